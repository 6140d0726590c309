"""Comparisons of sentences as code: truth values of propositions from the variables of a tick.

The numbers of a sentence have the units of the signals beside them. Constant expressions are
computed here, exactly; everything else is computed by the functions of `monitors.kernel.readings`,
as in an audit (`fretc.logs.signals.measures`). A comparison with any other expression stays a
proposition. The code consists of calls of these functions, so it is both Python and JavaScript; the
languages differ in how they write constants.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field
from fractions import Fraction

from compiler.files.templating import python
from compiler.formalization.obligation import variable
from fretish import expressions as e
from fretish.bindings.constants import called, computed, whole_exponent
from fretish.classes.frozen import dataclass
from fretish.units import unit

NUMBER, TRUTH, WORD = "number", "truth", "word"
"""The kinds of variables."""
ANNOTATIONS: Mapping[str, str] = {NUMBER: "Number", TRUTH: "Truth", WORD: '"str | None"'}
"""The annotation of a parameter for each kind of variable."""


@dataclass(frozen=True, slots=True)
class StepInput:
    """A variable that is an input of a step."""

    kind: str
    words: tuple[str, ...] = ()
    """The values of an enumeration variable."""
    infinite: tuple[str, ...] = ()
    """The infinities (`+inf`, `-inf`) that have a meaning for a numeric variable; others are
    unknown."""


@dataclass(frozen=True, slots=True)
class CompiledComparison:
    """A comparison that can be compiled, with its inputs and units."""

    inputs: Mapping[str, StepInput]
    """The variables of the comparison."""
    tree: e.Comparison
    units: Mapping[str, tuple[str, Fraction]]
    """The unit of each variable that is a signal, and its factor to base units."""

    @property
    def is_of_words(self) -> bool:
        """Whether the variables are enumeration values."""
        return any(variable.kind == WORD for variable in self.inputs.values())


class NotCompiledError(Exception):
    """The expression has no meaning as a number here."""


@dataclass(frozen=True, slots=True)
class _Term:
    """A number as code; a constant has its exact value instead."""

    text: str
    scale: Fraction | None = None
    """The factor from its unit to the base unit; None: it has no unit, and takes that of the number
    beside it."""
    exact: Fraction | None = None


_UNKNOWN = _Term("None")
_ARITHMETIC = {"+": "plus", "-": "minus", "*": "times", "/": "over", "mod": "modulo"}
_CALLS = {
    name + kind: function
    for name, function in (("abs", "abs"), ("min", "min"), ("max", "max"))
    for kind in ("", "Real", "Int")
}
_ENDS = {"min": "lesser", "max": "greater"}
FUNCTIONS = frozenset(
    "measurement truth_value word exact compared is_word plus minus times over modulo power "
    "negative absolute lesser greater in_base first".split()
)
"""The functions that an adapter's code calls."""
NAMES = FUNCTIONS | {"kept"}
"""The reserved names in an adapter's code."""


@dataclass(frozen=True, slots=True)
class Spelling:
    """A language's syntax of constants."""

    number: Callable[[Fraction], str]
    scale: Callable[[Fraction], str]
    """Writes the factor of a number."""
    truth: Callable[[bool | None], str]
    """Writes a truth value; None: unknown."""


def _number(value: Fraction) -> str:
    return f'exact("{fraction_text(value)}")'


def _scale(value: Fraction) -> str:
    return f'exact("{value}")'


PYTHON = Spelling(_number, _scale, str)


