"""The example of docs/analyze.md is what the command prints."""

import re

import pytest

from compiler.project.folder import load_folder
from fretc.analysis.analysis import analyze
from fretc.analysis.arena.roles import roles
from fretc.analysis.assumptions import assumptions
from fretc.analysis.text_output import lines
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.printer import sentence
from tests import requirement_sets
from tests.docs.pages import FOLDER, is_current


def printed(subject: str) -> str:
    """`start, stop -> run; SENTENCE; SENTENCE`, and what is printed of these."""
    named, *sentences = subject.split("; ")
    inputs, outputs = (part.split(", ") for part in named.split(" -> "))
    chosen = requirement_sets.roles(inputs, outputs)
    found = requirement_sets.analyzed(*sentences, roles=chosen, repairs=True)
    written = {f"R{i}": sentence for i, sentence in enumerate(sentences, 1)}
    return "\n".join(f"    {line}".rstrip() for line, _ in lines(found, written))


def of_project(folder: str) -> str:
    """What is printed of the requirements of a folder of this repository."""
    project = load_folder(folder)
    assert not isinstance(project, Diagnostic)
    assumed, _ = assumptions(project.formalized, project.declarations)
    named, mistakes = roles([*project.formalized, *assumed])
    assert not mistakes
    found = analyze(project.formalized, named, assumed)
    written = {requirement.id: sentence(requirement.written) for requirement in project.formalized}
    return "\n".join(f"    {line}".rstrip() for line, _ in lines(found, written))


@pytest.mark.slow
def test_the_examples_are_what_is_printed(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(FOLDER.parent)
    makers = {"analysis": printed, "project": of_project}
    is_current("analyze.md", makers, request, costly=["requirements/agv"])


def test_every_key_of_the_json_is_told() -> None:
    from fretc.analysis.findings import Analysis

    page = (FOLDER / "analyze.md").read_text("utf-8")
    told = set(re.findall(r"`(\w+)`", page.partition("## As JSON")[2]))
    assert {*Analysis.__struct_fields__} - {"schema", "fretc"} <= told
