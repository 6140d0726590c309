"""Comparison of statements with those that fretc writes."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from functools import cache


class UnexpectedStatementError(Exception):
    """The text contains code that the generator does not write, or that is not allowed."""


def require(right: bool, node: ast.AST) -> None:
    """Raise UnexpectedCodeError, with the line of the node, unless the condition holds."""
    if not right:
        line = (ast.unparse(node).splitlines() or ["nothing"])[0]
        raise UnexpectedStatementError(f"it is not laid out as fretc writes it: `{line}`")


@cache
def normal(text: str) -> str:
    """A statement or an expression as `ast.unparse` writes it."""
    return ast.unparse(ast.parse(text))


def is_one_of(node: ast.AST, *texts: str) -> bool:
    """Require that the node is one of these statements or expressions."""
    own = ast.unparse(node)
    return any(own == normal(text) for text in texts)


def reads(statements: Sequence[ast.stmt], text: str) -> bool:
    """Require that the statements are those of the text."""
    return "\n".join(map(ast.unparse, statements)) == normal(text)


def is_same(text: str, other: str) -> bool:
    """Whether both texts are one program except for comments and white space."""
    try:
        return text == other or ast.dump(ast.parse(text)) == ast.dump(ast.parse(other))
    except (SyntaxError, ValueError, RecursionError):
        return False


def constants(node: ast.AST) -> tuple[object, ...]:
    """The values of a tuple of constants."""
    require(isinstance(node, ast.Tuple), node)
    assert isinstance(node, ast.Tuple)
    for part in node.elts:
        require(isinstance(part, ast.Constant), part)
    return tuple(part.value for part in node.elts if isinstance(part, ast.Constant))


def names_in(node: ast.AST) -> tuple[str, ...]:
    """The values of a tuple of texts."""
    values = constants(node)
    names = tuple(value for value in values if isinstance(value, str))
    require(names == values, node)
    return names


def body_of(node: ast.stmt, name: str, arguments: str, *decorators: str) -> list[ast.stmt]:
    """The statements of a function below its docstring; there is at least one."""
    require(isinstance(node, ast.FunctionDef), node)
    assert isinstance(node, ast.FunctionDef)
    require(node.name == name and not getattr(node, "type_params", ()), node)
    require(ast.unparse(node.args) == _arguments(arguments), node.args)
    require([ast.unparse(d) for d in node.decorator_list] == [*decorators], node)
    body = below_docstring(node)
    require(bool(body), node)
    return body


@cache
def _arguments(text: str) -> str:
    function = ast.parse(f"def f({text}): pass").body[0]
    assert isinstance(function, ast.FunctionDef)
    return ast.unparse(function.args)


def below_docstring(node: ast.FunctionDef | ast.ClassDef) -> list[ast.stmt]:
    """The statements after the docstring, if there is one."""
    return node.body[1:] if ast.get_docstring(node) is not None else node.body
