"""Insert computed signals into the expressions of bindings.

The value of a computed signal at an instant is that of its expression over the values of its
signals at that instant. So a proposition is true exactly if it is with the expression in place of
the name.
"""

from __future__ import annotations

from collections.abc import Mapping

from fretish import expressions as e
from fretish.bindings.declarations import ComputedSignal
from fretish.reading.recursion import with_recursion_limit

MOST_PARTS = 1000
"""The largest size of the value of a computed signal, with the values that it names."""
MOST_LEVELS = 50
"""The largest nesting depth of such a value."""


@with_recursion_limit
def with_calculations(
    expression: e.Expression, computed: Mapping[str, ComputedSignal]
) -> e.Expression:
    """The expression with the name of each computed signal as a `Calculation`."""
    if isinstance(expression, e.Name):
        signal = computed.get(expression.id)
        if signal is None:
            return expression
        return e.Calculation(signal.name, signal.value, signal.is_rounded, expression.span)
    children = e.children(expression)
    parts = [with_calculations(part, computed) for part in children]
    changed = any(part is not child for part, child in zip(parts, children, strict=True))
    return e.with_children(expression, parts) if changed else expression


@with_recursion_limit
def without_calculations(expression: e.Expression) -> e.Expression:
    """The expression with the names of computed signals."""
    if isinstance(expression, e.Calculation):
        return e.Name(expression.name, expression.span)
    parts = [without_calculations(part) for part in e.children(expression)]
    return e.with_children(expression, parts)


def with_clamps_as_ends(expression: e.Expression) -> e.Expression:
    """The expression with `clamp(x, least, most)` as `min(max(x, least), most)`."""
    parts = [with_clamps_as_ends(part) for part in e.children(expression)]
    match e.with_children(expression, parts):
        case e.Call("clamp", (number, least, most), span):
            return e.Call("min", (e.Call("max", (number, least), span), most), span)
        case other:
            return other
