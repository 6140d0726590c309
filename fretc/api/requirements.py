"""Read projects, formalize sentences, and print formulas."""

from __future__ import annotations

import os

from compiler.files.text_files import read
from compiler.formalization.formalize import formalize as formalized
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from compiler.project.folder import load_folder
from compiler.project.project import Project
from fretc.api.refusal import Refusal, accepted, bounded
from fretish.bindings.declarations import Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.meaning import meaning

Path = str | os.PathLike[str]


@bounded
def read_project(
    requirements: Path = "requirements", bindings: Path | None = None, hazards: Path | None = None
) -> Project:
    """Read a folder of requirements, or one file, with bindings and hazards.

    An error in a requirement, or in a signal or a proposition that it reads, does not affect the
    others. The `diagnostics` of the project report it. Functions that need that requirement refuse
    it, or report that it is not shown.

    Args:
        requirements: the folder, or one `.fret` file.
        bindings: None: the `bindings.toml` in the folder, if there is one.
        hazards: None: the `hazards.toml` in the folder, if there is one.

    Raises:
        Refusal: there is no requirement, or no part of the bindings or the hazards can be used.
    """
    project = accepted(load_folder(os.fspath(requirements), _path(bindings), _path(hazards)))
    if has_errors(project.general):
        raise Refusal(each for each in project.general if each.is_error)
    return project


@bounded
def formalize(sentence: str, bindings: Path | None = None, id: str = "R1") -> FormalizedRequirement:
    """Parse and formalize one sentence of FRETish.

    Args:
        sentence: the text of the sentence, without a header.
        bindings: path of a `bindings.toml`; None: durations count ticks, whatever their unit.
        id: the id of the requirement.

    Raises:
        Refusal: the sentence is not FRETish, is free text, or the bindings have an error.
    """
    entry = RequirementEntry(id, Source("<sentence>", sentence.strip()).span())
    declarations = _declarations(bindings) if bindings is not None else None
    requirement, remarks = formalized(entry, declarations)
    if requirement is None or has_errors(remarks):
        raise Refusal([remark for remark in remarks if remark.is_error] or remarks)
    return requirement


def _path(path: Path | None) -> str | None:
    return None if path is None else os.fspath(path)


def _declarations(path: Path) -> Declarations:
    declarations, remarks = read_bindings(accepted(read(os.fspath(path))))
    if declarations is None or has_errors(remarks):
        raise Refusal(remark for remark in remarks if remark.is_error)
    return declarations


@dataclass(frozen=True, slots=True)
class Formulas:
    """The formulas of one requirement in one notation."""

    infinite: str
    """Future-time formula on infinite traces."""
    finite: str
    """Future-time formula on finite traces, with `LAST`."""
    past: str | None
    """Past-time formula at the last tick; None if the notation has no past operators."""
    probabilistic: str | None
    """PCTL* formula; None if the sentence has no probability."""
    meaning: str
    """The sentence in plain English."""


def formulas(requirement: FormalizedRequirement, notation: str = "plain") -> Formulas:
    """The formulas of a requirement.

    Args:
        requirement: from `formalize`, or one of the `requirements` of a project.
        notation: `plain`, `fret`, `spot`, `nusmv` or `latex`.

    Raises:
        Refusal: the notation is unknown.
    """
    dialect = printing.DIALECTS.get(notation)
    if dialect is None:
        raise Refusal((_no_notation(notation),))
    return Formulas(
        printing.text(requirement.ft_infinite, dialect),
        printing.text(requirement.ft_finite, dialect),
        printing.text(requirement.pt, dialect) if dialect.has_past else None,
        printing.pctl(requirement.pctl) if requirement.pctl is not None else None,
        meaning(requirement.written, requirement.ticks, requirement.clock),
    )


def _no_notation(notation: str) -> Diagnostic:
    return diagnostic("unknown_notation", notation=notation, notations=", ".join(printing.DIALECTS))
