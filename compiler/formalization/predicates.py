"""The meaning of FRETish's temporal predicates at a tick k of an interval [L, R].

`persisted`, `occurred`, `prevOcc`, `preBool` and `FTP` look back; `persists`, `occurs` and
`nextOcc` look ahead. In a formula of the other direction they stay propositions. None looks beyond
the interval, with two exceptions: `preBool` reads the whole trace, and the expression of a scope
has no interval yet. Source: SEMANTICS of FRETish, section 3, built-in predicates.
"""

from __future__ import annotations

from collections.abc import Callable

from compiler.formalization.future import end_marker
from compiler.formalization.obligation import Expand, Read
from compiler.formalization.past import first_marker
from compiler.logic.formula import (
    FALSE,
    FIRST,
    LAST,
    TRUE,
    Formula,
    Interval,
    and_,
    eventually,
    historically,
    next_,
    not_,
    once,
    or_,
    previous,
    since,
    until,
    weak_previous,
)
from fretish import expressions as e
from fretish.syntax import ScopeKind

_Bounded = Callable[[int, int, Formula], Formula]
_Pair = Callable[[Formula, Formula], Formula]


class Past:
    """The predicates that look back, as past-time formulas."""

    def alone(self) -> Expand:
        """Over the whole trace; `prevOcc` asks for an occurrence, `preBool` stays."""

        def previous_occurrence(p: Formula, q: Formula) -> Formula:
            return previous(since(not_(p), and_(p, q)))

        return _expand(
            {
                "persisted": lambda lo, hi, p: historically(p, Interval(lo, hi)),
                "occurred": lambda lo, hi, p: once(p, Interval(lo, hi)),
            },
            {"prevOcc": previous_occurrence},
            FIRST,
        )

    def inside(self, scope: ScopeKind | None, mode: Formula) -> Expand:
        """Back to the first tick of the interval."""
        left = first_marker(scope, mode)

        def persisted(lo: int, hi: int, p: Formula) -> Formula:
            """K - hi lies in the interval, and p held on k-hi..k-lo."""
            begun = once(left, Interval(0, hi - 1)) if hi else FALSE
            return and_(historically(p, Interval(lo, hi)), not_(begun))

        def occurred(lo: int, hi: int, p: Formula) -> Formula:
            """P held at some tick of k-hi..k-lo in the interval."""
            if left == FIRST:
                return once(p, Interval(lo, hi))
            return since(not_(left), p, Interval(lo, hi))

        def previous_occurrence(p: Formula, q: Formula) -> Formula:
            """At the latest tick of L..k-1 with p there was q; true where there is none."""
            if left == FIRST:
                return weak_previous(not_(since(not_(p), and_(p, not_(q)))))
            missed = since(and_(not_(left), not_(p)), and_(p, not_(q)))
            return or_(left, previous(not_(missed)))

        return _expand(
            {"persisted": persisted, "occurred": occurred},
            {"prevOcc": previous_occurrence, "preBool": _previous_value},
            FIRST,
        )


def _previous_value(initial: Formula, p: Formula) -> Formula:
    """P at the tick before; `initial` at tick 0."""
    if initial == TRUE:
        return weak_previous(p)
    return or_(and_(FIRST, initial), previous(p))


class Future:
    """The predicates that look ahead, as future-time formulas about finite traces."""

    def alone(self) -> Expand:
        """Up to the end of the trace; `nextOcc` asks for an occurrence."""

        def occurs(lo: int, hi: int, p: Formula) -> Formula:
            return _ahead(lo, hi, p, LAST)

        def next_occurrence(p: Formula, q: Formula) -> Formula:
            occurrence = until(and_(not_(LAST), not_(p)), and_(p, q))
            return and_(not_(LAST), next_(occurrence))

        return _expand(
            {"persists": lambda lo, hi, p: not_(occurs(lo, hi, not_(p))), "occurs": occurs},
            {"nextOcc": next_occurrence},
        )

    def inside(self, scope: ScopeKind | None, mode: Formula) -> Expand:
        """Up to the last tick of the interval."""
        end = end_marker(scope, mode)

        def persists(lo: int, hi: int, p: Formula) -> Formula:
            """K + hi lies in the interval, and p holds on k+lo..k+hi."""
            ends = eventually(end, Interval(0, hi - 1)) if hi else FALSE
            return and_(not_(_ahead(lo, hi, not_(p), end)), not_(ends))

        def next_occurrence(p: Formula, q: Formula) -> Formula:
            """At the next tick of k+1..R with p there is q; true where there is none."""
            missed = until(and_(not_(end), not_(p)), and_(p, not_(q)))
            return or_(end, next_(not_(missed)))

        return _expand(
            {"persists": persists, "occurs": lambda lo, hi, p: _ahead(lo, hi, p, end)},
            {"nextOcc": next_occurrence},
        )


def _ahead(lo: int, hi: int, p: Formula, end: Formula) -> Formula:
    """P at some tick of k+lo..k+hi that does not lie behind the next `end`.

    The nearest p decides: it must come before the end, and soon enough.
    """
    near = and_(until(not_(end), p), eventually(p, Interval(0, hi - lo)))
    if lo == 0:
        return near
    return and_(
        not_(eventually(end, Interval(0, lo - 1))),
        eventually(near, Interval(lo, lo)),
    )


def _expand(
    bounded: dict[str, _Bounded], pairs: dict[str, _Pair], first: Formula | None = None
) -> Expand:
    """The calls `name(n, p)`, `name(lo, hi, p)` and `name(p, q)`; anything else stays."""

    def expand(name: str, args: tuple[e.Expression, ...], read: Read) -> Formula | None:
        if name == "FTP":
            return first
        if name in pairs and len(args) == 2:
            return pairs[name](read(args[0]), read(args[1]))
        bounds = bounds_of(name, args)
        if name in bounded and bounds is not None:
            return bounded[name](*bounds, read(args[-1]))
        return None

    return expand


def bounds_of(name: str, args: tuple[e.Expression, ...]) -> tuple[int, int] | None:
    """`(lo, hi)` of `name(n, p)` and `name(lo, hi, p)`; None where they are no whole numbers."""
    numbers = [arg.digits for arg in args[:-1] if isinstance(arg, e.Number)]
    if len(numbers) != len(args) - 1 or not all(digits.isdigit() for digits in numbers):
        return None
    match [int(digits) for digits in numbers]:
        case [n]:
            return 0, n
        case [lo, hi] if lo <= hi:
            return lo, hi
        case _:
            return None
