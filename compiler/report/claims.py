"""Each requirement with all that bears upon it, and the verdict that follows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

from compiler.basis import Basis, why
from compiler.estimates import Estimated
from compiler.evidence import Evidence, Result, by_requirement
from compiler.links import chains, outdated
from compiler.lock import Lock, Standing, standings
from compiler.odds import REFUTED, SUPPORTED
from compiler.plan import bases
from compiler.products import Product, products
from compiler.project import Project
from compiler.proven import Proof
from compiler.report.probabilities import ANSWERS, contradictions
from compiler.report.views import Mark
from compiler.rule import Rule
from compiler.targets import monitor
from compiler.trials import plain
from compiler.waivers import Waiver, idle
from fretish.declarations import Declarations
from fretish.diagnostic import Diagnostic
from fretish.documents import Requirement
from monitors import kernel
from monitors.trials import NO_TRIALS

SUSPECT = "suspect"
UNFORMALIZED = "unformalized"
NOT_EXERCISED = "not exercised"
RETIRED = "retired"
WAIVED = "waived"

MARKS: Mapping[str, Mark] = {
    kernel.VIOLATED: Mark(kernel.VIOLATED, "✘", "violated"),
    REFUTED: ANSWERS[REFUTED],
    UNFORMALIZED: Mark(UNFORMALIZED, "!", "unformalized"),
    SUSPECT: Mark(SUSPECT, "⚠", "suspect"),
    kernel.NO_DATA: Mark(kernel.NO_DATA, "?", "no-data"),
    kernel.INCONCLUSIVE: Mark(kernel.INCONCLUSIVE, "◔", "inconclusive"),
    kernel.VACUOUS: Mark(kernel.VACUOUS, "∅", "vacuous"),
    NOT_EXERCISED: Mark(NOT_EXERCISED, "○", "not-exercised"),
    WAIVED: Mark(WAIVED, "w", "waived"),
    SUPPORTED: ANSWERS[SUPPORTED],
    kernel.SATISFIED: Mark(kernel.SATISFIED, "✔", "satisfied"),
    RETIRED: Mark(RETIRED, "\N{EN DASH}", "retired"),
}
"""Every verdict of the report, the worst first: that of several runs is the worst of theirs."""

SHOWN = (kernel.SATISFIED, SUPPORTED)
"""The verdicts that show a requirement."""
UNBOUND, NOT_GENERATED = "unbound", "not generated"
EXERCISED_PASS, EXERCISED_FAIL = "exercised, pass", "exercised, fail"
EXERCISED_OPEN = "exercised, open"
COVERAGE = (
    UNFORMALIZED, UNBOUND, NOT_GENERATED, NOT_EXERCISED, EXERCISED_OPEN, EXERCISED_PASS,
    EXERCISED_FAIL, SUSPECT, WAIVED, RETIRED,
)  # fmt: skip
"""How far a requirement has come; the last three whatever else is known of it."""

_RANK = {word: rank for rank, word in enumerate(MARKS)}


@dataclass(frozen=True, slots=True)
class Judged:
    """A result of an audit, and why it does not count, if it does not."""

    result: Result
    suspicions: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """The audit's verdict, or that it is suspect."""
        return SUSPECT if self.suspicions else self.result.verdict

    @property
    def is_stale(self) -> bool:
        """Whether it is the evidence of something else."""
        return bool(self.suspicions)


@dataclass(frozen=True, slots=True)
class Together:
    """What all runs say of a probability, and why it does not count, if it does not."""

    told: Estimated
    suspicions: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Claim:
    """A requirement: formalized (`rule`) or not (`diagnostic`), and its audits."""

    requirement: Requirement
    anchor: str
    rule: Rule | None
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
    def verdict(self) -> str:
        """The worst of its runs, or what they say together, or why it has none.

        `waived` where a waiver covers that verdict.
        """
        found = self.unwaived
        return WAIVED if self.waiver and found == self.waiver.verdict else found

    @property
    def unwaived(self) -> str:
        """The verdict without regard to a waiver."""
        if self.requirement.status == RETIRED:
            return RETIRED
        if self.rule is None:
            return UNFORMALIZED
        verdicts = self._of_runs
        if self.standing.is_suspect:
            verdicts.append(SUSPECT)
        return min(verdicts, key=_RANK.__getitem__)

    @property
    def _of_runs(self) -> list[str]:
        """The verdicts of all runs; with a probability, the one of all together."""
        if self.together is not None:
            return [SUSPECT if self.together.suspicions else self.together.told.answer]
        return [judged.verdict for judged in self.judged] or [NOT_EXERCISED]

    @property
    def coverage(self) -> str:
        """How far along the chain from sentence to passing run it is: one of `COVERAGE`."""
        verdict = self.verdict
        if verdict in (RETIRED, WAIVED, UNFORMALIZED, SUSPECT):
            return verdict
        if verdict in (kernel.VIOLATED, REFUTED):
            return EXERCISED_FAIL
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
        """Its verdict as it is shown."""
        return MARKS[self.verdict]


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
        judge = _Judge(rests_on[id(requirement)], evidence)
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
                _together(rule, evidence, judged),
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
    rule: Rule | None, evidence: Evidence | None, judged: Sequence[Judged]
) -> Together | None:
    if rule is None or evidence is None or rule.sentence.probability is None:
        return None
    told = next((one for one in evidence.probabilities if one.requirement == rule.id), None)
    if told is None:
        return None
    runs = [(j.result.content, j.result.health.intact, j.result.trials) for j in judged]
    known = [(content, intact, trials or NO_TRIALS) for content, intact, trials in runs]
    stale = [reason for each in judged for reason in each.suspicions]
    wrong = contradictions(told, rule.sentence.probability, known)
    return Together(told, tuple(dict.fromkeys((*stale, *wrong))))


def _is_bound(rule: Rule, declarations: Declarations | None) -> bool:
    known = declarations.propositions if declarations else {}
    return all(name in known for name in rule.watched)


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

    def __init__(self, now: Basis, evidence: Evidence | None) -> None:
        self._now, self._audited_by = now, evidence.fretc if evidence else ""

    def suspicions(self, result: Result) -> list[str]:
        """Why a result does not count; empty where it does."""
        reasons = [why(kind) for kind in outdated(result, self._audited_by, self._now)]
        if result.verdict in (kernel.SATISFIED, kernel.VACUOUS) and not result.health.intact:
            reasons.append("the log is damaged, and a damaged log cannot show this")
        if result.verdict == kernel.SATISFIED and result.violations:
            reasons.append("the evidence contradicts itself: it lists violations")
        return reasons
