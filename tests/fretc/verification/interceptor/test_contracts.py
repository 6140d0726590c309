"""The contracts of an interceptor: the emitted one keeps them, and each mutant breaks its own."""

from dataclasses import replace
from itertools import product
from typing import Any

import pytest

from compiler.logic.claims import ClaimResult, Layer, Proof, proved
from compiler.targets.interceptor_options import options as counted
from compiler.targets.python.interceptor import text
from fretc.verification.interceptor.contracts import contracts
from fretc.verification.interceptor.file import Core, PureCore, core, head
from fretc.verification.interceptor.incoming import COMMAND, RELEASE, RING, SCAN, STOP
from fretc.verification.interceptor.machine import InterceptorMachine, NotAnInterceptorError
from fretish.bindings.declarations import Interception, InterceptorForm
from monitors.interceptor import Options
from tests.each import each
from tests.effort import FULL, some
from tests.loops import interceptor_options, with_match
from tests.proofs import outcome

MS = 1_000_000
NODE = Interception(
    "/stop",
    "/cmd_vel",
    "/wheels",
    "/scan",
    period=50 * MS,
    hold=100 * MS,
    stop_timeout=150 * MS,
    scan_timeout=100 * MS,
    command_timeout=120 * MS,
)
PAPER = Interception("/stop", "/cmd_vel", "/wheels", form=InterceptorForm.EVENT, latching=True)
OPTIONS = Options(2, 3, 2, 3)
EMITTED = text(NODE, "bindings.toml")

FIRST = "initially no stop is in force"
SETS = "each message of the safety function sets the stop or clears it"
LATCHES = "each message of the safety function sets the stop, and no message clears it"
PASSES = "each command is passed on unchanged, or is zero where the robot must stand"
STOPPED = "while a stop is requested nothing but zero is published"
FOR_EVER = "after the first request nothing but zero is ever published"
AT_ONCE = "zero is published at once on a request"
HOLD = (
    "after a request nothing but zero is published up to tick 2 of the timer, and zero at each of "
    "these ticks"
)
SILENCE = (
    "{} ticks of the timer after the last message of {}, and until the next one, nothing but zero "
    "is published"
)
NO_STOP = SILENCE.format(3, "the safety function")
NO_SCAN = SILENCE.format(2, "the sensor")
NO_COMMAND = SILENCE.format(3, "the planner")
NOTHING_ELSE = "nothing but zero and the last command is ever published"
SPEAKS = "at each tick of the timer something is published"
REPEATS = "at a tick without a reason to stand the last command is published"
RANGE = "every number that the core keeps stays between 0 and its bound"
ONLY_THEN = "something is published when a command comes, and at no other time"


def mutant(*changes: tuple[str, str], of: str = EMITTED) -> str:
    for old, new in changes:
        assert of.count(old) == 1, (old, of.count(old))
        of = of.replace(old, new)
    return of


def refuted(proofs: tuple[Proof, ...]) -> set[str]:
    assert all(e.result in ("proved", "counterexample") for e in proofs), proofs[0].result
    return {e.claim for e in proofs if e.result is ClaimResult.COUNTEREXAMPLE}


def reason(text: str, options: Options = OPTIONS) -> str:
    (result,) = {outcome(e) for e in contracts(text, options)}
    assert result.result is ClaimResult.NOT_CHECKED
    return result.detail


def test_the_emitted_interceptor_keeps_every_contract() -> None:
    assert counted(NODE) == OPTIONS
    proofs = contracts(EMITTED, OPTIONS)
    assert [e.claim for e in proofs] == [
        FIRST, SETS, PASSES, STOPPED, AT_ONCE, HOLD, NO_STOP, NO_SCAN, NO_COMMAND,
        NOTHING_ELSE, SPEAKS, REPEATS, RANGE,
    ]  # fmt: skip
    assert {outcome(e) for e in proofs} == {proved("225 states, 1125 steps")}
    assert {e.layer for e in proofs} == {Layer.INTERCEPTOR}
    assert proofs[0].assumptions == (
        "the ROS node passes every message to the core, one at a time, and publishes the core's "
        "output",
        "the timer expires at every period in [interceptor]",
    )


