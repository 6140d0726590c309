"""The command about a project as a whole, before any run."""

from __future__ import annotations

import click

from fretc.terminal.output import BAD, NOT_SHOWN, SHOWN, say, say_line, stop
from fretish.diagnostics.diagnostic import Diagnostic, Severity, has_errors


@click.command(short_help="Say what is wrong or missing in a project, before any run.")
@click.argument("requirements", default="requirements", metavar="[FOLDER]")
@click.option("--bindings", help="bindings.toml; the one in the folder if not given.")
@click.option("--hazards", help="hazards.toml; the one in the folder if not given.")
@click.option("--evidence", default="build/evidence.json", show_default=True)
@click.option(
    "--verification",
    help="What `fretc verify` found; build/verification.json, if it is there and none is given.",
)
def check(
    requirements: str,
    bindings: str | None,
    hazards: str | None,
    evidence: str,
    verification: str | None,
) -> None:
    """Say what is wrong or missing in a project, before any run.

    Mistakes in requirements, bindings, hazards, lock and waivers; everything that an audit would
    refuse; numbers that have drifted apart; requirements that hold whatever happens; planned
    methods that can give no result; links that are missing; what has changed since its review,
    or since its audit; what was reviewed and is claimed no more; waivers that cover nothing.
    Exit status: 0 nothing to say, 3 warnings, 2 mistakes.
    """
    from compiler.files.dates import today
    from compiler.project.folder import beside, whole
    from fretc.audit.evidence.reader import read as read_evidence
    from fretc.audit.refusals import refusals
    from fretc.report.assembly import stale
    from fretc.report.model.claims import claims, idle_waivers
    from fretc.report.traceability.checks import checks, unreviewed
    from fretc.report.traceability.lock import Lock, told, withdrawn
    from fretc.report.traceability.lock import read as read_lock
    from fretc.report.traceability.waivers import read as read_waivers
    from fretc.verification.reader import known as proven

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
    claimed = claims(project, results, lock, waivers, proofs)
    standings = [claim.standing for claim in claimed]
    if path is not None:
        chains = [standing.chain for standing in standings]
        said.extend(told(withdrawn(project.requirements, chains, lock), path))
    said.extend(stale(claimed, results, evidence))
    said.extend(idle_waivers(claimed))
    flawed = has_errors(said)
    said.extend(reason for _, why in refusals(project) for reason in why)
    if not flawed:
        said.extend(checks(project, standings))
        said.extend(unreviewed(project, standings) if lock is not None and lock.reviews else ())
    _finish(tuple(dict.fromkeys(said)), len(project.requirements))


def _finish(said: tuple[Diagnostic, ...], count: int) -> None:
    """Say it, and exit with what it means."""
    say(said)
    errors = sum(d.is_error for d in said)
    warnings = sum(d.severity is Severity.WARNING for d in said)
    if said:
        say_line("")
    say_line(
        f"{_many(count, 'requirement')}: {_many(errors, 'mistake')}, {_many(warnings, 'warning')}"
    )
    raise SystemExit(BAD if errors else NOT_SHOWN if warnings else SHOWN)


def _many(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"
