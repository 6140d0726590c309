"""Temporal predicates: against FRET's own formulas, and against their meaning written directly."""

import json
import random
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from compiler.formalization.formalize import formalize
from compiler.logic import printing
from compiler.logic.definition import holds
from compiler.logic.spot import same_language
from compiler.targets.python import monitor as target
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from tests import fret_notation as fret
from tests import meaning, monitoring
from tests.each import each
from tests.effort import FULL, pairwise, some
from tests.monitoring import requirement
from tests.strategies import templates

TABLE = Path(__file__).parents[2] / "data/fret_templates.json"


# Against FRET's own formulas ------------------------------------------------------------------

ROWS: list[dict[str, Any]] = [
    row
    for row in json.loads(TABLE.read_text(encoding="utf-8"))
    if row["group"] == "temporal_predicate"
]


def with_a(formula: str) -> list[dict[str, Any]]:
    return [row for row in ROWS if row[formula] is not None]


def has_no_end(row: dict[str, Any]) -> bool:
    """Where FRET's right end of an interval forgets the end of the trace (anomaly A6)."""
    future = any(
        word in row["fretish"] for word in ("persists", "occurs", "nextOcc", "at the next")
    )
    scope = row["scope"] in ("before", "notin", "onlyIn", "onlyAfter")
    return future and (scope or row["fretish"].startswith("While"))


