"""What every log of an audit is judged by, as values that can be sent to any process or machine."""

from __future__ import annotations

import hashlib
import json
import pickle
from collections.abc import Sequence
from dataclasses import astuple, dataclass, field, replace
from functools import lru_cache, partial

from compiler import odds
from compiler.edition import edition
from compiler.files import sha256
from compiler.missing import demand
from compiler.pipeline import unbound
from compiler.project import Project, fingerprint
from compiler.record import wording
from compiler.rule import Rule
from compiler.targets import monitor as monitors
from compiler.trials import Chance, chance, trials
from fretish.declarations import Declarations
from fretish.depth import deep
from fretish.diagnostic import Code, Diagnostic
from monitors.audit import Watched
from monitors.evidence import SCHEMA
from monitors.integrity import Integrity
from monitors.loading import load
from monitors.violations import Demand


@dataclass(frozen=True, slots=True)
class Claim:
    """A requirement, and the text of its monitor."""

    id: str
    sentence: str
    sha256: str
    """Of the canonical wording."""
    monitor: str
    demand: Demand
    """What is missing where it is violated."""
    chance: Chance | None = None
    """With a probability: all runs together are judged, and no run alone."""

    def hashes(self, bindings: str) -> dict[str, str]:
        """SHA-256 of all that a verdict on it is made from, but for the log."""
        return {"sentence": self.sha256, "bindings": bindings, "monitor": sha256(self.monitor)}


@dataclass(frozen=True, slots=True)
class Plan:
    """The claims and what their propositions mean; what an audit shows depends on nothing else."""

    claims: tuple[Claim, ...]
    declarations: Declarations = field(compare=False, repr=False)
    bindings: str
    """SHA-256 of what the bindings say; comments and order do not count."""
    evaluation: str
    """How the monitors are run: a key of `compiler.auditing.EVALUATIONS`."""
    integrity: Integrity
    """What is looked at of a log."""
    key: str
    """SHA-256 of all of it to the letter that one log is judged by, and of the fretc that does."""
    confidence: float = odds.CONFIDENCE
    """Of what all logs together say of a probability."""


def planned(
    project: Project,
    evaluation: str = "columns",
    integrity: Integrity = Integrity.HASH,
    confidence: float = odds.CONFIDENCE,
) -> Plan | tuple[Diagnostic, ...]:
    """The plan to audit every requirement that is not retired, or why there can be none.

    Args:
        project: read without errors.
        evaluation: how the monitors are run: `columns` or `online`; what they show is the same.
        integrity: what is looked at of a log beyond the messages in question.
        confidence: of what is said of a probability, between 0.5 and 1.
    """
    rules = [rule for rule in project.rules if rule.requirement.status != "retired"]
    declarations = project.declarations
    wrong = _not_auditable(rules, declarations)
    if wrong or declarations is None:
        return tuple(wrong)
    claims = tuple(_claim(rule) for rule in rules)
    key = _key(claims, declarations, evaluation, integrity)
    bindings = fingerprint(declarations)
    return Plan(claims, declarations, bindings, evaluation, integrity, key, confidence)


def _claim(rule: Rule) -> Claim:
    return Claim(
        rule.id,
        wording(rule.requirement),
        rule.fingerprint,
        monitors.text(rule),
        demand(rule),
        chance(rule),
    )


@deep
def _key(
    claims: Sequence[Claim], declarations: Declarations, evaluation: str, integrity: Integrity
) -> str:
    """The bindings count with their places too: findings tell lines of them."""
    digest = hashlib.sha256(pickle.dumps(declarations, protocol=5))
    texts = [(c.id, c.sentence, c.sha256, c.monitor, astuple(c.demand)) for c in claims]
    digest.update(json.dumps([SCHEMA, edition(), evaluation, integrity, texts]).encode())
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
            claim.hashes(plan.bindings),
            claim.demand,
            partial(trials, claim.chance.obligation) if claim.chance else None,
            claim.chance.obligation.atoms if claim.chance else (),
        )
        for claim in plan.claims
    )


def _not_auditable(rules: Sequence[Rule], declarations: Declarations | None) -> list[Diagnostic]:
    if not rules:
        return [Diagnostic(Code.NOTHING_TO_DO, "there is no requirement to audit")]
    if declarations is None:
        return [
            Diagnostic(
                Code.UNBOUND,
                "no bindings say what the propositions mean in the messages",
                rules[0].requirement.wording,
                help="write `bindings.toml` beside the requirements, or name it with `--bindings`",
            )
        ]
    if not declarations.clock.declared:
        return [
            Diagnostic(
                Code.NO_CLOCK,
                f"`{declarations.source.name}` declares no clock",
                declarations.source.span(0, 0),
                help='add `[clock]` with `tick = "100 ms"`',
            )
        ]
    refused = [monitors.refuse(replace(rule, pctl=None)) for rule in rules]
    missing = [diagnostic for rule in rules for diagnostic in unbound(rule, declarations)]
    return [*(diagnostic for diagnostic in refused if diagnostic), *missing]
