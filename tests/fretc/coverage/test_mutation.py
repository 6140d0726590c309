"""Which mutants runs notice, against the emitted monitor of each mutant on its own."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import jsonschema  # type: ignore[import-untyped]
import numpy as np
import pytest

from compiler.files.templating import template_root
from compiler.targets.python import monitor as target
from fretc.audit.measurements.judgement import Judgement, judge
from fretc.coverage import mutation_record
from fretc.coverage.mutation import (
    MutantBatch,
    MutantDifference,
    MutationResult,
    difference,
    judgements,
    mutant_batch,
)
from fretc.coverage.mutation_output import lines
from fretc.logs.signals.traces import Trace, WholeTicks
from monitors import kernel
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Truth, Verdict
from monitors.loading import load
from tests.each import each
from tests.effort import FULL, some
from tests.emitting import requirement
from tests.monitoring import packed
from tests.strategies import Template, templates

Row = Mapping[str, Truth]
SENTENCES = [
    "in m mode, upon p the sw shall within 3 ticks satisfy q & !r",
    "whenever p | r the sw shall until m satisfy q",
    "only after m mode the sw shall for 2 ticks satisfy q",
    "the sw shall always satisfy p -> q",
]


def trace_of(run: Sequence[Row], cut: Row | None = None) -> Trace:
    _, columns = packed({name: [row[name] for row in run] for name in run[0]})
    times = np.arange(len(run), dtype=np.int64) * 10**8
    return Trace(WholeTicks(times, 10**8), columns, cut)


def by_itself(own: Monitor, trace: Trace, *, intact: bool) -> Judgement:
    """The judgement of a monitor of one requirement, stepped tick by tick."""
    columns = {name: trace.columns[name] for name in own.PROPOSITIONS}
    cut = trace.cut and {name: trace.cut[name] for name in columns}
    ticks = len(trace.timeline.times)
    end = kernel.INCONCLUSIVE
    (judgement,) = judge(own, columns, cut, ticks, intact=intact, end=end, engine=kernel.stepped)
    return judgement


def together(of: MutantBatch, trace: Trace, *, intact: bool = True) -> list[Judgement]:
    return [*judgements(of.monitor, trace, Verdict.INCONCLUSIVE, intact=intact)]


def runs(seed: str, unknown: float) -> Iterator[list[dict[str, Truth]]]:
    choose = random.Random(seed)
    for length in (1, 4, 12):
        yield [
            {name: None if choose.random() < unknown else choose.random() < 0.6 for name in "mpqrs"}
            for _ in range(length)
        ]


def seen(found: Judgement) -> tuple[object, ...]:
    outcome = found.outcome
    return found.verdict, [*outcome.violations], [*outcome.unknown]


@pytest.mark.slow
@each("sentence", some(SENTENCES, 2))
def test_all_mutants_in_one_monitor_are_judged_as_each_by_its_own(sentence: str) -> None:
    of = mutant_batch(requirement(sentence))
    assert of.mutants
    assert not of.refused
    alone, *of_mutants = [
        load("own", target.text(one))
        for one in (requirement(sentence), *(m.requirement for m in of.mutants))
    ]
    for number, run in enumerate([*runs(sentence, 0.0), *runs(sentence, 0.15)]):
        trace, intact = trace_of(run, run[0] if number % 2 else None), number != 1
        own, *others = together(of, trace, intact=intact)
        assert seen(own) == seen(by_itself(alone, trace, intact=intact))
        for mutant, watching, other in zip(of.mutants, of_mutants, others, strict=True):
            assert seen(other) == seen(by_itself(watching, trace, intact=intact)), mutant.words


@pytest.mark.slow
@each("template", [*templates((2,))][:: 30 if FULL else 90])
def test_a_difference_is_there_whatever_the_unknown_values_were(template: Template) -> None:
    of = mutant_batch(requirement(template.sentence))
    for run in runs(template.sentence, 0.0):
        holes = [
            {**row, name: None} if tick == len(run) // 2 else row
            for tick, row in enumerate(run)
            for name in "q"
        ]
        own, *others = together(of, trace_of(holes))
        filled = [
            together(
                of, trace_of([{k: v if w is None else w for k, w in row.items()} for row in holes])
            )
            for v in (False, True)
        ]
        for number, other in enumerate(others, 1):
            found = difference(own, other)
            if found is not None:
                assert all(difference(one[0], one[number]) is not None for one in filled)


@pytest.mark.slow
def test_known_runs_differ_where_verdicts_or_violated_ticks_do() -> None:
    of = mutant_batch(requirement(SENTENCES[0]))
    noticed = set[str]()
    for bits in product((False, True), repeat=6):
        values = [
            dict(zip("mpqr", (True, a, b, False), strict=True))
            for a, b in zip(bits[::2], bits[1::2], strict=True)
        ]
        run: list[Row] = [*values, *[dict.fromkeys("mpqr", False)] * 2, dict.fromkeys("mpqr", True)]
        own, *others = together(of, trace_of(run))
        for mutant, other in zip(of.mutants, others, strict=True):
            same = seen(own)[:2] == seen(other)[:2]
            assert (difference(own, other) is None) is same
            noticed |= set() if same else {mutant.key}
    assert noticed


def test_what_is_unknown_notices_nothing() -> None:
    of = mutant_batch(requirement(SENTENCES[3]))
    own, *others = together(of, trace_of([dict.fromkeys("pq")] * 3))
    stuck = {"stuck:response-false", "stuck:response-true"}
    for mutant, other in zip(of.mutants, others, strict=True):
        found = difference(own, other)
        assert found is None, mutant.key
    assert stuck <= {mutant.key for mutant in of.mutants}


def surveyed() -> MutationResult:
    of = mutant_batch(requirement(SENTENCES[3]))
    first, second, *_ = of.mutants
    apart = {
        ("R1", first.key): (0, MutantDifference("satisfied", "violated", 3)),
        ("R1", second.key): (1, MutantDifference("satisfied", "vacuous", None)),
    }
    return MutationResult(("a.mcap", "b.mcap"), (of,), frozenset({"R1"}), apart, ())


def test_its_json_is_of_its_schema() -> None:
    schema = json.loads((template_root() / "json/mutation.schema.json").read_text("utf-8"))
    found = json.loads(mutation_record.text(surveyed()))
    jsonschema.validate(found, schema)
    outcomes = [each["outcome"] for each in found["requirements"][0]["mutants"]]
    assert outcomes.count("noticed") == 2
    assert outcomes.count("not noticed") == len(outcomes) - 2


def test_what_no_run_notices_is_printed_with_its_sentence() -> None:
    found = surveyed()
    short = [text for text, _ in lines(found, {}, every=False)]
    (of,) = found.batches
    survivors = of.mutants[2:]
    assert short[0] == f"○ R1: 2 of {len(of.mutants)} mutants noticed"
    for mutant in survivors:
        assert f"    ○ {mutant.words}" in short
        assert f"      {mutation_record.written(mutant)}" in short
    assert not any(of.mutants[0].words in text for text in short)
    every = "\n".join(text for text, _ in lines(found, {}, every=True))
    assert f"{of.mutants[0].words}: violated, and the requirement satisfied, in a.mcap" in every


def test_runs_without_a_verdict_say_so() -> None:
    of = mutant_batch(requirement(SENTENCES[3]))
    nothing = MutationResult(("a.mcap",), (of,), frozenset(), {}, ())
    (head, *_) = lines(nothing, {}, every=False)
    assert head[0].endswith("noticed; no run has a verdict on it")
    assert not nothing.is_complete
    assert not MutationResult((), (), frozenset(), {}, ()).is_complete
