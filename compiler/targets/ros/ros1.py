"""`--emit ros1-package`: a catkin package with a node, its monitors, and the interceptor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import interceptor
from compiler.targets.python.monitor import remark
from compiler.targets.ros import package as shared
from compiler.targets.target import DEFAULT, LOOP, Target, TargetOptions


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """One folder, to be put into the `src` of a workspace."""
    package = shared.package(requirements, options)
    return tuple(
        Artifact(PurePosixPath(package.name, path), text) for path, text in _files(package)
    )


def _files(package: shared.Package) -> Iterator[tuple[str, str]]:
    given = {
        "package": package,
        "programs": ["monitor_node.py", *([interceptor.NAME] if package.interception else [])],
        "remaps": _remaps(package),
        "version": __version__,
    }
    for template, path in _TEMPLATES.items():
        yield path.format(package.name), render(f"ros1/{template}.j2", **given)
    yield f"src/{package.name}/__init__.py", ""
    for path, text in shared.modules(package).items():
        yield f"src/{package.name}/{path}", text
    if package.interception:
        text = interceptor.text(replace(package.interception, ros=1), package.bindings)
        yield f"scripts/{interceptor.NAME}", text
    yield "test/test_monitor.py", shared.tests(package)
    yield from shared.documents(package, 1).items()


_TEMPLATES = {
    "package.xml": "package.xml",
    "CMakeLists.txt": "CMakeLists.txt",
    "setup.py": "setup.py",
    "launch": "launch/{0}.launch",
    "config.yaml": "config/{0}.yaml",
    "monitor_node.py": "scripts/monitor_node.py",
}
"""Each template with its path in the package."""


def _remaps(package: shared.Package) -> list[tuple[str, str]]:
    """The arguments of the launch file, each with its topic."""
    node = package.interception
    if node is None:
        return [("stop", package.stop)]
    named = {"stop": node.stop, "command": node.command, "output": node.output, "scan": node.scan}
    return [(name, topic) for name, topic in named.items() if topic]


TARGET = Target(
    "ros1-package",
    "a catkin package: monitor, node and interceptor for ROS 1",
    emit,
    shared.refuse,
    remark,
    remarks=shared.remarks,
    refuse_project=shared.refuse_project,
    per_rule=False,
    together=True,
    reads=LOOP,
    next_step="put its folder into the `src` of a catkin workspace; see its README.md",
)
