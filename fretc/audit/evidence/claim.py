"""A requirement to audit, with the text of its monitor."""

from __future__ import annotations

from dataclasses import field

from compiler.situations.situations import Situation
from fretc.audit.evidence.verdict_inputs import VerdictInputs
from fretc.audit.measurements.count_trials import RequiredProbability
from fretc.audit.measurements.violations import DemandText
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class AuditedRequirement:
    """A requirement, and the text of its monitor."""

    id: str
    sentence: str
    verdict_inputs: VerdictInputs = field(compare=False)
    """SHA-256 of each input of the verdict other than the log."""
    monitor: str
    demand: DemandText
    """The response that is missing when the requirement is violated."""
    situations: tuple[Situation, ...] = field(compare=False)
    """The situations to look for in runs, from the sentence and the bindings."""
    chance: RequiredProbability | None = None
    """The probability; with one, only all runs together are judged."""
    is_assumption: bool = False
    """Whether it demands something of the environment."""
    beliefs: tuple[tuple[str, str], ...] = ()
    """Each proposition with its belief, where the names differ, if agents report beliefs."""
