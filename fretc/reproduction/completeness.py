"""What evidence must have: each requirement in force in each run, and the runs that are known.

What is missing is a difference: a result that is left out is not better than one that was changed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial

from fretc.audit.evidence.schema import Document, Result, Selection
from fretc.reproduction.outcome import FILE, Recheck, differs, unknown
from fretc.traceability.chain import LOG
from fretc.traceability.lock import Lock, Review
from fretish.reading.natural_order import natural

Prints = Callable[[str], Collection[str]]
"""Place of a log → each SHA-256 that it is known by: of all of it, and of its summary."""


@dataclass(frozen=True, slots=True)
class Scope:
    """What evidence is compared with."""

    claimed: tuple[str, ...]
    """The requirements in force, or those of them that are asked for."""
    lock: Lock | None = None
    part: bool = False
    """Whether others in force are not asked for."""


def incomplete(
    document: Document, scope: Scope, places: Mapping[str, str], prints: Prints
) -> Iterator[Recheck]:
    """All that is missing, there twice, or not what is known of it.

    Args:
        document: the evidence.
        scope: what it is compared with.
        places: run → where its log is now.
        prints: for logs that were looked at more or less closely when they were reviewed.
    """
    yield from _requirements(document, scope)
    yield from _results(document, scope)
    if document.selection and not _is_of(document.selection, document):
        yield differs(FILE, "", "what it says of the logs that were chosen contradicts its runs")
    if scope.lock is not None:
        once = cache(prints)
        prints_of = {run: partial(once, place) for run, place in places.items()}
        yield from _reviewed(document, scope, scope.lock, prints_of)


def _requirements(document: Document, scope: Scope) -> Iterator[Recheck]:
    named = Counter(each.id for each in document.requirements)
    for id in scope.claimed:
        if not named[id]:
            yield differs(FILE, id, f"{id} is claimed and the evidence does not name it")
    for id, count in named.items():
        if count > 1:
            yield differs(FILE, id, "it is named twice")


def _results(document: Document, scope: Scope) -> Iterator[Recheck]:
    """Each run has one result of each requirement."""
    counts = Counter((result.run, result.requirement) for result in document.results)
    named = {each.id for each in document.requirements}
    for run in dict.fromkeys(run for run, _ in counts):
        here = {id for other, id in counts if other == run}
        for id in sorted(named | here | {*scope.claimed}, key=natural):
            count = counts[run, id]
            if count > 1:
                yield differs(run, id, "it appears twice")
            elif not count and id in scope.claimed:
                yield differs(run, id, f"{id} is claimed and the evidence has no result of it")
            elif not count:
                yield differs(run, id, "its result is left out")
            elif id not in named:
                yield differs(run, id, "the file does not name it among its requirements")


def _is_of(selection: Selection, document: Document) -> bool:
    """Whether the choice is one that `fretc.audit.selection.choice` makes, of these runs."""
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
"""Run whose log is there → each SHA-256 that it is known by."""


def _reviewed(
    document: Document, scope: Scope, lock: Lock, prints_of: _PrintsOf
) -> Iterator[Recheck]:
    for id, review in lock.reviews.items():
        if id in scope.claimed:
            results = [result for result in document.results if result.requirement == id]
            yield from _runs(review, results, prints_of)
        elif review.was_claimed and not scope.part:
            yield differs(FILE, id, "it was claimed when it was reviewed, and is not any more")


def _runs(review: Review, results: Sequence[Result], prints_of: _PrintsOf) -> Iterator[Recheck]:
    """The runs of one review; a log may have another name by now."""
    hashes = {sha for result in results for sha in _hashes(result)}
    runs = {result.run for result in results}
    for node, sha in review.prints.items():
        if node.kind != LOG or (sha and sha in hashes):
            continue
        if node.name not in runs:
            why = "the lock names this run and the evidence has no result of it"
            yield differs(node.name, review.requirement, why)
        elif node.name not in prints_of:
            why = "its log is not found, to be compared with the lock"
            yield unknown(node.name, review.requirement, why)
        elif sha not in prints_of[node.name]():
            why = "its log is not the one that was reviewed"
            yield differs(node.name, review.requirement, why)


def _hashes(result: Result) -> tuple[str, ...]:
    return tuple(sha for name, sha in result.hashes.items() if name in ("log", "log_summary"))
