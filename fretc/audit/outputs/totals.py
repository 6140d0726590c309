"""The number of results with each verdict, and the result to look at first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Protocol, TypeVar

from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.result_summaries import ResultSummary
from fretc.audit.evidence.schema import Result, Violation
from fretc.audit.evidence.verdicts import ASSUMPTION_BROKEN, BROKEN, SHOWN, VERDICTS
from fretc.audit.measurements.confidence_intervals import REFUTED, SUPPORTED
from fretc.audit.measurements.trials import Trials
from fretish.classes.frozen import dataclass
from fretish.diagnostics.status_symbols import StatusSymbol
from monitors import kernel

NOT_JUDGED = "not judged"
"""The word for a requirement by which no log can be evaluated."""
COUNTED = "counted over all runs"
"""The word for a run that alone decides nothing: its triggers count with those of all others."""
_SEVERITY = {
    word: index
    for index, word in enumerate(
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
class ResultCount:
    """The number of results with one word."""

    word: str
    results: int
    requirements: int
    runs: int
    """Number of runs with such a result; 0: the results are about all runs together."""

    @property
    def colour(self) -> str | None:
        """The colour in a terminal."""
        return sign_of(self.word).colour if self.word != COUNTED else None


class HasVerdict(Protocol):
    """A result or its summary."""

    @property
    def run(self) -> str:
        """The log."""

    @property
    def requirement(self) -> str:
        """The id of the requirement."""

    @property
    def verdict(self) -> str:
        """The verdict of the run."""

    @property
    def trials(self) -> Trials | None:
        """Present for a requirement with a probability."""


J = TypeVar("J", bound=HasVerdict)


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


def word_of(result: HasVerdict, refused: Collection[str] = ()) -> str:
    """The word under which a result counts: its verdict, unless the run alone decides nothing.

    Args:
        result: the result of a run and a requirement.
        refused: the ids of requirements that could not be compared with any run.
    """
    if result.requirement in refused:
        return NOT_JUDGED
    counts = result.trials is not None and result.verdict != kernel.NO_DATA
    return COUNTED if counts else result.verdict


@dataclass(frozen=True, slots=True)
class VerdictWords:
    """The word of every result, and the result to look at first."""

    names: Sequence[str]
    """The names of the runs, in their order."""
    ids: Sequence[str]
    words: Sequence[Mapping[str, str]]
    """For each run, the word of each requirement."""
    answers: Mapping[str, str]
    """The answer of all runs for each requirement with a probability."""
    worst: int | None
    """The index of the result to look at first: the worst verdict, violated at most ticks.

    The first of equal ones; None: all are good. A run that alone decides nothing is never the
    worst."""
    violated: bool
    """Whether any requirement is violated in any run, or refuted by all of them."""
    shown: bool
    """Whether every requirement is satisfied in every run, or supported by all of them."""

    @staticmethod
    def of(
        summaries: Iterable[ResultSummary],
        estimates: Iterable[Estimated] = (),
        refused: Collection[str] = (),
    ) -> VerdictWords:
        """The words of all results of an audit.

        Args:
            summaries: the summaries of all results, in their order.
            estimates: the answers of all runs.
            refused: the ids of requirements that could not be compared with any run.
        """
        answers = {estimate.requirement: estimate.answer for estimate in estimates}
        names: list[str] = []
        words: list[Mapping[str, str]] = []
        ids: dict[str, None] = {}
        first: tuple[tuple[int, int], int] | None = None
        index = 0
        verdicts: set[str] = set()
        alone: set[str] = set()
        for run in runs(summaries):
            names.append(run[0].run)
            words.append({each.requirement: word_of(each, refused) for each in run})
            ids |= dict.fromkeys(words[-1])
            for each in run:
                word = words[-1][each.requirement]
                if word not in (*SHOWN, COUNTED):
                    rank = (severity(word), -each.violated_ticks), index
                    first = min(first or rank, rank)
                verdicts.add(each.verdict)
                if each.requirement not in answers:
                    alone.add(each.verdict)
                index += 1
        return VerdictWords(
            names,
            [*ids],
            words,
            answers,
            first[1] if first else None,
            REFUTED in answers.values() or kernel.VIOLATED in verdicts,
            {*answers.values()} <= {SUPPORTED} and alone <= {kernel.SATISFIED},
        )

    def word(self, id: str) -> str:
        """The worst word of a requirement."""
        words = (of_run[id] for of_run in self.words if id in of_run)
        return min((*words, *filter(None, [self.answers.get(id)])), key=severity)


def sign_of(word: str) -> StatusSymbol:
    """The symbol for a word; a run that alone decides nothing has that of an open verdict."""
    own = {NOT_JUDGED: kernel.NO_DATA, COUNTED: kernel.INCONCLUSIVE}.get(word, word)
    return VERDICTS[own].sign


def severity(word: str) -> int:
    """The order of words, the worst first."""
    return _SEVERITY[word]


def totals(marks: VerdictWords) -> tuple[ResultCount, ...]:
    """The number of results and estimates of each word, the worst word first."""
    counts: Counter[str] = Counter()
    ids: dict[str, set[str]] = {}
    of_runs: Counter[str] = Counter()
    for of_run in marks.words:
        for id, word in of_run.items():
            ids.setdefault(word, set()).add(id)
        counts.update(of_run.values())
        of_runs.update({*of_run.values()})
    single = [
        ResultCount(word, count, len(ids[word]), of_runs[word]) for word, count in counts.items()
    ]
    answers = Counter(marks.answers.values())
    of_all = [ResultCount(word, count, count, 0) for word, count in answers.items()]
    return tuple(sorted([*single, *of_all], key=lambda total: (severity(total.word), total.runs)))


def longest(result: Result) -> Violation | None:
    """The longest violation of a violated result or a broken assumption, the first of equals."""
    if result.verdict not in (*BROKEN, ASSUMPTION_BROKEN):
        return None
    return max(result.violations, key=lambda one: one.last_tick - one.first_tick, default=None)
