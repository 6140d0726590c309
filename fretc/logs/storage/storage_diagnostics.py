"""Diagnostics about bags, folders, URLs and standard input."""

from __future__ import annotations

import errno
from collections.abc import Collection

from fretish.bindings.declarations import short_type
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import missing_extra
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span

# Standard input and URLs


def no_stdin(why: str) -> Diagnostic:
    """Standard input cannot be read."""
    return diagnostic("no_stdin", Source("<stdin>", "").span(), why=why)


def no_package(url: str, error: ImportError, span: Span) -> Diagnostic:
    """The package for URLs, or for the protocol of a URL, is not installed."""
    if error.name == "fsspec":
        return missing_extra("a URL cannot be read: that needs", ["fsspec"], "remote", span)
    return no_protocol_package(url.partition("://")[0], str(error), span)


def no_protocol_package(protocol: str, why: str, span: Span) -> Diagnostic:
    """The package for the protocol of the URL is not installed."""
    reason = why.strip().partition("\n")[0][:200]
    packages = {"s3": "s3fs", "s3a": "s3fs", "gs": "gcsfs", "gcs": "gcsfs"}
    packages |= {"az": "adlfs", "abfs": "adlfs"}
    package = packages.get(protocol.lower())
    if protocol.lower() in ("http", "https"):
        return missing_extra(
            f"`{protocol}://` addresses cannot be read: that needs", ["aiohttp"], "remote", span
        )
    if package is None:
        return diagnostic("unknown_protocol", span, protocol=protocol, reason=reason)
    return diagnostic(
        "no_protocol_package", span, protocol=protocol, reason=reason, package=package
    )


# Bags and folders


def bad_bag(why: str, span: Span, *, indexed: bool) -> Diagnostic:
    """A bag cannot be read by rosbags."""
    return diagnostic("bag_to_reindex" if indexed else "bad_bag", span, why=why)


def unchecked(span: Span, assumed: Collection[str]) -> Diagnostic:
    """The limits of a bag: no check sums, and types whose definitions it lacks."""
    if not assumed:
        return diagnostic("limits_of_bag", span)
    names = ", ".join(sorted({short_type(name) for name in assumed})[:8])
    more = ", ..." if len(set(assumed)) > 8 else ""
    return diagnostic("limits_of_bag_without_types", span, names=f"{names}{more}")


def part_of_a_run(i: int, count: int, run: str, span: Span) -> Diagnostic:
    """One file of several is read as a run of its own; `run` is the name of the whole run."""
    return diagnostic("part_of_a_run", span, number=i + 1, count=count, run=run)


def unreadable(error: OSError, span: Span) -> Diagnostic:
    """The system or the server refuses to read the file."""
    reason = error.strerror or str(error)
    fix = "check its permissions"
    if "://" in span.source.name:
        fix = "check the address, the network, and whether your credentials reach it"
    elif error.errno == errno.ENOSPC:
        fix = "free space in the folder for temporary files, or set `TMPDIR` to another folder"
    return diagnostic("unreadable_log", span, reason=reason, help=fix)
