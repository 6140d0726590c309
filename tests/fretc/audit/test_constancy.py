from dataclasses import replace

from fretc.audit.constancy import PropositionTotal, never_changed, tallies_of, totals
from fretc.audit.measurements.tallies import PropositionTally
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from tests.fretc.audit.results import result
from tests.fretc.logs.logs import X


def messages(*tallies: PropositionTally) -> list[str]:
    of_all = totals({"low": each} for each in tallies)
    return [finding.message for finding in never_changed(of_all, X)]


def test_what_changed_in_one_log_is_not_told() -> None:
    assert messages(PropositionTally(5, 0, 0, 0), PropositionTally(3, 2, 0, 1)) == []


def test_what_changed_in_none_is_told_once_with_what_it_was() -> None:
    assert messages(PropositionTally(0, 7, 0, 0)) == [
        "`low` never changed in the log: it was false at 7 ticks"
    ]
    assert messages(
        PropositionTally(5, 0, 1, 0), PropositionTally(0, 1, 0, 0), PropositionTally(0, 0, 0, 0)
    ) == [
        "`low` never changed in any of 3 logs: it was true at 5 ticks, false at 1 tick, "
        "unknown at 1 tick"
    ]


def test_a_comparison_is_named_as_the_sentence_writes_it() -> None:
    total = {"(battery < 20)": PropositionTotal(PropositionTally(5, 0, 0, 0), 1)}
    known = replace(X, propositions={"(battery < 20)": X.propositions["low"]})
    assert [finding.message for finding in never_changed(total, known)] == [
        "`battery < 20` never changed in the log: it was true at 5 ticks"
    ]


def test_nothing_is_told_of_logs_without_a_tick() -> None:
    assert messages(PropositionTally(0, 0, 0, 0)) == []
    assert messages() == []


def test_a_proposition_of_two_requirements_counts_once_in_each_run() -> None:
    low = {"low": {"true": 1, "false": 2, "unknown": 3, "changes": 0}}
    both = [result(requirement=id, propositions=low) for id in ("R1", "R2")]
    runs = [tallies_of(both), tallies_of([result(propositions={})])]
    assert totals(runs) == {"low": PropositionTotal(PropositionTally(1, 2, 3, 0), 1)}


def test_what_an_error_in_the_bindings_explains_is_not_told_again() -> None:
    unknown, low = (
        {"low": PropositionTotal(PropositionTally(0, 0, 7, 0), 1)},
        {"low": PropositionTotal(PropositionTally(0, 7, 1, 0), 1)},
    )
    missing = Diagnostic(Code.NO_TOPIC, "the topic `/y` is not in the log", X.source.span())
    elsewhere = Diagnostic(Code.NO_SUCH_FILE, "there is no such file", Source("a", "").span())
    assert [*never_changed(unknown, X, [missing])] == []
    assert len([*never_changed(low, X, [missing])]) == 1
    assert len([*never_changed(unknown, X, [elsewhere])]) == 1
