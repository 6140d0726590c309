"""Show that the text of an interceptor keeps its contracts, by walking through all it can do.

The core is executed in every state that it can come to, with every kind of message, breadth first.
Beside it goes what has been heard, written down here independently of the core: what a contract
demands is read off that, never off the core's own state. Commands are opaque (`compiler.opaque`),
so a result holds for all velocities. A shortest run is told where a contract is broken.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from compiler.files import sha256
from compiler.opaque import InspectedError, Opaque, is_opaque
from compiler.purity import core
from compiler.verification import (
    Counterexample,
    Evidence,
    Layer,
    NotChecked,
    Proved,
    Result,
    Trace,
)
from monitors.interceptor import Options

MOST_STATES = 200_000
"""Some ten seconds and half a gigabyte."""

STOP, RELEASE, COMMAND, SCAN, RING = (
    "a stop is requested",
    "no stop is requested",
    "a command comes",
    "a scan comes",
    "the timer rings",
)
"""What can be heard, as the actions of a trace begin."""

_NEEDED = (
    "Velocity Options State StopHeard CommandHeard ScanHeard TimerRang initial step ZERO".split()
)


class Seen(NamedTuple):
    """What has been heard up to now; durations in ticks."""

    requested: bool
    """By the last message of the safety function."""
    ever: bool
    owed: int
    """Ticks for which zero must still be said after the last request."""
    stop: int
    """Ticks since the safety function was heard, no more than the timeout; the others likewise."""
    scan: int
    command: int
    last: Any
    """The last command; None: there was none."""


class Moment(NamedTuple):
    """One step, as contracts look at it."""

    before: Seen
    heard: str
    after: Seen
    said: str
    """`nothing`, `zero`, `last` (the last command, which may just have come) or `other`."""
    state: Any
    """The core's, after the step."""


@dataclass(frozen=True, slots=True)
class Contract:
    """A claim about every step, or about the first state."""

    claim: str
    broken: Callable[[Moment], bool]


def contracts(
    text: str, options: Options, requirement: str = "interceptor", most: int = MOST_STATES
) -> tuple[Evidence, ...]:
    """Every contract of an interceptor with the options, each proved, refuted or not checked.

    Args:
        text: what `--emit interceptor` wrote; the core is executed once it is known to be pure.
        options: those that the bindings declare.
        requirement: whom the evidence is for.
        most: states; with more, nothing is known.
    """
    claims = tuple(_contracts(options))
    found = _explored(text, options, claims, most)
    return tuple(
        Evidence(
            requirement,
            Layer.INTERCEPTOR,
            contract.claim,
            result,
            "every state and message of the core, explored",
            tuple(_assumptions(options)),
            {"interceptor.py": sha256(text)},
        )
        for contract, result in zip(claims, found, strict=True)
    )


def _assumptions(options: Options) -> Iterator[str]:
    yield "the ROS node hands every message to the core, one at a time, and publishes what it says"
    if options.event_driven:
        yield "no silence is noticed: form = event in [interceptor]"
        return
    yield "the timer rings at every period in [interceptor]"
    for name, channel in (("stop", "the safety function"), ("scan", "the sensor")):
        if not getattr(options, f"{name}_timeout"):
            yield f"{channel} is never silent for long: no {name}_timeout in [interceptor]"


# What is demanded -----------------------------------------------------------------------------


def _contracts(options: Options) -> Iterator[Contract]:
    """Those that the options call for."""
    yield from _of_the_paper(options)
    yield from _of_a_stop(options)
    for name, channel in _CHANNELS:
        timeout = getattr(options, f"{name}_timeout")
        if timeout:
            yield Contract(
                f"{timeout} ticks of the timer after the last message of {channel}, and until the "
                "next one, nothing but zero is published",
                _silence(name, timeout),
            )
    yield from _of_speech(options)


_CHANNELS = (
    ("stop", "the safety function"),
    ("scan", "the sensor"),
    ("command", "the planner"),
)


