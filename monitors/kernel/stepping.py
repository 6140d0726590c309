"""The base class of generated monitors: two approximations, stepped tick by tick.

An approximation is generated code that computes two-valued signals. A monitor has two instances:
one computes what is certain (an unknown counts as false), the other what is possible (an unknown
counts as true). This is correct because every operator is monotone in the propositions and in their
negations. As long as no value was unknown, one instance serves for both. Source: Kleene,
Introduction to Metamathematics, 1952, section 64 (strong three-valued logic).
"""

import hashlib
import itertools
import json
import typing
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any, ClassVar, NamedTuple, Protocol, TypeVar

from monitors.kernel.columns import Column
from monitors.kernel.verdicts import (
    Requirement,
    Signals,
    Truth,
    Verdict,
    at_end,
    truth,
)

Row = typing.Sequence[Truth]
"""The truth of each proposition at one tick, in the order of `PROPOSITIONS`."""


A = TypeVar("A")


class Marks(NamedTuple):
    """Ticks that an approximation stores for one requirement; -1: none."""

    broken: int
    """The first tick at which an obligation was violated."""
    violation_inevitable: int
    """The first tick at which open obligations became impossible to meet."""
    last: int
    """The last trigger."""
    open: int
    """The trigger of the oldest open obligation; of the latest if a new one replaces it."""

    @property
    def violated(self) -> int:
        """The tick at which the violation is certain; -1: not violated."""
        ticks = [tick for tick in (self.broken, self.violation_inevitable) if tick >= 0]
        return min(ticks, default=-1)


class Approximation(Protocol):
    """A generated approximation: straight-line code, its state in slots."""

    __slots__: "tuple[str, ...]"
    CELLS: ClassVar["tuple[str, ...]"]
    """The slots on which later signals depend; the others only store ticks."""
    is_possible: bool
    tick: int

    def __init__(self, is_possible: bool = False) -> None:
        """Start before the first tick; an unknown counts as true if `is_possible`."""

    def advance(self, rows: "Iterable[Sequence[Any]]") -> bool:
        """Step over all rows; whether all their values were known."""

    def signals(self) -> "tuple[Signals[bool], ...]":
        """The signals of the last tick, for each requirement."""

    def marks(self) -> "tuple[Marks, ...]":
        """The stored ticks of each requirement."""


class _Interval:
    """Ticks without a gap at which `right` of a window held, and the interval after it."""

    __slots__ = ("end", "next", "start")

    def __init__(self, start: int, end: int) -> None:
        self.start, self.end = start, end
        self.next: _Interval | None = None


