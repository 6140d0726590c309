"""The signals at the first tick of a violation, as the monitor saw them and as the picture shows.

A sample that has grown too old is unknown to the monitor: its value is told with its age and the
limit, never as if it still counted.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import isinf

from fretc.audit.evidence.schema import Result, Violation
from fretc.report.model import phrases


def reading(signal: str, violation: Violation, result: Result, ages: Mapping[str, float]) -> str:
    """`0.0318 m`; `unknown: 0.0318 m is 0.5 s old, and counts for 0.3 s`.

    Args:
        signal: one of the violation's values.
        violation: with its window, where the audit kept one.
        result: where it was found.
        ages: seconds after which a sample no longer counts, by the signal; absent: never.
    """
    value, limit = _value(signal, violation), ages.get(signal)
    bounds = _bounds(signal, result)
    text = phrases.value(value, result.units.get(signal, ""), bounds)
    age = _age(signal, violation)
    if value is None or age is None or limit is None or round(age, 9) <= limit:
        return text
    old, most = phrases.seconds(age), phrases.seconds(limit)
    return (
        f"unknown: {text} is {'just over ' if old == most else ''}{old} old, and counts for {most}"
    )


def _bounds(signal: str, result: Result) -> list[float]:
    """What the signal itself, or its absolute value, is compared with."""
    unit, bounds = result.units.get(signal), list[float]()
    for each in result.thresholds:
        if each.unit == unit and each.signal == signal:
            bounds.append(each.bound)
        elif each.unit == unit and each.signal == f"abs({signal})":
            bounds.extend((each.bound, -each.bound))
    return bounds


def _value(signal: str, violation: Violation) -> float | str | None:
    """The number in the evidence; the window also knows infinite ones."""
    number = violation.values[signal]
    if number is None and violation.window and signal in violation.window.samples:
        sample = violation.window.samples[signal].at(violation.first.seconds)
        if sample is not None and isinf(sample):
            return "+inf" if sample > 0 else "-inf"
    return number


def _age(signal: str, violation: Violation) -> float | None:
    """Seconds from its last sample to the first tick; None where no sample is known."""
    if violation.window is None or signal not in violation.window.samples:
        return None
    at = violation.first.seconds
    times = [time for time in violation.window.samples[signal].times if time <= at]
    return at - times[-1] if times else None
