"""Tables as logs: the same samples as the same messages in MCAP, and no verdict from a lost row."""

import csv
import io
import json
from collections.abc import Mapping, Sequence
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.reader import Overview, look, read
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import examples
from tests.fretc.logs.logs import MS, S, Sent, declare, write

BINDINGS = """
[clock]
tick = "100 ms"
[signal.x]
path = "/table.x"
[signal.y]
path = "/table.pose.y"
[signal.mode]
path = "/table.mode"
values = ["drive", "in motion"]
"""
DECLARED = declare(BINDINGS)


def put(folder: Path, text: str | bytes, name: str = "run.csv") -> str:
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return str(path)


def overview(path: str) -> Overview:
    result = look(path, words=True)
    assert isinstance(result, Overview), result
    return result


def refused(path: str) -> Diagnostic:
    result = look(path)
    assert isinstance(result, Diagnostic)
    return result


def recorded(path: str, *names: str) -> Recording:
    result = read(path, DECLARED, names or ("x", "y", "mode"))
    assert isinstance(result, Recording), result
    return result


def codes(recording: Recording) -> set[Code]:
    return {each.code for each in recording.findings}


TIMES = {
    ("t", "0.25"): 250 * MS,
    ("time", "1e-3"): MS,
    ("t_ms", "250"): 250 * MS,
    ("t_ms", "0.5"): MS // 2,
    ("Time (s)", "2"): 2 * S,
    ("timestamp_us", "7"): 7000,
    ("time_ns", "7"): 7,
    ("log_time", "1700000000"): 1_700_000_000 * S,
    ("timestamp", "1700000000123"): 1_700_000_000_123 * MS,
    ("timestamp", "1700000000123456"): 1_700_000_000_123_456_000,
    ("%time", "1700000000123456789"): 1_700_000_000_123_456_789,
    ("stamp", "1700000000.123456789"): 1_700_000_000_123_456_789,
    ("datetime", "2023-11-14T22:13:20Z"): 1_700_000_000 * S,
    ("datetime", "2023-11-14 22:13:20.000000001"): 1_700_000_000 * S + 1,
    ("datetime", "2023-11-15T00:13:20.5+02:00"): 1_700_000_000 * S + S // 2,
}


@pytest.mark.parametrize(("column", "text"), TIMES)
def test_the_unit_of_a_time_is_that_of_its_name_or_its_value(
    tmp_path: Path, column: str, text: str
) -> None:
    path = put(tmp_path, f"x,{column}\n1,{text}\n")
    assert overview(path).recording.start_ns == TIMES[column, text]
    lines = put(tmp_path, f'{{"x": 1, "{column}": {json.dumps(text)}}}\n', "run.jsonl")
    assert overview(lines).recording.start_ns == TIMES[column, text]


@pytest.mark.parametrize("text", ["100", "0", "1700", "99999999999999999999", "later", "", "nan"])
def test_a_unit_that_nothing_shows_is_not_guessed(tmp_path: Path, text: str) -> None:
    wrong = refused(put(tmp_path, f"t,x\n{text},1\n"))
    assert wrong.code is Code.TIME_OF_ROWS
    assert "`t_ms`" in (wrong.help or "")


def test_a_table_without_a_time_or_a_row_is_refused(tmp_path: Path) -> None:
    assert refused(put(tmp_path, "a,b\n1,2\n")).code is Code.TIME_OF_ROWS
    for text in ("", "\n\n", "t_s,x\n", "t_s,x\nnever,1\n", "t_s,x", b"\xff,\xfe\n1,2\n", "[1]"):
        wrong = refused(put(tmp_path, text))
        assert wrong.code in (Code.EMPTY_LOG, Code.TIME_OF_ROWS), text
        assert refused(put(tmp_path, text, "run.ndjson")).code in (
            Code.EMPTY_LOG,
            Code.TIME_OF_ROWS,
        )


def test_the_best_name_of_a_time_wins(tmp_path: Path) -> None:
    text = "time_s,t_ms,log_time_s,elapsed_s\n1,2,3,4\n5,6,7,8\n"
    table = overview(put(tmp_path, text))
    assert (table.recording.start_ns, table.recording.end_ns) == (3 * S, 7 * S)
    assert {*(table.leaves["/table"] or {})} == {"time_s", "t_ms", "elapsed_s"}


def test_decimals_are_seconds_and_that_is_told(tmp_path: Path) -> None:
    (note,) = overview(put(tmp_path, "t,x\n0.0,1\n0.1,2\n")).recording.findings
    assert "in seconds, since they are decimals" in note.message
    (note,) = overview(put(tmp_path, "t_s,x\n0.0,1\n0.1,2\n")).recording.findings
    assert note.message.endswith("column `t_s`, in seconds")


