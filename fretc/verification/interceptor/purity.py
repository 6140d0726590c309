"""Check that the core of an interceptor is pure, so that exploring it covers its behaviour.

The allowed syntax is listed here, and everything else is refused before anything is executed. There
is no loop and no recursion, so every step ends; no attribute is written, no name bound twice,
nothing called except the core's own functions and constructors, `min`, `max`, `replace` and
`isinstance`, and no function is a value. No statement distinguishes equal objects, and `ZERO` is
the only constant that is read, so that a state is the values of its fields. Annotations only name
types, because other programs evaluate them.
"""

from __future__ import annotations

import ast
import builtins
from collections.abc import Collection
from functools import cache
from math import isfinite

from fretc.verification.monitor.statements import UnexpectedStatementError
from monitors.source_text import ALONE
from monitors.source_text import interceptor as original

_IMPORTS = {
    "dataclasses": {"dataclass", "replace"},
    "typing": {"NamedTuple"},
}
_BUILTINS = frozenset(dir(builtins))
"""Names that the core must not rebind, because the node below uses them too."""
_CHOSEN = frozenset({"min", "max"})
_CALLED = _CHOSEN | {"replace"}
_TYPES = frozenset({"bool", "int", "float"})
_NOT_FIELDS = frozenset(name for kind in (bool, int, float, tuple, str) for name in dir(kind))
"""Attributes of numbers and tuples. Methods distinguish equal numbers: `x.real is y.real`."""
_KINDS = (["dataclass(frozen=True)"], ["dataclass(frozen=True, slots=True)"], ["NamedTuple"])
"""Decorators or bases of a class; Python 3.8 has no `slots`."""
_UNARY = (ast.Not, ast.USub)
_COMPARED = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq)


def bound_names(tree: ast.Module, taken: Collection[str]) -> frozenset[str]:
    """The names that a core binds; checks that it is pure.

    Args:
        tree: syntax tree of the core.
        taken: names that it must not bind.

    Raises:
        UnexpectedCodeError: it may not be pure, or binds such a name.
    """
    return _Module(taken).check(tree)


def _strange(node: ast.AST) -> UnexpectedStatementError:
    return UnexpectedStatementError(f"`{_line(node)}`")


def _demand(right: bool, node: ast.AST) -> None:
    if not right:
        raise _strange(node)


def _line(node: ast.AST) -> str:
    return (ast.unparse(node).splitlines() or ["nothing"])[0]


@cache
def _velocity() -> str:
    """Check that the class is the one that fretc writes: six numbers, 0.0 by default."""
    (velocity,) = (n for n in ast.parse(original().text).body if _is_class(n, "Velocity"))
    return ast.dump(_bare(velocity))


def _is_class(node: ast.AST, name: str) -> bool:
    return isinstance(node, ast.ClassDef) and node.name == name


def _bare(node: ast.AST) -> ast.Module:
    """Statements of a class without docstrings."""
    assert isinstance(node, ast.ClassDef)
    body = [part for part in node.body if not _is_docstring(part)]
    return ast.Module([ast.ClassDef(node.name, node.bases, [], body, [])], [])


def _is_docstring(node: ast.AST) -> bool:
    match node:
        case ast.Expr(ast.Constant(str())):
            return True
        case _:
            return False


def is_guarded(tree: ast.Module) -> bool:
    """Whether no module beside the file can replace the standard library."""
    guard = ast.parse(ALONE).body
    return list(map(ast.dump, tree.body[: len(guard)])) == list(map(ast.dump, guard))


def below_the_guard(tree: ast.Module) -> list[ast.stmt]:
    """The statements without those of `is_guarded`."""
    return tree.body[len(ast.parse(ALONE).body) :] if is_guarded(tree) else tree.body


class _Module:
    """The statements of the core."""

    def __init__(self, taken: Collection[str]) -> None:
        self.taken = taken
        self.bound: set[str] = set()
        self.classes: set[str] = set()
        self.fields: set[str] = set()
        """Fields of all classes."""
        self.functions: dict[str, set[str]] = {}
        """Function → functions that it calls."""

    def check(self, tree: ast.Module) -> frozenset[str]:
        """Check the statements; returns the names that they bind."""
        self._collect(tree)
        for node in below_the_guard(tree):
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
        _demand(not name.startswith("_") and name not in self.taken, node)
        self.bound.add(name)

    def _class(self, node: ast.ClassDef) -> None:
        """Check a class: fields with or without a constant, in a frozen dataclass or NamedTuple."""
        written = [ast.unparse(part) for part in (*node.decorator_list, *node.bases)]
        _demand(written in _KINDS, node)
        _demand(len(node.bases) == (written == ["NamedTuple"]) and not node.keywords, node)
        _demand(bool(node.bases) == (node.name == "Velocity"), node)
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
        """Check that an annotation only names types."""
        match annotation:
            case None | ast.Constant(None):
                pass
            case ast.Name(name):
                _demand(name in _TYPES or name in self.classes, node)
            case ast.Constant(str(text)):  # Python 3.8 cannot evaluate `|` and `tuple[...]`.
                self.check_type(_parsed(text, node), node)
            case ast.BinOp(left, ast.BitOr(), right):
                self.check_type(left, node)
                self.check_type(right, node)
            case ast.Subscript(ast.Name("tuple"), ast.Tuple(parts)):
                for part in parts:
                    self.check_type(part, node)
            case _:
                raise _strange(node)

    def _check_ends(self) -> None:
        """Check that no function is recursive."""
        ends: set[str] = set()
        rest = set(self.functions)
        while free := {name for name in rest if self.functions[name] <= ends}:
            ends |= free
            rest -= free
        if rest:
            raise UnexpectedStatementError(f"`{self._in_a_circle(min(rest), rest)}` calls itself")

    def _in_a_circle(self, name: str, rest: set[str]) -> str:
        """A recursive function among `rest`; each of them calls another one of them."""
        visited: set[str] = set()
        while name not in visited:
            visited.add(name)
            name = min(self.functions[name] & rest)
        return name


def _parsed(annotation: str, node: ast.AST) -> ast.expr:
    try:
        return ast.parse(annotation, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise _strange(node) from None


def _is_number(node: ast.AST) -> bool:
    """Whether the node is a constant finite number, truth value or None."""
    match node:
        case ast.Constant(None | bool() | int()):
            return True
        case ast.Constant(float(value)):
            return isfinite(value)
        case _:
            return False


class _Function:
    """Statements and expressions of one function."""

    def __init__(self, module: _Module, node: ast.FunctionDef) -> None:
        self.module, self.node = module, node
        self.local = {argument.arg for argument in node.args.args}

    def check(self) -> None:
        """Check that the function is pure and ends."""
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
        """Check an expression; functions are not values, so that calls are by name only."""
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
            case ast.Call(ast.Name("isinstance"), [value, ast.Name(kind)], []):
                # A `Velocity` equals a tuple of its numbers, which is none.
                _demand(kind in self.module.classes - {"Velocity"}, node)
                self._expression(value)
            case ast.Call(ast.Name(name), args, keywords):
                self._call(node, name, len(args), [keyword.arg for keyword in keywords])
                self._expressions(*args, *(keyword.value for keyword in keywords))
            case _:
                raise _strange(node)

    def _expressions(self, *nodes: ast.expr) -> None:
        for node in nodes:
            self._expression(node)

    def _call(self, node: ast.Call, name: str, count: int, words: list[str | None]) -> None:
        """Check the callee and the number and names of its arguments."""
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
