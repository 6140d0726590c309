"""Verdict of a component, and its conflicts if it is unrealizable."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import field, replace

from compiler.files.records import replace as altered
from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.components import without_inputs
from fretc.analysis.controllers.circuit import Circuit, circuit
from fretc.analysis.controllers.files import ControllerFormat
from fretc.analysis.controllers.machine import NoMachineError, machine
from fretc.analysis.controllers.moves import Mealy, mealy
from fretc.analysis.findings import Component, Conflict, OpenQuestion, RealizabilityVerdict
from fretc.analysis.games.cores import Members, cores, minimal
from fretc.analysis.games.game_traces import Counterstrategy, NoPlayError
from fretc.analysis.games.replay import broken
from fretc.analysis.games.switches import switched
from fretc.analysis.realizability_problem import RealizabilityProblem, stage
from fretc.analysis.reasons import because, listed
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Completeness:
    """All minimal conflicts among these requirements were found."""

    requirements: tuple[str, ...]


def verdict(
    setting: RealizabilityProblem, budget: Budget
) -> tuple[Component, RealizabilityProblem]:
    """Whether the requirements of a component are realizable, and the problem that decides it.

    If the answer depends on numbers of earlier ticks, more and more of them are stored.
    """
    answer, why = _answer(setting, budget)
    there = setting
    while answer is RealizabilityVerdict.NOT_CHECKED and _has_room(budget):
        try:
            finer = there.finer(budget)
        except (UnsupportedError, OutOfTimeError):
            break
        if finer is None:
            break
        there = finer
        found, because_ = _answer(there, budget)
        if found is not RealizabilityVerdict.NOT_CHECKED:
            answer, why, setting = found, because_, there
    if answer is RealizabilityVerdict.NOT_CHECKED:
        alone = without_inputs(setting.requirements, setting.roles)
        some = [*setting.parts, *([alone] if 0 < len(alone) < len(setting.requirements) else [])]
        lost = next(_lost_parts(setting, some, budget), None)
        if lost is not None:
            ids = [requirement.id for requirement in lost.requirements]
            which = listed(ids) if len(ids) <= _MOST_NAMES else f"{len(ids)} of them"
            answer, why = RealizabilityVerdict.UNREALIZABLE, f"the environment wins against {which}"
    spent = round(budget.spent, 3)
    return component(setting.requirements, setting.roles, answer, why, spent), setting


def _lost_parts(
    setting: RealizabilityProblem, some: Iterable[Sequence[FormalizedRequirement]], budget: Budget
) -> Iterator[RealizabilityProblem]:
    """Problems of some of the requirements that the environment certainly wins."""
    try:
        _check_assumptions(setting, budget)
        for each in some:
            part = setting.part(each, budget)
            if _answer(part, budget)[0] is RealizabilityVerdict.UNREALIZABLE:
                yield part
    except (UnsupportedError, OutOfTimeError):
        return


_MOST_NAMES = 4


def _has_room(budget: Budget) -> bool:
    """Whether there is time to store more; each refinement takes several times as long."""
    return budget.spent < budget.seconds / 8


def _answer(setting: RealizabilityProblem, budget: Budget) -> tuple[RealizabilityVerdict, str]:
    try:
        return _verdict(setting, budget)
    except (UnsupportedError, OutOfTimeError) as error:
        return RealizabilityVerdict.NOT_CHECKED, str(error)


def component(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    answer: RealizabilityVerdict,
    why: str,
    seconds: float = 0.0,
) -> Component:
    """A component with its verdict."""
    names = (
        name
        for requirement in requirements
        for name in requirement.variables
        if roles.get(name) is Role.OUTPUT
    )
    ids = tuple(requirement.id for requirement in requirements)
    return Component(ids, tuple(dict.fromkeys(names)), answer, why, seconds)


def _verdict(setting: RealizabilityProblem, budget: Budget) -> tuple[RealizabilityVerdict, str]:
    """The verdict with its reason."""
    _check_assumptions(setting, budget)
    if not _is_lost(setting, [counter.id for counter in setting.arena.counters], budget):
        uncertainty = setting.left_out or setting.of_outputs
        if uncertainty is None:
            return RealizabilityVerdict.REALIZABLE, "the system has a strategy"
    else:
        uncertainty = setting.of_inputs
        if uncertainty is None:
            return RealizabilityVerdict.UNREALIZABLE, "the environment wins"
        generous, ids = (
            setting.generous(budget),
            [requirement.id for requirement in setting.requirements],
        )
        if generous.of_inputs is None and _is_lost(generous, ids, budget):
            return RealizabilityVerdict.UNREALIZABLE, f"the environment wins, {_WHATEVER}"
        answer = _unrolled(setting, budget) if generous is not setting else None
        if answer is not None:
            return answer
    return RealizabilityVerdict.NOT_CHECKED, uncertainty


_WHATEVER = "whatever the unknown values are"


def _unrolled(
    setting: RealizabilityProblem, budget: Budget
) -> tuple[RealizabilityVerdict, str] | None:
    """Verdict without inputs: a satisfying run, or proof that there is none."""
    from fretc.analysis.games.lassos import NoShortRun, lasso

    chosen = [
        setting.roles.get(name)
        for requirement in setting.requirements
        for name in requirement.variables
    ]
    is_certain = setting.left_out is None and setting.of_outputs is None
    if not is_certain or setting.assumptions or Role.INPUT in chosen:
        return None
    found = lasso(setting.requirements, setting.roles, budget, as_fret=setting.as_fret)
    if found is None:
        return None
    if isinstance(found, NoShortRun):
        return (
            RealizabilityVerdict.UNREALIZABLE,
            f"no run of {found.ticks} ticks satisfies all of them",
        )
    run = f"a run of {len(found.numbers)} ticks that repeats itself from tick {found.loop} on"
    return RealizabilityVerdict.REALIZABLE, f"there are no inputs, and {run} satisfies all of them"


def _is_lost(setting: RealizabilityProblem, ids: Sequence[str], budget: Budget) -> bool:
    """Whether the environment wins against some requirements."""
    there = setting.close(ids, budget)
    return not there.game(there.counters(ids), budget).solution().is_realizable


def strategy(
    setting: RealizabilityProblem, budget: Budget, *, number: int, form: ControllerFormat
) -> Iterator[Circuit | Mealy | OpenQuestion]:
    """The controller of a realizable component.

    Args:
        setting: problem of the component.
        budget: time limit.
        number: number of the component.
        form: output form of the controller.
    """
    ids = tuple(requirement.id for requirement in setting.requirements)
    try:
        game = setting.game(setting.arena.counters, budget)
        controller = machine(game, game.solution(), budget)
        if form is ControllerFormat.PYTHON:
            yield circuit(controller, ids, number)
        else:
            yield mealy(controller, ids, budget)
    except (UnsupportedError, NoMachineError, OutOfTimeError) as error:
        yield OpenQuestion(f"how can {', '.join(ids)} be satisfied?", str(error))


def _check_assumptions(setting: RealizabilityProblem, budget: Budget) -> None:
    """Raise UnsupportedError if no run satisfies the assumptions: every result would follow."""
    if not setting.assumptions:
        return
    runs = setting.runs((), budget)
    if not runs.is_possible():
        ids = ", ".join(assumption.id for assumption in setting.assumptions)
        raise UnsupportedError(f"no run satisfies the assumptions {ids}")


def conflicts(
    setting: RealizabilityProblem, budget: Budget
) -> Iterator[Conflict | Completeness | OpenQuestion]:
    """Every minimal conflict; at the end an open question if there may be more.

    With unknown values, a conflict is certain if the environment wins for all of them; it is
    certainly minimal if the environment does not win with fewer requirements even when favoured. If
    neither is certain, more about numbers is stored.
    """
    question = (
        "which others of "
        f"{', '.join(requirement.id for requirement in setting.requirements)} conflict"
    )
    shown: set[tuple[str, ...]] = set()
    found = _Fights(setting, setting)
    try:
        _check_assumptions(setting, budget)
        there: RealizabilityProblem | None = setting
        while there is not None:
            now = _Fights(there, there.generous(budget))
            for core in now.minimal(budget):
                if core not in shown:
                    shown.add(core)
                    yield _conflict(now.sure(core), core, budget)
            found = now
            there = there.finer(budget) if found.is_open and _has_room(budget) else None
        for core in found.larger:
            yield _perhaps_larger(_conflict(found.generous, core, budget))
    except OutOfTimeError as error:
        for core in found.larger:
            yield _perhaps_larger(Conflict(core, (), "the environment wins"))
        yield OpenQuestion(question, f"{error}{_hint(setting, budget.again())}")
        return
    except UnsupportedError as error:
        yield OpenQuestion(question, str(error))
        return
    if (uncertainty := found.uncertainty) is None:
        yield Completeness(tuple(requirement.id for requirement in setting.requirements))
    else:
        yield from _of_parts(setting, shown, budget)
        yield OpenQuestion(question, uncertainty)


def _of_parts(
    setting: RealizabilityProblem, shown: Collection[tuple[str, ...]], budget: Budget
) -> Iterator[Conflict]:
    """Minimal conflicts of some of the requirements, except those that are known.

    A minimal conflict of a part is one of the component, because all its subsets are in the part.
    """
    known = [frozenset(each) for each in shown]
    try:
        for part in _lost_parts(setting, setting.parts, budget):
            fights = _Fights(part, part.generous(budget))
            for core in fights.minimal(budget):
                if not any(each <= frozenset(core) for each in known):
                    known.append(frozenset(core))
                    yield _conflict(fights.sure(core), core, budget)
    except (UnsupportedError, OutOfTimeError):
        return


def _perhaps_larger(conflict: Conflict) -> Conflict:
    return altered(conflict, because=f"{conflict.because}; perhaps fewer of them conflict already")


@dataclass(slots=True)
class _Fights:
    """Minimal conflicts of a problem, as far as unknown values permit."""

    strict: RealizabilityProblem
    """Problem with the environment favoured."""
    generous: RealizabilityProblem
    """Problem with the system favoured."""
    larger: list[tuple[str, ...]] = field(default_factory=list)
    """Conflicts that may not be minimal."""
    smaller: list[tuple[str, ...]] = field(default_factory=list)
    """Sets against which the environment wins only if it is favoured."""

    @property
    def is_open(self) -> bool:
        """Whether more could be decided about them."""
        return bool(self.larger or self.smaller)

    def minimal(self, budget: Budget) -> Iterator[tuple[str, ...]]:
        """Conflicts that are certainly minimal; then all others are known, too."""
        ids = [each.id for each in self.generous.certain]
        for core in _minimal(self.generous, ids, budget):
            fewer = [[id for id in core if id != other] for other in core]
            is_sure = self.sure(core) is self.strict
            if is_sure or not any(_is_lost(self.strict, each, budget) for each in fewer):
                yield core
            else:
                self.larger.append(core)
        if self.generous is not self.strict:
            for core in _minimal(self.strict, ids, budget):
                if not _is_lost(self.generous, core, budget):
                    self.smaller.append(core)

    def sure(self, ids: Sequence[str]) -> RealizabilityProblem:
        """The problem whose traces of these requirements are certain."""
        known = {each.id for each in self.strict.certain}
        return self.strict if known.issuperset(ids) else self.generous

    @property
    def uncertainty(self) -> str | None:
        """Why there may be more conflicts; None: there are no others."""
        uncertainty = self.strict.left_out or self.generous.of_inputs or self.strict.of_outputs
        if uncertainty is None and self.smaller:
            which = "; ".join(map(listed, self.smaller))
            return f"{self.strict.of_inputs}; that decides whether these can be satisfied: {which}"
        return uncertainty


def _minimal(
    there: RealizabilityProblem, ids: Sequence[str], budget: Budget
) -> Iterator[tuple[str, ...]]:
    """Minimal conflicts of some requirements."""
    read = {requirement.id: frozenset(requirement.variables) for requirement in there.requirements}

    def chosen(members: Members) -> tuple[str, ...]:
        return tuple(ids[i] for i in sorted(members))

    def near(i: int, j: int) -> bool:
        return bool(read[ids[i]] & read[ids[j]])

    if there.arena.alphabet.memory() is None:
        at_once = switched(there.game(there.counters(ids), budget), there.fresh)
        if at_once is not None:
            return map(chosen, at_once.cores(budget))
    conflicting = cores(len(ids), lambda members: _is_lost(there, chosen(members), budget), near)
    return map(chosen, conflicting)


_SHORT = 200
"""Ticks of the longest duration after scaling."""


def _hint(setting: RealizabilityProblem, budget: Budget) -> str:
    """Conflict with all durations scaled down: a hint, not a finding."""
    longest = max((requirement.ticks or 0 for requirement in setting.requirements), default=0)
    factor = -(-longest // _SHORT)
    if factor < 2:
        return ""
    requirements, assumptions = (
        [
            replace(
                requirement,
                ticks=-(-requirement.ticks // factor) if requirement.ticks else requirement.ticks,
            )
            for requirement in some
        ]
        for some in (setting.requirements, setting.assumptions)
    )
    scaled = stage(requirements, assumptions, setting.roles, as_fret=setting.as_fret)
    every = [counter.id for counter in scaled.arena.counters]

    def fights(ids: Sequence[str]) -> bool:
        return _is_lost(scaled, ids, budget)

    try:
        if not fights(every):
            return ""
        return (
            f"; with all durations divided by {factor}, {listed(minimal(every, fights))} conflict"
        )
    except OutOfTimeError:
        return ""


_LONGEST = 200_000
"""Maximum number of ticks of a trace in the output."""


def _conflict(whole: RealizabilityProblem, members: Sequence[str], budget: Budget) -> Conflict:
    """A minimal conflict, with a trace that the formulas of its monitors confirm."""
    ids, setting = sorted(members), whole.close(members, budget)
    counters = setting.counters(ids)
    game = setting.game(counters, budget)
    try:
        play = Counterstrategy(game, game.solution(traps=True), budget).play()
    except (NoPlayError, OutOfTimeError) as error:
        return Conflict(tuple(ids), (), f"the environment wins, by a run that is {error}")
    requirements = [requirement for requirement in setting.requirements if requirement.id in ids]
    alphabet = setting.arena.alphabet
    lost = broken(requirements, alphabet, play, as_fret=setting.as_fret)
    assert lost, f"the play of {', '.join(ids)} breaks none of them"
    assert not broken(setting.assumptions, alphabet, play), "the environment keeps its word"
    why = because(requirements, counters, game, play)
    if play.ticks > _LONGEST:
        return Conflict(tuple(ids), (), why)
    return Conflict(tuple(ids), setting.ticks(ids, play.runs, play.numbers), why, play.loop)
