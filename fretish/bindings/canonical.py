"""The canonical form of bindings, as plain values: equal meanings give equal values.

Numbers are exact fractions in base units, durations are nanoseconds, and defaults are filled in. So
`50 cm` equals `0.5 m`, and a default equals the same value written out.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from fractions import Fraction
from typing import Any, assert_never

from fretish import expressions as e
from fretish import units
from fretish.bindings.declarations import (
    Declarations,
    Proposition,
    Reduce,
    Signal,
    short_type,
)
from fretish.clock import Clock, TimeSource
from fretish.reading.recursion import with_recursion_limit


@with_recursion_limit
def digest(value: Any) -> str:
    """SHA-256 of plain values; the order of keys does not count."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


def clock(declared: Clock) -> Any:
    """The clock. `rounding` is left out: its effect is visible in the formulas."""
    where = [declared.period, declared.topic, declared.phase]
    by_arrival = declared.time is TimeSource.LOG_TIME or declared.lateness is None
    waits = [] if by_arrival else [declared.lateness]
    return [*where, str(declared.time), str(declared.end), *waits]


def bound(declarations: Declarations, names: Iterable[str]) -> Any:
    """The named propositions: their expressions, and the signals that they read."""
    propositions = [declarations.propositions[n] for n in names if n in declarations.propositions]
    read = {signal for proposition in propositions for signal in proposition.signals}
    return {
        "proposition": {p.name: [*proposition_fields(p).values()] for p in propositions},
        "signal": {name: signal_fields(declarations.signals[name]) for name in read},
    }


def described(declarations: Declarations | None, names: Iterable[str]) -> Any:
    """The documentation fields of propositions; no verdict depends on them."""
    propositions = declarations.propositions if declarations else {}
    return {
        name: [
            " ".join(propositions[name].text.split()),
            str(propositions[name].role),
            propositions[name].kind,
        ]
        for name in names
        if name in propositions
    }


def proposition_fields(proposition: Proposition) -> dict[str, Any]:
    """The canonical value of each field of a proposition that verdicts depend on."""
    return {
        "expr": expression(proposition.expression),
        "agg": str(proposition.aggregate),
        "on_unknown": proposition.on_unknown,
    }


def signal_fields(signal: Signal) -> dict[str, Any]:
    """The canonical value of each field of a signal that verdicts depend on.

    `outline` combines `footprint` and `sensor`.
    """
    outline = signal.reduce is Reduce.OUTLINE
    invalid = signal.invalid
    meaning = {
        "path": str(signal.path),
        "unit": unit_fields(signal.unit),
        "type": short_type(signal.type) if signal.type else None,
        "reduce": str(signal.reduce) if signal.reduce else None,
        "valid": expression(signal.valid, plain=False) if signal.valid else None,
        "invalid": [
            str(reading)
            for reading in (
                invalid.nan,
                invalid.positive_infinity,
                invalid.negative_infinity,
                invalid.other,
            )
        ],
        "max_age": signal.max_age,
        "outline": [signal.footprint, signal.sensor] if outline else None,
    }
    if signal.memory is not None:
        memory = signal.memory
        meaning |= {"memory": [memory.function, memory.over, memory.max_age]}
    if signal.pose is not None:
        meaning["pose"] = [signal.pose.frame, signal.pose.reference, str(signal.pose.number)]
    if signal.goals is not None:
        meaning["goals"] = [str(signal.goals.choice), sorted(signal.goals.statuses)]
    return meaning | {"values": _values(signal)} if signal.values else meaning


def unit_fields(unit: units.Unit) -> Any:
    """The unit; another name of the same unit is the same."""
    return [list(unit.dimension), str(unit.factor)]


def _values(signal: Signal) -> Any:
    """Each word with its number in the log, sorted; None: the message definition has the number.

    The order in which the bindings list the words has no meaning.
    """
    numbers = signal.numbers or [None] * len(signal.values)
    return sorted([word, number] for word, number in zip(signal.values, numbers, strict=True))


@with_recursion_limit
def expression(tree: e.Expression, *, plain: bool = True) -> Any:
    """An expression of the bindings as nested lists, numbers exact and in base units.

    Args:
        tree: the expression.
        plain: whether a plain number equals a dimensionless quantity. In `valid` it does not,
            because `valid` is in the unit of the field: `35 %` is 35 in a field in percent.
    """
    match tree:
        case e.Truth(value):
            return value
        case e.Name(id):
            return ["name", id]
        case e.Number(digits):
            return ["number", str(Fraction(digits))]
        case e.Quantity(digits, name):
            return _quantity(digits, name, plain=plain)
        case e.Word(text):
            return ["word", text]
        case e.Calculation(_, value):
            return expression(value, plain=plain)
        case e.Arithmetic(op, _, _) | e.Comparison(op, _, _):
            kind = [type(tree).__name__, op]
        case e.Call(name, _):
            kind = ["call", name]
        case e.Temporal(operator, _, bounds):
            kind = [operator, *map(str, bounds or ())]
        case e.Persistence(_, duration):
            kind = ["for", str(duration)]
        case e.Negation() | e.Not() | e.And() | e.Or() | e.Xor() | e.Implies() | e.Iff():
            kind = [type(tree).__name__]
        case _:
            assert_never(tree)
    return [*kind, *(expression(part, plain=plain) for part in e.children(tree))]


def _quantity(digits: str, name: str, *, plain: bool) -> Any:
    unit = units.unit(name)
    assert unit is not None, "the parser refuses unknown units"
    exact = str(Fraction(digits) * unit.factor)
    if plain and unit.dimension == units.DIMENSIONLESS:
        return ["number", exact]
    return ["quantity", exact, list(unit.dimension)]


def parameter(text: str) -> Any:
    """The exact value and dimension of a stated quantity; the text itself if it is no quantity."""
    exact = units.quantity(text)
    return " ".join(text.split()) if exact is None else [list(exact[0]), str(exact[1])]