def _of_the_paper(options: Options) -> Iterator[Contract]:
    """The three proof obligations of the paper."""
    yield Contract(
        "at first no stop is in force",
        lambda m: m.heard == "" and bool(m.state.stop),
    )
    latch = ", and no message clears it" if options.latching else " or clears it"
    yield Contract(
        f"each message of the safety function sets the stop{latch}",
        lambda m: (
            m.heard in (STOP, RELEASE)
            and m.state.stop != (m.after.requested or (options.latching and m.after.ever))
        ),
    )
    yield Contract(
        "each command is passed on unchanged, or is zero where the robot must stand",
        lambda m: (
            m.heard == COMMAND and m.said != ("zero" if _stands(m.after, options) else "last")
        ),
    )


def _of_a_stop(options: Options) -> Iterator[Contract]:
    yield Contract(
        "while a stop is requested nothing but zero is published",
        lambda m: m.after.requested and m.said not in ("nothing", "zero"),
    )
    if options.latching:
        yield Contract(
            "after the first request nothing but zero is ever published",
            lambda m: m.after.ever and m.said not in ("nothing", "zero"),
        )
    if not options.event_driven:
        yield Contract(
            "zero is published at once on a request",
            lambda m: m.heard == STOP and m.said != "zero",
        )
    if options.hold:
        yield Contract(
            f"after a request nothing but zero is published up to tick {options.hold} of the "
            "timer, and zero at each of these ticks",
            _short_hold,
        )


def _short_hold(m: Moment) -> bool:
    if m.heard == RING:
        return m.before.owed > 0 and m.said != "zero"
    return m.after.owed > 0 and m.said not in ("nothing", "zero")


def _silence(name: str, timeout: int) -> Callable[[Moment], bool]:
    return lambda m: getattr(m.after, name) >= timeout and m.said not in ("nothing", "zero")


def _of_speech(options: Options) -> Iterator[Contract]:
    if options.event_driven:
        yield Contract(
            "something is published when a command comes, and at no other time",
            lambda m: m.heard != "" and (m.said == "nothing") == (m.heard == COMMAND),
        )
    else:
        yield Contract(
            "at each tick of the timer something is published",
            lambda m: m.heard == RING and m.said == "nothing",
        )
        yield Contract(
            "at a tick without a reason to stand the last command is published",
            lambda m: (
                m.heard == RING
                and not _stands(m.after._replace(owed=m.before.owed), options)
                and m.said != ("zero" if m.after.last is None else "last")
            ),
        )
    yield Contract(
        "every number that the core keeps stays between 0 and its bound",
        lambda m: not _in_range(m.state, options),
    )


def _stands(seen: Seen, options: Options) -> bool:
    """A reason for zero: it says nothing of how the core knows."""
    return (
        seen.requested
        or seen.owed > 0
        or (options.latching and seen.ever)
        or any(
            getattr(seen, name) >= getattr(options, f"{name}_timeout") > 0 for name, _ in _CHANNELS
        )
    )


def _in_range(state: Any, options: Options) -> bool:
    bounds = {"held": options.hold}
    bounds |= {f"{name}_age": getattr(options, f"{name}_timeout") for name, _ in _CHANNELS}
    return all(0 <= getattr(state, name) <= bound for name, bound in bounds.items())


def _first(options: Options) -> Seen:
    """Nothing was heard: what is watched is silent."""
    return Seen(
        requested=False,
        ever=False,
        owed=0,
        stop=options.stop_timeout,
        scan=options.scan_timeout,
        command=options.command_timeout,
        last=None,
    )


def _seen(seen: Seen, heard: str, command: object, options: Options) -> Seen:
    match heard:
        case "a stop is requested":
            return seen._replace(requested=True, ever=True, owed=options.hold, stop=0)
        case "no stop is requested":
            return seen._replace(requested=False, stop=0)
        case "a command comes":
            return seen._replace(command=0, last=command)
        case "a scan comes":
            return seen._replace(scan=0)
    if options.event_driven:
        return seen
    return seen._replace(
        owed=max(seen.owed - 1, 0),
        stop=min(seen.stop + 1, options.stop_timeout),
        scan=min(seen.scan + 1, options.scan_timeout),
        command=min(seen.command + 1, options.command_timeout),
    )


