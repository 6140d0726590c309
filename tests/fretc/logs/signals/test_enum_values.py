"""Signals of words and truth values, from logs of every kind to propositions."""

import struct
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fretc.audit.one_log import examined
from fretc.logs.signals.enum_values import enum_indices
from fretc.logs.signals.samples import Recording
from fretc.logs.signals.traces import trace
from fretc.logs.stream import SampleStream, StreamEnd
from tests.effort import examples
from tests.fretc.logs.logs import (
    MS,
    S,
    Sent,
    codes,
    declare,
    payload,
    recorded,
    said,
    times,
    write,
)
from tests.fretc.logs.messages.test_idl import LINE
from tests.fretc.logs.messages.test_protobuf import STATE
from tests.fretc.logs.messages.test_protobuf import log as protobuf
from tests.fretc.logs.storage.test_bags import bag, db3

TEXT = """
[clock]
tick = "100 ms"

[signal.mode]
path = "{path}"
values = {values}
{more}

[proposition.p]
expr = "{expr}"
"""
WORDS = '["drive", "docking"]'
SEEN = ["drive", "docking", "drive", "charging", "", "docking"]
STEP = 100 * MS


def declared(path: str = "/m.data", values: str = WORDS, expr: str = "mode = 'docking'") -> str:
    return TEXT.format(path=path, values=values, expr=expr, more="")


def strings(seen: Sequence[str], encoding: str) -> list[Sent]:
    """One message every 100 ms from 1 s on."""
    name = "std_msgs/String" if encoding == "ros1" else "std_msgs/msg/String"
    return [
        Sent("/m", name, payload(name, encoding, data=text), S + i * STEP, encoding=encoding)
        for i, text in enumerate(seen)
    ]


def objects(seen: Sequence[object]) -> list[Sent]:
    return [said("/m", S + i * STEP, data=each) for i, each in enumerate(seen)]


def read(recording: Recording) -> list[str | None]:
    """The word of each sample."""
    samples = recording.samples["mode"]
    known = samples.words
    return [None if np.isnan(place) else known[int(place)] for place in samples.values]


def column(recording: Recording, text: str, name: str = "p") -> list[bool | None]:
    seen = trace(declare(text), recording, [name])
    return [seen.columns[name].at(tick) for tick in range(len(seen.timeline.times))]


LOGS: dict[str, Callable[[Path, Sequence[str]], Path]] = {
    "cdr": lambda path, seen: write(path / "l.mcap", strings(seen, "cdr")),
    "ros1": lambda path, seen: write(path / "l.mcap", strings(seen, "ros1")),
    "json": lambda path, seen: write(path / "l.mcap", objects(seen)),
    "bag": lambda path, seen: bag(path / "l.bag", strings(seen, "ros1")),
    "db3": lambda path, seen: db3(path / "l", strings(seen, "cdr")),
}


@pytest.mark.parametrize("kind", LOGS)
def test_a_text_is_read_of_every_kind_of_log(tmp_path: Path, kind: str) -> None:
    recording = recorded(LOGS[kind](tmp_path, SEEN), declare(declared()))
    assert read(recording) == ["drive", "docking", "drive", None, None, "docking"]
    assert times(recording, "mode") == [S + i * STEP for i in range(6)]
    (finding,) = [each for each in recording.findings if each.code.number == "F423"]
    assert finding.message == (
        "2 of 6 samples of `mode` are not among its values, the first one `charging` at 0.3 s: "
        "they are unknown"
    )
    assert column(recording, declared()) == [False, True, False, None, None, True]


IDL = f"""{LINE}IDL: a/msg/M
module a {{ module msg {{
  module M_Constants {{ const uint8 DRIVE = 0; const uint8 DOCKING = 4; const float F = 1.5; }};
  struct M {{ string name; uint8 data; }};
}}; }};
"""
MSG = "uint8 DRIVE=0\nuint8 DOCKING = 4  # at the dock\nstring WORD=4\nstring name\nuint8 data\n"


