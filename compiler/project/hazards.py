"""Hazards, and whether the parents of requirements lead to them."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from typing import Any

from compiler.files.text_files import read
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import (
    Code,
    Diagnostic,
    did_you_mean,
    has_errors,
)
from fretish.diagnostics.messages import diagnostic
from fretish.documents import RequirementEntry
from fretish.reading.natural_order import natural
from fretish.reading.toml_text import Tables
from fretish.reading.toml_text import read as read_tables

FIELDS = ("title", "text", "severity", "source")


@dataclass(frozen=True, slots=True)
class Hazard:
    """A hazard of `hazards.toml`, which requirements are to control."""

    id: str
    title: str
    text: str = ""
    severity: str = ""
    source: str = ""


def hazards(path: str) -> tuple[dict[str, Hazard], tuple[Diagnostic, ...]]:
    """The hazards of a file: tables `[HAZ-001]` with `title`, and optional other fields."""
    source = read(path)
    if isinstance(source, Diagnostic):
        return {}, (source,)
    tables = read_tables(source.span(), Code.BAD_HAZARDS, "the hazards file")
    if isinstance(tables, Diagnostic):
        return {}, (tables,)
    wrong = [d for id, fields in tables.data.items() for d in _mistakes(tables, id, fields)]
    if has_errors(wrong):
        return {}, tuple(wrong)
    return {id: Hazard(id, **fields) for id, fields in tables.data.items()}, ()


def _mistakes(tables: Tables, id: str, fields: Any) -> list[Diagnostic]:
    def wrong(message: str, fix: str, *path: str) -> Diagnostic:
        return Diagnostic(Code.BAD_HAZARDS, message, tables.place(*path), help=fix)

    if not isinstance(fields, dict):
        return [wrong(f"`{id}` is not a hazard table", f'write `[{id}]`, then `title = "..."`', id)]
    diagnostics = []
    for key, value in fields.items():
        if key not in FIELDS:
            fields_text = ", ".join(FIELDS)
            diagnostics.append(
                wrong(f"`{key}` is not a field of a hazard", f"it may have {fields_text}", id, key)
            )
        elif not isinstance(value, str):
            diagnostics.append(wrong(f"`{key}` must be a text", "write it in quotes", id, key))
    if "title" not in fields:
        diagnostics.append(wrong(f"the hazard {id} has no title", 'add `title = "..."`', id))
    return diagnostics


# Parents ------------------------------------------------------------------------------------------


def unknown_parents(
    requirements: Sequence[RequirementEntry],
    hazards: Collection[str],
    external: Collection[str],
    file: str | None,
) -> Iterator[Diagnostic]:
    """F501 for each parent that is neither a hazard, nor a requirement, here or in another tool.

    If no file can declare a parent, one diagnostic covers all of them.

    Args:
        requirements: the requirements.
        hazards: ids of the hazards.
        external: ids of the parents in other tools.
        file: the hazards file; None if there is none.
    """
    ids = [requirement.id for requirement in requirements]
    declared = [*sorted({*hazards, *external}, key=natural), *ids]
    unknown = [(r, parent) for r in requirements for parent in r.parents if parent not in declared]
    if unknown and file is None and not external:
        requirement, parent = unknown[0]
        more = len(unknown) - 1
        remainder = (
            f" ({more} more {'parent is' if more == 1 else 'parents are'}, too)" if more else ""
        )
        yield diagnostic(
            "no_hazards_file",
            requirement.place("parents"),
            parent=parent,
            requirement=requirement.id,
            remainder=remainder,
        )
        return
    for requirement, parent in unknown:
        yield diagnostic(
            "unknown_parent",
            requirement.place("parents"),
            requirement=requirement.id,
            parent=parent,
            help=did_you_mean(parent, declared, "declare it in hazards.toml"),
        )


def cycles(requirements: Sequence[RequirementEntry]) -> Iterator[Diagnostic]:
    """F526 for each circle of parents, once, at its first requirement."""
    by_id = {requirement.id: requirement for requirement in requirements}
    earlier: set[frozenset[str]] = set()
    for requirement in requirements:
        circle = _circle(requirement.id, by_id)
        if circle and frozenset(circle) not in earlier:
            earlier.add(frozenset(circle))
            yield diagnostic(
                "circular_parents",
                requirement.place("parents"),
                requirement=requirement.id,
                path=" → ".join(circle),
            )


def _circle(start: str, by_id: dict[str, RequirementEntry]) -> list[str]:
    """A shortest path from a requirement up to itself; empty where there is none."""
    came: dict[str, str] = {}
    waiting = [start]
    for id in waiting:  # it grows while it is walked: breadth first
        for parent in by_id[id].parents if id in by_id else ():
            if parent == start:
                way = [start, id]
                while way[-1] != start:
                    way.append(came[way[-1]])
                return way[::-1]
            if parent not in came:
                came[parent] = id
                waiting.append(parent)
    return []


def without_hazard(
    active: Sequence[RequirementEntry], declared: Collection[str]
) -> Iterator[RequirementEntry]:
    """The requirements with parents of which none leads to anything declared.

    Args:
        active: the requirements that are not retired; the path to a hazard uses no others.
        declared: ids of hazards, and of parents in other tools.
    """
    reached = {requirement.id for requirement in active if {*declared} & {*requirement.parents}}
    while True:
        more = {r.id for r in active if reached & {*r.parents}} - reached
        if not more:
            break
        reached |= more
    return (r for r in active if r.parents and r.id not in reached)
