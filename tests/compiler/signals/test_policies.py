"""Descriptions of propositions mean what the audit computes of the expressions."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.signals import numbers as n
from compiler.signals.policies import meaning
from fretc.logs.signals.samples import widest
from fretish import expressions as e
from fretish.bindings.declarations import Path, Proposition, Signal
from fretish.units import ONE
from tests.each import each
from tests.effort import examples
from tests.signal_policies import KINDS, SIGNS, audited_truth, signals, truth_of, truths_of


@pytest.mark.slow
@examples(8)
@given(st.data())
def test_a_description_has_the_truth_that_the_audit_computes(data: st.DataObject) -> None:
    declared: dict[str, Signal] = {name: data.draw(signals(name)) for name in ("a", "b")}
    check(data.draw(truths_of(("a", "b"))), declared, data)


def check(tree: e.Expression, declared: dict[str, Signal], data: st.DataObject) -> None:
    """Check the truth of an expression for some numbers of its signals."""
    row: dict[str, Any] = {
        name: data.draw(st.sampled_from([*KINDS]).flatmap(KINDS.__getitem__)) for name in declared
    }
    samples = {name: widest(np.array([value])) for name, value in row.items()}
    given_row = {
        name: value if isinstance(value, np.float32) else value.item() * 1
        for name, value in row.items()
    }
    try:
        lowered = meaning(Proposition("p", tree), declared.values())
    except ValueError:  # a power that is too large, which the reader of bindings refuses
        return
    assert truth_of(lowered.truth, given_row) == audited_truth(tree, declared, samples)


SIGNAL = Signal("a", Path("/t", ("f",)), ONE, "")
A, B, C = map(e.Name, "abc")
MIDDLE = e.Call("max", (e.Call("min", (A, C)), B))


@pytest.mark.slow
@examples(20)
@given(st.data())
def test_computed_signals_have_the_numbers_of_an_audit(data: st.DataObject) -> None:
    declared: dict[str, Signal] = {name: data.draw(signals(name)) for name in ("a", "b")}
    tree = data.draw(truths_of(("a", "b"), rounded=True))
    check(tree, declared, data)


def test_a_computed_signal_is_its_expression() -> None:
    """So is each function that is printed for another language."""
    value = e.Call("min", (e.Call("max", (A, B)), e.Quantity("3", "m")))
    compared, inline = (
        e.Comparison("<", e.Arithmetic("+", side, A), e.Quantity("2", "m"))
        for side in (e.Calculation("v", value), value)
    )
    declared = [replace(SIGNAL, name=name) for name in "ab"]
    for gives_rounded in (False, True):
        one, other = (
            meaning(Proposition("p", tree), declared, gives_rounded=gives_rounded)
            for tree in (compared, inline)
        )
        assert one == other


def test_the_caller_gives_what_a_rounded_function_computes() -> None:
    root = e.Calculation("root", e.Call("sqrt", (A,)), True)
    tree = e.Comparison("<", e.Calculation("v", e.Arithmetic("+", root, B)), e.Quantity("2", "m"))
    declared = [replace(SIGNAL, name=name) for name in "ab"]
    given_root = meaning(Proposition("p", tree), declared, gives_rounded=True)
    total = n.Computed("plus", n.SignalValue("root"), n.SignalValue("b"))
    assert given_root.truth == n.Comparison("<", total, n.Constant(Fraction(2)))
    computed = meaning(Proposition("p", tree), declared)
    call = n.RoundedCall("sqrt", (n.SignalValue("a"),))
    total = n.Computed("plus", call, n.SignalValue("b"))
    assert computed.truth == n.Comparison("<", total, n.Constant(Fraction(2)))


@each("sign", SIGNS)
@each("whole", [2**53 + 1, -(2**53) - 1, 2**63 + 2049])
@each("tree", [MIDDLE, e.Negation(MIDDLE), e.Call("abs", (MIDDLE,)), e.Arithmetic("+", MIDDLE, B)])
def test_a_float_that_was_chosen_beside_a_whole_number_is_compared_as_that_is(
    tree: e.Expression, whole: int, sign: Any
) -> None:
    """An audit has all of a column as numbers of the widest kind, whatever was chosen."""
    compared = e.Comparison(sign, tree, e.Number(str(whole)))
    declared = {name: replace(SIGNAL, name=name) for name in "abc"}
    row = {"a": np.int64(2**60), "b": np.float64(whole), "c": np.float64(7 - 2.0**62 * (whole < 0))}
    samples = {name: widest(np.array([value])) for name, value in row.items()}
    lowered = meaning(Proposition("p", compared), declared.values())
    plain = {name: value.item() for name, value in row.items()}
    assert truth_of(lowered.truth, plain) == audited_truth(compared, declared, samples)


def test_durations_are_inputs_in_the_order_in_which_they_close() -> None:
    inner = e.Persistence(e.Name("a"), 10)
    tree = e.And((e.Not(e.Persistence(e.Not(inner), 20)), inner))
    lowered = meaning(Proposition("p", tree), ())
    assert lowered.truth == n.All((n.Not(n.HeldFor(1)), n.HeldFor(2)))
    assert lowered.held == (
        (n.BooleanSignal("a"), 10),
        (n.Not(n.HeldFor(0)), 20),
        (n.BooleanSignal("a"), 10),
    )
