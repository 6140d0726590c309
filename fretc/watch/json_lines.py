"""The output of `--format jsonl`: a line with a JSON object for each event."""

from __future__ import annotations

from typing import Annotated, Any, assert_never

from compiler.files.records import (
    Count,
    Name,
    Ordinal,
    Record,
    Whole,
    about,
    json_schema,
    plain,
)
from fretc.watch.events import DiagnosticEvent, LateMessages, RunEnded, StateChange, WatchEvent
from fretc.watch.sources.source import ConnectionLost, Missed, Opened, Reconnected

_Time = Annotated[Whole | None, about("nanoseconds on the declared clock; null: there is none")]


class RequirementLine(Record, frozen=True, tag="requirement", tag_field="type"):
    """A requirement whose state has changed."""

    requirement: Name
    verdict: Annotated[str, about("the verdict of an audit if the run ended now")]
    obligation_pending: Annotated[
        bool | None,
        about(
            "whether an obligation is open (null: unknown); a robot with a stop supervisor "
            "stops unless it is false"
        ),
    ]
    triggered_ns: Annotated[_Time, about("the last tick with a trigger")]
    open_ns: Annotated[_Time, about("the trigger of the open obligation")]
    deadline_ns: Annotated[_Time, about("the last tick at which the open obligation can be met")]
    violated_ns: Annotated[_Time, about("the first tick at which it was violated")]
    time_ns: Annotated[Whole, about("the latest time of all messages, on the declared clock")]


class LateLine(Record, frozen=True, tag="late", tag_field="type"):
    """Judged ticks have become unknown."""

    ticks: Annotated[Count, about("the total in this run so far")]
    messages: Annotated[dict[Name, Count], about("the total of each topic in this run so far")]


class MessageLine(Record, frozen=True, tag="message", tag_field="type"):
    """A diagnostic for the user."""

    code: Name
    severity: Annotated[str, about("error, warning or note")]
    message: str
    help: str | None


class OpenedLine(Record, frozen=True, tag="opened", tag_field="type"):
    """The source is connected."""

    source: str


class InterruptedLine(Record, frozen=True, tag="interrupted", tag_field="type"):
    """The connection to the source is lost; fretc tries to connect again."""

    since_ns: Annotated[Whole, about("receive time")]
    code: Name
    message: str


class MissedLine(Record, frozen=True, tag="missed", tag_field="type"):
    """Messages received between these times are lost."""

    since_ns: Annotated[Whole, about("receive time")]
    until_ns: Annotated[Whole, about("receive time")]
    reconnected: Annotated[bool, about("true: the source is connected again")]
    count: Annotated[Count | None, about("the number of missed messages; null: unknown")]


class RunLine(Record, frozen=True, tag="run", tag_field="type"):
    """A run has ended."""

    number: Ordinal
    ticks: Count
    verdicts: dict[Name, str]
    recording: str | None


Line = (
    RequirementLine | LateLine | MessageLine | OpenedLine | InterruptedLine | MissedLine | RunLine
)


SCHEMA = "fretc-watch-1"


class _Lines(Record, frozen=True):
    """All kinds of lines."""

    lines: list[Line]


def schema() -> dict[str, Any]:
    """The JSON Schema of a line."""
    line_schema = json_schema(
        _Lines,
        SCHEMA,
        "A line of `fretc watch --format jsonl`",
        "Times are nanoseconds. `type` is the kind of a line.",
    )
    line_ = line_schema["properties"]["lines"]["items"]
    head = {key: value for key, value in line_schema.items() if key.startswith("$") or key in _HEAD}
    return {**head, **line_}


_HEAD = ("title", "description")


def line(event: WatchEvent) -> dict[str, Any]:
    """The JSON object of one event."""
    fields: dict[str, Any] = plain(_line(event))
    return fields


def _line(event: WatchEvent) -> Line:
    match event:
        case StateChange(state, _, time):
            return RequirementLine(**state._asdict(), time_ns=time)
        case LateMessages(ticks, messages):
            return LateLine(ticks, dict(messages))
        case DiagnosticEvent(diagnostic):
            return MessageLine(
                diagnostic.code.number,
                str(diagnostic.severity),
                diagnostic.message,
                diagnostic.help,
            )
        case Opened(name):
            return OpenedLine(name)
        case ConnectionLost(since, problem):
            return InterruptedLine(since, problem.code.number, problem.message)
        case Reconnected(since, until):
            return MissedLine(since, until, reconnected=True, count=None)
        case Missed(since, until, count):
            return MissedLine(since, until, reconnected=False, count=count)
        case RunEnded(number, verdicts, recording, ticks):
            return RunLine(number, ticks, dict(verdicts), recording)
        case _:
            assert_never(event)
