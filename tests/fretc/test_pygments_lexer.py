"""The Pygments lexer: Pygments finds it, no text is lost, and no word of a sentence is an error."""

import tomllib
from importlib.metadata import entry_points
from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.token import Error, Keyword, Name, Number, Operator, Punctuation, String

from fretc.pygments_lexer import FretishLexer
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.parser import parse
from tests.editors import published

ROOT = Path(__file__).parents[2]
Pieces = list[tuple[object, str]]


def pieces(text: str) -> Pieces:
    tokens = list(FretishLexer().get_tokens_unprocessed(text))
    assert "".join(piece for _, _, piece in tokens) == text
    assert [at for at, _, _ in tokens] == [
        sum(len(piece) for _, _, piece in tokens[:place]) for place in range(len(tokens))
    ]
    return [(kind, piece) for _, kind, piece in tokens if not piece.isspace()]


def test_pygments_finds_it_by_its_entry_point() -> None:
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]
    assert declared == {"pygments.lexers": {"fretish": "fretc.pygments_lexer:FretishLexer"}}
    (installed,) = entry_points(group="pygments.lexers", name="fretish")
    assert installed.load() is FretishLexer


def test_each_word_has_its_kind() -> None:
    header = '+++\nid = "R1"\n+++\n'
    sentence = 'in m mode when f(x) > 2 m/s & true the "a b" shall within 3 ticks satisfy not_x.\n'
    kinds = pieces(header + sentence)
    assert kinds[0] == (Punctuation.Marker, "+++")
    assert (Name, "id") in kinds
    assert kinds[[piece for _, piece in kinds].index("in") :] == [
        (Keyword, "in"),
        (Name.Variable, "m"),
        (Keyword, "mode"),
        (Keyword, "when"),
        (Name.Function, "f"),
        (Punctuation, "("),
        (Name.Variable, "x"),
        (Punctuation, ")"),
        (Operator, ">"),
        (Number, "2 m/s"),
        (Operator, "&"),
        (Keyword.Constant, "true"),
        (Keyword, "the"),
        (Name.Class, '"a b"'),
        (Keyword.Declaration, "shall"),
        (Keyword, "within"),
        (Number, "3"),
        (Keyword.Type, "ticks"),
        (Keyword.Declaration, "satisfy"),
        (Name.Variable, "not_x"),
        (Punctuation, "."),
    ]


def test_no_word_of_an_accepted_sentence_or_of_a_file_is_an_error() -> None:
    sentences = published.sentences()
    accepted = [text for text in sentences if not isinstance(parse(span(text)), Diagnostic)]
    files = [path.read_text() for path in sorted(ROOT.glob("requirements/**/*.fret"))]
    assert len(accepted) > 800
    assert len(files) > 20
    for text in [*accepted, *files]:
        assert Error not in {kind for kind, _ in pieces(text)}, text
    assert pieces('+++\nid = "R1"\n+++\n"free\ntext"')[-1] == (String.Double, '"free\ntext"')
    assert (Error, "?") in pieces("the r shall ? satisfy p")


def span(text: str) -> Span:
    return Source("r.fret", text).span()


@given(
    st.lists(
        st.sampled_from(
            ["+++\n", '"', "a = 1\n", "the r shall satisfy p", "\r\n", " ", "\ufeff", "é#", "'''"]
        )
    ).map("".join)
)
def test_no_text_is_lost(text: str) -> None:
    pieces(text)


def test_a_page_is_rendered() -> None:
    page = highlight("the robot shall satisfy stopped", FretishLexer(), HtmlFormatter())
    assert '<span class="nc">robot</span>' in page
    assert '<span class="kd">shall</span>' in page
