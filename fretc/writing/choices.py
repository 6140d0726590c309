"""All readings of one English sentence, formalized, merged and compared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import Any

from compiler.files.records import plain
from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from fretc.writing.questions import Comparison, Question, compare
from fretc.writing.text_output import in_words, left_out, listed, names_of, record, table
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.english.readings import Reading
from fretish.english.readings import readings as all_readings
from fretish.english.vocabulary import Vocabulary

SECONDS = 20.0
"""CPU seconds for the comparison of all readings."""


@dataclass(frozen=True)
class Choice:
    """The readings of a text that differ in meaning, the most plausible first."""

    english: str
    readings: tuple[Reading, ...]
    requirements: tuple[FormalizedRequirement, ...]
    """The readings, formalized, in the same order."""
    questions: tuple[Question, ...]
    """Runs that distinguish them, by indices of `readings`."""
    same: tuple[tuple[Reading, int], ...]
    """Readings with the meaning of another, and the index of that."""
    undecided: str
    """Why some readings were not compared; empty: all were."""
    declarations: Declarations | None
    unusable: tuple[tuple[Reading, Diagnostic], ...] = ()
    """Readings that cannot be formalized, with the error."""
    warning: Diagnostic | None = None
    """F312 if durations are read as ticks because no clock is declared."""

    @property
    def left_out(self) -> tuple[str, ...]:
        """The words of the text that no reading contains."""
        return left_out(self.readings)

    @cached_property
    def record(self) -> dict[str, Any]:
        """The choice as plain values for JSON."""
        questions = [
            {
                "rows": [plain(row) for row in each.run.rows],
                "allowed": sorted(each.allowed),
            }
            for each in self.questions
        ]
        meanings = [in_words(requirement) for requirement in self.requirements]
        unusable = [
            {"sentence": reading.text, "error": error.message} for reading, error in self.unusable
        ]
        whole = record(self.english, self.readings, meanings, questions, self.undecided)
        return whole | {"unusable": unusable}

    @property
    def lines(self) -> Iterator[str]:
        """The choice as text."""
        yield f"“{self.english}”"
        for number, (reading, own) in enumerate(
            zip(self.readings, self.requirements, strict=True), 1
        ):
            yield ""
            yield from listed(number, reading, in_words(own))
            for other, index in self.same:
                if index == number - 1:
                    yield f"   the same: {other.text}"
        yield ""
        yield from names_of(self.readings)
        for unusable, error in self.unusable:
            yield f"not compared: {unusable.text}: {error.message}"
        if self.undecided:
            yield f"not all readings were compared: {self.undecided}"

    def table(self, question: Question) -> Iterator[str]:
        """The run of a question as a table."""
        return table(question.run, self.requirements)


def choice(
    english: str, names: Vocabulary, declarations: Declarations | None
) -> Choice | Diagnostic:
    """The readings of one sentence, without those that mean the same.

    Args:
        english: one sentence.
        names: the names of the project.
        declarations: its bindings; None: there are none.

    Returns:
        F975 if the text has no reading; an error if no reading can be formalized, for example
        because a duration is no whole number of ticks.
    """
    offered = all_readings(english, names)
    if not offered:
        return diagnostic("no_reading", text=english)
    usable: list[tuple[Reading, FormalizedRequirement]] = []
    errors: list[tuple[Reading, Diagnostic]] = []
    warnings: list[Diagnostic] = []
    for reading in offered:
        requirement, remarks = formalize(_entry(reading), declarations)
        if requirement is None:
            errors.append((reading, next(each for each in remarks if each.is_error)))
        else:
            usable.append((reading, requirement))
            warnings += [each for each in remarks if each.code is Code.NO_CLOCK]
    if not usable:
        return errors[0][1]
    merged = _merged(english, usable, declarations)
    return replace(merged, unusable=tuple(errors), warning=next(iter(warnings), None))


def _merged(
    english: str,
    usable: list[tuple[Reading, FormalizedRequirement]],
    declarations: Declarations | None,
) -> Choice:
    comparison = compare([requirement for _, requirement in usable], SECONDS)
    place = {index: number for number, index in enumerate(comparison.kept)}
    return Choice(
        english,
        tuple(usable[index][0] for index in comparison.kept),
        tuple(usable[index][1] for index in comparison.kept),
        _numbered(comparison, place),
        tuple((usable[index][0], place[twin]) for index, twin in comparison.same),
        comparison.undecided,
        declarations,
    )


def _numbered(comparison: Comparison, place: dict[int, int]) -> tuple[Question, ...]:
    return tuple(
        replace(each, allowed=frozenset(place[index] for index in each.allowed))
        for each in comparison.questions
    )


def _entry(reading: Reading) -> RequirementEntry:
    return RequirementEntry("reading", Source("<reading>", reading.text).span())
