"""`fretc audit`: check recorded runs against the requirements.

This module reads the options; `audit_run` does what they ask for.
"""

from __future__ import annotations

from typing import Any

import click

from fretc.terminal.group import CommandWithHeadings
from fretc.terminal.options import (
    LOG_EXTRAS,
    PATH,
    bindings_option,
    extras,
    format_option,
    jobs_option,
    label_option,
    output_option,
    path_option,
    requirements_option,
)

_AUDIT = {
    "Input": ("requirements", "bindings", "integrity", "confidence"),
    "Output": ("output_format", "verbose", "output", "parquet", "annotate", "annotations"),
    "Selection": ("since", "sample", "seed"),
    "Many logs, performance": (
        "labels",
        "jobs",
        "log_time",
        "whole_time",
        "engine",
        "rehash",
        "keep_columns",
        "command",
    ),
    "Queries on existing evidence": (
        "summary",
        "query",
    ),
}


@click.command(
    cls=CommandWithHeadings,
    headings=_AUDIT,
    epilog=extras({**LOG_EXTRAS, "fleet": "--engine dask", "parquet": "--parquet"}),
)
@click.argument("paths", nargs=-1, required=True, type=PATH, metavar="LOG...")
@requirements_option
@bindings_option
@output_option(
    help="Evidence file (NAME.json), or folder of an evidence store (any other name). `-` "
    "prints the evidence.  [default: build/evidence.json for one log, build/evidence for "
    "several]",
)
@click.option(
    "--annotate",
    is_flag=True,
    help="Also write the verdicts as annotation logs, which Foxglove shows beside each run.",
)
@path_option(
    "--annotations",
    metavar="FOLDER",
    help="Folder for the annotation logs. Implies --annotate.  [default: build/annotations]",
)
@format_option(
    "junit",
    "github",
    "sarif",
    text="Output format. `github`: annotations for GitHub Actions.",
)
@click.option(
    "-v",
    "--verbose",
    is_flag=True,
    help="List every result and note. Without it, many runs are shown as a table of symbols.",
)
@click.option(
    "--integrity",
    type=click.Choice(("index", "hash", "full")),
    default="hash",
    show_default=True,
    help="How thoroughly a log is checked. `index`: only topics in the bindings are read. "
    "`hash`: also computes the SHA-256 of the file. `full`: also checks every record, CRC "
    "and count.",
)
@click.option(
    "--confidence",
    type=click.FloatRange(min=0.5, max=0.999, min_open=True),
    default=0.95,
    show_default=True,
    help="Confidence level for requirements with a probability.",
)
@label_option
@jobs_option
@click.option(
    "--engine",
    default="local",
    show_default=True,
    help="Where the audit runs: `local`, `dask` (a Dask cluster on this machine) or "
    "dask://HOST:PORT.",
)
@click.option(
    "--since",
    metavar="TIME",
    help="Only logs recorded since this time, for example 2026-11-22, 24h or 7d.",
)
@click.option(
    "--sample",
    type=click.IntRange(min=1),
    metavar="N",
    help="Audit a random sample of at most N logs.",
)
@click.option(
    "--seed",
    type=click.IntRange(min=0),
    default=0,
    show_default=True,
    help="Seed of the random sample.",
)
@click.option(
    "--log-time", metavar="TIME", help="Time limit for each log, for example 90s or 5min."
)
@click.option(
    "--time", "whole_time", metavar="TIME", help="Time limit for the whole audit, for example 6h."
)
@click.option(
    "--keep-columns",
    is_flag=True,
    help="Keep the samples of all logs beside the evidence, so that unchanged logs are not read"
    " again.",
)
@click.option(
    "--rehash",
    is_flag=True,
    help="Identify unchanged logs by SHA-256, not by size and time of change.",
)
@click.option(
    "--notify",
    "command",
    metavar="CMD",
    help="Run CMD at the end, with a JSON summary on its standard input.",
)
@path_option(
    "--parquet", help="Also write a Parquet table with one row for each run and requirement."
)
@click.option(
    "--summary",
    is_flag=True,
    help="Summarize existing evidence: verdict counts, worst runs, "
    "slowest responses. LOG is the evidence; nothing is "
    "audited.",
)
@click.option(
    "--query",
    metavar="SQL",
    help="Query existing evidence with DuckDB SQL. LOG is the evidence; the tables are "
    "`results`, `violations` and `runs`.",
)
def audit(summary: bool, query: str | None, **options: Any) -> None:
    """Check recorded runs against the requirements and give each a verdict.

    LOG is an MCAP file, a ROS bag, a ULog, a DataFlash log, a table (.csv, .jsonl), a folder, a
    quoted pattern ('runs/**/*.mcap'), a URL, a folder or pattern in an object store
    (s3://bucket/runs/), or `-` for standard input. A rosbag2 folder with several files is one log.

    The verdict of a requirement in a run is satisfied, violated, inconclusive, vacuous or no
    data. A requirement with a probability gets one verdict over all runs: supported, refuted or
    inconclusive.

    Exit status: 0 all are satisfied, 1 one is violated, 2 bad usage or bad input, 3 none is
    violated but one is inconclusive, vacuous or has no data.

    Example: fretc audit runs/ --requirements requirements/mission -o build/mission.json
    """
    if summary or query is not None:
        from fretc.commands.summary import print_summary

        print_summary(options["paths"], query, options["output_format"])
    from fretc.commands.audit_run import AuditOptions, run

    raise SystemExit(run(AuditOptions.of(options)))
