"""Walk through all that the core of an interceptor can do, beside what was heard.

Every state that it can come to, with every kind of message, breadth first. Commands are opaque
(`fretc.verification.interceptor.opaque`); states that differ only in which commands they hold are
one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from fretc.verification.interceptor.incoming import (
    COMMAND,
    RELEASE,
    RING,
    SCAN,
    STOP,
    Moment,
    Seen,
    after,
    first,
)
from fretc.verification.interceptor.machine import Core, NotAnInterceptorError
from fretc.verification.interceptor.opaque import InspectedError, Opaque, is_opaque
from monitors.interceptor import Options

Key = tuple[object, ...]


@dataclass(slots=True)
class Search:
    """The states that were found, and on which way."""

    came: dict[Key, tuple[Key, str, str, Seen] | None]
    """From where, by what, what was said, and what is heard by then; None: the first."""
    broken: dict[int, tuple[Key, str, str, Seen] | None]
    """Contract → the step that breaks it; None: the first state does."""
    steps: int = 0

    def run(self, contract: int) -> list[tuple[str, str, Seen]] | None:
        """The steps that lead to the first breach and the one that is it; None: there is none."""
        if contract not in self.broken:
            return None
        run: list[tuple[str, str, Seen]] = []
        step = self.broken[contract]
        while step is not None:
            key, heard, said, seen = step
            run.append((heard, said, seen))
            step = self.came[key]
        return run[::-1]


def explored(
    text: str, options: Options, broken: Sequence[Callable[[Moment], bool]], most: int
) -> Search | str:
    """Walk until every state is known; or why that cannot be.

    Args:
        text: of an interceptor; its core is executed once it is known to be pure.
        options: those that its own have to be.
        broken: whether a step breaks a contract, for each contract.
        most: states.
    """
    try:
        return _Walk(text, options, broken, most).search()
    except NotAnInterceptorError as error:
        return str(error)


class _Place(NamedTuple):
    """A state of the core beside what was heard."""

    key: Key
    values: dict[str, Any]
    """Of the state's fields."""
    seen: Seen


class _Walk:
    """The breadth-first walk through the product of the core and what was heard."""

    def __init__(
        self, text: str, options: Options, broken: Sequence[Callable[[Moment], bool]], most: int
    ) -> None:
        self.core = Core(text, options)
        self.declared, self.broken, self.most = options, broken, most
        own = getattr(self.core.module, "OPTIONS", self.core.options)
        if own != self.core.options:
            raise NotAnInterceptorError("its options are not those that are declared")
        self.tokens = tuple(Opaque() for _ in range(2 * len(self.core.fields) + 4))

    def search(self) -> Search:
        """Until no new state is found."""
        seen = first(self.declared)
        state = self.core.initial()
        place = self._normal(state, seen)
        found = Search({place.key: None}, {})
        for i in self._wrong(Moment(seen, "", seen, "nothing", state)):
            found.broken[i] = None
        queue = deque([place])
        while queue:
            if len(found.came) > self.most:
                raise NotAnInterceptorError(
                    f"it has more than {self.most} states: make the period in [interceptor] longer"
                )
            queue.extend(self._from(queue.popleft(), found))
        return found

    def _from(self, place: _Place, found: Search) -> Iterator[_Place]:
        """The new ones that one message leads to."""
        state = self.core.module.State(**place.values)
        kept = {id(place.seen.last), *map(id, place.values.values())}
        command = next(token for token in self.tokens if id(token) not in kept)
        for heard, message in self._messages(command):
            found.steps += 1
            then, said = self.core.step(state, message)
            now = after(place.seen, heard, command, self.declared)
            told = self._told(said, now)
            step = (place.key, heard, told, now)
            for i in self._wrong(Moment(place.seen, heard, now, told, then)):
                found.broken.setdefault(i, step)
            target = self._normal(then, now)
            if target.key not in found.came:
                found.came[target.key] = step
                yield target

    def _messages(self, command: object) -> Iterator[tuple[str, Any]]:
        module, called = self.core.module, self.core.called
        yield STOP, called(module.StopHeard, True)
        yield RELEASE, called(module.StopHeard, False)
        yield COMMAND, called(module.CommandHeard, command)
        yield SCAN, called(module.ScanHeard)
        yield RING, called(module.TimerRang)

    def _wrong(self, moment: Moment) -> Iterator[int]:
        for i, broken in enumerate(self.broken):
            try:
                if broken(moment):
                    yield i
            except InspectedError:
                raise NotAnInterceptorError(
                    "its state has a command in the place of a number"
                ) from None
            except (AttributeError, TypeError) as error:
                raise NotAnInterceptorError(f"its state is another one: {error}") from None

    def _told(self, said: Any, now: Seen) -> str:
        if said is None:
            return "nothing"
        if is_opaque(said):
            return "last" if said is now.last else "other"
        return "zero" if self.core.is_zero(said) else "other"

    def _normal(self, state: Any, seen: Seen) -> _Place:
        """One of all states that differ only in which commands they hold."""
        numbers: dict[int, int] = {}
        key: list[object] = []
        values: dict[str, Any] = {}
        for name in self.core.fields:
            value = getattr(state, name)
            if is_opaque(value):
                number = numbers.setdefault(id(value), len(numbers))
                values[name] = self.tokens[number]
                key.append(("command", number))
            elif value is None or isinstance(value, int | float):
                values[name] = value
                key.append((type(value), value))  # beyond 2^53 equal numbers add up differently
            elif self.core.is_zero(value):
                values[name] = self.core.module.ZERO
                key.append("zero")
            else:
                raise NotAnInterceptorError(
                    f"`{name}` of its state is neither a number nor a command"
                )
        last = None
        if seen.last is not None:
            last = numbers.setdefault(id(seen.last), len(numbers))
            seen = seen._replace(last=self.tokens[last])
        return _Place((*key, *seen[:-1], last), values, seen)
