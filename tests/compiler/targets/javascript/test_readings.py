"""Numbers in JavaScript are those in Python, to the last bit."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.files.templating import render
from compiler.formalization.formalize import formalize
from compiler.targets.javascript.constants import Constants, scale, truth
from compiler.targets.javascript.monitor import text
from compiler.targets.python.comparisons import (
    NUMBER,
    ComparisonWriter,
    CompiledComparison,
    NotCompiledError,
    Spelling,
    StepInput,
)
from compiler.targets.python.monitor import text as in_python
from fretish import expressions as e
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from monitors.loading import load
from tests.compiler.targets.python.test_comparisons import (
    BINDINGS,
    FACTORS,
    NAMES,
    UNITS,
    X,
    bare,
    compiled,
    rows,
    with_units,
)
from tests.compiler.targets.python.test_past_values import COMPARISONS
from tests.compiler.targets.python.test_past_values import requirement as past_rule
from tests.node import needs_node, outcomes, run

pytestmark = needs_node
Units = Mapping[str, tuple[str, Fraction]]
_READ = """
const given = (value) => value === null ? null : "float" in value ? Number(value.float)
  : "whole" in value ? BigInt(value.whole) : float32(Number(value.single));
const told = ROWS.map((row, i) => {
  const [x, y, z] = row.map((value, i) => number(given(value), "xyz"[i]));
  return COMPARISONS[i](x, y, z);
});
process.stdout.write(JSON.stringify(told));
"""


def plain(value: Any) -> Any:
    """As JSON holds it: a number of its kind, as text."""
    match value:
        case None:
            return None
        case int():
            return {"whole": str(value)}
        case _ if isinstance(value, np.float32):
            return {"single": _text(float(value))}
        case _:
            return {"float": _text(value)}


def _text(value: float) -> str:
    if math.isnan(value):
        return "NaN"
    return repr(value) if math.isfinite(value) else f"{'-' * (value < 0)}Infinity"


def by_node(cases: Sequence[tuple[e.Comparison, Units, Mapping[str, Any]]]) -> list[Any]:
    """The truth of each comparison, with its row."""
    constants = Constants()
    texts = []
    for tree, units, _ in cases:
        names = {name.id for name in e.names(tree)}
        inputs = {name: StepInput(NUMBER) for name in sorted(names)}
        kept = {name: unit for name, unit in units.items() if name in names}
        writer = ComparisonWriter(
            {name: name for name in names}, Spelling(constants.name, scale, truth)
        )
        texts.append(f"(x, y, z) => {writer.comparison(CompiledComparison(inputs, tree, kept))}")
    values = [[plain(row.get(name)) for name in NAMES] for _, _, row in cases]
    parts = (
        render("js/readings.js.j2"),
        *constants.lines(),
        f"const ROWS = {json.dumps(values)};",
        f"const COMPARISONS = [{', '.join(texts)}];",
        _READ,
    )
    told: list[Any] = json.loads(run("\n".join(parts)))
    return told


def is_compiled(tree: e.Comparison, units: Units) -> bool:
    try:
        compiled(tree, units)
    except NotCompiledError:
        return False
    return True


def no_units(tree: e.Comparison) -> tuple[e.Comparison, Units]:
    return tree, {}


some_units = st.fixed_dictionaries(dict.fromkeys(NAMES, st.sampled_from(UNITS))).map(
    lambda units: {name: (each, FACTORS[each]) for name, each in units.items()}
)
with_their_units = st.one_of(bare.map(no_units), st.tuples(with_units, some_units))
cases = st.tuples(with_their_units.filter(lambda each: is_compiled(*each)), rows)
MANY = settings().max_examples


@pytest.mark.slow
@settings(max_examples=max(4, MANY // 25))
@given(st.lists(cases, min_size=10, max_size=40))
def test_a_comparison_is_the_same(
    drawn: list[tuple[tuple[e.Comparison, Units], dict[str, Any]]],
) -> None:
    each = [(tree, units, row) for (tree, units), row in drawn]
    expected = [compiled(tree, units)(row) for tree, units, row in each]
    assert by_node(each) == expected


EDGES = (2**52, 2**53, 2**63, 2**64)
TEXTS = (
    *("0.35", "0.9", "1e400", "1e-400", "5e-324", "3.4028235677973366e38", "16777217"),
    *(f"{n + k}{half}" for n in EDGES for k in (-1, 0, 1) for half in ("", ".5")),
)


def edges() -> list[Any]:
    """Numbers of each kind, at constants and beside them."""
    whole = [sign * (n + k) for n in EDGES for k in (-1, 0, 1) for sign in (1, -1)]
    floats = [sign * float(text) for text in (*TEXTS, "0", "1e308", "3") for sign in (1, -1)]
    with np.errstate(all="ignore"):
        singles = [np.float32(value) for value in floats]
    return [None, math.nan, math.inf, -math.inf, *whole, *floats, *singles]


@pytest.mark.slow
def test_what_stands_at_an_edge_is_the_same() -> None:
    choose, values, y = random.Random("edges"), edges(), e.Name("y")
    speeds = {"x": ("km/h", Fraction(5, 18)), "y": ("m/s", Fraction(1))}
    calls = [e.Call(name, (X, y)) for name in ("min", "max")]
    calls += [e.Call("max", (e.Call("min", (X, e.Name("z"))), y))]
    drawn: list[tuple[e.Comparison, Units, dict[str, Any]]] = []
    for _ in range(100 * MANY // 4):
        fixed: e.Expression = e.Number(choose.choice(TEXTS))
        fixed = choose.choice([fixed, e.Negation(fixed)])
        some: tuple[e.Expression, ...] = (X, e.Call("abs", (X,)), e.Call("min", (X, fixed)), *calls)
        op, row = choose.choice([*e.COMPARE]), {name: choose.choice(values) for name in NAMES}
        near = float(choose.choice(TEXTS))  # where a bit more or less counts
        speed = choose.randrange(1, 1000) / 100
        with np.errstate(all="ignore"):
            row |= choose.choice(
                [
                    {},
                    {"x": int(near) + 1 if 1 < near < 2**65 else near, "y": near},
                    {"x": np.float32(near), "y": 0.1},
                    {"x": speed * 3.6, "y": speed},
                ]
            )
        tree = choose.choice([e.Comparison(op, choose.choice(some), fixed), e.Comparison(op, X, y)])
        drawn.append((tree, choose.choice([{}, speeds]) if tree.right is y else {}, row))
    with np.errstate(all="ignore"):
        expected = [compiled(tree, units)(row) for tree, units, row in drawn]
    assert by_node(drawn) == expected


WORDS = (
    "whenever mode = drive the sw shall within 1 ticks satisfy mode != wish & way > 50 cm",
    "the sw shall always satisfy v <= 150 cm/s & way - preReal(1 m, way) < gap",
    "the sw shall always satisfy way >= preReal(9007199254740993, way)",
)


@pytest.mark.slow
def test_words_and_ticks_before_are_the_same(tmp_path: Path) -> None:
    choose = random.Random("words")
    values: dict[str, Sequence[Any]] = {
        "number": (2.0**53, 0.0, 0.5, 1.0, 1.5, 149.9, 150.1, None),
        "word": ("drive", "docking", None),
        "truth": (True, False, None),
    }
    declared, wrong = read_bindings(Source("bindings.toml", BINDINGS))
    assert wrong == ()
    for place, sentence in enumerate((*WORDS, *COMPARISONS)):
        if sentence in WORDS:
            source = Source("r.fret", sentence)
            requirement, _ = formalize(RequirementEntry("R1", source.span()), declared)
            assert requirement is not None
        else:
            requirement = past_rule(sentence)
        machine: Any = load("monitor.py", in_python(requirement))
        kinds = [each.kind for each in machine.VARIABLES.values()]
        word = [[choose.choice(values[kind]) for kind in kinds] for _ in range(60)]
        word[0] = [values[kind][0] for kind in kinds]
        (folder := tmp_path / str(place)).mkdir()
        ((*told,),) = outcomes(folder, [text(requirement)], [(0, word)])
        for row, (outcome,) in zip(word, told, strict=True):
            machine.take([row])
            (status,) = machine.statuses()
            assert outcome["verdict"] == machine.verdicts()[0]
            assert (outcome["atEnd"], outcome["finite"]) == (status.verdict, status.finite)
