"""Diagnostics about a log whose values are computed from signals, clocks and damage.

`place` is the log itself; a diagnostic about one signal points at its line of the bindings. Times
are nanoseconds.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence

from fretc.logs.mcap.damage import Damage
from fretc.logs.messages.decoding import MissingExtra
from fretc.logs.signals.enum_values import UnmappedSamples
from fretc.logs.signals.samples import Gap
from fretc.logs.signals.signals import FieldError
from fretc.logs.signals.topic_clocks import STILL_RUN
from fretish.bindings.amounts import duration, seconds
from fretish.bindings.declarations import Signal, short_type
from fretish.bindings.words import listed
from fretish.clock import Clock, TimeSource
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity, did_you_mean, suggestion
from fretish.diagnostics.extras import install_help
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import as_key

_SECOND = 10**9
_MOST = 20

# The whole file


_PACKED = {
    b"\x28\xb5\x2f\xfd": ("zstd", "zstd -d"),
    b"\x04\x22\x4d\x18": ("lz4", "lz4 -d"),
    b"\x1f\x8b": ("gzip", "gunzip"),
    b"\xfd7zXZ\x00": ("xz", "unxz"),
    b"BZh": ("bzip2", "bunzip2"),
    b"PK\x03\x04": ("zip", "unzip"),
}
"""First bytes of compressed files, and the command that unpacks them."""


def not_a_log(start: bytes, span: Span) -> Diagnostic:
    """A file of another kind, recognized by its first bytes."""
    for magic, (codec, command) in _PACKED.items():
        if start.startswith(magic):
            return diagnostic("compressed_log", span, codec=codec, command=command)
    return diagnostic("not_a_log", span)


def truncated(cut: int, span: Span) -> Diagnostic:
    """A log without an end, and without a whole message before byte `cut`."""
    return diagnostic("truncated_log", span, cut=cut)


def too_long(length: int, ticks: int, clock: Clock, span: Span) -> Diagnostic:
    """A log with so many ticks that a time must be wrong."""
    return diagnostic(
        "log_too_long", span, length=duration(length / _SECOND), ticks=ticks, time=clock.time
    )


# Damaged parts


def damaged(damage: Damage, gap: Gap | None, origin: int, span: Span) -> Diagnostic:
    """One damaged part; its gap is in seconds from `origin`."""
    if damage.code in (Code.TRUNCATED_LOG, Code.REINDEXED) and gap is not None:
        description = (
            damage.description if damage.at < 0 else f"the log breaks off after byte {damage.at}"
        )
        return Diagnostic(
            damage.code,
            f"{description}: complete messages end after {_seconds(gap[0] - origin)}; what "
            "follows is unknown",
            span,
            "violations up to there count, but no requirement counts as satisfied",
            Severity.WARNING,
        )
    lost = "no message is known to be lost"
    if gap is not None:
        start, end = (_seconds(time - origin) for time in gap)
        lost = f"what was recorded from {start} to {end} counts as unknown"
    where = f"the log is damaged near byte {damage.at}: " if damage.at >= 0 else ""
    return Diagnostic(
        damage.code,
        f"{where}{damage.description}; {lost}",
        span,
        "copy the log again from where it was recorded; a damaged log does not count as shown",
        Severity.WARNING,
    )


def few(diagnostics: list[Diagnostic], span: Span) -> list[Diagnostic]:
    """At most a page of diagnostics; the last one counts the others."""
    if len(diagnostics) <= _MOST:
        return diagnostics
    more, help_ = len(diagnostics) - _MOST, diagnostics[0].help
    return [*diagnostics[:_MOST], diagnostic("more_damage", span, more=more, help=help_)]


# One topic


def no_message(topic: str, span: Span | None) -> Diagnostic:
    """F405: the log declares the topic and has no message of it."""
    return diagnostic("no_message", span, topic=topic)


def no_topic(topic: str, topics: Collection[str], span: Span | None) -> Diagnostic:
    """F405, with the topics that are in the log."""
    listed = ", ".join(sorted(topics)[:8]) + (", ..." if len(topics) > 8 else "")
    return diagnostic(
        "no_topic",
        span,
        topic=topic,
        help=did_you_mean(topic, topics, f"it holds {listed}"),
    )


def no_field(signal: Signal, error: FieldError) -> Diagnostic:
    """A message without the number that the signal reads."""
    return diagnostic("no_field", signal.span, topic=signal.path.topic, error=error, help=error.fix)


def never_stated(signal: Signal, paths: Collection[str]) -> Diagnostic:
    """A signal whose field every message leaves out, as their type allows."""
    name = ".".join(signal.path.fields)
    numbers = [path.removesuffix("[:]") for path in paths]
    what = "word" if signal.values else "number"
    first = f"{', '.join(numbers[:8])}{', ...' if len(numbers) > 8 else ''}"
    return diagnostic(
        "never_stated",
        signal.span,
        topic=signal.path.topic,
        what=what,
        name=name,
        help=did_you_mean(name, numbers, f"they state {first or f'no {what} at all'}"),
    )


def no_constant(signal: Signal, known: Mapping[str, int]) -> Diagnostic:
    """F340: the field holds numbers, and its definition has no constants for the values."""
    name = ".".join(signal.path.fields)
    missing = [word for word in signal.values if word not in known]
    if not missing:
        return diagnostic("equal_constants", signal.span, signal=signal.name, name=name)
    near = _constant(missing[0], known)
    listed = f"it names {', '.join(list(known)[:8])}{', ...' if len(known) > 8 else ''}"
    fix = (
        f"did you mean `{near}`?"
        if near
        else f"{listed if known else 'it names none'}; or write the number of each value: "
        f"`values = {{ {as_key(missing[0])} = 0 }}`"
    )
    topic = signal.path.topic
    return diagnostic(
        "no_constant", signal.span, name=name, topic=topic, constant=missing[0], help=fix
    )


def _constant(word: str, known: Mapping[str, int]) -> str | None:
    """The constant that is most likely meant: in capitals, with a prefix, or misspelt."""
    low = word.lower()
    ends = [each for each in known if each.lower() == low or each.lower().endswith(f"_{low}")]
    return ends[0] if ends else suggestion(word, known)


def foreign_value(signal: Signal, foreign: UnmappedSamples, count: int, after: int) -> Diagnostic:
    """F423: some samples are not among the signal's values; the first comes at `after` seconds."""
    is_number = re.fullmatch(r"-?[\d.]+", foreign.text) is not None
    if is_number and not signal.numbers:
        fix = "give the number of each value: `values = { drive = 0 }`"
    elif signal.numbers and not is_number:
        fix = 'the field is a text: `values = ["drive"]`'
    else:
        fix = did_you_mean(foreign.text, signal.values, "add this one if it is valid")
    return diagnostic(
        "foreign_value",
        signal.span,
        unmapped=foreign.count,
        count=count,
        signal=signal.name,
        sample=foreign.text,
        time=_seconds(after),
        values=listed(signal.values),
        advice=fix,
    )


