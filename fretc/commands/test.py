"""`fretc test`: generate short test traces from requirements, each with its verdict.

`fretc.testing` generates them; this module reads the options, prints and writes.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import AUDIT_TABLES, project_of
from fretc.terminal.options import (
    PATH,
    SECONDS,
    extras,
    format_option,
    jobs_option,
    output_option,
    path_option,
    requirements_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_USAGE,
    coloured,
    fail,
    print_project_diagnostics,
    print_status,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Diagnostic, did_you_mean, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from compiler.formalization.formalized import FormalizedRequirement
    from fretc.analysis.text_output import Line
    from fretc.testing.suite import Suite


@click.command(
    epilog=extras({"sim": "--emit mcap and --emit scenario"}),
)
@click.argument("files", nargs=-1, type=PATH, metavar="[FILE]...")
@click.option("--component", metavar="NAME", help="Only requirements of this component.")
@click.option("--show", metavar="ID", help="Print the tests of this requirement, tick by tick.")
@path_option("--suite", "saved", help="Use the tests of this file instead of generating new ones.")
@click.option(
    "--time",
    "seconds",
    type=SECONDS,
    default=120,
    show_default=True,
    help="CPU time limit for each requirement, in seconds.",
)
@click.option(
    "--emit",
    "emitted",
    type=click.Choice(("pytest", "csv", "fret", "c", "mcap", "scenario")),
    help="Write the tests: `pytest` files, `csv` tables for monitors, traces for FRET's "
    "simulator, a self-test in `c`, `mcap` logs for audits, or `scenario` files for the "
    "simulated robot. Repeatable.",
)
@click.option(
    "--language",
    "languages",
    multiple=True,
    type=click.Choice(("python", "c", "js")),
    help="Language of the monitor that the pytest files run. Repeatable.  [default: python]",
)
@path_option(
    "--emit-to", default="build/tests", show_default=True, help="Folder for `--emit`. `-` prints."
)
@click.option(
    "--runs",
    type=click.IntRange(min=1),
    default=40,
    show_default=True,
    help="Maximum number of simulated missions for `--emit scenario`.",
)
@jobs_option
@click.option(
    "--against",
    metavar="CMD",
    help="Test this program. It reads a line of inputs and answers with a line of outputs.",
)
@click.option(
    "--line-time",
    type=click.FloatRange(min=0, min_open=True),
    default=5,
    show_default=True,
    help="Time limit for each answer of the program, in seconds.",
)
@requirements_option
@path_option("--bindings", help="Bindings file.  [default: bindings.toml beside the first FILE]")
@format_option()
@output_option(
    help="File for the tests, or for the result of --against. `-` prints it.  [default: "
    "build/tests/suite.json, build/tests/conformance.json]"
)
def test(
    files: tuple[str, ...],
    component: str | None,
    show: str | None,
    saved: str | None,
    seconds: float,
    emitted: str | None,
    languages: tuple[str, ...],
    emit_to: str,
    runs: int,
    jobs: int,
    against: str | None,
    line_time: float,
    requirements: str,
    bindings: str | None,
    output_format: str,
    output: str | None,
) -> None:
    """Generate tests from requirements: short traces, each with its expected verdict.

    FILE is a requirement file, or a folder of them; it replaces `--requirements`. Each
    situation of a sentence gets a shortest trace that satisfies the requirement and one that
    violates it. Each mutant of a sentence gets a trace that distinguishes it. All traces
    satisfy the other requirements.

    With `--against`, a program is tested instead: it reads inputs and must answer with outputs
    that satisfy the requirements.

    Exit status: 0 every goal is reached or proved impossible, or the program conforms; 1 the
    program violates a requirement; 2 bad usage or bad input; 3 the search or the test is
    incomplete.

    Example: fretc test requirements/agv --emit pytest
    """
    from compiler.files.records import plain
    from compiler.files.templating import to_json
    from compiler.project.paths import companions
    from fretc.analysis.assumptions import assumptions
    from fretc.commands import test_against, test_staging
    from fretc.commands.analyze import active_requirements

    project, first = project_of(files, requirements, bindings, ("environment", *AUDIT_TABLES))
    formalized = active_requirements(project, component)
    if show is not None:
        _check_shown(show, [requirement.id for requirement in formalized])
    assumed, remarks = assumptions(formalized, project.declarations)
    print_project_diagnostics(remarks, first)
    if has_errors(remarks):
        raise SystemExit(EXIT_USAGE)
    sources = [entry.wording.source.name for entry in project.requirements]
    protected = [*sources, *companions(sources), *filter(None, [bindings])]
    if languages and emitted != "pytest":
        fail(diagnostic("language_without_pytest"))
    if against is not None:
        if emitted is not None or show is not None:
            fail(diagnostic("against_with_emit"))
        place = output or "build/tests/conformance.json"
        test_against.against(
            against, formalized, assumed, seconds, line_time, output_format, place, protected
        )
    output = output or "build/tests/suite.json"
    on_stage = emitted if emitted in test_staging.FORMS else None
    if on_stage is not None:
        test_staging.check(on_stage, emit_to)
    if saved is not None:
        protected.append(saved)
    suite, stopped = (
        (_of(saved, formalized), False) if saved else _made(formalized, assumed, seconds)
    )
    text = f"{to_json(plain(suite))}\n"
    if emitted is not None and emit_to == "-":
        pass  # Standard output then holds the tests.
    elif output == "-" or output_format == "json":
        click.echo(text, nl=False)
    else:
        found = _lines(suite, formalized, show, of_file=saved is not None)
        all_lines = [(visible(text), colour) for text, colour in found]
        click.echo(coloured(all_lines), nl=False)
    outputs: dict[Path, str] = {} if saved or output == "-" else {Path(output): text}
    if emitted is not None and on_stage is None:
        outputs |= _files(suite, formalized, emitted, emit_to, languages)
    write_outputs(outputs, protected)
    if stopped:
        raise SystemExit(EXIT_INTERRUPTED)
    if on_stage is not None:
        status = test_staging.write_simulated_tests(project, suite, on_stage, emit_to, runs, jobs)
        if status != EXIT_OK:
            raise SystemExit(status)
    raise SystemExit(EXIT_OK if saved or suite.is_complete else EXIT_INCONCLUSIVE)


def _check_shown(id: str, known: Sequence[str]) -> None:
    if id not in known:
        hint = did_you_mean(id, known, f"there are {', '.join(known)}")
        fail(diagnostic("unknown_requirement", id=id, help=hint))


def _of(path: str, requirements: Sequence[FormalizedRequirement]) -> Suite:
    """The tests of a file that are about the present requirements."""
    from fretc.testing.exports.saved import WrongError
    from fretc.testing.exports.saved import saved as checked
    from fretc.testing.reader import read

    suite = read(path)
    if isinstance(suite, Diagnostic):
        fail(suite)
    again = "generate it again: `fretc test`"
    try:
        found = checked(suite, requirements)
    except WrongError as error:
        fail(diagnostic("bad_test_evidence", path=path, error=error, help=again))
    if found.others:
        others = ", ".join(found.others)
        print_status(visible(f"left out, because the requirements have changed: {others}"))
    if not found.suite.tests:
        fail(diagnostic("no_current_test", path=path, help=again))
    return found.suite


def _made(
    requirements: Sequence[FormalizedRequirement],
    assumed: Sequence[FormalizedRequirement],
    seconds: float,
) -> tuple[Suite, bool]:
    """The test suite, and whether Ctrl-C has stopped the search."""
    from fretc.analysis.worker import Interrupted, findings
    from fretc.terminal.progress import print_activity
    from fretc.testing.assembly import jobs, suite

    found = []
    stopped = False
    try:
        for each in findings(jobs(requirements, assumed, seconds), print_activity):
            found.append(each)
    except Interrupted:
        stopped = True
    return suite(requirements, assumed, found), stopped


def _files(
    suite: Suite,
    requirements: Sequence[FormalizedRequirement],
    emitted: str,
    output: str,
    languages: Sequence[str],
) -> dict[Path, str]:
    """The files of the tests; tests without a file are reported."""
    from fretc.testing.exports.files import SuiteFormat, files
    from fretc.testing.exports.pytest_file import Language

    chosen = [each for each in Language if each in languages] or [Language.PYTHON]
    artifacts, left = files(suite, requirements, SuiteFormat(emitted), chosen)
    for why in dict.fromkeys(left.values()):
        names = [name for name in left if left[name] == why]
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        print_status(visible(f"not written: {names[0]}{more}: {why}"))
    if output == "-":
        return {Path("-"): "".join(artifact.text for artifact in artifacts)}
    return {Path(output) / emitted / artifact.path: artifact.text for artifact in artifacts}


def _lines(
    suite: Suite, requirements: Sequence[FormalizedRequirement], show: str | None, *, of_file: bool
) -> Iterator[Line]:
    from fretc.testing.requirement_model import demands
    from fretc.testing.text_output import lines, lines_of_file, shown
    from fretish.bindings.declarations import Role

    if show is None:
        yield from lines_of_file(suite) if of_file else lines(suite)
        return
    requirement = next(each for each in requirements if each.id == show)
    roles = {name: Role(own) for name, own in suite.roles.items()}
    declared = requirement.declarations.propositions if requirement.declarations else {}
    bound = (declared[name] for name in requirement.watched if name in declared)
    signals = (signal for each in bound for signal in each.signals)
    names = [*requirement.variables, *demands(requirement).atoms, *signals]
    yield from shown(suite, show, names, roles, requirement.wordings)
