"""`Assessment`: a requirement with audits, review and waiver, and the resulting verdict."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType

from compiler.formalization.formalized import FormalizedRequirement, without_probability
from compiler.logic.claims import Proof
from compiler.project.project import Project
from compiler.targets.python import monitor
from fretc.analysis.evidence import AnalyzedSet
from fretc.attestation.signatures import SignatureBook
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.result_summaries import EvidenceSource, ResultSummaries, ResultSummary
from fretc.audit.evidence.verdicts import (
    BROKEN,
    NOT_EXERCISED,
    RETIRED,
    SHOWN,
    SUSPECT,
    UNFORMALIZED,
    WAIVED,
    of_kind,
    severity,
)
from fretc.audit.measurements.trials import NO_TRIALS
from fretc.audit.project_inputs import all_verdict_inputs
from fretc.report.model.marks import Mark, verdict_mark
from fretc.report.model.suspicions import AboutResults, about_estimation, since_review
from fretc.traceability.artefacts import Product, monitors, products
from fretc.traceability.chain_builder import chains
from fretc.traceability.lock import Lock, ReviewStatus, review_statuses
from fretc.traceability.waivers import Waiver
from fretc.verification.reader import Proofs
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.documents import RequirementEntry
from monitors import kernel

UNBOUND, NOT_GENERATED = "unbound", "not generated"
EXERCISED_PASS, EXERCISED_FAIL = "exercised and shown", "exercised and violated"
EXERCISED_OPEN = "exercised, not decided"
COVERAGE = (
    UNFORMALIZED, UNBOUND, NOT_GENERATED, NOT_EXERCISED, EXERCISED_OPEN, EXERCISED_PASS,
    EXERCISED_FAIL, SUSPECT, WAIVED, RETIRED,
)  # fmt: skip
"""The steps from sentence to passing run; see `Assessment.coverage`."""


@dataclass(frozen=True, slots=True)
class NamedFiles:
    """The options of `fretc report` that the other inputs do not tell, for the printed command."""

    requirements: str | None = None
    """The folder or the file of the requirements, as named; None: the folder of the first file."""
    hazards: str | None = None
    """The hazards, if they were named."""
    lock: str | None = None
    waivers: str | None = None
    signers: str | None = None
    ajpf: tuple[str, ...] = ()
    play: bool = False
    """Whether the page includes the page of `fretc play`."""


@dataclass(frozen=True, slots=True)
class Inputs:
    """What a report is made from: a project, and the files about it."""

    project: Project
    """With or without errors; the report lists unformalized requirements."""
    path: str
    """The path of the evidence, which need not exist."""
    evidence: EvidenceSource | None
    """None if no run was audited."""
    lock: Lock | None
    """None if no requirement is reviewed."""
    waivers: Mapping[str, Waiver]
    """Requirement → waiver, for waivers that are valid today."""
    verification: Proofs | None
    """The file of `fretc verify`; None if nothing was verified."""
    proofs: Sequence[Proof]
    """The proofs of that file, and the results of AJPF."""
    book: SignatureBook
    """The checked signatures."""
    together: AnalyzedSet | None
    """The file of `fretc analyze`; None if there is none."""
    named: NamedFiles = NamedFiles()


@dataclass(frozen=True, slots=True)
class SingleAudit:
    """The result of one run, and the reasons why it is suspect."""

    result: ResultSummary
    suspicions: tuple[str, ...]
    mark: Mark
    """Verdict and currency."""
    place: int
    """Index of the result in the evidence."""

    @classmethod
    def of(
        cls,
        result: ResultSummary,
        suspicions: tuple[str, ...],
        place: int = 0,
        *,
        is_assumption: bool = False,
    ) -> SingleAudit:
        """The audit with its verdict; `violated` if the result lists a violation.

        Args:
            result: the result.
            suspicions: the reasons why it is suspect.
            place: its index in the evidence.
            is_assumption: whether the requirement is an assumption now, whatever it was at the
                audit.
        """
        violations = result.violations and result.trials is None
        word = kernel.VIOLATED if violations else result.verdict
        verdict = of_kind(word, is_assumption=is_assumption)
        return cls(result, suspicions, verdict_mark(verdict, suspect=bool(suspicions)), place)

    @property
    def verdict(self) -> str:
        """The word of the verdict."""
        return self.mark.word

    @property
    def is_stale(self) -> bool:
        """Whether the result is about another version."""
        return self.mark.suspect

    def since(self, review: tuple[str, ...]) -> SingleAudit:
        """The audit, with the reasons why it is suspect since a review.

        Args:
            review: what has changed since the review; "" if nothing has.
        """
        if not review or not self.mark.shows:
            return self
        return replace(self, suspicions=review, mark=verdict_mark(self.verdict, suspect=True))


@dataclass(frozen=True, slots=True)
class ProbabilityAudit:
    """The answer of all runs about a probability, and the reasons why it is suspect."""

    estimation: Estimated
    suspicions: tuple[str, ...]

    @property
    def mark(self) -> Mark:
        """Answer and currency."""
        return verdict_mark(self.estimation.answer, suspect=bool(self.suspicions))


@dataclass(frozen=True)
class Assessment:
    """One requirement and all inputs of its verdict."""

    entry: RequirementEntry
    anchor: str
    requirement: FormalizedRequirement | None
    diagnostic: Diagnostic | None
    """Why the requirement is not formalized; None if it is."""
    audits: tuple[SingleAudit, ...]
    """The audit of each run, without regard to the review."""
    products: tuple[Product, ...]
    review_status: ReviewStatus
    waiver: Waiver | None
    """The waiver that is valid today."""
    is_bound: bool
    probability: ProbabilityAudit | None = None
    """The answer over all runs, if the sentence has a probability; it replaces their verdicts."""

    @property
    def id(self) -> str:
        """The requirement's id."""
        return self.entry.id

    @cached_property
    def reviewed_audits(self) -> tuple[SingleAudit, ...]:
        """The audits, suspect if what they depend on has changed since the review."""
        review = () if self.review_status.needs_only_analysis else since_review(self.review_status)
        return tuple(audit.since(review) for audit in self.audits) if review else self.audits

    @property
    def verdict(self) -> str:
        """`waived` if a waiver covers the verdict; otherwise the verdict."""
        return WAIVED if self._is_waived else self.unwaived

    @cached_property
    def unwaived(self) -> str:
        """The verdict without regard to a waiver: the worst of the runs, or why there is no run."""
        if self.entry.status == RETIRED:
            return RETIRED
        words = [word for word, _ in self._verdicts] or [NOT_EXERCISED]
        unformalized = [] if self.requirement is not None else [UNFORMALIZED]
        return min([*words, *unformalized], key=severity)

    @cached_property
    def suspicions(self) -> tuple[str, ...]:
        """The reasons why the verdict is not about the present, reviewed requirement.

        A violation is current if one violating run is current. Any other verdict is suspect if one
        of its runs or the review is suspect.
        """
        word = self.unwaived
        if word == RETIRED:
            return ()
        reasons = [why for other, why in self._verdicts if word not in BROKEN or other == word]
        if word in BROKEN and not all(reasons):
            return ()
        distinct = tuple(dict.fromkeys(reason for why in reasons for reason in why))
        return distinct or since_review(self.review_status)

    @property
    def is_shown(self) -> bool:
        """Whether current evidence shows that the requirement holds."""
        return self.mark.shows

    @property
    def is_broken(self) -> bool:
        """Whether the evidence shows a violation that no waiver covers."""
        return self.verdict in BROKEN

    @property
    def _is_waived(self) -> bool:
        return self.waiver is not None and self.unwaived == self.waiver.verdict

    @property
    def _verdicts(self) -> list[tuple[str, tuple[str, ...]]]:
        """The verdicts that determine the verdict of the requirement, with their suspicions."""
        runs = [(audit.verdict, audit.suspicions) for audit in self.audits]
        if self.probability is None:
            return runs
        answer = (self.probability.estimation.answer, self.probability.suspicions)
        has_probability = (
            self.requirement is not None and self.requirement.sentence.probability is not None
        )
        return [answer] if has_probability else [*runs, answer]

    @property
    def coverage(self) -> str:
        """The last completed step from sentence to passing run: one of `COVERAGE`."""
        verdict = self.verdict
        if verdict in (RETIRED, WAIVED, UNFORMALIZED):
            return verdict
        if verdict in BROKEN:
            return EXERCISED_FAIL
        if self.suspicions:
            return SUSPECT
        if not self.is_bound:
            return UNBOUND
        if (
            self.requirement is None
            or monitor.refuse(without_probability(self.requirement)) is not None
        ):
            return NOT_GENERATED
        if verdict in SHOWN:
            return EXERCISED_PASS
        triggered = any(audit.result.triggers for audit in self.audits)
        return EXERCISED_OPEN if triggered else NOT_EXERCISED

    @property
    def mark(self) -> Mark:
        """Verdict and currency."""
        return verdict_mark(WAIVED) if self._is_waived else self.unwaived_mark

    @property
    def unwaived_mark(self) -> Mark:
        """Verdict and currency without regard to a waiver."""
        return verdict_mark(self.unwaived, suspect=bool(self.suspicions))


