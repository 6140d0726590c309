"""Diagnostics about a log: one function for each message (F400 to F418).

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
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity, suggestion
from fretish.diagnostics.extras import install_help
from fretish.diagnostics.source import Span
from fretish.reading.toml_text import as_key

_SECOND = 10**9
_MOST = 20

# The whole file


def changed(place: Span) -> Diagnostic:
    """F903: the bytes that were read and those that were hashed may differ."""
    return Diagnostic(
        Code.UNREADABLE,
        "the log was changed while it was read",
        place,
        "wait until its recording or its copy is complete",
    )


def empty(place: Span) -> Diagnostic:
    """A log without bytes, or without messages."""
    return Diagnostic(
        Code.EMPTY_LOG,
        "the log holds no message",
        place,
        "was the recorder stopped at once, or did it subscribe to no topic?",
    )


_PACKED = {
    b"\x28\xb5\x2f\xfd": ("zstd", "zstd -d"),
    b"\x04\x22\x4d\x18": ("lz4", "lz4 -d"),
    b"\x1f\x8b": ("gzip", "gunzip"),
    b"\xfd7zXZ\x00": ("xz", "unxz"),
    b"BZh": ("bzip2", "bunzip2"),
    b"PK\x03\x04": ("zip", "unzip"),
}
"""First bytes of compressed files, and the command that unpacks them."""


def not_a_log(start: bytes, place: Span) -> Diagnostic:
    """A file of another kind, recognized by its first bytes."""
    for magic, (codec, command) in _PACKED.items():
        if start.startswith(magic):
            return Diagnostic(
                Code.NOT_A_LOG,
                f"the whole file is compressed with {codec}",
                place,
                f"unpack it first: `{command} FILE`; MCAP has a compression of its own",
            )
    return Diagnostic(
        Code.NOT_A_LOG,
        "it is not a log: neither MCAP, nor a ROS 1 bag, nor an SQLite file of rosbag2",
        place,
        "name an MCAP file, a ROS 1 bag or a rosbag2 folder",
    )


def truncated(cut: int, place: Span) -> Diagnostic:
    """A log without an end, and without a whole message before byte `cut`."""
    return Diagnostic(
        Code.TRUNCATED_LOG,
        f"the log breaks off after byte {cut}: no message in it is whole",
        place,
        "copy the log again from where it was recorded",
    )


def nothing_whole(damage: Damage, place: Span) -> Diagnostic:
    """A log with messages, none of which is whole."""
    return Diagnostic(
        Code.DAMAGED_CHUNK,
        f"no message of the log can be read: {damage.description}",
        place,
        "copy the log again from where it was recorded",
    )


def too_long(length: int, ticks: int, clock: Clock, place: Span) -> Diagnostic:
    """A log with so many ticks that a time must be wrong."""
    return Diagnostic(
        Code.UNREADABLE_LOG,
        f"the log lasts {duration(length / _SECOND)}, which is {ticks} ticks: "
        f"a message has a wrong time ({clock.time})",
        place,
        "use another `time` under `[clock]`, or a longer `tick`",
    )


# Damaged parts


def damaged(damage: Damage, gap: Gap | None, origin: int, place: Span) -> Diagnostic:
    """One damaged part; its gap is in seconds from `origin`."""
    if damage.code in (Code.TRUNCATED_LOG, Code.REINDEXED) and gap is not None:
        description = (
            damage.description if damage.at < 0 else f"the log breaks off after byte {damage.at}"
        )
        return Diagnostic(
            damage.code,
            f"{description}: complete messages end after {_seconds(gap[0] - origin)}; what "
            "follows is unknown",
            place,
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
        place,
        "copy the log again from where it was recorded; a damaged log does not count as shown",
        Severity.WARNING,
    )


def few(diagnostics: list[Diagnostic], place: Span) -> list[Diagnostic]:
    """At most a page of diagnostics; the last one counts the others."""
    if len(diagnostics) <= _MOST:
        return diagnostics
    more = f"the log is damaged in {len(diagnostics) - _MOST} more places"
    return [
        *diagnostics[:_MOST],
        Diagnostic(Code.DAMAGED_CHUNK, more, place, diagnostics[0].help, Severity.WARNING),
    ]


# One topic


def no_message(topic: str, span: Span | None) -> Diagnostic:
    """F405: the log declares the topic and has no message of it."""
    return Diagnostic(
        Code.NO_TOPIC,
        f"the log holds no message of `{topic}`",
        span,
        "the topic was recorded, but nothing was published on it",
    )


def no_topic(topic: str, topics: Collection[str], span: Span | None) -> Diagnostic:
    """F405, with the topics that are in the log."""
    near = suggestion(topic, topics)
    listed = ", ".join(sorted(topics)[:8]) + (", ..." if len(topics) > 8 else "")
    return Diagnostic(
        Code.NO_TOPIC,
        f"the topic `{topic}` is not in the log",
        span,
        f"did you mean `{near}`?" if near else f"it holds {listed}",
    )


def no_field(signal: Signal, error: FieldError) -> Diagnostic:
    """A message without the number that the signal reads."""
    return Diagnostic(Code.NO_FIELD, f"in `{signal.path.topic}` {error}", signal.span, error.fix)


def never_stated(signal: Signal, paths: Collection[str]) -> Diagnostic:
    """A signal whose field every message leaves out, as their type allows."""
    name = ".".join(signal.path.fields)
    numbers = [path.removesuffix("[:]") for path in paths]
    what = "word" if signal.values else "number"
    near = suggestion(name, numbers)
    first = f"{', '.join(numbers[:8])}{', ...' if len(numbers) > 8 else ''}"
    return Diagnostic(
        Code.NO_FIELD,
        f"no message of `{signal.path.topic}` states a {what} in `{name}`",
        signal.span,
        f"did you mean `{near}`?" if near else f"they state {first or f'no {what} at all'}",
    )


def no_constant(signal: Signal, known: Mapping[str, int]) -> Diagnostic:
    """F340: the field holds numbers, and its definition has no constants for the values."""
    name = ".".join(signal.path.fields)
    missing = [word for word in signal.values if word not in known]
    if not missing:
        message = f"two values of `{signal.name}` have the same number in `{name}`"
        fix = "remove one of them"
    else:
        near = _constant(missing[0], known)
        listed = f"it names {', '.join(list(known)[:8])}{', ...' if len(known) > 8 else ''}"
        message = (
            f"`{name}` of `{signal.path.topic}` is a number, and the definition of its messages "
            f"has no constant `{missing[0]}`"
        )
        fix = (
            f"did you mean `{near}`?"
            if near
            else f"{listed if known else 'it names none'}; or write the number of each value: "
            f"`values = {{ {as_key(missing[0])} = 0 }}`"
        )
    return Diagnostic(Code.UNKNOWN_WORD, message, signal.span, fix)


def _constant(word: str, known: Mapping[str, int]) -> str | None:
    """The constant that is most likely meant: in capitals, with a prefix, or misspelt."""
    low = word.lower()
    ends = [each for each in known if each.lower() == low or each.lower().endswith(f"_{low}")]
    return ends[0] if ends else suggestion(word, known)


def foreign_value(signal: Signal, foreign: UnmappedSamples, count: int, after: int) -> Diagnostic:
    """F423: some samples are not among the signal's values; the first comes at `after` seconds."""
    near = suggestion(foreign.text, signal.values)
    is_number = re.fullmatch(r"-?[\d.]+", foreign.text) is not None
    if is_number and not signal.numbers:
        fix = "give the number of each value: `values = { drive = 0 }`"
    elif signal.numbers and not is_number:
        fix = 'the field is a text: `values = ["drive"]`'
    else:
        fix = f"did you mean `{near}`?" if near else "add this one if it is valid"
    return Diagnostic(
        Code.FOREIGN_VALUE,
        f"{foreign.count} of {count} samples of `{signal.name}` are not among its values, the "
        f"first one `{foreign.text}` at {_seconds(after)}: they are unknown",
        signal.span,
        f"its values are {listed(signal.values)}; {fix}",
        Severity.WARNING,
    )