class Window:
    """`left S[lo,hi] right` in ticks; memory: the intervals of `right` inside of the window.

    Copies share the intervals that have ended, so a copy costs the same for any number of them:
    they are linked from the oldest to the youngest, a window goes no further than its own last one,
    and what a fork adds branches off. The interval that may still grow is `start` and `end`.
    """

    __slots__ = ("branch", "end", "first", "hi", "last", "lo", "now", "start", "turn")

    def __init__(self, lo: int, hi: int) -> None:
        self.lo, self.hi = lo, hi
        self.now = -1
        self._clear()

    def _clear(self) -> None:
        """No interval."""
        self.start = self.end = _NONE
        self.first: _Interval | None = None
        self.last: _Interval | None = None
        self.turn: _Interval | None = None
        self.branch: _Interval | None = None

    def step(self, left: bool, right: bool) -> bool:
        """Whether right held `lo..hi` ticks ago, and left ever since."""
        self.now += 1
        now = self.now
        if not left:
            self._clear()
        if right:
            if self.end != now - 1:
                if self.end != _NONE:
                    self._add(_Interval(self.start, self.end))
                self.start = now
            self.end = now
        while self.first is not None and self.first.end < now - self.hi:
            self._drop(self.first)
        if self.first is not None:
            return self.first.start <= now - self.lo
        if self.end < now - self.hi:
            self.start = self.end = _NONE
        return 0 <= self.start <= now - self.lo

    def _add(self, interval: _Interval) -> None:
        """The interval has ended."""
        if self.last is None:
            self.first = interval
        elif self.last is self.turn:
            self.branch = interval
        else:
            self.last.next = interval
        self.last = interval

    def _after(self, interval: _Interval) -> "_Interval | None":
        if interval is self.last:
            return None
        return self.branch if interval is self.turn else interval.next

    def _drop(self, oldest: _Interval) -> None:
        self.first = self._after(oldest)
        if self.first is None:
            self.last = None
        if oldest is self.turn:  # The other window needs the intervals after it.
            self.turn = self.branch = None

    def copy(self) -> "Window":
        """A copy in the same state; only one of both can be stepped further."""
        other = Window(self.lo, self.hi)
        for name in self.__slots__:
            setattr(other, name, getattr(self, name))
        return other

    def fork(self) -> "Window":
        """A copy in the same state; both can be stepped further. A fork cannot be forked."""
        assert self.turn is None
        other = self.copy()
        other.turn = self.last
        return other

    def _intervals(self) -> "Iterator[tuple[int, int]]":
        """The oldest first."""
        interval = self.first
        while interval is not None:
            yield interval.start, interval.end
            interval = self._after(interval)
        if self.end != _NONE:
            yield self.start, self.end

    def state(self) -> "tuple[tuple[int, int], ...]":
        """The intervals, each as ages (oldest, youngest); ages above `hi` are all one."""
        return tuple((min(self.now - a, self.hi), self.now - b) for a, b in self._intervals())

    def is_like(self, other: "Window") -> bool:
        """Whether two windows with equal clocks have equal states; shared intervals are skipped."""
        mine, theirs, shared = self.first, other.first, other.turn
        youngest = (self.start, self.end), (other.start, other.end)
        if mine is None or theirs is None:
            return mine is theirs and self._same(*youngest)
        if mine is theirs and shared is not None:
            mine, theirs = shared, shared
        elif not self._same((mine.start, mine.end), (theirs.start, theirs.end)):
            return False
        mine, theirs = self._after(mine), other._after(theirs)
        while mine and theirs and (mine.start, mine.end) == (theirs.start, theirs.end):
            mine, theirs = self._after(mine), other._after(theirs)
        return mine is theirs is None and youngest[0] == youngest[1]

    def _same(self, one: "tuple[int, int]", other: "tuple[int, int]") -> bool:
        """Whether two intervals are equal within the window."""
        reach = self.now - self.hi
        return one[1] == other[1] and max(one[0], reach) == max(other[0], reach)

    def restore(self, state: "Sequence[Sequence[int]]") -> None:
        """Restore a state."""
        self._clear()
        self.now = self.hi
        for oldest, youngest in state:
            if self.end != _NONE:
                self._add(_Interval(self.start, self.end))
            self.start, self.end = self.now - oldest, self.now - youngest


_NONE = -2
"""No tick, and none before one."""


class RequirementStatus(NamedTuple):
    """The verdict on a requirement if the trace ended now, and its reasons."""

    requirement: str
    verdict: Verdict
    finite: Truth
    """FRET's verdict on the finite trace up to here."""
    first_violation: "int | None"
    open: "int | None"
    """The trigger of the obligation that is certainly open: of the oldest, or of the latest if a
    new one replaces it (`for`, `next`)."""
    deadline: "int | None"
    """The last tick at which this obligation can be decided; None if it has no deadline."""
    obligation_pending: Truth
    """Whether an obligation begins at this tick or is open after it. The robot must stop unless it
    is False. None before the first tick, and if it depends on an unknown value."""

    @property
    def owed(self) -> Truth:
        """The former name of `obligation_pending`; deprecated."""
        renamed("owed", "obligation_pending")
        return self.obligation_pending


def renamed(old: str, new: str) -> None:
    """Warn the caller of a name that the next version does not have any more."""
    warnings.warn(f"`{old}` is now `{new}`", DeprecationWarning, stacklevel=3)


_PIECE, _FEW, _SOON = 4096, 64, 64
"""Rows that are stepped at once; rows in which it is cheaper to look for unknowns than to copy;
ticks after which two approximations are compared first."""


