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
    known, limit = _value(signal, violation), ages.get(signal)
    bounds = _bounds(signal, result)
    is_word = isinstance(violation.values[signal], str)
    value = f'"{known}"' if is_word else phrases.value(known, result.units.get(signal, ""), bounds)
    age = _age(signal, violation)
    if known is None or age is None or limit is None or round(age, 9) <= limit:
        return value
    old, most = phrases.seconds(age), phrases.seconds(limit)
    return (
        f"unknown: {value} is {'just over ' if old == most else ''}{old} old, and counts for {most}"
    )


def _bounds(signal: str, result: Result) -> list[float]:
    """What the signal itself, or its absolute value, is compared with."""
    unit, found = result.units.get(signal), list[float]()
    for each in result.thresholds:
        if each.unit == unit and each.signal == signal:
            found.append(each.bound)
        elif each.unit == unit and each.signal == f"abs({signal})":
            found.extend((each.bound, -each.bound))
    return found


def _value(signal: str, violation: Violation) -> float | str | None:
    """The number or the word in the evidence; the window also knows infinite ones."""
    known = violation.values[signal]
    if known is None and violation.window and signal in violation.window.samples:
        found = violation.window.samples[signal].at(violation.first.seconds)
        if found is not None and isinf(found):
            return "+inf" if found > 0 else "-inf"
    return known


def _age(signal: str, violation: Violation) -> float | None:
    """Seconds from its last sample to the first tick; None where no sample is known."""
    window = violation.window
    samples = (window.samples.get(signal) or window.words.get(signal)) if window else None
    if samples is None:
        return None
    at = violation.first.seconds
    known = [time for time in samples.times if time <= at]
    return at - known[-1] if known else None
