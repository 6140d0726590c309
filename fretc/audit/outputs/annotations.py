"""The results of an audit as an annotation log, which Foxglove plays beside the audited log.

`/fretc/<id>` tells the state of a requirement whenever it changes, `/fretc/verdicts` says it in
words, with each violation, and the verdict at the end; nothing else is a message. Times are
nanoseconds of the clock by which the run was judged.

Source: https://docs.foxglove.dev, schema foxglove.Log; MCAP format registry, encoding `json`.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from io import BytesIO
from itertools import chain, count, takewhile
from pathlib import Path
from typing import Any

from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import Writer

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from fretc.audit.evidence.schema import Result
from fretc.audit.evidence.verdict_inputs import BINDINGS, CLOCK, MONITOR, PARAMS, SENTENCE, TOPICS
from fretc.audit.log_paths import ANNOTATIONS
from fretc.audit.measurements.intervals import end_ns
from fretc.audit.measurements.states import OPEN, UNKNOWN
from fretc.audit.outputs.violated_values import values
from fretc.logs.storage.log_names import LOGS, TABLES
from fretish.bindings.amounts import duration, seconds
from fretish.classes.frozen import dataclass
from monitors import kernel

VERDICTS = "/fretc/verdicts"
_INFO, _WARNING, _ERROR = 2, 3, 4
_LEVELS: Mapping[str, int] = {kernel.SATISFIED: _INFO, kernel.VIOLATED: _ERROR}
"""Levels of verdicts; any other verdict is a warning."""
_SECOND = 10**9

_TEXT = {"type": "string"}
_WHOLE = {"type": "integer", "minimum": 0}
_TIME = {
    "type": "object",
    "title": "time",
    "properties": {"sec": _WHOLE, "nsec": {**_WHOLE, "maximum": _SECOND - 1}},
}


def _schema(title: str, **fields: Mapping[str, Any]) -> str:
    properties = {"timestamp": _TIME, **fields}
    return json.dumps(
        {"title": title, "type": "object", "properties": properties, "required": [*properties]}
    )


_LOG = _schema("foxglove.Log", level=_WHOLE, message=_TEXT, name=_TEXT, file=_TEXT, line=_WHOLE)
_STATE = _schema("fretc.State", requirement=_TEXT, state=_TEXT)


@dataclass(frozen=True, slots=True)
class _Event:
    """A state change or text at one time, for one requirement."""

    ns: int
    topic: str
    content: Mapping[str, Any]


def sidecars(
    results: Sequence[Result], requirements: Sequence[FormalizedRequirement], folder: Path
) -> dict[Path, bytes]:
    """An annotation file for each run that could be read; equal results give equal bytes.

    Args:
        results: one for each run and requirement, in declared units.
        requirements: all requirements of the results.
        folder: the folder of the files.
    """
    runs: dict[str, list[Result]] = {}
    for result in results:
        if result.start_ns is not None:
            runs.setdefault(result.run, []).append(result)
    names = _names(list(runs))
    return {folder / names[run]: sidecar(of_run, requirements) for run, of_run in runs.items()}


def sidecar(results: Sequence[Result], requirements: Sequence[FormalizedRequirement]) -> bytes:
    """The annotation log of one run, in order of time.

    Args:
        results: the results of the run, one for each requirement, in declared units.
        requirements: all requirements of the results.
    """
    by_id = {requirement.id: requirement for requirement in requirements}
    data = BytesIO()
    writer = Writer(data)
    writer.start(library=f"fretc {__version__}")
    log = writer.register_schema("foxglove.Log", SchemaEncoding.JSONSchema, _LOG.encode())
    state = writer.register_schema("fretc.State", SchemaEncoding.JSONSchema, _STATE.encode())
    channels = {VERDICTS: writer.register_channel(VERDICTS, MessageEncoding.JSON, log)}
    for result in results:
        topic, requirement = state_topic(result.requirement), by_id[result.requirement]
        about = {"sentence": wording(requirement.entry)}
        channels[topic] = writer.register_channel(topic, MessageEncoding.JSON, state, about)
    events = [event for result in results for event in _events(result, by_id)]
    counts: Counter[str] = Counter()
    for event in sorted(events, key=lambda event: event.ns):
        content = json.dumps({"timestamp": _time(event.ns), **event.content}).encode()
        writer.add_message(channels[event.topic], event.ns, content, event.ns, counts[event.topic])
        counts[event.topic] += 1
    writer.add_metadata("fretc", _metadata(results))
    writer.finish()  # type: ignore[no-untyped-call]
    return data.getvalue()


def state_topic(id: str) -> str:
    """The topic with the states of a requirement."""
    topic = f"/fretc/{id}"
    return f"{topic}/state" if topic == VERDICTS else topic


def _events(result: Result, requirements: Mapping[str, FormalizedRequirement]) -> Iterator[_Event]:
    """The events of one requirement; at equal times, causes come before effects."""
    id = result.requirement
    span = requirements[id].entry.wording

    def event(ns: int, level: int, message: str) -> _Event:
        where = {"name": id, "file": span.source.name, "line": span.line}
        return _Event(max(0, ns), VERDICTS, {"level": level, "message": message, **where})

    answers = _longest_waits(result)
    before = ""
    for state in result.states:
        content = {"requirement": id, "state": state.state}
        yield _Event(max(0, state.ns), state_topic(id), content)
        if state.state == OPEN:
            yield event(state.ns, _INFO, f"{id}: triggered, waiting for the response")
        elif state.state == UNKNOWN:
            yield event(state.ns, _WARNING, f"{id}: unknown from here on")
        elif before == OPEN and state.tick in answers:
            waited = duration(answers[state.tick] / _SECOND)
            yield event(state.ns, _INFO, f"{id}: response after {waited}")
        elif before == UNKNOWN:
            yield event(state.ns, _INFO, f"{id}: known again")
        before = state.state
    for violation in result.violations:
        cause = violation.trigger
        at_first = f": {values(result, violation)}" if violation.values else ""
        since = f", triggered at {seconds(cause.seconds)}" if cause else ""
        yield event(violation.start_ns, _ERROR, f"{id}: violated from here on{since}{at_first}")
        end = end_ns(violation.last, result.clock)
        if end is None:
            yield event(violation.end_ns, _ERROR, f"{id}: violated up to this message")
        else:
            yield event(end, _ERROR, f"{id}: violated up to here")
    verdict = f"{id}: {result.verdict}: {result.reason}"
    assert result.end_ns is not None, "there is a sidecar of what could be read only"
    yield event(result.end_ns, _LEVELS.get(result.verdict, _WARNING), verdict)


def _longest_waits(result: Result) -> dict[int, int]:
    """The tick of each answer, with the nanoseconds that its oldest trigger waited."""
    triggers = {moment.tick: moment.ns for moment in result.triggers}
    waits: dict[int, int] = {}
    for answer in result.answers:
        if answer.trigger in triggers:
            waited = answer.ns - triggers[answer.trigger]
            waits[answer.tick] = max(waited, waits.get(answer.tick, 0))
    return waits


def _metadata(results: Sequence[Result]) -> dict[str, str]:
    """The hashes of the inputs of the verdicts, and the verdicts."""
    first = results[0]
    entries = {"fretc": __version__, "run": first.run, "clock": first.clock}
    names = ("log", "log_summary", CLOCK, TOPICS)
    entries |= {f"sha256.{n}": first.hashes[n] for n in names if n in first.hashes}
    for result in results:
        id, hashes = result.requirement, result.hashes
        entries |= {f"{id}.verdict": result.verdict, f"{id}.reason": result.reason}
        parts = [name for name in (SENTENCE, PARAMS, BINDINGS, MONITOR) if name in hashes]
        entries |= {f"{id}.sha256.{name}": hashes[name] for name in parts}
    return entries


def _names(runs: Sequence[str]) -> dict[str, Path]:
    """A file name for each run; runs with equal names keep the folders in which they differ."""
    runs_of: dict[str, list[str]] = {}
    for run in runs:
        runs_of.setdefault(_safe(_stem(run)), []).append(run)
    names: dict[str, Path] = {}
    used: set[Path] = set()
    for stem, same in runs_of.items():
        folders = [Path(run).parent.parts for run in same]
        shared = min(_shared(folders[0], parts) for parts in folders)
        for run, parts in zip(same, folders, strict=True):
            folder = Path(*map(_safe, parts[shared:]))
            numbered = (f"{stem}-{number}" for number in count(2))
            free = (folder / f"{name}{ANNOTATIONS}" for name in chain([stem], numbered))
            names[run] = next(name for name in free if name not in used)
            used.add(names[run])
    return names


def _shared(one: Sequence[str], other: Sequence[str]) -> int:
    """The number of leading folders that the paths have in common."""
    pairs = takewhile(lambda pair: pair[0] == pair[1], zip(one, other, strict=False))
    return sum(1 for _ in pairs)


def _stem(run: str) -> str:
    name = Path(run).name
    return next((name[: -len(end)] for end in (*LOGS, *TABLES) if name.endswith(end)), name)


def _safe(text: str) -> str:
    """A name for a file or a folder that never leads elsewhere."""
    return re.sub(r"[^\w.-]|^\.+", "_", text)


def _time(ns: int) -> dict[str, int]:
    seconds, nanoseconds = divmod(ns, _SECOND)
    return {"sec": seconds, "nsec": nanoseconds}
