"""Of broken and odd logs every whole message is read, and what is lost has a name."""

import math
from pathlib import Path

import pytest

from fretc.logs.reader import look, read
from fretc.logs.signals.samples import Recording
from fretish.diagnostics.diagnostic import Diagnostic
from tests.fretc.logs.broken import (
    CUT,
    DAMAGED,
    ODD,
    REFUSED,
    SOUND,
    Broken,
    Odd,
    Refused,
    sound,
)
from tests.fretc.logs.logs import MS, S, X, codes, times, values


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case.name)
def test_of_what_cannot_be_read_at_all_the_reason_is_told(case: Refused, tmp_path: Path) -> None:
    path = tmp_path / "log.mcap"
    path.write_bytes(case.make(sound()))
    for found in (read(str(path), X, ["x"]), look(str(path))):
        assert isinstance(found, Diagnostic)
        assert found.code is case.code


@pytest.mark.parametrize("case", [*CUT, *DAMAGED, *SOUND], ids=lambda case: case.name)
def test_whole_messages_are_read_and_lost_ones_are_a_gap(case: Broken, tmp_path: Path) -> None:
    path = tmp_path / "log.mcap"
    path.write_bytes(case.make(sound()))
    found = read(str(path), X, ["x"])
    assert isinstance(found, Recording), found
    assert times(found, "x") == [1000 * S + i * 100 * MS for i in case.whole]
    assert values(found, "x") == [i / 100 for i in case.whole]
    gaps = [tuple((time - 1000 * S) // (100 * MS) for time in gap) for gap in found.gaps]
    assert gaps == list(case.gaps)
    assert codes(found) == list(case.codes)
    assert found.intact is case.intact


@pytest.mark.parametrize("case", ODD, ids=lambda case: case.name)
def test_what_is_odd_is_read_as_it_stands(case: Odd, tmp_path: Path) -> None:
    path = tmp_path / "log.mcap"
    path.write_bytes(case.data)
    found = read(str(path), X, ["x"])
    assert isinstance(found, Recording), found
    assert times(found, "x") == [time for time, _ in case.samples]
    for value, (_, expected) in zip(values(found, "x"), case.samples, strict=True):
        assert value == expected or (math.isnan(value) and math.isnan(expected))
    assert (codes(found), found.gaps, found.intact) == (list(case.codes), case.gaps, case.intact)
