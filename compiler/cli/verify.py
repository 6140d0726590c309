"""The command about proofs: whether what was made of a requirement is what it says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from compiler.cli.output import BAD, NOT_SHOWN, SHOWN, VIOLATION, say, stop
from fretish.diagnostic import Code, Diagnostic, has_errors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from compiler.rule import Rule
    from compiler.verifying import Verified


@click.command(short_help="Prove that monitors mean what their requirements say.")
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@click.option("--monitor", is_flag=True, help="Prove the monitor that `--emit monitor` makes.")
@click.option("--file", "path", help="A monitor that was made before, in place of a new one.")
@click.option("--bindings", help="bindings.toml; the one beside the first FILE if not given.")
@click.option(
    "--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True
)
def verify(
    files: tuple[str, ...], monitor: bool, path: str | None, bindings: str | None, form: str
) -> None:
    """Prove that what was made of requirements means what they say.

    With `--monitor`, the text of each monitor is executed and explored in lock step against the
    counter automaton of its sentence, over all propositions and at its own bound: for traces of
    any length. Exit status: 0 proved, 1 refuted, 3 not checked.
    """
    from compiler.project import listed, load

    if not monitor and path is None:
        stop(Diagnostic(Code.BAD_USAGE, "nothing to verify is named", help="add `--monitor`"))
    paths = listed(files)
    if isinstance(paths, Diagnostic):
        stop(paths)
    project = load(paths, bindings)
    say(project.diagnostics)
    if has_errors(project.diagnostics):
        raise SystemExit(BAD)
    if not project.rules:
        stop(Diagnostic(Code.NOTHING_TO_DO, "there is no requirement to verify"))
    _refused(project.rules)
    found = [_verified(rule, path) for rule in project.rules]
    _print(found, form)
    _exit(found)


def _refused(rules: Sequence[Rule]) -> None:
    from compiler.targets import monitor

    wrong = [diagnostic for rule in rules if (diagnostic := monitor.refuse(rule)) is not None]
    if wrong:
        stop(*wrong)


def _verified(rule: Rule, path: str | None) -> Verified:
    from compiler.files import read
    from compiler.targets import monitor
    from compiler.verifying import NotAMonitorError, verified

    if path is None:
        return verified(rule, monitor.text(rule))
    source = read(path)
    if isinstance(source, Diagnostic):
        stop(source)
    try:
        return verified(rule, source.text)
    except NotAMonitorError as error:
        stop(
            Diagnostic(
                Code.BAD_MONITOR,
                f"`{path}` is no generated monitor: {error}",
                source.span(0, 0),
                help="name a file that `--emit monitor` wrote",
            )
        )


def _print(found: Sequence[Verified], form: str) -> None:
    from compiler.proofs import as_record, text
    from compiler.templating import to_json

    if form == "json":
        click.echo(to_json([as_record(verified) for verified in found]))
        return
    width = max(len(verified.requirement) for verified in found)
    for verified in found:
        click.echo(f"{verified.requirement:<{width}}  {text(verified)}")


def _exit(found: Sequence[Verified]) -> None:
    from compiler.proofs import NOT_CHECKED, REFUTED, status

    told = {status(verified) for verified in found}
    raise SystemExit(VIOLATION if REFUTED in told else NOT_SHOWN if NOT_CHECKED in told else SHOWN)
