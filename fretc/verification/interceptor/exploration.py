"""Walk through all that the core of an interceptor can do, beside what was heard.

Every state that it can come to, with every kind of message, breadth first. Commands are opaque
(`fretc.verification.interceptor.opaque`); states that differ only in which commands they hold are
one.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

from fretc.verification.interceptor.file import core
from fretc.verification.interceptor.heard import (
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
from fretc.verification.interceptor.opaque import InspectedError, Opaque, is_opaque, is_zero
from monitors.interceptor import Options

Key = tuple[object, ...]


class _StrangeError(Exception):
    """Nothing can be said, and why."""


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
    read = core(text)
    if isinstance(read, str):
        return read
    try:
        return _Walk(read.module, options, broken, most).search()
    except _StrangeError as error:
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
        self, module: Any, options: Options, broken: Sequence[Callable[[Moment], bool]], most: int
    ) -> None:
        self.module, self.declared, self.broken, self.most = module, options, broken, most
        self.fields = tuple(getattr(module.State, "__dataclass_fields__", ()))
        try:
            self.options = module.Options(**asdict(options))
        except TypeError as error:
            raise _StrangeError(f"its options are others: {error}") from None
        own = getattr(module, "OPTIONS", self.options)
        if own != self.options:
            raise _StrangeError("its options are not those that are declared")
        self.tokens = tuple(Opaque() for _ in range(2 * len(self.fields) + 4))

    def search(self) -> Search:
        """Until no new state is found."""
        seen = first(self.declared)
        state = self._called(lambda: self.module.initial(self.options))
        place = self._normal(state, seen)
        found = Search({place.key: None}, {})
        for i in self._wrong(Moment(seen, "", seen, "nothing", state)):
            found.broken[i] = None
        queue = deque([place])
        while queue:
            if len(found.came) > self.most:
                raise _StrangeError(
                    f"it has more than {self.most} states: make the period in [interceptor] longer"
                )
            queue.extend(self._from(queue.popleft(), found))
        return found

    def _from(self, place: _Place, found: Search) -> Iterator[_Place]:
        """The new ones that one message leads to."""
        state = self.module.State(**place.values)
        kept = {id(place.seen.last), *map(id, place.values.values())}
        command = next(token for token in self.tokens if id(token) not in kept)
        for heard, message in self._messages(command):
            found.steps += 1
            then, said = self._step(state, message)
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
        module = self.module
        yield STOP, self._called(lambda: module.StopHeard(True))
        yield RELEASE, self._called(lambda: module.StopHeard(False))
        yield COMMAND, self._called(lambda: module.CommandHeard(command))
        yield SCAN, self._called(lambda: module.ScanHeard())
        yield RING, self._called(lambda: module.TimerRang())

    def _step(self, state: Any, message: Any) -> tuple[Any, Any]:
        given = self._called(lambda: self.module.step(state, message, self.options))
        if type(given) is not tuple or len(given) != 2:
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
        for i, broken in enumerate(self.broken):
            try:
                if broken(moment):
                    yield i
            except InspectedError:
                raise _StrangeError("its state has a command in the place of a number") from None
            except (AttributeError, TypeError) as error:
                raise _StrangeError(f"its state is another one: {error}") from None

    def _told(self, said: Any, now: Seen) -> str:
        if said is None:
            return "nothing"
        if is_opaque(said):
            return "last" if said is now.last else "other"
        return "zero" if is_zero(said, self.module.Velocity) else "other"

    def _normal(self, state: Any, seen: Seen) -> _Place:
        """One of all states that differ only in which commands they hold."""
        if type(state) is not self.module.State:
            raise _StrangeError("a step gives no `State`")
        numbers: dict[int, int] = {}
        key: list[object] = []
        values: dict[str, Any] = {}
        for name in self.fields:
            value = getattr(state, name)
            if is_opaque(value):
                number = numbers.setdefault(id(value), len(numbers))
                values[name] = self.tokens[number]
                key.append(("command", number))
            elif value is None or isinstance(value, int | float):
                values[name] = value
                key.append((type(value), value))  # beyond 2^53 equal numbers add up differently
            elif is_zero(value, self.module.Velocity):
                values[name] = self.module.ZERO
                key.append("zero")
            else:
                raise _StrangeError(f"`{name}` of its state is neither a number nor a command")
        last = None
        if seen.last is not None:
            last = numbers.setdefault(id(seen.last), len(numbers))
            seen = seen._replace(last=self.tokens[last])
        return _Place((*key, *seen[:-1], last), values, seen)
