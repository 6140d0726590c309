"""The command about evidence: whether it still stands."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from compiler.cli.output import BAD, NOT_SHOWN, SHOWN, VIOLATION, coloured, say, stop
from compiler.cli.signing import demand
from fretish.diagnostic import Code, Diagnostic, Severity, has_errors
from fretish.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Sequence

    from compiler.plan import Plan
    from compiler.project import Project
    from compiler.rechecking import Rechecked


@click.command("verify-evidence", short_help="Make evidence again, and say whether it stands.")
@click.argument("file", default="build/evidence.json", metavar="[FILE]")
@click.option(
    "--requirements", default="requirements", show_default=True, help="Folder, or one file."
)
@click.option("--bindings", help="bindings.toml; the one in the requirements' folder if not given.")
@click.option(
    "--logs",
    "places",
    multiple=True,
    metavar="FOLDER|URL",
    help="Look for the logs below this folder, by their names; or open those of FILE whose URL "
    "begins so. Else only files below the present folder are opened, and https.",
)
@click.option("--offline", is_flag=True, help="Ask nothing of any server.")
@click.option("--report", help="An HTML report: it is made again from FILE, and compared.")
@click.option(
    "--verification",
    help="What `fretc verify` found; build/verification.json, if it is there and none is given.",
)
@click.option(
    "--signed-by",
    metavar="KEY",
    help="A public key (id_ed25519.pub), or a list of signers: one of them must have signed FILE, "
    "and what --report and --verification name.",
)
@click.option("--jobs", type=click.IntRange(min=1), default=os.cpu_count() or 1)
@click.option(
    "--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True
)
def verify_evidence(
    file: str,
    requirements: str,
    bindings: str | None,
    places: tuple[str, ...],
    offline: bool,
    report: str | None,
    verification: str | None,
    signed_by: str | None,
    jobs: int,
    form: str,
) -> None:
    """Make evidence again, and say whether it stands.

    Of every log in FILE the SHA-256 is taken again, and every requirement is audited again; what
    comes out is compared with what FILE says. Exit status: 0 it stands, 1 something differs, 3 a
    log is not found, 2 bad use or bad input.
    """
    from compiler.evidence import read
    from compiler.files import read as read_text
    from compiler.proven import written

    source = read_text(file)
    audited = read(file)
    if isinstance(source, Diagnostic) or isinstance(audited, Diagnostic):
        wrong = source if isinstance(source, Diagnostic) else audited
        assert isinstance(wrong, Diagnostic)
        stop(replace(wrong, severity=Severity.ERROR))
    if signed_by is not None:
        demand(audited, source.text, signed_by, {"report": report, "proofs": verification})
    project, plan = _plan(requirements, bindings)
    runs = list(dict.fromkeys(result.run for result in audited.results))
    found = _rechecked(source.text, plan, _places(runs, places, offline=offline), jobs)
    made_from = (file, verification or written(), requirements)
    same = _report(project, report, *made_from) if report is not None else None
    if form == "json":
        _print_json(found, same)
    else:
        _print(found, same)
    kinds = {str(one.finding) for one in found}
    if "differs" in kinds or same is False:
        raise SystemExit(VIOLATION)
    raise SystemExit(NOT_SHOWN if "not checked" in kinds else SHOWN)


def _plan(requirements: str, bindings: str | None) -> tuple[Project, Plan]:
    from compiler.plan import Plan, planned
    from compiler.project import whole

    project = whole(requirements, bindings)
    if isinstance(project, Diagnostic):
        stop(project)
    say(project.diagnostics)
    if has_errors(project.diagnostics):
        raise SystemExit(BAD)
    plan = planned(project)
    if not isinstance(plan, Plan):
        stop(*plan)
    if plan.refused:
        stop(*plan.refusals)
    return project, plan


def _places(runs: Sequence[str], named: Sequence[str], *, offline: bool) -> dict[str, str]:
    """Run → where its log is, of those that may be opened; of the others it is said."""
    from compiler.rechecking import located
    from monitors.inputs import is_url, shown
    from monitors.places import Places

    folders = [name for name in named if not is_url(name)]
    for folder in folders:
        if not Path(folder).is_dir():
            mend = "name the folder that the logs are in"
            stop(Diagnostic(Code.NO_SUCH_FILE, f"there is no folder `{folder}`", help=mend))
    found: dict[str, str] = {}
    for folder in folders:
        found = {**located(runs, folder), **found}
    if not folders or len(folders) < len(named):
        found = {**located(runs, None), **found}
    policy = Places(named, offline)
    refused = {run: why for run, place in found.items() if (why := policy.refusal(place))}
    mend = "name its folder, or the beginning of its URL, with `--logs`, if you trust it"
    say(
        [
            Diagnostic(
                Code.FOREIGN_PLACE,
                f"`{shown(found[run])}` is not opened: {why}",
                help=mend,
                severity=Severity.WARNING,
            )
            for run, why in refused.items()
        ]
    )
    return {run: place for run, place in found.items() if run not in refused}


def _rechecked(text: str, plan: Plan, places: dict[str, str], jobs: int) -> tuple[Rechecked, ...]:
    from compiler.auditing import locally
    from compiler.rechecking import rechecked

    found = rechecked(text, plan, places, locally(jobs))
    if isinstance(found, Diagnostic):
        stop(found)
    return found


def _report(
    project: Project, path: str, evidence: str, verification: str | None, requirements: str
) -> bool:
    """Whether the report that is made now is the one in the file, byte for byte."""
    from compiler.files import read
    from compiler.project import beside
    from compiler.report import make
    from compiler.signatures import SIGNERS

    there = read(path)
    if isinstance(there, Diagnostic):
        stop(there)
    names = [beside(requirements, name) for name in ("fretc.lock", "waivers.toml", SIGNERS)]
    made = make(
        project,
        evidence,
        lock=names[0],
        waivers=names[1],
        verification=verification,
        signers=names[2],
    )
    return made.html == there.text


_GLYPHS = {"stands": ("✔", "green"), "differs": ("✘", "red"), "not checked": ("?", "magenta")}


def _print(found: Sequence[Rechecked], same: bool | None) -> None:
    lines: list[tuple[str, str | None]] = []
    width = max((len(one.requirement) for one in found), default=0)
    run = None
    for one in found:
        if one.run != run:
            run = one.run
            lines.append((run, None))
        glyph, colour = _GLYPHS[str(one.finding)]
        told = f"{one.finding}: {'; '.join(one.reasons)}" if one.reasons else str(one.finding)
        lines.append((f"  {glyph} {one.requirement:<{width}}  {told}", colour))
    if same is not None:
        glyph, colour = _GLYPHS["stands" if same else "differs"]
        told = "the same, byte for byte" if same else "another one is made now"
        lines.append((f"{glyph} report  {told}", colour))
    click.echo(coloured([(visible(line), colour) for line, colour in lines]), nl=False)


def _print_json(found: Sequence[Rechecked], same: bool | None) -> None:
    from dataclasses import asdict

    from compiler.templating import to_json

    told = {"results": [asdict(one) for one in found], "report_is_the_same": same}
    click.echo(to_json(told))
