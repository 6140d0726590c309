"""Read `bindings.toml`: check every field, and report each error with its span."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from fretish.bindings.declarations import (
    ComputedSignal,
    Declarations,
    LoopAssumptions,
    Part,
    Proposition,
    Signal,
)
from fretish.bindings.tables.actions import ActionTables
from fretish.bindings.tables.clock import ClockTable
from fretish.bindings.tables.computed import ComputedTables
from fretish.bindings.tables.coordinates import MapTable
from fretish.bindings.tables.fields import Fields, Notes
from fretish.bindings.tables.frames import FrameTables
from fretish.bindings.tables.goals import GoalTables
from fretish.bindings.tables.interceptor import InterceptorTables
from fretish.bindings.tables.labels import LabelTable
from fretish.bindings.tables.memory import MemoryTables
from fretish.bindings.tables.propositions import PropositionTables
from fretish.bindings.tables.signals import SignalTables
from fretish.bindings.tables.variables import VariableTables
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.limits import with_budget
from fretish.reading.toml_text import Tables, read

FIELDS = ("clock", "signal", "proposition", "variable", "interceptor", "assume", "map", "run",
           "action", "call", "agent", "fret")  # fmt: skip
S = TypeVar("S")
T = TypeVar("T", Signal, ComputedSignal, Proposition)


def read_bindings(source: Source) -> tuple[Declarations | None, tuple[Diagnostic, ...]]:
    """Read the text of a `bindings.toml`.

    Returns:
        The declarations, and all diagnostics. An error in the table of a signal or a proposition,
        or in a shared table, is also in `Declarations.mistakes`. After any other error the
        declarations are None.
    """
    result = with_budget(len(source.text), source.span(0, 0), lambda: _read(source))
    return (None, (result,)) if isinstance(result, Diagnostic) else result


def _read(source: Source) -> tuple[Declarations | None, tuple[Diagnostic, ...]]:
    tables = read(source.span(), Code.BAD_BINDINGS, "the bindings file")
    if isinstance(tables, Diagnostic):
        return None, (tables,)
    reader = _TablesReader(tables)
    declarations = reader.declarations()
    return (declarations if reader.is_usable else None), tuple(reader.notes.diagnostics)


class _TablesReader(Fields):
    """Reads all tables, and collects all diagnostics."""

    def __init__(self, tables: Tables) -> None:
        super().__init__(tables, Notes())
        self.errors_of_parts = 0

    @property
    def is_usable(self) -> bool:
        """Whether every error belongs to a signal, a proposition or a shared table."""
        return (
            sum(diagnostic.is_error for diagnostic in self.notes.diagnostics)
            == self.errors_of_parts
        )

    def declarations(self) -> Declarations:
        tables, notes = self.tables, self.notes
        self._check_keys(tables.data, FIELDS, "the bindings")
        written = self._tables("signal")
        of_signals = SignalTables(tables, notes)
        of_goals = GoalTables(tables, notes, of_signals.known)
        others: Mapping[str, SignalTables] = {
            "frame": FrameTables(tables, notes, of_signals.known),
            "action": of_goals,
            "service": of_goals,
        }
        recorded = {name: table for name, table in written.items() if "value" not in table}
        signals = self._parts(
            "signal",
            lambda name, table: next(
                (reader for key, reader in others.items() if key in table), of_signals
            ).signal(name, table),
            recorded,
        )
        of_memory = MemoryTables(tables, notes, of_signals.known)
        remembering = of_memory.tables_with_memory()
        signals |= self._parts("signal", of_memory.signal, remembering)
        of_computed = ComputedTables(tables, notes, of_signals.known)
        ordered = of_computed.ordered(
            {
                name: table
                for name, table in written.items()
                if "value" in table and name not in remembering
            }
        )
        computed = self._parts("signal", of_computed.signal, ordered)
        of_propositions = PropositionTables(tables, notes, of_signals.known, of_computed.known)
        propositions = self._parts(
            "proposition", of_propositions.proposition, self._tables("proposition")
        )
        variables = VariableTables(tables, notes).variables()
        loop = InterceptorTables(tables, notes)
        return Declarations(
            tables.text.source,
            ClockTable(tables, notes).clock(),
            signals,
            propositions,
            variables,
            tuple(default for default in notes.defaults if default.part not in notes.mistakes),
            self._shared("interceptor", loop.interceptor),
            self._shared("assume", lambda: self._assumed(loop)),
            notes.mistakes,
            self._shared("map", MapTable(tables, notes, of_signals.known).map),
            self._shared("run", LabelTable(tables, notes).labels),
            VariableTables(tables, notes).kept(),
            self._shared("environment", loop.sentences),
            self._shared("action", ActionTables(tables, notes).actions),
            self._shared("call", ActionTables(tables, notes).calls),
            self._shared("agent", ActionTables(tables, notes).trace),
            computed,
        )

    def _shared(self, kind: str, read: Callable[[], S]) -> S:
        """Read a shared table, and record its errors under its name."""
        before = len(self.notes.diagnostics)
        table = read()
        self._keep((kind, ""), before)
        return table

    def _keep(self, part: Part, before: int) -> None:
        """Record the errors since index `before` as errors of a part."""
        own = [diagnostic for diagnostic in self.notes.diagnostics[before:] if diagnostic.is_error]
        self.errors_of_parts += len(own)
        self.notes.keep(part, own)

    def _parts(
        self,
        kind: str,
        read: Callable[[str, Mapping[str, Any]], T | None],
        tables: Mapping[str, Mapping[str, Any]],
    ) -> dict[str, T]:
        """Read the tables of one kind; those with errors are only in `mistakes`."""
        parts = {}
        for name, table in tables.items():
            before = len(self.notes.diagnostics)
            part = read(name, table)
            self._keep((kind, name), before)
            if (kind, name) not in self.notes.mistakes:
                assert part is not None, name
                parts[name] = part
        return parts

    def _assumed(self, loop: InterceptorTables) -> LoopAssumptions | None:
        """`[assume]`; None also if the proposition that it names has errors."""
        assumption = loop.assumed(tuple(self._tables("proposition")))
        broken = (
            assumption is not None and ("proposition", assumption.stands) in self.notes.mistakes
        )
        return None if broken else assumption
