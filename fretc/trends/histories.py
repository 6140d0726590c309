"""Evidence as histories: what each round says of each requirement in each scenario.

Runs of one scenario are comparable; a run that names none is comparable with those of its log's
name. A round is what is compared with earlier ones: each evidence, or each day, or each value of a
label. Rounds are in the order of time, and of names where times do not decide. Times are
nanoseconds since 1970, of UTC.
"""

from __future__ import annotations

import re
from array import array
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import field
from datetime import UTC, datetime
from pathlib import PurePosixPath

from fretc.audit.evidence.result_summaries import EvidenceSource, ResultSummary, RunFacts
from fretc.audit.evidence.schema import Selection
from fretc.audit.evidence.verdict_inputs import BINDINGS, CLOCK, PARAMS, SENTENCE, TOPICS
from fretish.classes.frozen import dataclass
from fretish.reading.natural_order import natural

EVIDENCE, DAY = "evidence", "day"
"""The kinds of rounds other than the values of a label."""
SCENARIO, VERSION, COMMIT, DATE = "scenario", "version", "commit", "date"
"""Labels with a meaning for trends."""
_INPUTS = (SENTENCE, PARAMS, CLOCK, TOPICS, BINDINGS)


@dataclass(frozen=True, slots=True, order=True)
class ComparableRuns:
    """Comparable runs: those of a scenario, or of a log name, or all runs of an evidence."""

    name: str
    kind: str = SCENARIO

    def __str__(self) -> str:
        """The scenario as text."""
        return "all runs together" if self.kind == ALL else self.name


NAME, ALL = "name", "all"
ALL_RUNS = ComparableRuns("", ALL)
"""The scenario of a requirement with a probability, which all runs decide together."""


@dataclass(frozen=True, slots=True)
class HistoryRun:
    """A run of an evidence."""

    name: str
    content: str
    """Hash of the content of the log, to detect copies of it."""
    scenario: ComparableRuns
    round: int
    version: str
    """The version of the software from a label; empty: there is none."""
    software: str
    """The commit, else the round: runs with the same software should have one outcome."""
    time: int | None


@dataclass(frozen=True, slots=True)
class Round:
    """A set of runs that is compared with earlier ones."""

    name: str
    first: int | None
    """The times of its first and its last run."""
    last: int | None
    runs: int
    versions: tuple[str, ...]
    requirements: frozenset[str]
    """Ids of the requirements by which its runs were evaluated."""
    selections: tuple[Selection, ...]
    """The selections of its evidence, if not all logs were audited."""

    @property
    def days(self) -> str:
        """The first and the last day; empty: no time is known."""
        if self.first is None or self.last is None:
            return ""
        days = dict.fromkeys((day(self.first), day(self.last)))
        return " to ".join(days)


@dataclass(frozen=True, slots=True)
class RunOutcome:
    """The result of one requirement in one run."""

    run: int
    """The index in `Histories.runs`; -1: all runs of the evidence together."""
    round: int
    verdict: str
    verdict_inputs: int
    """The number of its verdict inputs: equal numbers have equal inputs."""
    longest: float | None = None
    """The longest latency in seconds."""
    median: float | None = None


@dataclass(frozen=True, slots=True)
class Histories:
    """All evidence that was read, rounds from the oldest to the newest."""

    by: str
    rounds: tuple[Round, ...]
    runs: tuple[HistoryRun, ...]
    requirements: Mapping[str, str]
    """Id → the sentence in the newest evidence."""
    judged: Mapping[tuple[str, ComparableRuns], Sequence[RunOutcome]]
    order: str
    """The order of rounds, in words."""
    sources: tuple[EvidenceSource, ...] = field(repr=False)
    places: tuple[Sequence[int], ...] = field(repr=False)
    """For each source, the run of the result at each index."""
    verdict_inputs: tuple[Sequence[int], ...] = field(repr=False)
    """For each source, the verdict inputs of the result at each index."""

    @property
    def newest(self) -> int:
        """The index of the newest round."""
        return len(self.rounds) - 1


