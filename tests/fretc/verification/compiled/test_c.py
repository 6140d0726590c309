"""What is of C alone: headers, and sums that overflow."""

from dataclasses import replace

import pytest

from compiler.logic.claims import ClaimResult
from fretc.verification.c import language as c
from fretc.verification.c.build import compiler
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.compiled.tools import ToolError, compiled
from fretc.verification.compiled.verifying import verified
from fretc.verification.engines.sandbox import CallLimits
from tests.compiled_monitors import WITHIN, edited, given_c
from tests.each import each
from tests.monitoring import requirement
from tests.programs import needs

CC = compiler() or ""
LIMITS = CallLimits(seconds=20)
pytestmark = needs("gcc")


@each(
    "edit", [("int32_t left;", "int64_t left;"), ("#endif\n\n/* The", "/* The"), ("uint8_t", "int")]
)
def test_a_header_of_another_form_is_refused(edit: tuple[str, str]) -> None:
    one = requirement(WITHIN)
    monitor = given_c(one)
    assert edit[0] in monitor.header
    with pytest.raises(UnexpectedLayoutError):
        c.checked(replace(monitor, header=monitor.header.replace(*edit)), [one])


def test_a_compiler_that_writes_nothing_is_none() -> None:
    with pytest.raises(ToolError, match=r"compiles it, but writes no `text\.so`"):
        compiled("/bin/true", (), {"text.c": ""}, [()], "text.so")


@pytest.mark.slow
def test_undefined_behaviour_ends_the_process_and_proves_nothing() -> None:
    """A counter that begins at the largest number overflows at the first tick."""
    one = requirement(WITHIN)
    largest = edited(
        given_c(one),
        "approximation->oldest_1 = -1;\n    approximation->r1",
        "approximation->oldest_1 = 2147483647;\n    approximation->r1",
    )
    wrong = edited(
        largest,
        "(approximation->oldest_1 < 4) ? (approximation->oldest_1 + 1) : 4",
        "approximation->oldest_1 + 1",
    )
    ((_, outcome, _, _),) = verified([one], wrong, c, CC, LIMITS)
    assert outcome.result is ClaimResult.NOT_CHECKED
    assert "crashed" in outcome.detail


@pytest.mark.slow
def test_an_overflow_that_a_compiler_need_not_see_proves_nothing() -> None:
    """Without it, the text would mean the same."""
    one = requirement(WITHIN)
    counted = "(approximation->oldest_1 < 4) ? (approximation->oldest_1 + 1) : 4"
    twice, harmless = f"{counted} : {counted}", "approximation->oldest_1 < 9"
    fine = edited(given_c(one), counted, f"({harmless}) ? {twice}")
    ((_, outcome, _, _),) = verified([one], fine, c, CC, LIMITS)
    assert outcome.result is ClaimResult.PROVED, outcome.detail
    for overflow in (
        "2147483643 + approximation->oldest_1 + 1 > 2147483643 + approximation->oldest_1",
        "(2147483643 + approximation->oldest_1) - 2147483643 == approximation->oldest_1",
        "2147483643 + approximation->oldest_1 > approximation->oldest_1",
        "((approximation->oldest_1 < 9) ? (2147483643 + approximation->oldest_1) : 4) > 0",
        "2147483647 + 1 < 0",
        "0 - 2147483647 - 2 < 0",
    ):
        wrong = edited(given_c(one), counted, f"({overflow}) ? {twice}")
        ((_, outcome, _, _),) = verified([one], wrong, c, CC, LIMITS)
        assert outcome.result is ClaimResult.NOT_CHECKED, overflow
        assert "not laid out" in outcome.detail, (overflow, outcome.detail)
