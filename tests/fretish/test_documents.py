"""`.fret` files: headers and sentences, and the places of their mistakes."""

import pytest

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry, requirements

SENTENCE = "whenever too_close agilex_agent shall eventually satisfy stopped"
WHOLE = f"""+++
id        = "R1"
title     = "Stop when an obstacle is within 5 cm"
parents   = ["HAZ-003"]
text      = "When an obstacle is within 5cm of it, then it must stop immediately."
rationale = "Collision with a storage drum."
status    = "approved"            # draft | approved | retired
verify    = ["audit", "ajpf"]     # planned methods
params    = {{ too_close = "5 cm" }} # numbers the requirement states
+++
{SENTENCE}
"""


def read(text: str, name: str = "r1.fret") -> tuple[RequirementEntry, ...]:
    found, wrong = requirements(Source(name, text))
    assert wrong == ()
    return found


def diagnostics_of(text: str) -> tuple[Diagnostic, ...]:
    return requirements(Source("r1.fret", text))[1]


def test_a_header_is_read_field_by_field() -> None:
    (found,) = read(WHOLE)
    assert (found.id, found.title) == ("R1", "Stop when an obstacle is within 5 cm")
    assert found.text == "When an obstacle is within 5cm of it, then it must stop immediately."
    assert (found.parents, found.verify) == (("HAZ-003",), ("audit", "ajpf"))
    assert (found.rationale, found.status) == ("Collision with a storage drum.", "approved")
    assert dict(found.params) == {"too_close": "5 cm"}
    assert (found.wording.text, found.wording.line, found.wording.column) == (SENTENCE, 11, 1)


def test_a_file_may_hold_only_a_sentence() -> None:
    (found,) = read(f"\n  {SENTENCE}\n\n", "sub/stop.fret")
    assert (found.id, found.wording.text, found.status) == ("stop", SENTENCE, "draft")
    assert (found.wording.line, found.wording.column) == (2, 3)


def test_several_pairs_follow_each_other() -> None:
    found = read(
        '+++\nid = "R1"\n+++\nthe sw shall satisfy p\n\n'
        '+++\nid = "R2"\n+++\nthe sw shall\nsatisfy q\n'
    )
    assert [(r.id, r.wording.text) for r in found] == [
        ("R1", "the sw shall satisfy p"),
        ("R2", "the sw shall\nsatisfy q"),
    ]
    assert [r.wording.line for r in found] == [4, 9]


def test_a_single_header_needs_no_id() -> None:
    (found,) = read(f'+++\ntitle = "x"\n+++\n{SENTENCE}')
    assert (found.id, found.title) == ("r1", "x")


def test_several_headers_need_ids() -> None:
    (wrong,) = diagnostics_of(
        '+++\nid = "R1"\n+++\nthe sw shall satisfy p\n+++\n+++\nsw shall satisfy q\n'
    )
    assert wrong.code is Code.BAD_FIELD
    assert wrong.message == "each requirement needs an `id` if a file holds several"
    assert wrong.span is not None
    assert wrong.span.line == 6


def test_windows_line_ends_change_nothing() -> None:
    (found,) = read(WHOLE.replace("\n", "\r\n"))
    (plain,) = read(WHOLE)
    assert (found.id, found.wording.text) == (plain.id, plain.wording.text)
    assert (found.wording.line, found.wording.column) == (11, 1)
    assert found.place("status").text == plain.place("status").text == '"approved"'


@pytest.mark.parametrize("text", [WHOLE, SENTENCE])
def test_a_byte_order_mark_changes_nothing(text: str) -> None:
    (found,) = read("\ufeff" + text)
    (plain,) = read(text)
    assert (found.id, found.wording.text) == (plain.id, plain.wording.text)


def test_three_plus_signs_inside_a_line_close_nothing() -> None:
    (found,) = read(f'+++\nid = "R1"\ntitle = "a +++ b"\n+++\n{SENTENCE}\n')
    assert (found.title, found.wording.text) == ("a +++ b", SENTENCE)


def test_three_plus_signs_inside_a_long_text_close_nothing() -> None:
    (found,) = read(f"+++\nid = \"R1\"\ntext = '''\na\n  +++ b\n'''\n+++\n{SENTENCE}\n")
    assert (found.text, found.wording.text) == ("a\n  +++ b\n", SENTENCE)


def test_an_unknown_field_is_told_with_the_nearest_one() -> None:
    (wrong,) = diagnostics_of(f'+++\nid = "R1"\nratoinale = "x"\n+++\n{SENTENCE}\n')
    assert render(wrong) == (
        "F103 unknown field `ratoinale` in a requirement's header\n"
        "  --> r1.fret:3:1\n"
        '   | ratoinale = "x"\n'
        "   | ^^^^^^^^^\n"
        "help: did you mean `rationale`?"
    )


