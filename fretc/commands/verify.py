"""`fretc verify`: prove that monitors, interceptors and agents satisfy the requirements.

`fretc.verification` proves; this module reads the options, prints and writes the proofs.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import click

from compiler.files.build_id import __version__
from compiler.files.records import plain
from compiler.logic.claims import PROVERS, SCHEMA, ClaimResult, Layer, VerificationDocument
from fretc.commands.opening import input_files, print_excluded, project_of
from fretc.terminal.group import CommandWithHeadings
from fretc.terminal.options import (
    extras,
    files_argument,
    first_bindings_option,
    format_option,
    limit_option,
    output_option,
    path_option,
    requirements_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    EXIT_VIOLATION,
    coloured,
    fail,
    fail_at_end,
    or_fail,
    print_diagnostics,
    write_outputs,
)
from fretc.terminal.progress import print_activity
from fretc.verification.layers.languages import language_of
from fretc.verification.layers.table import OF_MONITOR, in_words
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from compiler.logic.claims import Proof
    from compiler.project.project import Project
    from fretc.verification.layers.request import Request
    from fretc.verification.text_output import Line
    from fretish.diagnostics.source import Source

_LAYERS = tuple(map(str, Layer))
_HEADINGS = {
    "Input and selection": ("layers", "monitor", "provers", "requirements", "bindings", "limit"),
    "Existing files instead of generated ones": (
        "monitor_file",
        "interceptor",
        "agent",
        "properties",
        "percepts",
        "ajpf",
    ),
    "Output": ("output_format", "every_claim", "output", "traces"),
}
"""Names of the parameters of `verify`, under the headings of its help."""
_HELP = f"""Prove that monitors, interceptors and agents do what the requirements say.

FILE is a requirement file, or a folder of them; it replaces `--requirements`.

{in_words()}

Exit status: 0 everything that applies is proved, 1 a claim about a requirement is refuted, 2
bad usage or bad input, 3 a claim is vacuous or not checked, or the robot stays stopped.

