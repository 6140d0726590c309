"""Bits of a state that are built one by one, and formulas of the past over them.

All bits are false before the first tick. A counter is a vector of bits, lowest first, and is
computed by arithmetic: a bound of a million ticks has twenty bits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import chain
from typing import assert_never

from compiler.logic import formula as f
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.variables import Numbers, UnsupportedError, numbers
from fretish.classes.frozen import dataclass

Word = Sequence[Function]
"""Bits of a whole number from 0 on, lowest first."""
LONGEST_DELAY = 256
"""Longest delay in ticks for which each value is stored in a bit of its own."""


@dataclass(frozen=True, slots=True)
class Bit:
    """A bit of a state: its value before a tick, and the variables for later ticks."""

    now: int
    after: int
    later: int
    """The variable of the bit after some more ticks."""


class Memory:
    """The bits of one requirement, during construction."""

    def __init__(self, fresh: Numbers, shared: dict[Function, Bit]) -> None:
        self._fresh, self.shared = fresh, shared
        self.bits: list[Bit] = []
        self.steps: dict[Bit, Function] = {}
        """The value of each bit after a tick, over bits before it and a letter."""
        self.words: list[tuple[Bit, ...]] = []
        """The bits of each count, lowest first."""

    def bit(self) -> Bit:
        """A new bit, whose step is still to be set."""
        self.bits.append(Bit(*(next(self._fresh) for _ in range(3))))
        return self.bits[-1]

    def word(self, most: int) -> tuple[list[Bit], Word]:
        """Bits for the numbers 0..most, highest first in the variable order; and their values."""
        bits = [self.bit() for _ in range(most.bit_length())][::-1]
        self.words.append(tuple(bits))
        return bits, [bdd.variable(bit.now) for bit in bits]

    def keep(self, value: Function) -> Function:
        """The value at the previous tick; false at the first tick."""
        if value in self.shared:
            self.bits.append(self.shared[value])
        else:
            self.shared[value] = self.bit()
        bit = self.shared[value]
        self.steps[bit] = value
        return bdd.variable(bit.now)

    def set(self, bits: Sequence[Bit], values: Word) -> None:
        """Set the steps of a bit vector."""
        self.steps.update(zip(bits, values, strict=True))

    def needed(self, roots: Sequence[Function]) -> tuple[Bit, ...]:
        """Bits on which the functions depend, at this tick or a later one."""
        by_number = {bit.now: bit for bit in self.bits}
        bits: set[Bit] = set()
        waiting = list(roots)
        while waiting:
            read = {by_number[n] for n in bdd.support(waiting.pop()) if n in by_number}
            waiting.extend(self.steps[bit] for bit in read - bits)
            bits |= read
        return tuple(bit for bit in dict.fromkeys(self.bits) if bit in bits)


def side_by_side(words: Iterable[tuple[Bit, ...]], count: int) -> Numbers:
    """Variables for a second construction like the first, with bits of equal weight adjacent.

    Args:
        words: bit vectors of the first construction, lowest bits first.
        count: number of variables; the second construction takes them in the same order.
    """
    weights = {
        number: weight
        for word in words
        for weight, bit in enumerate(word)
        for number in (bit.now, bit.after, bit.later)
    }
    order = sorted(range(count), key=lambda number: (-weights.get(number, count), number))
    places = {number: index for index, number in enumerate(order)}
    return chain((places[number] for number in range(count)), numbers(count))


# Arithmetic -----------------------------------------------------------------------------------


def equals(word: Word, number: int) -> Function:
    """Whether the bit vector equals the number, which fits."""
    function = bdd.true()
    for index, bit in reversed([*enumerate(word)]):
        function = (bit if number >> index & 1 else -bit) & function
    return function


def constant(number: int, like: Word) -> Word:
    """The number as a bit vector of the same length."""
    return [bdd.true() if number >> index & 1 else bdd.false() for index in range(len(like))]


def successor(word: Word) -> Word:
    """The number plus one; the greatest becomes 0."""
    carry, bits = bdd.true(), []
    for bit in word:
        bits.append(bit ^ carry)
        carry = carry & bit
    return bits


def predecessor(word: Word) -> Word:
    """The number minus one; 0 stays 0."""
    borrow, bits = some(word), []
    for bit in word:
        bits.append(bit ^ borrow)
        borrow = borrow - bit
    return bits


def some(word: Word) -> Function:
    """Whether the number is above 0."""
    function = bdd.false()
    for bit in word:
        function = function | bit
    return function


def either(condition: Function, then: Word, otherwise: Word) -> Word:
    """Bit vector: `if condition then left else right`."""
    pairs = zip(then, otherwise, strict=True)
    return [bdd.ite(condition, left, right) for left, right in pairs]


def only(condition: Function, word: Word) -> Word:
    """The bit vector, or 0 if the condition is false."""
    return [condition & bit for bit in word]


# Formulas of the past ---------------------------------------------------------------------------


class PastMemory:
    """Formulas of the past as functions of a valuation and of bits that they add to a memory.

    Source: Havelund, Rosu, Synthesizing monitors for safety properties, TACAS 2002: the value of a
    formula at a tick needs the values of its parts at this tick and at the previous one.
    """

    def __init__(self, atom: Callable[[str], Function], memory: Memory) -> None:
        self._atom, self._memory = atom, memory
        self._known: dict[f.Formula, Function] = {}

    def value(self, formula: f.Formula) -> Function:
        """Truth of the formula at a tick.

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
    result = start
    for function in functions:  # type: ignore[attr-defined]
        result = join(result, function)
    return result


@dataclass(frozen=True, slots=True)
class RequirementCounter:
    """A requirement as a counter. All bits of its state are false before the first tick."""

    id: str
    bits: tuple[Bit, ...]
    steps: tuple[Function, ...]
    """The value of each bit after a tick, over the bits before it and the valuation of the tick."""
    safe: Function
    """Whether a tick violates nothing; after a violation, steps have no meaning."""
    fair: Function | None
    """Function over bits: an endless run satisfies the requirement if such states recur; None:
    safety is enough."""
    words: tuple[tuple[Bit, ...], ...]
    """The bits of each count, lowest first."""
    enforced: Function
    """Whether a tick lies in an interval of the scope."""
    triggered: Function
    """Whether an obligation begins at a tick."""

    @property
    def longest(self) -> int:
        """Number of bits of the largest count."""
        return max(map(len, self.words), default=0)

    @property
    def idle(self) -> Function:
        """Function over bits: no count runs, so no deadline is open."""
        return bdd.point({bit.now: False for word in self.words for bit in word})
