"""Every code is explained, and the examples do what they say."""

import tomllib

import pytest

from compiler.formalization.formalize import duplicate_ids, formalize
from compiler.project.stated_numbers import check_stated_numbers
from compiler.targets.python import monitor
from fretish.bindings.declarations import Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.explanations import (
    CodeExplanation,
    as_record,
    explanation,
    explanations,
    text,
)
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from tests.each import each
from tests.fixes import toml_in

EXAMPLES = {number: each for number, each in explanations().items() if each.wrong}


def diagnostics_of(kind: str, declared: str, example: str) -> list[Diagnostic]:
    """All that is said of an example."""
    if kind == "bindings":
        return list(read_bindings(Source("bindings.toml", example))[1])
    beside: Declarations | None = None
    if declared:
        beside, wrong = read_bindings(Source("bindings.toml", declared))
        assert beside is not None, wrong
    written, diagnostics = requirements(Source("r.fret", example.strip("\n")))
    found: list[Diagnostic] = [*diagnostics, *duplicate_ids(written).values()]
    for entry in written:
        requirement, remarks = formalize(entry, beside)
        found.extend(remarks)
        found.extend(
            check_stated_numbers(requirement, requirement.declarations)
            if requirement and requirement.declarations
            else ()
        )
        remark = monitor.remark(requirement) if requirement else None
        found.extend([remark] if remark else [])
    return found


def codes_of(kind: str, declared: str, example: str) -> set[str]:
    """The codes of all that is said of an example."""
    return {diagnostic.code.number for diagnostic in diagnostics_of(kind, declared, example)}


def test_every_code_is_explained_and_nothing_else() -> None:
    assert set(explanations()) == {code.number for code in Code}


@pytest.mark.parametrize("number", EXAMPLES)
def test_an_example_gives_its_code_and_the_fixed_one_gives_none(number: str) -> None:
    example = EXAMPLES[number]
    assert number in codes_of(example.kind, example.declared, example.wrong)
    assert not codes_of(example.kind, example.declared, example.fixed)


@pytest.mark.parametrize("number", EXAMPLES)
def test_the_toml_that_an_example_is_told_to_write_parses(number: str) -> None:
    example = EXAMPLES[number]
    for diagnostic in diagnostics_of(example.kind, example.declared, example.wrong):
        for fragment in (*toml_in(diagnostic.help or ""), diagnostic.paste):
            tomllib.loads(fragment)


@each("code", Code)
def test_an_explanation_is_short_and_made_of_sentences(code: Code) -> None:
    explained = explanation(code)
    assert explained == explanations()[code.number]
    for part in (explained.cause, explained.fix):
        assert part == " ".join(part.split())
        assert part[-1] in ".?"
    assert all(len(line) <= 100 for line in text(code).splitlines())
    assert as_record(code)["cause"] == explained.cause


def test_the_text_of_a_code() -> None:
    assert text(Code.NEVER_DECIDED) == (
        "F203  no run can ever decide the requirement\n"
        "\n"
        "  The requirement has no bound, so the response may always come later. No finite run "
        "violates\n"
        "  it, and none confirms it. Its monitor can only report `pending`.\n"
        "\n"
        "  To fix it: State a bound.\n"
        "\n"
        "  to accept it, in the header of the requirement:\n"
        '    accept = { F203 = "the reason" }\n'
        "\n"
        "  wrong:\n"
        "    whenever too_close the robot shall eventually satisfy stopped\n"
        "\n"
        "  fixed:\n"
        "    whenever too_close the robot shall within 2 ticks satisfy stopped\n"
    )


def test_a_code_without_an_example_has_none_in_its_record() -> None:
    assert as_record(Code.INTERNAL)["example"] is None
    assert explanations()["F999"] == CodeExplanation(
        "fretc has a bug: it reached a state that should not occur. It gave no verdict.",
        "Report the bug with the input. `FRETC_TRACEBACK=1` shows the stack trace.",
    )
