"""Recheck of an analysis: its questions are answered again and the answers compared.

Questions that timed out or were stopped, then or now, are not checked. Any other change is a
difference, also a missing conflict. Only `seconds` is not compared.
"""

from __future__ import annotations

from collections.abc import Iterator

from compiler.files.build_id import __version__
from fretc.analysis.evidence import AnalysisDocument
from fretc.analysis.findings import Analysis, Component, Conflict, RealizabilityVerdict
from fretc.reproduction.outcome import TOGETHER, ItemOutcome, Recheck, differs, unknown

_REST = (
    "verdict", "repairs", "redundant", "removable", "vacuous", "consistent", "inconsistent",
    "always", "never", "assumptions", "roles", "terms",
)  # fmt: skip
_OF_TIME = ("why", "complete", "open")
"""Fields that may differ if a question timed out."""


def compared(document: AnalysisDocument, now: Analysis) -> Iterator[Recheck]:
    """Compare each component, each conflict and the other findings with a present analysis.

    Args:
        document: the evidence.
        now: a present analysis of the requirements, under the present assumptions.
    """
    before = document.analysis
    if document.as_fret:
        yield unknown(
            TOGETHER, "", "it answers FRET's question, not whether the requirements are realizable"
        )
    if {document.fretc, before.fretc} != {__version__}:
        yield differs(TOGETHER, "", f"the installed fretc is {__version__}")
    known = {component.requirements: component for component in now.components}
    for component in before.components:
        yield _component(component, known.get(component.requirements))
    then = {component.requirements for component in before.components}
    for ids in (each for each in known if each not in then):
        yield differs(TOGETHER, "", "it is missing from the file", claim=", ".join(ids))
    if len(then) != len(before.components):
        yield differs(TOGETHER, "", "a component appears twice")
    yield from _conflicts(before, now)
    others = [name for name in _REST if getattr(before, name) != getattr(now, name)]
    claim = "other results"
    if others and not (before.open or now.open):
        yield differs(TOGETHER, "", f"it differs in {', '.join(others)}", claim=claim)
    elif others:
        why = f"some questions have no answer, so {', '.join(others)} may differ"
        yield unknown(TOGETHER, "", why, claim=claim)
    elif any(getattr(before, name) != getattr(now, name) for name in _OF_TIME):
        why = f"the open questions are now: {_questions(now)}; they were: {_questions(before)}"
        yield unknown(TOGETHER, "", why, claim=claim)
    else:
        yield Recheck(TOGETHER, "", ItemOutcome.STANDS, (), claim)


def _questions(analysis: Analysis) -> str:
    return (
        "; ".join(f"{question.question} ({question.why})" for question in analysis.open) or "none"
    )


def _component(before: Component, now: Component | None) -> Recheck:
    claim = ", ".join(before.requirements)
    if now is None or before.outputs != now.outputs:
        return differs(TOGETHER, "", "these requirements are not a component now", claim=claim)
    if now.verdict is RealizabilityVerdict.NOT_CHECKED:
        return unknown(TOGETHER, "", now.why, claim=claim)
    if before.verdict is now.verdict and before.why != now.why:
        return unknown(
            TOGETHER, "", f"the reason is now `{now.why}`, and was `{before.why}`", claim=claim
        )
    if before.verdict is now.verdict:
        return Recheck(TOGETHER, "", ItemOutcome.STANDS, (), f"{claim}: {now.verdict}")
    why = f"they are {now.verdict} now, and the file says {before.verdict}"
    if (
        before.verdict is RealizabilityVerdict.NOT_CHECKED
        and now.verdict is RealizabilityVerdict.REALIZABLE
    ):
        return unknown(TOGETHER, "", why, claim=claim)
    return differs(TOGETHER, "", why, claim=claim)


def _conflicts(before: Analysis, now: Analysis) -> Iterator[Recheck]:
    then, found = _by_members(before), _by_members(now)
    for ids in dict.fromkeys((*then, *found)):
        claim = f"conflict of {', '.join(ids)}"
        old, new = then.get(ids), found.get(ids)
        if old == new:
            yield Recheck(TOGETHER, "", ItemOutcome.STANDS, (), claim)
        elif old is None:
            judge = differs if before.complete else unknown
            yield judge(TOGETHER, "", "it is missing from the file", claim=claim)
        elif new is None:
            judge = differs if now.complete else unknown
            yield judge(TOGETHER, "", "this conflict does not exist now", claim=claim)
        else:
            yield differs(TOGETHER, "", "its counterexample run differs", claim=claim)
    if len(then) != len(before.conflicts):
        yield differs(TOGETHER, "", "a conflict appears twice")


def _by_members(analysis: Analysis) -> dict[tuple[str, ...], Conflict]:
    return {conflict.requirements: conflict for conflict in analysis.conflicts}
