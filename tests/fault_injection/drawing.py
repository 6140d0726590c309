"""Faults: one small change of one place in a file of the product, drawn from a seed.

Not drawn is what no test could see, or each would: what stands in decorators, annotations and
assertions; arguments such as `strict` and `timeout`; conditions on the platform or for a type
checker; `/` and `+` beside a text or a list; names of types; and in modules that draw pictures
numbers, and arithmetic with a number: these are sizes on a page.
"""

from __future__ import annotations

import ast
import hashlib
import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

ROOT = Path(__file__).parents[2]
ROOMS = ("fretish", "monitors", "compiler", "fretc", "simulation")
TEMPLATES = "templates"


@dataclass(frozen=True, slots=True)
class Place:
    """A place that stays the same when other lines of the file change."""

    path: str
    line: str = ""
    """The line's text."""
    number: int = 0
    """How many lines of the same text stand before it."""
    column: int = 0


@dataclass(frozen=True, slots=True)
class Fault:
    """Replace `old`, which stands at byte `start` of the file, by `new`."""

    place: Place
    start: int
    old: str
    new: str
    kind: str

    @property
    def path(self) -> str:
        """The file, from the root of the tree."""
        return self.place.path

    @property
    def id(self) -> str:
        """Eight hexadecimal digits that stay the same while the line does."""
        return _digest(self.place, self.old, self.new)[:8]

    def applied(self, text: bytes) -> bytes:
        """Return the file's bytes with the fault in them."""
        old = self.old.encode()
        assert text[self.start : self.start + len(old)] == old, f"{self.path} is another file"
        return text[: self.start] + self.new.encode() + text[self.start + len(old) :]

    def line(self, text: bytes) -> int:
        """Return the line of the file on which the fault begins, from 1."""
        return text.count(b"\n", 0, self.start) + 1


def _digest(*values: object) -> str:
    return hashlib.sha256("\0".join(map(repr, values)).encode()).hexdigest()


class _Text:
    """A file's text, and where its lines are."""

    def __init__(self, path: str, text: bytes) -> None:
        self.path, self.text = path, text
        self.starts = [0, *(match.end() for match in re.finditer(rb"\n", text))]
        seen: Counter[str] = Counter()
        self.lines: list[tuple[str, int]] = []
        for line in text.decode().split("\n"):
            self.lines.append((line, seen[line]))
            seen[line] += 1

    def offset(self, line: int, column: int) -> int:
        """Return the byte of a line, from 1, and its column in bytes, as `ast` counts them."""
        return self.starts[line - 1] + column

    def fault(self, kind: str, start: int, end: int, new: str) -> Fault:
        """Return the fault that has `new` for the bytes from `start` to `end`."""
        row = bisect_right(self.starts, start) - 1
        place = Place(self.path, *self.lines[row], start - self.starts[row])
        return Fault(place, start, self.text[start:end].decode(), new, kind)


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
PAIRS = (
    ("min", "max"),
    ("any", "all"),
    ("and_", "or_"),
    ("TRUE", "FALSE"),
    ("lo", "hi"),
    ("start", "end"),
    ("first", "last"),
    ("certain", "possible"),
)
NAMES = dict(PAIRS) | {right: left for left, right in PAIRS} | {"sorted": "list"}
UNWRAPPED = re.compile(r"(^|_)(abs|not_|quote|quoted|escape|escaped)$")
"""Functions whose call is left out, so that their argument stays as it is."""
UNTESTED_ARGUMENTS = {"encoding", "maxsize", "repr", "strict", "timeout"}
UNTESTED_CONDITIONS = re.compile(r"TYPE_CHECKING|__name__|sys\.(version_info|platform)|os\.name")
PICTURES = re.compile(r"(^|[/_])(charts?|diagram|drawing|histograms?|pictures?|plots?|scales?)[/.]")
TYPE_NAME = re.compile(r"_?[A-Z]\w*[a-z]")
TEXTS = (ast.Constant, ast.JoinedStr, ast.List, ast.Tuple, ast.ListComp)


