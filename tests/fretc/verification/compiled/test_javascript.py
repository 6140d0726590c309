"""Monitors in JavaScript: what faults come to, and which texts are not run."""

from pathlib import Path

import pytest

from compiler.logic.claims import Result
from fretc.verification.compiled.text import StrangeTextError
from fretc.verification.compiled.verifying import explored
from fretc.verification.javascript import language as javascript
from tests.compiled_monitors import (
    FOR,
    REFUSED,
    REFUTED,
    SAME,
    WITHIN,
    Checker,
    edited,
    given_javascript,
)
from tests.each import each
from tests.monitoring import rule

needs_node = pytest.mark.skipif(javascript.tool() is None, reason="Node is not installed")
FAULTS = (
    (WITHIN, "rail.oldest_1 >= 3;", "rail.oldest_1 >= 2;", REFUTED),
    (WITHIN, "rail.oldest_1 >= 3;", "rail.oldest_1 > 2;", SAME),
    (WITHIN, "owed: since_2,", "owed: since_1,", REFUTED),
    (WITHIN, "trigger: is_m && is_p,", "trigger: is_p,", REFUTED),
    (WITHIN, "answer: is_m && is_q,", "answer: 1,", REFUTED),
    (WITHIN, "oldest_1: -1,", "oldest_1: 0,", REFUTED),
    (WITHIN, "rail.oldest_1 + 1 : 3;", "rail.oldest_1 + 1 + true : 3;", REFUTED),
    (WITHIN, "rail.oldest_1 = 0;", "rail.oldest_1 = -0;", SAME),
    (FOR, "settled: false,", "settled: since_1,", REFUTED),
    (WITHIN, "const since_1 = ", "const since_1 = (true)(false) && ", REFUSED),
    (WITHIN, 'verdict: violated ? "violated"', 'verdict: violated ? "satisfied"', REFUSED),
    (WITHIN, "if (now.trigger) marks.last = tick;", "", REFUSED),
)


@needs_node
@pytest.mark.slow
@each("fault", FAULTS)
def test_a_fault_comes_to_what_is_written_beside_it(
    fault: tuple[str, str, str, str], tmp_path: Path
) -> None:
    sentence, old, new, expected = fault
    one = rule(sentence)
    assert (
        Checker(javascript, tmp_path).kind(edited(given_javascript(one), old, new), one) == expected
    )


@needs_node
@pytest.mark.slow
def test_a_counter_without_end_has_too_many_states(tmp_path: Path) -> None:
    one = rule(WITHIN)
    endless = edited(
        given_javascript(one), "rail.oldest_1 < 3 ? rail.oldest_1 + 1 : 3;", "rail.oldest_1 + 1;"
    )
    checked, executable = Checker(javascript, tmp_path).prepared(endless, one)
    outcome = explored(one, executable, checked.plan(one), 1000)
    assert outcome.result is Result.NOT_CHECKED


@needs_node
@pytest.mark.slow
def test_values_of_other_types_are_told_apart(tmp_path: Path) -> None:
    """What is no truth value counts as one in conditions; as a signal it does not."""
    one = rule("whenever p the sw shall eventually satisfy q")
    monitor = given_javascript(one)
    told = monitor.text[monitor.text.index("owed: ") :].partition(",\n")[0]
    wrong = edited(monitor, f"{told},", f"{told} ? 1 : 0,")
    assert Checker(javascript, tmp_path).kind(wrong, one) == REFUTED


BEGIN = "function advance(rail, tick, truths) {\n"
SINCE = "const since_1 = rail.oldest_1 >= 3;"


