"""The formulas of a sentence against FRET's own, and against the meaning of FRETish."""

import json
import random
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import pytest

from compiler.formalization.formalize import formalize
from compiler.formalization.future import future
from compiler.formalization.obligation import Obligation, obligation
from compiler.formalization.past import monitor_spec, past
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.definition import holds
from compiler.logic.formula import Formula, children, endless
from compiler.logic.spot import same_language
from fretish.clock import Clock, Rounding, in_ticks
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry, requirements
from fretish.parser import parse
from fretish.reading.memory import Memory
from fretish.syntax import Sentence, duration
from tests import fret_notation as fret
from tests.each import each
from tests.effort import FULL, some
from tests.meaning import SCOPES
from tests.spot_oracle import equivalent
from tests.strategies import Template, some_templates, templates

DATA = Path(__file__).parents[2] / "data"


def read(text: str) -> Obligation:
    sentence = parse(Source("r.fret", text).span())
    assert isinstance(sentence, Sentence), sentence
    counted = duration(sentence.timing)
    return obligation(sentence, counted.amount if counted else 0)


@cache
def table(name: str) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads((DATA / name).read_text(encoding="utf-8"))
    return [row for row in rows if row.get("group") != "temporal_predicate"]


def formulas_of_fret() -> list[dict[str, Any]]:
    """Templates and case studies; without the temporal predicates, which fretc leaves alone."""
    rows = [*table("fret_templates.json"), *table("fret_case_studies.json")]
    predicates = ("preBool", "preReal", "preInt", "persist", "occur", "prevOcc", "FTP")
    return [row for row in rows if not any(word in row["pt"] for word in predicates)]


def drawn(names: Sequence[str], length: int, count: int, seed: str) -> list[fret.Trace]:
    choose = random.Random(f"{seed} {length}")
    return [
        {n: [choose.random() < 0.5 for _ in range(length)] for n in names} for _ in range(count)
    ]


CELLS = 12 if FULL else 9


def exhaustive(names: Sequence[str]) -> range:
    """The lengths of which all traces are judged: to 3 for four names, to 4 for fewer.

    To 2 for four names, to 3 for three, where not everything is tried.
    """
    return range(1, 1 + max((k for k in range(1, 5) if len(names) * k <= CELLS), default=0))


Packed = tuple[dict[str, list[int]], int, int]
"""As `fret.values` takes them: their columns, their length and all bits."""
Traces = tuple[list[fret.Trace], Packed]


@lru_cache(32)
def all_traces(names: tuple[str, ...], length: int) -> Traces:
    traces = fret.all_traces(names, length)
    return traces, fret.packed(traces)


@cache
def satisfied(template: Template, length: int) -> int:
    """Which of all traces of a length satisfy the template."""
    return fret.bits(all_traces(template.columns, length)[0], template.satisfied)


def judgements(template: Template, drawn_each: int) -> Iterator[tuple[Traces, int]]:
    """Some traces, and which of them satisfy the template."""
    lengths = exhaustive(template.columns)
    for length in lengths:
        yield all_traces(template.columns, length), satisfied(template, length)
    for traces in longer(template.columns, len(lengths), repr(template), drawn_each):
        yield traces, fret.bits(traces[0], template.satisfied)


def some_traces(names: Sequence[str], seed: str, drawn_each: int) -> Iterator[Traces]:
    """All short traces, then drawn longer ones."""
    lengths = exhaustive(names)
    yield from (all_traces(tuple(names), length) for length in lengths)
    yield from longer(names, len(lengths), seed, drawn_each)


def longer(names: Sequence[str], above: int, seed: str, drawn_each: int) -> Iterator[Traces]:
    for length in (*range(above + 1, 7), 9):
        traces = drawn(names, length, drawn_each, seed)
        yield traces, fret.packed(traces)


def at_start(text: str) -> Callable[[Packed], int]:
    node = fret.parse(text)
    return lambda packed: fret.values(node, *packed)[0]


def at_end(text: str) -> Callable[[Packed], int]:
    node = fret.parse(text)
    return lambda packed: fret.values(node, *packed)[-1]


# Against FRET's own formulas ------------------------------------------------------------------


@pytest.mark.slow
@each("row", formulas_of_fret())
def test_the_infinite_formula_has_the_language_of_frets(row: dict[str, Any]) -> None:
    ours = printing.future(endless(future(read(row["fretish"]))))
    assert same_language(ours, row["ft_inf"])


