"""What an audit is asked to judge: a requirement, and the text of its monitor."""

from __future__ import annotations

from dataclasses import dataclass, field

from compiler.situations.situations import Situation
from fretc.audit.evidence.basis import Basis
from fretc.audit.measurements.count_trials import Chance
from fretc.audit.measurements.violations import Demand


@dataclass(frozen=True, slots=True)
class AuditedRequirement:
    """A requirement, and the text of its monitor."""

    id: str
    sentence: str
    basis: Basis = field(compare=False)
    """SHA-256 of all that a verdict on it rests on, but for the log."""
    monitor: str
    demand: Demand
    """What is missing where it is violated."""
    situations: tuple[Situation, ...] = field(compare=False)
    """In which runs are looked at: made from the sentence and the bindings."""
    chance: Chance | None = None
    """With a probability: all runs together are judged, and no run alone."""
