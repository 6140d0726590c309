"""Each requirement with all that bears upon it, and the verdict that follows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

from compiler.formalization.formalized import Formalized, plain
from compiler.logic.claims import Proof
from compiler.project.folder import Project
from compiler.targets.python import monitor
from fretc.audit.bases import bases
from fretc.audit.evidence.basis import Basis, why
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.reader import by_requirement
from fretc.audit.evidence.schema import Evidence, Result
from fretc.audit.evidence.verdicts import (
    BROKEN,
    NOT_EXERCISED,
    RETIRED,
    SHOWN,
    SUSPECT,
    UNFORMALIZED,
    WAIVED,
    severity,
)
from fretc.audit.measurements.trials import NO_TRIALS
from fretc.report.model import phrases
from fretc.report.model.probabilities import contradictions
from fretc.report.model.views import Mark, verdict_mark
from fretc.report.traceability.artefacts import Product, products
from fretc.report.traceability.chain import Node, chains, outdated
from fretc.report.traceability.lock import Lock, Standing, standings
from fretc.report.traceability.waivers import Waiver, idle
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.documents import Requirement
from monitors import kernel

UNBOUND, NOT_GENERATED = "unbound", "not generated"
EXERCISED_PASS, EXERCISED_FAIL = "exercised, pass", "exercised, fail"
EXERCISED_OPEN = "exercised, open"
COVERAGE = (
    UNFORMALIZED, UNBOUND, NOT_GENERATED, NOT_EXERCISED, EXERCISED_OPEN, EXERCISED_PASS,
    EXERCISED_FAIL, SUSPECT, WAIVED, RETIRED,
)  # fmt: skip
"""How far a requirement has come; the last three whatever else is known of it."""


@dataclass(frozen=True, slots=True)
class Judged:
    """A result of an audit, and why it does not count, if it does not."""

    result: Result
    suspicions: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """The audit's verdict; a violation that is listed is one, whatever the word says."""
        broken = self.result.violations and self.result.trials is None
        return kernel.VIOLATED if broken else self.result.verdict

    @property
    def is_stale(self) -> bool:
        """Whether it is the evidence of something else."""
        return bool(self.suspicions)

    @property
    def mark(self) -> Mark:
        """Its verdict and its currency as they are shown."""
        return verdict_mark(self.verdict, suspect=self.is_stale)

    def seen(self, standing: Standing) -> Judged:
        """The same as one sees it beside a review: no run shows what is not as it was accepted."""
        doubts = since_review(standing) if self.mark.shows else ()
        return replace(self, suspicions=doubts) if doubts else self


@dataclass(frozen=True, slots=True)
class Together:
    """What all runs say of a probability, and why it does not count, if it does not."""

    told: Estimated
    suspicions: tuple[str, ...]

    @property
    def mark(self) -> Mark:
        """The answer and its currency as they are shown."""
        return verdict_mark(self.told.answer, suspect=bool(self.suspicions))


@dataclass(frozen=True, slots=True)
class Claim:
    """A requirement: formalized (`rule`) or not (`diagnostic`), and its audits."""

    requirement: Requirement
    anchor: str
    rule: Formalized | None
    diagnostic: Diagnostic | None
    judged: tuple[Judged, ...]
    products: tuple[Product, ...]
    standing: Standing
    waiver: Waiver | None
    """One that counts now."""
    is_bound: bool
    together: Together | None = None
    """With a probability: what all runs say, in place of the verdicts of each."""

    @property
    def id(self) -> str:
        """The requirement's id."""
        return self.requirement.id

    @property
    def results(self) -> tuple[Judged, ...]:
        """What each run shows, beside the review."""
        return tuple(judged.seen(self.standing) for judged in self.judged)

    @property
    def verdict(self) -> str:
        """The worst of its runs, or what they say together, or why it has none.

        `waived` where a waiver covers that verdict.
        """
        return WAIVED if self._is_waived else self.unwaived

    @property
    def unwaived(self) -> str:
        """The verdict without regard to a waiver."""
        if self.requirement.status == RETIRED:
            return RETIRED
        found = [word for word, _ in self._findings] or [NOT_EXERCISED]
        unformalized = [] if self.rule is not None else [UNFORMALIZED]
        return min([*found, *unformalized], key=severity)

    @property
    def suspicions(self) -> tuple[str, ...]:
        """Why its verdict is not that of the requirement as it is now and as it was accepted.

        Of runs that violate it one that is current is enough: a violation is shown by any. What
        all runs show together is suspect where one of them is, or where the review is.
        """
        word = self.unwaived
        if word == RETIRED:
            return ()
        known = [why for found, why in self._findings if word not in BROKEN or found == word]
        if word in BROKEN and not all(known):
            return ()
        found = tuple(dict.fromkeys(reason for why in known for reason in why))
        return found or since_review(self.standing)

    @property
    def is_shown(self) -> bool:
        """Whether the evidence shows that the requirement holds, as it is now."""
        return self.mark.shows

    @property
    def is_broken(self) -> bool:
        """Whether the evidence shows that it does not hold, and no waiver covers that."""
        return self.verdict in BROKEN

    @property
    def _is_waived(self) -> bool:
        return self.waiver is not None and self.unwaived == self.waiver.verdict

    @property
    def _findings(self) -> list[tuple[str, tuple[str, ...]]]:
        """The verdicts of all runs with their suspicions; with a probability, that of all."""
        runs = [(judged.verdict, judged.suspicions) for judged in self.judged]
        if self.together is None:
            return runs
        answer = (self.together.told.answer, self.together.suspicions)
        is_chance = self.rule is not None and self.rule.sentence.probability is not None
        return [answer] if is_chance else [*runs, answer]

    @property
    def coverage(self) -> str:
        """How far along the chain from sentence to passing run it is: one of `COVERAGE`."""
        verdict = self.verdict
        if verdict in (RETIRED, WAIVED, UNFORMALIZED):
            return verdict
        if verdict in BROKEN:
            return EXERCISED_FAIL
        if self.suspicions:
            return SUSPECT
        if not self.is_bound:
            return UNBOUND
        if self.rule is None or monitor.refuse(plain(self.rule)) is not None:
            return NOT_GENERATED
        if verdict in SHOWN:
            return EXERCISED_PASS
        triggered = any(judged.result.triggers for judged in self.judged)
        return EXERCISED_OPEN if triggered else NOT_EXERCISED

    @property
    def mark(self) -> Mark:
        """Its verdict and its currency as they are shown."""
        return verdict_mark(WAIVED) if self._is_waived else self.unwaived_mark

    @property
    def unwaived_mark(self) -> Mark:
        """The same without regard to a waiver."""
        return verdict_mark(self.unwaived, suspect=bool(self.suspicions))


