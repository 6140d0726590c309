"""The page as a browser shows it: its verdicts, a person's gestures, and that it stays alone."""

from __future__ import annotations

import io
import random
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from compiler.formalization.reference import (
    BROKEN,
    Automaton,
    accepts,
    explore,
    template,
    tick_role,
)
from compiler.targets.python.monitor import text as monitor_text
from fretc.play.starts import Start, Ticks, of_suite
from fretc.testing.exports.files import SuiteFormat, files
from fretc.testing.reader import read
from fretc.testing.suite import Suite
from monitors.kernel.tables import placed_rows
from monitors.loading import load
from tests.browsing import Visits, serious
from tests.effort import some
from tests.meaning import SCOPES
from tests.monitoring import requirement
from tests.play_pages import HOSTILE, Open, address, everything, expected_to, lane, told
from tests.strategies import templates

if TYPE_CHECKING:
    from playwright.sync_api import FilePayload, Locator

pytestmark = pytest.mark.slow
WITHIN = "whenever near the robot shall within 2 ticks satisfy stopped"
BATTERY = "whenever battery < 20 the agv shall within 1 ticks satisfy docking | speed <= 0.5"


# Verdicts -------------------------------------------------------------------------------------


def judged(automaton: Automaton, rows: Sequence[Mapping[str, bool]]) -> Iterator[tuple[str, str]]:
    """The verdict whatever follows, and a verdict where the run ends, of the counter automaton."""
    state, broken, triggered = 0, False, False
    for row in rows:
        letter = tuple(row.get(name, True) for name in "mpqs")
        place = automaton.letters.index(letter)
        if not broken:
            now = tick_role(automaton.template, automaton.states[state], letter[0], letter[1])
            triggered = triggered or now.triggered
            state = automaton.moves[state][place]
        broken = broken or state == BROKEN or automaton.verdicts[state] == "violated"
        if broken:
            yield "violated", "violated"
            continue
        good = "satisfied" if triggered else "vacuous"
        closed = accepts(automaton.template, automaton.states[state])
        yield automaton.verdicts[state], good if closed else "open"


@pytest.mark.parametrize("scope", some(SCOPES, 3))
def test_the_verdicts_are_those_of_the_automaton(opened: Open, scope: str) -> None:
    chosen = [each for each in templates((0, 2)) if each.scope == scope]
    choose = random.Random(scope)
    names = "pqs" if scope == "null" else "mpqs"
    rows = [{name: choose.random() < 0.5 for name in names} for _ in range(14)]
    found = everything(opened(*[each.sentence for each in chosen], address=address(rows)))
    letters = [(m, p, q, s) for m, p, q, s in product((False, True), repeat=4)]
    for place, each in enumerate(chosen, 1):
        subject = requirement(each.sentence)
        counted = explore(template(subject.sentence, subject.ticks or 0), letters)
        known = [{n: row[n] for n in each.columns} for row in rows]
        expected = [*judged(counted, known)]
        assert found[f"R{place} at this tick"] == [now for now, _ in expected], each
        for (_, end), shown in zip(expected, found[f"R{place} if the run ended here"], strict=True):
            assert shown == end or (shown == "inconclusive" and end != "violated"), each


def test_what_is_unknown_is_told_as_unknown(opened: Open) -> None:
    rows = [{"near": None if t == 0 else False, "stopped": False} for t in range(4)]
    page = opened(WITHIN, address=address(rows))
    assert told(page, "R1", "at this tick") == ["pending", "pending", "unknown", "unknown"]
    assert told(page, "R1", "open obligation")[:2] == ["unknown", "unknown"]
    assert told(page, "near") == ["unknown", "false", "false", "false"]
    assert lane(page, "near").first.inner_text() == "?"


# Gestures -------------------------------------------------------------------------------------


def centre(cell: Locator) -> tuple[float, float]:
    box = cell.bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def test_a_click_turns_a_value_and_a_drag_paints_it(opened: Open) -> None:
    page = opened(WITHIN)
    near = lane(page, "near")
    near.nth(3).click()
    assert told(page, "near")[3] == "true"
    assert told(page, "R1", "at this tick")[4:6] == ["pending", "violated"]
    page.mouse.move(*centre(near.nth(5)))
    page.mouse.down()
    page.mouse.move(*centre(near.nth(8)))
    page.mouse.up()
    assert told(page, "near")[3:10] == ["true", "false", "true", "true", "true", "true", "false"]
    near.nth(6).click(button="right")
    assert told(page, "near")[5:8] == ["true", "unknown", "true"]
    page.keyboard.press("Control+z")
    page.keyboard.press("Control+z")
    assert told(page, "near").count("true") == 1
    page.keyboard.press("Control+y")
    assert told(page, "near").count("true") == 5


