"""Provers that are not ours: Dafny for `--emit dafny`, CrossHair for the interceptor's core.

Both run in processes of their own, with limits. A proof is believed only where everything that a
prover tells says so: a missing line, another exit status, fewer verified parts than the file has,
and the claim is not checked. That a prover finds no proof refutes nothing.
"""

from __future__ import annotations

import ast
import hashlib
import re
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryDirectory

from compiler.formalization.rule import Rule
from compiler.logic.claims import (
    Counterexample,
    Evidence,
    Layer,
    NotChecked,
    Proved,
    Result,
)
from compiler.targets import dafny
from compiler.targets.dafny_claims import claims
from compiler.targets.target import stem
from fretc.verification.engines.programs import Ran, run
from fretish.bindings.declarations import Declarations

_MEMORY = 4 * 2**30
"""Bytes for each process of a prover."""


_STARTED = 30.0
"""Seconds in which a prover tells its version, or has read its text."""


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


# Dafny ----------------------------------------------------------------------------------------

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
    rule: Rule,
    text: str,
    declarations: Declarations | None,
    *,
    seconds: float = DAFNY_SECONDS,
) -> tuple[Evidence, ...]:
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
        result, engine = NotChecked(_OTHER), "Dafny"
    artefacts = {f"{stem(rule)}.dfy": _sha256(text)}
    return tuple(
        Evidence(
            rule.id,
            claim.layer,
            claim.sentence,
            result if claim.unshown is None else NotChecked(claim.unshown),
            engine,
            claim.assumptions,
            artefacts,
        )
        for claim in claims(rule, declarations)
    )


def verified(text: str, *, seconds: float = DAFNY_SECONDS) -> tuple[Result, str]:
    """What Dafny says of a text, and the name and version of Dafny.

    Proved: it verified at least every lemma, method and constructor, and found no error. Else not
    checked, with the places at which it found no proof.
    """
    program = shutil.which("dafny")
    if program is None:
        return NotChecked(_ABSENT), "Dafny"
    with TemporaryDirectory(prefix="fretc-") as name:
        folder = Path(name)
        try:
            known = _version(program, folder)
            if known is None:
                return NotChecked("`dafny` tells no version: it is not Dafny"), "Dafny"
            (folder / "text.dfy").write_text(text, encoding="utf-8")
            command = [program, *_options(program, known, folder, seconds), "text.dfy"]
            ran = run(command, folder, seconds=seconds, memory=_MEMORY)
        except OSError as error:
            return NotChecked(f"Dafny cannot be started: {error}"), "Dafny"
    return _verdict(text, ran, seconds), f"Dafny {known}"


def _version(program: str, folder: Path) -> str | None:
    """As 2.x tells it above a complaint, and 4.x alone."""
    for question in ("--version", "/version"):
        ran = run([program, question], folder, seconds=_STARTED, memory=_MEMORY)
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
    told = run([program, "verify", "--help"], folder, seconds=_STARTED, memory=_MEMORY).text
    allowed = [option for option in ("--allow-warnings",) if option in told]
    return ["verify", f"--verification-time-limit={limit}", *allowed]


def _verdict(text: str, ran: Ran, seconds: float) -> Result:
    if ran.status is None:
        return NotChecked(f"Dafny did not finish within {seconds:g} s")
    lines = ran.text.splitlines()
    unproved = [
        f"`{_member(text, int(found[1]))}` (line {found[1]}): {found[2].strip().rstrip('.')}"
        for line in lines
        if (found := _ERROR.match(line))
    ]
    if unproved:
        return NotChecked(f"Dafny finds no proof of {'; '.join(dict.fromkeys(unproved))}")
    finished = [found for line in lines if (found := _FINISHED.match(line.strip()))]
    if len(finished) != 1:
        return NotChecked(f"Dafny ended with exit status {ran.status} and no verdict")
    count, errors = map(int, finished[0].groups())
    if ran.status != 0 or errors:
        return NotChecked(f"Dafny tells of {errors} errors, and its exit status is {ran.status}")
    least = len(_OBLIGATION.findall(text))
    if count < least:
        return NotChecked(f"Dafny verified {count} parts, and the file has at least {least}")
    return Proved(f"{count} parts verified, among them all {least} lemmas and methods")


def _member(text: str, line: int) -> str:
    """What is declared at a line of the text or above it."""
    for above in reversed(text.splitlines()[:line]):
        found = _MEMBER.match(above)
        if found:
            return found[1] or found[2]
    return "the file"


# CrossHair ------------------------------------------------------------------------------------

CROSSHAIR_SECONDS = 60.0
_CROSSHAIR_ABSENT = "CrossHair is not installed: pip install 'fretc[crosshair]'"
_MODULE = "interceptor_core"
_WHOLE = "the numbers of a velocity are whole; no function names one of them"
_APART = (ast.Subscript, ast.For, ast.Starred, ast.comprehension, ast.MatchSequence)
_TOLD = re.compile(rf"^.*{_MODULE}\.py:(\d+): (info|error|warning): (.*)$")
_POST = re.compile(r"^\s*post\s*(?:\[[^\]]*\])?\s*:\s*(.*?)\s*$")


@dataclass(frozen=True, slots=True)
class _Contract:
    function: str
    line: int
    text: str


def stated(text: str) -> dict[str, str]:
    """The docstrings of functions and classes with a contract in them: CrossHair executes it."""
    found = {
        node.name: ast.get_docstring(node) or ""
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
    }
    return {name: told for name, told in found.items() if _STATED.search(told)}


_STATED = re.compile(r"(pre|post|inv|raises)\s*[\[:]")
"""Wherever a line might begin for CrossHair."""


