"""Position of a requirement in the text of a monitor, and the interface of languages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Protocol

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of
from fretc.verification.compiled.delays import Delayed
from fretc.verification.compiled.flow import CheckedLayout
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.monitor.approximations import Letter, Stepping
from fretc.verification.monitor.equivalence import Machine
from fretc.verification.monitor.verifying import NotAMonitorError
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class SourceText:
    """A monitor in another language than Python."""

    name: str
    """Name of the file."""
    text: str
    header_name: str = ""
    header: str = ""
    """Header of a monitor in C."""

    @property
    def texts(self) -> Mapping[str, str]:
        """All texts by file name."""
        return {self.name: self.text, **({self.header_name: self.header} if self.header else {})}


@dataclass(frozen=True, slots=True)
class RequirementPosition:
    """Position of a requirement in a monitor; it can be sent to another process."""

    needed: frozenset[str]
    """Names of the cells on which the requirement depends, among others."""
    outcome: int
    """Index of the requirement's outcome."""
    inputs: tuple[int, ...]
    """Index of the input for each value of a valuation; -1: there is none."""
    width: int
    """Number of inputs."""
    is_original: bool = False
    """Whether the text equals the one that fretc writes, except for comments and layout."""


@dataclass(frozen=True, slots=True)
class ParsedSource:
    """A text in the layout that fretc writes."""

    requirements: tuple[FormalizedRequirement, ...]
    """Requirements in the order of their outcomes."""
    outcomes: tuple[str, ...]
    """Names of the outcomes in the text."""
    form: CheckedLayout
    cells: tuple[str, ...]
    """All cells of an approximation."""
    inputs: tuple[str, ...]
    """Names of the propositions in the text, in their order."""
    is_original: bool = False
    """Whether the text equals the one that fretc writes, except for comments and layout."""

    def plan(self, requirement: FormalizedRequirement) -> RequirementPosition:
        """Position of a requirement in the text.

        Raises:
            UnexpectedLayoutError: it is missing, or depends on names that its sentence does not
                mention.
        """
        ids = [each.id for each in self.requirements]
        if requirement.id not in ids:
            raise UnexpectedLayoutError("the monitor is for other requirements")
        index, own = ids.index(requirement.id), atoms(requirement)
        part = self.form.part(self.outcomes[index])
        names = tuple(dict.fromkeys(name for each in self.requirements for name in each.watched))
        if not {names[i] for i in part.inputs} <= {*own}:
            raise UnexpectedLayoutError(
                f"{requirement.id} depends on names that its sentence does not mention"
            )
        places = tuple(names.index(name) if name in names else -1 for name in own)
        return RequirementPosition(part.cells, index, places, len(names), self.is_original)


class Machines(Protocol):
    """A running monitor, seen as one requirement."""

    def delayed(self, *, is_possible: bool) -> Delayed | None:
        """One of its approximations without delay lines, before the first tick.

        None: it has no delay lines, or their behaviour is unknown.
        """

    def judging(self) -> Machine:
        """Machine of both verdicts, before the first tick."""

    def approximation(self, letters: Sequence[Letter], *, is_possible: bool) -> Stepping:
        """One of its approximations, before the first tick.

        Args:
            letters: all valuations of a tick.
            is_possible: whether it is the approximation of the possible value.
        """


class Executable(Protocol):
    """A monitor that can be run; it can be sent to another process."""

    def running(self, plan: RequirementPosition) -> AbstractContextManager[Machines]:
        """The running monitor, as one requirement.

        Raises:
            ToolError: it cannot be run.
        """


@dataclass(frozen=True, slots=True)
class BuiltLibrary:
    """A checked monitor, ready to run."""

    executable: Executable
    engine: str
    """Compiler or interpreter, with version and flags."""
    artefacts: Mapping[str, str]
    """SHA-256 of the generated files, by name."""


class Language(Protocol):
    """Interface of the module of each language."""

    def tool(self) -> str | None:
        """Path of the compiler or interpreter; None: none is installed."""

    def checked(
        self, given: SourceText, requirements: Sequence[FormalizedRequirement]
    ) -> ParsedSource:
        """The parsed layout of the text.

        Args:
            given: the text.
            requirements: requirements that it may implement.

        Raises:
            NotAMonitorError: it contains no requirement.
            UnexpectedLayoutError: the layout differs from that of fretc.
        """

    def prepared(
        self, program: str, given: SourceText, checked: ParsedSource, folder: Path
    ) -> BuiltLibrary:
        """The compiled text; nothing of it has run.

        Args:
            program: the path from `tool`.
            given: the text.
            checked: the result of `checked`.
            folder: folder for files that the executable needs.

        Raises:
            ToolError: the program rejects the text.
        """


def atoms(requirement: FormalizedRequirement) -> tuple[str, ...]:
    """Order of the values in a valuation."""
    return tuple(dict.fromkeys((*atoms_of(requirement.sentence), *requirement.watched)))


def implemented(
    ids: Sequence[str], requirements: Sequence[FormalizedRequirement]
) -> tuple[FormalizedRequirement, ...]:
    """The requirements with the ids in a text.

    Raises:
        NotAMonitorError: there is no id.
        UnexpectedLayoutError: a requirement is unknown.
    """
    by_id = {requirement.id: requirement for requirement in requirements}
    if not ids:
        raise NotAMonitorError("it contains no requirement")
    for id in ids:
        if id not in by_id:
            raise UnexpectedLayoutError(f"it has {id}, which is not one of the given requirements")
    return tuple(by_id[id] for id in dict.fromkeys(ids))