def no_truth(signal: Signal, foreign: UnmappedSamples, count: int, after: int) -> Diagnostic:
    """F424: some samples of a signal that is read as a truth value are neither 0 nor 1."""
    return diagnostic(
        "no_truth",
        signal.span,
        signal=signal.name,
        unmapped=foreign.count,
        count=count,
        sample=foreign.text,
        time=_seconds(after),
    )


def wrong_type(signal: Signal, actual: str) -> Diagnostic:
    """A topic with another type than the signal declares."""
    return diagnostic(
        "wrong_type",
        signal.span,
        topic=signal.path.topic,
        type=short_type(actual),
        declared=short_type(signal.type or ""),
    )


def several_types(signal: Signal, types: Sequence[str]) -> Diagnostic:
    """F421: the topic has messages of more than one type, and the signal names none."""
    *names, last = [f"`{name}`" if name else "no type" for name in types]
    return diagnostic(
        "several_types",
        signal.span,
        topic=signal.path.topic,
        names=", ".join(names),
        last=last,
        signal=signal.name,
        first=types[0] or types[-1],
    )


def unknown_encoding(signal: Signal, why: str) -> Diagnostic:
    """A topic whose messages cannot be decoded, or only with an extra that is not installed."""
    if isinstance(why, MissingExtra):
        return diagnostic(
            "encoding_needs_extra",
            signal.span,
            topic=signal.path.topic,
            why=why,
            help=install_help(why.extra),
        )
    return diagnostic("unknown_encoding", signal.span, topic=signal.path.topic, why=why)


def bad_messages(signal: Signal, bad: int, count: int) -> Diagnostic:
    """A topic with single messages that cannot be decoded."""
    return diagnostic("bad_messages", signal.span, bad=bad, count=count, topic=signal.path.topic)


def out_of_order(signal: Signal, late: int, count: int) -> Diagnostic:
    """A topic whose messages are out of order."""
    return diagnostic("out_of_order", signal.span, late=late, count=count, topic=signal.path.topic)


def unstamped(signal: Signal, shift: int) -> Diagnostic:
    """A topic without stamps; the stamps of others differ by `shift` nanoseconds from log times."""
    if shift < _SECOND:
        return diagnostic("unstamped", signal.span, topic=signal.path.topic)
    away = duration(shift / _SECOND)
    return diagnostic("unstamped_beside_others", signal.span, topic=signal.path.topic, away=away)


def zero_stamps(
    topic: str, span: Span | None, zero: int, count: int, time: TimeSource
) -> Diagnostic:
    """F416: the publisher or the recorder never set the time of some messages."""
    return diagnostic(
        "zero_stamps", span, zero=zero, count=count, topic=topic, help=_other_time(time)
    )


def still_clock(
    topic: str, span: Span | None, same: int, count: int, time: TimeSource
) -> Diagnostic:
    """F420: many messages in a row have the same time."""
    return diagnostic(
        "still_clock",
        span,
        topic=topic,
        same=same,
        count=count,
        time=time,
        neighbours=STILL_RUN - 1,
        advice=_other_time(time),
    )


def _other_time(time: TimeSource) -> str:
    if time is TimeSource.LOG_TIME:
        return 'check the clock of the recorder, or use `time = "header.stamp"` under `[clock]`'
    return 'let the publisher set it, or use `time = "log_time"` under `[clock]`'


def clock_jumps(signal: Signal, jumps: int, largest: int) -> Diagnostic:
    """F417: declared time minus log time changes by more than a second between messages."""
    times = "once" if jumps == 1 else f"{jumps} times, at most"
    return diagnostic(
        "clock_jumps",
        signal.span,
        topic=signal.path.topic,
        times=times,
        largest=duration(largest / _SECOND),
    )


def mixed_clocks(signal: Signal, other: str, apart: int) -> Diagnostic:
    """F418: the stamps of two topics differ by more than a second, measured by log times."""
    return diagnostic(
        "mixed_clocks",
        signal.span,
        topic=signal.path.topic,
        apart=duration(abs(apart) / _SECOND),
        direction="ahead of" if apart > 0 else "behind",
        other=other,
    )


def _seconds(length: int) -> str:
    return seconds(length / _SECOND)