def claims(
    project: Project,
    evidence: Evidence | None,
    lock: Lock | None = None,
    waivers: Mapping[str, Waiver] = MappingProxyType({}),
    proofs: Sequence[Proof] = (),
) -> tuple[Claim, ...]:
    """Every requirement of the project, in its order.

    Args:
        project: all that was read.
        evidence: None where no run has been audited.
        lock: None where nothing has been reviewed.
        waivers: those that count now, by the requirement.
        proofs: what verification has found.
    """
    rules = {id(rule.requirement): rule for rule in project.rules}
    failed = {id(each.requirement): each.diagnostic for each in project.failed}
    results = by_requirement(evidence)
    rests_on = bases(project)
    made = {id: products(rule) for id, rule in rules.items()}
    standing = standings(chains(project, evidence, made, proofs), lock)
    anchors: list[str] = []
    found = []
    for requirement, stands in zip(project.requirements, standing, strict=True):
        anchors.append(_anchor(requirement.id, anchors))
        rule = rules.get(id(requirement))
        judge = _Judge(rule, rests_on[id(requirement)], evidence)
        mine = results.get(requirement.id, ())
        judged = tuple(Judged(result, tuple(judge.suspicions(result))) for result in mine)
        found.append(
            Claim(
                requirement,
                anchors[-1],
                rule,
                failed.get(id(requirement)),
                judged,
                made.get(id(requirement), ()),
                stands,
                waivers.get(requirement.id),
                rule is not None and _is_bound(rule, project.declarations),
                _together(requirement.id, rule, evidence, judged),
            )
        )
    return tuple(found)


def idle_waivers(claims: Sequence[Claim]) -> tuple[Diagnostic, ...]:
    """F543 for each waiver of another verdict than the one that is there."""
    return tuple(
        idle(claim.waiver, claim.verdict)
        for claim in claims
        if claim.waiver is not None and claim.verdict != WAIVED
    )


def _together(
    id: str, rule: Formalized | None, evidence: Evidence | None, judged: Sequence[Judged]
) -> Together | None:
    answers = evidence.probabilities if evidence is not None else ()
    told = next((one for one in answers if one.requirement == id), None)
    if told is None:
        return None
    stale = [reason for each in judged for reason in each.suspicions]
    if rule is None or rule.sentence.probability is None:
        return Together(told, (*dict.fromkeys(stale), "the sentence gives no probability now"))
    runs = [(j.result.content, j.result.health.intact, j.result.trials) for j in judged]
    known = [(content, intact, trials or NO_TRIALS) for content, intact, trials in runs]
    wrong = contradictions(told, rule.sentence.probability, known)
    return Together(told, tuple(dict.fromkeys((*stale, *wrong))))


def _is_bound(rule: Formalized, declarations: Declarations | None) -> bool:
    known = declarations.propositions if declarations else {}
    return all(name in known for name in rule.watched)


def since_review(standing: Standing) -> tuple[str, ...]:
    """What has changed since its review, in one phrase; empty where the review stands."""
    if standing.review is None or not standing.is_suspect:
        return ()
    causes = dict.fromkeys(cause for suspect in standing.suspects for cause in suspect.causes)
    told = phrases.some([thing(cause) for cause in causes])
    return (f"{told} changed since the review of {standing.review.date}",)


def thing(node: Node) -> str:
    """A thing of the chain as a reader calls it."""
    return "the clock" if node.kind == "clock" else f"{node.kind} {phrases.place(node.name)}"


def _anchor(id: str, taken: Sequence[str]) -> str:
    """`req-R1`: letters, digits, `-`, `_` and `.` only, and different from all others."""
    plain = "".join(c if c.isascii() and (c.isalnum() or c in "-_.") else "-" for c in id)
    anchor, number = f"req-{plain}", 1
    while anchor in taken:
        number += 1
        anchor = f"req-{plain}--{number}"
    return anchor


class _Judge:
    """Compares evidence with what its verdict would rest on now."""

    def __init__(self, rule: Formalized | None, now: Basis, evidence: Evidence | None) -> None:
        self._is_formal, self._now = rule is not None, now
        self._audited_by = evidence.fretc if evidence else ""

    def suspicions(self, result: Result) -> list[str]:
        """Why a result does not count; empty where it does."""
        reasons = ["the sentence cannot be formalized now"]
        if self._is_formal:
            reasons = [why(kind) for kind in outdated(result, self._audited_by, self._now)]
        if result.verdict in (kernel.SATISFIED, kernel.VACUOUS) and not result.health.intact:
            reasons.append("the log is damaged, and a damaged log cannot show this")
        if result.verdict == kernel.SATISFIED and result.violations:
            reasons.append("the evidence contradicts itself: it lists violations")
        return reasons