@cache
def every_trace(names: tuple[str, ...], length: int) -> tuple[fret.Word, int]:
    """All traces of a length at once: bit k of all columns is the k-th trace."""
    cells = len(names) * length
    full = (1 << (1 << cells)) - 1
    columns = [full // ((1 << (1 << i)) + 1) for i in range(cells)]
    return {n: columns[i * length : (i + 1) * length] for i, n in enumerate(names)}, full


def drawn_traces(names: Sequence[str], length: int) -> tuple[fret.Word, int]:
    choose = random.Random(f"{names} {length}")
    return {n: [choose.getrandbits(400) for _ in range(length)] for n in names}, (1 << 400) - 1


def words(names: Sequence[str]) -> Iterator[tuple[fret.Word, int, int]]:
    """All traces of up to 14 cells, then 400 of each length up to 10."""
    longest = (14 if FULL else 10) // len(names)
    for length in range(1, 11) if FULL else (1, 2, 3, 4, 6, 10):
        word, full = (every_trace if length <= longest else drawn_traces)(tuple(names), length)
        yield word, length, full


def test_all_traces_of_two_ticks_are_four() -> None:
    assert every_trace(("p",), 2) == ({"p": [0b0101, 0b0011]}, 0b1111)


@pytest.mark.slow
@each("row", with_a("ft_inf"))
def test_the_formula_of_infinite_traces_says_what_that_of_fret_says(row: dict[str, Any]) -> None:
    assert same_language(printing.future(requirement(row["fretish"]).ft_infinite), row["ft_inf"])


@pytest.mark.slow
@each("row", [row for row in with_a("ft_fin") if not has_no_end(row)])
def test_the_formula_of_finite_traces_says_what_that_of_fret_says(row: dict[str, Any]) -> None:
    ours = fret.parse(printing.future(requirement(row["fretish"]).ft_finite))
    theirs = fret.parse(row["ft_fin"])
    for word, length, full in words(row["variables"]):
        at_start = fret.values(ours, word, length, full)[0]
        assert at_start == fret.values(theirs, word, length, full)[0], length


@pytest.mark.slow
@each("row", with_a("pt"))
def test_the_past_time_formula_says_what_that_of_fret_says(row: dict[str, Any]) -> None:
    ours, theirs = fret.parse(printing.past(requirement(row["fretish"]).pt)), fret.parse(row["pt"])
    for word, length, full in words(row["variables"]):
        at_end = fret.values(ours, word, length, full)[-1]
        assert at_end == fret.values(theirs, word, length, full)[-1], length


def test_the_rows_without_a_finite_formula_of_use_are_known() -> None:
    def position(row: dict[str, Any]) -> str:
        return "while" if row["fretish"].startswith("While") else str(row["scope"])

    found = Counter(position(row) for row in ROWS if row["ft_inf"] and has_no_end(row))
    assert found == {"while": 9, "before": 13, "notin": 11, "onlyIn": 6, "onlyAfter": 9}


def beyond(formula: str, names: Sequence[str], length: int) -> set[int]:
    """What a formula says of all traces, as bits, for each of several endless continuations.

    The trace ends where `LAST` is true, and three ticks follow it for ever; on all traces the
    same three, drawn anew for each continuation.
    """
    word, full = every_trace(tuple(names), length)
    last = [0] * (length - 1) + [full] + [0] * 3
    choose = random.Random("what follows")
    said, node = set(), fret.parse(formula)
    for _ in range(40 if FULL else 12):
        after = {n: [choose.choice((0, full)) for _ in range(3)] for n in names}
        longer = {"LAST": last, **{n: [*word[n], *after[n]] for n in names}}
        said.add(fret.values(node, longer, length + 3, full, loop=length)[0])
    return said


HARMLESS = ("P.ft.persists(2,p).before.whenever", "P.ft.occurs(2,p).notin.whenever")
"""The end is forgotten in these too, but their answer has as long as their predicate."""


@pytest.mark.slow
@each("row", [row for row in with_a("ft_fin") if has_no_end(row)])
def test_a_finite_trace_is_judged_without_what_follows_it(row: dict[str, Any]) -> None:
    """FRET's formula of the same sentence does depend on it."""
    ours = printing.future(requirement(row["fretish"]).ft_finite)
    for length in (1, 2, 3):
        word, full = every_trace(tuple(row["variables"]), length)
        alone = fret.values(fret.parse(ours), word, length, full)[0]
        assert beyond(ours, row["variables"], length) == {alone}
    theirs = beyond(row["ft_fin"], row["variables"], 3)
    assert (len(theirs) == 1) == (row["id"] in HARMLESS)


# Against their meaning ------------------------------------------------------------------------

Trace = fret.Trace
Predicate = Callable[[Trace, int, int, int], bool]
"""Whether it holds, on a trace, at tick k of the interval left..right."""


def persisted(low: int, high: int) -> Predicate:
    return lambda x, k, left, right: (
        k - high >= left and all(x["p"][j] for j in range(k - high, k - low + 1))
    )


def occurred(low: int, high: int) -> Predicate:
    return lambda x, k, left, right: any(
        x["p"][j] for j in range(k - high, k - low + 1) if j >= left
    )


def previous_occurrence(x: Trace, k: int, left: int, right: int) -> bool:
    latest = [j for j in range(left, k) if x["p"][j]][-1:]
    return all(x["r"][j] for j in latest)


def previous_value(initial: Callable[[Trace], bool]) -> Predicate:
    return lambda x, k, left, right: x["p"][k - 1] if k > 0 else initial(x)


def first_tick(x: Trace, k: int, left: int, right: int) -> bool:
    return k == 0


def previous_other_than_first(x: Trace, k: int, left: int, right: int) -> bool:
    return [j for j in range(left, k) if x["p"][j]][-1:] != [0]


def persisted_after_occurred(x: Trace, k: int, left: int, right: int) -> bool:
    return k - 2 >= left and all(occurred(0, 3)(x, j, left, right) for j in range(k - 2, k + 1))


def persists(low: int, high: int) -> Predicate:
    return lambda x, k, left, right: (
        k + high <= right and all(x["p"][j] for j in range(k + low, k + high + 1))
    )


def occurs(low: int, high: int) -> Predicate:
    return lambda x, k, left, right: any(
        x["p"][j] for j in range(k + low, k + high + 1) if j <= right
    )


def next_occurrence(x: Trace, k: int, left: int, right: int) -> bool:
    nearest = [j for j in range(k + 1, right + 1) if x["p"][j]][:1]
    return all(x["r"][j] for j in nearest)


def persists_before_occurs(x: Trace, k: int, left: int, right: int) -> bool:
    return k + 1 <= right and all(occurs(0, 2)(x, j, left, right) for j in (k, k + 1))


BACK: dict[str, Predicate] = {
    "persisted(0,p)": persisted(0, 0),
    "persisted(2,p)": persisted(0, 2),
    "persisted(1,3,p)": persisted(1, 3),
    "persisted(2,2,p)": persisted(2, 2),
    "occurred(0,p)": occurred(0, 0),
    "occurred(2,p)": occurred(0, 2),
    "occurred(1,3,p)": occurred(1, 3),
    "prevOcc(p,r)": previous_occurrence,
    "at the previous occurrence of p, r": previous_occurrence,
    "preBool(false,p)": previous_value(lambda x: False),
    "preBool(true,p)": previous_value(lambda x: True),
    "preBool(r,p)": previous_value(lambda x: x["r"][0]),
    "FTP": first_tick,
    "occurred(2,FTP)": lambda x, k, left, right: left == 0 and k <= 2,
    "persisted(1,!FTP)": lambda x, k, left, right: k - 1 >= max(left, 1),
    "prevOcc(FTP,r)": lambda x, k, left, right: left > 0 or k == 0 or x["r"][0],
    "prevOcc(p,!FTP)": previous_other_than_first,
    "preBool(FTP,p)": previous_value(lambda x: True),
    "preBool(r,FTP)": lambda x, k, left, right: k == 1 or (k == 0 and x["r"][0]),
    "persisted(2,occurred(3,p))": persisted_after_occurred,
}
AHEAD: dict[str, Predicate] = {
    "persists(0,p)": persists(0, 0),
    "persists(2,p)": persists(0, 2),
    "persists(1,3,p)": persists(1, 3),
    "persists(2,2,p)": persists(2, 2),
    "occurs(0,p)": occurs(0, 0),
    "occurs(2,p)": occurs(0, 2),
    "occurs(1,3,p)": occurs(1, 3),
    "nextOcc(p,r)": next_occurrence,
    "at the next occurrence of p, r": next_occurrence,
    "persists(1,occurs(2,p))": persists_before_occurs,
}
SCOPES = {
    "null": "",
    "in": "in m",
    "notin": "unless in m",
    "before": "before m",
    "after": "after m",
    "onlyIn": "only in m",
    "onlyBefore": "only before m",
    "onlyAfter": "only after m",
}
PLACES = {
    "upon": ("upon ({}) the sw shall immediately satisfy q", "regular", "immediately"),
    "whenever": ("whenever ({}) the sw shall within 1 tick satisfy q", "holding", "within"),
    "until": ("the sw shall until ({}) satisfy q", "null", "until"),
    "response": ("the sw shall always satisfy (({}) -> q)", "null", "always"),
    "negated": ("whenever q the sw shall eventually satisfy !({})", "holding", "eventually"),
}


def meant(trace: Trace, scope: str, place: str, predicate: Predicate) -> bool:
    """Section 3 of the semantics: the predicate has its values interval by interval."""
    _, condition, timing = PLACES[place]
    q = trace["q"]
    table = meaning._NEGATED if scope.startswith("only") else meaning._DEMANDS
    for left, right in meaning.intervals(scope, trace["m"]):
        value = [left <= k <= right and predicate(trace, k, left, right) for k in range(len(q))]
        trigger, stop, response = value, value, q
        if place == "response":
            response = [q[k] or not value[k] for k in range(len(q))]
        if place == "negated":
            trigger, response = q, [not value[k] for k in range(len(q))]
        for t in meaning.triggers(condition, trigger, left, right):
            if not table[timing](t, right, 1, response, stop):
                return False
    return True


@cache
def traces() -> list[Trace]:
    """Each length from 1 to 8 some times, with modes that last."""
    choose = random.Random("traces of predicates")
    found = []
    for length in [*range(1, 9)] * (5 if FULL else 3):
        changes = [choose.random() < 0.35 for _ in range(length)]
        mode = [sum(changes[: k + 1]) % 2 == 1 for k in range(length)]
        p, q, r = ([choose.random() < 0.6 for _ in range(length)] for _ in "pqr")
        found.append({"m": mode, "p": p, "q": q, "r": r})
    return found


def rows(trace: Trace) -> list[dict[str, bool]]:
    return [{name: trace[name][k] for name in trace} for k in range(len(trace["q"]))]


@pytest.mark.slow
@each("case", pairwise([*BACK], [*SCOPES], [*PLACES]))
def test_a_predicate_that_looks_back_means_what_it_says(case: tuple[str, str, str]) -> None:
    text, scope, place = case
    sentence = f"{SCOPES[scope]} {PLACES[place][0].format(text)}"
    formula = requirement(sentence).pt
    for trace in traces():
        verdict = holds(formula, rows(trace), len(trace["q"]) - 1)
        assert verdict == meant(trace, scope, place, BACK[text]), (sentence, trace)


@pytest.mark.slow
@each("case", pairwise([*AHEAD], [*SCOPES], [*PLACES]))
def test_a_predicate_that_looks_ahead_means_what_it_says(case: tuple[str, str, str]) -> None:
    text, scope, place = case
    sentence = f"{SCOPES[scope]} {PLACES[place][0].format(text)}"
    formula = requirement(sentence).ft_finite
    for trace in traces():
        verdict = holds(formula, rows(trace), 0)
        assert verdict == meant(trace, scope, place, AHEAD[text]), (sentence, trace)


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES)
def test_the_meaning_tells_traces_apart(place: str) -> None:
    """Neither verdict is rare: the comparisons above compare something."""
    for table in (BACK, AHEAD):
        verdicts = Counter(
            meant(trace, scope, place, table[text])
            for text in table
            for scope in SCOPES
            for trace in traces()
        )
        assert min(verdicts.values()) > 0.05 * verdicts.total()