Example: fretc verify requirements/r1.fret --monitor
"""


@click.command(
    cls=CommandWithHeadings,
    headings=_HEADINGS,
    help=_HELP,
    epilog=extras({"crosshair": "--with crosshair"}),
)
@files_argument
@click.option(
    "--layer",
    "layers",
    multiple=True,
    type=click.Choice(_LAYERS),
    help="Examine only this layer. Repeatable.  [default: all that apply]",
)
@click.option("--monitor", is_flag=True, help="Same as `--layer monitor`.")
@click.option(
    "--with",
    "provers",
    multiple=True,
    type=click.Choice(PROVERS),
    help="Also use this external prover, if it is installed. Repeatable.",
)
@path_option(
    "--file",
    "monitor_file",
    help="Verify this monitor (.py, .c, .rs, .mjs) instead of a generated one.",
)
@path_option("--interceptor", help="Verify this interceptor instead of a generated one.")
@path_option("--agent", help="Verify this Gwendolen agent. Needs --properties.")
@path_option("--properties", help="Properties of the agent, in AJPF's language.")
@click.option(
    "--percept",
    "percepts",
    multiple=True,
    help="Percept that the environment of the agent can give. Repeatable.",
)
@path_option(
    "--ajpf",
    multiple=True,
    help="Result of AJPF. Repeatable.  [default: every build/*_ajpf/result.json]",
)
@requirements_option
@first_bindings_option
@limit_option
@format_option()
@output_option(
    default="build/verification.json",
    show_default=True,
    help="File for the proofs. `-` prints them.",
)
@click.option(
    "--all",
    "every_claim",
    is_flag=True,
    help="List every claim, also those that are proved or do not apply.",
)
@path_option("--traces", help="Folder for counterexamples, as CSV tables that monitors read.")
def verify(
    files: tuple[str, ...],
    layers: tuple[str, ...],
    monitor: bool,
    provers: tuple[str, ...],
    monitor_file: str | None,
    interceptor: str | None,
    agent: str | None,
    properties: str | None,
    percepts: tuple[str, ...],
    ajpf: tuple[str, ...],
    requirements: str,
    bindings: str | None,
    limit: int,
    output_format: str,
    output: str,
    every_claim: bool,
    traces: str | None,
) -> None:
    """The command; its help is `_HELP`."""
    from fretc.verification.engines.sandbox import CallLimits
    from fretc.verification.layers.request import Request
    from fretc.verification.reader import ajpf_results
    from fretc.verification.text_output import lines
    from fretc.verification.verify import missing_prover, refusals

    if (agent is None) != (properties is None):
        fail(_half_an_agent(agent))
    demanded = _demanded(layers, monitor=monitor, monitor_file=monitor_file)
    layer_names = demanded or tuple(Layer)
    if agent is not None:
        demanded = (*demanded, Layer.AGENT)
    project = _project(files, requirements, bindings)
    results = ajpf or (ajpf_results() if Layer.AJPF in layer_names else ())
    request = Request(
        layers=layer_names,
        limits=CallLimits(seconds=limit),
        demanded=demanded,
        monitor=(text := _read(monitor_file)),
        header=(header := _header(text, layer_names)),
        interceptor=_read(interceptor),
        agent=_read(agent),
        properties=_read(properties),
        percepts=percepts,
        provers=provers,
        ajpf=_ajpf_proofs(project, results),
        progress=print_activity,
    )
    absent = missing_prover(request)
    if absent is not None:
        fail(absent)
    refused = refusals(project, request)
    if refused:
        print_diagnostics([*refused.values()])
        fail_at_end()
    proofs = _proofs(project, request)
    if refused and not proofs:
        raise SystemExit(EXIT_USAGE)
    print_excluded({id: (why,) for id, why in refused.items()}, len(project.formalized))
    own = header.name if header else None
    options = (monitor_file, own, interceptor, agent, properties, bindings, *results)
    inputs = input_files(project, *options)
    texts = [*lines(proofs, every_claim=every_claim)] if output_format == "text" else None
    _print_and_write(proofs, texts, output, traces, inputs)
    raise SystemExit(_status(proofs))


def _demanded(
    layers: Sequence[str], *, monitor: bool, monitor_file: str | None
) -> tuple[Layer, ...]:
    """The requested layers, each once; empty: every layer that applies.

    Args:
        layers: values of `--layer`.
        monitor: whether `--monitor` is given.
        monitor_file: value of `--file`. Without a layer, only the layer `monitor` is used.
    """
    names = dict.fromkeys((*map(Layer, layers), *([Layer.MONITOR] if monitor else [])))
    if not names and monitor_file is not None:
        return (Layer.MONITOR,)
    return tuple(names)


def _ajpf_proofs(project: Project, results: Sequence[str]) -> Sequence[Proof]:
    """The proofs in result files of AJPF; exits if a file has an error."""
    from fretc.verification.ajpf_results import ajpf_proofs

    proofs, diagnostics = ajpf_proofs(project.formalized, results)
    print_diagnostics(diagnostics)
    if has_errors(diagnostics):
        raise SystemExit(EXIT_USAGE)
    return proofs


def _half_an_agent(agent: str | None) -> Diagnostic:
    """F907: `--agent` without `--properties`, or the other way round."""
    present, missing = ("properties", "agent") if agent is None else ("agent", "properties")
    return diagnostic("agent_option_missing", present=present, missing=missing)


def _project(files: Sequence[str], requirements: str, bindings: str | None) -> Project:
    """The usable part of the project; exits if it has no requirement."""
    project, _ = project_of(files, requirements, bindings, ("interceptor", "assume"))
    if not project.formalized:
        fail(diagnostic("no_requirement_to_verify"))
    return project


def _read(path: str | None) -> Source | None:
    """Text of a file that an option names; None if the option is not given."""
    from compiler.files.text_files import read

    if path is None:
        return None
    return or_fail(read(path))


def _header(monitor: Source | None, layers: Sequence[Layer]) -> Source | None:
    """Header of a monitor in C, from its folder; None: the monitor is not in C."""
    language = language_of(monitor.name) if monitor else None
    if monitor is None or language is None:
        return None
    others = [name for name in layers if name in OF_MONITOR and name != Layer.MONITOR]
    if others:
        fail(diagnostic("layer_needs_python", layer=others[0], monitor=monitor.name))
    if language.name != "C":
        return None
    included = re.search(r'^#include "(\w+\.h)"$', monitor.text, re.MULTILINE | re.ASCII)
    if included is None:
        fail(diagnostic("monitor_without_header", monitor.span(0, 0), monitor=monitor.name))
    return _read(str(Path(monitor.name).with_name(included[1])))


def _proofs(project: Project, request: Request) -> Sequence[Proof]:
    """All proofs; exits if a given file cannot be used."""
    from fretc.verification.monitor.verifying import NotAMonitorError
    from fretc.verification.verify import prove

    try:
        proofs = prove(project, request)
    except NotAMonitorError as error:
        assert request.monitor is not None
        language = language_of(request.monitor.name)
        fail(
            diagnostic(
                "not_a_monitor",
                request.monitor.span(0, 0),
                monitor=request.monitor.name,
                error=error,
                target=language.emit if language else "monitor",
            )
        )
    if isinstance(proofs, Diagnostic):
        fail(proofs)
    return proofs


def _print_and_write(
    proofs: Sequence[Proof],
    text: Iterable[Line] | None,
    output: str,
    traces: str | None,
    inputs: Iterable[str],
) -> None:
    """Print the proofs, and write them as JSON and their counterexamples as tables.

    `--output -` prints the JSON instead of the text.

    Args:
        proofs: all proofs.
        text: lines to print; None: the JSON is printed.
        output: path of the JSON.
        traces: folder for the tables; None: none are written.
        inputs: files that no output may replace.
    """
    from compiler.files.templating import to_json

    document = f"{to_json(plain(VerificationDocument(SCHEMA, __version__, tuple(proofs))))}\n"
    files: dict[Path, str | bytes] = {}
    if text is None:
        click.echo(document, nl=False)
    elif output != "-":
        click.echo(coloured(text), nl=False)
    if text is not None or output != "-":  # Otherwise the JSON was printed.
        files[Path(output)] = document
    if traces is not None:
        files.update(_trace_files(proofs, Path(traces)))
    write_outputs(files, inputs)


def _trace_files(proofs: Sequence[Proof], folder: Path) -> dict[Path, str]:
    """A CSV file for each counterexample: `<requirement>_<layer>_<number>.csv`.

    The columns are propositions. Further columns of a closed loop are left out, because monitors do
    not read them.
    """
    from fretc.verification.loop.replay import EXTRA
    from fretc.verification.text_output import as_csv

    files: dict[Path, str] = {}
    for proof in proofs:
        run = proof.run
        if run is None or proof.layer not in OF_MONITOR:
            continue
        propositions = run.names if proof.layer is Layer.MONITOR else run.names[: -len(EXTRA)]
        stem = f"{proof.requirement.lower()}_{proof.layer}"
        number = sum(path.name.startswith(f"{stem}_") for path in files) + 1
        files[folder / f"{stem}_{number}.csv"] = as_csv(run, propositions)
    return files


def _status(proofs: Sequence[Proof]) -> int:
    """The exit status, as stated in the help.

    A stop that is never released violates no requirement: it gives 3, not 1.
    """
    from fretc.verification.loop.closed_loop import RELEASED

    refuted = (proof.claim for proof in proofs if proof.result is ClaimResult.COUNTEREXAMPLE)
    if any(claim != RELEASED for claim in refuted):
        return EXIT_VIOLATION
    fine = (ClaimResult.PROVED, ClaimResult.NOT_APPLICABLE)
    return EXIT_OK if all(proof.result in fine for proof in proofs) else EXIT_INCONCLUSIVE
