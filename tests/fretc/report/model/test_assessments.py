"""What a result shows of its requirement."""

from fretc.audit.evidence.result_summaries import summary_of
from fretc.report.model.assessments import SingleAudit
from tests.fretc.audit.results import result


def test_a_result_that_lists_a_violation_is_violated_whatever_it_says() -> None:
    listed = result(verdict="satisfied", violations=[{}])
    assert SingleAudit.of(summary_of(listed), ()).verdict == "violated"
    assert SingleAudit.of(summary_of(result(verdict="satisfied")), ()).verdict == "satisfied"


def test_a_result_of_a_probability_counts_its_violations_and_is_not_violated() -> None:
    trials = {"answered": 1, "failed": 1, "open": 0}
    counted = result(verdict="inconclusive", violations=[{}], trials=trials)
    assert SingleAudit.of(summary_of(counted), ()).verdict == "inconclusive"
