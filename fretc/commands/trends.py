"""`fretc trends`: changes between many audits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.terminal.options import PATH, format_option, is_given, path_option, requirements_option
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_VIOLATION,
    fail,
    or_fail,
    painted,
    print_diagnostics,
    protect,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

if TYPE_CHECKING:
    from fretc.trends.known_requirements import KnownRequirements


@click.command()
@click.argument("evidence", nargs=-1, required=True, type=PATH, metavar="EVIDENCE...")
@click.option(
    "--by",
    metavar="evidence|day|LABEL",
    help="What is compared: each evidence, each day, or each value of a label such as version."
    "  [default: evidence; day for a single EVIDENCE]",
)
@click.option(
    "--level",
    type=click.FloatRange(min=0, max=0.5, min_open=True),
    default=0.05,
    show_default=True,
    help="Significance level: the probability of even one false alarm among all reported "
    "regressions.",
)
@format_option()
@path_option("--html", metavar="FILE", help="Also write an HTML page with charts.")
@click.option(
    "--reports",
    default="",
    metavar="ADDRESS",
    help="Address of the report of each round, for links of the page; `{name}` is the name of its "
    "evidence without its ending: --reports '../{name}/report.html'.",
)
@requirements_option
def trends(
    evidence: tuple[str, ...],
    requirements: str,
    by: str | None,
    level: float,
    output_format: str,
    html: str | None,
    reports: str,
) -> None:
    """Compare audits: what is newly violated, fixed, flaky or worse.

    EVIDENCE is what `fretc audit` writes: one file or store for each night, or a single one
    with runs of several days. The newest round is compared with all earlier ones, by
    requirement and scenario. The scenario is a label of the run, or else the name of the log.
    Every change of a verdict is reported. Longer latencies and smaller margins are reported if
    they are statistically significant. The page shows titles and time limits of the
    requirements, if they are there.

    Exit status: 0 no new violation and no regression, 1 a new violation or a regression, 3 a
    known result has become unknown, or nothing can be compared, 2 bad usage or bad input.

    Example: fretc trends nights/*.json --html build/trends.html
    """
    from fretc.audit.store.anywhere import required_source
    from fretc.audit.store.container import StoreError
    from fretc.trends.trends import trends as trends_of

    if html is not None:
        protect([Path(html)], evidence)
    sources = [required_source(path) for path in dict.fromkeys(evidence)]
    wrong = [each for each in sources if isinstance(each, Diagnostic)]
    if wrong:
        fail(*wrong)
    good = [each for each in sources if not isinstance(each, Diagnostic)]
    try:
        known = trends_of(good, by, level)
    except StoreError as error:
        fail(error.diagnostic)
    if isinstance(known, Diagnostic):
        fail(known)
    if html is not None:
        from fretc.trends.page import html as page

        named, files = _known_requirements(requirements, known.sentences)
        write_outputs({Path(html): page(known, reports, named)}, [*evidence, *files])
    if output_format == "json":
        from fretc.trends.json_form import text

        click.echo(text(known), nl=False)
    else:
        from fretc.commands.trends_text import lines
        from fretc.terminal.screen import screen

        click.echo(painted(lines(known, screen())), nl=False)
    if not known.has_pairs:
        print_diagnostics([diagnostic("nothing_to_compare")])
    worse = EXIT_VIOLATION if known.is_worse else None
    raise SystemExit(worse or (EXIT_OK if known.is_comparable else EXIT_INCONCLUSIVE))


def _known_requirements(
    path: str, sentences: Mapping[str, str]
) -> tuple[KnownRequirements, Sequence[str]]:
    """Titles and limits of the requirements, and the files that were read.

    The default folder may be missing.
    """
    from compiler.project.folder import load_folder
    from compiler.project.paths import companions, requirement_files
    from fretc.trends.known_requirements import NOTHING_KNOWN, known_requirements

    files = requirement_files(path)
    if isinstance(files, Diagnostic):
        if is_given("requirements"):
            fail(files)
        return NOTHING_KNOWN, ()
    project = or_fail(load_folder(path))
    return known_requirements(project, sentences), (*files, *companions(files))