def test_the_papers_interceptor_keeps_its_own() -> None:
    proofs = contracts(text(PAPER, "bindings.toml"), counted(PAPER))
    assert [e.claim for e in proofs] == [
        FIRST, LATCHES, PASSES, STOPPED, FOR_EVER, NOTHING_ELSE, ONLY_THEN, RANGE,
    ]  # fmt: skip
    assert refuted(proofs) == set()
    assert proofs[0].assumptions[1:] == ("silence is not detected: form = event in [interceptor]",)


@pytest.mark.slow
@pytest.mark.parametrize("latching", [False, True])
def test_the_core_keeps_them_with_all_small_options(latching: bool) -> None:
    alone, _, _ = EMITTED.partition("\n\n# The options ")
    for numbers in some(product((0, 1, 2), (0, 2), (0, 1), (0, 2)), 5):
        options = Options(*numbers, latching=latching)
        assert refuted(contracts(alone, options)) == set()


def test_a_channel_that_is_not_watched_is_an_assumption() -> None:
    alone, _, _ = EMITTED.partition("\n\n# The options ")
    (first, *_) = contracts(alone, Options(0, 0, 0, 3))
    assert first.assumptions[2:] == (
        "the safety function is never silent for long: no stop_timeout in [interceptor]",
        "the sensor is never silent for long: no scan_timeout in [interceptor]",
    )


# Places in the text
SCANNED = "    return replace(state, scan_age=0), None"
PASSED = "return after, ZERO if halted(after, options) else command"
CASE = "        case ScanHeard():"
"""With `match`."""
ASKS = "    if isinstance(event, ScanHeard):"
RETURNS = '-> "tuple[State, Velocity | None]":\n'
ABOUT = '    """Process a scan'
GROWS = "stop_age=min(state.stop_age + 1, options.stop_timeout)"
HELD = "held=options.hold if requested else state.held"
WATCH_STOP = "        or expired(state.stop_age, options.stop_timeout)\n"
WATCH_SCAN = "        or expired(state.scan_age, options.scan_timeout)\n"
WATCH_COMMAND = "        or expired(state.command_age, options.command_timeout)\n"
RUNG = "output = ZERO if halted(older, options) else state.command"
ASKED = "return after, ZERO if requested and not options.event_driven else None"
HANDED = "        return hear_command(state, event.command, options)"
PAID = (
    "less = replace(older, held=max(state.held - 1, 0))\n"
    "    output = ZERO if halted(less, options) else state.command"
)


# Mutants --------------------------------------------------------------------------------------

MUTANTS = {
    "forwards while stopped": (
        "        state.stop\n        or state.held",
        "        state.held",
        {PASSES, STOPPED},
    ),
    "forgets the watchdog of the safety function": (WATCH_STOP, "", {PASSES, NO_STOP}),
    "forgets the watchdog of the planner": (WATCH_COMMAND, "", {NO_COMMAND}),
    "forgets the watchdog of the sensor": (WATCH_SCAN, "", {PASSES, NO_SCAN}),
    "holds a tick too short": ("state.held > 0\n", "state.held > 1\n", {PASSES, HOLD}),
    "pays before it says": (RUNG, PAID, {HOLD}),
    "holds a tick too long": (
        HELD,
        "held=options.hold + 1 if requested else state.held",
        {PASSES, REPEATS, RANGE},
    ),
    "a watchdog barks late": (
        "    return timeout > 0 and age >= timeout",
        "    return timeout > 0 and age > timeout",
        {PASSES, NO_STOP, NO_SCAN, NO_COMMAND},
    ),
    "a watchdog never grows older": (GROWS, "stop_age=state.stop_age", {PASSES, NO_STOP}),
    "all is heard at first": (
        "stop_age=options.stop_timeout,\n        scan",
        "stop_age=0,\n        scan",
        {PASSES, NO_STOP},
    ),
    "waits for the tick": (ASKED, "return after, None", {AT_ONCE}),
    "releases what was not": (HELD, "held=options.hold if requested else 0", {PASSES, HOLD}),
    "is stopped at first": ("        stop=False,", "        stop=True,", {FIRST}),
    "passes on the command before": (
        PASSED,
        "return after, ZERO if halted(after, options) else state.command",
        {PASSES, NOTHING_ELSE},
    ),
    "makes up a command": (
        PASSED,
        "return after, ZERO if halted(after, options) else Velocity(1.0)",
        {PASSES, NOTHING_ELSE},
    ),
    "makes up a command at a scan": (
        SCANNED,
        f"{SCANNED[:-4]}ZERO if halted(state, options) else Velocity(9.0)",
        {NOTHING_ELSE},
    ),
    "says nothing when halted": (
        RUNG,
        "output = None if halted(older, options) else state.command",
        {HOLD, SPEAKS},
    ),
    "always stands": (
        "        state.stop\n        or",
        "        True\n        or",
        {PASSES, REPEATS},
    ),
    "counts without an end": (
        GROWS,
        "stop_age=min(state.stop_age + 1, options.stop_timeout + 1)",
        {RANGE},
    ),
}


