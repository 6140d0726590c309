"""Signals with memory of a log: read in order of time, with the values that the docs state."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from fretc.logs.signals.memory import with_memory
from fretc.logs.signals.samples import Samples
from fretc.logs.signals.traces import trace
from monitors.kernel.columns import truths
from tests.command import Fretc
from tests.command import write as put
from tests.fretc.logs.logs import MS, S, declare, number, recorded, times, values, write

BINDINGS = """
[clock]
tick = "100 ms"
[signal.x]
path = "/x.data"
unit = "km/h"
[signal.change]
value = "rate(x)"
[signal.top]
value = "max(x, over = 250 ms)"
[signal.middle]
value = "mean(x, over = 250 ms)"
[proposition.calm]
expr = "top < 30 km/h"
"""
START = 1000 * S
ROWS = ((0, 36.0), (200, 18.0), (100, 54.0), (300, 18.0), (600, 0.0))
"""Milliseconds and km/h, in the order of the file: one is out of order."""


def test_a_log_is_read_in_order_of_time(tmp_path: Path) -> None:
    sent = [number(value, START + at * MS) for at, value in ROWS]
    log = recorded(write(tmp_path / "x.mcap", sent), declare(BINDINGS))
    at = [(time - START) // MS for time in times(log, "change")]
    assert at == [0, 100, 200, 300, 600]
    assert values(log, "change")[1:] == pytest.approx([50, -100, 0, -5 / 0.3])  # m/s^2
    assert log.samples["x"].times.tolist() == log.samples["change"].times.tolist()


def test_a_window_changes_where_a_sample_leaves_it(tmp_path: Path) -> None:
    sent = [number(value, START + at * MS) for at, value in ROWS]
    declarations = declare(BINDINGS)
    log = recorded(write(tmp_path / "x.mcap", sent), declarations)
    at = [(time - START) // MS for time in times(log, "top")]
    assert at == [0, 100, 200, 250, 300, 350, 450, 550, 600]
    nan = math.nan
    kmh = np.array(values(log, "top")) * 3.6
    assert kmh.tolist() == pytest.approx([nan] * 3 + [54, 54, 18, 18, nan, 0], nan_ok=True)
    middle = np.array(values(log, "middle")) * 3.6
    expected = [nan] * 3 + [36, 30, 18, 18, nan, 0]
    assert middle.tolist() == pytest.approx(expected, nan_ok=True)
    column = trace(declarations, log, ["calm"]).columns["calm"]
    assert truths(column, 7) == [None, None, None, False, True, True, True]


def test_a_signal_without_samples_has_no_values() -> None:
    signal = declare(BINDINGS).signals["top"]
    none = Samples(np.zeros(0, np.int64), np.zeros(0))
    assert with_memory(signal, none, (), 9).times.tolist() == []


def test_a_check_of_the_bindings_names_the_function(fretc: Fretc) -> None:
    put("requirements/bindings.toml", BINDINGS.replace("30 km/h", "60 km/h"))
    sentence = "the sw shall always satisfy calm"
    put("requirements/r1.fret", f'+++\nid = "R1"\n+++\n{sentence}\n')
    write(Path("x.mcap"), [number(value, START + at * MS) for at, value in ROWS])
    checked = fretc("bind", "--check", "x.mcap").out
    assert "top = max(x, over = 250 ms) of /x.data, km/h" in checked
    assert "what `top` looks back on was not fully known" in fretc("audit", "x.mcap").out
