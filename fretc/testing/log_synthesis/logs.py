"""Logs of tests: written, audited, and kept if the audit gives the expected verdict."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Literal

from compiler.project.project import Project
from compiler.targets.python import monitor as monitors
from fretc.audit.many_logs import audit_log
from fretc.audit.plan import Plan, planned
from fretc.testing.log_synthesis.messages import NotRecordableError
from fretc.testing.log_synthesis.synthetic_log import EPOCH, SyntheticLog, synthesize
from fretc.testing.suite import Test
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from monitors.kernel import Monitor
from monitors.kernel.verdicts import INCONCLUSIVE, Verdict
from monitors.loading import load
from simulation.recording import RecordedTopic, recording

Outcome = Literal["confirmed", "cannot be recorded", "not confirmed"]


@dataclass(frozen=True, slots=True)
class LogTestResult:
    """Result of writing a test as a log."""

    test: Test
    outcome: Outcome
    why: str = ""
    """Why there is no log; empty: there is one."""
    lead: int = 0
    """Number of ticks of the log before those of the test."""


def logs(
    project: Project, tests: Sequence[Test], folder: Path, tell: Callable[[int], None]
) -> Iterator[LogTestResult]:
    """A log `folder/NAME.mcap` for each test that can be recorded.

    A log is kept if its audit gives the verdict that the test expects.

    Args:
        project: project of the requirements.
        tests: tests of its suite.
        folder: an existing folder.
        tell: called with the number of finished tests.

    Raises:
        OSError: a log cannot be written.
    """
    declarations = project.declarations
    plan = planned(project)
    requirements = {requirement.id: requirement for requirement in project.formalized}
    monitor = cache(lambda id: load(f"{id}_staged", monitors.text(requirements[id])))
    with tempfile.TemporaryDirectory(dir=folder, prefix=".staging.") as temporary:
        for done, test in enumerate(tests, start=1):
            try:
                if declarations is None or not isinstance(plan, Plan):
                    raise NotRecordableError(_first(plan))
                yield _log(plan, test, monitor(test.requirement), Path(temporary), folder)
            except NotRecordableError as error:
                yield LogTestResult(test, "cannot be recorded", str(error))
            tell(done)


def _first(plan: Plan | tuple[Diagnostic, ...]) -> str:
    assert not isinstance(plan, Plan)
    return plan[0].message


def _log(plan: Plan, test: Test, monitor: Monitor, temporary: Path, folder: Path) -> LogTestResult:
    claim = next((each for each in plan.claims if each.id == test.requirement), None)
    if claim is None:
        raise NotRecordableError(f"{test.requirement} is not audited")
    if claim.chance is not None:
        raise NotRecordableError("one run decides nothing of a requirement with a probability")
    stage = synthesize(test, plan.declarations, monitor)
    path = temporary / f"{test.name}.mcap"
    _write(stage, test, path)
    verdicts = {result.requirement: result.verdict for result in audit_log(plan, str(path)).results}
    expected, actual = _expected(test, plan), verdicts[test.requirement]
    if actual != expected:
        why = f"the audit of it says {actual}, not {expected}"
        return LogTestResult(test, "not confirmed", why, stage.lead)
    shutil.move(path, folder / path.name)
    return LogTestResult(test, "confirmed", "", stage.lead)


def _expected(test: Test, plan: Plan) -> str:
    """Expected verdict of the audit; the clock decides about obligations open at the end."""
    end = Verdict(plan.declarations.clock.end)
    return str(end if test.verdict == INCONCLUSIVE else test.verdict)


def _write(stage: SyntheticLog, test: Test, path: Path) -> None:
    topics = {
        message.topic: RecordedTopic(message.topic, message.type) for message in stage.messages
    }
    about = {
        "test": test.name,
        "requirement": test.requirement,
        "words": test.words,
        "verdict": str(test.verdict),
        "lead": str(stage.lead),
    }
    with recording(path, epoch=EPOCH, topics=tuple(topics.values())) as log:
        for message in stage.messages:
            log.write(message.topic, message.message, message.time)
        log.finish("test", about)
