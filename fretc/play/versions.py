"""Requirements as they are and as they were: what has changed, and what tells both apart."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from compiler.formalization.formalized import Formalized
from fretc.play.starts import MOST, Start
from fretc.testing.runs import Absence, difference
from fretish.reading.recursion import deep


@dataclass(frozen=True, slots=True)
class Pair:
    """A requirement that has another sentence than before."""

    new: Formalized
    old: Formalized
    """With an id of its own."""
    note: str
    """What became of it, in words."""
    start: Start | None
    """A shortest trace that tells both apart; None: there is none, or none that a page takes."""


@dataclass(frozen=True, slots=True)
class Versions:
    """Two versions of a project."""

    pairs: tuple[Pair, ...]
    notes: tuple[str, ...]
    """What became of the other requirements, in words."""


def versions(new: Sequence[Formalized], old: Sequence[Formalized], seconds: float) -> Versions:
    """Hold requirements against what they were.

    Args:
        new: as they are.
        old: as they were; an only one is held against an only one, whatever their ids are.
        seconds: of a processor, for each pair.
    """
    before = {rule.id: rule for rule in old}
    if len(new) == len(old) == 1:
        before = {new[0].id: old[0]}
    taken = {rule.id for rule in (*new, *old)}
    pairs = tuple(
        _pair(rule, _named(before[rule.id], rule.id, taken), seconds)
        for rule in new
        if rule.id in before and rule.fingerprint != before[rule.id].fingerprint
    )
    ids = [rule.id for rule in new]
    changed = {pair.new.id for pair in pairs}
    groups = {
        "the same as before": [id for id in ids if id in before and id not in changed],
        "new": [id for id in ids if id not in before],
        "gone": [id for id in before if id not in ids],
    }
    notes = [f"{', '.join(some)}: {what}" for what, some in groups.items() if some]
    return Versions(pairs, tuple(notes))


def _named(rule: Formalized, id: str, taken: set[str]) -> Formalized:
    """Under an id of its own."""
    name = f"{id} before"
    while name in taken:
        name += "'"
    return replace(rule, requirement=replace(rule.requirement, id=name))


@deep
def _pair(new: Formalized, old: Formalized, seconds: float) -> Pair:
    found = difference(new, old, seconds)
    if isinstance(found, Absence):
        if found.why:
            note = f"changed; whether a run tells both apart is not known: {found.why}"
        else:
            note = "written in another way, and every finite run has the same verdict: proved"
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


def side_by_side(versions: Versions, rules: Sequence[Formalized]) -> Iterator[Formalized]:
    """Each requirement, and behind it what it was."""
    before = {pair.new.id: pair.old for pair in versions.pairs}
    for rule in rules:
        yield rule
        if rule.id in before:
            yield before[rule.id]
