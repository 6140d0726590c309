"""JSON output of `fretc mutate`: each mutant with the first run that notices it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Final, Literal, cast

from compiler.files.build_id import __version__
from compiler.files.records import Count, Name, Record, about, json_schema, plain
from compiler.files.templating import to_json
from compiler.situations.mutants import Mutant
from fretc.audit.evidence.schema import Verdict
from fretc.coverage.mutation import MutantBatch, MutantDifference, MutationResult
from fretish.printer import sentence

SCHEMA: Final = "fretc-mutation-1"
Outcome = Literal["noticed", "not noticed", "equivalent", "not judged"]


class MutantDetection(Record, frozen=True):
    """The first run that notices a mutant, and the difference."""

    run: Annotated[Count, about("index of the run, from 0")]
    verdict: Annotated[Verdict, about("verdict of the requirement on this run")]
    mutant: Annotated[Verdict, about("verdict of the mutant on this run")]
    tick: Annotated[
        Count | None,
        about(
            "first tick at which only one of the two is violated; null: only the verdicts differ"
        ),
    ]


class RecordedMutant(Record, frozen=True):
    """A mutant: a requirement with one small change."""

    key: Name
    words: Annotated[str, about("the text that is replaced, and its replacement")]
    sentence: str
    outcome: Annotated[
        Outcome,
        about(
            "equivalent: proved to have the same verdict on every run, so that no run can notice it"
        ),
    ]
    notice: MutantDetection | None
    why: Annotated[str, about("why the mutant was not judged; empty if it was judged")] = ""


class RequirementMutants(Record, frozen=True):
    """A requirement and its mutants."""

    id: Name
    known: Annotated[bool, about("whether some run has a verdict on the requirement")]
    mutants: tuple[RecordedMutant, ...]


class MutationDocument(Record, frozen=True):
    """The JSON document."""

    schema: Literal["fretc-mutation-1"]
    fretc: Annotated[str, about("version of the tool")]
    runs: Annotated[tuple[str, ...], about("the logs that were read")]
    requirements: tuple[RequirementMutants, ...]


def text(survey: MutationResult) -> str:
    """The JSON document as text; equal values give equal bytes."""
    return f"{to_json(plain(document(survey)))}\n"


def document(survey: MutationResult) -> MutationDocument:
    """The JSON document of a result."""
    return MutationDocument(
        schema=SCHEMA,
        fretc=__version__,
        runs=survey.runs,
        requirements=tuple(
            RequirementMutants(batch.id, batch.id in survey.known, tuple(_mutants(batch, survey)))
            for batch in survey.batches
        ),
    )


def _mutants(batches: MutantBatch, survey: MutationResult) -> Iterator[RecordedMutant]:
    for mutant in batches.mutants:
        key = batches.id, mutant.key
        detection = survey.noticed.get(key)
        outcome: Outcome = "equivalent" if key in survey.equivalent else "not noticed"
        outcome = outcome if detection is None else "noticed"
        notice = None if detection is None else _notice(*detection)
        yield RecordedMutant(mutant.key, mutant.words, written(mutant), outcome, notice)
    for mutant, why in batches.refused:
        same = (batches.id, mutant.key) in survey.equivalent
        outcome = "equivalent" if same else "not judged"
        yield RecordedMutant(mutant.key, mutant.words, written(mutant), outcome, None, why)


def written(mutant: Mutant) -> str:
    """The sentence of a mutant."""
    return sentence(mutant.requirement.written)


def _notice(run: int, difference: MutantDifference) -> MutantDetection:
    return MutantDetection(
        run, cast("Verdict", difference.own), cast("Verdict", difference.other), difference.tick
    )


def schema() -> dict[str, Any]:
    """The JSON Schema of the document."""
    return json_schema(
        MutationDocument,
        SCHEMA,
        "Mutants of requirements that recorded runs notice, as `fretc mutate --format json` "
        "prints it",
        "Ticks count from 0.",
    )
