"""Diagnostics about bags, folders, URLs and standard input: one function for each message."""

from __future__ import annotations

import errno
from collections.abc import Collection

from fretish.bindings.declarations import short_type
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.extras import missing_extra
from fretish.diagnostics.source import Source, Span

# Standard input and URLs


def no_stdin(why: str) -> Diagnostic:
    """Standard input cannot be read."""
    return Diagnostic(
        Code.UNREADABLE,
        f"standard input cannot be read: {why}",
        Source("<stdin>", "").span(),
        "send a log: `fretc audit - < run.mcap`",
    )


def no_package(url: str, error: ImportError, place: Span) -> Diagnostic:
    """The package for URLs, or for the protocol of a URL, is not installed."""
    if error.name == "fsspec":
        return no_fsspec(place)
    return no_protocol_package(url.partition("://")[0], str(error), place)


def unlisted(error: OSError, place: Span) -> Diagnostic:
    """An object store cannot be listed."""
    return Diagnostic(
        Code.UNREADABLE,
        f"the folder cannot be listed: {error.strerror or error}",
        place,
        "check the address, the network, and whether your credentials may list it",
    )


def no_fsspec(place: Span) -> Diagnostic:
    """The extra for URLs is not installed."""
    return missing_extra("a URL cannot be read: that needs", ["fsspec"], "remote", place)


def no_protocol_package(protocol: str, why: str, place: Span) -> Diagnostic:
    """The package for the protocol of the URL is not installed."""
    reason = why.strip().partition("\n")[0][:200]
    packages = {"s3": "s3fs", "s3a": "s3fs", "gs": "gcsfs", "gcs": "gcsfs"}
    packages |= {"az": "adlfs", "abfs": "adlfs"}
    package = packages.get(protocol.lower())
    if protocol.lower() in ("http", "https"):
        return missing_extra(
            f"`{protocol}://` addresses cannot be read: that needs", ["aiohttp"], "remote", place
        )
    return Diagnostic(
        Code.MISSING_EXTRA,
        f"`{protocol}://` addresses cannot be read: {reason}",
        place,
        f"install its package: pip install {package}"
        if package
        else "fsspec's documentation lists the package for each protocol",
    )


# Bags and folders


def no_rosbags(place: Span) -> Diagnostic:
    """The extra for bags is not installed."""
    return missing_extra("a bag cannot be read: that needs", ["rosbags"], "bags", place)


def bad_bag(why: str, place: Span, *, indexed: bool) -> Diagnostic:
    """A bag cannot be read by rosbags."""
    return Diagnostic(
        Code.UNREADABLE_LOG,
        f"the bag cannot be read: {why}",
        place,
        "fix it first: `rosbag reindex`, which loses the chunk that was being written (keep the "
        "`.orig` file beside it, so that audits report the loss); or copy it again from where "
        "it was recorded"
        if indexed
        else "copy it again from where it was recorded",
    )


def bag_of_no_file(place: Span) -> Diagnostic:
    """A bag from standard input or a URL."""
    return Diagnostic(
        Code.NOT_A_LOG, "a bag can only be read from a file", place, "save it as a file first"
    )


def unchecked(place: Span, assumed: Collection[str]) -> Diagnostic:
    """The limits of a bag: no check sums, and types whose definitions it lacks."""
    message = (
        "a bag has no check sums, and one time for each message: a changed byte within a "
        "message is not detected, and publish_time is log_time"
    )
    if not assumed:
        return Diagnostic(Code.BAG_FORMAT, message, place, severity=Severity.NOTE)
    names = ", ".join(sorted({short_type(name) for name in assumed})[:8])
    more = ", ..." if len(set(assumed)) > 8 else ""
    return Diagnostic(
        Code.BAG_FORMAT,
        f"{message}; it defines no types: the definitions of ROS 2, the same in all releases, "
        f"are used for {names}{more}",
        place,
        "if these are packages of your own with the same names, record MCAP instead",
        Severity.WARNING,
    )


def without_crc(place: Span) -> Diagnostic:
    """The limits of an MCAP file without CRCs of its messages."""
    return Diagnostic(
        Code.BAG_FORMAT,
        "no CRC covers its messages: a changed byte within a message is not detected",
        place,
        "record with `noChunkCRC: false` in rosbag2's `--storage-config-file`",
        Severity.NOTE,
    )


def bad_metadata(place: Span) -> Diagnostic:
    """The `metadata.yaml` of a run is invalid."""
    return Diagnostic(
        Code.SPLIT_LOG,
        "it does not list the files of the run",
        place,
        "write it again: `ros2 bag reindex FOLDER`",
    )


def part_of_a_run(i: int, count: int, run: str, place: Span) -> Diagnostic:
    """One file of several is read as a run of its own; `run` is the name of the whole run."""
    return Diagnostic(
        Code.SPLIT_LOG,
        f"it is file {i + 1} of {count} of one run, but judged alone",
        place,
        f"name {run}: its files are one log",
        Severity.NOTE,
    )


def compressed_folder(mode: str, place: Span) -> Diagnostic:
    """The files or messages of a run are compressed by rosbag2."""
    return Diagnostic(
        Code.NOT_A_LOG,
        f"rosbag2 has compressed each {mode} of the run",
        place,
        "unpack it: `ros2 bag convert`, with `compression_mode: none`; MCAP has a compression of "
        "its own: `--storage-preset-profile zstd_fast`",
    )


def no_such_file(place: Span) -> Diagnostic:
    """There is nothing at the path."""
    return Diagnostic(Code.NO_SUCH_FILE, "there is no such file", place, "check the path")


def is_a_directory(place: Span) -> Diagnostic:
    """The path names a directory."""
    return Diagnostic(Code.IS_A_DIRECTORY, "it is a directory", place, "name the logs in it")


def grown(size: int, place: Span) -> Diagnostic:
    """F431: the log grew while it was read; only its first bytes are used."""
    return Diagnostic(
        Code.GROWN,
        f"the log grew while it was read: the audit covers the first {size:,} bytes",
        place,
        "audit it again when its recording, or its copy, is complete",
        severity=Severity.WARNING,
    )


def not_a_file(place: Span) -> Diagnostic:
    """The path names a device, a pipe or the like."""
    return Diagnostic(
        Code.UNREADABLE, "it is not a regular file", place, "name a file; `-` is standard input"
    )


def unreadable(error: OSError, place: Span) -> Diagnostic:
    """The system or the server refuses to read the file."""
    reason = error.strerror or str(error)
    fix = "check its permissions"
    if "://" in place.source.name:
        fix = "check the address, the network, and whether your credentials reach it"
    elif error.errno == errno.ENOSPC:
        fix = "free space in the folder for temporary files, or set `TMPDIR` to another folder"
    return Diagnostic(Code.UNREADABLE, f"it cannot be read: {reason}", place, fix)
