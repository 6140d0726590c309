"""The chain from hazard to review as a graph: a fingerprint for each thing, a link for each step.

What has changed since a review makes the links downstream of it suspect, and no others: whoever
reads a suspect link knows what to look at again, and that the rest still stands.

Source of the notion: ISO 26262-8 clause 6 (traceability of safety requirements) asks for links
that can be followed both ways; Doorstop and StrictDoc call a link suspect whose parent changed.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from compiler import printing
from compiler.evidence import Evidence, Result, by_requirement
from compiler.products import Product, shared_products
from compiler.products import products as _made
from compiler.project import Project, bound_to_logs
from compiler.proven import Proof
from compiler.rule import Rule
from fretish.documents import Requirement

HAZARD, PARENT = "hazard", "parent"
TEXT, PARAMS, SENTENCE = "text", "params", "sentence"
CLOCK, BINDINGS, FORMULAS, ARTEFACT = "clock", "bindings", "formulas", "artefact"
LOG, VERDICT, REVIEW = "log", "verdict", "review"
PROOF, SHARED = "proof", "shared"
_ADDED = (LOG, VERDICT, PROOF, SHARED)
"""What may come after a review without changing anything that was reviewed."""
_READINGS = ("ltl", "json")
"""Targets that only show what the formulas are: those have fingerprints of their own."""


@dataclass(frozen=True, slots=True, order=True)
class Node:
    """One thing of the chain: `hazard` HAZ-001, `artefact` r1_monitor.py, `log` traces/a.mcap."""

    kind: str
    name: str

    def __str__(self) -> str:
        """As it stands in a lock."""
        return f"{self.kind}:{self.name}"


@dataclass(frozen=True, slots=True, order=True)
class Link:
    """What the target is made of, or judged by."""

    source: Node
    target: Node


@dataclass(frozen=True, slots=True)
class Chain:
    """Everything that bears upon one requirement."""

    requirement: str
    prints: Mapping[Node, str]
    """SHA-256 of each thing but the review; white space, comments and order do not count."""
    links: tuple[Link, ...]
    verdicts: Mapping[str, str]
    """Run → the word of its verdict."""


def chains(
    project: Project,
    evidence: Evidence | None,
    made: Mapping[int, Sequence[Product]] | None = None,
    proofs: Sequence[Proof] = (),
) -> tuple[Chain, ...]:
    """The chain of each requirement, in the order of the project.

    Args:
        project: with or without errors; a requirement without a rule has a chain that ends early.
        evidence: None where no run has been audited.
        made: what the targets make of each requirement, by its `id()`; None: it is made here.
        proofs: what verification has found.
    """
    rules = {id(rule.requirement): rule for rule in project.rules}
    results, common = by_requirement(evidence), _common(project, proofs)
    return tuple(
        _Chain(common).of(
            requirement,
            rules.get(id(requirement)),
            _made(rules.get(id(requirement))) if made is None else made.get(id(requirement), ()),
            results.get(requirement.id, ()),
            [proof for proof in proofs if proof.requirement == requirement.id],
        )
        for requirement in project.requirements
    )


@dataclass(frozen=True, slots=True)
class _Common:
    """What the chains of all requirements are made of."""

    project: Project
    texts: Mapping[str, Requirement]
    bindings: Mapping[str, Any]
    shared: Mapping[str, str]
    """Name of what is made of the bindings alone → its SHA-256; nothing where nothing is proved."""


def _common(project: Project, proofs: Sequence[Proof]) -> _Common:
    declared = project.declarations
    shared = shared_products(declared) if proofs else ()
    return _Common(
        project,
        {requirement.id: requirement for requirement in project.requirements},
        bound_to_logs(declared) if declared is not None else {},
        {product.file: product.sha256 for product in shared},
    )


class _Chain:
    """Collects nodes and links of one requirement."""

    def __init__(self, common: _Common) -> None:
        self._common, self._project, self._bindings = common, common.project, common.bindings
        self._prints: dict[Node, str] = {}
        self._links: dict[Link, None] = {}

    def of(
        self,
        requirement: Requirement,
        rule: Rule | None,
        made: Iterable[Product],
        results: Sequence[Result],
        proofs: Sequence[Proof],
    ) -> Chain:
        verdicts = {result.run: result.verdict for result in results}
        self._above(requirement, {requirement.id})
        sentence = Node(SENTENCE, requirement.id)
        self._add(sentence, rule.fingerprint if rule else _plain(requirement.wording.text))
        self._link(Node(TEXT, requirement.id), sentence)
        if rule is not None:
            self._below(rule, sentence, made, results)
            self._proved(rule, proofs)
        review = Node(REVIEW, requirement.id)
        sources = {link.source for link in self._links}
        ends = [node for node in self._prints if node not in sources]
        for node in ends:
            self._link(node, review)
        return Chain(requirement.id, self._prints, tuple(sorted(self._links)), verdicts)

    def _above(self, requirement: Requirement, seen: set[str]) -> None:
        """Hazards and requirements that it traces to, all the way up."""
        text = Node(TEXT, requirement.id)
        self._add(text, _fingerprint(_said(requirement)))
        for parent in requirement.parents:
            hazard, above = self._project.hazards.get(parent), self._common.texts.get(parent)
            if hazard is not None:
                self._add(Node(HAZARD, parent), _fingerprint(_normal(asdict(hazard))))
                self._link(Node(HAZARD, parent), text)
            elif parent in self._project.parents:
                outside = self._project.parents[parent]
                told = _normal([outside.title, outside.text])
                self._add(Node(PARENT, parent), _fingerprint(told))
                self._link(Node(PARENT, parent), text)
            elif above is not None and parent not in seen:
                seen.add(parent)
                self._above(above, seen)
                self._link(Node(TEXT, parent), text)

    def _below(
        self, rule: Rule, sentence: Node, made: Iterable[Product], results: Iterable[Result]
    ) -> None:
        formulas = Node(FORMULAS, rule.id)
        self._add(formulas, _formulas(rule))
        self._link(sentence, formulas)
        clock = Node(CLOCK, "clock")
        self._add(clock, _fingerprint(self._bindings.get("clock")))
        if rule.ticks is not None:
            self._link(clock, formulas)
        monitor = self._artefacts(made, formulas)
        bound = Node(BINDINGS, rule.id)
        self._add(bound, _fingerprint(_normal(self._bound(rule))))
        sources = [monitor, bound, clock] if monitor else [bound, clock]
        if rule.requirement.params:
            params = Node(PARAMS, rule.id)
            self._add(params, _fingerprint(_normal(dict(rule.requirement.params))))
            sources.append(params)
        for result in results:
            self._judged(result, sources)

    def _artefacts(self, made: Iterable[Product], formulas: Node) -> Node | None:
        """A node for each file that can be made; gives that of the monitor."""
        monitor = None
        for product in made:
            if product.refusal or product.target in _READINGS:
                continue
            node = Node(ARTEFACT, product.file)
            self._add(node, product.sha256)
            self._link(formulas, node)
            monitor = node if product.target == "monitor" else monitor
        return monitor

    def _judged(self, result: Result, sources: Iterable[Node]) -> None:
        verdict, log = Node(VERDICT, f"{result.requirement} {result.run}"), Node(LOG, result.run)
        self._add(log, result.hashes.get("log", ""))
        self._add(verdict, _fingerprint(_judgement(result)))
        for source in (*sources, log):
            self._link(source, verdict)

    def _proved(self, rule: Rule, proofs: Sequence[Proof]) -> None:
        """Each claim, with the texts and assumptions that it is about, as they are now."""
        now = self._common.shared
        for proof in proofs:
            node = Node(PROOF, f"{rule.id} {proof.layer}: {proof.claim}")
            self._add(node, _fingerprint([proof.result, sorted(proof.assumptions)]))
            self._link(Node(FORMULAS, rule.id), node)
            for name in proof.artefacts:
                if name in now:
                    self._add(Node(SHARED, name), now[name])
                    self._link(Node(SHARED, name), node)
                elif Node(ARTEFACT, name) in self._prints:
                    self._link(Node(ARTEFACT, name), node)

    def _bound(self, rule: Rule) -> dict[str, Any]:
        """What the bindings say of its propositions, and of the signals that these read."""
        declared = self._project.declarations
        if declared is None:
            return {}
        known = [declared.propositions[n] for n in rule.watched if n in declared.propositions]
        signals = dict.fromkeys(signal for proposition in known for signal in proposition.signals)
        return {
            "proposition": {p.name: self._bindings["proposition"][p.name] for p in known},
            "signal": {name: self._bindings["signal"][name] for name in signals},
        }

    def _add(self, node: Node, fingerprint: str) -> None:
        self._prints[node] = fingerprint

    def _link(self, source: Node, target: Node) -> None:
        self._links[Link(source, target)] = None


# Fingerprints ----------------------------------------------------------------------------------


def _said(requirement: Requirement) -> dict[str, Any]:
    """What a person says of it; its status and planned methods are no part of the claim."""
    texts = (requirement.title, requirement.text, requirement.rationale)
    return {"texts": _normal(list(texts)), "parents": sorted(requirement.parents)}


def _judgement(result: Result) -> dict[str, Any]:
    return {
        "verdict": result.verdict,
        "finite": result.finite,
        "triggers": len(result.triggers),
        "violations": [[v.first.tick, v.last.tick] for v in result.violations],
        "open": [moment.tick for moment in result.open],
    }


def _formulas(rule: Rule) -> str:
    told = [rule.ft_infinite, rule.ft_finite, rule.pt]
    return _fingerprint([printing.readable(formula) for formula in told])


def _plain(text: str) -> str:
    return _fingerprint(_normal(text))


def _normal(value: Any) -> Any:
    """Texts without the difference that white space makes."""
    match value:
        case str():
            return " ".join(value.split())
        case dict():
            return {key: _normal(item) for key, item in value.items()}
        case list():
            return [_normal(item) for item in value]
        case _:
            return value


def _fingerprint(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


# Suspects --------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Suspect:
    """A link that no longer stands on what was reviewed."""

    link: Link
    causes: tuple[Node, ...]
    """What has changed, come or gone upstream of it: the first changes, not what follows."""


def changed(prints: Mapping[Node, str], locked: Mapping[Node, str]) -> tuple[Node, ...]:
    """What is not as it was locked: another fingerprint, new, or gone; sorted."""
    return tuple(
        sorted(node for node in {*prints, *locked} if prints.get(node) != locked.get(node))
    )


def suspects(chain: Chain, locked: Mapping[Node, str]) -> tuple[Suspect, ...]:
    """The links downstream of what has changed since the lock, those nearest to it first.

    Args:
        chain: as it is now.
        locked: the fingerprints that were accepted.
    """
    wrong = {
        node for node in changed(chain.prints, locked) if node in locked or node.kind not in _ADDED
    }
    upstream = _upstream(chain)
    found = []
    for link in sorted(chain.links, key=lambda link: (len(upstream[link.source]), link)):
        causes = wrong & {link.source, *upstream[link.source]}
        if causes:
            found.append(Suspect(link, tuple(sorted(_first(causes, upstream)))))
    gone = tuple(sorted(node for node in locked if node not in chain.prints))
    review = Node(REVIEW, chain.requirement)
    found.extend(Suspect(Link(node, review), (node,)) for node in gone)
    return tuple(found)


def _first(causes: set[Node], upstream: Mapping[Node, frozenset[Node]]) -> Iterator[Node]:
    """Those that no other cause explains."""
    return (cause for cause in causes if not upstream[cause] & causes)


def _upstream(chain: Chain) -> dict[Node, frozenset[Node]]:
    """Everything from which each thing can be reached."""
    above: dict[Node, set[Node]] = {node: set() for link in chain.links for node in _ends(link)}
    above |= {node: set() for node in chain.prints if node not in above}
    for link in chain.links:
        above[link.target].add(link.source)
    found: dict[Node, frozenset[Node]] = {}

    def reach(node: Node) -> frozenset[Node]:
        if node not in found:
            found[node] = frozenset()  # a requirement may be its own ancestor
            found[node] = frozenset(above[node]).union(*(reach(each) for each in above[node]))
        return found[node]

    for node in above:
        reach(node)
    return found


def _ends(link: Link) -> tuple[Node, Node]:
    return link.source, link.target
