"""ULog: the samples are those that pyulog gives, and what is lost is unknown."""

import random
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.logs.reader import Overview, look, read
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Code, Diagnostic
from tests.effort import FULL, examples
from tests.fretc.logs.logs import declare

HEAD = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 1000)
FORMATS = {
    "state": "uint64_t timestamp;float battery;bool armed;uint8_t mode;uint8_t[1] _padding0;",
    "rotor": "int32_t rpm;double load;",
    "rotors": "uint64_t timestamp;float[3] q;rotor[2] each;char[4] note;int16_t low;",
}
DECLARED = declare(
    """
[clock]
tick = "10 ms"
[signal.battery]
path = "/state.battery"
[signal.armed]
path = "/state.armed"
[signal.mode]
path = "/state.mode"
[signal.other]
path = "/state/instance_1.battery"
[signal.q]
path = "/rotors.q[2]"
[signal.rpm]
path = "/rotors.each_1_rpm"
[signal.load]
path = "/rotors.each_0_load"
[signal.low]
path = "/rotors.low"
"""
)


def record(kind: str, content: bytes) -> bytes:
    return struct.pack("<HB", len(content), ord(kind)) + content


def state(us: int, battery: float, armed: bool = True, mode: int = 3, number: int = 0) -> bytes:
    return record("D", struct.pack("<HQf?B", number, us, battery, armed, mode))


def rotors(us: int, q: float = 0.5, rpm: int = -7, load: float = 0.1, low: int = -3) -> bytes:
    fields = struct.pack("<HQ3fididh", 2, us, 0, 0, q, 1, load, rpm, 2.0, low)
    return record("D", fields[:-2] + b"text" + fields[-2:])


def dropout(milliseconds: int) -> bytes:
    return record("O", struct.pack("<H", milliseconds))


def log(*records: bytes) -> bytes:
    formats = [record("F", f"{name}:{fields}".encode()) for name, fields in FORMATS.items()]
    added = [
        record("A", struct.pack("<BH", instance, number) + name.encode())
        for number, (instance, name) in enumerate([(0, "state"), (1, "state"), (0, "rotors")])
    ]
    return b"".join([HEAD, *formats, *added, *records])


def put(folder: Path, content: bytes) -> str:
    path = folder / "flight.ulg"
    path.write_bytes(content)
    return str(path)


def recorded(path: str, *names: str) -> Recording:
    result = read(path, DECLARED, names or ("battery",))
    assert isinstance(result, Recording), result
    return result


def codes(recording: Recording) -> set[Code]:
    return {each.code for each in recording.findings}


def test_numbers_arrays_and_nested_formats_are_read(tmp_path: Path) -> None:
    path = put(
        tmp_path, log(state(1000, 12.5), rotors(1500), state(2000, 11.25, False, 4), rotors(9000))
    )
    recording = recorded(path, "battery", "armed", "mode", "q", "rpm", "load", "low")
    values = {name: each.values.tolist() for name, each in recording.samples.items()}
    assert values == {
        "battery": [12.5, 11.25],
        "armed": [1, 0],
        "mode": [3, 4],
        "q": [0.5, 0.5],
        "rpm": [-7, -7],
        "load": [0.1, 0.1],
        "low": [-3, -3],
    }
    assert recording.samples["battery"].times.tolist() == [10**6, 2 * 10**6]
    assert codes(recording) == {Code.BAG_FORMAT}


def test_instances_are_topics(tmp_path: Path) -> None:
    path = put(tmp_path, log(state(1000, 1.0), state(1000, 2.0, number=1), state(2000, 3.0)))
    recording = recorded(path, "battery", "other")
    assert recording.samples["battery"].values.tolist() == [1.0, 3.0]
    assert recording.samples["other"].values.tolist() == [2.0]
    overview = look(path)
    assert isinstance(overview, Overview)
    assert {*(overview.leaves["/state"] or {})} == {"timestamp", "battery", "armed", "mode"}


def test_a_dropout_is_a_gap_from_message_to_message(tmp_path: Path) -> None:
    path = put(tmp_path, log(state(1000, 1.0), dropout(2), state(5000, 2.0), state(9000, 3.0)))
    recording = recorded(path)
    assert recording.gaps == ((10**6, 5 * 10**6),)
    assert Code.DAMAGED_CHUNK in codes(recording)
    at_end = recorded(put(tmp_path, log(state(1000, 1.0), state(2000, 1.0), dropout(2))))
    assert at_end.gaps == ((2 * 10**6, 2 * 10**6),)


