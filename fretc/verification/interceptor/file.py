"""An interceptor's file: a core, its options, and the node below; deployed as one module.

The core may be any pure code (`fretc.verification.interceptor.purity`), so that exploring it covers
its behaviour. Its options and the node must be those that fretc writes for the bindings, and the
core must not bind a name of the node.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from types import ModuleType
from typing import Any

from compiler.targets.python import interceptor
from compiler.targets.python.interceptor import MARKER
from fretc.verification.interceptor.purity import bound_names, is_guarded
from fretc.verification.monitor.statements import UnexpectedStatementError
from fretish.bindings.declarations import Interception, InterceptorForm
from fretish.classes.frozen import dataclass
from fretish.reading.text_encoding import is_utf8
from monitors.loading import executed
from monitors.source_text import interceptor as original

_NEEDED = (
    "ZERO Velocity Options State StopHeard CommandHeard ScanHeard TimerRang initial halted step"
).split()


@dataclass(frozen=True, slots=True)
class PureCore:
    """Text of a pure core, without the node below it."""

    text: str


@dataclass(frozen=True, slots=True)
class Core:
    """The executed core."""

    module: Any
    """A module with classes, functions and constants as attributes."""


def core(text: str, name: str = "interceptor") -> Core | str:
    """Execute the core of an interceptor if it is pure; else, why it is not.

    Args:
        text: output of `--emit interceptor`, or the core alone.
        name: module name for tracebacks.
    """
    known = head(text)
    if isinstance(known, str):
        return known
    try:
        module: ModuleType = executed(known.text, name)
    except Exception as error:
        return f"it cannot be executed: {type(error).__name__}: {error}"
    return Core(module)


def head(text: str) -> PureCore | str:
    """The core of an interceptor if it is pure; else, why it is not. Nothing is executed.

    Args:
        text: output of `--emit interceptor`, or the core alone.
    """
    if not is_utf8(text):
        return "Python reads it in another encoding than UTF-8"
    above, marked, node = text.partition(f"{MARKER}\n")
    try:
        tree = ast.parse(above)
        missing = [name for name in _NEEDED if name not in _defined(tree)]
        if missing:
            return f"its core has no `{missing[0]}`"
        names = bound_names(tree, _names_of_nodes())
        if marked and "OPTIONS" not in names:
            return "its core has no `OPTIONS`"
        if marked:
            if not is_guarded(tree):
                return "it may import modules from its own folder: emit it again"
            _check_node(node)
            _check_whole(text, tree, node)
    except (SyntaxError, ValueError, RecursionError) as error:
        return f"it is not valid Python: {error}"
    except UnexpectedStatementError as error:
        return f"fretc cannot read its core: {error}"
    return PureCore(above)


def otherwise(text: str, interception: Interception) -> str | None:
    """Why the file does not match the declared interceptor; None: it does.

    The core may differ, because it is the subject of the proof. Its options and its node may not;
    the node may be that of ROS 1 or ROS 2, whatever `ros` says, because packages of ROS 1 contain
    that of ROS 1.
    """
    try:
        options, node = _around(text)
    except (SyntaxError, ValueError, RecursionError) as error:
        return f"it is not valid Python: {error}"
    of_both = (replace(interception, ros=ros) for ros in (1, 2))
    written = [_around(interceptor.text(each, "bindings.toml")) for each in of_both]
    if (options, node) == ([], None):
        return None
    if options != written[0][0]:
        return "its options differ from those that the bindings declare: emit it again"
    if node not in [each for _, each in written]:
        return "its node is not the one that fretc generates for these bindings: emit it again"
    return None


def is_original(text: str) -> bool:
    """Whether the core equals the one that fretc writes, except for comments."""
    above, _, _ = text.partition(f"{MARKER}\n")
    parts = [part for part in ast.parse(above).body if not _is_options(part)]
    written = ast.parse(f"{original().imports}\n{original().text}").body
    return [ast.dump(part) for part in parts] == [ast.dump(part) for part in written]


def _around(text: str) -> tuple[list[str], str | None]:
    """The statement that binds `OPTIONS`, and the node or None, without comments."""
    above, marked, node = text.partition(f"{MARKER}\n")
    options = [ast.unparse(part) for part in ast.parse(above).body if _is_options(part)]
    return options, ast.dump(ast.parse(node)) if marked else None


def _is_options(node: ast.stmt) -> bool:
    return ast.unparse(node).startswith("OPTIONS")


def _defined(tree: ast.Module) -> Iterator[str]:
    """Classes, functions and constants, without a look at what they are."""
    for node in tree.body:
        match node:
            case ast.ClassDef(name) | ast.FunctionDef(name) | ast.Assign([ast.Name(name)]):
                yield name


def _check_node(node: str) -> None:
    """Check that the node is one that fretc writes, up to its numbers and texts.

    Python has many ways to change a module from below, so other nodes are refused.
    """
    if _shape(node) not in _shapes():
        raise UnexpectedStatementError("the node below it is not one that fretc generates")


def _check_whole(text: str, core: ast.Module, node: str) -> None:
    """Check that the module is the core, directly followed by the node."""
    parts = [*core.body, *ast.parse(node).body]
    if [ast.dump(part) for part in ast.parse(text).body] != [ast.dump(part) for part in parts]:
        raise UnexpectedStatementError("the node does not directly follow the core")


@cache
def _nodes() -> tuple[str, ...]:
    """Nodes that fretc writes for each ROS version and form, with and without a scan."""
    interceptions = (
        Interception("/a", "/b", "/c", scan, 10**8, form=form, ros=ros)
        for scan in (None, "/d")
        for form in InterceptorForm
        for ros in (1, 2)
    )
    texts = (interceptor.text(one, "bindings.toml") for one in interceptions)
    return tuple(each.partition(f"{MARKER}\n")[2] for each in texts)


@cache
def _shapes() -> frozenset[str]:
    return frozenset(map(_shape, _nodes()))


@cache
def _names_of_nodes() -> frozenset[str]:
    """Names that a node binds at module level, which a core must not bind."""
    return frozenset(name for node in _nodes() for name in _outermost(ast.parse(node)))


def _outermost(node: ast.AST) -> Iterator[str]:
    """Names that statements bind, without those inside functions and classes."""
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


def _shape(node: str) -> str:
    """Syntax tree without the values of constants."""
    return ast.dump(_Blank().visit(ast.parse(node)))


class _Blank(ast.NodeTransformer):
    def visit_Constant(self, node: ast.Constant) -> ast.Constant:
        return ast.Constant(type(node.value).__name__)
