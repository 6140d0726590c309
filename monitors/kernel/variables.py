"""The base of a monitor whose sentences compare: it is stepped by variables.

Its approximations see the truth of comparisons, as every monitor's see that of propositions.
"""

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple, Union

from monitors.kernel.readings import Reading, Single
from monitors.kernel.stepping import Monitor, _digest, rows_in_order
from monitors.kernel.verdicts import Truth

Value = Union[float, str, bool, None]
"""The value of a variable at a tick; None is unknown."""


class Variable(NamedTuple):
    """The type of a variable of a sentence."""

    parameter: str
    """The name of its parameter of `step`."""
    kind: str
    """`number`, `truth` or `word`."""
    words: "tuple[str, ...]" = ()
    """The words of an enumeration."""
    infinite: "tuple[str, ...]" = ()
    """The infinities that are values of a number: `+inf`, `-inf`; others are unknown."""


_ROWS = 4096
"""Rows of variables that are stepped at once."""


class VariableMonitor(Monitor):
    """Steps variables and gives verdicts; `advance` takes the truth of `PROPOSITIONS` as ever."""

    VARIABLES: ClassVar["Mapping[str, Variable]"]
    """The variables of a step, by their names in the sentences."""
    truths: "Callable[..., tuple[Truth, ...]]"
    """The truth of `PROPOSITIONS`, from a value for each of `VARIABLES`; once a tick, for it keeps
    what the next tick looks back at."""
    kept: "tuple[Reading, ...] | None"
    """The values that the next tick looks back at; None before the first tick."""

    def reset(self) -> None:
        """Forget everything: the next step is tick 0."""
        super().reset()
        self.kept = None

    def take(self, rows: "Iterable[Sequence[Value] | Mapping[str, Value]]") -> None:
        """Step every row of variables, in pieces of some thousand.

        An exception leaves the monitor at the end of the last whole piece.

        Raises:
            KeyError: a row has no value for a variable.
            TypeError: a value is of another kind than its variable.
            ValueError: a row has more or fewer values, or a word is none of those declared.
        """
        waiting = iter(rows)
        while piece := list(itertools.islice(waiting, _ROWS)):
            kept = self.kept
            try:
                self.advance([self.truths(*row) for row in self._by_variable(piece)])
            except BaseException:
                self.kept = kept
                raise

    def rows_of(self, names: "Sequence[str]") -> "Callable[[Iterable[Any]], Iterable[Any]]":
        """A function that reorders rows with values in the order of `names` for `run`.

        Raises:
            ValueError: the names are not a permutation of `VARIABLES`.
        """
        return rows_in_order(tuple(names), tuple(self.VARIABLES))

    def _by_variable(self, rows: "list[Any]") -> "Iterator[Sequence[Value]]":
        """Rows by name as rows in the order of `VARIABLES`."""
        names = tuple(self.VARIABLES)
        for row in rows:
            if isinstance(row, Mapping):
                yield tuple([row[name] for name in names])
            elif len(row) == len(names):
                yield row
            else:
                raise ValueError(f"a row has {len(row)} values for {len(names)} variables")

    def state(self) -> "dict[str, Any]":
        """The whole memory, as plain values that JSON can hold."""
        content = super().state()
        del content["sha256"]
        content["kept"] = None if self.kept is None else [_plain_value(v) for v in self.kept]
        return {**content, "sha256": _digest(content)}

    def restore(self, state: "Mapping[str, Any]") -> None:
        """Go on from what `state` gave.

        Raises:
            ValueError: it is no state of this monitor.
        """
        content = dict(state) if isinstance(state, Mapping) else {}
        digest, kept = content.pop("sha256", None), content.pop("kept", None)
        if digest == _digest({**content, "kept": kept}):
            content["sha256"] = _digest(content)
        super().restore(content)
        self.kept = None if kept is None else tuple(map(_reading, kept))


def rows_of_truth(
    monitor: "type[VariableMonitor]", rows: "Iterable[Sequence[Value]]"
) -> "Iterator[tuple[Truth, ...]]":
    """The truth of `PROPOSITIONS` at each tick of a whole trace, from rows of `VARIABLES`."""
    alone = monitor()
    return (alone.truths(*row) for row in rows)


_SINGLE = "single "


def _plain_value(reading: Reading) -> "int | str | None":
    """A number as JSON without loss; JSON has no infinities."""
    if reading is None or isinstance(reading, int):
        return reading
    return f"{_SINGLE if isinstance(reading, Single) else ''}{reading.hex()}"


def _reading(value: "int | str | None") -> Reading:
    if not isinstance(value, str):
        return value
    kind = Single if value.startswith(_SINGLE) else float
    return kind(float.fromhex(value.replace(_SINGLE, "", 1)))
