"""The headline and the violated requirements: under which hazard, and in which runs.

The order is that of danger: the most severe hazard first, then the most runs.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from fretc.audit.evidence.verdicts import BROKEN
from fretc.report.front.gravity import NO_HAZARD, Gravity
from fretc.report.front.identity import interval
from fretc.report.front.speech import capital, number
from fretc.report.model import phrases
from fretc.report.model.front import RunGroup
from fretc.report.model.views import RequirementView
from fretish.reading.natural_order import natural
from monitors import kernel

_NAMED = 2
"""Up to this number the headline names the requirements; otherwise it counts them."""
_GROUPS, _RUNS = 6, 4
"""Maximum groups, and maximum single runs, that a sentence names."""
_OPEN = (kernel.NO_DATA, kernel.INCONCLUSIVE)


def is_red(view: RequirementView) -> bool:
    """Whether the requirement is violated or refuted without a waiver."""
    return view.mark.word in BROKEN


def broken_runs(view: RequirementView) -> frozenset[str]:
    """The anchors of the runs that violate the requirement."""
    return frozenset(result.run for result in view.results if result.mark.word in BROKEN)


def gravest_first(
    views: Sequence[RequirementView], gravity: Mapping[str, Gravity]
) -> list[RequirementView]:
    """The views by severity of the hazard, then by number of violating runs, then by id.

    Args:
        views: views of requirements.
        gravity: anchor of a requirement → its gravity.
    """
    return sorted(
        views,
        key=lambda view: (
            gravity.get(view.anchor, NO_HAZARD).rank,
            -len(broken_runs(view)),
            natural(view.id),
        ),
    )


def headline(views: Sequence[RequirementView], runs: int, gravity: Mapping[str, Gravity]) -> str:
    """`Five requirements are violated in six of 16 runs; the most severe: No contact (R14)`.

    Args:
        views: violated requirements, at least one, the gravest first.
        runs: the number of all runs.
        gravity: anchor of a requirement → its gravity.
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
    worst = gravity.get(views[0].anchor, NO_HAZARD)
    first = f"; the most severe: {views[0].name}, {worst.text}" if count > _NAMED else ""
    return capital(
        f"{who} {'is' if count == 1 else 'are'} {words}{where}{first if worst.severity else ''}."
    )


def _where(broken: int, runs: int, *, several: bool) -> str:
    """The runs with violations, in words; a run need not violate every requirement."""
    if broken < runs:
        return f" in {number(broken)} of {number(runs)} runs"
    if runs == 1:
        return " in the only run"
    return f": none of {number(runs)} runs keeps {'all of them' if several else 'it'}"


def sentences(
    views: Sequence[RequirementView],
    groups: Sequence[RunGroup],
    gravity: Mapping[str, Gravity],
) -> Iterator[str]:
    """A sentence for each violated requirement: its hazard, its runs, and the undecided runs.

    Args:
        views: violated requirements, the gravest first.
        groups: all runs.
        gravity: anchor of a requirement → its gravity.
    """
    for view in views:
        hazard = gravity.get(view.anchor, NO_HAZARD).text
        name = f"{view.name} [{hazard}]" if hazard else view.name
        broken = broken_runs(view)
        what = f"fails {where(broken, groups)}" if broken else f"is {view.mark.text} over all runs"
        yield "; ".join([f"{name} {what}", *_others(view, broken, groups)]) + "."


def where(broken: Collection[str], groups: Sequence[RunGroup]) -> str:
    """`only in safety-off (2 of 2 runs)` if whole groups are free of it; otherwise the runs."""
    total = sum(len(group.runs) for group in groups)
    if len(broken) == total:
        return "in every run" if total > 1 else "in the only run"
    hit = [group for group in groups if any(run.anchor in broken for run in group.runs)]
    if len(hit) < len(groups) and all(group.name for group in hit) and len(hit) <= _GROUPS:
        return f"only in {phrases.joined([_part(group, broken) for group in hit])}"
    runs = [run for group in groups for run in group.runs]
    count = f"in {len(broken)} of {phrases.times(total, 'run')}"
    others = [run.name for run in runs if run.anchor not in broken]
    if len(others) < min(_RUNS, len(broken)):
        return f"{count}, all but {phrases.joined(others)}"
    return f"{count}: {phrases.some([run.name for run in runs if run.anchor in broken], _RUNS)}"


def _part(group: RunGroup, broken: Collection[str]) -> str:
    count = sum(run.anchor in broken for run in group.runs)
    return f"{group.name} ({count} of {phrases.times(len(group.runs), 'run')})"


def _others(
    view: RequirementView, broken: Collection[str], groups: Sequence[RunGroup]
) -> Iterator[str]:
    """The other runs in which this requirement is not decided, and those without a verdict."""
    if view.probability is not None:
        return
    names = {run.anchor: run.name for group in groups for run in group.runs}
    words: dict[str, set[str]] = {}
    for result in view.results:
        words.setdefault(result.run, set()).add(result.mark.word)
    undecided = [run for run in names if run not in broken and words.get(run, set()) & {*_OPEN}]
    if undecided:
        runs = phrases.times(len(undecided), "other run")
        yield f"undecided in {runs}: {phrases.some([names[run] for run in undecided], _RUNS)}"
    missing = len(names.keys() - words.keys())
    audited = len(words.keys() & names.keys())
    if broken and audited > 1:
        share = interval(len(broken), len(undecided), audited)
        yield f"95 % interval of the share of failing runs: {share}"
    if missing:
        yield f"not audited in {phrases.times(missing, 'run')}"
