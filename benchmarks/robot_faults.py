"""Which faults of the interceptor and of the safety function tests from requirements find.

The requirements say what each must do, tick by tick. Of a run of a suite only the inputs are
used: the program answers, and monitors of all its requirements judge what came of it. The suite of
`fretc test` stands beside random inputs of the same lengths, and beside a suite like FLIP's.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cache
from types import SimpleNamespace
from typing import Any

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.targets.python import monitor as monitors
from fretc.analysis.arena.budget import Budget
from fretc.campaigns.experiment import SafetyFunction, interceptor_text, monitor_text
from fretc.testing.assembly import jobs
from fretc.testing.requirement_model import RequirementModel
from fretc.testing.words import Naming, judged, word
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from monitors.interceptor import Options
from monitors.kernel.verdicts import VIOLATED
from monitors.loading import executed, load
from tests.requirement_sets import requirement

Row = Mapping[str, Any]
"""Values of the inputs at a tick; then of the outputs, too."""
Run = Sequence[Row]
Program = Callable[[Row], Row]
"""One tick: inputs to outputs."""
WARM_UP = 6
"""Ordinary ticks before each run of each suite."""
SEEDS = 20
"""Random suites."""


@dataclass(frozen=True, slots=True)
class Fault:
    """A change of a text."""

    words: str
    before: str
    after: str


@dataclass(frozen=True, slots=True)
class Subject:
    """What is tested."""

    name: str
    requirements: Sequence[str]
    faults: Sequence[Fault]
    texts: Callable[[], tuple[str, ...]]
    """In which the faults are put."""
    start: Callable[[tuple[str, ...]], Program]
    usual: Row
    """Inputs that a sentence does not name: those of an ordinary tick. A few such come first."""


# The interceptor --------------------------------------------------------------------------------

OPTIONS = Options(hold=4, stop_timeout=24, scan_timeout=0, command_timeout=10)
"""Ticks of 50 ms: those of `requirements/mission`."""
_STOP = "stop=requested or (options.latching and state.stop),"
_HELD = "held=options.hold if requested else state.held,"
_PASSED = "return after, ZERO if halted(after, options) else command"
_RUNG = "output = ZERO if halted(older, options) else state.command"
_HALTED = "        or expired(state.{0}_age, options.{0}_timeout)\n"


def _gate(texts: tuple[str, ...]) -> Program:
    """The emitted node; in a tick it hears a release, a request and a command, then its timer."""
    module = executed(texts[0], "interceptor.py")
    module.OPTIONS = module.Options(**asdict(OPTIONS))
    said: list[Any] = []
    gate = module.Gate(said.append)
    number = last = 0

    def tick(row: Row) -> Row:
        nonlocal number, last
        said.clear()
        number += 1
        if row.get("release"):
            gate.hear_stop(SimpleNamespace(data=False))
        if row.get("request"):
            gate.hear_stop(SimpleNamespace(data=True))
        if row.get("command"):
            last = number
            still = SimpleNamespace(x=0.0, y=0.0, z=0.0)
            gate.hear_command(
                SimpleNamespace(
                    linear=SimpleNamespace(x=float(number), y=0.0, z=0.0), angular=still
                )
            )
        gate.ring()
        zero = all(not any(each) for each in said)
        return {"zero": zero, "passed": all(each[0] == last for each in said)}

    return tick


INTERCEPTOR = Subject(
    "interceptor",
    (
        "whenever request the gate shall immediately satisfy zero",
        "whenever request the gate shall for 3 ticks satisfy zero",
        "whenever request the gate shall until release satisfy zero",
        "whenever persisted(0, 20, !request) & occurred(0, 20, release) & occurred(0, 8, command) "
        "the gate shall immediately satisfy passed",
        "whenever persisted(0, 9, !command) the gate shall immediately satisfy zero",
        "whenever persisted(0, 23, !request & !release) the gate shall immediately satisfy zero",
    ),
    (
        Fault("requests are ignored", _STOP, "stop=options.latching and state.stop,"),
        Fault("the first stop is for ever", _STOP, "stop=requested or state.stop,"),
        Fault("requests and releases are confused", _STOP, "stop=not requested,"),
        Fault("no hold", _HELD, "held=0,"),
        Fault("the hold is a tick short", _HELD, _HELD.replace("options.hold", "options.hold - 1")),
        Fault("the hold is half", _HELD, _HELD.replace("options.hold", "options.hold // 2")),
        Fault("a release ends the hold", _HELD, "held=options.hold if requested else 0,"),
        Fault(
            "only a first request is held",
            _HELD,
            _HELD.replace("requested", "requested and not state.stop"),
        ),
        Fault("a command passes while stopped", _PASSED, "return after, command"),
        Fault("the timer speaks while stopped", _RUNG, "output = state.command"),
        Fault(
            "the latch of a stop is lost",
            "        state.stop\n        or state.held",
            "        state.held",
        ),
        Fault("the hold does not halt", "        or state.held > 0\n", ""),
        Fault("silence of the planner is not noticed", _HALTED.format("command"), ""),
        Fault("silence of the safety function is not noticed", _HALTED.format("stop"), ""),
        Fault(
            "a command does not wake the watchdog",
            "command=command, command_age=0",
            "command=command",
        ),
        Fault("a release does not wake the watchdog", "        stop_age=0,\n", ""),
        Fault(
            "watchdogs never run out",
            "timeout > 0 and age >= timeout",
            "timeout > 0 and age > timeout",
        ),
        Fault(
            "watchdogs run out a tick early",
            "timeout > 0 and age >= timeout",
            "timeout > 0 and age >= timeout - 1",
        ),
        Fault("the planner's time counts double", "state.command_age + 1", "state.command_age + 2"),
        Fault(
            "the safety function's time counts double", "state.stop_age + 1", "state.stop_age + 2"
        ),
        Fault(
            "the command before is passed on",
            _PASSED,
            _PASSED.replace("else command", "else state.command"),
        ),
        Fault("the hold counts double", "max(state.held - 1, 0)", "max(state.held - 2, 0)"),
    ),
    lambda: (interceptor_text(),),
    _gate,
    {"command": True, "release": True},
)

# The safety function ----------------------------------------------------------------------------

BINDINGS = """
[clock]
tick = "100 ms"
[signal.clearance]
path = "/clearance.data"
type = "std_msgs/Float64"
unit = "m"
max_age = "300 ms"
[signal.speed]
path = "/speed.data"
type = "std_msgs/Float64"
unit = "m/s"
max_age = "300 ms"
[proposition.too_close]
expr = "clearance < 5 cm"
role = "input"
agg = "any"
[proposition.stopped]
expr = "abs(speed) < 0.01 m/s"
role = "output"
agg = "last"
"""
TICK = 100_000_000
_SINCE = "since_1 = too_close and not_stopped or not_stopped and since_1"


def _safety(texts: tuple[str, ...]) -> Program:
    """The safety function that the simulated robot has, over its own bindings."""
    text, bindings = texts
    declared, mistakes = read_bindings(Source("bindings.toml", bindings))
    assert declared is not None, mistakes
    function, time = SafetyFunction(text, declared), 0

    def tick(row: Row) -> Row:
        nonlocal time
        time += TICK
        function.hear("/clearance", SimpleNamespace(data=float(row["clearance"])), time)
        speed = 0.0 if row.get("standing") else 0.3
        function.hear("/speed", SimpleNamespace(data=speed), time)
        return {"demand": function.step(time)}

    return tick


SAFETY = Subject(
    "safety function",
    (
        "whenever clearance < 0.05 the safety shall immediately satisfy demand",
        "whenever clearance < 0.05 & !standing the safety shall until standing satisfy demand",
        "whenever clearance >= 0.05 & standing the safety shall immediately satisfy !demand",
        "whenever clearance >= 0.05 & !preBool(false, demand) the safety shall immediately satisfy "
        "!demand",
    ),
    (
        Fault("the threshold is 4 cm", "clearance < 5 cm", "clearance < 4 cm"),
        Fault("the threshold is 6 cm", "clearance < 5 cm", "clearance < 6 cm"),
        Fault("5 cm is too close already", "clearance < 5 cm", "clearance <= 5 cm"),
        Fault("near and far are confused", "clearance < 5 cm", "clearance > 5 cm"),
        Fault("0.5 m/s counts as standing", "< 0.01 m/s", "< 0.5 m/s"),
        Fault("a stop is never demanded again", "too_close and not_stopped or not_stopped and", ""),
        Fault("the demand is not remembered", _SINCE, "since_1 = too_close and not_stopped"),
        Fault(
            "the demand is never taken back",
            _SINCE,
            "since_1 = too_close and not_stopped or since_1",
        ),
        Fault("the demand ends where it is far again", _SINCE, f"{_SINCE} and too_close"),
    ),
    lambda: (monitor_text(), BINDINGS),
    _safety,
    {"clearance": 0.5},
)


# Suites -----------------------------------------------------------------------------------------


def requirements(subject: Subject) -> list[FormalizedRequirement]:
    """Its requirements."""
    return [requirement(f"Q{number}", text) for number, text in enumerate(subject.requirements, 1)]


def ours(subject: Subject) -> list[Run]:
    """The suite of `fretc test`."""
    batches = [
        batch
        for each in requirements(subject)
        for job in jobs([each], (), 60)
        for batch in job.ask(())
    ]
    return [
        [{**subject.usual, **_numbers(row.values)} for row in test.rows for _ in range(row.count)]
        for batch in batches
        for test in batch.tests
    ]


def by_flips(subject: Subject) -> list[Run]:
    """For each atom a shortest accepted word that one flip of it makes a rejected one."""
    runs = list[Run]()
    for each in requirements(subject):
        for atom in each.watched:
            bench = RequirementModel(each, (), (), Budget(60))
            found = bench.dependence(bdd.true(), atom, ())
            if found is None:
                continue
            letters, tick = found
            naming = Naming(each.watched, each.watched, {}, {})
            made = word(letters, bench.alphabet, naming)
            rows = [dict(row.values) for row in made.rows for _ in range(row.count)]
            if not judged(each, made).accepted >> made.ticks - 1 & 1:
                rows[tick] = {**rows[tick], atom: not rows[tick][atom], "clearance": None}
            runs.append([{**subject.usual, **_numbers(row)} for row in rows])
    return runs


def at_random(lengths: Sequence[int], seed: int) -> list[Run]:
    """Inputs by chance, in runs as long as those."""
    drawn = random.Random(seed)
    return [
        [
            {
                **{
                    name: drawn.random() < 0.5
                    for name in ("request", "release", "command", "standing")
                },
                "clearance": drawn.uniform(0.0, 0.1),
            }
            for _ in range(ticks)
        ]
        for ticks in lengths
    ]


def _numbers(values: Row) -> Row:
    """With a clearance, where only its comparison is said."""
    row = {name: value or False for name, value in values.items() if name != "clearance"}
    near = row.get("(clearance < 0.05)", not row.get("(clearance >= 0.05)", True))
    number = values.get("clearance")
    if number is None and not any(name.startswith("(clearance") for name in values):
        return row
    return {**row, "clearance": (0.02 if near else 0.5) if number is None else float(number)}


# Judgement --------------------------------------------------------------------------------------


@cache
def _monitors(subject_name: str) -> list[Any]:
    subject = next(each for each in SUBJECTS if each.name == subject_name)
    return [load(each.id, monitors.text(each)) for each in requirements(subject)]


def is_found(subject: Subject, texts: tuple[str, ...], runs: Sequence[Run]) -> bool:
    """Whether a requirement is violated in some run of a program."""
    judges = _monitors(subject.name)
    for run in runs:
        program = subject.start(texts)
        for judge in judges:
            judge.reset()
        for inputs in (*[subject.usual] * WARM_UP, *run):
            row = _seen(inputs, program(inputs))
            for judge in judges:
                judge.advance([tuple(bool(row.get(name, False)) for name in judge.PROPOSITIONS)])
                if judge.verdicts()[0] == VIOLATED:
                    return True
    return False


def _seen(inputs: Row, outputs: Row) -> Row:
    number = inputs.get("clearance", 1.0)
    near = {"(clearance < 0.05)": number < 0.05, "(clearance >= 0.05)": number >= 0.05}
    return {**inputs, **near, **outputs}


def changed(texts: tuple[str, ...], fault: Fault) -> tuple[str, ...]:
    """The texts with a fault in them; a doubled line has it twice."""
    assert any(fault.before in text for text in texts), fault.words
    return tuple(text.replace(fault.before, fault.after) for text in texts)


SUBJECTS = (INTERCEPTOR, SAFETY)


def main() -> None:
    """A line for each fault, and the sums."""
    for subject in SUBJECTS:
        texts, own, flips = subject.texts(), ours(subject), by_flips(subject)
        lengths = [len(run) for run in own]
        chance = [at_random(lengths, seed) for seed in range(SEEDS)]
        for runs in (own, flips, *chance):
            assert not is_found(subject, texts, runs), "the program itself is accused"
        print(f"{subject.name}: {len(own)} tests of {sum(lengths)} ticks")
        print(f"  by flips: {len(flips)} of {sum(map(len, flips))}; random: {SEEDS} suites")
        sums = [0, 0, 0.0]
        for fault in subject.faults:
            wrong = changed(texts, fault)
            found = (
                is_found(subject, wrong, own),
                is_found(subject, wrong, flips),
                sum(is_found(subject, wrong, runs) for runs in chance) / SEEDS,
            )
            sums = [a + b for a, b in zip(sums, found, strict=True)]
            print(f"  {fault.words:<48} {_yes(found[0])} {_yes(found[1])} {found[2]:5.0%}")
        total = f"{sums[0]} found, by flips {sums[1]}, random {sums[2]:.1f}"
        print(f"  {len(subject.faults)} faults: {total}\n")


def _yes(is_so: bool) -> str:
    return "yes" if is_so else "no "


if __name__ == "__main__":
    main()
