"""Two versions of requirements: changes, and traces that distinguish the versions.

Two sentences are compared only if the clock is the same and the names that both read have the same
meaning in the bindings, so that both versions have the same runs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import comparisons
from compiler.project.project import Refused
from compiler.targets.javascript.monitor import refuse
from fretc.play.starts import MOST, Start
from fretc.testing.runs import Absence, difference
from fretish.bindings.canonical import bound, clock
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit


@dataclass(frozen=True, slots=True)
class Side:
    """One version of a project."""

    requirements: Sequence[FormalizedRequirement]
    """The requirements for which a monitor can be generated."""
    refused: Mapping[str, str]
    """Id of each other requirement → the reason."""
    declarations: Declarations | None
    """The declarations, including propositions that sentences define."""

    @property
    def ids(self) -> tuple[str, ...]:
        """The ids of all requirements of this version."""
        return (*(requirement.id for requirement in self.requirements), *self.refused)


def side(
    requirements: Sequence[FormalizedRequirement],
    refusals: Iterable[Refused],
    declared: Declarations | None,
) -> tuple[Side, list[Diagnostic]]:
    """One version, and why some requirements without errors have no monitor.

    Args:
        requirements: the requirements without errors.
        refusals: the requirements with errors.
        declared: the declarations.
    """
    mistaken = {refusal.requirement.id: refusal.why[0] for refusal in refusals}
    refused = {each.id: why for each in requirements if (why := refuse(each)) is not None}
    reasons = {id: why.message for id, why in (mistaken | refused).items()}
    known = [each for each in requirements if each.id not in refused]
    return Side(known, reasons, declared), [*refused.values()]


@dataclass(frozen=True, slots=True)
class Pair:
    """A requirement whose sentence has changed, over the same bindings."""

    new: FormalizedRequirement
    old: FormalizedRequirement
    """The earlier version, under a distinct id."""
    note: str
    """A sentence about the change."""
    start: Start | None
    """A shortest distinguishing trace; None if there is none, or it is too long."""


@dataclass(frozen=True, slots=True)
class Versions:
    """Two versions of a project."""

    pairs: tuple[Pair, ...] = ()
    notes: tuple[str, ...] = ()
    """Sentences about the other requirements."""


def versions(new: Side, old: Side, seconds: float) -> Versions:
    """Compare requirements with an earlier version.

    Args:
        new: the present version.
        old: the earlier version; if both have a single requirement, ids are ignored.
        seconds: CPU seconds for each pair.
    """
    ids, earlier = new.ids, old.ids
    names = {id: id for id in earlier}
    if len(ids) == len(earlier) == 1:
        names, earlier = {ids[0]: earlier[0]}, ids
    before = {requirement.id: requirement for requirement in old.requirements}
    taken = {*new.ids, *old.ids}
    pairs, notes, same = [], [], []
    for requirement in new.requirements:
        other = before.get(names.get(requirement.id, ""))
        if other is None:
            continue
        unlike = _unlike(requirement, other, new.declarations, old.declarations)
        if unlike:
            notes.append(f"{requirement.id}: {unlike}, so its versions are not compared")
        elif (requirement.fingerprint, requirement.ticks) == (other.fingerprint, other.ticks):
            same.append(requirement.id)
        else:
            pairs.append(_pair(requirement, _named(other, requirement.id, taken), seconds))
    gone = "no monitor can be generated from the earlier version"
    notes += [
        f"{id}: {gone}: {old.refused[names[id]]}" for id in ids if names.get(id) in old.refused
    ]
    groups = {
        "unchanged": same,
        "new": [id for id in ids if id not in names],
        "gone": [id for id in earlier if id not in ids],
    }
    notes += [f"{', '.join(some)}: {what}" for what, some in groups.items() if some]
    return Versions(tuple(pairs), tuple(notes))


def _unlike(
    new: FormalizedRequirement,
    old: FormalizedRequirement,
    now: Declarations | None,
    then: Declarations | None,
) -> str:
    """The reason why the versions have different runs, or ""."""
    clocks = [clock(declarations.clock) if declarations else None for declarations in (now, then)]
    if clocks[0] != clocks[1]:
        return "the clock has changed"
    one, other = _meanings(new, now), _meanings(old, then)
    both = one.keys() & other.keys()
    changed = sorted(name for kind, name in both if one[kind, name] != other[kind, name])
    return f"`{changed[0]}` has another meaning in the bindings now" if changed else ""


def _meanings(
    requirement: FormalizedRequirement, declarations: Declarations | None
) -> dict[tuple[str, str], Any]:
    """(kind, name) → its table in the bindings, or None, for each name that a requirement reads."""
    meanings: dict[tuple[str, str], Any] = {
        ("proposition", name): None for name in requirement.watched
    }
    if declarations is not None:
        known = bound(declarations, requirement.watched)
        meanings |= {(kind, name): known[kind][name] for kind in known for name in known[kind]}
    return meanings


def _named(requirement: FormalizedRequirement, id: str, taken: set[str]) -> FormalizedRequirement:
    """The requirement under an unused id."""
    name = f"{id} before"
    while name in taken:
        name += "'"
    return replace(requirement, entry=replace(requirement.entry, id=name))


@with_recursion_limit
def _pair(new: FormalizedRequirement, old: FormalizedRequirement, seconds: float) -> Pair:
    run = difference(new, old, seconds)
    if isinstance(run, Absence):
        if run.why:
            note = f"changed; whether a run distinguishes the versions is not known: {run.why}"
        else:
            note = (
                "reworded; proved: both versions have the same verdict on every finite run without"
            )
            note += " unknown values"
            if _has_numbers(new) or _has_numbers(old):
                note += "; the proof assumes exact numbers, without the rounding of floats"
        return Pair(new, old, f"{new.id}: {note}", None)
    word = run.word
    count = f"{word.ticks} tick{'' if word.ticks == 1 else 's'}"
    about = f"{new.id}: a shortest trace that distinguishes the two versions has {count}"
    about += f"; its values may not be consistent: {run.uncertainty}" if run.uncertainty else ""
    rows = tuple((row.count, dict(row.values)) for row in word.rows)
    start = Start("Versions", f"{new.id}, before and now", about, (new.id,), rows)
    if word.ticks > MOST:
        return Pair(new, old, f"{about}, and this page shows at most {MOST}", None)
    return Pair(new, old, about, start)


def _has_numbers(requirement: FormalizedRequirement) -> bool:
    """Whether the requirement or the bindings of its propositions compare numbers."""
    declared = requirement.declarations.propositions if requirement.declarations else {}
    return bool(comparisons(requirement)) or any(
        declared[name].signals for name in requirement.watched if name in declared
    )


def side_by_side(
    versions: Versions, requirements: Sequence[FormalizedRequirement]
) -> Iterator[FormalizedRequirement]:
    """Each requirement, followed by its earlier version."""
    before = {pair.new.id: pair.old for pair in versions.pairs}
    for requirement in requirements:
        yield requirement
        if requirement.id in before:
            yield before[requirement.id]
