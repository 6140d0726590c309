"""The command about proofs: whether what was made of requirements keeps them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from compiler.logic.claims import PROVERS, Layer
from fretc.terminal.group import Grouped
from fretc.terminal.options import (
    PATH,
    format_option,
    limit_option,
    output_option,
    path_option,
    places,
    requirements_option,
)
from fretc.terminal.output import (
    BAD,
    NOT_SHOWN,
    SHOWN,
    VIOLATION,
    coloured,
    deliver,
    say,
    say_briefly,
    stop,
)
from fretc.verification.layers.table import OF_MONITOR, in_words
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from compiler.logic.claims import Proof
    from compiler.project.folder import Project
    from fretc.verification.layers.request import Request
    from fretish.diagnostics.source import Source

_LAYERS = tuple(map(str, Layer))
_HEADINGS = {
    "What is looked at": ("layers", "monitor", "provers", "requirements", "bindings", "limit"),
    "Texts in place of new ones": ("path", "interceptor", "agent", "properties", "percepts"),
    "Found by others": ("ajpf",),
    "Printed and written": ("form", "output", "traces"),
}


_HELP = f"""Prove that what is made of requirements keeps them, layer by layer.

FILE holds requirements, or is a folder of such files: in place of `--requirements`.

{in_words()}

Exit status: 0 all proved, 1 a claim about a requirement is refuted, 2 bad use or input, 3 something
is vacuous, not checked, or stays stopped.
"""


@click.command(
    cls=Grouped,
    headings=_HEADINGS,
    help=_HELP,
    short_help="Prove that what is made of requirements keeps them.",
)
@click.argument("files", nargs=-1, type=PATH, metavar="[FILE]...")
@click.option(
    "--layer",
    "layers",
    multiple=True,
    type=click.Choice(_LAYERS),
    help="What to look at, maybe several; all six if none is given.",
)
@click.option("--monitor", is_flag=True, help="The same as `--layer monitor`.")
@click.option(
    "--with",
    "provers",
    multiple=True,
    type=click.Choice(PROVERS),
    help="A prover to ask as well, if it is installed.",
)
@path_option("--file", "path", help="A monitor that was made before.")
@path_option("--interceptor", help="An interceptor that was made before.")
@path_option("--agent", help="An agent in Gwendolen; with --properties.")
@path_option("--properties", help="The properties of the agent, as AJPF reads them.")
@click.option(
    "--percept", "percepts", multiple=True, help="A percept that the agent's environment draws."
)
@path_option(
    "--ajpf",
    multiple=True,
    help="A result of AJPF; each build/*_ajpf/result.json if none is given.",
)
@requirements_option
@path_option("--bindings", help="bindings.toml; the one beside the first FILE if not given.")
@limit_option
@format_option()
@output_option(
    default="build/verification.json", show_default=True, help="Where evidence goes; `-` prints it."
)
@path_option("--traces", help="A folder for each counterexample as a table that monitors read.")
def verify(
    files: tuple[str, ...],
    layers: tuple[str, ...],
    monitor: bool,
    provers: tuple[str, ...],
    path: str | None,
    interceptor: str | None,
    agent: str | None,
    properties: str | None,
    percepts: tuple[str, ...],
    ajpf: tuple[str, ...],
    requirements: str,
    bindings: str | None,
    limit: int,
    form: str,
    output: str,
    traces: str | None,
) -> None:
    """Prove that what is made of requirements keeps them."""
    from compiler.project.paths import companions
    from fretc.terminal.progress import at_work
    from fretc.verification.ajpf_results import written
    from fretc.verification.engines.sandbox import Limits
    from fretc.verification.layers.request import Request
    from fretc.verification.verify import refusals

    if (agent is None) != (properties is None):
        stop(_half(agent))
    named = dict.fromkeys((*layers, *(["monitor"] if monitor else [])))
    if path is not None and not named:
        named = {"monitor": None}
    project = _project(files, requirements, bindings)
    results = ajpf or (written() if "ajpf" in (named or _LAYERS) else ())
    request = Request(
        [Layer(name) for name in named or _LAYERS],
        Limits(seconds=limit),
        _read(path),
        _read(interceptor),
        _read(agent),
        _read(properties),
        percepts,
        provers,
        _ajpf_evidence(project, results),
        at_work,
    )
    mistakes = refusals(project, request)
    if mistakes:
        stop(*mistakes)
    proofs = _evidence(project, request)
    others = (path, interceptor, agent, properties, bindings, *results)
    sources = [requirement.wording.source.name for requirement in project.requirements]
    inputs = [*sources, *companions(sources), *(name for name in others if name is not None)]
    _deliver(proofs, form, output, traces, inputs)
    raise SystemExit(_status(proofs))


def _ajpf_evidence(project: Project, results: Sequence[str]) -> Sequence[Proof]:
    from fretc.verification.ajpf_results import evidence

    lines, diagnostics = evidence(project.rules, results)
    say(diagnostics)
    if has_errors(diagnostics):
        raise SystemExit(BAD)
    return lines


def _half(agent: str | None) -> Diagnostic:
    present, missing = ("properties", "agent") if agent is None else ("agent", "properties")
    return Diagnostic(
        Code.BAD_USAGE,
        f"`--{present}` is of no use without `--{missing}`",
        help="name both: `--agent FILE.gwen --properties FILE.psl`",
    )


def _project(files: Sequence[str], requirements: str, bindings: str | None) -> Project:
    from compiler.project.folder import load
    from compiler.project.paths import listed, requirement_files

    (first, *_) = places(files, requirements)
    paths = listed(files) if files else requirement_files(requirements)
    if isinstance(paths, Diagnostic):
        stop(paths)
    project = load(paths, bindings)
    say_briefly(project.diagnostics, first)
    if has_errors(project.diagnostics):
        raise SystemExit(BAD)
    if not project.rules:
        stop(Diagnostic(Code.NOTHING_TO_DO, "there is no requirement to verify"))
    return project


def _read(path: str | None) -> Source | None:
    from compiler.files.text_files import read

    if path is None:
        return None
    source = read(path)
    if isinstance(source, Diagnostic):
        stop(source)
    return source


def _evidence(project: Project, request: Request) -> Sequence[Proof]:
    from fretc.verification.monitor.verifying import NotAMonitorError
    from fretc.verification.verify import prove

    try:
        proofs = prove(project, request)
    except NotAMonitorError as error:
        assert request.monitor is not None
        stop(
            Diagnostic(
                Code.BAD_MONITOR,
                f"`{request.monitor.name}` is no generated monitor: {error}",
                request.monitor.span(0, 0),
                help="name a file that `--emit monitor` wrote",
            )
        )
    if isinstance(proofs, Diagnostic):
        stop(proofs)
    return proofs


def _deliver(
    proofs: Sequence[Proof], form: str, output: str, traces: str | None, inputs: Iterable[str]
) -> None:
    """Print it, and write the evidence and the runs."""
    from compiler.files.edition import __version__
    from compiler.files.records import plain
    from compiler.files.templating import to_json
    from compiler.logic.claims import SCHEMA, Document
    from fretc.verification.text_output import lines

    text = f"{to_json(plain(Document(SCHEMA, __version__, tuple(proofs))))}\n"
    if output != "-" or form == "json":
        click.echo(text if form == "json" else coloured([*lines(proofs)]), nl=False)
    files: dict[Path, str | bytes] = {}
    if output != "-" or form != "json":
        files[Path(output)] = text
    if traces is not None:
        files.update(_tables(proofs, Path(traces)))
    deliver(files, inputs)


def _tables(proofs: Sequence[Proof], folder: Path) -> dict[Path, str]:
    """Each run that a monitor can step, under the requirement, the layer and a number."""
    from fretc.verification.loop.replay import EXTRA
    from fretc.verification.text_output import as_csv

    files: dict[Path, str] = {}
    for one in proofs:
        if one.layer not in OF_MONITOR:
            continue
        if one.run is not None:
            names = one.run.names if one.layer is Layer.MONITOR else one.run.names[: -len(EXTRA)]
            stem = f"{one.requirement.lower()}_{one.layer}"
            number = sum(path.name.startswith(f"{stem}_") for path in files) + 1
            files[folder / f"{stem}_{number}.csv"] = as_csv(one.run, names)
    return files


def _status(proofs: Sequence[Proof]) -> int:
    from compiler.logic.claims import Result
    from fretc.verification.loop.layer import RELEASED

    if any(one.result is Result.COUNTEREXAMPLE and one.claim != RELEASED for one in proofs):
        return VIOLATION
    return SHOWN if all(one.result is Result.PROVED for one in proofs) else NOT_SHOWN
