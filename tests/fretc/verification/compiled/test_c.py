# ruff: noqa: E501
"""Compiled monitors in C are proved; what is wrong, or may hide something, is never proved."""

import os
import shutil
from dataclasses import replace
from pathlib import Path

import pytest

from compiler.logic.claims import Result
from fretc.verification.c import language as c
from fretc.verification.c.build import compiler
from fretc.verification.compiled.text import StrangeTextError
from fretc.verification.compiled.tools import ToolError
from fretc.verification.compiled.verifying import verified
from fretc.verification.engines.sandbox import Limits
from tests.compiled_monitors import (
    FOR,
    REFUSED,
    REFUTED,
    SAME,
    WITHIN,
    Checker,
    edited,
    given_c,
)
from tests.each import each
from tests.monitoring import rule

CC = compiler() or ""
LIMITS = Limits(seconds=20)
pytestmark = pytest.mark.skipif(not CC, reason="no C compiler is installed")
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
FULL = os.environ.get("HYPOTHESIS_PROFILE") == "full"


@pytest.fixture
def checker(tmp_path: Path) -> Checker:
    return Checker(c, tmp_path)


# What is wrong --------------------------------------------------------------------------------

FAULTS = (
    (WITHIN, "rail->oldest_1 >= 3", "rail->oldest_1 >= 2", REFUTED),
    (WITHIN, "rail->oldest_1 >= 3", "rail->oldest_1 > 2", SAME),
    (WITHIN, "reading->trigger = now->is_m & now->is_p;", "reading->trigger = now->is_p;", REFUTED),
    (WITHIN, "reading->open = since_2;", "reading->open = since_1;", REFUTED),
    (WITHIN, "reading->answer = now->is_m & now->is_q;", "", REFUTED),
    (WITHIN, "    rail->oldest_1 = -1;\n    rail->r1_broken", "    rail->oldest_1 = 0;\n    rail->r1_broken", REFUTED),
    (WITHIN, "reading->answer = now->is_m & now->is_q;", "reading->answer = now->is_q;", REFUTED),
    (WITHIN, "(3 - rail->oldest_1)", "(4 - rail->oldest_1)", REFUTED),
    (WITHIN, "reading->left = (since_2 & (rail", "reading->left = (since_1 & (rail", REFUTED),
    (FOR, "reading->settled = false;", "reading->settled = since_1;", REFUTED),
    (WITHIN, "reading->open = since_2;", "reading->open = &since_2 > &since_1;", REFUSED),
    (WITHIN, "reading->open = since_2;", "reading->open = since_1 | & rail->oldest_1;", REFUSED),
    (WITHIN, "now.is_q = inputs->q != FRETC_FALSE;", "now.is_q = inputs->q == FRETC_TRUE;", REFUSED),
    (WITHIN, "outcome->verdict = FRETC_PENDING;", "outcome->verdict = FRETC_SATISFIED;", REFUSED),
)  # fmt: skip


@each("fault", FAULTS)
def test_a_fault_comes_to_what_is_written_beside_it(
    fault: tuple[str, str, str, str], checker: Checker
) -> None:
    sentence, old, new, expected = fault
    one = rule(sentence)
    assert checker.kind(edited(given_c(one), old, new), one) == expected


# What is refused before it runs ---------------------------------------------------------------

BEGIN = "    fretc_reading *reading;\n"
SINCE = "const bool since_1 = rail->oldest_1 >= 3;"


@each(
    "edit",
    [
        (BEGIN, f'{BEGIN}    system("true");\n'),
        (BEGIN, f"{BEGIN}    static int n;\n"),
        (BEGIN, f"{BEGIN}    r1_init(0);\n"),
        (BEGIN, f"{BEGIN}    for (;;) {{ }}\n"),
        (BEGIN, f"{BEGIN}    while (true) {{ }}\n"),
        (BEGIN, f"{BEGIN}    rail = rail + 1;\n"),
        (BEGIN, f"{BEGIN}    rail[1].oldest_1 = 0;\n"),
        (BEGIN, f"{BEGIN}    *rail = *rail;\n"),
        (BEGIN, f"{BEGIN}    goto end; end:\n"),
        (BEGIN, f"{BEGIN}    return;\n"),
        (BEGIN, f"{BEGIN}    /* \\\n"),
        (BEGIN, f"{BEGIN}    // \n"),
        (BEGIN, f"{BEGIN}#include <stdlib.h>\n"),
        (BEGIN, f"{BEGIN}    const bool n = rail->oldest_1 <: 1 :> ;\n"),
        (BEGIN, f"{BEGIN}    const bool \u00e9 = true;\n"),
        (SINCE, "const bool since_1 = possible;"),
        (SINCE, "const bool since_1 = since_2;"),
        (SINCE, "const bool since_1 = (rail->oldest_1 = 3);"),
        (SINCE, "const bool since_1 = (rail->oldest_1++ >= 3);"),
        (SINCE, "const bool since_1 = --rail->oldest_1 >= 2;"),
        (SINCE, "const bool since_1 = rail->oldest_1-- >= 3;"),
        (SINCE, "const bool since_1 = (rail->oldest_1 >>= 1) >= 3;"),
        (SINCE, "const bool since_1 = (rail->oldest_1 -= 1) >= 2;"),
        (SINCE, "const bool since_1 = rail->oldest_1 >= 3 ??! false;"),
        (SINCE, f"{SINCE} if (since_1) {{ const bool since_1 = since_1; rail->r1_broken = since_1; }}"),
        (SINCE, "const bool since_1 = (abort(), true);"),
        (SINCE, "const bool since_1 = sizeof(rail) > 4;"),
        (SINCE, "const bool since_1 = rail > now;"),
        (SINCE, "bool since_1 = rail->oldest_1 >= 3;"),
        (SINCE, "const bool since_1 = rail->oldest_1 >= 3"),
        ("    rail->oldest_1 = -1;\n    rail->r1_broken", "    rail->r1_broken"),
        ("    rail->r1_broken = false;\n", ""),
        ("r1_clear(&state->possible);", ""),
        ("r1_judge(&outcomes->r1);", ""),
        ("bool is_m;", "int is_m;"),
        ("rail->oldest_1 = -1;\n    rail->r1_broken", "rail->oldest_1 = rail->r1_broken;\n    rail->r1_broken"),
    ],
)  # fmt: skip
def test_what_may_reach_further_is_refused(edit: tuple[str, str]) -> None:
    one = rule(WITHIN)
    with pytest.raises(StrangeTextError):
        c.checked(edited(given_c(one), *edit), [one])


