"""Random bindings and samples, what the audit says of them, and what the descriptions say.

The audit is asked by the functions that it calls itself: `sample` for a message, `truth` for a
proposition.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import floor
from typing import Any, assert_never

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals import numbers as n
from compiler.signals.policies import meaning
from fretc.logs.signals.measures import NameValues
from fretc.logs.signals.propositions import truth, truth_values
from fretc.logs.signals.samples import EXACT, Values
from fretc.logs.signals.signals import is_chosen, sample
from fretish import expressions as e
from fretish.bindings.declarations import (
    Declarations,
    InvalidReadings,
    Path,
    Proposition,
    Reading,
    Reduce,
    Signal,
    path,
)
from fretish.bindings.functions import ROUNDED
from fretish.clock import Clock
from fretish.diagnostics.source import Source
from fretish.units import ONE, unit
from monitors.kernel import readings
from monitors.kernel.verdicts import Truth
from monitors.rounded_functions import rounded
from tests.emitting import requirement

SIGNS = ("<", "<=", ">", ">=", "=", "!=")
EDGES = (0, 1, 2, 3, *(2**k + i for k in (52, 53, 63) for i in (-1, 0, 1)), 2**64 - 1)
DIGITS = (
    "0",
    "0.1",
    "0.35",
    "0.9",
    "3",
    "16777217",
    "1e400",
    "1e-400",
    "5e-324",
    "3.5e38",
    "1e308",
)
BETWEEN = (f"{2**52}.5", f"{2**53 + 1}.5", f"{2**63 + 1}", f"{2**64 - 1}.5", f"{2**64}")
digits = st.one_of(
    st.sampled_from(DIGITS),
    st.sampled_from(EDGES).map(str),
    st.sampled_from(BETWEEN),
    st.integers(0, 20).map(str),
    st.fractions(0, 4, max_denominator=8).map(lambda f: str(float(f))),
)


def _around(kind: type[np.floating[Any]]) -> list[float]:
    """Each threshold as a number of a kind, with its neighbours."""
    with np.errstate(over="ignore"):
        near = [kind(float(Fraction(text))) for text in DIGITS if text != "1e400"]
        ends = kind(-np.inf), kind(np.inf)
        around = [each for x in near for each in (x, *(np.nextafter(x, end) for end in ends))]
    return [float(sign * each) for each in around for sign in (1, -1)]


LARGEST = float(np.finfo(np.float64).max)
SPECIAL = [
    *(math.nan, math.inf, -math.inf, LARGEST, -LARGEST, 0.0, -0.0, 5e-324),
    *(2.0**52, 2.0**53, 2.0**53 + 2, 2.0**64),
]
doubles = st.one_of(
    st.floats(), st.sampled_from(SPECIAL), st.sampled_from(_around(np.float64)), st.integers(-9, 9)
).map(np.float64)
singles = st.one_of(
    st.floats(width=32),
    st.sampled_from([math.nan, math.inf, -math.inf, 0.0, -0.0, 2.0**-149]),
    st.sampled_from(_around(np.float32)),
    st.integers(-9, 9),
).map(np.float32)
signed = st.one_of(
    st.sampled_from([s * x for x in EDGES for s in (1, -1)] + [-(2**63)]), st.integers(-9, 9)
)
longs = signed.filter(lambda x: -(2**63) <= x < 2**63).map(np.int64)
unsigned = signed.filter(lambda x: x >= 0).map(np.uint64)
KINDS: Mapping[str, st.SearchStrategy[Any]] = {
    "float": singles,
    "double": doubles,
    "int64": longs,
    "uint64": unsigned,
    "int8": st.integers(-128, 127).map(np.int8),
    "uint8": st.integers(0, 255).map(np.uint8),
    "int16": st.sampled_from([-(2**15), -1, 0, 1, 3, 2**15 - 1]).map(np.int16),
    "uint16": st.sampled_from([0, 1, 3, 2**16 - 1]).map(np.uint16),
    "int32": st.sampled_from([-(2**31), -1, 0, 1, 2, 2**31 - 1]).map(np.int32),
    "uint32": st.sampled_from([0, 1, 3, 2**32 - 1]).map(np.uint32),
    "bool": st.booleans().map(np.bool_),
}
"""The types of fields, each with its numbers."""
UNITS = ("m", "cm", "km", "mm")


def numbers_of(names: tuple[str, ...], *, rounded: bool = False) -> st.SearchStrategy[e.Expression]:
    """Expressions of bindings that are lengths, as far as anybody checks.

    `rounded`: also computed signals that call a function whose last digits differ by library.
    """
    leaves = st.one_of(
        st.sampled_from(names).map(e.Name),
        st.builds(e.Quantity, digits, st.sampled_from(UNITS)),
        digits.map(e.Number),
    )

    def grown(parts: st.SearchStrategy[e.Expression]) -> st.SearchStrategy[e.Expression]:
        powers = st.integers(1, 4).map(lambda k: e.Number(str(k)))
        few = st.one_of(st.tuples(parts, parts), st.tuples(parts, parts, parts))
        return st.one_of(
            st.builds(e.Negation, parts),
            st.builds(e.Arithmetic, st.sampled_from(["+", "-", "*", "/", "mod"]), parts, parts),
            st.builds(e.Arithmetic, st.just("^"), st.sampled_from(names).map(e.Name), powers),
            st.builds(e.Call, st.just("abs"), st.tuples(parts)),
            st.builds(e.Call, st.sampled_from(["min", "max"]), few),
            st.builds(e.Calculation, st.just("v"), parts),
            *([st.builds(e.Calculation, st.just("w"), _calls(parts), st.just(True))] * rounded),
        )

    return st.recursive(leaves, grown, max_leaves=4)


def _calls(parts: st.SearchStrategy[e.Expression]) -> st.SearchStrategy[e.Expression]:
    """Calls of rounded functions, and what is computed of them."""
    calls = st.sampled_from([*ROUNDED.items()]).flatmap(
        lambda each: st.builds(e.Call, st.just(each[0]), st.tuples(*[parts] * each[1].least))
    )
    return st.one_of(calls, st.builds(e.Call, st.just("min"), st.tuples(calls, parts)))


def truths_of(names: tuple[str, ...], *, rounded: bool = False) -> st.SearchStrategy[e.Expression]:
    """Truth values of bindings over numbers; `x` also stands for one itself."""
    sides = numbers_of(names, rounded=rounded)
    leaves = st.one_of(
        st.builds(e.Comparison, st.sampled_from(SIGNS), sides, sides),
        st.builds(
            e.Comparison,
            st.sampled_from(SIGNS),
            st.sampled_from(names).map(e.Name),
            st.builds(e.Quantity, digits, st.sampled_from(UNITS)),
        ),
        st.sampled_from(names).map(e.Name),
        st.booleans().map(e.Truth),
    )
    return st.recursive(
        leaves,
        lambda parts: st.one_of(
            st.builds(e.Not, parts),
            st.tuples(parts, parts).map(e.And),
            st.tuples(parts, parts).map(e.Or),
            st.builds(e.Implies, parts, parts),
            st.builds(e.Iff, parts, parts),
            st.builds(e.Xor, parts, parts),
        ),
        max_leaves=4,
    )


readings_of = st.sampled_from(Reading)
invalids = st.builds(InvalidReadings, readings_of, readings_of, readings_of, readings_of)


@st.composite
def signals(draw: st.DrawFn, name: str) -> Signal:
    """A signal of numbers, of one field or of an array."""
    each = draw(st.booleans())
    found = path(f"/{name}.field" + "[:]" * each)
    assert found is not None
    chosen = draw(st.sampled_from(UNITS))
    known = unit(chosen)
    assert known is not None
    valid = draw(st.one_of(st.none(), truths_of(("x", "least", "most"))))
    reduce = draw(st.sampled_from([Reduce.MIN, Reduce.MAX])) if each else None
    return Signal(
        name,
        found,
        known,
        chosen,
        reduce=reduce,
        valid=valid,
        invalid=draw(invalids),
        max_age=draw(st.sampled_from([None, 0, 10**8])),
    )


@dataclass(frozen=True)
class Message:
    """A message of a signal: its field, the fields that `valid` reads, and its time."""

    field: Any
    least: float
    most: float
    at: int
    """-1: none has come."""


NOW = 2 * 10**8
"""The instant of every row, in nanoseconds."""


@dataclass(frozen=True)
class Case:
    """A proposition over two signals, and messages of both."""

    signals: tuple[Signal, Signal]
    tree: e.Expression
    rows: tuple[tuple[Message, Message], ...]

    def expected(self) -> list[tuple[Truth, tuple[Values, Values]]]:
        """What the audit says of each row: the truth, and the samples."""
        found = []
        for row in self.rows:
            pairs = zip(self.signals, row, strict=True)
            a, b = (audited_sample(signal, message) for signal, message in pairs)
            values = {}
            for signal, message, value in zip(self.signals, row, (a, b), strict=True):
                age = NOW - message.at
                is_old = signal.max_age is not None and age > signal.max_age
                lost = message.at < 0 or age < 0 or is_old
                values[signal.name] = np.array([np.nan]) if lost else value
            given = {signal.name: signal for signal in self.signals}
            found.append((audited_truth(self.tree, given, values), (a, b)))
        return found


@st.composite
def messages(draw: st.DrawFn, signal: Signal) -> Message:
    """A message that a signal may have."""
    kind = draw(st.sampled_from([*KINDS]))
    field = draw(KINDS[kind])
    if signal.path.each:
        items = draw(st.lists(KINDS[kind], max_size=4))
        field = np.array(items, field.dtype)
    ends = st.one_of(doubles, singles).map(float)
    at = draw(st.sampled_from([-1, 0, NOW - 10**8 - 1, NOW - 10**8, NOW, NOW, NOW, NOW + 1]))
    return Message(field, draw(ends), draw(ends), at)


@st.composite
def cases(draw: st.DrawFn) -> Case:
    """Bindings with messages."""
    a, b = (draw(signals(name)) for name in ("a", "b"))
    tree = draw(truths_of(("a", "b")))
    rows = draw(st.lists(st.tuples(messages(a), messages(b)), min_size=3, max_size=10))
    return Case((a, b), tree, tuple(rows))


def collected(count: int) -> list[Case]:
    """So many cases that the lowering takes: what a compiler is asked of at once."""
    found: list[Case] = []

    @settings(max_examples=count, database=None, suppress_health_check=[*HealthCheck])
    @given(cases())
    def collect(case: Case) -> None:
        try:
            meaning(Proposition("p", case.tree), case.signals)
        except ValueError:  # a power that is too large, which the reader of bindings refuses
            return
        found.append(case)

    collect()
    return found


def edge_cases() -> list[Case]:
    """Numbers at and beside the constant that they meet, of each kind, in each form."""
    choose, found = random.Random("edges"), list[Case]()
    constants = (*DIGITS, *map(str, EDGES), *BETWEEN)
    for place, text in enumerate(2 * (*constants, "3")):
        sign: Any = SIGNS[place % len(SIGNS)]
        fixed: e.Expression = e.Quantity(text, "m")
        fixed = e.Negation(fixed) if place % 3 == 2 else fixed
        value = Fraction(text) * (-1 if place % 3 == 2 else 1)
        tree = e.And(
            (
                e.Comparison(sign, _FORMS[place % len(_FORMS)], fixed),
                e.Comparison("<=", _REST, e.Number("0")),
            )
        )
        most = e.Call("max", (e.Name("x"), e.Name("least")))
        valid = e.Comparison("!=" if place % 4 else "=", most, fixed)
        near = [*beside(value), *map(np.float64, choose.sample(SPECIAL, 2))]
        each = place % 7 < 3
        fields = _arrays(near, choose) if each else [np.array([x]) for x in near]
        invalid = InvalidReadings(*choose.choices([*Reading], k=4))
        a, b = (_lengths(name, each, valid if each else None, invalid) for name in "ab")
        rows = [
            tuple(
                Message(array if each else array[0], float(choose.choice(near)), 0.0, NOW + late)
                for array, late in ((field, place % 5 == 4), (choose.choice(fields), 0))
            )
            for place, field in enumerate(fields)
        ]
        found.append(Case((a, b), tree, tuple((x, y) for x, y in rows)))
    return found


_A, _B, _SEVEN = e.Name("a"), e.Name("b"), e.Quantity("7", "m")
_FORMS: tuple[e.Expression, ...] = (
    _A,
    e.Call("min", (_A, _B)),
    e.Call("min", (_A, _SEVEN)),
    e.Call("max", (_A, _SEVEN)),
    e.Call("max", (e.Call("min", (_A, _B)), e.Call("abs", (_B,)))),
    e.Call("min", (e.Call("max", (_A, _B)), _SEVEN)),
)


_REST = e.Arithmetic("mod", e.Call("abs", (_B,)), e.Negation(_SEVEN))
"""It has the sign of the right side."""


def _lengths(name: str, each: bool, valid: e.Expression | None, invalid: InvalidReadings) -> Signal:
    reduce, place = Reduce.MAX if each else None, Path(f"/{name}", ("field",), each=each)
    return Signal(name, place, ONE, "m", reduce=reduce, valid=valid, invalid=invalid)


def beside(value: Fraction) -> list[Any]:
    """The numbers of each kind that are next to it, and it where it is one."""
    found: list[Any] = []
    for kind in (np.float32, np.float64):
        with np.errstate(over="ignore"):
            near = kind(float(value)) if abs(value) < 2**1024 else kind(math.inf)
            found += [near, *(np.nextafter(near, kind(end)) for end in (-math.inf, math.inf))]
    for whole in (floor(value) + step for step in (-1, 0, 1, 2)):
        found += [np.int64(whole)] if -(2**63) <= whole < 2**63 else []
        found += [np.uint64(whole)] if 0 <= whole < 2**64 else []
    return found


def _arrays(near: Sequence[Any], choose: random.Random) -> list[Any]:
    """Arrays of one kind each."""
    kinds = {x.dtype: [y for y in near if y.dtype == x.dtype] for x in near}
    return [
        np.array(choose.sample([*some, kind.type(7)], 2), kind)
        for kind, some in kinds.items()
        for _ in range(3)
    ]


def numbered(case: Case, number: int) -> FormalizedRequirement:
    """A requirement that watches the case's proposition, over signals that no other case has."""
    names = {signal.name: f"{signal.name}{number}" for signal in case.signals}

    def renamed(tree: e.Expression) -> e.Expression:
        if isinstance(tree, e.Name):
            return e.Name(names[tree.id])
        return e.with_children(tree, [*map(renamed, e.children(tree))])

    given = {names[s.name]: replace(s, name=names[s.name]) for s in case.signals}
    all_read = (e.Or((e.Name(signal.name), e.Truth(True))) for signal in case.signals)
    tree = renamed(e.And((case.tree, *all_read)))
    declared = {f"p{number}": Proposition(f"p{number}", tree)}
    declarations = Declarations(Source("bindings.toml", ""), Clock(10**8), given, declared)
    subject = requirement(f"the sw shall always satisfy p{number}", f"R{number}")
    return replace(subject, declarations=declarations)


