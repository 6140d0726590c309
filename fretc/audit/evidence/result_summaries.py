"""Summaries of results without their events, and the interface of evidence that provides them.

Ten thousand runs do not fit into memory with all their events. What counts results, marks them and
sorts them reads summaries, and asks for the few results that it shows in full.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import field, fields
from functools import lru_cache
from operator import attrgetter
from statistics import median
from typing import Any

from compiler.files.checked_json import GREATEST, LEAST
from compiler.files.records import (
    UNSET,
    Count,
    Name,
    Raw,
    Record,
    Seconds,
    UnsetType,
    Whole,
)
from compiler.files.records import field as record_field
from fretc.audit.evidence.probabilities import Estimated, Outcomes
from fretc.audit.evidence.schema import (
    BindingsRecord,
    EvidenceDocument,
    Hashes,
    Health,
    Labels,
    RequirementRecord,
    Result,
    Selection,
    Situations,
    ThresholdRecord,
    Verdict,
    trials_of,
)
from fretc.audit.evidence.verdict_inputs import KINDS
from fretc.audit.measurements.tallies import PropositionTally
from fretc.audit.measurements.trials import Trials
from fretish.bindings.canonical import digest
from fretish.classes.frozen import dataclass
from fretish.clock import period_of

Recorded = tuple[str | UnsetType, ...]
"""SHA-256 of each of `fretc.audit.evidence.verdict_inputs.KINDS`; unset if it is unknown."""


@dataclass(frozen=True, slots=True)
class ResultSummary:
    """The result of one requirement in one run, with the number of its events."""

    run: str
    requirement: str
    verdict: str
    finite: bool | None
    reason: str
    clock: str
    ticks: Count
    start_ns: Whole | None
    end_ns: Whole | None
    triggers: Count
    answers: Count
    at_once: Count
    """Number of answers at the tick of their trigger."""
    open: Count
    violations: Count
    violated_ticks: int
    first_violation_ns: Whole | None
    first_violation_s: Seconds | None
    unknown: Count
    """Number of intervals of ticks at which it is unknown whether a demand was broken; if there is
    none and no verdict, of those at which inputs were unknown."""
    unknown_ticks: int
    latency_median_s: Seconds | None
    latency_max_s: Seconds | None
    intact: bool
    """False: messages of the log may have been lost."""
    fingerprints: Hashes
    judgement: str
    """SHA-256 of the verdict and its ticks, as a review accepts it."""
    trials: Trials | None
    """Present for a requirement with a probability, if the log could be read."""

    @property
    def log(self) -> str:
        """SHA-256 of the log; empty if it was not read as a whole, or could not be read."""
        return self.fingerprints.log or ""

    @property
    def rests_on(self) -> Recorded:
        """The fingerprints of the inputs of the verdict other than the log."""
        kinds: Recorded = _rests_on(self.fingerprints)
        return kinds

    @property
    def content(self) -> str:
        """Hash of the content of the log, to detect copies of it.

        So has a log whose messages were written again, in other chunks, say. What cannot be read
        has no hash.
        """
        prints = self.fingerprints
        return prints.messages or prints.log or prints.log_summary or self.run


@dataclass(frozen=True, slots=True)
class RunFacts:
    """The facts that all results of one run share."""

    run: str
    clock: str
    ticks: int
    start_ns: int | None
    end_ns: int | None
    log: str
    """SHA-256 of the log; empty if it was not read as a whole, or could not be read."""
    log_summary: str
    health: Health
    assumptions: tuple[str, ...]
    """Of all its results, each once."""
    labels: Mapping[str, str] = field(default_factory=dict)
    """What is known of the run beside its messages: version, scenario and others."""


@dataclass(frozen=True)
class EvidenceSource(ABC):
    """Evidence in a file or in a store. The index of a result counts from 0."""

    file: str
    """The name of the evidence, as the user gave it."""
    sha256: str
    """SHA-256 of the evidence file, or of the records of a store.

    Another audit of the same logs gives the same.
    """
    document: EvidenceDocument
    """The evidence; that of a store without its results."""

    @property
    def fretc(self) -> str:
        """Version of the tool that audited."""
        return self.document.fretc

    @property
    def bindings(self) -> BindingsRecord:
        """The bindings with which the logs were read."""
        return self.document.bindings

    @property
    def requirements(self) -> Sequence[RequirementRecord]:
        """The requirements of the audit."""
        return self.document.requirements

    @property
    def probabilities(self) -> Sequence[Estimated]:
        """The answer of all runs for each requirement with a probability."""
        return self.document.probabilities or ()

    @property
    def selection(self) -> Selection | None:
        """The selection of the named logs that were audited; None: all."""
        return self.document.selection or None

    @abstractmethod
    def summaries(self) -> Iterator[tuple[int, ResultSummary]]:
        """The summary of each result with its index, in order; the results of a run adjoin."""

    @abstractmethod
    def runs(self) -> Iterator[RunFacts]:
        """The facts of each run, in the order of their first results."""

    def after_summaries(self) -> EvidenceSource:
        """The same evidence, once all its summaries have been read.

        A store has compared its summaries then, and takes the facts of its runs from them.
        """
        return self

    @abstractmethod
    def details(self, indices: Collection[int]) -> Iterator[tuple[int, Result]]:
        """The whole results at the given indices, in order."""

    @abstractmethod
    def latencies(self, requirements: Collection[str]) -> Iterator[tuple[int, Sequence[float]]]:
        """Latencies in seconds of each result of some requirements, with its index, in order.

        A store is read once for all of them.
        """

    @abstractmethod
    def thresholds(
        self, requirements: Collection[str]
    ) -> Iterator[tuple[int, Sequence[ThresholdRecord]]]:
        """The thresholds of each result of some requirements, with its index, in order."""

    @abstractmethod
    def situations(
        self, requirements: Collection[str]
    ) -> Iterator[tuple[int, Situations | UnsetType]]:
        """The situations that each result of some requirements shows, with its index, in order."""


@dataclass(frozen=True, slots=True)
class ResultSummaries:
    """The summaries of all results of some evidence, and the evidence itself."""

    source: EvidenceSource
    by_requirement: Mapping[str, Sequence[tuple[int, ResultSummary]]]
    """The summaries of each requirement that has results, with their indices, in order."""
    firsts: Mapping[tuple[str, str], int]
    """The index of the first result of each run, by the name and the hash of its log."""

    @classmethod
    def of(cls, source: EvidenceSource) -> ResultSummaries:
        """The summaries of all results, read once; equal values are shared to save memory."""
        groups: dict[str, list[tuple[int, ResultSummary]]] = {}
        pools: _Pools = {str: {}, int: {}, float: {}}
        firsts: dict[tuple[str, str], int] = {}
        for index, each in source.summaries():
            shared = _sharing(each, pools)
            groups.setdefault(each.requirement, []).append((index, shared))
            firsts.setdefault((shared.run, shared.log), index)
        return cls(source.after_summaries(), groups, firsts)


_Pools = dict[type, dict[Any, Any]]


def _sharing(summary: ResultSummary, pools: _Pools) -> ResultSummary:
    """The summary with its values replaced by equal ones that are already in memory."""
    values, share = [*_values(summary)], pools[str].setdefault
    for at, kind in _COMMON:
        value = values[at]
        if value:  # 0.0 and -0.0 are equal, and are two
            values[at] = pools[kind].setdefault(value, value)
    prints = [each and share(each, each) for each in _prints(summary.fingerprints)]
    values[_AT] = Hashes(**dict(zip(_PRINTS, prints, strict=True)))
    return ResultSummary(*values)


_PRINTS = Hashes.__struct_fields__
_FIELDS = tuple(field.name for field in fields(ResultSummary))
_AT = _FIELDS.index("fingerprints")
_COMMON = tuple(
    (_FIELDS.index(name), kind)
    for kind, names in (
        (str, "run requirement verdict reason clock judgement"),
        (int, "ticks start_ns end_ns"),
        (float, "latency_median_s latency_max_s"),
    )
    for name in names.split()
)
"""Fields that often have equal values, with their types; small counts are always shared."""
_prints, _values = attrgetter(*_PRINTS), attrgetter(*_FIELDS)
_rests_on = attrgetter(*KINDS)


class PartialRecord(Record, frozen=True, forbid_unknown_fields=False):
    """Some fields of a record of evidence; the others are skipped when it is read."""


class _Tick(PartialRecord, frozen=True):
    tick: Count


class _Violation(PartialRecord, frozen=True):
    first_tick: Count
    last_tick: Count
    start_ns: Whole
    start_s: Seconds


class _Interval(PartialRecord, frozen=True):
    first_tick: Count
    last_tick: Count


@dataclass(frozen=True, slots=True)
class SharedFacts:
    """What all results of a run have in common, as a `Result` has it."""

    run: str
    health: Health
    labels: Labels | UnsetType


class CountedResult(PartialRecord, frozen=True, kw_only=True):
    """What is counted of a result of a store; its events are not decoded.

    The facts of its run are not here: a store has them once for all results, as `SharedFacts`.
    """

    run: str = ""
    labels: Labels | UnsetType = UNSET
    requirement: Name
    verdict: Verdict
    finite: bool | None
    reason: str
    clock: str
    ticks: Count
    start_ns: Whole | None
    end_ns: Whole | None
    triggers: tuple[Raw, ...]
    violations: tuple[_Violation, ...]
    unknown: tuple[tuple[Count, Count], ...]
    open: tuple[_Tick, ...]
    latencies: tuple[Seconds, ...] = record_field(name="latencies_s")
    fingerprints: Hashes = record_field(name="hashes")
    assumptions: tuple[str, ...]
    propositions: dict[str, PropositionTally]
    outcomes: Outcomes | UnsetType = record_field(name="trials", default=UNSET)
    unknown_inputs: tuple[_Interval, ...] | UnsetType = UNSET

    def __post_init__(self) -> None:
        """Raise ValueError if a time has more than 64 bits."""
        _check_time(self.start_ns)
        _check_time(self.end_ns)
        for each in self.violations:
            _check_time(each.start_ns)

    @property
    def trials(self) -> Trials | None:
        """The trials; None: no probability is required, or the log could not be read."""
        return trials_of(self.outcomes)


def _check_time(time: int | None) -> None:
    if time is not None and not LEAST <= time <= GREATEST:
        raise ValueError("Expected a time of 64 bits")


def summary_of(result: Result) -> ResultSummary:
    """The summary of a result."""
    return summary_of_part(result, result)


def summary_of_part(result: Result | CountedResult, shared: Result | SharedFacts) -> ResultSummary:
    """The summary of a result of a run.

    Args:
        result: the result.
        shared: what it has in common with the results of its run; a whole result has it itself.
    """
    violations, latencies = result.violations, result.latencies
    first = violations[0] if violations else None
    return ResultSummary(
        run=shared.run,
        requirement=result.requirement,
        verdict=result.verdict,
        finite=result.finite,
        reason=result.reason,
        clock=result.clock,
        ticks=result.ticks,
        start_ns=result.start_ns,
        end_ns=result.end_ns,
        triggers=len(result.triggers),
        answers=len(latencies),
        at_once=latencies.count(0),
        open=len(result.open),
        violations=len(violations),
        violated_ticks=sum(v.last_tick - v.first_tick + 1 for v in violations),
        first_violation_ns=first.start_ns if first else None,
        first_violation_s=first.start_s if first else None,
        unknown=len(undecided_ticks(result)),
        unknown_ticks=sum(last - first + 1 for first, last in result.unknown),
        latency_median_s=median(latencies) if latencies else None,
        latency_max_s=max(latencies, default=None),
        intact=shared.health.intact,
        fingerprints=result.fingerprints,
        judgement=judgement(result),
        trials=result.trials,
    )


def undecided_ticks(result: Result | CountedResult) -> Sequence[tuple[int, int]]:
    """The intervals of ticks at which unknown values leave the verdict open."""
    if result.unknown or not result.unknown_inputs:
        return result.unknown
    return sorted({(one.first_tick, one.last_tick) for one in result.unknown_inputs})


def judgement(result: Result | CountedResult) -> str:
    """SHA-256 of the verdict and its ticks."""
    return judgement_of(
        result.verdict,
        result.finite,
        len(result.triggers),
        tuple((violation.first_tick, violation.last_tick) for violation in result.violations),
        tuple(moment.tick for moment in result.open),
    )


@lru_cache(1000)  # most results of a requirement are alike
def judgement_of(
    verdict: str,
    finite: bool | None,
    triggers: int,
    violations: tuple[tuple[int, int], ...],
    open_at: tuple[int | None, ...],
) -> str:
    """SHA-256 of the verdict and its ticks, from the parts of a result.

    Args:
        verdict: the word of the verdict.
        finite: FRET's verdict of the whole finite trace.
        triggers: the number of triggers.
        violations: the first and the last tick of each violation.
        open_at: the tick of each trigger whose demand is open at the end.
    """
    return digest(
        {
            "verdict": verdict,
            "finite": finite,
            "triggers": triggers,
            "violations": violations,
            "open": open_at,
        }
    )


def run_facts(results: Sequence[Result]) -> RunFacts:
    """The facts of a run.

    Args:
        results: all results of one run, at least one.
    """
    return facts_of_parts(results, results[0])


def facts_of_parts(
    results: Sequence[Result | CountedResult], shared: Result | SharedFacts
) -> RunFacts:
    """The facts of a run.

    Args:
        results: all results of one run, at least one.
        shared: what they have in common.
    """
    first = results[0]
    assumptions = dict.fromkeys(text for result in results for text in result.assumptions)
    return RunFacts(
        run=shared.run,
        clock=first.clock,
        ticks=first.ticks,
        start_ns=first.start_ns,
        end_ns=first.end_ns,
        log=first.fingerprints.log or "",
        log_summary=first.fingerprints.log_summary or "",
        health=shared.health,
        assumptions=tuple(assumptions),
        labels=shared.labels or {},
    )


def audited_s(run: RunFacts | Result) -> float | None:
    """How long a run was audited, in seconds: its ticks, each of one period of the clock.

    By a clock that ticks by message, from the first to the last of the messages. None: the log
    could not be read.
    """
    if run.start_ns is None or run.end_ns is None:
        return None
    period = period_of(run.clock)
    span = max(0, run.end_ns - run.start_ns) if period is None else run.ticks * period
    return span / 1e9
