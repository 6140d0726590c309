"""The assurance argument: hazards are controlled because evidence shows that requirements hold.

The argument claims no more than the report. A goal without evidence is undeveloped. Counter-
evidence is a solution that challenges its goal; current counter-evidence defeats the goal. A proof
supports the goal about its own subject: a proof about a monitor supports the monitor.

Source: GSN Community Standard, version 3 (2021), part 1, with its dialectic extension.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from types import MappingProxyType

from compiler.logic.claims import METHODS, ClaimResult, Layer
from fretc.audit.evidence.verdicts import BROKEN
from fretc.audit.measurements.confidence_intervals import REFUTED, SUPPORTED
from fretc.report.model import phrases
from fretc.report.model.results import ResultRow
from fretc.report.model.views import ProofView, ReportView, RequirementView
from fretc.report.sections.proofs import SHARED, covering, is_proved
from fretish.classes.frozen import dataclass


class ElementKind(StrEnum):
    """The elements of GSN; the values are the prefixes of gsn2x."""

    GOAL = "G"
    STRATEGY = "S"
    SOLUTION = "Sn"
    CONTEXT = "C"
    ASSUMPTION = "A"
    JUSTIFICATION = "J"
    COUNTER_SOLUTION = "CSn"


@dataclass(frozen=True, slots=True)
class Element:
    """One element; ids are unique and begin with the prefix of their kind."""

    id: str
    kind: ElementKind
    text: str
    supported_by: tuple[str, ...] = ()
    in_context_of: tuple[str, ...] = ()
    undeveloped: bool = False
    challenges: str = ""
    """The goal that a counter-solution challenges."""
    defeated: bool = False
    """Whether current counter-evidence challenges the goal."""
    name: str = ""
    """The short name in a reference; "" for the text."""


_SUBJECTS: Mapping[str, str] = MappingProxyType(
    {
        Layer.MONITOR: "The monitor of {id} gives the verdicts that the sentence demands",
        Layer.LOOP: "Monitor and interceptor satisfy {id} in the modelled loop",
        Layer.BOUNDS: "The claims about {id} at other bounds and latencies hold in the loop",
        Layer.INTERCEPTOR: "The interceptor of {id} fulfils its contracts",
        Layer.AGENT: "The agent satisfies {id} in its model",
        Layer.AJPF: "The agent satisfies {id}, according to AJPF",
    }
)
"""The goal that the proofs of each layer support."""
_SHARED_SUBJECTS: Mapping[str, str] = MappingProxyType(
    {
        "interceptor": "The interceptor fulfils its contracts",
        "agent": "The agent has the properties of its property file in its model",
    }
)
"""The goal that proofs about shared parts support."""
_NAMED = 3
"""Maximum number of violating runs that an element names; others are counted."""


def argument(report: ReportView) -> tuple[Element, ...]:
    """All elements, the top goal first, each after those that refer to it."""
    return tuple(_Argument(report).elements())


class _Argument:
    """Yields the elements of a report, each once."""

    def __init__(self, report: ReportView) -> None:
        self._report = report
        self._views = {view.anchor: view for view in report.requirements}
        self._shared = {
            name: [proof for proof in report.proofs if proof.requirement == name] for name in SHARED
        }
        self._yielded: set[str] = set()

    def elements(self) -> Iterator[Element]:
        report = self._report
        hazards = [hazard.id for hazard in report.hazards]
        untraced = [row.anchor for row in report.matrix if not row.hazard]
        name = ", ".join(report.components) or report.project
        below = (
            *(["S_hazards"] if hazards else []),
            *(["S_others"] if untraced else []),
            *(_id("G_shared", name) for name, proofs in self._shared.items() if proofs),
        )
        assumed = [f"A_{number}" for number, _ in enumerate(report.assumptions, 1)]
        context = ("C_project", *assumed)
        text = f"{name} satisfies its safety requirements"
        yield Element("G_top", ElementKind.GOAL, text, below, context, undeveloped=not below)
        yield Element(
            "C_project", ElementKind.CONTEXT, f"Requirements in {report.project}; {report.claims}"
        )
        for id, words in zip(assumed, report.assumptions, strict=True):
            yield Element(id, ElementKind.ASSUMPTION, words)
        if hazards:
            goals = tuple(_id("G_hazard", hazard) for hazard in hazards)
            yield Element(
                "S_hazards", ElementKind.STRATEGY, "Argument over each declared hazard", goals
            )
            for hazard in report.hazards:
                anchors = [row.anchor for row in report.matrix if row.hazard == hazard.id]
                yield from self._hazard(hazard.id, hazard.title, anchors)
        if untraced:
            goals = tuple(_id("G", anchor) for anchor in dict.fromkeys(untraced))
            words = "Argument over the requirements that are not traced to a hazard"
            yield Element("S_others", ElementKind.STRATEGY, words, goals)
            yield from self._requirements(untraced)
        for name, proofs in self._shared.items():
            if proofs:
                yield from _subject(_id("G_shared", name), _SHARED_SUBJECTS[name], proofs)

    def _hazard(self, id: str, title: str, anchors: Sequence[str]) -> Iterator[Element]:
        below = tuple(_id("G", anchor) for anchor in dict.fromkeys(anchors))
        text = f"{id} is controlled: {title}"
        yield Element(
            _id("G_hazard", id),
            ElementKind.GOAL,
            text,
            below,
            (),
            not below,
            name=f"{id} is controlled",
        )
        yield from self._requirements(anchors)

    def _requirements(self, anchors: Sequence[str]) -> Iterator[Element]:
        """The elements of each requirement, without duplicates if it has several hazards."""
        for anchor in anchors:
            if anchor not in self._yielded:
                self._yielded.add(anchor)
                yield from self._requirement(self._views[anchor])

    def _requirement(self, view: RequirementView) -> Iterator[Element]:
        goal = _id("G", view.anchor)
        is_shown = view.mark.shows
        counters = tuple(_counter_evidence(view, goal.replace("G_", "CSn_", 1)))
        layers = {
            layer: [proof for proof in view.proofs if proof.layer == layer]
            for layer in dict.fromkeys(proof.layer for proof in view.proofs)
        }
        subjects = [f"{goal}_{layer}" for layer in layers] + self._shared_goals(view)
        solution, runs = goal.replace("G_", "Sn_", 1), f"{goal}_runs"
        # A goal with proofs is developed; where no run shows it, a goal about runs below it is not.
        evidence = [solution] if is_shown else [runs] if subjects else []
        context, waived = goal.replace("G_", "C_", 1), goal.replace("G_", "J_", 1)
        yield Element(
            goal,
            ElementKind.GOAL,
            f"{view.id} holds: {view.sentence}",
            (*evidence, *subjects),
            (*([context] if view.meaning else []), *([waived] if view.waiver else [])),
            undeveloped=not (evidence or subjects),
            defeated=any(counter.is_current for counter in counters),
            name=f"{view.id} holds",
        )
        if view.meaning:
            yield Element(context, ElementKind.CONTEXT, view.meaning)
        if view.waiver:
            note = "" if view.waiver.signature.is_good else " (unauthenticated)"
            by = f"{view.waiver.by}{note}"
            words = f"Waived until {view.waiver.until} by {by}: {view.waiver.reason}"
            yield Element(waived, ElementKind.JUSTIFICATION, words)
        for counter in counters:
            yield Element(counter.id, ElementKind.COUNTER_SOLUTION, counter.text, challenges=goal)
        if is_shown:
            yield Element(solution, ElementKind.SOLUTION, _support(view))
        elif subjects:
            yield Element(
                runs, ElementKind.GOAL, f"The audited runs show {view.id}", undeveloped=True
            )
        for layer, proofs in layers.items():
            subject = _SUBJECTS[layer].format(id=view.id)
            yield from _subject(f"{goal}_{layer}", subject, proofs)

    def _shared_goals(self, view: RequirementView) -> list[str]:
        """The goals about shared parts whose proofs are results of methods that this one plans."""
        methods = [plan.method for plan in view.planned if plan.method in METHODS]
        return [
            _id("G_shared", name)
            for name, proofs in self._shared.items()
            if any(covering(method, proofs) for method in methods)
        ]


# Runs ------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _CounterEvidence:
    """Counter-evidence against a goal."""

    id: str
    text: str
    is_current: bool
    """Whether the counter-evidence is about the present requirement."""


def _support(view: RequirementView) -> str:
    runs = phrases.times(len(view.results), "audited run")
    if view.mark.word == SUPPORTED and view.probability is not None:
        return f"{view.id} is {SUPPORTED} by {runs}: {view.probability.reason}"
    limit = f". {view.limit}" if view.limit else ""
    return f"{view.id} is {view.mark.word} in {runs}{limit}"


def _counter_evidence(view: RequirementView, id: str) -> Iterator[_CounterEvidence]:
    """Counter-evidence: violating runs, suspect ones separately, or the estimate."""
    probability = view.probability
    if probability is not None:
        if probability.mark.word == REFUTED:
            words = f"{view.id} is {REFUTED} over all runs: {probability.reason}"
            yield _CounterEvidence(id, words, not probability.suspicions)
        return
    broken = [result for result in view.results if result.mark.word in BROKEN]
    for old in (False, True):
        results = [result for result in broken if bool(result.suspicions) is old]
        if results:
            yield _CounterEvidence(
                f"{id}_older" if old else id, _violated(view, results, old), not old
            )


def _violated(view: RequirementView, violating: Sequence[ResultRow], old: bool) -> str:
    runs = phrases.times(len(view.results), "audited run")
    worst = sorted(violating, key=lambda result: -result.violations_total)[:_NAMED]
    left = len(violating) - len(worst)
    repeated = len({result.run_file for result in worst}) < len(worst)
    named = [f"{r.run_label if repeated else r.run_file}: {r.reason}" for r in worst]
    more = [f"and {phrases.times(left, 'more run')}"] if left else []
    why = phrases.joined(list(dict.fromkeys(why for each in violating for why in each.suspicions)))
    age = f", before a change ({why})" if old else ""
    words = f"{view.id} is violated in {phrases.whole(len(violating))} of {runs}{age}"
    return "; ".join([f"{words}: {named[0]}", *named[1:], *more])


# Proofs ----------------------------------------------------------------------------------------


def _subject(goal: str, text: str, proofs: Sequence[ProofView]) -> Iterator[Element]:
    """The goal of one layer, with its claims that are proved, refuted, and open."""
    proved = [proof for proof in proofs if is_proved(proof)]
    against = [proof for proof in proofs if proof.mark.word == ClaimResult.COUNTEREXAMPLE]
    left = [proof for proof in proofs if proof not in proved and proof not in against]
    solution, counter = goal.replace("G_", "Sn_", 1), goal.replace("G_", "CSn_", 1)
    assumption, rest = goal.replace("G_", "A_", 1), f"{goal}_rest"
    assumed = dict.fromkeys(each for proof in proved for each in proof.assumptions)
    below = (*([solution] if proved else []), *([rest] if proved and left else []))
    yield Element(
        goal,
        ElementKind.GOAL,
        text,
        below,
        (assumption,) if assumed else (),
        undeveloped=not below,
        defeated=any(not proof.suspicions for proof in against),
    )
    if assumed:
        yield Element(assumption, ElementKind.ASSUMPTION, "; ".join(assumed))
    if against:
        words = _claims("Counterexample to", against)
        yield Element(counter, ElementKind.COUNTER_SOLUTION, words, challenges=goal)
    if proved:
        yield Element(solution, ElementKind.SOLUTION, _claims("Proved:", proved))
    if rest in below:
        yield Element(rest, ElementKind.GOAL, _claims("Not shown:", left), undeveloped=True)


def _claims(head: str, proofs: Sequence[ProofView]) -> str:
    """`Proved: it stops; it moves again (by Spot 2.13)`."""
    by = dict.fromkeys(proof.engine for proof in proofs)
    why = dict.fromkeys(why for proof in proofs for why in proof.suspicions)
    note = "; ".join([f"by {phrases.joined(list(by))}", *why])
    return f"{head} {'; '.join(proof.claim for proof in proofs)} ({note})"


def _id(prefix: str, name: str) -> str:
    """A valid GSN id; distinct for distinct names."""
    return f"{prefix}_{re.sub(r'[^A-Za-z0-9]', lambda m: f'_{ord(m[0]):x}_', name)}"
