"""The common parts of ROS 1 and ROS 2 packages: their description, and shared files.

The printers `ros1.py` and `ros2.py` write only what the middleware asks for: manifests, launch
files, and the node that gives messages to `StopSupervisor` of `perception.py` and publishes what it
says.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePosixPath

from compiler.files.attribution import EXAMPLE, Attribution
from compiler.files.build_id import __version__
from compiler.files.settings import NAME as SETTINGS
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals.policies import instant
from compiler.targets.python import interceptor, monitor, perception
from compiler.targets.target import TargetOptions, stem
from compiler.targets.witness_traces import witness_traces
from fretish.bindings.declarations import Interception, Signal, short_type
from fretish.bindings.tables.actions import ROS_TYPE
from fretish.bindings.tables.interceptor import TABLE
from fretish.classes.frozen import dataclass
from fretish.clock import TimeSource
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.expressions import names
from monitors.status_publisher import LONGEST_BEAT, SHORTEST
from monitors.stop_supervisor import LONGEST


@dataclass(frozen=True, slots=True)
class SubscribedTopic:
    """A topic that the node subscribes to."""

    name: str
    package: str
    """The ROS package of the message type, such as `sensor_msgs`."""
    message: str
    """The name of the message type, such as `LaserScan`."""
    fields: tuple[str, ...]
    """The fields that are read, as the bindings name them: `ranges[:]`."""
    is_kept: bool = False
    """Whether its publishers keep their messages for later subscribers (`transient_local`)."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A setting of the node that can be changed at start; the node checks it."""

    name: str
    value: float | tuple[str, ...]
    text: str
    least: float = 0.0
    most: float = 0.0


@dataclass(frozen=True, slots=True)
class Package:
    """A package with one node, one file of monitors, and perhaps an interceptor."""

    name: str
    requirements: tuple[FormalizedRequirement, ...]
    topics: tuple[SubscribedTopic, ...]
    period: int
    """The length of a tick in nanoseconds."""
    phase: int
    lateness: int
    time: TimeSource
    """The time of messages: their stamps where they have one, or their arrival."""
    parameters: tuple[Parameter, ...]
    bindings: str
    """The name of the bindings' file."""
    attribution: Attribution
    interception: Interception | None = None
    version: str = "0.1.0"

    @property
    def ids(self) -> tuple[str, ...]:
        """The ids of the requirements."""
        return tuple(requirement.id for requirement in self.requirements)

    @property
    def summary(self) -> str:
        """A summary on one line, without characters that need escaping in any format."""
        return f"Runtime monitor of {', '.join(self.ids)}, which stops the robot"

    @property
    def stop(self) -> str:
        """The default topic of stop requests, std_msgs/Bool."""
        return self.interception.stop if self.interception else f"/{self.name}/stop"

    @property
    def verdicts(self) -> str:
        """The topic of verdicts, std_msgs/String: the lines of `fretc watch --format jsonl`."""
        return f"/{self.name}/verdicts"

    @property
    def dependencies(self) -> tuple[str, ...]:
        """The ROS packages of all message types."""
        own = {"std_msgs", "diagnostic_msgs", *(topic.package for topic in self.topics)}
        own |= {"geometry_msgs"} if self.interception else set()
        own |= {"sensor_msgs"} if self.interception and self.interception.scan else set()
        return tuple(sorted(own))


# What cannot be a package -----------------------------------------------------------------------

_TOPIC = re.compile(r"/?[A-Za-z]\w*(?:/[A-Za-z_]\w*)*", re.ASCII)


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F312 and F601 for requirements without a monitor, a live node, or a subscription."""
    return (
        monitor.refuse(requirement)
        or perception.refuse(requirement)
        or next(_unsubscribable(requirement), None)
    )


def _unsubscribable(requirement: FormalizedRequirement) -> Iterator[Diagnostic]:
    declared = requirement.declarations.signals.values() if requirement.declarations else ()
    for signal in _signals([requirement]):
        topic, kind = signal.path.topic, _kind(signal)
        span = signal.span or requirement.entry.wording
        others = [
            _kind(declared_signal)
            for declared_signal in declared
            if declared_signal.path.topic == topic
        ]
        if ROS_TYPE.fullmatch(kind) is None:
            what = f"has the type `{kind}`, which is not a ROS type" if kind else "has no type"
            fix = f'add `type = "sensor_msgs/LaserScan"`, say, to `[signal.{signal.name}]`'
            yield _refusal(requirement, f"`{signal.name}` {what}", span, fix)
        elif any(other not in ("", kind) for other in others):
            what = (
                f"{topic} has the type `{kind}` for one signal and another type for another signal"
            )
            yield _refusal(requirement, what, span, "give all signals the type of their topic")
        elif _TOPIC.fullmatch(topic) is None:
            what = f"`{topic}` is not a valid ROS topic name"
            yield _refusal(
                requirement,
                what,
                span,
                "a topic name has letters, digits, `_` and `/`: remap the topic",
            )


def _kind(signal: Signal) -> str:
    return short_type(signal.type or "")


def _refusal(requirement: FormalizedRequirement, what: str, span: Span, fix: str) -> Diagnostic:
    message = f"a ROS node cannot judge {requirement.id}: {what}"
    return Diagnostic(Code.NOT_EXPRESSIBLE, message, span, help=fix)


def refuse_project(options: TargetOptions) -> Diagnostic | None:
    """F634 if maintainer or license are missing, which a manifest must have."""
    missing = options.attribution.missing
    if not missing:
        return None
    return diagnostic("no_attribution", settings=SETTINGS, fields=", ".join(missing), paste=EXAMPLE)


def remarks(options: TargetOptions) -> tuple[Diagnostic, ...]:
    """F323 if nothing executes a stop; F630 to F633 of the interceptor."""
    declared = options.declarations
    if declared is None or declared.interceptor is not None:
        return interceptor.remarks(options)
    return (
        diagnostic(
            "package_without_interceptor",
            declared.source.span().part(0, 0),
            source=declared.source.name,
            paste=TABLE,
        ),
    )


# The description --------------------------------------------------------------------------------


def package(requirements: Sequence[FormalizedRequirement], options: TargetOptions) -> Package:
    """The package of requirements that were not refused.

    Raises:
        AssertionError: some requirement had to be refused.
    """
    declared = options.declarations or requirements[0].declarations
    assert declared is not None
    clock = declared.clock
    assert clock.period is not None
    signals = _signals(requirements)
    return Package(
        name(requirements, declared.source),
        tuple(requirements),
        tuple(_topics(signals)),
        clock.period,
        clock.phase,
        clock.effective_lateness or 0,
        clock.time,
        tuple(_parameters(requirements, signals, options, clock.period)),
        PurePosixPath(declared.source.name).name,
        options.attribution,
        declared.interceptor,
    )


def name(requirements: Sequence[FormalizedRequirement], bindings: Source) -> str:
    """The package name, legal in ROS and Python: `r1_monitor`, or from the project's folder."""
    if len(requirements) == 1:
        own = stem(requirements[0])
    else:
        parts = [part for part in PurePosixPath(bindings.name).parent.parts if part not in _PLAIN]
        own = parts[-1].lower() if parts else "robot"
    own = re.sub(r"[^a-z0-9]+", "_", own).strip("_")
    return f"{own if own[:1].isalpha() else f'r{own}'}_monitor"


