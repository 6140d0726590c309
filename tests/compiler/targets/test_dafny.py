"""Files for Dafny: the definitions in them, what they leave out, and what Dafny says of them."""

import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import pytest

from compiler.emit import TARGETS
from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.reference import accepts, initial, step, template
from compiler.project.folder import load
from compiler.targets.dafny import text
from compiler.targets.dafny_claims import claims
from fretish.bindings.declarations import Declarations, Interception, InterceptorForm
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from monitors import interceptor as core
from monitors.interceptor import Velocity
from tests.bound_requirements import declared
from tests.dafny_reader import Reader
from tests.each import each
from tests.effort import FULL, pairwise

TARGET = TARGETS["dafny"]
CONDITIONS = ("", "when p ", "whenever p ")
TIMINGS = (
    "immediately",
    "at the next timepoint",
    "at the last timepoint",
    "eventually",
    "always",
    "never",
    "within {n} ticks",
    "for {n} ticks",
    "after {n} ticks",
    "until s",
    "before s",
)
BINDINGS = """\
[clock]
tick = "100 ms"

[signal.range]
path = "/scan.range_min"
type = "sensor_msgs/LaserScan"
unit = "m"
max_age = "100 ms"

[proposition.p]
text = "near"
expr = "range < 1 m"

[proposition.q]
text = "still"
expr = "range > 2 m"

[interceptor]
stop         = "/stop"
command      = "/cmd_vel"
output       = "/cmd_vel_filtered"
scan         = "/scan"
period       = "50 ms"
hold         = "200 ms"
stop_timeout = "1200 ms"
scan_timeout = "500 ms"

[assume]
stands  = "q"
latency = "100 ms"
lost    = 1
braking = "200 ms"
"""
EVENT = re.sub(r"(period|hold|\w+_timeout) .*\n", "", BINDINGS).replace(
    "[assume]", 'form = "event"\n\n[assume]'
)


def bound(text: str = BINDINGS) -> Declarations:
    return declared(text)


def requirement(sentence: str, declarations: Declarations | None = None) -> FormalizedRequirement:
    requirement = RequirementEntry("R1", Source("r.fret", sentence).span())
    made, diagnostics = formalize(requirement, declarations)
    assert made is not None, diagnostics
    return made


def emitted(sentence: str, bindings: str | None = BINDINGS) -> str:
    declarations = bound(bindings) if bindings else None
    made = requirement(sentence, declarations)
    assert TARGET.refuse(made) is None
    return text(made, declarations)


# The monitor in the text is the reference automaton -------------------------------------------


@pytest.mark.slow
@each(
    "kind",
    pairwise(CONDITIONS, [(t, n) for t in TIMINGS for n in (0, 1, 2) if "{n}" in t or not n]),
)
def test_the_step_and_the_definition_are_those_of_the_reference(
    kind: tuple[str, tuple[str, int]],
) -> None:
    condition, (timing, n) = kind
    made = requirement(f"{condition}robot shall {timing.format(n=n)} satisfy q")
    read = Reader(text(made, None))
    ticks = (n,) if "{n}" in timing else ()
    names = re.findall(r"(\w+): bool", re.findall(r"datatype Tick = .*", text(made, None))[0])
    reference = template(made.sentence, n)
    length = 3 if len(names) > 2 else 4 if FULL else 3
    for word in product(product((False, True), repeat=len(names)), repeat=length):
        letters = [dict(zip(names, letter, strict=True)) for letter in word]
        w = [read.Tick(*letter) for letter in word]
        state, broken = initial(reference), False
        for k in range(length + 1):
            monitor = read.Run(*ticks, w, k)
            if timing in ("eventually", "at the last timepoint"):
                assert (monitor.demand.count > 0) == (not accepts(reference, state))
                assert read.Unanswered(w, k) == (not accepts(reference, state))
            else:
                assert monitor.demand.broken == broken, (letters, k)
                assert read.Violated(*ticks, w, k) == broken, (letters, k)
            if k == length or broken:
                break
            p, q, s = (letters[k].get(name, False) for name in "pqs")
            after = step(reference, state, False, p, q, s)
            state, broken = after or state, after is None


