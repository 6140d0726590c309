"""Both engines of decision diagrams against truth tables, and a table of nodes that is full."""

import gc
import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.buddy_engine import BuddyEngine
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.diagrams.oxidd_engine import OxiddEngine

ROOT = Path(__file__).parents[4]
NUMBERS = (0, 2, 4, 300)
SPARE = {number: number + 1 for number in NUMBERS}
ASSIGNMENTS = [
    dict(zip(NUMBERS, values, strict=True)) for values in product((False, True), repeat=4)
]
Table = tuple[bool, ...]
"""Shape (16,): the value for each assignment."""
tables = st.tuples(*[st.booleans()] * len(ASSIGNMENTS))
subsets = st.sets(st.sampled_from(NUMBERS)).map(sorted)


@cache
def engine(name: str) -> Any:
    return {"OxiDD": OxiddEngine, "BuDDy": BuddyEngine}[name]()


@pytest.fixture(scope="module", autouse=True, params=["OxiDD", "BuDDy"])
def used(request: pytest.FixtureRequest) -> Iterator[str]:
    """The engine that the functions of the interface use."""
    name: str = request.param
    before = bdd.engine
    bdd.engine = lambda: engine(name)  # type: ignore[assignment]
    bdd._cube.cache_clear()
    yield name
    bdd.engine = before
    bdd._cube.cache_clear()


def made(table: Table) -> Function:
    """A diagram, from the conjunctions of literals where the function is true."""
    function = bdd.false()
    for values, value in zip(ASSIGNMENTS, table, strict=True):
        function = function | bdd.point(values) if value else function
    return function


def value(function: Function, values: Mapping[int, bool]) -> bool:
    while function not in (bdd.true(), bdd.false()):
        number, high, low = bdd.branches(function)
        function = high if values[number] else low
    return bool(function == bdd.true())


def table_of(function: Function) -> Table:
    return tuple(value(function, values) for values in ASSIGNMENTS)


def at(table: Table, values: Mapping[int, bool]) -> bool:
    return table[ASSIGNMENTS.index(dict(values))]


def computed(formula: Callable[[dict[int, bool]], bool]) -> Table:
    return tuple(formula(values) for values in ASSIGNMENTS)


def around(values: Mapping[int, bool], numbers: Sequence[int]) -> Iterator[dict[int, bool]]:
    """The assignments that differ in these variables only."""
    for changed in product((False, True), repeat=len(numbers)):
        yield {**values, **dict(zip(numbers, changed, strict=True))}


@given(tables, tables, tables)
def test_operators_are_those_of_truth_tables(f: Table, g: Table, h: Table) -> None:
    one, other, third = map(made, (f, g, h))
    assert table_of(one) == f
    assert (one == other) is (f == g)
    assert table_of(one & other) == tuple(a and b for a, b in zip(f, g, strict=True))
    assert table_of(one | other) == tuple(a or b for a, b in zip(f, g, strict=True))
    assert table_of(one ^ other) == tuple(a is not b for a, b in zip(f, g, strict=True))
    assert table_of(one - other) == tuple(a and not b for a, b in zip(f, g, strict=True))
    assert table_of(one >> other) == tuple(b or not a for a, b in zip(f, g, strict=True))
    assert table_of(-one) == tuple(not a for a in f)
    chosen = tuple(b if a else c for a, b, c in zip(f, g, h, strict=True))
    assert bdd.ite(one, other, third) == made(chosen)


@given(tables, tables, subsets)
def test_quantifiers_are_disjunctions_and_conjunctions(
    f: Table, g: Table, numbers: list[int]
) -> None:
    one, other, cube = made(f), made(g), bdd.cube(numbers)
    some = computed(lambda v: any(at(f, w) for w in around(v, numbers)))
    assert table_of(bdd.exists(one, cube)) == some
    both = computed(lambda v: any(at(f, w) and at(g, w) for w in around(v, numbers)))
    assert table_of(bdd.and_exists(one, other, cube)) == both
    implied = computed(lambda v: all(at(g, w) or not at(f, w) for w in around(v, numbers)))
    assert table_of(bdd.forall_implies(one, other, cube)) == implied


