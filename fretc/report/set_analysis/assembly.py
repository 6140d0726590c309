"""The view of the file of `fretc analyze`, and whether it is up to date."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from compiler.project.project import Project
from fretc.analysis.assumptions import assumptions, guarantees
from fretc.analysis.evidence import AnalysisDocument, AnalyzedSet, suspicions
from fretc.analysis.findings import Analysis, RealizabilityVerdict
from fretc.analysis.text_output import SIGNS, columns, lanes, remarks
from fretc.report.model import phrases
from fretc.report.model.front import Front
from fretc.report.model.marks import Mark, sign_mark
from fretc.report.model.sets import (
    REALIZABLE,
    UNREALIZABLE,
    Play,
    PlayLane,
    SetAnalysis,
    SetComponent,
    SetConflict,
    SetMember,
)
from fretc.report.model.views import Overall
from fretish.bindings.declarations import Role
from fretish.diagnostics import status_symbols as signs
from fretish.reading.natural_order import natural

_WORDS: Mapping[RealizabilityVerdict, str] = {
    RealizabilityVerdict.REALIZABLE: REALIZABLE,
    RealizabilityVerdict.UNREALIZABLE: UNREALIZABLE,
    RealizabilityVerdict.NOT_CHECKED: str(RealizabilityVerdict.NOT_CHECKED),
}


def set_analysis(known: AnalyzedSet, project: Project, anchors: Mapping[str, str]) -> SetAnalysis:
    """The view of the analysis.

    Args:
        known: the file of `fretc analyze`.
        project: the present project.
        anchors: id → anchor of the requirement.
    """
    requirements = guarantees(project.in_force)
    assumed, mistakes = assumptions(project.in_force, project.declarations)
    old = [
        *suspicions(known.document, requirements, assumed),
        *(
            f"an assumption has an error: {mistake.message}"
            for mistake in mistakes
            if mistake.is_error
        ),
    ]
    analysis = known.document.analysis
    view = _Views(known.document, anchors)
    return SetAnalysis(
        file=phrases.place(known.file),
        fretc=known.document.fretc,
        mark=replace(_mark(analysis.verdict), suspect=bool(old)),
        headline=_headline(analysis),
        suspicions=tuple(old),
        left_out=tuple(entry.id for entry in project.without_rule if entry.is_in_force),
        components=tuple(
            SetComponent(
                _mark(component.verdict),
                view.members(component.requirements),
                component.outputs,
                component.why,
            )
            for component in analysis.components
        ),
        conflicts=tuple(
            SetConflict(
                view.members(conflict.requirements),
                conflict.because,
                view.play(conflict.play, conflict.loop, conflict.requirements),
            )
            for conflict in analysis.conflicts
        ),
        complete=analysis.complete,
        clashes=tuple(
            SetConflict(
                view.members(conflict.requirements),
                "",
                view.play(conflict.play, None, conflict.requirements),
            )
            for conflict in analysis.inconsistent
        ),
        remarks=tuple(text.strip() for text, _ in remarks(analysis)),
        assumptions=tuple(assumption.in_words for assumption in analysis.assumptions),
        inputs=_of_role(analysis, Role.INPUT),
        outputs=_of_role(analysis, Role.OUTPUT),
        terms=analysis.terms,
        open=tuple(f"{question.question}: {question.why}" for question in analysis.open),
    )


def _mark(verdict: RealizabilityVerdict) -> Mark:
    return sign_mark(_WORDS[verdict], SIGNS[verdict])


def _of_role(analysis: Analysis, role: Role) -> tuple[str, ...]:
    return tuple(name for name, own in analysis.roles.items() if own is role)


def _headline(analysis: Analysis) -> str:
    """The result in a sentence."""
    match analysis.verdict:
        case RealizabilityVerdict.REALIZABLE:
            held = ", while the assumptions hold" if analysis.assumptions else ""
            return f"All requirements can be satisfied together{held}."
        case RealizabilityVerdict.NOT_CHECKED:
            return (
                f"Whether all requirements can be satisfied together is not known: {analysis.why}."
            )
        case RealizabilityVerdict.UNREALIZABLE if analysis.conflicts:
            ids = sorted(analysis.conflicts[0].requirements, key=natural)
            what = "can be kept by no system" if len(ids) == 1 else "cannot be satisfied together"
            more = len(analysis.conflicts) - 1
            rest = f"; there {'is' if more == 1 else 'are'} {phrases.times(more, 'more conflict')}"
            return (
                f"{phrases.joined(ids)} {what}{rest if more else ''}. This follows from the "
                f"sentences, not from the runs."
            )
        case RealizabilityVerdict.UNREALIZABLE:
            return f"No system can keep all requirements: they {analysis.why}."


class _Views:
    """Builds views of members and runs."""

    def __init__(self, document: AnalysisDocument, anchors: Mapping[str, str]) -> None:
        self._document, self._anchors = document, anchors

    def members(self, ids: Sequence[str]) -> tuple[SetMember, ...]:
        known = self._document.requirements
        return tuple(
            SetMember(id, self._anchors.get(id, ""), known[id].sentence)
            for id in sorted(ids, key=natural)
        )

    def play(
        self, ticks: Sequence[Mapping[str, object]], loop: int | None, ids: Sequence[str]
    ) -> Play:
        """The view of a run of some requirements in columns; `loop` is a tick."""
        roles = self._document.analysis.roles_in(ids)
        names = lanes(ticks, roles)
        lines = columns(ticks, names)
        back = [i for i, each in enumerate(lines) if loop is not None and each.first <= loop]
        return Play(
            tuple(conflict.head for conflict in lines),
            tuple(
                PlayLane(
                    name, str(roles.get(name, "")), tuple(conflict.values[i] for conflict in lines)
                )
                for i, name in enumerate(names)
            ),
            back[-1] if back else None,
        )


# The first screen ------------------------------------------------------------------------------


def sentence(analysis: SetAnalysis) -> str:
    """The sentence for the headline; "" if the analysis is good."""
    if analysis.is_good:
        return ""
    parts = [] if analysis.mark.word == REALIZABLE else [analysis.headline]
    if analysis.suspicions:
        why = phrases.some(analysis.suspicions, 3)
        parts.append(f"The analysis of all requirements together is suspect: {why}.")
    if analysis.left_out:
        names = phrases.some(analysis.left_out)
        parts.append(f"Not analyzed: whether {names} can be satisfied together with the others.")
    return " ".join(parts)


def in_overall(overall: Overall, analysis: SetAnalysis | None) -> Overall:
    """The overall result, extended by the result of the analysis."""
    if analysis is None:
        return overall
    if analysis.is_good:
        return replace(overall, sentences=(*overall.sentences, analysis.headline))
    mark = overall.mark
    if analysis.is_broken and mark.kind != signs.BAD.kind:
        mark = analysis.mark
    elif mark.kind == signs.GOOD.kind:
        mark = sign_mark("not all shown", signs.OPEN)
    return replace(overall, mark=mark, headline=f"{overall.headline} {sentence(analysis)}")


def in_front(front: Front, analysis: SetAnalysis | None) -> Front:
    """The first screen, extended by the result of the analysis unless the headline contains it."""
    said = "" if analysis is None else sentence(analysis)
    if not said or said in front.headline:
        return front
    return replace(front, headline=f"{front.headline} {said}")
