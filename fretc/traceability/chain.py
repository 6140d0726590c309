"""The chain from hazard to review as a graph: a fingerprint for each thing, a link for each step.

A change since a review makes the links downstream of it suspect, and no others: a suspect link
names what to review again, and the rest still stands.

Source: ISO 26262-8 clause 6 (traceability of safety requirements) asks for links
that can be followed both ways; Doorstop and StrictDoc call a link suspect whose parent changed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, NamedTuple

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from compiler.logic.claims import Proof
from compiler.project.acceptances import TOPIC, Acceptance
from compiler.project.folder import Project
from compiler.project.hazards import Hazard
from fretc.analysis.evidence import AnalyzedSet
from fretc.audit.bases import audited_topics, bases
from fretc.audit.evidence import basis
from fretc.audit.evidence.basis import Basis
from fretc.audit.evidence.briefs import Brief, Briefs, Recorded
from fretc.traceability import texts
from fretc.traceability.analyses import Answer, answers
from fretc.traceability.artefacts import Product, monitors, shared_products
from fretc.traceability.artefacts import products as products_of
from fretc.traceability.texts import ReviewedTexts
from fretish.bindings.canonical import described, digest
from fretish.documents import RequirementEntry

HAZARD, PARENT, STATUS, PLAN = "hazard", "parent", "status", "plan"
TEXT, WORDS, FORMULAS, ARTEFACT = "text", "words", "formulas", "artefact"
ACCEPTANCE = "acceptance"
LOG, VERDICT, REVIEW = "log", "verdict", "review"
PROOF, SHARED = "proof", "shared"
ANALYSIS, MEMBER = "analysis", "member"
DERIVED = (FORMULAS, ARTEFACT, VERDICT, PROOF, ANALYSIS)
"""Kinds of nodes that are made of those upstream; of any other the fingerprint is its own."""
ADDED = (LOG, VERDICT, PROOF, ANALYSIS, SHARED, PLAN, ARTEFACT, basis.TOPICS)
"""Kinds of nodes that may come after a review without a change of what was reviewed."""
_READINGS = ("ltl", "json")
"""Targets that only print formulas, which have fingerprints of their own."""


class Node(NamedTuple):
    """One thing of the chain: `hazard` HAZ-001, `artefact` r1_monitor.py, `log` traces/a.mcap."""

    kind: str
    name: str

    def __str__(self) -> str:
        """The text in a lock."""
        return f"{self.kind}:{self.name}"


class Link(NamedTuple):
    """The target depends on the source."""

    source: Node
    target: Node


@dataclass(frozen=True, slots=True)
class Chain:
    """All nodes and links of one requirement.

    Those of its runs are many and all alike: they are made when they are asked for.
    """

    requirement: str
    definition: Mapping[Node, str]
    """SHA-256 of each node but the review, and those of the runs."""
    steps: tuple[Link, ...]
    """All links but those of the runs, sorted."""
    results: Sequence[Brief] = ()
    """Of each run."""
    sources: tuple[Node, ...] = ()
    """What each verdict depends on, beside its log."""
    differences: Mapping[Recorded, tuple[Node, ...]] = field(default_factory=dict)
    """What a verdict may rest on that is out of date → the nodes that differ."""
    outdated_proofs: Mapping[Node, tuple[Node, ...]] = field(default_factory=dict)
    """Each proof or analysis that is out of date → the nodes that differ."""
    texts: ReviewedTexts | None = None
    """What the fingerprints are taken of, as it is written."""
    answer: Answer | None = None
    """What is known of it and the others together; None: nobody has asked."""

    @property
    def prints(self) -> Mapping[Node, str]:
        """SHA-256 of each node but the review; white space, comments and order do not count."""
        prints = dict(self.definition)
        for result in self.results:
            prints[Node(LOG, result.run)] = _print_of_log(result)
            prints[_verdict(result)] = result.judgement
        return prints

    @property
    def links(self) -> tuple[Link, ...]:
        """All of them, sorted."""
        review = Node(REVIEW, self.requirement)
        links = dict.fromkeys(self.steps)
        for result in self.results:
            verdict = _verdict(result)
            links |= dict.fromkeys(Link(source, verdict) for source in self.sources)
            links[Link(Node(LOG, result.run), verdict)] = None
            links[Link(verdict, review)] = None
        return tuple(sorted(links))

    @property
    def verdicts(self) -> Mapping[str, str]:
        """Run → the word of its verdict."""
        return {result.run: result.verdict for result in self.results}

    @property
    def outdated(self) -> Mapping[Node, tuple[Node, ...]]:
        """Each verdict, proof or analysis that is out of date → the nodes that differ."""
        if not self.differences:
            return self.outdated_proofs
        pairs = ((_verdict(each), self.differences.get(each.rests_on)) for each in self.results)
        return {node: nodes for node, nodes in pairs if nodes} | {**self.outdated_proofs}

    @property
    def unhashed(self) -> tuple[str, ...]:
        """Runs without a SHA-256 of their log."""
        return tuple(result.run for result in self.results if not _print_of_log(result))


def _verdict(result: Brief) -> Node:
    return Node(VERDICT, f"{result.requirement} {result.run}")


def chains(
    project: Project,
    briefs: Briefs | None,
    artefacts: Mapping[int, Sequence[Product]] | None = None,
    proofs: Sequence[Proof] = (),
    known: Mapping[int, Basis] | None = None,
    analyzed: AnalyzedSet | None = None,
) -> tuple[Chain, ...]:
    """The chain of each requirement, in the order of the project.

    Args:
        project: with or without errors; the chain of what is not formalized ends early.
        briefs: of the evidence; None where no run has been audited.
        artefacts: the products of each requirement, by its `id()`; None: `products` makes them.
        proofs: the results of verification.
        known: what a verdict on each requirement rests on now; None: `bases` makes it.
        analyzed: whether all can be kept together; None: nobody has asked.
    """
    requirements = {id(requirement.entry): requirement for requirement in project.formalized}
    results = briefs.by_requirement if briefs else {}
    if artefacts is None:
        artefacts = {entry: products_of(requirement) for entry, requirement in requirements.items()}
    common = _common(project, briefs, artefacts, proofs, known, analyzed)
    return tuple(
        _ChainBuilder(common, entry).build(
            entry,
            requirements.get(id(entry)),
            artefacts.get(id(entry), ()),
            [each for _, each in results.get(entry.id, ())],
            [proof for proof in proofs if proof.requirement == entry.id],
        )
        for entry in project.requirements
    )


@dataclass(frozen=True, slots=True)
class _Common:
    """What all chains of a project share."""

    project: Project
    texts: Mapping[str, RequirementEntry]
    bases: Mapping[int, Basis]
    audited_by: str
    """The version of fretc that wrote the evidence."""
    acceptances: Mapping[int | None, Sequence[Acceptance]]
    """Those in the header of each requirement, by its `id()`; None → those in the settings."""
    shared: Mapping[str, str]
    """Name of each shared product → its SHA-256; empty where there is no proof."""
    topics: frozenset[str]
    """Those that an audit of the project reads."""
    written: Mapping[str, Any]
    """The tables of the bindings."""
    answers: Mapping[str, Answer]
    """What is known of all requirements together, by id."""


def _common(
    project: Project,
    briefs: Briefs | None,
    artefacts: Mapping[int, Sequence[Product]],
    proofs: Sequence[Proof],
    known: Mapping[int, Basis] | None,
    analyzed: AnalyzedSet | None,
) -> _Common:
    shared = shared_products(project.declarations) if proofs else ()
    topics = audited_topics(project)
    return _Common(
        project,
        {requirement.id: requirement for requirement in project.requirements},
        bases(project, topics, monitors(artefacts)) if known is None else known,
        briefs.source.fretc if briefs else "",
        _by_requirement(project.acceptances),
        {product.file: product.sha256 for product in shared},
        topics,
        texts.written_tables(project.declarations),
        answers(analyzed, project),
    )


def _by_requirement(
    acceptances: Iterable[Acceptance],
) -> Mapping[int | None, Sequence[Acceptance]]:
    found: dict[int | None, list[Acceptance]] = {}
    for each in acceptances:
        found.setdefault(id(each.requirement) if each.requirement else None, []).append(each)
    return found


class _ChainBuilder:
    """Collects nodes and links of one requirement."""

    def __init__(self, common: _Common, requirement: RequirementEntry) -> None:
        self._common, self._project, self._id = common, common.project, requirement.id
        self._basis = common.bases[id(requirement)]
        self._prints: dict[Node, str] = {}
        self._links: dict[Link, None] = {}
        self._outdated_proofs: dict[Node, tuple[Node, ...]] = {}
        self._accept: dict[str, str] = {}
        self._hazards: dict[str, texts.HazardTexts] = {}
        self._elsewhere: dict[str, texts.ExternalParent] = {}
        self._above: dict[str, texts.ParentRequirement] = {}

    def build(
        self,
        entry: RequirementEntry,
        requirement: FormalizedRequirement | None,
        artefacts: Iterable[Product],
        results: Sequence[Brief],
        proofs: Sequence[Proof],
    ) -> Chain:
        self._add_parents(entry, {entry.id})
        self._add_status_and_plans(entry)
        self._accepted(entry, requirement)
        sentence = Node(basis.SENTENCE, entry.id)
        self._add(sentence, self._basis[basis.SENTENCE])
        self._link(Node(TEXT, entry.id), sentence)
        nodes = (
            self._add_artefacts(requirement, sentence, artefacts) if requirement is not None else {}
        )
        sources = self._add_sources(nodes.get("monitor"), audited=bool(results))
        of_verdicts = self._sources_of_verdicts(sources) if results else ()
        answer = self._common.answers.get(entry.id)
        if requirement is not None:
            self._add_proofs(requirement, proofs)
        if answer is not None:
            self._add_answer(answer)
        review = Node(REVIEW, entry.id)
        followed = {*of_verdicts, *(link.source for link in self._links)}
        for node in [node for node in self._prints if node not in followed]:
            self._link(node, review)
        return Chain(
            entry.id,
            self._prints,
            tuple(sorted(self._links)),
            results,
            of_verdicts,
            self._differences(results, sources),
            self._outdated_proofs,
            self._texts(entry, requirement, proofs, answer, audited=bool(results)),
            answer,
        )

    def _texts(
        self,
        entry: RequirementEntry,
        requirement: FormalizedRequirement | None,
        proofs: Sequence[Proof],
        answer: Answer | None,
        *,
        audited: bool,
    ) -> ReviewedTexts:
        """What the fingerprints are taken of."""
        declarations, written = self._project.declarations, self._common.written
        return ReviewedTexts(
            sentence=entry.wording.text,
            canonical=texts.canonical_text(requirement),
            title=entry.title,
            text=entry.text,
            rationale=entry.rationale,
            status=entry.status,
            parents=entry.parents,
            verify=entry.verify,
            params=dict(entry.params),
            accept=self._accept,
            hazards=self._hazards,
            elsewhere=self._elsewhere,
            above=self._above,
            bindings=texts.bindings(requirement, declarations, written) if declarations else None,
            topics=tuple(sorted(self._common.topics)) if audited and declarations else None,
            proofs={_claim(each): (each.result, *each.assumptions) for each in proofs}
            if requirement
            else {},
            loop=texts.loop(written) if proofs and declarations else {},
            analysis=answer.texts if answer else (),
            fretc=__version__ if requirement else "",
        )

    def _add_status_and_plans(self, requirement: RequirementEntry) -> None:
        """Add status and planned methods: a review depends on them, and no verdict does."""
        self._add(in_force(self._id), print_of_status(requirement.status))
        for method in requirement.verify:
            self._add(Node(PLAN, f"{self._id} {method}"), digest(method))

    def _accepted(self, entry: RequirementEntry, requirement: FormalizedRequirement | None) -> None:
        """The warnings that a reviewer accepts with it: no verdict depends on them."""
        topics = _topics(requirement, self._project)
        known = self._common.acceptances
        for each in (*known.get(id(entry), ()), *known.get(None, ())):
            if each.about != TOPIC or each.subject in ("", *topics):
                self._accept[each.name] = each.reason
                self._add(Node(ACCEPTANCE, each.name), print_of_words(each.reason))

    def _add_parents(self, requirement: RequirementEntry, visited: set[str]) -> None:
        """Add the hazards and requirements that it traces to, all the way up."""
        text = Node(TEXT, requirement.id)
        self._add(text, print_of_header(texts.above(requirement)))
        for parent in requirement.parents:
            hazard, above = self._project.hazards.get(parent), self._common.texts.get(parent)
            if hazard is not None:
                self._hazards[parent] = texts.hazard_texts(hazard)
                self._add(Node(HAZARD, parent), print_of_hazard(hazard))
                self._link(Node(HAZARD, parent), text)
            elif parent in self._project.parents:
                outside = self._project.parents[parent]
                self._elsewhere[parent] = texts.elsewhere(outside)
                self._add(Node(PARENT, parent), print_of_words([outside.title, outside.text]))
                self._link(Node(PARENT, parent), text)
            elif above is not None and parent not in visited:
                visited.add(parent)
                self._above[parent] = texts.above(above)
                self._add_parents(above, visited)
                self._link(Node(TEXT, parent), text)

    def _add_artefacts(
        self, requirement: FormalizedRequirement, sentence: Node, artefacts: Iterable[Product]
    ) -> Mapping[str, Node]:
        """Add formulas, words and artefacts; gives the artefact of each target."""
        formulas, words = Node(FORMULAS, requirement.id), Node(WORDS, requirement.id)
        clock, fretc = self._add_clock(), Node(basis.FRETC, _VERSION)
        self._add(formulas, _formulas(requirement))
        self._add(fretc, digest(__version__))
        self._link(sentence, formulas)
        if requirement.ticks is not None:
            self._link(clock, formulas)
        meanings = described(self._project.declarations, requirement.watched)
        if meanings:
            self._add(words, digest(meanings))
        nodes = {}
        for product in artefacts:
            if product.refusal or product.target in _READINGS:
                continue
            node = nodes[product.target] = Node(ARTEFACT, product.file)
            self._add(node, product.sha256)
            for source in (formulas, fretc, *([clock] if product.target == "monitor" else ())):
                self._link(source, node)
        return nodes

    def _add_clock(self) -> Node:
        node = Node(basis.CLOCK, "clock")
        self._add(node, self._basis[basis.CLOCK])
        return node

    def _add_sources(self, monitor: Node | None, *, audited: bool) -> Mapping[str, Node]:
        """Add the nodes that a verdict rests on; gives them by kind."""
        nodes = {
            basis.FRETC: Node(basis.FRETC, _VERSION),
            basis.SENTENCE: Node(basis.SENTENCE, self._id),
            basis.PARAMS: Node(basis.PARAMS, self._id),
            basis.CLOCK: self._add_clock(),
            basis.TOPICS: Node(basis.TOPICS, "audited"),
            basis.BINDINGS: Node(basis.BINDINGS, self._id),
            basis.MONITOR: monitor or Node(basis.MONITOR, self._id),
        }
        for kind in (basis.PARAMS, basis.BINDINGS, *([basis.TOPICS] if audited else ())):
            self._add(nodes[kind], self._basis[kind])
        return nodes

    def _sources_of_verdicts(self, sources: Mapping[str, Node]) -> tuple[Node, ...]:
        """What each verdict depends on; a monitor stands between the sentence and the verdict."""
        has_monitor = sources[basis.MONITOR] in self._prints
        return tuple(
            source
            for kind, source in sources.items()
            if source in self._prints and not (has_monitor and kind == basis.SENTENCE)
        )

    def _differences(
        self, results: Sequence[Brief], sources: Mapping[str, Node]
    ) -> Mapping[Recorded, tuple[Node, ...]]:
        """Each basis of results that is out of date → the nodes that differ."""
        kinds_of = {
            recorded: outdated(recorded, self._common.audited_by, self._basis)
            for recorded in {result.rests_on for result in results}
        }
        return {
            recorded: tuple(sources[kind] for kind in kinds)
            for recorded, kinds in kinds_of.items()
            if kinds
        }

    def _add_proofs(self, requirement: FormalizedRequirement, proofs: Sequence[Proof]) -> None:
        """Add each proof, with the texts and assumptions that it is about."""
        now = self._common.shared
        for proof in proofs:
            node = Node(PROOF, f"{requirement.id} {_claim(proof)}")
            self._add(node, print_of_proof(proof.result, proof.assumptions))
            self._link(Node(FORMULAS, requirement.id), node)
            for name, fingerprint in proof.artefacts.items():
                source = Node(SHARED, name) if name in now else Node(ARTEFACT, name)
                if name in now:
                    self._add(source, now[name])
                if source not in self._prints:
                    continue
                self._link(source, node)
                if self._prints[source] != fingerprint:
                    before = self._outdated_proofs.get(node, ())
                    self._outdated_proofs[node] = (*before, source)

    def _add_answer(self, answer: Answer) -> None:
        """Add what is known of it and the others together, with those that it is not about."""
        node = Node(ANALYSIS, self._id)
        self._add(node, print_of_proof(answer.verdict, answer.findings))
        self._link(Node(FORMULAS, self._id), node)
        if answer.differing:
            self._outdated_proofs[node] = tuple(Node(MEMBER, id) for id in answer.differing)

    def _add(self, node: Node, fingerprint: str) -> None:
        self._prints[node] = fingerprint

    def _link(self, source: Node, target: Node) -> None:
        self._links[Link(source, target)] = None


# Fingerprints ----------------------------------------------------------------------------------

_VERSION = "version"
IN_FORCE = digest("in force")
"""The fingerprint of the status of a requirement that is claimed, as a draft or approved."""


def print_of_status(status: str) -> str:
    """Whether it is claimed: a draft and an approved one are."""
    return digest("retired") if status == "retired" else IN_FORCE


def in_force(requirement: str) -> Node:
    """Whether a requirement is claimed, or retired."""
    return Node(STATUS, requirement)


def outdated(recorded: Recorded, audited_by: str, now: Basis) -> tuple[str, ...]:
    """The kinds of things that a result rests on and that have changed since its audit."""
    then = {**dict(zip(basis.KINDS, recorded, strict=True)), basis.FRETC: audited_by}
    return basis.outdated(then, {**now, basis.FRETC: __version__})


def _print_of_log(result: Brief) -> str:
    """SHA-256 of the log, or of its summary where the audit read its index only; or ""."""
    return result.log or result.fingerprints.log_summary or ""


def _topics(requirement: FormalizedRequirement | None, project: Project) -> set[str]:
    """Which the propositions of a requirement are read from."""
    if requirement is None or project.declarations is None:
        return set()
    read = project.declarations.reading(requirement.watched)
    return {signal.path.topic for signal in read.signals.values()}


def print_of_header(header: texts.ParentRequirement) -> str:
    """The texts and parents of a requirement, without status and planned methods."""
    words = [header.title, header.text, header.rationale]
    return digest({"texts": _normal(words), "parents": sorted(header.parents)})


def print_of_hazard(hazard: Hazard) -> str:
    """Its texts and its id."""
    return print_of_words(asdict(hazard))


def print_of_words(value: Any) -> str:
    """Texts, whatever their white space."""
    return digest(_normal(value))


def print_of_proof(result: str, assumptions: Iterable[str]) -> str:
    """What was proved of a claim, or analyzed, and under which assumptions."""
    return digest([result, sorted(assumptions)])


def _claim(proof: Proof) -> str:
    return f"{proof.layer}: {proof.claim}"


def _formulas(requirement: FormalizedRequirement) -> str:
    formulas = [requirement.ft_infinite, requirement.ft_finite, requirement.pt]
    return digest([printing.readable(formula) for formula in formulas])


def _normal(value: Any) -> Any:
    """The value with white space in texts made uniform."""
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
    """The first changes upstream of it, without changes that follow from these."""


def changed(prints: Mapping[Node, str], locked: Mapping[Node, str]) -> tuple[Node, ...]:
    """The nodes with another fingerprint than in the lock, new nodes, and gone ones; sorted."""
    return tuple(
        sorted(node for node in {*prints, *locked} if prints.get(node) != locked.get(node))
    )


def suspects(chain: Chain, locked: Mapping[Node, str]) -> tuple[Suspect, ...]:
    """The links downstream of what has changed since the lock, those nearest to it first.

    A verdict or proof that is out of date is suspect too, whatever the lock has: a verdict on
    another binding stays one when the binding of the review has come back.

    Args:
        chain: as it is now.
        locked: the fingerprints in the review.
    """
    prints, links, outdated_nodes = chain.prints, chain.links, chain.outdated
    changed_nodes = {
        node for node in changed(prints, locked) if node in locked or node.kind not in ADDED
    }
    late = outdated_nodes.keys() & locked.keys()
    if not changed_nodes and not late:
        return ()
    upstream = upstream_of(prints, links)
    causes_of: dict[Link, set[Node]] = {}
    for link in links:
        above = {link.source, *upstream[link.source]}
        causes_of[link] = changed_nodes & above
        for node in late & above:
            causes_of[link] |= {*outdated_nodes[node]}
    for node in late:
        for source in outdated_nodes[node]:
            causes_of.setdefault(Link(source, node), set()).add(source)
    suspect = [
        Suspect(link, tuple(sorted(_first(causes_of[link], upstream))))
        for link in sorted(causes_of, key=lambda link: (len(upstream.get(link.source, ())), link))
        if causes_of[link]
    ]
    gone = tuple(sorted(node for node in locked if node not in prints))
    review = Node(REVIEW, chain.requirement)
    suspect.extend(Suspect(Link(node, review), (node,)) for node in gone)
    return tuple(suspect)


def _first(causes: set[Node], upstream: Mapping[Node, frozenset[Node]]) -> Iterator[Node]:
    """The causes that do not follow from another cause."""
    return (
        cause
        for cause in causes
        if cause.kind not in DERIVED or not upstream.get(cause, frozenset()) & causes
    )


def upstream_of(nodes: Iterable[Node], links: Sequence[Link]) -> dict[Node, frozenset[Node]]:
    """Each node → all nodes that lead to it."""
    above: dict[Node, set[Node]] = {node: set() for link in links for node in link}
    above |= {node: set() for node in nodes if node not in above}
    for link in links:
        above[link.target].add(link.source)
    upstream: dict[Node, frozenset[Node]] = {}

    def reach(node: Node) -> frozenset[Node]:
        if node not in upstream:
            upstream[node] = frozenset()  # a requirement may be its own ancestor
            upstream[node] = frozenset(above[node]).union(*(reach(each) for each in above[node]))
        return upstream[node]

    for node in above:
        reach(node)
    return upstream
