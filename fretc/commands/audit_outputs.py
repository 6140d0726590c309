"""Outputs of an audit: the place of its evidence, and other formats of its results."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Protocol

from compiler.files.records import plain
from compiler.files.templating import to_json
from compiler.project.project import Project
from fretc.audit.evidence.declared_units import without_samples
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.schema import SCHEMA, Result
from fretc.terminal.output import EVIDENCE, STORE, fail, not_written, print_status
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

_BATCH = 256
"""Number of results that are read at once."""


class CommandOutcome(Protocol):
    """Result of an audit, in memory or in a store."""

    @property
    def source(self) -> EvidenceSource:
        """The results."""

    @property
    def estimates(self) -> Sequence[Estimated]:
        """Estimates of the requirements with a probability, over all runs."""

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Diagnostics of the logs."""

    @property
    def read(self) -> int:
        """Number of logs that could be read."""


@dataclass(frozen=True, slots=True)
class EvidencePath:
    """Output path of the evidence."""

    path: Path
    is_store: bool
    other: Path | None = None
    """Default path of the other kind, where an earlier audit may have written evidence."""

    @property
    def is_printed(self) -> bool:
        """Whether the evidence is printed to standard output."""
        return str(self.path) == "-"


def target(output: str | None, logs: int) -> EvidencePath:
    """The output path: by default a file for one log and a store for several."""
    if output is None:
        places = (EVIDENCE, STORE) if logs == 1 else (STORE, EVIDENCE)
        path, other = map(Path, places)
        return EvidencePath(path, is_store=logs > 1, other=other)
    return EvidencePath(Path(output), is_store=output != "-" and not output.endswith(".json"))


def check(target: EvidencePath, parquet: str | None) -> None:
    """Check that the outputs can be written, before the audit starts."""
    path = target.path
    if parquet is not None:
        _check_table(parquet, path)
    if target.is_printed or not os.path.lexists(path):
        return
    if not target.is_store:
        if path.exists() and not path.is_file():
            fail(not_written(str(path), "it is not a regular file"))
        return
    if not path.is_dir():
        fail(diagnostic("store_is_file", path=path))
    from fretc.audit.store.writer import is_store

    if any(path.iterdir()) and not is_store(path):
        fail(diagnostic("store_folder_in_use", path=path))


def _check_table(parquet: str, evidence: Path) -> None:
    from fretc.audit.outputs.table import no_parquet

    absent = no_parquet()
    if absent is not None:
        fail(absent)
    if parquet == "-":
        fail(not_written(parquet, "a Parquet table cannot be printed"))
    if os.path.exists(parquet) and not os.path.isfile(parquet):
        fail(not_written(parquet, "it is not a regular file"))
    if os.path.realpath(parquet) == os.path.realpath(evidence):
        fail(not_written(parquet, "two outputs would go there"))


def table(outcome: CommandOutcome) -> bytes:
    """The content of a Parquet file with a row for each result."""
    from fretc.audit.outputs import table as tables

    return tables.parquet(tables.rows(outcome.source))


def remove_other(target: EvidencePath) -> None:
    """Remove evidence of an earlier audit at the other default path."""
    other = target.other
    if other is None:
        return
    if other.is_dir() and not other.is_symlink():
        from fretc.audit.store.writer import is_store, remove

        if is_store(other):
            remove(other)
            print_status(f"removed {other}, the evidence of an earlier audit")
    elif other.is_file() and not other.is_symlink() and _is_evidence(other):
        other.unlink()
        print_status(f"removed {other}, the evidence of an earlier audit")


def _is_evidence(path: Path) -> bool:
    with path.open("rb") as file:
        return f'"schema": "{SCHEMA}"'.encode() in file.read(200)


# Other forms -------------------------------------------------------------------------------------


def results(source: EvidenceSource) -> Iterator[Result]:
    """All results; those of a store are read in batches."""
    places = [index for index, _ in source.summaries()]
    for start in range(0, len(places), _BATCH):
        yield from (result for _, result in source.details(places[start : start + _BATCH]))


def bare(source: EvidenceSource, project: Project) -> Iterator[Result]:
    """All results in declared units, without samples."""
    for result in results(source):
        yield from without_samples([result], project.declarations)


def annotation_files(
    outcome: CommandOutcome, project: Project, folder: str | None
) -> dict[Path, bytes]:
    """An annotation log for each run, and a Foxglove layout that shows them."""
    from fretc.audit.outputs.annotations import sidecars
    from fretc.audit.outputs.foxglove_layout import layout_file

    results, out = [*bare(outcome.source, project)], Path(folder or "build/annotations")
    return {
        **sidecars(results, project.formalized, out),
        **layout_file(results, project.formalized, out),
    }


def text(
    outcome: CommandOutcome, project: Project, refusals: Iterable[Diagnostic], output_format: str
) -> str:
    """The results in a format for programs."""
    from fretc.audit.outputs.github import github
    from fretc.audit.outputs.junit import junit
    from fretc.audit.outputs.sarif import AllRuns, OneRun, sarif

    if output_format == "json":
        return _json(outcome)
    results = bare(outcome.source, project)
    if output_format == "junit":
        return junit(results, outcome.estimates, project.requirements)
    if output_format == "github":
        return github(results, project.requirements, outcome.estimates)
    assert output_format == "sarif", "a choice of --format"
    diagnostics = (*project.diagnostics, *refusals, *outcome.diagnostics)
    together = [AllRuns.of(one) for one in outcome.estimates]
    each = [OneRun.of(one) for one in results]
    return sarif(each, project.formalized, diagnostics, together, project.without_rule)


def _json(outcome: CommandOutcome) -> str:
    """JSON array with an object for each run and requirement; an object with probabilities."""
    records = [plain(each) for each in results(outcome.source)]
    if not outcome.estimates:
        return f"{to_json(records)}\n"
    return f"{to_json({'results': records, 'probabilities': plain(tuple(outcome.estimates))})}\n"