def no_truth(signal: Signal, foreign: UnmappedSamples, count: int, after: int) -> Diagnostic:
    """F424: some samples of a signal that is read as a truth value are neither 0 nor 1."""
    return Diagnostic(
        Code.NO_TRUTH,
        f"`{signal.name}` stands for a truth value, and {foreign.count} of {count} samples are "
        f"neither 1 nor 0, the first one {foreign.text} at {_seconds(after)}: they are unknown",
        signal.span,
        f"if it is a number, compare it: `{signal.name} > 0`",
        Severity.WARNING,
    )


def wrong_type(signal: Signal, actual: str) -> Diagnostic:
    """A topic with another type than the signal declares."""
    return Diagnostic(
        Code.WRONG_TYPE,
        f"`{signal.path.topic}` is of type `{short_type(actual)}` in the log, "
        f"not `{short_type(signal.type or '')}`",
        signal.span,
        f'write `type = "{short_type(actual)}"`, and check that `path` still fits',
    )


def several_types(signal: Signal, types: Sequence[str]) -> Diagnostic:
    """F421: the topic has messages of more than one type, and the signal names none."""
    *names, last = [f"`{name}`" if name else "no type" for name in types]
    return Diagnostic(
        Code.SEVERAL_TYPES,
        f"`{signal.path.topic}` has messages of {', '.join(names)} and {last}: "
        f"`{signal.name}` is read from all of them",
        signal.span,
        "a field of the same name may mean something else there; "
        f'with `type = "{types[0] or types[-1]}"` a log with any other is refused',
        Severity.WARNING,
    )


