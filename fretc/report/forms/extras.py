"""The report in the forms of other tools, each made from the same values as the page."""

from __future__ import annotations

from importlib.util import find_spec

from fretish.diagnostics.diagnostic import Code, Diagnostic


def missing_reqif() -> Diagnostic | None:
    """F908, where what `--reqif` needs is not installed."""
    if find_spec("reqif") is not None:
        return None
    return Diagnostic(
        Code.MISSING_EXTRA,
        "a report as ReqIF needs `reqif`",
        help="install the extra: pip install 'fretc[reqif]' "
        "(in a checkout: .venv/bin/pip install '.[reqif]')",
    )
