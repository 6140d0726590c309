"""What a sentence means, in English: every template says what SEMANTICS says, no more, no less."""

import pytest

from fretish import syntax as s
from fretish.clock import Clock, in_ticks
from fretish.diagnostics.source import Source
from fretish.meaning import meaning, span
from fretish.parser import parse


def english(text: str, clock: Clock | None = None) -> str:
    sentence = parse(Source("r.fret", text).span())
    assert isinstance(sentence, s.Sentence)
    ticks = in_ticks(sentence, clock)
    assert ticks is None or isinstance(ticks, int)
    return meaning(sentence, ticks, clock)


@pytest.mark.parametrize(
    ("sentence", "text"),
    [
        (
            "the sw shall satisfy q",
            "Over the whole run: from its first tick on, `q` must be true at that tick or at a "
            "later one before the run ends.",
        ),
        (
            "whenever too_close agilex_agent shall eventually satisfy stopped",
            "Over the whole run: at every tick at which `too_close` is true, `stopped` must be "
            "true at that tick or at a later one before the run ends.",
        ),
        (
            "when p the sw shall within 3 ticks satisfy q",
            "Over the whole run: at every tick at which `p` becomes true (or is true at the "
            "first tick), `q` must be true at that tick or within the next 3 ticks (nothing is "
            "required if the run ends before that).",
        ),
        (
            "in m, whenever p the sw shall for 2 ticks satisfy q",
            "In every stretch of ticks on which `m` is true: at every tick at which `p` is true, "
            "`q` must be true at that tick and for the next 2 ticks, or until the stretch ends.",
        ),
        (
            "except in m, the sw shall finally satisfy q",
            "In every stretch of ticks on which `m` is false: from its first tick on, `q` must be "
            "true at the last tick of the stretch.",
        ),
        (
            "before m, the sw shall always satisfy q",
            "Before the first tick at which `m` is true: from its first tick on, `q` must be true "
            "at that tick and at every later one until that part ends.",
        ),
        (
            "after m, when p the sw shall immediately satisfy q",
            "After the first stretch of ticks on which `m` is true: at every tick at which `p` "
            "becomes true (or is true at the first tick there), `q` must be true at that same "
            "tick.",
        ),
        (
            "whenever p the sw shall at the next timepoint satisfy q",
            "Over the whole run: at every tick at which `p` is true, `q` must be true at the next "
            "tick, if the run has one.",
        ),
        (
            "only in m, the sw shall immediately satisfy q",
            "Outside of `m`, in every stretch of ticks on which it is false: from its first tick "
            "on, `q` must be false at that same tick.",
        ),
        (
            "only before m, the sw shall eventually satisfy q",
            "From the first tick at which `m` is true: from its first tick on, `q` must be "
            "false at that tick and at every later one until the run ends.",
        ),
        (
            "only after m, the sw shall finally satisfy q",
            "Up to the end of the first stretch of ticks on which `m` is true: from its first "
            "tick on, `q` must be false at the last tick of that part.",
        ),
        (
            "the sw shall with probability >= 0.9 never satisfy x-3 > 0",
            "Over the whole run: from its first tick on, `x - 3 > 0` must be false at that tick "
            "and at every later one until the run ends. This must hold with a probability >= 0.9.",
        ),
    ],
)
def test_a_sentence_says_in_english_what_it_means(sentence: str, text: str) -> None:
    assert english(sentence) == text


def test_a_duration_is_told_in_ticks_and_in_time() -> None:
    assert english("the sw shall for 300 milliseconds satisfy q", Clock(10**8)) == (
        "Over the whole run: from its first tick on, `q` must be true at that tick and for the "
        "next 3 ticks (300 ms), or until the run ends."
    )
    assert span(1, Clock(10**8)) == "1 tick (100 ms)"
    assert span(2, Clock(None, "/scan")) == "2 ticks"


@pytest.mark.parametrize(
    ("timing", "text"),
    [
        (
            "within 3 ticks",
            "`q` must be false at that tick and for the next 3 ticks, or until the stretch ends.",
        ),
        (
            "for 2 ticks",
            "`q` must be false at that tick or within the next 2 ticks (nothing is required if "
            "the stretch ends before that).",
        ),
        ("always", "`q` must be false at that tick or at a later one before the stretch ends."),
        ("never", "`q` must be true at that tick or at a later one before the stretch ends."),
        ("at the next timepoint", "`q` must be false at the next tick, if the stretch has one."),
    ],
)
def test_an_only_scope_demands_the_negated_timing_outside(timing: str, text: str) -> None:
    assert english(f"only in m, the sw shall {timing} satisfy q") == (
        "Outside of `m`, in every stretch of ticks on which it is false: from its first tick "
        f"on, {text}"
    )


def test_after_n_forbids_an_early_answer_even_where_the_interval_ends_early() -> None:
    """No q in t..min(t+n, R), and q at t+n+1 if that is <= R: `unless` is about the last part."""
    text = english("the sw shall after 2 ticks satisfy q")
    assert not text.endswith("and true at the tick after those, unless the run ends before.")


def test_until_speaks_of_the_first_tick_at_which_the_stop_is_true() -> None:
    """`until s` is vacuous and `before s` fails if s(t): s need not `become` true."""
    for timing in ("until s", "before s"):
        assert "becomes true" not in english(f"the sw shall {timing} satisfy q")