def test_an_unknown_field_without_a_near_one_is_told_what_there_is() -> None:
    (wrong,) = diagnostics_of(f'+++\nid = "R1"\n  zzz = 1\n+++\n{SENTENCE}\n')
    assert render(wrong) == (
        "F103 unknown field `zzz` in a requirement's header\n"
        "  --> r1.fret:3:3\n"
        "   |   zzz = 1\n"
        "   |   ^^^\n"
        "help: the fields are id, kind, title, text, parents, rationale, status, verify, params, "
        "accept, fret"
    )


@pytest.mark.parametrize(
    ("line", "column", "caret", "fix"),
    [
        ('status = "done"', 10, '"done"', "write one of draft, approved, retired"),
        ("title = 3", 9, "3", "write a text in quotes"),
        ('parents = "H1"', 11, '"H1"', 'write a list of ids: `["HAZ-003"]`'),
        ("verify = [1]", 10, "[1]", 'write a list of methods: `["audit", "ajpf"]`'),
        (
            "params = { p = 5 }",
            10,
            "{ p = 5 }",
            'write a table of quantities in quotes: `{ too_close = "5 cm" }`',
        ),
        (
            'id = "../R1"',
            6,
            '"../R1"',
            "write letters, digits, `_`, `-` and `.` in quotes, beginning with a letter or digit",
        ),
    ],
)
def test_a_value_of_the_wrong_kind_is_told_at_the_value(
    line: str, column: int, caret: str, fix: str
) -> None:
    (wrong,) = diagnostics_of(f"+++\n{line} # why\n+++\n{SENTENCE}\n")
    key = line.split(" ", 1)[0]
    assert render(wrong) == (
        f"F105 `{key}` has a value of the wrong kind\n"
        f"  --> r1.fret:2:{column}\n"
        f"   | {line} # why\n"
        f"   | {' ' * (column - 1)}{'^' * len(caret)}\n"
        f"help: {fix}"
    )


def test_a_status_of_another_type_is_a_mistake_and_no_crash() -> None:
    for value in ("[]", "{}", "[['draft']]", "1979-05-27", "nan"):
        (wrong,) = diagnostics_of(f"+++\nstatus = {value}\n+++\n{SENTENCE}\n")
        assert wrong.code is Code.BAD_FIELD


def test_every_mistake_of_a_header_is_told_at_once() -> None:
    wrong = diagnostics_of(f'+++\nidd = "R1"\nstatus = "done"\n+++\n{SENTENCE}\n')
    assert [d.code for d in wrong] == [Code.UNKNOWN_FIELD, Code.BAD_FIELD]


def test_an_unclosed_header_is_told_where_it_begins() -> None:
    (wrong,) = diagnostics_of(f'+++\nid = "R1"\n\n{SENTENCE}\n')
    assert render(wrong) == (
        "F113 a header begins here and does not end\n"
        "  --> r1.fret:1:1\n"
        "   | +++\n"
        "   | ^^^\n"
        "help: close the header with a line `+++` before the sentence"
    )


def test_a_header_that_is_not_toml_is_told_at_its_place() -> None:
    (wrong,) = diagnostics_of(f'+++\nid = "R1"\ntitle = Stop\n+++\n{SENTENCE}\n')
    assert wrong.code is Code.BAD_HEADER
    assert wrong.message.startswith("the header is not TOML: ")
    assert wrong.span is not None
    assert (wrong.span.line, wrong.span.column) == (3, 9)


def test_a_mistake_in_one_header_leaves_the_others() -> None:
    found, wrong = requirements(
        Source("r.fret", '+++\nidd = "R1"\n+++\nsw shall satisfy p\n+++\nid = "R2"\n+++\nq\n')
    )
    assert [(r.id, len(r.mistakes)) for r in found] == [("r-line-4", 2), ("R2", 0)]
    assert [d.code for d in wrong] == [Code.UNKNOWN_FIELD, Code.BAD_FIELD]


def test_a_header_without_a_sentence_has_an_empty_wording() -> None:
    (found,) = read('+++\nid = "R1"\n+++\n')
    assert found.wording.text == ""


def test_an_empty_file_has_an_empty_sentence() -> None:
    (found,) = read("")
    assert (found.id, found.wording.text) == ("r1", "")


@pytest.mark.parametrize("name", ["r\udcff.fret", "r\n.fret", "r\x1b.fret", "d\udcff/r\u202e.fret"])
def test_an_id_is_text_whatever_the_file_is_called(name: str) -> None:
    ((only,), _) = requirements(Source(name, "the sw shall satisfy p"))
    assert only.id == "r_"
