"""An interpreter of programs, straight from the definition of instructions.

Tests compare the generated code of each language with it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import assert_never

from compiler.program.instructions import (
    Advance,
    Assign,
    Choose,
    Instruction,
    SetCounter,
    Shift,
    Slide,
)
from compiler.program.program import Counter, Program, RequirementProgram, StoredFlag, WindowMemory
from compiler.program.values import (
    Age,
    And,
    Comparison,
    Constant,
    Literal,
    Not,
    Or,
    Value,
    Variable,
)
from monitors.kernel.stepping import Marks
from monitors.kernel.verdicts import Signals, Truth

Pairs = tuple[tuple[bool, bool], ...]


@dataclass(frozen=True)
class State:
    """The state of the certain or of the possible values after a tick."""

    tick: int
    """The index of the tick; -1 before the first."""
    values: Mapping[str, bool | int]
    """The values of flags, counters and variables."""
    windows: Mapping[str, Pairs]
    """The guard and the witness at the ticks inside of each window, the youngest first."""
    signals: tuple[Signals[bool], ...]
    """The signals of each requirement; none before the first tick."""
    marks: tuple[Marks, ...]


def initial(program: Program) -> State:
    """The state before the first tick."""
    values: dict[str, bool | int] = {}
    windows: dict[str, Pairs] = {}
    for cell in program.cells:
        match cell:
            case StoredFlag() | Counter():
                values[cell.name] = cell.initial
            case WindowMemory():
                windows[cell.name] = ()
            case _:
                assert_never(cell)
    return State(-1, values, windows, (), (Marks(-1, -1, -1, -1),) * len(program.requirements))


def step(
    program: Program, state: State, row: Mapping[str, Truth], is_possible: bool = False
) -> State:
    """The state one tick later.

    Args:
        program: the program.
        state: the state after the tick before.
        row: the truth of each proposition; None: unknown.
        is_possible: the value that an unknown literal counts as.
    """
    sizes = {cell.name: cell for cell in program.cells if isinstance(cell, WindowMemory)}
    tick = _Tick(row, is_possible, sizes, dict(state.values), dict(state.windows))
    for block in program.blocks:
        for instruction in block.instructions:
            tick.do(instruction)
    signals = tuple(
        Signals(*map(tick.value, requirement.signals)) for requirement in program.requirements
    )
    now = state.tick + 1
    marks = map(_marked, program.requirements, state.marks, signals, [now] * len(signals))
    return State(now, tick.values, tick.windows, signals, tuple(marks))


def _marked(requirement: RequirementProgram, before: Marks, now: Signals[bool], tick: int) -> Marks:
    """The marks after a tick with these signals."""
    broken = tick if before.broken < 0 and now.violation else before.broken
    inevitable = (
        tick
        if before.violation_inevitable < 0 and now.violation_inevitable
        else before.violation_inevitable
    )
    last = tick if now.trigger else before.last
    if not now.obligation_pending:
        return Marks(broken, inevitable, last, -1)
    if requirement.renewed:
        return Marks(broken, inevitable, last, last)
    return Marks(broken, inevitable, last, tick if before.open < 0 else before.open)


@dataclass(frozen=True)
class _Tick:
    """One tick of the certain or of the possible values."""

    row: Mapping[str, Truth]
    is_possible: bool
    sizes: Mapping[str, WindowMemory]
    values: dict[str, bool | int] = field(default_factory=dict)
    windows: dict[str, Pairs] = field(default_factory=dict)

    def value(self, value: Value) -> bool:
        match value:
            case Constant(truth):
                return truth
            case Literal(proposition, positive):
                truth_ = self.row[proposition]
                return self.is_possible if truth_ is None else truth_ is positive
            case Variable(name):
                return bool(self.values[name])
            case Age(counter, comparison, number):
                return _compared(int(self.values[counter]), comparison, number)
            case Not(negated):
                return not self.value(negated)
            case And(values):
                return all(map(self.value, values))
            case Or(values):
                return any(map(self.value, values))
            case _:
                assert_never(value)

    def do(self, instruction: Instruction) -> None:
        match instruction:
            case Assign(name, value):
                self.values[name] = self.value(value)
            case Shift(name, cell, value):
                self.values[name], self.values[cell] = self.values[cell], self.value(value)
            case SetCounter(counter, number):
                self.values[counter] = number
            case Advance(counter, most):
                self.values[counter] = min(int(self.values[counter]) + 1, most)
            case Slide(name, window, guard, witness, negated):
                now = (self.value(guard), self.value(witness))
                size = self.sizes[window]
                pairs = (now, *self.windows[window])[: size.hi + 1]
                self.windows[window] = pairs
                self.values[name] = _held(pairs, size.lo) is not negated
            case Choose(branches, otherwise):
                chosen = (then for condition, then in branches if self.value(condition))
                self.do(next(chosen, otherwise))
            case _:
                assert_never(instruction)


def _compared(age: int, comparison: Comparison, number: int) -> bool:
    match comparison:
        case Comparison.LESS:
            return age < number
        case Comparison.AT_MOST:
            return age <= number
        case Comparison.AT_LEAST:
            return age >= number
        case Comparison.MORE:
            return age > number
        case _:
            assert_never(comparison)


def _held(pairs: Sequence[tuple[bool, bool]], lo: int) -> bool:
    """Whether a witness lies `lo` pairs back or more, with all guards true since."""
    return any(
        pairs[ago][1] and all(guard for guard, _ in pairs[:ago]) for ago in range(lo, len(pairs))
    )
