"""An evidence file as values: what audits have shown of runs and requirements.

The types are the schema: they are written and read as they stand here, a key whose value is
`UNSET` is left out, and what they do not have is refused. `templates/json/evidence.schema.json` is
made of them. Seconds count from the first tick of the run, `_ns` are nanoseconds of the log, and
intervals include both ends.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Annotated, Any, Final, Literal

from compiler.files.records import (
    UNSET,
    Count,
    Distance,
    Duration,
    Meta,
    Name,
    Number,
    Ordinal,
    Record,
    Seconds,
    Sha256,
    UnsetType,
    Whole,
    about,
    field,
    json_schema,
    plain,
)
from fretc.audit.evidence.probabilities import Estimated, Outcomes
from fretc.audit.evidence.samples import (
    Reading,
    RunPart,
    Surroundings,
    Word,
    check_series,
    window,
)
from fretc.audit.measurements.beliefs import AgentBelief
from fretc.audit.measurements.intervals import Moment as Moment
from fretc.audit.measurements.intervals import TickInterval
from fretc.audit.measurements.tallies import PropositionTally
from fretc.audit.measurements.trials import Trials
from fretc.audit.measurements.unknown_inputs import MOST as MOST_UNKNOWN
from fretc.audit.measurements.unknown_inputs import UnknownInput

SCHEMA: Final = "fretc-evidence-1"
Verdict = Literal[
    "satisfied", "violated", "assumption broken", "inconclusive", "vacuous", "no data"
]
LabelName = Annotated[str, Meta(min_length=1, max_length=50)]
LabelText = Annotated[str, Meta(min_length=1, max_length=200)]
"""Texts of an untrusted log: they are escaped when they are shown."""
Labels = Annotated[dict[LabelName, LabelText], Meta(min_length=1, max_length=32)]
StateWord = Literal["idle", "open", "violated", "unknown"]
Comparison = Literal["true", "false", "crossed"]
Part = Annotated[
    str,
    Meta(
        pattern=r"^([0-9a-f]{64})?(?![\s\S])",
        description="SHA-256 of the log; empty if it could not be read, in a result that was "
        "not judged",
    ),
]


# Violations ------------------------------------------------------------------------------------


class Violation(TickInterval, frozen=True):
    """An interval of ticks at which a demand was broken."""

    trigger: Annotated[Moment | None, about("the oldest trigger whose demand was broken")]
    deadline: Annotated[
        Moment | None,
        about(
            "the last tick at which the response was in time; null: there is none, or it is "
            "after the last tick"
        ),
    ]
    missing: Annotated[str, about("the missing response, as written in the sentence")]
    values: Annotated[
        dict[str, Number | Word | None],
        about(
            "each signal at the first tick, in its base unit, or its enumeration value; null: "
            "unknown"
        ),
    ]
    surroundings: Annotated[Surroundings | None, about("null after the first 100 violations")] = (
        field(name="window")
    )
    beliefs: Annotated[
        tuple[AgentBelief, ...] | UnsetType,
        about("what agents believed; absent: they reported no belief about the requirement"),
    ] = UNSET

    @property
    def window(self) -> RunPart | None:
        """The signals around the violation, in seconds from the first tick; None: not kept."""
        if self.surroundings is None:
            return None
        return window(self.surroundings, self.start_ns - round(self.start_s * 1e9))


class Instant(Record, frozen=True):
    """A time of the log, in nanoseconds and seconds; seconds are negative before the first tick."""

    ns: Whole
    seconds: Number


class ThresholdRecord(Record, frozen=True):
    """A comparison of a signal with a constant, over the audited time; known samples count."""

    proposition: str
    signal: Annotated[str, about("the signal, or an expression of signals: abs(vx)")]
    operator: Literal["<", "<=", ">", ">="]
    bound: Annotated[Number, about("the bound, in `unit`")]
    unit: Annotated[str, about("the base unit; empty for a plain number")]
    least: Reading
    greatest: Reading
    comparison: Annotated[
        Comparison | None,
        about("the truth value over the whole run; null: it was always unknown"),
    ]
    margin: Annotated[
        Distance | None,
        about(
            "the least distance to the bound; null where the comparison was crossed, or never "
            "finite"
        ),
    ]
    nearest: Annotated[
        Instant | None,
        about(
            "the first time of the least distance; if the comparison was crossed, the time of "
            "its first change"
        ),
    ]


# The log ---------------------------------------------------------------------------------------


class LogFinding(Record, frozen=True):
    """A diagnostic about the log."""

    code: Annotated[str, Meta(pattern="^F[0-9]{3}$", max_length=4)]
    severity: Literal["error", "warning", "note"]
    message: str
    file: str | None
    line: Ordinal | None
    column: Ordinal | None
    help: str | None
    subject: Annotated[Name, about("the topic, for warnings that can be accepted")] | UnsetType = (
        UNSET
    )


class TopicRecord(Record, frozen=True):
    """The condition of one topic of a log; null: its messages were only counted."""

    type: str
    count: Count
    first_ns: Annotated[Whole | None, about("null: the topic has no message")]
    last_ns: Whole | None
    longest_gap_ns: Duration | None
    median_period_ns: Annotated[
        Duration | None,
        about("the longest time between two messages; null: there are fewer than two messages"),
    ]
    out_of_order: Annotated[Count | None, about("messages out of order")]
    equal_stamps: Annotated[Count | None, about("messages with the same time as another message")]
    unstamped: Annotated[
        Count | None,
        about("messages without the declared stamp: their log time is used"),
    ]
    zero_stamps: Annotated[
        Count | None, about("messages with the time 0: their samples are unknown")
    ]
    clock_jumps: Annotated[
        Count | None,
        about("jumps of the clock against the log time by more than 1 s, between two messages"),
    ]


class CheckedChunks(Record, frozen=True):
    """The numbers of chunks of an MCAP file that were checked, by kind of check."""

    by_index: Annotated[
        bool, about("true: only the bound messages were read; false: every record was read")
    ]
    chunks: Count
    crc_checked: Annotated[Count, about("chunks whose stated CRC was checked")]
    crc_unchecked: Annotated[
        Count, about("chunks with a CRC that was not checked: only their beginning was unpacked")
    ]
    without_crc: Annotated[Count, about("chunks that were unpacked and state no CRC")]
    skipped: Annotated[Count, about("chunks without bound messages")]


class Gap(Record, frozen=True):
    """An interval of time without data of the log."""

    start_ns: Whole
    end_ns: Whole


class Health(Record, frozen=True):
    """The integrity of the data of a run, and its diagnostics."""

    intact: Annotated[bool, about("false: messages may have been lost")]
    size: Annotated[Count | None, about("bytes; null: the log could not be read")]
    checked: Annotated[CheckedChunks | None, about("null: the log could not be read")]
    gaps: tuple[Gap, ...]
    findings: tuple[LogFinding, ...]
    topics: dict[str, TopicRecord]


class Hashes(Record, frozen=True, kw_only=True):
    """SHA-256 of the log and of the other inputs of the verdict.

    The inputs are hashed by their meaning: `50 cm` and `0.5 m` have one hash. A result without one
    of these hashes is of an earlier version, and suspect.
    """

    log: Annotated[
        Sha256 | UnsetType,
        about("absent if the log could not be read, or was not read as a whole"),
    ] = UNSET
    log_summary: Annotated[
        Sha256 | UnsetType,
        about(
            "SHA-256 of the summary section and of the CRCs of the chunks, if the log was not "
            "read as a whole (--integrity index)"
        ),
    ] = UNSET
    sentence: Annotated[Sha256, about("SHA-256 of the canonical wording")]
    params: Annotated[
        Sha256 | UnsetType, about("SHA-256 of the numbers that the requirement states")
    ] = UNSET
    clock: Annotated[Part | UnsetType, about("SHA-256 of the clock")] = UNSET
    topics: Annotated[
        Part | UnsetType,
        about(
            "SHA-256 of the names of the topics that the audit reads: the first tick depends on "
            "their messages"
        ),
    ] = UNSET
    bindings: Annotated[
        Part, about("SHA-256 of the propositions of the sentence and of the signals that they read")
    ]
    monitor: Sha256
    messages: Annotated[
        Sha256 | UnsetType,
        about(
            "SHA-256 of the times and values of all signals that were read, if a requirement "
            "has a probability: logs with the same hash are copies of one run"
        ),
    ] = UNSET


# Plot data of a run ----------------------------------------------------------------------------


MOST_POINTS, MOST_WORDS = 300, 300
"""The most points of a path, and the most changes of an enumeration signal, in the evidence of a
run."""


_FAR = 10**9
Metre = Annotated[int, Meta(ge=-_FAR, le=_FAR)] | Annotated[float, Meta(ge=-_FAR, le=_FAR)]


class RobotPath(Record, frozen=True):
    """The path of the robot, as lines with few points, for a map; no verdict depends on it."""

    times_ns: Annotated[tuple[Whole, ...], Meta(max_length=MOST_POINTS)]
    x: Annotated[tuple[Metre, ...], Meta(max_length=MOST_POINTS), about("in metres")]
    y: Annotated[tuple[Metre, ...], Meta(max_length=MOST_POINTS), about("in metres")]
    starts: Annotated[
        tuple[Count, ...],
        Meta(max_length=MOST_POINTS),
        about("the indices at which a new line begins: between two lines the position is unknown"),
    ]
    error: Annotated[
        Distance,
        about("metres: at the time of each sample the robot is at most this far from the line"),
    ]
    lines_left_out: Annotated[Count, about("number of lines left out, because there are too many")]

    def __post_init__(self) -> None:
        """Raise ValueError if the numbers do not form a path."""
        if not len(self.times_ns) == len(self.x) == len(self.y):
            raise ValueError("Expected as many times as places")
        if any(late < early for early, late in pairwise(self.times_ns)):
            raise ValueError("Expected times in their order")
        ordered = all(early < late for early, late in pairwise(self.starts))
        if not ordered or any(start >= len(self.x) for start in self.starts):
            raise ValueError("Expected the places of points, in their order")


class EnumChanges(Record, frozen=True):
    """The changes of an enumeration signal; null: it is unknown from then on."""

    times_ns: Annotated[tuple[Whole, ...], Meta(max_length=MOST_WORDS)]
    words: Annotated[tuple[Word | None, ...], Meta(max_length=MOST_WORDS)]
    changes_left_out: Annotated[
        Count, about("number of later changes left out, because there are too many")
    ]

    def __post_init__(self) -> None:
        """Raise ValueError if times and values do not form a series."""
        check_series(self.times_ns, self.words)


class RunPlotData(Record, frozen=True):
    """The plot data of a run, beside its results; present in the first of them."""

    way: Annotated[
        RobotPath | None, about("null: the bindings declare no map, or no position is known")
    ]
    words: Annotated[
        dict[str, EnumChanges],
        about(
            "each enumeration signal that the requirements read; what each agent believes, "
            "pursues and did last"
        ),
    ]


# Results ---------------------------------------------------------------------------------------


class StateChangeRecord(Record, frozen=True):
    """A tick at which the state changed, with the new state; open: a response is awaited."""

    tick: Count
    ns: Whole
    seconds: Seconds
    state: StateWord


class Answer(Record, frozen=True):
    """The first answer to a trigger, with the tick of that trigger."""

    tick: Count
    ns: Whole
    seconds: Seconds
    trigger: Count


class PhaseStretch(Record, frozen=True):
    """An interval of phases with one verdict."""

    first_ns: Count
    last_ns: Count
    verdict: Annotated[Verdict | None, about("null: not judged")]


class PhaseVerdicts(Record, frozen=True):
    """The verdict for each phase of the ticks.

    For a requirement with a probability, the verdict of the run alone.
    """

    period_ns: Annotated[Ordinal, about("of a tick")]
    declared_ns: Annotated[Count, about("the phase that is audited")]
    exact: Annotated[bool, about("true: every phase was judged")]
    nearest_ns: Annotated[
        Ordinal | None,
        about(
            "the distance from the declared phase to the nearest one with another verdict or "
            "none, modulo the tick; null: there is none"
        ),
    ]
    stretches: Annotated[
        tuple[PhaseStretch, ...],
        Meta(min_length=1, description="all phases from 0 to one tick, in order"),
    ]


class Situations(Record, frozen=True):
    """The situations of the requirement that a run showed, by their keys; it showed no others."""

    seen: Annotated[
        dict[str, Moment], about("the first tick at which each situation certainly occurred")
    ]
    perhaps: Annotated[
        dict[str, Moment],
        about(
            "the first tick at which each other situation may have occurred: inputs are "
            "unknown there"
        ),
    ]


class Result(Record, frozen=True, kw_only=True):
    """The result of one requirement in one run."""

    run: Annotated[str, about("the log, as named on the command line")]
    requirement: Name
    verdict: Verdict
    finite: Annotated[bool | None, about("FRET's verdict of the whole finite trace; null: unknown")]
    reason: str
    clock: Annotated[str, about("empty: the log could not be read")]
    ticks: Count
    start_ns: Whole | None
    end_ns: Whole | None
    states: tuple[StateChangeRecord, ...]
    answers: tuple[Answer, ...]
    triggers: tuple[Moment, ...]
    violations: tuple[Violation, ...]
    unknown: Annotated[
        tuple[tuple[Count, Count], ...],
        about("intervals of ticks at which it is unknown whether a demand was broken"),
    ]
    open: Annotated[
        tuple[Moment, ...], about("triggers whose demand is open at the end of the log")
    ]
    uncertain_ticks: Annotated[
        tuple[Count, ...] | UnsetType,
        about(
            "triggers of `answers` and `open` that are not certain, because propositions are "
            "unknown; all others are certain. Absent in evidence of earlier versions"
        ),
    ] = field(name="uncertain", default=UNSET)
    latencies: Annotated[
        tuple[Seconds, ...],
        about("the time from each answered trigger to its answer, in the order of the triggers"),
    ] = field(name="latencies_s")
    exercised: Annotated[Count, about("number of ticks with a trigger")]
    latency_median_s: Seconds | None
    latency_max_s: Seconds | None
    propositions: dict[str, PropositionTally]
    thresholds: tuple[ThresholdRecord, ...]
    units: Annotated[dict[str, str], about("the base unit of each signal")]
    fingerprints: Hashes = field(name="hashes")
    health: Health
    assumptions: tuple[str, ...]
    outcomes: Annotated[
        Outcomes | UnsetType,
        about(
            "for a requirement with a probability: the outcomes of its triggers in this run, "
            "which alone decide nothing"
        ),
    ] = field(name="trials", default=UNSET)
    phases: Annotated[
        PhaseVerdicts | UnsetType,
        about("absent: the clock ticks by message, or the log could not be read"),
    ] = UNSET
    course: Annotated[
        RunPlotData | UnsetType,
        about(
            "present in the first result of the run; absent if the bindings declare no map, no "
            "enumeration signal is read, and no agent reports"
        ),
    ] = UNSET
    situations: Annotated[
        Situations | UnsetType,
        about(
            "the situations of the requirement; absent: not measured, as in evidence of earlier "
            "versions, or because the log could not be read"
        ),
    ] = UNSET
    unknown_inputs: Annotated[
        Annotated[tuple[UnknownInput, ...], Meta(min_length=1, max_length=MOST_UNKNOWN)]
        | UnsetType,
        about(
            "the first 100 intervals at which propositions of the requirement were unknown, if "
            "the verdict is `no data`; absent: there are none, or the evidence is of an earlier "
            "version"
        ),
    ] = UNSET
    labels: Annotated[
        Labels | UnsetType,
        about(
            "labels of the run, such as robot, version, commit, scenario and date, from "
            "`[run.label]` of the bindings or `--label`; no verdict depends on them. Absent: "
            "there are none"
        ),
    ] = UNSET

    @property
    def hashes(self) -> Mapping[str, str]:
        """The known hashes by their names."""
        prints: Mapping[str, str] = plain(self.fingerprints)
        return prints

    @property
    def uncertain(self) -> frozenset[int]:
        """Ticks of triggers whose answer or open demand depends on unknown values."""
        return frozenset(self.uncertain_ticks or ())

    @property
    def trials(self) -> Trials | None:
        """The trials; None: no probability is required, or the log could not be read."""
        return trials_of(self.outcomes)

    @property
    def content(self) -> str:
        """Hash of the content of the log, to detect copies of it."""
        return self.fingerprints.log or self.fingerprints.log_summary or self.run


def trials_of(outcomes: Outcomes | UnsetType) -> Trials | None:
    """The trials of a result; None: it has no outcomes."""
    return Trials(outcomes.answered, outcomes.failed, outcomes.open) if outcomes else None


# The file --------------------------------------------------------------------------------------


class BindingsRecord(Record, frozen=True):
    """The bindings with which the logs were read."""

    file: str
    sha256: Annotated[
        Sha256,
        about(
            "SHA-256 of the bindings that the requirements read, without comments, order and "
            "spelling"
        ),
    ]


class SituationRecord(Record, frozen=True):
    """A way in which a run can meet a requirement."""

    key: Annotated[str, about("unique within the requirement")]
    words: Annotated[str, about("the title that people read")]


class RequirementRecord(Record, frozen=True):
    """A requirement of the audit."""

    id: Name
    sentence: str
    sha256: Annotated[Sha256, about("SHA-256 of the canonical wording")]
    situations: Annotated[
        tuple[SituationRecord, ...] | UnsetType,
        about("all situations that a run can reach; absent: they were not measured"),
    ] = UNSET


class Selection(Record, frozen=True):
    """The selection of the named logs that were audited."""

    named: Annotated[Count, about("logs")]
    since: Annotated[str | None, about("an instant in ISO 8601; null: no limit")]
    older: Annotated[Count, about("number of logs left out because they are older")]
    sample_of: Annotated[
        Count | None,
        about("number of logs from which the sample was drawn; null: all were audited"),
    ]
    seed: Annotated[Whole | None, about("the seed of the random selection")]
    audited: Annotated[Count, about("logs")]


class EvidenceDocument(Record, frozen=True):
    """A whole evidence file."""

    schema: Literal["fretc-evidence-1"]
    fretc: Annotated[str, about("version of the tool")]
    bindings: BindingsRecord
    requirements: tuple[RequirementRecord, ...]
    results: tuple[Result, ...]
    probabilities: Annotated[
        Annotated[tuple[Estimated, ...], Meta(min_length=1)] | UnsetType,
        about(
            "the answer of all runs together for each requirement with a probability; absent: "
            "there is none"
        ),
    ] = UNSET
    selection: Annotated[
        Selection | UnsetType, about("absent: all logs that were named were audited")
    ] = UNSET


def schema() -> dict[str, Any]:
    """The JSON Schema of evidence files."""
    return json_schema(
        EvidenceDocument,
        SCHEMA,
        "The results of audits, as `fretc audit --evidence` writes them",
        "Seconds count from the first tick of the run, ticks from 0, intervals include both ends; "
        "`_ns` are nanoseconds of the log.",
    )
