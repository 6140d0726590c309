"""Chains of gestures: the page holds the trace that they make, and judges it as monitors do."""

from __future__ import annotations

import random
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest

from compiler.project.folder import load as project_of
from compiler.targets.python.monitor import text as monitor_text
from fretc.play.page import html
from fretish.diagnostics.diagnostic import has_errors
from monitors.loading import load
from tests.effort import FULL
from tests.monitoring import requirement
from tests.play_pages import Open, everything, expected_to, told

if TYPE_CHECKING:
    from pathlib import Path

    from tests.browsing import Visits

pytestmark = pytest.mark.slow
SENTENCES = (
    "whenever near the robot shall within 2 ticks satisfy stopped",
    "upon stopped the robot shall for 3 ticks satisfy !near",
    "before stopped the robot shall eventually satisfy near",
)
Column = list[bool | None]
WORDS: dict[bool | None, str] = {True: "true", False: "false", None: "unknown"}


@dataclass
class Model:
    """What the page has to hold: written from its description, with no line of its script."""

    rows: list[Column] = field(default_factory=lambda: [[False] * 12, [False] * 12])
    lane: int = 0
    at: int = 0
    past: list[list[Column]] = field(default_factory=list)
    future: list[list[Column]] = field(default_factory=list)

    def press(self, key: str, lanes: int) -> None:
        before = [[*row] for row in self.rows]
        row = self.rows[self.lane] if self.lane < 2 else None
        last = len(self.rows[0]) - 1
        match key.removeprefix("Shift+"):
            case "Control+z" | "Control+y":
                source, other = self.past, self.future
                if key == "Control+y":
                    source, other = other, source
                if source:
                    other.append(self.rows)
                    self.rows = source.pop()
                    self.at = min(self.at, len(self.rows[0]) - 1)
                return
            case "ArrowUp" | "ArrowDown":
                self.lane = min(lanes - 1, max(0, self.lane + (1 if key == "ArrowDown" else -1)))
            case "ArrowLeft" | "ArrowRight" | "Home" | "End" as arrow:
                moves = {"Home": 0, "End": last, "ArrowLeft": self.at - 1}
                to = min(last, max(0, moves.get(arrow, self.at + 1)))
                if key.startswith("Shift+") and row is not None:
                    first, end = sorted((self.at, to))
                    row[first : end + 1] = [row[self.at]] * (end + 1 - first)
                    if to != self.at:  # an undo of its own, even where all values were equal
                        self.past.append(before)
                        self.future.clear()
                self.at = to
                return
            case "i" | "r":
                for each in self.rows:
                    each.insert(self.at, each[self.at])
                self.at += key == "r"
            case "Delete" if last:
                for each in self.rows:
                    del each[self.at]
                self.at = min(self.at, last - 1)
            case "Space" if row is not None:
                row[self.at] = row[self.at] is not True
            case "0" | "1" | "u" if row is not None:
                row[self.at] = {"0": False, "1": True}.get(key)
        if self.rows != before:
            self.past.append(before)
            self.future.clear()

    def said(self) -> dict[str, list[str]]:
        """The lanes of the variables, and the first one of each requirement."""
        found = {
            name: [WORDS[v] for v in row]
            for name, row in zip(("near", "stopped"), self.rows, strict=True)
        }
        for number, sentence in enumerate(SENTENCES, 1):
            machine: Any = load("m.py", monitor_text(requirement(sentence)))
            ends = found[f"R{number} if the run ended here"] = []
            for row in zip(*self.rows, strict=True):
                values = dict(zip(("near", "stopped"), row, strict=True))
                machine.advance([tuple(values[name] for name in machine.PROPOSITIONS)])
                ends.append(str(machine.statuses()[0].verdict))
        return found


KEYS = (
    *("ArrowLeft", "ArrowRight", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "End", "i", "r"),
    *("Shift+ArrowLeft", "Shift+ArrowRight", "Shift+Home", "Shift+End", "Delete", "Delete"),
    *("Space", "Space", "0", "1", "1", "u", "Control+z", "Control+z", "Control+y"),
)


@pytest.mark.parametrize("seed", range(8 if FULL else 1))
def test_a_chain_of_gestures_leaves_the_trace_that_they_say(opened: Open, seed: int) -> None:
    page = opened(*SENTENCES)
    choose, model = random.Random(seed), Model()
    lanes = len(everything(page))
    page.locator("#grid td").first.focus()
    for step in range(150):
        key = choose.choice(KEYS)
        page.keyboard.press(key)
        model.press(key, lanes)
        if step % 10 == 9:
            found, expected = everything(page), model.said()
            assert {name: found[name] for name in expected} == expected, (step, key)
            focused = page.evaluate("document.activeElement.dataset")
            assert (int(focused["row"]), int(focused["t"])) == (model.lane, model.at), (step, key)


ODD = ["u", "</script><script>document.title = 1</script>", "a*3", "?", " x", "x", "a_b", "é%", "1"]


def test_odd_words_stay_what_they_are(visits: Visits, tmp_path: Path) -> None:
    """In the address, in a table, and where they are chosen; names of prototypes are names."""
    (tmp_path / "bindings.toml").write_text(
        '[clock]\ntick = "1 s"\n'
        '[signal.mode]\npath = "/m.data"\ntype = "std_msgs/String"\nvalues = '
        + str(ODD).replace("'", '"')
        + '\n[signal.constructor]\npath = "/c.data"\nunit = "1"\n',
        encoding="utf-8",
    )
    (tmp_path / "r.fret").write_text(
        "whenever mode = u & constructor < 3 the robot shall always satisfy toString"
    )
    project = project_of([str(tmp_path / "r.fret")])
    assert not has_errors(project.diagnostics), project.diagnostics
    path = tmp_path / "p.html"
    path.write_text(html(project.formalized, [], []), encoding="utf-8")
    page = visits.open(path, address=f"#ticks={len(ODD)}")
    assert page.title() == "Play: r"
    page.locator("#grid td").first.focus()
    for tick in range(len(ODD)):
        page.locator("#grid tbody tr").first.locator("td").nth(tick).click()
        page.locator("#value select").select_option(index=tick + 1)
    assert told(page, "mode") == ODD
    expected_to(page).to_have_url(re.compile("at=8.*mode"))
    other = visits.again(page)
    assert everything(other) == everything(page)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save CSV").click()
    shown = everything(page)
    page.get_by_role("button", name="Clear").click()
    page.locator("#load").set_input_files(download.value.path())
    expected_to(page.locator("#status")).to_contain_text("9 ticks")
    assert everything(page) == shown
