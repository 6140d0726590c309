"""Results of AJPF, in the files that the `run.py` of a bundle writes.

The files are not trusted: a wrong shape is F616. A result counts only if it is about the present
files of fretc. Its conclusion is not read: it is derived from its checks, which must be those of
the present bundle and agree with their logs, if these are in the same folder.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path, PurePath

from compiler.files.checked_json import JsonValue, SchemaError, plain
from compiler.files.text_files import content, sha256
from compiler.files.text_files import read as read_text
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import (
    ClaimOutcome,
    ClaimResult,
    ClaimTrace,
    Layer,
    Proof,
    not_checked,
    proof,
    proved,
    refuted,
    vacuous,
)
from compiler.targets.ajpf import bundle
from compiler.targets.ajpf import properties as ajpf
from compiler.targets.ajpf.runner import ERROR, HOLDS, SCHEMA, VIOLATED, verdict
from compiler.targets.target import DEFAULT, TargetOptions
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.recursion import with_recursion_limit

_UNHASHED = ("README.md",)
"""Files of a bundle on which no verdict depends."""
_ASSUMED = (
    "the environment can show or hide every trigger at the start, at every action and whenever "
    "the agent is idle (Env.java)",
    "AJPF's answer is right for an agent that loops: fretc does not check it, and the layer "
    "agent examines the same files",
)


@dataclass(frozen=True, slots=True)
class Check:
    """One question to AJPF, and its answer."""

    role: str
    key: str
    jpf: str
    text: str
    """The property."""
    expected: str
    verdict: str
    why: str
    seconds: float
    states: int | None
    log: str
    """Name of the file with the output of AJPF."""
    log_sha256: str
    trace: ClaimTrace | None

    @property
    def question(self) -> tuple[str, str, str, str, str]:
        """The property, its role, and the expected verdict."""
        return self.role, self.key, self.jpf, self.text, self.expected


@dataclass(frozen=True, slots=True)
class AjpfResult:
    """Content of a result file."""

    file: str
    requirement: str
    weakened: bool
    own: tuple[str, str] | None
    """File and SHA-256 of the user's own agent, which replaces that of the bundle."""
    engine: str
    files: Mapping[str, str]
    checks: tuple[Check, ...]


def ajpf_proofs(
    requirements: Sequence[FormalizedRequirement], paths: Sequence[str]
) -> tuple[tuple[Proof, ...], tuple[Diagnostic, ...]]:
    """A proof for each result, in the order of the paths, and the diagnostics of the files.

    Args:
        requirements: the present requirements.
        paths: files of `run.py`.

    Returns:
        The proofs; F616 for an unreadable file, F617 for an unknown requirement.
    """
    known = {requirement.id: requirement for requirement in requirements}
    proofs: list[Proof] = []
    diagnostics: list[Diagnostic] = []
    for path in paths:
        result = read(path)
        if isinstance(result, Diagnostic):
            diagnostics.append(result)
        elif result.requirement not in known:
            diagnostics.append(_foreign(result))
        else:
            proofs.append(_proof(known[result.requirement], result))
    return tuple(proofs), tuple(diagnostics)


def merged(proofs: Sequence[Proof], present: Sequence[Proof]) -> tuple[Proof, ...]:
    """The proofs of a file, with its proofs of AJPF replaced by the present ones.

    A proof of AJPF without a present result becomes unchecked, because nothing compares it with the
    present files. A counterexample stays.
    """
    fresh = {proof.requirement for proof in present}
    old = [
        _unheld(one) if one.layer == Layer.AJPF else one
        for one in proofs
        if one.layer != Layer.AJPF or one.requirement not in fresh
    ]
    return (*old, *present)


def _unheld(one: Proof) -> Proof:
    if one.result is ClaimResult.COUNTEREXAMPLE:
        return one
    reason = (
        "the file of AJPF's result is missing, so it cannot be compared with the present bundle"
    )
    outcome = not_checked(f"it was {one.result}; {reason}")
    return proof(
        one.requirement, Layer.AJPF, one.claim, outcome, one.engine, one.assumptions, one.artefacts
    )


