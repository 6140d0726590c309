"""`fretc test --emit mcap|scenario`: tests as logs, or as simulated missions."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

import click

from compiler.project.project import Project
from fretc.terminal.output import (
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_USAGE,
    fail,
    not_written,
    write_outputs,
)
from fretc.terminal.progress import progress
from fretc.testing.log_synthesis.logs import LogTestResult, logs
from fretc.testing.log_synthesis.scenarios import (
    Aim,
    Found,
    confirmed,
    realizable_goals,
    search,
    text,
)
from fretc.testing.suite import Suite
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import visible
from simulation.world.scenario import names


def write_simulated_tests(
    project: Project, suite: Suite, emitted: str, emit_to: str, runs: int, jobs: int
) -> int:
    """Write a suite as logs or scenarios and print the result; returns the exit status."""
    folder = Path(emit_to) / emitted
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if emitted == "mcap":
            return _logs(project, suite, folder)
        return _scenarios(project, suite, folder, runs, jobs)
    except OSError as error:
        fail(not_written(str(folder), error.strerror or str(error)))


# Logs -------------------------------------------------------------------------------------------


def _logs(project: Project, suite: Suite, folder: Path) -> int:

    done: list[LogTestResult] = []
    interrupted = False
    try:
        with progress(len(suite.tests), "logs") as tell:
            for one in logs(project, suite.tests, folder, lambda n: tell(n, "")):
                done.append(one)
    except KeyboardInterrupt:
        interrupted = True
    confirmed = [one for one in done if one.outcome == "confirmed"]
    wrong = [one for one in done if one.outcome == "not confirmed"]
    refused = [one for one in done if one.outcome == "cannot be recorded"]
    sign = signs.BAD if wrong else signs.GOOD
    click.echo(
        f"{sign.glyph} {len(confirmed)} of {len(suite.tests)} tests are written as logs in "
        f"{folder}: the "
        "audit of each gives the verdict that the test expects"
    )
    for one in wrong:
        click.echo(f"{signs.BAD.glyph} {one.test.name} is not written: {visible(one.why)}")
    _listed("cannot be recorded", ((refusal.why, refusal.test.name) for refusal in refused))
    if interrupted:
        return EXIT_INTERRUPTED
    return EXIT_USAGE if wrong else EXIT_OK


def _listed(what: str, reasons: Iterable[tuple[str, str]]) -> None:
    """Each reason once, with everything that has this reason."""
    by_reason: dict[str, list[str]] = {}
    for why, name in reasons:
        by_reason.setdefault(why, []).append(name)
    for why, some in by_reason.items():
        click.echo(f"{signs.OPEN.glyph} {what}: {visible(why)}")
        for name in some:
            click.echo(f"    {visible(name)}")


# Scenarios --------------------------------------------------------------------------------------


def _scenarios(project: Project, suite: Suite, folder: Path, runs: int, jobs: int) -> int:

    aims, why = realizable_goals(suite, project)
    found, interrupted = Found(), False
    try:
        with progress(runs, "missions") as tell:
            if aims:
                search(project, aims, runs, jobs, found, tell)
    except KeyboardInterrupt:
        interrupted = True
    except RuntimeError as error:
        fail(Diagnostic(Code.PROCESS_KILLED, str(error)))
    words = {
        (obligation.requirement, obligation.situation, obligation.polarity): obligation.words
        for obligation in suite.obligations
    }
    unlike = _written(project, found, folder, words)
    _say(found, aims, why, words, folder, unlike)
    if interrupted:
        return EXIT_INTERRUPTED
    return EXIT_USAGE if unlike else EXIT_OK


def _written(
    project: Project, found: Found, folder: Path, words: Mapping[Aim, str]
) -> Collection[str]:
    """Write the new scenarios; one that does not reproduce its result is not written."""
    known, unlike = names(), []
    files: dict[Path, str] = {}
    for name, scenario in found.scenarios.items():
        if name not in known:
            own = found.new(name)
            written = text(scenario, found.verdicts[name], own, words)
            if confirmed(project, written, own):
                files[folder / f"{name}.toml"] = written
            else:
                unlike.append(name)
    write_outputs(files)
    return unlike


def _say(
    found: Found,
    aims: Sequence[Aim],
    why: Mapping[str, str],
    words: Mapping[Aim, str],
    folder: Path,
    unlike: Collection[str],
) -> None:

    known = names()
    own = [name for name in found.scenarios if name not in known]
    good = {aim: name for aim, name in found.shown.items() if name not in unlike}
    click.echo(
        f"{signs.GOOD.glyph} {len(good)} of {len(aims)} are shown in {found.runs} missions of the "
        f"simulated robot: by {len(found.scenarios) - len(own)} of the scenarios that come with "
        f"fretc and by {len(own) - len(unlike)} new ones in {folder}"
    )
    click.echo()
    for name in found.scenarios:
        click.echo(f"  {name:<16} {len(found.new(name))} not shown before")
    for name in unlike:
        click.echo(
            f"{signs.BAD.glyph} {name} is not written: its file does not reproduce the result"
        )
    for id, reason in why.items():
        click.echo(f"{signs.OPEN.glyph} {id} cannot be recorded: {visible(reason)}")
    missing = [aim for aim in aims if aim not in good]
    _listed(
        f"not shown in {found.runs} missions",
        ((id, f"{words[id, key, polarity]} ({polarity})") for id, key, polarity in missing),
    )
