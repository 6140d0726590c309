"""Each requirement of a file is proved on all that it depends on, and on nothing else."""

from __future__ import annotations

import random
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.logic.claims import ClaimOutcome, ClaimResult
from fretc.verification.monitor.slices import slice_of
from monitors.loading import load
from tests.effort import FULL
from tests.monitoring import emitted, requirement
from tests.proofs import verified
from tests.strategies import Template, templates

SENTENCES = (
    "whenever p the sw shall within 3 ticks satisfy q",
    "in m when p the sw shall for 3 ticks satisfy r",
    "the sw shall always satisfy s | t",
    "after m the sw shall until u satisfy v",
)
MANY = tuple(f"whenever a{i} the sw shall within 2 ticks satisfy b{i}" for i in range(9))


def check(place: int, text: str, sentences: tuple[str, ...] = SENTENCES) -> ClaimOutcome:
    requirements = [requirement(sentence, f"R{i + 1}") for i, sentence in enumerate(sentences)]
    return verified(requirements[place], text, others=requirements)


@pytest.mark.slow
def test_each_requirement_of_a_file_with_many_propositions_is_proved() -> None:
    text = emitted(*MANY)
    assert all(check(i, text, MANY).result is ClaimResult.PROVED for i in (0, 4, 8))


WIDE = tuple(f"the sw shall always satisfy a{i} | b{i}" for i in range(40 if FULL else 33))


@pytest.mark.slow
def test_a_requirement_of_a_file_is_proved_where_a_step_takes_a_mapping() -> None:
    text = emitted(*WIDE)
    step = "self._step(self._row(propositions))\n"
    last = len(WIDE) - 1
    assert check(last, text, WIDE).result is ClaimResult.PROVED
    for other in (
        f"self._step(self._row({{**propositions, 'a{last}': True}}))\n",
        "self._step(tuple(propositions.values()))\n",
        f"{step}        {step}",
    ):
        assert check(last, broken(text, step, other), WIDE).result is ClaimResult.NOT_CHECKED


def test_a_slice_is_what_a_requirement_names_and_the_cells_that_it_steps() -> None:
    text = emitted(*SENTENCES)
    monitor = load("m", text)
    found = [slice_of(text, f"r{i}", monitor.PROPOSITIONS).propositions for i in range(1, 5)]
    assert found == [{"p", "q"}, {"m", "p", "r"}, {"s", "t"}, {"m", "u", "v"}]


def broken(text: str, old: str, new: str) -> str:
    place = text.index("# The requirements ---")
    assert old in text[place:]
    return text[:place] + text[place:].replace(old, new, 1)


@pytest.mark.slow
def test_what_looks_at_another_proposition_is_not_taken_for_independent() -> None:
    """Were `s` left out of the comparison as false, the change would never show."""
    text = broken(emitted(*SENTENCES), "            if p:\n", "            if p or s:\n")
    monitor = load("m", text)
    assert "s" in slice_of(text, "r1", monitor.PROPOSITIONS).propositions
    assert check(0, text).result is not ClaimResult.PROVED
    assert check(2, text).result is not ClaimResult.COUNTEREXAMPLE


@pytest.mark.slow
def test_a_wrong_requirement_is_refuted_by_a_trace_that_the_file_can_step() -> None:
    text = broken(emitted(*SENTENCES), ">= 3", ">= 4")
    outcome = check(0, text)
    assert outcome.result is ClaimResult.COUNTEREXAMPLE
    assert outcome.trace is not None
    assert {*outcome.trace.names} >= {*load("m", text).PROPOSITIONS}
    assert all(len(row) == len(outcome.trace.names) for row in outcome.trace.rows)


def named(sentence: str, number: int) -> str:
    """The sentence over names of its own, but that every second one has the same."""
    return re.sub(r"\b[mpqs]\b", lambda name: f"{name[0]}{number % 2}", sentence)


CONTRADICTING = "whenever x < 2 the sw shall within 2 ticks satisfy !(x > 3)"


@pytest.mark.slow
def test_no_counterexample_has_comparisons_that_contradict_each_other() -> None:
    """The edits show at ticks with both as well as at others, or with an unknown x."""
    text = emitted(CONTRADICTING)
    for old, new in (
        ("elif x_lt_2 and x_gt_3:", "elif x_lt_2 and x_gt_3 and not x_lt_2:"),
        ("if oldest_1 >= 0 and x_gt_3:", "if oldest_1 >= 0 and not x_gt_3:"),
        ("            if x_lt_2:\n", "            if x_lt_2 and not x_gt_3:\n"),
        ("since(x_gt_3,", "since(x_lt_2,"),
    ):
        outcome = verified(requirement(CONTRADICTING), broken(text, old, new))
        assert outcome.result is not ClaimResult.PROVED
        if outcome.trace is not None:
            places = [outcome.trace.names.index(name) for name in ("(x < 2)", "(x > 3)")]
            assert not any(all(row[i] is True for i in places) for row in outcome.trace.rows)


@pytest.mark.slow
@settings(max_examples=12 if FULL else 6)
@given(
    st.lists(st.sampled_from([*templates(counts=(2,))]), min_size=2, max_size=3, unique=True),
    st.integers(0, 10**6),
)
def test_no_proposition_outside_of_a_slice_changes_anything(
    some: list[Template], seed: int
) -> None:
    text = emitted(*(named(each.sentence, number) for number, each in enumerate(some)))
    one, other = load("m", text), load("m", text)
    choose = random.Random(seed)
    for place in range(len(some)):
        part = slice_of(text, f"r{place + 1}", one.PROPOSITIONS).propositions
        one.reset()
        other.reset()
        for _ in range(12):
            row = {name: choose.random() < 0.5 for name in one.PROPOSITIONS}
            changed = {n: v if n in part else choose.random() < 0.5 for n, v in row.items()}
            one.advance([row])
            other.advance([changed])
            assert one.certain.signals()[place] == other.certain.signals()[place]
            assert one.certain.marks()[place] == other.certain.marks()[place]
