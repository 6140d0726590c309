"""Programs for languages without objects: the size of every cell is known in advance.

A window is a ring of bits: `guard S[lo,hi] witness` holds when the latest witness that is `lo`
ticks old or older, with the guard true ever since, became that old at most `hi - lo` ticks ago. So
the ring keeps the witnesses of `lo` ticks, one counter the ticks in a row with the guard, and one
the ticks since then. What outcomes remember is cells, too: what was broken, how old a demand is.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from compiler.program.clocks import clocks, lengthened
from compiler.program.instructions import (
    Advance,
    Assign,
    Choose,
    Instruction,
    SetCounter,
    Shift,
    Slide,
)
from compiler.program.program import (
    Block,
    Counter,
    Program,
    RequirementProgram,
    StoredFlag,
    WindowMemory,
)
from compiler.program.values import (
    FALSE,
    TRUE,
    Age,
    Comparison,
    Literal,
    Value,
    Variable,
    and_,
    or_,
    parts,
)
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class Ring:
    """The truth values of the last `length` ticks; false before tick 0."""

    name: str
    length: int
    comment: str


@dataclass(frozen=True, slots=True)
class Delay:
    """The variable gets the oldest value of the ring, which takes this one in its place."""

    name: str
    ring: str
    value: Value


Cell = StoredFlag | Counter | Ring
Step = Assign | Shift | SetCounter | Advance | Delay | Choose


@dataclass(frozen=True, slots=True)
class StatementGroup:
    """Steps that belong together, below a comment."""

    comment: str
    steps: tuple[Step, ...]


@dataclass(frozen=True, slots=True)
class Deadline:
    """The ticks left of an open demand: `deadline_ticks` less the counter, if not negative."""

    counter: str
    deadline_ticks: int


@dataclass(frozen=True, slots=True)
class RequirementValues:
    """The values to read of a requirement after a tick."""

    id: str
    prefix: str
    truths: Mapping[str, Value]
    deadline: Deadline | None
    """The deadline of the open demand; None if demands have no deadline."""


@dataclass(frozen=True, slots=True)
class StoredProgram:
    """A program whose cells are flags, counters and rings."""

    literals: tuple[Literal, ...]
    cells: tuple[Cell, ...]
    stages: tuple[StatementGroup, ...]
    readings: tuple[RequirementValues, ...]


def stored_program(program: Program, prefixes: Mapping[str, str]) -> StoredProgram:
    """The program reduced to what signals need, with rings for windows and cells for marks.

    Args:
        program: the program of any requirements.
        prefixes: requirement id → prefix of the names of its cells.
    """
    clock_of = clocks(program)
    program = lengthened(program, clock_of)
    blocks = _needed(program)
    names = {name for block in blocks for name in _cells(block)}
    windows = {cell.name: cell for cell in program.cells if isinstance(cell, WindowMemory)}
    cells: list[Cell] = [
        cell for cell in program.cells if cell.name in names and not isinstance(cell, WindowMemory)
    ]
    stages, readings = list[StatementGroup](), list[RequirementValues]()
    for block in blocks:
        steps = list[Step]()
        for instruction in block.instructions:
            new_cells, moves = _without_windows(instruction, windows)
            cells.extend(new_cells)
            steps.extend(moves)
        stages.append(StatementGroup(block.comment, tuple(steps)))
    for requirement in program.requirements:
        marks, stage, reading = _mark_cells(
            requirement, prefixes[requirement.id], clock_of.get(requirement.id)
        )
        cells.extend(marks)
        stages.extend([stage] if stage.steps else [])
        readings.append(reading)
    return StoredProgram(_literals(program, blocks), tuple(cells), tuple(stages), tuple(readings))


def _literals(program: Program, blocks: Iterable[Block]) -> tuple[Literal, ...]:
    """The literals that are read."""
    values = [*_output_values(program), *(value for block in blocks for value in _values(block))]
    used = {value for value in values if isinstance(value, Literal)}
    return tuple(literal for literal in program.literals if literal in used)


def _output_values(program: Program) -> Iterator[Value]:
    """The signals, and all values within them."""
    for requirement in program.requirements:
        for signal in requirement.signals:
            yield from parts(signal)


def _needed(program: Program) -> tuple[Block, ...]:
    """The blocks that signals depend on."""
    blocks = {block.name: block for block in program.blocks if block.instructions}
    waiting = [*_output_values(program)]
    needed: set[str] = set()
    while waiting:
        value = waiting.pop()
        match value:
            case Variable(name) | Age(name) if name not in needed:
                needed.add(name)
                waiting.extend(_values(blocks[name]))
            case _:
                continue
    return tuple(block for name, block in blocks.items() if name in needed)


def _values(block: Block) -> Iterator[Value]:
    """The values that the block's instructions read, without the cells that they move."""
    for instruction in block.instructions:
        for value in _read(instruction):
            yield from parts(value)


