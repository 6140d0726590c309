"""What to record next: inputs that lead to a situation, from the shortest tests of `fretc test`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from enum import StrEnum

from fretc.coverage.coverage import Coverage, CoverageStatus
from fretc.testing.suite import GoalResult, GoalStatus, Polarity, Repeat, Suite, Test
from fretish.bindings.amounts import seconds
from fretish.classes.frozen import dataclass
from fretish.units import nanoseconds


class Way(StrEnum):
    """Which runs can show a situation."""

    KEPT = "record"
    """A run that satisfies the requirement."""
    BROKEN = "only a run that violates the requirement can show it"
    NONE = "no run can show it"
    EXCLUDED = "no run that satisfies the other requirements can show it"


@dataclass(frozen=True, slots=True)
class Direction:
    """Instructions to reach a situation."""

    way: Way
    steps: str
    """The inputs from the start of the run; "" if no run can reach the situation."""

    @property
    def text(self) -> str:
        """The instructions on one line."""
        return f"{self.way}: {self.steps}" if self.steps else f"{self.way}"


Directions = Mapping[tuple[str, str], Direction]
"""(requirement, situation) → direction; a situation that was not searched is missing."""


def directions(suite: Suite, fingerprints: Mapping[str, str]) -> Directions:
    """The directions from a test suite.

    Args:
        suite: a suite of `fretc test`.
        fingerprints: requirement → SHA-256 of its sentence; tests of other sentences are ignored.
    """
    current = {
        requirement.id: requirement.sentence
        for requirement in suite.requirements
        if fingerprints.get(requirement.id) == requirement.fingerprint
    }
    tests = {test.name: test for test in suite.tests}
    groups: dict[tuple[str, str], dict[Polarity, GoalResult]] = {}
    for one in suite.obligations:
        if one.requirement in current:
            groups.setdefault((one.requirement, one.situation), {})[one.polarity] = one
    found = {
        key: _direction(both, tests, current[key[0]], nanoseconds(suite.clock))
        for key, both in groups.items()
    }
    return {key: direction for key, direction in found.items() if direction is not None}


def _direction(
    both: Mapping[Polarity, GoalResult],
    tests: Mapping[str, Test],
    sentence: str,
    tick: int | None,
) -> Direction | None:
    for polarity, way in ((Polarity.KEPT, Way.KEPT), (Polarity.BROKEN, Way.BROKEN)):
        one = both.get(polarity)
        if one is None or one.outcome is GoalStatus.NOT_SEARCHED:
            return None
        if one.outcome is GoalStatus.MET:
            known = [tests[name] for name in one.tests if name in tests]
            return Direction(way, steps(known[0], sentence, tick)) if known else None
    excluded = any(one.outcome is GoalStatus.EXCLUDED for one in both.values())
    return Direction(Way.EXCLUDED if excluded else Way.NONE, "")


def steps(test: Test, sentence: str, tick: int | None) -> str:
    """The inputs of a test in words: the values that the sentence reads, whenever they change.

    Args:
        test: the test.
        sentence: the sentence of the requirement.
        tick: length of a tick in nanoseconds; None if unknown.
    """
    names = [name for name in test.rows[0].values if _is_in(name, sentence)] if test.rows else []
    parts: list[str] = []
    waited, before = 0, dict[str, object]()
    for row in test.rows:
        changed = [_said(name, row) for name in names if before.get(name, ...) != row.values[name]]
        if not parts:
            parts.append(f"start with {', '.join(changed) or 'anything'}")
        elif changed:
            parts.append(f"after {_time(waited, tick)} {', '.join(changed)}")
            waited = 0
        waited += row.count
        before = {name: row.values[name] for name in names}
    return "; ".join((*parts, f"after {_time(waited, tick)} stop"))


def _is_in(name: str, sentence: str) -> bool:
    return re.search(rf"(?<![\w.]){re.escape(name)}(?![\w.])", sentence) is not None


def _said(name: str, row: Repeat) -> str:
    value = row.values[name]
    if value is None:
        return f"`{name}` unknown"
    return f"`{name}` {str(value).lower() if isinstance(value, bool) else value}"


def _time(ticks: int, tick: int | None) -> str:
    if tick is None:
        return f"{ticks} tick{'' if ticks == 1 else 's'}"
    return seconds(ticks * tick / 1e9)


def unseen(covered: Coverage, known: Directions) -> Iterator[tuple[str, str]]:
    """The situations that no run has certainly shown, but that a run can show.

    Situations that provably no run can show without violating a requirement are left out.
    """
    for requirement in covered.requirements:
        for situation in requirement.situations:
            direction = known.get((requirement.id, situation.key))
            if situation.status is not CoverageStatus.SEEN and (
                direction is None or direction.way is Way.KEPT
            ):
                yield requirement.id, situation.key


def is_complete(covered: Coverage, known: Directions) -> bool:
    """Whether every situation that a run can show has been seen."""
    measured = all(
        requirement.situations and requirement.measured for requirement in covered.requirements
    )
    return measured and next(unseen(covered, known), None) is None
