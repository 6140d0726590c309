"""`--emit ros2-cpp-package`: a package of ROS 2 around the monitor in C (`ament_cmake`, rclcpp).

The package can run beside the one in Python, with different code: its stop requests are on a
separate topic until they are remapped.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import PurePosixPath
from textwrap import wrap
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals.functions import SignalFunction
from compiler.signals.policies import PropositionFunctions, SamplePolicy, instant
from compiler.signals.printing import parts
from compiler.targets.c import monitor
from compiler.targets.c.monitor import JoinedInterface, joined_interface
from compiler.targets.python import perception
from compiler.targets.python.monitor import description_of
from compiler.targets.ros import package as shared
from compiler.targets.ros.package import Package
from compiler.targets.ros.ros2 import container, qos
from compiler.targets.target import DEFAULT, LOOP, Target, TargetOptions
from compiler.targets.witness_traces import RepeatedTick, witness_traces
from fretish.bindings.declarations import Reading, Reduce
from fretish.clock import TimeSource
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

_TEMPLATES = {
    "package.xml": "package.xml.j2",
    "CMakeLists.txt": "CMakeLists.txt.j2",
    "src/perception.hpp": "perception.hpp.j2",
    "src/stop_supervisor.hpp": "stop_supervisor.hpp.j2",
    "src/setting.hpp": "setting.hpp.j2",
    "src/node.cpp": "node.cpp.j2",
    "test/test_monitors.cpp": "test_monitors.cpp.j2",
    "README.md": "README.md.j2",
}


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F312 and F601 for requirements without a monitor in C, or a ROS node."""
    return (
        shared.refuse(requirement)
        or monitor.refuse(requirement)
        or _of_computed(requirement)
        or _of_several_fields(requirement)
    )


