"""The command: read, call, print, exit. Nothing heavy is imported before a command needs it.

Exit status: 0 all shown, 1 a violation, 2 bad use or bad input, 3 nothing violated but something
not shown; 130 stopped by Ctrl-C.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from compiler import __version__
from fretish.diagnostic import Code, Diagnostic, has_errors, suggestion
from fretish.rendering import render_all

if TYPE_CHECKING:
    from compiler.project import Project
    from compiler.targets.target import Options

SHOWN, VIOLATION, BAD, NOT_SHOWN, INTERRUPTED = 0, 1, 2, 3, 130
_EMITS = ("ltl", "monitor", "ajpf", "json", "fret-json")
_NOTATIONS = ("plain", "fret", "spot", "nusmv", "latex")
_DEFAULT = "compile"
"""The command that `fretc FILE...` stands for."""


class _Commands(click.Group):
    """Sub-commands, and `FILE...` without one; a word that is neither gets a suggestion."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if args and args[0] not in self.commands and args[0] not in ("--help", "--version"):
            if not args[0].startswith("-") and not _is_path(args[0]):
                _stop(_unknown_command(args[0], [*self.commands]))
            args = [_DEFAULT, *args]
        return super().parse_args(ctx, args)

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [name for name in self.commands if name != _DEFAULT]

    def format_usage(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        formatter.write_usage("fretc", "FILE... [--emit KIND]\n       fretc COMMAND ...", "Usage: ")


class _Compile(click.Command):
    """The default command: it has no name of its own."""

    def format_usage(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        formatter.write_usage("fretc", "FILE... [OPTIONS]")


def _is_path(word: str) -> bool:
    return word == "-" or "/" in word or "." in word or Path(word).exists()


def _unknown_command(word: str, commands: Sequence[str]) -> Diagnostic:
    near = suggestion(word, [c for c in commands if c != _DEFAULT])
    known = ", ".join(c for c in commands if c != _DEFAULT)
    return Diagnostic(
        Code.UNKNOWN_COMMAND,
        f"`{word}` is no command of fretc, and no file",
        help=f"did you mean `fretc {near}`?" if near else f"there are {known}; or name a file",
    )


def _stop(*diagnostics: Diagnostic) -> None:
    """Say it and exit with 2."""
    _say(diagnostics)
    raise SystemExit(BAD)


def _say(diagnostics: Sequence[Diagnostic]) -> None:
    if diagnostics:
        click.echo(render_all(diagnostics), err=True)


@click.group(cls=_Commands, no_args_is_help=True)
@click.version_option(__version__, prog_name="fretc", message="%(prog)s %(version)s")
def cli() -> None:
    """From FRETish requirements to monitors, audited logs and a traceability report.

    `fretc FILE...` parses and formalizes requirements; with `--emit` it makes files of them:
    ltl, monitor, ajpf, json, fret-json. `fretc FILE --help` says more.
    """


@cli.command(_DEFAULT, cls=_Compile, hidden=True)
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option(
    "--emit",
    "kinds",
    multiple=True,
    type=click.Choice(_EMITS),
    help="Make this kind of file; may be given several times.",
)
@click.option("-o", "--output", default="build", show_default=True, help="Folder; `-` prints.")
@click.option("--bindings", help="bindings.toml; the one beside the first FILE if not given.")
@click.option(
    "--format",
    "form",
    type=click.Choice(("text", "json")),
    default="text",
    show_default=True,
    help="Form of the formulas.",
)
@click.option(
    "--notation",
    type=click.Choice(_NOTATIONS),
    default="plain",
    show_default=True,
    help="Spelling of the formulas.",
)
@click.option("--simplify", is_flag=True, help="Show a simplified formula beside the exact one.")
def compile_(
    files: tuple[str, ...],
    kinds: tuple[str, ...],
    output: str,
    bindings: str | None,
    form: str,
    notation: str,
    simplify: bool,
) -> None:
    """Parse and formalize requirements; make files of them.

    FILE holds one or more requirements; `-` is standard input.
    """
    from compiler.project import load

    project = load(files, bindings)
    _say(project.diagnostics)
    as_json = form == "json" and set(kinds) <= {"ltl"}
    if as_json and _only_failed(project):
        _deliver_formulas(project, output if kinds else "-")
        raise SystemExit(BAD if has_errors(project.diagnostics) else SHOWN)
    if has_errors(project.diagnostics):
        raise SystemExit(BAD)
    from compiler.targets.target import Options

    options = Options(notation, simplify, tuple(f.requirement for f in project.failed))
    if kinds:
        _emit(project, dict.fromkeys(kinds), output, options)
    else:
        _print_formulas(project, options)


def _only_failed(project: Project) -> bool:
    """Whether every error is that of a sentence: the list of formulas then carries it."""
    told = [failed.diagnostic for failed in project.failed]
    return all(d in told for d in project.diagnostics if d.is_error)


def _deliver_formulas(project: Project, output: str) -> None:
    """The array of `--emit ltl --format json`, in the order of the files."""
    from compiler.record import failed, formulas
    from compiler.templating import to_json

    found = {id(rule.requirement): formulas(rule) for rule in project.rules}
    found |= {id(f.requirement): failed(f.requirement, f.diagnostic) for f in project.failed}
    text = to_json([found[id(r)] for r in project.requirements])
    _deliver({"ltl.json": f"{text}\n"}, output)


def _print_formulas(project: Project, options: Options) -> None:
    from compiler.targets.ltl import text

    click.echo("\n".join(text(rule, options) for rule in project.rules), nl=False)


def _emit(project: Project, kinds: dict[str, None], output: str, options: Options) -> None:
    from compiler.targets import TARGETS

    targets = [TARGETS[kind] for kind in kinds]
    refused = [
        diagnostic
        for target in targets
        for rule in project.rules
        if (diagnostic := target.refuse(rule)) is not None
    ]
    if refused:
        _stop(*refused)
    files = [artifact for target in targets for artifact in target.emit(project.rules, options)]
    _deliver({str(artifact.path): artifact.text for artifact in files}, output)


def _deliver(files: dict[str, str], output: str) -> None:
    """Print the texts (`-`), or write them below the folder and name them."""
    from pathlib import PurePosixPath

    from compiler.artifact import Artifact
    from compiler.files import write

    if output == "-":
        click.echo("".join(files.values()), nl=False)
        return
    artifacts = [Artifact(PurePosixPath(path), text) for path, text in files.items()]
    wrong = write(artifacts, Path(output))
    if wrong is not None:
        _stop(wrong)
    for path in files:
        click.echo(f"wrote {Path(output) / path}", err=True)


@cli.command(short_help="Put sentences into their canonical wording.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--check", is_flag=True, help="Write nothing; exit with 1 if a file would change.")
@click.option("-o", "--output", type=click.Choice(("-",)), help="`-` prints in place of writing.")
def fmt(files: tuple[str, ...], check: bool, output: str | None) -> None:
    """Put the sentences of requirement files into their canonical wording."""
    from compiler.formatting import formatted

    done, wrong = formatted(files)
    if wrong:
        _stop(*wrong)
    changed = [file for file in done if file.before != file.after]
    if output == "-":
        click.echo("".join(file.after for file in done), nl=False)
    elif check:
        for file in changed:
            click.echo(f"would change {file.path}", err=True)
        raise SystemExit(VIOLATION if changed else SHOWN)
    else:
        for file in changed:
            path = Path(file.path)
            _deliver({path.name: file.after}, str(path.parent))


@cli.command("import", short_help="Read requirements that FRET exported.")
@click.argument("file", metavar="FILE")
@click.option(
    "-o", "--output", default="requirements", show_default=True, help="Folder; `-` prints."
)
@click.option("--id-column", help="CSV: the column of the ids.")
@click.option("--text-column", help="CSV: the column of the sentences or texts.")
@click.option("--project-column", help="CSV: the column of the projects.")
@click.option("--force", is_flag=True, help="Write over files that are there.")
def import_(
    file: str,
    output: str,
    id_column: str | None,
    text_column: str | None,
    project_column: str | None,
    force: bool,
) -> None:
    """Read requirements that FRET exported: JSON, or a CSV.

    Writes a `.fret` file for each project, and `bindings.toml` with FRET's variables. Formulas are
    not taken over: they are made from the sentences.
    """
    from compiler.exchange import read_export
    from compiler.files import read

    source = read(file)
    if isinstance(source, Diagnostic):
        _stop(source)
        return
    asked = {"id": id_column, "text": text_column, "project": project_column}
    result = read_export(source, {part: name for part, name in asked.items() if name})
    _say(result.diagnostics)
    if has_errors(result.diagnostics):
        raise SystemExit(BAD)
    files = {str(artifact.path): artifact.text for artifact in result.artifacts}
    there = [path for path in files if (Path(output) / path).exists()]
    if there and output != "-" and not force:
        _stop(_exists(str(Path(output) / there[0])))
    _deliver(files, output)
    counts = f"{result.requirements} requirements, {result.variables} variables"
    click.echo(f"imported {counts}", err=True)


def _exists(path: str) -> Diagnostic:
    return Diagnostic(
        Code.NOT_WRITTEN,
        f"`{path}` is there already",
        help="name another folder with `-o`, or write over it with `--force`",
    )


@cli.command(short_help="Audit recorded runs against all requirements.")
@click.argument("logs", nargs=-1, required=True, metavar="LOG...")
@click.option(
    "--requirements", default="requirements", show_default=True, help="Folder, or one file."
)
@click.option("--bindings", help="bindings.toml; the one in the requirements' folder if not given.")
@click.option(
    "--evidence", default="build/evidence.json", show_default=True, help="Where evidence goes."
)
@click.option(
    "--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True
)
def audit(
    logs: tuple[str, ...], requirements: str, bindings: str | None, evidence: str, form: str
) -> None:
    """Audit recorded runs against all requirements.

    LOG is an MCAP file. Each run and requirement gets a verdict: satisfied, violated,
    inconclusive, vacuous or no data; the evidence goes to a JSON file.
    """
    from compiler.auditing import audit_logs
    from compiler.project import beside, load, requirement_files

    files = requirement_files(requirements)
    if isinstance(files, Diagnostic):
        _stop(files)
        return
    project = load(files, bindings or beside(requirements, "bindings.toml"))
    _say(project.diagnostics)
    if has_errors(project.diagnostics):
        raise SystemExit(BAD)
    result = audit_logs(project, logs)
    _say(result.diagnostics)
    if not result.results:
        raise SystemExit(BAD)
    path = Path(evidence)
    if result.read:  # a mistyped name must not cost the evidence of the last audit
        _deliver({path.name: result.evidence}, str(path.parent))
    click.echo(result.as_json if form == "json" else _coloured(result.text), nl=False)
    if has_errors(result.diagnostics):
        raise SystemExit(BAD)
    raise SystemExit(VIOLATION if result.violated else SHOWN if result.shown else NOT_SHOWN)


def _coloured(lines: Sequence[tuple[str, str | None]]) -> str:
    """The lines, each in its colour where standard output is a terminal that wants colours."""
    plain = not sys.stdout.isatty() or "NO_COLOR" in os.environ
    return "".join(
        f"{text if plain or colour is None else click.style(text, fg=colour)}\n"
        for text, colour in lines
    )


@cli.command(short_help="Trace hazard to verdict in one HTML file.")
@click.option("--html", "html", default="build/report.html", show_default=True, help="The report.")
@click.option("--json", "json_", help="Also write what the report says as JSON.")
@click.option(
    "--requirements", default="requirements", show_default=True, help="Folder, or one file."
)
@click.option("--bindings", help="bindings.toml; the one in the requirements' folder if not given.")
@click.option("--hazards", help="hazards.toml; the one in the requirements' folder if not given.")
@click.option("--evidence", default="build/evidence.json", show_default=True)
def report(
    html: str,
    json_: str | None,
    requirements: str,
    bindings: str | None,
    hazards: str | None,
    evidence: str,
) -> None:
    """Trace hazard, requirement, formula, artefact, run and verdict in one HTML file."""
    from compiler.project import beside, load, requirement_files
    from compiler.report import make

    files = requirement_files(requirements)
    if isinstance(files, Diagnostic):
        _stop(files)
        return
    project = load(
        files,
        bindings or beside(requirements, "bindings.toml"),
        hazards or beside(requirements, "hazards.toml"),
    )
    made = make(project, evidence)
    _say([*project.diagnostics, *made.diagnostics])
    if made.html is None or made.json is None:
        raise SystemExit(BAD)
    for path, text in ((html, made.html), (json_, made.json)):
        if path is not None:
            _deliver({Path(path).name: text}, str(Path(path).parent))


@cli.command(short_help="Record a mission of the simulated robot.")
@click.option("--out", required=True, help="The MCAP file to record.")
@click.option("--seed", default=1, show_default=True, type=click.IntRange(min=0))
@click.option(
    "--duration",
    default=240.0,
    show_default=True,
    type=click.FloatRange(min=0, min_open=True),
    help="Simulated seconds after which the mission is given up.",
)
def simulate(out: str, seed: int, duration: float) -> None:
    """Let the simulated robot drive its mission and record it.

    Needs the extra `sim`: pip install 'fretc[sim]'.
    """
    from simulation import missing

    absent = missing()
    if absent:
        _stop(_missing_extra(absent))
    from simulation.mission import record

    path = Path(out)
    if path.is_dir():
        _stop(_not_written(out, "it is a directory"))
    with _progress(duration) as tell:
        try:
            mission = record(path, seed, duration, tell)
        except OSError as error:
            _stop(_not_written(out, error.strerror or str(error)))
            return
    click.echo(f"wrote {out}", err=True)
    click.echo(
        f"seed {mission.seed}: {mission.duration:.1f} s, "
        f"{mission.goals_reached} of {mission.goals_total} goals, {mission.stops} stops, "
        f"least clearance {mission.true_clearance * 100:.1f} cm, {mission.messages} messages"
    )


def _progress(seconds: float) -> Any:
    """A context manager that gives a function to tell the simulated seconds to."""
    from contextlib import contextmanager

    @contextmanager
    def shown() -> Any:
        if not sys.stderr.isatty():
            yield None
            return
        with click.progressbar(
            length=int(seconds * 10), label="simulating", file=sys.stderr
        ) as bar:
            yield lambda now: bar.update(int(now * 10) - bar.pos)

    return shown()


def _missing_extra(absent: Sequence[str]) -> Diagnostic:
    names = " and ".join(f"`{name}`" for name in absent)
    return Diagnostic(
        Code.MISSING_EXTRA,
        f"the simulated robot needs {names}",
        help="install the extra: pip install 'fretc[sim]' "
        "(in a checkout: .venv/bin/pip install '.[sim]')",
    )


def _not_written(path: str, why: str) -> Diagnostic:
    return Diagnostic(
        Code.NOT_WRITTEN, f"`{path}` cannot be written: {why}", help="name another file"
    )


def main() -> None:
    """What the `fretc` command runs: no traceback ever reaches a user."""
    try:
        status = cli.main(prog_name="fretc", standalone_mode=False)
        sys.stdout.flush()
        raise SystemExit(status if isinstance(status, int) else SHOWN)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
        raise SystemExit(SHOWN) from None
    except click.ClickException as error:
        _say([_bad_usage(error)])
        raise SystemExit(BAD) from None
    except (click.Abort, KeyboardInterrupt):
        click.echo("stopped", err=True)
        raise SystemExit(INTERRUPTED) from None
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise SystemExit(BAD) from None
    except RecursionError:
        _say([_too_deep()])
        raise SystemExit(BAD) from None
    except Exception as error:
        if "FRETC_TRACEBACK" in os.environ:
            raise
        _say([_internal(error)])
        raise SystemExit(BAD) from None


def _too_deep() -> Diagnostic:
    return Diagnostic(
        Code.TOO_DEEP,
        "an expression has too many operators within each other",
        help="give parts of it names of their own",
    )


def _bad_usage(error: click.ClickException) -> Diagnostic:
    message = error.format_message()
    command = error.ctx.command_path if isinstance(error, click.UsageError) and error.ctx else ""
    command = command.removesuffix(f" {_DEFAULT}") or "fretc"
    return Diagnostic(
        Code.BAD_USAGE,
        f"{message[:1].lower()}{message[1:].rstrip('.')}",
        help=f"see `{command} --help`",
    )


def _internal(error: Exception) -> Diagnostic:
    where = ""
    if error.__traceback__ is not None:
        last = error.__traceback__
        while last.tb_next is not None:
            last = last.tb_next
        where = f" in {Path(last.tb_frame.f_code.co_filename).name}:{last.tb_lineno}"
    return Diagnostic(
        Code.INTERNAL,
        f"fretc itself is at fault: {type(error).__name__}{where}: {error}",
        help="please report it with the input; FRETC_TRACEBACK=1 shows where it comes from",
    )
