"""A pattern of names means what a regular expression of greedy places means, at a price."""

import re
from time import process_time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fretish.reading.name_patterns import match, names

PIECES = st.sampled_from(["{a}", "{b}", "{c}", "*", "-", "x", "xy", ".mcap", "/"])


def expression(pattern: str) -> re.Pattern[str]:
    """The same as a regular expression, which may take for ever."""
    parts = re.split(r"(\{\w+\}|\*)", pattern)
    forms = {"*": "[^/]*"} | {f"{{{name}}}": f"(?P<{name}>[^/]+)" for name in "abc"}
    return re.compile("".join(forms.get(part, re.escape(part)) for part in parts), re.DOTALL)


@given(st.lists(PIECES, min_size=1, max_size=7), st.text("xy-.mcap/\n", max_size=14))
def test_it_is_the_greedy_match(pieces: list[str], path: str) -> None:
    pattern = "".join(pieces)
    if isinstance(names(pattern), str):
        return
    tail = "/".join(path.split("/")[-(pattern.count("/") + 1) :])
    found = expression(pattern).fullmatch(tail)
    assert match(pattern, path) == (found.groupdict() if found else None)


def test_each_place_takes_as_much_as_it_can() -> None:
    found = match("{scenario}-{seed}.mcap", "nights/3/safety-late-12.mcap")
    assert found == {"scenario": "safety-late", "seed": "12"}
    found = match("v{version}/*-{seed}.mcap", "runs/v1.2/a-b-7.mcap")
    assert found == {"version": "1.2", "seed": "7"}
    assert match("{a}/{b}", "alone") is None


@pytest.mark.parametrize("pattern", ["", "{}", "{a", "a}", "a//b", "{a}{a}", "x" * 201, "{1}"])
def test_what_is_no_pattern_says_why(pattern: str) -> None:
    assert isinstance(names(pattern), str)


def test_a_name_of_a_stranger_takes_no_time() -> None:
    began = process_time()
    assert match("{a}x{b}x{c}x*x*x*y", "x" * 1000) is None
    assert process_time() - began < 1
