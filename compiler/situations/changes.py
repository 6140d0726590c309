"""Small changes of an expression, for mutants: one operand, one operator, one threshold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import islice

from compiler.situations.thresholds import literal_number
from fretish import expressions as e
from fretish.classes.frozen import dataclass
from fretish.printer import expression

MOST_PARTS = 100
"""Maximum number of nodes of an expression whose parts are changed one by one."""


@dataclass(frozen=True, slots=True)
class ExpressionChange:
    """An expression with one thing changed."""

    operator: str
    """`dropped`, `negated`, `operator`, `compared` or `threshold`."""
    about: str
    """The text to print: the dropped or negated operand, else the new text."""
    words: str
    whole: e.Expression


def changes(whole: e.Expression) -> Iterator[ExpressionChange]:
    """Each change of one part of an expression, outer parts first; none if it is large."""
    if not is_large(whole):
        yield from _changes(whole)


def is_large(whole: e.Expression) -> bool:
    """Whether the expression is too large to change its parts one by one."""
    return sum(1 for _ in islice(e.parts(whole), MOST_PARTS + 1)) > MOST_PARTS


def _changes(whole: e.Expression) -> Iterator[ExpressionChange]:
    yield from _dropped(whole)
    yield from _other_operator(whole)
    match whole:
        case e.Comparison():
            yield from _comparison(whole)
        case e.Not() | e.And() | e.Or() | e.Xor() | e.Implies() | e.Iff():
            yield from _within(whole)
        case _:
            pass  # what a call is about is its own


def _within(whole: e.Expression) -> Iterator[ExpressionChange]:
    """Changes of one operand."""
    operands = e.children(whole)
    for index, operand in enumerate(operands):
        own = [*_changes(operand)]
        if not isinstance(whole, e.Not):  # its operand negated is the whole negated
            own.insert(0, _replaced("negated", operand, opposite(operand)))
        for change in own:
            parts = (*operands[:index], change.whole, *operands[index + 1 :])
            yield replace(change, whole=e.with_children(whole, parts))


def opposite(part: e.Expression) -> e.Expression:
    """The negation, without double negation."""
    return part.arg if isinstance(part, e.Not) else e.Not(part)


def _dropped(whole: e.Expression) -> Iterator[ExpressionChange]:
    """The changes that drop one operand of a conjunction or disjunction."""
    if not isinstance(whole, e.And | e.Or):
        return
    for index, operand in enumerate(whole.args):
        rest = (*whole.args[:index], *whole.args[index + 1 :])
        text = expression(operand)
        less = rest[0] if len(rest) == 1 else replace(whole, args=rest)
        yield ExpressionChange("dropped", text, f"without `{text}`", less)


def _other_operator(whole: e.Expression) -> Iterator[ExpressionChange]:
    """The changes of an operator, such as `|` for `&`."""
    match whole:
        case e.And(args):
            yield _replaced("operator", whole, e.with_children(e.Or(args), args))
        case e.Or(args):
            yield _replaced("operator", whole, e.with_children(e.And(args), args))
        case e.Xor(left, right):
            yield _replaced("operator", whole, e.either(left, right))
        case e.Implies(left, right):
            yield _replaced("operator", whole, e.Iff(left, right))
        case e.Iff(left, right):
            yield _replaced("operator", whole, e.Implies(left, right))
        case _:
            pass


_NEAR: Mapping[e.ComparisonOperator, tuple[e.ComparisonOperator, ...]] = {
    "<": ("<=", ">"),
    "<=": ("<", ">="),
    ">": (">=", "<"),
    ">=": (">", "<="),
    "=": (),
    "!=": (),
}
"""Similar comparison operators; `=` has none, since `negated` covers it."""


def _comparison(whole: e.Comparison) -> Iterator[ExpressionChange]:
    for op in _NEAR[whole.op]:
        yield _replaced("compared", whole, replace(whole, op=op))
    for other in _moved(whole.left):
        yield _replaced("threshold", whole, replace(whole, left=other))
    for other in _moved(whole.right):
        yield _replaced("threshold", whole, replace(whole, right=other))


def _moved(side: e.Expression) -> Iterator[e.Expression]:
    """The number plus and minus one step."""
    number = literal_number(side)
    if number is not None:
        yield from (number.moved(number.step), number.moved(-number.step))


def _replaced(operator: str, old: e.Expression, new: e.Expression) -> ExpressionChange:
    was, now = expression(old), expression(new)
    about = was if operator == "negated" else now
    return ExpressionChange(operator, about, f"`{now}` in place of `{was}`", new)
