"""What names stand for is put in once, within bounds."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from fretish import expressions as e
from fretish.bindings.declarations import Declarations
from fretish.bindings.definitions import expanded, used_definitions
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from fretish.parser import parse, parse_value
from fretish.printer import sentence as printed
from fretish.syntax import Sentence
from tests.calls import calls
from tests.effort import FULL

HEAD = """\
[clock]
tick = "100 ms"
[signal.speed]
path = "/odom.vx"
unit = "km/h"
[signal.battery]
path = "/battery.soc"
unit = "%"
"""


def declared(**values: str) -> tuple[Declarations | None, tuple[Diagnostic, ...]]:
    tables = [f'[variable.{name}]\nvalue = "{value}"\n' for name, value in values.items()]
    return read_bindings(Source("bindings.toml", HEAD + "".join(tables)))


def outcome(text: str, **values: str) -> FormalizedRequirement | tuple[Diagnostic, ...]:
    declarations, wrong = declared(**values)
    assert declarations is not None, wrong
    ((entry,), _) = requirements(Source("r.fret", f"the agv shall always satisfy {text}"))
    requirement, said = formalize(entry, declarations)
    return tuple(each for each in said if each.is_error) if requirement is None else requirement


def requirement(text: str, **values: str) -> FormalizedRequirement:
    found = outcome(text, **values)
    assert isinstance(found, FormalizedRequirement), found
    return found


def judged(text: str, **values: str) -> str:
    whole = printed(requirement(text, **values).sentence)
    return whole.removeprefix("the agv shall always satisfy ")


def codes(found: object) -> list[Code]:
    assert isinstance(found, tuple), found
    return [each.code for each in found]


@pytest.mark.parametrize(
    ("text", "values", "whole"),
    [
        ("speed < limit", {"limit": "1.5 m/s"}, "speed < 5.4"),
        ("speed < limit", {"limit": "1.5"}, "speed < 1.5"),
        ("speed < limit / 2", {"limit": "1 + 2"}, "speed < (1 + 2) / 2"),
        (
            "fast -> low",
            {"fast": "speed > 3", "low": "battery < 20 %"},
            "speed > 3 -> battery < 20",
        ),
        ("! fast", {"fast": "speed > 3"}, "!(speed > 3)"),
        ("a & b", {"b": "c & d"}, "a & c & d"),
        ("x", {"x": "y", "y": "z | z2"}, "z | z2"),
        ("speed - past < 1", {"past": "preReal(0, speed)"}, "speed - preReal(0, speed) < 1"),
    ],
)
def test_a_name_stands_for_its_value(text: str, values: dict[str, str], whole: str) -> None:
    assert judged(text, **values) == whole


def test_what_was_written_stays_and_places_are_in_the_sentence() -> None:
    found = requirement("speed < limit", limit="1.5 m/s")
    assert printed(found.written) == "the agv shall always satisfy speed < limit"
    assert found.watched == ("(speed < 5.4)",)
    wrong = outcome("speed < limit", limit="1.5 m")
    assert isinstance(wrong, tuple)
    (mistake,) = wrong
    assert mistake.code is Code.UNIT_MISMATCH
    assert mistake.span is not None
    assert (mistake.span.source.name, mistake.span.text) == ("r.fret", "limit")


def test_another_value_is_another_requirement() -> None:
    first, second = requirement("a & m", m="b | c"), requirement("a & m", m="b & c")
    assert first.fingerprint != second.fingerprint
    assert first.fingerprint == requirement("a & m", m="b | c", unused="x").fingerprint


def test_the_kind_of_a_value_is_that_of_its_place() -> None:
    assert codes(outcome("limit", limit="1.5")) == [Code.WRONG_KIND]
    assert codes(outcome("fast < 3", fast="speed > 1")) == [Code.WRONG_KIND]


@pytest.mark.parametrize(
    ("values", "names"),
    [
        ({"a": "a + 1"}, "a -> a"),
        ({"a": "b", "b": "c", "c": "b"}, "b -> c -> b"),
        ({"x": "1", "a": "x + b", "b": "a"}, "a -> b -> a"),
    ],
)
def test_a_circle_is_shown(values: dict[str, str], names: str) -> None:
    declarations, (mistake,) = declared(**values)
    assert declarations is None
    assert mistake.message == f"the values of variables form a cycle: {names}"


@pytest.mark.parametrize("name", ["speed", "FTP"])
def test_a_name_has_one_meaning(name: str) -> None:
    declarations, (mistake,) = declared(**{name: "1"})
    assert (declarations, mistake.code) == (None, Code.DOUBLE_DEFINITION)


def test_an_input_stands_for_nothing() -> None:
    text = '[variable.x]\nrole = "input"\nvalue = "1"\n'
    declarations, (mistake,) = read_bindings(Source("bindings.toml", text))
    assert (declarations, mistake.code) == (None, Code.BAD_BINDING_FIELD)


def test_a_value_that_is_no_expression_is_refused_where_it_stands() -> None:
    declarations, (mistake,) = declared(limit="1.5 +")
    assert declarations is None
    assert mistake.span is not None
    assert mistake.span.line == 10


# Bounds


def test_doublings_are_refused_before_they_are_made() -> None:
    values = {f"x{i}": f"x{i - 1} + x{i - 1}" for i in range(1, 100)}
    assert codes(outcome("x99 > 3", **values)) == [Code.TOO_LARGE]


@pytest.mark.slow
def test_a_deep_chain_is_refused_before_it_is_made() -> None:
    values = {f"x{i}": f"-({'-(' * 70}x{i - 1}{')' * 70})" for i in range(1, 60)}
    assert codes(outcome("x59 > 3", **values)) == [Code.TOO_DEEP]


# Against the text


def numbers(*names: str) -> st.SearchStrategy[str]:
    leaf = st.sampled_from([*names, "2", "0.5"])
    return st.recursive(
        leaf,
        lambda inner: st.one_of(
            st.tuples(inner, st.sampled_from("+-*/"), inner).map(" ".join),
            inner.map(lambda t: f"-({t})"),
            inner.map(lambda t: f"absReal({t})"),
            inner.map(lambda t: f"preReal(0, {t})"),
        ),
        max_leaves=4,
    )


def truths(truth_names: list[str], *number_names: str) -> st.SearchStrategy[str]:
    compared = st.tuples(
        numbers(*number_names), st.sampled_from(["<", "<=", "=", "!="]), numbers(*number_names)
    )
    return st.recursive(
        st.sampled_from(truth_names) | compared.map(" ".join),
        lambda inner: st.one_of(
            st.tuples(inner, st.sampled_from(["&", "|", "->", "<->", "xor"]), inner).map(
                lambda t: f"({t[0]}) {t[1]} ({t[2]})"
            ),
            inner.map(lambda t: f"!({t})"),
            inner.map(lambda t: f"persisted(2, {t})"),
        ),
        max_leaves=4,
    )


VALUES = st.fixed_dictionaries(
    {
        "n1": numbers("speed"),
        "n2": numbers("speed", "n1"),
        "b1": truths(["p", "q"], "n1", "n2"),
        "b2": truths(["p", "b1"], "n2"),
    }
)


@pytest.mark.slow
@given(VALUES, truths(["b1", "b2", "p"], "n1", "n2", "speed"))
def test_it_is_the_text_with_the_values_in_parentheses(values: dict[str, str], text: str) -> None:
    trees = {name: parse_value(Source("v", value).span()) for name, value in values.items()}
    definitions = {name: v for name, v in trees.items() if not isinstance(v, Diagnostic)}
    assert len(definitions) == len(values)
    start = "the agv shall until b1 satisfy "
    whole = start + text
    written = parse(Source("r", whole).span())
    assert isinstance(written, Sentence)
    for name in ("b2", "b1", "n2", "n1"):  # an inner one after those that it stands in
        whole = re.sub(rf"\b{name}\b", f"({values[name]})", whole)
    expected = parse(Source("r", whole).span())
    assert expanded(written, used_definitions(written, definitions)) == expected


def test_a_chain_costs_in_proportion_to_its_length() -> None:
    def cost(length: int) -> int:
        values = {f"d{i}": f"d{i - 1} xor p{i}" for i in range(1, length)}
        needed = {
            name: value
            for name, text in values.items()
            if not isinstance(value := parse_value(Source(name, text).span()), Diagnostic)
        }
        sentence = parse(Source("r.fret", f"the c shall satisfy d{length - 1}").span())
        assert isinstance(sentence, Sentence)
        return calls(lambda: expanded(sentence, used_definitions(sentence, needed)))

    least, small, large = cost(25), cost(50), cost(100)
    assert large - small < 2.5 * (small - least)


@pytest.mark.slow
def test_a_long_chain_of_other_names_is_one_name() -> None:
    many = 40_000 if FULL else 5_000  # more than Python's calls may stand within each other
    needed = {f"d{i}": e.Name(f"d{i - 1}") for i in range(1, many)}
    sentence = parse(Source("r.fret", f"the c shall satisfy d{many - 1}").span())
    assert isinstance(sentence, Sentence)
    found = expanded(sentence, used_definitions(sentence, needed))
    assert isinstance(found, Sentence)
    assert found.response == e.Name("d0")
