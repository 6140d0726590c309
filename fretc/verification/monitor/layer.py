"""Layer MONITOR: the text of a monitor against its sentence, as one line of evidence."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.logic import claims as v
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.sandbox import Limits, Stopped
from fretc.verification.monitor.equivalence import NotChecked, Proved, Refuted
from fretc.verification.monitor.verifying import (
    MOST_STATES,
    Disagreement,
    Verified,
    verified,
)

CLAIM = "the monitor means what the sentence says"
ENGINE = "fretc, lock step with the counter automaton of the sentence"


def evidence(
    rule: Formalized, name: str, text: str, limits: Limits, others: Sequence[Formalized] = ()
) -> v.Evidence:
    """The evidence about a monitor's text.

    Args:
        rule: its requirement.
        name: of the file.
        text: that of its monitor, maybe with monitors of other rules.
        limits: of the process that it is executed in.
        others: rules that the text may be of, too.

    Raises:
        NotAMonitorError: the text is no generated monitor.
    """
    outcome = processes.confined(limits, verified, rule, text, MOST_STATES, tuple(others))
    result = v.NotChecked(outcome.reason) if isinstance(outcome, Stopped) else as_result(outcome)
    return v.Evidence(rule.id, v.Layer.MONITOR, CLAIM, result, ENGINE, (), {name: sha256(text)})


def as_result(outcome: Verified) -> v.Result:
    """The result in the form that all layers share."""
    match outcome.result:
        case Proved(states, steps):
            return v.Proved(
                f"the same at every tick of every trace ({states} states, {steps} steps); "
                f"columns agree on {outcome.compared} drawn ticks{_comparison(outcome)}"
            )
        case Refuted(word, expected, actual, shortest):
            length = f"{len(word)} tick{'' if len(word) == 1 else 's'}"
            kind = "the shortest trace" if shortest else "a trace"
            detail = (
                f"{kind} that shows it has {length}; after it, {_judgement(*actual)}, and should "
                f"be {_judgement(*expected)}"
            )
            return v.Counterexample(detail, v.Trace(outcome.atoms, word))
        case Disagreement(word, fault, values):
            last = f"; at its last tick {values}" if values else ""
            return v.Counterexample(f"{fault} on a trace{last}", v.Trace(outcome.atoms, word))
        case NotChecked(reason):
            return v.NotChecked(reason)
        case _:
            assert_never(outcome.result)


def _comparison(outcome: Verified) -> str:
    """The further comparisons for a text that differs from the one that fretc writes."""
    if not outcome.compared_states:
        return ""
    return (
        "; triggers, answers, open demands and unknown values as in the text that fretc writes "
        f"({outcome.compared_states} states)"
    )


def _judgement(verdict: str, finite: bool) -> str:
    return f"{verdict} ({'true' if finite else 'false'} if it ended there)"
