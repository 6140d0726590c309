"""No verdict over a broken log says more than is whole in it: the whole command, on files."""

import json
from pathlib import Path
from typing import Any

import pytest

from tests.command import Fretc, write
from tests.fretc.logs.broken import CUT, DAMAGED, REFUSED, SOUND, Broken, Refused, sound
from tests.fretc.logs.logs import X_TEXT

BINDINGS = f"""{X_TEXT}
[proposition.calm]
expr = "x < 1 m"

[proposition.rare]
expr = "x >= 4 cm and x < 8 cm"
"""
REQUIREMENTS = """+++
id = "R1"
+++
the sw shall always satisfy calm

+++
id = "R2"
+++
whenever low the sw shall within 300 milliseconds satisfy calm

+++
id = "R3"
+++
the sw shall never satisfy rare
"""


@pytest.fixture
def fretc(fretc: Fretc) -> Fretc:
    """Run the command beside requirements that the sound log satisfies, but for R3."""
    write("requirements/r.fret", REQUIREMENTS)
    write("requirements/bindings.toml", BINDINGS)
    return fretc


def audited(fretc: Fretc, data: bytes) -> tuple[int, list[dict[str, Any]]]:
    """The exit status, and the results of R1, R2 and R3."""
    Path("run.mcap").write_bytes(data)
    run = fretc("audit", "run.mcap", "--format", "json", "--jobs", "1")
    return run.status, json.loads(run.out)


@pytest.mark.slow
@pytest.mark.parametrize("case", SOUND, ids=lambda case: case.name)
def test_a_whole_log_shows_what_it_shows_in_whatever_form(fretc: Fretc, case: Broken) -> None:
    status, results = audited(fretc, case.make(sound()))
    verdicts = [result["verdict"] for result in results]
    assert (status, verdicts) == (1, ["satisfied", "satisfied", "violated"])


@pytest.mark.slow
@pytest.mark.parametrize("case", [*CUT, *DAMAGED], ids=lambda case: case.name)
def test_a_broken_log_satisfies_nothing_and_violates_what_is_whole_in_it(
    fretc: Fretc, case: Broken
) -> None:
    status, results = audited(fretc, case.make(sound()))
    first, second, third = (result["verdict"] for result in results)
    assert {first, second} <= {"no data", "inconclusive"}
    rare = any(4 <= tenth < 8 for tenth in case.whole)
    assert (status, third) == ((1, "violated") if rare else (3, "no data"))


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case.name)
def test_a_log_that_cannot_be_read_is_bad_input(fretc: Fretc, case: Refused) -> None:
    status, results = audited(fretc, case.make(sound()))
    assert (status, [result["verdict"] for result in results]) == (2, ["no data"] * 3)
    for result in results:
        (finding,) = result["health"]["findings"]
        assert finding["code"] == case.code.number