# Exploration ----------------------------------------------------------------------------------


class _StrangeError(Exception):
    """Nothing can be said, and why."""


Key = tuple[object, ...]


@dataclass(slots=True)
class _Search:
    """The states that were found, and on which way."""

    came: dict[Key, tuple[Key, str, str, Seen] | None]
    """From where, by what, what was said, and what is heard by then; None: the first."""
    broken: dict[int, tuple[Key, str, str, Seen] | None]
    """Contract → the step that breaks it; None: the first state does."""
    steps: int = 0


def _explored(text: str, options: Options, claims: tuple[Contract, ...], most: int) -> list[Result]:
    """The result of each contract."""

    def unknown(reason: str) -> list[Result]:
        return [NotChecked(reason) for _ in claims]

    if options.event_driven and any(
        (options.hold, options.stop_timeout, options.scan_timeout, options.command_timeout)
    ):
        return unknown("an interceptor without a timer cannot measure the times that are declared")
    read = core(text)
    if isinstance(read, str):
        return unknown(read)
    try:
        search = _Walk(read.module, options, claims, most).search()
    except _StrangeError as error:
        return unknown(str(error))
    looked = f"{len(search.came)} states, {search.steps} steps"
    return [
        Counterexample(f"a run of {len(run)} steps breaks it", _trace(run, options))
        if (run := _run(search, i)) is not None
        else Proved(looked)
        for i in range(len(claims))
    ]


