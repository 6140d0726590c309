"""The texts that a review covers: sentence, header, bindings, hazards, and so on.

A lock stores them with the fingerprints, so that a later change can be shown with both texts.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from compiler.files.checked_json import SchemaError
from compiler.files.records import Record, decoded, field, plain
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.hazards import Hazard
from compiler.project.parents import Parent
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.documents import RequirementEntry
from fretish.printer import canonical
from fretish.reading.toml_text import read as read_tables

Table = dict[str, Any]
_LARGEST = 2**63
_DEEPEST = 20
"""Maximum nesting of tables and lists; bindings need less than half of it."""


class ParentRequirement(Record, frozen=True, omit_defaults=True):
    """A requirement above the reviewed one."""

    title: str = ""
    text: str = ""
    rationale: str = ""
    parents: tuple[str, ...] = ()
    kind: str = ""
    """`assumption`, or empty."""


class HazardTexts(Record, frozen=True, omit_defaults=True):
    """A hazard above the reviewed requirement."""

    title: str = ""
    text: str = ""
    severity: str = ""
    source: str = ""


class ExternalParent(Record, frozen=True, omit_defaults=True):
    """A parent in another tool."""

    title: str = ""
    text: str = ""


class BindingsTexts(Record, frozen=True, omit_defaults=True):
    """The tables of `bindings.toml` that the requirement reads, by kind and name."""

    clock: Table = field(default_factory=dict)
    signal: dict[str, Table] = field(default_factory=dict)
    proposition: dict[str, Table] = field(default_factory=dict)
    variable: dict[str, Table] = field(default_factory=dict)


class ReviewedTexts(Record, frozen=True, omit_defaults=True):
    """All texts that the review of a requirement covers; defaults are not written."""

    sentence: str
    canonical: str = ""
    """The canonical sentence; "" if the requirement cannot be formalized."""
    title: str = ""
    text: str = ""
    rationale: str = ""
    status: str = ""
    kind: str = ""
    """`assumption`, or empty."""
    parents: tuple[str, ...] = ()
    verify: tuple[str, ...] = ()
    params: dict[str, str] = field(default_factory=dict)
    accept: dict[str, str] = field(default_factory=dict)
    """Accepted warning → reason."""
    hazards: dict[str, HazardTexts] = field(default_factory=dict)
    """Id → hazard, for each hazard above the requirement."""
    elsewhere: dict[str, ExternalParent] = field(default_factory=dict)
    above: dict[str, ParentRequirement] = field(default_factory=dict)
    bindings: BindingsTexts | None = None
    """None if the project has no bindings."""
    topics: tuple[str, ...] | None = None
    """The topics that the audit of the whole project reads; None if there was no audit."""
    proofs: dict[str, tuple[str, ...]] = field(default_factory=dict)
    """Claim → its result, then its assumptions."""
    loop: dict[str, Table] = field(default_factory=dict)
    """The tables `[interceptor]` and `[assume]`, if there are proofs."""
    analysis: tuple[str, ...] = ()
    """Result of the analysis: the verdict, then conflicts and assumptions."""
    fretc: str = ""
    """The version of fretc that computed the fingerprints."""


# Writing ---------------------------------------------------------------------------------------


def as_table(texts: ReviewedTexts) -> Table:
    """The texts as plain values, for TOML and for a digest."""
    table = plain(texts)
    assert isinstance(table, dict)
    return table


def above(requirement: RequirementEntry) -> ParentRequirement:
    """The texts of a parent requirement."""
    texts = (requirement.title, requirement.text, requirement.rationale)
    kind = requirement.kind if requirement.is_assumption else ""
    return ParentRequirement(*texts, requirement.parents, kind)


def header_of(texts: ReviewedTexts) -> ParentRequirement:
    """The header texts of the requirement itself."""
    return ParentRequirement(texts.title, texts.text, texts.rationale, texts.parents, texts.kind)


def hazard_texts(hazard: Hazard) -> HazardTexts:
    """The texts of a hazard."""
    return HazardTexts(hazard.title, hazard.text, hazard.severity, hazard.source)


def elsewhere(parent: Parent) -> ExternalParent:
    """A parent in another tool."""
    return ExternalParent(parent.title, parent.text)


def canonical_text(requirement: FormalizedRequirement | None) -> str:
    """The canonical wording of a sentence."""
    return canonical(requirement.written) if requirement else ""


def written_tables(declarations: Declarations | None) -> Mapping[str, Any]:
    """The tables of the bindings file: kind → name → table."""
    if declarations is None:
        return {}
    tables = read_tables(declarations.source.span(), Code.BAD_BINDINGS, "the bindings file")
    return {} if isinstance(tables, Diagnostic) else tables.data


def bindings(
    requirement: FormalizedRequirement | None, project: Declarations, written: Mapping[str, Any]
) -> BindingsTexts:
    """The tables that a requirement reads.

    Args:
        requirement: None if it cannot be formalized; then only the clock is returned.
        project: the bindings of the project.
        written: the tables, from `written_tables`.
    """
    clock = dict(written.get("clock", {}))
    if requirement is None:
        return BindingsTexts(clock)
    known = requirement.declarations or project
    named = tuple(dict.fromkeys((*requirement.watched, *requirement.propositions)))
    own = [name for name in named if name in known.propositions]
    bound = [known.propositions[name] for name in own]
    read = {signal for each in bound for signal in (*each.signals, *each.calculations)}
    names = {*requirement.variables, *requirement.definitions}
    return BindingsTexts(
        clock,
        _chosen(written, "signal", read & known.measured.keys()),
        _chosen(written, "proposition", own),
        _chosen(written, "variable", names | {*named}),
    )


def loop(written: Mapping[str, Any]) -> dict[str, Table]:
    """The tables that proofs about the closed loop depend on."""
    return {name: dict(written[name]) for name in ("interceptor", "assume") if name in written}


def _chosen(written: Mapping[str, Any], kind: str, names: Iterable[str]) -> dict[str, Table]:
    tables = written.get(kind, {})
    return {name: dict(tables[name]) for name in sorted(names) if name in tables}


# Reading ---------------------------------------------------------------------------------------


def read(value: object) -> ReviewedTexts | str:
    """The texts from a table of a lock, or an error message."""
    if not _is_plain(value):
        return "it has a value of a type that no requirement and no binding has"
    try:
        return decoded(value, ReviewedTexts)
    except SchemaError as error:
        return str(error)


def _is_plain(value: object) -> bool:
    """Whether a value consists of strings, booleans and 64-bit numbers, with limited nesting."""
    waiting = [(value, 0)]
    while waiting:
        each, depth = waiting.pop()
        if depth > _DEEPEST:
            return False
        if isinstance(each, dict | list | tuple):
            inside = each.values() if isinstance(each, dict) else each
            waiting.extend((part, depth + 1) for part in inside)
        elif isinstance(each, int):
            if not -_LARGEST < each < _LARGEST:
                return False
        elif not isinstance(each, str | float):
            return False
    return True