def audited_sample(signal: Signal, message: Message) -> Values:
    """The number of a message with this field, as a log's series of one sample has it."""
    single = message.field.dtype == np.float32
    value = sample(signal, message, single=single)
    if isinstance(value, int):
        return np.array([value], EXACT)
    return np.array([value], np.float32 if single and is_chosen(signal) else np.float64)


def audited_truth(
    tree: e.Expression, given: Mapping[str, Signal], row: Mapping[str, Values]
) -> Truth:
    """What the audit says of a proposition where its signals have these numbers."""
    scales = {name: signal.scale for name, signal in given.items()}
    words = {name: signal.values for name, signal in given.items()}
    (value,) = truth_values(truth(tree, NameValues(1, row, scales=scales, words=words)))
    return value


# The descriptions, read by an interpreter over the kernel of monitors ----------------------------


def number_of(tree: n.Number, row: Mapping[str, Any]) -> Any:
    """The value of a number; `row` has what `readings.number` takes."""
    match tree:
        case n.SignalValue(name):
            return readings.number(row[name], name)
        case n.Constant(value):
            return readings.exact(str(value))
        case n.UnaryCall(function, arg):
            return getattr(readings, function)(number_of(arg, row))
        case n.Computed(function, left, right) | n.MinMax(function, left, right):
            return getattr(readings, function)(number_of(left, row), number_of(right, row))
        case n.Power(base, times):
            return readings.power(number_of(base, row), times)
        case n.ToBaseUnit(arg, scale):
            return readings.in_base(number_of(arg, row), readings.exact(str(scale)))
        case n.RoundedCall(function, args):
            return rounded(function, *(number_of(arg, row) for arg in args))
        case _:
            assert_never(tree)


def truth_of(tree: n.Truth, row: Mapping[str, Any]) -> Truth:
    """The truth of a description that asks for no duration."""
    match tree:
        case n.Known(value):
            return value
        case n.BooleanSignal(name):
            number = readings.number(row[name], name)
            return None if number not in (0, 1) else number == 1
        case n.Comparison(sign, left, right):
            return readings.compared(number_of(left, row), sign, number_of(right, row))
        case n.Not(arg):
            value = truth_of(arg, row)
            return None if value is None else not value
        case n.All(args):
            values = [truth_of(arg, row) for arg in args]
            return False if False in values else None if None in values else True
        case n.Some(args):
            values = [truth_of(arg, row) for arg in args]
            return True if True in values else None if None in values else False
        case n.Iff(left, right):
            first, second = truth_of(left, row), truth_of(right, row)
            return None if first is None or second is None else first == second
        case n.HeldFor():
            raise AssertionError("not a truth of one instant")
        case _:
            assert_never(tree)