class Monitor:
    """Steps propositions; a generated class adds `step`, `run` and `verdicts`."""

    PROGRAM: ClassVar[str]
    """SHA-256 of the generated code: a state fits no other."""
    REQUIREMENTS: ClassVar["tuple[Requirement, ...]"]
    PROPOSITIONS: ClassVar["Mapping[str, str]"]
    """Proposition -> its parameter of `step`."""
    LITERALS: ClassVar["tuple[tuple[str, str, bool], ...]"]
    """Each parameter of `columns`, its proposition, and False if it is negated."""
    APPROXIMATION: ClassVar["type[Approximation]"]
    verdicts: "Callable[..., tuple[Verdict, ...]]"
    """The LTL3 verdict on each requirement: satisfied, violated or pending."""
    columns: "Callable[..., tuple[Signals[int], ...]]"
    """The signals of each requirement on whole traces. Arguments: `every`, the column that is true
    at every tick, and a keyword for each of `LITERALS`."""

    def __init__(self) -> None:
        self._values = _picked(tuple(self.PROPOSITIONS.values()))
        self.reset()

    def reset(self) -> None:
        """Forget everything: the next step is tick 0."""
        self.certain = self.possible = self.APPROXIMATION()

    @property
    def tick(self) -> int:
        """The last tick; -1 before the first."""
        return self.certain.tick

    def state(self) -> "dict[str, Any]":
        """The whole memory, as plain values that JSON can hold."""
        content = {
            "program": self.PROGRAM,
            "certain": _saved(self.certain),
            "possible": None if self._is_one() else _saved(self.possible),
        }
        return {**content, "sha256": _digest(content)}

    def restore(self, state: "Mapping[str, Any]") -> None:
        """Go on from what `state` gave.

        Raises:
            ValueError: it is no state of this monitor.
        """
        content = dict(state) if isinstance(state, Mapping) else {}
        digest = content.pop("sha256", None)
        if content.get("program") != self.PROGRAM:
            raise ValueError("the state is of another monitor, or is none")
        if digest != _digest(content):
            raise ValueError("the state was changed after it was saved")
        certain, possible = self.APPROXIMATION(), self.APPROXIMATION(is_possible=True)
        _restored(certain, content["certain"])
        if content["possible"] is not None:
            _restored(possible, content["possible"])
        self.certain = self.possible = certain
        if content["possible"] is not None:
            self._part(possible)

    def statuses(self) -> "tuple[RequirementStatus, ...]":
        """The status of each requirement."""
        if self.tick < 0:
            nothing = (Verdict.NO_DATA, None, None, None, None, None)
            return tuple(RequirementStatus(r.id, *nothing) for r in self.REQUIREMENTS)
        marks = self.certain.marks(), self.possible.marks()
        signals = self.certain.signals(), self.possible.signals()
        return tuple(map(_status, self.REQUIREMENTS, *marks, *signals))

    def standings(self) -> "tuple[RequirementStatus, ...]":
        """The former name of `statuses`; deprecated."""
        renamed("standings", "statuses")
        return self.statuses()

    def statuses_after(
        self, rows: "Iterable[Row | Mapping[str, Truth]]"
    ) -> "tuple[RequirementStatus, ...]":
        """The statuses after further rows, without stepping the monitor.

        Raises:
            KeyError, TypeError, ValueError: as `advance` does.
        """
        return self._after(rows, self.statuses)

    def standings_after(
        self, rows: "Iterable[Row | Mapping[str, Truth]]"
    ) -> "tuple[RequirementStatus, ...]":
        """The former name of `statuses_after`; deprecated."""
        renamed("standings_after", "statuses_after")
        return self.statuses_after(rows)

    def obligation_pending_after(
        self, rows: "Iterable[Row | Mapping[str, Truth]]"
    ) -> "tuple[Truth, ...]":
        """The `obligation_pending` of each of `statuses_after(rows)`, but cheaper.

        Raises:
            KeyError, TypeError, ValueError: as `advance` does.
        """
        return self._after(rows, self._obligation_pending)

    def owed_after(self, rows: "Iterable[Row | Mapping[str, Truth]]") -> "tuple[Truth, ...]":
        """The former name of `obligation_pending_after`; deprecated."""
        renamed("owed_after", "obligation_pending_after")
        return self.obligation_pending_after(rows)

    def _obligation_pending(self) -> "tuple[Truth, ...]":
        if self.tick < 0:
            return (None,) * len(self.REQUIREMENTS)
        return tuple(map(_obligation_pending, self.certain.signals(), self.possible.signals()))

    def _after(self, rows: "Iterable[Row | Mapping[str, Truth]]", read: "Callable[[], A]") -> A:
        kept = dict(vars(self))
        self.certain, self.possible = self._copies()
        try:
            self._advance(self._in_order([*rows]))
            return read()
        finally:
            vars(self).update(kept)

    def _fork(self) -> None:
        """Make a separate approximation for possible values."""
        if self.possible is self.certain:
            self._part(_forked(self.certain))

    def _step(self, row: Row) -> None:
        """Step both approximations, or one as long as all is known."""
        if self.possible is self.certain and None in row:
            self._fork()
        certain, possible = self.certain, self.possible
        certain.advance((row,))
        if possible is not certain:
            possible.advance((row,))
            self._meet()

    def _part(self, possible: Approximation) -> None:
        self.possible = possible
        self._apart = self.tick
        self._due = self.tick + _SOON

    def _meet(self) -> None:
        """Use one approximation again if both have equal states; checked less and less often."""
        tick = self.tick
        if tick < self._due:
            return
        if self._is_one():
            self.possible = self.certain
        self._due = tick + max(_SOON, tick - self._apart)

    def _is_one(self) -> bool:
        """Whether both approximations have equal states; windows are compared last."""
        if self.possible is self.certain:
            return True
        windows = []
        for name in self.APPROXIMATION.__slots__:
            certain, possible = getattr(self.certain, name), getattr(self.possible, name)
            if isinstance(certain, Window):
                windows.append((certain, possible))
            elif certain != possible and name != "is_possible":
                return False
        return all(certain.is_like(possible) for certain, possible in windows)

    def advance(self, rows: "Iterable[Row | Mapping[str, Truth]]") -> None:
        """Step every row, in pieces of some thousand: one approximation after the other.

        An exception leaves the monitor at the end of the last whole piece.

        Raises:
            KeyError: a row has no value for a proposition.
            TypeError: a value is not True, False or None.
            ValueError: a row has more or fewer values than there are propositions.
        """
        waiting = iter(rows)
        while piece := list(itertools.islice(waiting, _PIECE)):
            block = self._in_order(piece)
            before = (self.certain, self.possible) if len(block) == 1 else self._copies()
            try:
                self._advance(block)
            except BaseException:  # Both approximations must stay at the same tick.
                self.certain, self.possible = before
                raise

    def _advance(self, block: "list[Row]") -> None:
        """Step both approximations, or one as long as all is known."""
        if self.possible is not self.certain:
            self.certain.advance(block)
            self.possible.advance(block)
            self._meet()
        elif len(block) < _FEW:
            if any(None in row for row in block):
                self._fork()
                self.possible.advance(block)
            self.certain.advance(block)
        else:
            before = _forked(self.certain)
            if not self.certain.advance(block):
                self._part(before)
                before.advance(block)

    def _copies(self) -> "tuple[Approximation, Approximation]":
        """Both approximations as they are now."""
        certain = _copied(self.certain)
        return certain, certain if self.possible is self.certain else _copied(self.possible)

    def _in_order(self, rows: "list[Any]") -> "list[Row]":
        """Rows by name as rows in the order of `PROPOSITIONS`."""
        if not rows or not isinstance(rows[0], Mapping):
            return rows
        return list(map(_picked(tuple(self.PROPOSITIONS)), rows))

    def rows_of(self, names: "Sequence[str]") -> "Callable[[Iterable[Row]], Iterable[Row]]":
        """A function that reorders rows with values in the order of `names` for `run`.

        Raises:
            ValueError: the names are not a permutation of `PROPOSITIONS`.
        """
        return rows_in_order(tuple(names), tuple(self.PROPOSITIONS))

    def _row(self, arguments: "Mapping[str, Truth]") -> Row:
        """The arguments of a step that has too many parameters for Python to look for each.

        Raises:
            TypeError: as Python does, where one is missing or is no parameter.
        """
        parameters = tuple(self.PROPOSITIONS.values())
        if len(arguments) == len(parameters):
            try:
                return self._values(arguments)
            except KeyError:
                pass
        where = f"{type(self).__name__}.step()"
        for name in arguments:
            if name not in parameters:
                raise TypeError(f"{where} got an unexpected keyword argument {name!r}")
        missing = ", ".join(repr(name) for name in parameters if name not in arguments)
        raise TypeError(f"{where} missing required keyword-only arguments: {missing}")