def assessments(
    project: Project,
    summaries: ResultSummaries | None,
    lock: Lock | None = None,
    waivers: Mapping[str, Waiver] = MappingProxyType({}),
    proofs: Sequence[Proof] = (),
    analyzed: AnalyzedSet | None = None,
) -> tuple[Assessment, ...]:
    """The assessment of each requirement of the project, in its order.

    Args:
        project: with or without errors.
        summaries: results of the evidence; None if no run was audited.
        lock: None if no requirement is reviewed.
        waivers: requirement → waiver, for waivers that are valid today.
        proofs: the results of verification.
        analyzed: the file of `fretc analyze`; None if there is none.
    """
    requirements = {requirement.entry: requirement for requirement in project.formalized}
    diagnostics = {failed.requirement: failed.diagnostic for failed in project.failed}
    results = summaries.by_requirement if summaries else {}
    products_of = {id: products(requirement) for id, requirement in requirements.items()}
    inputs_of = all_verdict_inputs(project, monitors=monitors(products_of))
    all_chains = chains(project, summaries, products_of, proofs, inputs_of, analyzed)
    status_of_each = review_statuses(all_chains, lock)
    audited_by = summaries.source.fretc if summaries else ""
    anchors: list[str] = []
    assessed: list[Assessment] = []
    for entry, review_status in zip(project.requirements, status_of_each, strict=True):
        anchors.append(_anchor(entry.id, anchors))
        requirement = requirements.get(entry)
        verdict_inputs = inputs_of[entry]
        suspicions = AboutResults(verdict_inputs, audited_by, formalized=requirement is not None)
        audits = tuple(
            SingleAudit.of(result, suspicions.of(result), place, is_assumption=entry.is_assumption)
            for place, result in results.get(entry.id, ())
        )
        assessed.append(
            Assessment(
                entry,
                anchors[-1],
                requirement,
                diagnostics.get(entry),
                audits,
                products_of.get(entry, ()),
                review_status,
                waivers.get(entry.id),
                requirement is not None and _is_bound(requirement, project.declarations),
                _probability(entry.id, requirement, summaries, audits),
            )
        )
    return tuple(assessed)


