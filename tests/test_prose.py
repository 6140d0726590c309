"""The words of the project's texts, and what finds those that a newcomer does not understand."""

import pytest

from tests.prose.passages import Passage, of_module, passages, without_code
from tests.prose.words import Word, private_words, words


@pytest.mark.slow
def test_no_text_has_a_private_word() -> None:
    uses = [*private_words(passages(), words())]
    assert not uses, "\n".join(uses)


@pytest.mark.slow
def test_every_kind_of_text_is_read() -> None:
    paths = {passage.path for passage in passages()}
    for path in (
        "README.md",
        "docs/audit.md",
        "fretc/cli.py",
        "monitors/kernel/stepping.py",
        "templates/monitor/monitor.py.j2",
        "fretish/diagnostics/codes/3_bindings.toml",
    ):
        assert path in paths


def test_strings_docstrings_and_comments_of_a_module_are_passages() -> None:
    module = 'x = f"a {y[\'b\']} c" "d"\n\ndef f():\n    """One\n    two."""  # three\n'
    assert [*of_module("m.py", module)] == [
        Passage("m.py", 1, "a {} cd"),
        Passage("m.py", 1, "b"),
        Passage("m.py", 4, "One\n    two."),
        Passage("m.py", 5, "# three"),
    ]


def test_a_phrase_is_found_across_lines_and_with_any_ending() -> None:
    table = [Word.of("to the letter", "exactly"), Word.of("mend*", "fix")]
    text = "It is mended. Recommend it\nto\n   the letter; amend."
    assert [*private_words([Passage("p.md", 3, text)], table)] == [
        "p.md:4: `to the letter`: write exactly",
        "p.md:3: `mended`: write fix",
    ]


def test_code_tables_and_addresses_are_no_sentences() -> None:
    page = "# Title\n\nSee [a](b.md), `x`.\n\n    $ run\n\n| a |\n|---|\n\n```\ncode\n```\nEnd.\n"
    assert without_code(page).split() == ["See", "[a],", "name.", "End."]
