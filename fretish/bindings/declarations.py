"""`bindings.toml` → clock, signals and propositions.

Two layers: signals (numbers with units, or words, read from messages) feed propositions (truth
values, what a sentence names).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from fractions import Fraction
from typing import Any

from fretish.clock import Clock
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.documents import RequirementEntry
from fretish.expressions import Expression, names
from fretish.reading.caching import cache_by_identity
from fretish.units import Unit


class Reduce(StrEnum):
    """How a signal's array becomes one number."""

    MIN = "min"
    MAX = "max"
    MEAN = "mean"
    OUTLINE = "outline"
    """Least distance from the robot's outline to the points of a laser scan."""


class Reading(StrEnum):
    """What an element outside of the valid range means."""

    DROP = "drop"
    """The element says nothing; the others decide."""
    FAR = "far"
    """Nothing is there: +inf."""
    NEAR = "near"
    """Something is there, too near to measure: -inf, or no distance at all."""
    UNKNOWN = "unknown"
    """The whole sample is unknown."""


@dataclass(frozen=True, slots=True)
class Invalid:
    """What readings that are no measurement mean (REP 117)."""

    nan: Reading = Reading.UNKNOWN
    positive_infinity: Reading = Reading.UNKNOWN
    negative_infinity: Reading = Reading.UNKNOWN
    other: Reading = Reading.UNKNOWN
    """A finite number outside of `valid`."""


REP_117 = Invalid(Reading.DROP, Reading.FAR, Reading.NEAR, Reading.DROP)
"""ROS Enhancement Proposal 117: -inf is too near, +inf is nothing in range, NaN is an error."""


@dataclass(frozen=True, slots=True)
class Path:
    """`/scan.ranges[:]`: a topic and a field of its messages."""

    topic: str
    fields: tuple[str, ...]
    index: int | None = None
    each: bool = False
    """True for `[:]`: all elements of the array."""

    def __str__(self) -> str:
        """As it is written in the bindings."""
        index = "[:]" if self.each else "" if self.index is None else f"[{self.index}]"
        return ".".join((self.topic, *self.fields)) + index


_PATH = re.compile(
    r"(?P<topic>/?[A-Za-z_~][\w/~-]*)(?P<fields>(?:\.[A-Za-z_]\w*)+)(?:\[(?P<index>:|\d+)\])?"
)


def path(text: str) -> Path | None:
    """Read `/scan.ranges[:]`, `/odom.twist.twist.linear.x`, `/joints.position[3]`."""
    match = _PATH.fullmatch(text)
    if match is None:
        return None
    index = match["index"]
    return Path(
        match["topic"],
        tuple(match["fields"][1:].split(".")),
        int(index) if index and index != ":" else None,
        index == ":",
    )


class Role(StrEnum):
    """FRET's types of variable."""

    INPUT = "input"
    OUTPUT = "output"
    INTERNAL = "internal"
    MODE = "mode"


class Aggregate(StrEnum):
    """How several samples within one tick combine."""

    ANY = "any"
    ALL = "all"
    LAST = "last"


@dataclass(frozen=True, slots=True)
class Signal:
    """A number, or a word, over time, read from one field of one topic.

    `values` are the words that an enumerated signal may be: its samples are their places, from 0
    on. `numbers` are those by which the messages mean the words, one for each; empty: the field
    holds the words themselves, or the message's definition says which number each one is.
    `footprint` are the corners of the robot's outline and `sensor` is the pose of the sensor
    (x, y in metres, yaw in radians), both in the robot's frame; for `Reduce.OUTLINE` only.
    `max_age` is in nanoseconds; None: a sample counts until the next one. `role` is for people and
    other tools; None: nothing says it. `aggregate` is that of the comparisons of a sentence that
    read it; a proposition has its own.
    """

    name: str
    path: Path
    unit: Unit
    unit_name: str
    type: str | None = None
    reduce: Reduce | None = None
    valid: Expression | None = None
    invalid: Invalid = Invalid()
    max_age: int | None = None
    role: Role | None = None
    aggregate: Aggregate = Aggregate.LAST
    footprint: tuple[tuple[float, float], ...] = ()
    sensor: tuple[float, float, float] = (0.0, 0.0, 0.0)
    values: tuple[str, ...] = ()
    numbers: tuple[int, ...] = ()
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def scale(self) -> Fraction:
        """Factor from samples to base units; a clearance is in base units already."""
        return Fraction(1) if self.reduce is Reduce.OUTLINE else self.unit.factor


