"""CrossHair, for the core of the interceptor.

It runs in a separate process, with limits. A claim is proved only if the whole output confirms it:
with a missing line or another exit status the claim is not checked. A failed search refutes
nothing.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Callable, Iterator, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from tempfile import TemporaryDirectory

from compiler.files.text_files import sha256
from compiler.logic.claims import ClaimOutcome, Layer, Proof, not_checked, proof, proved, refuted
from fretc.verification.engines.programs import MEMORY, STARTED, Completion, run
from fretish.classes.frozen import dataclass
from fretish.diagnostics.extras import install_help

CROSSHAIR_SECONDS = 60.0
_ABSENT = f"CrossHair is not installed: {install_help('crosshair')}"
_MODULE = "interceptor_core"
_WHOLE = "the fields of a velocity are integers; no function reads one of them"
_APART = (ast.Subscript, ast.For, ast.Starred, ast.comprehension, ast.MatchSequence)
_MESSAGE = re.compile(rf"^.*{_MODULE}\.py:(\d+): (info|error|warning): (.*)$")
_POST = re.compile(r"^\s*post\s*(?:\[[^\]]*\])?\s*:\s*(.*?)\s*$")


@dataclass(frozen=True, slots=True)
class _Contract:
    function: str
    line: int
    text: str


def contract_texts(text: str) -> dict[str, str]:
    """Docstrings of functions and classes that contain a contract, which CrossHair executes."""
    docstrings = {
        node.name: ast.get_docstring(node) or ""
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)
    }
    return {name: own for name, own in docstrings.items() if _START.search(own)}


_START = re.compile(r"(pre|post|inv|raises)\s*[\[:]")
"""Beginning of a contract, wherever CrossHair might read one."""


def with_crosshair(
    text: str,
    requirement: str = "interceptor",
    *,
    seconds: float = CROSSHAIR_SECONDS,
    progress: Callable[[str], None] = lambda function: None,
) -> tuple[Proof, ...]:
    """Search with CrossHair for inputs that violate the contracts of an interceptor's core.

    Velocity fields that no function reads are given to CrossHair as `int`: six symbolic floats
    would multiply the cases without adding any.

    Args:
        text: the core, with `post:` lines in its docstrings (PEP 316). It is executed.
        requirement: name under which the evidence is filed.
        seconds: time limit for each function; its contracts share it.
        progress: called with the name of each function before it is examined.

    Returns:
        One proof for each contract: proved if CrossHair has confirmed it over all paths, refuted
        with the inputs if it found any, else not checked. And one for each function that fails.
    """
    try:
        engine = f"CrossHair {version('crosshair-tool')}"
    except PackageNotFoundError:
        engine = ""
    contracts = _contracts(text)
    whole = _with_whole_velocities(text)
    outcomes: list[tuple[str, ClaimOutcome]] = []
    for name in dict.fromkeys(contract.function for contract in contracts):
        own = [contract for contract in contracts if contract.function == name]
        if engine:
            progress(name)
            outcomes += _answers(whole or text, name, own, seconds)
        else:
            outcomes += [(_claim(contract), not_checked(_ABSENT)) for contract in own]
    return tuple(
        proof(
            requirement,
            Layer.INTERCEPTOR,
            claim,
            outcome,
            engine or "CrossHair",
            (_WHOLE,) if whole else (),
            {"interceptor core": sha256(text)},
        )
        for claim, outcome in outcomes
    )


def _with_whole_velocities(text: str) -> str | None:
    """The text with integers in `Velocity`, on the same lines; None if that may change a result.

    It cannot if no function names a field of it or takes a value apart: by an index, a loop, a
    pattern, or in arguments.
    """
    tree = ast.parse(text)
    classes = [n for n in tree.body if isinstance(n, ast.ClassDef) and n.name == "Velocity"]
    fields = [f for one in classes for f in one.body if isinstance(f, ast.AnnAssign)]
    if not fields or not all(ast.unparse(f.annotation) == "float" for f in fields):
        return None
    names = {ast.unparse(field.target) for field in fields}
    others = [node for one in tree.body if one not in classes for node in ast.walk(one)]
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
    """Whether the code could read parts of a tuple without naming a field."""
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
            own = child.body[0]
            for number in range(own.lineno, (own.end_lineno or own.lineno) + 1):
                if post := _POST.match(lines[number - 1]):
                    yield _Contract(f"{prefix}{child.name}", number, post[1])


def _answers(
    text: str, function: str, contracts: Sequence[_Contract], seconds: float
) -> Iterator[tuple[str, ClaimOutcome]]:
    """The claims of one function, each with its outcome."""
    command = [
        *(sys.executable, "-m", "crosshair", "check", "--report_all"),
        *("--analysis_kind=PEP316", f"--per_condition_timeout={seconds / len(contracts):g}"),
        f"{_MODULE}.{function}",
    ]
    with TemporaryDirectory(prefix="fretc-") as name:
        folder = Path(name)
        (folder / f"{_MODULE}.py").write_text(text, encoding="utf-8")
        end = run(command, folder, seconds=seconds + STARTED, memory=MEMORY)
    messages: dict[int, tuple[str, str]] = {}
    for line in end.text.splitlines():
        if match := _MESSAGE.match(line):
            messages[int(match[1])] = (match[2], match[3])
    for contract in contracts:
        yield _claim(contract), _outcome(messages.pop(contract.line, None), end)
    for kind, text in messages.values():
        if kind == "error":
            yield f"`{function}` raises nothing", refuted(text)


def _outcome(message: tuple[str, str] | None, end: Completion) -> ClaimOutcome:
    """The outcome of a contract.

    Args:
        message: kind and text of CrossHair's message; None: there is none about the contract.
        end: exit status and output of CrossHair.
    """
    if message is not None and message[0] == "error":
        return refuted(message[1])
    if end.status is None:
        return not_checked("CrossHair did not finish in time")
    if end.status not in (0, 1) or message is None:
        return not_checked(f"CrossHair gives no result for it (exit status {end.status})")
    if message == ("info", "Confirmed over all paths."):
        return proved("confirmed over all paths")
    return not_checked(f"CrossHair: {message[1].rstrip('.').lower()}")
