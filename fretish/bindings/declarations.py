"""`bindings.toml` → clock, signals and propositions.

Signals are numbers with units, or words, read from messages. Propositions are truth values: Boolean
expressions over signals, which sentences name.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import field, replace
from enum import StrEnum
from fractions import Fraction
from typing import Any

from fretish.classes.frozen import dataclass
from fretish.clock import Clock
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.documents import RequirementEntry
from fretish.expressions import Calculation, Expression, names, parts
from fretish.reading.caching import cache_by_identity
from fretish.units import Unit


class Reduce(StrEnum):
    """How an array field becomes one number."""

    MIN = "min"
    MAX = "max"
    MEAN = "mean"
    OUTLINE = "outline"
    """The least distance between the robot's outline and the points of a laser scan."""


class Reading(StrEnum):
    """How an element that is not a valid measurement is interpreted."""

    DROP = "drop"
    """The element is ignored."""
    FAR = "far"
    """No object in range: +inf."""
    NEAR = "near"
    """An object too near to measure: -inf, or a clearance of 0."""
    UNKNOWN = "unknown"
    """The whole sample is unknown."""


@dataclass(frozen=True, slots=True)
class InvalidReadings:
    """How each kind of invalid reading is interpreted (REP 117)."""

    nan: Reading = Reading.UNKNOWN
    positive_infinity: Reading = Reading.UNKNOWN
    negative_infinity: Reading = Reading.UNKNOWN
    other: Reading = Reading.UNKNOWN
    """A finite number outside of `valid`."""


REP_117 = InvalidReadings(Reading.DROP, Reading.FAR, Reading.NEAR, Reading.DROP)
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
        """The path as written in the bindings."""
        index = "[:]" if self.each else "" if self.index is None else f"[{self.index}]"
        return ".".join((self.topic, *self.fields)) + index


_PATH = re.compile(
    r"(?P<topic>/?[A-Za-z_~][\w/~-]*)(?P<fields>(?:\.[A-Za-z_]\w*)+)(?:\[(?P<index>:|\d+)\])?"
)


def path(text: str) -> Path | None:
    """Parse `/scan.ranges[:]`, `/odom.twist.twist.linear.x` or `/joints.position[3]`."""
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


class PoseNumber(StrEnum):
    """A number of the pose of one frame in another."""

    X = "x"
    Y = "y"
    Z = "z"
    DISTANCE = "distance"
    """Between the origins of the two frames."""
    YAW = "yaw"
    PITCH = "pitch"
    ROLL = "roll"

    @property
    def is_angle(self) -> bool:
        """Whether it is an angle; the others are lengths."""
        return self in (PoseNumber.YAW, PoseNumber.PITCH, PoseNumber.ROLL)


@dataclass(frozen=True, slots=True)
class FramePose:
    """A number of the pose of `frame` in `reference`, from the transforms that tf2 reads."""

    frame: str
    reference: str
    number: PoseNumber

    def __str__(self) -> str:
        """The number in words: `x of base_link in map`."""
        return f"{self.number} of {self.frame} in {self.reference}"


class GoalChoice(StrEnum):
    """Which goals of an action of ROS 2 count, of several at once."""

    LATEST = "latest"
    """The one that was accepted last."""
    ANY = "any"
    ALL = "all"


@dataclass(frozen=True, slots=True)
class GoalStatus:
    """The status of the latest goal of an action, or whether any or all have one of `statuses`."""

    action: str
    choice: GoalChoice = GoalChoice.LATEST
    statuses: tuple[str, ...] = ()

    def __str__(self) -> str:
        """In words: `status of /dock`, `any goal of /dock is canceled or aborted`."""
        if self.choice is GoalChoice.LATEST:
            return f"status of {self.action}"
        plural = "goals of" if self.choice is GoalChoice.ALL else "goal of"
        verb = "are" if self.choice is GoalChoice.ALL else "is"
        return f"{self.choice} {plural} {self.action} {verb} {' or '.join(self.statuses)}"


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
class Memory:
    """A function of the past of a recorded signal; `monitors/memory.py` defines its values."""

    function: str
    """A name of `fretish.bindings.functions.MEMORY`."""
    source: str
    """The name of the signal."""
    over: int | None
    """The length of the window in nanoseconds; None: only `rate` has none."""
    max_age: int | None
    """The `max_age` of the signal."""
    unit: Unit
    """The unit of the signal, in which `valid` is read."""
    text: str = ""
    """As written."""