# The first tick of the run ---------------------------------------------------------------------

WHILE = {
    "in": "while ({})",
    "notin": "except while ({})",
    "before": "before ({})",
    "after": "after ({})",
    "onlyIn": "only while ({})",
    "onlyBefore": "only before ({})",
    "onlyAfter": "only after ({})",
}
OF_THE_RUN: dict[str, Callable[[Sequence[bool], int], bool]] = {
    "FTP": lambda m, k: k == 0,
    "!FTP": lambda m, k: k > 0,
    "FTP | m": lambda m, k: k == 0 or m[k],
    "m & !FTP": lambda m, k: k > 0 and m[k],
    "occurred(1,FTP)": lambda m, k: k <= 1,
    "persisted(1,!FTP)": lambda m, k: k > 1,
    "prevOcc(FTP,m)": lambda m, k: k > 0 and m[0],
}
"""Within the expression of a scope, which knows no interval yet."""


@pytest.mark.slow
@each("case", some(product(WHILE, OF_THE_RUN), 2))
def test_the_first_tick_within_a_scope_is_that_of_the_run(case: tuple[str, str]) -> None:
    """Formula and monitor, at the end of each prefix, against the definition."""
    scope, text = case
    number = list(OF_THE_RUN).index(text)
    of_scope = [template for template in templates((1,)) if template.scope == scope]
    for place, template in enumerate(some(of_scope[number % 3 :: 3], 3, number % 3)):
        begun = template.sentence.index("mode") + len("mode")
        sentence = f"{WHILE[scope].format(text)}{template.sentence[begun:]}"
        made = requirement(sentence)
        machine = monitoring.monitor(sentence) if place % 4 == 0 else None
        names = {*template.columns, "m"}
        for trace in traces()[place % 10 :: 10]:
            word = {n: trace[{"s": "r"}.get(n, n)] for n in sorted(names)}
            told = {n: [*column] for n, column in word.items()}
            found = monitoring.steps(machine, told) if machine else []
            for length in range(1, len(trace["q"]) + 1):
                prefix = {name: list(column[:length]) for name, column in word.items()}
                mode = [OF_THE_RUN[text](prefix["m"], k) for k in range(length)]
                right = template.satisfied({**prefix, "m": mode})
                state = [{name: prefix[name][k] for name in prefix} for k in range(length)]
                assert holds(made.pt, state, length - 1) == right, (sentence, prefix)
                assert not found or found[length - 1].finite == right, (sentence, prefix)


