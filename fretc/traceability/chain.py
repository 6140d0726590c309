"""The chain from hazard to review as a graph: nodes with fingerprints, and dependency links.

A change since a review makes only the links downstream of it suspect. A suspect link names what to
review again; the other reviews stay valid.

Source: ISO 26262-8 clause 6 (traceability of safety requirements) asks for links
that can be followed both ways; Doorstop and StrictDoc call a link suspect whose parent changed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, field
from typing import Any, NamedTuple

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from compiler.logic.claims import Proof
from compiler.project.acceptances import TOPIC, Acceptance
from compiler.project.hazards import Hazard
from compiler.project.project import Project
from fretc.analysis.evidence import AnalyzedSet
from fretc.audit.evidence import verdict_inputs
from fretc.audit.evidence.result_summaries import Recorded, ResultSummaries, ResultSummary
from fretc.audit.evidence.verdict_inputs import VerdictInputs
from fretc.audit.project_inputs import all_verdict_inputs, audited_topics
from fretc.traceability import texts
from fretc.traceability.analyses import Realizability, answers
from fretc.traceability.artefacts import Product, monitors, shared_products
from fretc.traceability.artefacts import products as products_of
from fretc.traceability.texts import ReviewedTexts
from fretish.bindings.canonical import described, digest
from fretish.classes.frozen import dataclass
from fretish.documents import RequirementEntry

HAZARD, PARENT, STATUS, PLAN = "hazard", "parent", "status", "plan"
TEXT, WORDS, FORMULAS, ARTEFACT = "text", "words", "formulas", "artefact"
ACCEPTANCE = "acceptance"
LOG, VERDICT, REVIEW = "log", "verdict", "review"
PROOF, SHARED = "proof", "shared"
ANALYSIS, MEMBER = "analysis", "member"
DERIVED = (FORMULAS, ARTEFACT, VERDICT, PROOF, ANALYSIS)
"""Kinds of nodes that are derived from nodes upstream."""
ADDED = (LOG, VERDICT, PROOF, ANALYSIS, SHARED, PLAN, ARTEFACT, verdict_inputs.TOPICS)
"""Kinds of nodes that may be added after a review without invalidating it."""
_READINGS = ("ltl", "json")
"""Targets that only print formulas; formulas have nodes of their own."""


class ChainItem(NamedTuple):
    """One item of the chain: `hazard` HAZ-001, `artefact` r1_monitor.py, `log` traces/a.mcap."""

    kind: str
    name: str

    def __str__(self) -> str:
        """The text of the node in a lock."""
        return f"{self.kind}:{self.name}"


class Link(NamedTuple):
    """A dependency: the target depends on the source."""

    source: ChainItem
    target: ChainItem


@dataclass(frozen=True, slots=True)
class Chain:
    """All nodes and links of one requirement.

    Nodes and links of runs are computed on demand, because there are many of them.
    """

    requirement: str
    definition: Mapping[ChainItem, str]
    """SHA-256 of each node, except the review and the nodes of runs."""
    steps: tuple[Link, ...]
    """All links except those of runs, sorted."""
    results: Sequence[ResultSummary] = ()
    """The result of the requirement in each run."""
    sources: tuple[ChainItem, ...] = ()
    """The nodes that each verdict depends on, except its log."""
    differences: Mapping[Recorded, tuple[ChainItem, ...]] = field(default_factory=dict)
    """Outdated inputs of verdicts → the nodes that differ."""
    outdated_proofs: Mapping[ChainItem, tuple[ChainItem, ...]] = field(default_factory=dict)
    """Each outdated proof or analysis → the nodes that differ."""
    texts: ReviewedTexts | None = None
    """The texts that the fingerprints are computed from."""
    answer: Realizability | None = None
    """The result of the analysis of all requirements; None if there is none."""

    @property
    def prints(self) -> Mapping[ChainItem, str]:
        """SHA-256 of each node except the review; white space, comments and order are ignored."""
        prints = dict(self.definition)
        for result in self.results:
            prints[ChainItem(LOG, result.run)] = _print_of_log(result)
            prints[_verdict(result)] = result.judgement
        return prints

    @property
    def links(self) -> tuple[Link, ...]:
        """All links, sorted."""
        review = ChainItem(REVIEW, self.requirement)
        links = dict.fromkeys(self.steps)
        for result in self.results:
            verdict = _verdict(result)
            links |= dict.fromkeys(Link(source, verdict) for source in self.sources)
            links[Link(ChainItem(LOG, result.run), verdict)] = None
            links[Link(verdict, review)] = None
        return tuple(sorted(links))

    @property
    def verdicts(self) -> Mapping[str, str]:
        """Run → its verdict."""
        return {result.run: result.verdict for result in self.results}

    @property
    def outdated(self) -> Mapping[ChainItem, tuple[ChainItem, ...]]:
        """Each outdated verdict, proof or analysis → the nodes that differ."""
        if not self.differences:
            return self.outdated_proofs
        pairs = (
            (_verdict(result), self.differences.get(result.rests_on)) for result in self.results
        )
        return {node: nodes for node, nodes in pairs if nodes} | {**self.outdated_proofs}

    @property
    def unhashed(self) -> tuple[str, ...]:
        """Runs without a SHA-256 of their log."""
        return tuple(result.run for result in self.results if not _print_of_log(result))


def _verdict(result: ResultSummary) -> ChainItem:
    return ChainItem(VERDICT, f"{result.requirement} {result.run}")


def chains(
    project: Project,
    summaries: ResultSummaries | None,
    artefacts: Mapping[RequirementEntry, Sequence[Product]] | None = None,
    proofs: Sequence[Proof] = (),
    known: Mapping[RequirementEntry, VerdictInputs] | None = None,
    analyzed: AnalyzedSet | None = None,
) -> tuple[Chain, ...]:
    """The chain of each requirement, in the order of the project.

    Args:
        project: with or without errors; the chain of an unformalized requirement ends early.
        summaries: results of the evidence; None if no run was audited.
        artefacts: requirement → its products; None: computed by `products`.
        proofs: the results of verification.
        known: the present inputs of a verdict on each requirement; None: they are computed.
        analyzed: the file of `fretc analyze`; None if there is none.
    """
    requirements = {requirement.entry: requirement for requirement in project.formalized}
    results = summaries.by_requirement if summaries else {}
    if artefacts is None:
        artefacts = {entry: products_of(requirement) for entry, requirement in requirements.items()}
    common = _common(project, summaries, artefacts, proofs, known, analyzed)
    return tuple(
        _ChainBuilder(common, entry).build(
            entry,
            requirements.get(entry),
            artefacts.get(entry, ()),
            [each for _, each in results.get(entry.id, ())],
            [proof for proof in proofs if proof.requirement == entry.id],
        )
        for entry in project.requirements
    )


@dataclass(frozen=True, slots=True)
class _Common:
    """Data that all chains of a project share."""

    project: Project
    texts: Mapping[str, RequirementEntry]
    verdict_inputs: Mapping[RequirementEntry, VerdictInputs]
    audited_by: str
    """The version of fretc that wrote the evidence."""
    acceptances: Mapping[RequirementEntry | None, Sequence[Acceptance]]
    """Requirement → acceptances in its header; None → acceptances in the settings."""
    shared: Mapping[str, str]
    """Name of each shared product → its SHA-256; empty if there is no proof."""
    topics: frozenset[str]
    """Topics that an audit of the project reads."""
    written: Mapping[str, Any]
    """The tables of the bindings."""
    answers: Mapping[str, Realizability]
    """Requirement id → result of the analysis of all requirements."""


def _common(
    project: Project,
    summaries: ResultSummaries | None,
    artefacts: Mapping[RequirementEntry, Sequence[Product]],
    proofs: Sequence[Proof],
    known: Mapping[RequirementEntry, VerdictInputs] | None,
    analyzed: AnalyzedSet | None,
) -> _Common:
    shared = shared_products(project.declarations) if proofs else ()
    topics = audited_topics(project)
    return _Common(
        project,
        {requirement.id: requirement for requirement in project.requirements},
        all_verdict_inputs(project, topics, monitors(artefacts)) if known is None else known,
        summaries.source.fretc if summaries else "",
        _by_requirement(project.acceptances),
        {product.file: product.sha256 for product in shared},
        topics,
        texts.written_tables(project.declarations),
        answers(analyzed, project),
    )


def _by_requirement(
    acceptances: Iterable[Acceptance],
) -> Mapping[RequirementEntry | None, Sequence[Acceptance]]:
    found: dict[RequirementEntry | None, list[Acceptance]] = {}
    for acceptance in acceptances:
        found.setdefault(acceptance.requirement, []).append(acceptance)
    return found


class _ChainBuilder:
    """Collects nodes and links of one requirement."""

    def __init__(self, common: _Common, requirement: RequirementEntry) -> None:
        self._common, self._project, self._id = common, common.project, requirement.id
        self._verdict_inputs = common.verdict_inputs[requirement]
        self._prints: dict[ChainItem, str] = {}
        self._links: dict[Link, None] = {}
        self._outdated_proofs: dict[ChainItem, tuple[ChainItem, ...]] = {}
        self._accept: dict[str, str] = {}
        self._hazards: dict[str, texts.HazardTexts] = {}
        self._elsewhere: dict[str, texts.ExternalParent] = {}
        self._above: dict[str, texts.ParentRequirement] = {}

    def build(
        self,
        entry: RequirementEntry,
        requirement: FormalizedRequirement | None,
        artefacts: Iterable[Product],
        results: Sequence[ResultSummary],
        proofs: Sequence[Proof],
    ) -> Chain:
        self._add_parents(entry, {entry.id})
        self._add_status_and_plans(entry)
        self._accepted(entry, requirement)
        sentence = ChainItem(verdict_inputs.SENTENCE, entry.id)
        self._add(sentence, self._verdict_inputs[verdict_inputs.SENTENCE])
        self._link(ChainItem(TEXT, entry.id), sentence)
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
        review = ChainItem(REVIEW, entry.id)
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
        answer: Realizability | None,
        *,
        audited: bool,
    ) -> ReviewedTexts:
        """The texts that the fingerprints are computed from."""
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
            proofs={_claim(proof): (proof.result, *proof.assumptions) for proof in proofs}
            if requirement
            else {},
            loop=texts.loop(written) if proofs and declarations else {},
            analysis=answer.texts if answer else (),
            fretc=__version__ if requirement else "",
        )

    def _add_status_and_plans(self, requirement: RequirementEntry) -> None:
        """Add status and planned methods; only the review depends on them, no verdict."""
        self._add(status_node(self._id), print_of_status(requirement.status))
        for method in requirement.verify:
            self._add(ChainItem(PLAN, f"{self._id} {method}"), digest(method))

    def _accepted(self, entry: RequirementEntry, requirement: FormalizedRequirement | None) -> None:
        """Add the warnings that a reviewer accepts; no verdict depends on them."""
        topics = _topics(requirement, self._project)
        known = self._common.acceptances
        for acceptance in (*known.get(entry, ()), *known.get(None, ())):
            if acceptance.about != TOPIC or acceptance.subject in ("", *topics):
                self._accept[acceptance.name] = acceptance.reason
                self._add(ChainItem(ACCEPTANCE, acceptance.name), print_of_words(acceptance.reason))

    def _add_parents(self, requirement: RequirementEntry, visited: set[str]) -> None:
        """Add all hazards and requirements above the requirement."""
        text = ChainItem(TEXT, requirement.id)
        self._add(text, print_of_header(texts.above(requirement)))
        for parent in requirement.parents:
            hazard, above = self._project.hazards.get(parent), self._common.texts.get(parent)
            if hazard is not None:
                self._hazards[parent] = texts.hazard_texts(hazard)
                self._add(ChainItem(HAZARD, parent), print_of_hazard(hazard))
                self._link(ChainItem(HAZARD, parent), text)
            elif parent in self._project.parents:
                outside = self._project.parents[parent]
                self._elsewhere[parent] = texts.elsewhere(outside)
                self._add(ChainItem(PARENT, parent), print_of_words([outside.title, outside.text]))
                self._link(ChainItem(PARENT, parent), text)
            elif above is not None and parent not in visited:
                visited.add(parent)
                self._above[parent] = texts.above(above)
                self._add_parents(above, visited)
                self._link(ChainItem(TEXT, parent), text)

    def _add_artefacts(
        self, requirement: FormalizedRequirement, sentence: ChainItem, artefacts: Iterable[Product]
    ) -> Mapping[str, ChainItem]:
        """Add formulas, meanings and artefacts; return target → artefact."""
        formulas, words = ChainItem(FORMULAS, requirement.id), ChainItem(WORDS, requirement.id)
        clock, fretc = self._add_clock(), ChainItem(verdict_inputs.FRETC, _VERSION)
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
            node = nodes[product.target] = ChainItem(ARTEFACT, product.file)
            self._add(node, product.sha256)
            for source in (formulas, fretc, *([clock] if product.target == "monitor" else ())):
                self._link(source, node)
        return nodes

    def _add_clock(self) -> ChainItem:
        node = ChainItem(verdict_inputs.CLOCK, "clock")
        self._add(node, self._verdict_inputs[verdict_inputs.CLOCK])
        return node

    def _add_sources(self, monitor: ChainItem | None, *, audited: bool) -> Mapping[str, ChainItem]:
        """Add the inputs of a verdict; return kind → node."""
        nodes = {
            verdict_inputs.FRETC: ChainItem(verdict_inputs.FRETC, _VERSION),
            verdict_inputs.SENTENCE: ChainItem(verdict_inputs.SENTENCE, self._id),
            verdict_inputs.PARAMS: ChainItem(verdict_inputs.PARAMS, self._id),
            verdict_inputs.CLOCK: self._add_clock(),
            verdict_inputs.TOPICS: ChainItem(verdict_inputs.TOPICS, "audited"),
            verdict_inputs.BINDINGS: ChainItem(verdict_inputs.BINDINGS, self._id),
            verdict_inputs.MONITOR: monitor or ChainItem(verdict_inputs.MONITOR, self._id),
        }
        for kind in (
            verdict_inputs.PARAMS,
            verdict_inputs.BINDINGS,
            *([verdict_inputs.TOPICS] if audited else ()),
        ):
            self._add(nodes[kind], self._verdict_inputs[kind])
        return nodes

    def _sources_of_verdicts(self, sources: Mapping[str, ChainItem]) -> tuple[ChainItem, ...]:
        """The direct inputs of each verdict; the monitor takes the place of the sentence."""
        has_monitor = sources[verdict_inputs.MONITOR] in self._prints
        return tuple(
            source
            for kind, source in sources.items()
            if source in self._prints and not (has_monitor and kind == verdict_inputs.SENTENCE)
        )

    def _differences(
        self, results: Sequence[ResultSummary], sources: Mapping[str, ChainItem]
    ) -> Mapping[Recorded, tuple[ChainItem, ...]]:
        """Outdated inputs of results → the nodes that differ."""
        kinds_of = {
            recorded: outdated(recorded, self._common.audited_by, self._verdict_inputs)
            for recorded in {result.rests_on for result in results}
        }
        return {
            recorded: tuple(sources[kind] for kind in kinds)
            for recorded, kinds in kinds_of.items()
            if kinds
        }

    def _add_proofs(self, requirement: FormalizedRequirement, proofs: Sequence[Proof]) -> None:
        """Add each proof, with its files and assumptions."""
        now = self._common.shared
        for proof in proofs:
            node = ChainItem(PROOF, f"{requirement.id} {_claim(proof)}")
            self._add(node, print_of_proof(proof.result, proof.assumptions))
            self._link(ChainItem(FORMULAS, requirement.id), node)
            for name, fingerprint in proof.artefacts.items():
                source = ChainItem(SHARED, name) if name in now else ChainItem(ARTEFACT, name)
                if name in now:
                    self._add(source, now[name])
                if source not in self._prints:
                    continue
                self._link(source, node)
                if self._prints[source] != fingerprint:
                    before = self._outdated_proofs.get(node, ())
                    self._outdated_proofs[node] = (*before, source)

    def _add_answer(self, answer: Realizability) -> None:
        """Add the result of the analysis, with the members that have changed since."""
        node = ChainItem(ANALYSIS, self._id)
        self._add(node, print_of_proof(answer.verdict, answer.findings))
        self._link(ChainItem(FORMULAS, self._id), node)
        if answer.differing:
            self._outdated_proofs[node] = tuple(ChainItem(MEMBER, id) for id in answer.differing)

    def _add(self, node: ChainItem, fingerprint: str) -> None:
        self._prints[node] = fingerprint

    def _link(self, source: ChainItem, target: ChainItem) -> None:
        self._links[Link(source, target)] = None


# Fingerprints ----------------------------------------------------------------------------------

_VERSION = "version"
IN_FORCE = digest("in force")
"""The fingerprint of the status of a draft or approved requirement."""


def print_of_status(status: str) -> str:
    """Fingerprint of a status: drafts and approved requirements share one."""
    return digest("retired") if status == "retired" else IN_FORCE


def status_node(requirement: str) -> ChainItem:
    """The node of the status of a requirement."""
    return ChainItem(STATUS, requirement)


def outdated(recorded: Recorded, audited_by: str, now: VerdictInputs) -> tuple[str, ...]:
    """The kinds of inputs of a result that have changed since its audit."""
    then = {
        **dict(zip(verdict_inputs.KINDS, recorded, strict=True)),
        verdict_inputs.FRETC: audited_by,
    }
    return verdict_inputs.outdated(then, {**now, verdict_inputs.FRETC: __version__})


def _print_of_log(result: ResultSummary) -> str:
    """SHA-256 of the log, or of its summary if the audit read only its index; or "" if unknown."""
    return result.log or result.fingerprints.log_summary or ""


def _topics(requirement: FormalizedRequirement | None, project: Project) -> set[str]:
    """The topics from which the propositions of a requirement are computed."""
    if requirement is None or project.declarations is None:
        return set()
    read = project.declarations.restricted_to(requirement.watched)
    return {signal.path.topic for signal in read.signals.values()}


def print_of_header(header: texts.ParentRequirement) -> str:
    """The texts and parents of a requirement, without status and planned methods."""
    words = [header.title, header.text, header.rationale]
    return digest({"texts": _normal(words), "parents": sorted(header.parents)})


def print_of_hazard(hazard: Hazard) -> str:
    """Fingerprint of the texts and the id of a hazard."""
    return print_of_words(asdict(hazard))


def print_of_words(value: Any) -> str:
    """Fingerprint of texts, without regard to white space."""
    return digest(_normal(value))


def print_of_proof(result: str, assumptions: Iterable[str]) -> str:
    """Fingerprint of the result and the assumptions of a proof or analysis."""
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
    """A link that depends on an item that has changed since the review."""

    link: Link
    causes: tuple[ChainItem, ...]
    """The original changes upstream of the link, without changes that follow from them."""


def changed(
    prints: Mapping[ChainItem, str], locked: Mapping[ChainItem, str]
) -> tuple[ChainItem, ...]:
    """The nodes that were changed, added or removed since the lock, sorted."""
    return tuple(
        sorted(node for node in {*prints, *locked} if prints.get(node) != locked.get(node))
    )


def suspects(chain: Chain, locked: Mapping[ChainItem, str]) -> tuple[Suspect, ...]:
    """The links downstream of changes since the lock, those nearest to a change first.

    An outdated verdict or proof is suspect too, whatever the lock records: a verdict on changed
    bindings stays outdated when the reviewed bindings are restored.

    Args:
        chain: the present chain.
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
    causes_of: dict[Link, set[ChainItem]] = {}
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
    review = ChainItem(REVIEW, chain.requirement)
    suspect.extend(Suspect(Link(node, review), (node,)) for node in gone)
    return tuple(suspect)


def _first(
    causes: set[ChainItem], upstream: Mapping[ChainItem, frozenset[ChainItem]]
) -> Iterator[ChainItem]:
    """The causes that do not follow from another cause."""
    return (
        cause
        for cause in causes
        if cause.kind not in DERIVED or not upstream.get(cause, frozenset()) & causes
    )


def upstream_of(
    nodes: Iterable[ChainItem], links: Sequence[Link]
) -> dict[ChainItem, frozenset[ChainItem]]:
    """Each node → all nodes that lead to it."""
    above: dict[ChainItem, set[ChainItem]] = {node: set() for link in links for node in link}
    above |= {node: set() for node in nodes if node not in above}
    for link in links:
        above[link.target].add(link.source)
    upstream: dict[ChainItem, frozenset[ChainItem]] = {}

    def reach(node: ChainItem) -> frozenset[ChainItem]:
        if node not in upstream:
            upstream[node] = frozenset()  # A requirement may be its own ancestor.
            upstream[node] = frozenset(above[node]).union(
                *(reach(source) for source in above[node])
            )
        return upstream[node]

    for node in above:
        reach(node)
    return upstream
