"""Interface to Spot; the only module that imports it, on the first call.

Spot is not installed everywhere: `is_installed` says whether the other functions may be called.
An atom's name may be any text, so Spot gets names that are made here. Bounds must be small, because
Spot expands them into chains of X. So no path from a sentence to its generated files may depend on
this module.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

from compiler.logic import printing
from compiler.logic.formula import (
    FALSE,
    TRUE,
    Atom,
    Eventually,
    Formula,
    Globally,
    Interval,
    and_,
    atoms,
    children,
    longest_bound,
    next_,
    not_,
    or_,
    rebuild,
)
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.reading.recursion import with_recursion_limit

_INSTALL = (
    "install Spot: `pip install spottl` on Linux x86-64 with CPython 3.11 to 3.13; on macOS and "
    "other Linux `conda install -c conda-forge spot` in the environment of fretc"
)
ABSENT = f"{Code.MISSING_EXTRA.number} Spot is not installed: {_INSTALL}"
"""The reason why a claim is not checked."""


def is_installed() -> bool:
    """Whether Spot can be imported: a package of the same name is not Spot."""
    try:
        return hasattr(_spot(), "otf_product")
    except ImportError:
        return False


def unless_installed(need: str) -> Diagnostic | None:
    """F908 if Spot is not installed.

    Args:
        need: the feature and a verb: `a proof needs`.
    """
    if is_installed():
        return None
    return diagnostic("no_spot", need=need, help=_INSTALL)


def same_language(left: str, right: str) -> bool:
    """Whether two LTL formulas in Spot's syntax are equivalent.

    Raises:
        SyntaxError: one of them is not LTL.

    Source: Duret-Lutz et al., From Spot 2.0 to Spot 2.10, CAV 2022.
    """
    spot = _spot()
    return bool(spot.are_equivalent(spot.formula(left), spot.formula(right)))


_PROVABLE_BOUND = 12
"""Longer bounds are not given to Spot, which expands them into chains of X."""


@with_recursion_limit
def simplified(formula: Formula) -> str | None:
    """A shorter, equivalent text in Spot's syntax on infinite traces; None if there is none.

    Bounded operators are opaque while Spot rewrites, so that bounds of any size stay one operator.
    Spot then proves the result equivalent through automata: with the opaque operators, and also
    without them if bounds are small.

    Source: Duret-Lutz et al., CAV 2022, and Spot's documentation of tl_simplifier.
    """
    spot = _spot()
    names = _names(*atoms(formula))
    renamed = _renamed(formula, names)
    opaque: dict[str, Formula] = {}
    outline = spot.formula(printing.future(_hide(renamed, opaque)))
    shorter = spot.tl_simplifier(spot.tl_simplifier_options(3)).simplify(outline)
    assert spot.are_equivalent(outline, shorter), "Spot's simplification is not equivalent"
    text = str(shorter)
    size = spot.length(shorter)
    for name, bounded in reversed(opaque.items()):
        size += text.count(name) * (_length(bounded) - 1)
        text = text.replace(name, f"({printing.text(bounded, printing.SPOT)})")
    if longest_bound(formula) <= _PROVABLE_BOUND:
        assert same_language(text, printing.future(renamed)), "simplification is not equivalent"
    own = {name: printing.text(Atom(atom_name), printing.SPOT) for atom_name, name in names.items()}
    text = _NAME.sub(lambda match: own[match[0]], text)
    exact = printing.text(formula, printing.SPOT)
    return text if size < _length(formula) and len(text) < len(exact) else None


def _length(formula: Formula) -> int:
    """The number of operators and propositions as Spot counts them: `a & b & c` has five."""
    parts = children(formula)
    return max(1, len(parts) - 1) + sum(map(_length, parts))


def _hide(formula: Formula, opaque: dict[str, Formula]) -> Formula:
    """The formula with a fresh proposition for each bounded operator, recorded in `opaque`."""
    match formula:
        case Eventually(_, Interval(_, int())) | Globally(_, Interval(_, int())):
            inner = rebuild(formula, lambda part: _hide(part, opaque))
            name_of = {bounded: name for name, bounded in opaque.items()}
            name = name_of.get(inner) or f"_bounded_{len(opaque)}_"  # no name of `_names`
            opaque[name] = inner
            return Atom(name)
        case _:
            return rebuild(formula, lambda part: _hide(part, opaque))


@with_recursion_limit
def violation(
    labels: Sequence[frozenset[str]],
    edges: Sequence[Sequence[int]],
    initial: int,
    formula: Formula,
) -> tuple[tuple[int, ...], tuple[int, ...]] | None:
    """A run of a graph that violates the formula; None if every run satisfies it.

    Args:
        labels: shape (states,), the atoms that are true in each.
        edges: shape (states,), the next states of each, at least one.
        initial: the initial state.
        formula: future-time, on infinite runs.

    Returns:
        The states of a prefix, possibly empty, and those of a non-empty cycle.

    Source: Duret-Lutz et al., CAV 2022: product with the automaton of the negation on the fly.
    """
    spot = _spot()
    names = _names(*atoms(formula))
    renamed = spot.formula(printing.future(_renamed(formula, names)))
    dictionary = spot.make_bdd_dict()
    graph = _graph(spot.make_kripke_graph(dictionary), labels, edges, names)
    graph.set_init_state(initial)
    negation = spot.translate(spot.formula.Not(renamed), dict=dictionary)
    run = spot.otf_product(graph, negation).accepting_run()
    if run is None:
        return None
    run = run.reduce().project(graph)
    prefix, cycle = (
        tuple(graph.state_number(step.s) for step in part) for part in (run.prefix, run.cycle)
    )
    return prefix, cycle


@dataclass(frozen=True, slots=True)
class BuchiAutomaton:
    """A deterministic automaton; a run is accepted if accepting states recur on it.

    Without a move for a valuation, no continuation is accepted. State 0 is the initial one.
    """

    moves: tuple[tuple[tuple[Formula, int], ...], ...]
    """The moves of each state: a condition on the valuation, and the next state."""
    accepting: frozenset[int] | None
    """The accepting states; None: every run that does not get stuck is accepted."""


@with_recursion_limit
def deterministic_buchi(formula: Formula) -> BuchiAutomaton | None:
    """The automaton of a formula of the future; None: no automaton of this kind accepts its runs.

    Source: Krishnan, Puri, Brayton, Deterministic omega-automata vis-a-vis deterministic Buechi
    automata, ISAAC 1994; Duret-Lutz et al., CAV 2022.
    """
    spot = _spot()
    names = _names(*atoms(formula))
    text = printing.future(_renamed(formula, names))
    parity = spot.translate(text, "parity", "deterministic")
    automaton = parity
    if parity.num_sets() > 0:
        buchi = spot.rabin_to_buchi_if_realizable(parity)
        if buchi is None:
            return None
        # Spot 2.13 keeps the property of the parity automaton, and `sbacc` then does nothing.
        buchi.prop_state_acc(spot.trival_maybe())
        automaton = spot.sbacc(buchi)
    automaton.purge_dead_states()
    assert spot.is_deterministic(automaton)
    assert spot.are_equivalent(automaton, spot.formula(text)), "the automaton is another one"
    own = {name: Atom(atom) for atom, name in names.items()}
    first = automaton.get_init_state_number()
    numbers = {first: 0}
    for state in range(automaton.num_states()):
        numbers.setdefault(state, len(numbers))
    dictionary = automaton.get_dict()

    def condition(edge: Any) -> Formula:
        return _condition(spot.bdd_to_formula(edge.cond, dictionary), own)

    moves = tuple(
        tuple((condition(edge), numbers[edge.dst]) for edge in automaton.out(state))
        for state in numbers
    )
    if automaton.num_sets() == 0:
        return BuchiAutomaton(moves, None)
    recurring = (each for each in numbers if automaton.state_is_accepting(each))
    return BuchiAutomaton(moves, frozenset(numbers[each] for each in recurring))


def _condition(condition: Any, own: Mapping[str, Formula]) -> Formula:
    """A Boolean formula of Spot."""
    spot = _spot()
    parts = [_condition(part, own) for part in condition]
    match condition.kind():
        case spot.op_tt:
            return TRUE
        case spot.op_ff:
            return FALSE
        case spot.op_ap:
            return own[condition.ap_name()]
        case spot.op_Not:
            return not_(parts[0])
        case spot.op_And:
            return and_(*parts)
        case kind:
            assert kind == spot.op_Or
            return or_(*parts)


@with_recursion_limit
def is_bad_prefix(formula: Formula, prefix: Sequence[Mapping[str, bool]]) -> bool:
    """Whether no run that begins with these valuations satisfies a formula of the future.

    Args:
        formula: the formula.
        prefix: the value of each of its atoms at the first ticks.
    """
    begun: Formula = TRUE
    for row in reversed(prefix):
        literals = (Atom(name) if value else not_(Atom(name)) for name, value in row.items())
        begun = and_(*literals, next_(begun))
    names = _names(*atoms(formula), *(name for row in prefix for name in row))
    text = printing.future(_renamed(and_(formula, begun), names))
    return bool(_spot().translate(text).is_empty())


@with_recursion_limit
def is_realizable(formula: Formula, outputs: Collection[str]) -> bool:
    """Whether a system that sees the inputs of a tick before it chooses outputs can satisfy it.

    Args:
        formula: a formula of the future.
        outputs: the atoms that the system chooses; all others are inputs.

    Source: Renkin, Schlehuber-Caissier, Duret-Lutz, Pommellet, Dissecting ltlsynt, FMSD 2023.
    """
    spot = _spot()
    names = _names(*atoms(formula), *outputs)
    text = printing.future(_renamed(formula, names))
    return bool(spot.solve_game(spot.ltl_to_game(text, [names[name] for name in outputs])))


def _names(*own: str) -> dict[str, str]:
    """A plain name for each atom, in the same alphabetical order, since Spot sorts by name."""
    return {name: f"p{i}" for i, name in enumerate(sorted(set(own)))}


_NAME = re.compile(r"p\d+")


def _renamed(formula: Formula, names: Mapping[str, str]) -> Formula:
    if isinstance(formula, Atom):
        return Atom(names[formula.name])
    return rebuild(formula, lambda part: _renamed(part, names))


def _graph(
    graph: Any,
    labels: Sequence[frozenset[str]],
    edges: Sequence[Sequence[int]],
    names: dict[str, str],
) -> Any:
    """Spot's Kripke graph with the same numbers of states."""
    valuation = _valuations(graph, names)
    for number, label in enumerate(labels):
        state = graph.new_state(valuation(label))
        assert state == number
    for state, following in enumerate(edges):
        for successor in following:
            graph.new_edge(state, successor)
    return graph


def _valuations(graph: Any, names: dict[str, str]) -> Callable[[frozenset[str]], Any]:
    import buddy

    variables = {name: buddy.bdd_ithvar(graph.register_ap(p)) for name, p in names.items()}
    cache: dict[frozenset[str], Any] = {}

    def valuation(label: frozenset[str]) -> Any:
        true = label.intersection(variables)
        if true not in cache:
            cache[true] = buddy.bddtrue
            for name, variable in variables.items():
                cache[true] &= variable if name in true else buddy.bdd_not(variable)
        return cache[true]

    return valuation


def version() -> str:
    """The version of Spot."""
    return str(_spot().version())


def _spot() -> Any:
    with warnings.catch_warnings():
        # SWIG's deprecations are not ours; as errors they would end the process.
        warnings.simplefilter("ignore")
        import spot
    return spot
