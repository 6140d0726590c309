"""Words of an English sentence, and their stems."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from fretish.classes.frozen import dataclass

_WORD = re.compile(
    r"-?\d+(?:\.\d+)?(?![\w.]*[A-Za-z_])|[^\W\d][\w%^/]*(?:'[a-z]+)?|\d+\w+|<=|>=|!=|[<>=]"
    r"|[%°]|[,;:().]|\S"
)
_HYPHEN = re.compile(r"(?<=[A-Za-z])-(?=[A-Za-z])")
_DIGIT_HYPHEN = re.compile(r"(?<=\d)-(?=[A-Za-z])")
_NO_SPACE = re.compile(r"(?<=[A-Z]{3})(?=(?:when|if|while|until)\b)")
"""Where a blank is missing: `STANDBYwhen`."""
_END = re.compile(r"[.;!?]+(?=\s|$)")
_DIGIT = re.compile(r"-?\d+(?:\.\d+)?")
_PARTS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^\W\d_A-Za-z]+")
PUNCTUATION = frozenset(",;:().'\"`!?")
ARTICLES = frozenset("the a an this these those its their".split())
COPULAS = frozenset(
    "is are was were be been being becomes become gets get remains remain stays stay has have had "
    "does do did goes go kept keeps keep occurs occur happens happen".split()
)
_EMPTY = ARTICLES | frozenset(
    "then that and it also please both either to be is are there of".split()
)
"""Words that say nothing where no rule reads them."""
_SAME = {
    "seconds": "sec", "second": "sec", "secs": "sec", "s": "sec", "minutes": "min", "minute": "min",
    "degrees": "deg", "degree": "deg", "percent": "%",
}  # fmt: skip
_ENDINGS = ("ations", "ation", "ings", "ing", "ied", "ies", "ed", "es", "e", "s", "y")


@dataclass(frozen=True, slots=True)
class Word:
    """A word, a number or a punctuation mark, with its place in the text (in characters)."""

    text: str
    start: int

    @property
    def lower(self) -> str:
        """The word in lower case."""
        return self.text.lower()

    @property
    def is_number(self) -> bool:
        """Whether it is a number in digits."""
        return _DIGIT.fullmatch(self.text) is not None


Phrase = tuple[Word, ...]
Places = frozenset[int]
"""The places of words in the text."""


def sentences(text: str) -> tuple[str, ...]:
    """The sentences of a text, without the full stop; white space is made single."""
    text = _NO_SPACE.sub(" ", text)
    parts, start = [], 0
    for match in _END.finditer(text):
        parts.append(text[start : match.start()])
        start = match.end()
    return tuple(" ".join(part.split()) for part in (*parts, text[start:]) if part.strip())


def words(sentence: str) -> Phrase:
    """The words of a sentence; `mis-compare` is one, `60-second` are two."""
    plain = _DIGIT_HYPHEN.sub(" ", _HYPHEN.sub("_", sentence))
    parts = []
    for match in _WORD.finditer(plain):
        parts += _apart(match[0], match.start())
    return tuple(parts)


def _apart(text: str, start: int) -> list[Word]:
    """The word; `cannot` and `isn't` are two."""
    lower = text.lower()
    if lower == "cannot":
        return [Word("can", start), Word("not", start + 3)]
    if lower.endswith("n't"):
        stem = {"ca": "can", "wo": "will", "sha": "shall"}.get(lower[:-3], text[:-3])
        return [Word(stem, start), Word("not", start + len(text) - 3)]
    return [Word(text, start)]


def lower(phrase: Iterable[Word]) -> tuple[str, ...]:
    """The words in lower case."""
    return tuple(word.lower for word in phrase)


def places(phrase: Iterable[Word]) -> Places:
    """The places of the words."""
    return frozenset(word.start for word in phrase)


def text(phrase: Sequence[Word]) -> str:
    """The words as text."""
    spaced = " ".join(word.text for word in phrase)
    return re.sub(r" ([,;:).])", r"\1", spaced).replace("( ", "(")


def carries_meaning(word: Word) -> bool:
    """Whether a word must be used by a reading, or named."""
    return word.text not in PUNCTUATION and word.lower not in _EMPTY


def stem(word: str) -> str:
    """The word without its ending: equal for `press`, `pressed` and `pressing`."""
    lower = word.lower()
    lower = _SAME.get(lower, lower)
    for ending in _ENDINGS:
        if lower.endswith(ending) and len(lower) - len(ending) >= 3:
            lower = lower[: -len(ending)]
            break
    double = len(lower) > 3 and lower[-1] == lower[-2] and lower[-1] not in "sl"
    return lower[:-1] if double else lower


def stems(name: str) -> tuple[str, ...]:
    """The stems of a name's parts: of `timer_60sec_start` and of `timer60SecStart` the same."""
    return tuple(stem(part) for part in _PARTS.findall(name))
