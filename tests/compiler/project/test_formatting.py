"""`fretc fmt`: canonical sentences, and everything around them as it was."""

import json
import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.project.formatting import formatted_files
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from fretish.parser import parse
from fretish.printer import sentence
from fretish.syntax import Sentence
from tests.command import Fretc, Run, write
from tests.fretish.test_white_space import SENTENCES

FORMS = Path(__file__).parents[2] / "data/fret_surface_forms.json"


def read(path: str) -> str:
    return Path(path).read_bytes().decode()


LOOSE = """\
+++
# who may change this: nobody
id   = "R1"   # two blanks before the sign
text = \"\"\"
When   p,   stop.
\"\"\"
[params]
too_close = "5 cm"
+++

When   p &(q|r)   the   sw  shall  Eventually   satisfy   (  stopped  ) .


+++
id='R2'
+++
IN  m  MODE rover shall within 3   secs satisfy "a  b">3

+++\t
id = "R3"
+++
the sw shall always satisfy !  !  p
"""
NEAT = """\
+++
# who may change this: nobody
id   = "R1"   # two blanks before the sign
text = \"\"\"
When   p,   stop.
\"\"\"
[params]
too_close = "5 cm"
+++

when p & (q | r) the sw shall eventually satisfy stopped


+++
id='R2'
+++
in m mode, rover shall within 3 seconds satisfy "a  b" > 3

+++\t
id = "R3"
+++
the sw shall always satisfy !(!p)
"""


def test_sentences_become_canonical_and_all_else_stays(fretc: Fretc) -> None:
    path = write("r.fret", LOOSE)
    assert fretc("fmt", path) == Run(0, "", "wrote r.fret\n")
    assert read(path) == NEAT


def test_a_second_time_changes_nothing(fretc: Fretc) -> None:
    path = write("r.fret", NEAT)
    before = Path(path).stat()
    assert fretc("fmt", path) == Run(0, "", "")
    assert read(path) == NEAT
    assert Path(path).stat().st_mtime_ns == before.st_mtime_ns


def test_windows_line_ends_around_a_sentence_stay(fretc: Fretc) -> None:
    path = write("r.fret", LOOSE.replace("\n", "\r\n"))
    assert fretc("fmt", path).status == 0
    assert read(path) == NEAT.replace("\n", "\r\n")


def test_a_file_ends_with_a_line_end(fretc: Fretc) -> None:
    path = write("r.fret", "the sw shall always satisfy p")
    fretc("fmt", path)
    assert read(path) == "the sw shall always satisfy p\n"


def test_a_long_sentence_is_broken_at_spaces(fretc: Fretc) -> None:
    names = " | ".join(f"obstacle_number_{n}_near" for n in range(8))
    path = write("r.fret", f"whenever {names} the sw shall eventually satisfy stopped\n")
    fretc("fmt", path)
    assert read(path) == (
        "whenever obstacle_number_0_near | obstacle_number_1_near | obstacle_number_2_near |\n"
        "obstacle_number_3_near | obstacle_number_4_near | obstacle_number_5_near | "
        "obstacle_number_6_near |\n"
        "obstacle_number_7_near the sw shall eventually satisfy stopped\n"
    )
    assert fretc("fmt", "--check", path).status == 0


def test_a_line_has_at_most_a_hundred_characters(fretc: Fretc) -> None:
    exact = f"the sw shall always satisfy {'p' * 72}"
    path = write("r.fret", f"{exact}\n")
    assert len(exact) == 100
    assert fretc("fmt", path).err == ""
    write("r.fret", f"{exact}p\n")
    fretc("fmt", path)
    assert read(path) == f"the sw shall always satisfy\n{'p' * 73}\n"


def test_a_name_in_quotes_is_not_broken(fretc: Fretc) -> None:
    name = '"' + " ".join(["obstacle"] * 20) + '"'
    path = write("r.fret", f"whenever {name} the sw shall eventually satisfy stopped & {name}\n")
    assert fretc("fmt", path).status == 0
    assert read(path) == f"whenever\n{name}\nthe sw shall eventually satisfy stopped &\n{name}\n"


@pytest.mark.parametrize("name", ["two\twords", "two  words", " two words ", "a - b", "tab\tat"])
@pytest.mark.parametrize("more", ["", " & stopped_at_last" * 8])
def test_a_name_in_quotes_stays_letter_by_letter(fretc: Fretc, name: str, more: str) -> None:
    text = f'the sw shall eventually satisfy "{name}"{more}'
    path = write("r.fret", f"{text}\n")
    assert fretc("fmt", path).status == 0
    assert tree(read(path)) == tree(text)


