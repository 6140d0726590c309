"""Reading a requirements folder into a `Project`."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from compiler.files.attribution import NOBODY
from compiler.files.settings import Settings, settings
from compiler.files.text_files import read
from compiler.formalization.formalize import duplicate_ids, formalize, unreadable_sentence
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.acceptances import acceptances, with_acceptance_reasons
from compiler.project.hazards import cycles, unknown_parents
from compiler.project.hazards import hazards as read_hazards
from compiler.project.paths import (
    BINDINGS,
    HAZARDS,
    first_sibling_path,
    requirement_files,
    sibling_path,
)
from compiler.project.project import Project, UnformalizedRequirement
from compiler.project.refusals import refused
from compiler.project.stated_numbers import check_stated_numbers
from fretish.bindings.declarations import SHARED, Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry, requirements, unreadable_file
from fretish.reading.memory import remembered

if TYPE_CHECKING:
    from compiler.project.parents import Parent


def load(
    paths: Sequence[str],
    bindings: str | None = None,
    hazards: str | None = None,
    *,
    parents: bool = False,
    reads: Collection[str] = SHARED,
) -> Project:
    """Read requirement files, their bindings, hazards, settings and parents.

    Args:
        paths: `.fret` files; `-` is standard input.
        bindings: their `bindings.toml`; None: the one in the folder of the first file, if any.
        hazards: their `hazards.toml`; None: no hazards are read.
        parents: whether parents in other tools are read, as the settings name them.
        reads: the shared tables of the bindings that the caller reads; an error in another table
            refuses nothing.
    """
    declarations, of_bindings = _declarations(
        bindings or first_sibling_path(paths, BINDINGS), reads
    )
    hazard_of, of_hazards = read_hazards(hazards) if hazards else ({}, ())
    written = _written(paths)
    chosen = _settings(paths)
    above, elsewhere = _above(chosen) if parents else ({}, ())
    broken = declarations is None and has_errors(of_bindings)
    requirements, failed, mistaken, remarks = _formalized(written, declarations, broken=broken)
    upward = [*of_hazards, *elsewhere]
    if (hazards or parents) and not has_errors(upward):
        upward.extend(unknown_parents(written, hazard_of, above, hazards))
        upward.extend(cycles(written))
    declarations = _with_atoms(declarations, requirements)
    mistakes = declarations.mistakes.values() if declarations else ()
    single = frozenset(chain.from_iterable(mistakes))
    of_all = [each for each in of_bindings if each not in single]
    own = mistaken | {failure.requirement: failure.diagnostic for failure in failed}
    accepted, unanswered = acceptances(written, chosen if isinstance(chosen, Settings) else None)
    if isinstance(chosen, Diagnostic) and not parents:
        unanswered = (*unanswered, chosen)
    everything = (*of_bindings, *remarks, *upward, *unanswered)
    return Project(
        tuple(written),
        requirements,
        failed,
        declarations,
        hazard_of,
        with_acceptance_reasons(everything, accepted),
        (*of_all, *upward),
        mistaken,
        above,
        accepted,
        chosen.project if isinstance(chosen, Settings) else NOBODY,
        chosen.viewer if isinstance(chosen, Settings) else "",
        refused(written, requirements, own, declarations, of_all),
    )


def _with_atoms(
    declarations: Declarations | None, requirements: Sequence[FormalizedRequirement]
) -> Declarations | None:
    """The declarations extended by the atoms over signals of all requirements."""
    if declarations is None:
        return None
    propositions, mistakes = {**declarations.propositions}, {**declarations.mistakes}
    for requirement in requirements:
        own = requirement.declarations
        if own is not None and own.propositions is not declarations.propositions:
            propositions.update(own.propositions)
        if own is not None and own.mistakes is not declarations.mistakes:
            mistakes.update(own.mistakes)
    return replace(declarations, propositions=propositions, mistakes=mistakes)


def _written(paths: Sequence[str]) -> list[RequirementEntry]:
    """Every requirement; an unreadable file counts as one."""
    entries: list[RequirementEntry] = []
    for path in paths:
        source = read(path)
        if isinstance(source, Diagnostic):
            entries.append(unreadable_file(path, source))
        else:
            entries.extend(_entries(source))
    return entries


@remembered
def _entries(source: Source) -> tuple[RequirementEntry, ...]:
    return requirements(source)[0]


_MOST_BROKEN_HEADERS = 100
"""Up to this number of erroneous headers their sentences are checked, too; a file with thousands is
not fixed by hand."""


def _formalized(
    written: Sequence[RequirementEntry], declarations: Declarations | None, *, broken: bool
) -> tuple[
    tuple[FormalizedRequirement, ...],
    tuple[UnformalizedRequirement, ...],
    dict[RequirementEntry, Diagnostic],
    list[Diagnostic],
]:
    """Formalized requirements, failed ones, errors of formalized ones, and all diagnostics.

    Args:
        written: the requirements of the files.
        declarations: None if there are none, or they are `broken`; they may include a clock.
        broken: whether an error makes all bindings unusable.
    """
    unsaid = frozenset({Code.NO_CLOCK}) if broken else frozenset()
    mistaken = dict(duplicate_ids(written))
    requirements: list[FormalizedRequirement] = []
    failed: list[UnformalizedRequirement] = []
    diagnostics = list(dict.fromkeys(mistaken.values()))
    for entry in written:
        requirement, remarks = None, entry.mistakes
        if remarks and len(failed) < _MOST_BROKEN_HEADERS:
            remarks = (*remarks, *_unreadable_sentence(entry))
        if not entry.mistakes:
            requirement, remarks = _requirement(entry, declarations)
        diagnostics.extend(remark for remark in remarks if remark.code not in unsaid)
        if requirement is None:
            failed.append(UnformalizedRequirement(entry, _reason(remarks), remarks))
            continue
        requirements.append(requirement)
        if has_errors(remarks):
            mistaken.setdefault(entry, _reason(remarks))
    return tuple(requirements), tuple(failed), mistaken, _with_one_missing_clock(diagnostics)


_unreadable_sentence = remembered(unreadable_sentence)


@remembered
def _requirement(
    entry: RequirementEntry, declarations: Declarations | None
) -> tuple[FormalizedRequirement | None, tuple[Diagnostic, ...]]:
    """The formalized requirement, or None if there is an error; and all of its diagnostics."""
    requirement, remarks = formalize(entry, declarations)
    if requirement is not None and requirement.declarations is not None:
        remarks = (*remarks, *check_stated_numbers(requirement, requirement.declarations))
    return requirement, remarks


def _with_one_missing_clock(diagnostics: Sequence[Diagnostic]) -> list[Diagnostic]:
    """The diagnostics, with the first of all warnings that no clock measures a duration (F312)."""
    assumed = [each for each in diagnostics if each.code is Code.NO_CLOCK and not each.is_error]
    if len(assumed) < 2:
        return [*diagnostics]
    first, *others = assumed
    durations = "another duration" if len(others) == 1 else f"{len(others)} other durations"
    whole = diagnostic("assumed_ticks_of_all", first.span, first=first.message, others=durations)
    return [whole if each is first else each for each in diagnostics if each not in others]


def load_folder(
    folder: str, bindings: str | None = None, hazards: str | None = None
) -> Project | Diagnostic:
    """The project of a folder (or one file), with bindings, hazards, and parents in other tools.

    Args:
        folder: the folder of the requirements.
        bindings: None: the `bindings.toml` of the folder, if there is one.
        hazards: None: the `hazards.toml` of the folder, if there is one.
    """
    files = requirement_files(folder)
    if isinstance(files, Diagnostic):
        return files
    return load(
        files,
        bindings or sibling_path(folder, BINDINGS),
        hazards or sibling_path(folder, HAZARDS),
        parents=True,
    )


def _settings(paths: Sequence[str]) -> Settings | Diagnostic | None:
    """The settings of the project; None if it is read from standard input."""
    first = next((path for path in paths if path != "-"), None)
    return settings(str(Path(first).parent)) if first else None


def _above(
    chosen: Settings | Diagnostic | None,
) -> tuple[Mapping[str, Parent], tuple[Diagnostic, ...]]:
    """The parents in other tools, as the settings name them."""
    if isinstance(chosen, Diagnostic):
        return {}, (chosen,)
    if chosen is None:
        return {}, ()
    from compiler.project.parents import parents  # with archives and XML, which few projects have

    return parents(chosen)


def _reason(remarks: Sequence[Diagnostic]) -> Diagnostic:
    """The first error; the note if the requirement is free text."""
    return next((remark for remark in remarks if remark.is_error), remarks[0])


def _declarations(
    path: str | None, reads: Collection[str]
) -> tuple[Declarations | None, tuple[Diagnostic, ...]]:
    if path is None:
        return None, ()
    source = read(path)
    if isinstance(source, Diagnostic):
        return None, (source,)
    declarations, remarks = _bindings(source)
    if declarations is not None and any((kind, "") in declarations.mistakes for kind in reads):
        return None, remarks
    return declarations, remarks


_bindings = remembered(read_bindings)
