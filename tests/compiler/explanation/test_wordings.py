"""What people read has the numbers and units of the sentence, not what formulas compute with."""

from __future__ import annotations

import json
import re
from html import unescape
from pathlib import Path

import pytest

from compiler.explanation.diagram import diagram
from compiler.explanation.drawing import svg
from compiler.explanation.explain import explanation, text
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.folder import load
from fretc.play.page import html
from fretish.units import NAMES, base_name, unit
from tests.command import Fretc, write
from tests.each import each
from tests.effort import some
from tests.monitoring import requirement as plain

UNITS = (*(name for name in NAMES if name != "1"), "m/s^2", "km/h", "deg/s", "cm/s")
NUMBERS = ("3.0", "0.50", "30", "1.5e-3")


def requirement(name: str, digits: str) -> FormalizedRequirement:
    """A sentence with a number in a unit, of a signal in another one of the kind."""
    found = unit(name)
    assert found is not None
    own = base_name(found.dimension)
    declared = "km" if own == "m" else "ms" if own == "s" else own
    write(
        "requirements/bindings.toml",
        '[clock]\ntick = "100 ms"\n[signal.x]\npath = "/x.data"\n'
        f'unit = "{declared or 1}"\nrole = "input"\n'
        '[signal.y]\npath = "/y.data"\nrole = "output"\n',
    )
    sentence = (
        f"while x < {digits} {name}, whenever x >= {digits} {name} the rover shall "
        f"until x != {digits} {name} satisfy y > 2.50 | !(x <= {digits} {name})"
    )
    write("requirements/r.fret", f'+++\nid = "R1"\n+++\n{sentence}\n')
    (one,) = load(["requirements/r.fret"], "requirements/bindings.toml").formalized
    return one


def check(shown: str, name: str, digits: str) -> None:
    """Every comparison with x is one of the sentence; one that is cut has no other number."""
    assert re.search(r"\d / \d", shown) is None, shown
    found = re.findall(r"x (?:<=|>=|!=|<|>|=) ([0-9][^&|`:<)\"\n\u2026]*)(\u2026?)", shown)
    assert found
    for number, cut in found:
        whole = f"{digits} {name}"
        assert whole.startswith(number.strip()) if cut else number.strip() == whole, shown


@pytest.mark.slow
@each("name", some(UNITS, 3))
def test_explanations_pictures_and_pages_use_the_numbers_of_the_sentence(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    digits = NUMBERS[UNITS.index(name) % len(NUMBERS)]
    one = requirement(name, digits)
    check(text(explanation(one)).partition("one run, drawn")[2], name, digits)
    check(unescape(svg(diagram(one))), name, digits)
    found = re.findall(r'"(?:label|response)":("[^"]*")', html([one], (), ()))
    labels = [json.loads(label) for label in found]
    check("\n".join(labels), name, digits)
    assert "y > 2.50" in labels


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "digits"), some([("km/h", "3.0"), ("deg", "30"), ("min", "0.50")], 3)
)
def test_tests_are_shown_with_the_numbers_of_the_sentence(
    fretc: Fretc, name: str, digits: str
) -> None:
    requirement(name, digits)
    run = fretc("test", "--show", "R1")
    shown = run.out.partition("\n\n")[2]
    check("\n".join(line for line in shown.splitlines() if "(x" in line), name, digits)


def test_only_what_is_written_otherwise_has_other_words(tmp_path: Path) -> None:
    one = plain("while m, whenever x < 3.0 the sw shall satisfy f(x, 2) | persisted(2, q)")
    assert one.wordings == {}