@pytest.mark.slow
def test_a_file_that_is_cut_anywhere_is_damaged_or_refused(tmp_path: Path) -> None:
    records = [state(1000 * i, float(i)) for i in range(1, 5)]
    whole = log(*records)
    ends = {len(log(*records[:count])) for count in range(5)}
    for cut in range(0, len(whole)):
        result = read(put(tmp_path, whole[:cut]), DECLARED, ["battery"])
        if isinstance(result, Recording):
            assert (Code.TRUNCATED_LOG in codes(result)) == (cut not in ends), cut
        else:
            assert cut < len(log(records[0]))


def test_appended_data_says_that_the_autopilot_has_crashed(tmp_path: Path) -> None:
    flags = struct.pack("<16B3Q", *[0] * 8, 1, *[0] * 7, 0, 0, 0)
    content = log(state(1000, 1.0), state(2000, 2.0))
    start = len(HEAD)
    offset = len(content) + len(record("B", flags))
    flags = struct.pack("<16B3Q", *[0] * 8, 1, *[0] * 7, offset, 0, 0)
    crash = record("L", struct.pack("<BQ", 0x33, 3000) + b"hard fault")
    path = put(tmp_path, content[:start] + record("B", flags) + content[start:] + crash)
    assert Code.TRUNCATED_LOG in codes(recorded(path))


@pytest.mark.slow
@examples(60)
@given(st.data())
def test_any_formats_give_the_samples_of_pyulog(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    from pyulog import ULog

    kinds = {"int8_t": "b", "uint16_t": "H", "int32_t": "i", "uint64_t": "Q", "float": "f",
        "double": "d", "bool": "?"}  # fmt: skip
    fields = data.draw(
        st.lists(st.tuples(st.sampled_from([*kinds]), st.integers(0, 3)), max_size=6)
    )
    names = [f"f{i}" for i in range(len(fields))]
    text = "x:uint64_t timestamp;" + "".join(
        f"{kind}{f'[{count}]' if count else ''} {name};"
        for name, (kind, count) in zip(names, fields, strict=True)
    )
    layout = "<HQ" + "".join(kinds[kind] * max(count, 1) for kind, count in fields)
    drawn = random.Random(data.draw(st.integers()))
    rows = [
        record("D", struct.pack("<HQ", 0, 1000 * i) + drawn.randbytes(struct.calcsize(layout) - 10))
        for i in range(1, 4)
    ]
    content = HEAD + record("F", text.encode()) + record("A", struct.pack("<BH", 0, 0) + b"x")
    path = put(tmp_path_factory.mktemp("logs"), content + b"".join(rows))
    (expected,) = ULog(path).data_list
    signals = {
        f"s{i}_{j}": (f"{name}[{j}]" if count else name)
        for i, (name, (_, count)) in enumerate(zip(names, fields, strict=True))
        for j in range(max(count, 1))
    }
    bound = declare(
        '[clock]\ntick = "1 ms"\n'
        + "".join(f'[signal.{name}]\npath = "/x.{field}"\n' for name, field in signals.items())
    )
    recording = read(path, bound, [*signals])
    assert isinstance(recording, Recording)
    for name, field in signals.items():
        with np.errstate(invalid="ignore"):  # of a NaN that signals
            values = np.asarray(expected.data[field], np.longdouble)
        values[~np.isfinite(values)] = np.nan
        if expected.data[field].dtype == np.int8 and "bool" in str(field_kind(fields, field)):
            values = (values != 0).astype(np.float64)
        np.testing.assert_array_equal(recording.samples[name].values, values)


def field_kind(fields: Sequence[tuple[str, int]], field: str) -> str:
    return fields[int(field.removeprefix("f").partition("[")[0])][0]


@pytest.mark.slow
def test_whatever_a_byte_becomes_it_is_a_log_or_refused_with_a_reason(tmp_path: Path) -> None:
    whole = log(*(each(1000 * i, 1.0) for i in range(1, 3) for each in (state, rotors)))
    drawn = random.Random(7)
    for place in range(0, len(whole), 1 if FULL else 7):
        content = bytearray(whole)
        content[place] ^= 1 << drawn.randrange(8)
        result: Any = read(put(tmp_path, bytes(content)), DECLARED, ["battery", "rpm"])
        assert isinstance(result, Recording | Diagnostic), place