def with_crosshair(
    text: str,
    requirement: str = "interceptor",
    *,
    seconds: float = CROSSHAIR_SECONDS,
    tell: Callable[[str], None] = lambda function: None,
) -> tuple[Evidence, ...]:
    """Let CrossHair look for inputs that break the contracts of an interceptor's core.

    Numbers of a velocity are whole ones for CrossHair where no function names any of them: it knows
    several kinds of floats, and six of them are hundreds of cases of which none matters.

    Args:
        text: the core, with `post:` lines in its docstrings (PEP 316). It is executed.
        requirement: what the lines of evidence are filed under.
        seconds: for each function; its contracts share them.
        tell: is called with the name of each function before it is looked at.

    Returns:
        One line for each contract: proved if CrossHair has confirmed it over all paths, refuted
        with the inputs if it found any, else not checked. And one for each function that fails.
    """
    try:
        engine = f"CrossHair {version('crosshair-tool')}"
    except PackageNotFoundError:
        engine = ""
    contracts = _contracts(text)
    whole = _with_whole_velocities(text)
    found: list[tuple[str, Result]] = []
    for name in dict.fromkeys(contract.function for contract in contracts):
        own = [contract for contract in contracts if contract.function == name]
        if engine:
            tell(name)
            found += _explored(whole or text, name, own, seconds)
        else:
            found += [(_claim(contract), NotChecked(_CROSSHAIR_ABSENT)) for contract in own]
    return tuple(
        Evidence(
            requirement,
            Layer.INTERCEPTOR,
            claim,
            result,
            engine or "CrossHair",
            (_WHOLE,) if whole else (),
            {"interceptor core": _sha256(text)},
        )
        for claim, result in found
    )


def _with_whole_velocities(text: str) -> str | None:
    """The text with whole numbers in `Velocity`, on the same lines; None where that may matter.

    It cannot where no function names a field of it or takes anything apart: by an index, a loop, a
    pattern, or in arguments.
    """
    tree = ast.parse(text)
    found = [n for n in tree.body if isinstance(n, ast.ClassDef) and n.name == "Velocity"]
    fields = [f for one in found for f in one.body if isinstance(f, ast.AnnAssign)]
    if not fields or not all(ast.unparse(f.annotation) == "float" for f in fields):
        return None
    names = {ast.unparse(field.target) for field in fields}
    others = [node for one in tree.body if one not in found for node in ast.walk(one)]
    bodies = [s for node in others if isinstance(node, ast.FunctionDef) for s in node.body]
    if any(_takes_apart(node) for body in bodies for node in ast.walk(body)):
        return None
    if any(isinstance(node, ast.Attribute) and node.attr in names for node in others):
        return None
    lines = text.splitlines(keepends=True)
    for field in fields:
        target = ast.unparse(field.target)
        zero = " = 0" if field.value is not None else ""
        lines[field.lineno - 1] = f"    {target}: int{zero}\n"
    return "".join(lines)


def _takes_apart(node: ast.AST) -> bool:
    """Whether it could look into a tuple without naming a field."""
    match node:
        case ast.Tuple(ctx=ast.Store()) | ast.MatchClass(cls=ast.Name("Velocity")):
            return True
        case _:
            return isinstance(node, _APART)


def _claim(contract: _Contract) -> str:
    return f"`{contract.function}` keeps `{contract.text}`"


def _contracts(text: str) -> tuple[_Contract, ...]:
    """The `post:` lines in docstrings of functions and methods, in their order."""
    return tuple(_of(ast.parse(text), text.splitlines(), ""))


def _of(node: ast.AST, lines: Sequence[str], prefix: str) -> Iterator[_Contract]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.ClassDef):
            yield from _of(child, lines, f"{prefix}{child.name}.")
        elif isinstance(child, ast.FunctionDef) and ast.get_docstring(child) is not None:
            told = child.body[0]
            for number in range(told.lineno, (told.end_lineno or told.lineno) + 1):
                if found := _POST.match(lines[number - 1]):
                    yield _Contract(f"{prefix}{child.name}", number, found[1])


def _explored(
    text: str, function: str, contracts: Sequence[_Contract], seconds: float
) -> Iterator[tuple[str, Result]]:
    """The contracts of one function: claims and what is known of them."""
    command = [
        *(sys.executable, "-m", "crosshair", "check", "--report_all"),
        *("--analysis_kind=PEP316", f"--per_condition_timeout={seconds / len(contracts):g}"),
        f"{_MODULE}.{function}",
    ]
    with TemporaryDirectory(prefix="fretc-") as name:
        folder = Path(name)
        (folder / f"{_MODULE}.py").write_text(text, encoding="utf-8")
        ran = run(command, folder, seconds=seconds + _STARTED, memory=_MEMORY)
    told: dict[int, tuple[str, str]] = {}
    for line in ran.text.splitlines():
        if found := _TOLD.match(line):
            told[int(found[1])] = (found[2], found[3])
    for contract in contracts:
        yield _claim(contract), _result(told.pop(contract.line, None), ran)
    for kind, message in told.values():
        if kind == "error":
            yield f"`{function}` raises nothing", Counterexample(message, None)


def _result(told: tuple[str, str] | None, ran: Ran) -> Result:
    if told is not None and told[0] == "error":
        return Counterexample(told[1], None)
    if ran.status is None:
        return NotChecked("CrossHair did not finish in time")
    if ran.status not in (0, 1) or told is None:
        return NotChecked(f"CrossHair says nothing of it (exit status {ran.status})")
    if told == ("info", "Confirmed over all paths."):
        return Proved("confirmed over all paths")
    return NotChecked(f"CrossHair: {told[1].rstrip('.').lower()}")