def test_everything_can_be_done_by_keyboard(opened: Open) -> None:
    page = opened(WITHIN)
    lane(page, "near").first.focus()
    for key in ("ArrowRight", "ArrowRight", "Space", "ArrowDown", "End", "1", "Home", "u"):
        page.keyboard.press(key)
    assert told(page, "near") == ["false"] * 2 + ["true"] + ["false"] * 9
    assert told(page, "stopped") == ["unknown"] + ["false"] * 10 + ["true"]
    assert page.locator("#where").inner_text() == "Tick 0: 1 pending."
    for key in ("ArrowRight", "ArrowRight", "1", "Shift+ArrowRight", "Shift+ArrowRight"):
        page.keyboard.press(key)
    assert told(page, "stopped")[1:6] == ["false", "true", "true", "true", "false"]
    for key in ("Home", "i", "r", "Delete"):
        page.keyboard.press(key)
    assert told(page, "stopped")[:4] == ["unknown", "unknown", "false", "true"]
    focused = page.evaluate("document.activeElement.ariaLabel")
    assert focused == "stopped at tick 1: unknown"
    assert page.locator("#grid [tabindex='0']").count() == 1


def test_the_cursor_says_why(opened: Open) -> None:
    rows = [{"near": t == 1, "stopped": t > 3} for t in range(6)]
    page = opened(WITHIN, address=address(rows))
    says = {}
    for t in range(6):
        lane(page, "R1", "at this tick").nth(t).click()
        says[t] = page.locator("#why li").inner_text()
    assert "no obligation is open." in says[0]
    assert (
        "open since tick 1, due by tick 3, in 1 tick; not answered: violated at tick 3." in says[2]
    )
    assert "stopped is false at ticks 1 to 2." in says[2]
    assert "violated since tick 3. Triggered at tick 1, due by tick 3." in says[4]
    assert "stopped is false at ticks 1 to 3." in says[4]


def test_numbers_are_typed_and_comparisons_follow(opened: Open) -> None:
    page = opened(BATTERY)
    battery = lane(page, "battery")
    battery.nth(2).click()
    page.keyboard.type("20.5")
    page.keyboard.press("Enter")
    battery.nth(3).click()
    page.keyboard.type("-1e-3")
    page.keyboard.press("Enter")
    assert told(page, "battery")[1:5] == ["0", "20.5", "-0.001", "0"]
    assert told(page, "battery < 20")[1:5] == ["true", "false", "true", "true"]
    page.keyboard.press("u")
    assert told(page, "battery < 20")[3] == "unknown"
    page.keyboard.type("1x")
    page.keyboard.press("Enter")
    assert "is not a number" in page.locator("#status").inner_text()
    assert told(page, "battery")[3] == "unknown"
    page.keyboard.press("Escape")
    lines = page.locator(".plot .limit")
    assert [line.get_attribute("d").count("M") for line in lines.all()] == [1, 1]  # type: ignore[union-attr]


# Traces in and out ----------------------------------------------------------------------------


def test_the_address_is_the_trace(opened: Open, visits: Visits) -> None:
    page = opened(BATTERY, WITHIN)
    page.locator("#which").select_option("R1")
    lane(page, "battery").nth(1).click()
    page.keyboard.type("17.25")
    page.keyboard.press("Enter")
    page.get_by_role("button", name="Repeat tick").click()
    lane(page, "docking").nth(2).click(button="right")
    before = everything(page)
    expected_to(page).to_have_url(re.compile("(?=.*17[.]25).*docking=[^&]*u"))
    other = visits.again(page)
    assert everything(other) == before
    assert other.locator("#which").input_value() == "0"


def test_an_address_of_something_else_is_told(opened: Open) -> None:
    page = opened(WITHIN, address="#ticks=0")
    refused = "the address contains no valid trace for this page"
    assert page.locator("#status").inner_text() == refused
    for bad in ("ticks=99999999", "x", "ticks=2&v.near=1", "ticks=2&v.x=1_1", "ticks=1&v.near=%"):
        page.evaluate("location.hash = 'ticks=3'")
        expected_to(page.locator("#status")).to_have_text("")
        page.evaluate("hash => { location.hash = hash; }", bad)
        expected_to(page.locator("#status")).to_have_text(refused)
        assert len(told(page, "near")) == 3


