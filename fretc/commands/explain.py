"""`fretc explain`: explain a requirement, or the code of a diagnostic."""

from __future__ import annotations

import os
import re
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import print_excluded
from fretc.terminal.group import is_sentence
from fretc.terminal.options import (
    PATH,
    bindings_option,
    format_option,
    path_option,
    requirements_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_USAGE,
    fail,
    fail_at_end,
    print_diagnostics,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic, did_you_mean, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source

if TYPE_CHECKING:
    from collections.abc import Sequence

    from compiler.formalization.formalized import FormalizedRequirement
    from compiler.project.project import Project
    from fretish.documents import RequirementEntry


@click.command()
@click.argument("what", type=PATH, metavar="WHAT")
@requirements_option
@bindings_option
@format_option()
@path_option("--svg", "picture", help="Write the timing diagram to this file. `-` prints it.")
def explain(
    what: str, requirements: str, bindings: str | None, output_format: str, picture: str | None
) -> None:
    """Explain a requirement, or the code of a message.

    WHAT is the id of a requirement, a .fret file or folder, a sentence in quotes, or a code
    such as F203. For a requirement the command prints its meaning, its formulas, a timing
    diagram, and short traces that satisfy and violate it, each with the reason and the tick
    that decides.

    Example: fretc explain "whenever near the robot shall within 2 ticks satisfy stopped"
    """
    is_file = what == "-" or what.endswith(".fret") or _is_path(what)
    code = None if is_file else _code(what)
    if code is not None:
        if picture is not None:
            fail(diagnostic("picture_of_code"))
        _explain_code(code, output_format)
        return
    if is_sentence(what):
        formalized = _typed(what, requirements, bindings)
    else:
        formalized = _rules(what, requirements, bindings, is_file=is_file)
    if picture is not None and len(formalized) > 1:
        fix = f"name one of them: `fretc explain {quote(formalized[0].id)}`"
        fail(diagnostic("several_requirements", what=what, help=fix))
    _explain_rules(formalized, output_format, picture)


def _is_path(what: str) -> bool:
    """Whether the argument is a path; a bare word is an id, also if a folder has its name."""
    return Path(what).is_file() or (os.sep in what and Path(what).is_dir())


def _code(what: str) -> Code | None:
    return next((code for code in Code if code.number == what.upper()), None)


def _explain_code(code: Code, output_format: str) -> None:
    from compiler.files.templating import to_json
    from fretish.diagnostics import explanations

    if output_format == "json":
        click.echo(to_json(explanations.as_record(code)))
    else:
        click.echo(explanations.text(code), nl=False)


_MOST_TICKS = 100_000
"""Maximum duration in a diagram, which has a column for each tick."""


def _too_long(requirement: FormalizedRequirement) -> Diagnostic:
    return diagnostic(
        "picture_too_large",
        requirement.entry.wording,
        requirement=requirement.id,
        most=_MOST_TICKS,
    )


def _explain_rules(
    requirements: Sequence[FormalizedRequirement], output_format: str, picture: str | None
) -> None:
    from compiler.explanation import explain as explanation
    from compiler.explanation.drawing import svg
    from compiler.files.templating import to_json

    for requirement in requirements:
        if (requirement.ticks or 0) > _MOST_TICKS:
            fail(_too_long(requirement))
    explained = [explanation.explanation(requirement) for requirement in requirements]
    if picture != "-":
        if output_format == "json":
            click.echo(to_json([explanation.as_record(each) for each in explained]))
        else:
            click.echo("\n".join(map(explanation.text, explained)), nl=False)
    if picture is not None:
        sources = [requirement.entry.wording.source.name for requirement in requirements]
        write_outputs({Path(picture): svg(explained[0].picture)}, protected=sources)


def _typed(sentence: str, folder: str, bindings: str | None) -> list[FormalizedRequirement]:
    """A sentence as a requirement; the project's clock, if any, gives the length of a tick."""
    from compiler.formalization.binding_agreement import broken_tables
    from compiler.formalization.formalize import formalize
    from compiler.project.folder import load
    from compiler.project.paths import BINDINGS, sibling_path
    from fretish.documents import RequirementEntry

    project = load([], bindings or sibling_path(folder, BINDINGS), reads=())
    entry = RequirementEntry("sentence", Source("<sentence>", sentence.strip()).span())
    requirement, remarks = formalize(entry, project.declarations)
    print_diagnostics([*project.diagnostics, *remarks])
    if has_errors(project.diagnostics):
        fail_at_end()
    if requirement is None or has_errors((*project.general, *remarks)):
        raise SystemExit(EXIT_USAGE)
    if requirement.declarations is not None and [
        *broken_tables(requirement, requirement.declarations)
    ]:
        raise SystemExit(EXIT_USAGE)
    return [requirement]


def _rules(
    what: str, folder: str, bindings: str | None, *, is_file: bool
) -> list[FormalizedRequirement]:
    """The requirements to explain; exits if there is none."""
    from compiler.project.folder import load
    from compiler.project.paths import expanded_paths, requirement_files

    paths = expanded_paths([what]) if is_file else requirement_files(folder)
    if isinstance(paths, Diagnostic):
        fail(_unknown_code(what) or paths)
    project = load(paths, bindings, reads=())
    ids = [entry.id for entry in project.requirements]
    matches = ids if is_file else [id for id in ids if id.casefold() == what.casefold()]
    if not matches:
        _say_of(project, ())
        fail(_unknown(what, ids, folder, is_file=is_file))
    subjects = [r for r in project.requirements if r.id in matches]
    _say_of(project, subjects)
    requirements = [
        requirement for requirement in project.sound.formalized if requirement.id in matches
    ]
    if not requirements:
        raise SystemExit(
            EXIT_INCONCLUSIVE
        )  # Free text has status 3; an error has status 2 and wins.
    refused = {r.requirement.id: r.why for r in project.refused if r.requirement.id in matches}
    print_excluded(refused, len(subjects))
    return requirements


def _say_of(project: Project, subjects: Sequence[RequirementEntry]) -> None:
    """Print the diagnostics of the chosen requirements and of the bindings."""
    others = {
        diagnostic
        for requirement in project.requirements
        if requirement not in subjects
        for diagnostic in project.diagnostics
        if diagnostic.span is not None
        and diagnostic.span.source == requirement.wording.source
        and _nearest(project, diagnostic) is requirement
    }
    own = [diagnostic for diagnostic in project.diagnostics if diagnostic not in others]
    print_diagnostics(own)
    if has_errors(own):
        fail_at_end()


def _nearest(project: Project, diagnostic: Diagnostic) -> RequirementEntry | None:
    """The requirement at a position in its file: the first one that does not end before it."""
    assert diagnostic.span is not None
    for requirement in project.requirements:
        wording = requirement.wording
        if wording.source == diagnostic.span.source and diagnostic.span.start <= wording.end:
            return requirement
    return None


def _unknown_code(what: str) -> Diagnostic | None:
    """F515 for an unknown diagnostic code."""
    if not re.fullmatch(r"[Ff]\d+", what):
        return None
    area = [code.number for code in Code if code.number[1] == what[1]]
    return diagnostic(
        "unknown_id_or_code",
        word=what.upper(),
        help=f"there are {', '.join(sorted(area))}" if area else "codes begin with F1 to F9",
    )


def _unknown(what: str, ids: Sequence[str], folder: str, *, is_file: bool) -> Diagnostic:
    """F515 for an unknown requirement, or F515 for an unknown code if it looks like one."""
    if is_file:
        return diagnostic("no_requirement_in_text", what=what)
    if (unknown_code := _unknown_code(what)) is not None:
        return unknown_code
    if any(character.isspace() for character in what):
        return diagnostic("no_such_id", what=what)
    listing = f"there are {', '.join(ids[:8])}{', ...' if len(ids) > 8 else ''}"
    return diagnostic(
        "no_such_id_in_folder",
        folder=folder,
        what=what,
        help=did_you_mean(what, ids, listing if ids else "name a `.fret` file"),
    )