@pytest.mark.slow
@each("name", some(MUTANTS, 2))
def test_a_mutant_breaks_the_contracts_that_it_should(name: str) -> None:
    """And each counterexample can be replayed."""
    old, new, broken = MUTANTS[name]
    changed = mutant((old, new))
    proofs = contracts(changed, OPTIONS)
    assert refuted(proofs) == broken
    for evidence in proofs:
        if evidence.claim in broken:
            for words, command in replayed(changed, OPTIONS, evidence):
                why = {None: "nothing is published", 0.0: "zero is published"}.get(command)
                assert words == why or (why is None and words.endswith("is published"))


FIELD = "    command_age: int\n"
AT_FIRST = "command_age=options.command_timeout,\n"
OBEYS = "stop=requested or (options.latching and state.stop)"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("first", "then", "sum_"),
    some(
        [
            ("9007199254740992", "9007199254740992.0", "state.odd + 1"),
            ("9007199254740992.0", "9007199254740992", "state.odd + 1"),
            ("Velocity()", "Velocity(0)", "state.odd.vx + 9007199254740993"),
            ("Velocity(0)", "Velocity()", "state.odd.vx + 9007199254740993"),
        ],
        2,
    ),
)
@pytest.mark.parametrize("obeys", [">", "<="])
def test_equal_numbers_that_add_up_differently_are_not_one_state(
    first: str, then: str, sum_: str, obeys: str
) -> None:
    """Whole numbers and floats part beyond 2^53; a scan changes the one into the other."""
    changed = mutant(
        (FIELD, f"{FIELD}    odd: float | Velocity\n"),
        (AT_FIRST, f"{AT_FIRST}        odd={first},\n"),
        (
            SCANNED,
            f"    odd = {then} if state.scan_age == 0 else state.odd\n"
            "    return replace(state, scan_age=0, odd=odd), None",
        ),
        (OBEYS, f"stop=requested and {sum_} {obeys} 9007199254740992"),
    )
    results = {e.claim: e.result for e in contracts(changed, OPTIONS)}
    assert results[SETS] is not ClaimResult.PROVED


def test_zero_in_whole_numbers_is_none() -> None:
    """ROS 2 takes floats alone, and the node would fail when the robot is to stop."""
    whole = mutant((PASSED, "return after, Velocity(0) if halted(after, options) else command"))
    assert {PASSES, STOPPED, NOTHING_ELSE} <= refuted(contracts(whole, OPTIONS))


def test_a_state_has_fields_by_which_states_are_told_apart() -> None:
    """As a NamedTuple it would have none that are looked at."""
    changed = mutant(("@dataclass(frozen=True)\nclass State:", "class State(NamedTuple):"))
    assert reason(changed) == ("fretc cannot read its core: `class State(NamedTuple):`")


def test_a_latch_that_releases_is_told() -> None:
    latching = replace(NODE, latching=True)
    lost = mutant(
        ("stop=requested or (options.latching and state.stop)", "stop=requested"),
        of=text(latching, "b.toml"),
    )
    assert refuted(contracts(lost, counted(latching))) == {LATCHES, FOR_EVER, PASSES}


