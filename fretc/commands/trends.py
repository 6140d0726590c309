"""The command about many audits: what is new, fixed, flaky or worse between them."""

from __future__ import annotations

from pathlib import Path

import click

from fretc.terminal.options import PATH, format_option, path_option
from fretc.terminal.output import (
    NOT_SHOWN,
    SHOWN,
    VIOLATION,
    deliver,
    painted,
    protect,
    say,
    stop,
)
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity


@click.command(short_help="Say what is new, fixed, flaky or worse between audits.")
@click.argument("evidence", nargs=-1, required=True, type=PATH, metavar="EVIDENCE...")
@click.option(
    "--by",
    metavar="evidence|day|LABEL",
    help="What is compared: each evidence, each day, or each value of a label such as version. "
    "Each evidence, if not given; of a single one, each day.",
)
@click.option(
    "--level",
    type=click.FloatRange(min=0, max=0.5, min_open=True),
    default=0.05,
    show_default=True,
    help="The chance of even one regression that is none, of all that are told together.",
)
@format_option()
@path_option("--html", metavar="FILE", help="Also write a page with pictures.")
def trends(
    evidence: tuple[str, ...], by: str | None, level: float, form: str, html: str | None
) -> None:
    """Say what is new, fixed, flaky or worse between audits.

    EVIDENCE is what `fretc audit` has written: one of each night, say, or a single one with runs
    of many days. The newest round is held against those before it, for each requirement and each
    scenario (a label of the runs; else the name of the log). A change of a verdict is always told.
    Latencies and margins that are worse are told where that is more than chance.
    Exit status: 0 nothing is newly violated and nothing has regressed, 1 something is or has, 3
    something that was known before is not known now, or nothing can be compared, 2 bad use or
    bad input.
    """
    from fretc.audit.store.anywhere import StoreError, required_source
    from fretc.trends.trends import trends as trends_of

    if html is not None:
        protect([Path(html)], evidence)
    sources = [required_source(path) for path in dict.fromkeys(evidence)]
    wrong = [each for each in sources if isinstance(each, Diagnostic)]
    if wrong:
        stop(*wrong)
    good = [each for each in sources if not isinstance(each, Diagnostic)]
    try:
        known = trends_of(good, by, level)
    except StoreError as error:
        stop(error.diagnostic)
    if isinstance(known, Diagnostic):
        stop(known)
    if html is not None:
        from fretc.trends.page import html as page

        deliver({Path(html): page(known)}, evidence)
    if form == "json":
        from fretc.trends.json_form import text

        click.echo(text(known), nl=False)
    else:
        from fretc.commands.trends_text import lines
        from fretc.terminal.screen import screen

        click.echo(painted(lines(known, screen())), nl=False)
    if not known.has_pairs:
        say([_nothing_to_compare()])
    worse = VIOLATION if known.is_worse else None
    raise SystemExit(worse or (SHOWN if known.is_comparable else NOT_SHOWN))


def _nothing_to_compare() -> Diagnostic:
    return Diagnostic(
        Code.NOT_COMPARABLE,
        "nothing can be compared: no requirement was judged in one scenario in two rounds",
        help="name an earlier evidence, too; label runs with `scenario`, or give logs of one "
        "scenario one name",
        severity=Severity.WARNING,
    )