def test_a_ring_is_as_fretc_writes_it() -> None:
    one = rule("whenever p the sw shall immediately satisfy occurred(33, 35, q)")
    monitor = given_c(one)
    c.checked(monitor, [one])
    for old, new in (
        ("/ 32u]", "/ 31u]"),
        ("[word] = 0u", "[word] = 1u"),
        ("word < 2u", "word < 3u"),
        ("reading->settled = false;", "reading->settled = rail->ring_since_1 > 0;"),
        ("reading->settled = false;", "reading->settled = rail->ring_since_1_at > 0;"),
        ("    if (past_since_1) {", "    rail->ring_since_1_at = 99u;\n    if (past_since_1) {"),
    ):
        with pytest.raises(StrangeTextError):
            c.checked(edited(monitor, old, new), [one])


@each(
    "edit", [("int32_t left;", "int64_t left;"), ("#endif\n\n/* The", "/* The"), ("uint8_t", "int")]
)
def test_a_header_of_another_form_is_refused(edit: tuple[str, str]) -> None:
    one = rule(WITHIN)
    monitor = given_c(one)
    assert edit[0] in monitor.header
    with pytest.raises(StrangeTextError):
        c.checked(replace(monitor, header=monitor.header.replace(*edit)), [one])


def test_a_monitor_of_other_requirements_is_refused() -> None:
    one, other = rule(WITHIN), rule(FOR, "R2")
    for rules, reason in (((), "R2"), ((other,), "other requirements")):
        with pytest.raises(StrangeTextError, match=reason):
            c.checked(given_c(other), (one, *rules)).plan(one)


def test_what_does_not_compile_is_refused(checker: Checker) -> None:
    one = rule(WITHIN)
    with pytest.raises(ToolError, match="does not compile it"):
        checker.prepared(edited(given_c(one), SINCE, "const bool since_1 = 3 3;"), one)


@pytest.mark.slow
def test_undefined_behaviour_ends_the_process_and_proves_nothing() -> None:
    """A counter that begins at the largest number overflows at the first tick."""
    one = rule(WITHIN)
    largest = edited(
        given_c(one),
        "rail->oldest_1 = -1;\n    rail->r1",
        "rail->oldest_1 = 2147483647;\n    rail->r1",
    )
    wrong = edited(largest, "(rail->oldest_1 < 4) ? (rail->oldest_1 + 1) : 4", "rail->oldest_1 + 1")
    ((_, outcome, _, _),) = verified([one], wrong, c, CC, LIMITS)
    assert outcome.result is Result.NOT_CHECKED
    assert "crashed" in outcome.detail


@pytest.mark.slow
def test_an_overflow_that_a_compiler_need_not_see_proves_nothing() -> None:
    """Without it, the text would mean the same."""
    one = rule(WITHIN)
    counted = "(rail->oldest_1 < 4) ? (rail->oldest_1 + 1) : 4"
    twice, harmless = f"{counted} : {counted}", "rail->oldest_1 < 9"
    fine = edited(given_c(one), counted, f"({harmless}) ? {twice}")
    ((_, outcome, _, _),) = verified([one], fine, c, CC, LIMITS)
    assert outcome.result is Result.PROVED, outcome.detail
    for overflow in (
        "2147483643 + rail->oldest_1 + 1 > 2147483643 + rail->oldest_1",
        "(2147483643 + rail->oldest_1) - 2147483643 == rail->oldest_1",
        "2147483643 + rail->oldest_1 > rail->oldest_1",
        "((rail->oldest_1 < 9) ? (2147483643 + rail->oldest_1) : 4) > 0",
        "2147483647 + 1 < 0",
        "0 - 2147483647 - 2 < 0",
    ):
        wrong = edited(given_c(one), counted, f"({overflow}) ? {twice}")
        ((_, outcome, _, _),) = verified([one], wrong, c, CC, LIMITS)
        assert outcome.result is Result.NOT_CHECKED, overflow
        assert "not laid out" in outcome.detail, (overflow, outcome.detail)
