"""The keys of the TOML files of a project, and the values of those that have few."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

from compiler.emit import TARGETS
from compiler.files.settings import NAME as SETTINGS
from compiler.files.settings import SETTINGS_FIELDS
from compiler.logic.claims import METHODS
from compiler.project import hazards as hazard_table
from compiler.project.paths import BINDINGS, HAZARDS
from fretc.traceability import waivers
from fretish.bindings.declarations import Aggregate, Modality, Role
from fretish.bindings.tables import (
    actions,
    clock,
    coordinates,
    interceptor,
    propositions,
    reader,
    signals,
    variables,
)
from fretish.documents import FIELDS, KINDS, STATUSES
from fretish.units import NAMES

_ROLES = tuple(map(str, Role))
_AGGREGATES = tuple(map(str, Aggregate))
FIELDS_OF_FILES: Mapping[str, Mapping[str, Sequence[str]]] = {
    BINDINGS: {
        **{f"{name}.": () for name in ("signal", "proposition", "variable", "action", "call")},
        "clock": clock.FIELDS,
        "signal.": signals.FIELDS,
        "proposition.": propositions.FIELDS,
        "variable.": variables.FIELDS,
        "action.": actions.FIELDS,
        "call.": actions.CALL_FIELDS,
        "agent": actions.AGENT_FIELDS,
        "map": coordinates.FIELDS,
        "interceptor": interceptor.FIELDS,
        "assume": interceptor.ASSUMED_FIELDS,
        "run.label": (),
    },
    HAZARDS: {"*": hazard_table.FIELDS},
    "waivers.toml": {"*": waivers.FIELDS},
    SETTINGS: {"": SETTINGS_FIELDS},
}
"""Name of a file → table → its keys. A table that ends with `.` has tables with names in it, `*` is
any table, and the empty name stands for the keys outside of all tables."""
assert {name.split(".")[0] for name in FIELDS_OF_FILES[BINDINGS]} <= {*reader.FIELDS}
VALUES: Mapping[tuple[str, str], Sequence[str]] = {
    ("header", "status"): STATUSES,
    ("header", "kind"): KINDS,
    ("header", "verify"): tuple(dict.fromkeys(("audit", *METHODS, *TARGETS))),
    ("signal", "role"): _ROLES,
    ("signal", "agg"): _AGGREGATES,
    ("signal", "unit"): tuple(NAMES),
    ("proposition", "role"): _ROLES,
    ("proposition", "agg"): _AGGREGATES,
    ("proposition", "kind"): propositions.KINDS,
    ("proposition", "modality"): tuple(map(str, Modality)),
    ("variable", "role"): _ROLES,
    ("clock", "time"): ("log_time", "publish_time", "header.stamp"),
    ("clock", "end"): ("inconclusive", "violated"),
    ("waivers.toml", "verdict"): waivers.VERDICTS,
    ("clock", "rounding"): ("exact", "conservative"),
}
"""Table and key → the values that it can have."""


@cache
def header_fields() -> Mapping[str, Sequence[str]]:
    """The keys of the header of a requirement."""
    return {"": FIELDS}
