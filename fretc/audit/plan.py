"""What every log of an audit is judged by, as values that can be sent to any process or machine."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from functools import lru_cache, partial

from compiler.files.edition import edition
from compiler.formalization.binding_agreement import unbound
from compiler.formalization.formalized import Formalized
from compiler.formalization.record import wording
from compiler.project.folder import Project
from compiler.targets.python import monitor as monitors
from fretc.audit.evidence.basis import Basis, basis
from fretc.audit.evidence.claim import Claim
from fretc.audit.evidence.schema import SCHEMA
from fretc.audit.expected_response import demand
from fretc.audit.measurements import confidence_intervals as odds
from fretc.audit.measurements.count_trials import chance, trials
from fretc.audit.one_log import Watched
from fretc.logs.signals.integrity import Integrity
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors
from fretish.documents import Requirement
from fretish.reading.recursion import deep
from monitors.loading import load


@dataclass(frozen=True, slots=True)
class Refused:
    """A requirement that no log can be judged by: it is never lost, and shown by nothing."""

    id: str
    sentence: str
    basis: Basis = field(compare=False)
    """As that of a claim; of the wording as it is, where that cannot be formalized."""
    why: tuple[Diagnostic, ...]


@dataclass(frozen=True, slots=True)
class Plan:
    """The claims and what their propositions mean; what an audit shows depends on nothing else."""

    claims: tuple[Claim, ...]
    declarations: Declarations = field(compare=False, repr=False)
    """Only the signals that the claims read: no log is judged by another one."""
    evaluation: str
    """How the monitors are run: a key of `fretc.audit.many_logs.EVALUATIONS`."""
    integrity: Integrity
    """What is looked at of a log."""
    key: str
    """SHA-256 of all of it to the letter that one log is judged by, and of the fretc that does."""
    confidence: float = odds.CONFIDENCE
    """Of what all logs together say of a probability."""
    refused: tuple[Refused, ...] = field(default=(), compare=False, repr=False)
    """The requirements in force that are not among the claims."""

    @property
    def named(self) -> tuple[Claim | Refused, ...]:
        """Every requirement in force: those that are judged, then those that cannot be."""
        return (*self.claims, *self.refused)

    @property
    def refusals(self) -> tuple[Diagnostic, ...]:
        """Everything that keeps a requirement from being judged."""
        return tuple(dict.fromkeys(reason for each in self.refused for reason in each.why))


def planned(
    project: Project,
    evaluation: str = "columns",
    integrity: Integrity = Integrity.HASH,
    confidence: float = odds.CONFIDENCE,
) -> Plan | tuple[Diagnostic, ...]:
    """The plan to audit every requirement that is not retired, or why there can be none.

    A requirement that cannot be judged is among the `refused` of the plan. There is a plan where
    at least one can be.

    Args:
        project: without errors but for those of single requirements.
        evaluation: how the monitors are run: `columns` or `online`; what they show is the same.
        integrity: what is looked at of a log beyond the messages in question.
        confidence: of what is said of a probability, between 0.5 and 1.
    """
    declarations = project.declarations
    refused = refusals(project)
    reasons = {id(requirement) for requirement, _ in refused}
    rules = [rule for rule in _in_force(project) if id(rule.requirement) not in reasons]
    wrong = tuple(dict.fromkeys(reason for _, why in refused for reason in why))
    if declarations is None or not rules:
        return wrong or (Diagnostic(Code.NOTHING_TO_DO, "there is no requirement to audit"),)
    known = bases(project)
    claims = tuple(_claim(rule, known[id(rule.requirement)]) for rule in rules)
    left = tuple(_left(known, requirement, why) for requirement, why in refused)
    read = declarations.reading(name for rule in rules for name in rule.watched)
    key = _key(claims, left, read, evaluation, integrity)
    one_each = tuple({each.id: each for each in reversed(left)}.values())[::-1]
    return Plan(claims, read, evaluation, integrity, key, confidence, one_each)


def bases(project: Project) -> Mapping[int, Basis]:
    """What a verdict on each requirement rests on, by its `id()`: those in force and all others."""
    declarations = project.declarations
    refused = {id(requirement) for requirement, _ in refusals(project)}
    read = [rule for rule in _in_force(project) if id(rule.requirement) not in refused]
    topics: set[str] = set()
    if declarations is not None:
        used = declarations.reading(name for rule in read for name in rule.watched)
        topics = {signal.path.topic for signal in used.signals.values()}
    rules = {id(rule.requirement): rule for rule in project.rules}
    return {
        id(each): basis(each, rules.get(id(each)), declarations, topics)
        for each in project.requirements
    }


def refusals(project: Project) -> tuple[tuple[Requirement, tuple[Diagnostic, ...]], ...]:
    """Every requirement in force that an audit cannot judge, and why: errors, in their order.

    A mistake in the table of a signal or a proposition is one of those that read it. Any other
    mistake in the bindings is no fault of a requirement.
    """
    rules = _in_force(project)
    own = {id(rule.requirement): rule for rule in rules}
    failed = {id(each.requirement): each.diagnostic for each in project.failed}
    unusable = _unusable(project, rules[0]) if rules and not has_errors(project.general) else None
    found = []
    for requirement in project.requirements:
        rule = own.get(id(requirement))
        why = [failed.get(id(requirement)) or project.mistaken.get(id(requirement))]
        if rule is not None and unusable is not None:
            why.append(unusable)
        elif rule is not None and project.declarations is not None:
            why.extend(_not_auditable(rule, project.declarations))
        errors = (reason for reason in why if reason is not None and reason.is_error)
        reasons = tuple(dict.fromkeys(errors))
        if reasons and requirement.status != "retired":
            found.append((requirement, reasons))
    return tuple(found)


def _in_force(project: Project) -> list[Formalized]:
    return [rule for rule in project.rules if rule.requirement.status != "retired"]


def _left(
    known: Mapping[int, Basis], requirement: Requirement, why: tuple[Diagnostic, ...]
) -> Refused:
    return Refused(requirement.id, wording(requirement), known[id(requirement)], why)


def _claim(rule: Formalized, rests_on: Basis) -> Claim:
    return Claim(
        rule.id,
        wording(rule.requirement),
        rests_on,
        monitors.text(rule),
        demand(rule),
        chance(rule),
    )


@deep
def _key(
    claims: Sequence[Claim],
    refused: Sequence[Refused],
    declarations: Declarations,
    evaluation: str,
    integrity: Integrity,
) -> str:
    """The bindings count with their places too: findings tell lines of them."""
    digest = hashlib.sha256(pickle.dumps(declarations, protocol=5))
    texts = [(c.id, c.sentence, dict(c.basis), c.monitor, astuple(c.demand)) for c in claims]
    left = [(r.id, r.sentence, dict(r.basis), [d.message for d in r.why]) for r in refused]
    told = [SCHEMA, edition(), evaluation, integrity, texts, left]
    digest.update(json.dumps(told).encode())
    return digest.hexdigest()


@deep
def packed(plan: Plan) -> bytes:
    """The plan as bytes, for a process that trusts this one."""
    return pickle.dumps(plan, protocol=5)


@deep
def unpacked(data: bytes) -> Plan:
    """The plan again."""
    plan = pickle.loads(data)
    assert isinstance(plan, Plan)
    return plan


@lru_cache(maxsize=4)
def watched(plan: Plan) -> tuple[Watched, ...]:
    """The monitors of the claims, in their order: loaded once in each process."""
    return tuple(
        Watched(
            load(f"{claim.id}_monitor", claim.monitor),
            claim.basis,
            claim.demand,
            partial(trials, claim.chance.obligation) if claim.chance else None,
            claim.chance.obligation.atoms if claim.chance else (),
        )
        for claim in plan.claims
    )


def _unusable(project: Project, first: Formalized) -> Diagnostic | None:
    """Why the bindings cannot be used for any requirement, said once; None where they can."""
    declarations = project.declarations
    if declarations is None:
        return Diagnostic(
            Code.UNBOUND,
            "no bindings say what the propositions mean in the messages",
            first.requirement.wording,
            help="write `bindings.toml` beside the requirements, or name it with `--bindings`",
        )
    if not declarations.clock.declared:
        return Diagnostic(
            Code.NO_CLOCK,
            f"`{declarations.source.name}` declares no clock",
            declarations.source.span(0, 0),
            help='add `[clock]` with `tick = "100 ms"`',
        )
    return None


def _not_auditable(rule: Formalized, declarations: Declarations) -> tuple[Diagnostic, ...]:
    """Why no log can be judged by a rule; empty where one can."""
    refused = monitors.refuse(replace(rule, pctl=None))
    return (*([refused] if refused else []), *unbound(rule, declarations))
