"""Drafts of bindings: read back by the reader of bindings, for logs of any kind."""

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from compiler.project.folder import load
from fretc.audit.bindings.draft import draft
from fretc.audit.bindings.needs import (
    MissingProposition,
    MissingSignal,
    missing_propositions,
    missing_signals,
)
from fretc.logs.reader import look, read
from fretc.logs.signals.samples import Recording
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from tests.command import write as put
from tests.fretc.logs.logs import MS, S, Sent, declare, number, payload, scan, write

ROOT = Path(__file__).parents[4]
LOGS = sorted((ROOT / "traces").glob("*.mcap"))


def drafted(
    path: Path, needs: Sequence[MissingProposition] = (), durations: Sequence[int] = ()
) -> str:
    overview = look(str(path), words=True)
    assert not isinstance(overview, Diagnostic), overview
    return draft(overview, needs, durations)


def every(period: int, count: int, topic: str = "/x", start: int = 1000 * S) -> list[Sent]:
    return [number(float(i), start + i * period, topic) for i in range(count)]


def named(topic: str, type_: str, data: bytes, at: int = 1000 * S) -> Sent:
    return Sent(topic, type_, data, at)


def test_a_whole_draft(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, golden: Callable[[str, str], None]
) -> None:
    monkeypatch.chdir(tmp_path)
    messages = [scan([1.0, 2.0], 1000 * S + i * 100 * MS) for i in range(12)]
    messages += every(20 * MS, 51, "/battery level")
    messages += every(S, 3, "/mode")
    messages.append(named("/name", "std_msgs/msg/String", payload("std_msgs/String", data="a")))
    write(Path("run.mcap"), sorted(messages, key=lambda message: message.time))
    needs = [MissingProposition("near", ("R1", "R2"), "input", "any")]
    golden("bindings/draft.toml", drafted(Path("run.mcap"), needs))


@pytest.mark.slow
@pytest.mark.parametrize("path", LOGS, ids=lambda path: path.stem)
def test_a_draft_without_open_propositions_is_read_and_finds_no_fault_with_its_log(
    path: Path,
) -> None:
    declarations = declare(drafted(path))
    assert len(declarations.signals) > 10
    recording = read(str(path), declarations, list(declarations.signals))
    assert isinstance(recording, Recording)
    assert recording.findings == ()
    assert all(len(samples.times) for samples in recording.samples.values())


def test_a_signal_is_known_between_two_messages_of_its_topic(tmp_path: Path) -> None:
    declarations = declare(drafted(write(tmp_path / "a.mcap", every(100 * MS, 20))))
    assert declarations.signals["x"].max_age == 300 * MS
    assert declarations.clock.period == 100 * MS


def test_a_gap_longer_than_the_age_limit_is_stated_beside_it(tmp_path: Path) -> None:
    messages = [*every(100 * MS, 20), *every(100 * MS, 20, start=1000 * S + 2800 * MS)]
    text = drafted(write(tmp_path / "a.mcap", messages))
    assert declare(text).signals["x"].max_age == 400 * MS
    assert 'max_age = "400 ms"  # the longest gap in this log, 900 ms, exceeds it' in text
    assert "exceeds it" not in drafted(write(tmp_path / "b.mcap", every(100 * MS, 20)))


def test_bursts_do_not_make_a_sample_old_at_once(tmp_path: Path) -> None:
    """Three messages within 2 ms, every 100 ms: most steps are short."""
    messages = [m for i in range(20) for m in every(MS, 3, start=1000 * S + i * 100 * MS)]
    age = declare(drafted(write(tmp_path / "a.mcap", messages))).signals["x"].max_age
    assert age is not None
    assert 98 * MS <= age <= 300 * MS


def test_the_tick_is_that_of_the_slowest_topic_that_is_fast(tmp_path: Path) -> None:
    messages = [*every(10 * MS, 300), *every(40 * MS, 80, "/y"), *every(S, 11, "/slow")]
    messages.sort(key=lambda message: message.time)
    assert declare(drafted(write(tmp_path / "a.mcap", messages))).clock.period == 40 * MS
    late = declare(drafted(write(tmp_path / "c.mcap", every(101 * MS, 20))))
    assert late.clock.period == 100 * MS  # a little late is no other rate
    of_slow_topic = declare(drafted(write(tmp_path / "b.mcap", every(S, 11, "/slow"))))
    assert of_slow_topic.clock.period == S