def test_a_saved_table_is_judged_alike_by_the_monitor(opened: Open, tmp_path: Path) -> None:
    page = opened(BATTERY, WITHIN)
    page.locator("#which").select_option("R1")
    for t, number in ((1, "30"), (2, "19.99"), (4, "inf")):
        lane(page, "battery").nth(t).click()
        page.keyboard.press("Enter")
        page.keyboard.type(number)
        page.keyboard.press("Enter")
    lane(page, "docking").nth(3).click(button="right")
    with page.expect_download() as download:
        page.get_by_role("button", name="Save CSV").click()
    path = tmp_path / download.value.suggested_filename
    assert path.name == "r1.csv"
    download.value.save_as(path)
    header, *rows = path.read_text("utf-8").splitlines()
    machine: Any = load("monitor.py", monitor_text(requirement(BATTERY)))
    assert header == ",".join(machine.VARIABLES)
    expected = []
    for row in rows:
        battery, docking, speed = row.split(",")
        machine.take([(float(battery), docking == "1" if docking else None, float(speed))])
        expected.append(machine.verdicts()[0].value)
    shown = told(page, "R1", "at this tick")
    assert [word.replace("unknown", "pending") for word in shown] == expected
    page.get_by_role("button", name="Clear").click()
    page.locator("#load").set_input_files(path)
    expected_to(page.locator("#status")).to_have_text("r1.csv: 12 ticks")
    page.locator("#which").select_option("R1")
    assert told(page, "R1", "at this tick") == shown


def test_saved_tests_pass_with_the_monitor_and_give_the_trace_again(
    opened: Open, tmp_path: Path
) -> None:
    rows = [{"near": t in (1, 6), "stopped": None if t == 2 else t > 8} for t in range(12)]
    requirements = [requirement(BATTERY, "R1"), requirement(WITHIN, "R2")]
    page = opened(BATTERY, WITHIN, address=address(rows) + "&v.battery=0*4_20.5_u_19.75*6")
    shown = everything(page)
    with page.expect_download() as download:
        page.get_by_role("button", name="Save tests").click()
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    suite = read(str(path))
    assert isinstance(suite, Suite)
    assert [test.requirement for test in suite.tests] == ["R1", "R2"]
    made, left = files(suite, requirements, SuiteFormat.PYTEST)
    assert not left
    folder = tmp_path / "tests"
    folder.mkdir()
    for each in made:
        (folder / each.path).write_text(each.text, encoding="utf-8")
    run = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(folder)]
    assert "2 passed" in subprocess.run(run, check=True, capture_output=True, text=True).stdout
    again = opened(BATTERY, WITHIN, starts=[*of_suite(suite, requirements)])
    again.locator("#which").select_option("")
    assert everything(again) == shown
    for beyond in ("inf", "1e20"):  # JSON has no infinite number, and no other writing of 1e20
        lane(page, "battery").nth(2).click()
        page.keyboard.press("Enter")
        page.keyboard.type(beyond)
        page.keyboard.press("Enter")
        page.get_by_role("button", name="Save tests").click()
        assert "cannot contain an infinite number" in page.locator("#status").inner_text()
    lane(page, "battery").nth(2).click()
    page.keyboard.press("Enter")
    page.keyboard.type("9007199254740993")  # another number in JavaScript
    page.keyboard.press("Enter")
    assert "is not a number" in page.locator("#status").inner_text()


def test_both_versions_stand_side_by_side(opened: Open) -> None:
    """They differ where verdicts of their monitors do."""
    rows = [{"near": t in (1, 7), "stopped": t == 4} for t in range(14)]
    later = WITHIN.replace("2 ticks", "4 ticks")
    page = opened(later, WITHIN, before={"R1": "R2"}, address=address(rows))
    machines = [
        load(f"{n}.py", monitor_text(requirement(text))) for n, text in enumerate((later, WITHIN))
    ]
    expected = []
    for row in rows:
        for machine in machines:
            machine.advance([tuple(row[name] for name in machine.PROPOSITIONS)])
        one, other = ((m.verdicts(), m.statuses()[0].finite) for m in machines)
        expected.append(one != other)
    assert True in expected[:-1]
    assert False in expected
    said = told(page, "R1", "now and before")
    assert [text != "the same" for text in said] == expected
    page.locator("#which").select_option("R1")
    assert page.locator("#hidden").inner_text() == ""
    assert page.locator("#why li").count() == 2
    page.locator("#which").select_option("R2")
    assert page.locator("#why li").count() == 1
    assert HOSTILE[:9] in page.locator("#versions").inner_text()


