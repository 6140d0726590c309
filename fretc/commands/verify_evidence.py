"""The command about evidence: whether it still stands."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.sign import demand
from fretc.terminal.output import BAD, NOT_SHOWN, SHOWN, VIOLATION, coloured, say, stop
from fretish.diagnostics.diagnostic import (
    Code,
    Diagnostic,
    Severity,
    has_errors,
    suggestion,
)
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Sequence

    from compiler.project.folder import Project
    from fretc.audit.evidence.schema import Document
    from fretc.audit.plan import Plan
    from fretc.report.traceability.lock import Lock
    from fretc.reproduction.completeness import Scope
    from fretc.reproduction.manifest import Manifest
    from fretc.reproduction.outcome import Recheck
    from fretc.verification.reader import Proofs


@click.command("verify-evidence", short_help="Make evidence again, and say whether it stands.")
@click.argument("file", default="build/evidence.json", metavar="[FILE]")
@click.option(
    "--requirements", default="requirements", show_default=True, help="Folder, or one file."
)
@click.option("--bindings", help="bindings.toml; the one in the requirements' folder if not given.")
@click.option(
    "--logs",
    "places_named",
    multiple=True,
    metavar="FOLDER|URL",
    help="Look for the logs below this folder, by their names; or open those of FILE whose URL "
    "begins so. Else only files below the present folder are opened, and https.",
)
@click.option("--offline", is_flag=True, help="Ask nothing of any server.")
@click.option(
    "--manifest",
    metavar="FILE",
    help="What `sha256sum LOG...` wrote: FILE has these logs, with these hashes, and no other.",
)
@click.option(
    "--only",
    metavar="ID,...",
    help="Look at these requirements only; else at all in force. A part never stands as a whole.",
)
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
@click.option("--no-proofs", is_flag=True, help="Prove nothing again: proofs are not checked.")
@click.option(
    "--limit",
    type=click.IntRange(min=1),
    default=60,
    show_default=True,
    help="Seconds of a processor for each proof.",
)
@click.option("--jobs", type=click.IntRange(min=1), default=os.cpu_count() or 1)
@click.option(
    "--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True
)
def verify_evidence(
    file: str,
    requirements: str,
    bindings: str | None,
    places_named: tuple[str, ...],
    offline: bool,
    manifest: str | None,
    only: str | None,
    report: str | None,
    verification: str | None,
    signed_by: str | None,
    no_proofs: bool,
    limit: int,
    jobs: int,
    form: str,
) -> None:
    """Make evidence again, and say whether it stands.

    FILE must have a result of every requirement in force in each run, every run that the lock
    beside the requirements names, and every log of the manifest. Of every log the SHA-256 is taken
    again, every requirement is audited again, and every proof is made again; what comes out is
    compared with what is written. Exit status: 0 it stands, 1 something differs or is missing, 3
    something was not checked, 2 bad use or bad input.
    """
    from fretc.audit.evidence.reader import required
    from fretc.verification.reader import written

    audited = required(file)
    if isinstance(audited, Diagnostic):
        stop(audited)
    whole = audited.document
    if signed_by is not None:
        demand(audited, signed_by, {"report": report, "proofs": verification})
    project, plan = _plan(requirements, bindings)
    scope = _scope(plan, only, requirements)
    verification = verification or written()
    proofs = _proofs(verification)
    listed = _manifest(manifest)
    places = _places(_runs(whole), places_named, offline=offline)
    found = [*_rechecked(whole, plan, places, scope, listed, jobs)]
    found += _reproved(project, proofs, scope, limit, skip=no_proofs)
    made_from = (file, verification, requirements)
    same = _report(project, report, *made_from) if report is not None else None
    against = _against(scope, requirements, manifest)
    if form == "json":
        _print_json(found, same, scope, against)
    else:
        _print(found, same, against)
    raise SystemExit(_status(found, same, scope))


def _status(found: Sequence[Recheck], same: bool | None, scope: Scope) -> int:
    from fretc.reproduction.outcome import Finding

    kinds = {one.finding for one in found}
    if Finding.DIFFERS in kinds or same is False:
        return VIOLATION
    return NOT_SHOWN if Finding.UNKNOWN in kinds or scope.part else SHOWN


def _runs(whole: Document) -> list[str]:
    return list(dict.fromkeys(result.run for result in whole.results))


def _plan(requirements: str, bindings: str | None) -> tuple[Project, Plan]:
    from compiler.project.folder import whole
    from fretc.audit.plan import Plan, planned

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
    from fretc.logs.storage.inputs import is_url, shown
    from fretc.logs.storage.places import Places
    from fretc.reproduction.results import located

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


# What it is held against ------------------------------------------------------------------------


def _scope(plan: Plan, only: str | None, requirements: str) -> Scope:
    from fretc.reproduction.completeness import Scope

    claimed = tuple(claim.id for claim in plan.claims)
    if only is None:
        return Scope(claimed, _lock(requirements))
    asked = tuple(dict.fromkeys(name.strip() for name in only.split(",")))
    for name in asked:
        if name not in claimed:
            near = suggestion(name, claimed)
            mend = f"did you mean `{near}`?" if near else f"there are {', '.join(claimed)}"
            stop(Diagnostic(Code.BAD_USAGE, f"no requirement `{name}` is in force", help=mend))
    return Scope(asked, _lock(requirements), part=True)


def _lock(requirements: str) -> Lock | None:
    from compiler.project.folder import beside
    from fretc.report.traceability.lock import NAME, read

    path = beside(requirements, NAME)
    found = read(path) if path is not None else None
    if isinstance(found, Diagnostic):
        stop(found)
    return found


def _manifest(path: str | None) -> Manifest | None:
    from fretc.reproduction.manifest import Manifest, read

    if path is None:
        return None
    found = read(path)
    if not isinstance(found, Manifest):
        stop(*found)
    return found


def _proofs(path: str | None) -> Proofs | None:
    from fretc.verification.reader import read

    found = read(path) if path is not None else None
    if isinstance(found, Diagnostic):
        stop(found)
    return found


def _against(scope: Scope, requirements: str, manifest: str | None) -> str:
    """What was asked, in words: nothing that was not asked is said to stand."""
    count = len(scope.claimed)
    whole = f"{count} requirement{'' if count == 1 else 's'} of `{requirements}`"
    asked = f"only {', '.join(scope.claimed)}, a part" if scope.part else whole
    lock = "`fretc.lock`" if scope.lock is not None else ""
    naming = " and ".join(filter(None, (lock, f"`{manifest}`" if manifest else "")))
    runs = f"runs by {naming}" if naming else "no lock and no manifest says which runs there are"
    return f"{asked}; {runs}"


# Made again -------------------------------------------------------------------------------------


def _rechecked(
    whole: Document,
    plan: Plan,
    places: dict[str, str],
    scope: Scope,
    manifest: Manifest | None,
    jobs: int,
) -> tuple[Recheck, ...]:
    from fretc.audit.many_logs import locally
    from fretc.reproduction.results import recheck

    found = recheck(whole, plan, places, locally(jobs), scope, manifest)
    if isinstance(found, Diagnostic):
        stop(found)
    return found


def _reproved(
    project: Project, proofs: Proofs | None, scope: Scope, limit: int, *, skip: bool
) -> Sequence[Recheck]:
    from fretc.reproduction.outcome import PROOFS, unknown
    from fretc.reproduction.proofs import prove_again, unproved_plans
    from fretc.terminal.progress import at_work
    from fretc.verification.engines.sandbox import Limits

    missing = tuple(unproved_plans(project, proofs.proofs if proofs else (), scope.claimed))
    if proofs is None:
        return missing
    if skip:
        return (unknown(PROOFS, "", "no proof was made again: `--no-proofs`"), *missing)
    found = prove_again(project, proofs, Limits(seconds=limit), scope.claimed, at_work)
    if isinstance(found, Diagnostic):
        stop(found)
    return (*found, *missing)


def _report(
    project: Project, path: str, evidence: str, verification: str | None, requirements: str
) -> bool:
    """Whether the report that is made now is the one in the file, byte for byte."""
    from compiler.files.text_files import read
    from compiler.project.folder import beside
    from fretc.attestation.signatures import SIGNERS
    from fretc.report.make import make

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


def _print(found: Sequence[Recheck], same: bool | None, against: str) -> None:
    from fretc.reproduction.outcome import SIGNS, Finding

    lines: list[tuple[str, str | None]] = []
    width = max((len(one.requirement) for one in found), default=0)
    run = None
    for one in found:
        if one.run != run:
            run = one.run
            lines.append((run, None))
        sign = SIGNS[one.finding]
        told = ": ".join(filter(None, (one.finding, one.claim, "; ".join(one.reasons))))
        lines.append((f"  {sign.glyph} {one.requirement:<{width}}  {told}", sign.colour))
    if same is not None:
        sign = SIGNS[Finding.STANDS if same else Finding.DIFFERS]
        told = "the same, byte for byte" if same else "another one is made now"
        lines.append((f"{sign.glyph} report  {told}", sign.colour))
    counted = ", ".join(f"{finding} {count}" for finding, count in _counts(found, same).items())
    lines.append((f"{counted} ({against})", None))
    click.echo(coloured([(visible(line), colour) for line, colour in lines]), nl=False)


def _counts(found: Sequence[Recheck], same: bool | None) -> dict[str, int]:
    """How many of each finding, the report among them."""
    from fretc.reproduction.outcome import Finding, counts

    known = {str(finding): count for finding, count in counts(found).items()}
    if same is not None:
        known[Finding.STANDS if same else Finding.DIFFERS] += 1
    return known


def _print_json(found: Sequence[Recheck], same: bool | None, scope: Scope, against: str) -> None:
    from dataclasses import asdict

    from compiler.files.templating import to_json

    told = {
        "results": [asdict(one) for one in found],
        "report_is_the_same": same,
        "counts": _counts(found, same),
        "only": list(scope.claimed) if scope.part else None,
        "against": against,
    }
    click.echo(to_json(told))
