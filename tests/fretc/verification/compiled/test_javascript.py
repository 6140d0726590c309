"""What is of JavaScript alone: numbers without end, and values of any type."""

from pathlib import Path

import pytest

from compiler.logic.claims import ClaimResult
from fretc.verification.compiled.verifying import explored
from fretc.verification.javascript import language as javascript
from tests.compiled_monitors import REFUTED, WITHIN, Checker, edited, given_javascript
from tests.effort import FULL
from tests.monitoring import requirement
from tests.node import needs_node


@needs_node
@pytest.mark.slow
def test_a_counter_without_end_has_too_many_states(tmp_path: Path) -> None:
    one = requirement(WITHIN)
    endless = edited(
        given_javascript(one),
        "approximation.oldest_1 < 3 ? approximation.oldest_1 + 1 : 3;",
        "approximation.oldest_1 + 1;",
    )
    checked, executable = Checker(javascript, tmp_path).prepared(endless, one)
    outcome = explored(one, executable, checked.plan(one), 200 if FULL else 40)
    assert outcome.result is ClaimResult.NOT_CHECKED


@needs_node
def test_values_of_other_types_are_told_apart(tmp_path: Path) -> None:
    """What is no truth value counts as one in conditions; as a signal it does not."""
    one = requirement("whenever p the sw shall eventually satisfy q")
    monitor = given_javascript(one)
    told = monitor.text[monitor.text.index("obligationPending: ") :].partition(",\n")[0]
    wrong = edited(monitor, f"{told},", f"{told} ? 1 : 0,")
    assert Checker(javascript, tmp_path).kind(wrong, one) == REFUTED