def unknown_encoding(signal: Signal, why: str) -> Diagnostic:
    """A topic whose messages cannot be decoded, or only with an extra that is not installed."""
    if isinstance(why, MissingExtra):
        return Diagnostic(
            Code.MISSING_EXTRA,
            f"`{signal.path.topic}` cannot be read: {why}",
            signal.span,
            install_help(why.extra),
        )
    return Diagnostic(
        Code.UNKNOWN_ENCODING,
        f"`{signal.path.topic}` cannot be read: {why}",
        signal.span,
        "fretc reads messages of ROS 2 (cdr with ros2msg or ros2idl), ROS 1 (ros1 with ros1msg), "
        "JSON (with or without jsonschema) and Protobuf",
    )


def bad_messages(signal: Signal, bad: int, count: int) -> Diagnostic:
    """A topic with single messages that cannot be decoded."""
    return Diagnostic(
        Code.BAD_MESSAGE,
        f"{bad} of {count} messages of `{signal.path.topic}` cannot be decoded: their samples are "
        "unknown",
        signal.span,
        "the recorder and the publisher may differ in the type's definition",
    )


def out_of_order(signal: Signal, late: int, count: int) -> Diagnostic:
    """A topic whose messages are out of order."""
    return Diagnostic(
        Code.OUT_OF_ORDER,
        f"{late} of {count} messages of `{signal.path.topic}` are out of order: they are sorted "
        "by time",
        signal.span,
        "check the clocks of publisher and recorder",
        Severity.WARNING,
    )


def unstamped(signal: Signal, shift: int) -> Diagnostic:
    """A topic without stamps; the stamps of others differ by `shift` nanoseconds from log times."""
    message = f"the messages of `{signal.path.topic}` have no header.stamp: their log_time is used"
    if shift < _SECOND:
        return Diagnostic(Code.NO_FIELD, message, signal.span, severity=Severity.NOTE)
    return Diagnostic(
        Code.NO_FIELD,
        f"{message}, which is {duration(shift / _SECOND)} away from the stamps of the other topics",
        signal.span,
        'two clocks are mixed: use `time = "log_time"` under `[clock]`',
        Severity.WARNING,
    )


def zero_stamps(
    topic: str, place: Span | None, zero: int, count: int, time: TimeSource
) -> Diagnostic:
    """F416: the publisher or the recorder never set the time of some messages."""
    return Diagnostic(
        Code.ZERO_STAMP,
        f"{zero} of {count} messages of `{topic}` have the time 0: their samples are unknown",
        place,
        _other_time(time),
        Severity.WARNING,
    )


def still_clock(
    topic: str, place: Span | None, same: int, count: int, time: TimeSource
) -> Diagnostic:
    """F420: many messages in a row have the same time."""
    return Diagnostic(
        Code.STILL_CLOCK,
        f"the clock of `{topic}` stands still: {same} of {count} messages have the {time} of "
        f"{STILL_RUN - 1} or more neighbours",
        place,
        f"{_other_time(time)}; what happened between them counts as one instant",
        Severity.WARNING,
    )


def _other_time(time: TimeSource) -> str:
    if time is TimeSource.LOG_TIME:
        return 'check the clock of the recorder, or use `time = "header.stamp"` under `[clock]`'
    return 'let the publisher set it, or use `time = "log_time"` under `[clock]`'


def clock_jumps(signal: Signal, jumps: int, largest: int) -> Diagnostic:
    """F417: declared time minus log time changes by more than a second between messages."""
    times = "once" if jumps == 1 else f"{jumps} times, at most"
    return Diagnostic(
        Code.CLOCK_JUMP,
        f"the clock of `{signal.path.topic}` jumps against log_time {times} by "
        f"{duration(largest / _SECOND)}",
        signal.span,
        "a clock was set, a simulation was restarted, or messages were delayed: durations around "
        "the jump are unreliable",
        Severity.WARNING,
    )


def mixed_clocks(signal: Signal, other: str, apart: int) -> Diagnostic:
    """F418: the stamps of two topics differ by more than a second, measured by log times."""
    return Diagnostic(
        Code.MIXED_CLOCKS,
        f"the stamps of `{signal.path.topic}` are {duration(abs(apart) / _SECOND)} "
        f"{'ahead of' if apart > 0 else 'behind'} those of `{other}`, measured by their "
        "recording times",
        signal.span,
        'two clocks are mixed: use `time = "log_time"` under `[clock]`, or set the clocks',
        Severity.WARNING,
    )


def _seconds(length: int) -> str:
    return seconds(length / _SECOND)
