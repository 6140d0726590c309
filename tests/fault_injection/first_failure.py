"""pytest up to the first failure: `python first_failure.py SECONDS NOTE PYTEST-ARGUMENTS...`.

A script of its own, since the tree that it is run in may know nothing of this package.
"""

from __future__ import annotations

import os
import resource
import signal
import sys
import threading
import time
from pathlib import Path

import pytest

MEMORY = 6 << 20
"""KiB that this process may use: a loop that has no end is stopped before the machine is.

No limit of the system: programs with an address sanitizer reserve far more than they use.
"""
CUT_SHORT = 30
"""Exit status: the time was over before all tests had run, and none had failed."""


class FirstFailure:
    """Cheap tests first; no search for a smaller example; an end between tests when time is over.

    Args:
        seconds: of a processor, in this process; on the clock three times as many.
        note: a file for the name of the test that runs, or of the file that cannot be imported.
    """

    def __init__(self, seconds: int, note: Path) -> None:
        self.seconds, self.note, self.begun = seconds, note, time.monotonic()

    @pytest.hookimpl(trylast=True)
    def pytest_configure(self) -> None:
        """After the project has loaded its own profile of hypothesis, whose numbers stay."""
        from hypothesis import Phase, settings  # not before pytest, which warns of that

        phases = (Phase.explicit, Phase.generate)
        settings.register_profile("first failure", phases=phases, database=None, derandomize=True)
        settings.load_profile("first failure")

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            self.note.write_text(report.nodeid, "utf-8")

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items.sort(key=lambda item: item.get_closest_marker("slow") is not None)

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.note.write_text(nodeid, "utf-8")

    def pytest_runtest_logfinish(self) -> None:
        passed = time.monotonic() - self.begun
        if time.process_time() > self.seconds or passed > 3 * self.seconds:
            pytest.exit("the time is over", CUT_SHORT)


def watch_memory() -> None:
    """Kill this process, as a limit would, when it has used too much."""
    while resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < MEMORY:
        time.sleep(0.2)
    os.kill(os.getpid(), signal.SIGKILL)


if __name__ == "__main__":
    seconds, note, *arguments = sys.argv[1:]
    longest = 2 * int(seconds)  # one test that goes on for so long has no end
    resource.setrlimit(resource.RLIMIT_CPU, (longest, longest))
    threading.Thread(target=watch_memory, daemon=True).start()
    sys.exit(pytest.main(arguments, [FirstFailure(int(seconds), Path(note))]))