class _Walk:
    """The breadth-first walk through the product of the core and what was heard."""

    def __init__(
        self, module: Any, options: Options, claims: tuple[Contract, ...], most: int
    ) -> None:
        missing = next((name for name in _NEEDED if not hasattr(module, name)), None)
        if missing is not None:
            raise _StrangeError(f"its core has no `{missing}`")
        self.module, self.declared, self.claims, self.most = module, options, claims, most
        self.fields = tuple(getattr(module.State, "__dataclass_fields__", ()))
        try:
            self.options = module.Options(**asdict(options))
        except TypeError as error:
            raise _StrangeError(f"its options are others: {error}") from None
        own = getattr(module, "OPTIONS", self.options)
        if own != self.options:
            raise _StrangeError("its options are not those that are declared")
        self.tokens = tuple(Opaque() for _ in range(2 * len(self.fields) + 4))

    def search(self) -> _Search:
        first = _first(self.declared)
        state = self._called(lambda: self.module.initial(self.options))
        key, state, first = self._normal(state, first)
        found = _Search({key: None}, {})
        for i in self._wrong(Moment(first, "", first, "nothing", state)):
            found.broken[i] = None
        queue = deque([(key, state, first)])
        while queue:
            if len(found.came) > self.most:
                raise _StrangeError(
                    f"it has more than {self.most} states: make the period in [interceptor] longer"
                )
            self._from(*queue.popleft(), found, queue)
        return found

    def _from(
        self, key: Key, state: Any, seen: Seen, found: _Search, queue: deque[tuple[Key, Any, Seen]]
    ) -> None:
        kept = {id(seen.last), *(id(getattr(state, name)) for name in self.fields)}
        command = next(token for token in self.tokens if id(token) not in kept)
        for heard, message in self._messages(command):
            found.steps += 1
            after, said = self._step(state, message)
            now = _seen(seen, heard, command, self.declared)
            told = self._told(said, now)
            step = (key, heard, told, now)
            for i in self._wrong(Moment(seen, heard, now, told, after)):
                found.broken.setdefault(i, step)
            target, after, now = self._normal(after, now)
            if target not in found.came:
                found.came[target] = step
                queue.append((target, after, now))

    def _messages(self, command: object) -> Iterator[tuple[str, Any]]:
        module = self.module
        yield STOP, self._called(lambda: module.StopHeard(True))
        yield RELEASE, self._called(lambda: module.StopHeard(False))
        yield COMMAND, self._called(lambda: module.CommandHeard(command))
        yield SCAN, self._called(lambda: module.ScanHeard())
        yield RING, self._called(lambda: module.TimerRang())

    def _step(self, state: Any, message: Any) -> tuple[Any, Any]:
        given = self._called(lambda: self.module.step(state, message, self.options))
        if not isinstance(given, tuple) or len(given) != 2:
            raise _StrangeError("a step gives no state and command")
        return given[0], given[1]

    def _called(self, call: Callable[[], Any]) -> Any:
        try:
            return call()
        except InspectedError:
            raise _StrangeError(
                "it looks into a command: what is shown with one would not hold for all"
            ) from None
        except Exception as error:
            raise _StrangeError(f"a step fails: {type(error).__name__}: {error}") from None

    def _wrong(self, moment: Moment) -> Iterator[int]:
        for i, contract in enumerate(self.claims):
            try:
                if contract.broken(moment):
                    yield i
            except (AttributeError, TypeError) as error:
                raise _StrangeError(f"its state is another one: {error}") from None

    def _told(self, said: Any, now: Seen) -> str:
        if said is None:
            return "nothing"
        if is_opaque(said):
            return "last" if said is now.last else "other"
        return "zero" if self._is_zero(said) else "other"

    def _is_zero(self, value: Any) -> bool:
        return type(value) is self.module.Velocity and not any(
            is_opaque(part) or part != 0 for part in value
        )

    def _normal(self, state: Any, seen: Seen) -> tuple[Key, Any, Seen]:
        """One of all states that differ only in which commands they hold, and its key."""
        if type(state) is not self.module.State:
            raise _StrangeError("a step gives no `State`")
        names: dict[int, int] = {}

        def number(value: object) -> int:
            return names.setdefault(id(value), len(names))

        key: list[object] = []
        values: dict[str, Any] = {}
        for name in self.fields:
            value = getattr(state, name)
            if is_opaque(value):
                values[name] = self.tokens[number(value)]
                key.append(("command", number(value)))
            elif value is None or isinstance(value, int | float):
                values[name] = value
                key.append(value)
            elif self._is_zero(value):
                values[name] = self.module.ZERO
                key.append("zero")
            else:
                raise _StrangeError(f"`{name}` of its state is neither a number nor a command")
        if seen.last is not None:
            seen = seen._replace(last=self.tokens[number(seen.last)])
            last: object = number_of(self.tokens, seen.last)
        else:
            last = None
        return (*key, seen[:-1], last), self.module.State(**values), seen


def number_of(tokens: tuple[Opaque, ...], token: object) -> int:
    """Its place among them; compares by identity only."""
    return next(i for i, one in enumerate(tokens) if one is token)


# Runs -----------------------------------------------------------------------------------------


def _run(search: _Search, contract: int) -> list[tuple[str, str, Seen]] | None:
    """The steps that lead to the first breach and the one that is it; None: there is none."""
    if contract not in search.broken:
        return None
    run: list[tuple[str, str, Seen]] = []
    step = search.broken[contract]
    while step is not None:
        key, heard, said, seen = step
        run.append((heard, said, seen))
        step = search.came[key]
    return run[::-1]


_SAID: Mapping[str, str] = {
    "nothing": "nothing is published",
    "zero": "zero is published",
    "last": "the last command is published",
    "other": "something else is published",
}


def _trace(run: list[tuple[str, str, Seen]], options: Options) -> Trace:
    """A row for each step."""
    watched = [name for name, _ in _CHANNELS if getattr(options, f"{name}_timeout")]
    names = ("stop requested", "must stand", "zero", "command", *(f"{w} silent" for w in watched))
    rows = tuple(
        (
            seen.requested,
            _stands(seen, options),
            said == "zero",
            said not in ("zero", "nothing"),
            *(getattr(seen, w) >= getattr(options, f"{w}_timeout") for w in watched),
        )
        for _, said, seen in run
    )
    actions = tuple(f"{heard}: {_SAID[said]}" for heard, said, _ in run)
    return Trace(names, rows, actions)
