"""An estimation counts where it agrees with its runs, and not where it cannot."""

from fractions import Fraction

import pytest

from fretc.audit.evidence.probabilities import AnswerWord, Estimated, Logs, Outcomes
from fretc.audit.measurements.confidence_intervals import NOTHING_KNOWN
from fretc.audit.measurements.trials import Trials
from fretc.report.model.suspicions import about_estimation
from fretish.syntax import Probability

STATED = Probability(">=", Fraction("0.9"), "0.9")
SUMS = (
    "the evidence contradicts itself: its results for single runs do not add up to its "
    "result over all runs"
)
RUNS = [("a", True, Trials(3, 0, 1)), ("b", True, Trials(2, 1, 0))]
ALL = Outcomes(5, 1, 1)


def estimation(
    triggers: Outcomes, answer: AnswerWord = "supported", bound: str = "0.9"
) -> Estimated:
    return Estimated(
        requirement="R1",
        operator=STATED.op,
        bound=bound,
        answer=answer,
        reason="",
        confidence=0.95,
        triggers=triggers,
        logs=Logs(2, 0, 0, 0),
        estimate=None,
        bounds=NOTHING_KNOWN,
        needed=None,
        meaning="",
    )


def test_the_runs_add_up() -> None:
    assert [*about_estimation(estimation(ALL), STATED, RUNS)] == []


def test_a_copy_of_a_log_is_no_second_run() -> None:
    assert [*about_estimation(estimation(ALL), STATED, [*RUNS, RUNS[0]])] == []
    twice = Outcomes(ALL.answered + 3, ALL.failed, ALL.open + 1)
    assert [*about_estimation(estimation(twice), STATED, [*RUNS, RUNS[0]])] == [SUMS]


@pytest.mark.parametrize("wrong", [Outcomes(6, 1, 1), Outcomes(5, 0, 1), Outcomes(5, 1, 0)])
def test_runs_that_do_not_add_up(wrong: Outcomes) -> None:
    assert [*about_estimation(estimation(wrong), STATED, RUNS)] == [SUMS]


def test_another_probability() -> None:
    assert [*about_estimation(estimation(ALL, bound="0.90"), STATED, RUNS)] == [
        "the evidence is about another probability"
    ]


def test_a_damaged_log_supports_nothing_and_may_refute() -> None:
    runs = [RUNS[0], ("b", False, RUNS[1][2])]
    assert [*about_estimation(estimation(ALL, "refuted"), STATED, runs)] == []
    assert [*about_estimation(estimation(ALL), STATED, runs)] == [
        "a log is damaged, so it cannot support a probability"
    ]
