"""What every generated monitor carries with it: windows, verdicts, and the reading of tables."""

import json
from collections.abc import Callable, Mapping
from itertools import pairwise, product
from typing import ClassVar

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from monitors.kernel import (
    History,
    InputError,
    Outcome,
    Truth,
    Verdict,
    Window,
    rails,
    read_rows,
    run,
    truth,
)

# Windows --------------------------------------------------------------------------------------


def since(left: list[bool], right: list[bool], lo: int, hi: int, at: int) -> bool:
    """`left S[lo,hi] right`, from its definition."""
    return any(right[j] and all(left[j + 1 : at + 1]) for j in range(at + 1) if lo <= at - j <= hi)


@given(st.integers(0, 4), st.integers(0, 4), st.lists(st.tuples(st.booleans(), st.booleans())))
@example(0, 2, [(True, True), (True, False), (True, False), (True, False)])
@example(2, 1, [(True, True), (False, False), (True, False), (True, False)])
@example(1, 0, [(False, True), (False, True), (True, False)])
def test_a_window_is_the_bounded_since_of_its_definition(
    lo: int, more: int, rows: list[tuple[bool, bool]]
) -> None:
    left, right = [row[0] for row in rows], [row[1] for row in rows]
    window = Window(lo, lo + more)
    stepped = [window.step(*row) for row in rows]
    assert stepped == [since(left, right, lo, lo + more, at) for at in range(len(rows))]


@pytest.mark.parametrize("lo", range(4))
@pytest.mark.parametrize("more", range(3))
def test_a_window_is_its_definition_on_every_short_trace(lo: int, more: int) -> None:
    for rows in product(product((False, True), repeat=2), repeat=5):
        left, right = [row[0] for row in rows], [row[1] for row in rows]
        window = Window(lo, lo + more)
        stepped = [window.step(*row) for row in rows]
        assert stepped == [since(left, right, lo, lo + more, at) for at in range(5)], rows


@pytest.mark.parametrize("hi", [3, 10**6])
def test_a_window_remembers_runs_and_not_ticks(hi: int) -> None:
    window = Window(hi, hi)
    for _ in range(10_000):
        window.step(left=True, right=True)
    assert len(window.runs) == 1


# Truth ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("value", [True, False, None])
def test_a_truth_value_runs_on_two_rails_and_back(value: Truth) -> None:
    must, may = rails(value)
    assert truth(must, may) is value
    assert not must or may


@pytest.mark.parametrize("value", [0, 1, "true", "", 1.0, float("nan")])
def test_nothing_else_is_a_truth_value(value: object) -> None:
    with pytest.raises(TypeError, match="a truth value is True, False or None"):
        rails(value)  # type: ignore[arg-type]


# Verdicts -------------------------------------------------------------------------------------

NO, YES, UNKNOWN = (False, False), (True, True), (False, True)
Rails = tuple[bool, bool]


def noted(
    trigger: Rails = NO, breach: Rails = NO, owed: Rails = NO, fails: Rails = NO
) -> tuple[str, Truth]:
    verdict = History().note(trigger, breach, owed, fails, NO)
    return verdict.verdict, verdict.finite


def test_a_verdict_is_as_definite_as_its_signals() -> None:
    assert noted() == ("vacuous", True)
    assert noted(trigger=YES) == ("satisfied", True)
    assert noted(trigger=UNKNOWN) == ("no data", True)
    assert noted(trigger=YES, owed=YES, fails=YES) == ("inconclusive", False)
    assert noted(trigger=YES, owed=YES) == ("inconclusive", True)
    assert noted(trigger=YES, owed=UNKNOWN, fails=UNKNOWN) == ("no data", None)
    assert noted(trigger=YES, breach=YES, owed=YES, fails=YES) == ("violated", False)
    assert noted(trigger=YES, breach=UNKNOWN) == ("no data", None)
    assert noted(trigger=YES, breach=UNKNOWN, fails=YES) == ("no data", False)


def test_a_breach_is_never_forgotten() -> None:
    history = History()
    first = history.note(YES, YES, NO, NO, NO)
    second = history.note(NO, NO, NO, NO, YES)
    assert [first.verdict, second.verdict] == ["violated", "violated"]
    assert [first.tick, second.tick] == [0, 1]
    assert [first.breach, second.breach] == [True, False]


# A whole trace --------------------------------------------------------------------------------


