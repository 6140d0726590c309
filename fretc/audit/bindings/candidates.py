"""The fields of a log that a name of the requirements may stand for, the best first.

A field fits a name by its words (`altitude` and `altitude_mm`, `speed` and `linear.x`), its type
and its unit. Units come from the type of the message, from the last word of the field (`_ms`,
`_deg`), or else from REP 103: metres, radians, seconds.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from enum import IntEnum

import numpy as np

from compiler.files.templating import render
from fretc.audit.bindings.draft_signals import (
    DraftedSignal,
    age_limit,
    bindable_fields,
    long_gap,
)
from fretc.audit.bindings.needs import MissingProposition, MissingSignal
from fretc.audit.bindings.quantities import QUANTITIES, NumberField
from fretc.logs.messages.leaves import FieldKind
from fretc.logs.reader import Overview, read
from fretc.logs.signals.samples import Recording, Topic
from fretish.bindings.declarations import path, short_type
from fretish.bindings.tables.reader import read_bindings
from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Source
from fretish.units import base_name, unit

Need = MissingProposition | MissingSignal
Phrase = tuple[str, ...]
"""Words in lower case, without plurals."""

_SYNONYMS = (
    ("battery", "battery level", "percentage", "charge", "soc", "state of charge"),
    ("speed", "velocity", "linear x", "vx", "ground speed", "linear velocity"),
    ("altitude", "alt", "height", "position z", "point z"),
    ("yaw", "heading", "theta"),
    ("distance", "range", "clearance"),
    ("mode", "state", "status"),
    ("latitude", "lat"),
    ("longitude", "lon", "lng"),
    ("temperature", "temp"),
)
"""Names that people use for one quantity."""
_SUFFIXES = {
    "ns": "ns", "us": "us", "ms": "ms", "s": "s", "sec": "s", "min": "min", "h": "h",
    "mm": "mm", "cm": "cm", "m": "m", "km": "km", "mps": "m/s", "kmh": "km/h", "kn": "kn",
    "deg": "deg", "rad": "rad", "rps": "rad/s", "hz": "Hz", "mv": "mV", "v": "V", "ma": "mA",
    "a": "A", "w": "W", "n": "N", "nm": "Nm", "pa": "Pa", "kpa": "kPa", "pct": "%", "percent": "%",
}  # fmt: skip
"""Last words of fields that are units."""
_WANTED = {"cmd", "command", "desired", "goal", "reference", "setpoint", "target", "err", "error"}
"""Words of fields that say what a value should be, or how wrong it is."""
_MOST = 10


class Similarity(IntEnum):
    """How a field is like a name; the first is the best."""

    SAME_NAME = 0
    END_OF_PATH = 1
    """The name is the end of the path (`linear_x`), or the field without its unit or plural."""
    SYNONYM = 2
    PARTIAL = 3
    """The name or the field says more (`speed` and `desired_speed`): never chosen, only listed."""


@dataclass(frozen=True, slots=True)
class Candidate:
    """A field that a name may stand for."""

    signal: DraftedSignal
    """The signal of the name, read from this field."""
    similarity: Similarity
    is_unit_assumed: bool
    """Whether nothing states the unit, and it is the base unit of the sentence's dimension."""
    range: str = ""
    """`from 0.2 to 100`, or `always 1`; empty: no finite number, or not read."""


@dataclass(frozen=True, slots=True)
class Candidates:
    """The fields for one name."""

    need: Need
    chosen: Candidate | None
    """The only one that fits, or the only one of that very name; None: a person has to choose."""
    others: tuple[Candidate, ...]
    """At most ten, the most similar first."""


def candidates(overview: Overview, needs: Iterable[Need]) -> tuple[Candidates, ...]:
    """For each name its fields."""
    fits = [(need, sorted(_fitting(overview, need), key=_order)) for need in needs]
    known = ranges(overview, [each.signal for _, found in fits for each in found])
    return tuple(
        _decided(need, [replace(each, range=_range(known.get(each.signal.path))) for each in found])
        for need, found in fits
    )


def _decided(need: Need, fits: Sequence[Candidate]) -> Candidates:
    likely = [each for each in fits if each.similarity is not Similarity.PARTIAL]
    same = [each for each in likely if each.similarity is Similarity.SAME_NAME]
    chosen = same if len(same) == 1 else likely if len(likely) == 1 else [None]
    others = tuple(each for each in fits if each is not chosen[0])[:_MOST]
    return Candidates(need, chosen[0], others)


def _order(candidate: Candidate) -> tuple[int, int, str]:
    return candidate.similarity, len(candidate.signal.path), candidate.signal.path


def _fitting(overview: Overview, need: Need) -> Iterator[Candidate]:
    for name, topic in overview.recording.topics.items():
        leaves = overview.leaves.get(name) or {}
        for field, values in bindable_fields(overview, name).items():
            kind, similarity = leaves[field].kind, _similarity(need.name, name, field)
            if not topic.count or similarity is None or path(f"{name}.{field}") is None:
                continue
            signal = _signal(need, topic, field, values)
            assumed = _assumed_unit(need, signal, kind)
            if assumed is not None and _fits(need, kind, values):
                full = replace(signal, quantity=replace(signal.quantity, unit=assumed))
                yield Candidate(full, similarity, assumed != signal.quantity.unit)


