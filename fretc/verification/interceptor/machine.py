"""An interceptor's text as a machine that can be put into any state and stepped.

Only its core is executed, once it is known to be pure (`fretc.verification.interceptor.file`): no
input, no output, no node. The step must not look into velocities, so that opaque commands stand for
all. Source of that reduction: Wolper, Expressing interesting properties of programs in
propositional temporal logic, POPL 1986 (data independence).
"""

from __future__ import annotations

from dataclasses import fields
from enum import Enum
from typing import Any

from fretc.verification.interceptor.file import core
from fretc.verification.interceptor.opaque import InspectedError, Opaque, is_opaque, is_zero
from monitors.interceptor import Options


class NotAnInterceptorError(Exception):
    """The text cannot be explored as an interceptor; it says why."""


class Heard(Enum):
    """What an interceptor can hear, as a model tells it apart."""

    STOP = "`true` is heard"
    RELEASE = "`false` is heard"
    MOVE = "a command to move is heard"
    STAND = "a command to stand is heard"
    SCAN = "a scan is heard"
    RING = "the timer rings"


State = tuple[int | bool, ...]
"""The fields of an interceptor's state; of the command whether it moves."""

Said = bool | None
"""Whether what is published moves the wheels; None: nothing is published."""


_KEPT, _NEW = Opaque(), Opaque()
"""Velocities that move: the one that a state holds, and the next one that is heard."""


class Core:
    """The core of an interceptor's text, executed; what it does wrong is NotAnInterceptorError."""

    def __init__(self, text: str, options: Options) -> None:
        """Execute the definitions of a text that is known to be pure.

        Args:
            text: with the step.
            options: its own, in ticks of its timer.
        """
        read = core(text)
        if isinstance(read, str):
            raise NotAnInterceptorError(read)
        self.module = module = read.module
        self.fields = tuple(getattr(module.State, "__dataclass_fields__", ()))
        named = {field.name: getattr(options, field.name) for field in fields(options)}
        try:
            self.options = module.Options(**named)
        except TypeError as error:
            raise NotAnInterceptorError(f"its options are others: {error}") from None

    def initial(self) -> Any:
        """The state at first."""
        return self.is_state(self.called(self.module.initial, self.options))

    def step(self, state: Any, message: Any) -> tuple[Any, Any]:
        """The state after a message, and what is published; None: nothing."""
        given = self.called(self.module.step, state, message, self.options)
        if type(given) is not tuple or len(given) != 2:
            raise NotAnInterceptorError("a step gives no state and command")
        return self.is_state(given[0]), given[1]

    def is_state(self, state: Any) -> Any:
        """The same, once it is known to be a `State` of the text."""
        if type(state) is not self.module.State:
            raise NotAnInterceptorError("a step gives no `State`")
        return state

    def is_zero(self, velocity: Any) -> bool:
        """Whether it is a velocity of the text that stands."""
        return is_zero(velocity, self.module.Velocity)

    def called(self, function: Any, *arguments: Any) -> Any:
        """What a function of the text gives."""
        try:
            return function(*arguments)
        except InspectedError:
            raise NotAnInterceptorError(
                "it looks into a command: what is shown with one would not hold for all"
            ) from None
        except Exception as error:
            why = f"a step fails: {type(error).__name__}: {error}"
            raise NotAnInterceptorError(why) from None


class Gate:
    """The step of an interceptor's text, over encoded states, each computed once."""

    def __init__(self, text: str, options: Options, most: int = 10**6) -> None:
        """Raises NotAnInterceptorError where the text is none that can be explored.

        Args:
            text: with the step.
            options: its own, in ticks of its timer.
            most: states; where there are more, NotAnInterceptorError is raised, too.
        """
        self._most = most
        self._core = Core(text, options)
        self._module = module = self._core.module
        self._options = self._core.options
        if "command" not in self._core.fields:
            raise NotAnInterceptorError("its `State` has no `command`")
        self._events = {
            Heard.STOP: self._core.called(module.StopHeard, True),
            Heard.RELEASE: self._core.called(module.StopHeard, False),
            Heard.MOVE: self._core.called(module.CommandHeard, _NEW),
            Heard.STAND: self._core.called(module.CommandHeard, module.ZERO),
            Heard.SCAN: self._core.called(module.ScanHeard),
            Heard.RING: self._core.called(module.TimerRang),
        }
        self._known: dict[tuple[State, Heard], tuple[State, Said]] = {}
        self._objects: dict[State, Any] = {}
        self.initial = self._encoded(self._core.initial())

    def hear(self, state: State, heard: Heard) -> tuple[State, Said]:
        """The state after it, and what is published."""
        found = self._known.get((state, heard))
        if found is None:
            event = self._events[heard]
            after, said = self._core.step(self._objects[state], event)
            found = self._known[state, heard] = self._encoded(after), self._said(said)
        return found

    def stopping(self, state: State) -> bool:
        """Whether it hands no command on, although sensor and planner have just been heard."""
        scanned, _ = self.hear(state, Heard.SCAN)
        _, said = self.hear(scanned, Heard.MOVE)
        return not said

    def halts(self, state: Any) -> bool:
        """`halted`, of a state as the text has it."""
        return bool(self._module.halted(state, self._options))

    def fresh(self) -> Any:
        """The state at first as the text has it, for a replay."""
        return self._module.initial(self._options)

    def replayed(self, state: Any, heard: Heard) -> tuple[Any, Said]:
        """One step of the text itself, nothing encoded and nothing remembered."""
        after, said = self._module.step(state, self._events[heard], self._options)
        return after, self._said(said)

    def _encoded(self, state: Any) -> State:
        values = {name: getattr(state, name) for name in self._core.fields}
        moves = self._said(values["command"])
        if moves is None or not all(
            type(value) in (bool, int) for name, value in values.items() if name != "command"
        ):
            raise NotAnInterceptorError("its State holds something else than it declares")
        encoded = tuple({**values, "command": moves}.values())
        if encoded not in self._objects:
            kept = _KEPT if moves else self._module.ZERO
            self._objects[encoded] = self._module.State(**{**values, "command": kept})
        if len(self._objects) > self._most:
            raise NotAnInterceptorError(f"its State takes more than {self._most} values")
        return encoded

    def _said(self, velocity: Any) -> Said:
        if velocity is None:
            return None
        if is_opaque(velocity):
            return True
        if self._core.is_zero(velocity):
            return False
        raise NotAnInterceptorError("it makes a velocity that it has not heard")
