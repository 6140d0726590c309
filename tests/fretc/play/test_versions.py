"""Two versions of requirements: what tells them apart, and what became of each."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.folder import load
from compiler.targets.python.monitor import text
from fretc.play import versions as comparing
from fretc.play.versions import Side, Versions, side_by_side, versions
from fretc.testing.runs import Absence, DistinguishingRun, difference
from fretish.diagnostics.diagnostic import has_errors
from monitors.loading import load as monitor
from tests.monitoring import requirement
from tests.strategies import Template, templates

SECONDS = 60.0


def ends(template: Template, rows: list[dict[str, bool]]) -> bool:
    """FRET's verdict on a finite run, from the definition."""
    return template.satisfied({name: [row[name] for row in rows] for name in rows[0]})


def words(length: int) -> Iterator[list[dict[str, bool]]]:
    for values in product(product((False, True), repeat=4), repeat=length):
        yield [dict(zip("mpqs", row, strict=True)) for row in values]


@pytest.mark.slow
def test_a_shortest_run_tells_two_sentences_apart_or_none_does() -> None:
    """By the definition: the run does, and no shorter one; where there is none, no short one."""
    choose = random.Random(3)
    every = [*templates((0, 1, 2))]
    fates = set()
    for _ in range(80):
        one = choose.choice(every)
        like = [e for e in every if (e.scope, e.condition) == (one.scope, one.condition)]
        other = choose.choice([each for each in like if each != one])
        found = difference(requirement(one.sentence), requirement(other.sentence, "R2"), SECONDS)
        assert not isinstance(found, Absence) or not found.why
        fates.add(type(found))
        length = 2 if isinstance(found, Absence) else min(2, found.word.ticks - 1)
        for shorter in range(1, length + 1):
            for rows in words(shorter):
                assert ends(one, rows) is ends(other, rows), (one, other, rows)
        if isinstance(found, DistinguishingRun):
            blank = dict.fromkeys("mpqs", False)
            rows = [
                blank | {n: bool(v) for n, v in each.values.items()}
                for each in found.word.rows
                for _ in range(each.count)
            ]
            assert ends(one, rows) is not ends(other, rows), (one, other, rows)
    assert fates == {Absence, DistinguishingRun}


def named(sentence: str, id: str) -> FormalizedRequirement:
    found = requirement(sentence)
    return replace(found, entry=replace(found.entry, id=id))


WITHIN = "whenever near the robot shall within {} ticks satisfy stopped"
SAME = "the robot shall always satisfy !(near & stopped)"
AGAIN = "the robot shall never satisfy near & stopped"


def of(new: dict[str, str], old: dict[str, str]) -> Versions:
    now, then = (
        Side([named(text, id) for id, text in some.items()], {}, None) for some in (new, old)
    )
    return versions(now, then, SECONDS)


def test_what_became_of_each_requirement() -> None:
    new = {"A": WITHIN.format(2), "B": SAME, "C": SAME, "D": SAME}
    old = {"A": WITHIN.format(3), "B": AGAIN, "C": SAME, "E": SAME}
    found = of(new, old)
    assert [pair.note for pair in found.pairs] == [
        "A: a shortest trace that distinguishes the two versions has 3 ticks",
        "B: reworded; proved: both versions have the same verdict on every finite run without "
        "unknown values",
    ]
    assert found.notes == ("C: unchanged", "D: new", "E: gone")
    assert [pair.start is None for pair in found.pairs] == [False, True]
    beside = side_by_side(found, [named(text, id) for id, text in new.items()])
    assert [each.id for each in beside] == ["A", "A before", "B", "B before", "C", "D"]


def test_only_ones_are_held_against_each_other_whatever_their_ids_are() -> None:
    (pair,) = of({"A": WITHIN.format(2)}, {"B": WITHIN.format(3)}).pairs
    assert (pair.new.id, pair.old.id) == ("A", "A before")


ROUNDED = "the robot shall always satisfy 0.1 + x > 0.3", "the robot shall always satisfy x > 0.2"


def test_a_proof_about_numbers_says_that_floats_round() -> None:
    """At `x = 0.2` a monitor says that the one is kept and the other is not."""
    new, old = (named(each, "A") for each in ROUNDED)
    finite = []
    for each in (new, old):
        machine: Any = monitor("m.py", text(each))
        machine.take([(0.2,)])
        finite.append(machine.statuses()[0].finite)
    assert finite == [True, False]
    (pair,) = versions(Side([new], {}, None), Side([old], {}, None), SECONDS).pairs
    assert pair.note.endswith("; the proof assumes exact numbers, without the rounding of floats")


def test_an_id_that_is_taken_gets_a_mark() -> None:
    new = {"A": WITHIN.format(2), "A before": SAME}
    found = of(new, {"A": WITHIN.format(3), "A before": SAME})
    assert [pair.old.id for pair in found.pairs] == ["A before'"]


def test_a_trace_that_no_page_takes_is_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(comparing, "MOST", 20)
    (pair,) = of({"A": WITHIN.format(25)}, {"A": WITHIN.format(26)}).pairs
    assert pair.start is None
    assert pair.note.endswith("has 26 ticks, and this page shows at most 20")


BINDINGS = """
[clock]
tick = "{tick}"
[signal.d]
path = "/scan.range"
unit = "{unit}"
[proposition.near]
expr = "d < {near} m"
[proposition.stopped]
expr = "d > 2 m"
"""
NOT_COMPARED: dict[str, tuple[str, str, dict[str, str], str]] = {
    "the clock": (
        WITHIN.format(2),
        WITHIN.format(2),
        {"tick": "200 ms"},
        "the clock has changed",
    ),
    "a proposition": (
        WITHIN.format(2),
        WITHIN.format(2),
        {"near": "3"},
        "`near` has another meaning",
    ),
    "a proof about another proposition": (SAME, AGAIN, {"near": "3"}, "`near` has another meaning"),
    "the unit of a signal": (
        "the robot shall always satisfy d < 5",
        "the robot shall never satisfy d >= 5",
        {"unit": "km"},
        "`d` has another meaning",
    ),
}


@pytest.mark.parametrize("name", NOT_COMPARED)
def test_what_reads_other_bindings_is_neither_the_same_nor_proved(
    name: str, tmp_path: Path
) -> None:
    new, old, changes, why = NOT_COMPARED[name]
    sides = []
    for folder, sentence, other in (("new", new, {}), ("old", old, changes)):
        place = tmp_path / folder
        place.mkdir()
        (place / "r.fret").write_text(sentence)
        values = {"tick": "100 ms", "unit": "m", "near": "1"} | other
        (place / "bindings.toml").write_text(BINDINGS.format(**values))
        project = load([str(place / "r.fret")])
        assert not has_errors(project.diagnostics), project.diagnostics
        sides.append(Side(project.formalized, {}, project.declarations))
    found = versions(sides[0], sides[1], SECONDS)
    assert found.pairs == ()
    (note,) = found.notes
    assert why in note
    assert note.endswith("its versions are not compared")
    again = versions(sides[0], sides[0], SECONDS)
    assert again.notes == ("r: unchanged",)


def test_what_no_monitor_can_be_made_of_is_neither_new_nor_gone() -> None:
    requirements = [named(SAME, "A")]
    found = versions(
        Side(requirements, {"B": "why"}, None), Side([], {"A": "that", "B": "why"}, None), 1
    )
    assert found.notes == (
        "A: no monitor can be generated from the earlier version: that",
        "B: no monitor can be generated from the earlier version: why",
    )
