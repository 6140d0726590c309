"""What has become of a requirement, against the definition in words; red is never lost."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from fretc.audit.evidence.verdicts import BROKEN, SHOWN, VERDICTS
from fretc.trends.changes import RED, VerdictChange, change, is_flaky

ROUND = st.lists(st.sampled_from([*VERDICTS]), max_size=3)
HISTORY = st.lists(ROUND, min_size=1, max_size=6).filter(any)


def violated(verdicts: list[str]) -> bool:
    return any(word in BROKEN for word in verdicts)


def shown(verdicts: list[str]) -> bool:
    """Some run shows it, and no other is more than silent."""
    silent = ("vacuous", "not exercised", "retired")
    some = any(word in SHOWN for word in verdicts)
    return some and all(word in (*SHOWN, *silent) for word in verdicts)


def naive(rounds: list[list[str]]) -> VerdictChange:
    now, before = rounds[-1], [verdicts for verdicts in rounds[:-1] if verdicts]
    known = [violated(verdicts) for verdicts in before if violated(verdicts) or shown(verdicts)]
    if not now:
        return VerdictChange.GONE
    if not before:
        return VerdictChange.FIRST_VIOLATED if violated(now) else VerdictChange.FIRST
    if violated(now):
        return VerdictChange.STILL if known[-1:] == [True] else VerdictChange.NEW
    if shown(now):
        return VerdictChange.FIXED if known[-1:] == [True] else VerdictChange.STEADY
    return VerdictChange.LOST if known else VerdictChange.NEVER_SHOWN


@given(HISTORY)
def test_it_is_the_definition_in_words(rounds: list[list[str]]) -> None:
    assert change(rounds) is naive(rounds)


@given(HISTORY)
def test_what_is_violated_now_is_red_and_nothing_else_is(rounds: list[list[str]]) -> None:
    red = (*RED, VerdictChange.STILL)
    assert (change(rounds) in red) == violated(rounds[-1])


@given(HISTORY)
def test_a_violation_is_fixed_by_what_is_shown_alone(rounds: list[list[str]]) -> None:
    if change(rounds) is VerdictChange.FIXED:
        assert shown(rounds[-1])
        assert any(map(violated, rounds[:-1]))


@given(HISTORY, st.dictionaries(st.sampled_from("ab"), ROUND, max_size=2))
def test_flaky_is_more_than_one_turn_or_both_at_one_commit(
    rounds: list[list[str]], commits: dict[str, list[str]]
) -> None:
    known = ["V" if violated(r) else "S" for r in rounds if violated(r) or shown(r)]
    text = "".join(known)
    turns = text.count("VS") + text.count("SV")
    mixed = any(violated(r) and any(word in SHOWN for word in r) for r in commits.values())
    assert is_flaky(rounds, commits) == (turns > 1 or mixed)


def test_each_change_by_its_example() -> None:
    bad, good, none = ["violated"], ["satisfied"], ["no data"]
    assert change([good, bad]) is VerdictChange.NEW
    assert change([bad, none, bad]) is VerdictChange.STILL
    assert change([bad, none, good]) is VerdictChange.FIXED
    assert change([bad, none]) is VerdictChange.LOST
    assert change([bad, ["satisfied", "no data"]]) is VerdictChange.LOST
    assert change([bad, ["satisfied", "vacuous"]]) is VerdictChange.FIXED
    assert change([none, bad]) is VerdictChange.NEW
    assert change([bad, []]) is VerdictChange.GONE
    assert change([[], bad]) is VerdictChange.FIRST_VIOLATED
    assert change([["vacuous"], ["vacuous"]]) is VerdictChange.NEVER_SHOWN