# The step of the interceptor is that of the core ------------------------------------------------

Heard = core.StopHeard | core.CommandHeard | core.ScanHeard | core.TimerRang
FAST, SLOW = Velocity(0.4, wz=0.1), Velocity(-0.15)
TIMED = [
    core.Options(hold, stop, scan, command, latching=latching)
    for hold, stop, scan, command in product((0, 2), (0, 2), (0, 1), (0, 2))
    for latching in (False, True)
]
EVENTS = [core.Options(0, 0, 0, 0, event_driven=True, latching=one) for one in (False, True)]


def interceptor_text(options: core.Options) -> str:
    """The file for an interceptor with these options, a tick of its timer being 50 ms."""
    declarations = bound(BINDINGS)
    tick = 50_000_000
    node = Interception(
        "/stop",
        "/cmd_vel",
        "/out",
        "/scan",
        period=tick,
        hold=options.hold * tick,
        stop_timeout=options.stop_timeout * tick,
        scan_timeout=options.scan_timeout * tick,
        command_timeout=options.command_timeout * tick,
        form=InterceptorForm.EVENT if options.event_driven else InterceptorForm.TIMER,
        latching=options.latching,
    )
    made = requirement("robot shall eventually satisfy q")
    return text(made, replace(declarations, interceptor=node))


@pytest.mark.slow
@pytest.mark.parametrize("options", [*TIMED, *EVENTS])
def test_the_interceptor_does_in_each_state_what_the_core_does(options: core.Options) -> None:
    read = Reader(interceptor_text(options), interceptor=True)
    messages: list[tuple[Heard, object]] = [
        (core.StopHeard(True), read.StopHeard(True)),
        (core.StopHeard(False), read.StopHeard(False)),
        (core.CommandHeard(SLOW), read.CommandHeard(read.Velocity(*SLOW))),
        (core.CommandHeard(core.ZERO), read.CommandHeard(read.ZERO)),
        (core.ScanHeard(), read.ScanHeard),
        (core.TimerRang(), read.TimerRang),
    ]

    def alike(state: core.State) -> object:
        values = {name: getattr(state, name) for name in vars(state)}
        return read.Interceptor(*{**values, "command": read.Velocity(*state.command)}.values())

    assert read.Initial() == alike(core.initial(options))
    for state in in_range(options):
        assert read.InRange(alike(state))
        assert read.Halted(alike(state)) == core.halted(state, options)
        for ours, theirs in messages:
            after, output = core.step(state, ours, options)
            outcome = read.InterceptorStep(alike(state), theirs)
            assert outcome.state == alike(after), (state, ours)
            published = read.Nothing if output is None else read.Output(read.Velocity(*output))
            assert outcome.published == published, (state, ours)


