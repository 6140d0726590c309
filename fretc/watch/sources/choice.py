"""The words of a command → the source that they name."""

from __future__ import annotations

from collections.abc import Sequence

from fretc.watch.sources.dds import Dds
from fretc.watch.sources.log import Log
from fretc.watch.sources.ros1 import Ros1
from fretc.watch.sources.source import Source
from fretish.diagnostics.diagnostic import Code, Diagnostic


def chosen(words: Sequence[str], *, follow: bool) -> Source | Diagnostic:
    """The source, not yet opened; or what is wrong with the words.

    Args:
        words: `ros1`, `dds`, or the path of a log.
        follow: whether what is still to be written to a log is waited for.
    """
    name, *more = words
    if more:
        return Diagnostic(
            Code.BAD_USAGE,
            f"`{more[0]}` is one name too many: a watch has one source",
            help="watch two robots by two commands",
        )
    if name not in ("ros1", "dds"):
        return Log(name, follow=follow)
    if follow:
        return Diagnostic(
            Code.BAD_USAGE,
            "`--follow` is for a log that is being recorded; a middleware is always followed",
            help=f"leave it out, or name the log `./{name}`",
        )
    return Ros1() if name == "ros1" else Dds()