@each(
    "edit",
    [
        (BEGIN, f"{BEGIN} process.exit();"),
        (BEGIN, f"{BEGIN} while (true) rail.oldest_1 = 1;"),
        (BEGIN, f"{BEGIN} for (;;) rail.oldest_1 = 1;"),
        (BEGIN, f"{BEGIN} return;"),
        (BEGIN, f"{BEGIN} let n = true;"),
        (BEGIN, f"{BEGIN} var n = true;"),
        (BEGIN, f"{BEGIN} if (true) const n = true;"),
        (BEGIN, f"{BEGIN} else rail.oldest_1 = 1;"),
        (BEGIN, f"{BEGIN} if (true) if (false) rail.oldest_1 = 1;"),
        (BEGIN, f"{BEGIN} rail.doubt = true;"),
        (BEGIN, f"{BEGIN} rail.marks = true;"),
        (BEGIN, f"{BEGIN} rail.more = true;"),
        (BEGIN, f'{BEGIN} rail["oldest_1"] = 1;'),
        (BEGIN, f"{BEGIN} rail.oldest_1 += 1;"),
        (BEGIN, f"{BEGIN} rail.oldest_1 ++;"),
        (BEGIN, f"{BEGIN} const mark = true;"),
        (BEGIN, f"{BEGIN} // a comment \u2028 process.exit();\n"),
        (BEGIN, f"{BEGIN} // a comment \r process.exit();\n"),
        (BEGIN, f"{BEGIN} <!-- a comment\n"),
        (BEGIN, f"{BEGIN} /r/;"),
        (BEGIN, f"{BEGIN} `${{process.exit()}}`;"),
        (BEGIN, f"{BEGIN} const n = rail.constructor;"),
        (BEGIN, f"{BEGIN} const \\u006e = true;"),
        (BEGIN, f"{BEGIN} const n = true\n const m = true;"),
        (SINCE, "const since_1 = since_2;"),
        (SINCE, "const since_1 = tick > 3;"),
        (SINCE, "const since_1 = rail.doubt;"),
        (SINCE, "const since_1 = rail.tick > 3;"),
        (SINCE, "const since_1 = truths[0];"),
        (SINCE, "const since_1 = is_m(3);"),
        (SINCE, "const since_1 = rail.oldest_1 >= 3n;".replace("3n", '"3"')),
        (SINCE, "const since_1 = (rail.oldest_1 = 3);"),
        (SINCE, "const since_1 = rail?.oldest_1;"),
        (SINCE, "const since_1 = rail.oldest_1 >= 03;"),
        (SINCE, "const since_1 = typeof rail;"),
        (SINCE, "const since_1 = [true];"),
        ("truths[0] === null ? rail.doubt", "truths[1] === null ? rail.doubt"),
        ("oldest_1: -1,", "oldest_1: process.exit(),"),
        ("oldest_1: -1,", "get oldest_1() { return 0; },"),
        ("oldest_1: -1,", "oldest_1: -1, more: 0,"),
        ("mark(rail.marks[0], tick,", "mark(rail.marks[0], tick + 1,"),
        ("mark(rail.marks[0]", "rail.oldest_1 = 0;\n  mark(rail.marks[0]"),
        ("    return certain === possible", "    return\n certain === possible"),
        ("  return certain === possible", "  return // a comment\n certain === possible"),
        ("  return certain === possible", "  return /* a\ncomment */ certain === possible"),
        ("return { broken: -1", "return\n{ broken: -1"),
        ("export {", "export default process.exit(); export {"),
    ],
)
def test_what_may_do_more_is_not_run(edit: tuple[str, str]) -> None:
    one = rule(WITHIN)
    monitor = given_javascript(one)
    old, new = (part if edit[0] in monitor.text else part[2:] for part in edit)
    with pytest.raises(StrangeTextError):
        javascript.checked(edited(monitor, old, new), [one])


def test_a_window_is_as_fretc_writes_it() -> None:
    one = rule("only in p mode the sw shall after 2 ticks satisfy q")
    monitor = given_javascript(one)
    javascript.checked(monitor, [one])
    for old, new in (
        ("tick, 2, 2, not_q && not_p", "tick, 2, 3, not_q && not_p"),
        ("tick, 2, 2, not_q && not_p", "tick, 2, 2, not_q"),
        ("{ runs: [], first: 0 }", "{ runs: [], first: 1 }"),
        ("settled: false,", "settled: rail.kept_since_1,"),
        ("  const since_1 = slide(", "  rail.kept_since_1 = 0;\n  const since_1 = slide("),
    ):
        with pytest.raises(StrangeTextError):
            javascript.checked(edited(monitor, old, new), [one])
