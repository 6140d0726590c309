"""The command that audits runs."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.commands.audit_progress import audit_all
from fretc.commands.summary import summarize
from fretc.terminal.group import Grouped
from fretc.terminal.options import (
    PATH,
    Renamed,
    bindings_option,
    format_option,
    jobs_option,
    output_option,
    path_option,
    requirements_option,
)
from fretc.terminal.output import (
    BAD,
    EVIDENCE,
    NOT_SHOWN,
    SHOWN,
    VIOLATION,
    deliver,
    not_written,
    painted,
    protect,
    say,
    say_also,
    say_briefly,
    stop,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic, has_errors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from compiler.project.folder import Project
    from fretc.audit.journal import Journal
    from fretc.audit.many_logs import Audit, Engine
    from fretc.audit.plan import Plan


_AUDIT = {
    "Judged by": ("requirements", "bindings", "integrity", "evaluation", "confidence"),
    "Printed and written": ("form", "verbose", "output", "parquet", "annotate", "annotations"),
    "Many logs": ("jobs", "resume", "engine"),
    "Questions to tables and evidence: LOG is one of them, nothing is audited": (
        "summary",
        "query",
    ),
}


@click.command(
    cls=Grouped, headings=_AUDIT, short_help="Audit recorded runs against all requirements."
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="LOG...")
@requirements_option
@bindings_option
@output_option(
    cls=Renamed,
    earlier="--evidence",
    default=EVIDENCE,
    show_default=True,
    help="Where evidence goes; `-` prints it.",
)
@click.option("--annotate", is_flag=True, help="Also write its verdicts as a log, for Foxglove.")
@path_option(
    "--annotations",
    metavar="FOLDER",
    help="Where these go: build/annotations, if not given. Implies --annotate.",
)
@format_option(
    "junit",
    "github",
    "sarif",
    text="What is printed: for a person, as JSON, as JUnit XML, as annotations of GitHub Actions, "
    "as SARIF.",
)
@click.option(
    "-v", "--verbose", is_flag=True, help="List each result, of many runs too: no table of marks."
)
@click.option(
    "--evaluation",
    type=click.Choice(("columns", "online")),
    default="columns",
    show_default=True,
    help="Run the monitors over whole logs at once, or step by step; what they show is the same.",
)
@click.option(
    "--integrity",
    type=click.Choice(("index", "hash", "full")),
    default="hash",
    show_default=True,
    help="How much of a log is read: what is bound (index); that, and all bytes are hashed (hash); "
    "every record, CRC and count (full).",
)
@click.option(
    "--confidence",
    type=click.FloatRange(min=0.5, max=0.999, min_open=True),
    default=0.95,
    show_default=True,
    help="Of what all logs together say of a requirement with a probability.",
)
@jobs_option
@click.option(
    "--engine",
    default="local",
    show_default=True,
    help="Where logs are audited: local, dask (a cluster of this machine), dask://HOST:PORT.",
)
@click.option("--resume", is_flag=True, help="Go on with an audit that was stopped.")
@path_option("--parquet", help="Where a table goes, too: a row for each run and requirement.")
@click.option(
    "--summary", is_flag=True, help="How many of which verdict, worst runs, slowest answers."
)
@click.option("--query", metavar="SQL", help="The answer to SQL of DuckDB; the table is `results`.")
def audit(
    paths: tuple[str, ...],
    requirements: str,
    bindings: str | None,
    output: str,
    annotate: bool,
    annotations: str | None,
    form: str,
    verbose: bool,
    evaluation: str,
    integrity: str,
    confidence: float,
    jobs: int,
    engine: str,
    resume: bool,
    parquet: str | None,
    summary: bool,
    query: str | None,
) -> None:
    """Audit recorded runs against all requirements.

    LOG is an MCAP file, a bag (.bag, .db3), a folder (all logs below it), a quoted pattern
    ('runs/**/*.mcap'), a URL, or - for standard input. A folder of rosbag2 with several files is
    one log.

    Each run and requirement gets a verdict: satisfied, violated, inconclusive, vacuous or no data.
    A requirement with a probability is judged over all runs: supported, refuted or inconclusive.
    Exit status: 0 all satisfied, 1 a violation, 2 bad use or bad input, 3 something is not shown.
    """
    if summary or query is not None:
        summarize(paths, query, form)
    began = time.perf_counter()
    _check_outputs(output, parquet, resume=resume)
    from compiler.project.folder import load
    from compiler.project.paths import beside, companions, requirement_files
    from fretc.audit.log_paths import files_of
    from fretc.audit.log_paths import logs as logs_of
    from fretc.audit.plan import Plan, planned
    from fretc.logs.signals.integrity import Integrity

    logs = logs_of(paths)
    if isinstance(logs, Diagnostic):
        stop(logs)
    files = requirement_files(requirements)
    if isinstance(files, Diagnostic):
        stop(files)
    outputs = [Path(path) for path in (output, f"{output}.journal", parquet) if path]
    inputs = (*files_of(logs), *files, *companions(files), *([bindings] if bindings else []))
    protect(outputs, inputs)
    project = load(files, bindings or beside(requirements, "bindings.toml"))
    say_briefly(project.diagnostics, requirements)
    if has_errors(project.general):
        raise SystemExit(BAD)
    plan = planned(project, evaluation, Integrity(integrity), confidence)
    if not isinstance(plan, Plan):
        stop(*(reason for reason in plan if reason not in project.diagnostics))
    journal = _journal(output, plan) if output != "-" and len(logs) > 1 else None
    refusals = [reason for reason in plan.refusals if reason not in project.diagnostics]
    say_also(refusals, project.diagnostics)
    result = audit_all(plan, logs, _engine(engine, jobs), journal, resume=resume)
    result = replace(result, diagnostics=project.answered(result.diagnostics))
    say_also(result.diagnostics, (*project.diagnostics, *refusals))
    if result.read:  # a mistyped name must not cost the evidence of the last audit
        annotation_files = (
            _annotation_files(result, project, annotations) if annotate or annotations else {}
        )
        forms: dict[Path, str | bytes] = {Path(output): result.evidence}
        if parquet is not None:
            forms[Path(parquet)] = _table(result)
        if {*map(os.path.realpath, forms)} & {*map(os.path.realpath, annotation_files)}:
            stop(not_written(output, "two outputs would go there"))
        deliver({**forms, **annotation_files}, inputs)
        if journal is not None:
            journal.remove()
    if form == "text":
        from fretc.commands.audit_text import Places, Subject, lines
        from fretc.terminal.screen import screen

        places, refused = Places(requirements, bindings, output), {one.id for one in plan.refused}
        subject = Subject(result, project, refused, places, time.perf_counter() - began)
        click.echo(painted(lines(subject, screen(), every=verbose)), nl=False)
    else:
        click.echo(_text(result, project, refusals, form), nl=False)
    if plan.refused or has_errors((*project.diagnostics, *result.diagnostics)):
        raise SystemExit(BAD)
    raise SystemExit(VIOLATION if result.violated else SHOWN if result.shown else NOT_SHOWN)


def _journal(evidence: str, plan: Plan) -> Journal | None:
    """None where there is no key of the user: then nothing is kept for `--resume`."""
    from compiler.files.user_key import user_key
    from fretc.audit.journal import Journal

    key = user_key()
    if isinstance(key, Diagnostic):
        say([key])
        return None
    return Journal(Path(evidence), plan, key)


def _annotation_files(result: Audit, project: Project, folder: str | None) -> dict[Path, bytes]:
    from fretc.audit.evidence.declared_units import without_samples
    from fretc.audit.outputs.annotations import sidecars
    from fretc.audit.outputs.foxglove_layout import layout_file

    results = without_samples(result.results, project.declarations)
    place = Path(folder or "build/annotations")
    logs = sidecars(results, project.rules, place)
    return {**logs, **layout_file(results, project.rules, place)}


def _text(result: Audit, project: Project, refusals: Sequence[Diagnostic], form: str) -> str:
    from fretc.audit.evidence.declared_units import without_samples
    from fretc.audit.outputs.junit import github, junit
    from fretc.audit.outputs.sarif import AllRuns, OneRun, sarif

    if form == "json":
        return result.as_json
    results = without_samples(result.results, project.declarations)
    if form == "junit":
        return junit(results, result.estimates)
    if form == "github":
        return github(results, project.requirements, result.estimates)
    assert form == "sarif", "a choice of --format"
    diagnostics = (*project.diagnostics, *refusals, *result.diagnostics)
    together = [AllRuns.of(one) for one in result.estimates]
    each = [OneRun.of(one) for one in results]
    return sarif(each, project.rules, diagnostics, together, project.without_rule)


def _engine(name: str, jobs: int) -> Engine:
    if name == "local":
        from fretc.audit.many_logs import locally

        return locally(jobs)
    from fretc.audit import fleet

    engine = fleet.engine(name, jobs)
    if isinstance(engine, Diagnostic):
        stop(engine)
    return engine


def _check_outputs(evidence: str, parquet: str | None, *, resume: bool) -> None:
    """Stop where they cannot be written, before hours of audit have gone by."""
    if resume and evidence == "-":
        stop(_nothing_kept())
    if parquet == "-":
        stop(not_written(parquet, "a table is a file"))
    for path in (evidence, parquet):
        if path not in ("-", None) and os.path.exists(path) and not os.path.isfile(path):
            stop(not_written(path, "it is no regular file"))
    if parquet is not None:
        from fretc.audit.outputs.table import missing

        absent = missing()
        if absent is not None:
            stop(absent)
        if os.path.realpath(parquet) == os.path.realpath(evidence):
            stop(not_written(parquet, "two outputs would go there"))


def _table(result: Audit) -> bytes:
    from compiler.files.edition import __version__
    from fretc.audit.outputs.table import parquet

    return parquet(result.results, __version__)


def _nothing_kept() -> Diagnostic:
    return Diagnostic(
        Code.BAD_USAGE,
        "`--resume` goes on with evidence in a file, and this is printed",
        help="name a file with `-o`",
    )
