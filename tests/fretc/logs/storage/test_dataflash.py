"""DataFlash: the samples are those that were written, and what is lost is unknown."""

import random
import struct
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.reader import Overview, look, read
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import FULL, examples
from tests.fretc.logs.logs import declare

PACK = {
    "b": "b", "B": "B", "M": "B", "h": "h", "H": "H", "i": "i", "I": "I", "q": "q", "Q": "Q",
    "g": "e", "f": "f", "d": "d", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i", "a": "32h",
    "n": "4s", "N": "16s", "Z": "64s",
}  # fmt: skip
FORMATS = {
    10: ("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds"),
    11: ("BAT", "QBfcM", "TimeUS,Inst,Volt,Curr,Mode"),
    12: ("POS", "QLLeg", "TimeUS,Lat,Lng,Alt,H"),
    13: ("ISB", "QaZ", "TimeUS,x,Text"),
    14: ("PARM", "Nf", "Name,Value"),
    15: ("DSF", "QIH", "TimeUS,Dp,Blk"),
    16: ("OLD", "Ih", "TimeMS,v"),
}
DECLARED = declare(
    """
[clock]
tick = "10 ms"
[signal.volt]
path = "/BAT.Volt"
[signal.current]
path = "/BAT.Curr"
[signal.second]
path = "/BAT/instance_1.Volt"
[signal.lat]
path = "/POS.Lat"
[signal.alt]
path = "/POS.Alt"
[signal.half]
path = "/POS.H"
[signal.third]
path = "/ISB.x[2]"
[signal.old]
path = "/OLD.v"
"""
)


def record(type_: int, *values: object) -> bytes:
    fields = struct.pack("<" + "".join(PACK[each] for each in FORMATS[type_][1]), *values)
    return b"\xa3\x95" + bytes([type_]) + fields


def form(type_: int, size: int, name: str, formats: str, columns: str) -> bytes:
    texts = (name.encode(), formats.encode(), columns.encode())
    return b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", type_, size, *texts)


