"""`fretc lock` and `fretc diff`: record reviews, and show what has changed since."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from compiler.files.dates import is_date, is_in_future, today
from fretc.commands.opening import print_excluded
from fretc.terminal.options import (
    PATH,
    analysis_option,
    bindings_option,
    evidence_option,
    evidence_path,
    extras,
    format_option,
    hazards_option,
    is_given,
    path_option,
    requirements_option,
    verification_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    fail,
    fail_at_end,
    or_fail,
    print_project_diagnostics,
    print_status,
    write_outputs,
)
from fretish.diagnostics.diagnostic import (
    Diagnostic,
    Severity,
    did_you_mean,
    has_errors,
)
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible
from fretish.reading.natural_order import natural

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from compiler.project.project import Project
    from fretc.traceability.chain import Chain
    from fretc.traceability.lock import Lock, Review


@click.command(
    epilog=extras({"sign": "--key"}),
)
@click.argument("ids", nargs=-1, metavar="[ID]...")
@click.option("--reviewer", required=True, help="Name of the reviewer.")
@click.option("--role", required=True, help="Role of the reviewer, for example `safety engineer`.")
@click.option("--comment", required=True, help="What was reviewed, and why it is accepted.")
@click.option(
    "--date",
    "day",
    help="Date of the review, for example 2026-11-22.  [default: the"
    " day of SOURCE_DATE_EPOCH, else today]",
)
@requirements_option
@bindings_option
@hazards_option
@evidence_option
@verification_option
@analysis_option
@path_option("--lock", "path", help="Lock file.  [default: fretc.lock beside the requirements]")
@path_option("--key", help="Private key that signs the reviews, for example ~/.ssh/id_ed25519.")
@click.option("--accept-violations", is_flag=True, help="Also accept violations and conflicts.")
@format_option()
def lock(
    ids: tuple[str, ...],
    reviewer: str,
    role: str,
    comment: str,
    day: str | None,
    requirements: str,
    bindings: str | None,
    hazards: str | None,
    evidence: str | None,
    verification: str | None,
    analysis: str | None,
    path: str | None,
    key: str | None,
    accept_violations: bool,
    output_format: str,
) -> None:
    """Record your review of requirements in fretc.lock.

    The lock stores fingerprints of each sentence, its parents, parameters, bindings and
    artefacts, and of each audited run with its verdict. A later change marks everything that
    depends on it as suspect. Without ID, all requirements are reviewed, and reviews of
    requirements that are gone are removed. With ID, all other reviews stay.

    The command prints the audit results and the analysis that you accept. Violations and
    conflicts are accepted only with `--accept-violations`; they stay violations. Evidence that
    does not belong to the present requirements is refused.

    Example: fretc lock --reviewer "A. Meier" --role "safety engineer" --comment "first review"
    """
    from compiler.files.templating import to_json
    from compiler.project.folder import load_folder
    from fretc.traceability.lock import (
        AcceptedVerdicts,
        Lock,
        accepted,
        outdated_results,
        text,
        unnamed_violations,
        verdicts_of,
        warnings_of,
    )

    for name, words in (("--reviewer", reviewer), ("--role", role), ("--comment", comment)):
        if not words.strip():
            fail(diagnostic("empty_option", name=name))
    day = day or today()
    if not is_date(day):
        fail(diagnostic("not_a_date", day=day))
    if is_in_future(day):
        fail(diagnostic("review_in_future", day=day))
    project = or_fail(load_folder(requirements, bindings, hazards))
    chains, refuted = _chains(project, requirements, evidence, verification, analysis, accept=True)
    refused = _refused(project)
    where = path or _beside(requirements)
    before = _read(where, must=False)
    old_reviews = before.reviews if before is not None else {}
    orphans = old_reviews.keys() - {chain.requirement for chain in chains}
    chosen = _chosen(chains, ids, orphans)
    subjects = [chain for chain in chosen if chain.requirement not in refused]
    if refused and not subjects:
        raise SystemExit(EXIT_USAGE)
    violations = () if accept_violations else unnamed_violations(subjects, refuted)
    refusals = (*outdated_results(subjects), *violations)
    if refusals:
        fail(*refusals)
    removals = {id for id in orphans if not ids or id in ids}
    reviews = {id: review for id, review in old_reviews.items() if id not in removals}
    reviews |= {c.requirement: accepted(c, reviewer, role, day, comment) for c in subjects}
    signatures = _signatures(where, reviews, subjects, key) if key is not None else {}
    write_outputs({Path(where): text(Lock(reviews)), **signatures})
    counts = AcceptedVerdicts.of(subjects, refuted)
    if output_format == "json":
        click.echo(to_json({**counts.as_record, "left_out": sorted(removals, key=natural)}))
        return
    for chain in subjects:
        print_status(
            visible(f"accepted {chain.requirement}: {verdicts_of(chain)}{warnings_of(chain)}")
        )
    for id in sorted(removals, key=natural):
        print_status(f"left out {id}: there is no such requirement")
    print_status(counts.text)


def _signatures(
    path: str, reviews: Mapping[str, Review], chosen: Sequence[Chain], key: str
) -> dict[Path, str]:
    """The signatures beside the lock, with a new one for the reviews that are accepted now."""
    from fretc.commands.sign import of_reviews, private, signed

    mine = private(key)
    accepted = [reviews[chain.requirement] for chain in chosen]
    return signed(of_reviews(path, accepted, reviews.values()), mine)


@click.command()
@click.argument("baseline", required=False, type=PATH, metavar="[BASELINE]")
@requirements_option
@bindings_option
@hazards_option
@evidence_option
@verification_option
@analysis_option
@format_option()
def diff(
    baseline: str | None,
    requirements: str,
    bindings: str | None,
    hazards: str | None,
    evidence: str | None,
    verification: str | None,
    analysis: str | None,
    output_format: str,
) -> None:
    """Show what has changed since a review, verdicts included.

    BASELINE is a lock file; fretc.lock beside the requirements by default.

    Exit status: 0 nothing has changed, 3 something has changed, 2 bad usage or bad input.

    Example: fretc diff
    """
    from compiler.files.templating import to_json
    from compiler.project.folder import load_folder
    from fretc.traceability.comparison import as_record, differences, text
    from fretc.traceability.lock import Lock, review_statuses

    project = or_fail(load_folder(requirements, bindings, hazards))
    chains, _ = _chains(project, requirements, evidence, verification, analysis)
    refused = _refused(project)
    base = _read(baseline or _beside(requirements), must=True)
    assert base is not None
    sound = tuple(chain for chain in chains if chain.requirement not in refused)
    base = Lock({id: review for id, review in base.reviews.items() if id not in refused})
    if refused and not sound:
        raise SystemExit(EXIT_USAGE)
    changes = differences(review_statuses(sound, base), base, project)
    if output_format == "json":
        click.echo(to_json([as_record(difference) for difference in changes]))
    else:
        for line in text(changes):
            click.echo(visible(line))
    raise SystemExit(EXIT_OK if all(d.state == "same" for d in changes) else EXIT_INCONCLUSIVE)


def _refused(project: Project) -> Mapping[str, Sequence[Diagnostic]]:
    """Ids of the requirements with errors, and the errors; the ids are also printed."""
    from compiler.project.refusals import unreviewable

    if not has_errors(project.diagnostics):
        return {}
    fail_at_end()
    reached = unreviewable(project)
    refused = {r.id: reached[r] for r in project.requirements if r in reached}
    if len(refused) < len({requirement.id for requirement in project.requirements}):
        print_excluded(refused, len(project.requirements))
    return refused


def _chains(
    project: Project,
    requirements: str,
    evidence: str | None,
    verification: str | None,
    analysis: str | None,
    *,
    accept: bool = False,
) -> tuple[Sequence[Chain], Collection[str]]:
    """The chains of the project, and the requirements that all runs together refute.

    Args:
        project: what was read.
        requirements: folder or file of the requirements, for what is printed.
        evidence: path of the evidence; None: the default path.
        verification: path of the proofs.
        analysis: path of the analysis.
        accept: whether the results will be accepted, so that a store is checked in full.
    """
    from fretc.analysis.evidence import known as known_analysis
    from fretc.audit.evidence.result_summaries import ResultSummaries
    from fretc.audit.measurements.confidence_intervals import REFUTED
    from fretc.audit.store.anywhere import required_source, source
    from fretc.traceability.chain_builder import chains
    from fretc.verification.reader import known

    proofs = or_fail(known(verification))
    analyzed = or_fail(known_analysis(analysis))
    read = required_source if is_given("evidence") else source
    audited = read(evidence_path(evidence), in_full=accept)
    if isinstance(audited, Diagnostic):
        print_project_diagnostics([*project.diagnostics, audited], requirements)
        if audited.is_error:
            raise SystemExit(EXIT_USAGE)
        return chains(project, None, proofs=proofs, analyzed=analyzed), ()
    print_project_diagnostics(project.diagnostics, requirements)
    refuted = {one.requirement for one in audited.probabilities if one.answer == REFUTED}
    of_all = chains(project, ResultSummaries.of(audited), proofs=proofs, analyzed=analyzed)
    return of_all, refuted


def _chosen(
    chains: Sequence[Chain], ids: tuple[str, ...], orphans: Collection[str]
) -> Sequence[Chain]:
    """The named requirements, or all; a removed requirement may be named, to remove its review."""
    known = [*(chain.requirement for chain in chains), *orphans]
    for id in ids:
        if id not in known:
            fix = did_you_mean(id, known, f"there are {', '.join(known)}")
            fail(diagnostic("unknown_requirement", id=id, help=fix))
    return [chain for chain in chains if not ids or chain.requirement in ids]


def _beside(requirements: str) -> str:
    from fretc.traceability.lock import NAME

    folder = Path(requirements)
    return str((folder.parent if folder.is_file() else folder) / NAME)


def _read(path: str, *, must: bool) -> Lock | None:
    """The lock; None if it does not exist and is not required."""
    from fretc.traceability.lock import read

    lock_ = read(path)
    if not isinstance(lock_, Diagnostic):
        return lock_
    if must or lock_.is_error:
        fail(replace(lock_, severity=Severity.ERROR))
    return None
