"""Parquet and Arrow files as logs: the same samples as the same rows in CSV."""

import hashlib
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import feather, ipc, parquet

from fretc.audit.log_paths import logs
from fretc.logs.reader import Overview, look, read
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import FULL, examples
from tests.fretc.logs.logs import S, declare
from tests.fretc.logs.tables.test_tables import DECLARED, codes, overview, put, recorded

ROWS = {
    "t_s": [1.0, 1.5, 2.25],
    "x": [0.1, None, -3.0],
    "pose.y": [1, 2, None],
    "mode": ["drive", None, "in motion"],
    "state": [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]],
    "inside": [{"a": 1}, {"a": 2}, None],
}


def saved(folder: Path, kind: str, columns: dict[str, Any]) -> str:
    """A file of that kind with these columns."""
    path = folder / f"run.{kind}"
    table = pa.table(columns)
    if kind == "parquet":
        parquet.write_table(table, path, row_group_size=2)
    elif kind == "feather":
        feather.write_feather(table, path)
    else:
        with ipc.new_file(path, table.schema) as file:
            file.write_table(table)
    return str(path)


KINDS = ["parquet", "feather", "arrow"]
X = declare('[clock]\ntick = "100 ms"\n[signal.x]\npath = "/table.x"\n')


@pytest.mark.parametrize("kind", KINDS)
def test_the_samples_are_those_of_the_same_rows_in_csv(tmp_path: Path, kind: str) -> None:
    text = "t_s,x,pose.y,mode\n1.0,0.1,1,drive\n1.5,,2,\n2.25,-3.0,,in motion\n"
    expected = recorded(put(tmp_path, text))
    path = saved(tmp_path, kind, ROWS)
    recording = recorded(path)
    assert (recording.start_ns, recording.end_ns) == (S, 2 * S + S // 4)
    for name, samples in expected.samples.items():
        assert recording.samples[name].times.tolist() == samples.times.tolist()
        np.testing.assert_array_equal(recording.samples[name].values, samples.values)
    leaves = overview(path).leaves["/table"] or {}
    assert {*leaves} == {"x", "pose.y", "mode", "state[:]", "inside.a"}


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
@pytest.mark.parametrize("zone", [None, "UTC", "Europe/Berlin"])
def test_a_timestamp_has_its_unit_whatever_its_size(
    tmp_path: Path, unit: str, zone: str | None
) -> None:
    start = datetime(1970, 1, 3, tzinfo=UTC)
    moments = [start, start + timedelta(seconds=5)]
    times = pa.array(
        [
            int(each.timestamp() * {"s": 1, "ms": 1e3, "us": 1e6, "ns": 1e9}[unit])
            for each in moments
        ],
        pa.timestamp(unit, zone),
    )
    path = saved(tmp_path, "arrow", {"time": times, "x": [1.0, 2.0]})
    assert overview(path).recording.start_ns == 2 * 86_400 * S
    assert overview(path).recording.end_ns == (2 * 86_400 + 5) * S


def test_several_runs_in_a_file_are_refused(tmp_path: Path) -> None:
    columns = {"timestamp": [0.0, 0.1, 0.0], "episode_index": [0, 0, 1], "x": [1, 2, 3]}
    wrong = look(saved(tmp_path, "parquet", columns))
    assert isinstance(wrong, Diagnostic)
    assert "several runs" in wrong.message
    assert "run.parquet#0`" in str(wrong.help)
    columns["episode_index"] = [4, 4, 4]
    assert isinstance(look(saved(tmp_path, "parquet", columns)), Overview)


@pytest.mark.slow
@given(st.lists(st.sampled_from([0, 1, 2, 7]), min_size=1, max_size=40), st.sampled_from(["", "g"]))
@examples(20)
def test_a_run_of_several_is_read_as_a_file_of_its_rows(
    tmp_path_factory: pytest.TempPathFactory, numbers: list[int], groups: str
) -> None:
    folder = tmp_path_factory.mktemp("runs")
    rows: dict[str, list[Any]] = {
        "timestamp": [i * 0.1 for i in range(len(numbers))],
        "episode_index": numbers,
        "x": [float(i) for i in range(len(numbers))],
    }
    whole = folder / "file-000.parquet"
    parquet.write_table(pa.table(rows), whole, row_group_size=3 if groups else None)
    runs = logs([str(whole)])
    assert runs == (
        [f"{whole}#{number}" for number in sorted({*numbers})]
        if len({*numbers}) > 1
        else [str(whole)]
    )
    for number in {*numbers}:
        of_run = [i for i, each in enumerate(numbers) if each == number]
        alone = folder / "alone.parquet"
        parquet.write_table(
            pa.table({name: [column[i] for i in of_run] for name, column in rows.items()}), alone
        )
        got, wanted = (read(path, X, ["x"]) for path in (f"{whole}#{number}", str(alone)))
        assert isinstance(got, Recording)
        assert isinstance(wanted, Recording)
        np.testing.assert_array_equal(got.samples["x"].values, wanted.samples["x"].values)
        np.testing.assert_array_equal(got.samples["x"].times, wanted.samples["x"].times)
        assert got.sha256 == hashlib.sha256(whole.read_bytes()).hexdigest()


def test_a_run_that_a_file_does_not_hold_is_refused(tmp_path: Path) -> None:
    columns = {"timestamp": [0.0, 0.1], "episode_index": [0, 1], "x": [1, 2]}
    path = saved(tmp_path, "parquet", columns)
    for name in (f"{path}#2", f"{saved(tmp_path, 'feather', {'timestamp': [0.0]})}#0"):
        assert isinstance(look(name), Diagnostic)
    absent = look(f"{tmp_path}/none.parquet#0")
    assert isinstance(absent, Diagnostic)
    assert absent.code is Code.NO_SUCH_FILE


def test_a_file_whose_name_ends_like_that_of_a_run_is_a_file(tmp_path: Path) -> None:
    columns = {"timestamp": [0.0, 0.1], "episode_index": [5, 5], "x": [1, 2]}
    path = Path(saved(tmp_path, "parquet", columns)).rename(tmp_path / "a.parquet#3")
    assert isinstance(look(str(path)), Overview)


def test_an_empty_table_is_refused(tmp_path: Path) -> None:
    for kind in KINDS:
        wrong = look(saved(tmp_path, kind, {"t_s": pa.array([], pa.float64())}))
        assert isinstance(wrong, Diagnostic)
        assert wrong.code is Code.EMPTY_LOG


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_file_that_is_damaged_is_refused_or_its_samples_are_some_of_its_rows(
    tmp_path: Path, kind: str
) -> None:
    path = Path(saved(tmp_path, kind, {"t_s": [1.0, 2.0, 3.0], "x": [1.0, 2.0, 3.0]}))
    whole = path.read_bytes()
    for cut in range(1, len(whole), 1 if FULL else 11):
        path.write_bytes(whole[:cut])
        result = read(str(path), DECLARED, ["x"])
        assert isinstance(result, Diagnostic), cut
    for place in range(4, len(whole), 1 if FULL else 17):
        content = bytearray(whole)
        content[place] ^= 0x10
        path.write_bytes(content)
        flipped = read(str(path), DECLARED, ["x"])
        assert isinstance(flipped, Recording | Diagnostic)
        if isinstance(flipped, Recording) and len(flipped.samples["x"].values) < 3:
            assert flipped.gaps or Code.DAMAGED_CHUNK in codes(flipped)
