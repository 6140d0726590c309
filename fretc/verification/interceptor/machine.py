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
    """The text cannot be explored as an interceptor; the message says why."""


class Event(Enum):
    """The messages to an interceptor, and its timer, as far as a model distinguishes them."""

    STOP = "`true` is heard"
    RELEASE = "`false` is heard"
    MOVE = "a command to move is heard"
    STAND = "a command to stand is heard"
    SCAN = "a scan is heard"
    RING = "the timer rings"


State = tuple[int | bool, ...]
"""The fields of an interceptor's state; of the command whether it moves."""

Output = bool | None
"""Whether the published velocity moves the wheels; None: nothing is published."""


_LAST, _NEXT = Opaque(), Opaque()
"""Velocities that move: the one in a state, and the one of the next command."""


class Core:
    """The core of an interceptor's text, executed; a mistake of it is NotAnInterceptorError."""

    def __init__(self, text: str, options: Options) -> None:
        """Execute the definitions of a text that is known to be pure.

        Args:
            text: with the step.
            options: its own, in ticks of its timer.
        """
        executed = core(text)
        if isinstance(executed, str):
            raise NotAnInterceptorError(executed)
        self.module = module = executed.module
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
        pair = self.called(self.module.step, state, message, self.options)
        if type(pair) is not tuple or len(pair) != 2:
            raise NotAnInterceptorError("a step gives no state and command")
        return self.is_state(pair[0]), pair[1]

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
        self._messages = {
            Event.STOP: self._core.called(module.StopHeard, True),
            Event.RELEASE: self._core.called(module.StopHeard, False),
            Event.MOVE: self._core.called(module.CommandHeard, _NEXT),
            Event.STAND: self._core.called(module.CommandHeard, module.ZERO),
            Event.SCAN: self._core.called(module.ScanHeard),
            Event.RING: self._core.called(module.TimerRang),
        }
        self._steps: dict[tuple[State, Event], tuple[State, Output]] = {}
        self._objects: dict[State, Any] = {}
        self.initial = self._encoded(self._core.initial())

    def step(self, state: State, event: Event) -> tuple[State, Output]:
        """The state after an event, and the output."""
        pair = self._steps.get((state, event))
        if pair is None:
            after, velocity = self._core.step(self._objects[state], self._messages[event])
            pair = self._steps[state, event] = self._encoded(after), self._output(velocity)
        return pair

    def stopping(self, state: State) -> bool:
        """Whether it hands on no command, not even one that comes right after a scan."""
        scanned, _ = self.step(state, Event.SCAN)
        _, output = self.step(scanned, Event.MOVE)
        return not output

    def halts(self, state: Any) -> bool:
        """`halted`, of a state as the text has it."""
        return bool(self._module.halted(state, self._options))

    def fresh(self) -> Any:
        """The state at first as the text has it, for a replay."""
        return self._module.initial(self._options)

    def replayed(self, state: Any, event: Event) -> tuple[Any, Output]:
        """One step of the text itself, nothing encoded and nothing remembered."""
        after, velocity = self._module.step(state, self._messages[event], self._options)
        return after, self._output(velocity)

    def _encoded(self, state: Any) -> State:
        values = {name: getattr(state, name) for name in self._core.fields}
        moves = self._output(values["command"])
        if moves is None or not all(
            type(value) in (bool, int) for name, value in values.items() if name != "command"
        ):
            raise NotAnInterceptorError("its State holds something else than it declares")
        encoded = tuple({**values, "command": moves}.values())
        if encoded not in self._objects:
            command = _LAST if moves else self._module.ZERO
            self._objects[encoded] = self._module.State(**{**values, "command": command})
        if len(self._objects) > self._most:
            raise NotAnInterceptorError(f"its State takes more than {self._most} values")
        return encoded

    def _output(self, velocity: Any) -> Output:
        if velocity is None:
            return None
        if is_opaque(velocity):
            return True
        if self._core.is_zero(velocity):
            return False
        raise NotAnInterceptorError("it makes a velocity that it has not heard")
