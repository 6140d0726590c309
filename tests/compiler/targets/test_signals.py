"""Samples say in each language what they say in an audit: special floats, large numbers, words."""

from __future__ import annotations

import math
import random
import struct
from dataclasses import replace
from functools import cache
from itertools import chain, islice
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from fretc.logs.signals.enum_values import enum_index
from fretc.logs.signals.propositions import StepFunction, truth_values
from fretc.logs.signals.samples import EXACT, Values
from fretc.logs.signals.traces import combined
from fretish import expressions as e
from fretish.bindings.declarations import Aggregate, Declarations, Proposition, Signal, path
from fretish.clock import Clock
from fretish.diagnostics.source import Source
from fretish.units import ONE
from monitors.kernel.verdicts import Truth
from tests.effort import FULL
from tests.emitting import requirement
from tests.signal_policies import Case, audited_truth, collected, edge_cases, numbered
from tests.signal_programs import LANGUAGES, Language, c, packed

TRUTHS: tuple[Truth, ...] = (False, True, None)
MANY = 80 if FULL else 10


@cache
def audited() -> list[tuple[Case, list[tuple[Truth, tuple[Values, Values]]]]]:
    """Cases, and what an audit says of each row: each constant once, by default."""
    edges = edge_cases()
    half = len(edges) // 2  # the same constants again, with other signs and forms
    chosen = edges if FULL else [edges[i + half * (i // 2 % 2)] for i in range(half)]
    return [(case, case.expected()) for case in (*chosen, *collected(MANY))]


def same(audited: Values, value: float, magnitude: int, kind: int) -> bool:
    """Whether a number of a program is the audit's sample."""
    (expected,) = audited
    if np.isnan(expected) or kind == 0:
        return bool(np.isnan(expected)) and kind == 0
    if audited.dtype == EXACT:
        return kind == 3 and int(expected) == (magnitude if value > 0 else -magnitude)
    return kind == (1 if audited.dtype == np.float32 else 2) and float(expected) == value


OPTIMIZED = (
    pytest.param(c("clang", "-O3"), id="c-clang"),
    pytest.param(c("gcc", "-O3", "-march=native"), id="c-native"),
)


@pytest.mark.slow
@pytest.mark.parametrize("language", [*LANGUAGES, *(OPTIMIZED if FULL else ())], ids=str)
def test_samples_say_what_they_say_in_an_audit(language: Language, tmp_path: Path) -> None:
    cases = [case for case, _ in audited()]
    requirements = [numbered(case, i) for i, case in enumerate(cases)]
    run = language.runner(tmp_path, requirements, language.cases(cases))
    rows = chain.from_iterable(row for case in cases for row in case.rows)
    records = struct.iter_unpack("=dQBdQBB", run(b"".join(map(packed, rows))))
    for case, expected in audited():
        for row, (truth, samples) in zip(case.rows, expected, strict=True):
            told = next(records)
            assert same(samples[0], *told[:3]), (case.signals[0], row[0], samples[0], told)
            assert same(samples[1], *told[3:6]), (case.signals[1], row[1], samples[1], told)
            assert TRUTHS[told[6]] is truth, (case.tree, case.signals, row, samples, told)
    assert next(records, None) is None


WORDS = ("idle", 'say "?"', "dr\u00e9ive", "9")
NUMBERS = (0, 4, -1)


def is_word(signal: str, sign: Any, text: str) -> e.Expression:
    return e.Comparison(sign, e.Name(signal), e.Word(text))


PROPOSITIONS = (
    Proposition("p0", e.Or((is_word("mode", "=", WORDS[1]), is_word("mode", "=", WORDS[2])))),
    Proposition("p1", is_word("mode", "!=", "idle"), aggregate=Aggregate.ANY, on_unknown=False),
    Proposition("p2", is_word("gear", "!=", "back"), aggregate=Aggregate.ALL),
    Proposition(
        "p3",
        e.Not(e.Persistence(is_word("gear", "=", "forward"), 10**9)),
        aggregate=Aggregate.ALL,
        on_unknown=True,
    ),
)


def of_words() -> Declarations:
    places = [path(f"/t.{name}") for name in ("mode", "gear")]
    mode, gear = (place for place in places if place is not None)
    signals = {
        "mode": Signal("mode", mode, ONE, "", values=WORDS),
        "gear": Signal("gear", gear, ONE, "", values=("park", "forward", "back"), numbers=NUMBERS),
    }
    named = {each.name: each for each in PROPOSITIONS}
    return Declarations(Source("bindings.toml", ""), Clock(10**8), signals, named)


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES, ids=str)
def test_words_durations_and_the_instants_of_a_tick(language: Language, tmp_path: Path) -> None:
    declarations = of_words()
    subjects = [requirement(f"the sw shall always satisfy {p.name}", p.name) for p in PROPOSITIONS]
    requirements = [replace(each, declarations=declarations) for each in subjects]
    run = language.runner(tmp_path, requirements, language.tick)
    choose = random.Random(7)
    ticks = [
        [
            (choose.choice([*WORDS, "", "idle ", "Idle"]), choose.choice([*NUMBERS, 1.5, math.nan]))
            for _ in range(choose.randint(1, 5))
        ]
        for _ in range(200)
    ]
    data = b"".join(
        struct.pack("=B16sd", length, text, number)
        for rows in ticks
        for length, text, number in (*map(sent, rows), (255, b"", 0.0))
    )
    told = iter([TRUTHS[byte] for byte in run(data)])
    for rows in ticks:
        columns = [states(each, declarations, rows) for each in PROPOSITIONS]
        for now in zip(*columns, strict=True):
            p0, p1, p2, holding, p3 = islice(told, 5)
            assert (p0, p1, p2, p3) == now, rows
            assert holding is (None if p3 is None else not p3)
        decisions = [*map(decided, PROPOSITIONS, columns)]
        assert [*islice(told, 4)] == decisions, rows
    assert next(told, None) is None


def sent(row: tuple[str, float]) -> tuple[int, bytes, float]:
    text = row[0].encode()
    return len(text), text, row[1]


def states(
    proposition: Proposition, declarations: Declarations, rows: list[tuple[str, float]]
) -> list[Truth]:
    """The audit's truths; a duration is as what it is about."""
    found = []
    for text, number in rows:
        message = SimpleNamespace(mode=text, gear=number)
        places = {name: enum_index(each, message) for name, each in declarations.signals.items()}
        row = {n: np.array([np.nan if isinstance(p, str) else p]) for n, p in places.items()}
        tree = proposition.expression
        if isinstance(tree, e.Not) and isinstance(tree.arg, e.Persistence):
            tree = e.Not(tree.arg.arg)
        found.append(audited_truth(tree, declarations.signals, row))
    return found


def decided(proposition: Proposition, truths: list[Truth]) -> Truth:
    """What a tick says that sees these instants, in an audit."""
    codes = np.array([(False, None, True).index(each) for each in truths], np.int8)
    steps = StepFunction(np.arange(len(truths)), codes)
    ends = np.array([0]), np.array([len(truths)])
    (value,) = truth_values(combined(steps, *ends, proposition))
    return value
