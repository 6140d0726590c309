"""The messages of a table: its rows, in their order.

A table has no check sums: a changed digit is not detected, and a note says so. A row that cannot be
read is a damage, and what was recorded between its neighbours counts as unknown.
"""

from __future__ import annotations

import dataclasses
import io
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain

from mcap.records import Channel

from fretc.logs.mcap.container import ChannelDefinition
from fretc.logs.mcap.damage import LATEST, Damage
from fretc.logs.mcap.messages import Sink
from fretc.logs.signals.samples import Gap
from fretc.logs.storage.bags import NOWHERE
from fretc.logs.storage.inputs import OpenLog
from fretc.logs.storage.parts import FileContents
from fretc.logs.tables.arrow_rows import EPISODE, arrow_rows
from fretc.logs.tables.rows import Row, as_json, csv_rows, json_rows
from fretc.logs.tables.time_column import UNITS, TimeColumn, time_column
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.extras import missing_extra
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span

_DELIMITERS = {".csv": ",", ".tsv": "\t"}
"""The delimiter of the cells by the suffix; other tables have a JSON object on each line."""
TOPIC = "/table"
_LONG_NAMES = {"name", "signal", "variable", "key", "topic", "field", "series"}
"""Names of the column that names what a row of the long form measures."""


def read(log: OpenLog, sink: Sink, span: Span, suffix: str) -> FileContents | Diagnostic:
    """Pass the rows of a table to a sink.

    Args:
        log: the file, at its beginning.
        sink: receives the messages.
        span: the file, as named on the command line.
        suffix: one of the suffixes of tables.

    Returns:
        Its contents; or why it cannot be read.
    """
    text = io.TextIOWrapper(log.stream, "utf-8-sig", "surrogateescape", newline="")
    try:
        delimiter = _DELIMITERS.get(suffix)
        rows = _uncut(csv_rows(text, delimiter), log) if delimiter else json_rows(text)
        return _read(rows, {}, log, sink, span)
    finally:
        text.detach()


def read_arrow(log: OpenLog, sink: Sink, span: Span) -> FileContents | Diagnostic:
    """Pass the rows of a Parquet or Arrow file to a sink; or say why it cannot be read."""
    try:
        units, rows = arrow_rows(log.stream, log.size, log.episode)
    except ModuleNotFoundError:
        return missing_extra("this table cannot be read: that needs", ["pyarrow"], "parquet", span)
    except Exception as error:  # the reader trusts each byte, and each may be wrong
        reason = str(error).partition("\n")[0][:200] or type(error).__name__
        return diagnostic("unreadable_table", span, why=reason)
    return _read(rows, units, log, sink, span)


def _uncut(rows: Iterator[Row], log: OpenLog) -> Iterator[Row]:
    """The rows; a last one without a line break cannot be read, since its last cell may be cut."""
    log.stream.seek(-1, io.SEEK_END)
    is_whole = log.stream.read(1) in b"\r\n"
    log.stream.seek(0)
    last = next(rows, None)
    for row in rows:
        assert last is not None, "there was one"
        yield last
        last = row
    if last is not None:
        cut = "it has no line break at its end, so it may be cut"
        yield last if is_whole or last.reason else Row(last.line, (), cut)


def _read(
    rows: Iterator[Row], units: Mapping[str, str], log: OpenLog, sink: Sink, span: Span
) -> FileContents | Diagnostic:
    head = next(rows, None)
    if head is None:
        return diagnostic("empty_log", span)
    row = first = next(rows, None)
    while row is not None and row.reason:
        row = next(rows, None)
    if head.reason or first is None or row is None:
        return diagnostic("table_without_rows", span)
    column = time_column(head.texts, row.texts, units, span)
    if isinstance(column, Diagnostic):
        return column
    table = _Table(head.texts, column, sink)
    for each in chain([first] if first.reason else [], [row], rows):
        table.add(each)
        if len(table.episodes) > 1:
            least = min(table.episodes)
            return diagnostic("several_episodes", span, path=span.source.name, episode=least)
    if table.span is None:
        return diagnostic("table_without_rows", span)
    note = diagnostic(
        "assumed_unit_of_table" if column.is_assumed else "limits_of_table",
        span,
        column=column.name,
        unit=UNITS[column.unit],
    )
    return FileContents(log.sha256(), log.size, table.span, tuple(table.damages()), (note,))


