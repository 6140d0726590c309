"""Results of an earlier audit: the same as judged again, for each change of what they rest on."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest

from compiler.files.records import replace as record_with
from compiler.project.folder import load
from compiler.project.project import Project
from fretc.audit import many_logs as auditing
from fretc.audit import one_log
from fretc.audit.evidence.schema import Result
from fretc.audit.many_logs import LogResult, audit_log
from fretc.audit.plan import Plan, keys, planned
from fretc.logs.signals.integrity import Integrity
from tests.effort import some
from tests.fretc.logs.logs import MS, S, Sent, number, write

BINDINGS = """
[clock]
tick = "100 ms"
[signal.x]
path = "/x.data"
unit = "m"
max_age = "300 ms"
[signal.y]
path = "/y.data"
unit = "m"
[signal.z]
path = "/z.data"
unit = "m"
[proposition.near]
expr = "x < 50 cm"
[proposition.slow]
expr = "y < 0.3"
[proposition.high]
expr = "z > 1 m"
"""
SENTENCES = {
    "R1": "whenever near robot shall within 2 ticks satisfy slow",
    "R2": "robot shall always satisfy slow",
    "R3": "whenever near robot shall with probability >= 0.5 within 2 ticks satisfy slow",
    "R4": "whenever high robot shall eventually satisfy slow",
}
"""Of R4 there is no data: no log has `/z`."""
Texts = Mapping[str, str]
PROJECT: Texts = {"bindings": BINDINGS.replace("y < 0.3", "y < 0.3 m"), **SENTENCES}


def changed(file: str, old: str, new: str) -> Texts:
    assert PROJECT[file].count(old) == 1, (file, old)
    return {**PROJECT, file: PROJECT[file].replace(old, new)}


CHANGES: dict[str, tuple[Texts, set[str]]] = {
    "nothing": (PROJECT, set()),
    "a sentence": (changed("R2", "always", "eventually"), {"R2"}),
    "a bound": (changed("R1", "2 ticks", "3 ticks"), {"R1"}),
    "a probability": (changed("R3", "0.5", "0.75"), {"R3"}),
    "a threshold": (changed("bindings", "50 cm", "40 cm"), {"R1", "R3"}),
    "how a threshold is written": (changed("bindings", "50 cm", "0.5 m"), {"R1", "R3"}),
    "the age of samples": (changed("bindings", "300 ms", "90 ms"), {"R1", "R3"}),
    "a default that is stated": (
        changed("bindings", '"x < 50 cm"', '"x < 50 cm"\nagg = "last"'),
        {"R1", "R3"},
    ),
    "a comment above everything": (changed("bindings", "[clock]", "# why\n[clock]"), set()),
    "the clock": (changed("bindings", "100 ms", "50 ms"), {"R1", "R2", "R3", "R4"}),
    "a path": (changed("bindings", "/z.data", "/w.data"), {"R1", "R2", "R3", "R4"}),
    "a new requirement": ({**PROJECT, "R5": "robot shall always satisfy near"}, {"R5"}),
    "a requirement less": ({k: v for k, v in PROJECT.items() if k != "R2"}, set()),
    "a topic less": ({k: v for k, v in PROJECT.items() if k != "R4"}, {"R1", "R2", "R3"}),
    "the trace of agents": (
        changed("bindings", "[clock]", '[agent]\ntrace = "/trace"\n[clock]'),
        {"R1", "R2", "R3", "R4"},
    ),
    "an unbound proposition": ({**PROJECT, "R5": "robot shall always satisfy what"}, set()),
    "what is unknown": (
        changed("bindings", '"y < 0.3 m"', '"y < 0.3 m"\non_unknown = false'),
        {"R1", "R2", "R3", "R4"},
    ),
}


def written(folder: Path, texts: Texts) -> Project:
    """A project of these texts in a folder."""
    folder.mkdir(exist_ok=True)
    bindings = folder / "bindings.toml"
    bindings.write_text(texts["bindings"])
    paths = []
    for id, sentence in texts.items():
        if id != "bindings":
            path = folder / f"{id}.fret"
            path.write_text(f'+++\nid = "{id}"\n+++\n{sentence}\n')
            paths.append(str(path))
    return load(paths, str(bindings))


def plan(texts: Texts) -> Plan:
    """The plan of a project of these texts: made once, wherever it is used."""
    return _plan(tuple(texts.items()))


@cache
def _folder() -> TemporaryDirectory[str]:
    """Of all of them: what an audit says of a topic that is missing names the bindings."""
    return TemporaryDirectory()


@cache
def _plan(texts: tuple[tuple[str, str], ...]) -> Plan:
    made = planned(written(Path(_folder().name), dict(texts)))
    assert isinstance(made, Plan), made
    return made


def sent(*, late: bool = False) -> Iterator[Sent]:
    for tick in range(40):
        yield number(0.3 if tick % 13 == 5 else 0.9, 1000 * S + tick * 100 * MS)
        slow = tick % 13 == (9 if late else 6)
        yield number(0.1 if slow else 0.45, 1000 * S + tick * 100 * MS + 50 * MS, "/y")


@pytest.fixture
def log(tmp_path: Path) -> str:
    return str(write(tmp_path / "log.mcap", [*sent()]))


def taken(before: Plan, now: Plan, found: LogResult) -> tuple[Result, ...]:
    """The results of an audit by claims that are what they were."""
    same = {id for id, key in keys(before).items() if keys(now).get(id) == key}
    return tuple(each for each in found.results if each.requirement in same)


@pytest.fixture
def judged(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The requirements that were judged, in their order."""
    ids: list[str] = []

    def audit(recording: Any, declarations: Any, requirements: Sequence[Any]) -> Any:
        ids.extend(each.monitor.REQUIREMENTS[0].id for each in requirements)
        return one_log.audit(recording, declarations, requirements)

    monkeypatch.setattr(auditing, "audit", audit)
    return ids


