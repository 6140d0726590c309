"""A project as a whole: what its files say together."""

from pathlib import Path

import pytest

from compiler.project.folder import load
from compiler.project.project import Project

SECONDS = "the sw shall within {} seconds satisfy q"


def project(folder: Path, *sentences: str) -> Project:
    paths = [folder / f"r{number}.fret" for number, _ in enumerate(sentences, 1)]
    for path, sentence in zip(paths, sentences, strict=True):
        path.write_text(f"{sentence}\n")
    return load([str(path) for path in paths])


@pytest.mark.parametrize(
    ("sentences", "messages"),
    [
        (["the sw shall within 3 ticks satisfy q"], []),
        ([SECONDS.format(3)], ["`3 seconds` is read as 3 ticks, as FRET does"]),
        (
            [SECONDS.format(3), SECONDS.format(4)],
            ["`3 seconds` is read as 3 ticks, as FRET does; another duration likewise"],
        ),
        (
            [SECONDS.format(3), "the sw shall always satisfy q", *map(SECONDS.format, (4, 5))],
            ["`3 seconds` is read as 3 ticks, as FRET does; 2 other durations likewise"],
        ),
    ],
)
def test_durations_without_a_clock_are_one_warning(
    tmp_path: Path, sentences: list[str], messages: list[str]
) -> None:
    found = project(tmp_path, *sentences).diagnostics
    start = "no clock says what a tick is: "
    assert [each.message for each in found] == [f"{start}{message}" for message in messages]