@dataclasses.dataclass
class _Loss:
    """Rows that cannot be read, one after the other."""

    line: int
    reason: str
    before: int | None
    """The time of the last row before them."""
    after: int | None = None
    count: int = 1


class _Table:
    """The rows of a table, one after the other."""

    def __init__(self, columns: Sequence[str], time: TimeColumn, sink: Sink) -> None:
        self.span: Gap | None = None
        """The earliest and the latest row."""
        self._time, self._at = time, columns.index(time.name)
        self._sink = sink
        self._streams: dict[str, ChannelDefinition] = {}
        self._names = _paths(columns, self._at)
        others = [i for i in range(len(columns)) if i != self._at]
        by_name = {columns[i].strip().lower(): i for i in others}
        names = [i for name, i in by_name.items() if name in _LONG_NAMES]
        is_long = len(others) == 2 and len(names) == 1 and "value" in by_name
        self._long = (names[0], by_name["value"]) if is_long else None
        self._gaps: list[_Loss] = []
        self._last: int | None = None
        self._episode = columns.index(EPISODE) if EPISODE in columns else None
        self._episodes: set[str] = set()

    @property
    def episodes(self) -> Collection[str]:
        """The different runs that the rows name."""
        return self._episodes

    def add(self, row: Row) -> None:
        """One row."""
        time = None if row.reason else self._time.nanoseconds(row.texts[self._at])
        if time is None or not 0 <= time < LATEST:
            reason = row.reason or f"`{row.texts[self._at][:40]}` is not a time"
            if self._gaps and self._gaps[-1].after is None:
                self._gaps[-1].count += 1
            else:
                self._gaps.append(_Loss(row.line, reason, self._last))
            return
        if self._episode is not None:
            self._episodes.add(row.texts[self._episode])
        if self._gaps and self._gaps[-1].after is None:
            self._gaps[-1].after = time
        first, last = self.span or (time, time)
        self.span, self._last = (min(first, time), max(last, time)), time
        for topic, payload in self._messages(row):
            self._sink.add(self._stream(topic), time, time, memoryview(payload))

    def _messages(self, row: Row) -> Iterator[tuple[str, bytes]]:
        if self._long is None:
            yield TOPIC, row.payload or as_json(self._names, row.cells)
            return
        name, value = self._long
        yield f"{TOPIC}/{_identifier(row.texts[name])}", as_json([("value",)], [row.cells[value]])

    def _stream(self, topic: str) -> ChannelDefinition:
        stream = self._streams.get(topic)
        if stream is None:
            channel = Channel(len(self._streams) + 1, topic, "json", {}, 0)
            stream = self._streams[topic] = ChannelDefinition(channel, None)
            self._sink.declare(stream)
        return stream

    def damages(self) -> Iterator[tuple[Damage, Gap | None]]:
        """Each row that cannot be read, with the times between its neighbours."""
        assert self.span is not None, "there is a row"
        for loss in self._gaps:
            before = self.span[0] if loss.before is None else loss.before
            after = self.span[1] if loss.after is None else loss.after
            more = f", and {loss.count - 1} after it" if loss.count > 1 else ""
            what = f"line {loss.line}{more} cannot be read: {loss.reason}"
            code = Code.TRUNCATED_LOG if loss.after is None else Code.DAMAGED_CHUNK
            yield Damage(NOWHERE, what, code=code), (min(before, after), max(before, after))


def _paths(columns: Sequence[str], time: int) -> list[tuple[str, ...]]:
    """For each column the names of its field: `pose.x` is a field of `pose`."""
    paths: list[tuple[str, ...]] = []
    taken: set[tuple[str, ...]] = set()
    for i, column in enumerate(columns):
        path = tuple(_identifier(part) for part in column.strip().strip("/").split("."))
        whole, number = path, 2
        while any(whole[: len(each)] == each[: len(whole)] for each in taken):
            path = ("_".join(path),)
            whole, number = (f"{path[0]}_{number}",), number + 1
        paths.append(() if i == time else whole)
        taken.add(whole)
    return paths


def _identifier(name: str) -> str:
    word = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")
    return word if word[:1].isalpha() else f"column_{word}"
