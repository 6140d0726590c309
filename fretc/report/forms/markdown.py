"""`--markdown`: what a reviewer of a pull request wants to see first.

Source: GitHub Flavored Markdown Spec 0.29, tables (extension).
"""

from __future__ import annotations

import re
from collections.abc import Iterator

from fretc.audit.evidence.verdicts import SUSPECT
from fretc.report.model.changes import Change, follows, only_change
from fretc.report.model.phrases import times, visible
from fretc.report.model.views import Mark, Report, RequirementView, worst_first
from fretish.diagnostics import signs

_MARKUP = re.compile(r"([\\`*_{}\[\]()<>#+!|~&:@-])")
_LISTED = 50
_MOST_CHANGES, _NAMED, _RUNS = 20, 6, 3
"""The most changes, requirements of one change, and runs with another verdict."""


def markdown(report: Report) -> str:
    """The whole comment."""
    return "".join(f"{line}\n" for line in _lines(report))


def _lines(report: Report) -> Iterator[str]:
    overall = report.overall
    yield f"## {overall.mark.glyph} {_plain(overall.headline)}"
    yield ""
    for sentence in overall.sentences:
        yield f"{_plain(sentence)}  "
    yield ""
    yield "| requirement | verdict | coverage | review | why |"
    yield "|---|---|---|---|---|"
    ordered = worst_first(report.requirements)
    for view in ordered[:_LISTED]:
        yield _row(view)
    if len(ordered) > _LISTED:
        yield ""
        yield f"… and {len(ordered) - _LISTED} more requirements."
    yield from _changes(report)
    yield from _accepted(report)
    yield from _signatures(report)
    yield ""
    yield f"<sub>fretc {_plain(report.fretc)}</sub>"


def _row(view: RequirementView) -> str:
    why = view.reasons[0] if view.reasons else view.results[0].reason if view.results else ""
    more = f" (and {len(view.reasons) - 1} more)" if len(view.reasons) > 1 else ""
    cells = (
        f"**{_plain(view.id)}** {_plain(view.title)}",
        _verdict(view.mark),
        view.coverage,
        view.review.text,
        f"{_plain(why)}{more}",
    )
    return f"| {' | '.join(cells)} |"


def _verdict(mark: Mark) -> str:
    suspect = f", {signs.SUSPECT.glyph} {SUSPECT}" if mark.suspect else ""
    return f"{mark.glyph} {mark.word}{suspect}"


def _changes(report: Report) -> Iterator[str]:
    """Each change once; then what follows from it, requirement by requirement."""
    if not report.changes:
        return
    yield ""
    yield "### Changed since the review"
    yield ""
    shown: list[Change] = []
    for group in report.change_groups[:_MOST_CHANGES]:
        only = only_change(group, report.changes)
        shown += [only] if only else []
        ids = [_plain(id) for id, _ in group.requirements[:_NAMED]]
        left = len(group.requirements) - _NAMED
        named = f"**{', '.join(ids)}**{f' and {left} more' if left > 0 else ''}"
        more = follows(only) if only else ()
        yield f"- {named}: {_plain('; '.join([group.change.text, *more]))}"
        yield from _verdicts(only) if only else ()
    if len(report.change_groups) > _MOST_CHANGES:
        yield f"- … and {len(report.change_groups) - _MOST_CHANGES} more changes"
    others = [change for change in report.changes if follows(change) and change not in shown]
    for change in others[:_MOST_CHANGES]:
        yield f"- **{_plain(change.requirement)}**: {_plain('; '.join(follows(change)))}"
        yield from _verdicts(change)
    if len(others) > _MOST_CHANGES:
        yield f"- … and {len(others) - _MOST_CHANGES} more requirements"


def _verdicts(change: Change) -> Iterator[str]:
    """The first runs with another verdict, the worst first."""
    for run, then, now in change.verdicts[:_RUNS]:
        yield f"  - {_plain(run)}: {_plain(then)} → {_plain(now)}"
    if len(change.verdicts) > _RUNS:
        yield f"  - … and {times(len(change.verdicts) - _RUNS, 'more run')}"


def _accepted(report: Report) -> Iterator[str]:
    """The warnings that the project accepts, and why."""
    accepted = [remark for remark in report.remarks if remark.accepted]
    if not accepted:
        return
    yield ""
    yield f"### Accepted warnings: {len(accepted)}"
    yield ""
    for one in accepted[:_LISTED]:
        yield f"- **{one.code}** {_plain(one.message)}: {_plain(one.accepted)}"
    if len(accepted) > _LISTED:
        yield f"- … and {len(accepted) - _LISTED} more"


def _signatures(report: Report) -> Iterator[str]:
    """Those that do not verify come first; reviews stand in the table, too."""
    signed = report.signatures.signed
    if not signed:
        return
    yield ""
    yield "### Signatures"
    yield ""
    for one in signed[:_LISTED]:
        mark = one.signature.mark
        yield f"- {mark.glyph} {one.kind} {_plain(one.name)}: {_plain(one.signature.text)}"
    if len(signed) > _LISTED:
        unsigned = sum(not one.signature.is_good for one in signed[_LISTED:])
        yield f"- … and {len(signed) - _LISTED} more, {unsigned} of them unauthenticated"


def _plain(text: str) -> str:
    """Text as text, on one line: no markup, no mention, no link."""
    return _MARKUP.sub(r"\\\1", visible(" ".join(text.split())))
