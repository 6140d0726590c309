# ruff: noqa: E501
"""Faults that were put into a monitor's text by hand: what becomes of each is written beside it.

They are of the kinds that a proof about verdicts of known values does not see: what is reported
triggers, answers and open demands, the handling of unknown values, columns, names.
"""

import re
from functools import cache

import pytest

from compiler.logic.claims import ClaimResult
from compiler.targets.python import monitor as target
from monitors.loading import load
from tests.compiler.formalization.test_mutants import DIFFERS, MARK, REFUSED, REFUTED, SAME, Judge
from tests.each import each
from tests.effort import some
from tests.monitoring import requirement, with_step, without_step
from tests.proofs import verified

WITHIN = "in m mode whenever p the sw shall within 3 ticks satisfy q"
FOR = "upon p the sw shall for 2 ticks satisfy q & !m"
BEFORE = "before m mode the sw shall always satisfy q"
LONG = 2**4000 - 1
"""A constant that changes nothing on any trace that is drawn."""

SIGNALS = "self.r1_signals = (m and p, since_1, False, since_2, False, False, m and q)"
RENEWED = "r1_open = r1_last if since_2 else -1"
"""Of `FOR`, after its signals."""
P = "            if p is not True and p is not False:\n"

FAULTS = (
    # Names.
    (WITHIN, '"p": "p"', '"p": "q"', REFUSED),
    (WITHIN, '"p": "p",\n        "q": "q",', '"p": "q",\n        "q": "p",', REFUSED),
    (WITHIN, '"p": "p",\n        "q": "q",', '"q": "q",\n        "p": "p",', REFUSED),
    (WITHIN, '("not_q", "q", False)', '("not_q", "q", True)', REFUSED),
    (WITHIN, '("not_q", "q", False)', '("not_q", "p", False)', REFUSED),
    (WITHIN, '("p", "p", True)', '("p", "m", True)', REFUSED),
    (WITHIN, '("p", "p", True)', '("p", "p", 1)', REFUSED),
    (WITHIN, "for (m, p, q) in rows", "for (m, q, p) in rows", REFUSED),
    (WITHIN, "self._step((m, p, q))", "self._step((m, q, p))", REFUSED),
    (WITHIN, "self, *, m: Truth, p: Truth", "self, *, p: Truth, m: Truth", REFUSED),
    # Triggers, and the mark of the last one.
    (WITHIN, "self.r1_signals = (m and p,", "self.r1_signals = (p,", DIFFERS),
    (WITHIN, "self.r1_signals = (m and p,", "self.r1_signals = (m and p and not_q,", DIFFERS),
    (WITHIN, "self.r1_signals = (m and p,", "self.r1_signals = (False,", DIFFERS),
    (WITHIN, "self.r1_signals = (m and p,", "self.r1_signals = (", REFUSED),
    (WITHIN, f"        {SIGNALS}\n", "", REFUSED),
    (WITHIN, f"        {SIGNALS}\n", f"        {SIGNALS}\n        {SIGNALS}\n", REFUSED),
    (WITHIN, "            if m and p:\n                r1_last", "            if p:\n                r1_last", DIFFERS),
    (WITHIN, "            if m and p:\n                r1_last = tick\n", "", DIFFERS),
    (WITHIN, "            if m and p:\n                r1_last = tick\n", "            r1_last = tick\n", DIFFERS),
    (WITHIN, "        self.r1_last = r1_last\n", "", REFUSED),
    # Open demands, and their mark.
    (WITHIN, "False, since_2, False,", "False, since_1, False,", DIFFERS),
    (WITHIN, "False, since_2, False,", "False, False, False,", DIFFERS),
    (WITHIN, "if not since_2:", "if not since_1:", DIFFERS),
    (WITHIN, "if not since_2:\n                r1_open = -1\n            elif r1_open < 0:\n                r1_open = tick", "r1_broken", REFUSED),
    (WITHIN, "            if not since_2:\n                r1_open = -1\n            elif r1_open < 0:\n                r1_open = tick\n", "", DIFFERS),
    (WITHIN, f"        {SIGNALS}\n", f"        {SIGNALS}\n        {RENEWED}\n", DIFFERS),
    (FOR, f"        {RENEWED}\n", "", DIFFERS),
    (FOR, f"        {RENEWED}\n", f"        {RENEWED.replace('since_2', 'since_1')}\n", REFUSED),
    (FOR, "        self.youngest_1 = youngest_1\n", f"        self.youngest_1 = youngest_1\n        {RENEWED}\n", REFUSED),
    (FOR, f"        {RENEWED}\n        self.r1_broken = r1_broken\n        self.r1_last = r1_last\n        self.r1_open = r1_open\n", f"        self.r1_open = r1_open\n        {RENEWED}\n        self.r1_broken = r1_broken\n        self.r1_last = r1_last\n", REFUSED),
    (FOR, "False, since_2, False, False, False)\n        r1_open = r1_last if since_2", "False, since_1, False, False, False)\n        r1_open = r1_last if since_1", DIFFERS),
    # Answers.
    (WITHIN, "False, m and q)", "False, q)", DIFFERS),
    (WITHIN, "False, m and q)", "False, m)", DIFFERS),
    (WITHIN, "False, m and q)", "False, False)", DIFFERS),
    # What is satisfied_forever, violation_inevitable, failed, broken.
    (WITHIN, "since_2, False, False, m and q)", "since_2, False, q, m and q)", REFUSED),
    (WITHIN, "since_1, False, since_2", "since_1, since_2, since_2", DIFFERS),
    (WITHIN, "since_2, False, False, m and q)", "since_2, since_2, False, m and q)", REFUTED),
    (WITHIN, "(m and p, since_1,", "(m and p, since_2,", DIFFERS),
    (WITHIN, "r1_broken < 0 and since_1", "r1_broken < 0 and since_2", REFUTED),
    (BEFORE, "False, False, False, since_2, False)", "False, False, False, since_2 and first, False)", REFUTED),
    (BEFORE, "False, False, False, since_2, False)", "False, False, False, False, False)", REFUSED),
    (BEFORE, "certain.r1_signals[5]", "certain.r1_signals[4]", REFUSED),
    (BEFORE, "approximation.r1_signals[5]", "approximation.r1_signals[4]", REFUSED),
    (BEFORE, " and not (possible.r1_broken >= 0)", "", REFUSED),
    # Unknown values.
    (WITHIN, "q = not_q = is_possible", "q = not_q = False", REFUSED),
    (WITHIN, "q = not_q = is_possible", "q = not_q = True", REFUSED),
    (WITHIN, "q = not_q = is_possible", "not_q = is_possible", REFUSED),
    (WITHIN, "q = not_q = is_possible", "q = is_possible", REFUSED),
    (WITHIN, "known = False\n                    m = is_possible", "m = is_possible", REFUSED),
    (WITHIN, "known = False\n                    m = is_possible", "m = is_possible\n                    known = True", REFUSED),
    (WITHIN, "        is_possible = self.is_possible\n", "        is_possible = False\n", REFUSED),
    (WITHIN, "        self.is_possible = is_possible\n", "        self.is_possible = False\n", REFUSED),
    (WITHIN, "is_possible: bool = False", "is_possible: bool = True", REFUSED),
    (WITHIN, "            not_q = not q\n", "", REFUSED),
    (WITHIN, "            not_q = not q\n", "            not_q = not p\n", REFUSED),
    (WITHIN, 'm = boolean(m, "m")', "pass", REFUSED),
    (WITHIN, P, "            if p is not True:\n", REFUSED),
    (WITHIN, P, "            if p is not False:\n", REFUSED),
    (WITHIN, "oldest_1 >= 0 and not_q and m", "oldest_1 >= 0 and not q and m", DIFFERS),
    (WITHIN, "elif m and p and not_q:", "elif m and p and (not q):", DIFFERS),
    (WITHIN, "elif m and p and not_q:", "elif not (not m or not p) and not_q:", SAME),
    (FOR, "(since_1 and (not_q or m)):", "(since_1 and (not q or m)):", DIFFERS),
    (FOR, "self.r1_signals = (p and before_1, since_1 and (not_q or m),", "self.r1_signals = (p and before_1, since_1 and (not q or m),", DIFFERS),
    (FOR, "before_1, kept_before_1 = kept_before_1, not_p", "before_1, kept_before_1 = kept_before_1, not p", DIFFERS),
    (WITHIN, "            or (m is not True and m is not False)\n", "", REFUSED),
    (WITHIN, "            approximation is not self.possible\n            or", "           ", REFUSED),
    (WITHIN, "            self._step((m, p, q))\n", "", REFUSED),
    (WITHIN, "        return known\n", "        return True\n", REFUSED),
    # Steps.
    (WITHIN, "since_1 = oldest_1 >= 3", "since_1 = oldest_1 >= 2", REFUTED),
    (WITHIN, "since_1 = oldest_1 >= 3", "since_1 = oldest_1 > 2", SAME),
    (WITHIN, "oldest_1 + 1 if oldest_1 < 3 else 3", "oldest_1 + 1 if oldest_1 < 5 else 5", SAME),
    (WITHIN, "self.oldest_1 = -1", "self.oldest_1 = 0", REFUTED),
    (WITHIN, "self.r1_open = -1", "self.r1_open = 0", REFUSED),
    (WITHIN, "(False,) * 7", "(True,) * 7", REFUSED),
    (WITHIN, "(False,) * 7", "(False,) * 6", REFUSED),
    (WITHIN, "Signals(*self.r1_signals)", "Signals(*self.r1_signals[:-1], False)", REFUSED),
    (WITHIN, "self.r1_last, self.r1_open", "self.r1_open, self.r1_last", REFUSED),
    # Columns.
    (WITHIN, "trigger=m & p,", f"trigger=m & p & {LONG},", REFUSED),
    (WITHIN, "violation=since_1,", f"violation=since_1 & {LONG},", REFUSED),
    (WITHIN, "obligation_pending=since_2,", f"obligation_pending=since_2 & {LONG},", REFUSED),
    (WITHIN, "answer=m & q,", f"answer=m & q & {LONG},", REFUSED),
    (WITHIN, "since_2 = held_1", f"since_2 = held_1 & {LONG}", REFUSED),
    (WITHIN, "held_1 = since(not_q & m,", f"held_1 = since(not_q & m & {LONG},", REFUSED),
    (FOR, "0, 2, every)", f"0, 2, {LONG})", REFUSED),
    (WITHIN, "trigger=m & p,", "trigger=m & p & 1152921504606846975,", DIFFERS),
    (WITHIN, "trigger=m & p,", "trigger=p & m,", REFUSED),
    (WITHIN, "trigger=m & p,", "trigger=m,", DIFFERS),
    (WITHIN, "answer=m & q,", "answer=m | q,", DIFFERS),
    (WITHIN, "satisfied_forever=0,", "satisfied_forever=1,", DIFFERS),
    (WITHIN, "violation_inevitable=0,", "violation_inevitable=None,", DIFFERS),
    (WITHIN, "                violation_inevitable=0,\n", "", DIFFERS),
    (WITHIN, "not_q & m, m & p & not_q, 3, every", "not_q & m, m & p & not_q, 4, every", DIFFERS),
    (WITHIN, "p: int, not_q: int", "not_q: int, p: int", REFUSED),
    (WITHIN, "        since_2 = held_1\n", "        since_2 = held_1\n        every = 0\n", REFUSED),
    (WITHIN, "        since_2 = held_1\n", "        since_2 = held_1\n        once = 0\n", REFUSED),
    (WITHIN, "        since_2 = held_1\n", "        since_2 = held_1\n        m = p\n", REFUSED),
    (WITHIN, "        since_2 = held_1\n", "        other = held_1\n        since_2 = other\n", SAME),
    # What it says it is of.
    (WITHIN, 'whenever p the sw shall within 3 ticks satisfy q",', 'the sw shall never satisfy q",', REFUSED),
    (WITHIN, '",\n            3,\n', '",\n            4,\n', REFUSED),
    (WITHIN, '            "R1",\n', '            "R2",\n', REFUSED),
)  # fmt: skip


