"""`--emit dot`: the automaton of a requirement as a picture, for Graphviz.

Words and shapes distinguish states, never a colour alone. States that count ticks are one node
(`compiler.targets.automata.folding`). Source of the language: Graphviz, The DOT Language.
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence

from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.implicants import Term
from compiler.targets.automata.chart import PLACES, chart
from compiler.targets.automata.expressibility import refusal
from compiler.targets.automata.folding import (
    OPEN,
    SATISFIED,
    VIOLATED,
    Edge,
    FoldedState,
    folded_chart,
)
from compiler.targets.comparison_names import comparison_names, notes, with_renamed_atoms
from compiler.targets.target import Target, file_of_each
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.meaning import meaning

_LONGEST = 32
"""Maximum number of characters of an expression on an edge; a longer one gets a name, and is
printed below."""
_WIDTH = 76
"""Width of a line below the picture."""


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 for a probability or a temporal predicate, F670 for too many states."""
    return refusal(requirement, "DOT")


def _text(requirement: FormalizedRequirement) -> str:
    picture = folded_chart(requirement)
    automaton = chart(requirement)
    names = comparison_names(requirement)
    inputs = {i: with_renamed_atoms(part, names) for i, part in automaton.inputs.items()}
    guard = automaton.guard
    long = {i: part for i, part in inputs.items() if len(printing.readable(part)) > _LONGEST}
    spelt = {i: f.Atom(PLACES[i]) if i in long else part for i, part in inputs.items()}
    return render(
        "dot/automaton.dot.j2",
        id=requirement.id,
        title=_lines(_caption(requirement, long, picture.nodes)),
        start=picture.start,
        nodes=[(node.name, _lines(_node_text(node)), _look(node)) for node in picture.nodes],
        edges=[
            (edge.source, edge.target, _lines(_edge_text(edge, guard(edge.letters), spelt)))
            for edge in picture.edges
        ],
    )


def _caption(
    requirement: FormalizedRequirement, long: Mapping[int, f.Formula], nodes: Sequence[FoldedState]
) -> list[str]:
    lines = [f"{requirement.id}: {wording(requirement.entry)}"]
    lines.append(meaning(requirement.written, requirement.ticks, requirement.clock))
    lines.extend(f"{PLACES[i]}: {printing.readable(part)}" for i, part in long.items())
    lines.extend(notes(requirement))
    if any(node.counts for node in nodes):
        lines.append("On edges: [a condition on k], / what k becomes.")
    if any(not node.accepts and node.name != VIOLATED for node in nodes):
        lines.append("A run that stays among dashed states for ever violates the requirement.")
    return [line for text in lines for line in textwrap.wrap(" ".join(text.split()), _WIDTH)]


def _node_text(node: FoldedState) -> list[str]:
    if node.counts is None:
        return list(node.words)
    low, high = node.counts
    counts = f"k = {low}" if low == high else f"k = {low}..{high} ticks"
    return [f"{word}: {counts}" if word in OPEN else word for word in node.words]


def _look(node: FoldedState) -> str:
    if node.name == VIOLATED:
        return "shape=doubleoctagon"
    if node.name == SATISFIED:
        return "shape=doublecircle"
    shape = "shape=box" if node.counts else "shape=ellipse"
    return shape if node.accepts else f"{shape}, style=dashed"


def _edge_text(edge: Edge, terms: Sequence[Term], spelt: Mapping[int, f.Formula]) -> list[str]:
    parts = [_expression(terms, spelt)]
    if edge.condition:
        parts.append(f"[{edge.condition}]")
    if edge.change:
        parts.append(f"/ {edge.change}")
    return parts


def _expression(terms: Sequence[Term], spelt: Mapping[int, f.Formula]) -> str:
    return printing.readable(
        f.or_(
            *(
                f.and_(
                    *(spelt[i] if value else f.not_(spelt[i]) for i, value in sorted(term.items()))
                )
                for term in terms
            )
        )
    )


def _lines(texts: Iterable[str]) -> str:
    """A label in double quotes, one text a line; Graphviz interprets no escape in it."""
    escaped = (text.replace("\\", "\\\\").replace('"', '\\"') for text in texts)
    return '"' + r"\n".join(escaped) + '"'


TARGET = Target(
    "dot",
    "a picture of the automaton, for Graphviz",
    file_of_each("dot", lambda requirement, _: _text(requirement)),
    refuse,
    next_step="`dot -Tsvg -O {}` draws it",
)
