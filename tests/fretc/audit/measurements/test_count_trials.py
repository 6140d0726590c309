"""What each trigger came to, against the meaning of FRETish and all continuations of a log."""

import random
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from itertools import product

import pytest

from compiler.formalization.formalized import without_probability
from compiler.targets.python.monitor import text
from fretc.audit.measurements.count_trials import chance, trials
from fretc.audit.measurements.trials import Trials
from monitors.kernel import evaluate
from monitors.kernel.columns import columns_of
from monitors.kernel.verdicts import Truth
from tests import meaning
from tests.effort import some
from tests.monitoring import monitor, packed, requirement
from tests.strategies import Template, templates

Columns = dict[str, list[bool]]


def counted(sentence: str, columns: dict[str, list[Truth]]) -> Trials:
    odds = chance(requirement(sentence))
    assert odds is not None
    ticks, packs = packed(columns)
    return trials(odds.obligation, packs, ticks)


def of(template: Template, columns: dict[str, list[Truth]]) -> Trials:
    return counted(template.sentence.replace("shall", "shall with probability >= 0.9"), columns)


# The naive count ------------------------------------------------------------------------------


def only_forbids(template: Template) -> bool:
    negated = template.scope.startswith("only")
    if template.timing in ("eventually", "null"):
        return negated
    if template.timing in ("always", "never"):
        return not negated
    return template.timing in ("until", "before")


def met(template: Template, columns: Columns, trigger: int) -> bool:
    m, q, s = (columns.get(name, columns["q"]) for name in "mqs")
    demands = meaning._NEGATED if template.scope.startswith("only") else meaning._DEMANDS
    for left, right in meaning.intervals(template.scope, m):
        if left <= trigger <= right:
            return demands[template.timing](trigger, right, template.n, q, s)
    raise AssertionError("no trigger")


def begun(template: Template, columns: Columns) -> Iterator[int]:
    m, p = columns.get("m", columns["q"]), columns.get("p", columns["q"])
    for left, right in meaning.intervals(template.scope, m):
        yield from meaning.triggers(template.condition, p, left, right)


def naive(
    template: Template, columns: Columns, constants: Mapping[str, bool] | None = None
) -> Trials:
    """Each trigger, over every way in which the run could go on past its deadline.

    Those of the columns that are constants stay what they are.
    """
    counts = {"answered": 0, "failed": 0, "open": 0, "met_by_end": 0}
    more = template.n + 2
    fixed = {name: value for name, value in (constants or {}).items() if name != "p"}
    futures = [
        {name: [*columns[name], *tail] for name, tail in zip(columns, tails, strict=True)}
        for tails in product(product((False, True), repeat=more), repeat=len(columns))
        if "p" not in columns or not any(tails[list(columns).index("p")])
        if all(set(tails[list(columns).index(name)]) == {value} for name, value in fixed.items())
    ]
    for trigger in begun(template, columns):
        outcomes = {met(template, future, trigger) for future in futures}
        if len(outcomes) == 1:
            counts["answered" if outcomes.pop() else "failed"] += 1
        elif only_forbids(template) and met(template, columns, trigger):
            counts["answered"] += 1
            counts["met_by_end"] += 1
        else:
            counts["open"] += 1
    return Trials(**counts)


def drawn(template: Template, length: int, chance_: random.Random) -> Columns:
    return {name: [chance_.random() < 0.5 for _ in range(length)] for name in template.columns}


ALL = list(templates((0, 1, 2)))