def _probability(
    id: str,
    requirement: FormalizedRequirement | None,
    summaries: ResultSummaries | None,
    audits: Sequence[SingleAudit],
) -> ProbabilityAudit | None:
    estimations = summaries.source.probabilities if summaries is not None else ()
    estimation = next((one for one in estimations if one.requirement == id), None)
    if estimation is None:
        return None
    stale = [reason for audit in audits for reason in audit.suspicions]
    if requirement is None or requirement.sentence.probability is None:
        reasons = dict.fromkeys((*stale, "the sentence has no probability now"))
        return ProbabilityAudit(estimation, tuple(reasons))
    results = [audit.result for audit in audits]
    runs = [(result.content, result.intact, result.trials or NO_TRIALS) for result in results]
    suspicions = about_estimation(estimation, requirement.sentence.probability, runs)
    return ProbabilityAudit(estimation, tuple(dict.fromkeys((*stale, *suspicions))))


def _is_bound(requirement: FormalizedRequirement, declarations: Declarations | None) -> bool:
    propositions = declarations.propositions if declarations else {}
    return all(name in propositions for name in requirement.watched)


def _anchor(id: str, taken: Sequence[str]) -> str:
    """A unique anchor such as `req-R1`, of letters, digits, `-`, `_` and `.`."""
    plain = "".join(c if c.isascii() and (c.isalnum() or c in "-_.") else "-" for c in id)
    anchor, number = f"req-{plain}", 1
    while anchor in taken:
        number += 1
        anchor = f"req-{plain}--{number}"
    return anchor
