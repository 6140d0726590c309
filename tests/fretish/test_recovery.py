"""All mistakes of a sentence, and the laws of their fixes."""

import json
import random
import re
from pathlib import Path

import pytest

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.fixes import apply_fixes
from fretish.diagnostics.source import Source
from fretish.parser import MOST_ERRORS, find_errors, parse
from fretish.syntax import Sentence
from tests.effort import some
from tests.fuzzing import sentences

DATA = Path(__file__).parents[1] / "data"
REAL = [
    row["fretish"]
    for name in ("templates", "surface_forms", "case_studies")
    for row in json.loads((DATA / f"fret_{name}.json").read_text("utf-8"))
]
FOREIGN = (  # what is written, and what other languages write; each means the same
    (r"\bshall\b", ("should", "must", "will")),
    (r" & ", (" && ", " \u2227 ")),
    (r"<=(?!>)", ("=<", "\u2264")),
    (r"(?<![<>!=])=(?![>=])", ("==",)),
    (r"!=", ("<>", "\u2260")),
    (r"\bseconds?\b", ("s",)),
    (r"!(?!=)", ("\u00ac",)),
    (r"->", ("\u2192",)),
    (r"\bsatisfy\b", ("satisfy the",)),
)


def all_of(text: str) -> tuple[Diagnostic, ...]:
    return find_errors(Source("r.fret", text).span())


def fixed(text: str) -> str:
    """All safe fixes of all rounds."""
    for _ in range(100):
        found = all_of(text)
        fixes = sorted(
            (d.fix for d in found if d.fix is not None and d.fix.is_safe),
            key=lambda fix: (fix.span.start, fix.span.end),
        )
        if not fixes:
            return text
        text = apply_fixes(Source("r.fret", text).span(), fixes)
    raise AssertionError(text)


def test_all_mistakes_of_a_sentence_are_told_in_its_order() -> None:
    text = "when p and q then the sw should within 2.5 s stopped && \u201ca b\u201d \u2265 3 == U"
    found = [(d.code.number, d.span.text) for d in all_of(text) if d.span is not None]
    assert found[:3] == [("F101", "and"), ("F101", "then"), ("F107", "should")]
    assert len(found) > 5


def test_mistakes_beyond_the_grammar_are_all_told() -> None:
    found = all_of("whenever x the sw shall satisfy y - 1 & x + 1 & (3 | p)")
    assert [d.span.text for d in found if d.span] == ["y - 1", "x + 1", "3"]


def test_behind_a_second_sentence_reading_goes_on() -> None:
    found = all_of("the sw must satisfy what. when r then the sw shall satisfy s and t")
    assert [d.code.number for d in found] == ["F107", "F109", "F117", "F101", "F101"]


def test_behind_a_mistake_that_is_not_sure_nothing_is_guessed() -> None:
    assert len(all_of("the sw shall alwyas satisfy p and q")) == 1


def test_so_many_are_told_and_no_more() -> None:
    assert len(all_of("the sw shall satisfy p" + " and p" * 30)) == MOST_ERRORS
    assert fixed("the sw shall satisfy p" + " and p" * 30).count("&") == 30


def test_of_a_very_long_text_the_first_is_told() -> None:
    assert len(all_of("the sw shall satisfy p" + " and p" * 3_000)) == 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", some(range(2), 2))
def test_mistakes_of_any_text_have_a_place_an_order_and_fixes_that_lead_on(seed: int) -> None:
    """Each safe fix takes away its own mistake, and brings no other one."""
    for text in sentences(150, seed=seed):
        source = Source("fuzz.fret", text)
        found = find_errors(source.span())
        assert bool(found) == isinstance(parse(source.span()), Diagnostic), text
        assert len(found) <= MOST_ERRORS
        places = [d.span for d in found if d.span is not None]
        assert len(places) == len(found), text
        assert all(0 <= s.start <= s.end <= len(text) and s.source == source for s in places)
        assert [s.start for s in places] == sorted(s.start for s in places), text
        sure = [d.fix for d in found if d.fix is not None and d.fix.is_safe]
        if sure and len(found) < MOST_ERRORS:
            corrected = apply_fixes(
                source.span(), sorted(sure, key=lambda m: (m.span.start, m.span.end))
            )
            assert len(find_errors(Source("fuzz.fret", corrected).span())) <= len(found) - len(
                sure
            ), text


@pytest.mark.slow
@pytest.mark.parametrize("seed", some(range(3), 3))
def test_a_fix_gives_back_the_sentence_that_was_meant(seed: int) -> None:
    """Real sentences, as somebody would write them who is used to other languages.

    What could be meant in two ways stays a mistake; it is never fixed into another sentence.
    """
    chance = random.Random(seed)
    tried = restored = 0
    for text in chance.sample(REAL, 150):
        meant = parse(Source("r.fret", text).span())
        if not isinstance(meant, Sentence) or '"' in text or "shall the" in text:
            continue
        foreign = text
        for pattern, spellings in chance.sample(FOREIGN, 3):
            spelling = chance.choice(spellings)
            if pattern.startswith(r"\bsat") and not re.search(r"satisfy [a-z]\w*\s*\.?\Z", text):
                continue
            foreign = re.sub(pattern, spelling, foreign, flags=re.IGNORECASE)
        if foreign != text and isinstance(parse(Source("r", foreign).span()), Diagnostic):
            tried += 1
            found = parse(Source("r.fret", fixed(foreign)).span())
            assert isinstance(found, Diagnostic) or found == meant, foreign
            restored += found == meant
    assert restored > max(30, tried - 10)


@pytest.mark.parametrize("text", ["the sw shall satisfy p", "the sw must satisfy p and q or r"])
def test_what_is_not_sure_is_left_alone(text: str) -> None:
    assert fixed(text) == text.replace("must", "shall")