def numbers(encoding: str, seen: Sequence[int]) -> list[Sent]:
    head = b"" if encoding == "ros1" else b"\0\1\0\0"
    name = b"n" if encoding == "ros1" else b"n\0"
    type_ = "a/M" if encoding == "ros1" else "a/msg/M"
    return [
        Sent(
            "/m",
            type_,
            head + struct.pack("<I", len(name)) + name + bytes([each]),
            S + i * STEP,
            encoding=encoding,
        )
        for i, each in enumerate(seen)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("encoding", ["ros1", "cdr", "idl"])
@pytest.mark.parametrize("values", ['["DRIVE", "DOCKING"]', "{ DRIVE = 0, DOCKING = 4 }"])
@pytest.mark.parametrize("count", [6, 600])
def test_a_number_is_the_constant_of_its_definition(
    tmp_path: Path, encoding: str, values: str, count: int
) -> None:
    """Few messages are decoded one by one, many at once."""
    definition = {"a/M": MSG.encode(), "a/msg/M": (IDL if encoding == "idl" else MSG).encode()}
    seen = ([0, 4, 4, 7, 0, 4] * 100)[:count]
    log = write(tmp_path / "l.mcap", numbers(encoding, seen), definitions=definition)
    text = declared(values=values, expr="mode = DOCKING")
    recording = recorded(log, declare(text))
    assert read(recording) == [{0: "DRIVE", 4: "DOCKING"}.get(each) for each in seen]
    (finding,) = [each for each in recording.findings if each.code.number == "F423"]
    assert finding.message == (
        f"{count // 6} of {count} samples of `mode` are not among its values, the first one `7` at "
        "0.3 s: they are unknown"
    )
    assert column(recording, text)[:6] == [False, True, True, None, False, True]


@pytest.mark.parametrize(
    ("values", "message", "fix"),
    [
        ('["docking"]', "has no constant `docking`", "did you mean `DOCKING`?"),
        ('["DOKING"]', "has no constant `DOKING`", "did you mean `DOCKING`?"),
        (
            '["fly"]',
            "has no constant `fly`",
            "it names DRIVE, DOCKING; or write the number of each value: `values = { fly = 0 }`",
        ),
    ],
)
def test_a_constant_is_named_exactly(tmp_path: Path, values: str, message: str, fix: str) -> None:
    log = write(tmp_path / "l.mcap", numbers("cdr", [0, 4]), definitions={"a/msg/M": MSG.encode()})
    word = values[1:-1].replace('"', "'")
    recording = recorded(log, declare(declared(values=values, expr=f"mode = {word}")))
    (finding,) = recording.findings
    assert finding.is_error
    assert finding.message.endswith(message)
    assert finding.help == fix
    assert len(recording.samples["mode"].times) == 0


@pytest.mark.parametrize("values", ['["IDLE", "STOPPED"]', "{ IDLE = 0, STOPPED = 2 }"])
def test_an_enum_of_protobuf_is_read_by_name(tmp_path: Path, values: str) -> None:
    sent = [{"mode": 0}, {"mode": 2}, {}, {"mode": 1}]
    log = protobuf(tmp_path, [STATE(**each).SerializeToString() for each in sent])
    text = declared("/p.mode", values, "mode = STOPPED")
    recording = recorded(log, declare(text))
    assert read(recording) == ["IDLE", "STOPPED", "IDLE", None]
    assert codes(recording) == ["F423"]


def test_texts_of_protobuf_are_read(tmp_path: Path) -> None:
    sent = [STATE(name=name).SerializeToString() for name in ("docking", "x" * 10**6)]
    log = protobuf(tmp_path, sent)
    recording = recorded(log, declare(declared("/p.name")))
    assert read(recording) == ["docking", None]
    (finding,) = recording.findings
    assert f"`{'x' * 40}...`" in finding.message


def test_a_text_without_a_mapping_of_it_is_foreign(tmp_path: Path) -> None:
    """And a number where texts should be: neither is taken for the other."""
    log = write(tmp_path / "a.mcap", objects(["drive", 1, "docking"]))
    assert read(recorded(log, declare(declared()))) == ["drive", None, "docking"]
    log = write(tmp_path / "b.mcap", objects(["drive", 1, "docking", 1.5, True, None]))
    text = declared(values="{ drive = 1, docking = 0 }")
    assert read(recorded(log, declare(text))) == [None, "drive", None, None, "drive", None]


def test_an_element_of_an_array_is_one_word(tmp_path: Path) -> None:
    sent = objects([["drive", "docking"], ["docking"], "docking"])
    recording = recorded(write(tmp_path / "a.mcap", sent[:2]), declare(declared("/m.data[1]")))
    assert read(recording) == ["docking", None]
    recording = recorded(write(tmp_path / "b.mcap", sent), declare(declared("/m.data[1]")))
    (finding,) = recording.findings
    assert finding.message == "in `/m` `data` is no array"


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("date", "in `/m` the message has no field `date`"),
        ("data.x", "in `/m` `data` has no field `x`"),
        ("data[0]", "in `/m` `data` is no array"),
    ],
)
def test_a_field_that_is_no_word_is_an_error(tmp_path: Path, path: str, message: str) -> None:
    log = write(tmp_path / "l.mcap", strings(["drive"], "cdr"))
    (finding,) = recorded(log, declare(declared(f"/m.{path}"))).findings
    assert (finding.code.number, finding.message) == ("F406", message)


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
def test_bytes_that_are_no_text_are_unknown(tmp_path: Path, encoding: str) -> None:
    good = strings(["docking"] * 3, encoding)
    bad = good[1].payload.replace(b"king", b"\xff\xfeng")
    sent = [good[0], Sent(good[1].topic, good[1].type, bad, good[1].time, encoding=encoding)]
    recording = recorded(write(tmp_path / "l.mcap", [*sent, good[2]]), declare(declared()))
    assert read(recording) == ["docking", None, "docking"]
    assert set(codes(recording)) & {"F412", "F423"}


