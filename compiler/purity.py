"""Whether the core of an interceptor is pure: then what is explored of it is all that it does.

What the tree may consist of is listed here, and all else is refused, before anything is executed.
There is no loop and no recursion, so every step ends; no attribute is written, no name bound twice,
nothing called but the core's own functions and constructors, `min`, `max` and `replace`, and no
function is a value. No object is told from another that is equal to it, and no constant is read but
`ZERO`, so that a state is its values. Annotations are types and nothing else: other programs
evaluate them. The node below the core is one that fretc writes, up to its numbers and texts
(`otherwise` compares these too), and binds no name of the core: both are one module when it flies.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from math import isfinite
from types import ModuleType
from typing import Any

from compiler.layout import is_utf8
from compiler.runtime import ALONE
from compiler.runtime import interceptor as original
from compiler.targets import interceptor
from compiler.targets.interceptor import MARKER
from fretish.declarations import Form, Interception
from monitors.loading import executed

_IMPORTS = {
    "dataclasses": {"dataclass", "replace"},
    "typing": {"NamedTuple"},
}
_NEEDED = (
    "ZERO Velocity Options State StopHeard CommandHeard ScanHeard TimerRang initial halted step"
).split()
_BUILTINS = frozenset(dir(builtins))
"""No name of them is given to anything else: the node below uses them too."""
_CHOSEN = frozenset({"min", "max"})
_CALLED = _CHOSEN | {"replace"}
_TYPES = frozenset({"bool", "int", "float"})
_NOT_FIELDS = frozenset(name for kind in (bool, int, float, tuple, str) for name in dir(kind))
"""What numbers and tuples have themselves. Methods tell equal numbers apart: `x.real is y.real`."""
_UNARY = (ast.Not, ast.USub)
_COMPARED = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq)


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
            if not _is_guarded(tree):
                return "it may import what stands beside it: emit it again"
            _check_node(node)
            _check_whole(text, tree, node)
    except (SyntaxError, ValueError, RecursionError) as error:
        return f"it is no Python: {error}"
    except _StrangeError as error:
        return f"its core is not as fretc can read it: {error}"
    return Head(above)


def otherwise(text: str, interception: Interception) -> str | None:
    """Why the file is of another interceptor than the bindings declare; None: it is of this one.

    The core may be another: it is what is looked at. Its options and the node around it may not.
    """
    try:
        options, node = _around(text)
    except (SyntaxError, ValueError, RecursionError) as error:
        return f"it is no Python: {error}"
    declared, written = _around(interceptor.text(interception, "bindings.toml"))
    if (options, node) == ([], None):
        return None
    if options != declared:
        return "its options are not those that the bindings declare: emit it again"
    if node != written:
        return "its node is not one that fretc writes for these bindings: emit it again"
    return None


def _around(text: str) -> tuple[list[str], str | None]:
    """What binds `OPTIONS`, and the node (None: there is none), to the letter but for comments."""
    above, marked, node = text.partition(f"{MARKER}\n")
    statements = map(ast.unparse, ast.parse(above).body)
    options = [each for each in statements if each.startswith("OPTIONS")]
    return options, ast.dump(ast.parse(node)) if marked else None


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


def _check_whole(text: str, core: ast.Module, node: str) -> None:
    """Core and node are the module, one below the other."""
    parts = [*core.body, *ast.parse(node).body]
    if [ast.dump(part) for part in ast.parse(text).body] != [ast.dump(part) for part in parts]:
        raise _StrangeError("core and node are not one below the other")


@cache
def _nodes() -> tuple[str, ...]:
    """Those that fretc writes for each ROS and form, with and without a scan."""
    made = (
        Interception("/a", "/b", "/c", scan, 10**8, form=form, ros=ros)
        for scan in (None, "/d")
        for form in Form
        for ros in (1, 2)
    )
    texts = (interceptor.text(one, "bindings.toml") for one in made)
    return tuple(each.partition(f"{MARKER}\n")[2] for each in texts)


@cache
def _shapes() -> frozenset[str]:
    return frozenset(map(_shape, _nodes()))


@cache
def _names_of_nodes() -> frozenset[str]:
    """What a node binds at its outermost level: a core that has it too is another one in flight."""
    return frozenset(name for node in _nodes() for name in _outermost(ast.parse(node)))


def _outermost(node: ast.AST) -> Iterator[str]:
    """The names that statements bind, without those inside of functions and classes."""
    for child in ast.iter_child_nodes(node):
        match child:
            case ast.FunctionDef(name) | ast.AsyncFunctionDef(name) | ast.ClassDef(name):
                yield name
            case ast.alias(name, other):
                yield (other or name).partition(".")[0]
            case ast.Name(name, ast.Store() | ast.Del()):
                yield name
            case ast.ExceptHandler(name=str() as name):
                yield name
                yield from _outermost(child)
            case _:
                yield from _outermost(child)


@cache
def _velocity() -> str:
    """The class of that name as fretc writes it: six numbers, all of them 0.0 by default."""
    (found,) = (n for n in ast.parse(original().text).body if _is_class(n, "Velocity"))
    return ast.dump(_bare(found))


def _is_class(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.ClassDef) and node.name == name


def _bare(node: ast.AST) -> ast.Module:
    """The statements of a class without texts: they do nothing."""
    assert isinstance(node, ast.ClassDef)
    body = [part for part in node.body if not _is_docstring(part)]
    return ast.Module([ast.ClassDef(node.name, node.bases, [], body, [])], [])


def _is_docstring(node: ast.AST) -> bool:
    match node:
        case ast.Expr(ast.Constant(str())):
            return True
        case _:
            return False


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
        self.fields: set[str] = set()
        """Of all classes."""
        self.functions: dict[str, set[str]] = {}
        """What each of them calls."""

    def check(self, tree: ast.Module) -> frozenset[str]:
        """The names that it binds."""
        self._collect(tree)
        for node in _below_the_guard(tree):
            self._statement(node)
        self._check_ends()
        return frozenset(self.bound)

    def _collect(self, tree: ast.Module) -> None:
        for node in tree.body:
            match node:
                case ast.ClassDef(name, body=body):
                    self.classes.add(name)
                    self.fields |= {
                        part.target.id
                        for part in body
                        if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name)
                    }
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
                self._class(node)
            case ast.FunctionDef(name):
                self._bind(name, node)
                _Function(self, node).check()
            case ast.Assign([ast.Name(name)], ast.Call(ast.Name(maker), args, keywords)):
                _demand(maker in self.classes, node)
                values = [*args, *(keyword.value for keyword in keywords)]
                _demand(all(map(_is_number, values)), node)
                _demand(all(keyword.arg is not None for keyword in keywords), node)
                self._bind(name, node)
                if name == "ZERO":
                    _demand(maker == "Velocity" and not values, node)
            case _:
                raise _strange(node)

    def _bind(self, name: str, node: ast.AST) -> None:
        _demand(name not in self.bound and name not in _BUILTINS, node)
        _demand(not name.startswith("_") and name not in _names_of_nodes(), node)
        self.bound.add(name)

    def _class(self, node: ast.ClassDef) -> None:
        """Fields with or without a constant, in a frozen dataclass or a NamedTuple."""
        written = [ast.unparse(part) for part in (*node.decorator_list, *node.bases)]
        _demand(written in (["dataclass(frozen=True, slots=True)"], ["NamedTuple"]), node)
        _demand(len(node.bases) == (written == ["NamedTuple"]) and not node.keywords, node)
        _demand(not getattr(node, "type_params", ()), node)
        for part in node.body:
            match part:
                case ast.Expr(ast.Constant(str())):
                    pass
                case ast.AnnAssign(ast.Name(name), annotation, value):
                    _demand(not name.startswith("_") and name not in _NOT_FIELDS, part)
                    _demand(value is None or _is_number(value), part)
                    self.check_type(annotation, part)
                case _:
                    raise _strange(part)
        if node.name == "Velocity":
            _demand(ast.dump(_bare(node)) == _velocity(), node)

    def check_type(self, annotation: ast.expr | None, node: ast.AST) -> None:
        """It names types and does nothing, whoever evaluates it."""
        match annotation:
            case None | ast.Constant(None):
                pass
            case ast.Name(name):
                _demand(name in _TYPES or name in self.classes, node)
            case ast.BinOp(left, ast.BitOr(), right):
                self.check_type(left, node)
                self.check_type(right, node)
            case ast.Subscript(ast.Name("tuple"), ast.Tuple(parts)):
                for part in parts:
                    self.check_type(part, node)
            case _:
                raise _strange(node)

    def _check_ends(self) -> None:
        """No function comes to call itself."""
        ends: set[str] = set()
        rest = set(self.functions)
        while found := {name for name in rest if self.functions[name] <= ends}:
            ends |= found
            rest -= found
        if rest:
            raise _StrangeError(f"`{self._in_a_circle(min(rest), rest)}` calls itself")

    def _in_a_circle(self, name: str, rest: set[str]) -> str:
        """One that calls itself; each of `rest` calls another one of them."""
        seen: set[str] = set()
        while name not in seen:
            seen.add(name)
            name = min(self.functions[name] & rest)
        return name


def _is_guarded(tree: ast.Module) -> bool:
    """Whether nothing beside the file is imported in place of the standard library."""
    guard = ast.parse(ALONE).body
    return list(map(ast.dump, tree.body[: len(guard)])) == list(map(ast.dump, guard))


def _below_the_guard(tree: ast.Module) -> list[ast.stmt]:
    return tree.body[len(ast.parse(ALONE).body) :] if _is_guarded(tree) else tree.body


def _is_number(node: ast.AST) -> bool:
    """A constant that is a finite number, a truth value or None."""
    match node:
        case ast.Constant(None | bool() | int()):
            return True
        case ast.Constant(float(value)):
            return isfinite(value)
        case _:
            return False


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
        _demand(not getattr(node, "type_params", ()), node)
        for annotation in (node.returns, *(argument.annotation for argument in given.args)):
            self.module.check_type(annotation, node)
        for name in self.local:
            self._local(name, node)
        self._body(node.body)

    def _local(self, name: str, node: ast.AST) -> None:
        _demand(name not in {*self.module.classes, *self.module.functions, *_BUILTINS}, node)
        _demand(name not in _CALLED and not name.startswith("_"), node)
        self.local.add(name)

    def _body(self, statements: list[ast.stmt]) -> None:
        for node in statements:
            match node:
                case ast.Expr(ast.Constant(str())) | ast.Pass() | ast.Return(None):
                    pass
                case ast.Return(ast.expr() as value):
                    self._expression(value)
                case ast.Assign([ast.Name(name)], value):
                    self._expression(value)
                    self._local(name, node)
                case ast.AnnAssign(ast.Name(name), annotation, ast.expr() as value):
                    self.module.check_type(annotation, node)
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
        self._pattern(case.pattern, case.pattern)
        if case.guard is not None:
            self._expression(case.guard)
        self._body(case.body)

    def _pattern(self, node: ast.pattern, whole: ast.pattern) -> None:
        match node:
            case ast.MatchClass(ast.Name(name), patterns, words, named):
                _demand(name in self.module.classes, node)
                _demand(all(word in self.module.fields for word in words), node)
                for part in (*patterns, *named):
                    self._pattern(part, whole)
            case ast.MatchAs(pattern, name):
                if name is not None:
                    self._local(name, node)
                if pattern is not None:
                    self._pattern(pattern, whole)
            case ast.MatchValue(value):
                _demand(_is_number(value), node)
            case ast.MatchOr(patterns):
                for part in patterns:
                    self._pattern(part, whole)
            case _:
                raise _strange(whole)

    def _expression(self, node: ast.expr) -> None:
        """A name is a value: no function is one, so that nothing is called but by its name."""
        match node:
            case ast.Name(name):
                _demand(name in self.local or name == "ZERO", node)
            case ast.Attribute(ast.Name() | ast.Attribute() as value, name):
                _demand(name in self.module.fields, node)
                self._expression(value)
            case ast.Compare(left, operators, rest):
                _demand(all(isinstance(operator, _COMPARED) for operator in operators), node)
                self._expressions(left, *rest)
            case ast.BinOp(left, ast.Add() | ast.Sub(), right):
                self._expressions(left, right)
            case ast.BoolOp(_, values) | ast.Tuple(values, ast.Load()):
                self._expressions(*values)
            case ast.IfExp(test, body, orelse):
                self._expressions(test, body, orelse)
            case ast.UnaryOp(operator, arg):
                _demand(isinstance(operator, _UNARY), node)
                self._expression(arg)
            case ast.Constant():
                _demand(_is_number(node), node)
            case ast.Call(ast.Name(name), args, keywords):
                self._call(node, name, len(args), [keyword.arg for keyword in keywords])
                self._expressions(*args, *(keyword.value for keyword in keywords))
            case _:
                raise _strange(node)

    def _expressions(self, *nodes: ast.expr) -> None:
        for node in nodes:
            self._expression(node)

    def _call(self, node: ast.Call, name: str, count: int, words: list[str | None]) -> None:
        """What is called, with so many arguments by place and these by name."""
        named = all(word is not None and not word.startswith("_") for word in words)
        if name in self.module.classes:
            _demand(named, node)
        elif name in self.module.functions:
            _demand(not words, node)
            self.module.functions[self.node.name].add(name)
        elif name in _CHOSEN:
            _demand(count >= 2 and not words, node)
        else:
            _demand(name == "replace" and count == 1 and named, node)