POSITIONS = [
    *(f"{words} sw shall always satisfy q" for words in WHILE.values()),
    "when ({}) sw shall within 2 ticks satisfy q",
    "whenever ({}) sw shall immediately satisfy q",
    "in m mode whenever ({}) sw shall at the next timepoint satisfy q",
    "sw shall until ({}) satisfy q",
    "sw shall before ({}) satisfy q",
    "after m mode sw shall always satisfy ({}) -> q",
    "sw shall eventually satisfy q & !({})",
]
AT_FIRST = ("FTP", "!FTP & p", "FTP xor p", "occurred(2, FTP)", "prevOcc(FTP, p)")


@pytest.mark.slow
@each("case", some(product(POSITIONS, AT_FIRST), 2))
def test_no_monitor_asks_whether_it_is_the_first_tick(case: tuple[str, str]) -> None:
    """It tells what it would, were it told by a proposition that holds at that tick alone."""
    sentence, text = case
    itself = monitoring.monitor(sentence.format(text))
    told = monitoring.monitor(sentence.format(text.replace("FTP", "z")))
    assert [*itself.PROPOSITIONS] == [name for name in told.PROPOSITIONS if name != "z"]
    for trace in traces()[:8]:
        word = {**trace, "z": [k == 0 for k in range(len(trace["q"]))]}
        columns = {name: [*column] for name, column in word.items()}
        pairs = zip(monitoring.steps(itself, columns), monitoring.steps(told, columns), strict=True)
        for one, other in pairs:
            assert (one.trigger, one.violation, one.finite, one.first_violation) == (
                other.trigger,
                other.violation,
                other.finite,
                other.first_violation,
            ), (sentence, text, trace)


