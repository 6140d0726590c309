"""An analysis as evidence: whatever it read and whatever it concluded stands in the file."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pytest

from compiler.files.records import plain, replace
from compiler.formalization.formalized import FormalizedRequirement
from compiler.project.folder import load
from fretc.analysis.analysis import analyze
from fretc.analysis.arena.roles import roles
from fretc.analysis.assumptions import assumptions
from fretc.analysis.evidence import AnalysisDocument, AnalyzedSet, document, read, suspicions
from fretish.diagnostics.diagnostic import Code, Diagnostic

SENTENCES = {
    "R1": "whenever start the line shall within 200 milliseconds satisfy run",
    "R2": "upon stop the line shall always satisfy speed < limit",
}
TABLES = """\
[clock]
time = "log_time"
tick = "100 ms"

[variable.start]
role = "input"

[variable.stop]
role = "input"

[variable.run]
role = "output"

[variable.speed]
role = "output"
type = "double"

[variable.limit]
value = "3.0"

[[assume.requirement]]
id = "A1"
sentence = "the operator shall never satisfy start & stop"
"""


def rules_of(
    folder: Path, tables: str = TABLES, sentences: Mapping[str, str] = SENTENCES
) -> tuple[tuple[FormalizedRequirement, ...], tuple[FormalizedRequirement, ...]]:
    """Requirements and assumptions of a project."""
    texts = (f'+++\nid = "{id}"\n+++\n{text}\n' for id, text in sentences.items())
    (folder / "r.fret").write_text("\n".join(texts))
    (folder / "bindings.toml").write_text(tables)
    project = load([str(folder / "r.fret")])
    assumed, mistakes = assumptions(project.formalized, project.declarations)
    assert mistakes == ()
    return project.formalized, assumed


def analyzed(
    requirements: tuple[FormalizedRequirement, ...], assumed: tuple[FormalizedRequirement, ...]
) -> AnalysisDocument:
    chosen, mistakes = roles([*requirements, *assumed])
    assert not mistakes
    return document(requirements, assumed, analyze(requirements, chosen, assumed), as_fret=False)


@pytest.fixture(scope="module")
def known(tmp_path_factory: pytest.TempPathFactory) -> AnalysisDocument:
    return analyzed(*rules_of(tmp_path_factory.mktemp("known")))


def test_nothing_is_suspect_while_nothing_changes(tmp_path: Path, known: AnalysisDocument) -> None:
    assert [*suspicions(known, *rules_of(tmp_path))] == []


@pytest.mark.parametrize(
    ("old", "new", "why"),
    [
        ('tick = "100 ms"', 'tick = "50 ms"', "R1 has changed since"),
        ('[variable.start]\nrole = "input"', '[variable.start]\nrole = "output"', "R1 has changed"),
        ('value = "3.0"', 'value = "4.0"', "R2 has changed since"),
        ('type = "double"', 'type = "integer"', "R2 has changed since"),
        ("never satisfy", "always satisfy", "assumption A1 has changed since"),
        ('id = "A1"', 'id = "A2"', "assumption A1 is no longer part of the set"),
    ],
)
def test_whatever_the_analysis_read_makes_it_suspect(
    tmp_path: Path, known: AnalysisDocument, old: str, new: str, why: str
) -> None:
    assert TABLES.count(old) == 1
    (first, *_) = suspicions(known, *rules_of(tmp_path, TABLES.replace(old, new)))
    assert first.startswith(why)


def test_the_set_itself_counts(tmp_path: Path, known: AnalysisDocument) -> None:
    """A new member may fight with the others, and without one the others may do less."""
    changed = {"R1": SENTENCES["R1"], "R3": SENTENCES["R2"]}
    assert [*suspicions(known, *rules_of(tmp_path, sentences=changed))] == [
        "R2 is no longer part of the set",
        "R3 was not part of the set",
    ]


def test_an_answer_to_the_question_of_fret_is_no_answer_to_ours(
    tmp_path: Path, known: AnalysisDocument
) -> None:
    (why,) = suspicions(replace(known, as_fret=True), *rules_of(tmp_path))
    assert why == "it answers FRET's question, in which `eventually` means at once"


def test_words_and_places_do_not_count(tmp_path: Path, known: AnalysisDocument) -> None:
    same = {"R1": f"  {SENTENCES['R1'].replace('200 milli', '200  milli')}", "R2": SENTENCES["R2"]}
    assert [*suspicions(known, *rules_of(tmp_path, sentences=same))] == []


# Files ----------------------------------------------------------------------------------------


def written(folder: Path, content: Any) -> str:
    path = folder / "analysis.json"
    path.write_text(json.dumps(content))
    return str(path)


def test_what_was_written_is_read(tmp_path: Path, known: AnalysisDocument) -> None:
    found = read(written(tmp_path, plain(known)))
    assert isinstance(found, AnalyzedSet)
    assert found.document == known


Change = Callable[[Any], object]


@pytest.mark.parametrize(
    "change",
    [
        lambda c: c["analysis"].update(verdict="unrealizable"),
        lambda c: c["analysis"].update(verdict="not checked"),
        lambda c: c["analysis"]["components"][0].update(verdict="unrealizable"),
        lambda c: c["analysis"]["components"][0].update(verdict="not checked"),
        lambda c: c["analysis"]["components"].pop(),
        lambda c: c["requirements"].pop("R1"),
        lambda c: c["requirements"].update(R9=c["requirements"]["R1"]),
        lambda c: c["analysis"]["conflicts"].append(
            {"requirements": ["R1"], "play": [], "because": "", "loop": None}
        ),
        lambda c: c.update(more=1),
        lambda c: c.pop("fretc"),
    ],
)
def test_a_verdict_that_does_not_follow_is_refused(
    tmp_path: Path, known: AnalysisDocument, change: Change
) -> None:
    content = json.loads(json.dumps(plain(known)))
    change(content)
    found = read(written(tmp_path, content))
    assert isinstance(found, Diagnostic)
    assert found.code is Code.BAD_EVIDENCE
    assert found.help == "analyze again: `fretc analyze FILE...`"


@pytest.mark.parametrize("text", ["", "{", "[]", "3", "[" * 100_000, '{"a": 1e999}'])
def test_what_is_no_analysis_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "analysis.json"
    path.write_text(text)
    found = read(str(path))
    assert isinstance(found, Diagnostic)
    assert found.code is Code.BAD_EVIDENCE
