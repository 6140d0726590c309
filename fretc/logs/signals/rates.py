"""Warnings about topics whose messages are too rare or too late for the clock or for `max_age`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.logs.signals.samples import Recording, Times, Topic
from fretish.bindings.amounts import duration, exact_duration
from fretish.bindings.declarations import Declarations, Signal
from fretish.clock import Clock, in_words
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span

_JITTER = 1.1
"""The tolerance of a period: a topic of 10 Hz also has periods a little above 100 ms."""
_FEW = 10
"""A topic with fewer messages has no rate."""
_MOST_LATENESS = 2 * 10**9
"""Nanoseconds; a larger lateness is a difference of clocks."""
_EVENTS = 3
"""A topic with a period of so many times the median one sends on events, not at a rate."""


def slow_topics(
    declarations: Declarations, recording: Recording, signals: Sequence[str]
) -> Iterator[Diagnostic]:
    """F318 for each signal that is too old between messages, F315 for topics slower than ticks.

    Half of the periods between its messages are longer than `max_age`, or (by a tenth) than a tick.
    If `max_age` is stated, the use of earlier samples is intended. A topic that sends on events
    gets no warning.

    Args:
        declarations: clock and signals.
        recording: read with these signals.
        signals: names of declared signals.
    """
    tick = _tick(declarations.clock, recording)
    slow: set[str] = set()
    for name in signals:
        signal = declarations.signals[name]
        topic = recording.topics.get(signal.path.topic)
        if topic is None or topic.median_period_ns is None:
            continue
        period = topic.median_period_ns
        if signal.max_age is not None:
            if period > signal.max_age:
                yield diagnostic(
                    "sample_too_old",
                    signal.span,
                    topic=signal.path.topic,
                    period=_long(period, signal.max_age),
                    signal=signal.name,
                    max_age=exact_duration(signal.max_age / 1000000000.0),
                )
        elif tick is not None and period > tick * _JITTER and _is_regular(topic):
            if topic.name in slow:
                continue
            slow.add(topic.name)
            yield _slow(signal, period, declarations.clock, tick)


def late_topics(
    declarations: Declarations, recording: Recording, signals: Sequence[str], ticks: Times
) -> Iterator[Diagnostic]:
    """F429 for each topic with messages that were late for a tick.

    Args:
        declarations: clock and signals.
        recording: read with these signals.
        signals: names of declared signals.
        ticks: the times of all ticks.
    """
    read = {declarations.signals[name].path.topic: name for name in reversed(signals)}
    if declarations.clock.topic:
        read.setdefault(declarations.clock.topic, "")
    for topic, late in recording.late.items():
        count, over = late.missed(ticks)
        if topic in read and count:
            signal, of = declarations.signals.get(read[topic]), recording.topics[topic].count
            yield late_messages(
                topic, signal.span if signal else None, count, of, over, declarations.clock
            )


def late_messages(
    topic: str, span: Span | None, count: int, of: int, over: int, clock: Clock
) -> Diagnostic:
    """F429; `over` is the largest delay beyond the declared lateness."""
    lateness = clock.effective_lateness or 0
    needed = -(-(lateness + over) // 10**7) * 10**7
    return diagnostic(
        "late_messages",
        span,
        count=count,
        total=of,
        topic=topic,
        lateness=in_words(lateness),
        most=in_words(lateness + over),
        help=f'write `lateness = "{in_words(needed)}"` under `[clock]` to wait for them'
        if needed <= _MOST_LATENESS
        else "the clocks of publisher and recorder differ: set them, or use "
        '`time = "log_time"` under `[clock]`',
    )


def _is_regular(topic: Topic) -> bool:
    """Whether the topic sends at a rate, not on events."""
    period, longest = topic.median_period_ns or 0, topic.longest_gap_ns or 0
    return topic.count >= _FEW and longest <= _EVENTS * period


def _tick(clock: Clock, recording: Recording) -> int | None:
    """Nanoseconds of a tick; if the clock ticks by message, the median period.

    None: it is unknown.
    """
    if clock.period is not None:
        return clock.period
    topic = recording.topics.get(clock.topic or "")
    return topic.median_period_ns if topic is not None else None


def _slow(signal: Signal, period: int, clock: Clock, tick: int) -> Diagnostic:
    by = "" if clock.period is not None else f" (each message of `{clock.topic}`)"
    return diagnostic(
        "slow_topic",
        signal.span,
        topic=signal.path.topic,
        period=_long(period, tick),
        tick=exact_duration(tick / 1e9),
        by=by,
        subject=signal.path.topic,
    )


def _long(length: int, limit: int) -> str:
    return duration(length / 1e9, [limit / 1e9])
