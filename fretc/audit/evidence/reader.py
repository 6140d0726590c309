"""The evidence file as checked values: what audits have found, or why that cannot be read.

Nothing in the file is trusted: a wrong shape anywhere is F503, never a report about half of it.
Its schema is `templates/json/evidence.schema.json`: what it does not know is refused, too.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from compiler.files.checked_json import MisshapenError, Shape, parsed
from compiler.files.json_schema import misfit
from compiler.files.text_files import read as read_text
from compiler.files.text_files import sha256
from fretc.audit.evidence.estimates import Estimated
from fretc.audit.evidence.probabilities import probability, trials
from fretc.audit.evidence.samples import Window, window
from fretc.audit.evidence.writer import SCHEMA
from fretc.audit.measurements.confidence_intervals import REFUTED
from fretc.audit.measurements.trials import Trials
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Source
from monitors import kernel

VERDICTS = (
    kernel.VIOLATED,
    kernel.NO_DATA,
    kernel.INCONCLUSIVE,
    kernel.VACUOUS,
    kernel.SATISFIED,
)
"""What an audit can say, the worst first."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A tick and its time in seconds from the first tick of the run."""

    tick: int
    seconds: float


@dataclass(frozen=True, slots=True)
class Violation:
    """Ticks `first..last`, both included, at which a demand was broken."""

    first: Moment
    last: Moment
    trigger: Moment | None
    deadline: Moment | None
    missing: str
    """The response that did not come."""
    values: Mapping[str, float | None]
    """Each signal at the first tick, in its base unit; None: unknown."""
    window: Window | None = None
    """The signals around it; None where the audit kept none."""


@dataclass(frozen=True, slots=True)
class Threshold:
    """How near a signal came to a bound; numbers in `unit`, as text where they are infinite."""

    proposition: str
    signal: str
    operator: str
    bound: float
    unit: str
    least: float | str | None
    greatest: float | str | None
    comparison: str | None
    """The truth value that it kept, `crossed`, or None: it was never known."""
    margin: float | None
    nearest: float | None
    """Seconds from the first tick."""


@dataclass(frozen=True, slots=True)
class Topic:
    """How one topic of a log is; times in nanoseconds of the log."""

    name: str
    type: str
    count: int
    first_ns: int | None
    last_ns: int | None
    longest_gap_ns: int | None
    out_of_order: int | None
    """None where the messages were only counted."""


@dataclass(frozen=True, slots=True)
class Finding:
    """A diagnostic about the log, as the audit wrote it."""

    code: str
    severity: str
    message: str
    help: str


@dataclass(frozen=True, slots=True)
class Checked:
    """What was looked at of the chunks of a log."""

    by_index: bool
    chunks: int
    crc_checked: int
    crc_unchecked: int
    without_crc: int
    skipped: int


@dataclass(frozen=True, slots=True)
class Health:
    """Whether the data of a run can be trusted; `size` in bytes, gaps in nanoseconds of the log."""

    intact: bool
    size: int | None
    checked: Checked | None
    gaps: tuple[tuple[int, int], ...]
    findings: tuple[Finding, ...]
    topics: tuple[Topic, ...]


@dataclass(frozen=True, slots=True)
class Result:
    """What the audit of one run says of one requirement."""

    run: str
    requirement: str
    verdict: str
    finite: bool | None
    reason: str
    clock: str
    ticks: int
    start_ns: int | None
    end_ns: int | None
    triggers: tuple[Moment, ...]
    violations: tuple[Violation, ...]
    unknown: tuple[tuple[int, int], ...]
    open: tuple[Moment, ...]
    latencies: tuple[float, ...]
    thresholds: tuple[Threshold, ...]
    units: Mapping[str, str]
    hashes: Mapping[str, str]
    """SHA-256 of `log` (absent where it could not be read), `sentence`, `bindings`, `monitor`."""
    health: Health
    assumptions: tuple[str, ...]
    trials: Trials | None = None
    """Of a requirement with a probability, where the log could be read."""
    uncertain: frozenset[int] = frozenset()
    """Ticks of triggers whose answer, or whose open demand, depends on unknown values."""

    @property
    def content(self) -> str:
        """What tells its log from another one: copies have the same."""
        return self.hashes.get("log") or self.hashes.get("log_summary") or self.run


@dataclass(frozen=True, slots=True)
class Evidence:
    """A whole evidence file."""

    file: str
    sha256: str
    fretc: str
    """Version of the tool that audited."""
    results: tuple[Result, ...]
    probabilities: tuple[Estimated, ...]
    """What all runs say of each requirement with a probability."""


