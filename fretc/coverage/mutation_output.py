"""Text output of `fretc mutate`: each requirement with the mutants that no run has noticed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from fretc.coverage.mutation import MutantBatch, MutantDifference, MutationResult
from fretc.coverage.mutation_record import written
from fretish.diagnostics import status_symbols as signs

Line = tuple[str, str | None]
"""A line and its colour."""


def lines(survey: MutationResult, titles: Mapping[str, str], *, every: bool) -> Iterator[Line]:
    """The lines of the output.

    Args:
        survey: the result.
        titles: requirement id → title.
        every: also list the noticed mutants.
    """
    for batch in survey.batches:
        yield from _requirement(batch, titles.get(batch.id, batch.id), survey, every=every)
    yield "", None
    yield _totals(survey)


def _requirement(
    batch: MutantBatch, title: str, survey: MutationResult, *, every: bool
) -> Iterator[Line]:
    same = sum(id == batch.id for id, _ in survey.equivalent)
    count = len(batch.mutants) + len(batch.refused) - same
    found = [(each, survey.noticed.get((batch.id, each.key))) for each in batch.mutants]
    noticed = sum(difference is not None for _, difference in found)
    sign = signs.GOOD if noticed == count else signs.UNUSED
    wrong = f"{count} mutant{'' if count == 1 else 's'}"
    unknown = "" if batch.id in survey.known else "; no run has a verdict on it"
    yield f"{sign.glyph} {title}: {noticed} of {wrong} noticed{unknown}", sign.colour
    for mutant, difference in found:
        if (batch.id, mutant.key) in survey.equivalent:
            if every:
                text = f"    {signs.EMPTY.glyph} {mutant.words}: equivalent to the requirement"
                yield text, signs.EMPTY.colour
        elif difference is None:
            yield f"    {signs.UNUSED.glyph} {mutant.words}", signs.UNUSED.colour
            yield f"      {written(mutant)}", None
        elif every:
            text = f"    {signs.GOOD.glyph} {mutant.words}: {_how(difference, survey.runs)}"
            yield text, signs.GOOD.colour
    for mutant, why in batch.refused:
        if (batch.id, mutant.key) not in survey.equivalent:
            text = f"    {signs.UNKNOWN.glyph} {mutant.words}: not judged: {why}"
            yield text, signs.UNKNOWN.colour


def _how(detection: tuple[int, MutantDifference], runs: tuple[str, ...]) -> str:
    place, difference = detection
    at = "" if difference.tick is None else f", first at tick {difference.tick}"
    return f"{difference.other}, and the requirement {difference.own}, in {runs[place]}{at}"


def _totals(survey: MutationResult) -> Line:
    """`1 run x 15 requirements: 120 of 259 mutants noticed`."""
    same = len(survey.equivalent)
    refused = sum(len(batch.refused) for batch in survey.batches)
    runs, requirements = len(survey.runs), len(survey.batches)
    sign = signs.GOOD if survey.is_complete else signs.UNUSED
    text = (
        f"{runs:,} run{'' if runs == 1 else 's'} \N{MULTIPLICATION SIGN} "
        f"{requirements:,} requirement{'' if requirements == 1 else 's'}: "
        f"{len(survey.noticed):,} of {survey.count:,} mutants noticed"
        f"{f', {refused:,} not judged' if refused else ''}"
        f"{f', {same:,} equivalent mutants left out' if same else ''}"
    )
    return text, sign.colour
