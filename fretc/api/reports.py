"""`make_report` and its result, the traceability report."""

from __future__ import annotations

import os
from collections.abc import Iterable

from compiler.project.paths import sibling_path
from compiler.project.project import Project
from fretc.analysis.evidence import default_path as analysis_file
from fretc.api.refusal import Refusal, bounded
from fretc.attestation.signatures import SIGNERS
from fretc.report.make import ReportBuild, make
from fretc.verification.reader import ajpf_results
from fretc.verification.reader import default_path as verification_file
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

Path = str | os.PathLike[str]


@dataclass(frozen=True, slots=True)
class Report:
    """A traceability report: hazards, requirements, formulas, artefacts, runs and verdicts."""

    _build: ReportBuild

    @property
    def html(self) -> str:
        """The report as one HTML page that works offline."""
        return self._build.html or ""

    @property
    def json(self) -> str:
        """The content of the report as JSON."""
        return self._build.json or ""

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics about evidence, proofs, reviews and waivers."""
        return self._build.diagnostics


@bounded
def make_report(
    project: Project,
    evidence: Path = "build/evidence.json",
    *,
    verification: Path | None = None,
    lock: Path | None = None,
    waivers: Path | None = None,
    signers: Path | None = None,
    ajpf: Iterable[Path] = (),
    analysis: Path | None = None,
) -> Report:
    """Make the traceability report.

    Args:
        project: the requirements with their hazards.
        evidence: the evidence file; if it does not exist, no requirement is exercised.
        verification: the file of `fretc verify`; None: `build/verification.json`, if it exists.
        lock: the reviews; None: `fretc.lock` in the folder of the requirements, if it exists.
        waivers: None: `waivers.toml` in the folder of the requirements, if it exists.
        signers: the trusted keys; None: `allowed_signers` in that folder, if it exists.
        ajpf: result files of AJPF; if empty, each `build/*_ajpf/result.json`.
        analysis: the file of `fretc analyze`; None: `build/analysis.json`, if it exists.

    Raises:
        Refusal: a file cannot be read, or there is no requirement.
    """
    if not project.requirements:
        raise Refusal((diagnostic("nothing_to_report"),))
    first = project.requirements[0].wording.source.name
    build = make(
        project,
        os.fspath(evidence),
        lock=_path(lock) or sibling_path(first, "fretc.lock"),
        waivers=_path(waivers) or sibling_path(first, "waivers.toml"),
        verification=_path(verification) or verification_file(),
        ajpf=[os.fspath(path) for path in ajpf] or ajpf_results(),
        signers=_path(signers) or sibling_path(first, SIGNERS),
        analysis=_path(analysis) or analysis_file(),
    )
    if build.report is None:
        raise Refusal(build.diagnostics)
    return Report(build)


def _path(path: Path | None) -> str | None:
    return None if path is None else os.fspath(path)
