"""The list of words that no text of the project has, and where one has them all the same."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.prose.passages import Passage

TABLE = Path(__file__).parent / "words.toml"


@dataclass(frozen=True)
class Word:
    """A word or phrase that a newcomer does not understand, and what to write in its place."""

    pattern: re.Pattern[str]
    instead: str

    @classmethod
    def of(cls, phrase: str, instead: str) -> Word:
        """Whole words; a phrase is found across lines; `*` stands for any ending."""
        spaced = r"\s+".join(re.escape(part) for part in phrase.split())
        return cls(re.compile(rf"\b{spaced}\b".replace(r"\*\b", r"\w*"), re.IGNORECASE), instead)


def words(table: Path = TABLE) -> list[Word]:
    """The list, as its file has it: a phrase, and what to write in its place."""
    rows = tomllib.loads(table.read_text(encoding="utf-8"))["words"]
    return [Word.of(phrase, instead) for phrase, instead in rows.items()]


def private_words(passages: Iterable[Passage], table: Iterable[Word]) -> Iterator[str]:
    """A line for each use of a word of the table: where it stands, and what to write."""
    table = [*table]
    any_word = re.compile("|".join(word.pattern.pattern for word in table), re.IGNORECASE)
    for passage in passages:
        if not any_word.search(passage.text):
            continue
        for word in table:
            for use in word.pattern.finditer(passage.text):
                line = passage.line + passage.text.count("\n", 0, use.start())
                used = " ".join(use.group().split())
                yield f"{passage.path}:{line}: `{used}`: write {word.instead}"
