"""The values of signals at the first tick of a violation, as the monitor used them.

A sample above its age limit counts as unknown; the text has its value, its age and the limit.
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
        violation: the violation, with its window if the audit recorded one.
        result: the result with the violation.
        ages: age limit of each signal in seconds; a signal without one has no limit.
    """
    value, limit = _value(signal, violation), ages.get(signal)
    bounds = _bounds(signal, result)
    is_word = isinstance(violation.values[signal], str)
    measured = phrases.value(value, result.units.get(signal, ""), bounds)
    text = f'"{value}"' if is_word else measured
    age = _age(signal, violation)
    if value is None or age is None or limit is None or round(age, 9) <= limit:
        return text
    old, most = phrases.duration(round(age, 9), [limit]), phrases.exact_duration(limit)
    return f"unknown: {text} is {old} old, and valid for {most}"


def _bounds(signal: str, result: Result) -> list[float]:
    """The constants that thresholds compare the signal or its absolute value with."""
    unit, bounds = result.units.get(signal), list[float]()
    for threshold in result.thresholds:
        if threshold.unit == unit and threshold.signal == signal:
            bounds.append(threshold.bound)
        elif threshold.unit == unit and threshold.signal == f"abs({signal})":
            bounds.extend((threshold.bound, -threshold.bound))
    return bounds


def _value(signal: str, violation: Violation) -> float | str | None:
    """The number or word in the evidence; infinite numbers are only in the window."""
    known = violation.values[signal]
    if known is None and violation.window and signal in violation.window.samples:
        sample = violation.window.samples[signal].at(violation.first.seconds)
        if sample is not None and isinf(sample):
            return "+inf" if sample > 0 else "-inf"
    return known


def _age(signal: str, violation: Violation) -> float | None:
    """Seconds from the last sample to the first tick; None if no sample is known."""
    window = violation.window
    samples = (window.samples.get(signal) or window.words.get(signal)) if window else None
    if samples is None:
        return None
    at = violation.first.seconds
    times = [time for time in samples.times if time <= at]
    return at - times[-1] if times else None