CELLS: Mapping[str, Any] = {
    "1": 1.0, "-2.50": -2.5, "+3": 3.0, ".5": 0.5, "5.": 5.0, "1E3": 1000.0, "007": 7.0,
    " 4 ": 4.0, "true": 1.0, "FALSE": 0.0,
}  # fmt: skip


@pytest.mark.parametrize("text", CELLS)
def test_a_cell_is_a_number(tmp_path: Path, text: str) -> None:
    samples = recorded(put(tmp_path, f"t_s,x\n1,{text}\n2,{text}\n"), "x").samples["x"]
    assert samples.values.tolist() == [CELLS[text]] * 2


@pytest.mark.parametrize("text", ["", "null", "NA", "None", "nan"])
def test_an_empty_cell_is_no_number(tmp_path: Path, text: str) -> None:
    path = put(tmp_path, f"t_s,x,mode\n1,{text},drive\n2,3,{text}\n3,4,drive\n")
    samples = recorded(path, "x").samples["x"]
    assert np.isnan(samples.values[0]) if len(samples.values) == 3 else samples.times[0] == 2 * S
    assert samples.values.tolist()[-2:] == [3.0, 4.0]


def test_the_long_form_has_a_topic_for_each_name(tmp_path: Path) -> None:
    text = "signal,value,t_ms\nbattery,80,0\nmode,drive,0\nbattery,79,100\n/odom/v x,1.5,100\n"
    table = overview(put(tmp_path, text))
    counts = {name: topic.count for name, topic in table.recording.topics.items()}
    assert counts == {"/table/battery": 2, "/table/mode": 1, "/table/odom_v_x": 1}
    assert table.words["/table/mode"] == {"value": ("drive",)}
    bound = declare('[clock]\ntick = "100 ms"\n[signal.b]\npath = "/table/battery.value"\n')
    recording = read(str(tmp_path / "run.csv"), bound, ["b"])
    assert isinstance(recording, Recording)
    assert recording.samples["b"].values.tolist() == [80.0, 79.0]


def test_names_of_columns_become_paths(tmp_path: Path) -> None:
    text = "t_s,pose.x,pose,Battery (%),Battery %,9,/odom.v,\n1,2,3,4,5,6,7,8\n"
    leaves = overview(put(tmp_path, text)).leaves["/table"] or {}
    assert {*leaves} == {
        "pose.x", "pose_2", "Battery", "Battery_2", "column_9", "odom.v", "column_",
    }  # fmt: skip


def test_tabs_quotes_a_byte_order_mark_and_line_ends(tmp_path: Path) -> None:
    text = '\ufefft_s\tmode\tx\r\n1\t"in motion"\t5\r\n\r\n2\t"drive"\t6\r\n'
    recording = recorded(put(tmp_path, text, "run.TSV"), "x", "mode")
    assert recording.samples["x"].values.tolist() == [5.0, 6.0]
    assert recording.samples["mode"].times.tolist() == [S, 2 * S]


BAD = {
    "too few cells": "2",
    "too many": "2,1,1,1",
    "no time": "soon,1,drive",
    "before time": "-1,1,drive",
    "quotes": '2,"1"1,drive',
    "bytes": "2,1,\udcff",
}


@pytest.mark.parametrize("row", BAD.values(), ids=BAD)
def test_what_a_row_that_cannot_be_read_says_is_unknown(tmp_path: Path, row: str) -> None:
    text = f"t_s,x,mode\n1,5,drive\n{row}\n{row}\n3,6,drive\n4,7,drive\n"
    recording = recorded(put(tmp_path, text.encode("utf-8", "surrogateescape")), "x")
    assert recording.samples["x"].values.tolist() == [5.0, 6.0, 7.0]
    assert Code.DAMAGED_CHUNK in codes(recording)
    (gap,) = recording.gaps
    assert gap == (S, 3 * S)
    (told,) = [each for each in recording.findings if each.code is Code.DAMAGED_CHUNK]
    assert "line 3, and 1 after it cannot be read" in told.message


def test_lost_rows_before_the_first_whole_one_are_told(tmp_path: Path) -> None:
    recording = recorded(put(tmp_path, "t_s,x\n1\n2,5\n3,6\n"), "x")
    assert Code.DAMAGED_CHUNK in codes(recording)
    assert recording.gaps == ((2 * S, 2 * S),)


