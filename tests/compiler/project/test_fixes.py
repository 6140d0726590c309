"""Sure fixes of files: all of them, of sentences alone."""

from pathlib import Path

import pytest

from compiler.project.fixes import fixed_files
from fretish.parser import MOST_ERRORS
from tests.command import write

WRONG, RIGHT = "the rover should always satisfy p", "the rover shall always satisfy p"


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def texts(*files: str) -> list[str]:
    """The texts of the files that are fixed."""
    paths = [write(f"r{i}.fret", text) for i, text in enumerate(files)]
    return [file.text for file in fixed_files(paths)]


def test_more_mistakes_than_a_pass_finds_are_all_fixed() -> None:
    count = MOST_ERRORS + 3
    written = " && ".join(["p"] * (count + 1))
    wrong = f"the rover shall always satisfy {written.replace('&&', 'and')}"
    (file,) = fixed_files([write("r.fret", wrong)])
    assert file.text == f"the rover shall always satisfy {written.replace('&&', '&')}"
    assert len(file.fixes) == count


def test_every_sentence_of_a_file_is_fixed_and_its_headers_stay() -> None:
    two = '+++\nid = "A"\n+++\n{0}\n+++\nid = "B"\n+++\n{0}\n'
    assert texts(two.format(WRONG)) == [two.format(RIGHT)]


@pytest.mark.parametrize("text", [f'"{WRONG}"', f'{WRONG}\n+++\nid = "A"\n', RIGHT])
def test_free_text_a_file_with_an_open_header_and_what_is_right_stay(text: str) -> None:
    assert texts(text) == []


def test_a_file_that_cannot_be_read_is_left_out_and_the_others_are_fixed() -> None:
    assert [file.path for file in fixed_files(["none.fret", write("r.fret", WRONG)])] == ["r.fret"]
