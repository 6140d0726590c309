"""Names of comparisons for languages without numbers: `battery_lt_20` for `battery < 20`.

The names are equal in every language, and unique in the project. The module also gives their
meanings, and the combinations of comparisons that are impossible.
"""

from __future__ import annotations

from collections.abc import Mapping

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of, impossible_combinations
from compiler.formalization.resolution import candidates
from compiler.logic import formula as f
from compiler.logic.identifiers import legal_names
from compiler.logic.printing import identifier, is_compound
from fretish import expressions as e
from fretish.bindings.comparisons import bound, is_measured
from fretish.printer import expression
from fretish.reading.recursion import with_recursion_limit


@with_recursion_limit
def comparison_names(requirement: FormalizedRequirement) -> Mapping[str, str]:
    """The name of each atom of a requirement that is a comparison or a call."""
    atoms = dict.fromkeys((*requirement.propositions, *atoms_of(requirement.sentence)))
    others = {identifier(name) for name in (*requirement.variables, *requirement.glossary, *atoms)}
    return legal_names(filter(is_compound, atoms), others)


@with_recursion_limit
def in_words(requirement: FormalizedRequirement) -> Mapping[str, str]:
    """The meaning of each of these atoms, in the units of its signals: `battery < 20 %`."""
    parts = dict(candidates(requirement.sentence))
    meanings = {}
    for atom in comparison_names(requirement):
        tree = _meaning(requirement, atom, parts.get(atom))
        meanings[atom] = atom if tree is None else " ".join(expression(tree).split())
    return meanings


def _meaning(
    requirement: FormalizedRequirement, atom: str, part: e.Expression | None
) -> e.Expression | None:
    if requirement.declarations is None:
        return part
    signals = requirement.declarations.measured
    if isinstance(part, e.Comparison) and is_measured(part, signals):
        comparison = bound(part, signals, requirement.entry.wording)
        if isinstance(comparison, e.Comparison):
            return comparison
    declared = requirement.declarations.propositions.get(atom)
    return part if declared is None else declared.expression


def definitions(requirement: FormalizedRequirement, names: Mapping[str, str]) -> Mapping[str, str]:
    """The meaning of each name that abbreviates an atom: `battery_lt_20` for `battery < 20 %`.

    Args:
        requirement: the requirement.
        names: proposition → its name in the text.
    """
    meanings = in_words(requirement)
    return {
        name: meanings.get(atom, f"the proposition `{atom}`")
        for atom, name in names.items()
        if name != atom
    }


def impossible_texts(requirement: FormalizedRequirement, names: Mapping[str, str]) -> list[str]:
    """The combinations of comparisons that never occur, in a language's names."""
    return [
        ", ".join(f"{names[atom]} {str(value).lower()}" for atom, value in exclusion)
        for exclusion in impossible_combinations(requirement)
    ]


def notes(requirement: FormalizedRequirement) -> list[str]:
    """The definitions of names, and the impossible combinations, a sentence each."""
    names = comparison_names(requirement)
    return [
        *(f"{name}: {meaning}" for name, meaning in definitions(requirement, names).items()),
        *(f"never at one tick: {together}" for together in impossible_texts(requirement, names)),
    ]


def with_renamed_atoms(formula: f.Formula, names: Mapping[str, str]) -> f.Formula:
    """The formula with atoms renamed."""
    if isinstance(formula, f.Atom):
        return f.Atom(names.get(formula.name, formula.name))
    return f.rebuild(formula, lambda part: with_renamed_atoms(part, names))
