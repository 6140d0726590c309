"""Views of the changes since a review."""

from __future__ import annotations

from collections.abc import Sequence

from fretish.classes.frozen import dataclass
from monitors import kernel


@dataclass(frozen=True, slots=True)
class ChangeText:
    """One change since a review, with both texts."""

    what: str
    before: str | None
    """Text at the review; "" if there was none; None if unknown."""
    after: str | None
    text: str
    """The change on one line; only the differing word, if there is only one."""
    segments: tuple[tuple[str, str], ...]
    """Word difference: (`same`, `before` or `after`, text); empty if one text is unknown."""


@dataclass(frozen=True, slots=True)
class ChangeGroup:
    """One change, and `(id, anchor)` of each requirement whose review it affects."""

    change: ChangeText
    requirements: tuple[tuple[str, str], ...]
    links: int
    """Number of links that the change makes suspect."""
    is_root: bool
    """False: it is a consequence of another change, and only the analysis is out of date."""


@dataclass(frozen=True, slots=True)
class RequirementChanges:
    """The changes of a requirement since its review; `verdicts` are (run, before, now)."""

    requirement: str
    title: str
    anchor: str
    state: str
    by: str
    """Reviewer and date."""
    texts: tuple[ChangeText, ...]
    lines: tuple[str, ...]
    """Each change on one line."""
    contradictions: tuple[str, ...]
    """Unchanged texts that contradict the changed ones."""
    consequences: tuple[str, ...]
    """Changed verdicts in words, worst first."""
    suspicion: str
    """Number of suspect links with the causes; "" if there are none."""
    verdicts: tuple[tuple[str, str, str], ...]
    is_root: bool
    """False: only the analysis is out of date, because another requirement has changed."""


def follows(change: RequirementChanges) -> tuple[str, ...]:
    """Changed verdicts, contradictions, and how a requirement was withdrawn."""
    own = change.lines[len(change.texts) :]
    return (*own, *change.consequences, *change.contradictions)


def only_change(
    group: ChangeGroup, changes: Sequence[RequirementChanges]
) -> RequirementChanges | None:
    """The requirement, if this change affects only it and it has no other change."""
    own = [change for change in changes if change.texts == (group.change,)]
    return own[0] if len(group.requirements) == len(own) == 1 else None


def new_violations(change: RequirementChanges) -> int:
    """Number of runs that violate the requirement now, but did not at its review."""
    return sum(now == kernel.VIOLATED for _, _, now in change.verdicts)