def replayed(text: str, options: Options, evidence: Proof) -> list[tuple[str, Any]]:
    """What the text says when the run of a counterexample is given to it with true velocities."""
    assert evidence.result is ClaimResult.COUNTEREXAMPLE
    assert evidence.run is not None
    read = core(text)
    assert isinstance(read, Core)
    module = read.module
    state, out = module.initial(module.OPTIONS), []
    for i, action in enumerate(evidence.run.actions):
        event, _, output = action.partition(": ")
        message = {
            STOP: module.StopHeard(True),
            RELEASE: module.StopHeard(False),
            COMMAND: module.CommandHeard(module.Velocity(i + 1.0)),
            SCAN: module.ScanHeard(),
            RING: module.TimerRang(),
        }[event]
        state, command = module.step(state, message, module.OPTIONS)
        out.append((output, None if command is None else command.vx))
    return out


def test_a_counterexample_is_a_shortest_run_that_can_be_replayed() -> None:
    text = mutant((WATCH_SCAN, ""))
    proof = next(e for e in contracts(text, OPTIONS) if e.claim == NO_SCAN)
    assert proof.result is ClaimResult.COUNTEREXAMPLE
    assert proof.detail == "a run of 2 steps breaks it"
    assert proof.run is not None
    assert proof.run.names == (
        "stop requested",
        "must stand",
        "zero",
        "command",
        "stop silent",
        "scan silent",
        "command silent",
    )
    assert proof.run.rows == (
        (False, True, False, False, False, True, True),
        (False, True, False, True, False, True, False),
    )
    assert replayed(text, OPTIONS, proof) == [
        ("nothing is published", None),
        ("the last command is published", 2.0),
    ]


LOOKS = "it reads the content of a command"
MOST = 3000 if FULL else 1000

# What is not checked --------------------------------------------------------------------------


@pytest.mark.slow
@each(
    "case",
    [
        (SCANNED, "    print(state)\n    return state, None", "`print(state)`"),
        (SCANNED, "    state.held = 0\n    return state, None", "`state.held = 0`"),
        (SCANNED, "    global ZERO\n    return state, None", "`global ZERO`"),
        (SCANNED, "    return hear_scan(state, options)", "`hear_scan` calls itself"),
        (SCANNED, "    while True:\n        pass", "`while True:`"),
        (SCANNED, "    return [state for _ in ()], None", "`[state for _ in ()]`"),
        (SCANNED, "    return state.__class__(), None", "`state.__class__()`"),
        (SCANNED, "    return state.command is ZERO, None", "`state.command is ZERO`"),
        (
            "from dataclasses import dataclass, replace",
            "from dataclasses import dataclass, replace\nimport os",
            "`import os`",
        ),
        (
            "from typing import NamedTuple",
            "from typing import NamedTuple, Any",
            "`from typing import NamedTuple, Any`",
        ),
        ("ZERO = Velocity()", "ZERO = Velocity()\nZERO = Velocity(1.0)", "`ZERO = Velocity(1.0)`"),
        ("ZERO = Velocity()", "ZERO = [].pop()", "`ZERO = [].pop()`"),
        ("    held: int\n", "    held: int = print()\n", "`held: int = print()`"),
        ("del sys.path[0]", "del sys.path[:]", "`import sys`"),
        ("ZERO = Velocity()", "ZERO = Velocity(1.0)", "`ZERO = Velocity(1.0)`"),
        ("ZERO = Velocity()", "ZERO = Velocity()\nHOLD = Options(1, 0, 0, 0)", "`HOLD`"),
        (SCANNED, "    return replace(state, held=OPTIONS.hold), None", "`OPTIONS`"),
        (SCANNED, "    return replace(state, scan_age=0 * 2), None", "`0 * 2`"),
        (SCANNED, "    return replace(state, scan_age=(0, 1)[0]), None", "`(0, 1)[0]`"),
        (SCANNED, "    return replace(state, scan_age=abs(0)), None", "`abs(0)`"),
        (SCANNED, "    if state is None:\n        pass\n    return state, None", "`state is None`"),
        (CASE, "        case ScanHeard(__class__=c):", "`ScanHeard(__class__=c)`"),
        (CASE, f"        case None:\n            pass\n{CASE}", "`None`"),
        ("def hear_scan(state: State,", "def hear_scan(state: State, *more: State,", "`def hear"),
        ("class ScanHeard:", "class ScanHeard(metaclass=type):", "`@dataclass"),
        (ASKS, "    if isinstance(state.command, Velocity):", "`isinstance(state.command, Vel"),
        (ASKS, "    if isinstance(event, bool):", "`isinstance(event, bool)`"),
        (ASKS, "    if isinstance(event, (ScanHeard, TimerRang)):", "`isinstance(event, (Scan"),
        (f"{RETURNS}{ABOUT}", f"-> \"print()\":\n{ABOUT}", "`def hear_scan"),
        (f"{RETURNS}{ABOUT}", f"-> \"(\":\n{ABOUT}", "`def hear_scan"),
    ],
)  # fmt: skip
def test_a_core_that_may_not_be_pure_is_not_executed(case: tuple[str, str, str]) -> None:
    """By none of those that explore it."""
    old, new, why = case
    changed = mutant((old, new), of=with_match(EMITTED) if old == CASE else EMITTED)
    if "HOLD" in new:
        changed = mutant((SCANNED, "    return replace(state, held=HOLD.hold), None"), of=changed)
    message = reason(changed)
    assert message.startswith("fretc cannot read its core: ")
    assert why in message or not new
    with pytest.raises(NotAnInterceptorError) as refused:
        InterceptorMachine(changed, interceptor_options())
    assert str(refused.value) == message