BAD_TABLES = (
    ("near\n", "the table has no rows"),
    ("near,x\n1,1\n", "x is not a variable of this page; the variables are near, stopped"),
    ("near,near\n1,1\n", "near appears twice in the header"),
    ("near,stopped\n1,0\n1\n", "row 2 has 1 cells for 2 names"),
    ("near\n1\n2\n", "row 2: near cannot be 2"),
    ('near,stopped\n0,1\n"0"1,0\n', "row 2: a quotation mark is not closed, or is inside a cell"),
    ('near,stopped\n0"1,0\n', "row 1: a quotation mark is not closed, or is inside a cell"),
    ('near,stopped\n"0,1\n' + '"1,0\n' * 100_000, "row 1: a quotation mark is not closed"),
    ("near,stopped\n=1+0,0\n", "row 1: near cannot be =1+0"),
    ("tick,near\n3,1\n5,1\n", "row 2: 5 is not the next tick"),
    (
        "near\n" + "1\n" * 2001,
        "the table has 2001 rows, and the page shows at most 2000: load a shorter",
    ),
)


def test_a_table_that_cannot_be_taken_changes_nothing(opened: Open, tmp_path: Path) -> None:
    page = opened(WITHIN)
    before = everything(page)
    for table, message in BAD_TABLES:
        (tmp_path / "bad.csv").write_text(table, encoding="utf-8")
        page.locator("#load").set_input_files(tmp_path / "bad.csv")
        expected_to(page.locator("#status")).to_contain_text(f"bad.csv: {message}")
        assert everything(page) == before


TABLES = {
    "one": ("\nnear\n1\n\n0\n\n", ["true", "unknown", "false", "unknown"]),
    "no last line": ("near\n1\n\n0", ["true", "unknown", "false"]),
    "in quotes": ('"near"\r\n"1"\r\n""', ["true", "unknown"]),
    "counted": ("\ufefftick,near\r\n-1,1\r\n\r\n0,\r\n", ["true", "unknown"]),
}


def test_a_table_has_the_ticks_that_a_monitor_reads(opened: Open) -> None:
    """Where a table has one column, an empty line is an unknown value."""
    page = opened("the robot shall never satisfy near")
    for name, (table, expected) in TABLES.items():
        read = [row for _, row in placed_rows(io.StringIO(table, newline=""), ("near",), "t.csv")]
        words = {"1": "true", "0": "false", "": "unknown"}
        assert [words[row["near"]] for row in read] == expected, name
        page.locator("#load").set_input_files([as_csv(table, f"{name}.csv")])
        expected_to(page.locator("#status")).to_contain_text(f"{name}.csv: {len(expected)} tick")
        assert told(page, "near") == expected, name
        with page.expect_download() as download:
            page.get_by_role("button", name="Save CSV").click()
        page.get_by_role("button", name="Clear").click()
        page.locator("#load").set_input_files(download.value.path())
        expected_to(page.locator("#status")).to_contain_text(f": {len(expected)} tick")
        assert told(page, "near") == expected, name


def as_csv(text: str, name: str) -> FilePayload:
    return {"name": name, "mimeType": "text/csv", "buffer": text.encode()}


def test_a_start_gets_numbers_that_make_its_comparisons_true(opened: Open) -> None:
    given = [
        {"(battery < 20)": n % 2 == 0, "docking": False, "(speed <= 0.5)": n > 2} for n in range(5)
    ]
    start = Start(
        "Tests", "a word", "what it shows", ("R1",), tuple((1, dict(row)) for row in given)
    )
    page = opened(BATTERY, WITHIN, starts=[start])
    assert told(page, "battery < 20") == [str(row["(battery < 20)"]).lower() for row in given]
    assert told(page, "speed <= 0.5") == [str(row["(speed <= 0.5)"]).lower() for row in given]
    assert page.locator("#status").inner_text() == "what it shows"
    assert (
        page.locator("#hidden")
        .inner_text()
        .startswith("Other requirements at the last tick: 1 unknown")
    )


