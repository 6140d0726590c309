"""Sentences of FRETish with the meaning of formulas of linear temporal logic.

An invariant with `X` is shifted: `G (p -> X q)` holds if `q` holds at each tick after one with `p`,
and `preBool(false, p)` is the value of `p` at the tick before.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain

from compiler.logic import formula as f
from compiler.logic.printing import Dialect, text
from fretish.classes.frozen import dataclass

COMPONENT = "system"
"""The component of each sentence; TLSF has none."""
_MOST_SHIFTED = 8
"""Maximum number of nested `X`."""


class _NoPatternError(Exception):
    pass


def sentences(formula: f.Formula, names: Mapping[str, str]) -> tuple[str, ...] | None:
    """Sentences that together mean a formula; None: there are none.

    Args:
        formula: a formula over the first tick and all later ones.
        names: the text of each atom in FRETish.
    """
    try:
        return tuple(chain.from_iterable(map(_Patterns(names).at_first, _conjuncts(formula))))
    except _NoPatternError:
        return None


def as_formula(formula: f.Formula, names: Mapping[str, str]) -> str:
    """The text of a requirement that is a formula and no sentence of FRETish.

    Args:
        formula: a formula over the first tick and all later ones.
        names: the text of each atom.
    """
    dialect = Dialect("requirement", constants=("false", "true"), atom=names.__getitem__)
    return f"the {COMPONENT} shall satisfy formula: {text(formula, dialect)}"


def _conjuncts(formula: f.Formula) -> Iterator[f.Formula]:
    """Formulas whose conjunction is the formula; temporal operators are distributed over it."""
    match formula:
        case f.And(args):
            yield from chain.from_iterable(map(_conjuncts, args))
        case f.Globally(arg, f.EVER):
            for part in _conjuncts(arg):
                yield part if isinstance(part, f.Globally) else f.globally(part)
        case f.Next(arg):
            yield from map(f.next_, _conjuncts(arg))
        case f.Implies(left, right):
            yield from (f.implies(left, part) for part in _conjuncts(right))
        case f.Until(left, right):
            yield f.release(right, f.or_(left, right))
            yield f.eventually(right)
        case f.Iff(left, right) if not (_is_of_ticks(left) and _is_of_ticks(right)):
            yield from _conjuncts(f.implies(left, right))
            yield from _conjuncts(f.implies(right, left))
        case f.Not(f.Or(args)):
            yield from chain.from_iterable(_conjuncts(f.not_(arg)) for arg in args)
        case f.Not(f.Implies(left, right)):
            yield from _conjuncts(left)
            yield from _conjuncts(f.not_(right))
        case f.Not(f.Eventually(arg, f.EVER)):
            yield from _conjuncts(f.globally(f.not_(arg)))
        case f.Not(f.Globally(arg, f.EVER)):
            yield from _conjuncts(f.eventually(f.not_(arg)))
        case _:
            yield formula


@dataclass(frozen=True, slots=True)
class _Patterns:
    names: Mapping[str, str]

    def at_first(self, formula: f.Formula) -> Iterator[str]:
        """Sentences for a formula about the first tick."""
        match formula:
            case f.Globally(arg, f.EVER):
                yield self._always(arg)
            case f.Eventually(f.Globally(), _):
                raise _NoPatternError
            case f.Eventually(arg, f.EVER):
                yield _sentence("", f"eventually satisfy {self._now(arg)}")
            case f.Release(stop, kept):
                yield _sentence("", self._until(stop, kept))
            case _ if _depth(formula) == 0:
                yield _sentence("", f"immediately satisfy {self._now(formula)}")
            case _:
                depth = _depth(formula)
                shifted = self._shifted(formula, depth)
                yield _sentence("", f"always satisfy !{_before('false', 'FTP', depth)} | {shifted}")

    def _always(self, arg: f.Formula) -> str:
        """The sentence for `G arg`."""
        match arg:
            case f.Eventually(inner, f.EVER):
                depth = _depth(inner)
                return _sentence(
                    "whenever true", f"eventually satisfy {self._shifted(inner, depth)}"
                )
            case f.Implies(trigger, answer):
                answered = self._answered(trigger, answer)
                if answered is not None:
                    return answered
            case f.Or(args):
                later = [each for each in args if not _is_of_ticks(each)]
                if len(later) == 1:
                    rest = f.or_(*(each for each in args if each is not later[0]))
                    answered = self._answered(f.not_(rest), later[0])
                    if answered is not None:
                        return answered
        depth = _depth(arg)
        begins = "".join(f"{_before('true', 'FTP', ago)} | " for ago in range(depth))
        return _sentence("", f"always satisfy {begins}{self._shifted(arg, depth)}")

    def _answered(self, trigger: f.Formula, answer: f.Formula) -> str | None:
        """The sentence for `G (trigger -> answer)`; None: it is an invariant."""
        later = 0
        while isinstance(answer, f.Next) and not _is_of_ticks(answer):
            answer, later = answer.arg, later + 1
        if later > _MOST_SHIFTED:
            raise _NoPatternError
        match answer:
            case f.Eventually(f.Globally(), f.EVER):
                raise _NoPatternError
            case f.Eventually(f.Next(arg), f.EVER):
                return self._answered(trigger, f.next_(f.eventually(arg)))
            case f.Eventually(arg, f.EVER):
                timing = f"eventually satisfy {self._now(arg)}"
            case f.Globally(arg, f.EVER):
                timing = f"always satisfy {self._now(arg)}"
            case f.Release(stop, kept):
                timing = self._until(stop, kept)
            case _:
                return None
        self._now(trigger)
        return _sentence(f"whenever {self._shifted(trigger, 0, later)}", timing)

    def _until(self, stop: f.Formula, kept: f.Formula) -> str:
        """The timing for `stop R kept`: `kept` holds up to a tick at which both hold."""
        match kept:
            case f.Or(args) if stop in args:
                kept = f.or_(*(arg for arg in args if arg != stop))
            case _:
                stop = f.and_(stop, kept)
        return f"until {self._now(stop)} satisfy {self._now(kept)}"

    def _now(self, formula: f.Formula) -> str:
        """A formula without temporal operators."""
        if _depth(formula):
            raise _NoPatternError
        return self._shifted(formula, 0)

    def _shifted(self, formula: f.Formula, depth: int, later: int = 0) -> str:
        """A formula of some ticks as an expression at a later one.

        Args:
            formula: Boolean operators, `X` and atoms.
            depth: ticks that the formula looks ahead.
            later: further ticks that have passed.
        """

        def read(part: f.Formula, ago: int) -> str:
            match part:
                case f.Const(value):
                    return str(value).lower()
                case f.Atom(name):
                    return _before("false", self.names[name], ago)
                case f.Next(arg):
                    return read(arg, ago - 1)
                case f.Not(arg):
                    return f"!{read(arg, ago)}"
                case f.And(args):
                    return f"({' & '.join(read(arg, ago) for arg in args)})"
                case f.Or(args):
                    return f"({' | '.join(read(arg, ago) for arg in args)})"
                case f.Implies(left, right):
                    return f"({read(left, ago)} => {read(right, ago)})"
                case f.Iff(left, right):
                    return f"({read(left, ago)} <=> {read(right, ago)})"
                case _:
                    raise _NoPatternError

        if later and _depth(formula):
            raise _NoPatternError
        if not later:
            return read(formula, depth)
        return _before("false", read(formula, 0), later)


def _sentence(condition: str, rest: str) -> str:
    return f"{condition} the {COMPONENT} shall {rest}".strip()


def _before(first: str, text: str, ago: int) -> str:
    for _ in range(ago):
        text = f"preBool({first}, {text})"
    return text


def _depth(formula: f.Formula) -> int:
    """Number of nested `X`."""
    inner = max(map(_depth, f.children(formula)), default=0)
    depth = inner + isinstance(formula, f.Next)
    if depth > _MOST_SHIFTED:
        raise _NoPatternError
    return depth


def _is_of_ticks(formula: f.Formula) -> bool:
    """Whether a formula has no temporal operator but `X`."""
    if isinstance(formula, f.Eventually | f.Globally | f.Until | f.Release):
        return False
    return all(map(_is_of_ticks, f.children(formula)))