@given(tables, st.dictionaries(st.sampled_from(NUMBERS), tables))
def test_variables_are_replaced_all_at_once(f: Table, values: dict[int, Table]) -> None:
    """Also by functions of one another."""
    found = bdd.substitute(made(f), {number: made(g) for number, g in values.items()}, SPARE)
    expected = computed(lambda v: at(f, {n: at(values[n], v) if n in values else v[n] for n in v}))
    assert table_of(found) == expected


@given(tables, tables, subsets)
def test_no_spare_is_needed_where_no_value_reads_a_replaced_variable(
    f: Table, g: Table, numbers: list[int]
) -> None:
    cube = bdd.cube(numbers)
    free = bdd.exists(made(g), cube)
    found = bdd.substitute(made(f), dict.fromkeys(numbers, free))
    read = table_of(free)
    expected = computed(lambda v: at(f, {n: at(read, v) if n in numbers else v[n] for n in v}))
    assert table_of(found) == expected


@given(tables, st.dictionaries(st.sampled_from(NUMBERS), st.booleans()))
def test_a_restriction_fixes_the_variables_of_the_literals(
    f: Table, values: dict[int, bool]
) -> None:
    found = bdd.at(made(f), bdd.point(values))
    assert table_of(found) == computed(lambda v: at(f, {**v, **values}))
    assert not {*bdd.support(found)} & values.keys()


def levels(table: Table, level: int = 0) -> Iterator[tuple[int, Table]]:
    """The non-constant nodes of the reduced diagram: each with its level and its own table."""
    if len(table) > 1:
        low, high = table[: len(table) // 2], table[len(table) // 2 :]
        if low != high:
            yield level, table
        yield from levels(low, level + 1)
        yield from levels(high, level + 1)


@given(tables)
def test_support_size_and_nodes_are_those_of_the_reduced_diagram(f: Table) -> None:
    function, nodes = made(f), {*levels(f)}
    assert bdd.support(function) == tuple(NUMBERS[i] for i in sorted({i for i, _ in nodes}))
    assert bdd.size(function) == len(nodes)
    ordered = bdd.nodes([function])
    assert len({*ordered}) == len(ordered) == len(nodes)
    for place, node in enumerate(ordered):
        _, *after = bdd.branches(node)
        assert all(n in (bdd.true(), bdd.false()) or n in ordered[:place] for n in after)


@given(tables.filter(any), st.booleans())
def test_a_witness_is_the_preferred_one_of_those_that_are_true(f: Table, prefer: bool) -> None:
    found = bdd.witness(made(f), prefer)
    assert all(at(f, {**values, **found}) for values in ASSIGNMENTS)
    whole = {**dict.fromkeys(NUMBERS, prefer), **found}
    true = [values for values in ASSIGNMENTS if at(f, values)]
    assert whole == (true[-1] if prefer else true[0])


# A full table, and the choice of the engine -----------------------------------------------------


def fill(there: OxiddEngine, bits: int) -> Any:
    """The equality of two numbers whose bits are far apart, with some 2**bits nodes."""
    function = there.true
    for bit in range(bits):
        function = function & -(there.variable(bit) ^ there.variable(100 + bit))
    return function


def test_a_full_table_raises_a_memory_error_and_has_room_again_later() -> None:
    there = OxiddEngine(nodes=2**11)
    assert there.size(fill(there, 5)) > 2**5
    with pytest.raises(MemoryError):
        fill(there, 20)
    gc.collect()  # the traceback holds the diagrams in a cycle
    assert _has_room(there)


def _has_room(there: OxiddEngine) -> bool:
    """Whether there is room within five seconds: OxiDD frees nodes in a thread of its own."""
    for _ in range(100):
        with suppress(MemoryError):
            return there.size(fill(there, 5)) > 2**5
        time.sleep(0.05)
    return False


def test_the_engine_is_the_one_that_is_named(used: str) -> None:
    name = subprocess.check_output(
        [sys.executable, "-c", f"from {bdd.__name__} import engine; print(engine().name)"],
        env={**os.environ, "FRETC_DIAGRAMS": used.lower()},
        cwd=ROOT,
        text=True,
    )
    assert name == f"{used}\n"
