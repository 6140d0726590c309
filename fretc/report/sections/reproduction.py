"""The commands that reproduce the report, and the hashes to compare with."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from pathlib import PurePath
from typing import TYPE_CHECKING

from compiler.files.build_id import __version__
from compiler.files.shell_quoting import (
    UnencodableNameError,
    check_of,
    is_sha256,
    unquotable_comment,
    word,
    words,
)
from compiler.project.project import Project
from fretc.audit.evidence.basis import of_all, of_bindings
from fretc.audit.measurements.confidence_intervals import CONFIDENCE
from fretc.logs.storage.log_names import STDIN, name_of, path_of, shell_word
from fretc.report.model import phrases
from fretc.report.model.assessments import Inputs
from fretc.report.model.views import Command, Hash, RequirementView
from fretc.report.sections.runs import AuditedFile

if TYPE_CHECKING:
    pass


def commands(
    inputs: Inputs, sections: Sequence[RequirementView], runs: Sequence[AuditedFile]
) -> tuple[Command, ...]:
    """The commands, in the order in which a reader runs them.

    Names come from evidence, which is untrusted. Each name is quoted; a command with a
    name that cannot be quoted is replaced by a comment.
    """
    project, evidence, proofs = inputs.project, inputs.path, inputs.verification
    estimations = inputs.evidence.probabilities if inputs.evidence else ()
    confidence = next((estimation.confidence for estimation in estimations), CONFIDENCE)

    def audit() -> str:
        logs = " ".join(_log(run.facts.run) for run in runs) or "LOG..."
        level = "" if confidence == CONFIDENCE else f" --confidence {confidence}"
        return f"fretc audit {logs} {_options(project)}{level} -o {_quoted(evidence)}"

    def report() -> str:
        verification = f" --verification {_quoted(proofs.file)}" if proofs else ""
        return f"fretc report {_options(project)} --evidence {_quoted(evidence)}{verification}"

    return (
        Command("Check the version of the tool", f"fretc --version   # fretc {__version__}"),
        *_command("Check that the logs are the audited ones", lambda: _check(runs)),
        *_command("Audit the runs", audit),
        *_emissions(sections),
        *_command("Generate this report", report),
    )


def _command(purpose: str, text: Callable[[], str]) -> Iterator[Command]:
    """The command, or nothing if its text is empty."""
    try:
        command = text()
    except UnencodableNameError as error:
        command = unquotable_comment(str(error))
    if command:
        yield Command(purpose, command)


def _log(run: str) -> str:
    """The path of a run; only the last part of an absolute path."""
    return STDIN if run == name_of(STDIN) else shell_word(path_of(phrases.place(run)))


def _quoted(path: str) -> str:
    return word(phrases.place(path))


def _options(project: Project) -> str:
    folder = folder_of(project)
    options = [f"--requirements {word(folder)}"]
    bindings = project.declarations.source.name if project.declarations else ""
    if bindings and _folder(bindings) != folder:
        options.append(f"--bindings {_quoted(bindings)}")
    return " ".join(options)


def folder_of(project: Project) -> str:
    """The folder of the requirements, by its first file."""
    first = next((r.wording.source.name for r in project.requirements), None)
    return "requirements" if first is None else _folder(first)


def _folder(path: str) -> str:
    """The folder of a file; only the name of the folder if the path is absolute."""
    folder = PurePath(path).parent
    return str(folder) if phrases.place(path) == path else folder.name or str(folder)


def _check(runs: Sequence[AuditedFile]) -> str:
    facts = [run.facts for run in runs if run.facts.log and _is_file(run.facts.run)]
    return check_of((fact.log, phrases.place(path_of(fact.run))) for fact in facts)


def _is_file(run: str) -> bool:
    """Whether `sha256sum` can read the run: it is not a folder, a URL or standard input."""
    return PurePath(run).suffix in (".mcap", ".bag", ".db3") and "://" not in run


def _emissions(sections: Sequence[RequirementView]) -> Iterable[Command]:
    """A command for each set of targets, with all files that have it."""
    targets: dict[str, list[str]] = {}
    for section in sections:
        file = section.source.rpartition(":")[0]
        allowed = [a.target for a in section.artefacts if not a.refusal]
        before = targets.get(file, allowed)
        targets[file] = [target for target in before if target in allowed]
    groups: dict[tuple[str, ...], list[str]] = {}
    for file, names in targets.items():
        groups.setdefault(tuple(dict.fromkeys(names)), []).append(file)
    for kinds, files in groups.items():
        if kinds:
            emits = " ".join(f"--emit {kind}" for kind in kinds)
            yield from _command("Generate the artefacts", partial(_emission, files, emits))


def _emission(files: Sequence[str], emits: str) -> str:
    return f"fretc {words(files)} {emits} --output build"


def _of_bindings(project: Project) -> str:
    """SHA-256 of the bindings that requirements in force read, as in the evidence."""
    requirements = {requirement.entry: requirement for requirement in project.formalized}
    return of_all(
        {
            requirement.id: of_bindings(requirements.get(requirement), project.declarations)
            for requirement in project.requirements
            if requirement.is_in_force
        }
    )


def manifest(
    inputs: Inputs, sections: Sequence[RequirementView], runs: Sequence[AuditedFile]
) -> tuple[Hash, ...]:
    """The hashes of all inputs of the report."""
    project = inputs.project
    bindings = project.declarations
    lines = [Hash("sentence", section.id, section.fingerprint) for section in sections]
    if bindings is not None:
        lines.append(Hash("bindings", phrases.place(bindings.source.name), _of_bindings(project)))
    lines.extend(
        Hash(artefact.target, artefact.file, artefact.sha256)
        for section in sections
        for artefact in section.artefacts
    )
    lines.extend(
        Hash(kind, phrases.place(file.file), file.sha256)
        for kind, file in (
            ("evidence", inputs.evidence),
            ("verification", inputs.verification),
            ("analysis", inputs.together),
            ("signers", inputs.book.signers),
        )
        if file is not None
    )
    lines.extend(Hash("run", phrases.place(run.facts.run), run.facts.log) for run in runs)
    return tuple(line for line in lines if is_sha256(line.sha256))
