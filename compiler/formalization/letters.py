"""The letters of a sentence: the values of its parts for each valuation of its atoms.

Parts may share atoms, so not every combination of their values can occur. Nor can every combination
of atoms, where they compare the same signals: `battery < 20` and `battery > 30`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Uninterpreted, boolean
from compiler.formalization.reference import Letter
from compiler.formalization.resolution import candidates
from compiler.logic import formula as f
from compiler.logic.evaluation import evaluate
from compiler.logic.orders import Exclusion, exclusions
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.comparisons import is_measured
from fretish.bindings.declarations import Aggregate, Declarations
from fretish.checking import LOOK_AHEAD, LOOK_BACK, calls, conditions
from fretish.reading.recursion import with_recursion_limit

MOST_ATOMS = 12
"""Maximum number of atoms: each doubles the letters, and 12 mean 4 096 steps for each pair of
states."""

Valuation = tuple[bool, ...]
"""The truth values of the atoms at one tick, in a given order."""


def temporal_predicate(sentence: s.Sentence) -> str | None:
    """The first predicate that refers to other ticks; letters cannot express it."""
    for expression in conditions(sentence):
        for name in calls(expression):
            if name in LOOK_BACK | LOOK_AHEAD:
                return name
        if any(name.id == "FTP" for name in e.names(expression)):
            return "FTP"
    return None


@with_recursion_limit
def letters_by_valuation(sentence: s.Sentence, atoms: Sequence[str]) -> Mapping[Valuation, Letter]:
    """The letter (mode, condition, response, stop condition) of each valuation of the atoms.

    Each expression is evaluated once, as a column of bits: bit k is its value in the k-th
    valuation.
    """
    m, p, q, stop = _columns(sentence, atoms)
    return {
        valuation: (bool(m >> k & 1), bool(p >> k & 1), bool(q >> k & 1), bool(stop >> k & 1))
        for k, valuation in enumerate(product((False, True), repeat=len(atoms)))
    }


@with_recursion_limit
def all_letters(sentence: s.Sentence, atoms: Sequence[str]) -> tuple[Letter, ...]:
    """The letters of all valuations of the atoms, sorted."""
    every = (1 << 2 ** len(atoms)) - 1
    groups: list[tuple[tuple[bool, ...], int]] = [((), every)]
    for column in _columns(sentence, atoms):
        groups = [
            ((*letter, value), where & half)
            for letter, where in groups
            for value, half in ((False, every ^ column), (True, column))
        ]
    return tuple((m, p, q, stop) for (m, p, q, stop), where in groups if where)


def _columns(sentence: s.Sentence, atoms: Sequence[str]) -> list[int]:
    """Mode, condition, response and stop condition, bit k in the k-th valuation of the atoms."""
    ticks = 2 ** len(atoms)
    columns: dict[str, int] = {}
    for name in atoms:
        run = ticks >> len(columns) + 1  # false for so many valuations, then true for as many
        columns[name] = ((1 << ticks) - 1) // ((1 << 2 * run) - 1) * ((1 << run) - 1) << run
    return [0 if part is None else evaluate(part, columns, ticks) for part in parts(sentence)]


def atoms_of(sentence: s.Sentence) -> tuple[str, ...]:
    """The names in formulas of the atoms of the sentence."""
    formulas = [part for part in parts(sentence) if part is not None]
    return tuple(dict.fromkeys(name for formula in formulas for name in f.atoms(formula)))


@with_recursion_limit
def possible_letters(sentence: s.Sentence) -> tuple[Letter, ...]:
    """The possible letters; with more than `MOST_ATOMS` atoms, a superset of them.

    An extra letter does not change the language, since no valuation of the atoms has it.
    """
    atoms = atoms_of(sentence)
    if len(atoms) <= MOST_ATOMS:
        return all_letters(sentence, atoms)
    m, p, q, stop = (_values(part) for part in parts(sentence))
    return tuple(product(m, p, q, stop))


def _values(part: f.Formula | None) -> tuple[bool, ...]:
    match part:
        case None:
            return (False,)
        case f.Const(value):
            return (value,)
        case _:
            return (False, True)


Parts = tuple[f.Formula | None, f.Formula | None, f.Formula | None, f.Formula | None]


def parts(sentence: s.Sentence) -> Parts:
    """The mode, condition, response and stop condition; None for a missing part."""
    scope, condition, stop = sentence.scope, sentence.condition, s.stop(sentence.timing)
    return (
        _formula(scope.mode) if scope else None,
        _formula(condition.expression) if condition else None,
        _formula(sentence.response),
        _formula(stop) if stop else None,
    )


def _formula(expression: e.Expression) -> f.Formula:
    return boolean(expression, Uninterpreted().alone())


# Valuations that cannot occur ------------------------------------------------------------------


def impossible_combinations(requirement: FormalizedRequirement) -> tuple[Exclusion, ...]:
    """The comparisons of a requirement that exclude each other, whatever is measured."""
    signals = requirement.declarations.measured if requirement.declarations else {}
    scales = {name: signal.scale for name, signal in signals.items()}
    words = {name: signal.values for name, signal in signals.items() if signal.values}
    return exclusions(comparisons(requirement), scales, words)


def exclusion_in_words(exclusion: Exclusion) -> str:
    """`(battery < 20)` and not `(battery > 30)`."""
    return " and ".join(f"{'' if value else 'not '}`{name}`" for name, value in exclusion)


def comparisons(requirement: FormalizedRequirement) -> Mapping[str, e.Comparison]:
    """The atoms that compare numbers of one instant, by their names.

    A comparison with its own declared proposition is left out: that may also be true if any sample
    of the tick makes it true, or if the value is unknown.
    """
    written = all_comparisons(requirement)
    return {name: written[name] for name in atoms_of(requirement.sentence) if name in written}


def all_comparisons(requirement: FormalizedRequirement) -> Mapping[str, e.Comparison]:
    """The same with those within temporal predicates, such as `persisted(3, battery < 20)`."""
    declared = requirement.declarations
    return {
        name: part
        for name, part in candidates(requirement.sentence)
        if isinstance(part, e.Comparison)
        and (declared is None or _is_of_one_moment(name, part, declared))
    }


def _is_of_one_moment(name: str, part: e.Comparison, declarations: Declarations) -> bool:
    signals = declarations.measured
    read = [signals[node.id] for node in e.names(part) if node.id in signals]
    if any(signal.scale != signal.unit.factor for signal in read):
        return False  # its numbers are not compared in the unit of the sentence
    declared = declarations.propositions.get(name)
    if declared is None:
        return ("proposition", name) not in declarations.mistakes
    last = declared.aggregate is Aggregate.LAST and declared.on_unknown is None
    plain = isinstance(declared.expression, e.Comparison)
    return last and plain and is_measured(part, signals)