def by_requirement(evidence: Evidence | None) -> Mapping[str, Sequence[Result]]:
    """The results of each requirement that has any, in the order of the evidence."""
    found: dict[str, list[Result]] = {}
    for result in evidence.results if evidence else ():
        found.setdefault(result.requirement, []).append(result)
    return found


def refuted(path: str) -> frozenset[str]:
    """The requirements that all runs together refute; none where there is no evidence."""
    found = read(path)
    told = () if isinstance(found, Diagnostic) else found.probabilities
    return frozenset(one.requirement for one in told if one.answer == REFUTED)


def read(path: str) -> Evidence | Diagnostic:
    """Read and check an evidence file; a note, not an error, where there is none yet."""
    found = _loaded(path)
    return found if isinstance(found, Diagnostic) else found[0]


def document(path: str) -> Mapping[str, Any] | Diagnostic:
    """The same file as plain values; an error where there is none."""
    found = both(path)
    return found if isinstance(found, Diagnostic) else found[1]


def both(path: str) -> tuple[Evidence, Mapping[str, Any]] | Diagnostic:
    """The checked values, and the plain ones that they are made of; an error where none are."""
    found = _loaded(path)
    return replace(found, severity=Severity.ERROR) if isinstance(found, Diagnostic) else found


def _loaded(path: str) -> tuple[Evidence, Mapping[str, Any]] | Diagnostic:
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return _not_audited(path) if source.code is Code.NO_SUCH_FILE else source
    return _parsed(source)


def parse(source: Source) -> Evidence | Diagnostic:
    """Check the text of an evidence file."""
    found = _parsed(source)
    return found if isinstance(found, Diagnostic) else found[0]


def _parsed(source: Source) -> tuple[Evidence, Mapping[str, Any]] | Diagnostic:
    path = source.name
    try:
        file = parsed(source.text)
    except json.JSONDecodeError as error:
        return _not_json(source, error)
    except (ValueError, RecursionError) as error:
        return _wrong(path, f"is not JSON that fretc can read: {_why(error)}")
    try:
        found = _evidence(file, source)
    except MisshapenError as error:
        return _wrong(path, f"is not evidence of fretc: {error}")
    wrong = misfit(file.value, "evidence")
    if wrong:
        return _wrong(path, f"is not evidence of fretc: {wrong}")
    assert isinstance(file.value, dict)
    return found, file.value


def _not_audited(path: str) -> Diagnostic:
    """F901 as a note: a report before the first audit is a report of what is not shown."""
    return Diagnostic(
        Code.NO_SUCH_FILE,
        f"no run has been audited: there is no evidence in `{path}`",
        help=f"audit a run: `fretc audit LOG... --evidence {path}`",
        severity=Severity.NOTE,
    )


def _not_json(source: Source, error: json.JSONDecodeError) -> Diagnostic:
    at = min(error.pos, max(0, len(source.text) - 1))
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"the evidence is not JSON: {error.msg[:1].lower()}{error.msg[1:]}",
        source.span(at, at + 1),
        help=f"audit again: `fretc audit LOG... --evidence {source.name}`",
    )


def _wrong(path: str, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"`{path}` {what}",
        Source(path, "").span(),
        help=f"audit again: `fretc audit LOG... --evidence {path}`",
    )


def _why(error: Exception) -> str:
    return "it is nested too deeply" if isinstance(error, RecursionError) else str(error)


# Shapes -------------------------------------------------------------------------------------


def _evidence(file: Shape, source: Source) -> Evidence:
    schema = file.field("schema").text()
    if schema != SCHEMA:
        raise file.field("schema").wrong(f"`{SCHEMA}`")
    return Evidence(
        file=source.name,
        sha256=sha256(source.text),
        fretc=file.field("fretc").text(),
        results=tuple(_result(result) for result in file.field("results").items()),
        probabilities=tuple(probability(each) for each in _listed(file, "probabilities")),
    )


def _listed(at: Shape, key: str) -> tuple[Shape, ...]:
    return at.field(key).items() if at.has(key) else ()