def _read(instruction: Instruction) -> Iterable[Value]:
    match instruction:
        case Assign(_, value) | Shift(_, _, value):
            return (value,)
        case Slide(_, _, guard, witness):
            return (guard, witness)
        case Choose(branches):
            return (condition for condition, _ in branches)
        case SetCounter() | Advance():
            return ()


def _cells(block: Block) -> Iterator[str]:
    """The names of the cells of a block."""
    yield block.name
    for instruction in block.instructions:
        if isinstance(instruction, Shift):
            yield instruction.cell


def _without_windows(
    instruction: Instruction, windows: Mapping[str, WindowMemory]
) -> tuple[tuple[Cell, ...], tuple[Step, ...]]:
    """The instruction with windows replaced, and the cells needed for that."""
    if isinstance(instruction, Slide):
        return _ring_and_step(instruction, windows[instruction.window])
    return (), (instruction,)


def _ring_and_step(slide: Slide, window: WindowMemory) -> tuple[tuple[Cell, ...], tuple[Step, ...]]:
    """A window as a ring and counters, and its step."""
    name, lo, none = slide.name, window.lo, window.hi - window.lo + 1
    past, guarded = Variable(f"past_{name}"), slide.guard != TRUE
    ring = Ring(f"ring_{name}", lo, f"the witnesses of {lo} ticks, for {window.comment}")
    note = f"ticks since a witness became {lo} ticks old; {none}: none"
    age = Counter(f"age_{name}", none, 0, none, note)
    clear = Counter(f"clear_{name}", 0, 0, lo, "ticks in a row with the guard")
    old = and_([past, Age(clear.name, Comparison.AT_LEAST, lo)]) if guarded else past
    grown, lost = Advance(age.name, none), SetCounter(age.name, none)
    older = Choose(((old, SetCounter(age.name, 0)), (slide.guard, grown)), lost)
    row = Choose(((slide.guard, Advance(clear.name, lo)),), SetCounter(clear.name, 0))
    comparison = Comparison.MORE if slide.negated else Comparison.AT_MOST
    steps: tuple[Step, ...] = (
        *((row,) if guarded else ()),
        Delay(past.name, ring.name, slide.witness),
        older if guarded else Choose(((old, SetCounter(age.name, 0)),), grown),
        Assign(name, Age(age.name, comparison, none - 1)),
    )
    return (ring, *((clear,) if guarded else ()), age), steps


def _mark_cells(
    requirement: RequirementProgram, prefix: str, clock: str | None
) -> tuple[list[Cell], StatementGroup, RequirementValues]:
    """The marks of a requirement as cells, with the statements that update them and its reading.

    `clock`: the counter that is as old as the open demand, if there is one.
    """
    signals, cells, steps = requirement.signals, list[Cell](), list[Step]()
    latches: dict[str, Value] = {}
    for name, signal, state in (
        ("broken", signals.violation, "violated"),
        ("violation_inevitable", signals.violation_inevitable, "bound to be violated"),
    ):
        flag = StoredFlag(f"{prefix}_{name}", False, f"{requirement.id} was {state} up to here")
        latches[name] = Variable(flag.name) if signal != FALSE else FALSE
        if signal != FALSE:
            cells.append(flag)
            steps.append(Assign(flag.name, or_([Variable(flag.name), signal])))
    deadline = None
    if requirement.deadline_ticks is not None and clock is not None:
        deadline = Deadline(clock, requirement.deadline_ticks)
    elif requirement.deadline_ticks is not None and signals.obligation_pending != FALSE:
        deadline = Deadline(f"{prefix}_age", requirement.deadline_ticks)
        most, none = requirement.deadline_ticks + 1, SetCounter(deadline.counter, -1)
        note = f"ticks since the trigger of the open demand of {requirement.id}; -1: none"
        cells.append(Counter(deadline.counter, -1, -1, most, note))
        grown = Advance(deadline.counter, most)
        if requirement.renewed:
            open_ = Age(deadline.counter, Comparison.AT_LEAST, 0)
            born = SetCounter(deadline.counter, 0)
            steps.append(Choose(((signals.trigger, born), (open_, grown)), none))
        else:
            steps.append(Choose(((signals.obligation_pending, grown),), none))
    truths = {
        "violated": or_(latches.values()),
        "failed": or_([latches["broken"], signals.violated_if_ended]),
        "trigger": signals.trigger,
        "violation": signals.violation,
        "open": signals.obligation_pending,
        "satisfied_forever": signals.satisfied_forever,
        "answer": signals.answer,
    }
    stage = StatementGroup(f"{requirement.id}: what is remembered", tuple(steps))
    return cells, stage, RequirementValues(requirement.id, prefix, truths, deadline)
