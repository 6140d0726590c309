"""The samples of one tick: what several samples, and none, can make true together.

A tick contains a sequence of steps, and `any`, `all` or the last of them count. As many steps
beside the last one as there are such atoms are enough: one deciding step for each atom. So a tick
is the numbers of a few steps, without losing or adding patterns.

Atoms that share only some signals can differ through values carried over from the previous tick:
one of them reads a new sample beside an old one, while the other has no step. If this makes
patterns possible that new samples of all signals do not, the atoms are refused.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import assert_never

import z3

from compiler.formalization.numbers.terms import Term
from fretish.bindings.declarations import Aggregate
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class AtomStep:
    """An atom at one step: when it is certainly true, and when it is false."""

    true: Term
    false: Term
    signals: frozenset[str]
    aggregate: Aggregate
    on_unknown: bool | None
    names: tuple[str, ...]
    """Names in the sentence; the player who chooses them chooses the signals."""

    @property
    def is_of_all_steps(self) -> bool:
        """Whether steps other than the last one count."""
        return self.aggregate is not Aggregate.LAST


@dataclass(frozen=True, slots=True)
class AtomOfTick:
    """An atom of a tick."""

    formula: Term
    given: Term
    """Condition that its value is neither unknown nor replaced."""
    carried: Term | None = None
    """Formula for signals without a new sample; None: no difference."""
    links: Term | None = None
    """Constraints of `carried`."""


def unknown(signal: str) -> Term:
    """Flag: the signal is unknown at the last step."""
    return z3.Bool(f"{signal} is unknown")


def linked(moments: Mapping[str, AtomStep]) -> list[dict[str, AtomStep]]:
    """Atoms for which steps other than the last one count, grouped by shared signals."""
    groups: list[dict[str, AtomStep]] = []
    for name, moment in moments.items():
        if moment.is_of_all_steps:
            near = [
                group
                for group in groups
                if any(each.signals & moment.signals for each in group.values())
            ]
            groups = [group for group in groups if group not in near]
            groups.append({n: m for group in near for n, m in group.items()} | {name: moment})
    return groups


class Steps:
    """Steps of some signals within a tick."""

    def __init__(
        self, group: Mapping[str, AtomStep], variables: Mapping[str, Term], open_: Collection[str]
    ) -> None:
        """Create the steps.

        Args:
            group: atoms of the signals.
            variables: constants of z3 for signals at the last step.
            open_: signals that may be unknown.
        """
        self._group = group
        signals = sorted({signal for each in group.values() for signal in each.signals})
        self._signals = {name: variables[name] for name in signals}
        self._flags = {name: unknown(name) for name in signals if name in open_}
        self.copies: dict[str, Term] = {}
        """Name → variable for a signal or flag at another step."""
        self.of: dict[str, str] = {}
        """Copy → its signal."""
        self._others = [self._copied(number) for number in range(1, len(group) + 1)]

    def _copied(self, number: int) -> list[tuple[Term, Term]]:
        """Variables of each signal at another step."""
        pairs = []
        for name, last in [*self._signals.items(), *self._flags.items()]:
            copy = z3.Const(f"{last} at step {number}", last.sort())
            self.copies[str(copy)], self.of[str(copy)] = copy, name
            pairs.append((last, copy))
        return pairs

    @property
    def has_flags(self) -> bool:
        """Whether some of the signals may be unknown."""
        return bool(self._flags)

    @property
    def is_crossed(self) -> bool:
        """Whether some atoms read a part of what others read."""
        return len({each.signals for each in self._group.values()}) > 1

    def tick(self, moment: AtomStep) -> AtomOfTick:
        """Atom of the group over all steps."""
        every = [[], *self._others]
        true, false = (
            [z3.substitute(formula, *pairs) if pairs else formula for pairs in every]
            for formula in (moment.true, moment.false)
        )
        made = tick(moment, true, false)
        return self._carried(moment, made) if self.is_crossed else made

    def _carried(self, moment: AtomStep, made: AtomOfTick) -> AtomOfTick:
        """Formula with old numbers of signals without a new sample, step by step."""
        values = {n: z3.Const(f"{n} of before", v.sort()) for n, v in self._signals.items()}
        states, seen = [], []
        for number, pairs in enumerate(self._others, 1):
            copies = {str(last): copy for last, copy in pairs}
            values = {
                name: z3.If(_is_new(name, number), copies[name], old)
                for name, old in values.items()
            }
            now = [(last, values[name]) for name, last in self._signals.items()]
            states.append(z3.substitute(moment.true, *now))
            seen.append(z3.Or([_is_new(name, number) for name in moment.signals]))
        links = [z3.Or(_is_new(n, 0), last == values[n]) for n, last in self._signals.items()]
        states.append(moment.true)
        at_last = z3.Or([_is_new(name, 0) for name in moment.signals])
        seen.append(z3.Or(at_last, z3.Not(z3.Or(seen))))  # without a step: what is in force
        at_steps = [*zip(seen, states, strict=True)]
        if moment.aggregate is Aggregate.ANY:
            carried = z3.Or([z3.And(*each) for each in at_steps])
        else:
            carried = z3.And([z3.Implies(*each) for each in at_steps])
        return AtomOfTick(made.formula, made.given, carried, z3.And(links))


def _is_new(signal: str, step: int) -> Term:
    """Whether a signal has a sample at a step; 0 is the last one."""
    return z3.Bool(f"{signal} is new at {step}")


def tick(moment: AtomStep, true: Sequence[Term], false: Sequence[Term]) -> AtomOfTick:
    """Atom of a tick from its values at the steps, the last one first."""
    match moment.aggregate:
        case Aggregate.ANY:
            is_true, is_false = z3.Or(true), z3.And(false)
        case Aggregate.ALL:
            is_true, is_false = z3.And(true), z3.Or(false)
        case Aggregate.LAST:
            is_true, is_false = true[0], false[0]
        case _:
            assert_never(moment.aggregate)
    if moment.on_unknown is None:
        return AtomOfTick(z3.simplify(is_true), z3.simplify(z3.Or(is_true, is_false)))
    formula = z3.Not(is_false) if moment.on_unknown else is_true
    return AtomOfTick(z3.simplify(formula), z3.BoolVal(True))