@pytest.mark.slow
@pytest.mark.parametrize("name", CHANGES)
def test_after_each_change_only_what_it_changes_is_judged_and_all_is_as_from_nothing(
    tmp_path: Path, log: str, judged: list[str], name: str
) -> None:
    texts, expected = CHANGES[name]
    before, now = plan(PROJECT), plan(texts)
    earlier = audit_log(before, log)
    from_nothing = audit_log(now, log)
    judged.clear()
    assert audit_log(now, log, taken(before, now, earlier)) == from_nothing
    no_data = {"R4"} if earlier.results[0].health != from_nothing.results[0].health else set()
    assert {*judged} == (expected | no_data) & {*keys(now)}


@pytest.mark.slow
@pytest.mark.parametrize("name", some(CHANGES, 4, 1))
def test_and_back_again(tmp_path: Path, log: str, name: str) -> None:
    texts, _ = CHANGES[name]
    before, now = plan(texts), plan(PROJECT)
    known = taken(before, now, audit_log(before, log))
    assert audit_log(now, log, known) == audit_log(now, log)


def test_nothing_is_taken_over_of_another_log(tmp_path: Path, log: str, judged: list[str]) -> None:
    made = plan(PROJECT)
    known = audit_log(made, log).results
    write(Path(log), [*sent(late=True)])
    judged.clear()
    found = audit_log(made, log, known)
    assert found == audit_log(made, log)
    assert judged[:4] == ["R1", "R2", "R3", "R4"]
    other = str(write(tmp_path / "other.mcap", [*sent(late=True)]))
    assert audit_log(made, other, found.results) == audit_log(made, other)


def test_a_result_of_a_log_that_is_damaged_by_now_is_not_taken_over(
    tmp_path: Path, log: str
) -> None:
    made = plan(PROJECT)
    good = audit_log(made, log).results
    worse = [record_with(each, health=record_with(each.health, intact=False)) for each in good]
    wrong = [record_with(each, verdict="violated") for each in worse]
    assert audit_log(made, log, wrong) == audit_log(made, log)


@pytest.mark.slow
def test_a_closer_look_is_another_key(tmp_path: Path) -> None:
    project = written(tmp_path, {name: PROJECT[name] for name in ("bindings", "R1")})
    looks = [planned(project, integrity=each) for each in Integrity]
    assert len({keys(each)["R1"] for each in looks if isinstance(each, Plan)}) == len(Integrity)
