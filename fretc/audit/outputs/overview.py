"""The summary of a log and its integrity, as text and as a JSON object."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from typing import Any

from compiler.files.records import plain
from fretc.audit.evidence.writer import health
from fretc.logs.messages.leaves import FieldKind, Leaf
from fretc.logs.reader import Overview
from fretc.logs.signals.samples import Recording, Topic
from fretish.bindings import amounts
from fretish.diagnostics.rendering import visible

_MOST = 8
"""The most fields of a topic in the text."""
_WIDEST = 60
"""The widest topic name, in characters, that determines the column."""


def as_record(overview: Overview) -> dict[str, Any]:
    """Plain values, with the keys in a fixed order."""
    recording = overview.recording
    record = plain(health(recording))
    for name, topic in record["topics"].items():
        leaves = overview.leaves.get(name)
        paths = {f"{name}.{path}": leaf for path, leaf in (leaves or {}).items()}
        topic["rate_hz"] = _rate(recording.topics[name])
        topic["signals"] = None if leaves is None else [*paths]
        topic["kinds"] = {path: str(leaf.kind) for path, leaf in paths.items()}
        topic["names"] = {path: dict(leaf.names) for path, leaf in paths.items() if leaf.names}
    return {
        "run": recording.name,
        "sha256": recording.sha256,
        "start_ns": recording.start_ns,
        "end_ns": recording.end_ns,
        **record,
    }


def text(overview: Overview, *, whole: bool) -> str:
    """Lines of text; with `whole`, all fields that a signal can read."""
    lines = [*_head(overview.recording), *_topics(overview, whole=whole)]
    return "".join(f"{visible(line)}\n" for line in lines)


def _head(recording: Recording) -> Iterator[str]:
    length = (recording.end_ns - recording.start_ns) / 1e9
    state = "no damage found" if recording.intact else "damaged"
    yield f"{recording.name}  {recording.size:,} bytes, {amounts.duration(length)}, {state}"
    yield f"  from     {_moment(recording.start_ns)}"
    yield f"  SHA-256  {recording.sha256}"


def _moment(ns: int) -> str:
    """A time of the log, as a date if it can be one."""
    seconds = ns // 10**9
    if not 10**8 < seconds < 10**10:  # a simulated clock begins near 0
        return amounts.seconds(ns / 1e9)
    return f"{datetime.fromtimestamp(seconds, UTC):%Y-%m-%d %H:%M:%S} UTC ({ns} ns)"


def _topics(overview: Overview, *, whole: bool) -> Iterator[str]:
    topics = overview.recording.topics
    width = min(_WIDEST, max((len(name) for name in topics), default=0))
    for name, topic in topics.items():
        odd = "".join(_oddities(topic))
        yield f"  {name:<{width}}  {topic.type or '?'}, {_count(topic)}{odd}"
        yield from (f"  {'':<{width}}    {line}" for line in _fields(overview, name, whole=whole))


def _count(topic: Topic) -> str:
    rate = _rate(topic)
    longest = (topic.longest_gap_ns or 0) / 1e9
    every = f", {rate:.4g} Hz, longest gap {amounts.duration(longest)}" if rate else ""
    return f"{topic.count} message{'' if topic.count == 1 else 's'}{every}"


def _rate(topic: Topic) -> float | None:
    """Messages per second, from the first to the last one."""
    if topic.first_ns is None or topic.last_ns is None or topic.last_ns == topic.first_ns:
        return None
    return round((topic.count - 1) / (topic.last_ns - topic.first_ns) * 1e9, 6)


def _oddities(topic: Topic) -> Iterator[str]:
    if topic.out_of_order:
        yield f", {topic.out_of_order} out of order"
    if topic.equal_stamps:
        yield f", {topic.equal_stamps} with the same time as another"
    if topic.zero_stamps:
        yield f", {topic.zero_stamps} with the time 0"


def _fields(overview: Overview, name: str, *, whole: bool) -> Iterator[str]:
    """The fields that a signal can read."""
    leaves = overview.leaves.get(name)
    if leaves is None:
        yield f"cannot be read: {overview.reasons[name]}"
        return
    listed = list(leaves.items())[: None if whole else _MOST]
    if listed:
        more = f", and {len(leaves) - len(listed)} more" if len(leaves) > len(listed) else ""
        yield f"{', '.join(_field(*each) for each in listed)}{more}"


def _field(path: str, leaf: Leaf) -> str:
    """A field with its type, unless it is a plain number."""
    if leaf.names:
        few = ", ".join(list(leaf.names)[:_MOST])
        return f".{path} ({few}{', ...' if len(leaf.names) > _MOST else ''})"
    kinds = {FieldKind.NUMBER: "", FieldKind.FLAG: " (true or false)", FieldKind.TEXT: " (text)"}
    return f".{path}{kinds[leaf.kind]}"
