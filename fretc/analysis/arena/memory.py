"""Bits of a state that are built one by one, and formulas of the past over them.

All bits are false before the first tick. A counter is a word of bits, the least first, and is
computed by arithmetic: a bound of a million ticks has twenty bits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import assert_never

from compiler.logic import decision_diagrams as bdd
from compiler.logic import formula as f
from compiler.logic.decision_diagrams import Function
from fretc.analysis.arena.variables import Numbers, UnsupportedError, numbers

Word = Sequence[Function]
"""The bits of a whole number from 0 on, the least first."""
LONGEST_DELAY = 256
"""Ticks for which each value is kept in a bit of its own."""


@dataclass(frozen=True, slots=True)
class Bit:
    """One bit of a state: its value before a tick, and variables of the same place after it."""

    now: int
    after: int
    later: int
    """After some more ticks."""


class Memory:
    """The bits of one requirement, while it is built."""

    def __init__(self, fresh: Numbers, shared: dict[Function, Bit]) -> None:
        self._fresh, self.shared = fresh, shared
        self.bits: list[Bit] = []
        self.steps: dict[Bit, Function] = {}
        """The value of each bit after a tick, over bits before it and a letter."""
        self.words: list[tuple[Bit, ...]] = []
        """The bits of each count, the least first."""

    def bit(self) -> Bit:
        """A new one, whose step is to be set."""
        self.bits.append(Bit(*(next(self._fresh) for _ in range(3))))
        return self.bits[-1]

    def word(self, most: int) -> tuple[list[Bit], Word]:
        """Bits for the numbers 0..most, the weightiest on top of the order; and their values."""
        bits = [self.bit() for _ in range(most.bit_length())][::-1]
        self.words.append(tuple(bits))
        return bits, [bdd.variable(bit.now) for bit in bits]

    def keep(self, value: Function) -> Function:
        """The value at the tick before; false at the first one."""
        if value in self.shared:
            self.bits.append(self.shared[value])
        else:
            self.shared[value] = self.bit()
        bit = self.shared[value]
        self.steps[bit] = value
        return bdd.variable(bit.now)

    def set(self, bits: Sequence[Bit], values: Word) -> None:
        """The steps of a word."""
        self.steps.update(zip(bits, values, strict=True))

    def needed(self, roots: Sequence[Function]) -> tuple[Bit, ...]:
        """The bits on which the functions depend, at this tick or at a later one."""
        by_number = {bit.now: bit for bit in self.bits}
        found: set[Bit] = set()
        waiting = list(roots)
        while waiting:
            read = {by_number[n] for n in bdd.support(waiting.pop()) if n in by_number}
            waiting.extend(self.steps[bit] for bit in read - found)
            found |= read
        return tuple(bit for bit in dict.fromkeys(self.bits) if bit in found)


def side_by_side(words: Iterable[tuple[Bit, ...]], count: int) -> Numbers:
    """Variables for a second build like a first one, with bits of the same weight in a row.

    Args:
        words: of the first build, the least bits first.
        count: how many variables it took; the second one takes them in the same order.
    """
    weights = {
        number: weight
        for word in words
        for weight, bit in enumerate(word)
        for number in (bit.now, bit.after, bit.later)
    }
    order = sorted(range(count), key=lambda number: (-weights.get(number, count), number))
    places = {number: place for place, number in enumerate(order)}
    return chain((places[number] for number in range(count)), numbers(count))


# Arithmetic -----------------------------------------------------------------------------------


def equals(word: Word, number: int) -> Function:
    """Whether the word is the number, which fits."""
    found = bdd.true()
    for place, bit in reversed([*enumerate(word)]):
        found = (bit if number >> place & 1 else -bit) & found
    return found


def constant(number: int, like: Word) -> Word:
    """The number, in as many bits as another word."""
    return [bdd.true() if number >> place & 1 else bdd.false() for place in range(len(like))]


def successor(word: Word) -> Word:
    """One more; the greatest becomes 0."""
    carry, found = bdd.true(), []
    for bit in word:
        found.append(bit ^ carry)
        carry = carry & bit
    return found


def predecessor(word: Word) -> Word:
    """One less; 0 stays 0."""
    borrow, found = some(word), []
    for bit in word:
        found.append(bit ^ borrow)
        borrow = borrow - bit
    return found


def some(word: Word) -> Function:
    """Whether it is above 0."""
    found = bdd.false()
    for bit in word:
        found = found | bit
    return found


def either(condition: Function, then: Word, otherwise: Word) -> Word:
    """One word or the other."""
    pairs = zip(then, otherwise, strict=True)
    return [bdd.ite(condition, left, right) for left, right in pairs]


def only(condition: Function, word: Word) -> Word:
    """The word, or 0 where the condition is false."""
    return [condition & bit for bit in word]


# Formulas of the past ---------------------------------------------------------------------------


class Past:
    """Formulas of the past as functions of a letter and of the bits that they add to a memory.

    Source: Havelund, Rosu, Synthesizing monitors for safety properties, TACAS 2002: the value of a
    formula at a tick needs those of its parts at this tick and at the one before.
    """

    def __init__(self, atom: Callable[[str], Function], memory: Memory) -> None:
        self._atom, self._memory = atom, memory
        self._known: dict[f.Formula, Function] = {}

    def value(self, formula: f.Formula) -> Function:
        """Its truth at a tick.

        Raises:
            UnsupportedError: it looks ahead, or too far back.
        """
        if formula not in self._known:
            self._known[formula] = self._value(formula)
        return self._known[formula]

    def _value(self, formula: f.Formula) -> Function:
        read = self.value
        match formula:
            case f.Const(value):
                return bdd.true() if value else bdd.false()
            case f.Atom(name):
                return self._atom(name)
            case f.Not(arg):
                return -read(arg)
            case f.And(args):
                return _folded(bdd.true(), map(read, args), lambda x, y: x & y)
            case f.Or(args):
                return _folded(bdd.false(), map(read, args), lambda x, y: x | y)
            case f.Xor(left, right):
                return read(left) ^ read(right)
            case f.Implies(left, right):
                return -read(left) | read(right)
            case f.Iff(left, right):
                return -(read(left) ^ read(right))
            case f.Previous() | f.WeakPrevious() | f.Once() | f.Historically() | f.Since():
                return self._past(formula)
            case f.Last() | f.Next() | f.Eventually() | f.Globally() | f.Until() | f.Release():
                raise UnsupportedError("it looks ahead")
            case f.ProbabilityBound():
                raise UnsupportedError("it states a probability")
            case _:
                assert_never(formula)

    def _past(
        self, formula: f.Previous | f.WeakPrevious | f.Once | f.Historically | f.Since
    ) -> Function:
        read = self.value
        match formula:
            case f.Previous(arg):
                return self._memory.keep(read(arg))
            case f.WeakPrevious(arg):
                return -self._memory.keep(-read(arg))
            case f.Once(arg, ago):
                return self._since(bdd.true(), read(arg), ago)
            case f.Historically(arg, ago):
                return -self._since(bdd.true(), -read(arg), ago)
            case f.Since(left, right, ago):
                return self._since(read(left), read(right), ago)
            case _:
                assert_never(formula)

    def _since(self, left: Function, right: Function, ago: f.Interval) -> Function:
        """`left S[lo,hi] right` is `H[0,lo-1] left & Y^lo (left S[0,hi-lo] right)`."""
        if ago.lo > LONGEST_DELAY:
            raise UnsupportedError(f"it looks back by {ago.lo} ticks, tick by tick")
        near = self._near(left, right, None if ago.hi is None else ago.hi - ago.lo)
        for _ in range(ago.lo):
            near = self._memory.keep(near) & left
        return near

    def _near(self, left: Function, right: Function, most: int | None) -> Function:
        """`left S[0,most] right`."""
        if most is None:
            bit = self._memory.bit()
            held = right | (left & bdd.variable(bit.now))
            self._memory.steps[bit] = held
            return held
        bits, rest = self._memory.word(most)
        steps = only(left, predecessor(rest))
        self._memory.set(bits, either(right, constant(most, rest), steps))
        return right | (left & some(rest))


def _folded(
    start: Function, functions: object, join: Callable[[Function, Function], Function]
) -> Function:
    found = start
    for function in functions:  # type: ignore[attr-defined]
        found = join(found, function)
    return found


@dataclass(frozen=True, slots=True)
class Counter:
    """One requirement. Its state has all bits false before the first tick."""

    id: str
    bits: tuple[Bit, ...]
    steps: tuple[Function, ...]
    """Of each bit its value after a tick, over the bits before it and the letter of the tick."""
    safe: Function
    """Whether a tick breaks nothing; once it does, nothing repairs it, and steps mean nothing."""
    fair: Function | None
    """Over bits: an endless run keeps the requirement by such states again and again; None: it has
    no other duty than to be safe."""
    words: tuple[tuple[Bit, ...], ...]
    """The bits of each of its counts, the least first."""
    enforced: Function
    """Whether a tick lies in an interval of the scope."""
    triggered: Function
    """Whether a demand begins at a tick."""

    @property
    def longest(self) -> int:
        """Bits of its largest count."""
        return max(map(len, self.words), default=0)

    @property
    def idle(self) -> Function:
        """Over bits: nothing is counted, so that nothing is owed by a deadline."""
        return bdd.point({bit.now: False for word in self.words for bit in word})
