"""Scenarios: what is wrong in a mission, and which verdicts its log has to give, as small files."""

import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from importlib.resources import files
from math import isfinite
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

VERDICTS = ("satisfied", "violated", "vacuous", "inconclusive", "no data")
"""What a requirement can be in a log, in the order of the fields of `Expectations`."""


class ScenarioError(ValueError):
    """The file is no scenario; the text says why, in lower case and without a full stop."""


@dataclass(frozen=True, slots=True)
class Walker:
    """Somebody who walks into the room when the robot comes near.

    Places are in the room's frame and in metres, `speed` in m/s, `stays` in seconds.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    near: tuple[float, float]
    """The walk begins when the robot is `within` metres of this place."""
    within: float = 1.0
    speed: float = 0.8
    stays: float = 12.0
    """Then the same way back."""
    radius: float = 0.25


@dataclass(frozen=True, slots=True)
class MapDifferences:
    """How the room differs from the map."""

    moved: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Where the centre of a named obstacle really is."""
    walker: Walker | None = None


@dataclass(frozen=True, slots=True)
class Outage:
    """`seconds` from `at` on, in simulated seconds, in which the lidar fails."""

    at: float
    seconds: float
    says: Literal["nothing", "nan"] = "nothing"
    """`nothing`: no message comes; `nan`: messages come, and each beam of them is NaN."""


@dataclass(frozen=True, slots=True)
class Sensor:
    """The lidar and its faults."""

    range_min: float = 0.12
    nearer: Literal["near", "lost"] = "near"
    """What a return below `range_min` is: `near` (-inf, REP 117) or `lost` (+inf)."""
    nan_first: bool = False
    """The first beam of each scan is NaN."""
    outages: tuple[Outage, ...] = ()


@dataclass(frozen=True, slots=True)
class PlannerBehaviour:
    """The autonomous system. Metres, m/s, rad/s, seconds."""

    margin: float = 0.60
    """From path to mapped obstacle, where there is room for it."""
    speed: float = 0.40
    turn: float = 0.20
    slow: float = 0.14
    """Not faster than this while something is nearer than `slow_below`."""
    slow_below: float = 0.60
    silent_below: float = 0.0
    """When something comes nearer than this, no command is sent for `silent` seconds."""
    silent: float = 1.0


@dataclass(frozen=True, slots=True)
class Operator:
    """The person who releases a stopped robot."""

    present: bool = True


@dataclass(frozen=True, slots=True)
class Safety:
    """The Safety Instrumented Function. Times in seconds."""

    on: bool = True
    threshold: float = 0.05
    """Metres from the outline; nearer is too close."""
    late: float = 0.0
    """Every answer comes so much later than it could."""
    dies_at: float | None = None


@dataclass(frozen=True, slots=True)
class Interceptor:
    """What stands between commands and wheels. Times in seconds; 0: never.

    It speaks at once and has a timer, or neither: then it speaks only when a command comes.
    """

    at_once: bool = True
    """It speaks when a stop comes; else only when a command comes."""
    period: float = 0.05
    """And so often by itself."""
    hold: float = 0.2
    """Zero for so long after a stop has come, whatever comes meanwhile; only with a period."""
    command_timeout: float = 0.5
    safety_timeout: float = 1.2
    latching: bool = False
    """The first stop is for ever, whatever is released."""


@dataclass(frozen=True, slots=True)
class Transport:
    """What happens to the messages of a topic on their way."""

    delay: float = 0.0
    """Seconds."""
    loss: float = 0.0
    """The probability that a message is lost."""
    swap: float = 0.0
    """The probability that a message comes only after the next one."""


@dataclass(frozen=True, slots=True)
class AgentFault:
    """What goes wrong with the agent, its connection or its clock. Seconds of simulated time."""

    kind: Literal[
        "killed",
        "frozen",
        "out of memory",
        "endpoint killed",
        "dropped",
        "delayed",
        "duplicated",
        "reordered",
        "clock stepped",
    ]
    at: float
    seconds: float = 0.0
    """How long; 0: for good. What is killed or out of memory stays so; an endpoint is restarted."""
    by: float = 0.0
    """How far the clock of the agent is stepped."""


