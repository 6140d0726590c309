"""The chain from hazard to review as a graph: nodes with fingerprints, and dependency links.

A change since a review makes only the links downstream of it suspect. A suspect link names what to
review again; the other reviews stay valid.

Source: ISO 26262-8 clause 6 (traceability of safety requirements) asks for links
that can be followed both ways; Doorstop and StrictDoc call a link suspect whose parent changed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import NamedTuple

from fretc.audit.evidence import verdict_inputs
from fretc.audit.evidence.result_summaries import Recorded, ResultSummary
from fretc.traceability.analyses import Realizability
from fretc.traceability.fingerprints import print_of_log
from fretc.traceability.texts import ReviewedTexts
from fretish.classes.frozen import dataclass

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
            prints[ChainItem(LOG, result.run)] = print_of_log(result)
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
        return tuple(result.run for result in self.results if not print_of_log(result))


def _verdict(result: ResultSummary) -> ChainItem:
    return ChainItem(VERDICT, f"{result.requirement} {result.run}")


def status_node(requirement: str) -> ChainItem:
    """The node of the status of a requirement."""
    return ChainItem(STATUS, requirement)
