"""Layer MONITOR: the text of a monitor against its sentence, as one proof."""

from __future__ import annotations

from collections.abc import Sequence

from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Layer, Proof, not_checked, proof
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.sandbox import Limits, Stopped
from fretc.verification.monitor.verifying import MOST_STATES, verified

CLAIM = "the monitor means what the sentence says"
ENGINE = "fretc, lock step with the counter automaton of the sentence"


def monitor_proof(
    rule: Formalized, name: str, text: str, limits: Limits, others: Sequence[Formalized] = ()
) -> Proof:
    """The proof about a monitor's text.

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
    if isinstance(outcome, Stopped):
        outcome = not_checked(outcome.reason)
    return proof(rule.id, Layer.MONITOR, CLAIM, outcome, ENGINE, (), {name: sha256(text)})