@pytest.mark.slow
@each("row", some(formulas_of_fret(), 3, first=1))
def test_the_formulas_judge_finite_traces_as_frets_do(row: dict[str, Any]) -> None:
    meant = read(row["fretish"])
    judges = {
        "ft_fin": at_start(row["ft_fin"]),
        "pt": at_end(row["pt"]),
        "our future": at_start(printing.future(future(meant))),
        "our past": at_end(printing.past(past(meant))),
    }
    texts = (row["ft_fin"], row["pt"], printing.future(future(meant)))
    names = sorted(set().union(*(fret.atoms(fret.parse(text)) for text in texts)) - {"LAST"})
    for traces, packed in some_traces(names or ["q"], row["id"], drawn_each=20):
        expected = judges["ft_fin"](packed)
        for name, judge in judges.items():
            assert fret.differing(traces, expected, judge(packed)) is None, name


@pytest.mark.slow
@each("row", some(formulas_of_fret(), 5))
def test_the_printed_formulas_mean_what_the_formulas_mean(row: dict[str, Any]) -> None:
    meant = read(row["fretish"])
    forward, back = future(meant), past(meant)
    names = sorted({*f.atoms(forward), *f.atoms(back)}) or ["q"]
    for length in (1, 2, 3, 5):
        traces = drawn(names, length, 8, row["id"])
        rows = [[{n: t[n][i] for n in names} for i in range(length)] for t in traces]
        texts = (printing.future(forward), printing.past(back))
        for formula, text in zip((forward, back), texts, strict=True):
            node = fret.parse(text)
            word, _, full = fret.packed(traces)
            word = {name.strip('"'): column for name, column in word.items()}
            printed = fret.values(node, word, length, full)
            for k, trace in enumerate(rows):
                expected = [holds(formula, trace, i) for i in range(length)]
                assert [bool(value >> k & 1) for value in printed] == expected, text


# Against the meaning --------------------------------------------------------------------------


def every(scope: str) -> list[Template]:
    return [template for template in some_templates() if template.scope == scope]


def test_there_are_288_templates() -> None:
    assert len(list(templates((0,)))) == 288


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_future_past_and_watch_mean_what_fretish_means(scope: str) -> None:
    for template in every(scope):
        meant = read(template.sentence)
        signals = monitor_spec(meant)
        forward = at_start(printing.future(future(meant)))
        back = at_end(printing.past(past(meant)))
        violation = fret.parse(printing.past(signals.violation))
        violated_if_ended = fret.parse(printing.past(signals.violated_if_ended))
        for (traces, packed), expected in judgements(template, drawn_each=25):
            word, length, full = packed
            lost = fret.values(violated_if_ended, word, length, full)[-1]
            for broken in fret.values(violation, word, length, full):
                lost |= broken
            for name, judged in (
                ("future", forward(packed)),
                ("past", back(packed)),
                ("watch", full ^ lost),
            ):
                assert fret.differing(traces, expected, judged) is None, (template, name)


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_the_formulas_hold_as_their_definition_says(scope: str) -> None:
    for template in every(scope):
        meant = read(template.sentence)
        forward, back, signals = future(meant), past(meant), monitor_spec(meant)
        for length in (1, 2, 4):
            for columns in drawn(template.columns, length, 2, repr(template)):
                trace = [{n: column[i] for n, column in columns.items()} for i in range(length)]
                expected = template.satisfied(columns)
                kept = not holds(signals.violated_if_ended, trace, length - 1) and not any(
                    holds(signals.violation, trace, i) for i in range(length)
                )
                found = (holds(forward, trace, 0), holds(back, trace, length - 1), kept)
                assert found == (expected,) * 3, (template, columns)