class Modality(StrEnum):
    """What an agent has to do with a proposition, in AJPF's words."""

    BELIEF = "B"
    """The agent believes it."""
    GOAL = "G"
    """The agent has it as a goal."""
    INTENTION = "I"
    """The agent has an intention for it."""
    DONE = "D"
    """It is an action, and the last one that the agent did."""
    INTENDED = "ItD"
    """It is an action, and in one of the agent's intentions."""


@dataclass(frozen=True, slots=True)
class Proposition:
    """A truth value over time: an expression over signals.

    `on_unknown` is what the proposition is taken to be where its signals are unknown: None
    (it stays unknown), or a truth value, which is then an assumption of every verdict.
    """

    name: str
    expression: Expression
    text: str = ""
    role: Role = Role.INTERNAL
    kind: str = ""
    aggregate: Aggregate = Aggregate.LAST
    on_unknown: bool | None = None
    modality: Modality = Modality.BELIEF
    action: str = ""
    """What an agent does to make it true; empty: `do_` and its name."""
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def signals(self) -> tuple[str, ...]:
        """The names of the signals that it reads, in the order of their first use."""
        return _named(self.expression)


@cache_by_identity
def _named(expression: Expression) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name.id for name in names(expression)))


@dataclass(frozen=True, slots=True)
class Variable:
    """A name of the sentences, as FRET's glossary has it; bound or not."""

    name: str
    component: str = ""
    type: str = ""
    """FRET's data type: `boolean`, `integer`, `double`, ..."""
    role: str = ""
    """`input`, `output`, `internal`, `mode`, `function`, or nothing."""
    text: str = ""
    fret: Mapping[str, Any] = field(default_factory=dict)
    """What FRET keeps of it and fretc does not use."""
    modality: Modality = Modality.BELIEF
    action: str = ""
    """What an agent does to make it true; empty: `do_` and its name."""
    value: Expression | None = None
    """What it stands for in every sentence: FRET's assignment, in the words of FRETish."""
    of: Mapping[str, Variable] = field(default_factory=dict)
    """What it is in sentences about these components instead, each as a whole."""
    span: Span | None = field(default=None, compare=False, repr=False)
    """Where `value` stands."""


class Form(StrEnum):
    """When an interceptor speaks."""

    TIMER = "timer"
    """With each tick of its own timer, at once on a request, and when a command comes."""
    EVENT = "event"
    """Only when a command comes: the node of the Safe-ROS paper."""


@dataclass(frozen=True, slots=True)
class Interception:
    """`[interceptor]`: the node between the planner and the wheels.

    Durations in nanoseconds. `hold` 0: a stop ends with its release; a timeout of 0: the channel
    is not watched; `period` 0: no timer, in the event form only.
    """

    stop: str
    """The topic of stop requests, std_msgs/Bool."""
    command: str
    """The planner's, geometry_msgs/Twist."""
    output: str
    """The wheels', geometry_msgs/Twist."""
    scan: str | None = None
    """The topic of the sensor, sensor_msgs/LaserScan."""
    period: int = 0
    hold: int = 0
    stop_timeout: int = 0
    scan_timeout: int = 0
    command_timeout: int = 0
    form: Form = Form.TIMER
    latching: bool = False
    ros: int = 2
    """1 or 2: which ROS the emitted node runs on."""
    span: Span | None = field(default=None, compare=False, repr=False)


class Requests(StrEnum):
    """When the safety function sends what it wants."""

    LEVEL = "level"
    """At every tick."""
    EDGE = "edge"
    """Only where it changes."""


class Planner(StrEnum):
    """When commands come."""

    ANY = "any"
    """Now and then, or never."""
    EVERY_TICK = "every tick"


