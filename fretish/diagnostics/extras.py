"""Optional parts of fretc: whether what one needs is installed, and how to install it."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec

from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Span


def install(extra: str) -> str:
    """How to get an optional part of fretc."""
    return (
        f"install the extra: pip install 'fretc[{extra}]' (in a checkout: pip install '.[{extra}]')"
    )


def missing_extra(
    need: str, packages: Sequence[str], extra: str, place: Span | None = None
) -> Diagnostic:
    """F908.

    Args:
        need: what is asked for, and its verb: `signatures need`.
        packages: those that it lacks.
        extra: the one that installs them.
        place: where it is asked for, if that is a place of a file.
    """
    *some, last = [f"`{name}`" for name in packages]
    names = f"{', '.join(some)} and {last}" if some else last
    return Diagnostic(Code.MISSING_EXTRA, f"{need} {names}", place, install(extra))


def unless_installed(need: str, packages: Sequence[str], extra: str) -> Diagnostic | None:
    """F908 where one of these packages is not installed; none of them is imported."""
    absent = [name for name in packages if find_spec(name) is None]
    return missing_extra(need, absent, extra) if absent else None
