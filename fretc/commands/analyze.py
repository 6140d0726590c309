"""`fretc analyze`: realizability, conflicts and redundancy of a requirement set.

`fretc.analysis` computes the findings; this module reads the options and prints.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import input_files, requirement_set
from fretc.terminal.options import (
    SECONDS,
    component_option,
    files_argument,
    first_bindings_option,
    format_option,
    output_option,
    path_option,
    requirements_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_VIOLATION,
    coloured,
    fail,
    fail_at_end,
    print_diagnostics,
    print_status,
    write_outputs,
)
from fretc.terminal.progress import print_activity, progress
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from collections.abc import Sequence

    from compiler.files.artifact import Artifact
    from compiler.formalization.formalized import FormalizedRequirement
    from fretc.analysis.analysis import AnalysisOptions
    from fretc.analysis.answers import AnswerFile
    from fretc.analysis.arena.systems import Systems
    from fretc.analysis.findings import Analysis


@click.command()
@files_argument
@component_option
@click.option(
    "--time",
    "seconds",
    type=SECONDS,
    default=20,
    show_default=True,
    help="CPU time limit for each question, in seconds.",
)
@click.option(
    "--emit",
    "emitted",
    type=click.Choice(("python", "hoa", "dot", "tlsf")),
    help="Write a controller that satisfies all requirements, as a Python program or a Mealy "
    "machine; or each component as a TLSF specification.",
)
@path_option(
    "--emit-to", default="build", show_default=True, help="Folder for `--emit`. `-` prints."
)
@click.option(
    "--as-fret",
    is_flag=True,
    help="Answer as FRET does: an `eventually` without a bound must hold at once.",
)
@requirements_option
@first_bindings_option
@format_option()
@output_option(
    default="build/analysis.json", show_default=True, help="File for the analysis. `-` prints it."
)
def analyze(
    files: tuple[str, ...],
    component: str | None,
    seconds: float,
    emitted: str | None,
    emit_to: str,
    as_fret: bool,
    requirements: str,
    bindings: str | None,
    output_format: str,
    output: str,
) -> None:
    """Find out whether a system can satisfy all requirements together.

    FILE is a requirement file, or a folder of them; it replaces `--requirements`. The bindings
    say which variables are inputs, chosen by the environment, and which are outputs, chosen by
    the system.

    The analysis names requirements that conflict, that are redundant, and that no input can
    trigger.

    Exit status: 0 realizable, 1 not realizable, 2 bad usage or bad input, 3 not all questions
    are answered.

    Example: fretc analyze requirements/agv --time 60
    """
    from compiler.files.records import plain
    from compiler.files.templating import to_json
    from fretc.analysis.analysis import AnalysisOptions
    from fretc.analysis.arena.systems import systems
    from fretc.analysis.evidence import document
    from fretc.analysis.text_output import lines
    from fretish.printer import sentence as printed

    known = requirement_set(files, component, requirements, bindings, ("environment",))
    project, formalized, assumed = known.project, known.requirements, known.assumed
    examined = systems(formalized, assumed)
    if not examined.can_be_examined:
        fail(*examined.mistakes)
    print_diagnostics(examined.mistakes)
    if examined.mistakes:
        fail_at_end()
    options = AnalysisOptions(seconds, as_fret)
    analysis, stopped = asked(formalized, assumed, examined, options, _answer_file(output))
    evidence = f"{to_json(plain(document(formalized, assumed, analysis, as_fret=as_fret)))}\n"
    if emitted is not None and emit_to == "-":
        pass  # Standard output then holds the controller.
    elif output == "-":
        click.echo(evidence, nl=False)
    elif output_format == "json":
        click.echo(to_json(plain(analysis)))
    else:
        sentences = {requirement.id: printed(requirement.written) for requirement in formalized}
        left_out = [refusal.requirement.id for refusal in project.refused if refusal.is_in_force]
        click.echo(coloured([*lines(analysis, sentences, left_out)]), nl=False)
    if output != "-":
        write_outputs({Path(output): evidence}, input_files(project, bindings))
    if emitted == "tlsf" and not stopped:
        _emit_specifications(examined, options, emit_to)
    elif emitted is not None and not stopped:
        _emit(analysis, examined, options, emitted, emit_to)
    raise SystemExit(EXIT_INTERRUPTED if stopped else _status(analysis))


def _answer_file(output: str) -> AnswerFile | None:
    """The file of answers beside the analysis; None: there is none, and every question is asked."""
    from compiler.files.user_key import user_key
    from fretc.analysis.answers import SUFFIX, AnswerFile

    key = user_key() if output != "-" else None
    if isinstance(key, Diagnostic):
        print_diagnostics([key])
    return AnswerFile(Path(output).with_suffix(SUFFIX), key) if isinstance(key, bytes) else None


def asked(
    requirements: Sequence[FormalizedRequirement],
    assumed: Sequence[FormalizedRequirement],
    examined: Systems,
    options: AnalysisOptions,
    file: AnswerFile | None = None,
) -> tuple[Analysis, bool]:
    """The analysis of the requirements, and whether Ctrl-C has stopped it.

    Args:
        requirements: the requirements of all systems.
        assumed: the assumptions.
        examined: the systems.
        options: time limits and other choices.
        file: answers of earlier analyses, and then of this one; None: every question is asked.
    """
    from fretc.analysis.analysis import assembled, jobs
    from fretc.analysis.answers import KeptAnswers, answers
    from fretc.analysis.worker import missing_limits

    print_diagnostics(missing_limits())
    work = [
        job
        for system in examined.every
        for job in jobs(system.requirements, system.roles, system.assumptions, options)
    ]
    kept = KeptAnswers() if file is None else file.read()
    missing = len(work) - len(kept.of(work))
    if missing < len(work):
        print_status(f"{len(work) - missing} of {len(work)} questions were answered before")
    with progress(missing, "analyzing") as show:
        findings, known, stopped = answers(
            work, kept, lambda number, title: show(number, f"{number}/{missing} {title}")
        )
    mistake = None if file is None or known == kept else file.write(known)
    if mistake is not None:
        print_diagnostics([mistake])
    return assembled(requirements, examined.roles, assumed, options, findings), stopped


def _emit_specifications(examined: Systems, options: AnalysisOptions, output: str) -> None:
    """Write a TLSF file for each component, and report the components without one."""
    from fretc.analysis.tlsf import specifications

    if len(examined.every) > 1:
        fail(diagnostic("no_controller", why="there are several systems", help=_ONE_SYSTEM))
    (system,) = examined.every
    artifacts, refused = specifications(
        system.requirements, system.assumptions, system.roles, options.seconds
    )
    print_diagnostics(refused)
    if refused:
        fail_at_end()
    _write(artifacts, output)


def _write(artifacts: Sequence[Artifact], output: str) -> None:
    if output == "-":
        write_outputs({Path("-"): "".join(artifact.text for artifact in artifacts)})
    else:
        write_outputs({Path(output) / artifact.path: artifact.text for artifact in artifacts})


def _emit(
    analysis: Analysis,
    examined: Systems,
    options: AnalysisOptions,
    emitted: str,
    output: str,
) -> None:
    """Write the controllers of all components, or none of them."""
    from fretc.analysis.analysis import controllers
    from fretc.analysis.controllers.circuit import Circuit
    from fretc.analysis.controllers.files import ControllerFormat, automata, controller
    from fretc.analysis.controllers.moves import Mealy
    from fretc.analysis.findings import OpenQuestion, RealizabilityVerdict
    from fretc.analysis.worker import finished
    from fretish.printer import sentence as printed

    if analysis.verdict is not RealizabilityVerdict.REALIZABLE:
        print_status(f"no controller is written: {analysis.why}")
        return
    output_format = ControllerFormat(emitted)
    if len(examined.every) > 1:
        fail(diagnostic("no_controller", why="there are several systems", help=_ONE_SYSTEM))
    (system,) = examined.every
    requirements = system.requirements
    work = controllers(requirements, system.roles, system.assumptions, options, output_format)
    found, stopped = finished(work, print_activity)
    if stopped:
        raise SystemExit(EXIT_INTERRUPTED)
    circuits = [each for each in found if isinstance(each, Circuit)]
    machines = [each for each in found if isinstance(each, Mealy)]
    for each in found:
        if isinstance(each, OpenQuestion):
            fail(diagnostic("no_controller", why=each.why, help=_smaller(output_format)))
    if output_format is ControllerFormat.PYTHON:
        sentences = {requirement.id: printed(requirement.written) for requirement in requirements}
        promises = {assumption.id: assumption.sentence for assumption in analysis.assumptions}
        artifacts = [controller(circuits, sentences, promises)]
    else:
        artifacts = [*automata(machines, output_format)]
    _write(artifacts, output)


_ONE_SYSTEM = "select one of them with `--component`"


def _smaller(output_format: str) -> str:
    if output_format == "python":
        return "select one component with `--component`, or allow more time with `--time`"
    return "try `--emit python`: it lists no states and can write much larger controllers"


def _status(analysis: Analysis) -> int:
    from fretc.analysis.findings import RealizabilityVerdict

    match analysis.verdict:
        case RealizabilityVerdict.REALIZABLE:
            return EXIT_OK
        case RealizabilityVerdict.UNREALIZABLE:
            return EXIT_VIOLATION
        case RealizabilityVerdict.NOT_CHECKED:
            return EXIT_INCONCLUSIVE
