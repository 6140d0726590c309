"""The tables `[proposition.NAME]` of `bindings.toml`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fretish import expressions as e
from fretish import units
from fretish.bindings import expressions as binding
from fretish.bindings.calculations import with_calculations
from fretish.bindings.declarations import (
    Aggregate,
    ComputedSignal,
    Default,
    MeasuredSignal,
    Proposition,
    Role,
    Signal,
)
from fretish.bindings.tables.fields import Fields, Notes
from fretish.bindings.words import resolve_words
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.reading.toml_text import Tables

FIELDS = ("text", "expr", "role", "agg", "on_unknown", "kind", "modality", "action")
KINDS = ("belief", "command", "physical")


class PropositionTables(Fields):
    """Reader of the tables `[proposition.NAME]`."""

    def __init__(
        self,
        tables: Tables,
        notes: Notes,
        signals: Mapping[str, Signal],
        computed: Mapping[str, ComputedSignal],
    ) -> None:
        """`signals`: all recorded signals with a known unit or with words."""
        super().__init__(tables, notes)
        self._signals: Mapping[str, MeasuredSignal] = {**signals, **computed}
        self._computed = computed

    def proposition(self, name: str, table: Mapping[str, Any]) -> Proposition | None:
        """The proposition; None if it has errors that make it unusable."""
        at = ("proposition", name)
        self._check_keys(table, FIELDS, f"[proposition.{name}]", *at)
        if "expr" not in table:
            self._say(diagnostic("expression_missing", self.tables.place(*at), name=name))
        written = self._expression(table, (*at, "expr"))
        if written is None:
            return None
        names = dict.fromkeys(name.id for name in e.names(written))
        self.notes.keep(
            at, [m for name in names for m in self.notes.mistakes.get(("signal", name), ())]
        )
        expression = self._truth(written, at)
        if expression is None:
            return None
        if not self._ticks_fit(table, expression, at):
            return None
        if table.get("agg", Aggregate.LAST) == Aggregate.LAST:
            last = f"proposition {name}: the last sample of a tick counts"
            self.notes.defaults.append(Default(("proposition", name), last, "agg" in table))
        return Proposition(
            name,
            expression,
            text=self._field(table, (*at, "text"), str, "a text in quotes") or "",
            role=self._choice(table, (*at, "role"), Role, Role.INTERNAL),
            kind=self._kind(table, at),
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            on_unknown=self._on_unknown(table, at),
            modality=self._modality(table, at),
            action=self._action(table, at),
            span=self.tables.value(*at, "expr"),
        )

    def _truth(self, written: e.Expression, at: tuple[str, ...]) -> e.Expression | None:
        """The expression with resolved words; None if it is no correct Boolean expression."""
        span = self.tables.value(*at, "expr")
        unknown = self._tables("signal").keys() - self._signals.keys()
        if any(name.id in unknown for name in e.names(written)):
            return None  # The signal already has a diagnostic.
        if self._calls_function_of_values(written, span):
            return None
        expression = resolve_words(written, self._signals, span)
        if isinstance(expression, Diagnostic):
            self.notes.diagnostics.append(expression)
            return None
        kinds = {name: signal.unit.dimension for name, signal in self._signals.items()}
        if isinstance(expression, e.Name) and expression.id in kinds:
            return expression
        kind = binding.dimension(expression, kinds, span)
        if isinstance(kind, Diagnostic):
            self.notes.diagnostics.append(kind)
        elif kind is not None:
            self._say(diagnostic("proposition_is_number", span))
        else:
            known = {name.id: self._signals.get(name.id) for name in e.names(expression)}
            percents = {n for n, each in known.items() if each and each.unit == units.PERCENT}
            self.notes.diagnostics.extend(binding.plain_percents(expression, percents, span))
        return with_calculations(expression, self._computed) if kind is None else None

    def _ticks_fit(
        self, table: Mapping[str, Any], expression: e.Expression, at: tuple[str, ...]
    ) -> bool:
        """Whether `pre` is used where ticks exist: with `agg = "last"`, and not inside `for`."""
        if not binding.ticks_back(expression):
            return True
        span = self.tables.value(*at, "expr")
        if table.get("agg", Aggregate.LAST) != Aggregate.LAST:
            self._say(diagnostic("pre_needs_last", self.tables.value(*at, "agg")))
        elif any(
            isinstance(part, e.Persistence) and binding.ticks_back(part)
            for part in e.parts(expression)
        ):
            self._say(diagnostic("pre_inside_for", span))
        else:
            return True
        return False

    def _kind(self, table: Mapping[str, Any], at: tuple[str, ...]) -> str:
        kind = table.get("kind", "")
        if kind not in (*KINDS, ""):
            self._say(
                diagnostic(
                    "unknown_kind",
                    self.tables.value(*at, "kind"),
                    kind=kind,
                    kinds=", ".join(KINDS),
                )
            )
        return str(kind)

    def _on_unknown(self, table: Mapping[str, Any], at: tuple[str, ...]) -> bool | None:
        value = table.get("on_unknown", "unknown")
        if value == "unknown":
            return None
        if isinstance(value, bool):
            text = (
                f"proposition {at[1]}: where its signals are unknown it counts as "
                f"{str(value).lower()}, as the bindings declare"
            )
            self.notes.defaults.append(Default((at[0], at[1]), text))
            return value
        self._say(diagnostic("bad_on_unknown", self.tables.value(*at, "on_unknown")))
        return None