def _of_several_fields(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 for signals of frames and of actions, which only the node in Python reads."""
    at_instant = instant([requirement])
    for policy in at_instant.policies if at_instant else ():
        if policy.signal.pose is not None or policy.signal.goals is not None:
            return diagnostic(
                "not_judged_live",
                policy.signal.span or requirement.entry.wording,
                requirement=requirement.id,
                what=f"`{policy.signal.name}` is the {policy.signal.origin}",
                help="emit `ros2-package`, whose node is in Python, or publish the number",
            )
    return None


def _of_computed(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 for computed signals whose last digits would differ from those of an audit."""
    at_instant = instant([requirement], gives_rounded=True)
    if at_instant is None:
        return None
    remembering = [each.signal for each in at_instant.policies if each.signal.memory is not None]
    if remembering:
        return diagnostic(
            "not_judged_live",
            remembering[0].span or requirement.entry.wording,
            requirement=requirement.id,
            what=f"`{remembering[0].name}` has memory, which the node in C++ lacks",
            help="emit `ros2-package`, whose node is in Python, or publish the value as a field",
        )
    if not at_instant.given:
        return None
    signal = at_instant.given[0]
    return diagnostic(
        "not_judged_live",
        signal.span or requirement.entry.wording,
        requirement=requirement.id,
        what=f"`{signal.name}` calls a function whose last digits differ in C++",
        help="emit `ros2-package`, whose node is in Python, or publish the value as a field",
    )


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """A folder with the name of the package.

    Raises:
        AssertionError: some requirement had to be refused.
    """
    whole = shared.package(requirements, options)
    package = replace(whole, name=f"{whole.name}_cpp", interception=None)
    values = _values(package) | {"whole": whole}
    files = {
        place.format(name=package.name): render(f"ros2cpp/{template}", **values)
        for place, template in _TEMPLATES.items()
    }
    documents = shared.documents(package, 2)
    files |= {name: documents[name] for name in ("LICENSE", "CHANGELOG.rst")}
    files |= container(package)
    files[f"config/{package.name}.yaml"] = render("ros2/config.yaml.j2", **values)
    files[f"launch/{package.name}.launch.py"] = render("ros2/launch.py.j2", **values)
    for artifact in monitor.emit(requirements, TargetOptions(one_file=True)):
        files[f"src/{artifact.path}"] = artifact.text
    folder = PurePosixPath(package.name)
    return tuple(Artifact(folder / path, text) for path, text in files.items())


def _values(package: Package) -> dict[str, Any]:
    at_instant = instant(package.requirements)
    assert at_instant is not None, "it is refused"
    names = joined_interface(package.requirements)
    places = {policy.signal.name: index for index, policy in enumerate(at_instant.policies)}
    topics = [topic.name for topic in package.topics]
    signals = [
        _signal(policy, function)
        for policy, function in zip(at_instant.policies, names.signals.signals, strict=True)
    ]
    order = {meaning.name: index for index, meaning in enumerate(at_instant.meanings)}
    return {
        "package": package,
        "apart": True,
        "version": __version__,
        "stamped": package.time is TimeSource.HEADER_STAMP,
        "messages": sorted({"rcl_interfaces", *package.dependencies}),
        "headers": sorted(
            {f"{function.package}/msg/{snake(function.message)}.hpp" for function in package.topics}
            - {"std_msgs/msg/bool.hpp", "std_msgs/msg/string.hpp"}
        ),
        "topics": [
            {
                "name": topic.name,
                "package": topic.package,
                "message": topic.message,
                "is_sensor": qos(topic) != "10",
                "signals": [function for function in signals if function["topic"] == topic.name],
            }
            for topic in package.topics
        ],
        "outlines": [function for function in signals if function["outline"]],
        "samples": [function["name"] for function in signals],
        "policies": [
            {
                "topic": topics.index(policy.signal.path.topic),
                "max_age": _optional(policy.signal.max_age),
            }
            for policy in at_instant.policies
        ],
        "any_held": any(meaning.held for meaning in at_instant.meanings),
        "meanings": _meanings(at_instant.meanings, names, places),
        "inputs": [(member, order[name]) for name, member in names.inputs.items()],
        "requirements": [
            {
                "id": requirement.id,
                "member": member,
                "topics": [topics.index(name) for name in perception.topics_of(requirement)],
                "described": description_of(requirement),
            }
            for requirement, member in zip(package.requirements, names.outcomes, strict=True)
        ],
        "words": [
            (index, word.name, [_ticks(function, order) for function in word.ticks])
            for index, requirement in enumerate(package.requirements)
            for word in witness_traces(requirement)
        ],
        "parameters": [
            (function, _literal(function.value), wrap(function.text, 80, drop_whitespace=False))
            for function in package.parameters
        ],
    }


def _ticks(ticks: RepeatedTick, order: Mapping[str, int]) -> dict[str, Any]:
    return {
        "count": ticks.count,
        "values": [(order[name], str(value).lower()) for name, value in ticks.values.items()],
        "verdict": f"FRETC_{ticks.verdict.upper()}",
        "finite": _TRUTHS[ticks.finite],
    }


def _signal(policy: SamplePolicy, function: SignalFunction) -> dict[str, Any]:
    signal = policy.signal
    return {
        "name": function.name,
        "form": function.form,
        "fields": function.fields,
        "parameters": "".join(f", double f_{field}" for field in function.fields),
        "valid": function.valid,
        "invalid": ", ".join(map(_MEANINGS.__getitem__, function.invalid)),
        "numbers": function.numbers,
        "topic": signal.path.topic,
        "path": ".".join(signal.path.fields),
        "place": signal.path.index,
        "outline": signal.reduce is Reduce.OUTLINE,
        "beside": [f", static_cast<double>(message.{field})" for field in policy.fields],
        "footprint": signal.footprint,
        "sensor": signal.sensor,
        "scale": ", ".join(float(part).hex() for part in parts(signal.unit.factor)),
    }


_MEANINGS = {
    Reading.DROP: "FRETC_DROP",
    Reading.FAR: "FRETC_FAR",
    Reading.NEAR: "FRETC_NEAR",
    Reading.UNKNOWN: "FRETC_UNKNOWABLE",
}


def _meanings(
    meanings: Sequence[PropositionFunctions], names: JoinedInterface, places: Mapping[str, int]
) -> list[dict[str, Any]]:
    held = iter(names.signals.held)
    return [
        {
            "name": names.inputs[meaning.name],
            "text": meaning.name,
            "held": [next(held).name for _ in meaning.held],
            "durations": [duration for _, duration in meaning.held],
            "signals": sorted({places[name] for name in perception.signals_of(meaning)}),
            "outer": sorted({*perception.places(meaning.truth)}),
            "lookback": perception.lookback(meaning.truth, meaning),
            "aggregate": str(meaning.aggregate).upper(),
            "on_unknown": _TRUTHS[meaning.on_unknown],
        }
        for meaning in meanings
    ]


_TRUTHS = {True: "FRETC_TRUE", False: "FRETC_FALSE", None: "FRETC_UNKNOWN"}


def _optional(value: int | None) -> str:
    return "std::nullopt" if value is None else str(value)


def _literal(value: float | Sequence[str]) -> str:
    return repr(value) if isinstance(value, float) else json.dumps(list(value))


def snake(name: str) -> str:
    """`LaserScan` → `laser_scan`, as rosidl names headers."""
    text = re.sub(r"(.)([A-Z][a-z]+)", r"\1_\2", name)
    return re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", text).lower()


TARGET = Target(
    "ros2-cpp-package",
    "a package of ROS 2 around the monitor in C, with a lifecycle node in C++",
    emit,
    refuse,
    monitor.TARGET.remark,
    refuse_project=shared.refuse_project,
    per_rule=False,
    together=True,
    reads=LOOP,
    next_step="`colcon build` builds it, in the `src` of a workspace",
)
