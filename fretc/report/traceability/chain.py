"""The chain from hazard to review as a graph: a fingerprint for each thing, a link for each step.

What has changed since a review makes the links downstream of it suspect, and no others: whoever
reads a suspect link knows what to look at again, and that the rest still stands.

Source of the notion: ISO 26262-8 clause 6 (traceability of safety requirements) asks for links
that can be followed both ways; Doorstop and StrictDoc call a link suspect whose parent changed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from compiler.files.edition import __version__
from compiler.formalization.formalized import Formalized
from compiler.logic import printing
from compiler.logic.claims import Proof
from compiler.project.folder import Project
from fretc.audit.bases import bases
from fretc.audit.evidence import basis
from fretc.audit.evidence.basis import Basis
from fretc.audit.evidence.reader import by_requirement
from fretc.audit.evidence.schema import Evidence, Result
from fretc.report.traceability.artefacts import Product, shared_products
from fretc.report.traceability.artefacts import products as _made
from fretish.bindings.canonical import described, digest
from fretish.documents import Requirement

HAZARD, PARENT, STATUS, PLAN = "hazard", "parent", "status", "plan"
TEXT, WORDS, FORMULAS, ARTEFACT = "text", "words", "formulas", "artefact"
LOG, VERDICT, REVIEW = "log", "verdict", "review"
PROOF, SHARED = "proof", "shared"
_ADDED = (LOG, VERDICT, PROOF, SHARED, PLAN, ARTEFACT, basis.TOPICS)
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
    outdated: Mapping[Node, tuple[Node, ...]] = field(default_factory=dict)
    """Each verdict and proof that is about something else than what is here now → what differs."""
    unhashed: tuple[str, ...] = ()
    """Runs of whose log nothing is known that tells it from another one."""


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
    results, common = by_requirement(evidence), _common(project, evidence, proofs)
    return tuple(
        _Chain(common, requirement).of(
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
    bases: Mapping[int, Basis]
    audited_by: str
    """The version of fretc that made the evidence."""
    shared: Mapping[str, str]
    """Name of what is made of the bindings alone → its SHA-256; nothing where nothing is proved."""


def _common(project: Project, evidence: Evidence | None, proofs: Sequence[Proof]) -> _Common:
    shared = shared_products(project.declarations) if proofs else ()
    return _Common(
        project,
        {requirement.id: requirement for requirement in project.requirements},
        bases(project),
        evidence.fretc if evidence else "",
        {product.file: product.sha256 for product in shared},
    )


class _Chain:
    """Collects nodes and links of one requirement."""

    def __init__(self, common: _Common, requirement: Requirement) -> None:
        self._common, self._project, self._id = common, common.project, requirement.id
        self._basis = common.bases[id(requirement)]
        self._prints: dict[Node, str] = {}
        self._links: dict[Link, None] = {}
        self._outdated: dict[Node, tuple[Node, ...]] = {}

    def of(
        self,
        requirement: Requirement,
        rule: Formalized | None,
        made: Iterable[Product],
        results: Sequence[Result],
        proofs: Sequence[Proof],
    ) -> Chain:
        self._above(requirement, {requirement.id})
        self._beside(requirement)
        sentence = Node(basis.SENTENCE, requirement.id)
        self._add(sentence, self._basis[basis.SENTENCE])
        self._link(Node(TEXT, requirement.id), sentence)
        artefacts = self._below(rule, sentence, made) if rule is not None else {}
        sources = self._sources(artefacts.get("monitor"), audited=bool(results))
        for result in results:
            self._judged(result, sources)
        if rule is not None:
            self._proved(rule, proofs)
        review = Node(REVIEW, requirement.id)
        sent = {link.source for link in self._links}
        for node in [node for node in self._prints if node not in sent]:
            self._link(node, review)
        return Chain(
            requirement.id,
            self._prints,
            tuple(sorted(self._links)),
            {result.run: result.verdict for result in results},
            self._outdated,
            tuple(result.run for result in results if not _print_of_log(result)),
        )

    def _beside(self, requirement: Requirement) -> None:
        """What no log depends on, and a review does: whether it is claimed, and how it is shown."""
        retired = requirement.status == "retired"
        self._add(in_force(self._id), digest("retired") if retired else IN_FORCE)
        for method in requirement.verify:
            self._add(Node(PLAN, f"{self._id} {method}"), digest(method))

    def _above(self, requirement: Requirement, seen: set[str]) -> None:
        """Hazards and requirements that it traces to, all the way up."""
        text = Node(TEXT, requirement.id)
        self._add(text, digest(_said(requirement)))
        for parent in requirement.parents:
            hazard, above = self._project.hazards.get(parent), self._common.texts.get(parent)
            if hazard is not None:
                self._add(Node(HAZARD, parent), digest(_normal(asdict(hazard))))
                self._link(Node(HAZARD, parent), text)
            elif parent in self._project.parents:
                outside = self._project.parents[parent]
                told = _normal([outside.title, outside.text])
                self._add(Node(PARENT, parent), digest(told))
                self._link(Node(PARENT, parent), text)
            elif above is not None and parent not in seen:
                seen.add(parent)
                self._above(above, seen)
                self._link(Node(TEXT, parent), text)

    def _below(
        self, rule: Formalized, sentence: Node, made: Iterable[Product]
    ) -> Mapping[str, Node]:
        """Formulas, words and artefacts; gives the artefact of each target."""
        formulas, words = Node(FORMULAS, rule.id), Node(WORDS, rule.id)
        clock, fretc = self._clock(), Node(basis.FRETC, _VERSION)
        self._add(formulas, _formulas(rule))
        self._add(fretc, digest(__version__))
        self._link(sentence, formulas)
        if rule.ticks is not None:
            self._link(clock, formulas)
        told = described(self._project.declarations, rule.watched)
        if told:
            self._add(words, digest(told))
        found = {}
        for product in made:
            if product.refusal or product.target in _READINGS:
                continue
            node = found[product.target] = Node(ARTEFACT, product.file)
            self._add(node, product.sha256)
            for source in (formulas, fretc, *([clock] if product.target == "monitor" else ())):
                self._link(source, node)
        return found

    def _clock(self) -> Node:
        node = Node(basis.CLOCK, "clock")
        self._add(node, self._basis[basis.CLOCK])
        return node

    def _sources(self, monitor: Node | None, *, audited: bool) -> Mapping[str, Node]:
        """What a verdict rests on, by its kind."""
        found = {
            basis.FRETC: Node(basis.FRETC, _VERSION),
            basis.SENTENCE: Node(basis.SENTENCE, self._id),
            basis.PARAMS: Node(basis.PARAMS, self._id),
            basis.CLOCK: self._clock(),
            basis.TOPICS: Node(basis.TOPICS, "audited"),
            basis.BINDINGS: Node(basis.BINDINGS, self._id),
            basis.MONITOR: monitor or Node(basis.MONITOR, self._id),
        }
        for kind in (basis.PARAMS, basis.BINDINGS, *([basis.TOPICS] if audited else ())):
            self._add(found[kind], self._basis[kind])
        return found

    def _judged(self, result: Result, sources: Mapping[str, Node]) -> None:
        verdict, log = Node(VERDICT, f"{result.requirement} {result.run}"), Node(LOG, result.run)
        self._add(log, _print_of_log(result))
        self._add(verdict, digest(_judgement(result)))
        follows = sources[basis.MONITOR] in self._prints
        for kind, source in sources.items():
            if source in self._prints and not (follows and kind == basis.SENTENCE):
                self._link(source, verdict)
        self._link(log, verdict)
        old = outdated(result, self._common.audited_by, self._basis)
        if old:
            self._outdated[verdict] = tuple(sources[kind] for kind in old)

    def _proved(self, rule: Formalized, proofs: Sequence[Proof]) -> None:
        """Each claim, with the texts and assumptions that it is about, as they are now."""
        now = self._common.shared
        for proof in proofs:
            node = Node(PROOF, f"{rule.id} {proof.layer}: {proof.claim}")
            self._add(node, digest([proof.result, sorted(proof.assumptions)]))
            self._link(Node(FORMULAS, rule.id), node)
            for name, looked_at in proof.artefacts.items():
                source = Node(SHARED, name) if name in now else Node(ARTEFACT, name)
                if name in now:
                    self._add(source, now[name])
                if source not in self._prints:
                    continue
                self._link(source, node)
                if self._prints[source] != looked_at:
                    self._outdated[node] = (*self._outdated.get(node, ()), source)

    def _add(self, node: Node, fingerprint: str) -> None:
        self._prints[node] = fingerprint

    def _link(self, source: Node, target: Node) -> None:
        self._links[Link(source, target)] = None


# Fingerprints ----------------------------------------------------------------------------------

_VERSION = "version"
IN_FORCE = digest("in force")
"""The fingerprint of the status of a requirement that is claimed, as a draft or approved."""


def in_force(requirement: str) -> Node:
    """Whether a requirement is claimed, or retired."""
    return Node(STATUS, requirement)


def outdated(result: Result, audited_by: str, now: Basis) -> tuple[str, ...]:
    """The kinds of what a result rests on that are not as they were when it was audited."""
    recorded = {**result.hashes, basis.FRETC: audited_by}
    return basis.outdated(recorded, {**now, basis.FRETC: __version__})


def _print_of_log(result: Result) -> str:
    """SHA-256 of the log; of its summary, where it was read by its index; "": neither is known."""
    return result.hashes.get("log") or result.hashes.get("log_summary") or ""


def _said(requirement: Requirement) -> dict[str, Any]:
    """What a person says of it; its planned methods and whether it is claimed are no part of it."""
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


def _formulas(rule: Formalized) -> str:
    told = [rule.ft_infinite, rule.ft_finite, rule.pt]
    return digest([printing.readable(formula) for formula in told])


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

    What is about something else than what is here now is suspect too, whatever was locked: a
    verdict of another binding stays one when the binding of the review has come back.

    Args:
        chain: as it is now.
        locked: the fingerprints that were accepted.
    """
    wrong = {
        node for node in changed(chain.prints, locked) if node in locked or node.kind not in _ADDED
    }
    upstream = _upstream(chain)
    causes_of: dict[Link, set[Node]] = {}
    for link in chain.links:
        above = {link.source, *upstream[link.source]}
        causes_of[link] = wrong & above
        for node in chain.outdated.keys() & above & locked.keys():
            causes_of[link] |= {*chain.outdated[node]}
    for node in chain.outdated.keys() & locked.keys():
        for source in chain.outdated[node]:
            causes_of.setdefault(Link(source, node), set()).add(source)
    found = [
        Suspect(link, tuple(sorted(_first(causes_of[link], upstream))))
        for link in sorted(causes_of, key=lambda link: (len(upstream.get(link.source, ())), link))
        if causes_of[link]
    ]
    gone = tuple(sorted(node for node in locked if node not in chain.prints))
    review = Node(REVIEW, chain.requirement)
    found.extend(Suspect(Link(node, review), (node,)) for node in gone)
    return tuple(found)


def _first(causes: set[Node], upstream: Mapping[Node, frozenset[Node]]) -> Iterator[Node]:
    """Those that no other cause explains."""
    return (cause for cause in causes if not upstream.get(cause, frozenset()) & causes)


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