@dataclass(frozen=True, slots=True)
class Signal:
    """A number or a word over time, read from one field of one topic.

    `values` are the words of an enumerated signal; a sample is the index of its word. `numbers`
    are the numbers of these words in messages, in the same order; empty: the field holds the words,
    or the message definition has the numbers. `footprint` (corners of the robot's outline) and
    `sensor` (pose of the sensor: x, y in metres, yaw in radians) are in the robot's frame, and only
    for `Reduce.OUTLINE`. `max_age` is in nanoseconds; None: a sample counts until the next one.
    `role` is None if it is not declared. `aggregate` applies to comparisons in sentences; a
    proposition has its own. With `memory`, the samples are values over earlier samples of the
    field; all other fields but unit, role and `aggregate` are those of the signal that it reads.
    """

    name: str
    path: Path
    unit: Unit
    unit_name: str
    type: str | None = None
    reduce: Reduce | None = None
    valid: Expression | None = None
    invalid: InvalidReadings = InvalidReadings()
    max_age: int | None = None
    role: Role | None = None
    aggregate: Aggregate = Aggregate.LAST
    footprint: tuple[tuple[float, float], ...] = ()
    sensor: tuple[float, float, float] = (0.0, 0.0, 0.0)
    values: tuple[str, ...] = ()
    numbers: tuple[int, ...] = ()
    memory: Memory | None = None
    pose: FramePose | None = None
    """What is read from the transforms on the topic of `path`; None: the field of `path`."""
    goals: GoalStatus | None = None
    """What is read from the statuses of goals on the topic of `path`."""
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def origin(self) -> str:
        """What its samples are read from: `/odom.twist.x`, or `x of base_link in map`."""
        return str(self.pose or self.goals or self.path)

    @property
    def scale(self) -> Fraction:
        """Factor to base units; a clearance and a number of a pose are in base units already."""
        is_base = self.reduce is Reduce.OUTLINE or self.pose is not None
        return Fraction(1) if is_base else self.unit.factor

    @property
    def field_unit(self) -> Unit:
        """The unit of the field; that of the samples, except with `memory`."""
        return self.unit if self.memory is None else self.memory.unit


@dataclass(frozen=True, slots=True)
class ComputedSignal:
    """A number over time, computed from the signals' values at the same instant.

    Its value is unknown if one of them is. `aggregate` applies to comparisons in sentences.
    """

    name: str
    value: Expression
    """Over recorded signals, and other computed ones as `Calculation`."""
    unit: Unit
    """The unit of bare numbers in sentences, and of numbers in reports."""
    unit_name: str
    text: str
    """The value as written."""
    is_rounded: bool = False
    """As in `Calculation`."""
    role: Role | None = None
    aggregate: Aggregate = Aggregate.LAST
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def values(self) -> tuple[str, ...]:
        """No words: its values are numbers."""
        return ()

    @property
    def scale(self) -> Fraction:
        """Factor from its unit to base units."""
        return self.unit.factor


MeasuredSignal = Signal | ComputedSignal
"""A signal that sentences may compare."""


class Modality(StrEnum):
    """How an agent relates to a proposition: a modality of AJPF's property language."""

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

    `on_unknown` is its value while its signals are unknown. None: it is unknown, too. A truth value
    is an assumption of every verdict.
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
    """The action that makes it true; empty: `do_` and its name."""
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def signals(self) -> tuple[str, ...]:
        """The names of the recorded signals in the expression, in order of first use."""
        return _named(self.expression)

    @property
    def calculations(self) -> tuple[str, ...]:
        """The names of the computed signals in the expression, and in their values."""
        return _calculations(self.expression)


@cache_by_identity
def _calculations(expression: Expression) -> tuple[str, ...]:
    names = (part.name for part in parts(expression) if isinstance(part, Calculation))
    return tuple(dict.fromkeys(names))