def rows_in_order(
    names: "tuple[str, ...]", order: "tuple[str, ...]"
) -> "Callable[[Iterable[Sequence[Any]]], Iterable[Sequence[Any]]]":
    """A function that reorders rows of values from the order of `names` to `order`.

    Raises:
        ValueError: `names` is not a permutation of `order`.
    """
    places = {name: index for index, name in enumerate(names)}
    missing, unknown = {*order} - places.keys(), places.keys() - {*order}
    for wrong, why in ((missing, "is missing"), (unknown, "is no name of this monitor")):
        if wrong:
            raise ValueError(f"`{min(wrong)}` {why}")
    if len(places) < len(names):
        raise ValueError("a name comes more than once")
    if names == order:
        return lambda rows: rows
    pick = _picked([places[name] for name in order])

    def in_order(rows: "Iterable[Sequence[Any]]") -> "Iterator[Sequence[Any]]":
        for row in rows:
            if len(row) != len(names):
                raise ValueError(f"a row has {len(row)} values for {len(names)} names")
            yield pick(row)

    return in_order


def _picked(keys: "Sequence[Any]") -> "Callable[[Any], tuple[Any, ...]]":
    """A function that gives the values of all keys as a tuple."""
    if len(keys) < 2:
        return lambda values: tuple(values[key] for key in keys)
    return itemgetter(*keys)


