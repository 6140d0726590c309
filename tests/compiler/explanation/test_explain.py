"""Explanations of sentences whose parts share propositions; each checks itself as it is made."""

import random
from xml.etree import ElementTree

import pytest

from compiler.explanation.drawing import svg
from compiler.explanation.explain import TickRow, as_record, explanation, text
from fretish.clock import Clock
from tests.effort import FULL
from tests.monitoring import requirement

PARTS = ("p", "q", "!p", "!q", "p & q", "p | q", "p xor q", "p -> q", "true", "false", "p & !r")
SCOPES = ("", "in m mode", "while {}", "before {}", "after {}", "only in m mode", "only before {}")
CONDITIONS = ("", "upon {}", "whenever {}", "if {}")
TIMINGS = (
    "", "immediately", "at the next timepoint", "finally", "eventually", "always", "never",
    "within 2 ticks", "for 3 ticks", "after 1 tick", "until {}", "before {}", "within 0 ticks",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8 if FULL else 1))
def test_sentences_whose_parts_share_propositions_are_explained(seed: int) -> None:
    choose = random.Random(seed)
    for _ in range(25):
        scope, condition, timing = (
            choose.choice(of).format(choose.choice(PARTS)) for of in (SCOPES, CONDITIONS, TIMINGS)
        )
        sentence = f"{scope} {condition} sw shall {timing} satisfy {choose.choice(PARTS)}"
        explained = explanation(requirement(sentence))
        assert explained.traces or explained.notes, sentence
        assert as_record(explained)["sentence"] == " ".join(sentence.split())
        assert ElementTree.fromstring(svg(explained.picture)).get("role") == "img"


def test_equal_ticks_are_one_row_but_for_the_tick_that_decides() -> None:
    explained = explanation(
        requirement("when p sw shall within 1000 ticks satisfy q", clock=Clock(10**6))
    )
    silent = explained.traces[2]
    assert silent.rows == (
        TickRow(0, 0, (True, False), repeats=False, decides=False),
        TickRow(1, 999, (False, False), repeats=False, decides=False),
        TickRow(1000, 1000, (False, False), repeats=False, decides=True),
    )
    assert silent.reason == (
        "triggered at tick 0, `q` is false at ticks 0 to 1000; the bound is 1000 ticks (1 s)"
    )


@pytest.mark.parametrize(
    ("sentence", "note"),
    [
        ("sw shall always satisfy q | !q", "no run violates the sentence"),
        ("sw shall always satisfy q & !q", "no run that goes on satisfies the sentence"),
        (
            "sw shall with probability >= 0.9 eventually satisfy q",
            "a run counts as one that satisfies or violates; the probability is over many runs",
        ),
        ("sw shall finally satisfy q", "on a run without end nothing is required"),
        (
            "whenever persisted(3, p) sw shall immediately satisfy q",
            "no traces are shown: `persisted` refers to other ticks, but the automaton reads one "
            "tick at a time",
        ),
        ("sw shall immediately satisfy q", "no other way to satisfy the sentence was found"),
    ],
)
def test_what_traces_do_not_tell_is_noted(sentence: str, note: str) -> None:
    assert note in explanation(requirement(sentence)).notes


def test_an_undecided_trace_says_so() -> None:
    told = text(explanation(requirement("whenever p sw shall eventually satisfy q")))
    assert told.count("decided at the end only") == 4
    assert "← decided" not in told
