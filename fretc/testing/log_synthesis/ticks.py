"""Required truth value of each proposition at each tick of a log for a test.

`... for 200 ms` looks back: its argument must hold at earlier ticks, which may be before the test.
Then the log has additional ticks at its start, which do not change the verdict.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

from fretc.testing.log_synthesis.messages import NotRecordableError
from fretc.testing.suite import Test
from fretish import expressions as e
from fretish.bindings.declarations import Proposition
from fretish.bindings.expressions import ticks_back
from fretish.classes.frozen import dataclass
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Truth

Truths = Sequence[Truth]
_MOST = 6
"""Maximum number of propositions whose combinations are tried before the test."""


@dataclass(frozen=True, slots=True)
class TickPart:
    """The part of a proposition that the messages of a tick decide."""

    proposition: Proposition
    expression: e.Expression
    """Expression without its duration."""
    back: int
    """Number of earlier ticks over which it must last."""


@dataclass(frozen=True, slots=True)
class TickPlan:
    """The ticks of a log."""

    lead: int
    """Number of ticks before those of the test."""
    wanted: Mapping[str, Truths]
    """Proposition → required value of its part at each tick."""


def part(proposition: Proposition, period: int) -> TickPart:
    """A proposition without its duration.

    Args:
        proposition: a proposition of the bindings.
        period: length of a tick in nanoseconds.

    Raises:
        NotRecordableError: it looks back in another way.
    """
    expression, back = proposition.expression, 0
    if isinstance(expression, e.Persistence):
        back = -(-expression.duration // period)
        expression = expression.arg
    if any(isinstance(each, e.Persistence) for each in e.parts(expression)):
        raise NotRecordableError(f"`for` stands within the expression of `{proposition.name}`")
    if ticks_back(expression):
        raise NotRecordableError(f"`{proposition.name}` reads numbers of the tick before")
    return TickPart(proposition, expression, back)


def tick_plan(test: Test, parts: Sequence[TickPart], monitor: Monitor) -> TickPlan:
    """The ticks of a test, with additional ticks before them if needed.

    Args:
        test: test whose rows have the truth of each proposition.
        parts: parts of the propositions of the monitor, in its order.
        monitor: monitor of the requirement.

    Raises:
        NotRecordableError: no ticks give a duration its required values.
    """
    columns = {one.proposition.name: _column(test, one.proposition.name) for one in parts}
    most = max((one.back for one in parts), default=0)
    for lead in sorted({0, most, 2 * most}):
        for letter in _letters(parts, columns) if lead else [{}]:
            wanted, seen = {}, {}
            for one in parts:
                name = one.proposition.name
                wanted[name] = _lasting([letter.get(name)] * lead, columns[name], one)
                seen[name] = _seen(wanted[name], one)
            same = all(seen[name][lead:] == columns[name] for name in columns)
            if same and (lead == 0 or _unchanged(test, lead, seen, monitor)):
                return TickPlan(lead, wanted)
    raise NotRecordableError(_impossible(parts))


def _impossible(parts: Sequence[TickPart]) -> str:
    names = ", ".join(f"`{one.proposition.name}`" for one in parts if one.back)
    if not names:
        return "it turns unknown values into known ones"
    return f"{names} cannot become true and false so soon: it looks back in time"


def _column(test: Test, name: str) -> list[Truth]:
    column: list[Truth] = []
    for row in test.rows:
        if name not in row.values:
            raise NotRecordableError(f"the test has no value for `{name}`")
        value = row.values[name]
        assert value is None or isinstance(value, bool), (test.name, name)
        column += [value] * row.count
    return column


def _letters(
    parts: Sequence[TickPart], columns: Mapping[str, Truths]
) -> Iterator[Mapping[str, Truth]]:
    """Valuations that may precede the test; propositions with durations are left open."""
    free = [one.proposition.name for one in parts if not one.back]
    first = {name: columns[name][0] for name in free}
    yield first
    for values in product((False, True), repeat=len(free)) if len(free) <= _MOST else ():
        yield dict(zip(free, values, strict=True))


def _lasting(before: Sequence[Truth], column: Truths, one: TickPart) -> list[Truth]:
    """Values of a part that give its duration the column's values."""
    if not one.back:
        return [*before, *column]
    lead = len(before)
    wanted: list[Truth] = [False] * (lead + len(column))
    for value in (None, True):
        for tick, truth in enumerate(column):
            if truth is value:
                for k in range(max(0, lead + tick - one.back), lead + tick):
                    wanted[k] = True
                wanted[lead + tick] = value
    return wanted


def _seen(wanted: Truths, one: TickPart) -> list[Truth]:
    """Values of a proposition that the audit reads for these values of its part."""
    seen: list[Truth] = []
    for tick in range(len(wanted)):
        window = wanted[max(0, tick - one.back) : tick + 1]
        begun: Truth = True if tick >= one.back else None
        truth = False if False in window else None if None in window else begun
        seen.append(one.proposition.on_unknown if truth is None else truth)
    return seen


def _unchanged(test: Test, lead: int, seen: Mapping[str, Truths], monitor: Monitor) -> bool:
    """Whether the monitor gives the longer run the results of the test."""
    monitor.reset()
    for tick in range(lead + test.ticks):
        monitor.advance([tuple(seen[name][tick] for name in monitor.PROPOSITIONS)])
    (status,) = monitor.statuses()
    first = status.first_violation
    moved = None if first is None else first - lead
    return str(status.verdict) == test.verdict and moved == test.first_violation
