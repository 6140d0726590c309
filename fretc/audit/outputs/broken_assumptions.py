"""Assumptions that runs do not keep, and the requirements whose results there rest on them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from compiler.formalization.formalized import FormalizedRequirement
from fretc.audit.evidence.verdicts import ASSUMPTION_BROKEN
from fretish.bindings.amounts import count_of
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class BrokenAssumption:
    """An assumption that does not hold in some runs."""

    id: str
    runs: tuple[str, ...]
    """Names of the runs, in order."""
    resting: tuple[str, ...]
    """Ids of the requirements that read a signal of it."""

    @property
    def in_words(self) -> str:
        """One sentence, or two if a requirement rests on it."""
        where = self.runs[0] if len(self.runs) == 1 else count_of(len(self.runs), "run")
        text = f"The assumption {self.id} does not hold in {where}."
        if not self.resting:
            return text
        verb = "shares" if len(self.resting) == 1 else "share"
        return f"{text} The results of {_some(self.resting)}, which {verb} its signals, rest on it."


def broken_assumptions(
    results: Iterable[tuple[str, str, str]], requirements: Sequence[FormalizedRequirement]
) -> tuple[BrokenAssumption, ...]:
    """The assumptions that a run does not keep, in the order of the requirements.

    Args:
        results: run, requirement and verdict of each result.
        requirements: all requirements of the project, assumptions included.
    """
    runs: dict[str, list[str]] = {}
    for run, requirement, verdict in results:
        if verdict == ASSUMPTION_BROKEN:
            runs.setdefault(requirement, []).append(run)
    read = {each.id: _signals(each) for each in requirements} if runs else {}
    resting = [each.id for each in requirements if not each.entry.is_assumption]
    return tuple(
        BrokenAssumption(
            id,
            tuple(runs[id]),
            tuple(other for other in resting if read[other] & read.get(id, frozenset())),
        )
        for id in [*(each.id for each in requirements if each.id in runs), *(runs.keys() - read)]
    )


def _signals(requirement: FormalizedRequirement) -> frozenset[str]:
    """The signals that a requirement reads."""
    declared = requirement.declarations.propositions if requirement.declarations else {}
    bound = (declared[name] for name in requirement.watched if name in declared)
    return frozenset(signal for proposition in bound for signal in proposition.signals)


_MOST = 5


def _some(ids: Sequence[str]) -> str:
    """`R1, R2 and R3`, or the first ones and how many there are besides."""
    if len(ids) > _MOST:
        return f"{', '.join(ids[:_MOST])} and {len(ids) - _MOST} more"
    return " and ".join(part for part in (", ".join(ids[:-1]), *ids[-1:]) if part)