def test_a_start_begins_where_its_requirement_is_violated(opened: Open) -> None:
    rows: tuple[Ticks, ...] = ((200, {"q": True}), (1, {"q": False}), (9, {"q": True}))
    page = opened("the robot shall always satisfy q", starts=[Start("g", "n", "a", ("R1",), rows)])
    cursor = page.locator("td.now[aria-label^='q at tick']")
    assert cursor.get_attribute("aria-label") == "q at tick 200: false"
    left = cursor.evaluate("cell => cell.getBoundingClientRect().left")
    assert 0 <= left < page.viewport_size["width"]  # type: ignore[index]


def test_what_is_not_shown_is_counted(opened: Open) -> None:
    rows = [{"near": True, "stopped": False, "q": True}] * 4
    page = opened(WITHIN, "the robot shall always satisfy q", address=address(rows))
    assert page.locator("#hidden").inner_text() == ""
    page.locator("#which").select_option("R2")
    assert (
        page.locator("#hidden").inner_text() == "Other requirements at the last tick: 1 violated."
    )
    assert [*everything(page)][:2] == ["q", "R2 at this tick"]


def test_more_cells_than_a_browser_shows_are_counted(opened: Open) -> None:
    sentences = ["the robot shall always satisfy q"] * 40
    page = opened(*sentences, address="#ticks=2000&v.q=0_1*1999")
    assert page.locator("#which").input_value() == "0"
    assert (
        page.locator("#hidden").inner_text() == "Other requirements at the last tick: 39 violated."
    )
    page.locator("#which").select_option("")
    assert page.locator("#which").input_value() == "0"
    assert "too many to show at once" in page.locator("#status").inner_text()


# The page as a whole --------------------------------------------------------------------------


@pytest.mark.parametrize(("scheme", "width"), some([("dark", 390), ("light", 1200)], 2))
def test_axe_finds_nothing_serious_and_nothing_is_too_wide(
    opened: Open, scheme: str, width: int
) -> None:
    rows = [{"near": t in (1, 5), "stopped": None if t == 5 else t > 5} for t in range(40)]
    sentences = (WITHIN, BATTERY, "the robot shall eventually satisfy near")
    page = opened(*sentences, address=address(rows), scheme=scheme, width=width)
    assert page.evaluate("document.documentElement.scrollWidth") == width
    page.locator("summary").click()
    assert serious(page) == []


def test_it_asks_nothing_of_anybody_and_texts_stay_texts(opened: Open) -> None:
    page = opened('whenever "a</script>b" the robot shall within 2 ticks satisfy stopped')
    assert page.title() == "Play: R1"
    assert lane(page, "a</script>b").count() == 12
    text = page.content()
    assert "default-src 'none'" in text
    assert not re.search(r"(?:src|href)=\"(?!#)", text)
    assert "\\u202e" in page.locator("header").inner_text()


def test_a_trace_is_judged_once_whatever_is_done(opened: Open) -> None:
    """Each gesture, and the start itself, asks the monitors once for each tick at most."""
    rows: tuple[Ticks, ...] = ((2, {"p": True, "q": False}), (5, {"p": False, "q": True}))
    starts = [Start("a group", name, "shown", ("R1",), rows) for name in ("first", "second")]
    page = opened("whenever p the sw shall within 1 tick satisfy q", starts=starts)
    page.evaluate(
        "() => { const judge = monitor.judge; window.asked = 0;"
        " monitor.judge = (...given) => { window.asked += 1; return judge(...given); }; }"
    )

    def asked(gesture: Callable[[], object]) -> int:
        page.evaluate("window.asked = 0")
        gesture()
        found: int = page.evaluate("window.asked")
        return found

    cell = lane(page, "p").first
    for ticks, gesture in (
        (7, lambda: page.locator("#start").select_option("1")),
        (7, lambda: cell.click()),
        (8, lambda: cell.press("i")),
        (7, lambda: page.keyboard.press("Control+z")),
        (8, lambda: page.keyboard.press("Control+y")),
        (0, lambda: page.keyboard.press("ArrowRight")),
        (0, lambda: page.locator("#which").select_option("0")),
        (8, lambda: page.locator("#clear").click()),
    ):
        assert asked(gesture) == ticks