@cache_by_identity
def _named(expression: Expression) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name.id for name in names(expression)))


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of sentences, with the fields of FRET's glossary."""

    name: str
    component: str = ""
    type: str = ""
    """FRET's data type: `boolean`, `integer`, `double`, ..."""
    role: str = ""
    """`input`, `output`, `internal`, `mode`, `function`, or nothing."""
    text: str = ""
    fret: Mapping[str, Any] = field(default_factory=dict)
    """FRET's other fields, which fretc does not use."""
    modality: Modality = Modality.BELIEF
    action: str = ""
    """The action that makes it true; empty: `do_` and its name."""
    value: Expression | None = None
    """The expression that replaces it in every sentence (FRET's assignment), in FRETish."""
    of: Mapping[str, Variable] = field(default_factory=dict)
    """Component → the complete definition that replaces this one in its sentences."""
    span: Span | None = field(default=None, compare=False, repr=False)
    """The span of `value`."""


class InterceptorForm(StrEnum):
    """When an interceptor publishes."""

    TIMER = "timer"
    """At each tick of its own timer, at once on a stop request, and when a command arrives."""
    EVENT = "event"
    """Only when a command arrives: the node of the Safe-ROS paper."""


@dataclass(frozen=True, slots=True)
class Interception:
    """`[interceptor]`: the node between the planner and the wheels.

    Durations are in nanoseconds. `hold` 0: a stop ends with its release. A timeout of 0: silence on
    the channel has no effect. `period` 0: no timer, only with `Form.EVENT`.
    """

    stop: str
    """The topic of stop requests, std_msgs/Bool."""
    command: str
    """The topic of the planner's commands, geometry_msgs/Twist."""
    output: str
    """The topic of the commands to the wheels, geometry_msgs/Twist."""
    scan: str | None = None
    """The topic of the sensor, sensor_msgs/LaserScan."""
    period: int = 0
    hold: int = 0
    stop_timeout: int = 0
    scan_timeout: int = 0
    command_timeout: int = 0
    form: InterceptorForm = InterceptorForm.TIMER
    latching: bool = False
    ros: int = 2
    """1 or 2: the ROS version of the emitted node."""
    span: Span | None = field(default=None, compare=False, repr=False)


class Requests(StrEnum):
    """When the safety function sends its stop request."""

    LEVEL = "level"
    """At every tick."""
    EDGE = "edge"
    """Only when it changes."""


class Planner(StrEnum):
    """When the planner sends commands."""

    ANY = "any"
    """At arbitrary ticks, or never."""
    EVERY_TICK = "every tick"


@dataclass(frozen=True, slots=True)
class LoopAssumptions:
    """`[assume]`: the assumptions of a proof about the closed loop. Times in nanoseconds."""

    stands: str
    """The proposition that is true after the wheels have received zero for `braking`."""
    latency: int
    """The longest time of a stop request from the safety function to the interceptor."""
    braking: int
    lost: int = 0
    """The largest number of consecutive messages of the safety function that may be lost."""
    requests: Requests = Requests.LEVEL
    planner: Planner = Planner.ANY
    heartbeat: int = 0
    """With `Requests.EDGE`: the request is repeated at least this often; 0: never."""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class MapCoordinates:
    """`[map]`: the robot's coordinates, for the maps of a report; no verdict depends on them."""

    x: Signal
    y: Signal


@dataclass(frozen=True, slots=True)
class LabelSource:
    """The source of a label of a run: the metadata or the path of its log."""

    is_path: bool
    text: str
    """Record and key (`build.version`), or a path pattern (`fretish.reading.name_patterns`)."""


@dataclass(frozen=True, slots=True)
class ActionBinding:
    """`[action.NAME]`: what an action of an agent publishes."""

    action: str
    topic: str
    type: str
    """Such as `std_msgs/Bool`."""
    message: str
    """In JSON."""
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class ServiceCall:
    """`[call.NAME]`: which service an action of an agent calls."""

    action: str
    service: str
    type: str
    """Such as `std_srvs/Trigger`."""
    request: str
    """In JSON."""
    limit: int
    """Nanoseconds for the answer."""
    span: Span | None = field(default=None, compare=False, repr=False)