@pytest.mark.parametrize(
    "text",
    ["f(FTP)", "persisted(n, FTP)", "occurred(FTP & p)", "persisted(FTP, p)", "f(p, g(!FTP))"],
)
def test_a_monitor_refuses_what_would_be_asked_of_the_first_tick(text: str) -> None:
    for sentence in ("whenever {} sw shall satisfy q", "while {} sw shall satisfy q"):
        refused = target.refuse(requirement(sentence.format(text)))
        assert refused is not None
        assert refused.code is Code.NOT_EXPRESSIBLE
        assert "`FTP`" in refused.message


def test_within_a_scope_a_previous_value_of_the_first_tick_is_refused_too() -> None:
    refused = target.refuse(requirement("while preBool(false, FTP) sw shall satisfy q"))
    assert refused is not None
    assert "`FTP`" in refused.message


@pytest.mark.parametrize("text", ["FTP = 1", "x + FTP > 2", "absReal(FTP) > 1"])
def test_the_first_tick_is_no_number(text: str) -> None:
    ((requirement,), _) = requirements(Source("r.fret", f"whenever {text} sw shall satisfy q"))
    made, diagnostics = formalize(requirement, None)
    assert made is None
    assert [one.code for one in diagnostics] == [Code.WRONG_KIND]


# What stays a proposition ---------------------------------------------------------------------


