"""The coverage goals of each timing: answered at once, at the last tick, one tick too late, never.

For an `only` scope they are the goals of the dual, which it demands outside of the scope.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import assert_never

from compiler.formalization.obligation import Kind
from compiler.logic import formula as f
from compiler.situations.tick_predicates import TickPredicates

Rows = Iterator[tuple[str, f.Formula]]
"""Keys with past-time formulas; FALSE if no interval ends."""


def of_demand(known: TickPredicates) -> Rows:
    """The coverage goals of a sentence's timing."""
    return _rows(known.demand.kind)(known)


def _rows(kind: Kind) -> Callable[[TickPredicates], Rows]:
    match kind:
        case Kind.IMMEDIATELY:
            return _immediately
        case Kind.NEXT:
            return _next
        case Kind.FINALLY:
            return _finally
        case Kind.EVENTUALLY:
            return _eventually
        case Kind.ALWAYS:
            return _always
        case Kind.WITHIN:
            return _within
        case Kind.FOR:
            return _for
        case Kind.AFTER:
            return _after
        case Kind.NOT_AFTER:
            return _not_after
        case Kind.UNTIL:
            return _until
        case Kind.BEFORE:
            return _before
        case _:
            assert_never(kind)


def _immediately(known: TickPredicates) -> Rows:
    missed = f.and_(known.triggered, f.not_(known.answer))
    yield "answered-at-once", f.and_(known.triggered, known.answer)
    yield "missed-by-one", missed
    yield "one-tick-late", _late(known, missed)


def _next(known: TickPredicates) -> Rows:
    q, missed = known.answer, f.and_(known.was_open, f.not_(known.answer))
    yield "answered-too-early", f.and_(f.previous(f.and_(known.triggered, q)), missed)
    yield "answered-at-last-tick", f.and_(known.was_open, q)
    yield "missed-by-one", missed
    yield "one-tick-late", _late(known, missed)


def _finally(known: TickPredicates) -> Rows:
    q, missed = known.answer, f.and_(known.waiting, f.not_(known.answer))
    gone = f.and_(missed, f.previous(known.stage.open(f.TRUE)), f.previous(q))
    yield "answered-too-early", _at_its_end(known, gone)
    yield "answered-at-last-tick", _at_its_end(known, f.and_(known.waiting, q))
    yield "missed-by-one", _at_its_end(known, missed)
    yield "one-tick-late", f.and_(_at_its_end(known, missed), q)


def _eventually(known: TickPredicates) -> Rows:
    q = known.answer
    yield "answered-at-once", f.and_(known.triggered, q)
    yield "answered-later", f.and_(known.was_open, q)
    yield "answered-at-last-tick", _at_its_end(known, f.and_(known.was_open, q))
    yield "missed-by-one", _at_its_end(known, known.open)
    yield "one-tick-late", f.and_(_at_its_end(known, known.open), q)


def _always(known: TickPredicates) -> Rows:
    q = known.answer
    missed = f.and_(known.inside, f.previous(known.stage.open(f.TRUE)), f.not_(q))
    yield "answered-at-once", f.and_(known.triggered, q)
    yield "missed-at-once", f.and_(known.triggered, f.not_(q))
    yield "missed-later", missed
    yield "missed-by-one", _at_its_end(known, missed)


def _within(known: TickPredicates) -> Rows:
    q, n = known.answer, known.demand.ticks
    last = known.oldest(n)
    missed = f.and_(last, f.not_(q))
    yield "answered-at-once", f.and_(known.triggered, q)
    if n > 1:
        yield "answered-later", f.and_(known.has_time, q)
    if n:
        yield "answered-at-last-tick", f.and_(last, q)
    yield "missed-by-one", missed
    yield "one-tick-late", _late(known, missed)


def _for(known: TickPredicates) -> Rows:
    q, n = known.answer, known.demand.ticks
    kept = known.newest(n, q)
    yield "answered-at-once", f.and_(known.triggered, q)
    if n:
        yield "answered-at-last-tick", f.and_(kept, q)
        yield "missed-at-once", f.and_(known.triggered, f.not_(q))
    if n > 1:
        near = known.stage.open(f.TRUE, f.Interval(0, n - 1))
        yield "missed-later", f.and_(near, f.not_(known.triggered), f.not_(q))
    yield "missed-by-one", f.and_(kept, f.not_(q))
    yield "given-up-after", f.and_(known.newest(n + 1, q), f.not_(q))


def _after(known: TickPredicates) -> Rows:
    q, n = known.answer, known.demand.ticks
    last = known.oldest(n + 1)
    missed = f.and_(last, f.not_(q))
    yield "answered-at-once", f.and_(known.triggered, q)
    if n:
        early = f.previous(f.and_(known.oldest(n), q))
        yield "answered-too-early", f.and_(known.inside, early, f.not_(q))
    yield "answered-at-last-tick", f.and_(last, q)
    yield "missed-by-one", missed
    yield "one-tick-late", _late(known, missed)


def _not_after(known: TickPredicates) -> Rows:
    q, n = known.answer, known.demand.ticks
    beyond = known.oldest(n + 1)
    yield "answered-at-once", f.and_(known.triggered, q)
    if n > 1:
        yield "answered-later", f.and_(known.has_time, q)
    if n:
        yield "answered-at-last-tick", f.and_(known.oldest(n), q)
    yield "one-tick-late", f.and_(beyond, q)
    yield "never-answered", f.and_(beyond, f.not_(q))


def _until(known: TickPredicates) -> Rows:
    q, stop = known.answer, known.demand.stop
    asked = f.and_(known.was_open, f.not_(stop))
    yield "answered-at-once", f.and_(known.triggered, q, f.not_(stop))
    yield "missed-at-once", f.and_(known.triggered, f.not_(q), f.not_(stop))
    yield "missed-later", f.and_(asked, f.not_(q))
    yield "missed-by-one", f.and_(known.inside, f.previous(f.and_(asked, f.not_(q))), stop)
    yield "stopped-at-once", f.and_(known.triggered, stop)
    yield "stopped-later", f.and_(known.was_open, stop, q)
    yield "stopped-unanswered", f.and_(known.was_open, stop, f.not_(q))


def _before(known: TickPredicates) -> Rows:
    q, stop = known.answer, known.demand.stop
    answered = f.and_(known.was_open, q, f.not_(stop))
    yield "answered-at-once", f.and_(known.triggered, q, f.not_(stop))
    yield "answered-later", answered
    yield "answered-at-last-tick", f.and_(known.inside, f.previous(answered), stop)
    yield "one-tick-late", f.and_(known.was_open, stop, q)
    yield "stopped-at-once", f.and_(known.triggered, stop)
    yield "stopped-unanswered", f.and_(known.was_open, stop, f.not_(q))


def _late(known: TickPredicates, missed: f.Formula) -> f.Formula:
    """Formula: the answer comes in the same interval, one tick after it was missed."""
    return f.and_(known.inside, f.previous(missed), known.answer)


def _at_its_end(known: TickPredicates, last: f.Formula) -> f.Formula:
    """Formula: the interval is over, and `last` held at its last tick."""
    return f.and_(known.ended, f.previous(last))
