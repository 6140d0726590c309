"""Exploration of the core of an interceptor, with the history of its messages.

Every reachable state, with every kind of message, breadth first. Commands are opaque
(`fretc.verification.interceptor.opaque`); states that differ only in their commands are one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from fretc.verification.interceptor.incoming import (
    COMMAND,
    RELEASE,
    RING,
    SCAN,
    STOP,
    ContractStep,
    EventHistory,
    after,
    first,
)
from fretc.verification.interceptor.machine import CheckedCore, NotAnInterceptorError
from fretc.verification.interceptor.opaque import InspectedError, Opaque, is_opaque
from fretish.classes.frozen import dataclass
from monitors.interceptor import Options

Key = tuple[object, ...]


class Step(NamedTuple):
    """A step of the core from a state."""

    origin: Key
    """State before the step."""
    event: str
    output: str
    history: EventHistory
    """History after the step."""


@dataclass(slots=True)
class Search:
    """The states, with a path to each."""

    origins: dict[Key, Step | None]
    """State → the step to it; None: it is the first state."""
    breaches: dict[int, Step | None]
    """Contract → the step that violates it; None: the first state does."""
    steps: int = 0

    def run(self, contract: int) -> list[Step] | None:
        """Steps to the first violation, which the last step shows; None: no violation."""
        if contract not in self.breaches:
            return None
        run: list[Step] = []
        step = self.breaches[contract]
        while step is not None:
            run.append(step)
            step = self.origins[step.origin]
        return run[::-1]


def explore(
    text: str, options: Options, broken: Sequence[Callable[[ContractStep], bool]], most: int
) -> Search | str:
    """Explore all states; or why that is impossible.

    Args:
        text: text of an interceptor; its core is executed only if it is pure.
        options: required options of the text.
        broken: for each contract, whether a step violates it.
        most: maximum number of states.
    """
    try:
        return _Exploration(text, options, broken, most).search()
    except NotAnInterceptorError as error:
        return str(error)


class _Place(NamedTuple):
    """A state of the core with a history."""

    key: Key
    values: dict[str, Any]
    """Values of the state's fields."""
    history: EventHistory


class _Exploration:
    """Breadth-first search through the product of the core and the history."""

    def __init__(
        self,
        text: str,
        options: Options,
        broken: Sequence[Callable[[ContractStep], bool]],
        most: int,
    ) -> None:
        self.core = CheckedCore(text, options)
        self.declared, self.broken, self.most = options, broken, most
        own = getattr(self.core.module, "OPTIONS", self.core.options)
        if own != self.core.options:
            raise NotAnInterceptorError("its options differ from the declared options")
        self.tokens = tuple(Opaque() for _ in range(2 * len(self.core.state_fields) + 4))

    def search(self) -> Search:
        """Search until no state is new."""
        history = first(self.declared)
        state = self.core.initial()
        place = self._normal(state, history)
        search = Search({place.key: None}, {})
        for i in self._breaches(ContractStep(history, "", history, "nothing", state)):
            search.breaches[i] = None
        queue = deque([place])
        while queue:
            if len(search.origins) > self.most:
                raise NotAnInterceptorError(
                    f"it has more than {self.most} states: make the period in [interceptor] longer"
                )
            queue.extend(self._successors(queue.popleft(), search))
        return search

    def _successors(self, place: _Place, search: Search) -> Iterator[_Place]:
        """The new states after one message."""
        state = self.core.module.State(**place.values)
        kept = {id(place.history.last), *map(id, place.values.values())}
        command = next(token for token in self.tokens if id(token) not in kept)
        for event, message in self._messages(command):
            search.steps += 1
            then, velocity = self.core.step(state, message)
            now = after(place.history, event, command, self.declared)
            output = self._output(velocity, now)
            step = Step(place.key, event, output, now)
            for i in self._breaches(ContractStep(place.history, event, now, output, then)):
                search.breaches.setdefault(i, step)
            target = self._normal(then, now)
            if target.key not in search.origins:
                search.origins[target.key] = step
                yield target

    def _messages(self, command: object) -> Iterator[tuple[str, Any]]:
        module, call = self.core.module, self.core.call
        yield STOP, call(module.StopHeard, True)
        yield RELEASE, call(module.StopHeard, False)
        yield COMMAND, call(module.CommandHeard, command)
        yield SCAN, call(module.ScanHeard)
        yield RING, call(module.TimerRang)

    def _breaches(self, moment: ContractStep) -> Iterator[int]:
        """Indices of the contracts that a step violates."""
        for i, broken in enumerate(self.broken):
            try:
                if broken(moment):
                    yield i
            except InspectedError:
                raise NotAnInterceptorError(
                    "its state has a command in the place of a number"
                ) from None
            except (AttributeError, TypeError) as error:
                raise NotAnInterceptorError(f"its state is not the declared one: {error}") from None

    def _output(self, velocity: Any, now: EventHistory) -> str:
        """`ContractStep.output` of a velocity that the core publishes."""
        if velocity is None:
            return "nothing"
        if is_opaque(velocity):
            return "last" if velocity is now.last else "other"
        return "zero" if self.core.is_zero(velocity) else "other"

    def _normal(self, state: Any, history: EventHistory) -> _Place:
        """Representative of all states that differ only in their commands."""
        numbers: dict[int, int] = {}
        key: list[object] = []
        values: dict[str, Any] = {}
        for name in self.core.state_fields:
            value = getattr(state, name)
            if is_opaque(value):
                number = numbers.setdefault(id(value), len(numbers))
                values[name] = self.tokens[number]
                key.append(("command", number))
            elif value is None or isinstance(value, int | float):
                values[name] = value
                key.append(
                    (type(value), value)
                )  # Beyond 2^53 equal integers and floats add up differently.
            elif self.core.is_zero(value):
                values[name] = self.core.module.ZERO
                key.append("zero")
            else:
                raise NotAnInterceptorError(
                    f"`{name}` of its state is neither a number nor a command"
                )
        last = None
        if history.last is not None:
            last = numbers.setdefault(id(history.last), len(numbers))
            history = history._replace(last=self.tokens[last])
        return _Place((*key, *history[:-1], last), values, history)
