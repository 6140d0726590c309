"""Damaged parts of a log, each with the time of its lost messages.

Times are nanoseconds, log times.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection
from dataclasses import field

from fretc.logs.mcap.container import Summary
from fretc.logs.signals.samples import Gap
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code

LATEST = 2**62
"""Nanoseconds, in the year 2116; a later time counts as damage."""
_HOUR = 3600 * 10**9


@dataclass(slots=True)
class Damage:
    """A part of the file whose messages are, or may be, lost."""

    at: int
    description: str
    spans: list[Gap] = field(default_factory=list)
    """The times that the file itself states for the part."""
    before: int | None = None
    after: int | None = None
    """The times of the messages before and after the part."""
    also: list[int] = field(default_factory=list)
    """Further offsets, if no whole message lies between."""
    lossless: bool = False
    """Whether no message can be missing."""
    anywhere: bool = False
    """Whether messages of any time may be lost."""
    code: Code = Code.DAMAGED_CHUNK
    certain: bool = False


class Damages:
    """The damages found in one pass through a log, compared with the summary at its end."""

    def __init__(self) -> None:
        self.certain: list[Damage] = []
        self.span: Gap | None = None
        """The earliest and the latest of the whole messages, in any order."""
        self._last: int | None = None
        self._possible: list[Damage] = []
        self._waiting: list[Damage] = []
        """The damages after which no message has been read yet."""
        self._open: Damage | None = None
        """The damage into which the next damaged part is merged."""

    def passed(self, log_time: int) -> None:
        """Record a whole message."""
        for damage in self._waiting:
            damage.after = log_time
        self._waiting.clear()
        self._open = None
        self._last = log_time
        first, latest = self.span or (log_time, log_time)
        if self.span is None or not first <= log_time <= latest:
            self.span = min(first, log_time), max(latest, log_time)

    def passed_all(self, earliest: int, latest: int, last: int) -> None:
        """Record whole messages between these times, the last one at `last`."""
        first, end = self.span or (earliest, latest)
        self.span = min(first, earliest), max(end, latest)
        self._last = last

    def add(
        self,
        at: int,
        description: str,
        span: Gap | None = None,
        *,
        lossless: bool = False,
        anywhere: bool = False,
        code: Code = Code.DAMAGED_CHUNK,
    ) -> None:
        """Add a damage; it is merged with the one before if no message lies between them.

        The truncation at the end of a log is always separate.
        """
        located = not lossless and not anywhere
        if located and self._open is not None and code is not Code.TRUNCATED_LOG:
            self._open.spans += [span] if span else []
            self._open.also.append(at)
            return
        damage = self._new(at, description)
        damage.spans += [span] if span else []
        if located and self._open is not None:
            damage.spans += self._open.spans
        damage.lossless, damage.anywhere, damage.code = lossless, anywhere, code
        if located:
            self._open = damage
        self._keep(damage)

    def add_possible(self, at: int, description: str) -> None:
        """Add a damage that counts unless the summary shows that nothing is missing."""
        self._possible.append(self._new(at, description))

    def _new(self, at: int, description: str) -> Damage:
        damage = Damage(at, description, before=self._last)
        self._waiting.append(damage)
        return damage

    def _keep(self, *damages: Damage) -> None:
        for damage in damages:
            if not damage.certain:
                damage.certain = True
                self.certain.append(damage)

    # Lost times

    def settled(
        self, summary: Summary, complete: Collection[int], counts: Counter[int], size: int
    ) -> list[tuple[Damage, Gap | None]]:
        """All damages, each with the time of its lost messages; None: none are lost.

        Args:
            summary: the summary of the file.
            complete: the offsets of the chunks that were read as a whole.
            counts: the number of messages of each channel.
            size: the size of the file in bytes.
        """
        self._compare_chunks(summary, complete)
        self._compare_counts(summary, counts, size)
        span = self._whole_log(summary)
        return [(damage, _gap(damage, span)) for damage in self.certain]

    def _compare_chunks(self, summary: Summary, complete: Collection[int]) -> None:
        """Check that each chunk of the index was read as a whole."""
        places = {damage.at: damage for damage in self._possible}
        places |= {at: damage for damage in self.certain for at in (damage.at, *damage.also)}
        for at, index in summary.chunks.items():
            if at in complete:
                continue
            span = (index.message_start_time, index.message_end_time)
            if at in places:
                places[at].spans.append(span)
                self._keep(places[at])
            else:
                self.add(at, "a chunk that the index lists is missing", span)

    def _compare_counts(self, summary: Summary, counts: Counter[int], size: int) -> None:
        """Check that as many messages were read as the statistics state."""
        statistics = summary.statistics
        if statistics is None:
            self._keep(*self._possible)
            return
        listed = {id: n for id, n in statistics.channel_message_counts.items() if n}
        right = statistics.message_count == counts.total()
        if right and (not listed or listed == counts):
            return
        self._keep(*self._possible)
        if all(damage.lossless for damage in self.certain):
            description = (
                f"it states {statistics.message_count} messages, but holds {counts.total()}"
            )
            if right:
                description = "the numbers of messages of its topics differ from the stated numbers"
            self.add(size, description, anywhere=True, code=Code.COUNT_MISMATCH)

    def _whole_log(self, summary: Summary) -> Gap:
        """The time of the whole log, as far as it is known."""
        assert self.span is not None
        spans = [self.span]
        statistics = summary.statistics
        if statistics is not None and statistics.message_count:
            spans.append((statistics.message_start_time, statistics.message_end_time))
        chunks = summary.chunks.values()
        spans += [(chunk.message_start_time, chunk.message_end_time) for chunk in chunks]
        if len(spans) == 1:  # then only the damaged parts have times
            near = (self.span[0] - _HOUR, self.span[1] + _HOUR)
            gaps = [gap for damage in self.certain for gap in damage.spans]
            spans += [gap for gap in gaps if near[0] <= gap[0] <= gap[1] <= near[1]]
        return min(a for a, _ in spans), min(LATEST, max(b for _, b in spans))


def _gap(damage: Damage, span: Gap) -> Gap | None:
    """The time of the messages that one damage has lost, within the time of the whole log."""
    if damage.lossless:
        return None
    if damage.anywhere:
        return span
    start, end = span
    spans = [(a, b) for a, b in damage.spans if start <= a <= b <= end]
    if spans:
        return min(a for a, _ in spans), max(b for _, b in spans)
    before = start if damage.before is None else damage.before
    after = end if damage.after is None else damage.after
    return min(before, after), max(before, after)
