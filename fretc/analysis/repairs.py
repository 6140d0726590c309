"""Repairs of a conflict: the least change of a bound, or a simple assumption.

Each repair is a sentence that parses, and is proved: the system wins the game of the changed set.
An assumption that makes every trigger impossible is no repair.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import field, replace
from itertools import combinations, islice, permutations
from typing import assert_never, cast

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.resolution import candidates
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.memory import RequirementCounter
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.findings import Conflict, OpenQuestion, Repair
from fretc.analysis.realizability_problem import RealizabilityProblem, stage
from fretish import expressions as e
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass
from fretish.clock import in_unit
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.printer import expression
from fretish.printer import sentence as printed
from fretish.syntax import (
    After,
    Always,
    Before,
    Eventually,
    Finally,
    For,
    Immediately,
    Never,
    Next,
    Until,
    Within,
)

MOST_ASSUMPTIONS = 4
"""Maximum number of suggested assumptions of a conflict."""
MOST_INPUTS = 8
"""Maximum number of inputs of a conflict for which assumptions are searched."""
_ROOM = 8
"""Ticks beyond twice the bounds of a conflict, within which another bound is searched."""
Rules = tuple[FormalizedRequirement, ...]


@dataclass(frozen=True, slots=True)
class _Known:
    """Results that the conflicts of a component share."""

    triggered: dict[tuple[str, ...], frozenset[str]] = field(default_factory=dict)
    """Ids of requirements → those of them whose triggers can occur at present."""
    fits: dict[object, bool] = field(default_factory=dict)
    """Changed bounds and assumptions → whether the system wins."""
    assumptions: dict[tuple[str, ...], Rules | None] = field(default_factory=dict)
    """Assumptions by their sentences."""


@dataclass(frozen=True, slots=True)
class _ConflictSetting:
    """A component, one of its conflicts, and the remaining time."""

    whole: RealizabilityProblem
    requirements: Rules
    """Requirements of the conflict."""
    fought: Sequence[frozenset[str]]
    """Ids of each conflict of the component."""
    budget: Budget
    known: _Known

    @property
    def longest(self) -> int:
        """A bound that is long enough to represent any longer one."""
        return 2 * sum(requirement.ticks or 0 for requirement in self.requirements) + _ROOM


def repairs(
    setting: RealizabilityProblem, conflicts: Sequence[Conflict], budget: Budget
) -> Iterator[Repair | OpenQuestion]:
    """Repairs of each conflict of a component.

    Args:
        setting: problem of the component.
        conflicts: some of its minimal conflicts.
        budget: time limit for all of them.
    """
    known = _Known()
    fought = [frozenset(conflict.requirements) for conflict in conflicts]
    for conflict in conflicts:
        requirements = tuple(
            requirement
            for requirement in setting.requirements
            if requirement.id in conflict.requirements
        )
        for family in (_changes, _promises):
            share = Budget(budget.seconds / len(conflicts) / 2)
            try:
                yield from family(
                    _ConflictSetting(setting, requirements, fought, share, known),
                    conflict.requirements,
                )
            except (OutOfTimeError, UnsupportedError) as error:
                ids = ", ".join(conflict.requirements)
                yield OpenQuestion(f"what else would resolve {ids}", str(error))


def _changes(setting: _ConflictSetting, conflict: Sequence[str]) -> Iterator[Repair]:
    """Repairs that change a bound as little as possible."""
    for requirement in setting.requirements:
        changed = _least_change(setting, requirement)
        if changed is not None:
            settles = all(requirement.id in ids for ids in setting.fought) and _fits(
                setting, _with(setting.whole.requirements, changed), ()
            )
            yield Repair(tuple(conflict), requirement.id, (printed(changed.written),), settles)


def _promises(setting: _ConflictSetting, conflict: Sequence[str]) -> Iterator[Repair]:
    """Repairs that add assumptions."""
    for assumed in islice(_assumptions(setting), MOST_ASSUMPTIONS):
        sentences = tuple(printed(assumption.written) for assumption in assumed)
        settles = _fits(setting, setting.whole.requirements, assumed)
        yield Repair(tuple(conflict), None, sentences, settles)


def _with(requirements: Rules, changed: FormalizedRequirement) -> Rules:
    return tuple(
        changed if requirement.id == changed.id else requirement for requirement in requirements
    )


# The proof -------------------------------------------------------------------------------------


def _fits(setting: _ConflictSetting, requirements: Rules, assumed: Rules) -> bool:
    """Whether the system certainly wins, and each requirement can still be triggered."""
    key = (
        tuple((requirement.id, requirement.ticks) for requirement in requirements),
        tuple(requirement.entry.wording.text for requirement in assumed),
    )
    known = setting.known.fits
    if key not in known:
        known[key] = _is_shown_to_fit(setting, requirements, assumed)
    return known[key]


def _is_shown_to_fit(setting: _ConflictSetting, requirements: Rules, assumed: Rules) -> bool:
    there, counters = _staged(setting, requirements, assumed)
    if there.left_out is not None or there.of_outputs is not None:
        return False
    if assumed and _triggered(setting, there, counters) != _triggered_now(setting, requirements):
        return False
    return there.game(counters, setting.budget).solution().is_realizable


def _staged(
    setting: _ConflictSetting, requirements: Rules, assumed: Rules
) -> tuple[RealizabilityProblem, tuple[RequirementCounter, ...]]:
    """The problem of the requirements under the assumptions, and their counters.

    The component's problem is reused if it has all counters and the assumptions need no counts,
    because building another one takes longer than the game.
    """
    whole, budget = setting.whole, setting.budget
    ids = [requirement.id for requirement in requirements]
    is_there = set(map(id, requirements)) <= set(map(id, whole.requirements))
    if (
        is_there
        and not whole.left_out
        and not whole.of_outputs
        and not any(requirement.ticks for requirement in assumed)
    ):
        with suppress(UnsupportedError):
            there = whole.assuming(assumed).close(ids, budget)
            return there, there.counters(ids)
    near = (*whole.assumptions, *assumed)
    there = stage(requirements, near, whole.roles, as_fret=whole.as_fret, budget=budget)
    there = there.close(ids, budget)
    return there, there.arena.counters


def _triggered_now(setting: _ConflictSetting, requirements: Rules) -> frozenset[str]:
    """Ids of the requirements whose triggers can occur at present."""
    key = tuple(requirement.id for requirement in requirements)
    known = setting.known.triggered
    if key not in known:
        known[key] = _triggered(setting, *_staged(setting, requirements, ()))
    return known[key]


def _triggered(
    setting: _ConflictSetting, there: RealizabilityProblem, counters: Sequence[RequirementCounter]
) -> frozenset[str]:
    """Ids of the requirements whose triggers can occur in a run that satisfies the assumptions."""
    atoms: set[str] = set()
    for counter in counters:
        runs = there.runs((), setting.budget, watched=(counter,))
        lasting = runs.lasting()
        if (runs.transition.initial & lasting) == bdd.false():
            return frozenset()  # No run satisfies the assumptions.
        if runs.can_reach(counter.triggered, lasting):
            atoms.add(counter.id)
    return frozenset(atoms)


# Bounds ----------------------------------------------------------------------------------------


def _least_change(
    setting: _ConflictSetting, requirement: FormalizedRequirement
) -> FormalizedRequirement | None:
    """The requirement with the nearest bound that resolves the conflict."""
    scope, timing = requirement.sentence.scope, requirement.sentence.timing
    if requirement.ticks is None or (scope is not None and scope.kind.negates):
        return None

    def is_enough(ticks: int) -> bool:
        changed = _bounded(requirement, ticks)
        return changed is not None and _fits(setting, _with(setting.requirements, changed), ())

    match timing:
        case Within():
            least = _first(
                setting, is_enough, requirement.ticks + 1, requirement.ticks + setting.longest
            )
        case For():
            least = _first(setting, lambda less: is_enough(-less), 1 - requirement.ticks, 0)
            least = None if least is None else -least
        case Immediately() | Next() | Finally() | Eventually() | Always() | Never():
            return None
        case After() | Until() | Before():  # A longer `after` is not weaker.
            return None
        case _:
            assert_never(timing)
    return None if least is None else _bounded(requirement, least)


def _first(
    setting: _ConflictSetting, is_enough: Callable[[int], bool], low: int, high: int
) -> int | None:
    """The first number of low..high from which a monotone property holds; None: there is none.

    Numbers next to a bound of the conflict are tried first, because the answer is often one of
    them.
    """
    if low > high or not is_enough(high):
        return None
    near = {
        requirement.ticks + more
        for requirement in setting.requirements
        if requirement.ticks
        for more in (-1, 0, 1, 2)
    }
    marks = sorted({*near, *(-each for each in near)}.intersection(range(low, high)))
    while low < high:
        middle = marks[len(marks) // 2] if marks else (low + high) // 2
        if is_enough(middle):
            high = middle
        else:
            low = middle + 1
        marks = [mark for mark in marks if low <= mark < high]
    return low


def _bounded(requirement: FormalizedRequirement, ticks: int) -> FormalizedRequirement | None:
    timing = cast("Within | For", requirement.written.timing)
    duration = in_unit(ticks, timing.duration.unit, requirement.clock)
    changed = replace(requirement.written, timing=replace(timing, duration=duration))
    bounded = _formalized(requirement.id, printed(changed), requirement)
    return bounded if bounded is not None and bounded.ticks == ticks else None


# Assumptions -----------------------------------------------------------------------------------


def _assumptions(setting: _ConflictSetting) -> Iterator[Rules]:
    """Assumptions about the inputs of the conflict, each as weak as its pattern allows."""
    inputs = _inputs(setting)
    if len(inputs) > MOST_INPUTS:
        return
    lost = _lost(setting)
    if lost is not None:
        for (one, first), (other, second) in combinations(inputs.items(), 2):
            if lost - (first & second) == bdd.false():
                yield from _kept(setting, f"never satisfy {one} & {other}")
        return
    for name in inputs:
        yield from _kept(setting, f"immediately satisfy !{name}")
    apart: set[frozenset[str]] = set()
    for pair in combinations(inputs, 2):
        for repair in _kept(setting, f"never satisfy {' & '.join(pair)}"):
            apart.add(frozenset(pair))
            yield repair
    for first, then in permutations(inputs, 2):
        if frozenset((first, then)) not in apart:
            for repair in _distances(setting, (f"whenever {first}", then)):
                apart.add(frozenset((first, then)))
                yield repair
    for name in inputs:
        yield from _distances(setting, (f"whenever !{name} & preBool(false, {name})", name))
    for one, other in combinations(inputs, 2):
        if frozenset((one, other)) not in apart:
            yield from _distances(setting, (f"whenever {one}", other), (f"whenever {other}", one))


def _lost(setting: _ConflictSetting) -> Function | None:
    """Inputs that lose at any tick, if no requirement has memory; None: some has.

    Then every tick is like the first one, and only an assumption that excludes all of these inputs
    at every tick resolves the conflict.
    """
    there, counters = _staged(setting, setting.requirements, ())
    game = there.game(counters, setting.budget)
    if there.arena.alphabet is not setting.whole.arena.alphabet or not game.is_memoryless:
        return None
    return game.legal - game.answered(bdd.true())


def _inputs(setting: _ConflictSetting) -> dict[str, Function]:
    """Propositions of the conflict that the environment chooses, as spelled in sentences."""
    roles, alphabet = setting.whole.roles, setting.whole.arena.alphabet
    functions: dict[str, Function] = {}
    for requirement in setting.requirements:
        for atom, part in candidates(requirement.sentence):
            names = [name.id for name in e.names(part)]
            calls = any(isinstance(each, e.Call) for each in e.parts(part))
            if names and not calls and all(roles.get(name) is Role.INPUT for name in names):
                text = expression(part)
                functions[text if isinstance(part, e.Name) else f"({text})"] = alphabet.atom(atom)
    return functions


def _kept(setting: _ConflictSetting, *wordings: str) -> Iterator[Rules]:
    """The assumptions as a repair, if they resolve the conflict."""
    assumed = _assumed(setting, wordings)
    if assumed is not None and _fits(setting, setting.requirements, assumed):
        yield assumed


def _distances(setting: _ConflictSetting, *sides: tuple[str, str]) -> Iterator[Rules]:
    """The least distance between two inputs that resolves the conflict."""

    def wordings(ticks: int) -> list[str]:
        return [f"{when} the environment shall for {ticks} ticks satisfy !{n}" for when, n in sides]

    def is_enough(ticks: int) -> bool:
        return next(_kept(setting, *wordings(ticks)), None) is not None

    least = _first(setting, is_enough, 0, setting.longest)
    if least is not None:
        yield from _kept(setting, *wordings(least))


def _assumed(setting: _ConflictSetting, wordings: Sequence[str]) -> Rules | None:
    known, key = setting.known.assumptions, tuple(wordings)
    if key not in known:
        texts = (w if " shall " in w else f"the environment shall {w}" for w in wordings)
        requirements = [
            _formalized(f"assumption {number}", text, setting.requirements[0])
            for number, text in enumerate(texts)
        ]
        known[key] = None if None in requirements else tuple(filter(None, requirements))
    return known[key]


def _formalized(id: str, text: str, like: FormalizedRequirement) -> FormalizedRequirement | None:
    """A sentence with the declarations of another requirement; None if it does not parse there."""
    requirement, _ = formalize(
        RequirementEntry(id, Source("repair", text).span()), like.declarations
    )
    return requirement