@dataclass(frozen=True, slots=True)
class Assumed:
    """`[assume]`: what a proof about the closed loop takes for granted. Times in nanoseconds."""

    stands: str
    """The proposition that is true once the wheels have had zero for `braking`."""
    latency: int
    """A stop request takes no longer from the safety function to the interceptor."""
    braking: int
    lost: int = 0
    """At most so many messages of the safety function are lost in a row."""
    requests: Requests = Requests.LEVEL
    planner: Planner = Planner.ANY
    heartbeat: int = 0
    """On change only: it is sent again after so long without a message, or earlier; 0: never."""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Map:
    """`[map]`: where the robot is, for the pictures of a report; no verdict depends on it."""

    x: Signal
    y: Signal


@dataclass(frozen=True, slots=True)
class LabelSource:
    """Where a label of a run comes from: the metadata of its log, or the path of it."""

    is_path: bool
    text: str
    """`build.version`: record and key; or a pattern (`fretish.reading.name_patterns`)."""


Part = tuple[str, str]
"""`("signal", "vx")`, `("proposition", "near")`, `("clock", "")`, `("map", "")`."""
SHARED = ("interceptor", "assume", "environment", "map", "run")
"""Tables that belong to no single requirement, and that some commands alone read: `[interceptor]`,
`[assume]`, `[[assume.requirement]]`, `[map]` and `[run.label]`."""


@dataclass(frozen=True, slots=True)
class Default:
    """Something that is assumed of a part, in words: a default, or a choice of the bindings."""

    part: Part
    text: str
    written: bool | None = None
    """Whether a default is written in the bindings all the same; None: it cannot be written."""


@dataclass(frozen=True, slots=True)
class Declarations:
    """Everything that the bindings declare, but for the tables that have a mistake."""

    source: Source
    clock: Clock
    signals: Mapping[str, Signal]
    propositions: Mapping[str, Proposition]
    variables: Mapping[str, Variable] = field(default_factory=dict)
    defaults: tuple[Default, ...] = ()
    interceptor: Interception | None = None
    assumed: Assumed | None = None
    mistakes: Mapping[Part, tuple[Diagnostic, ...]] = field(default_factory=dict)
    """Each signal, proposition and shared table that is declared and cannot be used, and why; the
    mistakes of a signal are those of the propositions that read it, too."""
    map: Map | None = None
    labels: Mapping[str, tuple[LabelSource, ...]] = field(default_factory=dict)
    """`[run.label]`: each label of runs, with its sources; the first that says something counts."""
    fret: tuple[Mapping[str, Any], ...] = ()
    """`[[fret.variable]]`: FRET's records of variables that are none here; nothing reads them."""
    environment: tuple[RequirementEntry, ...] = ()
    """`[[assume.requirement]]`: what the environment is taken to keep, where requirements are
    asked whether they can be kept together; no verdict on a log depends on it."""

    @property
    def signal_names(self) -> tuple[str, ...]:
        """Every signal that is declared, with or without a mistake."""
        return (*self.signals, *(name for kind, name in self.mistakes if kind == "signal"))

    @property
    def definitions(self) -> Mapping[str, Expression]:
        """What variables stand for."""
        return {
            name: variable.value
            for name, variable in self.variables.items()
            if variable.value is not None
        }

    def about(self, component: str) -> Declarations:
        """The same with the variables as they are in sentences about a component."""
        own = {
            name: each.of[component]
            for name, each in self.variables.items()
            if component in each.of
        }
        return replace(self, variables={**self.variables, **own}) if own else self

    def reading(self, propositions: Iterable[str]) -> Declarations:
        """The same without the signals that none of the propositions reads."""
        bound = [self.propositions[name] for name in propositions if name in self.propositions]
        read = {signal for proposition in bound for signal in proposition.signals}
        parts = {("clock", "")}
        parts |= {("signal", name) for name in read}
        parts |= {("proposition", proposition.name) for proposition in bound}
        return replace(
            self,
            signals={name: signal for name, signal in self.signals.items() if name in read},
            defaults=tuple(default for default in self.defaults if default.part in parts),
        )

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Implicit defaults, and the declared values of unknown propositions, in words."""
        return tuple(default.text for default in self.defaults if not default.written)


def short_type(name: str) -> str:
    """`sensor_msgs/LaserScan` for ROS 2's `sensor_msgs/msg/LaserScan`."""
    return name.replace("/msg/", "/")
