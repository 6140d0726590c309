"""`fretc report`: the traceability report, in all formats."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from fretc.report.forms.forms import FORMS, Form, FormInput
from fretc.terminal.group import CommandWithHeadings
from fretc.terminal.options import (
    analysis_option,
    bindings_option,
    evidence_option,
    evidence_path,
    extras,
    hazards_option,
    is_given,
    output_option,
    path_option,
    requirements_option,
    verification_option,
)
from fretc.terminal.output import (
    EXIT_INCONCLUSIVE,
    EXIT_OK,
    EXIT_USAGE,
    EXIT_VIOLATION,
    fail,
    not_written,
    or_fail,
    print_project_diagnostics,
    write_outputs,
)
from fretish.diagnostics.diagnostic import Severity, has_errors

if TYPE_CHECKING:
    from compiler.project.project import Project
    from fretc.audit.evidence.result_summaries import EvidenceSource
    from fretc.report.model.views import ReportView
    from fretc.report.page.html import Inset

_HEADINGS = {
    "Input": (
        "requirements",
        "bindings",
        "hazards",
        "evidence",
        "verification",
        "analysis",
        "lock",
        "waivers",
        "signers",
    ),
    "Output: one format with --format and -o, or one file for each format": (
        "output_format",
        "output",
        *FORMS,
    ),
}


def _forms(command: Callable[..., None]) -> Callable[..., None]:
    """Output option of each format."""
    for report_format in FORMS.values():
        shown = report_format.default is not None
        option = path_option(
            f"--{report_format.name}",
            default=report_format.default,
            show_default=shown,
            help=report_format.help,
        )
        command = option(command)
    return command


@click.command(
    cls=CommandWithHeadings,
    headings=_HEADINGS,
    epilog=extras({"reqif": "--reqif", "sign": "what is signed"}),
)
@click.option(
    "--format",
    "output_format",
    type=click.Choice([*FORMS]),
    help="Format that is printed, or written to the file of `-o`; html if only `-o` is given.",
)
@output_option(help="File for `--format`. `-` prints.")
@_forms
@requirements_option
@bindings_option
@hazards_option
@evidence_option
@verification_option
@analysis_option
@path_option(
    "--ajpf",
    multiple=True,
    help="Result of AJPF. Repeatable.  [default: every build/*_ajpf/result.json]",
)
@path_option("--lock", help="Lock with the reviews.  [default: fretc.lock beside the requirements]")
@path_option("--waivers", help="Waivers file.  [default: waivers.toml beside the requirements]")
@path_option(
    "--signers",
    help="List of trusted public keys.  [default: allowed_signers beside the requirements]",
)
@click.option(
    "--play",
    is_flag=True,
    help="Include the page of `fretc play` in the HTML page.",
)
@click.option("--open", "opens", is_flag=True, help="Open the HTML page in a browser.")
@click.option(
    "--strict",
    is_flag=True,
    help="Set the exit status from the report: 1 violated or suspect, 3 a requirement is not "
    "shown to be satisfied.",
)
def report(
    requirements: str,
    bindings: str | None,
    hazards: str | None,
    evidence: str | None,
    verification: str | None,
    analysis: str | None,
    ajpf: tuple[str, ...],
    lock: str | None,
    waivers: str | None,
    signers: str | None,
    play: bool,
    opens: bool,
    strict: bool,
    output_format: str | None,
    output: str | None,
    **places: str | None,
) -> None:
    """Trace hazard, requirement, formula, artefact, run and verdict in one HTML file.

    All formats have the same content. The same inputs give the same bytes. If SOURCE_DATE_EPOCH
    is set, its day decides whether a waiver has expired.

    Example: fretc report --html build/report.html --junit build/report.xml
    """
    from compiler.project.folder import load_folder
    from compiler.project.paths import companions, requirement_files, sibling_path
    from fretc.analysis.evidence import default_path as analyzed
    from fretc.attestation.signatures import SIGNERS
    from fretc.audit.evidence.reader import not_audited
    from fretc.report.make import make
    from fretc.verification.reader import ajpf_results, default_path

    outputs = _outputs(output_format, output, places)
    for kind, _ in outputs:
        absent = kind.missing()
        if absent is not None:
            fail(absent)
    evidence = evidence_path(evidence)
    if is_given("evidence") and not os.path.lexists(evidence):
        fail(replace(not_audited(evidence), severity=Severity.ERROR))
    files = or_fail(requirement_files(requirements))
    project = or_fail(load_folder(requirements, bindings, hazards))
    lock = lock or sibling_path(requirements, "fretc.lock")
    waivers = waivers or sibling_path(requirements, "waivers.toml")
    signers = signers or sibling_path(requirements, SIGNERS)
    verification = verification or default_path()
    analysis = analysis or analyzed()
    results = ajpf or ajpf_results()
    outcome = make(
        project,
        evidence,
        lock=lock,
        waivers=waivers,
        verification=verification,
        ajpf=results,
        signers=signers,
        analysis=analysis,
        requirements=requirements,
        hazards=hazards,
        play=play,
    )
    print_project_diagnostics([*project.diagnostics, *outcome.diagnostics], requirements)
    if outcome.report is None or outcome.details is None:
        raise SystemExit(EXIT_USAGE)
    inset = _inset(project, outcome.details.evidence, analysis) if play else None
    subject = FormInput(outcome.report, project, outcome.details, outcome.diagnostics, inset)
    others = (bindings, hazards, verification, analysis, lock, waivers, signers)
    inputs = filter(None, (*others, *results))
    read = [evidence, *files, *companions(files), *inputs, *outcome.details.logs]
    _deliver(outputs, subject, read)
    if opens:
        for path in [path for kind, path in outputs if kind.name == "html" and path != "-"]:
            click.launch(path)
    if has_errors([*project.diagnostics, *outcome.diagnostics]):
        raise SystemExit(EXIT_USAGE)
    raise SystemExit(_status(outcome.report) if strict else EXIT_OK)


def _inset(project: Project, evidence: EvidenceSource | None, analysis: str | None) -> Inset | None:
    """The embedded page of `fretc play`; None: no requirement can be on it."""
    from compiler.formalization.formalize import name_collisions
    from fretc.audit.plan import Plan, planned
    from fretc.commands.play import of_files
    from fretc.play.page import inset
    from fretc.play.recorded import Recorded, of_evidence
    from fretc.play.starts import of_examples
    from fretc.play.versions import side

    refusals, project = project.refused, project.sound
    mistaken = {refusal.requirement.id for refusal in refusals}
    sound = [each for each in project.formalized if each.id not in mistaken]
    shown, _ = side(sound, refusals, None)
    known = shown.requirements
    if not known or [*name_collisions(known)]:
        return None
    plan = planned(project)
    recorded = Recorded((), ())
    if evidence is not None and isinstance(plan, Plan):
        recorded = of_evidence(known, plan, evidence)
    starts = [
        *recorded.starts,
        *of_examples(known),
        *of_files(project.formalized, known, None, analysis),
    ]
    return inset(known, [*shown.refused.items()], starts, notes=recorded.notes)


def _outputs(
    output_format: str | None, output: str | None, places: Mapping[str, str | None]
) -> list[tuple[Form, str]]:
    """Each requested format and its path; the default path if none is requested."""
    named = [(kind, path) for name, kind in FORMS.items() if (path := places[name]) is not None]
    if output_format is None and output is None:
        return named
    chosen = [(kind, path) for kind, path in named if is_given(kind.name)]
    return [(FORMS[output_format or "html"], output or "-"), *chosen]


def _deliver(
    outputs: Sequence[tuple[Form, str]], subject: FormInput, inputs: Sequence[str]
) -> None:
    """Write each format to its path."""
    paths: dict[Path, str | Iterable[str]] = {}
    for report_format, path in outputs:
        if Path(path) in paths:
            fail(not_written(path, "two outputs would go there"))
        paths[Path(path)] = report_format.text(subject)
    write_outputs(paths, inputs)


def _status(whole: ReportView) -> int:
    from fretc.audit.evidence.verdicts import BROKEN, RETIRED, WAIVED
    from fretc.report.sections.proofs import is_refuted

    marks = {view.mark for view in whole.requirements}
    if any(mark.word in BROKEN or mark.suspect for mark in marks) or any(
        map(is_refuted, whole.requirements)
    ):
        return EXIT_VIOLATION
    together = whole.analysis
    if whole.withdrawn or (together and (together.is_broken or together.mark.suspect)):
        return EXIT_VIOLATION
    in_force = [mark for mark in marks if mark.word != RETIRED]
    shown = all(mark.shows or mark.word == WAIVED for mark in in_force)
    shown = shown and (together is None or together.is_good)
    return EXIT_OK if in_force and shown else EXIT_INCONCLUSIVE