def forms() -> Iterable[bytes]:
    yield form(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")
    for type_, (name, formats, columns) in FORMATS.items():
        size = 3 + struct.calcsize("<" + "".join(PACK[each] for each in formats))
        yield form(type_, size, name, formats, columns)
    yield record(10, 1, 11, b"s#vA-", b"F----")


def battery(us: int, volt: float, number: int = 0, current: int = 0) -> bytes:
    return record(11, us, number, volt, current, 3)


def put(folder: Path, *records: bytes) -> str:
    path = folder / "00000001.BIN"
    path.write_bytes(b"".join([*forms(), *records]))
    return str(path)


def recorded(path: str, *names: str) -> Recording:
    result = read(path, DECLARED, names or ("volt",))
    assert isinstance(result, Recording), result
    return result


def values(recording: Recording) -> dict[str, list[float]]:
    return {name: each.values.tolist() for name, each in recording.samples.items()}


def test_numbers_of_all_types_are_read_in_their_units(tmp_path: Path) -> None:
    path = put(
        tmp_path,
        battery(1000, 12.5, 0, -250),
        record(12, 2000, -337654321, 1234567890, 12345, 0.5),
        battery(3000, 11.25, 1),
        record(13, 4000, *range(7, 39), b"text"),
        record(14, b"ANGLE_MAX", 3.0),
        record(16, 5, -7),
    )
    names = ("volt", "current", "second", "lat", "alt", "half", "third", "old")
    recording = recorded(path, *names)
    assert values(recording) == {
        "volt": [12.5],
        "current": [-2.5],
        "second": [11.25],
        "lat": [-33.7654321],
        "alt": [123.45],
        "half": [0.5],
        "third": [9],
        "old": [-7],
    }
    assert recording.samples["volt"].times.tolist() == [10**6]
    assert recording.samples["old"].times.tolist() == [5 * 10**6]
    assert {each.code for each in recording.findings} == {Code.BAG_FORMAT}
    overview = look(path)
    assert isinstance(overview, Overview)
    assert "/PARM" not in overview.leaves


@examples(30)
@given(
    st.lists(
        st.tuples(st.integers(1, 10**9), st.integers(0, 2), st.floats(width=32, allow_nan=False)),
        min_size=1,
        max_size=30,
    )
)
def test_the_samples_are_those_that_were_written(
    tmp_path_factory: pytest.TempPathFactory, sent: list[tuple[int, int, float]]
) -> None:
    folder = tmp_path_factory.mktemp("log")
    sent.sort(key=lambda each: each[0])
    recording = recorded(put(folder, *(battery(us, v, n) for us, n, v in sent)), "volt", "second")
    for name, number in (("volt", 0), ("second", 1)):
        wanted = [(us * 1000, v) for us, n, v in sent if n == number]
        samples = recording.samples[name]
        got = [*zip(samples.times.tolist(), samples.values.tolist(), strict=True)]
        finite = [(t, v if abs(v) != float("inf") else None) for t, v in wanted]
        assert [(t, None if np.isnan(v) else v) for t, v in got] == finite


LOG = [battery(1000 * i, float(i)) for i in range(1, 9)]


def test_a_record_that_cannot_be_read_is_a_gap_between_its_neighbours(tmp_path: Path) -> None:
    broken = b"\xa3\x96" + LOG[3][2:]
    recording = recorded(put(tmp_path, *LOG[:3], broken, *LOG[4:]))
    assert not recording.intact
    # The record before it is followed by none, and does not count either.
    assert recording.gaps == ((2 * 10**6, 5 * 10**6),)
    assert values(recording) == {"volt": [1, 2, 5, 6, 7, 8]}


def test_what_the_autopilot_has_dropped_is_a_gap(tmp_path: Path) -> None:
    states = [record(15, 1500, 0, 9), record(15, 4500, 2, 9), record(15, 6500, 2, 9)]
    log = [*LOG[:1], states[0], *LOG[1:4], states[1], *LOG[4:6], states[2], *LOG[6:]]
    recording = recorded(put(tmp_path, *log))
    assert recording.gaps == ((1_500_000, 4_500_000),)
    assert not recording.intact


def test_a_log_that_ends_within_a_record_is_cut(tmp_path: Path) -> None:
    recording = recorded(put(tmp_path, *LOG[:-1], LOG[-1][:-2]))
    assert Code.TRUNCATED_LOG in {each.code for each in recording.findings}
    assert values(recording) == {"volt": [1, 2, 3, 4, 5, 6, 7]}
    assert not recording.intact


@pytest.mark.parametrize(
    "wrong",
    [
        form(20, 3, "NONE", "", ""),
        form(20, 12, "SIZE", "Q", "TimeUS"),
        form(20, 11, "KIND", "?", "TimeUS"),
        form(20, 19, "SAME", "QQ", "TimeUS,TimeUS"),
        form(20, 11, "N A", "Q", "TimeUS"),
        form(20, 12, "FEW", "QB", "TimeUS"),
        form(11, 12, "BAT", "QB", "TimeUS,Inst"),
    ],
)
def test_a_format_that_contradicts_itself_or_an_earlier_one_is_damage(
    tmp_path: Path, wrong: bytes
) -> None:
    recording = recorded(put(tmp_path, *LOG[:4], wrong, *LOG[4:]))
    assert recording.intact is (wrong == form(20, 3, "NONE", "", ""))
    assert values(recording) == {"volt": [1, 2, 3, 4, 5, 6, 7, 8]}


@pytest.mark.parametrize(
    ("records", "code"),
    [
        ((), Code.EMPTY_LOG),
        ((battery(2**63, 1.0),), Code.UNREADABLE_LOG),
        ((record(14, b"ANGLE_MAX", 3.0),), Code.EMPTY_LOG),
    ],
)
def test_a_log_without_a_time_is_refused(
    tmp_path: Path, records: Sequence[bytes], code: Code
) -> None:
    forms_alone = records or ()
    path = tmp_path / "log.bin"
    content = b"".join([*list(forms())[:-1], *forms_alone])
    path.write_bytes(content)
    wrong = look(str(path))
    assert isinstance(wrong, Diagnostic)
    assert wrong.code is code


@pytest.mark.slow
def test_a_cut_or_changed_file_is_refused_or_shows_only_samples_that_were_written(
    tmp_path: Path,
) -> None:
    path = Path(put(tmp_path, *LOG))
    whole = path.read_bytes()
    for cut in range(3, len(whole), 1 if FULL else 13):
        path.write_bytes(whole[:cut])
        result = read(str(path), DECLARED, ["volt"])
        if isinstance(result, Recording):
            assert {*result.samples["volt"].values.tolist()} <= {float(i) for i in range(1, 9)}
    draw = random.Random(1)
    first = len(whole) - len(LOG) * len(LOG[0])
    for _ in range(2000 if FULL else 60):
        content = bytearray(whole)
        at = draw.randrange(3, len(content))
        content[at] ^= 1 << draw.randrange(8)
        path.write_bytes(content)
        result = read(str(path), DECLARED, ["volt"])
        is_head = at < first or (at - first) % len(LOG[0]) < 3
        if isinstance(result, Recording) and is_head and at >= first:
            assert not result.intact
