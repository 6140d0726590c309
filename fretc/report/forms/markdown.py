"""`--markdown`: a summary on one screen for the reviewer of a pull request.

The summary has at most forty lines. Omitted items are counted; none of them is worse than a listed
one.

Source: GitHub Flavored Markdown Spec 0.29, tables (extension).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import chain
from typing import TypeVar

from fretc.audit.evidence.verdicts import BROKEN, RETIRED, SUSPECT
from fretc.report.front.gravity import gravities
from fretc.report.front.violations import gravest_first
from fretc.report.model import phrases
from fretc.report.model.changes import follows
from fretc.report.model.marks import Mark
from fretc.report.model.results import ResultRow, ResultView
from fretc.report.model.views import ReportView, RequirementView, worst_first
from fretc.report.sections.details import Details
from fretc.report.sections.proofs import is_refuted, refutations
from fretc.report.sections.signatures import BROKEN as DOES_NOT_VERIFY
from fretish.diagnostics import status_symbols as signs

_MARKUP = re.compile(r"([\\`*_{}\[\]()<>#+!|~&:@-])")
_VIOLATED, _NOT_SHOWN, _CHANGED, _OTHERS = 8, 4, 4, 3
"""Maximum lines of each list, and maximum entries of a line with several."""
_LONGEST = 240
"""Maximum characters of one text."""
T = TypeVar("T")


def markdown(report: ReportView, details: Details) -> str:
    """The Markdown text."""
    return "".join(f"{line}\n" for line in _lines(report, details))


def _lines(report: ReportView, details: Details) -> Iterator[str]:
    claimed = [view for view in worst_first(report.requirements) if view.mark.word != RETIRED]
    violated = [view for view in claimed if _is_violated(view)]
    not_shown = [view for view in claimed if not _is_violated(view) and not view.mark.shows]
    claim = partial(_claim, details)
    blocks = (
        [f"## {report.overall.mark.glyph} {_plain(report.overall.headline)}"],
        _figures(report, len(claimed), len(violated), len(not_shown)),
        [" ".join(_plain(sentence) for sentence in report.overall.sentences)],
        _list("Violated", _gravest_first(violated, report), claim, _VIOLATED, _id),
        _list("Not shown", not_shown, claim, _NOT_SHOWN, _id),
        _list("Changed since the review", _changes(report), str, _CHANGED),
        _accepted(report),
        _signatures(report),
        [f"<sub>fretc {_plain(report.fretc)}</sub>"],
    )
    filled = [list(block) for block in blocks]
    yield from [*chain.from_iterable([*block, ""] for block in filled if any(block))][:-1]


def _is_violated(view: RequirementView) -> bool:
    return view.mark.word in BROKEN or is_refuted(view)


def _figures(report: ReportView, claimed: int, violated: int, not_shown: int) -> Iterator[str]:
    yield "| claimed | shown | violated | not shown | changed since the review |"
    yield "|---|---|---|---|---|"
    shown, changed = claimed - violated - not_shown, len(report.changes)
    yield f"| {claimed} | {shown} | {violated} | {not_shown} | {changed} |"


def _id(view: RequirementView) -> str:
    return _plain(view.id)


def _gravest_first(
    views: Sequence[RequirementView], report: ReportView
) -> Sequence[RequirementView]:
    return worst_first(gravest_first(views, gravities(report.matrix, report.hazards)))


def _list(
    heading: str,
    things: Sequence[T],
    line: Callable[[T], str],
    most: int,
    name: Callable[[T], str] | None = None,
) -> Iterator[str]:
    """A heading with the total, the first items, and the number and names of the others."""
    if not things:
        return
    yield f"### {heading}: {len(things)}"
    yield from (f"- {line(thing)}" for thing in things[:most])
    if len(things) > most:
        names = f": {', '.join(map(name, things[most:]))}" if name else ""
        yield f"- … and {len(things) - most} more{names}"


# What is violated, and what is not shown -------------------------------------------------------


def _claim(details: Details, view: RequirementView) -> str:
    """Verdict, title, run and cause: `violated **No contact (R14)** in runs/06.mcap: ...`."""
    where, why = _worst(details, view)
    waived = f" ({_plain(view.waiver.reason)})" if view.waiver else ""
    return f"{_verdict(view.mark)} **{_plain(view.name)}**{waived}{where}: {_plain(why)}"


def _worst(details: Details, view: RequirementView) -> tuple[str, str]:
    """The worst run with its cause, and the number of further runs; or the reason without a run."""
    open_ones = [result for result in view.results if not result.mark.shows]
    if view.mark.word not in BROKEN and is_refuted(view):
        counterexamples = (
            f"{refutation.layer}: {refutation.claim}" for refutation in refutations(view)
        )
        plans = (f"{plan.method}: {plan.result}" for plan in view.planned if plan.refuted)
        return " but for a counterexample", next(chain(counterexamples, plans))
    if not open_ones or view.probability is not None:
        return "", next(iter(view.reasons), view.mark.text)
    first = min(open_ones, key=lambda result: result.mark.severity)
    runs = {result.run for result in open_ones if result.mark.word == first.mark.word}
    more = f" and {phrases.times(len(runs) - 1, 'more run')}" if len(runs) > 1 else ""
    return f" in {_plain(first.run_file)}{more}", _cause(details, first)


def _cause(details: Details, row: ResultRow) -> str:
    """The reason of the verdict, with the cause in words or the values of the signals."""
    (result,) = (view for _, view in details.results([row]))
    because = f" ({'; '.join(row.suspicions)})" if row.suspicions else ""
    return f"{row.reason}{_at_first(result)}{because}"


def _at_first(result: ResultView) -> str:
    """The values at the first violated tick."""
    first = next(iter(result.violations), None)
    if first is None:
        return ""
    values = [f"{name} {value}" for name, value in first.values]
    why = [*first.causes[:_OTHERS]] or values[:_OTHERS]
    return f"; at {first.start} {phrases.joined(why)}" if why else ""


def _verdict(mark: Mark) -> str:
    suspect = f", {signs.SUSPECT.glyph} {SUSPECT}" if mark.suspect else ""
    return f"{mark.glyph} {mark.word}{suspect}"


# What else a reviewer must know ----------------------------------------------------------------


def _changes(report: ReportView) -> list[str]:
    """Changed verdicts first if there are new violations; then each change."""
    names = {view.id: view.name for view in report.requirements}
    followed = sorted(
        ((change, follows(change)) for change in report.changes if follows(change)),
        key=lambda pair: not any(now.startswith(BROKEN) for _, _, now in pair[0].verdicts),
    )
    consequences = [
        _change(names.get(one.requirement, one.requirement), texts) for one, texts in followed
    ]
    changes = [
        _change(_some([names.get(id, id) for id, _ in group.requirements]), [group.change.text])
        for group in report.change_groups
    ]
    return [*consequences, *changes]


def _change(name: str, texts: Sequence[str]) -> str:
    left = len(texts) - _OTHERS
    more = f" (and {left} more)" if left > 0 else ""
    return f"**{_plain(name)}**: {_plain('; '.join(texts[:_OTHERS]))}{more}"


def _accepted(report: ReportView) -> Iterator[str]:
    """The accepted warnings with their reasons."""
    accepted = [
        f"**{remark.code}** {_plain(remark.message)} ({_plain(remark.accepted)})"
        for remark in report.remarks
        if remark.accepted
    ]
    if accepted:
        yield f"Accepted warnings: {len(accepted)}: {_some(accepted)}"


def _signatures(report: ReportView) -> Iterator[str]:
    """Missing and invalid signatures; those that do not verify come first."""
    signed = sorted(
        report.signatures.signed,
        key=lambda one: (one.signature.mark != DOES_NOT_VERIFY, one.signature.is_good),
    )
    if signed:
        bad = sum(not entry.signature.is_good for entry in signed)
        texts = [
            f"{entry.signature.mark.glyph} {entry.kind} {_plain(entry.name)}: "
            f"{_plain(entry.signature.text)}"
            for entry in signed
        ]
        yield f"Signatures: {bad} of {len(signed)} are missing or invalid: {_some(texts)}"


def _some(texts: Sequence[str]) -> str:
    left = len(texts) - _OTHERS
    return "; ".join([*texts[:_OTHERS], *([f"and {left} more"] if left > 0 else [])])


def _plain(text: str) -> str:
    """A text on one line, shortened, without markup, mentions and links."""
    words = " ".join(text.split())
    short = words if len(words) <= _LONGEST else f"{words[: _LONGEST - 1]}…"
    return _MARKUP.sub(r"\\\1", phrases.visible(short))
