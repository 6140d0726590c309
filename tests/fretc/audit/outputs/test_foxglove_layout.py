"""The layout has a line and a tab for each requirement, and only panels that it declares."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fretc.audit.outputs.annotations import state_topic
from fretc.audit.outputs.foxglove_layout import LAYOUT, layout, layout_file
from tests.fretc.audit import results
from tests.fretc.report.cases import project, requirement

SENTENCE = "whenever near the robot shall within 3 ticks satisfy stopped"


def leaves(tree: Any) -> Iterator[str]:
    if isinstance(tree, str):
        yield tree
    else:
        yield from leaves(tree["first"])
        yield from leaves(tree["second"])


def test_each_requirement_has_a_line_and_a_tab_with_its_numbers(tmp_path: Path) -> None:
    known = project(tmp_path, requirement("R1", SENTENCE), requirement("R-2", SENTENCE))
    content = layout(known.formalized)
    panels = content["configById"]
    assert [path["value"] for path in panels["StateTransitions!all"]["paths"]] == [
        "/fretc/R1.state",
        '"/fretc/R-2".state',
    ]
    tabs = panels["Tab!requirements"]["tabs"]
    assert [tab["title"] for tab in tabs] == ["R1", "R-2"]
    used = [*leaves(content["layout"]), *(leaf for tab in tabs for leaf in leaves(tab["layout"]))]
    assert sorted(used) == sorted(panels)
    # The clearance is the least of an array, and no line of a plot.
    assert [(path["value"], path["label"]) for path in panels["Plot!1"]["paths"]] == [
        ("/odom.twist.twist.linear.x", "vx (m/s)")
    ]


def test_violated_requirements_come_first(tmp_path: Path) -> None:
    known = project(tmp_path, requirement("R1", SENTENCE), requirement("R2", SENTENCE))
    of = {"start_ns": 0, "end_ns": 1}
    audited = [
        results.result(requirement="R1", verdict="satisfied", **of),
        results.result(requirement="R2", verdict="violated", **of),
    ]
    ((path, data),) = layout_file(audited, known.formalized, Path("out")).items()
    assert path == Path("out") / LAYOUT
    lines = json.loads(data)["configById"]["StateTransitions!all"]["paths"]
    assert [line["label"] for line in lines] == ["Title of R2 (R2)", "Title of R1 (R1)"]
    assert lines[0]["value"] == f"{state_topic('R2')}.state"
    assert not layout_file([results.result(requirement="R1")], known.formalized, Path("out"))