def test_free_text_stays_as_it_is(fretc: Fretc) -> None:
    text = '+++\nid = "R1"\n+++\n"It   should be\nnice."\n'
    path = write("r.fret", text)
    assert fretc("fmt", path) == Run(0, "", "")
    assert read(path) == text


def test_free_text_beside_a_sentence_keeps_no_file_from_being_written(fretc: Fretc) -> None:
    path = write(
        "r.fret",
        '+++\nid = "R1"\n+++\n"Be nice."\n+++\nid = "R2"\n+++\nthe sw shall  satisfy p\n',
    )
    assert fretc("fmt", path).status == 0
    assert read(path) == (
        '+++\nid = "R1"\n+++\n"Be nice."\n+++\nid = "R2"\n+++\nthe sw shall satisfy p\n'
    )


# The words of the writer ----------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    ("written", "canonical"),
    [
        ("The SW shall satisfy q", "the SW shall satisfy q"),
        ("SW shall satisfy q.", "SW shall satisfy q"),
        ("shall the sw satisfy q", "the sw shall satisfy q"),
        ("When p sw shall satisfy q", "when p sw shall satisfy q"),
        ("if p, sw shall satisfy q", "if p sw shall satisfy q"),
        ("where p sw shall satisfy q", "where p sw shall satisfy q"),
        ("upon p sw shall satisfy q", "upon p sw shall satisfy q"),
        ("whenever p sw shall satisfy q", "whenever p sw shall satisfy q"),
        ("unless p sw shall satisfy q", "upon !p sw shall satisfy q"),
        ("when p and if q sw shall satisfy r", "when p & q sw shall satisfy r"),
        ("when p or when q sw shall satisfy r", "when p | q sw shall satisfy r"),
        ("when p is FALSE sw shall satisfy q", "when !p sw shall satisfy q"),
        ("during m sw shall satisfy q", "in m mode, sw shall satisfy q"),
        ("while m sw shall satisfy q", "in m mode, sw shall satisfy q"),
        ("while m & n sw shall satisfy q", "while m & n, sw shall satisfy q"),
        ("unless in m sw shall satisfy q", "except in m mode, sw shall satisfy q"),
        ("only if in m sw shall satisfy q", "only in m mode, sw shall satisfy q"),
        ("only after x > 3 sw shall satisfy q", "only after x > 3, sw shall satisfy q"),
        ("sw shall initially satisfy q", "sw shall immediately satisfy q"),
        ("sw shall, at the last timepoint, satisfy q", "sw shall finally satisfy q"),
        ("sw shall within 1 secs satisfy q", "sw shall within 1 second satisfy q"),
        ("sw shall for 90 minute satisfy q", "sw shall for 90 minutes satisfy q"),
        ("sw shall until (s|r) satisfy q", "sw shall until s | r satisfy q"),
        (
            "sw shall with probability >= 0.95 always satisfy q",
            "sw shall with probability >= 0.95 always satisfy q",
        ),
        ("sw shall satisfy if p then q", "sw shall satisfy p -> q"),
        ("sw shall satisfy ~p <=> (q => r)", "sw shall satisfy !p <-> q -> r"),
        ('sw shall satisfy "always"', 'sw shall satisfy "always"'),
        ('sw shall satisfy "p"', "sw shall satisfy p"),
    ],
)
def test_one_wording_for_each_meaning_but_the_words_of_the_writer(
    fretc: Fretc, written: str, canonical: str
) -> None:
    path = write("r.fret", f"{written}\n")
    assert fretc("fmt", "-o", "-", path).out == f"{canonical}\n"


@cache
def accepted() -> list[Any]:
    rows: list[dict[str, Any]] = json.loads(FORMS.read_text(encoding="utf-8"))
    rows = [row for row in rows if row["accepted"]]
    readable = [row for row in rows if isinstance(parsed(row["fretish"]), Sentence)]
    return [row["fretish"] for row in readable]


def parsed(text: str) -> object:
    return parse(Source("r.fret", text).span())


def tree(text: str) -> Sentence:
    found = parsed(text)
    assert isinstance(found, Sentence), found
    return found


def test_nearly_all_wordings_that_fret_accepts_are_formatted_here() -> None:
    """All but those whose duration FRET misreads."""
    rows = json.loads(FORMS.read_text(encoding="utf-8"))
    assert sum(row["accepted"] for row in rows) == 337
    assert len(accepted()) > 325