@cache
def judge(sentence: str) -> tuple[str, Judge]:
    formalized = requirement(sentence)
    return target.text(formalized), Judge(formalized)


@pytest.mark.slow
@each("fault", some(FAULTS, 4))
def test_a_fault_comes_to_what_is_written_beside_it(fault: tuple[str, str, str, str]) -> None:
    """What is proved tells the same as the right one on drawn traces: `TOLD` is never right."""
    sentence, old, new, expected = fault
    text, examiner = judge(sentence)
    place = text.index(MARK)
    own = without_step(text)[place:]
    assert own.count(old) == 1, own.count(old)
    assert examiner.kind(with_step(text[:place] + own.replace(old, new))) == expected


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("            since_1 = oldest_1 >= 3\n", "            since_1 = oldest_1 > 2\n"),
        ("\n        since_1 = oldest_1 >= 3\n", "\n        since_1 = oldest_1 > 2\n"),
        ("\n        since_1 = oldest_1 >= 3\n", "\n        since_1 = oldest_1 >= 2\n"),
        ("        approximation.oldest_1 = oldest_1\n", ""),
        ("            approximation.r1_last = tick\n", "            approximation.r1_last = 0\n"),
        ("        approximation.r1_signals = (m and p,", "        approximation.r1_signals = (p,"),
    ],
)
def test_a_step_that_has_another_tick_in_it_than_its_approximation_is_refused(
    old: str, new: str
) -> None:
    """Even where it is an equal one: only one of both is explored."""
    text, examiner = judge(WITHIN)
    place = text.index(MARK)
    assert text[place:].count(old) == 1
    assert examiner.kind(text[:place] + text[place:].replace(old, new)) == REFUSED