@pytest.mark.slow
@each(
    "line",
    [
        "step = print", "def step(*_): pass", "import os as ring", "globals()['step'] = print",
        "OPTIONS = Options(0, 0, 0, 0)", "for halted in (): pass",
        "sys.modules[__name__].step = print", "if (step := print): pass",
    ],
)  # fmt: skip
def test_a_node_that_changes_the_core_is_told(line: str) -> None:
    changed = mutant(("\n\nclass Gate:", f"\n\n{line}\n\nclass Gate:"))
    assert "the node below it" in reason(changed)
    with pytest.raises(NotAnInterceptorError, match="the node below it"):
        InterceptorMachine(changed, interceptor_options())


@pytest.mark.slow
@each(
    "case",
    [
        (PASSED, "return after, ZERO if command == ZERO else command", LOOKS),
        (PASSED, "return after, command if command else ZERO", LOOKS),
        (PASSED, "return after, Velocity(command.vx)", LOOKS),
        (HANDED, "        return hear_command(state, max(event.command, ZERO), options)", LOOKS),
        (
            PASSED,
            f"return replace(after, held=command), {PASSED[14:]}",
            "its state has a command in the place of a number",
        ),
        (SCANNED, "    return state.command", "a step returns no state and command"),
        ("hold=2", "hold=3", "its options differ from the declared options"),
        (SCANNED, "    return replace(state, age=0), None", "a step fails: TypeError"),
        (SCANNED, "    return None", "a step returns no state and command"),
        (GROWS, "stop_age=state.stop_age + 1", f"it has more than {MOST} states"),
        ("    held: int\n", "    hold: int\n", "fretc cannot read its core"),
        ("def halted(", "def halted((", "it is not valid Python"),
    ],
)
def test_where_nothing_can_be_said_the_reason_is(case: tuple[str, str, str]) -> None:
    old, new, why = case
    said_nothing(why, (old, new))


def test_a_core_without_an_event_is_none() -> None:
    asked = "    if isinstance(event, ScanHeard):"
    other = (("class ScanHeard:", "class SensorHeard:"), (asked, asked.replace("Scan", "Sensor")))
    said_nothing("its core has no `ScanHeard`", *other)


def said_nothing(why: str, *changes: tuple[str, str]) -> None:
    (result,) = {outcome(e) for e in contracts(mutant(*changes), OPTIONS, most=MOST)}
    assert result.result is ClaimResult.NOT_CHECKED
    assert result.detail.startswith(why)


def test_the_core_ends_where_the_node_begins() -> None:
    core = head(EMITTED)
    assert isinstance(core, PureCore)
    assert EMITTED.startswith(core.text)
    assert core.text.rstrip().endswith("# latching = false\n)")
    assert head(core.text) == core


def test_a_text_that_is_no_interceptor_is_not_checked() -> None:
    assert reason("") != ""
    assert reason("\0") != ""
    assert reason(EMITTED.replace("OPTIONS = Options(", "NUMBERS = Options(", 1)) == (
        "its core has no `OPTIONS`"
    )
    timed = Options(1, 0, 0, 0, event_driven=True)
    assert reason(EMITTED, timed).startswith("an interceptor without a timer")
