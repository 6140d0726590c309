"""Building the chain of each requirement from project, evidence, proofs and analysis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Proof
from compiler.project.acceptances import TOPIC, Acceptance
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
from fretc.traceability.chain import (
    ACCEPTANCE,
    ANALYSIS,
    ARTEFACT,
    FORMULAS,
    HAZARD,
    MEMBER,
    PARENT,
    PLAN,
    PROOF,
    REVIEW,
    SHARED,
    TEXT,
    WORDS,
    Chain,
    ChainItem,
    Link,
    status_node,
)
from fretc.traceability.fingerprints import (
    outdated,
    print_of_formulas,
    print_of_hazard,
    print_of_header,
    print_of_proof,
    print_of_status,
    print_of_words,
)
from fretc.traceability.texts import ReviewedTexts
from fretish.bindings.canonical import described, digest
from fretish.classes.frozen import dataclass
from fretish.documents import RequirementEntry

_READINGS = ("ltl", "json")
"""Targets that only print formulas; formulas have nodes of their own."""
_VERSION = "version"
"""Name of the node of fretc, whose fingerprint is its version."""


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
            kind=entry.kind if entry.is_assumption else "",
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
        self._add(formulas, print_of_formulas(requirement))
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


def _topics(requirement: FormalizedRequirement | None, project: Project) -> set[str]:
    """The topics from which the propositions of a requirement are computed."""
    if requirement is None or project.declarations is None:
        return set()
    read = project.declarations.restricted_to(requirement.watched)
    return {signal.path.topic for signal in read.signals.values()}


def _claim(proof: Proof) -> str:
    return f"{proof.layer}: {proof.claim}"
