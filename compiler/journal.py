"""What an audit has finished, kept beside its evidence until that is written.

JSON lines: a head that names the plan, then one line for each log. A line is appended whole, so
that whatever stops the audit, all lines but the last are good, and a last one without its end does
not count.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Any

from compiler.auditing import Audited
from compiler.files import Stamp, file_sha256, sha256, stamp
from compiler.plan import Plan
from fretish.diagnostic import Code, Diagnostic, Severity
from fretish.source import Source, Span

SCHEMA = "fretc-journal-1"
_CODES = {code.number: code for code in Code}


class Journal:
    """The journal of one audit. It becomes a file with the first log that is kept."""

    def __init__(self, evidence: Path, plan: Plan) -> None:
        """Nothing is read or written yet.

        Args:
            evidence: where the evidence will be.
            plan: lines of another plan are not used, and are lost when a log is kept.
        """
        self.path = evidence.with_name(f"{evidence.name}.journal")
        self._plan = plan
        self._file: int | None = None
        self._good = 0
        """Bytes at the beginning of the file that are kept."""
        self.stale = False
        """Whether what was found is of another plan."""

    def finished(self, logs: Sequence[str]) -> dict[str, Audited] | Diagnostic:
        """Those of the logs that need not be audited again, with what was shown of them.

        A log is the same when its stamp is the same, or else its SHA-256: what an audit shows
        depends on the bytes of the log, its name and the plan, and on nothing else.
        """
        try:
            if not self.path.exists():
                return {}
            self._open()
            lines = list(self._lines())
        except OSError as error:
            return self._wrong(error)
        wanted = set(logs)
        entries = {entry["log"]: entry for entry in map(json.loads, lines)}
        return {
            log: self._audited(entry)
            for log, entry in entries.items()
            if log in wanted and _unchanged(entry)
        }

    def keep(self, log: str, audited: Audited) -> bool | Diagnostic:
        """Add a log; one that could not be read, or has changed meanwhile, is to be tried again.

        Returns:
            Whether it is kept; or why nothing can be.
        """
        if not audited.read or audited.stamp is None:
            return False
        try:
            if self._file is None:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                self._open()
            if not self._good:
                self._begin()
            self._write(_entry(log, audited, self._plan))
        except OSError as error:
            return self._wrong(error)
        return True

    def remove(self) -> None:
        """The audit is complete."""
        if self._file is not None:
            self.path.unlink(missing_ok=True)
        self.close()

    def close(self) -> None:
        """Let another audit have it."""
        if self._file is not None:
            os.close(self._file)
            self._file = None

    def _open(self) -> None:
        self._file = os.open(self.path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o644)
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            self.close()
            raise

    def _lines(self) -> Iterator[bytes]:
        """The good lines below the head, where that is of this plan; what follows them is cut."""
        assert self._file is not None
        with open(self._file, "rb", closefd=False) as file:
            file.seek(0)
            head = file.readline()
            self.stale = bool(head) and head != self._head()
            if head == self._head():
                self._good = file.tell()
                while (line := file.readline()) and _whole(line):
                    self._good = file.tell()
                    yield line
        if self._good:
            os.ftruncate(self._file, self._good)

    def _head(self) -> bytes:
        return _line({"schema": SCHEMA, "plan": self._plan.key})

    def _begin(self) -> None:
        assert self._file is not None
        os.ftruncate(self._file, 0)
        self._write(self._head())

    def _write(self, line: bytes) -> None:
        assert self._file is not None
        rest = memoryview(line)
        while rest:
            rest = rest[os.write(self._file, rest) :]
        self._good += len(line)

    def _wrong(self, error: OSError) -> Diagnostic:
        if isinstance(error, BlockingIOError):
            return Diagnostic(
                Code.BUSY,
                f"another audit is at work on `{self.path}`",
                Source(str(self.path), "").span(),
                help="wait for it, or name another file with `--evidence`",
            )
        return Diagnostic(
            Code.NOT_WRITTEN,
            f"`{self.path}` cannot be written: {error.strerror or error}",
            help="name another place with `--evidence`, or mend this one",
        )

    def _audited(self, entry: Mapping[str, Any]) -> Audited:
        bindings = self._plan.declarations.source
        return Audited(
            tuple(entry["results"]),
            tuple(_diagnostic(found, bindings) for found in entry["diagnostics"]),
            read=True,
            stamp=Stamp(*entry["stamp"]),
        )


def _whole(line: bytes) -> bool:
    """Whether the line has its end, and is what was written: verdicts are taken from it."""
    try:
        value = json.loads(line)
    except ValueError:
        return False
    return isinstance(value, dict) and line == _line({**value, "check": ""})


def _unchanged(entry: Mapping[str, Any]) -> bool:
    before, now = Stamp(*entry["stamp"]), stamp(entry["log"])
    if now is None or now.size != before.size:
        return False
    return (before.settled and now == before) or file_sha256(entry["log"]) == entry["sha256"]


def _line(value: Mapping[str, Any]) -> bytes:
    """With the SHA-256 of itself, but for that, at its end."""
    unchecked = json.dumps({**value, "check": ""}, allow_nan=False)
    return f"{json.dumps({**value, 'check': sha256(unchecked)}, allow_nan=False)}\n".encode()


def _entry(log: str, audited: Audited, plan: Plan) -> bytes:
    assert audited.stamp is not None
    bindings = plan.declarations.source
    return _line(
        {
            "log": log,
            "sha256": audited.results[0]["hashes"].get("log", ""),
            "stamp": astuple(audited.stamp),
            "results": audited.results,
            "diagnostics": [_plain(diagnostic, bindings) for diagnostic in audited.diagnostics],
        }
    )


def _plain(diagnostic: Diagnostic, bindings: Source) -> dict[str, Any]:
    """As plain values; the text of the bindings is not repeated."""
    span = diagnostic.span
    return {
        "code": diagnostic.code.number,
        "message": diagnostic.message,
        "help": diagnostic.help,
        "severity": str(diagnostic.severity),
        "span": span
        and {
            "name": span.source.name,
            "text": None if span.source == bindings else span.source.text,
            "start": span.start,
            "end": span.end,
        },
    }


def _diagnostic(plain: Mapping[str, Any], bindings: Source) -> Diagnostic:
    """The diagnostic again."""
    return Diagnostic(
        _CODES[plain["code"]],
        plain["message"],
        _place(plain["span"], bindings) if plain["span"] else None,
        plain["help"],
        Severity(plain["severity"]),
    )


def _place(at: Mapping[str, Any], bindings: Source) -> Span:
    source = bindings if at["text"] is None else Source(at["name"], at["text"])
    return source.span(at["start"], at["end"])