def test_events_have_no_rate(tmp_path: Path) -> None:
    text = drafted(write(tmp_path / "a.mcap", every(S, 2)))
    assert declare(text).signals["x"].max_age is None
    assert declare(text).clock.period == 100 * MS
    assert '# max_age = "1 s"' in text


def test_names_are_ones_that_expressions_can_use(tmp_path: Path) -> None:
    topics = ["/a/b", "/a_b", "/min", "/9", "/A-c", "not"]
    text = drafted(write(tmp_path / "a.mcap", [m for t in topics for m in every(MS, 1, t)]))
    declarations = declare(text)
    assert set(declarations.signals) == {"a_b", "a_b_2", "min_2", "a_c", "not_2"}
    assert "# a path cannot contain the name of this topic" in text  # /9
    expr = " + ".join(declarations.signals)
    declare(f'{text}\n[proposition.p]\nexpr = "{expr} > 0"\n')


def test_what_a_log_calls_its_topics_and_types_cannot_leave_a_comment(tmp_path: Path) -> None:
    evil = '/x"\n[signal.y]\npath = "/z.data'
    message = number(1.0, S, topic=evil)
    text = drafted(write(tmp_path / "a.mcap", [message, *every(MS, 1)]))
    assert set(declare(text).signals) == {"x"}


def test_other_numbers_are_there_as_comments(tmp_path: Path) -> None:
    text = drafted(write(tmp_path / "a.mcap", [scan([1.0], S + i * 100 * MS) for i in range(12)]))
    lines = text.splitlines()
    for field in ("angle_min", "range_max", "intensities[:]"):
        assert f'# path = "/scan.{field}"' in lines
    assert "header" not in text.replace("header.stamp: when", "")


