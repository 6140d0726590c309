"""The samples of logs, kept beside the evidence: the requirements may change without them.

A file for each log holds its `Recording`. It stands for the log as long as that is unchanged and
the signals are declared as they were. Verdicts are taken from it, so it has a check that only the
user's key can make (`compiler.files.user_key`), for its own place: a file that came with somebody's
evidence is not believed, and nothing of it is parsed.
"""

from __future__ import annotations

import hmac
import json
import os
import stat
from collections.abc import Mapping, Sequence
from dataclasses import astuple, replace
from fractions import Fraction
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from compiler.files.build_id import build_id
from compiler.files.text_files import Stamp, file_sha256, sha256, stamp, write
from fretc.logs.signals.integrity import Checked, Integrity
from fretc.logs.signals.samples import (
    AgentTrace,
    Late,
    MentalState,
    Recording,
    Samples,
    Topic,
)
from fretc.logs.storage.folders import is_folder
from fretc.logs.storage.log_names import name_of
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source, Span
from fretish.system.files import NO_LINK, NO_WAIT, TO_READ

SCHEMA = "fretc-columns-3"
SUFFIX = ".columns"
"""The suffix of the folder beside the evidence."""
_MOST = 2**28
"""The most bytes of a file; larger recordings are read from their logs."""
_CHECK = 32
"""The bytes of the authentication code, with which a file begins."""
_LENGTH = 8
"""The bytes after it with the length of the description."""
_CODES = {code.number: code for code in Code}
Array = NDArray[Any]
KnownBy = Literal["read", "stamp", "sha256"]


@dataclass(frozen=True, slots=True)
class SampleCache:
    """The cache folder in which an audit keeps the samples of its logs."""

    folder: Path
    key: bytes
    """The key of the user."""
    rehash: bool = False
    """Identify logs by their SHA-256 alone, not by size and times."""

    def recording(
        self, log: str, declarations: Declarations, wanted: Sequence[str], integrity: Integrity
    ) -> tuple[Recording, KnownBy] | None:
        """The cached recording, and how the log was identified; None: read the log.

        Args:
            log: the path of the log. An unchanged stamp is enough: the log is not opened.
            declarations: clock and signals.
            wanted: the names of declared signals, in the order in which they would be read.
            integrity: how thoroughly the log would be checked.
        """
        try:
            content = self._content(self._path(log))
        except OSError:
            return None
        if content is None:
            return None
        about, arrays = content
        of_now = _reading(declarations, wanted, integrity)
        if about["reading"] != of_now or about["edition"] != build_id():
            return None
        by = _unchanged(log, about, rehash=self.rehash)
        return by and (_recording(about, arrays, declarations), by)

    def keep(
        self,
        log: str,
        before: Stamp | None,
        recording: Recording,
        declarations: Declarations,
        wanted: Sequence[str],
        integrity: Integrity,
    ) -> None:
        """Keep the recording of a log, if the log can be identified later.

        Only MCAP files that stand alone are kept: other logs depend on more than their bytes.
        """
        if before is None or not _stands_alone(log) or recording.samples.keys() != {*wanted}:
            return
        findings = [_plain(finding, declarations) for finding in recording.findings]
        if None in findings:
            return
        about = {
            "schema": SCHEMA,
            "edition": build_id(),
            "reading": _reading(declarations, wanted, integrity),
            "log": os.path.realpath(log),
            "stamp": astuple(before),
            "findings": findings,
        }
        described, arrays = _described(recording)
        data = _packed({**about, **described}, arrays)
        again = _recording(*_unpacked(data), declarations)
        if len(data) <= _MOST and again.findings == recording.findings:
            path = self._path(log)
            write({path: _checked(path, data, self.key) + data})

    def _path(self, log: str) -> Path:
        return self.folder / sha256(f"{name_of(log)}\0{name_of(os.path.realpath(log))}")[:32]

    def _content(self, path: Path) -> tuple[dict[str, Any], list[Array]] | None:
        """The content of a file; None: this user's fretc did not write it at this path."""
        with open(os.open(path, TO_READ | NO_LINK | NO_WAIT), "rb") as stream:
            about = os.fstat(stream.fileno())
            if not stat.S_ISREG(about.st_mode) or about.st_size > _MOST + _CHECK:
                return None
            check, data = stream.read(_CHECK), stream.read(_MOST)
        right = hmac.compare_digest(check, _checked(path, data, self.key))
        return _unpacked(data) if right else None


def _checked(path: Path, data: bytes, key: bytes) -> bytes:
    real_path = os.path.realpath(path).encode("utf-8", "surrogateescape")
    return hmac.digest(key, SCHEMA.encode() + b"\0" + real_path + b"\0" + data, "sha256")


def _reading(declarations: Declarations, wanted: Sequence[str], integrity: Integrity) -> str:
    """SHA-256 of all inputs of a recording except its log and positions in the bindings."""
    signals = declarations.signals
    labels = {name: [repr(each) for each in some] for name, some in declarations.labels.items()}
    read = [repr(signals[name]) for name in wanted]
    beside = [repr(declarations.map), declarations.agent_trace]
    bound = sorted(map(repr, signals.values()))
    return sha256(json.dumps([repr(declarations.clock), read, bound, beside, labels, integrity]))


def _unchanged(log: str, about: Mapping[str, Any], *, rehash: bool) -> KnownBy | None:
    """How the log was identified as unchanged; None: it was not."""
    before, now = Stamp(*about["stamp"]), stamp(log)
    if now is None or now.size != before.size or os.path.realpath(log) != about["log"]:
        return None
    if before.settled and now == before and not rehash:
        return "stamp"
    same = about["checked"]["hashed"] and file_sha256(log) == about["sha256"]
    return "sha256" if same else None


