"""Optional dependencies of fretc: check them, and say how to install them."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span


def install_help(extra: str) -> str:
    """The help text that says how to install an extra."""
    return (
        f"install the extra: pip install 'fretc[{extra}]' (in a checkout: pip install '.[{extra}]')"
    )


def missing_extra(
    need: str, packages: Sequence[str], extra: str, span: Span | None = None
) -> Diagnostic:
    """F908 for missing packages.

    Args:
        need: the feature and a verb: `signatures need`.
        packages: the missing packages.
        extra: the extra that installs them.
        span: the span that needs the feature, if there is one.
    """
    *some, last = [f"`{name}`" for name in packages]
    names = f"{', '.join(some)} and {last}" if some else last
    return diagnostic("missing_extra", span, need=need, names=names, help=install_help(extra))


def unless_installed(need: str, packages: Sequence[str], extra: str) -> Diagnostic | None:
    """F908 if one of the packages is not installed; the check imports none of them."""
    absent = [name for name in packages if find_spec(name) is None]
    return missing_extra(need, absent, extra) if absent else None
