"""The letters of a game: what can be true at one tick, and who decides it.

The arena asks for the atoms of its requirements one by one, and an alphabet answers with functions
of the variables of its letters. The environment sets the `inputs` first, where `legal` holds; then
the system the `outputs`, so that `reachable` holds. With numbers the environment's bits name a cell
of the input space, and `reachable` says which truth patterns the system can bring about in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import count
from typing import TYPE_CHECKING, Protocol

from compiler.logic.decision_diagrams import Function
from fretish.bindings.declarations import Role

if TYPE_CHECKING:
    from fretc.analysis.arena.counters import Counter

Value = bool | int | float | str
"""Of a variable at one tick: a truth value, a number, a word of an enumerated signal."""
Tick = dict[str, Value]
"""The value of each variable at one tick."""


class Alphabet(Protocol):
    """Letters; its variables are complete once every atom has been asked for."""

    @property
    def inputs(self) -> Sequence[int]:
        """The variables that the environment sets."""

    @property
    def outputs(self) -> Sequence[int]:
        """The variables that the system sets."""

    @property
    def legal(self) -> Function:
        """Over inputs: which values can occur together. Never false."""

    @property
    def reachable(self) -> Function:
        """Over inputs and outputs: what the system can do. For all legal inputs it can do some."""

    @property
    def doubts(self) -> Mapping[Role, str]:
        """Why its letters are more than there can be, of inputs or of outputs; none: they are not.

        Where inputs have too many letters, what the environment can force is not certain; where
        outputs have too many, what the system can keep is not.
        """

    @property
    def doubtful(self) -> frozenset[str]:
        """The atoms that these doubts are about."""

    def atom(self, name: str) -> Function:
        """When an atom is true, over inputs and outputs.

        Raises:
            BeyondError: the alphabet has no such atom.
        """

    def memory(self) -> Counter | None:
        """What is remembered of the tick before, where letters speak of it."""

    @property
    def labels(self) -> Mapping[int, str]:
        """The atom of each variable that stands for one."""

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """Values of the user's variables that make up a letter.

        Args:
            letter: a value of each of inputs and outputs, legal and reachable.
        """


class BeyondError(Exception):
    """Something that the analysis has no model of; the message says what, in words."""


Numbers = Iterator[int]
"""Variables that nothing has yet, in their order: whoever needs one takes the next."""


def numbers(start: int = 0) -> Numbers:
    """All of them, from one on."""
    return count(start)
