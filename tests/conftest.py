"""Golden files, a browser, and how hard hypothesis tries.

`--hypothesis-profile=full`, or `HYPOTHESIS_PROFILE=full`: many more examples.
"""

import gc
import os
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

# Bytecode is kept, whatever the shell says: each worker, and each process that a test starts, would
# compile the same text again, pytest's own forms of the assertions and of hypothesis among it.
sys.dont_write_bytecode = False
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)

import pytest  # noqa: E402
from hypothesis import HealthCheck, settings  # noqa: E402

with warnings.catch_warnings(), suppress(ImportError):  # it is not installed everywhere
    # Spot's bindings warn while they are imported, and crash where a warning is an error.
    warnings.simplefilter("ignore", DeprecationWarning)
    with suppress(ModuleNotFoundError):  # it exists for Linux on x86-64 only
        import spot  # noqa: F401

from tests import browsing, programs  # noqa: E402
from tests.command import Fretc, runner  # noqa: E402

if TYPE_CHECKING:
    from tests.browsing import Visits
    from tests.simulation.missions import Missions

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    # A shell starts what runs in its background so, and every process that a test starts would
    # inherit that Ctrl-C does nothing.
    signal.signal(signal.SIGINT, signal.default_int_handler)

# How long a case or its making takes is no failure: the machine may be busy.
WITHOUT_CLOCK = settings(deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("default", WITHOUT_CLOCK, max_examples=30)
settings.register_profile("full", WITHOUT_CLOCK, max_examples=2000)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="rewrite tests/golden/")
    parser.addoption(
        "--without-programs",
        action="store_true",
        help="hide the programs that tests run, but for a shell and Python (tests/programs.py)",
    )


def pytest_configure(config: pytest.Config) -> None:
    if config.getoption("--without-programs"):
        programs.hide()


def pytest_xdist_auto_num_workers() -> int:
    """One more than there are processors: tests of middlewares wait most of their time."""
    return (os.cpu_count() or 1) + 1


def pytest_collectstart() -> None:
    """Let the collector of garbage rest: what is loaded and collected stays to the end."""
    gc.disable()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let each worker begin with files that have slow tests, and end with quick ones.

    A worker has the next so many items, and takes some of the last ones of another when it has no
    more: where those are quick, none waits for another's last test.
    """
    workers = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    kinds = [[item for item in items if (item.path in slow) is first] for first in (True, False)]
    items[:] = [
        item
        for worker in range(workers)
        for kind in kinds
        for item in kind[len(kind) * worker // workers : len(kind) * (worker + 1) // workers]
    ]


def pytest_collection_finish() -> None:
    """Keep the collector of garbage from what is loaded by now: it is large."""
    gc.freeze()
    gc.enable()
    gc.set_threshold(20_000, 20, 20)


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """Compare a whole output with its file in `tests/golden/`, or rewrite that file."""

    def check(name: str, text: str) -> None:
        path = Path(__file__).parent / "golden" / name
        if request.config.getoption("--update-golden"):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        assert text == path.read_text(encoding="utf-8"), f"{name}: pytest --update-golden"

    return check


@pytest.fixture
def fretc(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    tmp_path_factory: pytest.TempPathFactory,
) -> Fretc:
    """Run the command in an empty folder, for a user who has never run it."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
    monkeypatch.chdir(tmp_path)
    return runner(monkeypatch, capsys)


@pytest.fixture
def visits() -> "Iterator[Visits]":
    """Documents in a browser, which complain of nothing, and are complete alone.

    A folder's tests share it, and are skipped where there is none.
    """
    there = browsing.started()
    there.begin()
    yield there
    assert there.messages == []
    assert not [url for url in there.asked if not url.startswith(("file:", "blob:", "about:"))]


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item: pytest.Item, nextitem: pytest.Item | None) -> None:
    """End the browser with its folder: its event loop would be in the way of other tests."""
    if nextitem is None or nextitem.path.parent != item.path.parent:
        browsing.end()


@pytest.fixture(scope="session")
def missions(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> "Missions":
    """Missions of the simulated robot, kept in pytest's cache where it has one."""
    from tests.simulation.missions import Missions

    cache = getattr(request.config, "cache", None)
    return Missions(cache.mkdir("missions") if cache else tmp_path_factory.mktemp("missions"))