def tried(scope: str, first: int) -> list[Template]:
    """Those of a scope; in quick tests some, in which each condition and each timing is."""
    return some([template for template in ALL if template.scope == scope], 7, first)


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_every_template_is_counted_as_its_meaning_says(scope: str) -> None:
    for template in tried(scope, 0):
        chance_ = random.Random(repr(template))
        for length in (1, 4, 6):
            columns = drawn(template, length, chance_)
            truths: dict[str, list[Truth]] = {name: [*c] for name, c in columns.items()}
            assert of(template, truths) == naive(template, columns), (template, columns)


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_the_monitor_and_the_count_agree_on_every_run(scope: str) -> None:
    """The same triggers; a failure is a violation, and a satisfied run has answers only."""
    for template in tried(scope, 2):
        machine = monitor(template.sentence)
        chance_ = random.Random(f"monitor {template!r}")
        for length in (3, 9, 14):
            columns = drawn(template, length, chance_)
            truths: dict[str, list[Truth]] = {name: [*c] for name, c in columns.items()}
            trials_of_run = of(template, truths)
            ticks, packs = packed(truths)
            needed = {name: packs[name] for name in machine.PROPOSITIONS}
            (outcome,) = evaluate(machine, needed, ticks)
            where = (template, columns, trials_of_run, outcome)
            assert trials_of_run.count == len(outcome.triggers), where
            assert not trials_of_run.failed or outcome.verdict == "violated", where
            good = trials_of_run.count > 0 and not trials_of_run.failed and not trials_of_run.open
            assert good == (outcome.verdict == "satisfied"), where
            assert (trials_of_run.count == 0) == (outcome.verdict == "vacuous"), where


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_what_is_unknown_is_never_decided_against_what_it_may_be(scope: str) -> None:
    for template in tried(scope, 4):
        chance_ = random.Random(f"unknown {template!r}")
        columns = drawn(template, 6, chance_)
        gaps = [(chance_.choice(template.columns), chance_.randrange(6)) for _ in range(2)]
        truths: dict[str, list[Truth]] = {name: [*c] for name, c in columns.items()}
        for name, tick in gaps:
            truths[name][tick] = None
        trials_of_run = of(template, truths)
        for values in product((False, True), repeat=2):
            completed: dict[str, list[Truth]] = {name: [*c] for name, c in columns.items()}
            for (name, tick), value in zip(gaps, values, strict=True):
                completed[name][tick] = value
            really = of(template, completed)
            assert trials_of_run.answered <= really.answered, (template, truths)
            assert trials_of_run.failed <= really.failed, (template, truths)
            assert trials_of_run.count >= really.count, (template, truths)


# Any expressions, constants among them ----------------------------------------------------------

SHAPES: dict[str, Callable[[bool, bool], bool]] = {
    "true": lambda a, b: True,
    "false": lambda a, b: False,
    "{0}": lambda a, b: a,
    "!{0}": lambda a, b: not a,
    "({0} & true)": lambda a, b: a,
    "({0} & false)": lambda a, b: False,
    "({0} -> {1})": lambda a, b: not a or b,
    "({0} xor true)": lambda a, b: not a,
    "({0} | !{1})": lambda a, b: a or not b,
}
"""Each of two propositions of its own, and what it is of them."""


@dataclass(frozen=True)
class Filled:
    """A template with an expression in place of each of its propositions."""

    template: Template
    shapes: Mapping[str, str]

    @property
    def sentence(self) -> str:
        words = self.template.sentence.replace("shall", "shall with probability >= 0.9")
        for name, shape in self.shapes.items():
            words = re.sub(rf"\b{name}\b( mode)?", shape.format(f"{name}1", f"{name}2"), words)
        return re.sub(r"^(when not in|only in|in)\b", of_an_expression, words)

    @property
    def names(self) -> list[str]:
        """Of all the propositions that it may have."""
        return [f"{name}{i}" for name in self.shapes for i in (1, 2)]

    def naive(self, columns: Columns) -> Trials:
        """The naive count; constants stay what they are, however the run goes on."""
        always = {
            name: values.pop()
            for name, shape in self.shapes.items()
            for values in [{SHAPES[shape](a, b) for a in (False, True) for b in (False, True)}]
            if len(values) == 1
        }
        return naive(self.template, self.parts(columns), always)

    def parts(self, columns: Columns) -> Columns:
        """What the expressions are at each tick."""
        return {
            name: [
                SHAPES[shape](*values)
                for values in zip(columns[f"{name}1"], columns[f"{name}2"], strict=True)
            ]
            for name, shape in self.shapes.items()
        }


def of_an_expression(match: re.Match[str]) -> str:
    """A scope of an expression, for that of a mode."""
    return {"when not in": "except while", "only in": "only while", "in": "while"}[match[1]]


def fillings(chance_: random.Random) -> Iterator[Filled]:
    """Each template some times; half of all expressions are constants."""
    for template in templates((1,)):
        for _ in range(3):
            shapes = {
                name: chance_.choice(("true", "false") * 3 + tuple(SHAPES))
                for name in template.columns
            }
            yield Filled(template, shapes)


