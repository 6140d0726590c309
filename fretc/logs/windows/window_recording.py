"""The window of a stream as a recording, for the functions that judge recorded logs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from fretc.logs.signals.samples import Gap, Late, Recording
from fretc.logs.windows.sample_queue import SampleQueue


def window_recording(
    span: Gap,
    queues: Mapping[str, SampleQueue],
    gaps: Sequence[Gap],
    late: Mapping[str, Sequence[Gap]],
) -> Recording:
    """The samples of a window.

    Args:
        span: the begin and the end of the window.
        queues: the samples of each signal.
        gaps: intervals with lost messages.
        late: for each topic the ticks for which a message was late, as first and last time.
    """
    start, end = span
    return Recording(
        name="",
        sha256="",
        size=0,
        start_ns=start,
        end_ns=end,
        samples={name: queue.samples(gaps, end) for name, queue in queues.items()},
        ticks=np.zeros(0, np.int64),
        gaps=tuple(gaps),
        topics={},
        nearest={},
        findings=(),
        intact=not gaps,
        late={topic: Late(*np.array(spans, np.int64).T) for topic, spans in late.items() if spans},
    )