@dataclass(frozen=True, slots=True)
class Recorder:
    """Faults of the log itself. Seconds of simulated time."""

    jump_at: float | None = None
    jump_by: float = 0.0
    """From `jump_at` on, the clock of the log is so much ahead."""
    keep: float = 1.0
    """The share of the file that is there; the rest is cut off."""


@dataclass(frozen=True, slots=True)
class Expectations:
    """Which requirements come out how; one that is not named may come out in any way."""

    satisfied: tuple[str, ...] = ()
    violated: tuple[str, ...] = ()
    vacuous: tuple[str, ...] = ()
    inconclusive: tuple[str, ...] = ()
    no_data: tuple[str, ...] = ()

    @property
    def verdicts(self) -> dict[str, str]:
        """Requirement → verdict."""
        lists = (self.satisfied, self.violated, self.vacuous, self.inconclusive, self.no_data)
        return {id: verdict for verdict, ids in zip(VERDICTS, lists, strict=True) for id in ids}


@dataclass(frozen=True, slots=True)
class Scenario:
    """A mission with its faults, and what its log has to show."""

    title: str
    text: str = ""
    duration: float = 400.0
    """Simulated seconds after which the mission is given up."""
    store: MapDifferences = field(default_factory=MapDifferences)
    lidar: Sensor = field(default_factory=Sensor)
    planner: PlannerBehaviour = field(default_factory=PlannerBehaviour)
    operator: Operator = field(default_factory=Operator)
    safety: Safety = field(default_factory=Safety)
    interceptor: Interceptor = field(default_factory=Interceptor)
    transport: Mapping[str, Transport] = field(default_factory=lambda: MappingProxyType({}))
    recorder: Recorder = field(default_factory=Recorder)
    agent: AgentFault | None = None
    """Such a mission needs an agent as its safety function."""
    expect: Expectations = field(default_factory=Expectations)
    name: str = "custom"


NOMINAL = "nominal"
"""The scenario in which nothing is wrong."""


def names() -> tuple[str, ...]:
    """The scenarios that come with the simulation, sorted."""
    folder = Path(str(files("simulation"))) / "scenarios"
    return tuple(sorted(path.stem for path in folder.glob("*.toml")))


def without_agent() -> tuple[str, ...]:
    """Those of `names` that need no agent."""
    return tuple(name for name in names() if load(name).agent is None)


def load(name: str) -> Scenario:
    """A scenario by its name, or from a file whose name ends with `.toml`.

    Raises:
        ScenarioError: it is none.
        OSError: the file cannot be read.
    """
    path = Path(name)
    if path.suffix != ".toml":
        if name not in names():
            raise ScenarioError(f"there is no scenario `{name}`; there are {', '.join(names())}")
        path = Path(str(files("simulation"))) / "scenarios" / f"{name}.toml"
    if path.exists() and not path.is_file():
        raise ScenarioError(f"`{name}` is not a regular file")
    if path.is_file() and path.stat().st_size > _MOST:
        raise ScenarioError(f"`{name}` is larger than a scenario is")
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ScenarioError(f"`{name}` is no TOML: {error}") from None
    if "name" in data:
        raise ScenarioError("`name` cannot be set: a scenario is called by its file")
    scenario = _table(Scenario, {**data, "name": path.stem}, "")
    for mistake in _mistakes(scenario):
        raise ScenarioError(mistake)
    return scenario


