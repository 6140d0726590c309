"""`fretc coverage`: which situations recorded runs have exercised.

`fretc.audit` reads the logs, `fretc.coverage` counts; this module reads the options and prints.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import click

from fretc.commands.opening import planned_project
from fretc.terminal.options import (
    LOG_EXTRAS,
    PATH,
    bindings_option,
    evidence_option,
    evidence_path,
    extras,
    format_option,
    is_given,
    jobs_option,
    requirements_option,
    tests_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    coloured,
    fail,
    or_fail,
    print_diagnostics_below,
    print_status,
)
from fretish.diagnostics.diagnostic import has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import visible

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from fretc.audit.evidence.result_summaries import EvidenceSource
    from fretc.coverage.coverage import Coverage
    from fretc.coverage.directions import Directions
    from fretc.testing.suite import Suite


@click.command(
    epilog=extras(LOG_EXTRAS),
)
@click.argument("paths", nargs=-1, type=PATH, metavar="[LOG]...")
@requirements_option
@bindings_option
@evidence_option
@format_option()
@click.option(
    "-v", "--verbose", is_flag=True, help="Also list the situations that were seen, and all runs."
)
@tests_option
@jobs_option
def coverage(
    paths: tuple[str, ...],
    requirements: str,
    bindings: str | None,
    evidence: str | None,
    output_format: str,
    verbose: bool,
    tests: str | None,
    jobs: int,
) -> None:
    """Show which situations of each requirement recorded runs have exercised, and which never.

    LOG is a log, folder, pattern or URL, as for `fretc audit`. Without LOG, the evidence of an
    audit is used. A situation is one way in which a run can exercise a requirement: it is
    triggered again while a response is pending, it is answered at the last possible tick, and
    others (docs/coverage.md).

    Exit status: 0 every possible situation was seen, 2 bad usage or bad input, 3 some were not
    seen.

    Example: fretc coverage runs/ --requirements requirements/mission
    """
    from fretc.audit.store.anywhere import required_source
    from fretc.coverage import record, text_output
    from fretc.coverage.coverage import coverage as found_in
    from fretc.coverage.directions import is_complete

    if paths and is_given("evidence"):
        fail(diagnostic("logs_and_evidence"))
    if paths:
        source, titles, is_bad = _audited(paths, requirements, bindings, jobs)
    else:
        source, titles, is_bad = or_fail(required_source(evidence_path(evidence))), {}, False
    covered = found_in(source)
    known = _directions(covered, tests)
    if output_format == "json":
        click.echo(record.text(covered, known), nl=False)
    else:
        found = text_output.lines(covered, titles, known, every=verbose)
        click.echo(coloured((visible(text), colour) for text, colour in found), nl=False)
    if is_bad:
        raise SystemExit(EXIT_USAGE)
    raise SystemExit(EXIT_OK if is_complete(covered, known) else EXIT_INCONCLUSIVE)


def _directions(covered: Coverage, named: str | None) -> Directions:
    """The verdicts with which tests reach situations; tests for other sentences are ignored."""
    from fretc.coverage.directions import directions

    fingerprints = {requirement.id: requirement.fingerprint for requirement in covered.requirements}
    suite = suite_of(named, fingerprints)
    return {} if suite is None else directions(suite, fingerprints)


def suite_of(named: str | None, fingerprints: Mapping[str, str]) -> Suite | None:
    """The test suite of the user, or the default one if it exists; None: there is none.

    Args:
        named: path of the suite; None: the default path of `fretc test`.
        fingerprints: fingerprint of each requirement, to detect outdated tests.
    """
    from fretc.testing.reader import DEFAULT, read

    if named is None and not os.path.lexists(DEFAULT):
        return None
    suite = or_fail(read(named or DEFAULT))
    known = {requirement.id: requirement.fingerprint for requirement in suite.requirements}
    other = [id for id, own in fingerprints.items() if known.get(id, own) != own]
    if other:
        which = ", ".join(other)
        print_status(
            visible(
                f"the tests were generated for earlier sentences of {which}: run `fretc test` again"
            )
        )
    return suite


def _audited(
    paths: Sequence[str], requirements: str, bindings: str | None, jobs: int
) -> tuple[EvidenceSource, dict[str, str], bool]:
    """The audit of some logs, the titles of requirements, and whether some input was bad.

    No file is written.
    """
    from fretc.audit.many_logs import local_executor
    from fretc.commands.audit_logs import audit_in_memory, selected

    project, plan = planned_project(requirements, bindings)
    logs, _ = selected(paths)
    audit = audit_in_memory(plan, logs, local_executor(jobs))
    diagnostics = project.answered(audit.diagnostics)
    print_diagnostics_below(diagnostics, project.diagnostics)
    if not audit.read:
        raise SystemExit(EXIT_USAGE)
    titles = {requirement.id: requirement.name for requirement in project.requirements}
    return audit.source, titles, has_errors(diagnostics)
