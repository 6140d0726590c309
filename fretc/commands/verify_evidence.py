"""`fretc verify-evidence`: recompute evidence and compare."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import plan_of
from fretc.commands.sign import installed, require
from fretc.terminal.options import (
    LOG_EXTRAS,
    PATH,
    analysis_option,
    bindings_option,
    evidence_path,
    extras,
    format_option,
    jobs_option,
    label_option,
    limit_option,
    path_option,
    requirements_option,
    verification_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_USAGE,
    EXIT_VIOLATION,
    coloured,
    fail,
    or_fail,
    print_diagnostics,
)
from fretc.terminal.progress import print_activity
from fretish.diagnostics.diagnostic import (
    did_you_mean,
    has_errors,
)
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from compiler.project.project import Project
    from fretc.analysis.evidence import AnalyzedSet
    from fretc.attestation.signatures import SignatureBook
    from fretc.audit.evidence.reader import EvidenceFile
    from fretc.audit.evidence.schema import EvidenceDocument
    from fretc.audit.plan import Plan
    from fretc.reproduction.completeness import ComparisonScope
    from fretc.reproduction.manifest import Manifest
    from fretc.reproduction.outcome import Recheck
    from fretc.traceability.lock import Lock
    from fretc.verification.reader import Proofs


@click.command(
    "verify-evidence",
    epilog=extras({**LOG_EXTRAS, "sign": "what is signed"}),
)
@click.argument("file", type=PATH, required=False, metavar="[FILE]")
@requirements_option
@bindings_option
@path_option(
    "--logs",
    "places_named",
    multiple=True,
    metavar="FOLDER|URL",
    help="Where the logs are: a folder, in which they are found by name, or a URL prefix.  "
    "[default: files below the current folder, and https URLs]",
)
@click.option("--offline", is_flag=True, help="Do not access the network.")
@path_option(
    "--manifest",
    metavar="FILE",
    help="Output of `sha256sum LOG...`: FILE must have exactly these logs, with these hashes.",
)
@click.option(
    "--only",
    metavar="ID,...",
    help="Check only these requirements, for example R1,R2. A part never counts as the whole.",
)
@path_option("--report", help="HTML report that must equal the one made from FILE.")
@verification_option
@analysis_option
@path_option(
    "--signed-by",
    metavar="KEY",
    help="Public key (id_ed25519.pub), or list of signers. One of them must have signed FILE "
    "and the files of --report, --verification and --analysis.",
)
@click.option(
    "--strict",
    is_flag=True,
    help="Require a manifest, and signatures of FILE, of each review, and of the report, proofs "
    "and analysis if they exist. Signers are those of --signed-by, else those of "
    "allowed_signers beside the requirements, which also says which key belongs to which "
    "reviewer.",
)
@click.option(
    "--no-proofs", is_flag=True, help="Do not repeat the proofs: they count as not checked."
)
@click.option(
    "--no-analysis", is_flag=True, help="Do not repeat the analysis: it counts as not checked."
)
@label_option
@limit_option
@jobs_option
@format_option()
def verify_evidence(
    file: str | None,
    requirements: str,
    bindings: str | None,
    places_named: tuple[str, ...],
    offline: bool,
    manifest: str | None,
    only: str | None,
    report: str | None,
    verification: str | None,
    analysis: str | None,
    signed_by: str | None,
    strict: bool,
    no_proofs: bool,
    no_analysis: bool,
    labels: tuple[str, ...],
    limit: int,
    jobs: int,
    output_format: str,
) -> None:
    """Recompute evidence and compare it with what is written.

    FILE is the evidence of an audit. It must have a result for every active requirement in each
    run, every run that the lock names, and every log of the manifest. The command computes the
    SHA-256 of every log, repeats every audit, proof and analysis, and compares the results with
    those in FILE.

    Exit status: 0 everything is the same, 1 something differs or is missing (with --strict also
    a missing signature or manifest), 3 something was not checked, 2 bad usage or bad input.

    Example: fretc verify-evidence --manifest logs.sha256 --report build/report.html
    """
    from fretc.analysis.evidence import default_path as analyzed
    from fretc.analysis.evidence import read as read_analysis
    from fretc.audit.store.anywhere import required
    from fretc.verification.reader import default_path
    from fretc.verification.reader import read as read_proofs

    file = evidence_path(file)
    evidence = or_fail(required(file))
    whole = evidence.document
    if signed_by is not None:
        others = {"report": report, "proofs": verification, "analysis": analysis}
        require(evidence, signed_by, others)
    project, plan = _plan(requirements, bindings, labels)
    scope = _scope(plan, only, requirements)
    verification = verification or default_path()
    proofs = or_fail(read_proofs(verification)) if verification is not None else None
    analysis = analysis or analyzed()
    known = or_fail(read_analysis(analysis)) if analysis is not None else None
    log_hashes = _manifest(manifest)
    runs = list(dict.fromkeys(result.run for result in whole.results))
    places = _places(runs, places_named, offline=offline)
    results = [*_rechecked(whole, plan, places, scope, log_hashes, jobs)]
    results += _reproved(project.sound, proofs, scope, limit, skip=no_proofs)
    if known is not None:
        results += _asked_again(project.sound, known, scope, skip=no_analysis)
    if strict:
        there = {"report": report, "proofs": verification, "analysis": analysis}
        results += _unmet(evidence, scope, requirements, signed_by, there, log_hashes)
    sources = (file, verification, analysis, requirements)
    same = _report(project, report, *sources) if report is not None else None
    against = _against(scope, requirements, manifest)
    if output_format == "json":
        _print_json(results, same, scope, against)
    else:
        _print(results, same, against)
    raise SystemExit(_status(results, same, scope))


def _status(results: Sequence[Recheck], same: bool | None, scope: ComparisonScope) -> int:
    from fretc.reproduction.outcome import ItemOutcome

    kinds = {result.finding for result in results}
    if ItemOutcome.DIFFERS in kinds or same is False:
        return EXIT_VIOLATION
    return EXIT_INCONCLUSIVE if ItemOutcome.UNKNOWN in kinds or scope.part else EXIT_OK


def _plan(requirements: str, bindings: str | None, labels: Sequence[str]) -> tuple[Project, Plan]:
    from compiler.project.folder import load_folder
    from fretc.logs.labels import given

    given_labels = or_fail(given(labels))
    project = or_fail(load_folder(requirements, bindings))
    return project, replace(plan_of(project, requirements), labels=given_labels)


def _places(runs: Sequence[str], named: Sequence[str], *, offline: bool) -> dict[str, str]:
    """Run → path of its log, for logs that may be opened; others are reported."""
    from fretc.logs.storage.log_names import is_url, name_of
    from fretc.logs.storage.places import AllowedLocations
    from fretc.reproduction.results import located

    folders = [name for name in named if not is_url(name)]
    for folder in folders:
        if not Path(folder).is_dir():
            fix = "name the folder of the logs"
            fail(diagnostic("no_folder", folder=folder, help=fix))
    places: dict[str, str] = {}
    for folder in folders:
        places = {**located(runs, folder), **places}
    if not folders or len(folders) < len(named):
        places = {**located(runs, None), **places}
    policy = AllowedLocations(named, offline)
    refusals = {run: why for run, place in places.items() if (why := policy.refusal(place))}
    fix = "if you trust it, name its folder or URL prefix with `--logs`"
    print_diagnostics(
        [
            diagnostic("log_not_opened", log=name_of(places[run]), why=why, help=fix)
            for run, why in refusals.items()
        ]
    )
    return {run: place for run, place in places.items() if run not in refusals}


# What it is compared with ------------------------------------------------------------------------


def _scope(plan: Plan, only: str | None, requirements: str) -> ComparisonScope:
    from fretc.reproduction.completeness import ComparisonScope

    claims = tuple(each.id for each in plan.named)
    if only is None:
        return ComparisonScope(claims, _lock(requirements))
    ids = tuple(dict.fromkeys(name.strip() for name in only.split(",")))
    for name in ids:
        if name not in claims:
            fix = did_you_mean(name, claims, f"there are {', '.join(claims)}")
            fail(diagnostic("requirement_not_in_force", name=name, help=fix))
    return ComparisonScope(ids, _lock(requirements), part=True)


def _lock(requirements: str) -> Lock | None:
    from compiler.project.paths import sibling_path
    from fretc.traceability.lock import NAME, read

    path = sibling_path(requirements, NAME)
    return or_fail(read(path) if path is not None else None)


def _manifest(path: str | None) -> Manifest | None:
    from fretc.reproduction.manifest import Manifest, read

    if path is None:
        return None
    manifest = read(path)
    if not isinstance(manifest, Manifest):
        fail(*manifest)
    return manifest


def _against(scope: ComparisonScope, requirements: str, manifest: str | None) -> str:
    """The extent of the check in words, so that nothing unchecked seems confirmed."""
    count = len(scope.claimed)
    whole = f"{count} requirement{'' if count == 1 else 's'} of `{requirements}`"
    extent = f"only {', '.join(scope.claimed)}, a part" if scope.part else whole
    lock = "`fretc.lock`" if scope.lock is not None else ""
    naming = " and ".join(filter(None, (lock, f"`{manifest}`" if manifest else "")))
    runs = f"runs by {naming}" if naming else "neither a lock nor a manifest lists the runs"
    return f"{extent}; {runs}"


def _unmet(
    evidence: EvidenceFile,
    scope: ComparisonScope,
    requirements: str,
    signed_by: str | None,
    others: Mapping[str, str | None],
    manifest: Manifest | None,
) -> Sequence[Recheck]:
    """What `--strict` requires and is missing."""
    from compiler.project.paths import sibling_path
    from fretc.attestation.signatures import SIGNERS
    from fretc.reproduction.strictness import unmet_demands
    from fretc.traceability.lock import NAME

    installed()
    listed, lock = (sibling_path(requirements, name) for name in (SIGNERS, NAME))
    there = {kind: path for kind, path in others.items() if path is not None}
    of_files = _signatures([evidence.file, *there.values()], signed_by or listed)
    of_reviews = _signatures([lock] if lock else [], listed or signed_by)
    is_listed = manifest is not None
    return [*unmet_demands(evidence, scope, of_files, of_reviews, there, is_listed=is_listed)]


def _signatures(files: Sequence[str], signers: str | None) -> SignatureBook:
    """The signatures of files; exits if one is invalid."""
    from fretc.attestation.signatures import book
    from fretc.attestation.signers import trusted

    known = or_fail(trusted(signers) if signers is not None else None)
    signatures = or_fail(book(files, known))
    broken = list(signatures.diagnostics())
    print_diagnostics(broken)
    if has_errors(broken):
        raise SystemExit(EXIT_USAGE)
    return signatures


# Made again -------------------------------------------------------------------------------------


def _rechecked(
    whole: EvidenceDocument,
    plan: Plan,
    places: dict[str, str],
    scope: ComparisonScope,
    manifest: Manifest | None,
    jobs: int,
) -> tuple[Recheck, ...]:
    from fretc.audit.many_logs import local_executor
    from fretc.reproduction.results import recheck

    return or_fail(recheck(whole, plan, places, local_executor(jobs), scope, manifest))


def _reproved(
    project: Project, proofs: Proofs | None, scope: ComparisonScope, limit: int, *, skip: bool
) -> Sequence[Recheck]:
    from fretc.reproduction.outcome import PROOFS, unknown
    from fretc.reproduction.proofs import prove_again, unproved_plans
    from fretc.verification.engines.sandbox import CallLimits

    missing = tuple(unproved_plans(project, proofs.proofs if proofs else (), scope.claimed))
    if proofs is None:
        return missing
    if skip:
        return (unknown(PROOFS, "", "the proofs were not repeated: `--no-proofs`"), *missing)
    results = or_fail(
        prove_again(project, proofs, CallLimits(seconds=limit), scope.claimed, print_activity)
    )
    return (*results, *missing)


def _asked_again(
    project: Project, known: AnalyzedSet, scope: ComparisonScope, *, skip: bool
) -> Sequence[Recheck]:
    """The repeated analysis of the requirement set, compared with the stored one."""
    from fretc.analysis.analysis import AnalysisOptions
    from fretc.analysis.arena.systems import systems
    from fretc.analysis.assumptions import assumptions, guarantees
    from fretc.analysis.evidence import changes
    from fretc.commands.analyze import asked
    from fretc.reproduction.outcome import TOGETHER, differs, unknown
    from fretc.reproduction.sets import compared

    if skip or scope.part:
        why = f"the analysis was not repeated: `{'--no-analysis' if skip else '--only'}`"
        return (unknown(TOGETHER, "", why),)
    document = known.document
    in_force = guarantees(project.in_force)
    requirements = [
        requirement for requirement in in_force if requirement.id in document.requirements
    ]
    assumed, remarks = assumptions(project.in_force, project.declarations)
    if has_errors(remarks):
        fail(*remarks)
    examined = systems(requirements, assumed)
    print_diagnostics(examined.mistakes)
    now, stopped = asked(requirements, assumed, examined, AnalysisOptions(as_fret=document.as_fret))
    if stopped:
        raise SystemExit(EXIT_INTERRUPTED)
    old = [differs(TOGETHER, "", why) for why in changes(document, requirements, assumed)]
    others = (
        requirement.id for requirement in in_force if requirement not in requirements
    )  # A requirement outside `--component`, or a new one.
    new = [unknown(TOGETHER, id, "it was not part of the set") for id in others]
    return (*old, *new, *compared(document, now))


def _report(
    project: Project,
    path: str,
    evidence: str,
    verification: str | None,
    analysis: str | None,
    requirements: str,
) -> bool:
    """Whether the report that is made now equals the file, byte for byte."""
    from compiler.files.text_files import read
    from compiler.project.paths import sibling_path
    from fretc.attestation.signatures import SIGNERS
    from fretc.report.make import make
    from fretc.verification.reader import ajpf_results

    source = or_fail(read(path))
    names = [sibling_path(requirements, name) for name in ("fretc.lock", "waivers.toml", SIGNERS)]
    current = make(
        project,
        evidence,
        lock=names[0],
        waivers=names[1],
        verification=verification,
        ajpf=ajpf_results(),
        signers=names[2],
        analysis=analysis,
        requirements=requirements,
    )
    return current.html == source.text


def _print(results: Sequence[Recheck], same: bool | None, against: str) -> None:
    from fretc.reproduction.outcome import SIGNS, ItemOutcome

    lines: list[tuple[str, str | None]] = []
    width = max((len(result.requirement) for result in results), default=0)
    run = None
    for one in results:
        if one.run != run:
            run = one.run
            lines.append((run, None))
        sign = SIGNS[one.finding]
        text = ": ".join(filter(None, (one.finding, one.claim, "; ".join(one.reasons))))
        lines.append((f"  {sign.glyph} {one.requirement:<{width}}  {text}", sign.colour))
    if same is not None:
        sign = SIGNS[ItemOutcome.STANDS if same else ItemOutcome.DIFFERS]
        text = "the same, byte for byte" if same else "the report made now is different"
        lines.append((f"{sign.glyph} report  {text}", sign.colour))
    totals = ", ".join(f"{finding} {count}" for finding, count in _counts(results, same).items())
    lines.append((f"{totals} ({against})", None))
    click.echo(coloured([(visible(line), colour) for line, colour in lines]), nl=False)


def _counts(results: Sequence[Recheck], same: bool | None) -> dict[str, int]:
    """Number of each finding, including the report."""
    from fretc.reproduction.outcome import ItemOutcome, counts

    totals = {str(finding): count for finding, count in counts(results).items()}
    if same is not None:
        totals[ItemOutcome.STANDS if same else ItemOutcome.DIFFERS] += 1
    return totals


def _print_json(
    results: Sequence[Recheck], same: bool | None, scope: ComparisonScope, against: str
) -> None:
    from dataclasses import asdict

    from compiler.files.templating import to_json

    record = {
        "results": [asdict(result) for result in results],
        "report_is_the_same": same,
        "counts": _counts(results, same),
        "only": list(scope.claimed) if scope.part else None,
        "against": against,
    }
    click.echo(to_json(record))