class Scripted:
    """A monitor that is told its verdicts."""

    REQUIREMENT: ClassVar[str] = "R9"
    SENTENCE: ClassVar[str] = "a script"
    HORIZON: ClassVar[int | None] = 3
    PROPOSITIONS: ClassVar[Mapping[str, str]] = {"a.b": "a_DOT_b"}

    def __init__(self, *signals: tuple[Truth, Truth, Truth, Truth]) -> None:
        self.signals = signals
        self.seen: list[Truth] = []

    def reset(self) -> None:
        self.seen = []

    @property
    def step(self) -> Callable[..., Verdict]:
        return self._step

    def _step(self, *, a_DOT_b: Truth) -> Verdict:  # noqa: N803
        tick = len(self.seen)
        self.seen.append(a_DOT_b)
        trigger, breach, owed, answer = self.signals[tick]
        verdict = "inconclusive" if owed else "satisfied"
        return Verdict(tick, verdict, True, trigger, breach, owed, answer)


def outcome(*signals: tuple[Truth, Truth, Truth, Truth], end: str = "inconclusive") -> Outcome:
    return run(Scripted(*signals), [{"a.b": True}] * len(signals), end)


def test_a_run_gives_each_answer_with_its_trigger() -> None:
    found = outcome(
        (True, False, True, False),
        (True, False, True, False),
        (False, False, False, True),
        (True, False, True, False),
    )
    assert found.triggers == (0, 1, 3)
    assert found.answers == ((0, 2), (1, 2))
    assert found.open == ((3, 6),)
    assert found.verdict == "inconclusive"


def test_a_run_gives_stretches_of_breaches_and_of_unknown_ticks() -> None:
    found = outcome(
        (False, True, False, False),
        (False, True, False, False),
        (False, None, False, False),
        (False, False, False, False),
        (False, True, False, False),
    )
    assert found.violations == ((0, 1), (4, 4))
    assert found.first_violation == 0
    assert found.unknown == ((2, 2),)


def test_what_is_open_at_the_end_may_count_as_violated() -> None:
    found = outcome((True, False, True, False), (False, False, True, False), end="violated")
    assert (found.verdict, found.violations, found.first_violation) == ("violated", ((1, 1),), 1)


def test_nothing_is_known_of_an_empty_trace() -> None:
    found = outcome()
    assert (found.verdict, found.finite, found.ticks) == ("no data", None, 0)


def test_a_run_begins_at_tick_0_again() -> None:
    monitor = Scripted((True, False, False, False))
    assert run(monitor, [{"a.b": None}]) == run(monitor, [{"a.b": None}])
    assert monitor.seen == [None]


def test_an_outcome_as_json_holds_plain_values() -> None:
    found = outcome((True, True, True, False)).as_json()
    assert json.loads(json.dumps(found)) == {
        "requirement": "R9",
        "ticks": 1,
        "verdict": "inconclusive",
        "finite": True,
        "first_violation": 0,
        "violations": [[0, 0]],
        "unknown": [],
        "triggers": [0],
        "answers": [],
        "open": [{"trigger": 0, "deadline": 3}],
    }


# Tables ---------------------------------------------------------------------------------------


def rows(text: str, *names: str) -> list[dict[str, Truth]]:
    return list(read_rows(text.splitlines(keepends=True), names, "t.csv"))


PQ: list[dict[str, Truth]] = [{"p": True, "q": False}, {"p": None, "q": True}]


@pytest.mark.parametrize(
    "text",
    [
        "p,q\n1,0\n,1\n",
        "p,q\ntrue,FALSE\n,True",
        "q,p\r\n0,1\r\n1,\r\n",
        "\ufeffp,q\n1,0\n,1\n",
        "tick,p,q\n0,1,0\n1,,1\n",
        "tick,p,q\n7,1,0\n8,,1\n",
        " p , q \n 1 , 0 \n , 1 \n",
        '"p","q"\n"1","0"\n"","1"\n',
        "p,other,q\n1,x,0\n,,1\n",
        '{"p": true, "q": 0}\n{"p": null, "q": "1"}\n',
        '{"p": 1, "q": false, "tick": 3}\n\n{"p": "", "q": true, "tick": 4}\n',
        '\ufeff{"p": 1, "q": 0}\n{"p": null, "q": 1}\n',
    ],
)
def test_a_table_is_read_row_by_row(text: str) -> None:
    assert rows(text, "p", "q") == PQ


def test_a_proposition_may_be_named_tick() -> None:
    assert rows("tick\n1\n0\n", "tick") == [{"tick": True}, {"tick": False}]


def test_an_empty_value_is_unknown_in_a_table_of_one_column_too() -> None:
    assert rows("q\n1\n\n0\n", "q") == [{"q": True}, {"q": None}, {"q": False}]