def test_a_proposition_that_is_to_be_filled_in_is_an_error_until_it_is(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap", every(100 * MS, 12))
    text = drafted(path, [MissingProposition("near", ("R1",), "input", "any")])
    declarations, diagnostics = read_bindings(Source("bindings.toml", text))
    assert declarations is not None
    (diagnostic,) = diagnostics
    assert declarations.mistakes == {("proposition", "near"): diagnostics}
    assert diagnostic.code is Code.BAD_EXPRESSION
    assert diagnostic.span is not None
    line = diagnostic.span.source.text.splitlines()[diagnostic.span.line - 1]
    assert line == 'expr = "TODO: when is it true? As in: x < 0.5"'
    filled = declare(text.replace(line, 'expr = "x < 0.5"'))
    assert filled.propositions["near"].role == "input"


def texts(*seen: str, topic: str = "/mode") -> list[Sent]:
    name = "std_msgs/msg/String"
    return [
        named(topic, name, payload(name, data=text), 1000 * S + i * 500 * MS)
        for i, text in enumerate(seen)
    ]


def test_the_words_of_a_text_are_those_of_the_log(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap", texts(*["drive", "in motion", "drive"] * 4))
    mode = declare(drafted(path)).signals["mode"]
    assert mode.values == ("drive", "in motion")
    assert mode.max_age == 1500 * MS
    recording = read(str(path), declare(drafted(path)), ["mode"])
    assert isinstance(recording, Recording)
    assert recording.findings == ()


@pytest.mark.parametrize("text", ["x" * 41, 'a"b', "a\nb"])
def test_free_text_is_no_signal(tmp_path: Path, text: str) -> None:
    assert declare(drafted(write(tmp_path / "a.mcap", texts("a", text)))).signals == {}
    many = texts(*(f"word {i}" for i in range(21)))
    assert declare(drafted(write(tmp_path / "b.mcap", many))).signals == {}


def test_words_of_other_messages_are_there_as_comments(tmp_path: Path) -> None:
    sent = [
        Sent(
            "/s",
            "s",
            b'{"mode": "drive", "level": 3, "header": {"frame_id": "x"}}',
            S,
            None,
            "json",
        ),
        Sent("/s", "s", b'{"mode": "dock", "level": 4}', 2 * S, None, "json"),
    ]
    lines = drafted(write(tmp_path / "a.mcap", sent)).splitlines()
    at = lines.index('# path = "/s.mode"')
    assert lines[at + 1] == '# values = ["drive", "dock"]'
    assert '# path = "/s.level"' in lines


def test_a_proposition_that_is_called_as_a_truth_value_of_the_log_is_that(tmp_path: Path) -> None:
    flag = "std_msgs/msg/Bool"
    sent = [named("/docking", flag, payload(flag, data=True))]
    needs = [MissingProposition("docking", ("R1",), "input", "any")]
    text = drafted(write(tmp_path / "a.mcap", sent), needs)
    assert declare(text).propositions["docking"].signals == ("docking",)


@pytest.mark.parametrize(
    ("durations", "tick"),
    [
        ((), 200), ((400 * MS,), 200), ((300 * MS,), 150), ((300 * MS, 500 * MS), 100),
        ((MS // 2,), 200), ((10**30,), 200),
    ],
)  # fmt: skip
def test_durations_are_whole_numbers_of_the_tick(
    tmp_path: Path, durations: tuple[int, ...], tick: int
) -> None:
    text = drafted(write(tmp_path / "a.mcap", every(200 * MS, 12)), (), durations)
    assert declare(text).clock.period == tick * MS


# What requirements still need


def needed(folder: Path, *sentences: str, bindings: str = "") -> list[MissingProposition]:
    files = [
        put(str(folder / f"r{i}.fret"), f'+++\nid = "R{i}"\n+++\n{sentence}\n')
        for i, sentence in enumerate(sentences, 1)
    ]
    return list(missing_propositions(load(files, put(str(folder / "bindings.toml"), bindings))))


def test_each_name_is_wanted_once_with_the_role_that_its_place_gives_it(tmp_path: Path) -> None:
    missing = needed(
        tmp_path,
        "in m mode, whenever near the rover shall within 3 ticks satisfy still",
        "whenever near the rover shall until done satisfy slow",
        "whenever still the rover shall immediately satisfy quiet",
    )
    assert {(each.name, each.requirements, each.role, each.aggregate) for each in missing} == {
        ("m", ("R1",), "mode", "last"),
        ("near", ("R1", "R2"), "input", "any"),
        ("still", ("R1", "R3"), "internal", "last"),
        ("done", ("R2",), "internal", "last"),
        ("slow", ("R2",), "output", "last"),
        ("quiet", ("R3",), "output", "last"),
    }


def test_what_is_bound_is_not_wanted(tmp_path: Path) -> None:
    bindings = (
        '[clock]\ntick = "1 s"\n[signal.x]\npath = "/x.data"\n[proposition.near]\nexpr = "x < 1"\n'
    )
    missing = needed(
        tmp_path, "whenever near the rover shall immediately satisfy still", bindings=bindings
    )
    assert [each.name for each in missing] == ["still"]


def test_of_a_comparison_the_signals_are_wanted(tmp_path: Path) -> None:
    bindings = '[clock]\ntick = "1 s"\n[signal.x]\npath = "/x.data"\n'
    file = put(
        str(tmp_path / "r.fret"),
        "whenever x < 1 & battery < 20 & far(y) < 3 the rover shall immediately satisfy "
        "mode = home & minReal(battery, z) > x\n",
    )
    project = load([file], put(str(tmp_path / "bindings.toml"), bindings))
    assert [(each.name, each.requirements) for each in missing_signals(project)] == [
        ("battery", ("r",)),
        ("mode", ("r",)),
        ("z", ("r",)),
    ]
    assert [each.name for each in missing_propositions(project)] == ["(far(y) < 3)"]


def test_a_signal_that_is_to_be_found_is_an_error_until_it_is(tmp_path: Path) -> None:
    path = write(tmp_path / "run.mcap", every(100 * MS, 12))
    overview = look(str(path))
    assert not isinstance(overview, Diagnostic)
    text = draft(overview, (), (), [MissingSignal("battery", ("R1",)), MissingSignal("x", ("R1",))])
    assert "# To do: which field is it? Named by R1.\n[signal.battery]\n" in text
    assert text.count("[signal.x]") == 1
    _, wrong = read_bindings(Source("bindings.toml", text))
    assert [each.code for each in wrong] == [Code.BAD_BINDING_FIELD]
