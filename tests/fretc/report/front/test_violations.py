"""Every violated requirement is named, the most dangerous first."""

from pathlib import Path
from typing import Any

from tests.fretc.report.cases import content_of, project, requirement, result

ALWAYS = "the robot shall always satisfy stopped"
SCALE = ("negligible", "marginal", "serious", "critical", "catastrophic")


def front(folder: Path, parents: dict[str, list[str]], broken: dict[str, str]) -> dict[str, Any]:
    """The first screen; `broken` has the letters of the runs that violate each requirement."""
    hazards = "".join(
        f'[HAZ-{n}]\ntitle = "Hazard {n}"\nseverity = "{word}"\n' for n, word in enumerate(SCALE, 1)
    )
    texts = [requirement(id, ALWAYS, parents=above) for id, above in parents.items()]
    known = project(folder, *texts, hazards=hazards + '[HAZ-9]\ntitle = "x"\nseverity = "huge"\n')
    results = [
        result(known, "violated" if run in broken[id] else "satisfied", id, f"{run}.mcap")
        for id in parents
        for run in "abc"
    ]
    page: dict[str, Any] = content_of(known, folder, *results)["front"]
    return page


def test_the_most_severe_hazard_comes_first_however_few_runs_violate_it(tmp_path: Path) -> None:
    parents = {"R1": [], "R2": ["HAZ-1"], "R3": ["HAZ-1", "HAZ-5"], "R4": ["HAZ-3"], "R10": []}
    page = front(tmp_path, parents, dict.fromkeys(parents, "ab") | {"R3": "c", "R10": "abc"})
    assert [sentence.partition(" fails")[0] for sentence in page["sentences"]] == [
        "Title of R3 (R3) [HAZ-5, catastrophic]",
        "Title of R4 (R4) [HAZ-3, serious]",
        "Title of R2 (R2) [HAZ-1, negligible]",
        "Title of R10 (R10)",
        "Title of R1 (R1)",
    ]
    assert page["headline"].endswith("the most severe: Title of R3 (R3), HAZ-5, catastrophic.")


def test_a_severity_that_no_scale_has_is_not_put_last(tmp_path: Path) -> None:
    page = front(tmp_path, {"R1": ["HAZ-4"], "R2": ["HAZ-9"]}, {"R1": "abc", "R2": "a"})
    assert [sentence.partition(" fails")[0] for sentence in page["sentences"]] == [
        "Title of R2 (R2) [HAZ-9, huge]",
        "Title of R1 (R1) [HAZ-4, critical]",
    ]


def test_all_are_named_however_many(tmp_path: Path) -> None:
    parents: dict[str, list[str]] = {f"R{n}": ["HAZ-2"] for n in range(1, 31)}
    page = front(tmp_path, parents, dict.fromkeys(parents, "b"))
    assert [sentence.partition(" (")[0] for sentence in page["sentences"]] == [
        f"Title of R{n}" for n in range(1, 31)
    ]
