"""The views: what a reader gets of each part of the report. Templates and `--json` print them.

The names of classes and fields are those of `report.schema.json`. No view contains markup. Times
are seconds from the first tick of a run, ticks count from 0, intervals include both ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from fretc.report.model.across import Across
from fretc.report.model.changes import Change, ChangeGroup
from fretc.report.model.front import Front
from fretc.report.model.marks import Mark as Mark
from fretc.report.model.marks import sign_mark as sign_mark
from fretc.report.model.marks import verdict_mark as verdict_mark
from fretc.report.model.pictures import Histogram, Timeline
from fretc.traceability.artefacts import Product
from fretish.documents import named

SCHEMA = "fretc-report-1"


@dataclass(frozen=True, slots=True)
class Remark:
    """A diagnostic; `place` is `file:line:column`, empty where it has none."""

    code: str
    severity: str
    message: str
    place: str = ""
    help: str = ""
    accepted: str = ""
    """Why the project accepts it; empty: it does not."""


# 1: the runs -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Overall:
    """The overall result in words."""

    mark: Mark
    headline: str
    sentences: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TopicView:
    """One topic of a run; `read_for` names the signals that the bindings read from it."""

    name: str
    type: str
    count: str
    rate: str
    longest_gap: str
    out_of_order: str
    read_for: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RunSummary:
    """One recorded run and whether it can be trusted, without its topics."""

    anchor: str
    label: str
    file: str
    sha256: str
    size: str
    recorded: str
    duration: str
    ticks: str
    clock: str
    intact: bool
    health: Mark
    checked: str
    gaps: tuple[str, ...]
    findings: tuple[Remark, ...]


@dataclass(frozen=True, slots=True)
class RunView(RunSummary):
    """One recorded run with its topics."""

    topics: tuple[TopicView, ...]


# 2: the claims ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Count:
    """The number of requirements and of single audits with one mark."""

    mark: Mark
    requirements: int
    results: int


@dataclass(frozen=True, slots=True)
class NotShown:
    """A requirement that is not shown, and why."""

    requirement: str
    title: str
    anchor: str
    mark: Mark
    reasons: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Planned:
    """A planned method of verification and its result."""

    requirement: str
    anchor: str
    method: str
    has_result: bool
    result: str
    refuted: bool = False


# 3: the matrix ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SituationsView:
    """How much of a requirement the runs have exercised."""

    share: str
    """`7/11`; empty where they were not measured."""
    text: str
    """`7 of 11 situations seen`."""
    perhaps: tuple[str, ...]
    """Those that were perhaps seen, in words."""
    never: tuple[str, ...]
    """Those that were not."""


@dataclass(frozen=True, slots=True)
class Row:
    """A requirement and a hazard that it traces to; `hazard` is empty where it traces to none."""

    hazard: str
    hazard_title: str
    via: str
    requirement: str
    title: str
    status: str
    anchor: str
    mark: Mark
    runs: int
    """How many runs have the verdict; of a waived one, that behind the waiver."""
    limit: str
    """Why no run can violate it; empty where one can."""
    proof: Mark | None
    """What is proved of it: the closed loop, or its monitor; None: neither."""
    review: Mark
    situations: SituationsView | None
    """None where no run has been audited."""


@dataclass(frozen=True, slots=True)
class HazardView:
    """A hazard of the project."""

    id: str
    title: str
    text: str
    severity: str
    source: str


@dataclass(frozen=True, slots=True)
class Orphans:
    """The places where the chain from hazard to verdict has no link, in words."""

    hazards: tuple[str, ...]
    requirements: tuple[str, ...]
    parents: tuple[str, ...]
    evidence: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Withdrawal:
    """A requirement that was reviewed and is claimed no more; `text` says how."""

    requirement: str
    text: str


@dataclass(frozen=True, slots=True)
class SignatureView:
    """Whether the right person has signed something, and who has."""

    mark: Mark
    text: str
    is_good: bool


@dataclass(frozen=True, slots=True)
class Signed:
    """A line of the table of signatures: a thing that can be signed, or a signature that fails."""

    kind: str
    name: str
    anchor: str
    signature: SignatureView


@dataclass(frozen=True, slots=True)
class Signatures:
    """The table of signatures, and the keys that count."""

    file: str
    """The file of signers; empty where there is none: then no signature counts."""
    signers: tuple[str, ...]
    signed: tuple[Signed, ...]


@dataclass(frozen=True, slots=True)
class ReviewView:
    """The review of a requirement, and whether it still stands."""

    mark: Mark
    by: str
    comment: str
    changes: tuple[str, ...]
    signature: SignatureView | None
    """None: there is no review."""

    @property
    def text(self) -> str:
        """The words of both marks: `reviewed, unauthenticated`."""
        marks = (self.mark, *([self.signature.mark] if self.signature else []))
        return ", ".join(mark.word for mark in marks)


@dataclass(frozen=True, slots=True)
class WaiverView:
    """The waiver of a requirement; `covers` is the verdict without it."""

    requirement: str
    anchor: str
    reason: str
    by: str
    until: str
    covers: Mark
    signature: SignatureView


# 4: the requirements ---------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ProofView:
    """The result of `fretc verify` for one claim, and why it does not count, if it does not."""

    requirement: str
    layer: str
    claim: str
    mark: Mark
    detail: str
    assumptions: tuple[str, ...]
    engine: str
    artefacts: tuple[tuple[str, str], ...]
    suspicions: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Formula:
    """A formula, and the traces that it is read over."""

    name: str
    over: str
    text: str


@dataclass(frozen=True, slots=True)
class SignalView:
    """Where the numbers of a proposition come from."""

    name: str
    path: str
    type: str
    unit: str
    reading: str


@dataclass(frozen=True, slots=True)
class PropositionView:
    """A proposition of the sentence, and its binding to the messages."""

    name: str
    is_bound: bool
    text: str
    expression: str
    properties: str
    signals: tuple[SignalView, ...]


@dataclass(frozen=True, slots=True)
class Parent:
    """A parent of a requirement; `anchor` is empty where the parent has no section."""

    id: str
    title: str
    anchor: str


@dataclass(frozen=True, slots=True)
class Latency:
    """The latency of the response; `waits` are the longest waits, one for each answer."""

    answered: int
    at_once: int
    answers: str
    median: str
    longest: str
    longest_s: float
    is_bounded: bool
    bound: str
    waits: tuple[str, ...]
    median_s: float


@dataclass(frozen=True, slots=True)
class ViolationView:
    """A stretch of ticks that violates the requirement; `values` are `(signal, value)`."""

    start: str
    end: str
    ticks: str
    trigger: str
    deadline: str
    missing: str
    values: tuple[tuple[str, str], ...]
    causes: tuple[str, ...]
    """Why the response was not as demanded; empty where the evidence leaves it open."""


@dataclass(frozen=True, slots=True)
class ThresholdView:
    """A comparison with a constant, and the margin of the signal."""

    proposition: str
    comparison: str
    values: str
    margin: str
    nearest: str


@dataclass(frozen=True, slots=True)
class Listing:
    """The first of many lines, and how many there are in all."""

    lines: tuple[str, ...]
    total: int


@dataclass(frozen=True, slots=True)
class ResultRow:
    """The result of one run in numbers; `fretc.report.sections.details` reads the rest of it."""

    place: int
    """Of the result in the evidence, from 0."""
    number: int
    """Among those of its requirement, from 1."""
    requirement: str
    """The anchor of its requirement."""
    run: str
    run_label: str
    run_file: str
    mark: Mark
    suspicions: tuple[str, ...]
    reason: str
    triggers: int
    answers: int
    at_once: int
    """Of the answers, those at the tick of their trigger."""
    open: int
    violations_total: int
    latency_median_s: float | None
    latency_max_s: float | None

    @property
    def anchor(self) -> str:
        """Its own."""
        return result_anchor(self.requirement, self.number)


def result_anchor(requirement: str, number: int) -> str:
    """The anchor of a result of a requirement, by the anchor of that; numbered from 1."""
    return f"{requirement.replace('req-', 'result-', 1)}.{number}"


@dataclass(frozen=True, slots=True)
class ResultView:
    """The result of one run; with suspicions it is evidence of something else."""

    anchor: str
    run: str
    run_label: str
    run_file: str
    mark: Mark
    suspicions: tuple[str, ...]
    reason: str
    triggers: int
    exercised: str
    latency: Latency | None
    thresholds: tuple[ThresholdView, ...]
    violations: tuple[ViolationView, ...]
    violations_total: int
    open: Listing
    unknown: Listing
    timelines: tuple[Timeline, ...]


@dataclass(frozen=True, slots=True)
class BoundsView:
    """An interval of a probability; `name` is its method."""

    name: str
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class ProbabilityView:
    """The answer of all runs about a probability; `text` is its picture in words."""

    mark: Mark
    suspicions: tuple[str, ...]
    """Why the answer does not count; empty where it counts."""
    stated: str
    bound: float
    reason: str
    lines: tuple[str, ...]
    estimate: float | None
    bars: tuple[BoundsView, ...]
    text: str


@dataclass(frozen=True, slots=True)
class RequirementView:
    """The section of one requirement."""

    id: str
    anchor: str
    title: str
    mark: Mark
    suspicions: tuple[str, ...]
    """Why its verdict is not current; empty where it is."""
    status: str
    source: str
    text: str
    sentence: str
    canonical: str
    fingerprint: str
    meaning: str
    error: Remark | None
    diagram: str
    """The picture of its meaning in words; empty where there is none."""
    formulas: tuple[Formula, ...]
    propositions: tuple[PropositionView, ...]
    clock: str
    parents: tuple[Parent, ...]
    rationale: str
    params: Mapping[str, str]
    planned: tuple[Planned, ...]
    artefacts: tuple[Product, ...]
    proofs: tuple[ProofView, ...]
    exercise: str
    """How often all runs together have triggered it, in words."""
    histograms: tuple[Histogram, ...]
    """Empty until `fretc.report.sections.details` reads them, for a form that has them."""
    probability: ProbabilityView | None
    """None where the sentence has no probability, or the evidence has no estimation."""
    results: tuple[ResultRow, ...]
    """Of all runs, in rows; the JSON form has each in full, as a `ResultView`."""
    reasons: tuple[str, ...]
    """Why it is not shown; empty where it is."""
    limit: str
    """Why no run can violate it, in one sentence; empty where one can."""
    coverage: str
    """How far along the chain it is; one of `fretc.report.model.assessments.COVERAGE`."""
    situations: SituationsView | None
    """None where no run has been audited."""
    review: ReviewView
    waiver: WaiverView | None

    @property
    def name(self) -> str:
        """As a person calls it: `No contact (R14)`."""
        return named(self.id, self.title)


def worst_first(views: Iterable[RequirementView]) -> list[RequirementView]:
    """The views sorted by verdict; views of one verdict keep their order."""
    return sorted(views, key=lambda view: view.mark.severity)


# 5: the means ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Command:
    """A command to reproduce a part of the report."""

    purpose: str
    text: str


@dataclass(frozen=True, slots=True)
class Hash:
    """A line of the manifest."""

    kind: str
    name: str
    sha256: str


REALIZABLE, UNREALIZABLE = "can be kept together", "cannot be kept together"


# All requirements together ------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class PlayLane:
    """A variable in a play; `role` is empty where it is not one variable's."""

    name: str
    role: str
    values: tuple[str, ...]
    """One for each column: `0` and `1` are truth values."""


