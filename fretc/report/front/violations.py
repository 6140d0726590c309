"""The headline: violated requirements, and the runs or groups in which they fail."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.audit.evidence.verdicts import BROKEN
from fretc.report.front.speech import capital, number
from fretc.report.model import phrases
from fretc.report.model.front import RunGroup
from fretc.report.model.views import RequirementView
from monitors import kernel

_NAMED = 2
"""Up to this number the headline names the requirements; otherwise it counts them."""
_SENTENCES, _GROUPS = 4, 3
"""Maximum sentences about violations, and maximum groups that a sentence names."""


def is_red(view: RequirementView) -> bool:
    """Whether the requirement is violated or refuted without a waiver."""
    return view.mark.word in BROKEN


def broken_runs(view: RequirementView) -> frozenset[str]:
    """The anchors of the runs that violate the requirement."""
    return frozenset(result.run for result in view.results if result.mark.word in BROKEN)


def headline(views: Sequence[RequirementView], runs: int) -> str:
    """The number of violated requirements: `Five requirements are violated, in six of 16 runs`.

    Args:
        views: violated requirements, at least one.
        runs: the number of all runs.
    """
    count = len(views)
    who = (
        phrases.joined([view.name for view in views])
        if count <= _NAMED
        else f"{number(count)} requirements"
    )
    words = " or ".join(dict.fromkeys(view.mark.word for view in views))
    broken = len(frozenset[str]().union(*map(broken_runs, views)))
    where = _where(broken, runs, several=count > 1) if broken else ""
    return capital(f"{who} {'is' if count == 1 else 'are'} {words}{where}.")


def _where(broken: int, runs: int, *, several: bool) -> str:
    """The runs with violations, in words; a run need not violate every requirement."""
    if broken < runs:
        return f", in {number(broken)} of {number(runs)} runs"
    if runs == 1:
        return ", in the one run"
    return f": none of {number(runs)} runs keeps {'all of them' if several else 'it'}"


def sentences(views: Sequence[RequirementView], groups: Sequence[RunGroup]) -> Iterator[str]:
    """Sentences that say where requirements fail; those that fail in the same runs share one."""
    same: dict[frozenset[str], list[RequirementView]] = {}
    for view in views:
        if broken := broken_runs(view):
            same.setdefault(broken, []).append(view)
    ordered = sorted(same.items(), key=lambda item: -len(item[1]))
    for broken, those in ordered[:_SENTENCES]:
        verb = "fails" if len(those) == 1 else "fail"
        unknown = _unknown(those, broken, groups)
        names = phrases.some([view.name for view in those], 4)
        yield f"{names} {verb} {where(broken, groups)}{unknown}."
    rest = sum(len(those) for _, those in ordered[_SENTENCES:])
    if rest:
        verb = "fails" if rest == 1 else "fail"
        yield f"{capital(phrases.times(rest, 'more requirement'))} {verb} in other runs."


def where(broken: frozenset[str], groups: Sequence[RunGroup]) -> str:
    """`only in safety-off (2 of 2 runs)` if few groups are affected; otherwise the runs."""
    runs = [run for group in groups for run in group.runs]
    if len(broken) == len(runs):
        return "in every run" if len(runs) > 1 else "in the one run"
    counts = [(group, sum(run.anchor in broken for run in group.runs)) for group in groups]
    hit = [(group, count) for group, count in counts if count]
    if all(group.name for group in groups) and len(hit) < len(groups) and len(hit) <= _GROUPS:
        parts = [
            f"{group.name} ({count} of {phrases.times(len(group.runs), 'run')})"
            for group, count in hit
        ]
        return f"only in {phrases.joined(parts)}"
    count = f"in {len(broken)} of {phrases.times(len(runs), 'run')}"
    others = [run.name for run in runs if run.anchor not in broken]
    if len(others) <= _GROUPS and len(others) < len(broken):
        return f"{count}, all but {phrases.joined(others)}"
    return f"{count}: {phrases.some([run.name for run in runs if run.anchor in broken], 4)}"


def _unknown(
    views: Sequence[RequirementView], broken: frozenset[str], groups: Sequence[RunGroup]
) -> str:
    """The number of other runs in which the verdict is unknown, in words."""
    runs = {run.anchor for group in groups for run in group.runs} - broken
    unknown = set[str]()
    for view in views:
        decided = {r.run for r in view.results if r.mark.word != kernel.NO_DATA}
        unknown |= runs - decided
    return (
        f"; the verdict is not known in {phrases.times(len(unknown), 'other run')}"
        if unknown
        else ""
    )
