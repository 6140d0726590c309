"""Counters that are the age of an open demand."""

import random
from dataclasses import replace

import pytest

from compiler.program.clocks import clocks, lengthened
from compiler.program.instructions import Advance, Choose, SetCounter
from compiler.program.lowering import program
from compiler.program.values import Literal
from tests.monitoring import requirement
from tests.program_interpreter import initial, step
from tests.strategies import templates

WITHIN = "whenever p the sw shall within 3 ticks satisfy q"


@pytest.mark.slow
def test_a_clock_is_as_old_as_the_open_demand() -> None:
    choose, found = random.Random(0), 0
    for template in templates((0, 1, 2, 3)):
        one = requirement(template.sentence)
        plain = program({"R1": one.watch})
        known = clocks(plain)
        if known:
            found += 1
            made = lengthened(plain, known)
            most = made.requirements[0].deadline_ticks
            assert most is not None
            state, is_possible = initial(made), choose.choice([False, True])
            for _ in range(30):
                row = {name: choose.choice([False, False, True, None]) for name in one.watched}
                state = step(made, state, row, is_possible)
                opened = state.marks[0].open
                age = min(state.tick - opened, most + 1) if opened >= 0 else -1
                told = int(state.values[known["R1"]])
                assert min(told, most + 1) == age, (template, state)
    assert found > 100


def test_a_counter_that_starts_again_is_no_clock() -> None:
    plain = program({"R1": requirement(WITHIN).watch})
    assert clocks(plain) == {"R1": "oldest_1"}
    blocks = {block.name: block for block in plain.blocks}
    (choice,) = blocks["oldest_1"].instructions
    assert isinstance(choice, Choose)
    (kept, grown), _ = choice.branches
    assert isinstance(grown, Advance)
    anyhow = Choose(
        ((kept, grown), (Literal("p", True), SetCounter("oldest_1", 0))), choice.otherwise
    )
    blocks["oldest_1"] = replace(blocks["oldest_1"], instructions=(anyhow,))
    assert clocks(replace(plain, blocks=tuple(blocks.values()))) == {}
