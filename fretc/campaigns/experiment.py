"""Requirements of the simulated experiment, with their safety function and interceptor."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import asdict
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from compiler.project.folder import load
from compiler.project.paths import requirement_files
from compiler.project.project import Project
from compiler.targets.python import interceptor as interceptors
from compiler.targets.python import monitor as monitors
from compiler.targets.target import TargetOptions as TargetOptions
from fretc.audit.plan import Plan, planned
from fretc.logs.signals.propositions import TRUE, evaluate
from fretc.logs.signals.samples import Recording, Samples
from fretc.logs.signals.signals import sample
from fretish.bindings.declarations import Aggregate, Declarations, Proposition
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.source import Source
from monitors.interceptor import Options
from monitors.loading import executed
from monitors.loading import load as loaded

SAFETY_REQUIREMENT = "R1"
"""Its monitor is the Safety Instrumented Function."""

_THRESHOLD = "clearance < 5 cm"
"""Bound that the safety function compares with; a scenario may replace its number."""

_WINDOW = 600_000_000
"""Nanoseconds of stored messages: more than any `max_age` and any `for` of the propositions."""


def folder() -> Path:
    """Requirements folder: below `compiler` in a wheel, beside `fretc` in a checkout."""
    package = Path(str(files("compiler")))
    installed = package / "requirements"
    root = installed if installed.is_dir() else package.parent / "requirements"
    return root / "mission"


@lru_cache(maxsize=1)
def project() -> Project:
    """The requirements of a whole mission with their bindings and hazards."""
    requirements = requirement_files(str(folder()))
    assert not isinstance(requirements, Diagnostic), requirements
    read = load(requirements, str(folder() / "bindings.toml"), str(folder() / "hazards.toml"))
    assert not has_errors(read.diagnostics), read.diagnostics
    return read


@lru_cache(maxsize=1)
def plan() -> Plan:
    """Audit plan for the logs of missions."""
    audit_plan = planned(project())
    assert isinstance(audit_plan, Plan), audit_plan
    return audit_plan


def safety_function(threshold: float = 0.05) -> SafetyFunction:
    """The safety function before its first message.

    Args:
        threshold: metres, in place of the 5 cm of the bindings.
    """
    return SafetyFunction(monitor_text(), declarations(threshold))


def interceptor(options: Options, publish: Callable[[Sequence[float]], None]) -> Any:
    """The `Gate` of the emitted interceptor, before its first message.

    Args:
        options: options that replace those of the bindings.
        publish: receives the wheel command: m/s along x, y, z, and rad/s around them.
    """
    module = executed(interceptor_text(), "interceptor.py")
    module.OPTIONS = module.Options(**asdict(options))
    return module.Gate(publish)


@lru_cache(maxsize=1)
def interceptor_text() -> str:
    """Text that `--emit interceptor` writes for the mission."""
    declared = project().declarations
    (file,) = interceptors.emit((), TargetOptions(declarations=declared))
    return file.text


@lru_cache(maxsize=1)
def monitor_text() -> str:
    """The generated monitor of the safety function."""
    (requirement,) = (
        requirement for requirement in project().formalized if requirement.id == SAFETY_REQUIREMENT
    )
    return monitors.text(requirement)


@lru_cache(maxsize=8)
def declarations(threshold: float) -> Declarations:
    """The bindings with another threshold of the safety function, in metres."""
    declared = project().declarations
    assert declared is not None
    text = declared.source.text
    assert _THRESHOLD in text
    changed = text.replace(_THRESHOLD, f"clearance < {threshold * 100:g} cm")
    declarations, diagnostics = read_bindings(Source(declared.source.name, changed))
    assert declarations is not None, diagnostics
    assert not has_errors(diagnostics), diagnostics
    return declarations


class SafetyFunction:
    """Requests a stop while the monitor of R1 has an open obligation, or a new trigger.

    The code that audits logs converts messages to numbers and truth values. An unknown distance
    counts as too close; an unknown standstill counts as moving.
    """

    def __init__(self, text: str, declarations: Declarations) -> None:
        self._monitor: Any = loaded("safety_function", text)
        names = tuple(self._monitor.PROPOSITIONS)
        propositions = [declarations.propositions[name] for name in names]
        self._inputs = [proposition for proposition in propositions if proposition.role == "input"]
        self._outputs = [proposition for proposition in propositions if proposition.role != "input"]
        self._declarations = declarations
        self._demanded = False
        read = dict.fromkeys(name for one in propositions for name in one.signals)
        self._signals = [declarations.signals[name] for name in read]
        self._times: dict[str, deque[int]] = {name: deque() for name in read}
        self._values: dict[str, deque[float]] = {name: deque() for name in read}
        self._last = -1

    def hear(self, topic: str, message: Any, time: int) -> None:
        """Receive a message; `time` in nanoseconds, not before the previous one."""
        for signal in self._signals:
            if signal.path.topic == topic:
                times, values = self._times[signal.name], self._values[signal.name]
                times.append(time)
                values.append(sample(signal, message))
                while times[0] < time - _WINDOW:
                    times.popleft()
                    values.popleft()

    def step(self, time: int) -> bool:
        """Whether the robot must stop now; `time` in nanoseconds."""
        recording = self._recording(time)
        truths = {
            input_.name: self._truth(input_, recording, time, unknown=True)
            for input_ in self._inputs
        }
        awaited = self._demanded or any(truths.values())  # Otherwise no response is pending.
        for output in self._outputs:
            stands = awaited and self._truth(output, recording, time, unknown=False)
            truths[output.name] = stands
        self._last = time
        self._monitor.advance([truths])
        (signal,) = self._monitor.certain.signals()
        self._demanded = bool(signal.trigger or signal.obligation_pending)
        return self._demanded

    def _recording(self, time: int) -> Recording:
        """The stored messages in the form of a log."""
        samples = {
            name: Samples(
                np.array(times, np.int64),
                np.array(self._values[name], np.float64),
                self._declarations.signals[name].scale,
            )
            for name, times in self._times.items()
        }
        return Recording(
            name="",
            sha256="",
            size=0,
            start_ns=max(0, time - _WINDOW),
            end_ns=time,
            samples=samples,
            ticks=np.zeros(0, np.int64),
            gaps=(),
            topics={},
            nearest={},
            findings=(),
            intact=True,
        )

    def _truth(
        self, proposition: Proposition, recording: Recording, time: int, *, unknown: bool
    ) -> bool:
        """Value of a proposition since the last step; `unknown` replaces an unknown value."""
        steps = evaluate(proposition, self._declarations, recording)
        new = [
            unknown if value is None else value
            for at, value in zip(steps.times.tolist(), steps.values, strict=True)
            if 0 <= self._last < at <= time
        ] or [unknown if steps.values[-1] is None else steps.states[-1] == TRUE]
        match proposition.aggregate:
            case Aggregate.ANY:
                return any(new)
            case Aggregate.ALL:
                return all(new)
            case _:
                return bool(new[-1])