def _mistakes(scenario: Scenario) -> Iterator[str]:
    """Numbers with which there is no mission, and statements that contradict each other."""
    planner, safety, recorder = scenario.planner, scenario.safety, scenario.recorder
    more = {
        "duration": scenario.duration,
        "planner.speed": planner.speed,
        "planner.turn": planner.turn,
        "safety.threshold": safety.threshold,
        "recorder.keep": recorder.keep,
    }
    shares = {"recorder.keep": recorder.keep}
    for topic, way in scenario.transport.items():
        shares |= {f"transport.{topic}.loss": way.loss, f"transport.{topic}.swap": way.swap}
    walker = scenario.store.walker
    if walker is not None:
        more |= {"store.walker.speed": walker.speed, "store.walker.radius": walker.radius}
        if walker.start == walker.end:
            yield "`store.walker` must not end where it starts"
    yield from (f"`{name}` must be above 0" for name, value in more.items() if value <= 0)
    for name, value in shares.items():
        if not 0 <= value <= 1:
            yield f"`{name}` must be between 0 and 1"
    yield from _interceptor_mistakes(scenario.interceptor)
    fault = scenario.agent
    if fault is not None and bool(fault.by) != (fault.kind == "clock stepped"):
        yield "`agent.by` must be given with `clock stepped`, and only then"
    expectation = scenario.expect
    ids = [id for each in fields(expectation) for id in getattr(expectation, each.name)]
    twice = next((id for id in ids if ids.count(id) > 1), None)
    if twice is not None:
        yield f"`expect` names {twice} twice"


def _interceptor_mistakes(node: Interceptor) -> Iterator[str]:
    times = ("hold", "command_timeout", "safety_timeout")
    if node.at_once != (node.period > 0):
        yield "`interceptor.at_once` must be true with a period above 0, and false without one"
    for name in times:
        value = getattr(node, name)
        if node.period == 0 and value:
            yield f"`interceptor.{name}` must be 0 without a period: there is no timer"
        elif value and value < node.period:
            yield f"`interceptor.{name}` must be 0, or not below the period"


_MOST = 2**20
"""Bytes of a scenario."""
_SIGNED = {"recorder.jump_by", "agent.by"}
"""Numbers that may be negative, beside places: a clock may jump back."""

T = TypeVar("T")


def _table(cls: type[T], data: object, where: str) -> T:
    """A dataclass of a TOML table; every key and every type is checked."""
    if not isinstance(data, dict):
        raise ScenarioError(f"`{where}` must be a table")
    hints, by_name = get_type_hints(cls), {f.name: f for f in fields(cls)}  # type: ignore[arg-type]
    for key in data:
        if key not in by_name:
            subject = f"`{where}`" if where else "a scenario"
            raise ScenarioError(f"{subject} has no `{key}`; it may have {', '.join(by_name)}")
    for key, each in by_name.items():
        if key not in data and each.default is MISSING and each.default_factory is MISSING:
            raise ScenarioError(f"`{f'{where}.{key}' if where else key}` is missing")
    values = {
        key: _value(hints[key], value, f"{where}.{key}".lstrip(".")) for key, value in data.items()
    }
    for key, value in values.items():
        name = f"{where}.{key}".lstrip(".")
        if isinstance(value, float) and value < 0 and name not in _SIGNED:
            raise ScenarioError(f"`{name}` must not be below 0")
    return cls(**values)


def _value(kind: Any, value: object, where: str) -> Any:
    origin, arguments = get_origin(kind), get_args(kind)
    if isinstance(kind, type) and is_dataclass(kind):
        return _table(kind, value, where)
    if type(None) in arguments:
        return _value(next(a for a in arguments if a is not type(None)), value, where)
    if origin is tuple:
        return _sequence(arguments, value, where)
    if origin is not None and isinstance(value, dict):
        return {key: _value(arguments[1], item, f"{where}.{key}") for key, item in value.items()}
    if origin is Literal:
        if value not in arguments:
            raise ScenarioError(f"`{where}` must be {' or '.join(f'`{a}`' for a in arguments)}")
        return value
    if kind is float and isinstance(value, int | float) and not isinstance(value, bool):
        if not isfinite(value):
            raise ScenarioError(f"`{where}` must be finite")
        return float(value)
    if isinstance(kind, type) and kind in (str, bool) and isinstance(value, kind):
        return value
    form = {float: "a number", str: "a text", bool: "true or false"}.get(kind, "a table")
    raise ScenarioError(f"`{where}` must be {form}")


def _sequence(arguments: tuple[Any, ...], value: object, where: str) -> tuple[Any, ...]:
    if not isinstance(value, list):
        raise ScenarioError(f"`{where}` must be a list")
    if arguments[-1] is not Ellipsis and len(value) != len(arguments):
        raise ScenarioError(f"`{where}` must have {len(arguments)} elements")
    return tuple(_value(arguments[0], item, where) for item in value)
