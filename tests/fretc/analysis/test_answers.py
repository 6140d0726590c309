"""Answers of earlier analyses: reused as long as nothing that they depend on has changed."""

import hashlib
import hmac
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import pytest

from compiler.project.folder import load_folder
from compiler.project.project import Project
from fretc.analysis import answers as kept_answers
from fretc.analysis import worker
from fretc.analysis.analysis import AnalysisOptions, Finding, Job, jobs
from fretc.analysis.answers import AnswerFile, KeptAnswers, answers
from fretc.analysis.arena.systems import systems
from fretc.analysis.assumptions import assumptions, guarantees
from fretc.analysis.findings import OpenQuestion
from tests.command import Fretc, write
from tests.requirement_sets import requirements, roles

SENTENCES = {
    "R1": "whenever start the line shall within 2 ticks satisfy run",
    "R2": "upon stop the line shall for 3 ticks satisfy !run",
    "R3": "whenever hot the line shall immediately satisfy alarm",
    "R4": "whenever warm the line shall immediately satisfy speed <= 2 * ramp",
}
BINDINGS = """
[clock]
tick = "100 ms"

[signal.temperature]
path = "/t.temperature"
type = "sensor_msgs/Temperature"
unit = "K"
role = "input"

[proposition.hot]
expr = "temperature > 350 K"

[variable]
start = {role = "input"}
stop = {role = "input"}
run = {role = "output"}
alarm = {role = "output"}
speed = {role = "output", type = "double"}
warm = {value = "start & !stop"}
ramp = {role = "output", type = "double"}

[[assume.requirement]]
id = "A1"
text = ""
sentence = "the operator shall never satisfy start & stop"
"""


def work(
    folder: Path,
    sentences: Mapping[str, str] = SENTENCES,
    bindings: str = BINDINGS,
    options: AnalysisOptions | None = None,
) -> tuple[Job, ...]:
    """The questions about a project."""
    folder.mkdir(exist_ok=True)
    text = "".join(f'+++\nid = "{id}"\n+++\n{each}\n\n' for id, each in sentences.items())
    (folder / "set.fret").write_text(text)
    (folder / "bindings.toml").write_text(bindings)
    project = load_folder(str(folder))
    assert isinstance(project, Project)
    assert not [each for each in project.diagnostics if each.is_error]
    assumed, _ = assumptions(project.in_force, project.declarations)
    (system,) = systems(guarantees(project.in_force), assumed).every
    return jobs(system.requirements, system.roles, system.assumptions, options or AnalysisOptions())


def all_of(questions: Sequence[Job]) -> KeptAnswers:
    """An empty answer to each question."""
    return KeptAnswers().with_more(questions, dict.fromkeys(range(len(questions)), ()))


def unknown(before: Sequence[Job], now: Sequence[Job]) -> str:
    """The titles of the questions that must be asked again."""
    known = all_of(before).of(now)
    return "\n".join(job.title for index, job in enumerate(now) if index not in known)


def changed(old: str, new: str) -> str:
    assert BINDINGS.count(old) == 1, old
    return BINDINGS.replace(old, new)


def test_nothing_is_asked_again_if_only_the_layout_changes(tmp_path: Path) -> None:
    spaced = {id: each.replace(" shall ", "   shall ") for id, each in SENTENCES.items()}
    again = work(tmp_path / "b", spaced, f"# a comment\n{BINDINGS}")
    assert unknown(work(tmp_path / "a"), again) == ""


@pytest.mark.parametrize(
    ("id", "sentence", "others"),
    [
        ("R1", "whenever start the line shall within 3 ticks satisfy run", "R3"),
        ("R2", "upon stop the line shall for 3 ticks satisfy run", "R3"),
        ("R3", "whenever hot the line shall immediately satisfy !alarm", "R1"),
        ("R4", "whenever warm the line shall immediately satisfy speed < 2 * ramp", "R3"),
    ],
)
def test_a_changed_sentence_asks_again_what_it_touches(
    tmp_path: Path, id: str, sentence: str, others: str
) -> None:
    titles = unknown(work(tmp_path / "a"), work(tmp_path / "b", {**SENTENCES, id: sentence}))
    assert id in titles
    assert f"can {others}" not in titles


