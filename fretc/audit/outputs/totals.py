"""How many results of an audit have which verdict, and the one to look at first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeVar

from fretc.audit.evidence.briefs import Brief
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import Result, Violation
from fretc.audit.evidence.verdicts import BROKEN, SHOWN, VERDICTS
from fretc.audit.measurements.confidence_intervals import REFUTED, SUPPORTED
from fretc.audit.measurements.trials import Trials
from fretish.diagnostics.status_symbols import StatusSymbol
from monitors import kernel

NOT_JUDGED = "not judged"
"""Of a requirement that no run can be compared with: no data, and not for want of a log."""
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


class Judged(Protocol):
    """A result or the brief of one."""

    @property
    def run(self) -> str:
        """The log."""

    @property
    def requirement(self) -> str:
        """Its id."""

    @property
    def verdict(self) -> str:
        """Of the run."""

    @property
    def trials(self) -> Trials | None:
        """Of a requirement with a probability."""


J = TypeVar("J", bound=Judged)


def runs(results: Iterable[J]) -> Iterator[tuple[J, ...]]:
    """The results of each run. Two logs may have one name, and are two runs."""
    group: dict[str, J] = {}
    name = None
    for result in results:
        if result.run != name or result.requirement in group:
            if group:
                yield tuple(group.values())
            group, name = {}, result.run
        group[result.requirement] = result
    if group:
        yield tuple(group.values())


def word_of(result: Judged, refused: Collection[str] = ()) -> str:
    """The word under which a result counts: its verdict, where it is one by itself.

    Args:
        result: of a run and a requirement.
        refused: the ids of requirements that could not be compared with any run.
    """
    if result.requirement in refused:
        return NOT_JUDGED
    counts = result.trials is not None and result.verdict != kernel.NO_DATA
    return COUNTED if counts else result.verdict


@dataclass(frozen=True, slots=True)
class Marks:
    """The word of every result, and which one to look at first."""

    names: Sequence[str]
    """Of the runs, in their order."""
    ids: Sequence[str]
    words: Sequence[Mapping[str, str]]
    """Of each run: the word of each requirement."""
    answers: Mapping[str, str]
    """What all runs say of a requirement with a probability."""
    worst: int | None
    """The place of the result to look at first: the worst verdict, broken at most ticks.

    Of equal ones it is the first; None: all are good. A run that only counts is none of them.
    """
    violated: bool
    """Whether any requirement is violated in any run, or refuted by all of them."""
    shown: bool
    """Whether every requirement is satisfied in every run, or supported by all of them."""

    @staticmethod
    def of(
        briefs: Iterable[Brief],
        estimates: Iterable[Estimated] = (),
        refused: Collection[str] = (),
    ) -> Marks:
        """Those of an audit.

        Args:
            briefs: of all results, in their order.
            estimates: what all runs say of requirements with a probability.
            refused: the ids of requirements that could not be compared with any run.
        """
        answers = {one.requirement: one.answer for one in estimates}
        names: list[str] = []
        words: list[Mapping[str, str]] = []
        ids: dict[str, None] = {}
        first: tuple[tuple[int, int], int] | None = None
        place = 0
        verdicts: set[str] = set()
        alone: set[str] = set()
        for run in runs(briefs):
            names.append(run[0].run)
            words.append({each.requirement: word_of(each, refused) for each in run})
            ids |= dict.fromkeys(words[-1])
            for each in run:
                word = words[-1][each.requirement]
                if word not in (*SHOWN, COUNTED):
                    found = (severity(word), -each.violated_ticks), place
                    first = min(first or found, found)
                verdicts.add(each.verdict)
                if each.requirement not in answers:
                    alone.add(each.verdict)
                place += 1
        return Marks(
            names,
            [*ids],
            words,
            answers,
            first[1] if first else None,
            REFUTED in answers.values() or kernel.VIOLATED in verdicts,
            {*answers.values()} <= {SUPPORTED} and alone <= {kernel.SATISFIED},
        )

    def word(self, id: str) -> str:
        """The worst of a requirement."""
        words = (of_run[id] for of_run in self.words if id in of_run)
        return min((*words, *filter(None, [self.answers.get(id)])), key=severity)


def sign_of(word: str) -> StatusSymbol:
    """The sign of a word; of a run that only counts that of what is open."""
    own = {NOT_JUDGED: kernel.NO_DATA, COUNTED: kernel.INCONCLUSIVE}.get(word, word)
    return VERDICTS[own].sign


def severity(word: str) -> int:
    """By which words are sorted, the worst first."""
    return _SEVERITY[word]


def totals(marks: Marks) -> tuple[Total, ...]:
    """Each result and each estimate in exactly one of them, the worst word first."""
    counts: Counter[str] = Counter()
    ids: dict[str, set[str]] = {}
    of_runs: Counter[str] = Counter()
    for of_run in marks.words:
        for id, word in of_run.items():
            ids.setdefault(word, set()).add(id)
        counts.update(of_run.values())
        of_runs.update({*of_run.values()})
    single = [Total(word, count, len(ids[word]), of_runs[word]) for word, count in counts.items()]
    answers = Counter(marks.answers.values())
    of_all = [Total(word, count, count, 0) for word, count in answers.items()]
    return tuple(sorted([*single, *of_all], key=lambda total: (severity(total.word), total.runs)))


def longest(result: Result) -> Violation | None:
    """The longest violation of a result that is violated, the first of equal ones."""
    if result.verdict not in BROKEN:
        return None
    return max(result.violations, key=_ticks, default=None)


def _ticks(violation: Violation) -> int:
    return violation.last_tick - violation.first_tick + 1
