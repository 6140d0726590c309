"""Dafny, for the files of `--emit dafny`.

It runs in a process of its own, with limits. A proof is believed only where everything that it
tells says so: a missing line, another exit status, fewer verified parts than the text has, and the
claim is not checked. That it finds no proof refutes nothing.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Outcome, Proof, not_checked, proof, proved
from compiler.targets import dafny
from compiler.targets.dafny_claims import claims
from compiler.targets.target import stem
from fretc.verification.engines.programs import MEMORY, STARTED, Ran, run
from fretish.bindings.declarations import Declarations

DAFNY_SECONDS = 300.0
_ABSENT = (
    "Dafny is not installed: put `dafny` on the PATH (Debian and Ubuntu: `apt-get install dafny`; "
    "elsewhere: github.com/dafny-lang/dafny)"
)
_OTHER = "the text is not what fretc makes of this requirement: make it anew with `--emit dafny`"
_FINISHED = re.compile(r"^Dafny program verifier finished with (\d+) verified, (\d+) errors?$")
_ERROR = re.compile(r"^\S+?\.dfy\((\d+),\d+\): Error\b:?\s*(?:BP\d+: )?(.*)$")
_MEMBER = re.compile(
    r"^ *(?:(?:lemma|method|function|predicate)(?: \{[^}]*\})? (\w+)|(constructor))\b"
)
_OBLIGATION = re.compile(r"^ *(?:lemma|method|constructor)\b", re.MULTILINE)
_VERSION = re.compile(r"\b(\d+)\.\d+[\w.+-]*")


def with_dafny(
    rule: Formalized,
    text: str,
    declarations: Declarations | None,
    *,
    seconds: float = DAFNY_SECONDS,
) -> tuple[Proof, ...]:
    """Let Dafny verify the file of a rule: one line for each claim of the file.

    Dafny gives one verdict for a file. So either all claims are proved, or none is.

    Args:
        rule: one that the target does not refuse.
        text: what `--emit dafny` made of it; of any other text nothing is claimed.
        declarations: those that it was made with.
        seconds: so long Dafny may take.
    """
    if text == dafny.text(rule, declarations):
        result, engine = verified(text, seconds=seconds)
    else:
        result, engine = not_checked(_OTHER), "Dafny"
    artefacts = {f"{stem(rule)}.dfy": sha256(text)}
    return tuple(
        proof(
            rule.id,
            claim.layer,
            claim.sentence,
            result if claim.unshown is None else not_checked(claim.unshown),
            engine,
            claim.assumptions,
            artefacts,
        )
        for claim in claims(rule, declarations)
    )


def verified(text: str, *, seconds: float = DAFNY_SECONDS) -> tuple[Outcome, str]:
    """What Dafny says of a text, and the name and version of Dafny.

    Proved: it verified at least every lemma, method and constructor, and found no error. Else not
    checked, with the places at which it found no proof.
    """
    program = shutil.which("dafny")
    if program is None:
        return not_checked(_ABSENT), "Dafny"
    with TemporaryDirectory(prefix="fretc-") as name:
        folder = Path(name)
        try:
            known = _version(program, folder)
            if known is None:
                return not_checked("`dafny` tells no version: it is not Dafny"), "Dafny"
            (folder / "text.dfy").write_text(text, encoding="utf-8")
            command = [program, *_options(program, known, folder, seconds), "text.dfy"]
            ran = run(command, folder, seconds=seconds, memory=MEMORY)
        except OSError as error:
            return not_checked(f"Dafny cannot be started: {error}"), "Dafny"
    return _verdict(text, ran, seconds), f"Dafny {known}"


def _version(program: str, folder: Path) -> str | None:
    """As 2.x tells it above a complaint, and 4.x alone."""
    for question in ("--version", "/version"):
        ran = run([program, question], folder, seconds=STARTED, memory=MEMORY)
        for line in ran.text.splitlines():
            found = _VERSION.search(line)
            if found and (line.startswith("Dafny ") or found.start() == 0):
                return found.group()
    return None


def _options(program: str, known: str, folder: Path, seconds: float) -> list[str]:
    """4 has commands; from some version on warnings are errors unless they are allowed."""
    limit = max(int(seconds) - 1, 1)
    if int(known.partition(".")[0]) < 4:
        return ["/compile:0", f"/timeLimit:{limit}"]
    told = run([program, "verify", "--help"], folder, seconds=STARTED, memory=MEMORY).text
    allowed = [option for option in ("--allow-warnings",) if option in told]
    return ["verify", f"--verification-time-limit={limit}", *allowed]


def _verdict(text: str, ran: Ran, seconds: float) -> Outcome:
    if ran.status is None:
        return not_checked(f"Dafny did not finish within {seconds:g} s")
    lines = ran.text.splitlines()
    unproved = [
        f"`{_member(text, int(found[1]))}` (line {found[1]}): {found[2].strip().rstrip('.')}"
        for line in lines
        if (found := _ERROR.match(line))
    ]
    if unproved:
        return not_checked(f"Dafny finds no proof of {'; '.join(dict.fromkeys(unproved))}")
    finished = [found for line in lines if (found := _FINISHED.match(line.strip()))]
    if len(finished) != 1:
        return not_checked(f"Dafny ended with exit status {ran.status} and no verdict")
    count, errors = map(int, finished[0].groups())
    if ran.status != 0 or errors:
        return not_checked(f"Dafny tells of {errors} errors, and its exit status is {ran.status}")
    least = len(_OBLIGATION.findall(text))
    if count < least:
        return not_checked(f"Dafny verified {count} parts, and the file has at least {least}")
    return proved(f"{count} parts verified, among them all {least} lemmas and methods")


def _member(text: str, line: int) -> str:
    """What is declared at a line of the text or above it."""
    for above in reversed(text.splitlines()[:line]):
        found = _MEMBER.match(above)
        if found:
            return found[1] or found[2]
    return "the file"
