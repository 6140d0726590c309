"""The container formats of logs, told apart by their first bytes, and tables by their suffix."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from pathlib import PurePath

from fretc.logs import log_diagnostics
from fretc.logs.mcap.container import MAGIC
from fretc.logs.mcap.contents import contents
from fretc.logs.mcap.damage import Damage
from fretc.logs.mcap.messages import Sink
from fretc.logs.signals.integrity import Integrity
from fretc.logs.signals.samples import Gap
from fretc.logs.storage import bags, dataflash, ulog
from fretc.logs.storage.bags import NOWHERE
from fretc.logs.storage.inputs import OpenLog
from fretc.logs.storage.log_names import TEXT_TABLES
from fretc.logs.storage.parts import FileContents
from fretc.logs.storage.splits import unclosed_backup
from fretc.logs.tables import contents as tables
from fretc.logs.tables.arrow_rows import ARROW, PARQUET
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.reading.limits import extend_budget


def part(
    log: OpenLog, sink: Sink, integrity: Integrity, span: Span, wanted: Collection[str] = ()
) -> FileContents | Diagnostic:
    """The messages of one file, or the diagnostic that says why the file cannot be read.

    Args:
        log: the file.
        sink: receives the messages.
        integrity: how thoroughly the file is checked beyond the messages.
        span: the file, as named on the command line.
        wanted: the keys of its metadata records that are wanted.

    Raises:
        BrokenError: the file does not match its index.
    """
    extend_budget(log.size)
    contents = _read(log, sink, integrity, span, wanted)
    return diagnostic("changed_log", span) if log.changed() else contents


def only_grows(log: OpenLog) -> bool:
    """Whether the file is of a kind that is written from its beginning to its end."""
    log.stream.seek(0)
    return log.stream.read(len(MAGIC)) == MAGIC


def _read(
    log: OpenLog, sink: Sink, integrity: Integrity, span: Span, wanted: Collection[str]
) -> FileContents | Diagnostic:
    log.stream.seek(0)
    start = log.stream.read(_BEGINNING)
    if not start:
        return diagnostic("empty_log", span)
    if integrity is not Integrity.INDEX:
        log.begin()
    if start.startswith(MAGIC):
        return _mcap(log, sink, integrity, span, wanted)
    for magic, read in _WHOLE.items():
        if start.startswith(magic):
            return read(log, sink, span)
    suffix = PurePath(span.source.name).suffix.lower()
    if suffix in TEXT_TABLES:
        log.stream.seek(0)
        return tables.read(log, sink, span, suffix)
    return log_diagnostics.not_a_log(start, span)


def _bag(magic: bytes, log: OpenLog, sink: Sink, span: Span) -> FileContents | Diagnostic:
    if log.file is None or log.same is None:
        return diagnostic("bag_of_no_file", span)
    contents = bags.read(log.file, log.same, magic, sink, span)
    if isinstance(contents, Diagnostic):
        return contents
    damages = (*contents.damages, *_reindexed(log.file, contents.span))
    return FileContents(log.sha256(), log.size, contents.span, damages, contents.notes)


def _reindexed(file: str, span: Gap | None) -> Iterator[tuple[Damage, Gap | None]]:
    """The loss of a bag that was fixed by `rosbag reindex`."""
    backup = unclosed_backup(file)
    if backup is not None and span is not None:
        what = (
            f"the bag was reindexed: the chunk that was being written when the recording "
            f"stopped is missing (`{backup}` is beside it)"
        )
        yield Damage(NOWHERE, what, code=Code.REINDEXED), (span[1], span[1])


def _mcap(
    log: OpenLog, sink: Sink, integrity: Integrity, span: Span, wanted: Collection[str]
) -> FileContents | Diagnostic:
    held = contents(log.stream, log.size, sink, integrity, wanted)
    if held.span is not None:
        digest = log.sha256() if held.checked.hashed else held.summary_sha256
        notes = (diagnostic("without_crc", span),) if held.unprotected else ()
        return FileContents(
            digest, log.size, held.span, held.damages, notes, held.checked, held.described
        )
    if held.cut is not None:
        return log_diagnostics.truncated(held.cut, span)
    if held.damages:
        return diagnostic("no_whole_message", span, description=held.damages[0][0].description)
    return FileContents(log.sha256(), log.size, None, ())


_BEGINNING = 16
"""The first bytes of a file; enough to recognize every format."""
_WHOLE: Mapping[bytes, Callable[[OpenLog, Sink, Span], FileContents | Diagnostic]] = {
    bags.BAG: partial(_bag, bags.BAG),
    bags.DB3: partial(_bag, bags.DB3),
    ulog.MAGIC: ulog.read,
    dataflash.MAGIC: dataflash.read,
    PARQUET: tables.read_arrow,
    ARROW: tables.read_arrow,
}
"""The first bytes and the reader of each format that is always read in full."""
