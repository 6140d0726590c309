"""The Lezer grammar accepts the sentences and files that our parser accepts, and no others."""

from pathlib import Path
from typing import Any

import pytest

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from fretish.keywords import RESERVED
from fretish.parser import parse, words
from tests.editors import npm_packages, published
from tests.effort import FULL

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
_SEMANTIC = {Code.BAD_PROBABILITY, Code.WRONG_KIND, Code.TOO_DEEP}
"""Errors of sentences that the grammar of the language allows."""


@pytest.fixture(scope="module")
def lezer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = npm_packages.copy("lezer", tmp_path_factory.mktemp("lezer"))
    output = npm_packages.run(folder, "npm", "run", "build")
    assert "Wrote src/parser.js" in output
    return folder


def results(lezer: Path, texts: list[str]) -> list[Any]:
    answers: list[Any] = npm_packages.answer(lezer, "tests/trees.mjs", texts)
    assert len(answers) == len(texts)
    return answers


def accepts(text: str) -> bool | None:
    """Whether our parser accepts a sentence; None: its syntax is right, and its meaning wrong."""
    tree = parse(Source("r.fret", text).span())
    if not isinstance(tree, Diagnostic):
        return True
    return None if tree.code in _SEMANTIC else False


def disagreements(lezer: Path, texts: list[str]) -> list[tuple[str, bool]]:
    return [
        (text, accepted)
        for text, answer in zip(texts, results(lezer, texts), strict=True)
        if (accepted := accepts(text)) is not None and accepted != (not answer["errors"])
    ]


def test_published_sentences_are_accepted_and_refused_as_by_our_parser(lezer: Path) -> None:
    texts = published.sentences()
    assert disagreements(lezer, texts) == []
    assert sum(accepts(text) is True for text in texts) > 800
    assert sum(accepts(text) is False for text in texts) >= 50


def test_each_reserved_word_and_unit_is_known(lezer: Path) -> None:
    places = "the r shall always satisfy {}", "the {} shall satisfy p", "{} p the r shall satisfy q"
    texts = [place.format(word) for place in places for word in sorted(RESERVED)]
    texts += [f"the r shall for {number} satisfy p" for number in published.words_alone()]
    texts += [
        f"the r shall for {amount} {unit} satisfy p" for amount in _AMOUNTS for unit in _TIMES
    ]
    texts += [f"the r shall satisfy x > 3 {unit}{end}" for unit in published.UNITS for end in _ENDS]
    assert disagreements(lezer, texts) == []


_AMOUNTS = "0 1 2.0 2.5 1.0004 0.0005 -2 1e3 007 999999999999999 1000000000000000 0.1".split()
_TIMES = "tick ticks TICKS Seconds sec secs ms us h min Minutes s^2 m s/s s.x sx minuteonds".split()
_ENDS = "", ".", "2", "^-2/s", "x", ".x", " & p", "*m", "/m2 - 1 m"


def test_altered_sentences_are_accepted_and_refused_as_by_our_parser(lezer: Path) -> None:
    texts = published.sentences()
    altered = [text for seed in range(50 if FULL else 2) for text in published.altered(texts, seed)]
    altered += published.shuffled(300)
    assert disagreements(lezer, altered) == []
    assert len({accepts(text) for text in altered}) == 3


def test_files_are_accepted_and_refused_as_by_our_parser(lezer: Path) -> None:
    files = [path.read_text() for path in sorted(ROOT.glob("requirements/**/*.fret"))]
    texts = [*files, "\n".join(files), *_FILES]
    answers = results(lezer, texts)
    for text, answer in zip(texts, answers, strict=True):
        entries, mistakes = requirements(Source("r.fret", text))
        free = [entry.is_free_text for entry in entries]
        sound = [
            is_free or bool(accepts(e.wording.text))
            for e, is_free in zip(entries, free, strict=True)
        ]
        unclosed = any(mistake.code is Code.BAD_HEADER for mistake in mistakes)
        assert (not answer["errors"]) == (all(sound) and not unclosed), text
        if not answer["errors"]:
            assert answer["tree"].count("FreeText(") == sum(free)
            assert answer["tree"].count("Sentence(") == len(free) - sum(free)


_FILES = (
    "",
    "+++\n+++\n",
    "+++\n+++\nthe r shall satisfy p",
    '\ufeff+++\nid = "R1"\n+++\nthe r shall satisfy p\n',
    '+++ \t\r\nid = "R1"\r\n+++\r\nthe r shall satisfy p\r\n',
    'the r shall satisfy p\n+++\nid = "R2"\n+++\n"free\ntext"\n',
    '+++\nid = "R1"\n+++\n"a free text"',
    '+++\nid = "R1"\n',
    '+++\nid = "R1"\n+++\n"a robot" shall satisfy p',
    '+++\nid = "R1"\n+++\n""',
    "the r shall satisfy p\nthe r shall satisfy q",
)


def test_words_have_the_colours_of_their_kinds(lezer: Path) -> None:
    sentence = (
        'in m mode when x > 2 m/s & f(y) the robot shall within 3 ticks satisfy true | "a b".'
    )
    (answer,) = results(lezer, [sentence])
    colours = dict(answer["colours"])
    expected = {"in": "keyword", "m": "variableName", "mode": "keyword", "2 m/s": "number"}
    expected |= {"robot": "className", "3 ticks": "number", "true": "bool", '"a b"': "variableName"}
    assert {word: colours[word] for word in expected} == {
        word: f"tok-{kind}" for word, kind in expected.items()
    }
    coloured = " ".join(colours)
    assert all(str(word) in coloured for word in words(sentence) if word not in (".", "(", ")"))
