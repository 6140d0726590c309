"""Text output of `fretc coverage`: each requirement with its unseen situations, then the runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import assert_never

from fretc.audit.evidence.schema import Moment
from fretc.coverage.coverage import (
    Coverage,
    CoverageStatus,
    RecordedSituation,
    RequirementCoverage,
    counts,
)
from fretc.coverage.directions import Directions, is_complete, unseen
from fretish.bindings.amounts import count_of, seconds
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.status_symbols import StatusSymbol

Line = tuple[str, str | None]
"""A line and its colour."""
_MOST_NAMED = 10
"""Maximum number of named runs of the least set, and of listed runs; others are counted."""


def lines(
    covered: Coverage,
    titles: Mapping[str, str],
    directions: Directions = MappingProxyType({}),
    *,
    every: bool,
) -> Iterator[Line]:
    """The lines of the output.

    Args:
        covered: the coverage.
        titles: requirement id → title; without a title, the id is printed.
        directions: known directions to unseen situations.
        every: also list the seen situations.
    """
    for requirement in covered.requirements:
        title = titles.get(requirement.id, requirement.id)
        yield from _requirement(requirement, title, covered.runs, directions, every=every)
    yield "", None
    yield from _runs(covered, every=every)
    yield from _least(covered)
    yield totals(covered, directions)


def _requirement(
    one: RequirementCoverage,
    title: str,
    runs: tuple[str, ...],
    directions: Directions,
    *,
    every: bool,
) -> Iterator[Line]:
    seen, of = len(one.of(CoverageStatus.SEEN)), len(one.situations)
    sign = signs.GOOD if of and seen == of else signs.UNUSED
    if not of:
        yield f"{signs.UNKNOWN.glyph} {title}: situations not measured", signs.UNKNOWN.colour
        return
    unmeasured = (
        f", not measured in {count_of(len(one.unmeasured), 'run')}" if one.unmeasured else ""
    )
    yield f"{sign.glyph} {title}: {seen} of {of} situations seen{unmeasured}", sign.colour
    for situation in one.situations:
        if every or situation.status is not CoverageStatus.SEEN:
            yield _situation(situation, runs)
        direction = directions.get((one.id, situation.key))
        if direction is not None and situation.status is not CoverageStatus.SEEN:
            yield f"        {direction.text}", None


def _situation(one: RecordedSituation, runs: tuple[str, ...]) -> Line:
    sign = sign_of(one.status)
    text = f"    {sign.glyph} {one.words}: {_status_words(one, runs)}"
    return text, sign.colour


def sign_of(status: CoverageStatus) -> StatusSymbol:
    """The symbol of a status."""
    match status:
        case CoverageStatus.SEEN:
            return signs.GOOD
        case CoverageStatus.PERHAPS | CoverageStatus.NOT_MEASURED:
            return signs.UNKNOWN
        case CoverageStatus.NEVER:
            return signs.UNUSED
        case _:
            assert_never(status)


def _status_words(one: RecordedSituation, runs: tuple[str, ...]) -> str:
    match one.status:
        case CoverageStatus.SEEN:
            many = f"seen in {count_of(len(one.seen), 'run')}, first" if len(runs) > 1 else "seen"
            return f"{many} {_first(one.seen, runs)}"
        case CoverageStatus.PERHAPS:
            return f"perhaps {_first(one.perhaps, runs)}, where some values are unknown"
        case CoverageStatus.NEVER | CoverageStatus.NOT_MEASURED:
            return one.status
        case _:
            assert_never(one.status)


def _first(moments: Mapping[int, Moment], runs: tuple[str, ...]) -> str:
    run = min(moments)
    of_run = f" of {runs[run]}" if len(runs) > 1 else ""
    return f"at {seconds(moments[run].seconds)}{of_run}"


def _runs(covered: Coverage, *, every: bool) -> Iterator[Line]:
    """Lines with the number of situations that each run shows, and that no other run shows."""
    shown: Counter[int] = Counter()
    alone: Counter[int] = Counter()
    for requirement in covered.requirements:
        for situation in requirement.situations:
            shown.update(situation.seen.keys())
            if len(situation.seen) == 1:
                alone.update(situation.seen.keys())
    if len(covered.runs) < 2:
        return
    listed = covered.runs if every else covered.runs[:_MOST_NAMED]
    for index, name in enumerate(listed):
        only = f", {alone[index]} of them that no other run shows" if alone[index] else ""
        yield f"{name}: {count_of(shown[index], 'situation')}{only}", None
    if len(listed) < len(covered.runs):
        yield f"and {len(covered.runs) - len(listed):,} more runs: `-v` lists them", None


def _least(covered: Coverage) -> Iterator[Line]:
    """The line about the smallest set of runs."""
    least, runs = covered.least, covered.runs
    if len(runs) < 2 or not least.runs:
        return
    names = [runs[index] for index in least.runs[:_MOST_NAMED]]
    more = f" and {len(least.runs) - len(names)} more" if len(least.runs) > len(names) else ""
    how = "the smallest set" if least.is_exact else "a smaller set may exist"
    verb = "shows" if len(least.runs) == 1 else "show"
    yield (
        f"{len(least.runs)} of {count_of(len(runs), 'run')} {verb} all that is seen ({how}): "
        f"{', '.join(names)}{more}",
        None,
    )


def totals(covered: Coverage, directions: Directions) -> Line:
    """`2 runs x 15 requirements: 84 of 190 situations seen, 12 perhaps, 94 never`."""
    head = (
        f"{count_of(len(covered.runs), 'run')} \N{MULTIPLICATION SIGN} "
        f"{count_of(len(covered.requirements), 'requirement')}"
    )
    left = sum(1 for _ in unseen(covered, directions))
    known = f"; {left:,} are not seen yet that a run can show" if directions else ""
    sign = signs.GOOD if is_complete(covered, directions) else signs.UNUSED
    return f"{head}: {in_counts(covered.requirements)}{known}", sign.colour


def in_counts(requirements: Sequence[RequirementCoverage]) -> str:
    """`84 of 190 situations seen, 12 perhaps, 94 never`."""
    found = counts(requirements)
    rest = [f"{found[status]:,} {status}" for status in [*CoverageStatus][1:] if found[status]]
    blank = sum(not requirement.situations for requirement in requirements)
    rest += [f"{count_of(blank, 'requirement')} not measured"] if blank else []
    seen = f"{found[CoverageStatus.SEEN]:,} of {found.total():,} situations seen"
    return ", ".join([seen, *rest])