# Files -----------------------------------------------------------------------------------------


def read(path: str) -> AjpfResult | Diagnostic:
    """Read and check a file of `run.py`; F616."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return source
    try:
        return _result(JsonValue(plain(source.text)), path)
    except SchemaError as error:
        return _wrong(source, f"is not what `run.py` writes: {error}")
    except (ValueError, AssertionError):
        return _wrong(source, "is not JSON that fretc can read")


def _wrong(source: Source, what: str) -> Diagnostic:
    return diagnostic(
        "bad_ajpf_result", Source(source.name, "").span(), source=source.name, what=what
    )


def _foreign(result: AjpfResult) -> Diagnostic:
    return diagnostic(
        "foreign_ajpf_result",
        Source(result.file, "").span(),
        file=result.file,
        requirement=result.requirement,
    )


def _result(file: JsonValue, path: str) -> AjpfResult:
    if file.field("schema").text() != SCHEMA:
        raise file.field("schema").wrong(f"`{SCHEMA}`")
    own, commit = file.field("agent"), file.field("mcapl").field("commit")
    mcapl = "of unknown commit" if commit.value is None else commit.text()[:12]
    return AjpfResult(
        path,
        file.field("requirement").text(),
        file.field("weakened").value is not None,
        None if own.value is None else (own.field("file").text(), own.field("sha256").text()),
        f"AJPF, MCAPL {mcapl}, Java {file.field('java').text()}",
        {name: value.text() for name, value in file.field("files").fields().items()},
        tuple(map(_check, file.field("checks").items())),
    )


def _check(at: JsonValue) -> Check:
    states, trace = at.field("states"), at.field("trace")
    return Check(
        at.field("role").text(),
        at.field("key").text(),
        at.field("jpf").text(),
        at.field("property").text(),
        at.field("expected").one_of((HOLDS, VIOLATED)),
        at.field("told").one_of((HOLDS, VIOLATED, ERROR)),
        at.field("why").text(),
        at.field("seconds").number(),
        states.field("new").count() if states.has("new") else None,
        PurePath(at.field("log").text()).name,
        at.field("log_sha256").text(),
        None if trace.value is None else _trace(trace),
    )


def _trace(at: JsonValue) -> ClaimTrace:
    names = tuple(name.text() for name in at.field("names").items())
    rows = tuple(
        tuple(None if cell.value is None else cell.flag() for cell in row.items())
        for row in at.field("rows").items()
    )
    actions = tuple(action.text() for action in at.field("actions").items())
    cycle = at.field("cycle")
    if any(len(row) != len(names) for row in rows) or len(actions) != len(rows):
        raise at.wrong("a table")
    back = None if cycle.value is None else cycle.count()
    if back is not None and back >= len(rows):
        raise cycle.wrong("the number of a row")
    return ClaimTrace(names, rows, actions, back)


# What counts -----------------------------------------------------------------------------------


@with_recursion_limit
def _proof(requirement: FormalizedRequirement, result: AjpfResult) -> Proof:
    options = TargetOptions(weaken=True) if result.weakened else DEFAULT
    main = next((c for c in result.checks if c.role == "requirement"), None)
    stated = f": {main.text}" if main else ""
    which = "its bundle"
    if result.own:
        which = f"{Path(result.own[0]).name} (SHA-256 {result.own[1][:12]})"
    folder = bundle.package(requirement)
    hashes = {
        f"{folder}/{name}": hashed
        for name, hashed in result.files.items()
        if name not in _UNHASHED and not (result.own and name == "SIF.gwen")
    }
    if result.own:
        hashes[Path(result.own[0]).name] = result.own[1]
    reason = _reason(requirement, result, options)
    outcome = _conclusion(result)
    if reason is not None:
        was = "it was refuted; " if outcome.result is ClaimResult.COUNTEREXAMPLE else ""
        outcome = not_checked(f"{was}{reason}")
    loss = ajpf.weakened(requirement, options)
    if outcome.result is ClaimResult.PROVED and loss is not None:
        outcome = not_checked(f"what AJPF shows is weaker than {requirement.id}: {loss}")
    claim = f"AJPF: every run of the agent of {which} keeps {requirement.id}{stated}"
    return proof(requirement.id, Layer.AJPF, claim, outcome, result.engine, _ASSUMED, hashes)


def _reason(
    requirement: FormalizedRequirement, result: AjpfResult, options: TargetOptions
) -> str | None:
    """Why the result is not about the present files; None: it is."""
    refused = bundle.refusal(requirement, options)
    if refused is not None:
        why = f"{refused.code.number} {refused.message}"
        if refused.code is Code.MISSING_EXTRA:
            return f"it cannot be compared with the present bundle: {why}"
        return f"{requirement.id} can no longer be exported as a bundle: {why}"
    artifacts = bundle.emit([requirement], options)
    texts = {artifact.path.name: artifact.text for artifact in artifacts}
    manifest = json.loads(texts.pop("manifest.json"))
    stale = sorted(_stale(result, {name: sha256(text) for name, text in texts.items()}))
    if stale:
        verb = "is" if len(stale) == 1 else "are"
        return f"{', '.join(stale)} {verb} out of date: run AJPF again"
    asked = {tuple(map(check.get, _QUESTION)) for check in manifest["checks"]}
    if asked != {check.question for check in result.checks} or len(asked) != len(result.checks):
        return "its checks are not those of the present bundle: run AJPF again"
    other = next(filter(None, (_otherwise(result.file, check) for check in result.checks)), None)
    if other is not None or result.own is None:
        return other
    return _changed(*result.own)


def _otherwise(file: str, check: Check) -> str | None:
    """Why a check disagrees with its log; None: they agree, or there is no log.

    A refutation stays one, whatever its log contains.
    """
    if check.role == "requirement" and check.verdict == VIOLATED:
        return None
    try:
        log = content(Path(file).parent / "logs" / check.log)
    except (OSError, ValueError):
        return None
    if hashlib.sha256(log).hexdigest() != check.log_sha256:
        return f"logs/{check.log} was changed since AJPF printed it: run AJPF again"
    of_log, _ = verdict(log.decode(errors="replace"), 0)
    if check.verdict not in (of_log, ERROR):
        return f"it states {check.verdict} for {check.jpf}, but logs/{check.log} does not"
    return None


_QUESTION = ("role", "key", "jpf", "property", "expected")


def _stale(result: AjpfResult, now: Mapping[str, str]) -> Iterator[str]:
    for name in {*now, *result.files}:
        ours = result.own is not None and name == "SIF.gwen"
        if name not in _UNHASHED and not ours and result.files.get(name) != now.get(name):
            yield name


def _changed(file: str, hashed: str) -> str | None:
    """Why the user's own agent has changed; None: it has not."""
    try:
        own = content(file)
    except (OSError, ValueError):
        return (
            f"the agent {file} cannot be read, so it cannot be compared with the one that was "
            "checked"
        )
    if hashlib.sha256(own).hexdigest() != hashed:
        return f"the agent {file} was changed since: run AJPF again"
    return None


def _conclusion(result: AjpfResult) -> ClaimOutcome:
    """The outcome of all checks together: a refutation first, then missing answers."""
    checks = result.checks
    for check in checks:
        if check.role == "requirement" and check.verdict == VIOLATED:
            length = f" of {len(check.trace.rows)} states" if check.trace else ""
            return refuted(f"AJPF found a run{length} that violates it", check.trace)
    for check in checks:
        if check.verdict == ERROR:
            return not_checked(f"{check.jpf}: {check.why}")
    for check in checks:
        if check.verdict != check.expected:
            what = "the agent without the response satisfies it too" * (check.role == "mutant")
            return vacuous(what or f"its control {check.key} holds")
    sizes = ", ".join("?" if c.states is None else f"{c.states:,}" for c in checks)
    seconds = sum(check.seconds for check in checks)
    return proved(
        f"AJPF gives the expected verdicts for the property, its controls and the mutant ({sizes} "
        f"states, {seconds:.1f} s)"
    )