def day(time: int) -> str:
    """The day of a time, in UTC."""
    return datetime.fromtimestamp(time // 10**9, UTC).date().isoformat()


def time_of(facts: RunFacts) -> int | None:
    """The time of a run: its label `date`, else the begin of its log; None: unknown."""
    written = _time(facts.labels.get(DATE, ""))
    start = facts.start_ns
    if written is not None or start is None or not 0 <= start < _LATEST:
        return written
    return start


_LATEST = 4102444800 * 10**9
"""2100-01-01: a later time is invalid."""


def _time(text: str) -> int | None:
    """The time of `2026-11-20`, `2026-11-20T21:00:00+01:00`, `2026_11_20-21_00_00`; or None."""
    rosbag = _ROSBAG.fullmatch(text)
    try:
        form = "{}-{}-{}T{}:{}:{}".format(*rosbag.groups()) if rosbag else text
        moment = datetime.fromisoformat(form)
        aware = moment if moment.tzinfo is not None else moment.replace(tzinfo=UTC)
        time = round((aware - datetime(1970, 1, 1, tzinfo=UTC)).total_seconds()) * 10**9
    except (ValueError, OverflowError):
        return None
    return time if 0 <= time < _LATEST else None


_ROSBAG = re.compile(r"(\d{4})_(\d\d)_(\d\d)-(\d\d)_(\d\d)_(\d\d)", re.ASCII)
"""The format of times in folder names of rosbag2."""


def scenario_of(facts: RunFacts) -> ComparableRuns:
    """The scenario of a run."""
    named = facts.labels.get(SCENARIO)
    return (
        ComparableRuns(named)
        if named
        else ComparableRuns(PurePosixPath(facts.run).name or facts.run, NAME)
    )


# Reading ----------------------------------------------------------------------------------------


def histories(sources: Sequence[EvidenceSource], by: str | None = None) -> Histories:
    """The histories of all sources.

    Args:
        sources: at least one, in any order.
        by: the kind of rounds: `EVIDENCE`, `DAY` or a label; None: evidence, or days if there is
            one evidence.
    """
    by = by or (EVIDENCE if len(sources) > 1 else DAY)
    facts_of = [list(source.runs()) for source in sources]
    undated = by == EVIDENCE and any(not _times(facts) for facts in facts_of)
    latest = [-1 if undated else _latest(facts) for facts in facts_of]
    order = sorted(range(len(sources)), key=lambda i: (latest[i], natural(sources[i].file)))
    ordered = [sources[i] for i in order]
    facts_of = [facts_of[i] for i in order]
    rounds, round_of = _rounds(by, ordered, facts_of)
    reader = _HistoryReader(by, round_of)
    for i, (source, facts) in enumerate(zip(ordered, facts_of, strict=True)):
        reader.read(i, source, facts)
    return Histories(
        by,
        rounds,
        tuple(reader.runs),
        reader.requirements,
        {key: tuple(found) for key, found in reader.judged.items()},
        _order(rounds, undated=undated),
        tuple(ordered),
        tuple(reader.places),
        tuple(reader.verdict_inputs),
    )


def _latest(facts: Sequence[RunFacts]) -> int:
    """The sort key of a time: an unknown time comes first, because it cannot be the newest."""
    return max(_times(facts), default=-1)


def _order(rounds: Sequence[Round], *, undated: bool) -> str:
    """The order of rounds in words, and how to change it."""
    times = [each.last for each in rounds]
    by = [f"by time (label `{DATE}`, else start of the logs)"]
    by += ["those without a time first"] if None in times else []
    by += ["those of equal times by name"] if len({*times}) < len(times) else []
    words = "by name, since not all have a time" if undated else ", ".join(by)
    return f"rounds are ordered {words}; `fretc audit --label {DATE}=...` decides"


def _key(by: str, source: int, facts: RunFacts) -> str:
    """The key of the round of a run."""
    if by == EVIDENCE:
        return str(source)
    if by == DAY:
        time = time_of(facts)
        return "" if time is None else day(time)
    return facts.labels.get(by, "")


def _rounds(
    by: str, sources: Sequence[EvidenceSource], facts_of: Sequence[Sequence[RunFacts]]
) -> tuple[tuple[Round, ...], Mapping[str, int]]:
    """The rounds, and the index of each by its key."""
    members: dict[str, list[RunFacts]] = defaultdict(list)
    audits: dict[str, dict[int, EvidenceSource]] = defaultdict(dict)
    for i, (source, facts) in enumerate(zip(sources, facts_of, strict=True)):
        if by == EVIDENCE:
            members[str(i)], audits[str(i)][i] = [], source
        for one in facts:
            key = _key(by, i, one)
            members[key].append(one)
            audits[key][i] = source
    times = {key: _times(facts) for key, facts in members.items()}
    keys = list(members)
    if by != EVIDENCE:
        keys.sort(key=lambda key: (_latest(members[key]), natural(key)))
    rounds = tuple(
        Round(
            _round_name(by, key, sources),
            min(times[key], default=None),
            max(times[key], default=None),
            len(members[key]),
            tuple(dict.fromkeys(v for one in members[key] if (v := one.labels.get(VERSION)))),
            frozenset(
                requirement.id for some in audits[key].values() for requirement in some.requirements
            ),
            tuple(each.selection for each in audits[key].values() if each.selection is not None),
        )
        for key in keys
    )
    return rounds, {key: i for i, key in enumerate(keys)}


def _times(facts: Sequence[RunFacts]) -> list[int]:
    return [time for run in facts if (time := time_of(run)) is not None]


def _round_name(by: str, key: str, sources: Sequence[EvidenceSource]) -> str:
    if by == EVIDENCE:
        return sources[int(key)].file
    return key or f"without {'a date' if by == DAY else by}"


class _HistoryReader:
    """The histories while evidence is read."""

    def __init__(self, by: str, round_of: Mapping[str, int]) -> None:
        self.runs: list[HistoryRun] = []
        self.requirements: dict[str, str] = {}
        self.judged: dict[tuple[str, ComparableRuns], list[RunOutcome]] = defaultdict(list)
        self.places: list[Sequence[int]] = []
        self.verdict_inputs: list[Sequence[int]] = []
        self._by, self._round_of = by, round_of
        self._numbers: dict[tuple[str, ...], int] = {}

    def read(self, number: int, source: EvidenceSource, facts: Sequence[RunFacts]) -> None:
        """Add one evidence."""
        run_of: dict[str, int] = {}
        for one in facts:
            run_of[one.run] = len(self.runs)
            self.runs.append(self._run(one, self._round_of[_key(self._by, number, one)]))
        self.requirements |= {
            requirement.id: requirement.sentence for requirement in source.requirements
        }
        together = {probability.requirement for probability in source.probabilities}
        places, numbers = array("q"), array("q")
        for _, summary in source.summaries():
            run, verdict_inputs = run_of[summary.run], self._verdict_inputs(summary)
            places.append(run)
            numbers.append(verdict_inputs)
            if summary.requirement not in together:
                self._add(summary, run, verdict_inputs)
        self.places.append(places)
        self.verdict_inputs.append(numbers)
        self._add_estimates(source, number, [self.runs[i].round for i in run_of.values()])

    def _run(self, facts: RunFacts, round_: int) -> HistoryRun:
        labels = facts.labels
        return HistoryRun(
            facts.run,
            facts.log or facts.log_summary or facts.run,
            scenario_of(facts),
            round_,
            labels.get(VERSION, ""),
            f"commit {labels[COMMIT]}" if COMMIT in labels else f"round {round_}",
            time_of(facts),
        )

    def _add(self, summary: ResultSummary, run: int, verdict_inputs: int) -> None:
        one = self.runs[run]
        self.judged[summary.requirement, one.scenario].append(
            RunOutcome(
                run,
                one.round,
                summary.verdict,
                verdict_inputs,
                summary.latency_max_s,
                summary.latency_median_s,
            )
        )

    def _add_estimates(self, source: EvidenceSource, number: int, rounds: Sequence[int]) -> None:
        """Add the answers of all runs of an evidence to its newest round."""
        own = self._round_of[str(number)] if self._by == EVIDENCE else max(rounds, default=0)
        for probability in source.probabilities:
            self.judged[probability.requirement, ALL_RUNS].append(
                RunOutcome(-1, own, probability.answer, 0)
            )

    def _verdict_inputs(self, summary: ResultSummary) -> int:
        prints = summary.fingerprints
        parts = tuple(str(getattr(prints, name)) for name in _INPUTS)
        return self._numbers.setdefault(parts, len(self._numbers))


def verdicts_of_rounds(judged: Sequence[RunOutcome], rounds: int) -> tuple[tuple[str, ...], ...]:
    """The verdicts of each round."""
    verdicts: list[list[str]] = [[] for _ in range(rounds)]
    for outcome in judged:
        verdicts[outcome.round].append(outcome.verdict)
    return tuple(map(tuple, verdicts))


def counted(verdicts: Sequence[str]) -> Mapping[str, int]:
    """The number of each verdict."""
    return Counter(verdicts)
