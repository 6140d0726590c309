"""Exploration of the closed loop: a shortest violation, an endless one, a stop that stays.

All of it is reachability in a finite graph (`fretc.verification.loop.model`); Spot searches for
endless runs, and without it no claim about them is checked. The code replays each run before a
result contains it.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import assert_never

from compiler.logic import formula as f
from compiler.logic import spot
from compiler.logic.claims import ClaimOutcome, ClaimTrace, not_checked, proved, refuted, vacuous
from compiler.logic.kripke import Explored, ModelTooLargeError, check, explore
from compiler.logic.orders import Exclusion
from fretc.verification.interceptor.machine import InterceptorMachine, NotAnInterceptorError
from fretc.verification.loop.actuation_model import ActuationAssumptions, ActuationModel
from fretc.verification.loop.model import Environment, Loop, LoopTick, Node
from fretc.verification.loop.replay import LoadedMonitor, moments, replayed
from fretc.verification.monitor.machine import Stepped
from fretc.verification.monitor.text_check import strange
from fretish.classes.frozen import dataclass
from monitors.interceptor import Options
from monitors.loading import load

MOST_ATOMS = 8
"""Maximum number of propositions, each of which doubles the valuations of a tick."""
LONGEST = 250
"""Maximum bound in ticks for Spot, which expands bounds."""

_HALT, _TRIGGER = f.Atom("_halt_"), f.Atom("_trigger_")  # These are not names of FRETish.
RELEASE = f.implies(
    f.eventually(f.globally(f.not_(_TRIGGER))), f.eventually(f.globally(f.not_(_HALT)))
)


@dataclass(frozen=True, slots=True)
class Case:
    """Everything on which the search depends: code and numbers."""

    requirement: str
    formula: f.Formula
    """Future-time formula on infinite traces."""
    safety: str
    """Text of the monitor that requests stops."""
    observer: str
    """Text of the monitor that detects violations."""
    interceptor: str
    settings: Options
    channel: ActuationAssumptions
    stands: str
    limit: int = 10**6
    """Maximum number of states of the exploration."""
    excluded: tuple[Exclusion, ...] = ()
    """Combinations of propositions that cannot occur."""


@dataclass(frozen=True, slots=True)
class Results:
    """The results of both claims."""

    kept: ClaimOutcome
    released: ClaimOutcome


class NotALoopError(Exception):
    """The case cannot be explored; the message gives the reason."""


def search(case: Case) -> Results:
    """Search for a violation, then for an endless one, then for a stop that stays."""
    try:
        parts = Parts.of(case)
        reached = reach(parts.loop, case.limit)
        visible = frozenset(() if is_safety(case.formula) else f.atoms(case.formula))
        runs = LoopRuns.of(parts.loop, visible | {_TRIGGER.name, _HALT.name}, case.limit)
        return Results(
            _requirement_result(case, parts, reached, runs), _release_result(parts, runs)
        )
    except (NotALoopError, NotAnInterceptorError) as error:
        return Results(not_checked(str(error)), not_checked(str(error)))
    except ModelTooLargeError as error:
        return Results(not_checked(str(error)), not_checked(str(error)))


# Parts ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Parts:
    """The loaded code."""

    loop: Loop
    safety: LoadedMonitor
    observer: LoadedMonitor

    @classmethod
    def of(cls, case: Case, drive: ActuationModel | None = None) -> Parts:
        """The loaded parts of a case.

        Args:
            case: the case.
            drive: actuation model of another case with the same interceptor, settings and channel;
                None: a new one.

        Raises:
            NotALoopError, NotAnInterceptorError: a text cannot be used.
        """
        assert drive is None or drive.channel == case.channel
        same = case.safety == case.observer
        observer, safety = (watched(t, case.requirement) for t in (case.observer, case.safety))
        watching, requesting = observer.fresh(), safety.fresh()
        names = (*f.atoms(case.formula), *watching.PROPOSITIONS, *requesting.PROPOSITIONS)
        atoms = tuple(dict.fromkeys(names))
        if case.stands not in atoms:
            raise NotALoopError(f"the monitor does not read `{case.stands}`")
        if len(atoms) > MOST_ATOMS:
            raise NotALoopError(f"{len(atoms)} propositions, more than {MOST_ATOMS}")
        loop = Loop(
            Stepped(requesting, safety.place, atoms),
            None if same else Stepped(watching, observer.place, atoms),
            drive or new_drive(case),
            Environment(atoms, case.stands, case.excluded),
        )
        return cls(loop, safety, observer)


def new_drive(case: Case) -> ActuationModel:
    """The actuation model of a case.

    Raises:
        NotAnInterceptorError: the text of its interceptor cannot be used.
    """
    machine = InterceptorMachine(case.interceptor, case.settings, case.limit)
    return ActuationModel(machine, case.channel)


@lru_cache(maxsize=8)
def watched(text: str, requirement: str) -> LoadedMonitor:
    """A monitor of the requirement; only a text in the layout of fretc is executed.

    The result is cached, because a requirement is examined with several channels.
    """
    reason = strange(text)
    if reason is not None:
        raise NotALoopError(f"of the monitor: {reason}")
    monitor = load("monitor", text)
    places = [i for i, each in enumerate(monitor.REQUIREMENTS) if each.id == requirement]
    if not places:
        raise NotALoopError("the monitor is for other requirements")
    return LoadedMonitor(text, places[0])


# Finite runs ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Exploration:
    """Result of an exploration: its size, and a shortest run to a violation, if any."""

    states: int
    steps: int
    violation: tuple[tuple[LoopTick, Node], ...] | None
    triggered: bool
    moved: bool
    """Whether the robot can be sampled while it moves."""


def reach(loop: Loop, limit: int) -> Exploration:
    """All states, breadth first, up to the first violation.

    Raises:
        ModelTooLargeError: there are more states than the limit.
    """
    index = loop.environment.atoms.index(loop.environment.stands)
    came: dict[Node, tuple[Node, LoopTick] | None] = {loop.initial: None}
    waiting, visited = [loop.initial], set[Node]()
    steps, triggered, moved = 0, False, False
    for node in waiting:
        for tick, begun in loop.begins(node):
            triggered |= tick.triggered
            moved |= not tick.letter[index]
            if tick.violated:
                run = (*_way(came, node), (tick, next(loop.ends(begun))))
                return Exploration(len(came), steps, run, triggered, moved)
            if begun in visited:
                continue
            visited.add(begun)
            for after in loop.ends(begun):
                steps += 1
                if after not in came:
                    if len(came) >= limit:
                        raise ModelTooLargeError(limit)
                    came[after] = node, tick
                    waiting.append(after)
    return Exploration(len(came), steps, None, triggered, moved)


def _way(
    came: dict[Node, tuple[Node, LoopTick] | None], node: Node
) -> tuple[tuple[LoopTick, Node], ...]:
    way: list[tuple[LoopTick, Node]] = []
    while (back := came[node]) is not None:
        before, tick = back
        way.append((tick, node))
        node = before
    return tuple(reversed(way))


def _requirement_result(
    case: Case, parts: Parts, reached: Exploration, runs: LoopRuns
) -> ClaimOutcome:
    if reached.violation is not None:
        trace, violated = as_table(parts, reached.violation)
        assert violated, "the code does not violate what the model violates"
        ticks = len(trace.rows)
        return refuted(f"violated at tick {ticks - 1}; no shorter run shows it", trace)
    looked = f"{reached.states:,} states, {reached.steps:,} steps"
    if not reached.triggered:
        return vacuous(f"no demand ever begins ({looked})")
    if not reached.moved:
        return vacuous(f"the robot never moves ({looked})")
    if is_safety(case.formula):
        return proved(looked)
    if f.longest_bound(case.formula) > LONGEST:
        return not_checked(f"no finite run violates it; Spot is not asked above {LONGEST} ticks")
    if not spot.is_installed():
        return not_checked(f"no finite run violates it; for endless ones {spot.ABSENT}")
    lasso = _lasso(parts, runs, case.formula)
    if lasso is None:
        return proved(f"{looked}; Spot finds no endless run that violates it")
    return refuted("the demanded response never comes: the last ticks repeat for ever", lasso)


def _release_result(parts: Parts, runs: LoopRuns) -> ClaimOutcome:
    if not any(_HALT.name in label for label in runs.explored.kripke.labels):
        return vacuous("no stop is ever in force")
    if not spot.is_installed():
        return not_checked(spot.ABSENT)
    lasso = _lasso(parts, runs, RELEASE)
    if lasso is None:
        return proved("Spot finds no endless run that violates it")
    return refuted("the stop is never released: the last ticks repeat for ever", lasso)


def as_table(
    parts: Parts, run: tuple[tuple[LoopTick, Node], ...], cycle: int | None = None
) -> tuple[ClaimTrace, bool]:
    """The run as a table, replayed by the code; and whether it violates the requirement."""
    visible = moments(parts.loop, parts.loop.initial, run)
    return replayed(visible, parts.safety, parts.observer, parts.loop, cycle)


# Endless runs ---------------------------------------------------------------------------------

Labelled = tuple[frozenset[str], Node]
"""A state of a Kripke structure: the atoms of the last tick, and the node of the loop."""


@dataclass(frozen=True, slots=True)
class LoopRuns:
    """All runs, also beyond violations, from before the first tick on."""

    loop: Loop
    visible: frozenset[str]
    """Atoms that distinguish states."""
    explored: Explored[Labelled]

    @classmethod
    def of(cls, loop: Loop, visible: frozenset[str], limit: int) -> LoopRuns:
        """The runs; raises ModelTooLargeError if there are more states than the limit."""
        ends: dict[tuple[frozenset[str], Node], tuple[Labelled, ...]] = {}

        def successors(state: Labelled) -> Iterator[Labelled]:
            begun = ((_true(loop, tick) & visible, begun) for tick, begun in loop.begins(state[1]))
            for key in dict.fromkeys(begun):
                if key not in ends:
                    ends[key] = tuple(_labelled(loop, *key))
                yield from ends[key]

        start: Labelled = (frozenset(), loop.initial)
        return cls(loop, visible, explore(start, successors, lambda state: state[0], limit))

    def tick(self, before: Node, label: frozenset[str], after: Node) -> LoopTick:
        """One of the ticks that lead from one state to the next."""
        return next(
            tick
            for tick, begun in self.loop.begins(before)
            if (label, after) in _labelled(self.loop, _true(self.loop, tick) & self.visible, begun)
        )


def _lasso(parts: Parts, runs: LoopRuns, formula: f.Formula) -> ClaimTrace | None:
    """An endless run that violates the formula from tick 0 on; None: there is none."""
    lasso = check(runs.explored.kripke, f.next_(formula))
    if lasso is None:
        return None
    run: list[tuple[LoopTick, Node]] = []
    before = parts.loop.initial
    for label, after in (runs.explored.states[number] for number in lasso.states[1:]):
        run.append((runs.tick(before, label, after), after))
        before = after
    trace, _ = as_table(parts, tuple(run), len(lasso.prefix) - 1)
    return trace


def _true(loop: Loop, tick: LoopTick) -> frozenset[str]:
    true = {name for name, value in zip(loop.environment.atoms, tick.letter, strict=True) if value}
    return frozenset({*true, _TRIGGER.name} if tick.triggered else true)


def _labelled(loop: Loop, true: frozenset[str], begun: Node) -> Iterator[Labelled]:
    """States at the end of a tick with this beginning, with these atoms."""
    halted = true | {_HALT.name}
    for after in loop.ends(begun):
        blocks = loop.interceptor.blocks_commands(after.wheels.interceptor)
        yield halted if blocks else true, after


def is_safety(formula: f.Formula, positive: bool = True) -> bool:
    """Whether the syntax shows that each violation has a finite prefix that proves it.

    Source: Sistla, Safety, liveness and fairness in temporal logic, FAC 6 (1994), section 3.
    """
    match formula:
        case f.Const() | f.Atom():
            return True
        case f.Not(arg):
            return is_safety(arg, not positive)
        case f.And(args) | f.Or(args):
            return all(is_safety(arg, positive) for arg in args)
        case f.Implies(left, right):
            return is_safety(left, not positive) and is_safety(right, positive)
        case f.Xor(left, right) | f.Iff(left, right):
            return all(is_safety(arg, way) for arg in (left, right) for way in (False, True))
        case f.Next(arg):
            return is_safety(arg, positive)
        case f.Eventually(arg, ahead):
            return (ahead.hi is not None or not positive) and is_safety(arg, positive)
        case f.Globally(arg, ahead):
            return (ahead.hi is not None or positive) and is_safety(arg, positive)
        case f.Until(left, right):
            return not positive and all(is_safety(arg, positive) for arg in (left, right))
        case f.Release(left, right):
            return positive and all(is_safety(arg, positive) for arg in (left, right))
        case (
            f.Last()
            | f.Previous()
            | f.WeakPrevious()
            | f.Once()
            | f.Historically()
            | f.Since()
            | f.ProbabilityBound()
        ):
            return False
        case _:
            assert_never(formula)
