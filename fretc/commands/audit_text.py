"""Text output of `fretc audit`: the verdicts, the first one to examine, the counts."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from shlex import quote
from typing import Any

from compiler.formalization.record import wording
from compiler.project.project import Project
from fretc.audit.evidence.declared_units import without_samples
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.result_summaries import EvidenceSource
from fretc.audit.evidence.schema import Result, ThresholdRecord, Violation
from fretc.audit.evidence.verdicts import ASSUMPTION_BROKEN, SHOWN, VERDICTS
from fretc.audit.measurements.confidence_intervals import REFUTED
from fretc.audit.measurements.intervals import end_ns
from fretc.audit.outputs.broken_assumptions import broken_assumptions
from fretc.audit.outputs.totals import (
    COUNTED,
    ResultCount,
    VerdictWords,
    longest,
    runs,
    totals,
    word_of,
)
from fretc.audit.outputs.violated_values import values
from fretc.commands.audit_table import Line, table
from fretc.coverage.coverage import of_all_runs
from fretc.coverage.text_output import in_counts
from fretc.terminal.output import EVIDENCE, REQUIREMENTS_FOLDER, STORE
from fretc.terminal.screen import Screen, padded, titled, width
from fretish.bindings.amounts import count_of, duration, exact, instant, seconds, value
from fretish.classes.frozen import dataclass
from fretish.diagnostics.rendering import visible
from fretish.documents import named

_FIRST_DATE = 10**17
"""Nanoseconds, a date in 1973: an earlier time stamp is of a simulated clock that starts at 0."""


_LONGEST_NAME = 48
"""Minimum number of columns for a requirement's name before it is shortened."""


@dataclass(frozen=True, slots=True)
class AuditPaths:
    """Paths that an audit reads and writes, as named on the command line."""

    requirements: str
    bindings: str | None
    evidence: str

    def commands(self, id: str) -> Iterator[str]:
        """Commands that show more about a requirement."""
        folder = self._option("--requirements", self.requirements, REQUIREMENTS_FOLDER)
        project = f"{folder}{self._option('--bindings', self.bindings, None)}"
        if self.evidence != "-":
            yield f"fretc report{project}{self.evidence_option}"
        yield f"fretc explain {quote(id)}{project}"

    @property
    def evidence_option(self) -> str:
        """The `--evidence` option for other commands; empty for the default path."""
        default = self.evidence if self.evidence in (EVIDENCE, STORE) else None
        return self._option("--evidence", self.evidence, default)

    @staticmethod
    def _option(name: str, value: str | None, default: str | None) -> str:
        return "" if value is None or value == default else f" {name} {quote(value)}"


@dataclass(frozen=True, slots=True)
class AuditText:
    """An audit, and the other values that its text shows."""

    source: EvidenceSource
    marks: VerdictWords
    estimates: Sequence[Estimated]
    project: Project
    refused: Collection[str]
    """Ids of requirements that could not be evaluated on any run."""
    places: AuditPaths
    seconds: float
    """Duration of the audit."""


def lines(subject: AuditText, screen: Screen, *, every: bool) -> Iterator[Line]:
    """All lines, the counts last.

    Args:
        subject: the audit.
        screen: the output screen.
        every: list each result, also where a table would show it.
    """
    titles = {requirement.id: requirement.title for requirement in subject.project.requirements}
    if every or len(subject.marks.names) == 1:
        yield from _listed(subject, titles, screen)
    else:
        yield from table(subject.marks, screen, titles)
    for one in subject.estimates:
        yield from _estimate(one, named(one.requirement, titles.get(one.requirement, "")))
    for text in _first_to_look_at(subject):
        yield ((visible(text), None),)
    yield from _assumptions(subject)
    yield from _situations(subject)
    yield _last(subject)


def _assumptions(subject: AuditText) -> Iterator[Line]:
    """The assumptions that runs do not keep."""
    summaries = (each for _, each in subject.source.summaries())
    results = ((each.run, each.requirement, each.verdict) for each in summaries)
    for each in broken_assumptions(results, subject.project.formalized):
        sign = VERDICTS[ASSUMPTION_BROKEN].sign
        yield ((visible(f"{sign.glyph} {each.in_words}"), sign.colour),)


def _situations(subject: AuditText) -> Iterator[Line]:
    """Number of situations that the runs exercised, and the command that lists them."""
    _, situations = of_all_runs(subject.source)
    if any(each.situations for each in situations):
        printed = subject.places.evidence == "-"
        more = "" if printed else f": `fretc coverage{subject.places.evidence_option}` lists them"
        yield ((visible(f"{in_counts(situations)}{more}"), None),)


