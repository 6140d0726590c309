"""Completeness of evidence: a result for each requirement in force in each run, and all known runs.

A missing item is a difference: removing a result is as bad as changing it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from functools import cache, partial

from fretc.audit.evidence.schema import EvidenceDocument, Result, Selection
from fretc.reproduction.outcome import FILE, Recheck, differs, unknown
from fretc.traceability.chain import LOG
from fretc.traceability.lock import Lock, Review
from fretish.classes.frozen import dataclass
from fretish.reading.natural_order import natural

Prints = Callable[[str], Collection[str]]
"""Path of a log → its SHA-256 values: of the whole file, and of its summary."""


@dataclass(frozen=True, slots=True)
class ComparisonScope:
    """The requirements and reviews that evidence is compared with."""

    claimed: tuple[str, ...]
    """The requirements in force, or the selected ones."""
    lock: Lock | None = None
    part: bool = False
    """Whether only some of the requirements in force are selected."""


def incomplete(
    document: EvidenceDocument, scope: ComparisonScope, places: Mapping[str, str], prints: Prints
) -> Iterator[Recheck]:
    """All items that are missing, duplicated, or contradict the lock.

    Args:
        document: the evidence.
        scope: requirements and reviews to compare with.
        places: run → present path of its log.
        prints: computes the hashes of a log, because a review may record either of them.
    """
    yield from _requirements(document, scope)
    yield from _results(document, scope)
    if document.selection and not _is_of(document.selection, document):
        yield differs(FILE, "", "its record of the selected logs contradicts its runs")
    if scope.lock is not None:
        once = cache(prints)
        prints_of = {run: partial(once, place) for run, place in places.items()}
        yield from _reviewed(document, scope, scope.lock, prints_of)


def _requirements(document: EvidenceDocument, scope: ComparisonScope) -> Iterator[Recheck]:
    named = Counter(requirement.id for requirement in document.requirements)
    for id in scope.claimed:
        if not named[id]:
            yield differs(FILE, id, f"{id} is claimed, but the evidence does not name it")
    for id, count in named.items():
        if count > 1:
            yield differs(FILE, id, "it appears twice")


def _results(document: EvidenceDocument, scope: ComparisonScope) -> Iterator[Recheck]:
    """Check that each run has exactly one result for each requirement."""
    counts = Counter((result.run, result.requirement) for result in document.results)
    named = {requirement.id for requirement in document.requirements}
    for run in dict.fromkeys(run for run, _ in counts):
        here = {id for other, id in counts if other == run}
        for id in sorted(named | here | {*scope.claimed}, key=natural):
            count = counts[run, id]
            if count > 1:
                yield differs(run, id, "it appears twice")
            elif not count and id in scope.claimed:
                yield differs(run, id, f"{id} is claimed, but the evidence has no result for it")
            elif not count:
                yield differs(run, id, "its result is missing from the file")
            elif id not in named:
                yield differs(run, id, "the file does not name it among its requirements")


def _is_of(selection: Selection, document: EvidenceDocument) -> bool:
    """Whether the recorded selection is a valid selection of exactly these runs."""
    runs = len({result.run for result in document.results})
    sample = selection.sample_of
    recent = selection.named - selection.older
    return (
        selection.audited == runs <= recent
        and sample == (None if selection.seed is None else recent)
        and (selection.since is not None or selection.older == 0)
        and (selection.since is not None or sample is not None)
        and (sample is not None or runs == recent)
    )


# The lock ---------------------------------------------------------------------------------------


_PrintsOf = Mapping[str, Callable[[], Collection[str]]]
"""Run with a present log → its SHA-256 values."""


def _reviewed(
    document: EvidenceDocument, scope: ComparisonScope, lock: Lock, prints_of: _PrintsOf
) -> Iterator[Recheck]:
    for id, review in lock.reviews.items():
        if id in scope.claimed:
            results = [result for result in document.results if result.requirement == id]
            yield from _runs(review, results, prints_of)
        elif review.was_claimed and not scope.part:
            yield differs(FILE, id, "it was claimed at the review, and is no longer claimed")


def _runs(review: Review, results: Sequence[Result], prints_of: _PrintsOf) -> Iterator[Recheck]:
    """Check the runs of one review; a log may have been renamed."""
    hashes = {sha for result in results for sha in _hashes(result)}
    runs = {result.run for result in results}
    for node, sha in review.prints.items():
        if node.kind != LOG or (sha and sha in hashes):
            continue
        if node.name not in runs:
            why = "the lock names this run, but the evidence has no result for it"
            yield differs(node.name, review.requirement, why)
        elif node.name not in prints_of:
            why = "its log was not found, so it cannot be compared with the lock"
            yield unknown(node.name, review.requirement, why)
        elif sha not in prints_of[node.name]():
            why = "its log differs from the one that was reviewed"
            yield differs(node.name, review.requirement, why)


def _hashes(result: Result) -> tuple[str, ...]:
    return tuple(sha for name, sha in result.hashes.items() if name in ("log", "log_summary"))