@pytest.mark.parametrize(
    ("old", "new", "id"),
    [
        ('run = {role = "output"}', 'run = {role = "input"}', "R1"),
        ('stop = {role = "input"}', 'stop = {role = "output"}', "R1"),
        ('alarm = {role = "output"}', 'alarm = {role = "input"}', "R3"),
        ('speed = {role = "output", type = "double"}',
         'speed = {role = "output", type = "integer"}', "R4"),
        ('ramp = {role = "output", type = "double"}',
         'ramp = {role = "output", type = "integer"}', "R4"),
        ('"start & !stop"', '"start | stop"', "R4"),
        ("350 K", "351 K", "R3"),
        ('unit = "K"', 'unit = "K"\nmax_age = "1 s"', "R3"),
        ("/t.temperature", "/u.temperature", "R3"),
        ("350 K\"", "350 K\"\non_unknown = true", "R3"),
        ("350 K\"", "350 K\"\nagg = \"any\"", "R3"),
        ("start & stop", "start | stop", "R1"),
        ("start & stop", "start", "R1"),
        ('tick = "100 ms"', 'tick = "50 ms"', "R3"),
    ],
)  # fmt: skip
def test_a_changed_declaration_asks_again_what_it_touches(
    tmp_path: Path, old: str, new: str, id: str
) -> None:
    before, now = work(tmp_path / "a"), work(tmp_path / "b", bindings=changed(old, new))
    titles = unknown(before, now)
    assert id in titles
    touches_all = "tick" in old or "R1" in id
    assert touches_all or f"can {'R1' if id == 'R3' else 'R3'}" not in titles


def test_another_question_or_time_limit_asks_again(tmp_path: Path) -> None:
    before = work(tmp_path / "a")
    for options in (
        AnalysisOptions(seconds=10),
        AnalysisOptions(as_fret=True),
        AnalysisOptions(repairs=False),
    ):
        now = work(tmp_path / "a", options=options)
        assert len(unknown(before, now).splitlines()) == len(now)


def test_a_new_and_a_removed_assumption_ask_again(tmp_path: Path) -> None:
    before, free = work(tmp_path / "a"), BINDINGS[: BINDINGS.index("[[assume")]
    without = work(tmp_path / "b", bindings=free)
    assert len(unknown(before, without).splitlines()) == len(without)
    assert len(unknown(without, before).splitlines()) == len(before)


# Reuse