_PLAIN = {"requirements", "..", ".", "/"}
"""Folder names that do not describe a project."""


def _signals(requirements: Sequence[FormalizedRequirement]) -> list[Signal]:
    at_instant = instant(requirements)
    return [policy.signal for policy in at_instant.policies] if at_instant else []


def _topics(signals: Sequence[Signal]) -> Iterator[SubscribedTopic]:
    for topic in dict.fromkeys(signal.path.topic for signal in signals):
        own = [signal for signal in signals if signal.path.topic == topic]
        kind = ROS_TYPE.fullmatch(_kind(own[0]))
        assert kind is not None, "it is refused"
        fields = dict.fromkeys(str(signal.path).removeprefix(f"{topic}.") for signal in own)
        names = kind["package"], kind["message"], tuple(fields)
        is_kept = any(signal.goals is not None for signal in own)
        yield SubscribedTopic(topic, *names, is_kept=is_kept)
        if any(signal.pose is not None for signal in own):
            yield SubscribedTopic(f"{topic}_static", *names, is_kept=True)


def _parameters(
    requirements: Sequence[FormalizedRequirement],
    signals: Sequence[Signal],
    options: TargetOptions,
    period: int,
) -> Iterator[Parameter]:
    ages = [signal.max_age for signal in signals if signal.max_age is not None]
    declared = options.declarations
    node = declared.interceptor if declared else None
    often = [period, 10**8, *([node.stop_timeout // 3] if node and node.stop_timeout else [])]
    yield Parameter(
        "source_timeout",
        max(ages, default=0) / 10**9,
        "seconds of silence of a topic with `max_age` after which the robot must stop; "
        "0: by the ages alone",
        0.0,
        LONGEST,
    )
    yield Parameter(
        "heartbeat",
        max(min(often), 10**6) / 10**9,
        "seconds from one request, to stop or not to stop, to the next",
        SHORTEST,
        LONGEST_BEAT,
    )
    yield Parameter(
        "stop_for",
        _deciding(requirements, options),
        "the requirements that stop the robot while an obligation of them is pending",
    )


def _deciding(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions
) -> tuple[str, ...]:
    """The requirements that stop the robot, by `[assume]`; all of them if it names none."""
    assumed = options.declarations.assumed if options.declarations else None
    asking = [
        requirement.id
        for requirement in requirements
        if assumed and assumed.stands in {name.id for name in names(requirement.sentence.response)}
    ]
    return tuple(asking or [requirement.id for requirement in requirements])


# The texts --------------------------------------------------------------------------------------


def modules(package: Package) -> Mapping[str, str]:
    """The files without dependencies on ROS: `monitor.py` as audited, and `perception.py`."""
    return {
        "monitor.py": monitor.text(*package.requirements),
        "perception.py": perception.text(package.requirements),
    }


def tests(package: Package) -> str:
    """Unit tests of both files: shortest runs to each verdict, and a node without messages."""
    witnesses = {
        requirement.id: witness_traces(requirement) for requirement in package.requirements
    }
    return render("ros/test_monitor.py.j2", package=package, words=witnesses, version=__version__)


def documents(package: Package, ros: int) -> Mapping[str, str]:
    """LICENSE, README.md and CHANGELOG.rst."""
    described = [monitor.description_of(requirement) for requirement in package.requirements]
    given = {"package": package, "ros": ros, "version": __version__, "formalized": described}
    return {
        "LICENSE": render("ros/LICENSE.j2", **given),
        "README.md": render("ros/README.md.j2", **given),
        "CHANGELOG.rst": render("ros/CHANGELOG.rst.j2", **given),
    }
