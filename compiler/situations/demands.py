"""The coverage goals of each timing: answered at once, at the last tick, one tick too late, never.

For an `only` scope they are the goals of the dual, which it demands outside of the scope.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import assert_never

from compiler.formalization.obligation import ObligationKind
from compiler.logic import formula as f
from compiler.situations.tick_predicates import TickPredicates

Rows = Iterator[tuple[str, f.Formula]]
"""Keys with past-time formulas; FALSE if no interval ends."""


def of_demand(predicates: TickPredicates) -> Rows:
    """The coverage goals of a sentence's timing."""
    return _rows(predicates.demand.kind)(predicates)


def _rows(kind: ObligationKind) -> Callable[[TickPredicates], Rows]:
    match kind:
        case ObligationKind.IMMEDIATELY:
            return _immediately
        case ObligationKind.NEXT:
            return _next
        case ObligationKind.FINALLY:
            return _finally
        case ObligationKind.EVENTUALLY:
            return _eventually
        case ObligationKind.ALWAYS:
            return _always
        case ObligationKind.WITHIN:
            return _within
        case ObligationKind.FOR:
            return _for
        case ObligationKind.AFTER:
            return _after
        case ObligationKind.NOT_AFTER:
            return _not_after
        case ObligationKind.UNTIL:
            return _until
        case ObligationKind.BEFORE:
            return _before
        case _:
            assert_never(kind)


def _immediately(predicates: TickPredicates) -> Rows:
    missed = f.and_(predicates.triggered, f.not_(predicates.answer))
    yield "answered-at-once", f.and_(predicates.triggered, predicates.answer)
    yield "missed-by-one", missed
    yield "one-tick-late", _late(predicates, missed)


def _next(predicates: TickPredicates) -> Rows:
    q, missed = predicates.answer, f.and_(predicates.was_open, f.not_(predicates.answer))
    yield "answered-too-early", f.and_(f.previous(f.and_(predicates.triggered, q)), missed)
    yield "answered-at-last-tick", f.and_(predicates.was_open, q)
    yield "missed-by-one", missed
    yield "one-tick-late", _late(predicates, missed)


def _finally(predicates: TickPredicates) -> Rows:
    q, missed = predicates.answer, f.and_(predicates.waiting, f.not_(predicates.answer))
    gone = f.and_(missed, f.previous(predicates.stage.open(f.TRUE)), f.previous(q))
    yield "answered-too-early", _at_its_end(predicates, gone)
    yield "answered-at-last-tick", _at_its_end(predicates, f.and_(predicates.waiting, q))
    yield "missed-by-one", _at_its_end(predicates, missed)
    yield "one-tick-late", f.and_(_at_its_end(predicates, missed), q)


def _eventually(predicates: TickPredicates) -> Rows:
    q = predicates.answer
    yield "answered-at-once", f.and_(predicates.triggered, q)
    yield "answered-later", f.and_(predicates.was_open, q)
    yield "answered-at-last-tick", _at_its_end(predicates, f.and_(predicates.was_open, q))
    yield "missed-by-one", _at_its_end(predicates, predicates.open)
    yield "one-tick-late", f.and_(_at_its_end(predicates, predicates.open), q)


def _always(predicates: TickPredicates) -> Rows:
    q = predicates.answer
    missed = f.and_(predicates.inside, f.previous(predicates.stage.open(f.TRUE)), f.not_(q))
    yield "answered-at-once", f.and_(predicates.triggered, q)
    yield "missed-at-once", f.and_(predicates.triggered, f.not_(q))
    yield "missed-later", missed
    yield "missed-by-one", _at_its_end(predicates, missed)


def _within(predicates: TickPredicates) -> Rows:
    q, n = predicates.answer, predicates.demand.ticks
    last = predicates.oldest(n)
    missed = f.and_(last, f.not_(q))
    yield "answered-at-once", f.and_(predicates.triggered, q)
    if n > 1:
        yield "answered-later", f.and_(predicates.has_time, q)
    if n:
        yield "answered-at-last-tick", f.and_(last, q)
    yield "missed-by-one", missed
    yield "one-tick-late", _late(predicates, missed)


