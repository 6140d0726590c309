"""Faults: one small change of one place in a file of the product, drawn from a seed."""

from __future__ import annotations

import ast
import hashlib
import itertools
import random
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent.parent
ROOMS = ("fretish", "monitors", "compiler", "fretc", "simulation")
TEMPLATES = "templates"


@dataclass(frozen=True)
class Fault:
    """Replace `old`, which stands at byte `start` of the file, by `new`."""

    path: str
    start: int
    old: str
    new: str
    kind: str

    @property
    def id(self) -> str:
        """Eight hexadecimal digits that stay the same while the file does."""
        text = f"{self.path}\0{self.start}\0{self.old}\0{self.new}"
        return hashlib.sha256(text.encode()).hexdigest()[:8]

    def applied(self, text: bytes) -> bytes:
        """Return the file's bytes with the fault in them."""
        old = self.old.encode()
        assert text[self.start : self.start + len(old)] == old, f"{self.path} is another file"
        return text[: self.start] + self.new.encode() + text[self.start + len(old) :]

    def line(self, text: bytes) -> int:
        """Return the line of the file on which the fault begins, from 1."""
        return text.count(b"\n", 0, self.start) + 1


COMPARISONS: dict[type[ast.cmpop], tuple[str, str]] = {
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
}
OPERATORS: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "//"),
    ast.FloorDiv: ("//", "*"),
    ast.Div: ("/", "*"),
    ast.Mod: ("%", "//"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
}
NAMES = {
    "min": "max",
    "max": "min",
    "any": "all",
    "all": "any",
    "sorted": "list",
    "and_": "or_",
    "or_": "and_",
    "TRUE": "FALSE",
    "FALSE": "TRUE",
}


