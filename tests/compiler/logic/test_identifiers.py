"""Names for propositions in languages that know identifiers only."""

import re

from hypothesis import given
from hypothesis import strategies as st

from compiler.logic.identifiers import legal_names
from compiler.logic.spelling.reserved_words import ReservedWords
from tests.strategies import NAMES


def test_comparisons_are_spelt_and_names_stay() -> None:
    assert legal_names(["(x > 3)", "too_close", "a.b", "f(x,(y + 1))", "(x <= 0.5)"], ()) == {
        "(x > 3)": "x_gt_3",
        "too_close": "too_close",
        "a.b": "a_DOT_b",
        "f(x,(y + 1))": "f_x_y_plus_1",
        "(x <= 0.5)": "x_le_0_5",
    }


def test_names_as_they_are_come_first() -> None:
    assert legal_names(["(x > 3)", "x_gt_3"], ()) == {"(x > 3)": "x_gt_3_2", "x_gt_3": "x_gt_3"}


def test_reserved_words_and_what_begins_with_no_letter_are_changed() -> None:
    assert legal_names(["init", "_p", "(3 > x)"], {"init", "init_2"}) == {
        "init": "init_3",
        "_p": "v__p",
        "(3 > x)": "v_3_gt_x",
    }


def test_a_name_of_a_reserved_family_begins_in_another_way() -> None:
    family = ReservedWords(frozenset(), r"fretc_\w+|int\d*")
    assert legal_names(["fretc_truth", "int", "v_fretc_truth"], family) == {
        "fretc_truth": "v_fretc_truth_2",
        "int": "int_2",
        "v_fretc_truth": "v_fretc_truth",
    }


def test_what_is_legal_keeps_its_name_whatever_comes_before() -> None:
    assert legal_names(["init", "init_2", "a.b", "a_DOT_b"], {"init"}) == {
        "init": "init_3",
        "init_2": "init_2",
        "a.b": "a_DOT_b_2",
        "a_DOT_b": "a_DOT_b",
    }


def test_a_prefix_begins_them_all() -> None:
    assert legal_names(["p", "q"], {"p_q"}, "p_") == {"p": "p_p", "q": "p_q_2"}


@given(st.lists(st.sampled_from([*NAMES, "(x > 3)", "(x < 3)", "x_gt_3", "(x>3)", '"f(x)"'])))
def test_no_name_comes_twice(propositions: list[str]) -> None:
    names = legal_names(propositions, {"p", "speed_2"})
    assert set(names) == set(propositions)
    assert len(set(names.values())) == len(names)
    assert all(re.fullmatch("[A-Za-z][A-Za-z0-9_]*", name) for name in names.values())
    assert not {"p", "speed_2"} & set(names.values())