@pytest.mark.parametrize("text", ["persists(2,p)", "occurs(1,3,p)", "nextOcc(p,r)"])
def test_a_predicate_that_looks_ahead_stays_in_the_past_time_formula(text: str) -> None:
    formalized = requirement(f"the sw shall always satisfy {text}")
    assert printing.past(formalized.pt) == f"(H {text})"
    assert text not in printing.future(formalized.ft_finite)


@pytest.mark.parametrize(
    "text", ["persisted(2,p)", "occurred(1,3,p)", "prevOcc(p,r)", "preBool(FALSE,p)"]
)
def test_a_predicate_that_looks_back_stays_in_the_future_time_formulas(text: str) -> None:
    formalized = requirement(f"the sw shall always satisfy {text.replace('FALSE', 'false')}")
    assert printing.future(formalized.ft_finite) == f'(LAST R "{text}")'
    assert printing.future(formalized.ft_infinite) == f'(G "{text}")'
    assert text not in printing.past(formalized.pt)


def test_the_first_tick_stays_in_the_future_time_formulas() -> None:
    formalized = requirement("the sw shall always satisfy FTP -> q")
    assert printing.future(formalized.ft_infinite).replace('"', "") == "(G (FTP -> q))"
    assert printing.past(formalized.pt) == "(H ((Z FALSE) -> q))"


@pytest.mark.parametrize(
    "text",
    ["persisted(n,p)", "persisted(1.5,p)", "occurred(1,n,p)", "occurred(3,1,p)", "persisted(p)"],
)
def test_a_bound_that_is_no_whole_number_leaves_the_past_predicate_alone(text: str) -> None:
    assert printing.past(requirement(f"the sw shall always satisfy {text}").pt) == f"(H {text})"


@pytest.mark.parametrize("text", ["persists(n,p)", "occurs(2.0,p)", "occurs(3,1,p)", "occurs(p)"])
def test_a_bound_that_is_no_whole_number_leaves_the_future_predicate_alone(text: str) -> None:
    formula = requirement(f"the sw shall always satisfy {text}").ft_infinite
    assert printing.future(formula) == f'(G "{text}")'


def test_other_functions_stay() -> None:
    formula = requirement("the sw shall always satisfy f(p,q)").pt
    assert printing.past(formula) == "(H f(p,q))"


# In the expression of a scope ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scope", "formula"),
    [
        ("while persisted(2,p)", "(H ((H[0,2] p) -> q))"),
        ("while occurred(1,3,p)", "(H ((O[1,3] p) -> q))"),
        ("while prevOcc(p,r)", "(H ((Y ((! p) S (p & r))) -> q))"),
        ("while preBool(r,p)", "(H (preBool(r,p) -> q))"),
    ],
)
def test_a_predicate_in_a_scope_looks_over_the_whole_trace(scope: str, formula: str) -> None:
    """`prevOcc` asks for an occurrence there, and `preBool` is left alone."""
    assert printing.past(requirement(f"{scope} the sw shall always satisfy q").pt) == formula


def test_a_following_occurrence_in_a_scope_must_exist() -> None:
    formula = requirement("while nextOcc(p,r) the sw shall always satisfy q").ft_finite
    never_again = [{"p": True, "r": True, "q": False}, {"p": False, "r": True, "q": False}]
    comes = [{"p": False, "r": False, "q": False}, {"p": True, "r": True, "q": True}]
    wrong = [{"p": False, "r": True, "q": False}, {"p": True, "r": False, "q": True}]
    assert [holds(formula, trace) for trace in (never_again, comes, wrong)] == [True, False, True]


def test_a_predicate_in_a_scope_does_not_begin_with_its_own_interval() -> None:
    """P since tick 0, and the interval begins at tick 0 only if the past is not cut at it."""
    formula = requirement("while persisted(2,p) & m the sw shall immediately satisfy q").pt
    trace = [
        {"m": False, "p": True, "q": False},
        {"m": False, "p": True, "q": False},
        {"m": True, "p": True, "q": False},
    ]
    assert [holds(formula, trace, at) for at in range(3)] == [True, True, False]
