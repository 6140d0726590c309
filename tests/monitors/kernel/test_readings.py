"""Words and truth values of a tick; numbers are compared with an audit with the comparisons."""

import numpy as np
import pytest

from monitors.kernel.readings import is_word, truth_value, word

WORDS = ("drive", "dock")


def test_a_word_is_one_of_those_declared_or_unknown() -> None:
    assert [word(each, "mode", WORDS) for each in ("dock", np.str_("drive"), None)] == [
        *("dock", "drive", None)
    ]
    with pytest.raises(ValueError, match=r"`mode` is one of drive, dock, or None .*, not 'Dock'"):
        word("Dock", "mode", WORDS)
    with pytest.raises(TypeError, match=r"`mode` is one of drive, dock, or None .*, not 1"):
        word(1, "mode", WORDS)


def test_an_unknown_word_is_neither_equal_nor_unequal() -> None:
    assert [is_word(each, "=", "dock") for each in ("dock", "drive", None)] == [True, False, None]
    assert [is_word(each, "!=", "dock") for each in ("dock", "drive", None)] == [False, True, None]


def test_a_truth_value_is_no_number() -> None:
    values = [truth_value(each, "p") for each in (True, np.bool_(False), None)]
    assert values == [True, False, None]
    assert type(values[1]) is bool
    with pytest.raises(TypeError, match="`p` is True, False or None"):
        truth_value(0, "p")