@pytest.mark.slow
@each(
    "name",
    "row tick is_possible known certain possible rows refused Signals since other_name".split(),
)
def test_a_parameter_of_another_name_than_its_proposition_has_is_refused(name: str) -> None:
    """`row` hid unknown values: it is what a step calls the values of a tick."""
    formalized = requirement("in m mode whenever longname the sw shall within 3 ticks satisfy q")
    text = target.text(formalized)
    place = text.index(MARK)
    own = re.sub(r'(?<!")\blongname\b(?!"| the)', name, text[place:])
    own = own.replace('"longname": "longname"', f'"longname": "{name}"')
    own = own.replace('("longname", "longname", True)', f'("{name}", "longname", True)')
    assert load("renamed", text[:place] + own).PROPOSITIONS["longname"] == name
    assert verified(formalized, text[:place] + own).result is ClaimResult.NOT_CHECKED


@pytest.mark.slow
@each(
    "name",
    "known rows boolean tick is_possible self advance signals marks CELLS p not_q r1_last __hidden".split(),
)
def test_a_cell_has_no_name_that_something_else_has(name: str) -> None:
    """`known`, put back into the approximation, would say that nothing was unknown."""
    text, examiner = judge(WITHIN)
    place = text.index(MARK)
    assert examiner.kind(text[:place] + re.sub(r"\boldest_1\b", name, text[place:])) == REFUSED


def test_a_cell_may_have_a_name_of_its_own() -> None:
    text, examiner = judge(WITHIN)
    place = text.index(MARK)
    renamed = re.sub(r"\boldest_1\b", "count", text[place:])
    assert examiner.kind(text[:place] + renamed) == SAME
