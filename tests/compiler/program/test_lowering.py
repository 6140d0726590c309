"""Programs say what their formulas say; counters keep their ranges; names come before their use."""

from collections.abc import Iterator, Mapping, Sequence

from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization.past import MonitorSpec
from compiler.logic import formula as f
from compiler.logic.definition import holds
from compiler.logic.evaluation import evaluate_unknown
from compiler.program.instructions import Advance, Choose, Instruction, SetCounter, Shift, Slide
from compiler.program.lowering import program
from compiler.program.program import Counter, Program
from compiler.program.values import Age, Variable, parts
from monitors.kernel.verdicts import Signals, Truth
from tests.monitoring import packed
from tests.program_interpreter import State, initial, step
from tests.strategies import FORMULA_ATOMS, leaves, past, three_valued, traces

BOUNDS = st.one_of(
    st.just(f.EVER),
    st.builds(f.Interval, st.sampled_from([0, 1, 2, 5, 10**6]), st.none()),
    st.builds(
        lambda lo, more: f.Interval(lo, lo + more),
        st.sampled_from([0, 1, 3, 10**6]),
        st.sampled_from([0, 1, 4, 10**6]),
    ),
)
FORMULAS = st.recursive(leaves, lambda inner: past(inner, BOUNDS), max_leaves=6)


def of(*formulas: f.Formula) -> Program:
    """A program that tells the formulas, each as the trigger of a requirement."""
    no = f.FALSE
    watches = {
        f"R{i}": MonitorSpec(formula, no, no, no, no, no, None, None, renewed=False)
        for i, formula in enumerate(formulas)
    }
    return program(watches)


def states(made: Program, rows: Sequence[Mapping[str, Truth]], is_possible: bool) -> list[State]:
    state, found = initial(made), []
    for row in rows:
        state = step(made, state, row, is_possible)
        found.append(state)
    return found


def triggers(signals: tuple[Signals[bool], ...]) -> list[bool]:
    return [each.trigger for each in signals]


@given(st.lists(FORMULAS, min_size=1, max_size=3), traces(*FORMULA_ATOMS))
def test_a_program_says_what_its_formulas_say(
    formulas: list[f.Formula], rows: list[dict[str, bool]]
) -> None:
    for tick, state in enumerate(states(of(*formulas), rows, is_possible=False)):
        assert triggers(state.signals) == [holds(each, rows, tick) for each in formulas]


@given(FORMULAS, three_valued(*FORMULA_ATOMS))
def test_two_approximations_are_the_logic_of_kleene(
    formula: f.Formula, rows: list[dict[str, Truth]]
) -> None:
    columns = {name: [row[name] for row in rows] for name in FORMULA_ATOMS}
    ticks, made = packed(columns)
    expected = evaluate_unknown(formula, made, ticks)
    certain, possible = (states(of(formula), rows, is_possible) for is_possible in (False, True))
    for tick, (low, high) in enumerate(zip(certain, possible, strict=True)):
        assert low.signals[0].trigger is bool(expected.true >> tick & 1)
        unknown = high.signals[0].trigger and not low.signals[0].trigger
        assert unknown is bool(expected.unknown >> tick & 1)


def moves(instruction: Instruction) -> Iterator[SetCounter | Advance]:
    match instruction:
        case SetCounter() | Advance():
            yield instruction
        case Choose(branches, otherwise):
            yield from (then for _, then in branches)
            yield otherwise


@given(st.lists(FORMULAS, min_size=1, max_size=3))
def test_every_move_of_a_counter_stays_in_its_range(formulas: list[f.Formula]) -> None:
    """Whatever the literals are: from any number in its range the next one is in it."""
    made = of(*formulas)
    counters = {cell.name: cell for cell in made.cells if isinstance(cell, Counter)}
    assert all(cell.least <= cell.initial <= cell.most for cell in counters.values())
    for block in made.blocks:
        for move in (move for each in block.instructions for move in moves(each)):
            cell = counters[move.counter]
            if isinstance(move, SetCounter):
                assert cell.least <= move.number <= cell.most
            else:
                assert cell.least < move.most <= cell.most


@given(st.lists(FORMULAS, min_size=1, max_size=3))
def test_a_name_is_computed_before_it_is_used(formulas: list[f.Formula]) -> None:
    made = of(*formulas)
    known = {cell.name for cell in made.cells}
    assert len(known) == len(made.cells)
    for block in made.blocks:
        for instruction in block.instructions:
            match instruction:
                case Slide(_, _, guard, witness):
                    used = [guard, witness]
                case Choose(branches):
                    used = [condition for condition, _ in branches]
                case SetCounter() | Advance():
                    used = []
                case _:
                    used = [instruction.value]
            assert {*names(used)} <= known
            if isinstance(instruction, Shift | Slide):
                known.add(instruction.name)
        known.add(block.name)
    assert {*names([value for each in made.requirements for value in each.signals])} <= known


def names(values: Sequence[object]) -> Iterator[str]:
    for value in values:
        for part in parts(value):  # type: ignore[arg-type]
            if isinstance(part, Variable):
                yield part.name
            elif isinstance(part, Age):
                yield part.counter
