"""The types of a project that was read: its requirements, diagnostics and refused requirements."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from typing import TYPE_CHECKING

from compiler.files.attribution import NOBODY, Attribution
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.acceptances import Acceptance, with_acceptance_reasons
from compiler.project.hazards import Hazard
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.documents import RequirementEntry

if TYPE_CHECKING:
    from compiler.project.parents import Parent


@dataclass(frozen=True, slots=True)
class Refused:
    """A requirement that nothing can be generated from, with the errors in what it reads."""

    requirement: RequirementEntry
    why: tuple[Diagnostic, ...]
    """The errors in its header, its sentence, its id and the bindings of its names."""

    @property
    def is_in_force(self) -> bool:
        """Whether the requirement is not retired."""
        return self.requirement.is_in_force


@dataclass(frozen=True, slots=True)
class UnformalizedRequirement:
    """A requirement that has no formulas because it has an error, or is free text."""

    requirement: RequirementEntry
    diagnostic: Diagnostic
    """The first error; the note where it is free text."""
    diagnostics: tuple[Diagnostic, ...] = ()
    """All diagnostics of the requirement."""


@dataclass(frozen=True, slots=True)
class Project:
    """The content of a requirements folder, and all of its diagnostics."""

    requirements: tuple[RequirementEntry, ...]
    """As written, in the order of the files."""
    formalized: tuple[FormalizedRequirement, ...]
    failed: tuple[UnformalizedRequirement, ...]
    declarations: Declarations | None
    hazards: Mapping[str, Hazard]
    diagnostics: tuple[Diagnostic, ...]
    general: tuple[Diagnostic, ...] = ()
    """Diagnostics about neither a single requirement nor a single table of the bindings: those of
    the bindings as a whole, of hazards, of parents and of the settings. An error in a table belongs
    to the requirements that read the table."""
    mistaken: Mapping[RequirementEntry, Diagnostic] = field(default_factory=dict)
    """The error of each formalized requirement that has one, by its entry: its id is
    taken, or its `params` name something undeclared."""
    parents: Mapping[str, Parent] = field(default_factory=dict)
    """Parent requirements in other tools, by their ids."""
    acceptances: tuple[Acceptance, ...] = ()
    """The accepted warnings with their reasons. In `diagnostics` such warnings are marked."""
    attribution: Attribution = NOBODY
    """Author, maintainer and license of the project, from its settings."""
    viewer: str = ""
    """The address at which another program shows a log at a time (`compiler.files.log_viewer`)."""
    refused: tuple[Refused, ...] = ()
    """The requirements with an error in what they read: no file is generated from them."""

    @property
    def rules(self) -> tuple[FormalizedRequirement, ...]:
        """The former name of `formalized`."""
        warnings.warn("`rules` of a project is `formalized` now", DeprecationWarning, stacklevel=2)
        return self.formalized

    @property
    def sound(self) -> Project:
        """The project without its `refused` requirements, retired ones included."""
        refused = {refusal.requirement for refusal in self.refused}
        requirements = tuple(
            requirement for requirement in self.formalized if requirement.entry not in refused
        )
        return replace(self, formalized=requirements)

    @property
    def in_force(self) -> tuple[FormalizedRequirement, ...]:
        """The formalized requirements that are not retired."""
        return tuple(each for each in self.formalized if each.entry.is_in_force)

    @property
    def without_rule(self) -> tuple[RequirementEntry, ...]:
        """The requirements that have an error, or are free text."""
        return tuple(failure.requirement for failure in self.failed)

    def answered(self, diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """The diagnostics, with the reason added to each accepted warning."""
        return with_acceptance_reasons(diagnostics, self.acceptances)