class _Places(ast.NodeVisitor):
    """Every place of one module at which a fault could be, by kind."""

    def __init__(self, path: str, text: bytes) -> None:
        self.path, self.text = path, text
        starts = [0, *(match.end() for match in re.finditer(rb"\n", text))]
        self.starts = starts
        self.faults: list[Fault] = []

    def _offset(self, line: int, column: int) -> int:
        return self.starts[line - 1] + column

    def _span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None and node.end_col_offset is not None
        start = self._offset(node.lineno, node.col_offset)
        return start, self._offset(node.end_lineno, node.end_col_offset)

    def _add(self, kind: str, start: int, end: int, new: str) -> None:
        old = self.text[start:end].decode()
        if old != new:
            self.faults.append(Fault(self.path, start, old, new, kind))

    def _replace(self, kind: str, node: ast.expr | ast.stmt, new: str) -> None:
        self._add(kind, *self._span(node), new)

    def _source(self, node: ast.expr) -> str:
        start, end = self._span(node)
        return self.text[start:end].decode()

    def _sign(self, kind: str, left: ast.expr, right: ast.expr, signs: tuple[str, str]) -> None:
        """Exchange the operator that stands between two operands."""
        begin, end = self._span(left)[1], self._span(right)[0]
        between = self.text[begin:end].decode()
        place = between.find(signs[0])
        if place >= 0 and "#" not in between:
            start = begin + len(between[:place].encode())
            self._add(kind, start, start + len(signs[0]), signs[1])

    def visit_Compare(self, node: ast.Compare) -> None:
        operands = [node.left, *node.comparators]
        for left, operator, right in zip(operands, node.ops, operands[1:], strict=False):
            self._sign("comparison", left, right, COMPARISONS[type(operator)])
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        text = isinstance(node.left, ast.Constant) and isinstance(node.left.value, str)
        if type(node.op) in OPERATORS and not text:
            self._sign("operator", node.left, node.right, OPERATORS[type(node.op)])
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        signs = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        if len(node.values) == 2:  # of more, `a or b and c` would group anew
            self._sign("connective", *node.values, signs)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.Not):
            self._replace("negation", node, f"({self._source(node.operand)})")
        self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:
        self._replace("check left out", node.test, "False")
        self.generic_visit(node)

    def visit_IfExp(self, node: ast.IfExp) -> None:
        this, other = self._source(node.body), self._source(node.orelse)
        new = f"{other} if {self._source(node.test)} else {this}"
        self._replace("branches exchanged", node, new)
        self.generic_visit(node)

    def visit_comprehension(self, node: ast.comprehension) -> None:
        for condition in node.ifs:
            self._replace("filter left out", condition, "True")
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, bool):
            self._replace("truth value", node, str(not node.value))
        elif isinstance(node.value, int):
            self._replace("number", node, str(node.value + 1))
        elif isinstance(node.value, float):
            self._replace("number", node, repr(node.value * 1000))

    def visit_Name(self, node: ast.Name) -> None:
        if node.id in NAMES and isinstance(node.ctx, ast.Load):
            self._replace("name", node, NAMES[node.id])

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Constant):
            return  # a docstring
        if isinstance(node.value, ast.Call):
            self._replace("call left out", node, "pass")
        self.generic_visit(node)

    def visit_Return(self, node: ast.Return) -> None:
        if isinstance(node.value, ast.List | ast.Tuple) and len(node.value.elts) > 1:
            self._replace("entry lost", node.value.elts[-1], self._source(node.value.elts[0]))
        self.generic_visit(node)

    def visit_Subscript(self, node: ast.Subscript) -> None:
        if isinstance(node.ctx, ast.Load):  # not `list[int]` of an annotation, which is left out
            self.generic_visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_arguments(self, node: ast.arguments) -> None:
        for default in [*node.defaults, *node.kw_defaults]:
            if default is not None:
                self.visit(default)

    def _function(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
        self.visit(node.args)
        for statement in node.body:
            self.visit(statement)

    visit_FunctionDef = _function
    visit_AsyncFunctionDef = _function

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Leave out what stands in a string: its places are not exact before Python 3.12."""


FILTER = re.compile(r"(\{\{[^{}\n]*?)(\s*\|\s*[a-z_]+)(\s*\}\})")
CONDITION = re.compile(r"(\{%-?\s*(?:el)?if )(not )?")


def of_template(path: str, text: bytes) -> list[Fault]:
    """Return each filter left out (a quote is no longer escaped), and each condition negated."""
    decoded = text.decode()

    def fault(start: int, old: str, new: str, kind: str) -> Fault:
        return Fault(path, len(decoded[:start].encode()), old, new, kind)

    return [
        *(fault(m.start(2), m[2], "", "filter left out") for m in FILTER.finditer(decoded)),
        *(
            fault(m.end(1), m[2] or "", "" if m[2] else "not ", "condition")
            for m in CONDITION.finditer(decoded)
        ),
    ]


def of_module(path: str, text: bytes) -> list[Fault]:
    """Return each change that can be made to a Python module; few of them are no Python."""
    places = _Places(path, text)
    places.visit(ast.parse(text))
    return places.faults


def is_whole(fault: Fault, text: bytes) -> bool:
    """Whether the changed file can be read at all: what cannot, every test finds."""
    try:
        if fault.path.endswith(".py"):
            ast.parse(fault.applied(text))
    except SyntaxError:
        return False
    return True


def files(root: Path) -> Iterator[tuple[str, Callable[[str, bytes], list[Fault]]]]:
    """Yield each file that faults are drawn for, with what finds its places."""
    for room in ROOMS:
        for path in sorted(root.joinpath(room).rglob("*.py")):
            yield path.relative_to(root).as_posix(), of_module
    for path in sorted(root.joinpath(TEMPLATES).rglob("*.j2")):
        yield path.relative_to(root).as_posix(), of_template


def room_of(path: str) -> str:
    """Return the part of the house whose share of lines decides how many faults it gets."""
    parts = path.split("/")
    return "/".join(parts[:2]) if parts[0] in {"compiler", "fretc"} and len(parts) > 2 else parts[0]


def drawn(root: Path, seed: int, count: int) -> list[Fault]:
    """Draw faults, to each room by its share of lines, no two on one line.

    Lines of a room are those on which a fault is possible, so that what has no decision in it has
    no share.
    """
    rooms: dict[str, dict[tuple[str, int], list[Fault]]] = {}
    texts = {path: root.joinpath(path).read_bytes() for path, _ in files(root)}
    for path, places in files(root):
        text = texts[path]
        lines = rooms.setdefault(room_of(path), {})
        for fault in places(path, text):
            lines.setdefault((path, fault.line(text)), []).append(fault)
    every = sum(map(len, rooms.values()))
    faults: list[Fault] = []
    for room, lines in sorted(rooms.items()):
        chance = random.Random(f"{seed}{room}")
        share = max(1, round(count * len(lines) / every))
        places = iter(chance.sample(sorted(lines), len(lines)))
        choices = (_choice(chance, lines[place]) for place in places)
        whole = (fault for fault in choices if is_whole(fault, texts[fault.path]))
        faults += itertools.islice(whole, share)
    return faults


def _choice(chance: random.Random, faults: list[Fault]) -> Fault:
    """Draw a kind, then one of its faults: numbers are many, checks that are left out few."""
    kind = chance.choice(sorted({fault.kind for fault in faults}))
    return chance.choice([fault for fault in faults if fault.kind == kind])
