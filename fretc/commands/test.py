"""`fretc test`: few short runs that show whether a requirement is right, each with its verdict.

`fretc.testing` makes them; this module reads the options, prints and writes.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import OF_AUDITS, project_of
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
    BAD,
    INTERRUPTED,
    NOT_SHOWN,
    SHOWN,
    coloured,
    deliver,
    say_briefly,
    say_line,
    stop,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors, suggestion
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from compiler.formalization.formalized import FormalizedRequirement
    from fretc.analysis.text_output import Line
    from fretc.testing.suite import Suite


@click.command(
    short_help="Make tests from requirements.",
    epilog=extras({"sim": "--emit mcap and --emit scenario"}),
)
@click.argument("files", nargs=-1, type=PATH, metavar="[FILE]...")
@click.option(
    "--component", metavar="NAME", help="Only the requirements of this component of the sentences."
)
@click.option("--show", metavar="ID", help="Print the tests of this requirement, tick by tick.")
@path_option("--suite", "saved", help="Take the tests of this file, and make none.")
@click.option(
    "--time",
    "seconds",
    type=SECONDS,
    default=120,
    show_default=True,
    help="Seconds of a processor for each requirement.",
)
@click.option(
    "--emit",
    "emitted",
    type=click.Choice(("pytest", "csv", "fret", "c", "mcap", "scenario")),
    help="Write the tests: for pytest, as tables for monitors, for the simulator of FRET, as a "
    "self-test in C, as logs of messages for audits, or as missions of the simulated robot that "
    "show the same.",
)
@click.option(
    "--language",
    "languages",
    multiple=True,
    type=click.Choice(("python", "c", "js")),
    help="The language of the monitor that tests for pytest step, maybe several; python if none "
    "is given.",
)
@path_option(
    "--emit-to", default="build/tests", show_default=True, help="Folder for `--emit`; `-` prints."
)
@click.option(
    "--runs",
    type=click.IntRange(min=1),
    default=40,
    show_default=True,
    help="Missions that are simulated for `--emit scenario`, at most.",
)
@jobs_option
@click.option(
    "--against",
    metavar="CMD",
    help="Test this program: a line of inputs goes in, a line of outputs comes out.",
)
@click.option(
    "--line-time",
    type=click.FloatRange(min=0, min_open=True),
    default=5,
    show_default=True,
    help="Seconds that the program of `--against` may take for a line.",
)
@requirements_option
@path_option("--bindings", help="bindings.toml; the one beside the first FILE if not given.")
@format_option()
@output_option(
    help="Where the suite goes, or what was seen of a program; `-` prints it. "
    "[default: build/tests/suite.json, build/tests/conformance.json]"
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
    form: str,
    output: str | None,
) -> None:
    """Make tests from requirements: few short runs, each with the verdict that it is to get.

    FILE holds requirements, or is a folder of such files: in place of `--requirements`. Each
    situation of a sentence is met by a shortest run that keeps it and by one that breaks it, and
    each sentence that might have been meant in its place gets another verdict on some run. All runs
    keep the other requirements.

    With `--against` a program is tested, and no tests are made: its inputs react to its outputs.

    Exit status: 0 all is met or proved impossible, or the program conforms, 1 it violates a
    requirement, 2 bad use or input, 3 not all was searched, or tested.
    """
    from compiler.files.records import plain
    from compiler.files.templating import to_json
    from compiler.project.paths import companions
    from fretc.analysis.assumptions import assumptions
    from fretc.commands import test_against, test_staging
    from fretc.commands.analyze import active_requirements

    project, first = project_of(files, requirements, bindings, ("environment", *OF_AUDITS))
    rules = active_requirements(project, component)
    if show is not None:
        _check_shown(show, [rule.id for rule in rules])
    assumed, remarks = assumptions(rules, project.declarations)
    say_briefly(remarks, first)
    if has_errors(remarks):
        raise SystemExit(BAD)
    sources = [requirement.wording.source.name for requirement in project.requirements]
    protected = [*sources, *companions(sources), *filter(None, [bindings])]
    if languages and emitted != "pytest":
        why = "`--language` is about the tests of `--emit pytest`"
        stop(Diagnostic(Code.BAD_USAGE, why, help="ask for these, or leave it out"))
    if against is not None:
        if emitted is not None or show is not None:
            clash = "`--against` tests a program, and makes no tests to emit or show"
            stop(Diagnostic(Code.BAD_USAGE, clash, help="ask for one of them"))
        place = output or "build/tests/conformance.json"
        test_against.against(against, rules, assumed, seconds, line_time, form, place, protected)
    output = output or "build/tests/suite.json"
    on_stage = emitted if emitted in test_staging.FORMS else None
    if on_stage is not None:
        test_staging.check(on_stage, emit_to)
    if saved is not None:
        protected.append(saved)
    suite, stopped = (_of(saved, rules), False) if saved else _made(rules, assumed, seconds)
    text = f"{to_json(plain(suite))}\n"
    if emitted is not None and emit_to == "-":
        pass  # what is printed is the tests
    elif output == "-" or form == "json":
        click.echo(text, nl=False)
    else:
        found = _lines(suite, rules, show, of_file=saved is not None)
        all_lines = [(visible(text), colour) for text, colour in found]
        click.echo(coloured(all_lines), nl=False)
    outputs: dict[Path, str] = {} if saved or output == "-" else {Path(output): text}
    if emitted is not None and on_stage is None:
        outputs |= _files(suite, rules, emitted, emit_to, languages)
    deliver(outputs, protected)
    if stopped:
        raise SystemExit(INTERRUPTED)
    if on_stage is not None:
        status = test_staging.staged(project, suite, on_stage, emit_to, runs, jobs)
        if status != SHOWN:
            raise SystemExit(status)
    raise SystemExit(SHOWN if saved or suite.is_complete else NOT_SHOWN)


def _check_shown(id: str, known: Sequence[str]) -> None:
    if id not in known:
        near = suggestion(id, known)
        hint = f"did you mean `{near}`?" if near else f"there are {', '.join(known)}"
        stop(Diagnostic(Code.BAD_USAGE, f"there is no requirement `{id}`", help=hint))


def _of(path: str, rules: Sequence[FormalizedRequirement]) -> Suite:
    """The suite of a file, as far as it is about requirements as they are."""
    from fretc.testing.exports.saved import WrongError
    from fretc.testing.exports.saved import saved as checked
    from fretc.testing.reader import read

    suite = read(path)
    if isinstance(suite, Diagnostic):
        stop(suite)
    again = "make it again: `fretc test`"
    try:
        found = checked(suite, rules)
    except WrongError as error:
        stop(Diagnostic(Code.BAD_EVIDENCE, f"`{path}`: {error}", help=again))
    if found.others:
        others = ", ".join(found.others)
        say_line(visible(f"left out, because they are other requirements now: {others}"))
    if not found.suite.tests:
        why = f"`{path}` has no test of a requirement as it is"
        stop(Diagnostic(Code.NOTHING_TO_DO, why, help=again))
    return found.suite


def _made(
    rules: Sequence[FormalizedRequirement], assumed: Sequence[FormalizedRequirement], seconds: float
) -> tuple[Suite, bool]:
    """The suite, and whether Ctrl-C has stopped it."""
    from fretc.analysis.worker import Stopped, findings
    from fretc.terminal.progress import at_work
    from fretc.testing.assembly import jobs, suite

    found = []
    stopped = False
    try:
        for each in findings(jobs(rules, assumed, seconds), at_work):
            found.append(each)
    except Stopped:
        stopped = True
    return suite(rules, assumed, found), stopped


def _files(
    suite: Suite,
    rules: Sequence[FormalizedRequirement],
    emitted: str,
    output: str,
    languages: Sequence[str],
) -> dict[Path, str]:
    """The tests as files; those that cannot be written so are named."""
    from fretc.testing.exports.files import Form, files
    from fretc.testing.exports.pytest_file import Language

    chosen = [each for each in Language if each in languages] or [Language.PYTHON]
    artifacts, left = files(suite, rules, Form(emitted), chosen)
    for why in dict.fromkeys(left.values()):
        names = [name for name in left if left[name] == why]
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        say_line(visible(f"not written: {names[0]}{more}: {why}"))
    if output == "-":
        return {Path("-"): "".join(each.text for each in artifacts)}
    return {Path(output) / emitted / each.path: each.text for each in artifacts}


def _lines(
    suite: Suite, rules: Sequence[FormalizedRequirement], show: str | None, *, of_file: bool
) -> Iterator[Line]:
    from fretc.testing.bench import demands
    from fretc.testing.text_output import lines, lines_of_file, shown
    from fretish.bindings.declarations import Role

    if show is None:
        yield from lines_of_file(suite) if of_file else lines(suite)
        return
    rule = next(each for each in rules if each.id == show)
    roles = {name: Role(own) for name, own in suite.roles.items()}
    declared = rule.declarations.propositions if rule.declarations else {}
    bound = (declared[name] for name in rule.watched if name in declared)
    signals = (signal for each in bound for signal in each.signals)
    names = [*rule.variables, *demands(rule).atoms, *signals]
    yield from shown(suite, show, names, roles, rule.wordings)
