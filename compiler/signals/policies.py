"""Bindings → what each signal's sample says, and each proposition's truth at an instant.

The door is `instant`: it has, for some requirements, the policies of all signals that their
propositions read, and the truths of these propositions. Printers of languages turn both into
functions:

- a message's field → `Policy` (elements that are no measurement, `valid`, least or greatest) → a
  number of the sample, or unknown;
- a sample counts until it is older than `Policy.signal.max_age`; then, and before the first one, it
  is unknown;
- the numbers of all signals → `Meaning.truth` at an instant;
- the truths of all instants of a tick → `Meaning.aggregate`, then `Meaning.on_unknown`.

What depends on more than one instant is an input: `... for 200 ms` is `HeldFor`. What looks back by
ticks (`pre`) is no function of an instant at all, and stands in `Instant.left_out`. A mean and a
clearance are not exact in other languages: their signals are given as one number (`is_given`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals import numbers as n
from compiler.signals.lowering import Lowering
from fretish import expressions as e
from fretish.bindings.declarations import Aggregate, Proposition, Reduce, Signal
from fretish.bindings.expressions import ticks_back


@dataclass(frozen=True, slots=True)
class Policy:
    """From the field of one message to the number of a sample.

    An element is NaN, +inf, -inf, a finite number for which `valid` is not true, or a
    measurement; `signal.invalid` says of each of the first four what it means. `valid` compares
    `SignalValue("x")`, the element, with fields of the same message, which are 64-bit floats.
    """

    signal: Signal
    valid: n.Truth | None = None
    fields: tuple[str, ...] = ()
    """The other fields that `valid` reads."""

    @property
    def is_given(self) -> bool:
        """Whether the caller computes the number: a mean, in the field's unit; or a clearance."""
        return self.signal.reduce in (Reduce.MEAN, Reduce.OUTLINE)

    @property
    def is_array(self) -> bool:
        """Whether it takes all elements of an array, of which `signal.reduce` chooses one."""
        return self.signal.path.each and not self.is_given


@dataclass(frozen=True, slots=True)
class Meaning:
    """A proposition at an instant, over the numbers of its signals."""

    name: str
    truth: n.Truth
    held: tuple[tuple[n.Truth, int], ...]
    """What has to hold for a duration, and for how many nanoseconds; in the order of `HeldFor`."""
    aggregate: Aggregate
    on_unknown: bool | None


@dataclass(frozen=True, slots=True)
class Instant:
    """What the samples of one instant say."""

    policies: tuple[Policy, ...]
    meanings: tuple[Meaning, ...]
    left_out: tuple[str, ...]
    """Propositions that are bound and look back by ticks: their truth is given."""


def instant(requirements: Sequence[FormalizedRequirement]) -> Instant | None:
    """Of all propositions that the requirements watch; None where no bindings say what they are."""
    bound = _bound(requirements)
    pure = [each for each in bound if not ticks_back(each.expression)]
    read = dict.fromkeys(name for each in pure for name in each.signals)
    signals = {
        name: signal
        for requirement in requirements
        if requirement.declarations is not None
        for name, signal in requirement.declarations.signals.items()
        if name in read
    }
    if not pure:
        return None
    policies = tuple(policy(signals[name]) for name in read)
    meanings = tuple(meaning(each, signals.values()) for each in pure)
    left_out = tuple(each.name for each in bound if ticks_back(each.expression))
    return Instant(policies, meanings, left_out)


def _bound(requirements: Sequence[FormalizedRequirement]) -> list[Proposition]:
    found: dict[str, Proposition] = {}
    for requirement in requirements:
        known = (
            requirement.declarations.propositions if requirement.declarations is not None else {}
        )
        found |= {name: known[name] for name in requirement.watched if name in known}
    return [*found.values()]


def policy(signal: Signal) -> Policy:
    """What a sample of the signal says."""
    if signal.valid is None:
        return Policy(signal)
    fields = dict.fromkeys(name.id for name in e.names(signal.valid) if name.id != "x")
    return Policy(signal, Lowering(unit=signal.unit).truth(signal.valid), tuple(fields))


def meaning(proposition: Proposition, signals: Iterable[Signal]) -> Meaning:
    """The truth of a proposition that does not look back by ticks, over declared signals."""
    scales, words = {}, {}
    for signal in signals:
        scales[signal.name], words[signal.name] = signal.scale, signal.values
    lowering = Lowering(scales, words)
    truth = lowering.truth(proposition.expression)
    return Meaning(
        proposition.name,
        truth,
        tuple(lowering.held),
        proposition.aggregate,
        proposition.on_unknown,
    )
