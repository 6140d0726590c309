"""The TextMate grammar gives each word the kind that the lexer of the language gives it."""

from pathlib import Path

import pytest

from fretish.documents import FIELDS
from fretish.keywords import RESERVED
from fretish.parser import words
from fretish.reading.lalr import Token
from tests.editors import npm_packages, published

pytestmark = pytest.mark.slow
Scopes = list[tuple[int, int, str]]
_PUNCTUATION = {"_COMMA", "_DOT", "LPAR", "RPAR"}
_KINDS = {
    "variable": ("variable.other", "entity.name"),
    "number": ("constant.numeric", "keyword.other.unit", "source.fretish"),
    "operator": ("keyword.operator",),
    "keyword": ("keyword.", "constant.language"),
}


@pytest.fixture(scope="module")
def extension(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return npm_packages.copy("vscode", tmp_path_factory.mktemp("textmate"))


def kind(token: Token) -> str:
    if token.type in ("ID", "QUOTED") and token.lower() not in RESERVED:
        return "variable"
    if token.type in ("NUMBER", "QUANTITY"):
        return "number"
    return "keyword" if token[0].isalpha() else "operator"


def disagreements(text: str, scopes: Scopes) -> list[tuple[str, Scopes]]:
    """The words whose scopes are not those of their kind, or do not begin and end with them."""
    wrong = []
    for token in words(text):
        start, end = token.start_pos, token.end_pos
        inside = [each for each in scopes if each[0] < end and each[1] > start]
        if token.type in _PUNCTUATION:
            fits = all(scope == "source.fretish" for _, _, scope in inside)
        else:
            fits = (inside[0][0], inside[-1][1]) == (start, end)
            fits &= all(scope.startswith(_KINDS[kind(token)]) for _, _, scope in inside)
        if not fits:
            wrong.append((str(token), inside))
    return wrong


def test_each_word_has_the_kind_that_our_lexer_gives_it(extension: Path) -> None:
    """A key word or unit that the grammar lacks makes this fail."""
    texts = [*published.sentences(), *published.words_alone(), *published.shuffled(400)]
    texts = [text for text in texts if text.count('"') % 2 == 0]
    all_scopes = npm_packages.answer(extension, "tests/scopes.mjs", texts)
    wrong = {
        text: found
        for text, scopes in zip(texts, all_scopes, strict=True)
        if (found := disagreements(text, scopes))
    }
    assert wrong == {}
    assert len(texts) > 1_300


def test_the_fields_of_a_header_are_known_and_a_fence_always_ends_it(extension: Path) -> None:
    known = "\n".join(f'{field} = ""' for field in FIELDS)
    texts = [
        f"+++\n{known}\nother = 1\n+++\nnear",
        '+++\nid = """\n+++\nnear',
        "+++\na = '''\n+++\nnear",
    ]
    documents = npm_packages.answer(extension, "tests/scopes.mjs", texts)
    for text, scopes in zip(texts, documents, strict=True):
        assert scopes[-1] == [len(text) - 4, len(text), "variable.other.fretish"]
    fields = [texts[0][a:b] for a, b, scope in documents[0] if scope.startswith("support.type")]
    assert fields == list(FIELDS)
    others = [
        texts[0][a:b] for a, b, scope in documents[0] if scope.startswith("variable.other.key")
    ]
    assert others == ["other"]