@pytest.mark.slow
def test_a_formatted_sentence_says_the_same_in_stable_words() -> None:
    for text in accepted():
        written, once = tree(text), sentence(tree(text))
        assert tree(once) == written, text
        assert tree(once).article == written.article, text
        assert sentence(tree(once)) == once, text
        assert "\n" not in once, text


@pytest.mark.slow
@given(SENTENCES, st.integers(1, 100), st.sampled_from(["\n", "\r\n"]))
def test_what_is_broken_anywhere_is_read_back_and_stays(text: str, length: int, end: str) -> None:
    long = text.replace("sw shall", f"sw{'w' * length} shall")
    with TemporaryDirectory() as folder:
        path = Path(folder, "r.fret")
        path.write_text(f'+++{end}id = "R1"{end}+++{end}{long}{end}', "utf-8", newline="")
        ((file,), wrong) = formatted_files([str(path)])
        assert not wrong
        path.write_text(file.after, "utf-8", newline="")
        ((again,), _) = formatted_files([str(path)])
    ((only,), _) = requirements(Source("r.fret", file.after))
    assert parse(only.wording) == tree(long)
    assert again.before == again.after
    lines = file.after.split(end)
    assert not any("\r" in line or "\n" in line for line in lines)
    assert all(len(line) <= 100 or " " not in line for line in lines)
    assert not any(re.search(r"(?<![\w.])[0-9][\w.+-]*$", line) and lines[i + 1][:1].isalpha()
                   for i, line in enumerate(lines[:-1]))  # fmt: skip


# The command ----------------------------------------------------------------------------------


def test_check_tells_which_files_would_change_and_writes_none(fretc: Fretc) -> None:
    loose, neat = write("loose.fret", LOOSE), write("neat.fret", NEAT)
    assert fretc("fmt", "--check", loose, neat) == Run(1, "", "would change loose.fret\n")
    assert read(loose) == LOOSE


def test_check_is_content_with_canonical_files(fretc: Fretc) -> None:
    assert fretc("fmt", "--check", write("neat.fret", NEAT)) == Run(0, "", "")


def test_minus_prints_all_files_and_writes_none(fretc: Fretc) -> None:
    loose, neat = write("loose.fret", LOOSE), write("neat.fret", NEAT)
    assert fretc("fmt", "-o", "-", loose, neat) == Run(0, NEAT + NEAT, "")
    assert read(loose) == LOOSE


def test_only_files_that_change_are_written(fretc: Fretc) -> None:
    Path("folder").mkdir()
    loose, neat = write("folder/loose.fret", LOOSE), write("neat.fret", NEAT)
    assert fretc("fmt", neat, loose) == Run(0, "", "wrote folder/loose.fret\n")
    assert read(loose) == NEAT


@pytest.mark.parametrize("options", [(), ("--check",), ("-o", "-")])
def test_a_mistake_in_one_file_leaves_all_untouched(fretc: Fretc, options: tuple[str, ...]) -> None:
    loose, wrong = write("loose.fret", LOOSE), write("wrong.fret", "the sw shall always stopped\n")
    assert fretc("fmt", *options, loose, wrong) == Run(
        2,
        "",
        "F104 missing `satisfy` before `stopped`\n"
        "  --> wrong.fret:1:21\n"
        "   | the sw shall always stopped\n"
        "   |                     ^^^^^^^\n"
        "help: write `satisfy stopped`\n",
    )
    assert (read(loose), read(wrong)) == (LOOSE, "the sw shall always stopped\n")


def test_a_mistake_in_one_of_several_sentences_leaves_the_file_untouched(fretc: Fretc) -> None:
    text = LOOSE.replace("shall always satisfy !", "shall allways satisfy !")
    path = write("r.fret", text)
    assert fretc("fmt", path).status == 2
    assert read(path) == text


def test_all_mistakes_of_all_files_are_told(fretc: Fretc) -> None:
    first = write("first.fret", "the sw shall always stopped\n")
    second = write("second.fret", "+++\ncolour = 3\n+++\nthe sw shall satisfy p\n")
    run = fretc("fmt", first, second, "third.fret")
    assert run.status == 2
    assert [line[:4] for line in run.err.splitlines() if line[:1] == "F"] == [
        "F104",
        "F103",
        "F901",
    ]


def test_standard_input_is_never_written_to(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> None:
    from compiler.project import formatting

    monkeypatch.setattr(formatting, "read", lambda path: Source("<stdin>", "sw shall  satisfy p"))
    fretc("fmt", "-")
    assert list(Path().iterdir()) == []
