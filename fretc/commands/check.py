"""The command about a project as a whole, before any run."""

from __future__ import annotations

from pathlib import Path

import click

from fretc.terminal.output import BAD, NOT_SHOWN, SHOWN, deliver, say_all, say_line, stop
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.rendering import visible


@click.command(short_help="Say what is wrong or missing in a project, before any run.")
@click.argument("requirements", default="requirements", metavar="[FOLDER]")
@click.option("--bindings", help="bindings.toml; the one in the folder if not given.")
@click.option("--hazards", help="hazards.toml; the one in the folder if not given.")
@click.option("--evidence", default="build/evidence.json", show_default=True)
@click.option(
    "--verification",
    help="What `fretc verify` found; build/verification.json, if it is there and none is given.",
)
@click.option("--fix", is_flag=True, help="Write the mends that are sure, then check.")
def check(
    requirements: str,
    bindings: str | None,
    hazards: str | None,
    evidence: str,
    verification: str | None,
    fix: bool,
) -> None:
    """Say what is wrong or missing in a project, before any run.

    Mistakes in requirements, bindings, hazards, lock and waivers; everything that an audit would
    refuse; numbers that have drifted apart; requirements that hold whatever happens; planned
    methods that can give no result; links that are missing; what has changed since its review,
    or since its audit; what was reviewed and is claimed no more; waivers that cover nothing.
    Warnings that are accepted are listed with their reasons.
    `--fix` mends what can mean one thing only (`should`, `and`, `=<`) and names each mend.
    Exit status: 0 no warning but accepted ones, 3 warnings, 2 mistakes.
    """
    from compiler.files.dates import today
    from compiler.project.folder import beside, whole
    from fretc.audit.evidence.reader import read as read_evidence
    from fretc.audit.plan import refusals
    from fretc.report.diagnostics import idle_waivers, stale_evidence
    from fretc.report.model.assessments import assessments
    from fretc.report.traceability.acceptances import warnings
    from fretc.report.traceability.lock import Lock, withdrawal_warnings, withdrawn_requirements
    from fretc.report.traceability.lock import read as read_lock
    from fretc.report.traceability.waivers import read as read_waivers
    from fretc.verification.reader import known as proven

    if fix:
        _mend(requirements)
    project = whole(requirements, bindings, hazards)
    if isinstance(project, Diagnostic):
        stop(project)
    said = list(project.diagnostics)
    audited = read_evidence(evidence)
    if isinstance(audited, Diagnostic) and audited.is_error:
        said.append(audited)
    proofs = proven(verification)
    if isinstance(proofs, Diagnostic):
        said.append(proofs)
        proofs = ()
    results = None if isinstance(audited, Diagnostic) else audited
    lock, path = None, beside(requirements, "fretc.lock")
    if path is not None:
        known = read_lock(path)
        lock = known if isinstance(known, Lock) else None
        said.extend([] if isinstance(known, Lock) else [known])
    waivers, waived = {}, beside(requirements, "waivers.toml")
    if waived is not None:
        found, wrong = read_waivers(waived, [r.id for r in project.requirements], today())
        waivers = {id: waiver for id, waiver in found.items() if waiver.covers(today())}
        said.extend(wrong)
    assessed = assessments(project, results, lock, waivers, proofs)
    standings = [assessment.standing for assessment in assessed]
    if path is not None:
        chains = [standing.chain for standing in standings]
        withdrawn = withdrawn_requirements(project.requirements, chains, lock)
        said.extend(withdrawal_warnings(withdrawn, path))
    said.extend(stale_evidence(assessed, results, evidence))
    said.extend(idle_waivers(assessed))
    flawed = has_errors(said)
    said.extend(reason for _, why in refusals(project) for reason in why)
    if not flawed:
        said.extend(warnings(project, standings, lock, results))
    _finish(tuple(dict.fromkeys(said)), len(project.requirements))


def _mend(folder: str) -> None:
    """Write what can be mended for sure, all files or none, and name each mend."""
    from compiler.project.folder import requirement_files
    from compiler.project.mending import mended

    paths = requirement_files(folder)
    files = () if isinstance(paths, Diagnostic) else mended(paths)
    deliver({Path(file.path): file.text for file in files})
    for mend in (mend for file in files for mend in file.mends):
        place = f"{mend.span.source.name}:{mend.span.line}:{mend.span.column}"
        say_line(visible(f"mended {place}: {mend.change}"))
    if files:
        say_line("")


def _finish(said: tuple[Diagnostic, ...], count: int) -> None:
    """Say it, and exit with what it means."""
    accepted = [d for d in said if d.accepted]
    errors, warnings = sum(d.is_error for d in said), sum(d.is_open for d in said)
    say_all([d for d in said if not d.accepted], accepted)
    if said:
        say_line("")
    counts = f"{_many(errors, 'mistake')}, {_many(warnings, 'warning')}"
    also = f", {len(accepted)} accepted" if accepted else ""
    say_line(f"{_many(count, 'requirement')}: {counts}{also}")
    raise SystemExit(BAD if errors else NOT_SHOWN if warnings else SHOWN)


def _many(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
