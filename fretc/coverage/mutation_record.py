"""Mutants against runs as JSON: which were noticed by which run, and which by none."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Final, Literal, cast

from compiler.files.build_id import __version__
from compiler.files.records import Count, Name, Record, about, json_schema, plain
from compiler.files.templating import to_json
from compiler.situations.mutants import Mutant
from fretc.audit.evidence.schema import Verdict
from fretc.coverage.mutation import Difference, MutantBatch, MutationResult
from fretish.printer import sentence

SCHEMA: Final = "fretc-mutation-1"
Outcome = Literal["noticed", "not noticed", "equivalent", "not judged"]


class Notice(Record, frozen=True):
    """How the first run that notices a mutant does."""

    run: Annotated[Count, about("its place among the runs, from 0")]
    verdict: Annotated[Verdict, about("of the requirement on it")]
    mutant: Annotated[Verdict, about("of the mutant on it")]
    tick: Annotated[
        Count | None,
        about(
            "the first at which only one of the two is violated; null: the verdicts alone differ"
        ),
    ]


class Judged(Record, frozen=True):
    """A sentence that somebody might have written in place of the requirement."""

    key: Name
    words: Annotated[str, about("what stands in place of what")]
    sentence: str
    outcome: Annotated[
        Outcome,
        about("equivalent: it is proved to say the same, so no run can notice it"),
    ]
    notice: Notice | None
    why: Annotated[str, about("why it was not judged; empty: it was")] = ""


class Requirement(Record, frozen=True):
    """A requirement and its mutants."""

    id: Name
    known: Annotated[bool, about("whether some run has a verdict on the requirement")]
    mutants: tuple[Judged, ...]


class Document(Record, frozen=True):
    """A whole file."""

    schema: Literal["fretc-mutation-1"]
    fretc: Annotated[str, about("version of the tool")]
    runs: Annotated[tuple[str, ...], about("the logs that were read")]
    requirements: tuple[Requirement, ...]


def text(survey: MutationResult) -> str:
    """The whole file: the same values give the same bytes."""
    return f"{to_json(plain(document(survey)))}\n"


def document(survey: MutationResult) -> Document:
    """The record of what runs noticed."""
    return Document(
        schema=SCHEMA,
        fretc=__version__,
        runs=survey.runs,
        requirements=tuple(
            Requirement(each.id, each.id in survey.known, tuple(_mutants(each, survey)))
            for each in survey.suspects
        ),
    )


def _mutants(suspects: MutantBatch, survey: MutationResult) -> Iterator[Judged]:
    for mutant in suspects.mutants:
        key = suspects.id, mutant.key
        found = survey.noticed.get(key)
        outcome: Outcome = "equivalent" if key in survey.equivalent else "not noticed"
        outcome = outcome if found is None else "noticed"
        notice = None if found is None else _notice(*found)
        yield Judged(mutant.key, mutant.words, written(mutant), outcome, notice)
    for mutant, why in suspects.refused:
        same = (suspects.id, mutant.key) in survey.equivalent
        outcome = "equivalent" if same else "not judged"
        yield Judged(mutant.key, mutant.words, written(mutant), outcome, None, why)


def written(mutant: Mutant) -> str:
    """Its sentence."""
    return sentence(mutant.requirement.written)


def _notice(run: int, found: Difference) -> Notice:
    return Notice(run, cast("Verdict", found.own), cast("Verdict", found.other), found.tick)


def schema() -> dict[str, Any]:
    """The JSON Schema of this."""
    return json_schema(
        Document,
        SCHEMA,
        "Which wrong requirements recorded runs notice, as `fretc mutate --format json` prints it",
        "Ticks count from 0.",
    )