@dataclass(frozen=True, slots=True)
class Play:
    """A run, tick by tick; equal ticks in a row share a column: `3..7`."""

    ticks: tuple[str, ...]
    lanes: tuple[PlayLane, ...]
    loop: int | None
    """The column to which the last one leads back for ever; None: the play ends in a breach."""


@dataclass(frozen=True, slots=True)
class SetMember:
    """A requirement as it was analyzed; `anchor` is empty where it is no more."""

    requirement: str
    anchor: str
    sentence: str


@dataclass(frozen=True, slots=True)
class SetComponent:
    """Requirements that share outputs, and whether they can be kept together."""

    mark: Mark
    members: tuple[SetMember, ...]
    outputs: tuple[str, ...]
    why: str


@dataclass(frozen=True, slots=True)
class SetConflict:
    """Requirements that cannot be kept together, or no longer after a run, and that run."""

    members: tuple[SetMember, ...]
    because: str
    play: Play


@dataclass(frozen=True, slots=True)
class SetAnalysis:
    """Can these requirements be kept together? What `fretc analyze` has found."""

    file: str
    fretc: str
    """The version that analyzed."""
    mark: Mark
    headline: str
    suspicions: tuple[str, ...]
    """Why it is not of the requirements as they are now; empty where it is."""
    left_out: tuple[str, ...]
    """Requirements in force that it says nothing of, since they have no formula."""
    components: tuple[SetComponent, ...]
    conflicts: tuple[SetConflict, ...]
    complete: bool
    """Whether these are all minimal conflicts."""
    clashes: tuple[SetConflict, ...]
    """Real-time inconsistencies."""
    remarks: tuple[str, ...]
    """What is redundant, never triggered, kept by every run or by none."""
    assumptions: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    terms: tuple[str, ...]
    """What all of it rests on."""
    open: tuple[str, ...]
    """Questions without an answer, and why."""

    @property
    def is_good(self) -> bool:
        """Whether all requirements in force, as they are now, can be kept together."""
        return self.mark.word == REALIZABLE and not self.mark.suspect and not self.left_out

    @property
    def is_broken(self) -> bool:
        """Whether they cannot."""
        return self.mark.word == UNREALIZABLE


