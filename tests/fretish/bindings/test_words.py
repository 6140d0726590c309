"""Signals of words, and truth values: what `values` may be, and how expressions compare words."""

import pytest

from fretish import expressions as e
from fretish.bindings.declarations import Declarations
from fretish.bindings.expressions import parse
from fretish.bindings.tables.reader import read_bindings
from fretish.bindings.words import resolve_words
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.parser import parse as sentence
from fretish.printer import expression

HEAD = """\
[clock]
tick = "100 ms"

[signal.mode]
path = "/mode.data"
values = ["drive", "docking", "in motion"]

[signal.wanted]
path = "/wanted.data"
values = ["drive", "docking", "in motion"]

[signal.gear]
path = "/gear.data"
values = { park = 0, drive = 1 }

[signal.drive]
path = "/drive.data"

[signal.battery]
path = "/battery.data"
unit = "%"

[proposition.p]
expr = '''
"""


def read(expr: str, text: str = HEAD) -> tuple[Declarations | None, tuple[Diagnostic, ...]]:
    return read_bindings(Source("b.toml", f"{text.rstrip()}{expr}'''\n"))


MODE, GEAR = e.Name("mode"), e.Name("gear")


@pytest.mark.parametrize(
    ("text", "tree"),
    [
        ("mode == 'docking'", e.Comparison("=", MODE, e.Word("docking"))),
        ('mode = "docking"', e.Comparison("=", MODE, e.Word("docking"))),
        ("mode = docking", e.Comparison("=", MODE, e.Word("docking"))),
        ("docking != mode", e.Comparison("!=", e.Word("docking"), MODE)),
        ("mode = 'in motion'", e.Comparison("=", MODE, e.Word("in motion"))),
        ("mode != wanted", e.Comparison("!=", MODE, e.Name("wanted"))),
        ("mode = 'drive'", e.Comparison("=", MODE, e.Word("drive"))),
        ("gear = park", e.Comparison("=", GEAR, e.Word("park"))),
        ("drive", e.Name("drive")),
        ("not drive", e.Not(e.Name("drive"))),
        ("drive == true", e.Name("drive")),
        ("false != drive", e.Name("drive")),
        ("drive == false", e.Not(e.Name("drive"))),
        ("drive for 200 ms", e.Persistence(e.Name("drive"), 2 * 10**8)),
        ("(drive > 0.5) = true", e.Comparison(">", e.Name("drive"), e.Number("0.5"))),
        (
            "drive and mode = docking",
            e.And((e.Name("drive"), e.Comparison("=", MODE, e.Word("docking")))),
        ),
    ],
)
def test_words_and_truths_of_an_expression(text: str, tree: e.Expression) -> None:
    found, wrong = read(text)
    assert found is not None
    assert wrong == ()
    assert found.propositions["p"].expression == tree


@pytest.mark.parametrize(
    ("text", "code", "message"),
    [
        ("mode = dokcing", "F340", "`dokcing` is not a value of `mode`"),
        ("mode = 'park'", "F340", "`park` is not a value of `mode`"),
        ("mode = drive", "F341", "`drive` is ambiguous: a signal, or a value of `mode`"),
        ("mode < docking", "F308", "words have no order: `<` cannot compare them"),
        ("mode >= wanted", "F308", "words have no order: `>=` cannot compare them"),
        ("mode = 3", "F308", "`mode` is a word, and this is a number: they cannot be compared"),
        (
            "mode = battery",
            "F308",
            "`mode` is a word, and `battery` is a number: they cannot be compared",
        ),
        (
            "mode = gear",
            "F308",
            "`mode` and `gear` have different values: they cannot be compared",
        ),
        ("mode + 1 > 2", "F308", "`mode` is a word, and a number is needed"),
        ("abs(mode) > 2", "F308", "`mode` is a word, and a number is needed"),
        ("drive + 'docking' > 2", "F308", '`"docking"` is a word, and a number is needed'),
        ("mode", "F308", "`mode` is a word, and a truth value is needed"),
        ("drive and mode", "F308", "`mode` is a word, and a truth value is needed"),
        ("mode = true", "F308", "`mode` is a word, and a truth value is needed"),
        ("'docking'", "F308", '`"docking"` is a word, and a truth value is needed'),
        (
            "drive = 'docking'",
            "F308",
            '`"docking"` is a word, and `drive` has no `values`',
        ),
        ("battery", "F308", "`battery` is in %, and a truth value is needed"),
        ("not battery", "F308", "`battery` is in %, and a truth value is needed"),
        ("drive < true", "F308", "a number is needed, and this is a truth value"),
        ("mood = docking", "F309", "`mood` is not declared"),
        ("mood = 'docking'", "F309", "`mood` is not declared"),
    ],
)
def test_what_cannot_be_compared_is_one_mistake(text: str, code: str, message: str) -> None:
    found, (wrong,) = read(text)
    assert found is not None
    assert "p" not in found.propositions
    assert (wrong.code.number, wrong.message) == (code, message)
    assert wrong.span is not None
    assert wrong.help


