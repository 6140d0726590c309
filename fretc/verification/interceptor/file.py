"""An interceptor's file: a core, its options, and the node below; one module when it flies.

The core may be any that is pure (`fretc.verification.interceptor.purity`): then what is explored of
it is all that it does. Its options and the node below it must be those that fretc writes for the
bindings, and the core binds no name of a node.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from types import ModuleType
from typing import Any

from compiler.targets.python import interceptor
from compiler.targets.python.interceptor import MARKER
from fretc.verification.interceptor.purity import UnexpectedCodeError, bound_names, is_guarded
from fretish.bindings.declarations import Form, Interception
from fretish.reading.text_encoding import is_utf8
from monitors.loading import executed
from monitors.source_text import interceptor as original

_NEEDED = (
    "ZERO Velocity Options State StopHeard CommandHeard ScanHeard TimerRang initial halted step"
).split()


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
    except UnexpectedCodeError as error:
        return f"fretc cannot read its core: {error}"
    return Head(above)


def otherwise(text: str, interception: Interception) -> str | None:
    """Why the file is of another interceptor than the bindings declare; None: it is of this one.

    The core may be another: it is what is looked at. Its options and the node around it may not,
    which is that of either ROS: a package of ROS 1 has that of ROS 1, whatever `ros` says.
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
    """Whether the core is the one that fretc writes, but for comments."""
    above, _, _ = text.partition(f"{MARKER}\n")
    parts = [part for part in ast.parse(above).body if not _is_options(part)]
    written = ast.parse(f"{original().imports}\n{original().text}").body
    return [ast.dump(part) for part in parts] == [ast.dump(part) for part in written]


def _around(text: str) -> tuple[list[str], str | None]:
    """What binds `OPTIONS`, and the node (None: there is none), exactly but for comments."""
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
    """It is one that fretc writes, up to its numbers and texts.

    Python has no end of ways to change a module from below, so that nothing else is looked into.
    """
    if _shape(node) not in _shapes():
        raise UnexpectedCodeError("the node below it is not one that fretc generates")


def _check_whole(text: str, core: ast.Module, node: str) -> None:
    """Core and node are the module, one below the other."""
    parts = [*core.body, *ast.parse(node).body]
    if [ast.dump(part) for part in ast.parse(text).body] != [ast.dump(part) for part in parts]:
        raise UnexpectedCodeError("the node does not directly follow the core")


@cache
def _nodes() -> tuple[str, ...]:
    """Those that fretc writes for each ROS and form, with and without a scan."""
    interceptions = (
        Interception("/a", "/b", "/c", scan, 10**8, form=form, ros=ros)
        for scan in (None, "/d")
        for form in Form
        for ros in (1, 2)
    )
    texts = (interceptor.text(one, "bindings.toml") for one in interceptions)
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


def _shape(node: str) -> str:
    """Its tree without what constants say."""
    return ast.dump(_Blank().visit(ast.parse(node)))


class _Blank(ast.NodeTransformer):
    def visit_Constant(self, node: ast.Constant) -> ast.Constant:
        return ast.Constant(type(node.value).__name__)