@dataclass(slots=True)
class ComparisonWriter:
    """The writer of comparisons; values that they look back at are stored from tick to tick."""

    parameters: Mapping[str, str]
    """The parameter of each variable."""
    spelling: Spelling = PYTHON
    units: Mapping[str, tuple[str, Fraction]] = field(default_factory=dict)
    earlier: dict[tuple[str, str], str] = field(default_factory=dict)
    """(expression, initial value) → name of the stored value."""

    def comparison(self, compared: CompiledComparison) -> str:
        """The code for the truth of a comparison.

        Raises:
            NotCompiledError: the comparison contains an expression that is not a number here.
        """
        self.units = compared.units
        op = compared.tree.op
        if compared.is_of_words:
            return self._spoken(compared, op)
        if not compared.units.keys() >= compared.inputs.keys() and e.has_unit(compared.tree):
            raise NotCompiledError  # nothing says in which unit the variable is
        left, right = self._term(compared.tree.left), self._term(compared.tree.right)
        if _UNKNOWN in (left, right):
            return self.spelling.truth(None)
        left, right, _ = self._in_one_unit(left, right)
        if left.exact is not None and right.exact is not None:
            return self.spelling.truth(e.COMPARE[op](left.exact, right.exact))
        text = f'compared({self._text(left)}, "{op}", {self._text(right)})'
        if max(map(_nesting, (text, *itertools.chain(*self.earlier)))) > _MOST_NESTING:
            raise NotCompiledError
        return text

    def _spoken(self, compared: CompiledComparison, op: str) -> str:
        sides = (compared.tree.left, compared.tree.right)
        first, second = (
            python(side.text) if isinstance(side, e.Word) else self.parameters[variable(side.id)]
            for side in sides
            if isinstance(side, e.Word | e.Name)
        )
        return f'is_word({first}, "{op}", {second})'

    def _term(self, tree: e.Expression) -> _Term:
        match tree:
            case e.Number(digits) if _WRITTEN.fullmatch(digits):
                return _constant(Fraction(digits))
            case e.Quantity(digits, name) if _WRITTEN.fullmatch(digits):
                own_unit = unit(name)
                assert own_unit is not None, "the parser refuses unknown units"
                return _constant(Fraction(digits), own_unit.factor)
            case e.Name(id) if variable(id) in self.parameters:
                name = variable(id)
                scale = self.units[name][1] if name in self.units else None
                return _Term(self.parameters[name], scale)
            case e.Negation(arg):
                term = self._term(arg)
                return self._applied("negative", term, None if term.exact is None else -term.exact)
            case e.Arithmetic(op, left, right):
                return self._arithmetic(op, self._term(left), self._term(right))
            case e.Call(name, args) if name in ("preInt", "preReal") and len(args) == 2:
                return self._before(*map(self._term, args))
            case e.Call(name, args) if name in _CALLS and args:
                return self._call(_CALLS[name], [self._term(arg) for arg in args])
            case _:
                raise NotCompiledError

    def _arithmetic(self, op: e.ArithmeticOperator, left: _Term, right: _Term) -> _Term:
        if _UNKNOWN in (left, right):
            return _UNKNOWN
        if op == "^":
            return self._power(left, right)
        if op in ("*", "/"):
            left, right = (_plain(side) for side in (left, right))
            scale = _combined(op, left.scale, right.scale)
        else:
            left, right, scale = self._in_one_unit(left, right)
        if left.exact is not None and right.exact is not None:
            return _constant(computed(op, left.exact, right.exact), scale)
        return _Term(f"{_ARITHMETIC[op]}({self._text(left)}, {self._text(right)})", scale)

    def _call(self, name: str, args: Sequence[_Term]) -> _Term:
        if name == "abs":
            if len(args) != 1:
                raise NotCompiledError
            (term,) = args
            return self._applied("absolute", term, None if term.exact is None else abs(term.exact))
        combined, *rest = args
        for term in rest:
            if _UNKNOWN in (combined, term):
                return _UNKNOWN
            first, second, scale = self._in_one_unit(combined, term)
            if first.exact is not None and second.exact is not None:
                combined = _constant(called(name, [first.exact, second.exact]), scale)
            else:
                text = f"{_ENDS[name]}({self._text(first)}, {self._text(second)})"
                combined = _Term(text, scale)
        return combined

    def _before(self, initial: _Term, term: _Term) -> _Term:
        """The value of the tick before; at the first tick, the initial value."""
        if _UNKNOWN in (initial, term):  # a mistake in the sentence: nothing is compared with it
            raise NotCompiledError
        before, now, scale = self._in_one_unit(initial, term)
        text = self._text(now)
        key = f"first({self._text(before)})", text if now.exact is None else f"first({text})"
        name = self.earlier.setdefault(key, f"_earlier_{len(self.earlier) + 1}")
        return _Term(name, scale)

    def _text(self, term: _Term) -> str:
        return term.text if term.exact is None else self.spelling.number(term.exact)

    def _in_one_unit(self, left: _Term, right: _Term) -> tuple[_Term, _Term, Fraction | None]:
        """Both terms in one unit, and its factor, which is that of the measured term."""
        if left.scale is None or right.scale is None or left.scale == right.scale:
            return left, right, right.scale if left.scale is None else left.scale
        if left.exact is not None and right.exact is None:
            return _constant(left.exact * left.scale / right.scale, right.scale), right, right.scale
        if right.exact is not None and left.exact is None:
            return left, _constant(right.exact * right.scale / left.scale, left.scale), left.scale
        return self._in_base(left, left.scale), self._in_base(right, right.scale), Fraction(1)

    def _in_base(self, term: _Term, scale: Fraction) -> _Term:
        if term.exact is not None:
            return _constant(term.exact * scale, Fraction(1))
        text = f"in_base({self._text(term)}, {self.spelling.scale(scale)})"
        return _Term(text, Fraction(1))

    def _applied(self, function: str, term: _Term, exact: Fraction | None) -> _Term:
        if term == _UNKNOWN or exact is not None:
            return _constant(exact, term.scale)
        return _Term(f"{function}({self._text(term)})", term.scale)

    def _power(self, base: _Term, exponent: _Term) -> _Term:
        if exponent.exact is None:
            raise NotCompiledError
        try:
            times = whole_exponent(exponent.exact)
            value = None if base.exact is None else computed("^", base.exact, exponent.exact)
        except ValueError:
            raise NotCompiledError from None
        scale = None if base.scale is None else base.scale**times
        if value is not None:
            return _constant(value, scale)
        return _Term(f"power({self._text(base)}, {times})", scale)