def test_an_escape_of_a_log_is_never_printed(tmp_path: Path) -> None:
    recording = recorded(
        write(tmp_path / "l.mcap", objects(["\x1b[2J\u202e\ud800"])), declare(declared())
    )
    (finding,) = recording.findings
    assert finding.message.isprintable()


FLAG = """
[clock]
tick = "100 ms"

[signal.on]
path = "/m.data"

[proposition.p]
expr = "{}"
"""


@pytest.mark.parametrize(
    ("expr", "expected"),
    [
        ("on", [False, True, None, None]),
        ("not on", [True, False, None, None]),
        ("on == false", [True, False, None, None]),
        ("on or true", [True] * 4),
        ("not on or on", [True, True, None, None]),
    ],
)
def test_a_plain_number_is_true_false_or_unknown(
    tmp_path: Path, expr: str, expected: list[bool | None]
) -> None:
    log = write(tmp_path / "l.mcap", objects([False, 1.0, 2, 0.5]))
    recording = recorded(log, declare(FLAG.format(expr)))
    assert column(recording, FLAG.format(expr)) == expected


NAIVE: dict[str, Callable[[object, object], bool]] = {
    "mode = docking": lambda a, _: a == "docking",
    "mode != docking": lambda a, _: a != "docking",
    "mode = other": lambda a, b: a == b,
    "mode != other": lambda a, b: a != b,
    "drive = mode": lambda a, _: a == "drive",
}
BOTH = """
[clock]
tick = "100 ms"

[signal.mode]
path = "/m.mode"
values = ["drive", "docking", "idle"]

[signal.other]
path = "/m.other"
values = ["drive", "docking", "idle"]
"""


@pytest.mark.slow
@settings(examples(15), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.lists(
        st.tuples(*2 * [st.sampled_from(["drive", "docking", "idle", "fly", "", None, 3])]),
        min_size=1,
        max_size=12,
    )
)
def test_a_random_log_is_judged_word_by_word(
    tmp_path: Path, rows: list[tuple[str | int | None, str | int | None]]
) -> None:
    """A comparison is unknown where a side is none of the words, and else as Python has it."""
    sent = [said("/m", S + i * STEP, mode=a, other=b) for i, (a, b) in enumerate(rows)]
    text = BOTH + "".join(f'[proposition."{expr}"]\nexpr = "{expr}"\n' for expr in NAIVE)
    recording = recorded(write(tmp_path / "l.mcap", sent), declare(text))
    known = ("drive", "docking", "idle")
    for expr, holds in NAIVE.items():
        expected = [
            holds(a, b) if a in known and (b in known or "other" not in expr) else None
            for a, b in rows
        ]
        assert column(recording, text, expr) == expected


