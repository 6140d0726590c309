"""Where a requirement is in a text of a monitor, and what the text may be run by."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of
from fretc.verification.compiled.delays import Delayed
from fretc.verification.compiled.flow import Form
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.monitor.equivalence import Machine
from fretc.verification.monitor.rails import Letter, Stepping
from fretc.verification.monitor.verifying import NotAMonitorError


@dataclass(frozen=True, slots=True)
class SourceText:
    """A monitor in another language than Python."""

    name: str
    """Of its file."""
    text: str
    header_name: str = ""
    header: str = ""
    """Of a monitor in C."""

    @property
    def texts(self) -> Mapping[str, str]:
        """All of it, by the names of the files."""
        return {self.name: self.text, **({self.header_name: self.header} if self.header else {})}


@dataclass(frozen=True, slots=True)
class Plan:
    """Where the requirement is; it can be sent to another process."""

    needed: frozenset[str]
    """Names of the cells that the requirement depends on, among others."""
    outcome: int
    """The place of the requirement among the outcomes."""
    inputs: tuple[int, ...]
    """For each value of a letter, the place of its input; -1: there is none."""
    width: int
    """How many inputs there are."""
    is_original: bool = False
    """Whether the text is, but for comments and layout, the one that fretc writes."""


@dataclass(frozen=True, slots=True)
class ParsedSource:
    """A text that has the form that fretc writes."""

    requirements: tuple[FormalizedRequirement, ...]
    """In the order of its outcomes."""
    outcomes: tuple[str, ...]
    """Their names in the text."""
    form: Form
    cells: tuple[str, ...]
    """All of a rail."""
    inputs: tuple[str, ...]
    """The names of the propositions in the text, in their order."""
    is_original: bool = False
    """Whether the text is, but for comments and layout, the one that fretc writes."""

    def plan(self, requirement: FormalizedRequirement) -> Plan:
        """Where a requirement is.

        Raises:
            UnexpectedLayoutError: it is not there, or depends on more than its sentence speaks of.
        """
        ids = [each.id for each in self.requirements]
        if requirement.id not in ids:
            raise UnexpectedLayoutError("the monitor is for other requirements")
        place, own = ids.index(requirement.id), atoms(requirement)
        part = self.form.part(self.outcomes[place])
        names = tuple(dict.fromkeys(name for each in self.requirements for name in each.watched))
        if not {names[i] for i in part.inputs} <= {*own}:
            raise UnexpectedLayoutError(
                f"{requirement.id} depends on names that its sentence does not mention"
            )
        places = tuple(names.index(name) if name in names else -1 for name in own)
        return Plan(part.cells, place, places, len(names), self.is_original)


class Machines(Protocol):
    """A text that runs, seen as one requirement."""

    def delayed(self, *, doubt: bool) -> Delayed | None:
        """One of its rails without its delay lines, before the first tick.

        None: it has none, or it is not known what they do.
        """

    def judging(self) -> Machine:
        """It, before the first tick, by both verdicts."""

    def rail(self, letters: Sequence[Letter], *, doubt: bool) -> Stepping:
        """One of its rails, before the first tick.

        Args:
            letters: all that may come at a tick.
            doubt: whether it is the rail of what may hold.
        """


class Executable(Protocol):
    """A text that can be run; it can be sent to another process."""

    def running(self, plan: Plan) -> AbstractContextManager[Machines]:
        """It, as one requirement.

        Raises:
            ToolError: it cannot be run.
        """


@dataclass(frozen=True, slots=True)
class BuiltLibrary:
    """A text that was checked, as it is to run."""

    executable: Executable
    engine: str
    """What compiled it or is to run it, with version and flags."""
    artefacts: Mapping[str, str]
    """SHA-256 of what was made of the text, by the names of files."""


class Language(Protocol):
    """A module for each language."""

    def tool(self) -> str | None:
        """The path of the program that compiles or runs; None: none is installed."""

    def checked(
        self, given: SourceText, requirements: Sequence[FormalizedRequirement]
    ) -> ParsedSource:
        """The text in the form that fretc writes.

        Args:
            given: it.
            requirements: those that it may implement.

        Raises:
            NotAMonitorError: it names no requirement.
            UnexpectedLayoutError: it has another form.
        """

    def prepared(
        self, program: str, given: SourceText, checked: ParsedSource, folder: Path
    ) -> BuiltLibrary:
        """The text, compiled; nothing of it has run.

        Args:
            program: that of `tool`.
            given: the text.
            checked: what `checked` has said of it.
            folder: where files are put that the executable needs.

        Raises:
            ToolError: the program does not take it.
        """


def atoms(requirement: FormalizedRequirement) -> tuple[str, ...]:
    """The order of the values in a letter."""
    return tuple(dict.fromkeys((*atoms_of(requirement.sentence), *requirement.watched)))


def implemented(
    ids: Sequence[str], requirements: Sequence[FormalizedRequirement]
) -> tuple[FormalizedRequirement, ...]:
    """The requirements with the ids that a text tells.

    Raises:
        NotAMonitorError: there is none.
        UnexpectedLayoutError: one of them is not there.
    """
    by_id = {each.id: each for each in requirements}
    if not ids:
        raise NotAMonitorError("it contains no requirement")
    for id in ids:
        if id not in by_id:
            raise UnexpectedLayoutError(f"it has {id}, which is not one of the given requirements")
    return tuple(by_id[id] for id in dict.fromkeys(ids))