def test_a_name_with_a_comma_is_one_column() -> None:
    assert rows('"f(x,y)",q\n1,0\n', "f(x,y)", "q") == [{"f(x,y)": True, "q": False}]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "t.csv: the trace is empty"),
        ("\n \n", "t.csv: the trace is empty"),
        ("p\n1\n", "t.csv:1: there is no column `q`; there are p"),
        ("p,q,q\n1,0,0\n", "t.csv:1: there are two columns `q`"),
        (
            "p,q\n1,2\n",
            "t.csv:2: column `q`: `2` is no truth value; write 0, 1, true, false, or nothing for "
            "unknown",
        ),
        (
            "p,q\n1,0\nnan,0\n",
            "t.csv:3: column `p`: `nan` is no truth value; write 0, 1, true, false, or nothing "
            "for unknown",
        ),
        ("p,q\n1\n", "t.csv:2: 1 values for 2 columns"),
        ("tick,p,q\n0,1,0\n0,1,0\n", "t.csv:3: column `tick` goes back: 0, then 0"),
        ("tick,p,q\n5,1,0\n4,1,0\n", "t.csv:3: column `tick` goes back: 5, then 4"),
        ("tick,p,q\n0,1,0\n2,1,0\n", "t.csv:3: column `tick` leaves ticks out: 0, then 2"),
        ("tick,p,q\n0.5,1,0\n", "t.csv:2: column `tick`: `0.5` is no whole number"),
        ("tick,p,q\n,1,0\n", "t.csv:2: column `tick`: `` is no whole number"),
        ('p,q\n"1,0\n', "t.csv:2: unexpected end of data"),
        ('{"p": 1}\n', "t.csv:1: there is no column `q`; there are p"),
        ('{"p": 1, "q": 1}\n[1, 1]\n', "t.csv:2: a line must hold one object"),
        (
            '{"p": 1, "q": NaN}\n',
            "t.csv:1: column `q`: `nan` is no truth value; write 0, 1, true, false, or nothing "
            "for unknown",
        ),
        (
            '{"p": 1, "q": [1]}\n',
            "t.csv:1: column `q`: `[1]` is no truth value; write 0, 1, true, false, or nothing "
            "for unknown",
        ),
        (
            '{"p": 1, "q": 1, "tick": 2}\n{"p": 1, "q": 1, "tick": 1}\n',
            "t.csv:2: column `tick` goes back: 2, then 1",
        ),
    ],
)
def test_a_table_that_cannot_be_read_says_why(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        rows(text, "p", "q")
    assert str(caught.value) == message


def test_a_tick_column_that_begins_to_fail_is_told_in_json_too() -> None:
    """A row without its tick may hide a gap."""
    with pytest.raises(InputError):
        rows('{"p": 1, "tick": 0}\n{"p": 1}\n{"p": 1, "tick": 5}\n', "p")


@pytest.mark.parametrize(
    "text",
    [
        '{"p": 1, "q": tru}\n',
        '{"p": 1, "q": 1\n',
        '{"p": 1, "q": 1, "p": 0}\n',
        '{"p": ' + "[" * 100_000 + "\n",
        '{"p": 1' + "0" * 5000 + ', "q": 1}\n',
        "p,q\n\x00,1\n",
        "p,q\n" + "1" * 200_000 + ",1\n",
        "tick,p,q\n" + "1" * 5000 + ",1,1\n",
        '{"p": true, "q": true, "tick": true}\n',
    ],
)
def test_a_hostile_table_is_an_input_error(text: str) -> None:
    with pytest.raises(InputError):
        rows(text, "p", "q")


@given(st.text(max_size=40))
def test_any_text_gives_rows_or_an_input_error(text: str) -> None:
    for table in (text, f"p,q\n{text}", f'{{"p": 1, "q": {text}}}'):
        try:
            found = rows(table, "p", "q")
        except InputError as error:
            told = str(error)
        else:
            told = "" if all(row.keys() == {"p", "q"} for row in found) else "\n"
        assert "\n" not in told


@given(st.lists(st.integers(-2, 3), min_size=1, max_size=6))
def test_ticks_grow_by_one_or_the_table_is_refused(ticks: list[int]) -> None:
    table = "tick,p\n" + "".join(f"{tick},1\n" for tick in ticks)
    if all(later == earlier + 1 for earlier, later in pairwise(ticks)):
        assert len(rows(table, "p")) == len(ticks)
    else:
        with pytest.raises(InputError):
            rows(table, "p")