class _Module(ast.NodeVisitor):
    """Every place of one module at which a fault could be, by kind."""

    def __init__(self, path: str, text: bytes) -> None:
        self.text = _Text(path, text)
        self.draws = bool(PICTURES.search(path))
        self.faults: list[Fault] = []

    def _span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        start = self.text.offset(node.lineno, node.col_offset)
        return start, self.text.offset(node.end_lineno, node.end_col_offset)

    def _source(self, node: ast.expr) -> str:
        start, end = self._span(node)
        return self.text.text[start:end].decode()

    def _replace(self, kind: str, node: ast.expr | ast.stmt, new: str) -> None:
        self.faults.append(self.text.fault(kind, *self._span(node), new))

    def _sign(self, kind: str, left: ast.expr, right: ast.expr, signs: tuple[str, str]) -> None:
        """Exchange the operator that stands between two operands."""
        begin, end = self._span(left)[1], self._span(right)[0]
        place = self.text.text[begin:end].find(signs[0].encode())
        if place >= 0 and b"#" not in self.text.text[begin:end]:
            start = begin + place
            self.faults.append(self.text.fault(kind, start, start + len(signs[0]), signs[1]))

    def visit_Compare(self, node: ast.Compare) -> None:
        operands = [node.left, *node.comparators]
        for left, operator, right in zip(operands, node.ops, operands[1:], strict=False):
            self._sign("comparison", left, right, COMPARISONS[type(operator)])
        self.generic_visit(node)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        sides = (node.left, node.right)
        plain = not any(isinstance(side, TEXTS) and not _is_number(side) for side in sides)
        if (
            plain
            and type(node.op) in OPERATORS
            and not (self.draws and any(map(_is_number, sides)))
        ):
            self._sign("operator", node.left, node.right, OPERATORS[type(node.op)])
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        signs = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        if len(node.values) == 2:  # of more, `a or b and c` would group anew
            self._sign("connective", node.values[0], node.values[1], signs)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.Not):
            self._replace("negation", node, f"({self._source(node.operand)})")
        self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:
        if UNTESTED_CONDITIONS.search(self._source(node.test)):
            return
        self._replace("check left out", node.test, "False")
        self.generic_visit(node)

    def visit_match_case(self, node: ast.match_case) -> None:
        if node.guard is not None:
            self._replace("check left out", node.guard, "False")
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
        elif self.draws:
            return
        elif isinstance(node.value, int):
            # One more of a thousand would not be seen; of a factor between units it is ten times.
            new = node.value + 1 if node.value < 1000 else node.value * 10
            self._replace("number", node, str(new))
        elif isinstance(node.value, float):
            self._replace("number", node, repr(node.value * 1000 or 1.0))

    def visit_Name(self, node: ast.Name) -> None:
        if node.id in NAMES and isinstance(node.ctx, ast.Load):
            self._replace("name", node, NAMES[node.id])

    def visit_Attribute(self, node: ast.Attribute) -> None:
        if node.attr in NAMES and isinstance(node.ctx, ast.Load):
            end = self._span(node)[1]
            start = end - len(node.attr)
            self.faults.append(self.text.fault("name", start, end, NAMES[node.attr]))
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        name = self._source(node.func).rpartition(".")[2]
        if UNWRAPPED.search(name) and len(node.args) == 1 and not node.keywords:
            self._replace("call unwrapped", node, f"({self._source(node.args[0])})")
        self.generic_visit(node)

    def visit_keyword(self, node: ast.keyword) -> None:
        if node.arg not in UNTESTED_ARGUMENTS:
            self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Constant):
            return  # a docstring
        if isinstance(node.value, ast.Call) and self._source(node.value.func) != "assert_never":
            self._replace("call left out", node, "pass")
        self.generic_visit(node)

    def visit_Return(self, node: ast.Return) -> None:
        if isinstance(node.value, ast.List | ast.Tuple) and len(node.value.elts) > 1:
            self._replace("entry lost", node.value.elts[-1], self._source(node.value.elts[0]))
        self.generic_visit(node)

    def visit_Assign(self, node: ast.Assign) -> None:
        if not TYPE_NAME.match(self._source(node.targets[0])):
            self.generic_visit(node)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_arguments(self, node: ast.arguments) -> None:
        for default in [*node.defaults, *node.kw_defaults]:
            if default is not None:
                self.visit(default)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        self._body(node.args, *node.body)

    def visit_AsyncFunctionDef(self, node: ast.AsyncFunctionDef) -> None:
        self._body(node.args, *node.body)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        self._body(*node.body)

    def _body(self, *nodes: ast.AST) -> None:
        for node in nodes:
            self.visit(node)

    def visit_Assert(self, node: ast.Assert) -> None:
        """Leave out what is a mistake of ours wherever it is not so."""

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Leave out what stands in a string: its places are not exact before Python 3.12."""


def _is_number(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, int | float)


def of_module(path: str, text: bytes) -> list[Fault]:
    """Return each change that can be made to a Python module; a few of them are no Python."""
    module = _Module(path, text)
    module.visit(ast.parse(text))
    return module.faults


FILTER = re.compile(rb"\{\{[^{}\n]*?(\s*\|\s*[a-z_]+)\s*\}\}")
CONDITION = re.compile(rb"\{%-?\s*(?:el)?if ((?:not )?)")
CODE = re.compile(r"\.(c|h|cpp|hpp|rs|js|mjs|py|java|dfy)\.j2$")
SIGN = re.compile(rb" (<=|>=|<|>|===?|!==?|&&|\|\|) ")
SIGNS = {
    b"<=": "<",
    b">=": ">",
    b"<": "<=",
    b">": ">=",
    b"==": "!=",
    b"!=": "==",
    b"===": "!==",
    b"!==": "===",
    b"&&": "||",
    b"||": "&&",
}


def of_template(path: str, data: bytes) -> list[Fault]:
    """Return filters left out (a quote is no longer escaped), conditions and signs turned."""
    text = _Text(path, data)
    return [
        *(text.fault("filter left out", *m.span(1), "") for m in FILTER.finditer(data)),
        *(
            text.fault("condition", *m.span(1), "" if m[1] else "not ")
            for m in CONDITION.finditer(data)
        ),
        *(
            text.fault("comparison", *m.span(1), SIGNS[m[1]])
            for m in SIGN.finditer(data if CODE.search(path) else b"")
        ),
    ]


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
    """Return the part of the product whose share of lines decides how many faults it gets."""
    parts = path.split("/")
    return "/".join(parts[:2]) if parts[0] in {"compiler", "fretc"} and len(parts) > 2 else parts[0]


def drawn(root: Path, seed: int, count: int) -> list[Fault]:
    """Draw faults, to each room by its share of lines of code, no two on one line.

    Each fault's rank is a hash of the seed and of its place: after a change elsewhere in a file
    nearly the same faults are drawn.
    """
    faults: dict[str, list[Fault]] = {}
    lines: Counter[str] = Counter()
    texts = {path: root.joinpath(path).read_bytes() for path, _ in files(root)}
    for path, places in files(root):
        room = room_of(path)
        lines[room] += sum(1 for line in texts[path].split(b"\n") if line.strip()[:1] not in b"#")
        faults.setdefault(room, []).extend(places(path, texts[path]))
    chosen: list[Fault] = []
    for room, of_room in sorted(faults.items()):
        share = min(count, max(1, round(count * lines[room] / lines.total())))
        each = _by_chance(of_room, seed)
        chosen += islice((fault for fault in each if is_whole(fault, texts[fault.path])), share)
    return chosen


def _by_chance(faults: list[Fault], seed: int) -> Iterator[Fault]:
    """Yield one fault of each line: first a kind, since numbers are many and checks are few."""
    lines: dict[tuple[str, str, int], list[Fault]] = {}
    for fault in faults:
        line = (fault.path, fault.place.line, fault.place.number)
        lines.setdefault(line, []).append(fault)
    for line in sorted(lines, key=lambda line: _digest(seed, *line)):
        yield min(lines[line], key=lambda f: (_digest(seed, *line, f.kind), _digest(seed, f.id)))