def in_range(options: core.Options) -> Iterator[core.State]:
    """Every state within its bounds, reached or not, with a command to move and one to stand."""
    numbers = (options.hold, options.stop_timeout, options.scan_timeout, options.command_timeout)
    for stop, command in product((False, True), (core.ZERO, FAST)):
        for held, *ages in product(*(range(most + 1) for most in numbers)):
            yield core.State(stop, held, command, *ages)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("if s.held > 0 then s.held - 1 else 0", "if s.held > 1 then s.held - 1 else s.held"),
        ("if requested then HOLD else s.held", "if requested then HOLD else 0"),
        ("Passed(older, s.last)", "Passed(s, s.last)"),
        ("0 < timeout <= age", "0 < timeout < age"),
        ("s.(scan_age := 0)", "s.(stop_age := 0)"),
    ],
)
def test_an_interceptor_that_does_something_else_is_found(
    old: str, new: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = interceptor_text(TIMED[-1])
    assert found.count(old) == 1
    monkeypatch.setitem(globals(), "interceptor_text", lambda _: found.replace(old, new))
    with pytest.raises(AssertionError):
        test_the_interceptor_does_in_each_state_what_the_core_does(TIMED[-1])


# Text ------------------------------------------------------------------------------------------

_NOT_IN_BOTH = (
    r"\bfunction method\b|\bpredicate method\b",  # 2.3 only
    r"\bghost (function|predicate)\b",  # 4 only
    r"\bassume\b|\{:axiom\}|\{:verify|\{:extern|\binclude\b|/\*",  # nothing is taken on trust
    r"\{:(?!induction false\})",
    r"^\s*(requires|ensures(?! var)|modifies|reads|decreases)\b.*;\s*$",  # an old end of a clause
    r"^(var|const|datatype)\b.*;\s*$",
    r"\bnew;|\binductive\b|\bleast\b|\bcopredicate\b|\bcolemma\b|\bby method\b",
    r"\[[^\]]*\.\.",  # slices of sequences
    r"\bcase \w+\(.*\) => *\{|\bmatch \w+ *\{",
    r"\bforall \w+, \w+ *\||<-",  # other quantifier syntax
)


@pytest.mark.slow
@pytest.mark.parametrize("pattern", _NOT_IN_BOTH)
def test_the_text_keeps_to_what_dafny_2_3_and_4_both_read(pattern: str) -> None:
    for found in _every_text():
        assert not re.search(pattern, re.sub(r"//[^\n]*", "", found), re.MULTILINE)


@cache
def _every_text() -> tuple[str, ...]:
    latching = BINDINGS.replace("[assume]", "latching = true\n\n[assume]")
    return tuple(
        emitted(f"{condition}robot shall {timing.format(n=6)} satisfy q", bindings)
        for bindings in (None, latching, EVENT)
        for timing in TIMINGS
        for condition in CONDITIONS
    )


def test_methods_call_no_function() -> None:
    """A function is ghost in 2.3, so that what runs must not need it."""
    code = emitted("whenever p robot shall within 2 ticks satisfy q")
    functions = re.findall(r"^ *(?:function|predicate) (\w+)", code, re.MULTILINE)
    bodies = re.findall(r"^  (?:method|constructor)[^{]*?\n  \{\n(.*?)^  \}", code, re.M | re.S)
    assert len(bodies) == 5
    for body in bodies:
        assert not set(functions) & set(re.findall(r"\w+", body))


def test_names_that_dafny_cannot_read_are_changed_and_told() -> None:
    found = emitted("whenever (map & x > 3) robot shall satisfy (x >= 3 | bv8)", None)
    assert "datatype Tick = Tick(map_: bool, x_gt_3: bool, x_ge_3: bool, bv8_: bool)" in found
    assert "// map_ is map\n// x_gt_3 is x > 3\n// x_ge_3 is x >= 3\n" in found
    assert "  (x.map_ && x.x_gt_3)\n" in found


def test_a_sentence_that_names_no_proposition_has_a_tick_all_the_same() -> None:
    assert "datatype Tick = Tick(unused: bool)" in emitted("robot shall always satisfy true", None)


@pytest.mark.parametrize(
    ("sentence", "bindings", "reason"),
    [
        (
            "whenever p robot shall within 5 ticks satisfy q",
            None,
            "the bindings have no [interceptor], and the plain form waits for a command to stop",
        ),
        (
            "whenever p robot shall within 5 ticks satisfy q",
            EVENT,
            "the event form waits for a command to stop, so no delay bounds its answer",
        ),
        (
            "whenever p robot shall for 5 ticks satisfy q",
            BINDINGS,
            "it is about answers, and `for 5 ticks` asks for something else",
        ),
        (
            "whenever q robot shall eventually satisfy p",
            BINDINGS,
            "what a stop brings about is `q`, and the response is something else",
        ),
    ],
)
def test_what_cannot_be_shown_of_the_loop_is_left_out_and_said(
    sentence: str, bindings: str | None, reason: str
) -> None:
    found = emitted(sentence, bindings)
    assert f"// Nothing is shown of it:\n// {reason}.\n" in found
    assert "NeverViolated" not in found
    assert "AnsweredInTime" not in found


def test_the_numbers_of_the_bindings_are_in_the_text() -> None:
    found = emitted("whenever p robot shall within 5 ticks satisfy q")
    constants = dict(re.findall(r"const (\w+): (?:int|bool) := (\w+)", found))
    assert constants == {
        "BOUND": "5",
        "HOLD": "4",
        "STOP_TIMEOUT": "24",
        "SCAN_TIMEOUT": "10",
        "COMMAND_TIMEOUT": "0",
        "EVENT_DRIVEN": "false",
        "LATCHING": "false",
        "REACH": "1",  # one tick of latency, less the tick itself, and a lost message
        "BRAKING": "3",  # two ticks, and the one in which it began
    }


@pytest.mark.parametrize(
    ("requests", "reach"),
    [
        ('requests = "edge"\nheartbeat = "250 ms"', "6"),  # two messages, three ticks apart
        ('requests = "level"', "2"),
        ('requests = "edge"', None),
    ],
)
def test_a_lost_message_costs_the_time_to_the_next(requests: str, reach: str | None) -> None:
    bindings = BINDINGS.replace("lost    = 1", f"lost = 2\n{requests}")
    found = emitted("whenever p robot shall eventually satisfy q", bindings)
    declarations = bound(bindings)
    lines = claims(
        requirement("whenever p robot shall eventually satisfy q", declarations), declarations
    )
    if reach is None:
        assert lines[-1].unshown is not None
        assert lines[-1].unshown.endswith("([assume] requests, lost and no heartbeat)")
    else:
        assert f"reach = {reach} ticks ([assume] latency and lost)" in lines[-1].assumptions
        assert lines[-1].sentence.endswith(f"within {int(reach) + 3} ticks, the declared delay")
    assert ("or one from before" in lines[-1].assumptions[1]) == ("edge" in requests)
    assert "AnsweredInTime" in found


def test_a_declared_delay_above_the_bound_is_not_claimed() -> None:
    found = emitted("whenever p robot shall within 3 ticks satisfy q")
    assert "lemma {:induction false} NeverViolated(" in found
    assert "NeverViolatedAsDeclared" not in found


@pytest.mark.parametrize(
    ("sentence", "message"),
    [
        ("in m robot shall satisfy q", "the scope `in` of R1"),
        ("only before m robot shall satisfy q", "the scope `only before` of R1"),
        ("robot shall with probability >= 0.9 eventually satisfy q", "the probability of R1"),
        (
            "when persisted(2, p) robot shall satisfy q",
            "the predicate `persisted`, which refers to other ticks, of R1",
        ),
    ],
)
def test_what_has_no_proof_is_refused(sentence: str, message: str) -> None:
    found = TARGET.refuse(requirement(sentence))
    assert found is not None
    assert render(found).startswith(f"F601 Dafny cannot express {message}\n")


# Golden ----------------------------------------------------------------------------------------


def test_a_whole_file_of_a_deadline(golden: Callable[[str, str], None]) -> None:
    golden("dafny/within.dfy", emitted("whenever p robot shall within 5 ticks satisfy q"))


def test_the_command_writes_the_file(fretc: Callable[..., object], tmp_path: Path) -> None:
    (tmp_path / "bindings.toml").write_text(BINDINGS)
    (tmp_path / "r1.fret").write_text(
        '+++\nid = "R1"\n+++\nwhenever p robot shall within 5 ticks satisfy q\n'
    )
    fretc("r1.fret", "--emit", "dafny")
    project = load(["r1.fret"])
    assert (tmp_path / "build/r1.dfy").read_text() == text(
        project.formalized[0], project.declarations
    )
