"""The text output of a watch: a row for each requirement, or a line for each event."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import assert_never

from fretc.audit.evidence.verdicts import VERDICTS
from fretc.terminal.output import Piece
from fretc.terminal.screen import Screen, fitted, padded, titled, width
from fretc.watch.events import DiagnosticEvent, LateMessages, RunEnded, StateChange, WatchEvent
from fretc.watch.session import Session
from fretc.watch.sources.source import ConnectionLost, Missed, Opened, Reconnected
from fretish.bindings.amounts import duration, seconds
from monitors.kernel.verdicts import Truth
from monitors.stop_supervisor import State

_S = 10**9
_OBLIGATION: Mapping[Truth, str] = {
    True: "obligation pending",
    None: "obligation may be pending",
    False: "",
}
_NAME = 40
"""The widest name of a requirement, in columns."""


def rows(session: Session, titles: Mapping[str, str], screen: Screen) -> Iterator[list[Piece]]:
    """The rows of the screen: requirements, then topics."""
    states = session.states()
    ids = [state.requirement for state in states]
    most = min(_NAME, screen.width // 2)
    names = {id: titled(id, titles.get(id, ""), most) for id in ids}
    room = max(map(width, names.values()), default=0)
    for state in states:
        sign = VERDICTS[state.verdict].sign
        text = f"{sign.glyph} {padded(names[state.requirement], room)}  {state.verdict:<12}"
        text = f"{text}  {_demand(state, session.now)}".rstrip()
        yield [(fitted(text, screen.width), sign.colour)]
    yield [("", None)]
    for name, topic in session.topics.items():
        rate = "nothing yet" if not topic.count else _rate(topic.rate)
        late = session.late.get(name, 0)
        text = f"  {name}  {rate}{f', {late} late' if late else ''}"
        yield [(fitted(text, screen.width), None if topic.count else "yellow")]
    yield [(fitted(_ticks(session), screen.width), None)]


def _ticks(session: Session) -> str:
    if session.waiting:
        return f"  waits for {', '.join(session.waiting)} before the first tick"
    late = f", {session.late_ticks} became unknown" if session.late_ticks else ""
    behind = session.disordered
    why = f"; {behind} messages out of order: judged again at the end" if behind else ""
    return f"  {session.ticks} ticks{late}{why}"


def _rate(rate: float | None) -> str:
    return "once" if rate is None else f"{rate:.3g} Hz"


def _demand(state: State, now: int) -> str:
    parts = []
    if state.violated_ns is not None:
        parts.append(f"first {_ago(state.violated_ns, now)}")
    pending = _OBLIGATION[state.obligation_pending]
    if pending and state.open_ns is not None:
        pending = f"{pending} since {duration(max(0, now - state.open_ns) / _S)}"
    if pending and state.deadline_ns is not None:
        left = state.deadline_ns - now
        pending += f", {duration(left / _S)} left" if left >= 0 else ", too late"
    parts += [pending] if pending else []
    if state.triggered_ns is not None:
        parts.append(f"triggered {_ago(state.triggered_ns, now)}")
    return "; ".join(parts)


def _ago(time: int, now: int) -> str:
    return f"{duration(max(0, now - time) / _S)} ago"


def line(event: WatchEvent, start: int | None) -> str | None:
    """The line of an event; None: a diagnostic says the same.

    Args:
        event: the event.
        start: the time of the first tick, from which seconds count; None: there is none yet.
    """
    match event:
        case StateChange(state, before, time):
            return _changed(state, before, time, start)
        case LateMessages(ticks, messages):
            of = ", ".join(f"{count} of {topic}" for topic, count in messages.items() if count)
            return f"late messages ({of}): {ticks} judged ticks became unknown"
        case Opened(name):
            return f"watches {name}"
        case ConnectionLost(_, problem):
            return f"interrupted: {problem.message}"
        case Reconnected(since, until):
            return f"connected again: messages of {duration((until - since) / _S)} are lost"
        case Missed(since, until, count):
            what = "1 message" if count == 1 else f"{count} messages"
            within = f" within {duration((until - since) / _S)}" if until > since else ""
            return f"missed {what}{within}: unknown"
        case RunEnded(number, verdicts, recording, ticks):
            where = f", recorded in {recording}" if recording else ""
            of = ", ".join(f"{id} {verdict}" for id, verdict in verdicts.items())
            return f"run {number} ended after {ticks} ticks{where}: {of}"
        case DiagnosticEvent():
            return None
        case _:
            assert_never(event)


def _changed(state: State, before: State | None, time: int, start: int | None) -> str | None:
    """The line of a changed verdict, or of an obligation that opens or ends, else None."""
    previous = None if before is None else (before.verdict, before.obligation_pending)
    if previous == (state.verdict, state.obligation_pending):
        return None
    at = seconds((time - start) / _S) if start is not None else "-"
    obligation = _OBLIGATION[state.obligation_pending]
    pending = f", {obligation}" if obligation else ""
    return (
        f"{at}  {VERDICTS[state.verdict].sign.glyph} {state.requirement} {state.verdict}{pending}"
    )
