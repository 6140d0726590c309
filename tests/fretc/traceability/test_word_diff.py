"""The difference of two texts: nothing of either is lost, and one word is reported alone."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretc.traceability.word_diff import AFTER, BEFORE, _around, segments, short

WORDS = st.lists(st.sampled_from(["x", "<", "0.4 m/s", "5 cm", "for", "(", ")", "ok", "&", "12"]))
TEXTS = WORDS.map(" ".join)


@given(TEXTS, TEXTS)
def test_both_texts_can_be_read_in_their_segments(before: str, after: str) -> None:
    found = segments(before, after)
    assert "".join(text for kind, text in found if kind != AFTER) == before
    assert "".join(text for kind, text in found if kind != BEFORE) == after
    assert all(text for _, text in found)


@given(TEXTS)
def test_equal_texts_have_one_segment(text: str) -> None:
    assert segments(text, text) == ((("same", text),) if text else ())


@pytest.mark.parametrize(
    ("before", "after", "told"),
    [
        ("x <= 0.40 m/s", "x <= 0.35 m/s", "x <= 0.40 m/s → 0.35 m/s"),
        ("x > 1 m for 2 s", "x > 2 m for 2 s", "x > 1 m → 2 m …"),
        ("within 3 seconds", "within 3 ticks", "within 3 seconds → 3 ticks"),
        ("x > 1 m", "x >= 1 m", "x > 1 m → x >= 1 m"),
        ("ok", "ok & ok", "ok → ok & ok"),
        ("It falls", "It flies", "It falls → flies"),
        ("/a.x", "/a.z", "/a.x → /a.z"),
        ("3 obstacles", "4 obstacles", "3 → 4 …"),
        ("none", "10 ms", "none → 10 ms"),
        (
            "a sentence of many words, which go on and on, ends with x",
            "a sentence of many words, which go on and on, ends with y",
            "… words, which go on and on, ends with x → y",
        ),
    ],
)
def test_a_word_that_differs_is_told_with_what_stands_before_it(
    before: str, after: str, told: str
) -> None:
    assert short(before, after) == told


def test_long_texts_are_told_around_their_difference() -> None:
    before, after = "word " * 2000 + "a b", "word " * 2000 + "c d"
    assert len(short(before, after)) < 600
    assert sum(len(text) for _, text in segments(before, after)) < 2 * 2100


def test_long_texts_are_told_where_they_differ() -> None:
    words = [f"w{i}" for i in range(1000)]
    other = [*words[:700], "a", "b", *words[700:]]
    assert "a b" in short(" ".join(words), " ".join(other))
    (new,) = (text for kind, text in segments(" ".join(words), " ".join(other)) if kind == AFTER)
    assert new.startswith("a b")
    assert len(new) < 20


def test_a_number_of_a_long_text_is_told_whole() -> None:
    words = " ".join(["w"] * 1000)
    found = segments(f"{words} 0.40 m", f"{words} 0.45 m")
    assert [text for kind, text in found if kind != "same"] == ["0.40", "0.45"]


@given(st.text("ab ", max_size=40), st.text("ab ", max_size=40))
def test_long_texts_lose_nothing_either(before: str, after: str) -> None:
    found = _around(before, after)
    assert "".join(old for _, old, _, _ in found) == before
    assert "".join(new for _, _, new, _ in found) == after
