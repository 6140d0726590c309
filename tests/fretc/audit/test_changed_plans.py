"""An audit into a store that another plan has filled: what its claims share is not judged again."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from compiler.files import text_files
from fretc.audit import many_logs as auditing
from fretc.audit import one_log
from fretc.audit.many_logs import local_executor
from fretc.audit.plan import Plan
from tests.fretc.audit.test_into_store import content, session
from tests.fretc.audit.test_results_taken_over import CHANGES, PROJECT, changed, plan, sent
from tests.fretc.logs.logs import write

LOGS = ["a.mcap", "b.mcap", "c.mcap"]


@pytest.fixture
def judged(
    tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> list[tuple[str, str]]:
    """Each log and requirement that was judged, in a folder with three logs."""
    found: list[tuple[str, str]] = []

    def audit(recording: Any, declarations: Any, requirements: Sequence[Any]) -> Any:
        ids = [each.monitor.REQUIREMENTS[0].id for each in requirements]
        found.extend((recording.name, id) for id in ids)
        return one_log.audit(recording, declarations, requirements)

    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path_factory.mktemp("state")))
    monkeypatch.setattr(auditing, "audit", audit)
    monkeypatch.setattr(text_files, "_COARSEST", -1)
    monkeypatch.chdir(tmp_path)
    for place, log in enumerate(LOGS):
        write(Path(log), [*sent(late=place == 1)])
    return found


def stored(own: Plan, folder: str) -> None:
    """Audit the logs into a store, in this process."""
    with session(LOGS, own, Path(folder)) as one:
        results = one.earlier.results

        def engine(plan: Plan, logs: Sequence[str]) -> Any:
            for log in logs:
                yield log, auditing.audit_log(plan, log, results(log))

        one.run(engine, lambda _: None)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["a threshold", "a new requirement", "a topic less"])
def test_after_a_change_the_store_is_the_one_made_from_nothing(
    tmp_path: Path, judged: list[tuple[str, str]], name: str
) -> None:
    texts, expected = CHANGES[name]
    before, now = plan(PROJECT), plan(texts)
    stored(now, "nothing")
    stored(before, "store")
    judged.clear()
    stored(now, "store")
    assert content(Path("store")) == content(Path("nothing"))
    assert {*judged} == {(log, id) for log in LOGS for id in expected if id in texts}


@pytest.mark.slow
def test_a_new_log_is_judged_by_all_and_an_old_one_by_what_has_changed(
    tmp_path: Path, judged: list[tuple[str, str]]
) -> None:
    before = plan(PROJECT)
    now = plan(changed("R2", "always", "eventually"))
    stored(before, "store")
    write(Path("b.mcap"), [*sent()])  # another one than it was
    judged.clear()
    stored(now, "store")
    stored(now, "nothing")
    assert judged[:6] == [
        ("a.mcap", "R2"),
        *(("b.mcap", f"R{number}") for number in (1, 2, 3, 4)),
        ("c.mcap", "R2"),
    ]
    assert content(Path("store")) == content(Path("nothing"))


@pytest.mark.slow
def test_of_a_store_that_somebody_else_vouches_for_nothing_is_taken_over(
    tmp_path: Path, judged: list[tuple[str, str]]
) -> None:
    before = plan(PROJECT)
    now = plan(changed("R2", "always", "eventually"))
    stored(before, "store")
    shutil.copytree("store", "copy")
    judged.clear()
    stored(now, "copy")
    assert len(judged) == len(LOGS) * 4


@pytest.mark.confined
@pytest.mark.slow
def test_processes_take_over_the_same(tmp_path: Path, judged: list[tuple[str, str]]) -> None:
    before = plan(PROJECT)
    now = plan(changed("R2", "always", "eventually"))
    stored(before, "store")
    stored(now, "nothing")
    with session(LOGS, now, Path("store")) as one:
        one.run(local_executor(2, None, one.earlier.results), lambda _: None)
    assert content(Path("store")) == content(Path("nothing"))
