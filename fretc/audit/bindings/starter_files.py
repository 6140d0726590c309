"""The first files of a project: hazards, bindings and one requirement that can be audited.

With a log the requirement bounds a signal of it, by the least round number that the log keeps; so
its first audit shows something, and a person puts the true limit in its place.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from decimal import ROUND_CEILING, Decimal
from pathlib import Path

import numpy as np

from compiler.files.templating import render
from fretc.audit.bindings.draft import draft, draft_of_topics
from fretc.audit.bindings.draft_signals import TopicDraft, plain_signals
from fretc.logs.reader import Overview, look, read
from fretc.logs.signals.samples import Recording
from fretc.logs.storage.log_names import is_url, name_of
from fretc.logs.tables.episodes import runs_of
from fretish.bindings.declarations import Declarations, Signal
from fretish.bindings.tables.reader import read_bindings
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.printer import identifier

_PREFERENCE = ("m/s", "m", "rad/s")
"""Units of the signals that suit a first requirement best; all other units come after them."""
_COUNTERS = frozenset(
    ("timestamp", "time", "stamp", "sec", "nanosec", "index", "id", "seq", "sequence", "count",
     "counter", "frame", "episode", "instance", "version")
)  # fmt: skip
"""Words in the names of fields that are no measurements."""
_MEASURES = (
    "battery", "voltage", "remaining", "percent", "speed", "vel", "alt", "depth", "height",
    "distance", "range", "temperature", "current", "effort",
)  # fmt: skip
"""Parts of the names of fields that suit a first requirement."""
_DIGITS = 2
"""Significant digits of a limit."""
_NAMES = ("r1.fret", "bindings.toml", "hazards.toml")


@dataclass(frozen=True, slots=True)
class UpperLimit:
    """A signal and its upper limit."""

    signal: str
    limit: str
    """A decimal number."""
    unit: str
    """The unit; empty: a plain number."""


@dataclass(frozen=True, slots=True)
class FirstRequirement:
    """A requirement, and the bindings that its sentence needs."""

    title: str
    text: str
    rationale: str
    sentence: str


def first_requirement(bound: UpperLimit, origin: str) -> FirstRequirement:
    """The text of a requirement about one signal.

    Args:
        bound: what is required.
        origin: where the limit comes from, as the rest of a sentence.
    """
    return FirstRequirement(
        title=f"Limit of {bound.signal}",
        text=f"{bound.signal} is at most {bound.limit} {bound.unit}".rstrip() + ", always.",
        rationale=f"To do: say why. The limit {origin}",
        sentence=f"the robot shall always satisfy {identifier(bound.signal)} <= {bound.limit}",
    )


@dataclass(frozen=True, slots=True)
class StarterFiles:
    """The first files of a project."""

    files: Mapping[str, str]
    """The text of each file, by name."""
    findings: tuple[Diagnostic, ...] = ()
    """Diagnostics about the log from which the files are drafted."""


def without_log() -> StarterFiles:
    """The first files of a project without a log."""
    bound = UpperLimit("speed", "1.5", "m/s")
    requirement = first_requirement(bound, "is an example.")
    return StarterFiles(_files(requirement, render("project/speed.toml.j2")))


def from_log(log: str) -> StarterFiles | Diagnostic:
    """The first files of a project whose first requirement is about a signal of the log."""
    run = log if is_url(log) else runs_of(log)[0]
    overview = look(run, words=True)
    if isinstance(overview, Diagnostic):
        return overview
    topics = draft_of_topics(overview)
    signals = _signals(overview, topics)
    declarations, _ = read_bindings(Source("bindings.toml", signals))
    if declarations is None or not declarations.signals:
        return _no_signal(log)
    recording = read(run, declarations, list(declarations.signals))
    if isinstance(recording, Diagnostic):
        return recording
    bound = next(_bounds(declarations, recording), None)
    if bound is None:
        return _no_signal(log)
    origin = f"is the largest value in {Path(overview.recording.name).name}, rounded up."
    signals = _signals(overview, topics, declarations.signals[bound.signal].path.topic)
    files = _files(first_requirement(bound, origin), signals)
    return StarterFiles(files, overview.recording.findings)


def _files(requirement: FirstRequirement, signals: str) -> dict[str, str]:
    texts = (
        render("project/r1.fret.j2", requirement=requirement),
        f"{signals.rstrip()}\n",
        render("project/hazards.toml.j2"),
    )
    return dict(zip(_NAMES, texts, strict=True))


def _signals(overview: Overview, topics: Sequence[TopicDraft], clocked_by: str = "") -> str:
    """The clock and signals; if no message type is well known, a signal for every field."""
    text = draft(overview, (), clocked_by=clocked_by, topics=topics)
    plain = () if any(topic.signals for topic in topics) else plain_signals(overview)
    return text + render("project/signals.toml.j2", signals=plain)


def _bounds(declarations: Declarations, recording: Recording) -> Iterator[UpperLimit]:
    """The bound that each signal of the recording satisfies, the best first requirement first."""
    signals = sorted(
        declarations.signals.values(),
        key=lambda signal: (
            not _is_steady(signal, recording),
            not _varies(signal, recording),
            _is_counter(signal),
            _rank(signal),
        ),
    )
    for signal in signals:
        samples = recording.samples.get(signal.name)
        if samples is None or signal.values or not samples.values.size:
            continue
        largest = float(samples.values.max())
        if np.isfinite(samples.values).all():
            yield UpperLimit(signal.name, _limit(largest), signal.unit_name)


def _is_steady(signal: Signal, recording: Recording) -> bool:
    """Whether the topic of the signal is frequent enough for the signal to be known throughout."""
    topic = recording.topics[signal.path.topic]
    gap = topic.longest_gap_ns
    return signal.max_age is not None and gap is not None and gap <= signal.max_age


def _varies(signal: Signal, recording: Recording) -> bool:
    """Whether the signal has more than one value: the limit of a constant would show nothing."""
    samples = recording.samples.get(signal.name)
    return samples is not None and bool((samples.values[1:] != samples.values[:-1]).any())


def _is_counter(signal: Signal) -> bool:
    """Whether the name of the field says that it counts or names something: no limit suits it."""
    words = re.findall(r"[a-z]+", signal.path.fields[-1].lower())
    return not _COUNTERS.isdisjoint(words)


def _rank(signal: Signal) -> tuple[int, bool]:
    unit, field = signal.unit_name, signal.path.fields[-1].lower()
    place = _PREFERENCE.index(unit) if unit in _PREFERENCE else len(_PREFERENCE)
    return place, not any(word in field for word in _MEASURES)


def _limit(largest: float) -> str:
    """The least number of two digits that is not below the value."""
    exact = Decimal(largest)
    if not exact:
        return "0"
    digit = Decimal(1).scaleb(exact.adjusted() - _DIGITS + 1)
    rounded = (exact / digit).to_integral_value(ROUND_CEILING) * digit
    return f"{rounded.normalize():f}"


def _no_signal(log: str) -> Diagnostic:
    return diagnostic("nothing_to_draft", Source(name_of(log), "").span(), log=name_of(log))
