"""`fretc test` without `--against`: make the tests, print and write them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from compiler.files.records import plain
from compiler.files.templating import to_json
from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.text_output import Line
from fretc.analysis.worker import finished, missing_limits
from fretc.commands.opening import RequirementSet
from fretc.commands.simulate import require_simulation
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_INTERRUPTED,
    EXIT_OK,
    coloured,
    fail,
    or_fail,
    print_diagnostics,
    print_status,
    write_outputs,
)
from fretc.terminal.progress import print_activity
from fretc.testing.assembly import jobs
from fretc.testing.assembly import suite as suite_of
from fretc.testing.exports.files import SuiteFormat, files
from fretc.testing.exports.pytest_file import MonitorLanguage
from fretc.testing.exports.saved import WrongError, saved
from fretc.testing.reader import read
from fretc.testing.requirement_model import demands
from fretc.testing.suite import Suite
from fretc.testing.text_output import lines, lines_of_file, shown
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

ON_STAGE = ("mcap", "scenario")
"""Values of `--emit` that need the simulated robot."""


@dataclass(frozen=True, slots=True)
class SuiteOptions:
    """The options of `fretc test` about the tests that it makes."""

    show: str | None
    saved: str | None
    seconds: float
    emitted: str | None
    languages: tuple[str, ...]
    emit_to: str
    runs: int
    jobs: int
    output_format: str
    output: str | None


def make_tests(checked: RequirementSet, options: SuiteOptions, protected: Sequence[str]) -> int:
    """Generate or read tests, print and write them; returns the exit status."""
    requirements, emitted = checked.requirements, options.emitted
    output = options.output or "build/tests/suite.json"
    if emitted in ON_STAGE:
        _check_stage(str(emitted), options.emit_to)
    if options.saved:
        suite, stopped = _saved(options.saved, requirements), False
    else:
        work = jobs(requirements, checked.assumed, options.seconds)
        print_diagnostics(missing_limits())
        found, stopped = finished(work, print_activity)
        suite = suite_of(requirements, checked.assumed, found)
    text = f"{to_json(plain(suite))}\n"
    if emitted is not None and options.emit_to == "-":
        pass  # Standard output then holds the tests.
    elif output == "-" or options.output_format == "json":
        click.echo(text, nl=False)
    else:
        told = _lines(suite, requirements, options.show, of_file=options.saved is not None)
        click.echo(coloured((visible(line), colour) for line, colour in told), nl=False)
    outputs: dict[Path, str] = {} if options.saved or output == "-" else {Path(output): text}
    if emitted is not None and emitted not in ON_STAGE:
        outputs |= _files(suite, requirements, options)
    write_outputs(outputs, protected)
    if stopped:
        return EXIT_INTERRUPTED
    if emitted in ON_STAGE:
        from fretc.commands.test_staging import write_simulated_tests

        status = write_simulated_tests(
            checked.project, suite, emitted, options.emit_to, options.runs, options.jobs
        )
        if status != EXIT_OK:
            return status
    return EXIT_OK if options.saved or suite.is_complete else EXIT_INCONCLUSIVE


def _check_stage(emitted: str, emit_to: str) -> None:
    """Exit if the files cannot be written: without the packages, or to standard output."""
    if emit_to == "-":
        fail(diagnostic("several_files_printed", form=emitted))
    require_simulation()


def _saved(path: str, requirements: Sequence[FormalizedRequirement]) -> Suite:
    """The tests of a file that are about the present requirements."""
    suite = or_fail(read(path))
    again = "generate it again: `fretc test`"
    try:
        found = saved(suite, requirements)
    except WrongError as error:
        fail(diagnostic("bad_test_evidence", path=path, error=error, help=again))
    if found.others:
        others = ", ".join(found.others)
        print_status(visible(f"left out, because the requirements have changed: {others}"))
    if not found.suite.tests:
        fail(diagnostic("no_current_test", path=path, help=again))
    return found.suite


def _files(
    suite: Suite, requirements: Sequence[FormalizedRequirement], options: SuiteOptions
) -> dict[Path, str]:
    """The files of the tests; tests without a file are reported."""
    emitted = str(options.emitted)
    chosen = [each for each in MonitorLanguage if each in options.languages] or [
        MonitorLanguage.PYTHON
    ]
    artifacts, left = files(suite, requirements, SuiteFormat(emitted), chosen)
    for why in dict.fromkeys(left.values()):
        names = [name for name in left if left[name] == why]
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        print_status(visible(f"not written: {names[0]}{more}: {why}"))
    if options.emit_to == "-":
        return {Path("-"): "".join(artifact.text for artifact in artifacts)}
    folder = Path(options.emit_to) / emitted
    return {folder / artifact.path: artifact.text for artifact in artifacts}


def _lines(
    suite: Suite, requirements: Sequence[FormalizedRequirement], show: str | None, *, of_file: bool
) -> Iterator[Line]:

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
