"""`fretc audit --summary` and `--query`: aggregated results of many runs."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from typing import Any, NoReturn

import click

from fretc.audit.evidence.verdicts import ASSUMPTION_BROKEN, VERDICTS
from fretc.audit.outputs.summary import (
    COUNTED,
    MOST,
    QueryResult,
    TableSummary,
    run_query,
    summarize,
)
from fretc.audit.outputs.table import read
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_VIOLATION,
    fail,
    or_fail,
    print_diagnostics,
)
from fretish.bindings.amounts import count_of
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible


def print_summary(paths: Sequence[str], query: str | None, output_format: str) -> NoReturn:
    """Print a summary of evidence, or the result of a query; exit with the status of the audit."""
    if output_format not in ("text", "json"):
        fail(diagnostic("unknown_summary_format", output_format=output_format))
    table = or_fail(read(paths, query))
    if query is not None:
        with closing(table):
            answer = or_fail(run_query(table, query))
        click.echo(_json(answer.records) if output_format == "json" else _listed(answer), nl=False)
        raise SystemExit(EXIT_OK)
    with closing(table):
        summary = summarize(table)
    print_diagnostics(summary.remarks)
    click.echo(_json(summary.as_record) if output_format == "json" else _text(summary), nl=False)
    raise SystemExit(
        EXIT_VIOLATION if summary.violated else EXIT_OK if summary.shown else EXIT_INCONCLUSIVE
    )


def _json(value: object) -> str:
    return f"{json.dumps(_plain(value), indent=2, allow_nan=False, default=str)}\n"


def _plain(value: object) -> object:
    """The value with NaN and infinities replaced by None, which JSON can hold."""
    match value:
        case dict():
            return {str(key): _plain(item) for key, item in value.items()}
        case list() | tuple():
            return [_plain(item) for item in value]
        case float() if not math.isfinite(value):
            return None
        case _:
            return value


def _text(summary: TableSummary) -> str:
    whole = summary.whole
    damaged = f", {count_of(whole['damaged'], 'damaged run')}" if whole["damaged"] else ""
    lines = [
        f"{count_of(whole['runs'], 'run')}, {count_of(whole['requirements'], 'requirement')}, "
        f"{whole['seconds'] / 3600:.1f} h{damaged}",
        "",
        *_aligned(*_verdicts(summary)),
    ]
    failed = summary.failed.records
    if failed:
        listed = f" ({MOST} of {len(failed):,})" if len(failed) > MOST else ""
        lines += ["", f"worst runs{listed}", *_aligned(*_worst(failed[:MOST]))]
    if summary.slowest.rows:
        lines += ["", "slowest answers", *_aligned(*_slowest(summary))]
    return "".join(f"{line}\n" for line in lines)


def _verdicts(summary: TableSummary) -> tuple[list[str], list[list[str]]]:
    records = summary.requirements.records
    columns = {
        name: word
        for name, word in COUNTED.items()
        if word != ASSUMPTION_BROKEN or any(row[name] for row in records)
    }
    counted = (f"{VERDICTS[word].sign.glyph} {word}" for word in columns.values())
    head = ["requirement", "runs", *counted, "violations"]
    rows = [
        [
            row["requirement"],
            *(f"{row[name]:,}" for name in ("runs", *columns, "violations")),
        ]
        for row in records
    ]
    return head, rows


def _worst(failed: Sequence[Mapping[str, Any]]) -> tuple[list[str], list[list[str]]]:
    head = ["run", "violated", "not shown", "violations", "why"]
    rows = [
        [row["run"], str(row["violated"]), str(row["not_shown"]), str(row["violations"])]
        + [row["reason"]]
        for row in failed
    ]
    return head, rows


def _slowest(summary: TableSummary) -> tuple[list[str], list[list[str]]]:
    head = ["requirement", "longest", "median", "run"]
    rows = [
        [
            row["requirement"],
            f"{row['latency_max_s']:.2f} s",
            f"{row['latency_median_s']:.2f} s",
            row["run"],
        ]
        for row in summary.slowest.records
    ]
    return head, rows


def _listed(answer: QueryResult) -> str:
    """Lines of a query result: its columns, then its rows."""
    rows = [["" if value is None else str(value) for value in row] for row in answer.rows]
    return "".join(f"{line}\n" for line in _aligned(list(answer.columns), rows))


def _aligned(head: list[str], rows: list[list[str]]) -> Iterator[str]:
    """Lines with aligned columns, numbers to the right."""
    cells = [[visible(cell) for cell in row] for row in (head, *rows)]
    columns = list(zip(*cells, strict=True))
    widths = [max(map(len, column)) for column in columns]
    right = [all(_is_number(cell) for cell in column[1:]) for column in columns]
    for row in cells:
        padded = [
            cell.rjust(width) if number else cell.ljust(width)
            for cell, width, number in zip(row, widths, right, strict=True)
        ]
        yield f"  {'  '.join(padded)}".rstrip()


def _is_number(cell: str) -> bool:
    return not cell.strip("0123456789.,-+e s")
