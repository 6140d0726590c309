"""Entry point of the `fretc` command: Ctrl-C during imports, and what is set before them."""

from __future__ import annotations

import gc
import os
import sys

_GARBAGE = 200_000
"""Number of new objects after which the garbage collector runs. Imports create no cycles, and with
Python's default of 700 the collector takes a tenth of the start-up time."""


def collect_rarely() -> None:
    """Set how often garbage is collected, as the command does."""
    gc.set_threshold(_GARBAGE)


def main() -> None:
    """Run the command; the exit status is 130 if Ctrl-C stopped it during imports.

    When it ends, Python searches all objects for cycles, which takes a fifth of the time of a short
    command. It does not search frozen objects. Files are closed and temporary folders removed
    without that search.
    """
    collect_rarely()
    # NumPy's linear algebra starts a thread for each core when it is imported: a third of the CPU
    # time of that import. Only estimates of probabilities use it, with small arrays.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        from fretc.cli import main as run

        run()
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        raise SystemExit(130) from None
    finally:
        gc.freeze()
