"""Groups of unshown requirements by cause; each requirement is in at least one group."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from fretc.audit.evidence.verdicts import (
    BROKEN,
    NOT_EXERCISED,
    SUSPECT,
    UNFORMALIZED,
    WAIVED,
)
from fretc.report.model import phrases
from fretc.report.model.front import FigureLine, SectionLink
from fretc.report.model.marks import Mark
from fretc.report.model.views import RequirementView, RunSummary
from monitors import kernel

_NAMED = 8
"""Maximum number of names in a line."""
_DAMAGED = "damaged log"
_CAUSES = {
    UNFORMALIZED: "not formalized",
    kernel.NO_DATA: "no data",
    kernel.INCONCLUSIVE: "open at the end",
    NOT_EXERCISED: "not audited",
    WAIVED: "waived",
    SUSPECT: "suspect: changed since",
}
_NEVER, _SOMETIMES, _OTHER = "never triggered", "not triggered in some runs", "other reasons"
_ORDER = (
    _CAUSES[UNFORMALIZED], _CAUSES[kernel.NO_DATA], _NEVER, _SOMETIMES,
    _CAUSES[kernel.INCONCLUSIVE], _CAUSES[NOT_EXERCISED], _CAUSES[SUSPECT], _CAUSES[WAIVED], _OTHER,
)  # fmt: skip


def link(view: RequirementView) -> SectionLink:
    """A link with the id of a requirement to its section."""
    return SectionLink(view.id, view.title, view.anchor)


def line(text: str, names: Sequence[SectionLink]) -> FigureLine:
    """A line with the first names."""
    most = _NAMED if len(names) > _NAMED + 1 else len(names)
    return FigureLine(text, tuple(names[:most]), len(names) - most)


def causes(
    unshown: Sequence[RequirementView], runs: Sequence[RunSummary]
) -> tuple[FigureLine, ...]:
    """A line for each cause, with the requirements that are not shown because of it.

    Args:
        unshown: requirements in force that are neither shown nor violated.
        runs: all audited runs.
    """
    damaged = [run for run in runs if not run.intact]
    bad = {run.anchor for run in damaged}
    by_cause: dict[str, list[SectionLink]] = {}
    for view in unshown:
        for cause in dict.fromkeys(_of(view, bad)):
            by_cause.setdefault(cause, []).append(link(view))
    hurt = [view for view in unshown if any(_is_hurt(r.run, r.mark, bad) for r in view.results)]
    lines = [line(cause, by_cause[cause]) for cause in _ORDER if cause in by_cause]
    return (*([_damage(damaged, len(hurt))] if hurt else []), *lines)


def _damage(runs: Sequence[RunSummary], requirements: int) -> FigureLine:
    counts = f"{phrases.times(len(runs), 'run')}, {phrases.times(requirements, 'requirement')}"
    return FigureLine(f"{_DAMAGED}: {counts}", (), 0)


def _is_hurt(run: str, mark: Mark, damaged: Collection[str]) -> bool:
    """Whether a damaged run neither shows nor violates a requirement."""
    return run in damaged and not mark.shows and mark.word not in BROKEN


def _of(view: RequirementView, damaged: Collection[str]) -> Iterator[str]:
    """The causes of one requirement; empty if damaged logs are the only cause."""
    word = view.mark.word
    if word in (WAIVED, UNFORMALIZED, NOT_EXERCISED):
        yield _CAUSES[word]
        return
    single = () if view.probability else view.results
    marks = {result.mark for result in single if not result.mark.shows}
    for mark in sorted(marks, key=lambda mark: mark.severity):
        hurt = all(r.run in damaged for r in single if r.mark == mark)
        if mark.word not in BROKEN and not hurt:
            yield _cause(mark, view)
    if not any(mark.word not in BROKEN for mark in marks):
        yield _cause(view.mark, view)


def _cause(mark: Mark, view: RequirementView) -> str:
    if mark.suspect:
        return _CAUSES[SUSPECT]
    if mark.word == kernel.VACUOUS:
        return _SOMETIMES if any(result.triggers for result in view.results) else _NEVER
    return _CAUSES.get(mark.word, _OTHER)
