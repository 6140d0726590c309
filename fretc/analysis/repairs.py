"""What would settle a conflict: the least change of a bound, or an assumption of a small family.

Each suggestion is a sentence that parses, and is proved: the game of the changed set is played, and
the system wins. An assumption that would take away every trigger settles nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations, islice, permutations
from typing import assert_never, cast

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import Formalized
from compiler.formalization.resolution import candidates
from compiler.logic import decision_diagrams as bdd
from fretc.analysis.arena.alphabet import BeyondError
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.findings import Conflict, OpenQuestion, Repair
from fretc.analysis.stage import Stage, stage
from fretish import expressions as e
from fretish.bindings.declarations import Role
from fretish.clock import in_unit
from fretish.diagnostics.source import Source
from fretish.documents import Requirement
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
"""Of a conflict: more are no help."""
MOST_INPUTS = 8
"""Of a conflict with more no assumption is looked for."""
_ROOM = 8
"""Ticks beyond twice the bounds of a conflict, within which another bound is looked for."""
Rules = tuple[Formalized, ...]


@dataclass(frozen=True, slots=True)
class _Setting:
    """A component, one of its conflicts, and the time that is left."""

    whole: Stage
    rules: Rules
    """Those of the conflict."""
    budget: Budget
    triggered: dict[str, frozenset[str]] = field(default_factory=dict)

    @property
    def longest(self) -> int:
        """A bound that is as good as any longer one, or nearly."""
        return 2 * sum(rule.ticks or 0 for rule in self.rules) + _ROOM


def repairs(
    setting: Stage, conflicts: Sequence[Conflict], budget: Budget
) -> Iterator[Repair | OpenQuestion]:
    """What would settle each conflict of a component.

    Args:
        setting: of the component.
        conflicts: some of its minimal ones.
        budget: for all of them.
    """
    for conflict in conflicts:
        rules = tuple(rule for rule in setting.rules if rule.id in conflict.requirements)
        for family in (_changes, _promises):
            share = Budget(budget.seconds / len(conflicts) / 2)
            try:
                yield from family(_Setting(setting, rules, share), conflict.requirements)
            except (OutOfTimeError, BeyondError) as error:
                ids = ", ".join(conflict.requirements)
                yield OpenQuestion(f"what else would settle {ids}", str(error))


def _changes(setting: _Setting, conflict: Sequence[str]) -> Iterator[Repair]:
    """The least change of each bound."""
    for rule in setting.rules:
        changed = _least_change(setting, rule)
        if changed is not None:
            settles = _fits(setting, _with(setting.whole.rules, changed), ())
            yield Repair(tuple(conflict), rule.id, (printed(changed.written),), settles)


def _promises(setting: _Setting, conflict: Sequence[str]) -> Iterator[Repair]:
    """Some assumptions."""
    for assumed in islice(_assumptions(setting), MOST_ASSUMPTIONS):
        sentences = tuple(printed(each.written) for each in assumed)
        settles = _fits(setting, setting.whole.rules, assumed)
        yield Repair(tuple(conflict), None, sentences, settles)


def _with(rules: Rules, changed: Formalized) -> Rules:
    return tuple(changed if rule.id == changed.id else rule for rule in rules)


# The proof -------------------------------------------------------------------------------------


def _fits(setting: _Setting, rules: Rules, assumed: Rules) -> bool:
    """Whether the system wins, for certain, and each rule can still be triggered."""
    whole = setting.whole
    there = stage(rules, (*whole.assumptions, *assumed), whole.roles, as_fret=whole.as_fret)
    if there.left_out is not None or there.of_outputs is not None:
        return False
    if assumed and _triggered(setting, there) != _triggered_now(setting, rules):
        return False
    return there.game(there.arena.counters, setting.budget).solution().is_realizable


def _triggered_now(setting: _Setting, rules: Rules) -> frozenset[str]:
    """The ids of the rules whose triggers can come, as things are."""
    whole = setting.whole
    key = " ".join(rule.id for rule in rules)
    if key not in setting.triggered:
        there = stage(rules, whole.assumptions, whole.roles, as_fret=whole.as_fret)
        setting.triggered[key] = _triggered(setting, there)
    return setting.triggered[key]


def _triggered(setting: _Setting, there: Stage) -> frozenset[str]:
    """The ids of the rules whose triggers can come, in a run that keeps the assumptions."""
    found: set[str] = set()
    for counter in there.arena.counters:
        runs = there.runs((), setting.budget, watched=(counter,))
        lasting = runs.lasting()
        if (runs.transition.initial & lasting) == bdd.false():
            return frozenset()  # no run keeps the assumptions
        if runs.can_reach(counter.triggered, lasting):
            found.add(counter.id)
    return frozenset(found)


# Bounds ----------------------------------------------------------------------------------------


def _least_change(setting: _Setting, rule: Formalized) -> Formalized | None:
    """The rule with another bound: as little later, or as little shorter, as will do."""
    scope, timing = rule.sentence.scope, rule.sentence.timing
    if rule.ticks is None or (scope is not None and scope.kind.negates):
        return None

    def is_enough(ticks: int) -> bool:
        changed = _bounded(rule, ticks)
        return changed is not None and _fits(setting, _with(setting.rules, changed), ())

    match timing:
        case Within():
            least = _first(is_enough, rule.ticks + 1, rule.ticks + setting.longest)
        case For():
            least = _first(lambda less: is_enough(-less), 1 - rule.ticks, 0)
            least = None if least is None else -least
        case Immediately() | Next() | Finally() | Eventually() | Always() | Never():
            return None
        case After() | Until() | Before():  # a longer `after` is not weaker
            return None
        case _:
            assert_never(timing)
    return None if least is None else _bounded(rule, least)


def _first(is_enough: Callable[[int], bool], low: int, high: int) -> int | None:
    """The first number of low..high from which on something monotone holds; None: none."""
    if low > high or not is_enough(high):
        return None
    while low < high:
        middle = (low + high) // 2
        if is_enough(middle):
            high = middle
        else:
            low = middle + 1
    return low


def _bounded(rule: Formalized, ticks: int) -> Formalized | None:
    timing = cast("Within | For", rule.written.timing)
    duration = in_unit(ticks, timing.duration.unit, rule.clock)
    changed = replace(rule.written, timing=replace(timing, duration=duration))
    found = _formalized(rule.id, printed(changed), rule)
    return found if found is not None and found.ticks == ticks else None


# Assumptions -----------------------------------------------------------------------------------


def _assumptions(setting: _Setting) -> Iterator[Rules]:
    """Assumptions about the inputs of the conflict, each as weak as its family has it."""
    inputs = _inputs(setting)
    if len(inputs) > MOST_INPUTS:
        return
    for name in inputs:
        yield from _kept(setting, f"immediately satisfy !{name}")
    apart: set[frozenset[str]] = set()
    for pair in combinations(inputs, 2):
        for found in _kept(setting, f"never satisfy {' & '.join(pair)}"):
            apart.add(frozenset(pair))
            yield found
    for first, then in permutations(inputs, 2):
        if frozenset((first, then)) not in apart:
            for found in _distances(setting, (f"whenever {first}", then)):
                apart.add(frozenset((first, then)))
                yield found
    for name in inputs:
        yield from _distances(setting, (f"whenever !{name} & preBool(false, {name})", name))
    for one, other in combinations(inputs, 2):
        if frozenset((one, other)) not in apart:
            yield from _distances(setting, (f"whenever {one}", other), (f"whenever {other}", one))


def _inputs(setting: _Setting) -> list[str]:
    """The propositions of the conflict that the environment decides, as sentences spell them."""
    roles = setting.whole.roles
    found: dict[str, None] = {}
    for rule in setting.rules:
        for _, part in candidates(rule.sentence):
            names = [name.id for name in e.names(part)]
            calls = any(isinstance(each, e.Call) for each in e.parts(part))
            if names and not calls and all(roles.get(name) is Role.INPUT for name in names):
                text = expression(part)
                found[text if isinstance(part, e.Name) else f"({text})"] = None
    return [*found]


def _kept(setting: _Setting, *wordings: str) -> Iterator[Rules]:
    """The assumptions, where they settle the conflict."""
    assumed = _assumed(setting, wordings)
    if assumed is not None and _fits(setting, setting.rules, assumed):
        yield assumed


def _distances(setting: _Setting, *sides: tuple[str, str]) -> Iterator[Rules]:
    """The least distance of one input after another that settles the conflict."""

    def wordings(ticks: int) -> list[str]:
        return [f"{when} the environment shall for {ticks} ticks satisfy !{n}" for when, n in sides]

    def is_enough(ticks: int) -> bool:
        return next(_kept(setting, *wordings(ticks)), None) is not None

    least = _first(is_enough, 0, setting.longest)
    if least is not None:
        yield from _kept(setting, *wordings(least))


def _assumed(setting: _Setting, wordings: Sequence[str]) -> Rules | None:
    rules: list[Formalized] = []
    for wording in wordings:
        text = wording if " shall " in wording else f"the environment shall {wording}"
        rule = _formalized(f"assumption {len(rules)}", text, setting.rules[0])
        if rule is None:
            return None
        rules.append(rule)
    return tuple(rules)


def _formalized(id: str, text: str, like: Formalized) -> Formalized | None:
    """A sentence among the declarations of another rule; None where it is none there."""
    rule, _ = formalize(Requirement(id, Source("repair", text).span()), like.declarations)
    return rule
