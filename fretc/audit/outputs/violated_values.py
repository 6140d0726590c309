"""The values of signals and the beliefs of agents at a violation, for a person."""

from __future__ import annotations

from fretc.audit.evidence.schema import Result, Violation
from fretish.bindings.amounts import seconds, value


def values(result: Result, violation: Violation) -> str:
    """`speed = 1.8 m/s, battery = unknown`: each signal at the first tick of the violation.

    Args:
        result: in declared units (`fretc.audit.evidence.declared_units`).
        violation: one violation of the result.
    """
    return ", ".join(
        f'{name} = "{known}"'
        if isinstance(known, str)
        else f"{name} = {value(known, result.units.get(name, ''), _bounds(result, name))}"
        for name, known in violation.values.items()
    )


def beliefs(violation: Violation) -> str:
    """What agents believed: `` `sw` did not believe `near`, which was true from 3.2 s``."""
    return "; ".join(belief.in_words() for belief in violation.beliefs or ())


def reason(result: Result) -> str:
    """The reason of the verdict; for a violated one, with the values at the first violation.

    Args:
        result: in declared units.
    """
    first = next(iter(result.violations), None)
    if first is None or not first.values or result.trials is not None:
        return result.reason
    known = f"{result.reason}; at {seconds(first.start_s)} {values(result, first)}"
    return "; ".join(filter(None, [known, beliefs(first)]))


def _bounds(result: Result, signal: str) -> list[float]:
    """The bounds with which a signal, or its absolute value, is compared."""
    thresholds = (t for t in result.thresholds if t.signal in (signal, f"abs({signal})"))
    return [sign * threshold.bound for threshold in thresholds for sign in (1, -1)]
