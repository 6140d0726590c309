"""What docs/write.md shows is what the command prints."""

from collections.abc import Iterator

import pytest

from fretc.writing.choices import Choice, choice
from fretc.writing.questions import next_question
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.english.vocabulary import Vocabulary
from tests.docs.pages import is_current


def read(text: str) -> Choice:
    made = choice(text, Vocabulary(), None)
    assert not isinstance(made, Diagnostic)
    return made


def listed(text: str) -> str:
    return "\n".join(indented([f'$ fretc write "{text}"', *read(text).lines]))


def asked(subject: str) -> str:
    """The first question, and its answer."""
    answer, _, text = subject.partition(": ")
    made = read(text)
    question = next_question(range(len(made.readings)), made.questions)
    assert question is not None
    table = [f"  {line}" for line in made.table(question)]
    prompt = f"y yes, n no, s skip (y, n, s): {answer}"
    return "\n".join(indented(["May this run happen, and end so?", *table, prompt]))


def indented(lines: list[str]) -> Iterator[str]:
    return (f"    {line}".rstrip() for line in lines)


def test_the_page_is_current(request: pytest.FixtureRequest) -> None:
    is_current("write.md", {"write": listed, "asked": asked}, request)
