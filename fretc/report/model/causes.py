"""The cause of a violation in words, where it follows from the evidence of its first tick.

Examples: `the last sample of `clearance` was 304 ms old, 300 ms are allowed`; `vx` was 0.52 m/s,
must be at most 0.5 m/s`. No cause is given if the evidence does not determine it: for a value too
near its bound for the rounding of samples, for `for 200 ms`, for `pre`, for several samples in one
tick, and for signals of unknown age.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from fractions import Fraction
from functools import partial
from math import inf, isfinite, isnan
from typing import Protocol, TypeVar, assert_never

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import atom, variable
from fretc.audit.evidence.schema import Result, Violation
from fretc.audit.measurements.intervals import end_s, interval_words
from fretc.report.model import phrases
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.amounts import shared_unit
from fretish.bindings.declarations import Aggregate, Declarations, Proposition, Signal
from fretish.bindings.expressions import ticks_back
from fretish.classes.frozen import dataclass
from fretish.printer import expression
from fretish.units import base_name, unit

_NEAR = 1e-6
"""A relative difference up to this may come from the rounding of 32-bit samples."""
_MOST = 4
"""Maximum number of causes for one violation."""
C = TypeVar("C")


@dataclass(frozen=True, slots=True)
class Cause:
    """A proposition at the first violated tick, and why it has its value."""

    proposition: str
    value: bool
    text: str


# The sentence ----------------------------------------------------------------------------------


def falsity(violation: Violation, result: Result, requirement: FormalizedRequirement | None) -> str:
    """`` `stopped` was false from 3.2 s to 4.1 s, but had to be true by 3.4 s``.

    Empty if the timing or scope of the sentence does not determine the response at that tick.
    """
    if requirement is None or _is_indirect(requirement):
        return ""
    missing = expression(requirement.written.response)
    when = interval_words(violation.first, violation.last, result.clock)
    match requirement.sentence.timing:
        case s.Within():
            deadline_ticks = requirement.ticks or 0
            trigger, deadline = violation.trigger, violation.deadline
            if trigger is None or deadline is None or deadline.tick > violation.first_tick:
                return ""
            if trigger.tick < violation.first_tick - deadline_ticks:
                return ""
            since, due = phrases.seconds(trigger.seconds), phrases.seconds(deadline.seconds)
            end = end_s(violation.last, result.clock)
            until = violation.last.seconds if end is None else end
            when = f"from {since} to {phrases.seconds(until)}"
            return f"`{missing}` was false {when}, but had to be true by {due}"
        case s.Always() | s.For() | s.Immediately():
            return f"`{missing}` was false {when}, but had to be true"
        case s.Never():
            return f"`{missing}` was true {when}, but had to be false"
        case s.Next() | s.Finally() | s.Eventually() | s.After() | s.Until() | s.Before():
            return ""
        case _:
            assert_never(requirement.sentence.timing)


def _is_indirect(requirement: FormalizedRequirement) -> bool:
    """Whether a violated tick does not determine the response: negated scope, or probability."""
    sentence = requirement.sentence
    negated = sentence.scope is not None and sentence.scope.kind.negates
    return negated or sentence.probability is not None


# The propositions ------------------------------------------------------------------------------


def causes(
    violation: Violation, result: Result, requirement: FormalizedRequirement | None
) -> tuple[Cause, ...]:
    """Why the response did not have the required value; empty if the evidence leaves that open.

    Args:
        violation: a violation of the result.
        result: the result of the run, in declared units.
        requirement: the requirement that was judged; None if unknown.
    """
    if requirement is None or requirement.declarations is None or _is_indirect(requirement):
        return ()
    wanted = _wanted(requirement.sentence.timing)
    if wanted is None:
        return ()
    at = _ViolationTick(violation, result, requirement.declarations)
    found = _against(requirement.sentence.response, wanted=wanted, at=at)
    return tuple(dict.fromkeys(found or ()))


def _wanted(timing: s.Timing) -> bool | None:
    """The required value of the response at a violated tick; None if undetermined."""
    match timing:
        case s.Within() | s.Always() | s.For() | s.Immediately():
            return True
        case s.Never():
            return False
        case s.Next() | s.Finally() | s.Eventually() | s.After() | s.Until() | s.Before():
            return None
        case _:
            assert_never(timing)


def in_words(some: Sequence[Cause]) -> str:
    """The causes as one clause of a sentence."""
    texts = list(dict.fromkeys(cause.text for cause in some))
    more = len(texts) - _MOST
    return "; ".join([*texts[:_MOST], *([f"{more} more"] if more > 0 else [])])


def _against(tree: e.Expression, *, wanted: bool, at: _ViolationTick) -> list[Cause] | None:
    """Why a part of the sentence does not have the wanted value; None if it may have it."""
    match tree:
        case e.Name() | e.Comparison():
            name = variable(tree.id) if isinstance(tree, e.Name) else atom(tree)
            proposition = at.declarations.propositions.get(name)
            return None if proposition is None else _of_proposition(proposition, wanted, at)
        case _:
            return _composed(tree, wanted, partial(_against, at=at))


def _of_proposition(
    proposition: Proposition, wanted: bool, at: _ViolationTick
) -> list[Cause] | None:
    tree = proposition.expression
    if ticks_back(tree):
        return None
    if not _decides(proposition.aggregate, value=not wanted):
        return None
    texts = _texts(tree, wanted=wanted, at=at)
    if texts is not None:
        return [Cause(proposition.name, not wanted, text) for text in texts]
    if proposition.on_unknown is not (not wanted) or not _is_unknown(tree, at):
        return None
    why = phrases.joined([at.why_unknown(name) for name in proposition.signals])
    counts = f"{why}, so `{proposition.name}` counts as {str(not wanted).lower()}"
    return [Cause(proposition.name, not wanted, counts)]


def _decides(aggregate: Aggregate, *, value: bool) -> bool:
    """Whether a last sample with this value determines the value of the tick."""
    return aggregate == Aggregate.LAST or aggregate == (Aggregate.ANY if value else Aggregate.ALL)


def _is_unknown(tree: e.Expression, at: _ViolationTick) -> bool:
    """Whether every part of an expression certainly is unknown."""
    if isinstance(tree, e.Persistence | e.Truth):
        return False
    if isinstance(tree, e.Comparison | e.Name):
        read = [name.id for name in e.names(tree)]
        return bool(read) and all(at.value(name) == _UNKNOWN for name in read)
    return all(_is_unknown(part, at) for part in e.children(tree))


# An expression of the bindings -----------------------------------------------------------------


def _texts(tree: e.Expression, *, wanted: bool, at: _ViolationTick) -> list[str] | None:
    """Why an expression does not have the wanted truth value; None if it may have it."""
    match tree:
        case e.Name(id):
            value = at.value(id)
            if value not in (0, 1) or bool(value) == wanted:
                return None
            now, needed = ("true", "false") if value else ("false", "true")
            return [f"`{id}` was {now}, but had to be {needed}"]
        case e.Comparison():
            return _of_comparison(tree, wanted, at)
        case e.Persistence(arg):
            return _texts(arg, wanted=True, at=at) if wanted else None
        case _:
            return _composed(tree, wanted, partial(_texts, at=at))


_NEGATED: Mapping[str, str] = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "=": "!=", "!=": "="}
_NEEDED = {
    "<": "must be below {}",
    "<=": "must be at most {}",
    ">": "must be above {}",
    ">=": "must be at least {}",
    "=": "must be {}",
    "!=": "must not be {}",
}


def _of_comparison(tree: e.Comparison, wanted: bool, at: _ViolationTick) -> list[str] | None:
    left, op, right = tree.left, str(tree.op), tree.right
    if not any(True for _ in e.names(left)) or isinstance(left, e.Word):
        left, right, op = right, left, e.MIRRORED.get(op, op)
    needed = _NEEDED[op if wanted else _NEGATED[op]]
    if isinstance(right, e.Word):
        word = at.value(left.id) if isinstance(left, e.Name) else None
        if not isinstance(word, str) or word == _UNKNOWN:
            return None
        if ((word == right.text) == (op == "=")) == wanted:
            return None
        return [f'`{_written(left)}` was "{word}", {needed.format(f"`{right.text}`")}']
    value, bound = at.number(left), at.number(right)
    if value is None or bound is None or _holds(op, value, bound) is not (not wanted):
        return None
    return [_measured(left, right, needed, (value, bound), at)]


def _written(tree: e.Expression) -> str:
    """The expression as written in the bindings."""
    return tree.id if isinstance(tree, e.Name) else expression(tree)


def _holds(op: str, left: float, right: float) -> bool | None:
    """Whether the comparison holds; None if rounding could decide."""
    if isnan(left) or isnan(right):
        return None
    if isfinite(left) and isfinite(right):
        near = _NEAR * max(abs(left), abs(right))
        if abs(left - right) <= near and not (left == right == 0):
            return None
    elif left == right:
        return None
    return {
        "<": left < right,
        "<=": left <= right,
        ">": left > right,
        ">=": left >= right,
        "=": left == right,
        "!=": left != right,
    }[op]


def _measured(
    left: e.Expression,
    right: e.Expression,
    needed: str,
    sides: tuple[float, float],
    at: _ViolationTick,
) -> str:
    """The measured value and the allowed one, in the unit of the sentence."""
    name = f"`{_written(left)}`"
    if isinstance(right, e.Number | e.Quantity):
        written = unit(right.unit) if isinstance(right, e.Quantity) else None
        factor = written.factor if written else Fraction(1)
        shown = right.unit if isinstance(right, e.Quantity) else ""
        value, bound = (_over(side, factor) for side in sides)
        measured = phrases.value(value, shown, [bound])
        return f"{name} was {measured}, {needed.format(expression(right))}"
    other = f"`{_written(right)}`"
    shown, factor = at.unit_of(left, right)
    if not shown:
        return f"{name} was on the wrong side of {other}: {needed.format(other)}"
    value, bound = (_over(side, factor) for side in sides)
    measured, limit = phrases.value(value, shown, [bound]), phrases.value(bound, shown, [value])
    return f"{name} was {measured}, {needed.format(f'{other}, {limit},')}"


def _over(number: float, factor: Fraction) -> float:
    return _float(Fraction(number) / factor) if isfinite(number) else number


# The first broken tick -------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _ViolationTick:
    """The monitor's inputs at the first tick of a violation, as far as the evidence has them."""

    violation: Violation
    result: Result
    declarations: Declarations
    values: dict[str, float | str | None] = field(default_factory=dict)

    def value(self, name: str) -> float | str | None:
        """A number in its declared unit, a word, `_UNKNOWN`; None if not in the evidence."""
        if name not in self.values:
            signal = self.declarations.signals.get(name)
            self.values[name] = None if signal is None else self._value(name, signal)
        return self.values[name]

    def _value(self, name: str, signal: Signal) -> float | str | None:
        if name not in self.violation.values:
            return None
        if self.violation.window is None:
            certain = signal.max_age is None and not self.result.health.gaps
            return self.violation.values[name] if certain else None
        sample = self._sample(name)
        if sample is None:
            return _UNKNOWN
        time, value = sample
        if value is None or self._is_old(time, signal) or self._is_in_gap(time):
            return _UNKNOWN
        return value

    def _sample(self, name: str) -> tuple[float, float | str | None] | None:
        """The time and the value of the last sample up to the tick."""
        window = self.violation.window
        samples = window and (window.samples.get(name) or window.words.get(name))
        if not samples:
            return None
        at = self.violation.start_s
        times = [time for time in samples.times if time <= at]
        return (times[-1], samples.at(at)) if times else None

    def _is_old(self, time: float, signal: Signal) -> bool:
        limit = signal.max_age
        return limit is not None and round(self.violation.start_s - time, 9) > limit / 1e9

    def _is_in_gap(self, time: float) -> bool:
        """Whether messages were lost since the sample."""
        now = self.violation.start_ns
        sampled = now - round((self.violation.start_s - time) * 1e9)
        gaps = self.result.health.gaps
        return any(gap.start_ns <= now and sampled <= gap.end_ns for gap in gaps)

    def why_unknown(self, name: str) -> str:
        """`` the last sample of `clearance` was 304 ms old, 300 ms are allowed``."""
        signal, sample = self.declarations.signals[name], self._sample(name)
        if sample is None or signal.max_age is None or not self._is_old(sample[0], signal):
            return f"`{name}` was unknown"
        age, limit = (self.violation.start_s - sample[0]) * 1e3, signal.max_age / 1e6
        return (
            f"the last sample of `{name}` was {_duration(age, limit)} old, "
            f"{_duration(limit, limit)} are allowed"
        )

    def number(self, tree: e.Expression) -> float | None:
        """The number in base units; None if it is not a number, or unknown."""
        import numpy as np

        from fretc.logs.signals.measures import ExpressionError, Measure, NameValues, term

        names = {name.id for name in e.names(tree)}
        values = {name: self.value(name) for name in names}
        numbers = {n: v for n, v in values.items() if isinstance(v, float | int)}
        if len(numbers) < len(names):
            return None
        scope = NameValues(
            1,
            {name: np.array([float(value)]) for name, value in numbers.items()},
            scales={name: self.declarations.signals[name].unit.factor for name in names},
        )
        try:
            found = term(tree, scope)
        except (ExpressionError, ValueError, OverflowError):
            return None
        number = float(found.base[0]) if isinstance(found, Measure) else _float(found)
        return None if isnan(number) else number

    def unit_of(self, *trees: e.Expression) -> tuple[str, Fraction]:
        """The common unit of the signals of some simple terms, or ""."""
        names = [name.id for tree in trees for name in e.names(tree)]
        simple = all(len([*e.parts(tree)]) <= 2 for tree in trees)
        units = {self.declarations.signals[name].unit for name in names}
        if not simple or len(units) != 1:
            return "", Fraction(1)
        base = base_name(units.pop().dimension)
        return shared_unit(" ".join(names), base, self.declarations.signals)


