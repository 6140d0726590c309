"""Existing counters of a program that also measure the age of an open demand.

Such a counter saves a cell for the age of a demand. A demand is open while a counter of the oldest
witness is not negative. If a witness never comes without the guard, the counter starts when the
demand opens, and is not reset while it is open.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import assert_never

from compiler.program.instructions import Advance, Assign, Choose, Instruction, SetCounter
from compiler.program.program import Block, Counter, Program, RequirementProgram
from compiler.program.values import Age, And, Comparison, Value, Variable


def clocks(program: Program) -> Mapping[str, str]:
    """The counter of the open demand by requirement id, where there is one."""
    blocks = {block.name: block for block in program.blocks}
    candidates = (
        (requirement.id, _clock(requirement, blocks)) for requirement in program.requirements
    )
    return {id: counter for id, counter in candidates if counter is not None}


def lengthened(program: Program, clocks: Mapping[str, str]) -> Program:
    """The program with counters that distinguish the deadline's tick from later ones.

    Args:
        program: its comparisons do not distinguish a counter's largest value from larger ones.
        clocks: requirement id → counter.
    """
    most: dict[str, int] = {}
    for requirement in program.requirements:
        if requirement.id in clocks and requirement.deadline_ticks is not None:
            counter = clocks[requirement.id]
            most[counter] = max(most.get(counter, 0), requirement.deadline_ticks + 1)
    cells = tuple(
        replace(cell, most=max(cell.most, most[cell.name]))
        if isinstance(cell, Counter) and cell.name in most
        else cell
        for cell in program.cells
    )
    blocks = tuple(
        _longer(block, most[block.name]) if block.name in most else block
        for block in program.blocks
    )
    return replace(program, cells=cells, blocks=blocks)


def _clock(requirement: RequirementProgram, blocks: Mapping[str, Block]) -> str | None:
    pending = requirement.signals.obligation_pending
    if (
        requirement.deadline_ticks is None
        or requirement.renewed
        or not isinstance(pending, Variable)
    ):
        return None
    match blocks[pending.name].instructions:
        case (Assign(_, Age(counter, Comparison.AT_LEAST, 0)),) if _starts_once(blocks[counter]):
            return counter
        case _:
            return None


def _starts_once(block: Block) -> bool:
    """Whether the counter grows until it is -1, and then restarts from 0."""
    there = Age(block.name, Comparison.AT_LEAST, 0)
    match block.instructions:
        case (Choose(((kept, Advance()), (witness, SetCounter(_, 0))), SetCounter(_, -1)),):
            return _conjuncts(kept) <= _conjuncts(witness) | {there}
        case _:
            return False


def _conjuncts(value: Value) -> frozenset[Value]:
    if isinstance(value, And):
        return frozenset().union(*map(_conjuncts, value.values))
    return frozenset((value,))


def _longer(block: Block, most: int) -> Block:
    """The block with its counter's maximum raised to `most`."""
    instructions = list[Instruction]()
    for instruction in block.instructions:
        assert isinstance(instruction, Choose)
        branches = tuple(
            (condition, _grown(then, most)) for condition, then in instruction.branches
        )
        instructions.append(Choose(branches, _grown(instruction.otherwise, most)))
    return replace(block, instructions=tuple(instructions))


def _grown(instruction: SetCounter | Advance, most: int) -> SetCounter | Advance:
    match instruction:
        case Advance(counter, before):
            return Advance(counter, max(before, most))
        case SetCounter():
            return instruction
        case _:
            assert_never(instruction)
