"""What a worker of Dask does whom a log kills.

In a module that imports no more than the work itself: a worker that begins in place of another one
may be in a folder that is gone.
"""

import os
import signal

from fretc.audit import dask_executor
from fretc.audit.many_logs import LogResult

LOG = "03.mcap"


def work(plan: bytes, log: str, folder: str, edition: str) -> LogResult | str:
    """The work, which no patch reaches there; one log kills who does it."""
    if log == LOG:
        os.kill(os.getpid(), signal.SIGKILL)
    return dask_executor._work(plan, log, folder, edition)
