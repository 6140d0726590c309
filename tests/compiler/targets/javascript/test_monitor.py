"""Monitors in JavaScript say what those in Python say, tick by tick."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.past import MonitorSpec
from compiler.logic import formula as f
from compiler.targets.javascript import monitor as target
from compiler.targets.python.monitor import text as in_python
from monitors.kernel import Monitor
from monitors.kernel.stepping import RequirementStatus
from monitors.kernel.verdicts import Signals, Truth, truth
from monitors.loading import load
from tests.compiler.targets.c.test_c_monitor import in_files
from tests.effort import FULL, some
from tests.emitting import PROBABLE, SHARING, refused
from tests.meaning import SCOPES
from tests.monitoring import requirement
from tests.node import Row, needs_node, outcomes, run
from tests.strategies import templates

pytestmark = needs_node
Word = list[list[Truth]]
SIGNALS = {
    "trigger": "trigger",
    "violation": "violation",
    "violation_inevitable": "violationInevitable",
    "obligation_pending": "obligationPending",
    "violated_if_ended": "violatedIfEnded",
    "satisfied_forever": "satisfiedForever",
    "answer": "answer",
}
"""The name of each of `Signals` in JavaScript."""
MANY = 400 if FULL else 40
WINDOWS = (
    "only in p mode the sw shall after {n} ticks satisfy q",
    "only after p mode whenever q the sw shall after {n} ticks satisfy !p",
    "whenever occurred(2, {n} + 2, p) the sw shall immediately satisfy q",
    "whenever persisted({n}, p) the sw shall within 2 ticks satisfy q",
)


def drawn(choose: random.Random, names: Sequence[str], length: int) -> Word:
    """Values that stay a while, and few unknowns."""
    unknown, change = choose.choice([0, 0, 0.1]), choose.choice([0.2, 0.5])
    row: list[Truth] = [choose.random() < 0.5 for _ in names]
    word = []
    for _ in range(length):
        row = [choose.random() < 0.5 if choose.random() < change else value for value in row]
        word.append([None if choose.random() < unknown else value for value in row])
    return word


def told_by_python(machine: Monitor, word: Word) -> Iterator[list[dict[str, Any]]]:
    machine.reset()
    for row in word:
        machine.advance([tuple(row)])
        parts = (
            machine.verdicts(),
            machine.statuses(),
            machine.certain.signals(),
            machine.possible.signals(),
        )
        yield [expected(*each) for each in zip(*parts, strict=True)]


def expected(
    verdict: str, status: RequirementStatus, certain: Signals[bool], possible: Signals[bool]
) -> dict[str, Any]:
    both = {name: truth(*pair) for name, *pair in zip(SIGNALS, certain, possible, strict=True)}
    return {
        "verdict": verdict,
        "atEnd": status.verdict,
        "finite": status.finite,
        "trigger": both["trigger"],
        "violation": both["violation"],
        "obligationPending": status.obligation_pending,
        "firstViolation": status.first_violation,
        "open": status.open,
        "deadline": status.deadline,
        "certain": {SIGNALS[name]: value for name, value in certain._asdict().items()},
        "possible": {SIGNALS[name]: value for name, value in possible._asdict().items()},
    }


def agree(folder: Path, sentences: Sequence[tuple[str, ...]], words: int, length: int) -> None:
    """Each group of sentences is one monitor; both languages judge the same words."""
    requirements = [
        [requirement(s, f"R{i}") for i, s in enumerate(group, 1)] for group in sentences
    ]
    alike(folder, requirements, words, length)


def alike(
    folder: Path, requirements: Sequence[Sequence[FormalizedRequirement]], words: int, length: int
) -> None:
    choose = random.Random(f"{[each.id for group in requirements for each in group]}")
    machines = [load("monitor.py", in_python(*each)) for each in requirements]
    judged = [
        (place, drawn(choose, tuple(machine.PROPOSITIONS), length))
        for place, machine in enumerate(machines)
        for _ in range(words)
    ]
    texts = [target.text(*each) for each in requirements]
    for (place, word), told in zip(judged, outcomes(folder, texts, judged, "judge"), strict=True):
        for tick, row in enumerate(told_by_python(machines[place], word)):
            assert list(map(reduced, told[tick])) == row, (requirements[place], word[: tick + 1])


def reduced(outcome: Mapping[str, Any]) -> dict[str, Any]:
    """Without the marks of the approximations, of which Python tells some only."""
    approximations = {
        approximation: {name: outcome[approximation][name] for name in SIGNALS.values()}
        for approximation in ("certain", "possible")
    }
    return {**outcome, **approximations}


@pytest.mark.slow
def test_every_template(tmp_path: Path) -> None:
    """Several are one monitor, which computes once what they share."""
    groups = [*map(tuple, in_files((0, 1, 2, 3)))]
    assert not FULL or [*map(len, groups)] == [63] * len(SCOPES)
    agree(tmp_path, groups, words=20, length=12)


@pytest.mark.slow
def test_templates_alone_and_sentences_with_large_bounds(tmp_path: Path) -> None:
    choose = random.Random("alone")
    sentences = [each.sentence for each in choose.sample([*templates()], MANY // 4)]
    for text in (*SHARING, *WINDOWS):
        sentences.extend(text.format(n=n) for n in (0, 7, 100, 10**9))
    agree(tmp_path, [(each,) for each in choose.sample(sentences, MANY)], words=1, length=150)


@pytest.mark.slow
def test_every_bound_of_a_window(tmp_path: Path) -> None:
    a, b, no = f.Atom("a"), f.Atom("b"), f.FALSE
    every = [f.Interval(lo, hi) for lo in range(4) for hi in range(lo, 8)]
    bounds = some(every, 3)
    formulas = [
        made
        for each in bounds
        for made in (f.Since(a, b, each), f.Once(b, each), f.Historically(f.Not(a), each))
    ]
    plain = requirement("the sw shall satisfy q")
    requirements = [
        replace(
            plain,
            entry=replace(plain.entry, id=f"R{place}"),
            watch=MonitorSpec(each, no, no, no, no, no, f.Not(each), None, renewed=False),
        )
        for place, each in enumerate(formulas)
    ]
    alike(tmp_path, [requirements], words=6, length=80)


@pytest.mark.slow
def test_no_name_clashes_with_another(tmp_path: Path) -> None:
    names = (
        "tick",
        "approximation",
        "truths",
        "mark",
        "first",
        "class",
        "await",
        "is_p",
        "p",
        "not_p",
    )
    odd = ("a.b", "two words", "__proto__", "constructor", "a</script>b", "a\u2028b", "since_1")
    quoted = [f'"{name}"' for name in (*names, *odd)]
    wanted = [f"whenever {p} the sw shall within 1 ticks satisfy {q}" for p, q in pairs(quoted)]
    agree(tmp_path, [tuple(wanted)], words=3, length=12)


def pairs(names: Sequence[str]) -> Iterator[tuple[str, str]]:
    return zip(names, (*names[1:], names[0]), strict=True)


# Values ---------------------------------------------------------------------------------------

BATTERY = "whenever battery < 20 the agv shall within 1 ticks satisfy docking"


def test_values_come_in_their_order_or_by_name(tmp_path: Path) -> None:
    by_name: list[Row] = [{"docking": False, "battery": 19.9}, {"battery": 20, "docking": False}]
    in_order: list[Row] = [[19.9, False], [20, False]]
    one, other = outcomes(
        tmp_path, [target.text(requirement(BATTERY))], [(0, by_name), (0, in_order)]
    )
    assert one == other
    assert [(row["verdict"], row["open"], row["deadline"]) for (row,) in one] == [
        ("pending", 0, 1),
        ("violated", 0, 1),
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("row", "message"),
    [
        ('["19", true]', "`battery` is a number, or null or NaN (unknown), not 19"),
        ("[true, true]", "`battery` is a number, or null or NaN (unknown), not true"),
        ("[1, 1]", "`docking` is true, false or null (unknown), not 1"),
        ("{ battery: 1 }", "`docking` is true, false or null (unknown), not undefined"),
        ("[1]", "1 values for 2 names"),
    ],
)
def test_a_value_of_another_kind_is_refused_and_changes_nothing(
    tmp_path: Path, row: str, message: str
) -> None:
    path = tmp_path / "m.mjs"
    path.write_text(target.text(requirement(BATTERY)), encoding="utf-8")
    script = f"""
