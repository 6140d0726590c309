"""Generated monitors in tests: made from sentences, stepped, and read at each tick."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from textwrap import indent
from typing import NamedTuple

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.past import MonitorSpec
from compiler.logic import formula as f
from compiler.targets.python import monitor as target
from fretc.verification.monitor.statements import below_docstring
from fretc.verification.monitor.tick_layout import inlined
from fretish.bindings.declarations import Declarations
from fretish.clock import Clock
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from monitors.kernel import INCONCLUSIVE, Column, Monitor, Outcome, evaluate
from monitors.kernel.columns import columns_of, pieces_of
from monitors.kernel.verdicts import Truth, Verdict, truth
from monitors.loading import load


class Step(NamedTuple):
    """What a monitor tells after one tick."""

    tick: int
    decided: str
    """Whatever follows: satisfied, violated, or pending."""
    verdict: str
    """If the trace ended here."""
    finite: Truth
    first_violation: int | None
    trigger: Truth
    violation: Truth
    violation_inevitable: Truth
    obligation_pending: Truth
    violated_if_ended: Truth
    satisfied_forever: Truth
    answer: Truth


@lru_cache(maxsize=4096)
def requirement(sentence: str, id: str = "R1", clock: Clock | None = None) -> FormalizedRequirement:
    """The requirement of a sentence; tests that ask for the same one share it."""
    source = Source("r.fret", sentence)
    declared = Declarations(Source("bindings.toml", ""), clock, {}, {}) if clock else None
    result, diagnostics = formalize(RequirementEntry(id, source.span()), declared)
    assert result is not None, diagnostics
    return result


@lru_cache(maxsize=512)
def emitted(*sentences: str, clock: Clock | None = None) -> str:
    """The text of one monitor for all of them; they are called R1, R2, ..."""
    requirements = [
        requirement(sentence, f"R{i}", clock) for i, sentence in enumerate(sentences, 1)
    ]
    return target.text(*requirements)


def monitor(*sentences: str) -> Monitor:
    """A new monitor of the class that their text makes."""
    return _kind(*sentences)()


@lru_cache(maxsize=512)
def _kind(*sentences: str) -> type[Monitor]:
    return type(load("monitor.py", emitted(*sentences)))


def steps(machine: Monitor, columns: Mapping[str, Sequence[Truth]], place: int = 0) -> list[Step]:
    """Step over columns by name; what is reported the requirement at that place."""
    machine.reset()
    names = tuple(machine.PROPOSITIONS)
    length = len(next(iter(columns.values())))
    found = []
    for tick in range(length):
        machine.advance([tuple(columns[name][tick] for name in names)])
        assert machine.tick == tick
        found.append(step(machine, place))
    return found


def step(machine: Monitor, place: int = 0) -> Step:
    """What it tells now."""
    status = machine.statuses()[place]
    signals = zip(machine.certain.signals()[place], machine.possible.signals()[place], strict=True)
    return Step(
        machine.tick,
        machine.verdicts()[place],
        status.verdict,
        status.finite,
        status.first_violation,
        *[truth(certain, possible) for certain, possible in signals],
    )


def packed(columns: Mapping[str, Sequence[Truth]]) -> tuple[int, dict[str, Column]]:
    """The length of the columns, and each as integers."""
    ticks, made = columns_of(pieces_of(zip(*columns.values(), strict=True)), len(columns))
    return ticks, dict(zip(columns, made, strict=True))


def over(
    machine: Monitor, columns: Mapping[str, Sequence[Truth]], end: Verdict = INCONCLUSIVE
) -> Outcome:
    """The column program over a whole trace, for a monitor of one requirement."""
    ticks, made = packed(columns)
    (outcome,) = evaluate(machine, made, ticks, end)
    return outcome


OWN = "# The requirements ---"
"""Where the code of the requirements begins."""
_TICK = re.compile(
    r"( +)approximation\.tick = tick = approximation\.tick \+ 1\n"
    r"(?:.*\n)*?(?= +if approximation\.\w+_broken >)"
)


def without_step(text: str) -> str:
    """A monitor's text; of the tick in its step the first line is left."""
    place = text.index(OWN)
    return text[:place] + _TICK.sub(
        r"\1approximation.tick = tick = approximation.tick + 1\n", text[place:]
    )


def with_step(text: str) -> str:
    """The text with the tick of its `advance` in its step, too, if it has it in there."""
    place = text.index(OWN)
    head, own = text[:place], text[place:]
    try:
        functions = [n for n in ast.walk(ast.parse(own)) if isinstance(n, ast.FunctionDef)]
        (advance,) = (node for node in functions if node.name == "advance")
        tick = inlined(below_docstring(advance))
    except (SyntaxError, ValueError, StopIteration, AssertionError):
        return text
    return head + _TICK.sub(lambda match: indent(tick, match[1]) + "\n", own)


def of_formula(formula: f.Formula) -> Monitor:
    """A monitor whose trigger is a past-time formula and whose answer is its negation."""
    no = f.FALSE
    watch = MonitorSpec(formula, no, no, no, no, no, f.Not(formula), None, renewed=False)
    return load(
        "monitor.py", target.text(replace(requirement("the sw shall satisfy q"), watch=watch))
    )
