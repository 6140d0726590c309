"""Exact verdicts of a past-time formula over all completions of a run with unknown values.

`compiler.logic.evaluation` reports unknown too often, such as for `p | !p` with p unknown. This
module is exact: the formula becomes an automaton, and all possible runs are followed at once, as
the set of their states.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product

from compiler.logic import formula as f
from fretish.classes.frozen import dataclass
from fretish.reading.recursion import with_recursion_limit
from monitors.kernel.columns import Column

MOST_STEPS = 1 << 16
"""Maximum number of steps of a search: ticks, and new moves of states."""

State = tuple[int, ...]
_Row = tuple[str, ...]
"""For a tick: whether it counts, and the code of each proposition."""
_Values = list[int]
_Node = Callable[[_Values, State, list[int]], int]
"""Computes the value of a sub-formula from the values of earlier sub-formulas and the memory of the
tick before, and appends to the memory for the next tick."""


@dataclass(frozen=True, slots=True)
class FirstTicks:
    """The ticks at which completions of a run show a formula; None if not all do, or none does."""

    by_some: int | None
    """The first tick at which a completion shows the formula."""
    by_all: int | None
    """The first tick by which every completion has shown the formula, possibly at different
    ticks."""


def first_ticks(
    formula: f.Formula, columns: Mapping[str, Column], ticks: int, counted: int
) -> FirstTicks | None:
    """The ticks at which completions show the formula; None if that needs more than `MOST_STEPS`.

    Args:
        formula: a past-time formula.
        columns: one for each atom; unknown values are independent of each other.
        ticks: the length of the run.
        counted: a column of the ticks that count; other ticks never show the formula.
    """
    automaton = _Automaton(formula)
    inputs = [columns[name] for name in automaton.names]
    possible, by_some = frozenset([automaton.initial]), None
    moves: dict[tuple[frozenset[State], _Row], tuple[frozenset[State], bool]] = {}
    steps = 0
    for tick, row in enumerate(_rows(inputs, counted, ticks)):
        step = possible, row
        if step not in moves:
            steps += len(possible) << row.count("2")
            if steps > MOST_STEPS:
                return None
            moves[step] = automaton.moved(possible, row)
        steps += 1
        if steps > MOST_STEPS:
            return None
        possible, is_shown = moves[step]
        if is_shown and by_some is None:
            by_some = tick
        if not possible:
            return FirstTicks(by_some, tick)
    return FirstTicks(by_some, None)


_VALUES: Mapping[str, tuple[int, ...]] = {"0": (0,), "1": (1,), "2": (0, 1)}
"""The possible values of a proposition by its code: false, true, either."""


def _rows(columns: Sequence[Column], counted: int, ticks: int) -> Iterator[_Row]:
    """For each tick: whether it counts, and the code of each proposition."""
    if not ticks:
        return
    texts = [_bits(counted & (1 << ticks) - 1, ticks)]
    for column in columns:
        true, unknown = _bits(column.true, ticks), _bits(column.unknown, ticks)
        texts.append("".join("2" if u == "1" else t for t, u in zip(true, unknown, strict=True)))
    yield from zip(*texts, strict=True)


def _bits(column: int, ticks: int) -> str:
    """A column as digits, tick 0 first."""
    return f"{column:0{ticks}b}"[::-1]


class _Automaton:
    """A past-time formula as an automaton that is stepped tick by tick."""

    def __init__(self, formula: f.Formula) -> None:
        self.names = [*f.atoms(formula)]
        self._nodes: list[_Node] = []
        self._first: list[int] = []
        self._moves: dict[tuple[State, _Row], tuple[set[State], bool]] = {}
        """Cache of moves: the sets of a run share most of their states."""
        self._places: dict[int, tuple[f.Formula, int]] = {}
        """The node of each sub-formula, by identity, because hashing a tree takes as long as the
        tree is large."""
        self._whole = self._place(formula)

    @property
    def initial(self) -> State:
        """The state before the first tick."""
        return tuple(self._first)

    def moved(self, states: frozenset[State], row: _Row) -> tuple[frozenset[State], bool]:
        """The states after a tick in which nothing was shown yet; and whether something was."""
        after, is_shown = set[State](), False
        for state in states:
            move = state, row
            if move not in self._moves:
                self._moves[move] = self._moved(state, row)
            following, shows = self._moves[move]
            after |= following
            is_shown |= shows
        return frozenset(after), is_shown

    def _moved(self, state: State, row: _Row) -> tuple[set[State], bool]:
        """The states after a tick from one state; and whether a completion showed the formula."""
        after, is_shown = set[State](), False
        for letter in product(*(_VALUES[code] for code in row[1:])):
            following, value = self._step(state, letter)
            if row[0] == "1" and value:
                is_shown = True
            else:
                after.add(following)
        return after, is_shown

    def _step(self, state: State, letter: Sequence[int]) -> tuple[State, int]:
        values, memory = [*letter], list[int]()
        for node in self._nodes:
            values.append(node(values, state, memory))
        return tuple(memory), values[self._whole]

    @with_recursion_limit
    def _place(self, formula: f.Formula) -> int:
        """The index of the value of a sub-formula; a shared sub-formula is computed once."""
        if isinstance(formula, f.Atom):
            return self.names.index(formula.name)
        if id(formula) not in self._places:
            node = self._node(formula)
            self._places[id(formula)] = formula, len(self.names) + len(self._nodes)
            self._nodes.append(node)
        return self._places[id(formula)][1]

    def _node(self, formula: f.Formula) -> _Node:
        places = [self._place(part) for part in f.children(formula)]
        match formula:
            case f.Const(value):
                return lambda *_: int(value)
            case f.And():
                return lambda values, *_: int(all(values[index] for index in places))
            case f.Or():
                return lambda values, *_: int(any(values[index] for index in places))
            case f.Not():
                return lambda values, *_: 1 - values[places[0]]
            case f.Xor():
                return lambda values, *_: values[places[0]] ^ values[places[1]]
            case f.Implies():
                return lambda values, *_: 1 - values[places[0]] | values[places[1]]
            case f.Iff():
                return lambda values, *_: int(values[places[0]] == values[places[1]])
            case f.Previous():
                return self._kept(places[0], first=0)
            case f.WeakPrevious():
                return self._kept(places[0], first=1)
            case f.Once(_, ago):
                return self._since(None, places[0], ago)
            case f.Historically(arg, ago):
                never = self._place(f.Once(f.Not(arg), ago))
                return lambda values, *_: 1 - values[never]
            case f.Since(_, _, ago):
                return self._since(places[0], places[1], ago)
            case _:
                raise ValueError("not a formula of the past")

    def _kept(self, index: int, first: int) -> _Node:
        slot = len(self._first)
        self._first.append(first)

        def node(values: _Values, state: State, memory: list[int]) -> int:
            memory.append(values[index])
            return state[slot]

        return node

    def _since(self, left: int | None, right: int, ago: f.Interval) -> _Node:
        """A node whose memory has bit k set if `right` was true k ticks ago and `left` since."""
        slot, lo, hi = len(self._first), ago.lo, ago.hi
        self._first.append(0)

        def node(values: _Values, state: State, memory: list[int]) -> int:
            going = left is None or values[left]
            ages = (state[slot] << 1 if going else 0) | values[right]
            if hi is not None:
                ages &= (2 << hi) - 1
            elif ages >> lo:  # the oldest has come to the window, and stays in it
                ages = 1 << lo
            if lo == 0:
                ages &= -ages  # only the youngest counts
            memory.append(ages)
            return int(ages >> lo != 0)

        return node
