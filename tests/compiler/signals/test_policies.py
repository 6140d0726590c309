"""Descriptions of propositions mean what the audit computes of the expressions."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from compiler.signals import numbers as n
from compiler.signals.policies import meaning
from fretc.logs.signals.samples import widest
from fretish import expressions as e
from fretish.bindings.declarations import Proposition, Signal
from tests.signal_policies import KINDS, audited_truth, signals, truth_of, truths_of


@given(st.data())
def test_a_description_has_the_truth_that_the_audit_computes(data: st.DataObject) -> None:
    declared: dict[str, Signal] = {name: data.draw(signals(name)) for name in ("a", "b")}
    tree = data.draw(truths_of(("a", "b")))
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


def test_durations_are_inputs_in_the_order_in_which_they_close() -> None:
    inner = e.Persistence(e.Name("a"), 10)
    tree = e.And((e.Not(e.Persistence(e.Not(inner), 20)), inner))
    lowered = meaning(Proposition("p", tree), ())
    assert lowered.truth == n.All((n.Not(n.Held(1)), n.Held(2)))
    assert lowered.held == (
        (n.Flag("a"), 10),
        (n.Not(n.Held(0)), 20),
        (n.Flag("a"), 10),
    )
