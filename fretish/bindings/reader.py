"""Read `bindings.toml`: every field is checked, every mistake has its place."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from math import isfinite
from typing import Any, TypeVar

from fretish import expressions as e
from fretish import units
from fretish.bindings import expressions as binding
from fretish.bindings.declarations import (
    REP_117,
    Aggregate,
    Assumed,
    Declarations,
    Default,
    Invalid,
    LabelSource,
    Map,
    Modality,
    Part,
    Path,
    Proposition,
    Reading,
    Reduce,
    Role,
    Signal,
    Variable,
    path,
)
from fretish.bindings.definitions import circle
from fretish.bindings.fields import Fields
from fretish.bindings.interceptor import Loop
from fretish.bindings.words import words
from fretish.clock import Clock, End, Rounding, TimeSource, in_words
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.parser import parse_value
from fretish.reading import name_patterns
from fretish.reading.limits import within
from fretish.reading.toml_text import Tables, as_key, read

_TABLES = ("clock", "signal", "proposition", "variable", "interceptor", "assume", "map", "run")
_TOPIC = re.compile(r"[A-Za-z_~/]\S*")
"""A topic, and no duration: a duration begins with a digit."""
_MOST_LATENESS = 60 * 10**9
"""Nanoseconds: a verdict that comes later than that is none of a watch."""
_CLOCK = ("time", "tick", "phase", "lateness", "end", "rounding")
_SIGNAL = (
    "path", "type", "reduce", "unit", "valid", "invalid", "max_age", "footprint", "sensor",
    "values", "role", "agg",
)  # fmt: skip
_OF_NUMBERS = ("unit", "valid", "invalid", "reduce", "footprint", "sensor")
"""Fields of a signal that mean nothing beside `values`."""
_MOST_WORDS, _LONGEST_WORD = 1000, 100
_RUN = ("label",)
_LABEL = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,49}", re.ASCII)
MOST_LABELS = 32
_MOST_SOURCES, _LONGEST_SOURCE = 8, 200
_EXACT = 2**53
"""Numbers of words below it are exact in every field."""
_MAP = ("x", "y")
_NOWHERE = Path("", ())
_PROPOSITION = ("text", "expr", "role", "agg", "on_unknown", "kind", "modality", "action")
_INVALID = {
    "nan": "nan",
    "+inf": "positive_infinity",
    "-inf": "negative_infinity",
    "other": "other",
}
_KINDS = ("belief", "command", "physical")
T = TypeVar("T", Signal, Proposition)


def read_bindings(source: Source) -> tuple[Declarations | None, tuple[Diagnostic, ...]]:
    """Read the text of a `bindings.toml`.

    Returns:
        The declarations, and all that there is to say. A mistake in the table of a signal or a
        proposition is among the `mistakes` of the declarations; with any other error there are
        none.
    """
    found = within(len(source.text), source.span(0, 0), lambda: _read(source))
    return (None, (found,)) if isinstance(found, Diagnostic) else found


def _read(source: Source) -> tuple[Declarations | None, tuple[Diagnostic, ...]]:
    tables = read(source.span(), Code.BAD_BINDINGS, "the bindings file")
    if isinstance(tables, Diagnostic):
        return None, (tables,)
    reader = _Reader(tables)
    declarations = reader.declarations()
    return (declarations if reader.is_usable else None), tuple(reader.diagnostics)


class _Reader(Fields):
    """One walk over the tables, which collects every mistake."""

    def __init__(self, tables: Tables) -> None:
        super().__init__(tables)
        self.defaults: list[Default] = []
        self.malformed: set[str] = set()
        self.mistakes: dict[Part, tuple[Diagnostic, ...]] = {}
        self.errors_of_parts = 0
        self.signals: dict[str, Signal] = {}
        """Every signal that has a unit, or words, even where it has other mistakes."""

    @property
    def is_usable(self) -> bool:
        """Whether every error is in the table of a signal or a proposition."""
        return sum(each.is_error for each in self.diagnostics) == self.errors_of_parts

    def declarations(self) -> Declarations:
        data = self.tables.data
        self._check_keys(data, _TABLES, "the bindings")
        signals = self._parts("signal", self._signal)
        propositions = self._parts("proposition", self._proposition)
        variables = {name: self._variable(name, f) for name, f in self._tables("variable").items()}
        components = dict.fromkeys(name for each in variables.values() for name in each.of)
        self._check_definitions(variables, "")
        for component in components:
            own = {name: each.of.get(component, each) for name, each in variables.items()}
            self._check_definitions(own, component)
        loop = Loop(self.tables, self.diagnostics)
        return Declarations(
            self.tables.text.source,
            self._clock(),
            signals,
            propositions,
            variables,
            tuple(each for each in self.defaults if each.part not in self.mistakes),
            loop.interceptor(),
            self._assumed(loop),
            self.mistakes,
            self._map(),
            self._labels(),
            loop.sentences(),
        )

    def _map(self) -> Map | None:
        """`[map]`; None where it is absent, or has mistakes, which become diagnostics."""
        table = self.tables.data.get("map")
        if table is None:
            return None
        if not isinstance(table, dict):
            self._say(
                Code.BAD_BINDING_FIELD,
                "`map` must be a table",
                self.tables.place("map"),
                'write `[map]`, and below it `x = "/odom.pose.pose.position.x"`',
            )
            return None
        self._check_keys(table, _MAP, "[map]", "map")
        x, y = self._coordinate(table, "x"), self._coordinate(table, "y")
        return Map(x, y) if x is not None and y is not None else None

    def _coordinate(self, table: Mapping[str, Any], key: str) -> Signal | None:
        """A coordinate of the map: as the signal of the same path reads it, else in metres."""
        text = table.get(key)
        where = path(text) if isinstance(text, str) else None
        if where is None or where.each:
            self._say(
                Code.BAD_BINDING_FIELD,
                f"`{key}` of the map must be a topic and one number of its messages",
                self.tables.value("map", key) if key in table else self.tables.place("map"),
                f'write `{key} = "/odom.pose.pose.position.{key}"`',
            )
            return None
        same = next((signal for signal in self.signals.values() if signal.path == where), None)
        own = same or Signal("", where, units.METRE, "m")
        if own.unit.dimension != units.METRE.dimension:
            self._say(
                Code.BAD_BINDING_FIELD,
                f"`{key}` of the map must be a length, and `{own.name}` is in "
                f"{own.unit_name or 'plain numbers'}",
                self.tables.value("map", key),
                f'give `[signal.{own.name}]` a length for its unit: `unit = "m"`',
            )
            return None
        return replace(own, name=f"[map] {key}", span=self.tables.value("map", key))

    def _parts(self, kind: str, read: Callable[[str, Mapping[str, Any]], T | None]) -> dict[str, T]:
        """The parts without a mistake; `mistakes` holds those of the others."""
        parts = {}
        for name, table in self._tables(kind).items():
            before = len(self.diagnostics)
            part = read(name, table)
            own = [each for each in self.diagnostics[before:] if each.is_error]
            self.errors_of_parts += len(own)
            self._keep((kind, name), own)
            if (kind, name) not in self.mistakes:
                assert part is not None, name
                parts[name] = part
        return parts

    def _keep(self, part: Part, mistakes: Iterable[Diagnostic]) -> None:
        all_mistakes = tuple(dict.fromkeys((*self.mistakes.get(part, ()), *mistakes)))
        if all_mistakes:
            self.mistakes[part] = all_mistakes

    def _assumed(self, loop: Loop) -> Assumed | None:
        """`[assume]`; None, too, where the proposition that it names has a mistake."""
        assumption = loop.assumed(tuple(self._tables("proposition")))
        broken = assumption is not None and ("proposition", assumption.stands) in self.mistakes
        return None if broken else assumption

    # Labels of runs

    def _labels(self) -> dict[str, tuple[LabelSource, ...]]:
        """`[run.label]`: each label with its sources."""
        table = self.tables.data.get("run", {})
        labels = table.get("label", {}) if isinstance(table, dict) else None
        if not isinstance(labels, dict) or len(labels) > MOST_LABELS:
            message = f"`run` must hold a table `label`, of up to {MOST_LABELS} labels"
            self._bad_label(message, ("run",), f"write `[run.label]` and {_LABEL_FORM}")
            return {}
        self._check_keys(table, _RUN, "[run]", "run")
        return {name: self._label_sources(name, written) for name, written in labels.items()}

    def _label_sources(self, name: str, written: object) -> tuple[LabelSource, ...]:
        at = ("run", "label", name)
        if not is_label(name):
            message = f"`{name}` is no name of a label: a letter, then letters, digits, `_`, `-`"
            self._bad_label(f"{message}, 50 at most", at)
            return ()
        texts = written if isinstance(written, list) else [written]
        sources = [_label_source(name, text) for text in texts]
        wrong = next((each for each in sources if isinstance(each, str)), None)
        if wrong is None and not 0 < len(sources) <= _MOST_SOURCES:
            wrong = f"a label has 1 to {_MOST_SOURCES} sources"
        if wrong is not None:
            self._bad_label(f"`{name}` has no sound source: {wrong}", at, f"write {_LABEL_FORM}")
            return ()
        return tuple(each for each in sources if isinstance(each, LabelSource))

    def _bad_label(self, message: str, at: tuple[str, ...], mend: str | None = None) -> None:
        self._say(Code.BAD_LABEL, message, self.tables.value(*at), mend)

    # Fields

    def _tables(self, kind: str) -> dict[str, Mapping[str, Any]]:
        tables = self.tables.data.get(kind, {})
        if not isinstance(tables, dict) or not all(isinstance(t, dict) for t in tables.values()):
            if kind in self.malformed:
                return {}
            self.malformed.add(kind)
            self._say(
                Code.BAD_BINDING_FIELD,
                f"`{kind}` must hold tables",
                self.tables.place(kind),
                f"write `[{kind}.NAME]`",
            )
            return {}
        return tables

    def _expression(self, table: Mapping[str, Any], at: tuple[str, ...]) -> e.Expression | None:
        text = self._field(table, at, str, 'an expression in quotes: `"min_range < 5 cm"`')
        if text is None:
            return None
        parsed = binding.parse(self._inside(at, text))
        if isinstance(parsed, Diagnostic):
            self.diagnostics.append(parsed)
            return None
        return parsed

    def _inside(self, at: tuple[str, ...], text: str) -> Span:
        """The characters between the quotes, so that mistakes point into the file."""
        value = self.tables.value(*at)
        start = value.text.find(text)
        if start < 0:  # written with escapes: the text stands for itself
            return Source(f"{value.source.name} ({'.'.join(at)})", text).span()
        return value.part(start, start + len(text))

    # Clock

    def _clock(self) -> Clock:
        table = self.tables.data.get("clock")
        if table is None and not self.tables.data.keys() & {"signal", "proposition"}:
            return Clock(None)
        if not isinstance(table, dict):
            self._say(
                Code.BAD_BINDING_FIELD,
                "the bindings declare no clock",
                self.tables.text.part(0, 0),
                'add `[clock]` with `tick = "100 ms"`',
            )
            return Clock(10**9)
        self._check_keys(table, _CLOCK, "[clock]", "clock")
        for name, default in (("time", TimeSource.LOG_TIME), ("end", End.INCONCLUSIVE)):
            if table.get(name, default) == default:
                text = f"clock: {name} is {default}, the default"
                self.defaults.append(Default(("clock", ""), text, name in table))
        period, topic = self._tick(table)
        return Clock(
            period,
            topic,
            self._choice(table, ("clock", "time"), TimeSource, TimeSource.LOG_TIME),
            self._choice(table, ("clock", "end"), End, End.INCONCLUSIVE),
            self._choice(table, ("clock", "rounding"), Rounding, Rounding.EXACT),
            self._phase(table, period),
            self._lateness(table),
        )

    def _tick(self, table: Mapping[str, Any]) -> tuple[int | None, str | None]:
        tick = table.get("tick")
        if isinstance(tick, str) and _TOPIC.fullmatch(tick):
            return None, tick
        period = units.nanoseconds(tick) if isinstance(tick, str) else None
        if not period:
            self._say(
                Code.BAD_BINDING_FIELD,
                "`tick` must be a duration above 0, or a topic",
                self.tables.value("clock", "tick"),
                'write `tick = "100 ms"`, or `tick = "/scan"` for a tick with each message',
            )
            return 10**9, None
        return period, None

    def _phase(self, table: Mapping[str, Any], period: int | None) -> int:
        text = table.get("phase", "0 ns")
        phase = units.nanoseconds(text) if isinstance(text, str) else None
        if period is None and "phase" in table:
            message, mend = "a clock that ticks by message has no `phase`", "take it out"
        elif phase is None or (period is not None and not 0 <= phase < period):
            message = "`phase` must be a duration from 0 on, and less than a tick"
            mend = 'half a tick of 100 ms is `phase = "50 ms"`'
        else:
            return phase
        self._say(Code.BAD_PHASE, message, self.tables.value("clock", "phase"), mend)
        return 0

    def _lateness(self, table: Mapping[str, Any]) -> int | None:
        if "lateness" not in table:
            return None
        text = table["lateness"]
        found = units.nanoseconds(text) if isinstance(text, str) else None
        if found is not None and 0 <= found <= _MOST_LATENESS:
            return found
        self._say(
            Code.BAD_LATENESS,
            f"`lateness` must be a duration from 0 to {in_words(_MOST_LATENESS)}",
            self.tables.value("clock", "lateness"),
            'where messages take less than 50 ms, write `lateness = "50 ms"`',
        )
        return None

    # Signals

    def _signal(self, name: str, table: Mapping[str, Any]) -> Signal | None:
        at = ("signal", name)
        self._check_keys(table, _SIGNAL, f"[signal.{name}]", *at)
        where = self._path(table, (*at, "path"))
        if "values" in table:
            return self._enumerated(name, table, where)
        unit_name = self._field(table, (*at, "unit"), str, "a unit in quotes")
        if unit_name is None and "unit" not in table:
            unit_name = "1"
        unit = units.unit(unit_name) if unit_name is not None else None
        if unit is None and unit_name is not None:
            self.diagnostics.append(units.unknown_unit(unit_name, self.tables.value(*at, "unit")))
        reduce = self._reduce(table, at, where)
        valid = self._valid(table, (*at, "valid"))
        footprint = self._footprint(table, at, reduce)
        type_ = self._field(table, (*at, "type"), str, "a message type in quotes")
        if unit is None or unit_name is None:
            return None
        signal = Signal(
            name,
            where or _NOWHERE,
            unit,
            "" if unit_name == "1" else unit_name,
            type=type_,
            reduce=reduce,
            valid=valid,
            invalid=self._invalid(table, at, type_),
            max_age=self._max_age(table, at),
            footprint=footprint,
            sensor=self._sensor(table, at),
            role=self._role(table, at),
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            span=self.tables.value(*at, "path"),
        )
        self.signals[name] = signal
        return signal if where is not None else None

    def _enumerated(self, name: str, table: Mapping[str, Any], where: Path | None) -> Signal | None:
        """A signal of words."""
        at = ("signal", name)
        for key in _OF_NUMBERS:
            if key in table:
                self._say(
                    Code.BAD_BINDING_FIELD,
                    f"a signal with `values` has no `{key}`: it is a word, and no number",
                    self.tables.place(*at, key),
                    "take it out",
                )
        if where is not None and where.each:
            self._say(
                Code.BAD_BINDING_FIELD,
                "a signal with `values` is one word, and `[:]` is many",
                self.tables.value(*at, "path"),
                "name one element: `[0]`",
            )
        values, numbers = self._words(table["values"], (*at, "values"))
        signal = Signal(
            name,
            where or _NOWHERE,
            units.ONE,
            "",
            type=self._field(table, (*at, "type"), str, "a message type in quotes"),
            max_age=self._max_age(table, at),
            values=values,
            numbers=numbers,
            role=self._role(table, at),
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            span=self.tables.value(*at, "path"),
        )
        if values:
            self.signals[name] = signal
        return signal if where is not None and values else None

    def _role(self, table: Mapping[str, Any], at: tuple[str, ...]) -> Role | None:
        """Of a signal; None where nothing says it."""
        if "role" not in table:
            return None
        return self._choice(table, (*at, "role"), Role, Role.INTERNAL)

    def _words(
        self, written: object, at: tuple[str, ...]
    ) -> tuple[tuple[str, ...], tuple[int, ...]]:
        """The words, and the number of each one; no words where there is a mistake."""
        before = len(self.diagnostics)
        if isinstance(written, dict):
            values, numbers = [*written], [*written.values()]
            self._check_numbers(written, at)
        else:
            values, numbers = written if isinstance(written, list) else [], []
        if not values:
            self._say(
                Code.BAD_BINDING_FIELD,
                "`values` must be a list of words, or a table of their numbers",
                self.tables.value(*at),
                'write `values = ["drive", "docking"]` or `values = { drive = 0, docking = 4 }`',
            )
        if len(values) > _MOST_WORDS:
            self._say(
                Code.BAD_BINDING_FIELD,
                f"`values` has {len(values)} words; {_MOST_WORDS} is the most",
                self.tables.value(*at),
            )
        for place, word in enumerate(values[:_MOST_WORDS]):
            self._check_word(word, values[:place], at)
        if len(self.diagnostics) > before:
            return (), ()
        return tuple(values), tuple(numbers)

    def _check_word(self, word: object, before: list[Any], at: tuple[str, ...]) -> None:
        if (
            not isinstance(word, str)
            or not word.isprintable()
            or '"' in word
            or not 0 < len(word) <= _LONGEST_WORD
        ):
            message, mend = (
                f"a word must be a text of 1 to {_LONGEST_WORD} characters on one line, without "
                "a double quote",
                'write such as `values = ["drive", "docking"]`',
            )
        elif word in before:
            message, mend = f"`{word}` stands twice in `values`", "take one out"
        else:
            return
        self._say(Code.BAD_BINDING_FIELD, message, self._last_in(at, word), mend)

    def _check_numbers(self, written: Mapping[str, Any], at: tuple[str, ...]) -> None:
        words: dict[int, str] = {}
        for word, number in written.items():
            place = self.tables.value(*at, word)
            if not isinstance(number, int) or isinstance(number, bool) or abs(number) >= _EXACT:
                self._say(
                    Code.BAD_BINDING_FIELD,
                    f"the number of `{word}` must be a whole number below 2^53",
                    place,
                    f"write the one that the messages have for it: `{as_key(word)} = 4`",
                )
            elif number in words:
                self._say(
                    Code.BAD_BINDING_FIELD,
                    f"`{words[number]}` and `{word}` are both {number}",
                    place,
                    "give each word a number of its own",
                )
            else:
                words[number] = word

    def _last_in(self, at: tuple[str, ...], word: object) -> Span:
        """Where a text stands in the value of a field, for the last time; else the whole value."""
        value = self.tables.value(*at)
        start = value.text.rfind(word) if isinstance(word, str) and word else -1
        return value.part(start, start + len(str(word))) if start >= 0 else value

    def _valid(self, table: Mapping[str, Any], at: tuple[str, ...]) -> e.Expression | None:
        valid = self._expression(table, at)
        if valid is None:
            return None
        if binding.ticks_back(valid):
            self._say(
                Code.BAD_EXPRESSION,
                "`pre` is of ticks, and a message has none",
                self.tables.value(*at),
                "compare the reading with fields of its message",
            )
            return None
        if any(isinstance(part, e.Word) for part in e.parts(valid)):
            self._say(
                Code.BAD_EXPRESSION,
                "`valid` is about numbers, and this compares a word",
                self.tables.value(*at),
                "a signal of words has `values`, and no `valid`",
            )
            return None
        if binding.is_truth(valid):
            return valid
        self._say(
            Code.BAD_EXPRESSION,
            "`valid` must be true or false, and this is a number",
            self.tables.value(*at),
            "compare the reading: `range_min <= x and x <= range_max`",
        )
        return None

    def _path(self, table: Mapping[str, Any], at: tuple[str, ...]) -> Path | None:
        text = table.get("path")
        read = path(text) if isinstance(text, str) else None
        if read is None:
            self._say(
                Code.BAD_BINDING_FIELD,
                "`path` must name a topic and a field" if text else "the signal has no `path`",
                self.tables.value(*at),
                'write `path = "/scan.ranges[:]"` or `path = "/odom.twist.twist.linear.x"`',
            )
        return read

    def _reduce(
        self, table: Mapping[str, Any], at: tuple[str, ...], where: Path | None
    ) -> Reduce | None:
        each = where is not None and where.each
        if "reduce" in table and not each and where is not None:
            self._say(
                Code.BAD_BINDING_FIELD,
                "`reduce` needs a path that ends with `[:]`",
                self.tables.value(*at, "reduce"),
            )
        if "reduce" not in table and each:
            self._say(
                Code.BAD_BINDING_FIELD,
                "a path that ends with `[:]` needs `reduce`",
                self.tables.value(*at, "path"),
                'add `reduce = "min"`',
            )
        if "reduce" not in table:
            return None
        return self._choice(table, (*at, "reduce"), Reduce, Reduce.MIN)

    def _invalid(self, table: Mapping[str, Any], at: tuple[str, ...], type_: str | None) -> Invalid:
        scan = type_ is not None and type_.endswith("/LaserScan")
        default = REP_117 if scan else Invalid()
        fields = self._field(table, (*at, "invalid"), dict, "a table of readings")
        words = "as REP 117 says" if scan else "unknown"
        text = f"signal {at[1]}: readings that are no measurement are {words}"
        if fields is None:
            self.defaults.append(Default((at[0], at[1]), text))
            return default
        self._check_keys(fields, (*_INVALID, "empty"), "`invalid`", *at, "invalid")
        place = (*at, "invalid")
        if fields.get("empty", "unknown") != "unknown":
            self._say(
                Code.BAD_BINDING_FIELD,
                "`empty` can only be `unknown`: no reading is no evidence",
                self.tables.value(*place, "empty"),
            )
        values = {
            attribute: self._choice(fields, (*place, key), Reading, getattr(default, attribute))
            for key, attribute in _INVALID.items()
        }
        invalid = Invalid(**values)
        if invalid == default:
            self.defaults.append(Default((at[0], at[1]), text, explicit=True))
        return invalid

    def _max_age(self, table: Mapping[str, Any], at: tuple[str, ...]) -> int | None:
        text = self._field(table, (*at, "max_age"), str, 'a duration: `"300 ms"`')
        if "max_age" not in table:
            old = f"signal {at[1]}: a sample never grows too old (no max_age)"
            self.defaults.append(Default((at[0], at[1]), old))
        age = units.nanoseconds(text) if text is not None else None
        if text is not None and not age:
            self._say(
                Code.BAD_BINDING_FIELD,
                "`max_age` must be a duration above 0",
                self.tables.value(*at, "max_age"),
                'write `max_age = "300 ms"`',
            )
        return age

    def _footprint(
        self, table: Mapping[str, Any], at: tuple[str, ...], reduce: Reduce | None
    ) -> tuple[tuple[float, float], ...]:
        corners = table.get("footprint", [])
        good = isinstance(corners, list) and all(_is_numbers(c, 2) for c in corners)
        if reduce is Reduce.OUTLINE and (not good or len(corners) < 3):
            self._say(
                Code.BAD_BINDING_FIELD,
                '`reduce = "outline"` needs `footprint`: three corners or more, in metres',
                self.tables.value(*at, "footprint"),
                "write `footprint = [[0.3, 0.3], [-0.3, 0.3], [-0.3, -0.3], [0.3, -0.3]]`",
            )
            return ()
        return tuple((float(x), float(y)) for x, y in corners) if good else ()

    def _sensor(self, table: Mapping[str, Any], at: tuple[str, ...]) -> tuple[float, float, float]:
        pose = table.get("sensor", [0.0, 0.0, 0.0])
        if not _is_numbers(pose, 3):
            self._say(
                Code.BAD_BINDING_FIELD,
                "`sensor` must be the sensor's pose: x and y in metres, yaw in radians",
                self.tables.value(*at, "sensor"),
                "write `sensor = [0.0, 0.0, 0.0]`",
            )
            return 0.0, 0.0, 0.0
        return float(pose[0]), float(pose[1]), float(pose[2])

    # Propositions

    def _proposition(self, name: str, table: Mapping[str, Any]) -> Proposition | None:
        at = ("proposition", name)
        self._check_keys(table, _PROPOSITION, f"[proposition.{name}]", *at)
        if "expr" not in table:
            self._say(
                Code.BAD_BINDING_FIELD,
                f"the proposition `{name}` has no `expr`",
                self.tables.place(*at),
                'add `expr = "min_range < 5 cm"`',
            )
        written = self._expression(table, (*at, "expr"))
        if written is None:
            return None
        names = dict.fromkeys(name.id for name in e.names(written))
        self._keep(at, [m for name in names for m in self.mistakes.get(("signal", name), ())])
        expression = self._truth(written, at)
        if expression is None:
            return None
        if not self._ticks_fit(table, expression, at):
            return None
        if table.get("agg", Aggregate.LAST) == Aggregate.LAST:
            last = f"proposition {name}: the last sample of a tick counts"
            self.defaults.append(Default(("proposition", name), last, "agg" in table))
        return Proposition(
            name,
            expression,
            text=self._field(table, (*at, "text"), str, "a text in quotes") or "",
            role=self._choice(table, (*at, "role"), Role, Role.INTERNAL),
            kind=self._kind(table, at),
            aggregate=self._choice(table, (*at, "agg"), Aggregate, Aggregate.LAST),
            on_unknown=self._on_unknown(table, at),
            modality=self._modality(table, at),
            action=self._action(table, at),
            span=self.tables.value(*at, "expr"),
        )

    def _truth(self, written: e.Expression, at: tuple[str, ...]) -> e.Expression | None:
        """The expression with its words; None where it cannot be a proposition."""
        place = self.tables.value(*at, "expr")
        unknown = self._tables("signal").keys() - self.signals.keys()
        if any(name.id in unknown for name in e.names(written)):
            return None  # the signal has a diagnostic of its own
        expression = words(written, self.signals, place)
        if isinstance(expression, Diagnostic):
            self.diagnostics.append(expression)
            return None
        kinds = {name: signal.unit.dimension for name, signal in self.signals.items()}
        if isinstance(expression, e.Name) and expression.id in kinds:
            return expression
        kind = binding.dimension(expression, kinds, place)
        if isinstance(kind, Diagnostic):
            self.diagnostics.append(kind)
        elif kind is not None:
            self._say(
                Code.BAD_EXPRESSION,
                "a proposition must be true or false, and this is a number",
                place,
                "compare it: `min_range < 5 cm`",
            )
        else:
            known = {name.id: self.signals.get(name.id) for name in e.names(expression)}
            percents = {n for n, each in known.items() if each and each.unit == units.PERCENT}
            self.diagnostics.extend(binding.plain_percents(expression, percents, place))
        return expression if kind is None else None

    def _ticks_fit(
        self, table: Mapping[str, Any], expression: e.Expression, at: tuple[str, ...]
    ) -> bool:
        """Whether what looks back by ticks stands where there are ticks."""
        if not binding.ticks_back(expression):
            return True
        place = self.tables.value(*at, "expr")
        if table.get("agg", Aggregate.LAST) != Aggregate.LAST:
            self._say(
                Code.BAD_BINDING_FIELD,
                "`pre` sees what is in force at each tick: `agg` can only be `last`",
                self.tables.value(*at, "agg"),
                "take it out",
            )
        elif any(
            isinstance(part, e.Persistence) and binding.ticks_back(part)
            for part in e.parts(expression)
        ):
            self._say(
                Code.BAD_EXPRESSION,
                "`pre` counts ticks, and `for` the time between them",
                place,
                "let the requirement say for how long: `for 2 ticks satisfy ...`",
            )
        else:
            return True
        return False

    # Variables that are not bound

    def _variable(self, name: str, table: Mapping[str, Any]) -> Variable:
        at = ("variable", name)
        self._check_keys(table, _VARIABLE, f"[variable.{name}]", *at)
        of = self._field(table, (*at, "of"), dict, "tables of components") or {}
        if not all(isinstance(each, dict) for each in of.values()):
            self._say(
                Code.BAD_BINDING_FIELD,
                "`of` must hold tables",
                self.tables.value(*at, "of"),
                f"write `[variable.{as_key(name)}.of.COMPONENT]`",
            )
            of = {}
        whole = self._fields_of_variable(name, table, at)
        own = {
            component: replace(
                self._fields_of_variable(name, each, (*at, "of", component)),
                component=component,
                modality=whole.modality,
                action=whole.action,
            )
            for component, each in of.items()
        }
        return replace(whole, of=own)

    def _fields_of_variable(
        self, name: str, table: Mapping[str, Any], at: tuple[str, ...]
    ) -> Variable:
        if len(at) > 2:
            self._check_keys(table, _OF_COMPONENT, f"[{'.'.join(at)}]", *at)
        texts = {
            key: self._field(table, (*at, key), str, "a text in quotes") or ""
            for key in ("component", "type", "role", "text")
        }
        fret = self._field(table, (*at, "fret"), dict, "a table of texts") or {}
        value, place = self._value(table, (*at, "value"))
        if value is not None and texts["role"] not in ("", Role.INTERNAL, Role.MODE):
            self._say(
                Code.BAD_BINDING_FIELD,
                f"`{name}` stands for something: its role cannot be `{texts['role']}`",
                self.tables.value(*at, "role"),
                "it may be internal or mode",
            )
        return Variable(
            name,
            component=texts["component"],
            type=texts["type"],
            role=texts["role"],
            text=texts["text"],
            fret=fret,
            modality=self._modality(table, at),
            action=self._action(table, at),
            value=value,
            span=place,
        )

    def _value(
        self, table: Mapping[str, Any], at: tuple[str, ...]
    ) -> tuple[e.Expression | None, Span | None]:
        """What a variable stands for, and where that is written."""
        text = self._field(table, at, str, 'an expression in quotes: `"1.5 m/s"`')
        if text is None:
            return None, None
        place = self._inside(at, text)
        value = parse_value(place)
        if isinstance(value, Diagnostic):
            self.diagnostics.append(value)
            return None, place
        return value, place

    def _check_definitions(self, variables: Mapping[str, Variable], component: str) -> None:
        """F342 and F343: what a name stands for is said once, and not by way of itself.

        Args:
            variables: as they are for a component.
            component: empty: for those that no variable names.
        """
        values = {name: v.value for name, v in variables.items() if v.value is not None}
        for name in values:
            kinds = [kind for kind in ("signal", "proposition") if name in self._tables(kind)]
            other = f"by `[{kinds[0]}.{name}]`" if kinds else "by FRETish, as the first tick"
            if kinds or name == "FTP":
                self._say(
                    Code.DOUBLE_DEFINITION,
                    f"`{name}` is defined twice: by its `value`, and {other}",
                    self._of_value(name, component),
                    "take one of them out",
                )
        chain = circle(values)
        if chain:
            self._say(
                Code.DEFINITION_CIRCLE,
                f"the values of variables lead in a circle: {' -> '.join(chain[:_MOST_NAMES])}"
                f"{' ...' if len(chain) > _MOST_NAMES else ''}",
                self._of_value(chain[0], component),
                "let one of them stand for numbers and signals alone",
            )

    def _of_value(self, name: str, component: str) -> Span:
        """Where it is written what a variable stands for."""
        own = component in self._tables("variable")[name].get("of", {})
        return self.tables.value("variable", name, *(("of", component) if own else ()), "value")

    def _modality(self, table: Mapping[str, Any], at: tuple[str, ...]) -> Modality:
        if table.get("modality") != "P":
            return self._choice(table, (*at, "modality"), Modality, Modality.BELIEF)
        self._say(
            Code.BAD_MODALITY,
            f"`{at[1]}` cannot be a percept (`P`): AJPF takes a percept for absent once the agent "
            "has read it",
            self.tables.value(*at, "modality"),
            'say what the agent believes: `modality = "B"`',
        )
        return Modality.BELIEF

    def _action(self, table: Mapping[str, Any], at: tuple[str, ...]) -> str:
        action = table.get("action", "")
        if action == "" or (isinstance(action, str) and _ACTION.fullmatch(action)):
            return str(action)
        self._say(
            Code.BAD_BINDING_FIELD,
            "`action` must be a name of Gwendolen: a small letter, then letters, digits and `_`",
            self.tables.value(*at, "action"),
            'write `action = "stop_moving"`',
        )
        return ""

    def _kind(self, table: Mapping[str, Any], at: tuple[str, ...]) -> str:
        kind = table.get("kind", "")
        if kind not in (*_KINDS, ""):
            self._say(
                Code.BAD_BINDING_FIELD,
                f"`kind` cannot be `{kind}`",
                self.tables.value(*at, "kind"),
                f"it may be {', '.join(_KINDS)}",
            )
        return str(kind)

    def _on_unknown(self, table: Mapping[str, Any], at: tuple[str, ...]) -> bool | None:
        value = table.get("on_unknown", "unknown")
        if value == "unknown":
            return None
        if isinstance(value, bool):
            text = (
                f"proposition {at[1]}: where its signals are unknown it counts as "
                f"{str(value).lower()}, as the bindings declare"
            )
            self.defaults.append(Default((at[0], at[1]), text))
            return value
        self._say(
            Code.BAD_BINDING_FIELD,
            "`on_unknown` must be true, false or `unknown`",
            self.tables.value(*at, "on_unknown"),
        )
        return None


_LABEL_FORM = '`version = "metadata:build.version"` or `scenario = "path:{scenario}-*.mcap"`'


def is_label(name: str) -> bool:
    """Whether it can be the name of a label."""
    return _LABEL.fullmatch(name) is not None


def _label_source(name: str, written: object) -> LabelSource | str:
    """The source of a label, or what is wrong with it."""
    kind, _, text = written.partition(":") if isinstance(written, str) else ("", "", "")
    if kind not in ("metadata", "path") or not 0 < len(text) <= _LONGEST_SOURCE:
        return "it is neither `metadata:RECORD.KEY` nor `path:PATTERN`"
    if kind == "metadata":
        return LabelSource(False, text) if "." in text else "a record has keys: `RECORD.KEY`"
    found = name_patterns.names(text)
    if isinstance(found, str):
        return found
    return LabelSource(True, text) if name in found else f"`{{{name}}}` is not in the pattern"


_VARIABLE = ("component", "type", "role", "text", "value", "fret", "of", "modality", "action")
_OF_COMPONENT = ("type", "role", "text", "value", "fret")
_MOST_NAMES = 12
"""Of a circle that a message shows."""
_ACTION = re.compile(r"[a-z][A-Za-z0-9_]*")


def _is_numbers(value: object, count: int) -> bool:
    return (
        isinstance(value, list)
        and len(value) == count
        and all(isinstance(n, int | float) and isfinite(n) for n in value)
    )