def test_a_table_that_breaks_off_is_unknown_from_its_last_row_on(tmp_path: Path) -> None:
    recording = recorded(put(tmp_path, "t_s,x\n1,5\n2,6\n3,99"), "x")
    assert recording.samples["x"].values.tolist() == [5.0, 6.0]
    assert Code.TRUNCATED_LOG in codes(recording)
    assert recording.gaps == ((2 * S, 2 * S),)


@pytest.mark.slow
def test_a_table_that_is_cut_anywhere_within_a_row_is_damaged(tmp_path: Path) -> None:
    rows = [f"{i},{i}.25,drive" for i in range(1, 6)]
    whole = "t_s,x,mode\n" + "".join(f"{row}\n" for row in rows)
    objects = "".join(f'{{"t_s": {i}, "x": {i}.25}}\n' for i in range(1, 6))
    for text, name in ((whole, "a.csv"), (objects, "a.jsonl")):
        for cut in range(text.index("\n", 20) + 1, len(text)):
            result = read(put(tmp_path, text[:cut], name), DECLARED, ["x"])
            assert isinstance(result, Recording)
            at_end = text[cut - 1] == "\n" or (name == "a.jsonl" and text[cut] == "\n")
            assert (Code.TRUNCATED_LOG in codes(result)) != at_end, text[:cut]


def test_rows_out_of_order_are_messages_out_of_order(tmp_path: Path) -> None:
    recording = recorded(put(tmp_path, "t_s,x\n2,6\n1,5\n3,7\n"), "x")
    assert (recording.start_ns, recording.end_ns) == (S, 3 * S)
    assert sorted(recording.samples["x"].values.tolist()) == [5.0, 6.0, 7.0]


VALUES = st.one_of(
    st.floats(allow_nan=False),
    st.integers(-(10**6), 10**6),
    st.booleans(),
    st.none(),
)


@pytest.mark.slow
@examples(40)
@given(
    st.lists(
        st.tuples(
            st.integers(0, 10**6), VALUES, VALUES, st.sampled_from(["drive", "in motion", None])
        ),
        min_size=1,
    )
)
def test_a_table_is_read_as_the_same_messages_in_mcap(
    tmp_path_factory: pytest.TempPathFactory, rows: Sequence[tuple[Any, ...]]
) -> None:
    folder = tmp_path_factory.mktemp("tables")
    rows = sorted(rows, key=lambda row: row[0])
    sent, lines = [], []
    text = io.StringIO()
    table = csv.writer(text)
    table.writerow(["t_us", "x", "pose.y", "mode"])
    for at, x, y, mode in rows:
        message = {"x": x, "pose": {"y": y}, "mode": mode}
        known = {name: each for name, each in message.items() if each is not None}
        sent.append(Sent("/table", "", json.dumps(known).encode(), S + at * 1000, None, "json"))
        lines.append(json.dumps({**known, "t_us": 10**6 + at}))
        table.writerow([10**6 + at, *("" if each is None else each for each in (x, y, mode))])
    expected = recorded(str(write(folder / "run.mcap", sent)))
    for path in (
        put(folder, text.getvalue()),
        put(folder, "\n".join(lines), "run.jsonl"),
    ):
        recording = recorded(path)
        assert (recording.start_ns, recording.end_ns) == (expected.start_ns, expected.end_ns)
        assert recording.samples.keys() == expected.samples.keys()
        for name, samples in expected.samples.items():
            assert recording.samples[name].times.tolist() == samples.times.tolist()
            np.testing.assert_array_equal(recording.samples[name].values, samples.values)


@pytest.mark.slow
@examples(60)
@given(st.text(st.characters(exclude_categories=["Cs"])) | st.binary())
def test_whatever_a_file_holds_it_is_a_log_or_refused_with_a_reason(
    tmp_path_factory: pytest.TempPathFactory, text: str | bytes
) -> None:
    folder = tmp_path_factory.mktemp("tables")
    content = text if isinstance(text, bytes) else text.encode()
    for name in ("a.csv", "a.tsv", "a.jsonl"):
        for head in (b"", b"t_s,x\n1,2\n", b'{"t_s": 1, "x": 2}\n'):
            result = read(put(folder, head + content, name), DECLARED, ["x"])
            assert isinstance(result, Recording | Diagnostic)


@given(st.decimals(0, 10**6, allow_nan=False, places=9))
def test_decimals_are_exact_nanoseconds(amount: Decimal) -> None:
    from fretc.logs.tables.time_column import TimeColumn

    assert TimeColumn("t", "s").nanoseconds(str(amount)) == int(amount * 10**9)
