"""The tests that are made of a requirement, compared with words that are listed one by one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import count, product

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.definition import holds
from compiler.logic.evaluation import evaluate
from compiler.situations.mutants import mutants
from compiler.situations.situations import Situation, situations
from fretc.testing.generation import Batch, batch
from fretc.testing.suite import GoalResult, GoalStatus, MutantStatus, Polarity, Test
from fretc.testing.words import RunColumns, defined, judged, letters
from tests.each import each
from tests.effort import FULL, some
from tests.requirement_sets import requirements

SENTENCES = (
    "upon a the sw shall within 2 ticks satisfy x",
    "whenever a the sw shall for 1 tick satisfy x",
    "in b mode whenever a the sw shall within 1 tick satisfy x",
    "after b mode the sw shall eventually satisfy x",
    "before b mode the sw shall finally satisfy x",
    "only in b mode the sw shall always satisfy x",
    "upon a the sw shall after 1 tick satisfy x",
    "whenever a the sw shall until b satisfy x",
    "upon a the sw shall before b satisfy x",
    "whenever a the sw shall at the next timepoint satisfy x",
    "whenever a | b the sw shall immediately satisfy x & !a",
    "the sw shall never satisfy a & x",
)
MOST = 1 << (12 if FULL else 8)
"""Words that are listed of each length."""


@cache
def made(*sentences: str) -> Batch:
    """The tests of the first sentence, which keep the others."""
    first, *others = requirements(*sentences)
    return batch(first, others, 60)


def word_of(test: Test) -> RunColumns:
    """A test as columns, from the rows that are written."""
    columns: dict[str, int] = dict.fromkeys(test.rows[0].values, 0)
    tick = 0
    for row in test.rows:
        for name, value in row.values.items():
            columns[name] |= (((1 << row.count) - 1) if value else 0) << tick
        tick += row.count
    return RunColumns(test.rows, columns, tick)


def words(atoms: Sequence[str]) -> Iterator[RunColumns]:
    """All words up to some length, the short ones first."""
    for ticks in count(1):
        if 1 << ticks * len(atoms) > MOST:
            return
        for columns in product(range(1 << ticks), repeat=len(atoms)):
            yield RunColumns((), dict(zip(atoms, columns, strict=True)), ticks)


def comes_by(word: RunColumns, situation: Situation, last: int) -> bool:
    """Whether a word shows a situation at one of the ticks 0..last."""
    column = evaluate(situation.formula, word.columns, word.ticks)
    if situation.at_end:
        return bool(column >> (word.ticks - 1))
    return bool(column & ((2 << last) - 1))


def manner(
    requirement: FormalizedRequirement,
    situation: Situation,
    word: RunColumns,
    ending: tuple[int | None, bool],
) -> int | None:
    """How well a word shows a situation, 0 best; None: it does not show it.

    Args:
        requirement: the requirement.
        situation: one of it.
        word: it.
        ending: where the word breaks the requirement, and whether it is accepted.
    """
    broken, accepted = ending
    last = word.ticks - 1
    if not comes_by(word, situation, last):
        return None
    if accepted:
        return evaluate(requirement.watch.obligation_pending, word.columns, word.ticks) >> last & 1
    if broken is None:
        return 2
    return 0 if broken == last and comes_by(word, situation, broken) else 1


Need = tuple[str, Polarity]


def listed(requirement: FormalizedRequirement) -> tuple[Mapping[Need, Mapping[int, int]], int]:
    """Of each situation and polarity the length of a shortest word of each manner."""
    found: dict[Need, dict[int, int]] = {}
    known = [each for each in situations(requirement) if each.unknown is None]
    ticks = 0
    for word in words(requirement.watched):
        ticks = word.ticks
        ending = defined(requirement, letters(requirement, word))
        polarity = Polarity.KEPT if ending[1] else Polarity.BROKEN
        for situation in known:
            how = manner(requirement, situation, word, ending)
            if how is not None:
                found.setdefault((situation.key, polarity), {}).setdefault(how, ticks)
    return found, ticks


@pytest.mark.slow
@each("sentence", some(SENTENCES, 3))
def test_no_shorter_word_shows_the_same(sentence: str) -> None:
    """What is impossible has no word among those that are listed, what is met no shorter one."""
    (requirement,) = requirements(sentence)
    found = made(sentence)
    tests = {test.name: test for test in found.tests}
    shortest, most = listed(requirement)
    by_key = {each.key: each for each in situations(requirement)}
    for obligation in found.obligations:
        need = obligation.situation, obligation.polarity
        if obligation.polarity is Polarity.UNKNOWN:
            assert obligation.outcome is GoalStatus.MET
            continue
        if obligation.outcome is GoalStatus.IMPOSSIBLE:
            assert need not in shortest
            continue
        assert obligation.outcome is GoalStatus.MET
        shown = [word_of(tests[name]) for name in obligation.tests]
        manners = [
            (
                manner(
                    requirement,
                    by_key[need[0]],
                    word,
                    defined(requirement, letters(requirement, word)),
                ),
                word.ticks,
            )
            for word in shown
        ]
        best, length = min((how, ticks) for how, ticks in manners if how is not None)
        known = shortest.get(need, {})
        assert all(how >= best for how in known)
        assert known.get(best, length) == length
        assert best in known or length > most


@pytest.mark.slow
@each("sentence", SENTENCES)
def test_verdicts_are_those_of_the_formula(sentence: str) -> None:
    """The formula of finite traces, evaluated as it is defined, shares nothing with the search."""
    (requirement,) = requirements(sentence)
    for test in made(sentence).tests:
        if test.polarity is Polarity.UNKNOWN:
            assert test.finite is None
            continue
        trace = [
            {name: bool(value) for name, value in row.values.items()}
            for row in test.rows
            for _ in range(row.count)
        ]
        assert holds(requirement.ft_finite, trace) is test.finite


@pytest.mark.slow
@each("sentence", SENTENCES)
def test_a_mutant_is_killed_or_judges_all_words_alike(sentence: str) -> None:
    (requirement,) = requirements(sentence)
    found = made(sentence)
    tests = {test.name: word_of(test) for test in found.tests}
    wrong = {each.key: each.requirement for each in mutants(requirement)}
    for mutant in found.mutants:
        other = wrong[mutant.key]
        atoms = tuple(dict.fromkeys([*requirement.watched, *other.watched]))
        if mutant.outcome is MutantStatus.KILLED:
            assert any(
                defined(requirement, letters(requirement, tests[name]))
                != defined(other, letters(other, tests[name]))
                for name in mutant.tests
            )
        else:
            assert mutant.outcome is MutantStatus.EQUIVALENT
            for word in words(atoms):
                own, theirs = letters(requirement, word), letters(other, word)
                assert defined(requirement, own)[1] is defined(other, theirs)[1]


@pytest.mark.slow
@each("sentence", SENTENCES)
def test_what_is_unknown_decides_and_no_shorter_run_depends_on_it(sentence: str) -> None:
    """Both values are tried at the tick; shorter words are listed, with each tick in turn."""
    (requirement,) = requirements(sentence)
    found = made(sentence)
    tests = {test.name: test for test in found.tests}
    by_key = {each.key: each for each in situations(requirement)}
    for obligation in found.obligations:
        situation = by_key[obligation.situation]
        if situation.unknown is None:
            continue
        (name,) = obligation.tests
        least = next(
            (
                word.ticks
                for word in words(requirement.watched)
                if depends(requirement, situation, word)
            ),
            None,
        )
        assert least is None or least == tests[name].ticks
        assert tests[name].finite is None
        assert sum(row.values[situation.unknown] is None for row in tests[name].rows) == 1


def depends(requirement: FormalizedRequirement, situation: Situation, word: RunColumns) -> bool:
    """Whether the verdict of a word depends on an atom at a tick of the situation."""
    atom = situation.unknown
    assert atom is not None
    column = evaluate(situation.formula, word.columns, word.ticks)
    for tick in range(word.ticks):
        other = {**word.columns, atom: word.columns[atom] ^ 1 << tick}
        opposite = RunColumns(word.rows, other, word.ticks)
        if column >> tick & 1 and verdict(requirement, word) is not verdict(requirement, opposite):
            return True
    return False


def verdict(requirement: FormalizedRequirement, word: RunColumns) -> bool:
    return defined(requirement, letters(requirement, word))[1]


def test_a_threshold_is_met_by_its_number() -> None:
    found = made("whenever x < 1.5 the sw shall immediately satisfy y")
    tests = {test.name: test for test in found.tests}
    numbers = {
        (obligation.situation.partition(":")[0], tests[name].rows[-1].values["x"])
        for obligation in found.obligations
        for name in obligation.tests
        if obligation.situation.startswith("threshold") and tests[name].ticks == 1
    }
    assert numbers == {("threshold-below", 1.4), ("threshold-at", 1.5), ("threshold-above", 1.6)}


def outcomes(found: Batch) -> dict[Need, GoalResult]:
    return {(each.situation, each.polarity): each for each in found.obligations}


def test_the_other_requirements_are_kept() -> None:
    sentences = (
        "upon a the sw shall within 2 ticks satisfy x",
        "whenever b the sw shall immediately satisfy !x",
        "the sw shall always satisfy a | b",
    )
    found = made(*sentences)
    for test in found.tests:
        word = word_of(test)
        assert all(not judged(other, word).violation for other in requirements(*sentences)[1:])


@pytest.mark.slow
def test_what_others_exclude_is_excluded_by_the_fewest() -> None:
    found = outcomes(
        made(
            "upon a the sw shall within 2 ticks satisfy x",
            "the sw shall always satisfy b",
            "whenever b the sw shall immediately satisfy !x",
            "the sw shall never satisfy b & y",
        )
    )
    answered = found["answered-at-once", Polarity.KEPT]
    assert answered.outcome is GoalStatus.EXCLUDED
    assert answered.by == ("R2", "R3")
    assert found["missed-by-one", Polarity.BROKEN].outcome is GoalStatus.MET


def test_a_mutant_that_others_hide_is_excluded() -> None:
    found = made("whenever a the sw shall immediately satisfy x", "the sw shall always satisfy x")
    fates = {each.key: each for each in found.mutants}
    assert fates["negated:condition"].outcome is MutantStatus.EXCLUDED
    assert fates["negated:condition"].by == ("R2",)


@pytest.mark.slow
def test_a_long_bound_is_stored_by_stretches() -> None:
    found = made("upon a the sw shall within 40 ticks satisfy x")
    (name, *_) = outcomes(found)["answered-at-last-tick", Polarity.KEPT].tests
    test = next(test for test in found.tests if test.name == name)
    assert test.ticks == 41
    assert len(test.rows) == 3


def test_what_has_no_counter_is_not_searched() -> None:
    found = made("whenever a the sw shall with probability > 0.9 within 2 ticks satisfy x")
    assert found.tests == ()
    assert {each.outcome for each in found.obligations} == {GoalStatus.NOT_SEARCHED}
    assert {each.why for each in found.obligations} == {"it states a probability"}


def test_time_that_is_over_is_said() -> None:
    first, *_ = requirements("upon a the sw shall within 2 ticks satisfy x")
    found = batch(first, [], 1e-9)
    assert found.tests == ()
    assert all("not answered within" in each.why for each in found.obligations)
