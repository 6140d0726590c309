"""`fretc mutate`: which mutants of requirements recorded runs would not detect.

`fretc.coverage` computes the result; this module reads the options and prints.
"""

from __future__ import annotations

import click

from fretc.commands.opening import planned_project
from fretc.terminal.options import (
    LOG_EXTRAS,
    PATH,
    bindings_option,
    extras,
    format_option,
    jobs_option,
    places,
    requirements_option,
    tests_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_USAGE,
    coloured,
    print_diagnostics_below,
    print_status,
)
from fretish.diagnostics.rendering import visible


@click.command(
    epilog=extras(LOG_EXTRAS),
)
@click.argument("folder", required=False, type=PATH, metavar="[FOLDER]")
@click.option(
    "--against",
    "paths",
    multiple=True,
    required=True,
    type=PATH,
    metavar="LOG",
    help="A log, folder, pattern or URL, as for `fretc audit`. Repeatable.",
)
@requirements_option
@bindings_option
@format_option()
@click.option(
    "-v", "--verbose", is_flag=True, help="Also list the mutants that were detected, and how."
)
@tests_option
@jobs_option
def mutate(
    folder: str | None,
    paths: tuple[str, ...],
    requirements: str,
    bindings: str | None,
    output_format: str,
    verbose: bool,
    tests: str | None,
    jobs: int,
) -> None:
    """Show which wrong requirements the recorded runs would not have detected.

    FOLDER is a folder of requirement files, or one file; it replaces `--requirements`. Each
    requirement is changed in small ways (mutants, docs/coverage.md). A run detects a mutant if
    its verdict or the ticks of a violation differ from those of the requirement. Mutants that
    `--tests` prove equivalent are left out.

    Exit status: 0 every mutant is detected, 2 bad usage or bad input, 3 some are not detected.

    Example: fretc mutate --against runs/
    """
    from fretc.commands.audit_logs import selected, shown
    from fretc.commands.coverage import suite_of
    from fretc.coverage import mutation_output, mutation_record
    from fretc.coverage.mutation import mutation_job, survey

    (project_folder,) = places([folder] if folder else [], requirements)
    project, plan = planned_project(project_folder, bindings)
    logs, _ = selected(paths)
    asked = mutation_job(project, plan)
    try:
        with shown(logs) as show:
            found = survey(asked, logs, jobs, show)
    except KeyboardInterrupt:
        print_status("stopped")
        raise SystemExit(EXIT_INTERRUPTED) from None
    print_diagnostics_below(found.diagnostics, project.diagnostics)
    if not found.runs:
        raise SystemExit(EXIT_USAGE)
    suite = suite_of(tests, {each.id: each.fingerprint for each in found.batches})
    if suite is not None:
        found = found.with_proofs(suite)
    if output_format == "json":
        click.echo(mutation_record.text(found), nl=False)
    else:
        titles = {requirement.id: requirement.name for requirement in project.requirements}
        all_lines = mutation_output.lines(found, titles, every=verbose)
        click.echo(coloured((visible(text), colour) for text, colour in all_lines), nl=False)
    if plan.refused or found.diagnostics:
        raise SystemExit(EXIT_USAGE)
    raise SystemExit(EXIT_OK if found.is_complete else EXIT_INCONCLUSIVE)
