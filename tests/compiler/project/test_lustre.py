"""FRET's assignments in Lustre, and expressions of FRETish: only what certainly is the same."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.project.lustre import fretish, lustre
from fretish import expressions as e
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.parser import parse_value
from fretish.printer import expression
from tests.monitoring import monitor, steps
from tests.strategies import expressions


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("0.5", "0.5"),
        ("-3", "-3"),
        ("true", "true"),
        ("a and not b", "a & !b"),
        ("not(a or b) => c", "!(a | b) -> c"),
        ("x <> 3 and y >= z + 1.0", "x != 3 & y >= z + 1.0"),
        ("a or b and c", "a | b & c"),
        ("a => b => c", "a -> b -> c"),
        ("x mod 2 = 0", "x mod 2 = 0"),
        ("preReal(0.0, speed) < speed", "preReal(0.0, speed) < speed"),
        ("(a xor b) and (x < 3)", "(a xor b) & x < 3"),
        ("x=3", "x = 3"),
        ("a or (b xor c)", "a | (b xor c)"),
        ("0.0 -> pre x", "preReal(0.0, x)"),
        ("-1 -> pre(x + 1)", "preInt(-1, x + 1)"),
        ("1e3 -> pre x", "preReal(1e3, x)"),
        ("false -> pre (a and b)", "preBool(false, a & b)"),
        ("x - (0.0 -> pre x) <= 10.0", "x - preReal(0.0, x) <= 10.0"),
        ("not (true -> pre b) and c", "!preBool(true, b) & c"),
        ("true -> pre (false -> pre b)", "preBool(true, preBool(false, b))"),
        ("0.0 -> (x - pre x)", "x - preReal(x, x)"),
        ("0.0 -> x - pre x", "x - preReal(x, x)"),
        ("0 -> ( n - pre n ) * 10", "(n - preInt(n, n)) * 10"),
        ("0.0 -> (x - pre x) / 2.5", "(x - preReal(x, x)) / 2.5"),
    ],
)
def test_lustre_is_read(text: str, meaning: str) -> None:
    tree = fretish(text)
    assert tree is not None
    assert expression(tree) == meaning


@pytest.mark.parametrize(
    "text",
    [
        "",
        "0.0 -> x",
        "1.0 -> (x - pre x)",
        "0.0 -> (x - pre y)",
        "0.0 -> (x - pre x) + 1.0",
        "0.0 -> (x - pre x) / 0.0",
        "0.0 -> (x - pre x) * y",
        "0.0 -> x - pre x * 2.0",
        "0.0 -> (x - pre x) * 2.0 + 1.0",
        "0.0 -> pre x + 1.0",
        "x - 1.0 -> pre x",
        "a or true -> pre b",
        "true -> pre a and b",
        "a -> pre b",
        "0.0 -> pre x -> pre y",
        "0.0 -> pre abs(x)",
        "f(0.0 -> pre x)",
        "0.0 -> pre pre x",
        "0.0 -> pre true",
        "-> pre x",
        "0.0 -> pre",
        "true -> pre (" * 300,
        "if a then b else c",
        "pre(x)",
        "x div 2",
        "not x = y",
        "not (x) = y",
        "a or b xor c",
        "a && b",
        "a ; b",
        "speed = ",
        "5 m",
        "x[2]",
        "the x",
        "(" * 30_000,
    ],
)
def test_what_is_not_certain_stays_a_text(text: str) -> None:
    assert fretish(text) is None


@pytest.mark.parametrize("text", ["1.5 m/s", "x ^ 2 < 3", '"two words" & a', "a.b"])
def test_what_lustre_has_not_is_not_written(text: str) -> None:
    tree = parse_value(Source("v", text).span())
    assert not isinstance(tree, Diagnostic)
    assert lustre(tree) is None


@pytest.mark.slow
@given(expressions)
def test_what_is_written_is_read_as_the_same_or_not_at_all(tree: e.Expression) -> None:
    """But for `<->`, which Lustre has no sign for beside `=`."""
    text = lustre(tree)
    if text is None or any(isinstance(part, e.Iff) for part in e.parts(tree)):
        return
    again = fretish(text)
    assert again is None or again == tree
    if not any(isinstance(part, e.Name | e.Call) for part in e.parts(tree)):
        assert again == tree


# Delays: a naive evaluator of Lustre's streams ---------------------------------------------------

Stream = tuple[str, list[bool]]
"""An expression of Lustre, and its value at each tick of one run."""
RUN = {"p": [True, False, False, True, True, False], "q": [False, False, True, True, False, True]}


def streams(inner: st.SearchStrategy[Stream]) -> st.SearchStrategy[Stream]:
    literals = st.booleans()
    delays = st.builds(
        lambda first, one: (
            f"({str(first).lower()} -> pre ({one[0]}))",
            [first, *one[1][:-1]],
        ),
        literals,
        inner,
    )
    joins = st.builds(
        lambda one, two: (
            f"(({one[0]}) and ({two[0]}))",
            [a and b for a, b in zip(one[1], two[1], strict=True)],
        ),
        inner,
        inner,
    )
    negations = st.builds(lambda one: (f"(not ({one[0]}))", [not a for a in one[1]]), inner)
    return delays | joins | negations


@pytest.mark.slow
@given(st.recursive(st.sampled_from([*RUN.items()]), streams, max_leaves=4))
def test_a_delay_means_what_it_means_in_lustre(stream: Stream) -> None:
    text, values = stream
    tree = fretish(text)
    assert tree is not None
    machine = monitor(f"the sw shall always satisfy r <-> ({expression(tree)})")
    columns = {**RUN, "r": values}
    assert steps(machine, columns)[-1].first_violation is None
    for place, value in enumerate(values):
        other = [*values[:place], not value, *values[place + 1 :]]
        assert steps(machine, {**RUN, "r": other})[-1].first_violation == place