@pytest.fixture
def _here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Questions are answered in this process."""
    monkeypatch.setattr(worker, "FORKS", False)


CONFLICT = (
    "whenever a the sw shall immediately satisfy x",
    "whenever b the sw shall immediately satisfy !x",
    "the sw shall always satisfy y",
)
NAMED = roles(["a", "b"], ["x", "y"])


def about(*sentences: str) -> tuple[Job, ...]:
    return jobs(requirements(*sentences), NAMED, (), AnalysisOptions())


def asked(
    questions: Sequence[Job], kept: KeptAnswers
) -> tuple[list[Finding], KeptAnswers, bool, list[str]]:
    titles: list[str] = []
    return *answers(questions, kept, lambda number, title: titles.append(title)), titles


@pytest.mark.usefixtures("_here")
def test_reused_answers_are_those_of_a_new_analysis() -> None:
    findings, kept, _, titles = asked(about(*CONFLICT), KeptAnswers())
    assert len(titles) == len(about(*CONFLICT))
    again, same, _, titles = asked(about(*CONFLICT), kept)
    assert (again, same, titles) == (findings, kept, [])
    assert {type(each).__name__ for each in findings} > {"Component", "Conflict", "Repair"}
    other = (*CONFLICT[:2], "the sw shall always satisfy !y")
    changed, _, _, titles = asked(about(*other), kept)
    fresh, *_ = asked(about(*other), KeptAnswers())
    assert titles
    assert all("R1" not in title for title in titles)
    assert [each for each in changed if not hasattr(each, "seconds")] == [
        each for each in fresh if not hasattr(each, "seconds")
    ]


def answered(name: str, problem: str, error: type[BaseException] | None = None) -> Job:
    """A question whose answer is its name, or that fails."""

    def ask(known: Sequence[Finding]) -> Iterator[Finding]:
        if error is not None:
            raise error
        yield OpenQuestion(name, f"after {len(known)}")

    return Job(name, ask, lambda why: OpenQuestion(name, f"lost: {why}"), lambda: problem)


@pytest.mark.usefixtures("_here")
@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError])
def test_what_was_answered_before_a_failure_is_kept_and_the_rest_is_asked_again(
    error: type[BaseException],
) -> None:
    names = ("a", "b", "c")
    broken = [answered(each, each, error if each == "b" else None) for each in names]
    findings, kept, is_stopped, _ = asked(broken, KeptAnswers())
    assert is_stopped is (error is KeyboardInterrupt)
    assert findings[0] == OpenQuestion("a", "after 0")
    assert findings[1].why.startswith("lost: ")  # type: ignore[union-attr]
    _, _, _, titles = asked([answered(each, each) for each in names], kept)
    assert titles == (["b", "c"] if is_stopped else ["b"])


@pytest.mark.usefixtures("_here")
def test_of_a_problem_all_questions_are_asked_or_none() -> None:
    halves = [answered("a", "one"), answered("b", "one", MemoryError), answered("c", "other")]
    _, kept, _, _ = asked(halves, KeptAnswers())
    _, _, _, titles = asked(
        [answered("a", "one"), answered("b", "one"), answered("c", "other")], kept
    )
    assert titles == ["a", "b"]


# Files


def test_a_file_is_believed_only_for_its_place_its_user_and_its_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = KeptAnswers().with_more(
        [answered("a", "one")], {0: (OpenQuestion("can R1 be satisfied?", "no time"),)}
    )
    file = AnswerFile(tmp_path / "analysis.answers", b"k" * 32)
    assert file.read() == KeptAnswers()
    assert file.write(kept) is None
    assert file.read() == kept
    assert AnswerFile(file.path, b"j" * 32).read() == KeptAnswers()
    copy = file.path.rename(tmp_path / "other.answers")
    assert AnswerFile(copy, file.key).read() == KeptAnswers()
    text = copy.read_text()
    file.path.write_text(text)
    assert file.read() == kept
    file.path.write_text(text.replace("no time", "no tame"))
    assert file.read() == KeptAnswers()
    file.path.write_bytes(b"\xff\x00")
    assert file.read() == KeptAnswers()
    file.path.write_text(text)
    monkeypatch.setattr(kept_answers, "build_id", lambda: "another build")
    assert file.read() == KeptAnswers()


def test_the_mark_covers_the_place_and_the_whole_content(tmp_path: Path) -> None:
    file = AnswerFile(tmp_path / "a.answers", b"k" * 32)
    file.write(KeptAnswers())
    mark, _, body = file.path.read_text().partition("\n")
    text = f"{os.path.realpath(file.path)}\n{hashlib.sha256(body.encode()).hexdigest()}"
    assert mark == hmac.digest(file.key, text.encode(), "sha256").hex()


@pytest.mark.slow
def test_a_second_analysis_asks_only_what_has_changed(fretc: Fretc) -> None:
    header = '+++\nid = "{}"\n+++\n{}\n'
    for number, sentence in enumerate(CONFLICT, 1):
        write(f"set/r{number}.fret", header.format(f"R{number}", sentence))
    write(
        "set/bindings.toml",
        "".join(f'[variable.{name}]\nrole = "{role}"\n' for name, role in NAMED.items()),
    )
    first, document = fretc("analyze", "set"), Path("build/analysis.json").read_bytes()
    assert "answered before" not in first.err
    second = fretc("analyze", "set")
    assert (second.status, second.out) == (first.status, first.out)
    assert "16 of 16 questions were answered before" in second.err
    assert Path("build/analysis.json").read_bytes() == document
    write("set/r3.fret", header.format("R3", "the sw shall always satisfy y | a"))
    third = fretc("analyze", "set")
    assert "questions were answered before" in third.err
    assert "16 of 16" not in third.err
    third_document = Path("build/analysis.json").read_bytes()
    Path("build/analysis.answers").unlink()
    fourth = fretc("analyze", "set")
    assert third.out == fourth.out
    assert third_document == Path("build/analysis.json").read_bytes()
