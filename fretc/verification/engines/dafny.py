"""Dafny, for the files of `--emit dafny`.

It runs in a separate process, with limits. A claim is proved only if the whole output confirms it:
with a missing line, another exit status, or fewer verified parts than the text has, the claim is
not checked. A failed proof refutes nothing.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimOutcome, Proof, not_checked, proof, proved
from compiler.targets import dafny
from compiler.targets.dafny_claims import claims
from compiler.targets.target import stem
from fretc.verification.engines.programs import MEMORY, STARTED, Completion, run
from fretish.bindings.declarations import Declarations

DAFNY_SECONDS = 300.0
_ABSENT = (
    "Dafny is not installed: put `dafny` on the PATH (Debian and Ubuntu: `apt-get install dafny`; "
    "elsewhere: github.com/dafny-lang/dafny)"
)
_OTHER = (
    "the file is not what fretc generates for this requirement: generate it again with "
    "`--emit dafny`"
)
_FINISHED = re.compile(r"^Dafny program verifier finished with (\d+) verified, (\d+) errors?$")
_ERROR = re.compile(r"^\S+?\.dfy\((\d+),\d+\): Error\b:?\s*(?:BP\d+: )?(.*)$")
_MEMBER = re.compile(
    r"^ *(?:(?:lemma|method|function|predicate)(?: \{[^}]*\})? (\w+)|(constructor))\b"
)
_OBLIGATION = re.compile(r"^ *(?:lemma|method|constructor)\b", re.MULTILINE)
_VERSION = re.compile(r"\b(\d+)\.\d+[\w.+-]*")


def with_dafny(
    requirement: FormalizedRequirement,
    text: str,
    declarations: Declarations | None,
    *,
    seconds: float = DAFNY_SECONDS,
) -> tuple[Proof, ...]:
    """Verify the file of a requirement with Dafny: one proof for each claim of the file.

    Dafny gives one verdict for a file, so either all claims are proved, or none is.

    Args:
        requirement: a requirement that the target accepts.
        text: file of `--emit dafny`; any other text is not checked.
        declarations: declarations of the requirement's file.
        seconds: time limit of Dafny.
    """
    if text == dafny.text(requirement, declarations):
        outcome, engine = answer(text, seconds=seconds)
    else:
        outcome, engine = not_checked(_OTHER), "Dafny"
    artefacts = {f"{stem(requirement)}.dfy": sha256(text)}
    return tuple(
        proof(
            requirement.id,
            claim.layer,
            claim.sentence,
            outcome if claim.unshown is None else not_checked(claim.unshown),
            engine,
            claim.assumptions,
            artefacts,
        )
        for claim in claims(requirement, declarations)
    )


def answer(text: str, *, seconds: float = DAFNY_SECONDS) -> tuple[ClaimOutcome, str]:
    """The outcome of a text, and the name and version of Dafny.

    Proved: Dafny verifies at least every lemma, method and constructor, and reports no error. Else
    not checked, with the parts that have no proof.
    """
    program = shutil.which("dafny")
    if program is None:
        return not_checked(_ABSENT), "Dafny"
    with TemporaryDirectory(prefix="fretc-") as name:
        folder = Path(name)
        try:
            known = _version(program, folder)
            if known is None:
                return not_checked("`dafny` prints no version: it is not Dafny"), "Dafny"
            (folder / "text.dfy").write_text(text, encoding="utf-8")
            command = [program, *_options(program, known, folder, seconds), "text.dfy"]
            end = run(command, folder, seconds=seconds, memory=MEMORY)
        except OSError as error:
            return not_checked(f"Dafny cannot be started: {error}"), "Dafny"
    return _outcome(text, end, seconds), f"Dafny {known}"


def _version(program: str, folder: Path) -> str | None:
    """The version; 2.x prints it above a complaint, 4.x alone."""
    for question in ("--version", "/version"):
        end = run([program, question], folder, seconds=STARTED, memory=MEMORY)
        for line in end.text.splitlines():
            match = _VERSION.search(line)
            if match and (line.startswith("Dafny ") or match.start() == 0):
                return match.group()
    return None


def _options(program: str, known: str, folder: Path, seconds: float) -> list[str]:
    """Options by version: 4 has commands; later versions treat warnings as errors by default."""
    limit = max(int(seconds) - 1, 1)
    if int(known.partition(".")[0]) < 4:
        return ["/compile:0", f"/timeLimit:{limit}"]
    known_options = run([program, "verify", "--help"], folder, seconds=STARTED, memory=MEMORY).text
    allowed = [option for option in ("--allow-warnings",) if option in known_options]
    return ["verify", f"--verification-time-limit={limit}", *allowed]


def _outcome(text: str, end: Completion, seconds: float) -> ClaimOutcome:
    if end.status is None:
        return not_checked(f"Dafny did not finish within {seconds:g} s")
    lines = end.text.splitlines()
    unproved = [
        f"`{_member(text, int(match[1]))}` (line {match[1]}): {match[2].strip().rstrip('.')}"
        for line in lines
        if (match := _ERROR.match(line))
    ]
    if unproved:
        return not_checked(f"Dafny finds no proof of {'; '.join(dict.fromkeys(unproved))}")
    finished = [match for line in lines if (match := _FINISHED.match(line.strip()))]
    if len(finished) != 1:
        return not_checked(f"Dafny ended with exit status {end.status} and no verdict")
    count, errors = map(int, finished[0].groups())
    if end.status != 0 or errors:
        return not_checked(f"Dafny reports {errors} errors, and its exit status is {end.status}")
    least = len(_OBLIGATION.findall(text))
    if count < least:
        return not_checked(f"Dafny verified {count} parts, but the file has at least {least}")
    return proved(f"{count} parts verified, among them all {least} lemmas and methods")


def _member(text: str, line: int) -> str:
    """Name of the declaration at a line of the text or above it."""
    for above in reversed(text.splitlines()[:line]):
        match = _MEMBER.match(above)
        if match:
            return match[1] or match[2]
    return "the file"