def _listed(subject: AuditText, titles: Mapping[str, str], screen: Screen) -> Iterator[Line]:
    """The name of each run, and a line for each of its results."""
    most = max(_LONGEST_NAME, screen.width // 3)
    names = {
        id: titled(screen.text(id), screen.text(titles.get(id, "")), most)
        for id in subject.marks.ids
    }
    room = max(map(width, names.values()), default=0)
    for run in runs(summary for _, summary in subject.source.summaries()):
        yield ((visible(run[0].run), None),)
        for result in run:
            verdict = VERDICTS[result.verdict]
            name = padded(names[result.requirement], room)
            line = f"  {verdict.sign.glyph} {name}  {verdict.word:<12}  {visible(result.reason)}"
            yield ((line, verdict.sign.colour),)


def _estimate(one: Estimated, name: str) -> Iterator[Line]:
    """Estimate of a requirement with a probability over all runs."""
    first, *rest = one.lines
    verdict = VERDICTS[one.answer]
    yield ((visible(f"{name} over all runs, {one.text}"), None),)
    yield ((visible(f"  {verdict.sign.glyph} {first}"), verdict.sign.colour),)
    yield from (((visible(f"    {line}"), None),) for line in rest)


def summary(subject: AuditText, status: int) -> dict[str, Any]:
    """JSON summary for `--notify`: a text and numbers."""
    last = "".join(text for text, _ in _last(subject)).rsplit("  ", 1)[0]
    worst_first = [*_first_to_look_at(subject, commands=False)]
    marks = subject.marks
    return {
        "text": "\n".join(map(visible, [last, *worst_first[1:]])),
        "status": status,
        "runs": len(marks.names),
        "requirements": len(marks.ids),
        "counts": {each.word: each.results for each in totals(marks)},
        "evidence": subject.places.evidence,
    }


def _first_to_look_at(subject: AuditText, *, commands: bool = True) -> Iterator[str]:
    """The worst result, and the commands that show more; nothing if all are satisfied."""
    index = subject.marks.worst
    ((_, result),) = subject.source.details([index]) if index is not None else ((0, None),)
    refuted = next((one for one in subject.estimates if one.answer == REFUTED), None)
    if refuted is not None and (result is None or longest(result) is None):
        id, where, details = refuted.requirement, f"{REFUTED} over all runs", [refuted.lines[0]]
    elif result is not None:
        id, details = result.requirement, [*_details(result, subject), *_origin(result)]
        where = f"{word_of(result, subject.refused)} in {result.run}"
    else:
        return
    yield ""
    yield f"worst: {_name(subject, id)} {where}"
    yield from (f"  {line}" for line in details)
    for index, command in enumerate(subject.places.commands(id) if commands else ()):
        yield f"  {'more:' if index == 0 else '     '} {command}"


def _origin(result: Result) -> Iterator[str]:
    """The time from which all printed seconds count; nothing for a log without a tick."""
    if result.states:
        yield f"seconds count from the first tick, at {_time(result.states[0].ns)}"


def _details(result: Result, subject: AuditText) -> Iterator[str]:
    """The longest violation of a result, or the reason for another verdict."""
    violation = longest(result)
    if violation is None:
        yield result.reason
        return
    (shown,) = without_samples([result], subject.project.declarations)
    yield from _violation(shown, shown.violations[result.violations.index(violation)])


def _name(subject: AuditText, id: str) -> str:
    """Title and id of a requirement, or id and sentence if it has no title."""
    requirement = next((each for each in subject.project.requirements if each.id == id), None)
    if requirement is None or requirement.title:
        return requirement.name if requirement else id
    return f"{id} (`{wording(requirement)}`)"


def _violation(result: Result, violation: Violation) -> Iterator[str]:
    """Time, demand, values and limits of a violation.

    Args:
        result: result in declared units.
        violation: one of its violations.
    """
    first = violation.start_ns
    end = end_ns(violation.last, result.clock) or violation.end_ns
    length = (end - first) / 1e9
    until = f", until {seconds(violation.start_s + length)} ({duration(length)})"
    many = len(result.violations)
    yield (
        f"at {seconds(violation.start_s)} ({_time(first)})"
        f"{until if end > first else ''}"
        f"{f'; the longest of {many:,} intervals' if many > 1 else ''}"
    )
    known = f"; recorded: {values(result, violation)}" if violation.values else ""
    if violation.missing or known:
        yield f"demanded: {violation.missing}{known}"
    for belief in violation.beliefs or ():
        yield f"agent: {belief.in_words()}"
    for threshold in result.thresholds:
        if _is_in(threshold.proposition, violation.missing):
            yield f"limit: {_limit(threshold)}"


def _time(ns: int) -> str:
    return instant(ns) if ns >= _FIRST_DATE else f"{seconds(ns / 1e9)} by the clock of the log"


def _is_in(proposition: str, expression: str) -> bool:
    return re.search(rf"(?<!\w){re.escape(proposition)}(?!\w)", expression) is not None


def _limit(threshold: ThresholdRecord) -> str:
    """`speed <= 1.5 m/s (slow); from 0 m/s to 1.8 m/s in this run`."""
    unit, bound = threshold.unit, threshold.bound
    comparison = f"{threshold.signal} {threshold.operator} {exact(bound, unit)}"
    name = f" ({threshold.proposition})" if threshold.proposition.isidentifier() else ""
    least, greatest = (value(each, unit, [bound]) for each in (threshold.least, threshold.greatest))
    known = "" if threshold.least is None else f"; from {least} to {greatest} in this run"
    return f"{comparison}{name}{known}"


def _last(subject: AuditText) -> Line:
    """`16 runs x 15 requirements: 12 violated (3 requirements in 4 runs), 228 satisfied  2.1 s`."""
    marks = subject.marks
    counts = totals(marks)
    parts = [_count(total, many=len(marks.names) > 1) for total in counts]
    times = "\N{MULTIPLICATION SIGN}"
    head = f"{count_of(len(marks.names), 'run')} {times} {count_of(len(marks.ids), 'requirement')}"
    text = f"{head}: {', '.join(parts)}  {subject.seconds:.1f} s"
    return ((text, counts[0].colour if counts else None),)


def _count(total: ResultCount, *, many: bool) -> str:
    if not total.runs:
        return f"{total.results:,} {total.word} over all runs"
    where = f" ({count_of(total.requirements, 'requirement')} in {count_of(total.runs, 'run')})"
    bad = total.word not in (*SHOWN, COUNTED)
    return f"{total.results:,} {total.word}{where if many and bad else ''}"
