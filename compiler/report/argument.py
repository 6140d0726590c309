"""The assurance argument: hazards are controlled because requirements hold, as the evidence shows.

Goals that nothing shows stay undeveloped: an argument never says more than the report.
Source: GSN Community Standard, version 3 (2021), part 1.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum

from compiler.report import phrases
from compiler.report.proofs import is_proved, is_refuted
from compiler.report.views import Report, RequirementView


class Kind(StrEnum):
    """The elements of GSN; the values are the prefixes of gsn2x."""

    GOAL = "G"
    STRATEGY = "S"
    SOLUTION = "Sn"
    CONTEXT = "C"
    ASSUMPTION = "A"
    JUSTIFICATION = "J"


@dataclass(frozen=True, slots=True)
class Element:
    """One element; ids are unique and begin with the prefix of their kind."""

    id: str
    kind: Kind
    text: str
    supported_by: tuple[str, ...] = ()
    in_context_of: tuple[str, ...] = ()
    undeveloped: bool = False


def argument(report: Report) -> tuple[Element, ...]:
    """All elements, the top goal first, each after those that refer to it."""
    return tuple(_Argument(report).elements())


class _Argument:
    def __init__(self, report: Report) -> None:
        self._report = report
        self._views = {view.anchor: view for view in report.requirements}
        self._told: set[str] = set()

    def elements(self) -> Iterator[Element]:
        report = self._report
        hazards = [hazard.id for hazard in report.hazards]
        loose = [row.anchor for row in report.matrix if not row.hazard]
        name = ", ".join(report.components) or report.project
        below = (*(["S_hazards"] if hazards else []), *(["S_others"] if loose else []))
        assumed = [f"A_{number}" for number, _ in enumerate(report.assumptions, 1)]
        context = ("C_project", *assumed)
        text = f"{name} keeps its safety requirements"
        yield Element("G_top", Kind.GOAL, text, below, context, undeveloped=not below)
        yield Element(
            "C_project", Kind.CONTEXT, f"Requirements in {report.project}; {report.claims}"
        )
        for id, said in zip(assumed, report.assumptions, strict=True):
            yield Element(id, Kind.ASSUMPTION, said)
        if hazards:
            goals = tuple(_id("G_hazard", hazard) for hazard in hazards)
            yield Element("S_hazards", Kind.STRATEGY, "Argument over each declared hazard", goals)
            for hazard in report.hazards:
                anchors = [row.anchor for row in report.matrix if row.hazard == hazard.id]
                yield from self._hazard(hazard.id, hazard.title, anchors)
        if loose:
            goals = tuple(self._goal(anchor) for anchor in dict.fromkeys(loose))
            said = "Argument over the requirements that trace to no hazard"
            yield Element("S_others", Kind.STRATEGY, said, goals)
            yield from self._requirements(loose)

    def _hazard(self, id: str, title: str, anchors: Sequence[str]) -> Iterator[Element]:
        below = tuple(self._goal(anchor) for anchor in dict.fromkeys(anchors))
        text = f"{id} is controlled: {title}"
        yield Element(_id("G_hazard", id), Kind.GOAL, text, below, undeveloped=not below)
        yield from self._requirements(anchors)

    def _requirements(self, anchors: Sequence[str]) -> Iterator[Element]:
        """Each once, however many hazards it controls."""
        for anchor in anchors:
            if anchor not in self._told:
                self._told.add(anchor)
                yield from self._requirement(self._views[anchor])

    def _requirement(self, view: RequirementView) -> Iterator[Element]:
        goal = self._goal(view.anchor)
        shown = view.mark.shows and not is_refuted(view)
        proved = [proof for proof in view.proofs if is_proved(proof)]
        solution = goal.replace("G_", "Sn_", 1)
        # A goal is developed or not: what is proved of one that is not shown is context.
        proofs = f"{solution if shown else goal.replace('G_', 'C_', 1)}_proofs"
        context = goal.replace("G_", "C_", 1)
        waived = goal.replace("G_", "J_", 1)
        around = [context] if view.meaning else []
        around += [waived] if view.waiver else []
        around += [proofs] if proved and not shown else []
        text = f"{view.id} holds: {view.sentence}"
        below = (solution, *([proofs] if proved else [])) if shown else ()
        yield Element(goal, Kind.GOAL, text, below, tuple(around), undeveloped=not shown)
        if view.meaning:
            yield Element(context, Kind.CONTEXT, view.meaning)
        if view.waiver:
            said = f"Waived until {view.waiver.until} by {view.waiver.by}: {view.waiver.reason}"
            yield Element(waived, Kind.JUSTIFICATION, said)
        if shown:
            runs = phrases.times(len(view.results), "audited run")
            yield Element(solution, Kind.SOLUTION, f"{view.id} is {view.mark.word} in {runs}")
        if proved:
            layers = phrases.joined(list(dict.fromkeys(proof.layer for proof in proved)))
            claims = phrases.times(len(proved), "claim")
            kind = Kind.SOLUTION if shown else Kind.CONTEXT
            yield Element(proofs, kind, f"{claims} about {view.id} proved ({layers})")

    def _goal(self, anchor: str) -> str:
        return _id("G", anchor)


def _id(prefix: str, name: str) -> str:
    """Different for different names; anchors of requirements begin with `req-`."""
    return f"{prefix}_{re.sub(r'[^A-Za-z0-9]', lambda m: f'_{ord(m[0]):x}_', name)}"