def _stands_alone(log: str) -> bool:
    """Whether no file beside the log describes its run."""
    return log.endswith(".mcap") and not is_folder(os.path.dirname(log) or ".")


# A file ------------------------------------------------------------------------------------------


def _packed(about: Mapping[str, Any], arrays: Sequence[Array]) -> bytes:
    """The length of a description, the description, and the arrays one after the other."""
    kinds = [[array.dtype.str, len(array)] for array in arrays]
    head = json.dumps({**about, "arrays": kinds}).encode()
    return b"".join(
        (len(head).to_bytes(_LENGTH, "little"), head, *(array.tobytes() for array in arrays))
    )


def _unpacked(data: bytes) -> tuple[dict[str, Any], list[Array]]:
    at = _LENGTH + int.from_bytes(data[:_LENGTH], "little")
    about = json.loads(data[_LENGTH:at])
    arrays = []
    for kind, count in about["arrays"]:
        arrays.append(np.frombuffer(data, kind, count, at))
        at += arrays[-1].nbytes
    return about, arrays


def _described(recording: Recording) -> tuple[dict[str, Any], list[Array]]:
    """A recording without its diagnostics as values and arrays; equal times are kept once."""
    arrays: list[Array] = [recording.ticks]
    places: dict[bytes, int] = {}

    def kept(samples: Mapping[str, Samples]) -> dict[str, Any]:
        description = {}
        for name, each in samples.items():
            times = each.times.tobytes()
            if times not in places:
                places[times] = len(arrays)
                arrays.append(each.times)
            description[name] = [places[times], len(arrays), str(each.scale), each.words]
            arrays.append(each.values)
        return description

    late = {}
    for topic, each in recording.late.items():
        late[topic] = len(arrays)
        arrays += [each.firsts, each.lasts]
    agents = {}
    for name, trace in recording.agents.items():
        agents[name] = [len(arrays), [astuple(each) for each in trace.states], trace.actions]
        arrays.append(trace.times)
    return {
        "name": recording.name,
        "sha256": recording.sha256,
        "size": recording.size,
        "span": [recording.start_ns, recording.end_ns],
        "samples": kept(recording.samples),
        "beside": kept(recording.beside),
        "gaps": recording.gaps,
        "topics": {name: astuple(topic) for name, topic in recording.topics.items()},
        "nearest": dict(recording.nearest),
        "intact": recording.intact,
        "checked": {name: getattr(recording.checked, name) for name in Checked.__slots__},
        "described": dict(recording.described),
        "origin": recording.origin,
        "late": late,
        "agents": agents,
    }, arrays


def _recording(
    about: Mapping[str, Any], arrays: Sequence[Array], declarations: Declarations
) -> Recording:
    samples, beside = (
        {
            name: Samples(arrays[times], arrays[values], Fraction(scale), tuple(words))
            for name, (times, values, scale, words) in about[key].items()
        }
        for key in ("samples", "beside")
    )
    return Recording(
        name=about["name"],
        sha256=about["sha256"],
        size=about["size"],
        start_ns=about["span"][0],
        end_ns=about["span"][1],
        samples=samples,
        ticks=arrays[0],
        gaps=tuple((start, end) for start, end in about["gaps"]),
        topics={name: Topic(*topic) for name, topic in about["topics"].items()},
        nearest=about["nearest"],
        findings=tuple(_finding(each, declarations) for each in about["findings"]),
        intact=about["intact"],
        checked=Checked(**about["checked"]),
        described={name: tuple(values) for name, values in about["described"].items()},
        beside=beside,
        origin=about["origin"],
        late={topic: Late(arrays[at], arrays[at + 1]) for topic, at in about["late"].items()},
        agents={
            name: _agent(arrays[at], states, actions)
            for name, (at, states, actions) in about["agents"].items()
        },
    )


def _agent(times: Array, states: Sequence[Any], actions: Sequence[Any]) -> AgentTrace:
    return AgentTrace(
        times,
        tuple(MentalState(ns, tuple(beliefs), tuple(goals)) for ns, beliefs, goals in states),
        tuple((ns, action) for ns, action in actions),
    )


# Diagnostics -------------------------------------------------------------------------------------


def _plain(finding: Diagnostic, declarations: Declarations) -> dict[str, Any] | None:
    """A diagnostic as plain values; the place of a signal's binding is looked up when it is read.

    None if the diagnostic is at another place in the bindings, because that place may move.
    """
    span, place = finding.span, None
    if span is not None and span.source == declarations.source:
        signals = declarations.signals.values()
        place = next((signal.name for signal in signals if signal.span == span), None)
        if place is None:
            return None
    if replace(finding, fix=None, accepted="") != finding:
        return None
    return {
        "code": finding.code.number,
        "message": finding.message,
        "help": finding.help,
        "severity": str(finding.severity),
        "paste": finding.paste,
        "subject": finding.subject,
        "signal": place,
        "span": span and [span.source.name, span.source.text, span.start, span.end]
        if place is None
        else None,
    }


def _finding(plain: Mapping[str, Any], declarations: Declarations) -> Diagnostic:
    span: Span | None = None
    if plain["signal"] is not None:
        span = declarations.signals[plain["signal"]].span
    elif plain["span"] is not None:
        name, text, start, end = plain["span"]
        span = Source(name, text).span(start, end)
    return Diagnostic(
        _CODES[plain["code"]],
        plain["message"],
        span,
        plain["help"],
        Severity(plain["severity"]),
        paste=plain["paste"],
        subject=plain["subject"],
    )
