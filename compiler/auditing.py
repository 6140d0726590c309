"""From a project and logs to verdicts: compile the monitors, read each log, run them over it."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from compiler import __version__
from compiler.constancy import never_changed, tallies_of
from compiler.files import sha256
from compiler.missing import demand
from compiler.pipeline import unbound
from compiler.project import Project, fingerprint
from compiler.record import wording
from compiler.rule import Rule
from compiler.targets import monitor as monitors
from compiler.templating import to_json
from compiler.workers import each
from fretish.declarations import Declarations
from fretish.diagnostic import Code, Diagnostic
from monitors import kernel
from monitors.audit import Engine, Watched, audit, examined, signals_of
from monitors.evidence import SCHEMA, as_record, unread
from monitors.inputs import STDIN, shown
from monitors.loading import load
from monitors.recordings import read

GLYPHS: Mapping[str, tuple[str, str]] = {
    kernel.SATISFIED: ("✔", "green"),
    kernel.VIOLATED: ("✘", "red"),
    kernel.INCONCLUSIVE: ("◔", "yellow"),
    kernel.VACUOUS: ("∅", "bright_black"),
    kernel.NO_DATA: ("?", "magenta"),
}
"""Verdict → its sign and its colour."""


@dataclass(frozen=True, slots=True)
class Audit:
    """What an audit has shown: one result for each run and requirement, runs in their order."""

    results: tuple[Mapping[str, Any], ...]
    evidence: str
    """The text of the evidence file."""
    diagnostics: tuple[Diagnostic, ...]
    read: int = 0
    """How many of the logs could be read."""

    @property
    def violated(self) -> bool:
        """Whether any requirement is violated in any run."""
        return any(result["verdict"] == kernel.VIOLATED for result in self.results)

    @property
    def shown(self) -> bool:
        """Whether every requirement is satisfied in every run."""
        return all(result["verdict"] == kernel.SATISFIED for result in self.results)

    @property
    def as_json(self) -> str:
        """One JSON array, an object per run and requirement."""
        return f"{json.dumps(list(self.results), indent=2, allow_nan=False)}\n"

    @property
    def text(self) -> tuple[tuple[str, str | None], ...]:
        """Lines for a person, each with its colour."""
        lines: list[tuple[str, str | None]] = []
        width = max((len(result["requirement"]) for result in self.results), default=0)
        run = None
        for result in self.results:
            if result["run"] != run:
                run = result["run"]
                lines.append((str(run), None))
            glyph, colour = GLYPHS[result["verdict"]]
            name = f"{result['requirement']:<{width}}"
            lines.append((f"  {glyph} {name}  {result['verdict']:<12}  {result['reason']}", colour))
        return tuple(lines)


ENGINES: Mapping[str, Engine] = {"columns": kernel.evaluate, "online": kernel.stepped}
"""How monitors are run: whole traces at once, or step by step."""


def audit_logs(
    project: Project,
    logs: Sequence[str],
    engine: str = "columns",
    jobs: int = 1,
    tell: Callable[[], None] = lambda: None,
) -> Audit:
    """Audit every log against every requirement that is not retired.

    Args:
        project: read without errors.
        logs: files, folders of rosbag2, URLs, or `-` for standard input.
        engine: one of `ENGINES`; the results are the same.
        jobs: how many processes share the logs; the results are the same.
        tell: is called after each log.
    """
    rules = [rule for rule in project.rules if rule.requirement.status != "retired"]
    declarations = project.declarations
    wrong = _not_auditable(rules, declarations)
    if wrong or declarations is None:
        return Audit((), "", tuple(wrong))
    bindings = fingerprint(declarations)
    watched = [_watched(rule, bindings) for rule in rules]
    results: list[Mapping[str, Any]] = []
    said: list[Diagnostic] = []
    read = 0
    work = partial(_audit_log, declarations=declarations, watched=watched, engine=ENGINES[engine])
    if STDIN in logs:  # another process would not have it
        jobs = 1
    for found, told, could_be_read in each(work, tuple(dict.fromkeys(logs)), jobs):
        tell()
        results.extend(found)
        said.extend(told)
        read += could_be_read
    said.extend(never_changed(tallies_of(results), declarations))
    return Audit(
        tuple(results),
        _evidence(rules, declarations.source.name, bindings, results),
        tuple(said),
        read,
    )


def _not_auditable(rules: Sequence[Rule], declarations: Declarations | None) -> list[Diagnostic]:
    if not rules:
        return [Diagnostic(Code.NOTHING_TO_DO, "there is no requirement to audit")]
    if declarations is None:
        return [
            Diagnostic(
                Code.UNBOUND,
                "no bindings say what the propositions mean in the messages",
                rules[0].requirement.wording,
                help="write `bindings.toml` beside the requirements, or name it with `--bindings`",
            )
        ]
    if not declarations.clock.declared:
        return [
            Diagnostic(
                Code.NO_CLOCK,
                f"`{declarations.source.name}` declares no clock",
                declarations.source.span(0, 0),
                help='add `[clock]` with `tick = "100 ms"`',
            )
        ]
    refused = [monitors.refuse(rule) for rule in rules]
    missing = [diagnostic for rule in rules for diagnostic in unbound(rule, declarations)]
    return [*(diagnostic for diagnostic in refused if diagnostic), *missing]


def _watched(rule: Rule, bindings: str) -> Watched:
    text = monitors.text(rule)
    return Watched(
        load(f"{rule.id}_monitor", text),
        {
            "sentence": rule.fingerprint,
            "bindings": bindings,
            "monitor": sha256(text),
        },
        demand(rule),
    )


def _audit_log(
    log: str, declarations: Declarations, watched: Sequence[Watched], engine: Engine
) -> tuple[list[dict[str, Any]], list[Diagnostic], bool]:
    """The results of one log, what there is to say of it, and whether it could be read."""
    names = tuple(dict.fromkeys(name for w in watched for name in w.monitor.PROPOSITIONS))
    recording = read(log, declarations, signals_of(declarations, names))
    if isinstance(recording, Diagnostic):
        hashes = _hash_of(log)
        return (
            [
                unread(shown(log), w.monitor.REQUIREMENTS[0].id, recording, {**hashes, **w.hashes})
                for w in watched
            ],
            [recording],
            False,
        )
    recording = examined(recording, declarations, names)
    evidence = audit(recording, declarations, watched, engine)
    return [as_record(e) for e in evidence], list(recording.findings), True


def _hash_of(log: str) -> dict[str, str]:
    """SHA-256 of a log that could not be read as one, where its bytes can be."""
    if not Path(log).is_file():
        return {}
    try:
        with Path(log).open("rb") as file:
            return {"log": hashlib.file_digest(file, "sha256").hexdigest()}
    except OSError:
        return {}


def _evidence(
    rules: Sequence[Rule], file: str, bindings: str, results: Sequence[Mapping[str, Any]]
) -> str:
    """The evidence file: the same inputs give the same bytes."""
    content = {
        "schema": SCHEMA,
        "fretc": __version__,
        "bindings": {"file": file, "sha256": bindings},
        "requirements": [
            {"id": rule.id, "sentence": wording(rule.requirement), "sha256": rule.fingerprint}
            for rule in rules
        ],
        "results": list(results),
    }
    return f"{to_json(content)}\n"