def threshold(compared: CompiledComparison) -> tuple[str, Fraction] | None:
    """The variable of a comparison with a number, and the number in its unit."""
    names = {name: name for name in compared.inputs}
    writer = ComparisonWriter(names, units=compared.units)
    tree = compared.tree
    for side, other in ((tree.left, tree.right), (tree.right, tree.left)):
        if isinstance(side, e.Name) and not any(e.names(other)) and not compared.is_of_words:
            _, limit, _ = writer._in_one_unit(writer._term(side), writer._term(other))
            if limit.exact is not None:
                return variable(side.id), limit.exact
    return None


def numbers(compared: CompiledComparison) -> Iterator[Fraction]:
    """The numbers in a comparison."""
    for part in e.parts(compared.tree.left), e.parts(compared.tree.right):
        for node in part:
            if isinstance(node, e.Number | e.Quantity) and _WRITTEN.fullmatch(node.digits):
                yield Fraction(node.digits)


_WRITTEN = re.compile(r"\d{1,60}(?:\.\d{1,60})?(?:[eE][+-]?\d{1,3})?", re.ASCII)
"""A number with at most as many digits as the bindings allow."""


_MOST_BITS = 1 << 13
"""Maximum size of a constant: Python reads at most 4 300 digits."""


def _constant(value: Fraction | None, scale: Fraction | None = None) -> _Term:
    if value is None:
        return _UNKNOWN
    if max(map(int.bit_length, value.as_integer_ratio())) > _MOST_BITS:
        raise NotCompiledError
    return _Term("", scale, value)


def fraction_text(value: Fraction) -> str:
    """A fraction as text: a short decimal, else a quotient such as `25/18`."""
    for places in range(_MOST_PLACES + 1):
        digits = value * 10**places
        if digits.denominator == 1:
            whole, part = divmod(abs(digits.numerator), 10**places)
            return f"{'-' * (value < 0)}{whole}" + (f".{part:0{places}}" if places else "")
    return str(value)


_MOST_PLACES = 12


def _plain(factor: _Term) -> _Term:
    """The factor; a constant is in its base unit."""
    if factor.exact is None or factor.scale is None:
        return factor
    return _constant(factor.exact * factor.scale, Fraction(1))


def _combined(op: str, left: Fraction | None, right: Fraction | None) -> Fraction | None:
    """The factor of a product or a quotient."""
    if left is None and right is None:
        return None
    a, b = (Fraction(1) if factor is None else factor for factor in (left, right))
    return a * b if op == "*" else a / b


_MOST_NESTING = 150
"""Maximum depth of parentheses; Python reads 200."""


def _nesting(text: str) -> int:
    """The depth of nested parentheses."""
    return max(itertools.accumulate((c == "(") - (c == ")") for c in text))
