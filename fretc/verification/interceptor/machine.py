"""An interceptor's text as a state machine that can be put into any state and stepped.

Only the core of the text is executed, once it is known to be pure
(`fretc.verification.interceptor.file`): no input, no output, no node. Its step must not look into
velocities, so that one opaque velocity stands for all that move. Source of that reduction: Wolper,
Expressing interesting properties of programs in propositional temporal logic, POPL 1986 (data
independence).

A state has two forms. A raw state is a `State` object of the text. An encoded one (`State` below)
is a tuple that a search can hash and compare, with a Boolean in the place of the velocity.
"""

from __future__ import annotations

from dataclasses import fields
from enum import Enum
from typing import Any

from fretc.verification.interceptor.file import core
from fretc.verification.interceptor.opaque import InspectedError, Opaque, is_opaque, is_zero
from monitors.interceptor import Options


class NotAnInterceptorError(Exception):
    """The text cannot be explored as an interceptor; the message gives the reason."""


class Event(Enum):
    """Messages to an interceptor, and its timer, as far as a model distinguishes them."""

    STOP = "`true` is received"
    RELEASE = "`false` is received"
    MOVE = "a command to move is received"
    STAND = "a command to stand is received"
    SCAN = "a scan is received"
    RING = "the timer expires"


State = tuple[int | bool, ...]
"""An encoded state: the fields of a raw state in order, with whether it moves for `command`."""

Output = bool | None
"""Whether the published velocity moves the wheels; None: nothing is published."""


_KEPT, _NEXT = Opaque(), Opaque()
"""Moving velocities: the stored one of a state, and that of the next command."""


class CheckedCore:
    """The executed core of an interceptor's text, with a check of its results.

    Every method raises NotAnInterceptorError if the core fails, or returns a value that no core of
    an interceptor may return.
    """

    def __init__(self, text: str, options: Options) -> None:
        """Execute the definitions of a pure text.

        Args:
            text: an interceptor, or its core alone.
            options: its options, in ticks of its timer.
        """
        executed = core(text)
        if isinstance(executed, str):
            raise NotAnInterceptorError(executed)
        self.module = module = executed.module
        self.state_fields = tuple(getattr(module.State, "__dataclass_fields__", ()))
        named = {field.name: getattr(options, field.name) for field in fields(options)}
        try:
            self.options = module.Options(**named)
        except TypeError as error:
            raise NotAnInterceptorError(f"its options differ: {error}") from None

    def initial(self) -> Any:
        """The raw state before the first message."""
        return self._checked_state(self.call(self.module.initial, self.options))

    def step(self, state: Any, message: Any) -> tuple[Any, Any]:
        """The raw state after a message, and the published velocity; None: nothing is published."""
        pair = self.call(self.module.step, state, message, self.options)
        if type(pair) is not tuple or len(pair) != 2:
            raise NotAnInterceptorError("a step returns no state and command")
        return self._checked_state(pair[0]), pair[1]

    def is_zero(self, velocity: Any) -> bool:
        """Whether the value is a `Velocity` of zeros: the robot stands."""
        return is_zero(velocity, self.module.Velocity)

    def call(self, function: Any, *arguments: Any) -> Any:
        """The result of a function of the text."""
        try:
            return function(*arguments)
        except InspectedError:
            raise NotAnInterceptorError(
                "it reads the content of a command: a proof with one command would not hold for all"
            ) from None
        except Exception as error:
            why = f"a step fails: {type(error).__name__}: {error}"
            raise NotAnInterceptorError(why) from None

    def _checked_state(self, state: Any) -> Any:
        """The value, checked to be a `State` of the text."""
        if type(state) is not self.module.State:
            raise NotAnInterceptorError("a step returns no `State`")
        return state


class InterceptorMachine:
    """Transitions of an interceptor's text between encoded states, each computed once."""

    def __init__(self, text: str, options: Options, max_states: int = 10**6) -> None:
        """Execute the core of the text.

        Args:
            text: an interceptor, or its core alone.
            options: its options, in ticks of its timer.
            max_states: maximum number of encoded states; an unbounded counter would have infinitely
                many.

        Raises:
            NotAnInterceptorError: the text cannot be explored. `step` raises it for too many
                states.
        """
        self._max_states = max_states
        self._core = CheckedCore(text, options)
        self._module = module = self._core.module
        self._options = self._core.options
        if "command" not in self._core.state_fields:
            raise NotAnInterceptorError("its `State` has no `command`")
        self._messages = {
            Event.STOP: self._core.call(module.StopHeard, True),
            Event.RELEASE: self._core.call(module.StopHeard, False),
            Event.MOVE: self._core.call(module.CommandHeard, _NEXT),
            Event.STAND: self._core.call(module.CommandHeard, module.ZERO),
            Event.SCAN: self._core.call(module.ScanHeard),
            Event.RING: self._core.call(module.TimerRang),
        }
        self._steps: dict[tuple[State, Event], tuple[State, Output]] = {}
        self._blocks: dict[State, bool] = {}
        self._raw: dict[State, Any] = {}
        """A raw state for each encoded state."""
        self.initial = self._encoded(self._core.initial())

    def step(self, state: State, event: Event) -> tuple[State, Output]:
        """The encoded state after an event, and the output."""
        pair = self._steps.get((state, event))
        if pair is None:
            after, velocity = self._core.step(self._raw[state], self._messages[event])
            pair = self._steps[state, event] = self._encoded(after), self._output(velocity)
        return pair

    def blocks_commands(self, state: State) -> bool:
        """Whether no command is passed on, not even one right after a scan.

        The scan comes first so that the watchdog of the sensor alone does not count as a stop.
        """
        if state not in self._blocks:
            scanned, _ = self.step(state, Event.SCAN)
            _, output = self.step(scanned, Event.MOVE)
            self._blocks[state] = not output
        return self._blocks[state]

    def raw_initial(self) -> Any:
        """The raw state before the first message."""
        return self._module.initial(self._options)

    def raw_step(self, state: Any, event: Event) -> tuple[Any, Output]:
        """One step from a raw state, without encoding or caching."""
        after, velocity = self._module.step(state, self._messages[event], self._options)
        return after, self._output(velocity)

    def is_halted(self, state: Any) -> bool:
        """Value of the text's `halted` for a raw state."""
        return bool(self._module.halted(state, self._options))

    def _encoded(self, state: Any) -> State:
        """The encoded form of a raw state, which `_raw` stores."""
        values = {name: getattr(state, name) for name in self._core.state_fields}
        moves = self._output(values["command"])
        if moves is None or not all(
            type(value) in (bool, int) for name, value in values.items() if name != "command"
        ):
            raise NotAnInterceptorError("its State holds values that it does not declare")
        encoded = tuple({**values, "command": moves}.values())
        if encoded not in self._raw:
            # All moving velocities are one, so that one raw state represents all.
            command = _KEPT if moves else self._module.ZERO
            self._raw[encoded] = self._module.State(**{**values, "command": command})
        if len(self._raw) > self._max_states:
            raise NotAnInterceptorError(f"its State takes more than {self._max_states} values")
        return encoded

    def _output(self, velocity: Any) -> Output:
        """Effect on the wheels: the velocity must be nothing, a received command, or zero."""
        if velocity is None:
            return None
        if is_opaque(velocity):
            return True
        if self._core.is_zero(velocity):
            return False
        raise NotAnInterceptorError("it publishes a velocity that it has not received")
