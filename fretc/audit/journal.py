"""The finished logs of an audit, in a file beside its evidence until that is written.

JSON lines: a head that names the plan, then one line for each log. A line is appended whole, so
that whatever stops the audit, all lines but the last are good, and a last one without its end does
not count. Verdicts are taken from it, so each line has a check that only the user's key can make
(`userkey`), for this place and this plan: a journal that came with somebody's files is not
believed.
"""

from __future__ import annotations

import fcntl
import hmac
import json
import os
import stat
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple
from pathlib import Path
from typing import Any

from compiler.files.checked_json import MisshapenError
from compiler.files.records import decoded, plain
from compiler.files.text_files import Stamp, destination, file_sha256, stamp
from fretc.audit.evidence.schema import Result
from fretc.audit.many_logs import LogAudit
from fretc.audit.plan import Plan
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source, Span

SCHEMA = "fretc-journal-2"
_CODES = {code.number: code for code in Code}


class Journal:
    """The journal of one audit. It becomes a file with the first log that is kept."""

    def __init__(self, evidence: Path, plan: Plan, key: bytes) -> None:
        """Nothing is read or written yet.

        Args:
            evidence: where the evidence will be.
            plan: lines of another plan are not used, and are lost when a log is kept.
            key: of the user; what was kept with another one is not used.
        """
        self.path = evidence.with_name(f"{evidence.name}.journal")
        self._plan = plan
        self._key = key
        head = {"plan": plan.key, "place": os.path.realpath(self.path)}
        self._head = _line({"schema": SCHEMA, **head}, key)
        self._of_lines = hmac.digest(key, self._head, "sha256")
        """The key of the lines below this head."""
        self._file: int | None = None
        self._good = 0
        """Bytes at the beginning of the file that are kept."""
        self.stale = False
        """Whether the journal on disk is of another plan."""
        self.foreign = False
        """Whether lines on disk were not written by this user, for this place."""

    def finished(self, logs: Sequence[str]) -> dict[str, LogAudit] | Diagnostic:
        """Those of the logs that need not be audited again, with their audits.

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
        names = set(logs)
        entries = {entry["log"]: entry for entry in map(json.loads, lines)}
        audits = {
            log: self._audited(entry)
            for log, entry in entries.items()
            if log in names and _unchanged(entry)
        }
        return {log: audit for log, audit in audits.items() if audit is not None}

    def keep(self, log: str, audited: LogAudit) -> bool | Diagnostic:
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
            self._write(_line(_entry(log, audited, self._plan), self._of_lines))
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
        destination(self.path)
        self._file = os.open(self.path, _OPENED, 0o600)
        try:
            about = os.fstat(self._file)
            if not stat.S_ISREG(about.st_mode) or about.st_nlink > 1:
                raise OSError(None, "it is a link, or no regular file")
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
            self.stale = head != self._head and self._is_ours(head)
            self.foreign = bool(head) and head != self._head and not self.stale
            if head == self._head:
                self._good = file.tell()
                while (line := file.readline()) and _whole(line, self._of_lines):
                    self._good = file.tell()
                    yield line
                self.foreign = line.endswith(b"\n")
        if self._good:
            os.ftruncate(self._file, self._good)

    def _is_ours(self, head: bytes) -> bool:
        """Whether it is the head of another plan, kept by this user in this place."""
        place = os.path.realpath(self.path)
        return _whole(head, self._key) and json.loads(head).get("place") == place

    def _begin(self) -> None:
        assert self._file is not None
        os.ftruncate(self._file, 0)
        self._write(self._head)

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
                help="wait for it, or name another file with `-o`",
            )
        return Diagnostic(
            Code.NOT_WRITTEN,
            f"`{self.path}` cannot be written: {error.strerror or error}",
            help="name another place with `-o`, or mend this one",
        )

    def _audited(self, entry: Mapping[str, Any]) -> LogAudit | None:
        """None where a number is too large to be read back: a damaged log can have such times."""
        bindings = self._plan.declarations.source
        try:
            results = decoded(entry["results"], tuple[Result, ...])
        except MisshapenError:
            return None
        return LogAudit(
            results,
            tuple(_diagnostic(finding, bindings) for finding in entry["diagnostics"]),
            read=True,
            stamp=Stamp(*entry["stamp"]),
        )


_OPENED = os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK
"""No link is followed: the folder may be somebody else's, and what is not believed is cut off."""


def _whole(line: bytes, key: bytes) -> bool:
    """Whether the line has its end, and is what was written: verdicts are taken from it."""
    try:
        value = json.loads(line)
    except (ValueError, RecursionError):
        return False
    if not isinstance(value, dict):
        return False
    try:
        return hmac.compare_digest(line, _line(value, key))
    except ValueError:  # a number that JSON has not
        return False


def _unchanged(entry: Mapping[str, Any]) -> bool:
    before, now = Stamp(*entry["stamp"]), stamp(entry["log"])
    if now is None or now.size != before.size:
        return False
    return (before.settled and now == before) or file_sha256(entry["log"]) == entry["sha256"]


def _line(value: Mapping[str, Any], key: bytes) -> bytes:
    """With the HMAC-SHA256 of itself, but for that, at its end."""
    unchecked = json.dumps({**value, "check": ""}, allow_nan=False)
    check = hmac.digest(key, unchecked.encode(), "sha256").hex()
    return f"{json.dumps({**value, 'check': check}, allow_nan=False)}\n".encode()


def _entry(log: str, audited: LogAudit, plan: Plan) -> dict[str, Any]:
    assert audited.stamp is not None
    bindings = plan.declarations.source
    return {
        "log": log,
        "sha256": audited.results[0].hashes.get("log", ""),
        "stamp": astuple(audited.stamp),
        "results": plain(audited.results),
        "diagnostics": [_plain(diagnostic, bindings) for diagnostic in audited.diagnostics],
    }


def _plain(diagnostic: Diagnostic, bindings: Source) -> dict[str, Any]:
    """As plain values; the text of the bindings is not repeated."""
    span = diagnostic.span
    return {
        "code": diagnostic.code.number,
        "message": diagnostic.message,
        "help": diagnostic.help,
        "severity": str(diagnostic.severity),
        "subject": diagnostic.subject,
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
        subject=plain["subject"],
    )


def _place(at: Mapping[str, Any], bindings: Source) -> Span:
    source = bindings if at["text"] is None else Source(at["name"], at["text"])
    return source.span(at["start"], at["end"])