@dataclass(frozen=True, slots=True)
class Report:
    """The whole report."""

    schema: str
    fretc: str
    project: str
    components: tuple[str, ...]
    evidence: str
    audited_by: str
    overall: Overall
    front: Front
    runs: tuple[RunSummary, ...]
    """Runs with errors first; the JSON form has each with its topics, as a `RunView`."""
    claims: str
    counts: tuple[Count, ...]
    not_shown: tuple[NotShown, ...]
    reservations: tuple[str, ...]
    planned: tuple[Planned, ...]
    proofs: tuple[ProofView, ...]
    """Proofs about the interceptor and the agent, which no single requirement has."""
    verification: str
    """The file with all proofs; empty where there is none."""
    remarks: tuple[Remark, ...]
    hazards: tuple[HazardView, ...]
    matrix: tuple[Row, ...]
    orphans: Orphans
    reviewed: str
    """The number of reviews, and whether they stand, in sentences."""
    changes: tuple[Change, ...]
    withdrawn: tuple[Withdrawal, ...]
    """Requirements that were reviewed and are claimed no more."""
    waivers: tuple[WaiverView, ...]
    signatures: Signatures
    requirements: tuple[RequirementView, ...]
    assumptions: tuple[str, ...]
    commands: tuple[Command, ...]
    manifest: tuple[Hash, ...]
    across: Across
    """With pictures of some requirements, the worst; the JSON form has those of all."""
    """All runs in one picture each: their violations, and what they used of the bounds."""
    change_groups: tuple[ChangeGroup, ...]
    """Each change since the review once, with the requirements that it touches."""
    analysis: SetAnalysis | None
    """Whether all requirements can be kept together; None: nobody has asked."""
