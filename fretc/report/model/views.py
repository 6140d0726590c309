"""The views of the parts of the report, which templates and `--json` print.

The names of classes and fields are those of `report.schema.json`. No view contains markup. Times
are seconds from the first tick of a run, ticks count from 0, intervals include both ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from fretc.report.model.changes import ChangeGroup, RequirementChanges
from fretc.report.model.front import Front
from fretc.report.model.marks import Mark
from fretc.report.model.pictures import Across, Histogram
from fretc.report.model.results import ProbabilityView, ResultRow
from fretc.report.model.sets import SetAnalysis
from fretc.traceability.artefacts import Product
from fretish.classes.frozen import dataclass
from fretish.documents import named

SCHEMA = "fretc-report-1"


@dataclass(frozen=True, slots=True)
class Remark:
    """A diagnostic; `place` is `file:line:column`, or ""."""

    code: str
    severity: str
    message: str
    place: str = ""
    help: str = ""
    accepted: str = ""
    """The reason why the project accepts the diagnostic, or ""."""


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
class MarkCount:
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
    """`7/11`; "" if situations were not measured."""
    text: str
    """`7 of 11 situations seen`."""
    perhaps: tuple[str, ...]
    """Situations that were perhaps seen, in words."""
    never: tuple[str, ...]
    """Situations that were not seen, in words."""


@dataclass(frozen=True, slots=True)
class HazardRequirement:
    """A requirement and a hazard above it; `hazard` is "" if there is none."""

    hazard: str
    hazard_title: str
    via: str
    requirement: str
    title: str
    status: str
    anchor: str
    mark: Mark
    runs: int
    """Number of runs with the verdict (if waived: with the verdict behind the waiver)."""
    limit: str
    """The reason why no run can violate the requirement, or ""."""
    proof: Mark | None
    """Mark of a proof of the closed loop or of the monitor, or None."""
    review: Mark
    situations: SituationsView | None
    """None if no run was audited."""


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
    """The missing links of the chain from hazard to verdict, in words."""

    hazards: tuple[str, ...]
    requirements: tuple[str, ...]
    parents: tuple[str, ...]
    evidence: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Withdrawal:
    """A reviewed requirement that is no longer in force; `text` is the explanation."""

    requirement: str
    text: str


@dataclass(frozen=True, slots=True)
class SignatureView:
    """The state of a signature, and its signers."""

    mark: Mark
    text: str
    is_good: bool


@dataclass(frozen=True, slots=True)
class Signed:
    """A line of the table of signatures: a signable item, or an invalid signature."""

    kind: str
    name: str
    anchor: str
    signature: SignatureView


@dataclass(frozen=True, slots=True)
class Signatures:
    """The table of signatures, and the trusted keys."""

    file: str
    """The list of signers; "" if there is none, so that no signature is valid."""
    signers: tuple[str, ...]
    signed: tuple[Signed, ...]


@dataclass(frozen=True, slots=True)
class ReviewView:
    """The review of a requirement, and whether it is still valid."""

    mark: Mark
    by: str
    comment: str
    changes: tuple[str, ...]
    signature: SignatureView | None
    """None if there is no review."""

    @property
    def text(self) -> str:
        """Both marks in words: `reviewed, unauthenticated`."""
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
    """The result of `fretc verify` for one claim, and the reasons why it is suspect."""

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
    """A formula, and the traces on which it is evaluated."""

    name: str
    over: str
    text: str


@dataclass(frozen=True, slots=True)
class SignalView:
    """A signal that a proposition reads."""

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
class ParentView:
    """A parent of a requirement; `anchor` is "" if the parent has no section."""

    id: str
    title: str
    anchor: str


@dataclass(frozen=True, slots=True)
class RequirementView:
    """The section of one requirement."""

    id: str
    anchor: str
    title: str
    mark: Mark
    suspicions: tuple[str, ...]
    """The reasons why the verdict is suspect."""
    status: str
    source: str
    text: str
    sentence: str
    canonical: str
    fingerprint: str
    meaning: str
    error: Remark | None
    diagram: str
    """The description of the diagram of its meaning; "" if there is none."""
    formulas: tuple[Formula, ...]
    propositions: tuple[PropositionView, ...]
    clock: str
    parents: tuple[ParentView, ...]
    rationale: str
    params: Mapping[str, str]
    planned: tuple[Planned, ...]
    artefacts: tuple[Product, ...]
    proofs: tuple[ProofView, ...]
    exercise: str
    """Number of triggers over all runs, in words."""
    histograms: tuple[Histogram, ...]
    """Empty until `fretc.report.sections.details` reads them, for formats that need them."""
    probability: ProbabilityView | None
    """None if the sentence has no probability, or the evidence has no estimate."""
    results: tuple[ResultRow, ...]
    """The results of all runs in rows; `--json` has each in full, as a `ResultView`."""
    reasons: tuple[str, ...]
    """Why the requirement is not shown; empty if it is."""
    limit: str
    """A sentence that says why no run can violate the requirement, or ""."""
    coverage: str
    """The last completed step; one of `fretc.report.model.assessments.COVERAGE`."""
    situations: SituationsView | None
    """None if no run was audited."""
    review: ReviewView
    waiver: WaiverView | None

    @property
    def name(self) -> str:
        """Title and id: `No contact (R14)`."""
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
    """A line of the table of hashes."""

    kind: str
    name: str
    sha256: str


@dataclass(frozen=True, slots=True)
class ReportView:
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
    """Runs with errors first; `--json` has each with its topics, as a `RunView`."""
    claims: str
    counts: tuple[MarkCount, ...]
    violated: tuple[NotShown, ...]
    not_shown: tuple[NotShown, ...]
    damaged: tuple[str, ...]
    """A sentence for each damaged run: what is wrong, and how many requirements it leaves open."""
    reservations: tuple[str, ...]
    planned: tuple[Planned, ...]
    proofs: tuple[ProofView, ...]
    """Proofs about the interceptor and the agent."""
    verification: str
    """The file with all proofs, or ""."""
    remarks: tuple[Remark, ...]
    hazards: tuple[HazardView, ...]
    matrix: tuple[HazardRequirement, ...]
    orphans: Orphans
    reviewed: str
    """Sentences with the number of reviews and whether they are valid."""
    changes: tuple[RequirementChanges, ...]
    withdrawn: tuple[Withdrawal, ...]
    """Reviewed requirements that are no longer in force."""
    waivers: tuple[WaiverView, ...]
    signatures: Signatures
    requirements: tuple[RequirementView, ...]
    assumptions: tuple[str, ...]
    commands: tuple[Command, ...]
    manifest: tuple[Hash, ...]
    across: Across
    """Pictures over all runs, here of the worst requirements; `--json` has those of all."""
    change_groups: tuple[ChangeGroup, ...]
    """The distinct changes since the review, each with the affected requirements."""
    analysis: SetAnalysis | None
    """The analysis of all requirements; None if there is none."""
