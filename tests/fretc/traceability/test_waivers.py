import pytest

from compiler.files.dates import today
from fretc.audit.evidence import verdicts
from fretc.traceability.waivers import VERDICTS, Waiver, read
from fretish.diagnostics.rendering import render
from tests.command import write

GOOD = """\
[R1]
verdict = "no data"
reason  = "the lidar is being replaced"
by      = "A. Meier"
role    = "safety engineer"
granted = "2026-11-01"
expires = "2026-12-31"
"""


@pytest.fixture(autouse=True)
def _here(tmp_path: object, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(str(tmp_path))


def test_a_waiver_counts_from_its_first_to_its_last_day() -> None:
    waivers, diagnostics = read(write("waivers.toml", GOOD), ["R1"], "2026-11-22")
    assert diagnostics == ()
    assert waivers == {
        "R1": Waiver(
            "R1",
            "no data",
            "the lidar is being replaced",
            "A. Meier",
            "safety engineer",
            "2026-11-01",
            "2026-12-31",
        )
    }
    days = ("2026-10-31", "2026-11-01", "2026-12-31", "2027-01-01")
    assert [waivers["R1"].covers(day) for day in days] == [False, True, True, False]


def test_a_waiver_that_has_ended_is_reported() -> None:
    _, (warning,) = read(write("waivers.toml", GOOD), ["R1"], "2027-01-01")
    assert render(warning) == (
        "F514 warning: the waiver of R1 is valid only from 2026-11-01 to 2026-12-31\n"
        "  --> waivers.toml:7:11\n"
        '   | expires = "2026-12-31"\n'
        "   |           ^^^^^^^^^^^^\n"
        "help: show that the requirement holds, or have the waiver granted again"
    )


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("[R1]", "[R2]", "R2 is waived, but is not among the requirements"),
        ('by      = "A. Meier"\n', "", "the waiver of R1 has no `by`"),
        ('"A. Meier"', '" "', "the waiver of R1 has no `by`"),
        ('"2026-12-31"', '"31.12.2026"', "`31.12.2026` is not a date"),
        ('verdict = "no data"\n', "", "the waiver of R1 does not name the verdict that it covers"),
        ('"no data"', '"nodata"', "`nodata` is not a verdict that can be waived"),
        ('"no data"', '"satisfied"', "`satisfied` is not a verdict that can be waived"),
        ('"no data"', '"suspect"', "`suspect` is not a verdict that can be waived"),
        ('"no data"', "7", "`7` is not a verdict that can be waived"),
        ("reason", "raeson", "unknown field `raeson` in [R1]"),
    ],
)
def test_a_waiver_with_a_mistake_waives_nothing(old: str, new: str, message: str) -> None:
    waivers, diagnostics = read(write("waivers.toml", GOOD.replace(old, new)), ["R1"], "2026-11-22")
    assert waivers == {}
    assert message in [d.message for d in diagnostics]


def test_the_day_is_that_of_source_date_epoch(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    assert today() == "2023-11-14"


def test_what_a_waiver_may_cover_is_what_does_not_show_a_requirement() -> None:
    passing = {"satisfied", "supported", "retired", "waived", "suspect"}
    assert set(VERDICTS) == {word for word in verdicts.VERDICTS if word not in passing}


def test_an_older_waiver_is_reported_with_its_fix() -> None:
    _, (mistake,) = read(
        write("waivers.toml", GOOD.replace('verdict = "no data"\n', "")), ["R1"], ""
    )
    assert mistake.help is not None
    assert mistake.help.startswith('add `verdict = "no data"`; it may be `violated`, `refuted`, ')
