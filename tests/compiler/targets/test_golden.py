"""Whole outputs for the paper's requirement, as a person reads them."""

from collections.abc import Callable
from pathlib import Path

import pytest

from compiler.project import load
from compiler.targets import TARGETS

R1 = Path(__file__).parent.parent.parent.parent / "requirements"


@pytest.mark.parametrize("target", TARGETS)
def test_the_papers_requirement(
    target: str, golden: Callable[[str, str], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(R1.parent)
    project = load(["requirements/r1.fret"])
    assert project.diagnostics == ()
    for artifact in TARGETS[target].emit(project.rules):
        golden(f"{target}/{artifact.path}", artifact.text)


def test_every_golden_file_belongs_to_a_target_or_to_a_draft() -> None:
    folder = R1.parent / "tests/golden"
    assert {path.name for path in folder.iterdir()} == {*TARGETS, "bindings"}
    assert all(len(list(path.iterdir())) == 1 for path in folder.iterdir())
