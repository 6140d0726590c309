"""A layout of Foxglove beside the annotations: states, messages, and the signals of requirements.

On the left the states of all requirements and what changed; on the right a tab for each
requirement, with its states and a plot of the numbers that it reads.

Source: https://docs.foxglove.dev/docs/visualization/layouts and .../message-path-syntax; panels
`StateTransitions`, `Plot`, `RosOut` (the Log panel) and `Tab`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from compiler.files.templating import to_json
from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.evidence.schema import Result
from fretc.audit.evidence.verdicts import severity
from fretc.audit.outputs.annotations import VERDICTS, state_topic
from fretish.bindings.declarations import Signal

LAYOUT = "foxglove-layout.json"
_PLAIN = re.compile(r"/?\w+(?:/\w+)*", re.ASCII)
"""A topic that needs no quotes in a message path."""
_MOST_PLOTTED = 8
"""The most signals in one plot."""


def layout_file(
    results: Sequence[Result], requirements: Sequence[FormalizedRequirement], folder: Path
) -> dict[Path, bytes]:
    """The layout file; empty if no run could be read.

    Args:
        results: one for each run and requirement.
        requirements: all requirements of the results.
        folder: the folder of the annotations.
    """
    read = [result for result in results if result.start_ns is not None]
    ids = dict.fromkeys(result.requirement for result in read)
    if not ids:
        return {}
    worst = {id: min(severity(r.verdict) for r in read if r.requirement == id) for id in ids}
    by_id = {requirement.id: requirement for requirement in requirements}
    chosen = [by_id[id] for id in sorted(ids, key=lambda id: worst[id]) if id in by_id]
    return {folder / LAYOUT: f"{to_json(layout(chosen))}\n".encode()}


def layout(requirements: Sequence[FormalizedRequirement]) -> dict[str, Any]:
    """The layout for some requirements, in their order."""
    panels: dict[str, Any] = {
        "StateTransitions!all": {"paths": list(map(_states, requirements)), "isSynced": True},
        "RosOut!verdicts": {"topicToRender": VERDICTS, "minLogLevel": 1, "searchTerms": []},
    }
    tabs = []
    for number, requirement in enumerate(requirements, 1):
        states, plot = f"StateTransitions!{number}", f"Plot!{number}"
        panels[states] = {"paths": [_states(requirement)], "isSynced": True}
        whole: Any = states
        plotted = _signals(requirement)
        if plotted:
            panels[plot] = {
                "title": requirement.id,
                "paths": list(map(_line, plotted)),
                "xAxisVal": "timestamp",
                "isSynced": True,
                "showLegend": True,
            }
            whole = _split("column", states, plot, 25)
        tabs.append({"title": requirement.id, "layout": whole})
    panels["Tab!requirements"] = {"activeTabIdx": 0, "tabs": tabs}
    left = _split("column", "StateTransitions!all", "RosOut!verdicts", 60)
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": _split("row", left, "Tab!requirements", 50),
    }


def _split(direction: str, first: Any, second: Any, share: int) -> dict[str, Any]:
    return {"direction": direction, "first": first, "second": second, "splitPercentage": share}


def _states(requirement: FormalizedRequirement) -> dict[str, Any]:
    """The row of states of a requirement."""
    title = (
        f"{requirement.entry.title} ({requirement.id})"
        if requirement.entry.title
        else requirement.id
    )
    path = f"{_topic(state_topic(requirement.id))}.state"
    return {"value": path, "label": title, "timestampMethod": "receiveTime"}


def _signals(requirement: FormalizedRequirement) -> list[Signal]:
    """The signals that the requirement reads from a single number of a message."""
    declared = requirement.declarations
    if declared is None:
        return []
    names = dict.fromkeys(
        signal
        for name in requirement.watched
        if name in declared.propositions
        for signal in declared.propositions[name].signals
    )
    signals = (declared.signals[name] for name in names if name in declared.signals)
    single = [each for each in signals if not each.values and not each.path.each]
    return [each for each in single if each.pose is None and each.goals is None][:_MOST_PLOTTED]


def _line(signal: Signal) -> dict[str, Any]:
    """The line of a signal in a plot, in the unit of the messages."""
    path = signal.path
    index = "" if path.index is None else f"[{path.index}]"
    value = f"{_topic(path.topic)}.{'.'.join(path.fields)}{index}"
    unit = f" ({signal.unit_name})" if signal.unit_name else ""
    label = f"{signal.name}{unit}"
    return {"value": value, "label": label, "enabled": True, "timestampMethod": "receiveTime"}


def _topic(name: str) -> str:
    """The topic, quoted for a message path if necessary."""
    if _PLAIN.fullmatch(name):
        return name
    return '"{}"'.format(name.replace("\\", "\\\\").replace('"', '\\"'))