@pytest.mark.slow
def test_any_expressions_are_counted_as_their_meaning_says() -> None:
    chance_ = random.Random("expressions")
    for filled in some(fillings(chance_), 7):
        columns = {name: [chance_.random() < 0.5 for _ in range(5)] for name in filled.names}
        truths: dict[str, list[Truth]] = {"other": [None] * 5}
        truths |= {name: [*columns[name]] for name in requirement(filled.sentence).watched}
        assert counted(filled.sentence, truths) == filled.naive(columns), (filled.sentence, columns)


# Written out ----------------------------------------------------------------------------------

WITHIN = "whenever c the robot shall with probability >= 0.99 within 2 ticks satisfy r"


def bits(text: str) -> list[Truth]:
    return [{"1": True, "0": False, "?": None}[letter] for letter in text]


@pytest.mark.parametrize(
    ("c", "r", "expected"),
    [
        ("1000", "0100", Trials(1, 0, 0)),
        ("1000", "0001", Trials(0, 1, 0)),
        ("0010", "0000", Trials(0, 0, 1)),  # its deadline lies behind the end
        ("1110", "0010", Trials(3, 0, 0)),  # one answer for three triggers
        ("11000", "00010", Trials(1, 1, 0)),
        ("1000", "0?00", Trials(0, 0, 1)),
        ("1000", "0?10", Trials(1, 0, 0)),
        ("?000", "0000", Trials(0, 0, 1)),
        ("?000", "1000", Trials(0, 0, 1)),  # it may be no trigger at all
        ("0000", "0000", Trials(0, 0, 0)),
        ("????", "????", Trials(0, 0, 4)),
    ],
)
def test_a_deadline(c: str, r: str, expected: Trials) -> None:
    assert counted(WITHIN, {"c": bits(c), "r": bits(r)}) == expected


def test_an_edge_is_one_trigger() -> None:
    sentence = "when c the robot shall with probability > 0.5 immediately satisfy r"
    assert counted(sentence, {"c": bits("1101110"), "r": bits("1110111")}) == Trials(1, 1, 0)


def test_without_a_condition_each_interval_is_one() -> None:
    sentence = "in m mode the robot shall with probability > 0.5 eventually satisfy r"
    columns = {"m": bits("1100110011"), "r": bits("0100000000")}
    assert counted(sentence, columns) == Trials(1, 1, 1)


def test_what_only_forbids_is_met_when_the_run_ends() -> None:
    sentence = "the robot shall with probability > 0.5 always satisfy r"
    assert counted(sentence, {"r": bits("111")}) == Trials(1, 0, 0, met_by_end=1)
    assert counted(sentence, {"r": bits("110")}) == Trials(0, 1, 0)
    assert counted(sentence, {"r": bits("1?1")}) == Trials(0, 0, 1)


def test_a_bound_of_a_thousand_million_ticks_costs_no_more_than_the_run() -> None:
    sentence = "whenever c the sw shall with probability >= 0.9 within 1000000000 ticks satisfy r"
    assert counted(sentence, {"c": bits("101"), "r": bits("010")}) == Trials(1, 0, 1)


def test_an_empty_run_has_none() -> None:
    odds = chance(requirement(WITHIN))
    assert odds is not None
    _, columns = columns_of([], 2)
    assert trials(odds.obligation, dict(zip("cr", columns, strict=True)), 0) == Trials(0, 0, 0)


def test_a_cut_tick_undoes_what_was_only_kept() -> None:
    shorter = Trials(3, 1, 0, met_by_end=2)
    assert shorter.before(Trials(1, 3, 0)) == Trials(1, 1, 2)
    assert shorter.before(Trials(3, 1, 1)) == shorter
    assert Trials(3, 0, 0).before(Trials(3, 1, 0)) == Trials(3, 0, 1)


# The monitor ----------------------------------------------------------------------------------


@pytest.mark.slow
def test_the_text_is_the_monitor_of_the_sentence_without_its_probability_and_says_so() -> None:
    with_, without = (
        text(requirement(WITHIN)),
        text(requirement(WITHIN.replace("with probability >= 0.99 ", ""))),
    )
    more = [line for line in with_.splitlines() if line not in without.splitlines()]
    assert more == [
        "# R1 is here without its probability, >= 0.99: one run does not tell it; SHA-256 with it: "
        f"{requirement(WITHIN).fingerprint}"
    ]
    assert with_.replace(f"{more[0]}\n", "") == without


def test_a_rule_without_a_probability_stays_itself() -> None:
    own = requirement("whenever c the robot shall satisfy r")
    assert without_probability(own) is own
    assert chance(own) is None