def _signal(need: Need, topic: Topic, field: str, values: tuple[str, ...]) -> DraftedSignal:
    type_ = short_type(topic.type)
    known = (each for each in QUANTITIES.get(type_, ()) if each.field == field)
    own = NumberField(field, "", _unit_of(field), reduce="min" if field.endswith("[:]") else "")
    age, gap = age_limit(topic), long_gap(topic)
    return DraftedSignal(need.name, topic.name, type_, next(known, own), age, values, gap)


def _fits(need: Need, kind: FieldKind, values: tuple[str, ...]) -> bool:
    """Whether the sentences use the name as a field of that type can be used."""
    if isinstance(need, MissingProposition):
        return kind is FieldKind.FLAG
    if need.words:
        return bool(set(need.words) & set(values)) or kind is FieldKind.TEXT
    return kind is FieldKind.NUMBER


def _assumed_unit(need: Need, signal: DraftedSignal, kind: FieldKind) -> str | None:
    """The unit of the signal; None: the sentences compare it with another kind of quantity."""
    units = need.units if isinstance(need, MissingSignal) else ()
    compared = {parsed.dimension for text in units if (parsed := unit(text))}
    stated = unit(signal.quantity.unit or "1")
    assert stated is not None, "units of fields are units"
    if kind is not FieldKind.NUMBER or compared <= {stated.dimension}:
        return signal.quantity.unit
    if signal.quantity.unit or len(compared) > 1:
        return None
    return base_name(compared.pop())


# Words


def _similarity(name: str, topic: str, field: str) -> Similarity | None:
    path = [*topic.split("/"), *re.split(r"[.\[\]:]+", field.removesuffix("[:]"))]
    if path[-1] in ("data", "value"):  # the topic is the name
        path.pop()
    parts = [_phrase(part) for part in path if part]
    wanted, last = _phrase(name), parts[-1] if parts else ()
    meant = _WANTED & {*_joined(parts)} <= {*wanted}
    if meant and name.lower() == path[-1].lower():
        return Similarity.SAME_NAME
    bare = [*parts[:-1], last[:-1]] if len(last) > 1 and last[-1] in _SUFFIXES else parts
    ends = {_joined(each[start:]) for each in (parts, bare) for start in range(len(each))}
    if meant and _without_verb(wanted) in ends:
        return Similarity.END_OF_PATH
    if meant and _synonyms(wanted) & ends:
        return Similarity.SYNONYM
    inner = {each[-1][start:] for each in (parts, bare) if each for start in range(len(each[-1]))}
    alike = {end for each in (wanted, wanted[-1:]) for end in (each, *_synonyms(each))}
    return Similarity.PARTIAL if alike & (ends | inner) else None


def _joined(parts: Sequence[Phrase]) -> Phrase:
    return tuple(word for part in parts for word in part)


def _phrase(text: str) -> Phrase:
    """`batteryLevel`, `battery_level` and `BATTERY-levels` are `battery level`."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", text)
    return tuple(_singular(word.lower()) for word in re.findall(r"[A-Za-z]+|[0-9]+", spaced))


def _singular(word: str) -> str:
    return word[:-1] if len(word) > 3 and word.endswith("s") and not word.endswith("ss") else word


def _without_verb(phrase: Phrase) -> Phrase:
    return phrase[1:] if len(phrase) > 1 and phrase[0] in ("is", "has") else phrase


def _synonyms(phrase: Phrase) -> set[Phrase]:
    return {each for group in _GROUPS if phrase in group for each in group if each != phrase}


_GROUPS = tuple(frozenset(map(_phrase, group)) for group in _SYNONYMS)


def _unit_of(field: str) -> str:
    words = re.findall(r"[A-Za-z]+", re.split(r"[.]", field)[-1].replace("[:]", ""))
    words = re.findall(r"[A-Za-z][a-z]*|[A-Z]+", " ".join(words))
    return _SUFFIXES.get(words[-1].lower(), "") if len(words) > 1 else ""


# Ranges


def ranges(
    overview: Overview, signals: Iterable[DraftedSignal]
) -> Mapping[str, tuple[float, float]]:
    """The least and the greatest of the finite numbers of each signal in the log, by its path."""
    numbers = {each.path: each for each in signals if not each.values}
    named = {f"x{i}": each for i, each in enumerate(numbers.values())}
    text = render(
        "project/signals.toml.j2", signals=[replace(each, name=n) for n, each in named.items()]
    )
    declarations, _ = read_bindings(Source("bindings.toml", f'[clock]\ntick = "1 s"\n{text}'))
    if declarations is None or not named:
        return {}
    recording = read(overview.recording.name, declarations, list(declarations.signals))
    samples = recording.samples if isinstance(recording, Recording) else {}
    finite = {name: each.values[np.isfinite(each.values)] for name, each in samples.items()}
    return {
        named[name].path: (float(values.min()), float(values.max()))
        for name, values in finite.items()
        if values.size
    }


def _range(ends: tuple[float, float] | None) -> str:
    if ends is None:
        return ""
    least, greatest = ends
    return f"always {least:.4g}" if least == greatest else f"from {least:.4g} to {greatest:.4g}"
