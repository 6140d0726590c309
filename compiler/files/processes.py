"""Processes that we start: none of them looks for its libraries in the present folder."""

from __future__ import annotations

import os


def shield() -> None:
    """Python processes that begin from now on import nothing from where they happen to run.

    Python would put the present folder first for `-c` and `-m`, which is how children are started:
    a `multiprocessing.py` beside a supplier's logs would be executed. Options such as `-P` are
    handed on by multiprocessing, the environment by every program in between.
    """
    os.environ["PYTHONSAFEPATH"] = "1"
