"""The files below an address in an object store, and the times of their last changes.

Only a store that the command line names is listed, never one that a file names. Web servers are not
listed: a page with links is not a list of files. Credentials are found by the package of the
protocol, if it supports that.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime
from typing import Any

from fretc.logs.storage import storage_diagnostics, web
from fretc.logs.storage.inputs import as_os_error
from fretc.logs.storage.log_names import is_url, name_of
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.reading.limits import with_budget

_PATTERN = re.compile(r"[*\[]|\?(?!\w+=)")
"""Characters that are not part of a name; `?versionId=...` is not part of a pattern either."""
_BYTES = 10_000_000
"""The most bytes that a list may cost: some hundred thousands of names."""


def is_store(path: str) -> bool:
    """Whether the address is in an object store, which has folders and patterns."""
    return is_url(path) and not web.is_web(path) and "::" not in path


def below(url: str, is_log: Callable[[str], bool]) -> Sequence[str] | Diagnostic | None:
    """The addresses of the logs below a folder, or of the files that a pattern matches, in order.

    Args:
        url: an address in a store; a folder ends with `/`.
        is_log: whether a file below a folder is a log, by its name.

    Returns:
        None where it is the address of a file; or why nothing can be listed.
    """
    if not url.endswith("/") and not _PATTERN.search(url):
        return None
    span = Source(name_of(url), "").span()
    try:
        return with_budget(_BYTES, span, lambda: _listed(url, is_log))
    except ImportError as error:
        return storage_diagnostics.no_package(url, error, span)
    except OSError as error:
        return diagnostic("folder_not_listed", span, reason=error.strerror or error)


def changed(url: str) -> int | None:
    """The time of the last change of a file, in nanoseconds since 1970; None: it is unknown."""
    try:
        system, path = _opened(url)
        moment = system.modified(path)
    except Exception:  # each protocol raises its own; the reader of the file reports the error
        return None
    if not isinstance(moment, datetime):
        return None
    aware = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
    return int(aware.timestamp() * 1000) * 10**6


def _opened(url: str) -> tuple[Any, str]:
    """The store, and the path in it."""
    import fsspec

    system, path = fsspec.core.url_to_fs(url, **web.options(url))
    return system, str(path)


def _listed(url: str, is_log: Callable[[str], bool]) -> Sequence[str] | None:
    """The addresses; None: a file has exactly this name.

    Raises:
        ImportError: the package of the protocol is not installed.
        OSError: the store does not answer, or its names cannot be turned into addresses.
    """
    try:
        system, path = _opened(url)
        start = _start(url, path)
        if not _PATTERN.search(url):
            names = list(_found(system, path, is_log))
        elif system.isfile(path):
            return None
        else:
            names = list(_matched(system, path, is_log))
    except ImportError:
        raise
    except Exception as error:  # each protocol raises its own exceptions
        raise as_os_error(error) from error
    return [f"{start}{name}" for name in sorted({*names})]


def _start(url: str, path: str) -> str:
    """The part of addresses before the names of a store."""
    bare, path = url.rstrip("/"), path.rstrip("/")
    if not path or not bare.endswith(path):
        raise OSError(None, "its file names cannot be turned into addresses: name each log")
    return bare[: len(bare) - len(path)]


def _found(system: Any, path: str, is_log: Callable[[str], bool]) -> Iterator[str]:
    yield from (name for name in system.find(path) if is_log(name))


def _matched(system: Any, path: str, is_log: Callable[[str], bool]) -> Iterator[str]:
    for name, about in system.glob(path, detail=True).items():
        if about.get("type") == "directory":
            yield from _found(system, name, is_log)
        else:
            yield name
