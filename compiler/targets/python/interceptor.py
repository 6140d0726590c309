"""`--emit interceptor`: the node between the planner and the wheels, as one Python file.

The core is the text of `monitors/interceptor.py`, and the options come from the bindings. Below a
marked line is a thin ROS node around them. All requirements share it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.interceptor_options import options as counted
from compiler.targets.interceptor_options import repetition, ticks
from compiler.targets.target import DEFAULT, LOOP, Target, TargetOptions
from fretish.bindings.declarations import Declarations, Interception, InterceptorForm
from fretish.bindings.tables.interceptor import TABLE
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from monitors.source_text import interceptor as core

NAME = "interceptor.py"
MARKER = "# The ROS node ".ljust(97, "-")
"""The line between the core with its options and the node."""


def refuse(options: TargetOptions) -> Diagnostic | None:
    """F323: the topics of the interceptor are not declared."""
    declared = options.declarations
    if declared is not None and declared.interceptor is not None:
        return None
    source = Source("bindings.toml", "") if declared is None else declared.source
    subject = "there are no bindings, and so" if declared is None else "the bindings declare"
    return diagnostic(
        "no_interceptor", source.span().part(0, 0), who=subject, source=source.name, paste=TABLE
    )


# Remarks --------------------------------------------------------------------------------------


def remarks(options: TargetOptions) -> tuple[Diagnostic, ...]:
    """F630 to F633: hazards that remain even if the node works as declared."""
    declared = options.declarations
    if declared is None or declared.interceptor is None:
        return ()
    node = declared.interceptor
    latched = (_latching(node),) if node.latching else ()
    if node.form is InterceptorForm.EVENT:
        return (*latched, _event_driven(node))
    return (*latched, *_unwatched(node), *_short_hold(declared, node))


def _latching(node: Interception) -> Diagnostic:
    return diagnostic("latching", node.span)


def _event_driven(node: Interception) -> Diagnostic:
    return diagnostic("event_driven", node.span)


def _unwatched(node: Interception) -> Iterator[Diagnostic]:
    if not node.stop_timeout:
        yield diagnostic("no_stop_timeout", node.span, stop=node.stop)
    if not node.scan_timeout:
        yield diagnostic("no_scan_timeout", node.span)


def _short_hold(declared: Declarations, node: Interception) -> Iterator[Diagnostic]:
    """The warning that `lost` requests may be lost in a row before one arrives."""
    assumed, period = declared.assumed, declared.clock.period
    if assumed is None or not assumed.lost or period is None:
        return
    sure = max(ticks(node.hold, node.period) - 1, 0) * node.period
    gap = assumed.lost * period * (repetition(assumed, period) or 1)
    if sure > gap:
        return
    yield diagnostic(
        "short_hold",
        node.span,
        held=_duration(sure),
        gap=_duration(gap),
        least=_duration(gap + node.period),
    )


# The file -------------------------------------------------------------------------------------


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """`interceptor.py`.

    Raises:
        AssertionError: the target had to be refused.
    """
    assert options.declarations is not None
    assert options.declarations.interceptor is not None
    source = PurePosixPath(options.declarations.source.name).name
    return (Artifact(PurePosixPath(NAME), text(options.declarations.interceptor, source)),)


def text(interception: Interception, source: str) -> str:
    """The file.

    Args:
        interception: what the bindings declare.
        source: the name of the bindings' file.
    """
    return render(
        "interceptor/interceptor.py.j2",
        imports=core().imports,
        core=core().text,
        options=[{"name": n, "value": v, "why": w} for n, v, w in _options(interception)],
        node=_node(interception),
        marker=MARKER,
        source=source,
        version=__version__,
    )


def _options(node: Interception) -> Iterator[tuple[str, Any, str]]:
    """The name, the value and the source of each option."""
    core_options = counted(node)
    for name in ("hold", "stop_timeout", "scan_timeout", "command_timeout"):
        duration = getattr(node, name)
        every = f"at {_duration(node.period)} a tick"
        why = f"{name} = {_duration(duration)}, {every}" if duration else f"no {name} is declared"
        yield name, getattr(core_options, name), why
    yield "event_driven", core_options.event_driven, f"form = {node.form}"
    yield "latching", core_options.latching, f"latching = {str(node.latching).lower()}"


def _node(node: Interception) -> dict[str, Any]:
    timed = node.form is InterceptorForm.TIMER
    return {
        "ros": node.ros,
        "stop": node.stop,
        "command": node.command,
        "output": node.output,
        "scan": node.scan,
        "timed": timed,
        "period": node.period / 10**9,
        "summary": _summary(node),
        "statuses": _STATUSES[node.ros],
    }


_STATUSES = {
    1: "3 no ROS master has answered, 4 ROS has ended it: another node has taken its name, say",
    2: "4 ROS has ended it",
}
"""Further exit statuses of the node in `--help`, for each ROS."""


def _summary(node: Interception) -> str:
    """The summary in `--help`."""
    when = (
        f"Every {_duration(node.period)}, on each command and at once on a request to stop"
        if node.form is InterceptorForm.TIMER
        else "On each command"
    )
    scan = f", {node.scan} (LaserScan)" if node.scan else ""
    return (
        f"Hears {node.stop} (Bool), {node.command} (Twist){scan}.\n"
        f"{when}\n"
        f"it says the last command on {node.output},\nor zero where the robot must stand."
    )


_UNITS = (("s", 10**9), ("ms", 10**6), ("us", 10**3), ("ns", 1))


def _duration(nanoseconds: int) -> str:
    """`1200 ms`: in the largest unit in which it is a whole number."""
    unit, size = next(pair for pair in _UNITS if nanoseconds % pair[1] == 0)
    return f"{nanoseconds // size} {unit}"


TARGET = Target(
    "interceptor",
    "the node between the planner and the wheels, in Python",
    emit,
    refuse_project=refuse,
    remarks=remarks,
    per_rule=False,
    of_bindings=True,
    reads=LOOP,
)
