"""Sentences parsed and formalized per second of CPU; what long durations and deep ones cost."""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from compiler.formalization.formalize import formalize
from compiler.formalization.record import formulas
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry

DATA = Path(__file__).parent.parent / "tests/data"
LIMIT = 2.0
"""Seconds of CPU that 1 000 mixed sentences may take on one core, after import."""


def mixed(count: int) -> list[str]:
    """Sentences of FRET's tables: all scopes, conditions, timings, wordings and case studies."""
    found = [
        row["fretish"]
        for name in ("templates", "surface_forms", "case_studies")
        for row in json.loads((DATA / f"fret_{name}.json").read_text("utf-8"))
        if row.get("accepted", True) and "flags" not in row
    ]
    return (found * (count // len(found) + 1))[:count]


def work(sentence: str) -> None:
    """From text to the printed formulas."""
    requirement, _ = formalize(RequirementEntry("b", Source("b.fret", sentence).span()), None)
    assert requirement is not None, sentence
    formulas(requirement)


def work_all(sentences: Sequence[str]) -> None:
    """Each of them."""
    for sentence in sentences:
        work(sentence)


def seconds(function: Callable[[], None], runs: int = 5) -> float:
    """Median CPU time."""
    times = []
    for _ in range(runs):
        start = time.process_time()
        function()
        times.append(time.process_time() - start)
    return statistics.median(times)


def nested(template: str, levels: int) -> str:
    """A sentence with the template within itself."""
    text = "p"
    for _ in range(levels):
        text = template.format(text)
    return f"whenever p the sw shall within 3 ticks satisfy {text}"


SIZED: Mapping[str, Callable[[int], str]] = {
    "`&` and `|` within each other": lambda size: nested("q & (r | {})", size // 2),
    "`xor` within each other": lambda size: nested("({}) xor q", size),
    "predicates within each other": lambda size: nested("preBool(false, {})", size),
    "disjunctions beside each other": lambda size: nested(
        " & ".join(f"(p{i} | ! q{i})" for i in range(size)), 1
    ),
}
"""Expressions with so many operators within, or beside, each other."""


def main() -> None:
    """Print the table."""
    sentences = mixed(1_000)
    work(sentences[0])  # the grammar is compiled once
    spent = seconds(lambda: work_all(sentences))
    print(f"1 000 mixed sentences: {spent:.2f} s of CPU, {spent / LIMIT:.2f} of the limit")
    template = "in m mode, upon p the sw shall within {} ticks satisfy q"
    short = seconds(lambda: work_all([template.format(3)] * 300))
    long = seconds(lambda: work_all([template.format(10**6)] * 300))
    print(f"a duration of 10^6 against one of 3: {long / short:.2f} of the time")
    for name, sized in SIZED.items():
        half, whole = (seconds(partial(work, sized(size))) for size in (500, 1_000))
        print(f"{name}, 1 000 against 500: {whole * 1e3:.0f} ms, {whole / half:.2f} of the time")


if __name__ == "__main__":
    main()
