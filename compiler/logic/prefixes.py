"""Future-time formulas on the prefixes of a run, as formulas of the past.

A witness of a formula is followed tick by tick: a formula of the past says at which ticks it has
come so far. This works if the left side of each `U` and the release of each `R` is about one tick;
other formulas are refused.

Sources: Kupferman, Vardi, Model checking of safety properties, FMSD 2001 (informative prefixes);
De Giacomo, Vardi, Linear temporal logic on finite traces, IJCAI 2013.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain

from compiler.logic import formula as f
from fretish.reading.recursion import with_recursion_limit

_MOST_STEPS = 2_000
"""Maximum number of steps of a translation."""
_LONGEST_BOUND = 64
"""Maximum bound of `F` and `G` in ticks: each tick of it is an `X` here."""


class UntranslatableError(Exception):
    """The formula has no equivalent of the past that this module finds."""


def finite(formula: f.Formula) -> f.Formula:
    """The formula about finite traces: nothing after `LAST` matters.

    A tick that does not come satisfies every `X` that is not below a negation, and nothing that is
    awaited by `F` or `U`.
    """
    return _until_last(negation_normal(formula))


def _until_last(formula: f.Formula) -> f.Formula:
    match formula:
        case f.Next(arg):
            return f.or_(f.LAST, f.next_(_until_last(arg)))
        case f.Until(left, right):
            return f.until(f.and_(f.not_(f.LAST), _until_last(left)), _until_last(right))
        case f.Release(left, right):
            return f.release(f.or_(f.LAST, _until_last(left)), _until_last(right))
        case f.Eventually(arg, f.EVER):
            return f.until(f.not_(f.LAST), _until_last(arg))
        case f.Globally(arg, f.EVER):
            return f.release(f.LAST, _until_last(arg))
        case f.Eventually(arg, f.Interval(0, int(hi))):
            ends = f.eventually(f.LAST, f.Interval(0, hi - 1)) if hi else f.FALSE
            return f.or_(ends, f.eventually(_until_last(arg), formula.ahead))
        case f.Globally(arg, f.Interval(0, int())):
            kept = _until_last(arg)
            return f.or_(f.globally(kept, formula.ahead), f.release(f.LAST, kept))
        case f.Eventually(arg, f.Interval(lo, hi)) | f.Globally(arg, f.Interval(lo, hi)):
            ahead = f.Interval(0, None if hi is None else hi - lo)
            later = f.eventually if isinstance(formula, f.Eventually) else f.globally
            ends = f.eventually(f.LAST, f.Interval(0, lo - 1))
            return f.or_(ends, f.eventually(_until_last(later(arg, ahead)), f.Interval(lo, lo)))
        case _:
            return f.rebuild(formula, _until_last)


@with_recursion_limit
def negation_normal(formula: f.Formula, *, negated: bool = False) -> f.Formula:
    """The formula with negations at atoms only, and without `->`, `<->`, `xor`."""

    def same(part: f.Formula) -> f.Formula:
        return negation_normal(part, negated=negated)

    def other(part: f.Formula) -> f.Formula:
        return negation_normal(part, negated=not negated)

    match formula:
        case f.Const() | f.Atom() | f.Last():
            return f.not_(formula) if negated else formula
        case f.Not(arg):
            return other(arg)
        case f.And(args):
            return (f.or_ if negated else f.and_)(*map(same, args))
        case f.Or(args):
            return (f.and_ if negated else f.or_)(*map(same, args))
        case f.Implies(left, right):
            return (f.and_ if negated else f.or_)(other(left), same(right))
        case f.Iff(left, right):
            return f.and_(f.or_(other(left), _plain(right)), f.or_(same(left), _plain(right, True)))
        case f.Xor(left, right):
            return f.and_(f.or_(same(left), _plain(right)), f.or_(other(left), _plain(right, True)))
        case f.Next(arg):
            return f.next_(same(arg))
        case f.Eventually(arg, ahead):
            return (f.globally if negated else f.eventually)(same(arg), ahead)
        case f.Globally(arg, ahead):
            return (f.eventually if negated else f.globally)(same(arg), ahead)
        case f.Until(left, right):
            return (f.release if negated else f.until)(same(left), same(right))
        case f.Release(left, right):
            return (f.until if negated else f.release)(same(left), same(right))
        case _:
            raise AssertionError(f"not of the future: {formula}")


def _plain(formula: f.Formula, negated: bool = False) -> f.Formula:
    return negation_normal(formula, negated=negated)


def is_of_one_tick(formula: f.Formula) -> bool:
    """Whether a formula has no temporal operator."""
    match formula:
        case f.Next() | f.Until() | f.Release() | f.Eventually() | f.Globally():
            return False
        case _:
            return all(map(is_of_one_tick, f.children(formula)))


@with_recursion_limit
def bad_prefix(formula: f.Formula) -> f.Formula:
    """The last ticks of prefixes that no continuation turns into a run of the formula.

    A prefix is bad if the operators show it: `F p & G !p` has no such prefix at all.

    Raises:
        UntranslatableError: no formula of the past is available.
    """
    return _Translation().arrival(f.FIRST, _weak(negation_normal(formula)))


@with_recursion_limit
def good_prefix(formula: f.Formula) -> f.Formula | None:
    """The last ticks of prefixes after which every run satisfies the formula; None: unknown."""
    normal = negation_normal(formula)
    if _may_never_come(normal):
        return None
    try:
        return _Translation().arrival(f.FIRST, normal)
    except UntranslatableError:
        return None


@with_recursion_limit
def ends_badly(formula: f.Formula, *, strict: bool) -> f.Formula:
    """The ticks with which a trace may not end, by the formula about finite traces.

    Where an earlier prefix is bad, the result may be false, if it is not strict.

    Args:
        formula: the formula of the future.
        strict: whether the next tick of `X` must come, too.

    Raises:
        UntranslatableError: no formula of the past is available.
    """
    if strict:
        return _Translation().end(f.FIRST, _lenient(negation_normal(formula, negated=True)))
    normal = negation_normal(formula)
    parts = normal.args if isinstance(normal, f.And) else (normal,)
    awaiting = f.and_(*(part for part in parts if not _is_safe(part)))
    return _Translation().end(f.FIRST, negation_normal(awaiting, negated=True))


def _is_safe(normal: f.Formula) -> bool:
    """Whether nothing is awaited: a trace satisfies the formula unless a prefix is bad."""
    if isinstance(normal, f.Until) or (
        isinstance(normal, f.Eventually) and normal.ahead.hi is None
    ):
        return False
    return all(map(_is_safe, f.children(normal)))


def _weak(normal: f.Formula) -> f.Formula:
    """The negation of a formula in which nothing that is awaited need ever come."""

    def weaker(part: f.Formula) -> f.Formula:
        match part:
            case f.Until(left, right):
                later = weaker(right)
                return f.release(later, f.or_(weaker(left), later))
            case f.Eventually(_, f.EVER):
                return f.TRUE
            case _:
                return f.rebuild(part, weaker)

    return negation_normal(weaker(normal), negated=True)


def _lenient(normal: f.Formula) -> f.Formula:
    """A formula that a tick that does not come satisfies, below `X`."""
    match normal:
        case f.Next(arg):
            return f.or_(f.LAST, f.next_(_lenient(arg)))
        case f.Eventually(_, f.Interval(_, int())) | f.Globally(_, f.Interval(_, int())):
            return _lenient(_steps(normal))
        case _:
            return f.rebuild(normal, _lenient)


def _may_never_come(normal: f.Formula) -> bool:
    """Whether only endless runs show that a formula holds."""
    if isinstance(normal, f.Release) or (
        isinstance(normal, f.Globally) and normal.ahead.hi is None
    ):
        return True
    return any(map(_may_never_come, f.children(normal)))


def _steps(bounded: f.Eventually | f.Globally) -> f.Formula:
    """A bounded operator by `X`."""
    lo, hi = bounded.ahead.lo, bounded.ahead.hi
    if max(lo, hi or 0) > _LONGEST_BOUND:
        raise UntranslatableError(f"a bound is longer than {_LONGEST_BOUND} ticks")
    join = f.or_ if isinstance(bounded, f.Eventually) else f.and_
    if hi is None:
        build = f.eventually if isinstance(bounded, f.Eventually) else f.globally
        result = build(bounded.arg)
    else:
        result = bounded.arg
        for _ in range(hi - lo):
            result = join(bounded.arg, f.next_(result))
    for _ in range(lo):
        result = f.next_(result)
    return result


class _Translation:
    """Formulas of the past for formulas in negation normal form; counts its steps."""

    def __init__(self) -> None:
        self._left = _MOST_STEPS

    def _step(self) -> None:
        self._left -= 1
        if self._left < 0:
            raise UntranslatableError("the formula is too large")

    def arrival(self, begun: f.Formula, formula: f.Formula) -> f.Formula:
        """The ticks with which a formula becomes certain, if it is asked where `begun` is true."""
        self._step()
        match formula:
            case _ if is_of_one_tick(formula):
                return f.and_(begun, formula)
            case f.Or(args):
                return f.or_(*(self.arrival(begun, arg) for arg in args))
            case f.And(args):
                now, later = _split(args)
                whole = later[0] if len(later) == 1 else self._joint(later)
                return self.arrival(f.and_(begun, now), whole)
            case f.Next(arg):
                return self.arrival(f.previous(begun), arg)
            case f.Until(left, right):
                return self.arrival(_carried(begun, left), right)
            case f.Eventually(arg, f.EVER):
                return self.arrival(f.once(begun), arg)
            case f.Eventually() | f.Globally(_, f.Interval(_, int())):
                return self.arrival(begun, _steps(formula))
            case _:
                raise UntranslatableError("a negated `U` or `G` is nested in another operator")

    def end(self, begun: f.Formula, formula: f.Formula) -> f.Formula:
        """The ticks with which a trace satisfies a formula that is asked where `begun` is true."""
        self._step()
        match formula:
            case _ if is_of_one_tick(formula):
                earlier = f.previous(f.once(f.and_(begun, _at_last(formula, False))))
                return f.or_(f.and_(begun, _at_last(formula, True)), earlier)
            case f.Or(args):
                return f.or_(*(self.end(begun, arg) for arg in args))
            case f.And(args):
                if _is_unique(begun):
                    return f.and_(*(self.end(begun, arg) for arg in args))
                now, later = _split(args)
                joint = f.and_(now, later[0] if len(later) == 1 else self._joint(later))
                if isinstance(joint, f.And) and len(later) == 1:
                    return self._after(begun, now, later[0])
                return self.end(begun, joint)
            case f.Next(arg):
                return self.end(f.previous(begun), arg)
            case f.Until(left, right):
                return self.end(_carried(begun, _at_last(left, False)), right)
            case f.Eventually(arg, f.EVER):
                return self.end(f.once(begun), arg)
            case f.Globally(_, f.EVER) | f.Release():
                return self._kept(begun, formula)
            case f.Eventually() | f.Globally():
                return self.end(begun, _steps(formula))
            case _:
                raise AssertionError(f"not in negation normal form: {formula}")

    def _after(self, begun: f.Formula, now: f.Formula, later: f.Formula) -> f.Formula:
        """The end of `now & later`; at the last tick, `now` may be true for `LAST`."""
        at_last = f.and_(begun, _at_last(now, True))
        before = f.and_(begun, _at_last(now, False))
        if at_last == before:
            return self.end(before, later)
        # `later` is asked at the last tick itself, or at an earlier one.
        if f.Not(f.LAST) in _subformulas(now) and not isinstance(later, f.Next):
            raise UntranslatableError("an `X` is nested in another operator")
        here = self._at_last_tick(later)
        return f.or_(f.and_(at_last, here), self.end(before, later))

    def _at_last_tick(self, formula: f.Formula) -> f.Formula:
        """A formula at the last tick of a trace, where no tick follows."""
        self._step()

        def last(part: f.Formula) -> f.Formula:
            match part:
                case f.Next():
                    return f.FALSE
                case f.Until(_, right) | f.Release(_, right):
                    return last(right)
                case f.Eventually(arg, ahead):
                    return last(arg) if ahead.lo == 0 else f.FALSE
                case f.Globally(arg, f.EVER):
                    return last(arg)
                case f.Globally():
                    return last(_steps(part))
                case f.Last():
                    return f.TRUE
                case _:
                    return f.rebuild(part, last)

        return last(formula)

    def _kept(self, begun: f.Formula, formula: f.Release | f.Globally) -> f.Formula:
        """The end of a formula that may be kept up to the last tick."""
        if _is_unique(begun):
            # The opposite of an `X` whose tick must come holds if it does not come.
            opposite = _lenient(negation_normal(formula, negated=True))
            return f.and_(f.once(begun), f.not_(self.end(begun, opposite)))
        match formula:
            case f.Globally(arg) if is_of_one_tick(arg):
                now, earlier = _at_last(arg, True), _at_last(arg, False)
                return f.and_(now, _carried(begun, earlier))
            case f.Globally(f.Eventually(arg, f.EVER)):
                return f.and_(f.once(begun), self._at_last_tick(arg))
            case f.Release(left, right) if is_of_one_tick(left) and is_of_one_tick(right):
                return self.end(begun, _unless(formula))
            case _:
                raise UntranslatableError("a `G` or `R` is nested in another operator")

    def _joint(self, parts: Sequence[f.Formula]) -> f.Formula:
        """The conjunction of temporal formulas with one of them, or a step, outside."""
        self._step()
        for part in parts:
            rest = [other for other in parts if other is not part]
            match part:
                case f.Or(args):
                    return f.or_(*(f.and_(arg, *rest) for arg in args))
                case f.Release(left, right) if is_of_one_tick(left) and is_of_one_tick(right):
                    return f.and_(_unless(part), *rest)
                case f.Eventually(_, f.Interval(lo, hi)) | f.Globally(_, f.Interval(lo, hi)) if (
                    hi is not None or lo > 0
                ):
                    return f.and_(_steps(part), *rest)
        if any(isinstance(part, f.Next) for part in parts):
            return self._unrolled(parts)
        kept = f.and_(*(part.arg for part in parts if isinstance(part, f.Globally)))
        awaited = [_awaited(part) for part in parts if not isinstance(part, f.Globally)]
        if not is_of_one_tick(kept):
            raise UntranslatableError("a `G` is nested in another operator")
        always = [f.globally(kept)] if kept != f.TRUE else []
        if not awaited:
            return f.globally(kept)
        left = f.and_(kept, *(each for each, _ in awaited))
        if not is_of_one_tick(left):
            raise UntranslatableError("the left side of a `U` is about several ticks")
        options = []
        for index, (_, right) in enumerate(awaited):
            others = [f.until(*each) for other, each in enumerate(awaited) if other != index]
            options.append(f.and_(right, *others, *always))
        return f.until(left, f.or_(*options))

    def _unrolled(self, parts: Sequence[f.Formula]) -> f.Formula:
        """Each part as a statement about this tick and the next one."""
        options: list[tuple[list[f.Formula], list[f.Formula]]] = [([], [])]
        for part in parts:
            match part:
                case f.Next(arg):
                    choices: list[tuple[list[f.Formula], list[f.Formula]]] = [([], [arg])]
                case f.Globally(arg, _):
                    choices = [([arg], [part])]
                case _:
                    left, right = _awaited(part)
                    choices = [([right], []), ([left], [part])]
            options = [(now + a, later + b) for now, later in options for a, b in choices]
            self._step()
        return f.or_(*(f.and_(*now, f.next_(f.and_(*later))) for now, later in options))


def _awaited(part: f.Formula) -> tuple[f.Formula, f.Formula]:
    match part:
        case f.Until(left, right):
            return left, right
        case f.Eventually(arg, f.EVER):
            return f.TRUE, arg
        case _:
            raise UntranslatableError("a `G` or `R` is nested in another operator")


def _unless(formula: f.Release) -> f.Formula:
    """`left R right` as `G right | (right U (left & right))`."""
    left, right = formula.left, formula.right
    return f.or_(f.globally(right), f.until(right, f.and_(left, right)))


def _split(args: Sequence[f.Formula]) -> tuple[f.Formula, list[f.Formula]]:
    """The part about this tick, and the temporal parts."""
    now = f.and_(*filter(is_of_one_tick, args))
    return now, [arg for arg in args if not is_of_one_tick(arg)]


def _carried(begun: f.Formula, left: f.Formula) -> f.Formula:
    """The ticks to which a witness comes while `left` is true."""
    if not is_of_one_tick(left):
        raise UntranslatableError("the left side of a `U` is about several ticks")
    return f.or_(begun, f.previous(f.since(left, f.and_(begun, left))))


def _at_last(formula: f.Formula, value: bool) -> f.Formula:
    """A formula about one tick, where `LAST` has a known value."""
    if isinstance(formula, f.Last):
        return f.Const(value)
    return f.rebuild(formula, lambda part: _at_last(part, value))


def _subformulas(formula: f.Formula) -> Iterator[f.Formula]:
    yield formula
    yield from chain.from_iterable(map(_subformulas, f.children(formula)))


def _is_unique(begun: f.Formula) -> bool:
    """Whether a formula of the past is true at one tick at most."""
    match begun:
        case f.FIRST:
            return True
        case f.Previous(arg):
            return _is_unique(arg)
        case f.And(args):
            return any(map(_is_unique, args))
        case _:
            return False
