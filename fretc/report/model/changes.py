"""The views of what has changed since a review."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from monitors import kernel


@dataclass(frozen=True, slots=True)
class ChangeText:
    """One thing that is not as it was reviewed, before and after."""

    what: str
    before: str | None
    """As it was written; empty: it was not there; None: not known."""
    after: str | None
    text: str
    """On one line: only what differs, where that is one word."""
    segments: tuple[tuple[str, str], ...]
    """Both texts as one: `same`, `before` or `after`, and the words; none where one is unknown."""


@dataclass(frozen=True, slots=True)
class ChangeGroup:
    """One change, and every requirement whose review it touches: `(id, anchor)` of each."""

    change: ChangeText
    requirements: tuple[tuple[str, str], ...]
    links: int
    """The links that it makes suspect."""


@dataclass(frozen=True, slots=True)
class Change:
    """The changes of a requirement since its review; `verdicts` are run, then and now."""

    requirement: str
    title: str
    anchor: str
    state: str
    by: str
    """Who reviewed it, and when."""
    texts: tuple[ChangeText, ...]
    lines: tuple[str, ...]
    """Each change on one line."""
    contradictions: tuple[str, ...]
    """What has stayed as it was, and says something else now."""
    consequences: tuple[str, ...]
    """What became of verdicts, in words, the worst first."""
    suspicion: str
    """How many links are suspect, and why; empty where none is."""
    verdicts: tuple[tuple[str, str, str], ...]


def follows(change: Change) -> tuple[str, ...]:
    """What became of verdicts, and what contradicts the changes; how a requirement is gone."""
    own = change.lines[len(change.texts) :]
    return (*own, *change.consequences, *change.contradictions)


def only_change(group: ChangeGroup, changes: Sequence[Change]) -> Change | None:
    """The requirement that nothing but this change touches, and that no other is touched by."""
    own = [change for change in changes if change.texts == (group.change,)]
    return own[0] if len(group.requirements) == len(own) == 1 else None


def new_violations(change: Change) -> int:
    """The runs that violate it now, and did not at its review."""
    return sum(now == kernel.VIOLATED for _, _, now in change.verdicts)
