"""The commands about requirement files: formalize and emit, `fmt`, `import`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING

import click

from compiler.emit import TARGETS, renamed_propositions
from fretc.commands.opening import usable_part
from fretc.terminal.group import DEFAULT, Compile
from fretc.terminal.options import PATH, first_bindings_option, format_option, output_option
from fretc.terminal.output import (
    EXIT_OK,
    EXIT_USAGE,
    EXIT_VIOLATION,
    REQUIREMENTS_FOLDER,
    fail,
    fail_at_end,
    or_fail,
    print_diagnostics,
    print_status,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from compiler.formalization.formalized import FormalizedRequirement
    from compiler.project.fret_import import ImportResult
    from compiler.project.project import Project, Refused
    from compiler.targets.target import Target, TargetOptions

_NOTATIONS = ("plain", "fret", "spot", "nusmv", "latex")


@click.command(DEFAULT, cls=Compile, hidden=True)
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@click.option(
    "--emit",
    "kinds",
    multiple=True,
    type=click.Choice([*TARGETS]),
    help="Kind of file to generate. Repeatable.",
)
@output_option(default="build", show_default=True, help="Folder for generated files. `-` prints.")
@first_bindings_option
@format_option(text="Output format of the formulas.")
@click.option(
    "--notation",
    type=click.Choice(_NOTATIONS),
    default="plain",
    show_default=True,
    help="Notation of the formulas.",
)
@click.option(
    "--simplify", is_flag=True, help="Also show a simplified formula, if Spot is installed."
)
@click.option(
    "--one-file", is_flag=True, help="Generate one file with the monitors of all requirements."
)
@click.option(
    "--weaken",
    is_flag=True,
    help="In AJPF files, write `eventually` where the requirement "
    "says `within`; each such file says so.",
)
def compile_(
    files: tuple[str, ...],
    kinds: tuple[str, ...],
    output: str,
    bindings: str | None,
    output_format: str,
    notation: str,
    simplify: bool,
    one_file: bool,
    weaken: bool,
) -> None:
    """Formalize requirements, and generate files from them.

    FILE is a requirement file, or a folder of them; `-` is standard input. Without `--emit`,
    the command prints the meaning and the formulas.

    Example: fretc requirements/r1.fret --emit monitor --emit c
    """
    from compiler.project.folder import load
    from compiler.project.paths import expanded_paths

    if one_file and not any(TARGETS[kind].joins for kind in kinds):
        *most, last = (f"`--emit {name}`" for name, each in TARGETS.items() if each.joins)
        joining = f"{', '.join(most)} and {last}"
        fail(diagnostic("one_file_not_joining", joining=joining))
    if weaken:
        _check_weaken(kinds)
    paths = or_fail(expanded_paths(files))
    reads = {table for kind in kinds for table in TARGETS[kind].reads}
    project = load(paths, bindings, reads=reads)
    undecided = _undecided(project.sound.formalized)
    print_diagnostics([*project.diagnostics, *project.answered(undecided)])
    if output_format == "json" and set(kinds) <= {"ltl"} and not has_errors(project.general):
        if has_errors(project.diagnostics):
            fail_at_end()
        _deliver_formulas(project, output if kinds else "-")
        return
    project = usable_part(project, others=any(TARGETS[kind].of_bindings for kind in kinds))
    from compiler.targets.target import TargetOptions

    free_texts = tuple(f.requirement for f in project.failed if not f.diagnostic.is_error)
    options = TargetOptions(
        notation,
        simplify,
        one_file,
        free_texts,
        weaken,
        project.declarations,
        project.attribution,
    )
    if kinds:
        _emit(project, dict.fromkeys(kinds), output, options, undecided)
    else:
        _print_formulas(project, options)


def _undecided(requirements: Sequence[FormalizedRequirement]) -> list[Diagnostic]:
    """F203 for each requirement that no finite run decides; reported once for all targets."""
    monitor = TARGETS["monitor"]
    remarks = [
        monitor.remark(requirement)
        for requirement in requirements
        if monitor.refuse(requirement) is None
    ]
    return [remark for remark in remarks if remark is not None]


def _check_weaken(kinds: Sequence[str]) -> None:
    """F907 if no requested target has a weaker form."""
    weak = [f"`--emit {name}`" for name, target in TARGETS.items() if target.weak is not None]
    if not any(TARGETS[kind].weak for kind in kinds):
        fail(diagnostic("nothing_to_weaken", targets=" and ".join(weak)))


def _deliver_formulas(project: Project, output: str) -> None:
    """Write the JSON array of `--emit ltl --format json`, in the order of the files."""
    from compiler.files.templating import to_json
    from compiler.formalization.record import failed, formulas

    records = {}
    for requirement in project.formalized:
        names = renamed_propositions(requirement)
        records[requirement.entry] = formulas(requirement) | ({"names": names} if names else {})
    records |= {f.requirement: failed(f.requirement, f.diagnostic) for f in project.failed}
    records |= {r.requirement: failed(r.requirement, r.why[0]) for r in project.refused}
    text = to_json([records[r] for r in project.requirements])
    write_outputs({Path(output) / "ltl.json" if output != "-" else Path("-"): f"{text}\n"})


def _print_formulas(project: Project, options: TargetOptions) -> None:
    from compiler.targets.ltl import text

    click.echo(
        "\n".join(text(requirement, options) for requirement in project.formalized), nl=False
    )


def _emit(
    project: Project,
    kinds: dict[str, None],
    output: str,
    options: TargetOptions,
    remarks: Sequence[Diagnostic],
) -> None:
    """Write the files of all targets; a refusal of one target does not affect the others."""
    named = [TARGETS[kind] for kind in kinds]
    targets = [(options.weaken and target.weak) or target for target in named]
    outputs = [(target, *_emitted(target, project, options)) for target in targets]
    refusals = list(dict.fromkeys(chain.from_iterable(wrong for _, _, wrong in outputs)))
    jobs = [
        (target, requirements) for target, requirements, _ in outputs if requirements is not None
    ]
    print_diagnostics(refusals)
    of_rules = [
        d
        for target, requirements in jobs
        for requirement in requirements
        if (d := target.remark(requirement))
    ]
    print_diagnostics(project.answered(remark for remark in of_rules if remark not in remarks))
    print_diagnostics(project.answered(d for target, _ in jobs for d in target.remarks(options)))
    files = {
        target.name: {str(a.path): a.text for a in target.emit(requirements, options)}
        for target, requirements in jobs
    }
    texts = {path: text for each in files.values() for path, text in each.items()}
    first_time = output != "-" and not any((Path(output) / path).exists() for path in texts)
    _deliver_all(texts, output)
    if first_time and texts:
        print_status(
            _next_steps(project, {kind: next(iter(f)) for kind, f in files.items() if f}, output)
        )
    if refusals:
        raise SystemExit(EXIT_USAGE)


def _next_steps(project: Project, firsts: Mapping[str, str], output: str) -> str:
    """Print the next commands for files that are written for the first time.

    Args:
        project: the project of the files.
        firsts: target name → its first file.
        output: folder of the files.
    """
    steps = [
        TARGETS[kind].next_step.format(quote(str(Path(output) / path)))
        for kind, path in firsts.items()
        if TARGETS[kind].next_step
    ]
    source = project.requirements[0].wording.source.name
    if source != "<stdin>":
        steps.append(
            f"`fretc explain {quote(source)}` explains the requirement with a timing diagram"
        )
    return "\n".join(visible(f"next: {step}") for step in steps)


def _emitted(
    target: Target, project: Project, options: TargetOptions
) -> tuple[list[FormalizedRequirement] | None, list[Diagnostic]]:
    """The requirements that the target accepts, or None for no file; and the refusals.

    A file that combines all requirements is written for all of them or not at all.
    """
    from compiler.formalization.formalize import name_collisions

    requirements = project.formalized
    answers = [(requirement, target.refuse(requirement)) for requirement in requirements]
    wrong = [*dict.fromkeys(refusal for _, refusal in answers if refusal is not None)]
    whole = [refusal] if (refusal := target.refuse_project(options)) else []
    one_file = target.together or (options.one_file and target.joins)
    if one_file:
        whole += name_collisions(requirements)
    if options.one_file and target.joins and not (wrong or whole):
        whole += [refusal] if (refusal := target.refuse_joint(requirements)) else []
    if target.together and any(
        each.is_error and each.code is Code.BAD_SETTINGS for each in project.diagnostics
    ):  # The settings name the maintainer of a package.
        return None, wrong
    if project.refused and not target.of_bindings and (one_file or not target.per_rule):
        whole.append(_not_of_all(target, project.refused))
    if whole or (wrong and (one_file or not target.per_rule)):
        return None, [*wrong, *whole]
    expressible = [requirement for requirement, refusal in answers if refusal is None]
    return (expressible or None) if wrong else expressible, wrong


def _not_of_all(target: Target, refused: Sequence[Refused]) -> Diagnostic:
    """F618: a file that combines all requirements would lack some."""
    ids = ", ".join(refusal.requirement.id for refusal in refused)
    return diagnostic("not_of_all", target=target.name, ids=ids)


@click.command()
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@click.option(
    "--check", is_flag=True, help="Write nothing; exit with status 1 if a file would change."
)
@click.option(
    "-o",
    "--output",
    type=click.Choice(("-",)),
    help="`-` prints the files instead of rewriting them.",
)
def fmt(files: tuple[str, ...], check: bool, output: str | None) -> None:
    """Rewrite the sentences of requirement files in canonical wording.

    Example: fretc fmt requirements/*.fret
    """
    from compiler.project.formatting import formatted_files
    from compiler.project.paths import expanded_paths

    paths = or_fail(expanded_paths(files))
    texts, wrong = formatted_files(paths)
    if wrong:
        fail(*wrong)
    changed = [file for file in texts if file.before != file.after]
    if output == "-" or files == ("-",):
        click.echo("".join(file.after for file in texts), nl=False)
    elif check:
        for file in changed:
            print_status(f"would change {file.path}")
        raise SystemExit(EXIT_VIOLATION if changed else EXIT_OK)
    else:
        for file in changed:
            path = Path(file.path)
            write_outputs({path: file.after})


@click.command("import")
@click.argument("files", nargs=-1, required=True, type=PATH, metavar="FILE...")
@output_option(default=REQUIREMENTS_FOLDER, show_default=True, help="Folder. `-` prints.")
@click.option("--id-column", help="Name of the CSV column with the ids.")
@click.option("--text-column", help="Name of the CSV column with the sentences or texts.")
@click.option("--project-column", help="Name of the CSV column with the projects.")
@click.option("--force", is_flag=True, help="Overwrite existing files.")
def import_(
    files: tuple[str, ...],
    output: str,
    id_column: str | None,
    text_column: str | None,
    project_column: str | None,
    force: bool,
) -> None:
    """Import requirements that FRET has exported, as JSON or CSV; agents; or TLSF.

    The command writes a .fret file for each FRET project, and bindings.toml with FRET's
    variables. Formulas are made anew from the sentences. The columns of a CSV are separated by
    comma, semicolon or tab, whichever splits its header into the most columns. Of an agent (.gwen)
    and its properties (.psl), the command writes a .fret file for each, and their actions. Each
    formula of a specification in TLSF (.tlsf) becomes sentences of the same meaning.

    Example: fretc import EXPORT.json -o requirements
    """
    columns = {"id": id_column, "text": text_column, "project": project_column}
    result = _imported(files, {part: name for part, name in columns.items() if name})
    print_diagnostics(result.diagnostics)
    if has_errors(result.diagnostics):
        raise SystemExit(EXIT_USAGE)
    texts = {str(artifact.path): artifact.text for artifact in result.artifacts}
    clashes = [path for path in texts if (Path(output) / path).exists()]
    if clashes and output != "-" and not force:
        fail(diagnostic("output_exists", path=str(Path(output) / clashes[0])))
    _deliver_all(texts, output)
    assumed = f" ({result.assumptions} of them assumptions)" if result.assumptions else ""
    counts = f"{result.requirements} requirements{assumed}, {result.variables} variables"
    print_status(f"imported {counts}")


def _imported(files: Sequence[str], columns: Mapping[str, str]) -> ImportResult:
    from compiler.files.text_files import read
    from compiler.project.fret_import import read_export
    from compiler.project.tlsf.importing import read_specification
    from compiler.targets.ajpf.agent_import import SUFFIXES, read_agents

    sources = [or_fail(read(file)) for file in files]
    if all(source.name.endswith(SUFFIXES) for source in sources):
        return read_agents(sources)
    if len(sources) > 1:
        raise click.UsageError("only agents and properties (.gwen, .psl) are imported together")
    (source,) = sources
    if source.name.lower().endswith(".tlsf"):
        return read_specification(source)
    return read_export(source, columns)


def _deliver_all(files: Mapping[str, str], output: str) -> None:
    """Write the files below the folder, or print them one after the other for `-`."""
    if output == "-":
        write_outputs({Path("-"): "".join(files.values())})
    else:
        write_outputs({Path(output) / path: text for path, text in files.items()})
