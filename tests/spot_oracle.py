"""What Spot says of formulas and endless traces: the oracle of their definitions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import spot

from compiler.logic import printing
from compiler.logic.formula import Atom, Formula, atoms, rebuild
from compiler.logic.spot import same_language


def equivalent(left: Formula, right: Formula) -> bool:
    """Whether two future-time formulas hold on the same infinite traces (and `LAST` is free)."""
    names = _names(*atoms(left), *atoms(right))
    return same_language(*(printing.future(_renamed(formula, names)) for formula in (left, right)))


def holds_on(
    formula: Formula, prefix: Sequence[Mapping[str, bool]], loop: Sequence[Mapping[str, bool]]
) -> bool:
    """Whether an endless trace satisfies a future-time formula, according to Spot's automaton.

    Args:
        formula: with small bounds, which Spot expands; without `LAST`.
        prefix: the values of its atoms at the first ticks.
        loop: the ticks that repeat for ever, at least one.

    Source: Duret-Lutz et al., CAV 2022 (`twa_word`).
    """
    names = _names(*atoms(formula), *(name for values in (*prefix, *loop) for name in values))

    def letters(ticks: Sequence[Mapping[str, bool]]) -> list[str]:
        return [
            _letter({names[name]: value for name, value in valuation.items()})
            for valuation in ticks
        ]

    parts = [*letters(prefix), f"cycle{{{'; '.join(letters(loop))}}}"]
    word = spot.parse_word("; ".join(parts), spot.make_bdd_dict())
    renamed = spot.formula(printing.future(_renamed(formula, names)))
    automaton = renamed.translate(dict=word.get_dict())
    return bool(word.as_automaton().intersects(automaton))


def _letter(values: Mapping[str, bool]) -> str:
    """A conjunction of literals, in Spot's syntax."""
    return " & ".join(f"{'' if value else '!'}{name}" for name, value in values.items()) or "1"


def _names(*own: str) -> dict[str, str]:
    """A plain name for each atom: its own may be any text."""
    return {name: f"p{i}" for i, name in enumerate(sorted(set(own)))}


def _renamed(formula: Formula, names: Mapping[str, str]) -> Formula:
    if isinstance(formula, Atom):
        return Atom(names[formula.name])
    return rebuild(formula, lambda part: _renamed(part, names))
