"""The audited runs, and the condition of their data."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace as changed
from functools import cached_property
from itertools import takewhile

from compiler.files.records import replace
from compiler.project.project import Project
from fretc.audit.evidence.result_summaries import (
    ResultSummaries,
    ResultSummary,
    RunFacts,
    audited_s,
)
from fretc.audit.evidence.schema import CheckedChunks, Gap, LogFinding, TopicRecord
from fretc.report.model import phrases
from fretc.report.model.marks import sign_mark
from fretc.report.model.views import Remark, RequirementView, RunSummary, TopicView
from fretc.traceability.acceptances import as_diagnostic
from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.diagnostic import Severity
from monitors import kernel

_NONE = "\N{EN DASH}"
_INTACT = sign_mark("no damage found", signs.GOOD)
_DAMAGED = sign_mark("damaged", signs.BAD)
_UNREAD = sign_mark("not readable", signs.UNKNOWN)


@dataclass(frozen=True)
class AuditedFile:
    """One audited file."""

    number: int
    facts: RunFacts
    """Facts without topics, because there may be many; `topic_views` reads the topics of a run."""
    has_topics: bool
    first: int = 0
    """Index of the first result of the run, which contains the plot data of the run."""
    name: str = ""
    """A short unique name, from the name of the file."""

    @cached_property
    def anchor(self) -> str:
        """The anchor of the section of the run."""
        return f"run-{self.number}"


RunKey = tuple[str, str]


def run_key(result: ResultSummary | RunFacts) -> RunKey:
    """Name and hash of the file: results of one run have the same key."""
    return result.run, result.log


def runs(summaries: ResultSummaries | None) -> dict[RunKey, AuditedFile]:
    """The runs of the evidence, numbered from 1 in its order."""
    numbered: dict[RunKey, AuditedFile] = {}
    for facts in summaries.source.runs() if summaries else ():
        bare = changed(facts, health=replace(facts.health, topics={}))
        first = summaries.firsts.get(run_key(facts), 0) if summaries else 0
        run = AuditedFile(len(numbered) + 1, bare, bool(facts.health.topics), first)
        numbered.setdefault(run_key(facts), run)
    names = run_names([run.facts.run for run in numbered.values()])
    return {
        key: changed(run, name=name)
        for (key, run), name in zip(numbered.items(), names, strict=True)
    }


# Names -----------------------------------------------------------------------------------------

_SEPARATOR = re.compile(r"[/\\]+")
_LONGEST = 60
"""Maximum number of characters of a name."""


def run_names(logs: Sequence[str]) -> list[str]:
    """A unique name for each run, such as `safety-off-2`; equal names get a number."""
    names = file_names(inner_paths(logs))
    counts = Counter(names)
    return [
        name if name and counts[name] == 1 else f"{name} (run {number})".lstrip()
        for number, name in enumerate(names, 1)
    ]


def inner_paths(logs: Sequence[str]) -> list[list[str]]:
    """The paths without their common folders, so that the report is independent of the machine."""
    paths = [_SEPARATOR.split(log) for log in logs]
    shared = alike([path[:-1] for path in paths])
    return [path[shared:] for path in paths]


def places(logs: Sequence[str]) -> dict[str, str]:
    """Each log with its path for a reader, which is independent of the machine.

    Of an absolute path it is the last part, or the part below the common folder of the absolute
    paths if two of them have the same last part. So a command never names one file for two logs.
    """
    absolute = [log for log in dict.fromkeys(logs) if phrases.place(log) != log]
    names = [phrases.place(log) for log in absolute]
    if len({*names}) < len(names):
        names = ["/".join(path) for path in inner_paths(absolute)]
    return {**{log: log for log in logs}, **dict(zip(absolute, names, strict=True))}


def alike(sequences: Sequence[Sequence[str]]) -> int:
    """The length of the common prefix of sequences."""
    return sum(1 for _ in takewhile(lambda same: len({*same}) == 1, zip(*sequences, strict=False)))


def file_names(paths: Sequence[Sequence[str]]) -> list[str]:
    """The name of each file, without a common ending, and with its folder if needed."""
    endings = {path[-1].rpartition(".")[1:] for path in paths}
    cut = sum(map(len, next(iter(endings)))) if len(endings) == 1 else 0
    cut = cut if all(len(path[-1]) > cut for path in paths) else 0
    files = [path[-1][: len(path[-1]) - cut] for path in paths]
    if len({*files}) != len(files):
        files = ["/".join((*path[:-1], file)) for path, file in zip(paths, files, strict=True)]
    return [_short(file) for file in files]


def _short(name: str) -> str:
    half = _LONGEST // 2
    return name if len(name) <= _LONGEST else f"{name[:half]}…{name[1 - half :]}"


def damage(runs: Sequence[RunSummary], sections: Sequence[RequirementView]) -> Iterator[str]:
    """`log-cut-6: the log breaks off after 128.28 s: 15 requirements have no verdict from it`.

    Args:
        runs: the views of all runs.
        sections: the views of all requirements.
    """
    lost = Counter(
        result.run
        for view in sections
        for result in view.results
        if result.mark.word == kernel.NO_DATA
    )
    for run in runs:
        if run.intact:
            continue
        errors = [finding for finding in run.findings if finding.severity != "note"]
        what = errors[0].message if errors else "the log is damaged"
        count = phrases.times(lost[run.anchor], "requirement")
        verb = "has" if lost[run.anchor] == 1 else "have"
        yield f"{run.label}: {what}: {count} {verb} no verdict from it. Record it again."


# Views -----------------------------------------------------------------------------------------


def run_summaries(runs: Iterable[AuditedFile], project: Project) -> tuple[RunSummary, ...]:
    """The view of each run, runs with errors first."""
    return tuple(_summary(run, project) for run in sorted(runs, key=_severity))


def _severity(run: AuditedFile) -> tuple[bool, bool, bool, bool]:
    """Sort key of runs: errors, damage, other findings, gaps."""
    health = run.facts.health
    return not _errors(run), health.intact, not health.findings, not health.gaps


def _errors(run: AuditedFile) -> list[str]:
    """The codes of the errors of a run, without duplicates."""
    codes = (f.code for f in run.facts.health.findings if f.severity == Severity.ERROR.value)
    return list(dict.fromkeys(codes))


def _summary(run: AuditedFile, project: Project) -> RunSummary:
    facts = run.facts
    health = facts.health
    return RunSummary(
        anchor=run.anchor,
        label=run.name,
        file=phrases.place(facts.run),
        sha256=facts.log,
        size=phrases.size(health.size),
        recorded=phrases.instant(facts.start_ns),
        duration=_duration(facts),
        ticks=phrases.times(facts.ticks, "tick"),
        clock=facts.clock,
        intact=health.intact,
        health=_INTACT if health.intact else _DAMAGED if run.has_topics else _UNREAD,
        checked=_checked(health.checked, hashed=not facts.log_summary),
        gaps=_gaps(facts),
        findings=tuple(
            _finding(finding, project) for finding in sorted(health.findings, key=_badness)
        ),
    )


def topic_views(facts: RunFacts, project: Project) -> tuple[TopicView, ...]:
    """The topics of one run."""
    topics = sorted(facts.health.topics.items())
    return tuple(_topic(name, topic, project) for name, topic in topics)


def _duration(facts: RunFacts) -> str:
    length = audited_s(facts)
    return "not known" if length is None else phrases.seconds(length)


def _checked(checked: CheckedChunks | None, *, hashed: bool) -> str:
    """The checks of the file, and the parts that were not checked."""
    if checked is None:
        return "not known"
    if not checked.chunks:
        return "every record was read" if not checked.by_index else "nothing: the log has no chunks"
    parts = [
        f"{count} of {checked.chunks} chunks {what}"
        for count, what in (
            (checked.crc_checked, "match their CRC"),
            (
                checked.crc_unchecked,
                "have a CRC that was not checked, because only their beginning was read",
            ),
            (checked.without_crc, "have no CRC"),
            (checked.skipped, "contain no bound topic and were not read"),
        )
        if count
    ]
    parts.append("read by the index" if checked.by_index else "every record was read")
    return "; ".join(parts if hashed else [*parts, "not hashed"])


def _gaps(facts: RunFacts) -> tuple[str, ...]:
    return tuple(_gap(gap, facts) for gap in facts.health.gaps)


def _gap(gap: Gap, facts: RunFacts) -> str:
    """`from 3 s to 4.2 s (1.2 s)`; data that is lost after the last message has no known end."""
    start, end = ((ns - (facts.start_ns or 0)) / 1e9 for ns in (gap.start_ns, gap.end_ns))
    if facts.end_ns is not None and gap.end_ns >= facts.end_ns:
        return f"from {phrases.seconds(start)} to the end of the log"
    length = phrases.duration(round(end - start, 9))
    return f"from {phrases.seconds(start)} to {phrases.seconds(end)} ({length})"


def _badness(finding: LogFinding) -> int:
    """Sort key of findings."""
    return [str(severity) for severity in Severity].index(finding.severity)


def _finding(finding: LogFinding, project: Project) -> Remark:
    return Remark(
        finding.code,
        finding.severity,
        finding.message,
        help=finding.help or "",
        accepted=_accepted(finding, project),
    )


def _accepted(finding: LogFinding, project: Project) -> str:
    """The reason why the project accepts a finding, or ""."""
    (answered,) = project.answered([as_diagnostic(finding)])
    return answered.accepted


def _topic(name: str, topic: TopicRecord, project: Project) -> TopicView:
    signals = project.declarations.signals.values() if project.declarations else ()
    return TopicView(
        name=name,
        type=topic.type,
        count=phrases.whole(topic.count),
        rate=_rate(topic),
        longest_gap=_longest_gap(topic),
        out_of_order=_NONE if topic.out_of_order is None else phrases.whole(topic.out_of_order),
        read_for=tuple(signal.name for signal in signals if signal.path.topic == name),
    )


def _longest_gap(topic: TopicRecord) -> str:
    if topic.longest_gap_ns is None or topic.count < 2:
        return _NONE
    return phrases.duration(topic.longest_gap_ns / 1e9)


def _rate(topic: TopicRecord) -> str:
    """Messages per second, between the first and the last message."""
    if topic.first_ns is None or topic.last_ns is None or topic.last_ns <= topic.first_ns:
        return _NONE
    rate = (topic.count - 1) * 1e9 / (topic.last_ns - topic.first_ns)
    return phrases.value(rate, "Hz")


def _named(run: AuditedFile) -> str:
    """`Run 2`, with the codes of its errors."""
    codes = ", ".join(_errors(run))
    return f"{run.name} ({codes})" if codes else run.name


def trust(runs: Sequence[AuditedFile], project: Project) -> str:
    """The condition of the runs in one sentence; "" if there is no run."""
    damaged = [_named(run) for run in runs if not run.facts.health.intact]
    wrong = [_named(run) for run in runs if run.facts.health.intact and _errors(run)]
    with_findings = [
        run.name
        for run in runs
        if not all(_accepted(finding, project) for finding in run.facts.health.findings)
    ]
    if not runs:
        return ""
    if damaged or wrong:
        verb = "is" if len(damaged) == 1 else "are"
        had = "has an error" if len(wrong) == 1 else "have errors"
        parts = [
            f"{phrases.some(damaged)} {verb} damaged or could not be read" if damaged else "",
            f"{phrases.some(wrong)} {had}: read them before the verdicts" if wrong else "",
        ]
        return f"{'; '.join(filter(None, parts))}."
    if with_findings:
        verb = "has" if len(with_findings) == 1 else "have"
        return f"{phrases.some(with_findings)} {verb} findings: read them before the verdicts."
    return (
        "No damage was found in the run."
        if len(runs) == 1
        else f"No damage was found in any of {len(runs)} runs."
    )
