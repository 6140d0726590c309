"""The topics of a log, with diagnostics about their fields and clocks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from statistics import median

import numpy as np

from fretc.logs import log_diagnostics
from fretc.logs.first_messages import FirstMessages
from fretc.logs.messages.json_messages import message_leaves
from fretc.logs.messages.leaves import FieldKind
from fretc.logs.signals.samples import Samples, Topic
from fretc.logs.signals.topic_clocks import JUMP, ClockOffset, clock_offset, count_still
from fretc.logs.topic_columns import Columns, TopicColumn
from fretish.bindings.declarations import Signal
from fretish.diagnostics.diagnostic import Diagnostic


def never_stated(
    samples: Mapping[str, Samples], examples: FirstMessages, wanted: Sequence[Signal]
) -> list[Diagnostic]:
    """Warnings about JSON fields that no message has, which make their signals unknown."""
    diagnostics = []
    for signal in wanted:
        values = samples[signal.name].values
        payloads = examples.of(signal.path.topic)
        if signal.pose is not None or not payloads or not len(values) or not np.isnan(values).all():
            continue
        leaves = message_leaves(payloads)
        paths = [
            p for p, leaf in leaves.items() if signal.values or leaf.kind is not FieldKind.TEXT
        ]
        if ".".join(signal.path.fields) not in {path.removesuffix("[:]") for path in paths}:
            diagnostics.append(log_diagnostics.never_stated(signal, paths))
    return diagnostics


def clocks(columns: Columns, wanted: Sequence[Signal]) -> list[Diagnostic]:
    """Warnings about the clocks of the topics that the signals read."""
    diagnostics = list(_unmoved(columns))
    ahead: dict[str, int] = {}
    signals = {
        signal.path.topic: signal for signal in wanted if signal.path.topic in columns.topics
    }
    for topic, signal in signals.items():
        column = columns.topics[topic]
        offset = _clock_offset(column)
        if offset is not None and offset.jumps:
            diagnostics.append(
                log_diagnostics.clock_jumps(signal, offset.jumps, offset.largest_jump)
            )
        if offset is not None and not column.unstamped:
            ahead[topic] = offset.median
    middle = median(ahead.values()) if ahead else 0
    true = min(ahead, key=lambda topic: (abs(ahead[topic] - middle), abs(ahead[topic])), default="")
    for topic, shift in ahead.items():
        if abs(shift - ahead[true]) > JUMP:
            diagnostics.append(
                log_diagnostics.mixed_clocks(signals[topic], true, shift - ahead[true])
            )
    return diagnostics


def _unmoved(columns: Columns) -> Iterator[Diagnostic]:
    """Warnings about clocks that were never set, or that stand still."""
    for topic, place in columns.readers().items():
        column, time = columns.topics[topic], columns.clock.time
        if zero := int(column.unset.sum()):
            yield log_diagnostics.zero_stamps(topic, place, zero, column.count, time)
        if same := count_still(column.stamps()[~column.unset]):
            yield log_diagnostics.still_clock(topic, place, same, column.count, time)


def _clock_offset(column: TopicColumn) -> ClockOffset | None:
    """The offset of the clock, without messages whose time was never set."""
    is_set = ~column.unset
    return clock_offset(np.array(column.logs, np.int64)[is_set], column.stamps()[is_set])


def topic(column: TopicColumn) -> Topic:
    """The statistics of a topic and its clock."""
    if column.stated:
        return _counted(column)
    times = np.sort(column.stamps())
    steps = np.diff(times)
    offset = _clock_offset(column) if column.bound else None  # other topics have only log times
    return Topic(
        name=column.name,
        type=column.type,
        encoding=column.encoding,
        count=column.count,
        first_ns=int(times[0]) if len(times) else None,
        last_ns=int(times[-1]) if len(times) else None,
        longest_gap_ns=int(steps.max(initial=0)),
        out_of_order=column.late(),
        equal_stamps=int((steps == 0).sum()),
        median_period_ns=int(np.median(steps)) if len(steps) else None,
        unstamped=column.unstamped,
        zero_stamps=int(column.unset.sum()),
        clock_jumps=offset.jumps if offset is not None else 0,
    )


def _counted(column: TopicColumn) -> Topic:
    """A topic whose messages were only counted."""
    return Topic(
        name=column.name,
        type=column.type,
        encoding=column.encoding,
        count=column.count,
    )
