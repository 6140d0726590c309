"""Parsing with stored tables against Lark: the same trees, the same errors, the same positions."""

import random
import re
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from pathlib import Path

import pytest
from lark import Lark, Tree
from lark import Token as LarkToken
from lark.exceptions import UnexpectedCharacters, UnexpectedToken

from fretish import documents, parser
from fretish.bindings import expressions
from fretish.diagnostics.source import Source
from fretish.reading.grammars import Grammar
from fretish.reading.lalr import (
    END,
    Parser,
    SyntaxTreeNode,
    Token,
    UnexpectedCharacterError,
    UnexpectedTokenError,
    build,
)
from tests.effort import FULL

ROOT = Path(__file__).parents[3]
EXPRESSIONS = (
    "a < 1 m",
    "min(range) <= 3.5e-1 km/h and !(b or 'x y' == c)",
    "((a)) for 200 ms",
    "(a | (b for 2 s))",
    "-abs(-x) + 2 * y ^ 2 mod z != pre(0 m/s, v) | true",
    "((x)) = ((1))",
    "f(a, (b), c, d) for 1 s",
    "true",
    "",
    " \n ",
    "a <",
    "a b",
    "a & ?",
    "for 2 s",
    "(a",
    "a ^ b",
    "a < b < c",
)
SENTENCES = (
    "whenever a r shall eventually satisfy b",
    "in m when x > 3.5 km/h & !p the robot shall within 10 s satisfy persisted(2, q) => z",
    "Upon c r shall satisfy p 3",
    "while ((a | (b))) , upon p and q is false, if r shall, with probability >= - 0.5, "
    "at the same timepoint satisfy if (a) then ((b)).",
    "after mode x upon at the previous occurrence of (p), q the s shall for 3 secs satisfy f() <=> "
    '"A b" <= -(3) ^ 2 mod mode',
    "",
    "the sw shall within 5 s satisfy p",
    "the sw shall immediately satisfy (p",
)


@pytest.mark.parametrize("text", EXPRESSIONS)
def test_an_expression_is_parsed_as_by_lark(text: str) -> None:
    assert ours(expressions.GRAMMAR, text, "start") == larks(expressions.GRAMMAR, text, "start")


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20 if FULL else 2))
def test_changed_texts_are_parsed_as_by_lark(seed: int) -> None:
    for grammar, start, texts in (
        (expressions.GRAMMAR, "start", EXPRESSIONS),
        (parser.GRAMMAR, "value", (*EXPRESSIONS, *SENTENCES)),
        (parser.GRAMMAR, "start", (*SENTENCES, *recorded())),
    ):
        answers = set[bool]()
        for text in (*texts, *changed(texts, seed)):
            expected = larks(grammar, text, start)
            assert ours(grammar, text, start) == expected, text
            answers.add(expected[0] == "tree")
        assert answers == {True, False}


def test_a_text_of_thousands_of_levels_needs_no_recursion() -> None:
    nodes = expressions.GRAMMAR.parser().parse("(" * 5000 + "a" + ")" * 5000)
    assert [(node.kind, node.start_pos, node.end_pos) for node in nodes] == [
        ("name", 5000, 5001),
        ("start", 0, 10_001),
    ]


def recorded() -> Sequence[str]:
    """The sentences of the requirements in this checkout."""
    return [
        entry.wording.text
        for path in sorted(ROOT.glob("requirements/**/*.fret"))
        for entry in documents.requirements(Source(str(path), path.read_text(encoding="utf-8")))[0]
    ]


def changed(texts: Sequence[str], seed: int) -> Iterable[str]:
    """Texts in which one word is left out, doubled, or replaced by a word of another text."""
    choose = random.Random(seed)
    words = sorted({word for text in texts for word in re.findall(r"\w+|\S", text)})
    for text in texts:
        parts = re.findall(r"\w+|\s+|\S", text)
        for _ in range(5 if parts else 0):
            place = choose.randrange(len(parts))
            other = choose.choice(("", parts[place] * 2, choose.choice(words), "§"))
            yield "".join([*parts[:place], other, *parts[place + 1 :]])


@cache
def _lark(grammar: Grammar) -> Lark:
    return grammar.lark()


class _Nested:
    """Builds nested tuples: the kind of a node, its children, and its extent."""

    def __getattr__(self, kind: str) -> Callable[..., object]:
        return lambda node, children: nested(kind, children, node)


def nested(kind: str, children: Sequence[object], node: SyntaxTreeNode) -> tuple[object, ...]:
    words = [
        (child.type, str(child), child.start_pos, child.end_pos)
        if isinstance(child, Token)
        else child
        for child in children
    ]
    return (kind, words, node.start_pos, node.end_pos)


def ours(grammar: Grammar, text: str, start: str) -> tuple[object, ...]:
    """The tree, or the error."""
    try:
        return "tree", build(_parser(grammar).parse(text, start), _Nested())
    except UnexpectedTokenError as error:
        token, before = error.token, error.previous
        place = None if token.type == END else (token.start_pos, token.end_pos)
        return "token", token.type, place, before and before.start_pos, error.accepts
    except UnexpectedCharacterError as error:
        return "character", error.position


@cache
def _parser(grammar: Grammar) -> Parser:
    return grammar.parser()


def larks(grammar: Grammar, text: str, start: str) -> tuple[object, ...]:
    """The same of Lark."""
    lark = _lark(grammar)
    try:
        return "tree", of_tree(lark.parse(text, start=start))
    except UnexpectedToken as error:
        token = error.token
        place = None if token.type == END else (token.start_pos, token.end_pos)
        before = previous(lark, text, token)
        return "token", token.type, place, before, frozenset(error.accepts or error.expected)
    except UnexpectedCharacters as error:
        return "character", error.pos_in_stream


def previous(lark: Lark, text: str, token: LarkToken) -> int | None:
    """Where the token before an unexpected one begins."""
    start = None
    for word in lark.lex(text):
        if token.type != END and word.start_pos == token.start_pos:
            break
        start = word.start_pos
    return start


def of_tree(tree: Tree[LarkToken]) -> tuple[object, ...]:
    children = [
        of_tree(child)
        if isinstance(child, Tree)
        else (child.type, str(child), child.start_pos, child.end_pos)
        for child in tree.children
    ]
    return (str(tree.data), children, tree.meta.start_pos, tree.meta.end_pos)


def test_a_beginning_continues_as_lark_says() -> None:
    """Every beginning of the sentences that ends between two words."""
    lark, own = _lark(parser.GRAMMAR), _parser(parser.GRAMMAR)
    for text in SENTENCES:
        for end in [match.start() for match in re.finditer(r"(?<=\s)\S|\Z", text)]:
            reading = lark.parse_interactive(text[:end], start="start")
            try:
                reading.exhaust_lexer()
            except (UnexpectedToken, UnexpectedCharacters):
                expected = frozenset[str]()
            else:
                expected = frozenset(reading.accepts())  # type: ignore[no-untyped-call]
            assert own.continuations(text[:end]) == expected, text[:end]


def test_the_words_of_a_wrong_text_are_those_around_what_is_no_word() -> None:
    words = [*_parser(parser.GRAMMAR).known_tokens("the § r \U0001f600 shal 5")]
    assert [(str(word), word.type, word.start_pos) for word in words] == [
        ("the", "THE", 0),
        ("r", "ID", 6),
        ("shal", "ID", 10),
        ("5", "NUMBER", 15),
    ]