_UNKNOWN = "\0unknown"
"""A marker that differs from all words of signals, which are printable."""


def _float(number: Fraction) -> float:
    try:
        return float(number)
    except OverflowError:
        return inf if number > 0 else -inf


def _duration(milliseconds: float, limit: float) -> str:
    """`304 ms`, `1.2 s`: with enough digits to differ from the limit."""
    if max(milliseconds, limit) < 1000:
        return phrases.value(round(milliseconds, 6), "ms", [limit])
    return phrases.value(round(milliseconds / 1e3, 9), "s", [limit / 1e3])


# Made of truth values --------------------------------------------------------------------------


class _Explain(Protocol[C]):
    def __call__(self, tree: e.Expression, /, *, wanted: bool) -> list[C] | None:
        """Why a part does not have the wanted value; None if it may have it."""


def _composed(tree: e.Expression, wanted: bool, explain: _Explain[C]) -> list[C] | None:
    """Why a Boolean combination does not have the wanted value."""
    match tree:
        case e.Truth(value):
            return [] if value != wanted else None
        case e.Not(arg):
            return explain(arg, wanted=not wanted)
        case e.Implies(left, right):
            return _composed(e.Or((e.Not(left), right)), wanted, explain)
        case e.And(args) | e.Or(args):
            found = [explain(arg, wanted=wanted) for arg in args]
            certain = [explanation for explanation in found if explanation is not None]
            one_is_enough = isinstance(tree, e.And) == wanted
            if not certain or (len(certain) < len(found) and not one_is_enough):
                return None
            return [cause for explanation in certain for cause in explanation]
        case _:
            return None
