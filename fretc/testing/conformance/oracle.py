"""Test oracle: the emitted monitor of all requirements evaluates the program's runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from compiler.explanation.reasons import why
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python.monitor import text
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import UnsupportedError
from fretc.testing.exports.tables import Cell
from fretc.testing.words import RunColumns, letters
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass
from monitors.kernel.tables import InputError
from monitors.kernel.variables import Variable
from monitors.kernel.verdicts import VIOLATED
from monitors.loading import load

Tick = Mapping[str, Cell]
"""The value of each column at one tick."""
Truths = Mapping[str, bool | None]
"""Truth values of atoms at one tick."""


class Oracle:
    """The monitor of requirements and assumptions, tick by tick."""

    def __init__(
        self,
        requirements: Sequence[FormalizedRequirement],
        assumptions: Sequence[FormalizedRequirement],
        roles: Roles,
    ) -> None:
        """The monitor before the first tick.

        Raises:
            UnsupportedError: a column is neither an input nor an output.
        """
        self._rules = [*requirements, *assumptions]
        self._assumed = {assumption.id for assumption in assumptions}
        self._monitor = load("monitors.py", text(*self._rules))
        self._truths: Callable[..., Sequence[bool | None]] | None
        self._truths = getattr(self._monitor, "truths", None)
        columns: dict[str, Variable] = getattr(
            self._monitor,
            "VARIABLES",
            {name: Variable(own, "truth") for name, own in self._monitor.PROPOSITIONS.items()},
        )
        for name in columns:
            if name not in roles:
                raise UnsupportedError(f"`{name}` is neither an input nor an output of a program")
        self._names = tuple(columns)
        self.inputs = tuple(name for name in columns if roles[name] is Role.INPUT)
        self.outputs = {name: own for name, own in columns.items() if roles[name] is Role.OUTPUT}

    def begin(self) -> None:
        """Reset the monitor."""
        self._monitor.reset()

    def step(self, values: Tick) -> Truths:
        """Truth values of all atoms at the next tick; None: unknown.

        Raises:
            InputError: a value has a wrong type.
        """
        row: list[Any] = [values[name] for name in self._names]
        try:
            truths = row if self._truths is None else self._truths(*row)
            self._monitor.advance([truths])
        except (TypeError, ValueError) as error:
            raise InputError(str(error)) from error
        return dict(zip(self._monitor.PROPOSITIONS, truths, strict=True))

    def broken(self) -> tuple[str, ...]:
        """The violated requirements; empty if an assumption is violated."""
        said = zip(self._rules, self._monitor.verdicts(), strict=True)
        found = tuple(requirement.id for requirement, verdict in said if verdict == VIOLATED)
        return () if self._assumed.intersection(found) else found

    def is_over(self) -> bool:
        """Whether an assumption is violated, so that later ticks do not count."""
        said = zip(self._rules, self._monitor.verdicts(), strict=True)
        return any(
            verdict == VIOLATED and requirement.id in self._assumed for requirement, verdict in said
        )

    def triggered(self) -> frozenset[str]:
        """The requirements that were triggered."""
        marks = zip(self._rules, self._monitor.certain.marks(), strict=True)
        return frozenset(requirement.id for requirement, mark in marks if mark.last >= 0)


@dataclass(frozen=True, slots=True)
class ProgramTrace:
    """Inputs and outputs of the program, from its start on."""

    rows: tuple[Tick, ...]
    truths: tuple[Truths, ...]
    broken: tuple[str, ...]
    """The requirements that its last tick violates; earlier ticks violate none."""
    triggered: frozenset[str]

    def columns(self) -> dict[str, int]:
        """Each atom over time; unknown values count as false."""
        columns: dict[str, int] = {}
        for tick, truths in enumerate(self.truths):
            for name, truth in truths.items():
                columns[name] = columns.get(name, 0) | (bool(truth) << tick)
        return columns

    @property
    def is_known(self) -> bool:
        """Whether no atom was ever unknown."""
        return all(truth is not None for truths in self.truths for truth in truths.values())


def reason(requirement: FormalizedRequirement, run: ProgramTrace) -> str:
    """Reason why the run violates the requirement, in words."""
    if not run.is_known:
        return "whatever the unknown values are"
    word = RunColumns((), run.columns(), len(run.rows))
    return why(requirement, letters(requirement, word), ends=True)
