"""How many results of an audit have which verdict, and the one to look at first."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import Result, Violation
from fretc.audit.evidence.verdicts import BROKEN, SHOWN, VERDICTS
from fretish.diagnostics.signs import Sign
from monitors import kernel

NOT_JUDGED = "not judged"
"""Of a requirement that no run can be held against: no data, and not for want of a log."""
COUNTED = "counted over all runs"
"""Of a run that alone decides nothing: its triggers are counted with those of all others."""
_SEVERITY = {
    word: place
    for place, word in enumerate(
        word
        for verdict in VERDICTS
        for word in (
            (NOT_JUDGED, verdict)
            if verdict == kernel.NO_DATA
            else (COUNTED, verdict)
            if verdict == SHOWN[0]
            else (verdict,)
        )
    )
}
"""The words of counts, the worst first."""


@dataclass(frozen=True, slots=True)
class Total:
    """The results of one word."""

    word: str
    results: int
    requirements: int
    runs: int
    """In how many runs they are; 0: they are about all runs together."""

    @property
    def colour(self) -> str | None:
        """In a terminal."""
        return sign_of(self.word).colour if self.word != COUNTED else None


def runs(results: Iterable[Result]) -> tuple[tuple[Result, ...], ...]:
    """The results of each run. Two logs may have one name, and are two runs."""
    groups: list[dict[str, Result]] = []
    name = None
    for result in results:
        if result.run != name or result.requirement in groups[-1]:
            groups.append({})
            name = result.run
        groups[-1][result.requirement] = result
    return tuple(tuple(group.values()) for group in groups)


def word_of(result: Result, refused: Collection[str] = ()) -> str:
    """The word under which a result counts: its verdict, where it is one by itself.

    Args:
        result: of a run and a requirement.
        refused: the ids of requirements that could not be held against any run.
    """
    if result.requirement in refused:
        return NOT_JUDGED
    counts = result.trials is not None and result.verdict != kernel.NO_DATA
    return COUNTED if counts else result.verdict


def sign_of(word: str) -> Sign:
    """The sign of a word; of a run that only counts that of what is open."""
    own = {NOT_JUDGED: kernel.NO_DATA, COUNTED: kernel.INCONCLUSIVE}.get(word, word)
    return VERDICTS[own].sign


def severity(word: str) -> int:
    """By which words are sorted, the worst first."""
    return _SEVERITY[word]


def totals(
    results: Iterable[Result],
    estimates: Sequence[Estimated] = (),
    refused: Collection[str] = (),
) -> tuple[Total, ...]:
    """Each result and each estimate in exactly one of them, the worst word first."""
    of_word: dict[str, list[tuple[int, str]]] = {}
    for number, run in enumerate(runs(results)):
        for result in run:
            of_word.setdefault(word_of(result, refused), []).append((number, result.requirement))
    of_runs = [
        Total(word, len(some), len({id for _, id in some}), len({run for run, _ in some}))
        for word, some in of_word.items()
    ]
    answers = [one.answer for one in estimates]
    of_all = [Total(word, answers.count(word), answers.count(word), 0) for word in {*answers}]
    return tuple(sorted([*of_runs, *of_all], key=lambda total: (severity(total.word), total.runs)))


def worst(results: Iterable[Result], refused: Collection[str] = ()) -> Result | None:
    """The result to look at first: the worst verdict, broken at most ticks; None: all are good.

    Of equal ones it is the first. A run that only counts is none of them.
    """
    open_ones = (each for each in results if word_of(each, refused) not in (*SHOWN, COUNTED))
    return min(
        open_ones,
        key=lambda each: (severity(word_of(each, refused)), -_broken_ticks(each)),
        default=None,
    )


def longest(result: Result) -> Violation | None:
    """The longest violation of a result that is violated, the first of equal ones."""
    if result.verdict not in BROKEN:
        return None
    return max(result.violations, key=_ticks, default=None)


def _broken_ticks(result: Result) -> int:
    return sum(map(_ticks, result.violations))


def _ticks(violation: Violation) -> int:
    return violation.last_tick - violation.first_tick + 1