FORMS: list[tuple[str, Callable[[bool, bool], bool]]] = [
    ("({0} -> {1})", lambda x, y: not x or y),
    ("!{0}", lambda x, y: not x),
    ("({0} & !{1})", lambda x, y: x and not y),
    ("true", lambda x, y: True),
    ("({0} | {1})", lambda x, y: x or y),
    ("({0} xor {1})", lambda x, y: x is not y),
    ("false", lambda x, y: False),
    ("({0} <-> {1})", lambda x, y: x is y),
    ("!({0} & ({1} -> {0}))", lambda x, y: not (x and (not y or x))),
]
"""What a user may write for a variable, over two others, and its truth table."""


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("turn", range(3) if FULL else [0])
def test_a_variable_may_be_any_expression(scope: str, turn: int) -> None:
    names = ("a", "b", "c")
    for number, template in enumerate(every(scope)):
        shift = (number // len(FORMS) + turn) % 3
        chosen = {
            name: (
                FORMS[(number + 2 * i + 3 * shift) % len(FORMS)],
                names[i % 3],
                names[(i + 1) % 3],
            )
            for i, name in enumerate("mpqs")
        }
        text = template.sentence.replace(" m mode", " m").replace("when not in m", "except while m")
        text = text.replace("only in m", "only while m").replace("in m", "while m")
        for name, ((form, _), one, two) in chosen.items():
            text = re.sub(rf"\b{name}\b", f"@{form.format(one.upper(), two.upper())}", text)
        meant = read(text.replace("@", "").translate(str.maketrans("ABC", "abc")))
        judges = {
            "future": at_start(printing.future(future(meant))),
            "past": at_end(printing.past(past(meant))),
        }
        signals = monitor_spec(meant)
        for length in (1, 2, 3, 6):
            traces = drawn(names, length, 12, f"{template} {shift}")
            values = [
                {
                    name: [table(x, y) for x, y in zip(trace[one], trace[two], strict=True)]
                    for name, ((_, table), one, two) in chosen.items()
                }
                for trace in traces
            ]
            expected = fret.bits(values, template.satisfied)
            packed = word, _, full = fret.packed(traces)
            for name, judge in judges.items():
                assert fret.differing(traces, expected, judge(packed)) is None, (text, name)
            lost = fret.values(
                fret.parse(printing.past(signals.violated_if_ended)), word, length, full
            )[-1]
            violation = fret.parse(printing.past(signals.violation))
            for broken in fret.values(violation, word, length, full):
                lost |= broken
            assert fret.differing(traces, expected, full ^ lost) is None, (text, "watch")


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_a_breach_cannot_be_repaired(scope: str) -> None:
    """The verdict `violated` is certain: every longer trace is violated too."""
    for template in every(scope):
        violation = fret.parse(printing.past(monitor_spec(read(template.sentence)).violation))
        for (traces, packed), kept in judgements(template, drawn_each=10):
            word, length, full = packed
            lost = 0
            for broken in fret.values(violation, word, length, full):
                lost |= broken
            assert fret.differing(traces, lost & kept, 0) is None, template


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_a_finite_formula_does_not_depend_on_what_follows_the_last_tick(scope: str) -> None:
    for template in every(scope):
        node = fret.parse(printing.future(future(read(template.sentence))))
        for length in (1, 2, 3, 5):
            for after in (1, 3):
                traces = drawn(template.columns, length + after, 20, repr(template))
                word, whole, full = fret.packed(traces)
                word["LAST"] = [full if i == length - 1 else 0 for i in range(whole)]
                followed = fret.values(node, word, whole, full, loop=length)[0]
                alone = [{n: c[:length] for n, c in trace.items()} for trace in traces]
                expected = fret.bits(alone, template.satisfied)
                assert fret.differing(traces, expected, followed) is None, template


# Single cases ---------------------------------------------------------------------------------

R1 = "whenever too_close agilex_agent shall eventually satisfy stopped"


def test_r1_is_the_formula_of_the_paper() -> None:
    meant = endless(future(read(R1)))
    too_close, stopped = f.Atom("too_close"), f.Atom("stopped")
    assert meant == f.Globally(f.Implies(too_close, f.Eventually(stopped, f.EVER)), f.EVER)
    assert printing.readable(meant) == "G(too_close -> F stopped)"


def test_r1_with_when_asks_only_where_too_close_begins() -> None:
    whenever = endless(future(read(R1)))
    when = endless(future(read(R1.replace("whenever", "when"))))
    assert not equivalent(whenever, when)
    # Too close for ever, stopped at the first tick only: one rising edge, answered at once.
    word = {"too_close": [1, 1], "stopped": [1, 0]}
    told = [
        fret.values(fret.parse(printing.future(g)), word, 2, loop=1)[0] for g in (whenever, when)
    ]
    assert told == [0, 1]
    assert same_language(
        printing.future(when),
        "(too_close -> F stopped) & G((!too_close & X too_close) -> X F stopped)",
    )


def nodes(formula: Formula) -> int:
    return 1 + sum(map(nodes, children(formula)))


def bounds(formula: Formula) -> int:
    """The number of nodes and of digits is not the same: this is the largest bound."""
    here = [
        interval.hi
        for name in ("ago", "ahead")
        if (interval := getattr(formula, name, None)) is not None and interval.hi is not None
    ]
    return max([*here, *map(bounds, children(formula))], default=0)


@pytest.mark.parametrize("scope", SCOPES)
@pytest.mark.parametrize("timing", ["within", "for", "after"])
def test_a_long_duration_makes_no_longer_formula(scope: str, timing: str) -> None:
    for condition in ("null", "regular", "holding"):
        short = read(Template(scope, condition, timing, 3).sentence)
        long = read(Template(scope, condition, timing, 10**6).sentence)
        assert nodes(future(short)) == nodes(future(long))
        assert nodes(past(short)) == nodes(past(long))
        assert bounds(future(long)) >= 10**6 - 1


@pytest.mark.parametrize(
    ("sentence", "formula"),
    [
        # The surprises of SEMANTICS section 3, each with its formula on infinite traces.
        ("the sw shall satisfy q", "F q"),
        ("the sw shall always satisfy q", "G q"),
        ("the sw shall never satisfy q", "G !q"),
        ("the sw shall immediately satisfy q", "q"),
        ("the sw shall finally satisfy q", "1"),
        ("if p the sw shall immediately satisfy q", "(p -> q) & G((!p & X p) -> X q)"),
        ("whenever p the sw shall immediately satisfy q", "G(p -> q)"),
        ("whenever p the sw shall within 3 ticks satisfy q", "G(p -> F[0:3] q)"),
        ("whenever p the sw shall for 3 ticks satisfy q", "G(p -> G[0:3] q)"),
        ("whenever p the sw shall after 3 ticks satisfy q", "G(p -> (G[0:3] !q & F[4:4] q))"),
        ("whenever p the sw shall after 0 ticks satisfy q", "G(p -> (!q & X q))"),
        ("whenever p the sw shall within 0 ticks satisfy q", "G(p -> q)"),
        ("whenever p the sw shall for 0 ticks satisfy q", "G(p -> q)"),
        ("whenever p the sw shall until s satisfy q", "G(p -> (q W s))"),
        ("whenever p the sw shall before s satisfy q", "G(p -> (!s W (q & !s)))"),
        ("in m the sw shall always satisfy q", "G(m -> q)"),
        ("before m the sw shall always satisfy q", "q W m"),
        ("before m the sw shall eventually satisfy q", "m | (F q & (!m W (q & !m)))"),
        ("after m the sw shall always satisfy q", "!m W (m & (m W (!m & G q)))"),
        ("only in m the sw shall eventually satisfy q", "G(!m -> !q)"),
        ("only before m the sw shall eventually satisfy q", "!m W (m & G !q)"),
        ("only after m the sw shall immediately satisfy q", "!q"),
    ],
)
def test_a_sentence_has_the_expected_formula(sentence: str, formula: str) -> None:
    assert same_language(printing.future(endless(future(read(sentence)))), formula)


# Rounding -------------------------------------------------------------------------------------


def rounded(template: Template) -> int | Diagnostic | None:
    """How many ticks of 100 ms the template counts where it says 250 milliseconds."""
    text = template.sentence.replace(f" {template.n} ticks ", " 250 milliseconds ").strip()
    sentence = parse(Source("r.fret", text).span())
    assert isinstance(sentence, Sentence), sentence
    return in_ticks(sentence, Clock(10**8, rounding=Rounding.CONSERVATIVE))


def implied(strict: Template, lax: Template) -> bool:
    """Whether Spot knows no endless trace of the one that is none of the other."""
    one, two = (
        printing.future(endless(future(read(template.sentence)))) for template in (strict, lax)
    )
    return same_language(f"({one}) & ({two})", one)


@pytest.mark.slow
@each("template", [t for t in templates((2,)) if t.n])
def test_the_chosen_rounding_implies_the_other_one(template: Template) -> None:
    down, up = template, replace(template, n=3)
    if template.timing == "after":
        assert not implied(down, up)
        assert not implied(up, down)
        assert isinstance(rounded(template), Diagnostic)
        return
    strict, lax = (down, up) if rounded(template) == 2 else (up, down)
    assert implied(strict, lax)
    assert not implied(lax, strict)


def test_formulas_recalled_from_a_memory_are_those_computed() -> None:
    """All sentences share one memory, and move within their file."""
    memory, count = Memory(), 0
    texts = [row["fretish"] for row in some(formulas_of_fret(), 8)]
    for start in ("", "\n\n"):
        with memory.active():
            recalled = [formalize(entry, None) for entry in entries(start, texts)]
        computed = [formalize(entry, None) for entry in entries(start, texts)]
        assert recalled == computed
        count += sum(requirement is not None for requirement, _ in recalled)
    assert count > 20


def entries(start: str, texts: Sequence[str]) -> list[RequirementEntry]:
    return [requirements(Source("r.fret", f"{start}{text}\n"))[0][0] for text in texts]
