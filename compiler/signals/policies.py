"""The meaning of bindings: numbers of samples, and truth values of propositions at an instant.

The entry point is `instant`: for some requirements it has the policies of all signals that their
propositions read, and the truth values of these propositions. Printers turn both into functions of
a language:

- a message's field → `SamplePolicy` (elements that are no measurement, `valid`, least or greatest)
  → a number of the sample, or unknown;
- a sample counts until it is older than `SamplePolicy.signal.max_age`; then, and before the first
  one, it is unknown;
- the numbers of all signals → `PropositionFunctions.truth` at an instant;
- the truths of all instants of a tick → `PropositionFunctions.aggregate`, then
  `PropositionFunctions.on_unknown`.

A value that depends on several instants is an input: `... for 200 ms` is `HeldFor`. A proposition
that looks back by ticks (`pre`) is not a function of an instant, and is listed in
`InstantFunctions.left_out`. A mean and a clearance are not exact in other languages: their signals
are given as one number (`is_given`). So are computed signals that call a function whose last digits
differ from one library to the next (`InstantFunctions.given`); only Python computes them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals import numbers as n
from compiler.signals.lowering import Lowering
from fretish import expressions as e
from fretish.bindings.declarations import (
    Aggregate,
    ComputedSignal,
    MeasuredSignal,
    Proposition,
    Reduce,
    Signal,
)
from fretish.bindings.expressions import ticks_back
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class SamplePolicy:
    """How the field of one message becomes the number of a sample.

    An element is NaN, +inf, -inf, a finite but invalid number, or a measurement; `signal.invalid`
    defines the first four. `valid` compares `SignalValue("x")`, the element, with fields of the
    same message, which are 64-bit floats.
    """

    signal: Signal
    valid: n.Truth | None = None
    fields: tuple[str, ...] = ()
    """The other fields that `valid` reads."""

    @property
    def is_given(self) -> bool:
        """Whether the caller computes the number, which is not exact or not of one field.

        It is a mean in the field's unit, a clearance or a number of a pose in base units, a status
        of goals, as its place in the signal's values, or the value of a signal with memory.
        """
        signal = self.signal
        is_rounded = signal.reduce in (Reduce.MEAN, Reduce.OUTLINE)
        return is_rounded or any((signal.pose, signal.goals, signal.memory))

    @property
    def is_array(self) -> bool:
        """Whether the field is an array, of which `signal.reduce` selects one element."""
        return self.signal.path.each and not self.is_given


@dataclass(frozen=True, slots=True)
class PropositionFunctions:
    """A proposition at an instant, over the numbers of its signals."""

    name: str
    truth: n.Truth
    held: tuple[tuple[n.Truth, int], ...]
    """Conditions that have to hold for a duration, with nanoseconds, in the order of `HeldFor`."""
    aggregate: Aggregate
    on_unknown: bool | None


@dataclass(frozen=True, slots=True)
class InstantFunctions:
    """The signals and propositions of one instant."""

    policies: tuple[SamplePolicy, ...]
    meanings: tuple[PropositionFunctions, ...]
    left_out: tuple[str, ...]
    """Bound propositions that look back by ticks: the caller gives their truth value."""
    given: tuple[ComputedSignal, ...] = ()
    """The computed signals whose number the caller gives, in base units."""


def instant(
    requirements: Sequence[FormalizedRequirement], *, gives_rounded: bool = False
) -> InstantFunctions | None:
    """The instant of all propositions of the requirements; None if there are no bindings.

    Args:
        requirements: the requirements.
        gives_rounded: whether the caller gives the numbers of computed signals that call a rounded
            function.
    """
    bound = _bound(requirements)
    pure = [proposition for proposition in bound if not ticks_back(proposition.expression)]
    read = dict.fromkeys(
        name
        for proposition in pure
        for name in _inputs(proposition.expression, gives_rounded=gives_rounded)
    )
    signals: dict[str, MeasuredSignal] = {
        name: signal
        for requirement in requirements
        if requirement.declarations is not None
        for name, signal in requirement.declarations.measured.items()
        if name in read
    }
    if not pure:
        return None
    inputs = [signals[name] for name in read]
    recorded = [signal for signal in inputs if isinstance(signal, Signal)]
    meanings = tuple(meaning(each, recorded, gives_rounded=gives_rounded) for each in pure)
    left_out = tuple(
        proposition.name for proposition in bound if ticks_back(proposition.expression)
    )
    given = tuple(signal for signal in inputs if isinstance(signal, ComputedSignal))
    return InstantFunctions(tuple(map(policy, recorded)), meanings, left_out, given)


def _inputs(expression: e.Expression, *, gives_rounded: bool) -> Iterator[str]:
    """The signals whose numbers the expression needs, left to right."""
    if isinstance(expression, e.Name):
        yield expression.id
    elif gives_rounded and isinstance(expression, e.Calculation) and expression.is_rounded:
        yield expression.name
    else:
        for part in e.children(expression):
            yield from _inputs(part, gives_rounded=gives_rounded)


def _bound(requirements: Sequence[FormalizedRequirement]) -> list[Proposition]:
    propositions: dict[str, Proposition] = {}
    for requirement in requirements:
        declared = (
            requirement.declarations.propositions if requirement.declarations is not None else {}
        )
        propositions |= {name: declared[name] for name in requirement.watched if name in declared}
    return [*propositions.values()]


def policy(signal: Signal) -> SamplePolicy:
    """The policy of a signal."""
    if signal.valid is None:
        return SamplePolicy(signal)
    fields = dict.fromkeys(name.id for name in e.names(signal.valid) if name.id != "x")
    return SamplePolicy(signal, Lowering(unit=signal.field_unit).truth(signal.valid), tuple(fields))


def meaning(
    proposition: Proposition, signals: Iterable[Signal], *, gives_rounded: bool = False
) -> PropositionFunctions:
    """The meaning of a proposition without `pre`, over declared signals; as in `instant`."""
    scales, words = {}, {}
    for signal in signals:
        scales[signal.name], words[signal.name] = signal.scale, signal.values
    lowering = Lowering(scales, words, gives_rounded=gives_rounded)
    truth = lowering.truth(proposition.expression)
    return PropositionFunctions(
        proposition.name,
        truth,
        tuple(lowering.held),
        proposition.aggregate,
        proposition.on_unknown,
    )
