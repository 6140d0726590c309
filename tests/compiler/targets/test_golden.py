"""Whole outputs for the paper's requirement, as a person reads them."""

from collections.abc import Callable
from pathlib import Path

import pytest

from compiler.emit import TARGETS
from compiler.project.folder import load
from compiler.targets.target import TargetOptions
from monitors.source_text import interceptor, kernel
from tests.emitting import emitted

SHARED = {"monitor.py", "perception.py", "interceptor.py", "test_monitor.py", "perception.hpp"}
SHARED |= {f"monitors{part}.{kind}" for part in ("", "_signals") for kind in ("c", "h")}
"""What packages of ROS carry that is in all of them, or that other targets make."""
R1 = Path(__file__).parent.parent.parent.parent / "requirements"


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
def test_the_papers_requirement(
    target: str, golden: Callable[[str, str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(R1.parent)
    project = load(["requirements/r1.fret"])
    assert project.diagnostics == ()
    if target == "prism":  # it is for requirements with a probability
        return
    if target in ("ajpf-bundle", "agent-runtime"):  # in their own tests: `run.py` is no golden file
        return
    options = TargetOptions(declarations=project.declarations, attribution=project.attribution)
    for artifact in TARGETS[target].emit(project.formalized, options):
        if target.startswith("ros") and artifact.path.name in SHARED:
            continue
        golden(f"{target}/{artifact.path}", without_run_time(artifact.text))


def without_run_time(text: str) -> str:
    """The text, with a line in place of each module that all such files have."""
    text = text.replace(kernel().text, "# (the text of monitors/kernel)")
    return text.replace(interceptor().text, "# (the text of monitors/interceptor.py)")


def test_a_monitor_has_the_text_of_its_run_time() -> None:
    (text,) = emitted("monitor", "the sw shall eventually satisfy p").values()
    assert text.count(kernel().text) == 1


def test_a_probable_requirement(golden: Callable[[str, str], None]) -> None:
    sentence = "whenever too_close agilex_agent shall with probability >= 0.99 within 3 ticks"
    for name, text in emitted("prism", f"{sentence} satisfy stopped").items():
        golden(f"prism/{name}", text)


def test_every_golden_file_belongs_to_a_target_or_to_a_draft() -> None:
    folder = R1.parent / "tests/golden"
    assert {path.name for path in folder.iterdir()} == {*TARGETS, "bindings"}
    several = {"prism": 2, "dafny": 2, "c": 4, "rust": 2, "js": 2, "java": 2}
    for path in folder.iterdir():
        assert len(list(path.iterdir())) == several.get(path.name, 1), path
