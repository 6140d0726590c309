"""Replace variables that have a `value`: constants, and FRET's assignments.

With `[variable.limit] value = "1.5 m/s"`, a sentence with `limit` means 1.5 m/s. The value gets the
span of the name, so that every span of a sentence is in its own text.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

from fretish import expressions as e
from fretish import syntax as s
from fretish.checking import conditions, too_deep
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.recursion import MOST, with_recursion_limit
from fretish.syntax import Sentence

Definitions = Mapping[str, e.Expression]
"""Name → the expression that replaces it, without cycles."""

MOST_PARTS = 10_000
"""Largest size of an expanded sentence: 100 definitions could each double it."""


def find_cycle(definitions: Definitions) -> tuple[str, ...]:
    """The names of a cyclic definition, the first repeated at the end; empty if there is none."""
    done: set[str] = set()
    for name in definitions:
        path = cycle_from(name, definitions, done)
        if path:
            return path
    return ()


def cycle_from(
    start: str, definitions: Definitions, done: set[str] | None = None
) -> tuple[str, ...]:
    """A cycle that `start` leads to, as in `find_cycle`; adds to `done` the names without one."""
    done = set() if done is None else done
    path = {start: None}
    waiting = [_dependencies(start, definitions)]
    while waiting:
        name = next((id for id in waiting[-1] if id not in done), None)
        if name is None:
            done.add(path.popitem()[0])
            waiting.pop()
        elif name in path:
            names = [*path]
            return (*names[names.index(name) :], name)
        else:
            path[name] = None
            waiting.append(_dependencies(name, definitions))
    return ()


def _dependencies(name: str, definitions: Definitions) -> Iterator[str]:
    """The defined names in the definition of a name."""
    if name in definitions:
        yield from dict.fromkeys(
            used.id for used in e.names(definitions[name]) if used.id in definitions
        )


def used_definitions(sentence: Sentence, definitions: Definitions) -> Definitions:
    """The definitions that the sentence needs, each after the definitions it depends on."""
    ordered: dict[str, e.Expression] = {}
    for expression in conditions(sentence):
        for name in e.names(expression):
            for id in _dependency_order(name.id, definitions, ordered):
                ordered[id] = definitions[id]
    return ordered


def _dependency_order(
    start: str, definitions: Definitions, done: Mapping[str, object]
) -> list[str]:
    """The name and the names it depends on, dependencies first."""
    ordered: dict[str, None] = {}
    path = [(start, _dependencies(start, definitions))] if start in definitions else []
    while path:
        name, dependencies = path[-1]
        inner = next((id for id in dependencies if id not in ordered and id not in done), None)
        if inner is not None:
            path.append((inner, _dependencies(inner, definitions)))
            continue
        path.pop()
        if name not in done:
            ordered[name] = None
    return list(ordered)


def expanded(sentence: Sentence, needed: Definitions) -> Sentence | Diagnostic:
    """The sentence with its variables replaced by their values; F115 or F670 if it is too large.

    Args:
        sentence: as written.
        needed: the result of `used`.
    """
    if not needed:
        return sentence
    sizes: dict[str, int] = {}
    depths: dict[str, int] = {}
    for name, value in needed.items():
        sizes[name], depths[name] = _size(value, sizes), _depth(value, depths)
    if sum(_size(condition, sizes) for condition in conditions(sentence)) > MOST_PARTS:
        return diagnostic("sentence_too_large", sentence.span, most=MOST_PARTS)
    if max(_depth(condition, depths) for condition in conditions(sentence)) > MOST:
        return too_deep(sentence)
    return s.with_expressions(sentence, partial(_substitute, values=needed))


def _size(tree: e.Expression, sizes: Mapping[str, int]) -> int:
    return sum(sizes.get(part.id, 1) if isinstance(part, e.Name) else 1 for part in e.parts(tree))


def _depth(tree: e.Expression, depths: Mapping[str, int]) -> int:
    deepest = 0
    waiting = [(tree, 1)]
    while waiting:
        part, level = waiting.pop()
        inner = depths.get(part.id, 1) if isinstance(part, e.Name) else 1
        deepest = max(deepest, level + inner - 1)
        waiting.extend((child, level + 1) for child in e.children(part))
    return deepest


@with_recursion_limit
def _substitute(tree: e.Expression, values: Definitions) -> e.Expression:
    """The expression with all defined names replaced, also within their values."""
    if isinstance(tree, e.Name):
        return _with_span(tree, tree.span, values) if tree.id in values else tree
    return e.with_children(tree, [_substitute(part, values) for part in e.children(tree)])


def _with_span(tree: e.Expression, span: Span | None, values: Definitions) -> e.Expression:
    """The expanded expression with `span` as the span of each part; each part is built once."""
    while isinstance(tree, e.Name) and tree.id in values:
        tree = values[tree.id]
    placed = e.with_children(tree, [_with_span(part, span, values) for part in e.children(tree)])
    match placed:
        case e.Name() | e.Number() | e.Quantity() | e.Negation() | e.Call():
            return replace(placed, span=span)
        case e.Arithmetic() | e.Comparison():
            return replace(placed, span=span)
        case _:
            return placed