Part = tuple[str, str]
"""`("signal", "vx")`, `("proposition", "near")`, `("clock", "")`, `("map", "")`."""
SHARED = ("interceptor", "assume", "environment", "map", "run", "action", "call", "agent")
"""Tables that belong to no single requirement: `[interceptor]`, `[assume]`,
`[[assume.requirement]]`, `[map]`, `[run.label]`, `[action.NAME]`, `[call.NAME]` and `[agent]`. Only
some commands read them."""


@dataclass(frozen=True, slots=True)
class Default:
    """An assumption about a part, as a phrase: a default, or a choice of the bindings."""

    part: Part
    text: str
    is_explicit: bool | None = None
    """Whether the bindings state the default explicitly; None: it cannot be stated."""


@dataclass(frozen=True, slots=True)
class Declarations:
    """All declarations of the bindings, without the tables that have an error."""

    source: Source
    clock: Clock
    signals: Mapping[str, Signal]
    propositions: Mapping[str, Proposition]
    variables: Mapping[str, Variable] = field(default_factory=dict)
    defaults: tuple[Default, ...] = ()
    interceptor: Interception | None = None
    assumed: LoopAssumptions | None = None
    mistakes: Mapping[Part, tuple[Diagnostic, ...]] = field(default_factory=dict)
    """Declared but unusable signals, propositions and shared tables → their errors. The errors of a
    signal are also errors of the propositions that read it."""
    map: MapCoordinates | None = None
    labels: Mapping[str, tuple[LabelSource, ...]] = field(default_factory=dict)
    """`[run.label]`: label → its sources; the first source with a value counts."""
    fret: tuple[Mapping[str, Any], ...] = ()
    """`[[fret.variable]]`: FRET's records of variables that fretc does not use."""
    environment: tuple[RequirementEntry, ...] = ()
    """`[[assume.requirement]]`: assumptions about the environment, for realizability analysis. No
    verdict on a log depends on them."""
    actions: Mapping[str, ActionBinding] = field(default_factory=dict)
    """`[action.NAME]`: name of an agent's action → what it publishes."""
    calls: Mapping[str, ServiceCall] = field(default_factory=dict)
    """`[call.NAME]`: name of an agent's action → the service that it calls."""
    agent_trace: str | None = None
    """`[agent]`: the topic on which agents report beliefs, goals and actions; no verdict depends on
    it."""
    computed: Mapping[str, ComputedSignal] = field(default_factory=dict)
    """The computed signals; `signals` has the recorded ones."""

    @property
    def measured(self) -> Mapping[str, MeasuredSignal]:
        """All signals that sentences may compare."""
        return {**self.signals, **self.computed} if self.computed else self.signals

    @property
    def signal_names(self) -> tuple[str, ...]:
        """The names of all declared signals, with or without errors."""
        return (*self.measured, *(name for kind, name in self.mistakes if kind == "signal"))

    @property
    def definitions(self) -> Mapping[str, Expression]:
        """Variable → the expression that replaces it."""
        return {
            name: variable.value
            for name, variable in self.variables.items()
            if variable.value is not None
        }

    def for_component(self, component: str) -> Declarations:
        """The declarations for sentences about a component, with the variables of the component."""
        own = {
            name: each.of[component]
            for name, each in self.variables.items()
            if component in each.of
        }
        return replace(self, variables={**self.variables, **own}) if own else self

    def restricted_to(self, propositions: Iterable[str]) -> Declarations:
        """The declarations without the signals that none of these propositions reads."""
        bound = [self.propositions[name] for name in propositions if name in self.propositions]
        read = {signal for proposition in bound for signal in proposition.signals}
        computed = {name for proposition in bound for name in proposition.calculations}
        kept = {("clock", "")}
        kept |= {("signal", name) for name in read}
        kept |= {("proposition", proposition.name) for proposition in bound}
        return replace(
            self,
            signals={name: signal for name, signal in self.signals.items() if name in read},
            defaults=tuple(default for default in self.defaults if default.part in kept),
            computed={name: each for name, each in self.computed.items() if name in computed},
        )

    @property
    def assumptions(self) -> tuple[str, ...]:
        """The implicit defaults, and the declared values of unknown propositions, as phrases."""
        return tuple(default.text for default in self.defaults if not default.is_explicit)


def short_type(name: str) -> str:
    """`sensor_msgs/LaserScan` for ROS 2's `sensor_msgs/msg/LaserScan`."""
    return name.replace("/msg/", "/")