import {{ init, step }} from {path.as_uri()!r};
const state = init(), before = JSON.stringify(state);
try {{ step(state, {row}); }} catch (error) {{ console.log(error.message); }}
console.log(JSON.stringify(state) === before);
"""
    assert run(script) == f"{message}\ntrue\n"


def test_a_state_is_plain_and_can_be_copied(tmp_path: Path) -> None:
    path = tmp_path / "m.mjs"
    path.write_text(target.text(requirement(WINDOWS[0].format(n=3))), encoding="utf-8")
    script = f"""
import {{ init, step }} from {path.as_uri()!r};
const state = init(), rows = [[true, false], [false, null], [true, true], [false, false]];
let copy = init();
const told = (state, row) => JSON.stringify(step(state, row));
for (const row of [...rows, ...rows, ...rows]) {{
  const next = structuredClone(copy);
  if (told(state, row) !== told(next, row)) throw new Error("differs");
  copy = next;
}}
"""
    assert run(script) == ""


def test_what_python_refuses_is_refused() -> None:
    assert "one run does not show a probability" in refused("js", PROBABLE)
    deep = "(p & (q | " * 40 + "p" + "))" * 40
    refusal = refused("js", f"the sw shall always satisfy {deep}")
    assert "JavaScript cannot express more than 60 nested operators" in refusal