def test_an_unknown_word_is_suggested_and_all_are_listed() -> None:
    _, (wrong,) = read("mode = dokcing")
    assert wrong.help == "did you mean `docking`? its values are `drive`, `docking`, `in motion`"
    assert wrong.span is not None
    assert wrong.span.text == "dokcing"


def test_a_name_of_a_sentence_is_a_word_with_quotes_and_without() -> None:
    declared, _ = read("drive")
    assert declared is not None
    for text in ('"mode" = docking', '"mode" = "docking"'):
        tree = sentence(Source("r", f"the agv shall always satisfy {text} & p").span())
        assert not isinstance(tree, Diagnostic)
        found = resolve_words(tree.response, declared.signals)
        docks = e.Comparison("=", MODE, e.Word("docking"))
        assert found == e.And((docks, e.Name("p")))
        assert expression(docks) == '"mode" = docking'
    spaced = parse(Source("e", "mode = 'in motion'").span())
    assert not isinstance(spaced, Diagnostic)
    assert expression(spaced) == '"mode" = "in motion"'


def test_a_deep_sentence_is_read() -> None:
    tree: e.Expression = e.Comparison("=", MODE, e.Name("docking"))
    for _ in range(2400):
        tree = e.Not(tree)
    declared, _ = read("drive")
    assert declared is not None
    found = resolve_words(tree, declared.signals)
    assert e.Word("docking") in [p for p in e.parts(found) if isinstance(p, e.Word)]  # type: ignore[arg-type]


SIGNAL = """\
[clock]
tick = "100 ms"
[signal.mode]
path = "/mode.data"
{}
[proposition.p]
expr = "mode != 'x'"
"""


@pytest.mark.parametrize(
    ("lines", "place", "message"),
    [
        ("values = []", "5:10", "`values` must be a list of words, or a table of their numbers"),
        ("values = {}", "5:10", "`values` must be a list of words, or a table of their numbers"),
        ("values = 'x'", "5:10", "`values` must be a list of words, or a table of their numbers"),
        ("values = ['x', 'y', 'x']", "5:22", "`x` is twice in `values`"),
        ("values = { x = 1, y = 1 }", "5:23", "`x` and `y` are both 1"),
        ("values = { x = 'a' }", "5:16", "the number of `x` must be a whole number below 2^53"),
        ("values = { x = true }", "5:16", "the number of `x` must be a whole number below 2^53"),
        (
            "values = { x = 9007199254740992 }",
            "5:16",
            "the number of `x` must be a whole number below 2^53",
        ),
        (
            "values = ['x', 3]",
            "5:10",
            "a word must be a text of 1 to 100 characters on one line, without a double quote",
        ),
        (
            "values = ['x', '']",
            "5:10",
            "a word must be a text of 1 to 100 characters on one line, without a double quote",
        ),
        (
            "values = ['x']\nunit = 'm'",
            "6:1",
            "a signal with `values` cannot have `unit`: it is a word, not a number",
        ),
        (
            "values = ['x']\nvalid = 'x > 1'",
            "6:1",
            "a signal with `values` cannot have `valid`: it is a word, not a number",
        ),
        (
            "values = ['x']\nreduce = 'min'",
            "6:1",
            "a signal with `values` cannot have `reduce`: it is a word, not a number",
        ),
    ],
)
def test_a_mistake_of_values_is_told_at_its_place(lines: str, place: str, message: str) -> None:
    found, (wrong,) = read_bindings(Source("b.toml", SIGNAL.format(lines)))
    assert found is not None
    assert found.propositions == {}
    assert wrong.code.number == "F303"
    assert wrong.message == message
    assert wrong.span is not None
    assert f"{wrong.span.line}:{wrong.span.column}" == place


def test_the_numbers_of_words_are_in_the_order_of_the_words() -> None:
    found, _ = read("gear = park")
    assert found is not None
    assert (found.signals["gear"].values, found.signals["gear"].numbers) == (
        ("park", "drive"),
        (0, 1),
    )
    assert found.signals["mode"].numbers == ()
    assert found.signals["mode"].scale == 1


def test_valid_compares_no_words() -> None:
    text = '[clock]\ntick = "1 s"\n[signal.x]\npath = "/a.x"\nvalid = "mode = \'x\'"\n'
    _, (wrong,) = read_bindings(Source("b.toml", text))
    assert wrong.message == "`valid` is about numbers, and this compares a word"
