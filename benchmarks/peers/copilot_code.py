"""Copilot: the C that it generated for the workloads, run over columns by a loop in C."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.peers.peer import Evaluation, Peer, Step
from benchmarks.peers.workloads import Column, Columns

HERE = Path(__file__).parent / "copilot"
GENERATOR = "copilot-c99 3.13"


class Copilot(Peer):
    """One style of writing the streams; `Workloads.hs` has them."""

    def __init__(self, name: str, style: str, formulas: Mapping[str, str]) -> None:
        self.name, self.style, self.formulas = name, style, formulas

    @property
    def version(self) -> str:
        return GENERATOR

    def missing(self) -> str | None:
        return None if shutil.which("gcc") else "not installed: gcc"

    def prepare(self, workload: str, columns: Columns) -> Evaluation:
        code = self._code(workload)
        truths = np.empty(len(columns["a"]), dtype=np.bool_)
        return Evaluation(lambda: _reset(code), lambda monitor: _run(monitor, columns, truths))

    def prepare_from_numpy(self, workload: str, columns: Columns) -> Evaluation:
        """NumPy's Booleans are C's: only the answer's memory comes on top."""
        code = self._code(workload)
        return Evaluation(
            lambda: _reset(code),
            lambda monitor: _run(monitor, columns, np.empty(len(columns["a"]), dtype=np.bool_)),
        )

    def prepare_steps(self, workload: str) -> Step:
        tick = _reset(self._code(workload)).tick
        return lambda row: tick(row["a"], row["b"], row.get("c", False))

    def truths(self, results: Any) -> Sequence[bool]:
        return [bool(truth) for truth in results]

    def _code(self, workload: str) -> ctypes.CDLL:
        return _compiled(f"{workload.lower()}_{self.style}.c")


@cache
def _compiled(monitor: str) -> ctypes.CDLL:
    """The loop around this monitor. Its state is the library's: one monitor at a time."""
    with tempfile.TemporaryDirectory() as folder:
        library = f"{folder}/monitor.so"
        options = ["-O2", "-fPIC", "-shared", "-fvisibility=hidden", f'-DMONITOR="{monitor}"']
        subprocess.run(["gcc", *options, str(HERE / "loop.c"), "-o", library], check=True)
        code = ctypes.CDLL(library)
    code.tick.argtypes, code.tick.restype = [ctypes.c_bool] * 3, ctypes.c_bool
    code.run.argtypes, code.run.restype = [ctypes.c_void_p] * 4 + [ctypes.c_size_t], None
    return code


def _reset(code: ctypes.CDLL) -> ctypes.CDLL:
    code.reset()
    return code


def _run(code: ctypes.CDLL, columns: Columns, truths: Column) -> Column:
    signals = (columns.get(name, columns["a"]) for name in "abc")
    addresses = [np.ascontiguousarray(signal).ctypes.data for signal in signals]
    code.run(*addresses, truths.ctypes.data, len(truths))
    return truths


COPILOT = Copilot(
    "Copilot C, library operators",
    "library",
    {
        "W1": "not (since (not b) (a && not b))",
        "W2": "alwaysBeen (eventuallyPrev 10 10 a ==> eventuallyPrev 0 10 b)",
        "W3": "alwaysBeen (a ==> eventuallyPrev 0 100 b)",
        "W4": "alwaysBeen ((a && previous (not a)) ==> since (not c) b)",
    },
)
COUNTERS = Copilot(
    "Copilot C, counters by hand",
    "counter",
    {"W2": "alwaysBeen (open < 10)", "W3": "alwaysBeen (a ==> age <= 100)"},
)