@given(
    st.lists(st.integers(-5, 300), min_size=1, max_size=6, unique=True),
    st.lists(st.integers(-5, 300) | st.sampled_from([float("nan"), 0.5, 2.0**60]), max_size=20),
)
def test_numbers_mean_the_same_words_at_once_and_one_by_one(
    known: list[int], seen: list[float]
) -> None:
    text = declared(values="{" + ", ".join(f"w{n + 9} = {n}" for n in known) + "}")
    signal = declare(text.replace("'docking'", f"'w{known[0] + 9}'")).signals["mode"]
    places, foreign = enum_indices(signal, np.array(seen, np.float64))
    for number, place, is_foreign in zip(seen, places, foreign, strict=True):
        assert bool(is_foreign) is (number == number and number not in known)
        assert (known[int(place)] == number) if number in known else np.isnan(place)


STREAMED = f"""
[clock]
tick = "100 ms"

[signal.mode]
path = "/m.mode"
values = {WORDS}
max_age = "250 ms"

[signal.gear]
path = "/m.gear"
values = {{ park = 0, forward = 3 }}

[signal.on]
path = "/m.on"

[proposition.p]
expr = "on and mode != 'drive' or gear = park"
"""
ROWS = st.tuples(
    st.sampled_from(["drive", "docking", "fly", None]),
    st.sampled_from([0, 3, 1, None]),
    st.sampled_from([True, False, 0, 1, 2, None]),
)


@pytest.mark.slow
@settings(examples(15), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.sampled_from([40, 100, 300]), ROWS), min_size=1, max_size=8))
def test_a_stream_sees_what_a_log_of_the_same_messages_shows(
    tmp_path: Path, rows: list[tuple[int, tuple[object, object, object]]]
) -> None:
    declarations, sent, now = declare(STREAMED), [], S
    stream = SampleStream(declarations, ["p"])
    for step, row in rows:
        message = dict(zip(("mode", "gear", "on"), row, strict=True))
        assert stream.message("/m", now, message) is None
        sent.append(said("/m", now, **message))
        now += step * MS
    end = stream.end()
    assert isinstance(end, StreamEnd)
    recording = recorded(write(tmp_path / "l.mcap", sent), declarations)
    assert [tick.truth["p"] for tick in end.ticks] == column(recording, STREAMED)
    found = examined(recording, declarations, ["p"]).findings
    kinds = {"F423", "F424"}
    told = [each.message for each in found if each.code.number in kinds]
    assert sorted(each.message for each in stream.findings) == sorted(told)


def test_a_word_may_be_added_where_messages_have_its_number() -> None:
    stream = SampleStream(declare(STREAMED), ["p"])
    for time, word in ((S, "park"), (S + STEP, 3), (S + 2 * STEP, "reverse")):
        assert stream.add("gear", time, word) is None
    assert stream.add("mode", S, "drive") is None
    end = stream.end()
    assert isinstance(end, StreamEnd)
    assert [tick.truth["p"] for tick in end.ticks] == [True, False, None]
    (finding,) = stream.findings
    assert finding.message == (
        "1 of 3 samples of `gear` are not among its values, the first one `reverse` at 0.2 s: "
        "they are unknown"
    )
    wrong = stream.add("mode", S, {"a": 1})
    assert wrong is not None


def test_a_number_that_stands_for_a_truth_value_is_named(tmp_path: Path) -> None:
    declarations = declare(FLAG.format("on"))
    log = write(tmp_path / "l.mcap", objects([1, 55.5, 0, 3]))
    findings = examined(recorded(log, declarations), declarations, ["p"]).findings
    (finding,) = [each for each in findings if each.code.number == "F424"]
    assert finding.message == (
        "`on` stands for a truth value, and 2 of 4 samples are neither 1 nor 0, the first one 55.5 "
        "at 0.1 s: they are unknown"
    )


class Status:
    """As rospy and rclpy have a message with constants."""

    DRIVE, DOCKING = 0, 4
    __slots__ = ("data",)

    def __init__(self, data: object) -> None:
        self.data = data


def test_the_constants_of_a_message_of_python_are_its_words() -> None:
    values = '["DRIVE", "DOCKING"]'
    stream = SampleStream(declare(declared("/m.state.data", values, "mode = DOCKING")), ["p"])
    for i, data in enumerate((4, 0, 7)):
        assert stream.message("/m", S + i * STEP, {"state": Status(data)}) is None
    end = stream.end()
    assert isinstance(end, StreamEnd)
    assert [tick.truth["p"] for tick in end.ticks] == [True, False, None]