def _status(
    requirement: Requirement,
    certain_marks: Marks,
    possible_marks: Marks,
    certain: "Signals[bool]",
    possible: "Signals[bool]",
) -> RequirementStatus:
    broken = truth(certain_marks.broken >= 0, possible_marks.broken >= 0)
    violated = truth(certain_marks.violated >= 0, possible_marks.violated >= 0)
    opened = certain_marks.open if certain_marks.open >= 0 else None
    deadline = None
    if opened is not None and requirement.deadline_ticks is not None:
        deadline = opened + requirement.deadline_ticks
    return RequirementStatus(
        requirement.id,
        at_end(
            violated,
            truth(certain.obligation_pending, possible.obligation_pending),
            truth(certain_marks.last >= 0, possible_marks.last >= 0),
        ),
        finite_verdict(broken, truth(certain.violated_if_ended, possible.violated_if_ended)),
        certain_marks.violated if certain_marks.violated >= 0 else None,
        opened,
        deadline,
        _obligation_pending(certain, possible),
    )


def _obligation_pending(certain: "Signals[bool]", possible: "Signals[bool]") -> Truth:
    return truth(
        certain.trigger or certain.obligation_pending,
        possible.trigger or possible.obligation_pending,
    )


def finite_verdict(broken: Truth, violated_if_ended: Truth) -> Truth:
    """FRET's verdict on the finite trace: not violated, and it may end here."""
    if broken or violated_if_ended:
        return False
    return True if broken is False and violated_if_ended is False else None


def literals_of(
    monitor: "Monitor | type[Monitor]",
    columns: "Mapping[str, Column]",
    every: int,
    is_possible: bool,
) -> "dict[str, int]":
    """The columns of the literals on one approximation."""
    literals = {}
    for name, proposition, positive in monitor.LITERALS:
        true, unknown = columns[proposition]
        sure = true if positive else every ^ (true | unknown)
        literals[name] = sure | unknown if is_possible else sure
    return literals


def _copied(approximation: Approximation) -> Approximation:
    """An approximation in the same state; only one of both can be stepped further."""
    return _with_windows(approximation, approximation.is_possible, Window.copy)


def _forked(approximation: Approximation) -> Approximation:
    """The possible approximation, in the state of this one; both can be stepped."""
    return _with_windows(approximation, True, Window.fork)


def _with_windows(
    approximation: Approximation, is_possible: bool, made: "Callable[[Window], Window]"
) -> Approximation:
    copy = type(approximation)(is_possible=is_possible)
    for name in approximation.__slots__:
        if name != "is_possible":
            value = getattr(approximation, name)
            setattr(copy, name, made(value) if isinstance(value, Window) else value)
    return copy


def _saved(approximation: Approximation) -> "dict[str, Any]":
    values = {name: getattr(approximation, name) for name in approximation.__slots__}
    return {
        name: value.state() if isinstance(value, Window) else value
        for name, value in values.items()
    }


def _digest(content: "Mapping[str, Any]") -> str:
    """The SHA-256 of a state; equal for tuples and for lists from JSON; empty if it is no JSON."""
    try:
        text = json.dumps(content, sort_keys=True, allow_nan=False)
    except (TypeError, ValueError):
        return ""
    return hashlib.sha256(text.encode()).hexdigest()


def _restored(approximation: Approximation, state: "Mapping[str, Any]") -> None:
    """Put a saved state into an approximation; its digest has shown that nothing is missing."""
    for name, value in state.items():
        there = getattr(approximation, name)
        if isinstance(there, Window):
            there.restore(value)
        else:
            setattr(approximation, name, tuple(value) if isinstance(value, list) else value)
