"""The commands that reproduce the report, and the hashes to compare with."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from functools import partial
from pathlib import PurePath

from compiler.files.build_id import __version__
from compiler.files.dates import source_date
from compiler.files.shell_quoting import (
    UnencodableNameError,
    check_of,
    is_sha256,
    unquotable_comment,
    word,
    words,
)
from compiler.logic.claims import PROVERS, ClaimResult, Layer
from compiler.project.project import Project
from fretc.analysis.evidence import AnalyzedSet
from fretc.attestation.signatures import SIGNERS
from fretc.audit.evidence.verdict_inputs import of_all, of_bindings
from fretc.audit.measurements.confidence_intervals import CONFIDENCE
from fretc.logs.storage.log_names import LOGS, STDIN, TABLES, name_of, path_of, shell_word
from fretc.report.model import phrases
from fretc.report.model.assessments import Inputs
from fretc.report.model.views import Command, Hash, RequirementView
from fretc.report.sections.runs import AuditedFile, places
from fretc.verification.reader import Proofs


def commands(
    inputs: Inputs, sections: Sequence[RequirementView], runs: Sequence[AuditedFile]
) -> tuple[Command, ...]:
    """The commands, in the order in which a reader runs them.

    Names come from evidence, which is untrusted. Each name is quoted; a command with a
    name that cannot be quoted is replaced by a comment.
    """
    proofs, together = inputs.verification, inputs.together
    return (
        Command("Check the version of the tool", f"fretc --version   # fretc {__version__}"),
        *_command("Check that the logs are the audited ones", lambda: _check(runs)),
        *_command("Audit the runs", lambda: _audit(inputs, runs)),
        *_emissions(sections),
        *(_command("Verify the requirements", lambda: _verify(inputs, proofs)) if proofs else ()),
        *(
            _command("Analyze the requirements together", lambda: _analyze(inputs, together))
            if together
            else ()
        ),
        *(
            command
            for result in inputs.named.ajpf
            for command in _command("Verify an agent by AJPF", partial(_ajpf, result))
        ),
        *_command(_report_purpose(inputs), lambda: _report(inputs)),
    )


def _audit(inputs: Inputs, runs: Sequence[AuditedFile]) -> str:
    """The audit; if the logs were selected among others, the reader has to name all of these."""
    estimations = inputs.evidence.probabilities if inputs.evidence else ()
    confidence = next((estimation.confidence for estimation in estimations), CONFIDENCE)
    selection = inputs.evidence.selection if inputs.evidence else None
    logs = " ".join(_logs(runs)) if selection is None else ""
    since = selection.since if selection else None
    options = (
        f"--confidence {confidence}" if confidence != CONFIDENCE else "",
        _integrity(runs),
        *(f"--label {shlex.quote(f'{key}={value}')}" for key, value in _labels(inputs, runs)),
        f"--since {word(since)}" if since else "",
        f"--sample {selection.audited} --seed {selection.seed or 0}"
        if selection and selection.sample_of is not None
        else "",
        f"-o {_quoted(inputs.path)}",
    )
    return _joined("fretc audit", logs or "LOG...", _options(inputs), *options)


def _integrity(runs: Sequence[AuditedFile]) -> str:
    """How thoroughly the logs were checked; a damaged log is always read as a whole."""
    if any(run.facts.log_summary for run in runs):
        return "--integrity index"
    sound = [run.facts for run in runs if run.facts.health.intact and ".mcap" in run.facts.run]
    checks = [run.health.checked for run in sound]
    whole = any(check is not None and check.chunks and not check.by_index for check in checks)
    return "--integrity full" if whole else ""


def _labels(inputs: Inputs, runs: Sequence[AuditedFile]) -> list[tuple[str, str]]:
    """The labels that all runs share and that the bindings do not give: those of `--label`.

    Raises:
        UnencodableNameError: a label has a line break, or an invisible character.
    """
    declared = inputs.project.declarations.labels if inputs.project.declarations else {}
    labels = [{*run.facts.labels.items()} for run in runs]
    shared = sorted(set[tuple[str, str]].intersection(*labels)) if labels else []
    found = [(key, text) for key, text in shared if key not in declared]
    for key, text in found:
        word(f"{key}={text}")
    return found


def _verify(inputs: Inputs, proofs: Proofs) -> str:
    """The proofs, of the same layers and requirements.

    `--layer` turns `not applicable` into `not checked`: a file with such a claim was made without.
    """
    claims = proofs.document.evidence
    chosen = all(claim.result is not ClaimResult.NOT_APPLICABLE for claim in claims)
    layers = dict.fromkeys(claim.layer for claim in claims) if chosen else {}
    engines = {word for claim in claims for word in claim.engine.replace(",", " ").split()}
    return _joined(
        "fretc verify",
        _subject(inputs, {claim.requirement for claim in claims}),
        *(f"--layer {layer}" for layer in layers if layer != Layer.AGENT),
        *(f"--with {prover}" for prover in PROVERS if prover in engines),
        "--agent AGENT --properties PROPERTIES" if Layer.AGENT in layers else "",
        f"-o {_quoted(proofs.file)}",
    )


def _analyze(inputs: Inputs, together: AnalyzedSet) -> str:
    """The analysis, of the same requirements."""
    document = together.document
    return _joined(
        "fretc analyze",
        _subject(inputs, {*document.requirements}),
        "--as-fret" if document.as_fret else "",
        f"-o {_quoted(together.file)}",
    )


def _subject(inputs: Inputs, ids: Collection[str]) -> str:
    """The options for all requirements, or the files of those that a file is about."""
    entries = [entry for entry in inputs.project.requirements if entry.is_in_force]
    some = [entry for entry in entries if entry.id in ids]
    if not some or len(some) == len(entries):
        return _options(inputs)
    files = dict.fromkeys(phrases.place(entry.wording.source.name) for entry in some)
    return _joined(words(files), _bindings(inputs.project))


def _ajpf(result: str) -> str:
    return f"python3 {_quoted(str(PurePath(result).with_name('run.py')))}"


def _report_purpose(inputs: Inputs) -> str:
    """Names the day from which on the report is another one, because a waiver expires."""
    last = min((waiver.expires for waiver in inputs.waivers.values()), default="")
    return (
        f"Generate this report (until {last}: then a waiver expires)"
        if last
        else ("Generate this report")
    )


def _report(inputs: Inputs) -> str:
    named, proofs, together = inputs.named, inputs.verification, inputs.together
    files = (
        ("hazards", named.hazards, "hazards.toml"),
        ("verification", proofs.file if proofs else None, ""),
        ("analysis", together.file if together else None, ""),
        ("lock", named.lock, "fretc.lock"),
        ("waivers", named.waivers, "waivers.toml"),
        ("signers", named.signers, SIGNERS),
    )
    options = [
        f"--{name} {_quoted(path)}"
        for name, path, default in files
        if path is not None and not _is_beside(path, default, inputs.project)
    ]
    results = [f"--ajpf {_quoted(path)}" for path in named.ajpf]
    play = "--play" if named.play else ""
    epoch = source_date()
    when = f"SOURCE_DATE_EPOCH={int(epoch.timestamp())} " if epoch else ""
    evidence = f"--evidence {_quoted(inputs.path)}"
    return _joined(f"{when}fretc report", _options(inputs), evidence, *options, *results, play)


def _is_beside(path: str, name: str, project: Project) -> bool:
    """Whether a file is the one that `fretc report` finds beside the requirements."""
    first = next((entry.wording.source.name for entry in project.requirements), None)
    return bool(name) and first is not None and PurePath(path) == PurePath(first).parent / name


def _joined(*parts: str) -> str:
    return " ".join(filter(None, parts))


def _command(purpose: str, text: Callable[[], str]) -> Iterator[Command]:
    """The command, or nothing if its text is empty."""
    try:
        command = text()
    except UnencodableNameError as error:
        command = unquotable_comment(str(error))
    if command:
        yield Command(purpose, command)


def _logs(runs: Sequence[AuditedFile]) -> Iterator[str]:
    """The path of each run, as in `places`."""
    for run, place in places([run.facts.run for run in runs]).items():
        yield STDIN if run == name_of(STDIN) else shell_word(path_of(place))


def _quoted(path: str) -> str:
    return word(phrases.place(path))


def _options(inputs: Inputs) -> str:
    folder = inputs.named.requirements or folder_of(inputs.project)
    return _joined(f"--requirements {_quoted(folder)}", _bindings(inputs.project))


def _bindings(project: Project) -> str:
    """The option for bindings that are not beside the requirements."""
    bindings = project.declarations.source.name if project.declarations else ""
    if not bindings or _folder(bindings) == folder_of(project):
        return ""
    return f"--bindings {_quoted(bindings)}"


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
    shown = places([fact.run for fact in facts])
    return check_of((fact.log, path_of(shown[fact.run])) for fact in facts)


def _is_file(run: str) -> bool:
    """Whether `sha256sum` can read the run: it is not a folder, a URL or standard input."""
    return PurePath(run).suffix in (*LOGS, *TABLES) and "://" not in run


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
    if inputs.evidence is not None:
        name, content = phrases.place(inputs.evidence.file), inputs.evidence.sha256
        lines.append(Hash("evidence", name, content))
    lines.extend(
        Hash(kind, phrases.place(file.file), file.sha256)
        for kind, file in (
            ("verification", inputs.verification),
            ("analysis", inputs.together),
            ("signers", inputs.book.signers),
        )
        if file is not None
    )
    shown = places([run.facts.run for run in runs])
    lines.extend(Hash("run", shown[run.facts.run], run.facts.log) for run in runs)
    return tuple(line for line in lines if is_sha256(line.sha256))
