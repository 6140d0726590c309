"""The published sentences, and sentences made of the vocabulary of the language."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from random import Random

from fretish.keywords import RESERVED
from fretish.units import NAMES

_DATA = Path(__file__).parents[1] / "data"
_FILES = "fret_surface_forms.json", "fret_case_studies.json", "fret_templates.json"
UNITS = [name for name in NAMES if name != "1"]
_PIECES = (
    *sorted(RESERVED),
    *(word.title() for word in sorted(RESERVED)),
    *"-> => <-> <=> <= >= != < > = + - * / ^ ! ~ & | ( ) , .".split(),
    *'robot mode.x shall.y a%b near. "two words" "the" f( x.y 0 1.5 2e3 05 7sec 1a 5 5. "'.split(),
    *(f"{number}{space}{unit}" for unit in UNITS for number, space in (("3", " "), ("2.5", ""))),
    *"5 m/s^2;3 m/second;2 s2;1 km*h;4 m.;4 m.x;6 % x;8 m^-1".split(";"),
)


def sentences() -> list[str]:
    """Every published sentence, whether FRET accepts it or not."""
    texts = [_DATA.joinpath(name).read_text(encoding="utf-8") for name in _FILES]
    return [entry["fretish"] for text in texts for entry in json.loads(text)]


def words_alone() -> list[str]:
    """Each reserved word in three spellings, and a number with each unit."""
    words = [spelling(word) for word in sorted(RESERVED) for spelling in _SPELLINGS]
    return [*words, *(f"3 {unit}" for unit in UNITS), *(f"0.5{unit}^2/s" for unit in UNITS)]


_SPELLINGS = (str.lower, str.upper, str.title)


def shuffled(count: int, seed: int = 0) -> list[str]:
    """Random sequences of words, numbers and operators; most are no sentence."""
    random = Random(seed)
    return [
        random.choice([" ", "  ", "\t"]).join(random.choices(_PIECES, k=random.randint(1, 12)))
        for _ in range(count)
    ]


def altered(texts: Sequence[str], seed: int = 0) -> list[str]:
    """Each text with one word left out, doubled, replaced or exchanged with the next."""
    random = Random(seed)
    return [_altered(text.split(" "), random) for text in texts if text]


def _altered(words: list[str], random: Random) -> str:
    at = random.randrange(len(words))
    match random.randrange(4):
        case 0:
            words.pop(at)
        case 1:
            words.insert(at, words[at])
        case 2:
            words[at] = random.choice(_PIECES)
        case _:
            words[at : at + 2] = words[at : at + 2][::-1]
    return " ".join(words)