def _result(at: Shape) -> Result:
    return Result(
        run=at.field("run").text(),
        requirement=at.field("requirement").text(),
        verdict=at.field("verdict").one_of(VERDICTS),
        finite=at.field("finite").or_none(Shape.flag),
        reason=at.field("reason").text(),
        clock=at.field("clock").text(),
        ticks=at.field("ticks").count(),
        start_ns=at.field("start_ns").or_none(Shape.whole),
        end_ns=at.field("end_ns").or_none(Shape.whole),
        triggers=tuple(map(_moment, at.field("triggers").items())),
        violations=tuple(map(_violation, at.field("violations").items())),
        unknown=tuple(map(_ticks, at.field("unknown").items())),
        open=tuple(map(_moment, at.field("open").items())),
        latencies=tuple(latency.seconds() for latency in at.field("latencies_s").items()),
        thresholds=tuple(map(_threshold, at.field("thresholds").items())),
        units={name: unit.text() for name, unit in at.field("units").fields().items()},
        hashes=_hashes(at.field("hashes")),
        health=_health(at.field("health")),
        assumptions=tuple(text.text() for text in at.field("assumptions").items()),
        trials=trials(at.field("trials")) if at.has("trials") else None,
        uncertain=frozenset(_uncertain(at)),
    )


def _uncertain(at: Shape) -> Iterator[int]:
    """Earlier versions did not say it."""
    if at.has("uncertain"):
        yield from (tick.count() for tick in at.field("uncertain").items())


def _hashes(at: Shape) -> dict[str, str]:
    for name in ("sentence", "bindings", "monitor"):
        at.field(name).text()
    return {name: value.text() for name, value in at.fields().items()}


def _moment(at: Shape) -> Moment:
    return Moment(at.field("tick").count(), at.field("seconds").seconds())


def _violation(at: Shape) -> Violation:
    values = at.field("values").fields()
    start = at.field("start_s").seconds()
    first_ns = at.field("start_ns").whole() - round(start * 1e9)
    return Violation(
        Moment(at.field("first_tick").count(), start),
        Moment(at.field("last_tick").count(), at.field("end_s").seconds()),
        at.field("trigger").or_none(_moment),
        at.field("deadline").or_none(_moment),
        at.field("missing").text(),
        {name: value.or_none(Shape.number) for name, value in values.items()},
        at.field("window").or_none(lambda each: window(each, first_ns)),
    )


def _threshold(at: Shape) -> Threshold:
    return Threshold(
        proposition=at.field("proposition").text(),
        signal=at.field("signal").text(),
        operator=at.field("operator").one_of(("<", "<=", ">", ">=")),
        bound=at.field("bound").number(),
        unit=at.field("unit").text(),
        least=at.field("least").or_none(_reading),
        greatest=at.field("greatest").or_none(_reading),
        comparison=at.field("comparison").or_none(_comparison),
        margin=at.field("margin").or_none(Shape.number),
        nearest=at.field("nearest").or_none(lambda nearest: nearest.field("seconds").number()),
    )


def _reading(at: Shape) -> float | str:
    return at.one_of(("+inf", "-inf")) if isinstance(at.value, str) else at.number()


def _comparison(at: Shape) -> str:
    return at.one_of(("true", "false", "crossed"))


def _ticks(at: Shape) -> tuple[int, int]:
    ends = tuple(end.count() for end in at.items())
    if len(ends) != 2:
        raise at.wrong("two ticks: the first and the last")
    return ends[0], ends[1]


def _health(at: Shape) -> Health:
    return Health(
        intact=at.field("intact").flag(),
        size=at.field("size").or_none(Shape.count),
        checked=at.field("checked").or_none(_checked),
        gaps=tuple(
            (gap.field("start_ns").whole(), gap.field("end_ns").whole())
            for gap in at.field("gaps").items()
        ),
        findings=tuple(map(_finding, at.field("findings").items())),
        topics=tuple(_topic(name, topic) for name, topic in at.field("topics").fields().items()),
    )


def _checked(at: Shape) -> Checked:
    return Checked(
        by_index=at.field("by_index").flag(),
        chunks=at.field("chunks").count(),
        crc_checked=at.field("crc_checked").count(),
        crc_unchecked=at.field("crc_unchecked").count(),
        without_crc=at.field("without_crc").count(),
        skipped=at.field("skipped").count(),
    )


def _finding(at: Shape) -> Finding:
    return Finding(
        code=at.field("code").text(),
        severity=at.field("severity").one_of([str(severity) for severity in Severity]),
        message=at.field("message").text(),
        help=at.field("help").or_none(Shape.text) or "",
    )


def _topic(name: str, at: Shape) -> Topic:
    return Topic(
        name=name,
        type=at.field("type").text(),
        count=at.field("count").count(),
        first_ns=at.field("first_ns").or_none(Shape.whole),
        last_ns=at.field("last_ns").or_none(Shape.whole),
        longest_gap_ns=at.field("longest_gap_ns").or_none(Shape.count),
        out_of_order=at.field("out_of_order").or_none(Shape.count),
    )