def _for(predicates: TickPredicates) -> Rows:
    q, n = predicates.answer, predicates.demand.ticks
    kept = predicates.newest(n, q)
    yield "answered-at-once", f.and_(predicates.triggered, q)
    if n:
        yield "answered-at-last-tick", f.and_(kept, q)
        yield "missed-at-once", f.and_(predicates.triggered, f.not_(q))
    if n > 1:
        near = predicates.stage.open(f.TRUE, f.Interval(0, n - 1))
        yield "missed-later", f.and_(near, f.not_(predicates.triggered), f.not_(q))
    yield "missed-by-one", f.and_(kept, f.not_(q))
    yield "given-up-after", f.and_(predicates.newest(n + 1, q), f.not_(q))


def _after(predicates: TickPredicates) -> Rows:
    q, n = predicates.answer, predicates.demand.ticks
    last = predicates.oldest(n + 1)
    missed = f.and_(last, f.not_(q))
    yield "answered-at-once", f.and_(predicates.triggered, q)
    if n:
        early = f.previous(f.and_(predicates.oldest(n), q))
        yield "answered-too-early", f.and_(predicates.inside, early, f.not_(q))
    yield "answered-at-last-tick", f.and_(last, q)
    yield "missed-by-one", missed
    yield "one-tick-late", _late(predicates, missed)


def _not_after(predicates: TickPredicates) -> Rows:
    q, n = predicates.answer, predicates.demand.ticks
    beyond = predicates.oldest(n + 1)
    yield "answered-at-once", f.and_(predicates.triggered, q)
    if n > 1:
        yield "answered-later", f.and_(predicates.has_time, q)
    if n:
        yield "answered-at-last-tick", f.and_(predicates.oldest(n), q)
    yield "one-tick-late", f.and_(beyond, q)
    yield "never-answered", f.and_(beyond, f.not_(q))


def _until(predicates: TickPredicates) -> Rows:
    q, stop = predicates.answer, predicates.demand.stop
    asked = f.and_(predicates.was_open, f.not_(stop))
    yield "answered-at-once", f.and_(predicates.triggered, q, f.not_(stop))
    yield "missed-at-once", f.and_(predicates.triggered, f.not_(q), f.not_(stop))
    yield "missed-later", f.and_(asked, f.not_(q))
    yield "missed-by-one", f.and_(predicates.inside, f.previous(f.and_(asked, f.not_(q))), stop)
    yield "stopped-at-once", f.and_(predicates.triggered, stop)
    yield "stopped-later", f.and_(predicates.was_open, stop, q)
    yield "stopped-unanswered", f.and_(predicates.was_open, stop, f.not_(q))


def _before(predicates: TickPredicates) -> Rows:
    q, stop = predicates.answer, predicates.demand.stop
    answered = f.and_(predicates.was_open, q, f.not_(stop))
    yield "answered-at-once", f.and_(predicates.triggered, q, f.not_(stop))
    yield "answered-later", answered
    yield "answered-at-last-tick", f.and_(predicates.inside, f.previous(answered), stop)
    yield "one-tick-late", f.and_(predicates.was_open, stop, q)
    yield "stopped-at-once", f.and_(predicates.triggered, stop)
    yield "stopped-unanswered", f.and_(predicates.was_open, stop, f.not_(q))


def _late(predicates: TickPredicates, missed: f.Formula) -> f.Formula:
    """Formula: the answer comes in the same interval, one tick after it was missed."""
    return f.and_(predicates.inside, f.previous(missed), predicates.answer)


def _at_its_end(predicates: TickPredicates, last: f.Formula) -> f.Formula:
    """Formula: the interval is over, and `last` held at its last tick."""
    return f.and_(predicates.ended, f.previous(last))
