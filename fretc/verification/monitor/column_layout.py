"""The layout of a generated monitor's column program: named columns, then its signals."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Sequence

from fretc.verification.monitor.statements import body_of, require

_COLUMNS = frozenset(
    "previous weak_previous once historically since released since_from since_between "
    "released_between".split()
)
"""Functions that a column program may call."""


def check_columns(node: ast.stmt, literals: Sequence[str]) -> None:
    """Check that a function defines columns and returns signals, and does nothing else.

    Args:
        node: the function.
        literals: names of its parameters.

    Raises:
        UnexpectedCodeError: it does something else.
    """
    parameters = ", ".join(f"{name}: int" for name in literals)
    arguments = f"every: int, *, {parameters}" if literals else "every: int"
    *body, last = body_of(node, "columns", arguments, "staticmethod")
    bound = {"every", *literals}
    for statement in body:
        match statement:
            case ast.Assign([ast.Name(name)], value):
                require(name not in bound and name not in {*_COLUMNS, "Signals"}, statement)
                _check_column(value, bound)
                bound.add(name)
            case _:
                require(False, statement)
    match last:
        case ast.Return(ast.Tuple(entries)):
            for entry in entries:
                match entry:
                    case ast.Call(ast.Name("Signals"), [], keywords):
                        for keyword in keywords:
                            _check_column(keyword.value, bound)
                    case _:
                        require(False, entry)
        case _:
            require(False, last)


def _check_column(node: ast.expr, bound: Iterable[str]) -> None:
    match node:
        case ast.Name(name):
            require(name in bound, node)
        case ast.Constant(value):
            require(value is None or isinstance(value, int), node)
        case ast.BinOp(left, ast.BitAnd() | ast.BitOr(), right):
            _check_column(left, bound)
            _check_column(right, bound)
        case ast.Call(ast.Name(name), args, []):
            require(name in _COLUMNS, node)
            for arg in args:
                _check_column(arg, bound)
        case _:
            require(False, node)
