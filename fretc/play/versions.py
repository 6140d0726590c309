"""Requirements as they are and as they were: what has changed, and what tells both apart.

Two sentences are compared with each other only where a tick is the same and all that both read
means the same in the bindings: a run of the one is then a run of the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import comparisons
from fretc.play.starts import MOST, Start
from fretc.testing.runs import Absence, difference
from fretish.bindings.canonical import bound, clock
from fretish.bindings.declarations import Declarations
from fretish.reading.recursion import with_recursion_limit


@dataclass(frozen=True, slots=True)
class Side:
    """One version of a project."""

    requirements: Sequence[FormalizedRequirement]
    """Those that a monitor can be made of."""
    refused: Mapping[str, str]
    """The ids of the others, and why they are none."""
    declarations: Declarations | None
    """With the propositions that sentences state."""

    @property
    def ids(self) -> tuple[str, ...]:
        """Of all its requirements."""
        return (*(requirement.id for requirement in self.requirements), *self.refused)


@dataclass(frozen=True, slots=True)
class Pair:
    """A requirement that is another sentence than before, over the same bindings."""

    new: FormalizedRequirement
    old: FormalizedRequirement
    """With an id of its own."""
    note: str
    """What became of it, in words."""
    start: Start | None
    """A shortest trace that tells both apart; None: there is none, or none that a page takes."""


@dataclass(frozen=True, slots=True)
class Versions:
    """Two versions of a project."""

    pairs: tuple[Pair, ...] = ()
    notes: tuple[str, ...] = ()
    """What became of the other requirements, in words."""


def versions(new: Side, old: Side, seconds: float) -> Versions:
    """Hold requirements against what they were.

    Args:
        new: as they are.
        old: as they were; an only one is compared with an only one, whatever their ids are.
        seconds: of a processor, for each pair.
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
            notes.append(f"{requirement.id}: {unlike}: its versions are not compared")
        elif (requirement.fingerprint, requirement.ticks) == (other.fingerprint, other.ticks):
            same.append(requirement.id)
        else:
            pairs.append(_pair(requirement, _named(other, requirement.id, taken), seconds))
    gone = "no monitor can be made of what it was"
    notes += [
        f"{id}: {gone}: {old.refused[names[id]]}" for id in ids if names.get(id) in old.refused
    ]
    groups = {
        "the same as before": same,
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
    """Why a run of one version is none of the other; empty: it is one."""
    clocks = [clock(each.clock) if each else None for each in (now, then)]
    if clocks[0] != clocks[1]:
        return "a tick is something else now"
    one, other = _meanings(new, now), _meanings(old, then)
    both = one.keys() & other.keys()
    changed = sorted(name for kind, name in both if one[kind, name] != other[kind, name])
    return f"`{changed[0]}` means something else in the bindings now" if changed else ""


def _meanings(
    requirement: FormalizedRequirement, declarations: Declarations | None
) -> dict[tuple[str, str], Any]:
    """What the bindings say of each name that a requirement reads; None: nothing."""
    found: dict[tuple[str, str], Any] = {
        ("proposition", name): None for name in requirement.watched
    }
    if declarations is not None:
        known = bound(declarations, requirement.watched)
        found |= {(kind, name): known[kind][name] for kind in known for name in known[kind]}
    return found


def _named(requirement: FormalizedRequirement, id: str, taken: set[str]) -> FormalizedRequirement:
    """Under an id of its own."""
    name = f"{id} before"
    while name in taken:
        name += "'"
    return replace(requirement, entry=replace(requirement.entry, id=name))


@with_recursion_limit
def _pair(new: FormalizedRequirement, old: FormalizedRequirement, seconds: float) -> Pair:
    found = difference(new, old, seconds)
    if isinstance(found, Absence):
        if found.why:
            note = f"changed; whether a run tells both apart is not known: {found.why}"
        else:
            note = "written in another way; all finite runs without unknown values have the same"
            note += " verdicts: proved"
            if _has_numbers(new) or _has_numbers(old):
                note += ", of exact numbers; rounding of floats is not modelled"
        return Pair(new, old, f"{new.id}: {note}", None)
    word = found.word
    count = f"{word.ticks} tick{'' if word.ticks == 1 else 's'}"
    about = f"{new.id}: a shortest trace that tells both versions apart has {count}"
    about += f"; its values may not go together: {found.doubt}" if found.doubt else ""
    rows = tuple((row.count, dict(row.values)) for row in word.rows)
    start = Start("Versions", f"{new.id}, before and now", about, (new.id,), rows)
    if word.ticks > MOST:
        return Pair(new, old, f"{about}, and this page takes {MOST}", None)
    return Pair(new, old, about, start)


def _has_numbers(requirement: FormalizedRequirement) -> bool:
    """Whether it compares some, itself or by what the bindings say of its propositions."""
    declared = requirement.declarations.propositions if requirement.declarations else {}
    return bool(comparisons(requirement)) or any(
        declared[name].signals for name in requirement.watched if name in declared
    )


def side_by_side(
    versions: Versions, requirements: Sequence[FormalizedRequirement]
) -> Iterator[FormalizedRequirement]:
    """Each requirement, and behind it what it was."""
    before = {pair.new.id: pair.old for pair in versions.pairs}
    for requirement in requirements:
        yield requirement
        if requirement.id in before:
            yield before[requirement.id]
