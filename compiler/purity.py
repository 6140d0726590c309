"""Whether the core of an interceptor is pure: then what is explored of it is all that it does.

What the tree may consist of is listed here; all else is told. There is no loop and no recursion, so
every step ends; no attribute is written, no name bound twice, nothing called but the core's own
functions and constructors, `min`, `max` and `replace`. No object is told from another that is equal
to it, and no constant is read but `ZERO`, so that a state is its values. The node below the core is
one that fretc writes, up to its numbers and texts: nothing else is known to leave the core alone.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from types import ModuleType
from typing import Any

from compiler.layout import is_utf8
from compiler.targets import interceptor
from compiler.targets.interceptor import MARKER
from fretish.declarations import Form, Interception
from monitors.loading import executed

_IMPORTS = {
    "__future__": {"annotations"},
    "dataclasses": {"dataclass", "replace"},
    "typing": {"NamedTuple"},
}
_NEEDED = (
    "ZERO Velocity Options State StopHeard CommandHeard ScanHeard TimerRang initial halted step"
).split()
_BUILTINS = frozenset({"min", "max", "bool", "int", "float"})
_CALLED = frozenset({"min", "max", "replace"})


class _StrangeError(Exception):
    """What is not on the list."""


@dataclass(frozen=True, slots=True)
class Head:
    """The text of a core that is known to be pure, without the node below it."""

    text: str


@dataclass(frozen=True, slots=True)
class Core:
    """The core, executed."""

    module: Any
    """A module; its attributes are classes, functions and constants."""


def core(text: str, name: str = "interceptor") -> Core | str:
    """Execute the core of an interceptor once it is known to be pure; else, why it is not.

    Args:
        text: what `--emit interceptor` wrote, or the core alone.
        name: for tracebacks.
    """
    known = head(text)
    if isinstance(known, str):
        return known
    try:
        module: ModuleType = executed(known.text, name)
    except Exception as error:
        return f"it cannot be executed: {type(error).__name__}: {error}"
    return Core(module)


def head(text: str) -> Head | str:
    """The core of an interceptor where it is pure; else, why it is not. Nothing is executed.

    Args:
        text: what `--emit interceptor` wrote, or the core alone.
    """
    if not is_utf8(text):
        return "Python reads it in another encoding than UTF-8"
    above, marked, node = text.partition(f"{MARKER}\n")
    try:
        tree = ast.parse(above)
        missing = [name for name in _NEEDED if name not in _defined(tree)]
        if missing:
            return f"its core has no `{missing[0]}`"
        names = _Module().check(tree)
        if marked and "OPTIONS" not in names:
            return "its core has no `OPTIONS`"
        if marked:
            _check_node(node)
    except (SyntaxError, ValueError, RecursionError) as error:
        return f"it is no Python: {error}"
    except _StrangeError as error:
        return f"its core is not as fretc can read it: {error}"
    return Head(above)


def _defined(tree: ast.Module) -> Iterator[str]:
    """Classes, functions and constants, without a look at what they are."""
    for node in tree.body:
        match node:
            case ast.ClassDef(name) | ast.FunctionDef(name) | ast.Assign([ast.Name(name)]):
                yield name


def _strange(node: ast.AST) -> _StrangeError:
    return _StrangeError(f"`{_line(node)}`")


def _demand(right: bool, node: ast.AST) -> None:
    if not right:
        raise _strange(node)


def _check_node(node: str) -> None:
    """It is one that fretc writes, up to its numbers and texts.

    Python has no end of ways to change a module from below, so that nothing else is looked into.
    """
    if _shape(node) not in _shapes():
        raise _StrangeError("the node below it is not one that fretc writes")


@cache
def _shapes() -> frozenset[str]:
    """Of the nodes for each ROS and form, with and without a scan."""
    made = (
        Interception("/a", "/b", "/c", scan, 10**8, form=form, ros=ros)
        for scan in (None, "/d")
        for form in Form
        for ros in (1, 2)
    )
    texts = (interceptor.text(one, "bindings.toml") for one in made)
    return frozenset(_shape(each.partition(f"{MARKER}\n")[2]) for each in texts)


def _shape(node: str) -> str:
    """Its tree without what constants say."""
    return ast.dump(_Blank().visit(ast.parse(node)))


class _Blank(ast.NodeTransformer):
    def visit_Constant(self, node: ast.Constant) -> ast.Constant:
        return ast.Constant(type(node.value).__name__)


def _line(node: ast.AST) -> str:
    return (ast.unparse(node).splitlines() or ["nothing"])[0]


class _Module:
    """The statements of the core."""

    def __init__(self) -> None:
        self.bound: set[str] = set()
        self.classes: set[str] = set()
        self.unread: set[str] = {"dataclass", "NamedTuple"}
        """Names that no function may use."""
        self.functions: dict[str, set[str]] = {}
        """What each of them calls."""

    def check(self, tree: ast.Module) -> frozenset[str]:
        """The names that it binds."""
        _demand(any(_is_future(node) for node in tree.body), tree)
        self._collect(tree)
        for node in tree.body:
            self._statement(node)
        for name in self.functions:
            self._ends(name, ())
        return frozenset(self.bound)

    def _collect(self, tree: ast.Module) -> None:
        for node in tree.body:
            match node:
                case ast.ClassDef(name):
                    self.classes.add(name)
                case ast.FunctionDef(name):
                    self.functions[name] = set()

    def _statement(self, node: ast.stmt) -> None:
        match node:
            case ast.Expr(ast.Constant(str())):
                return
            case ast.ImportFrom(str(module), aliases, 0):
                known = _IMPORTS.get(module, set())
                _demand(all(a.name in known and a.asname is None for a in aliases), node)
                for alias in aliases:
                    self._bind(alias.name, node)
            case ast.ClassDef(name):
                self._bind(name, node)
                _check_class(node)
            case ast.FunctionDef(name):
                self._bind(name, node)
                _Function(self, node).check()
            case ast.Assign([ast.Name(name)], ast.Call(ast.Name(maker), args, keywords)):
                _demand(maker in self.classes, node)
                values = [*args, *(keyword.value for keyword in keywords)]
                _demand(all(isinstance(value, ast.Constant) for value in values), node)
                self._constant(name, maker, plain=not values, node=node)
            case _:
                raise _strange(node)

    def _constant(self, name: str, maker: str, *, plain: bool, node: ast.AST) -> None:
        """`ZERO` is what it is called; any other is an option of the node."""
        self._bind(name, node)
        if name == "ZERO":
            _demand(maker == "Velocity" and plain, node)
        else:
            self.unread.add(name)

    def _bind(self, name: str, node: ast.AST) -> None:
        _demand(name not in self.bound and name not in _BUILTINS, node)
        self.bound.add(name)

    def _ends(self, name: str, above: tuple[str, ...]) -> None:
        """It does not come to call itself."""
        if name in above:
            raise _StrangeError(f"`{name}` calls itself")
        for called in self.functions[name]:
            self._ends(called, (*above, name))


def _is_future(node: ast.stmt) -> bool:
    """With it annotations are not evaluated."""
    return isinstance(node, ast.ImportFrom) and node.module == "__future__"


def _check_class(node: ast.ClassDef) -> None:
    """Fields with or without a constant, in a frozen dataclass or a NamedTuple."""
    written = [ast.unparse(part) for part in (*node.decorator_list, *node.bases)]
    _demand(written in (["dataclass(frozen=True, slots=True)"], ["NamedTuple"]), node)
    _demand(len(node.bases) == (written == ["NamedTuple"]) and not node.keywords, node)
    for part in node.body:
        match part:
            case ast.Expr(ast.Constant(str())):
                pass
            case ast.AnnAssign(ast.Name(name), _, None | ast.Constant()):
                _demand(not name.startswith("_"), part)
            case _:
                raise _strange(part)


class _Function:
    """One function: its statements and expressions."""

    def __init__(self, module: _Module, node: ast.FunctionDef) -> None:
        self.module, self.node = module, node
        self.local = {argument.arg for argument in node.args.args}

    def check(self) -> None:
        """It is pure and ends."""
        node, given = self.node, self.node.args
        plain = not (given.vararg or given.kwarg or given.kwonlyargs or given.posonlyargs)
        _demand(plain and not given.defaults and not node.decorator_list, node)
        for name in self.local:
            self._local(name, node)
        self._body(node.body)

    def _local(self, name: str, node: ast.AST) -> None:
        _demand(name not in {*self.module.classes, *self.module.functions, *_BUILTINS}, node)
        _demand(name not in _CALLED, node)
        self.local.add(name)

    def _body(self, statements: list[ast.stmt]) -> None:
        for node in statements:
            match node:
                case ast.Expr(ast.Constant(str())) | ast.Pass() | ast.Return(None):
                    pass
                case ast.Return(ast.expr() as value):
                    self._expression(value)
                case ast.Assign([ast.Name(name)], value) | ast.AnnAssign(
                    ast.Name(name), _, ast.expr() as value
                ):
                    self._expression(value)
                    self._local(name, node)
                case ast.If(test, body, orelse):
                    self._expression(test)
                    self._body(body)
                    self._body(orelse)
                case ast.Match(subject, cases):
                    self._expression(subject)
                    for case in cases:
                        self._case(case)
                case _:
                    raise _strange(node)

    def _case(self, case: ast.match_case) -> None:
        for part in ast.walk(case.pattern):
            match part:
                case ast.MatchClass(ast.Name(name), _, keywords):
                    _demand(name in self.module.classes, part)
                    _demand(not any(word.startswith("_") for word in keywords), part)
                case ast.MatchAs(name=name):
                    if name is not None:
                        self._local(name, part)
                case ast.MatchValue(ast.Constant()) | ast.MatchOr():
                    pass
                case ast.Name() | ast.Constant() | ast.expr_context():
                    pass
                case _:
                    raise _strange(case.pattern)
        if case.guard is not None:
            self._expression(case.guard)
        self._body(case.body)

    def _expression(self, node: ast.expr) -> None:
        for part in _parts(node):
            self._expression(part)
        match node:
            case ast.Name(name):
                known = {*self.local, *self.module.bound}
                _demand(name in known and name not in self.module.unread, node)
            case ast.Attribute(_, name):
                _demand(not name.startswith("_"), node)
            case ast.Compare(_, operators):
                _demand(not any(isinstance(o, ast.Is | ast.IsNot) for o in operators), node)
            case ast.BinOp(_, ast.Add() | ast.Sub(), _) | ast.BoolOp() | ast.IfExp():
                pass
            case ast.Constant() | ast.UnaryOp() | ast.Tuple(ctx=ast.Load()):
                pass
            case ast.Call(ast.Name(name), args, keywords):
                _demand(name in _CALLED or name in {*self.module.functions, *self._makers()}, node)
                _demand(not any(isinstance(arg, ast.Starred) for arg in args), node)
                _demand(all(keyword.arg is not None for keyword in keywords), node)
                if name in self.module.functions:
                    self.module.functions[self.node.name].add(name)
            case _:
                raise _strange(node)

    def _makers(self) -> set[str]:
        return self.module.classes


def _parts(node: ast.expr) -> Iterator[ast.expr]:
    """The expressions in it; what is called is looked at where it is called."""
    for child in ast.iter_child_nodes(node):
        if isinstance(node, ast.Call) and child is node.func:
            continue
        if isinstance(child, ast.keyword):
            yield child.value
        elif isinstance(child, ast.expr):
            yield child
