"""The letters of a game: what can be true at one tick, and who decides it.

The arena asks for the atoms of its requirements one by one, and an alphabet answers with functions
of the variables of its letters. The environment sets the `inputs` first, where `legal` holds; then
the system the `outputs`, so that `reachable` holds. With numbers the environment's bits name a cell
of the input space, and `reachable` says which truth patterns the system can bring about in it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from compiler.logic.decision_diagrams import Function
from fretish.bindings.declarations import Role

if TYPE_CHECKING:
    from fretc.analysis.arena.budget import Budget
    from fretc.analysis.arena.memory import Counter

Value = bool | int | float | str
"""Of a variable at one tick: a truth value, a number, a word of an enumerated signal."""
Tick = dict[str, Value]
"""The value of each variable at one tick."""


class NumericTrace(Protocol):
    """The numbers of a run, tick by tick, where letters depend on those of the tick before."""

    @property
    def ticks(self) -> Sequence[Tick]:
        """The numbers so far."""

    @property
    def last(self) -> tuple[object, ...]:
        """What is possible next depends on these alone."""

    def possible(self, inputs: Mapping[int, bool]) -> Function:
        """Over outputs: what can be true at the next tick, after these numbers."""

    def follow(self, letter: Mapping[int, bool]) -> None:
        """Choose numbers for the next tick, which are possible."""


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
    def possible(self) -> Function:
        """Which letters there can be, for any setter. What follows from these is certain."""

    @property
    def certain(self) -> Function:
        """Which letters there are for certain, over what `memory` has, too."""

    @property
    def doubts(self) -> Mapping[Role, str]:
        """Why its letters are more than there can be, of inputs or of outputs; none: they are not.

        Where inputs have too many letters, what the environment can force is not certain; where
        outputs have too many, what the system can keep is not.
        """

    def doubtful(self, role: Role) -> frozenset[str]:
        """The atoms of which a player has too many letters."""

    @property
    def is_refinable(self) -> bool:
        """Whether more can be remembered of numbers than is."""

    @property
    def open(self) -> str | None:
        """What one player chooses that nobody does, as far as that is not known; None: nothing."""

    def atom(self, name: str) -> Function:
        """When an atom is true, over inputs and outputs, and over what `memory` has.

        Raises:
            UnsupportedError: the alphabet has no such atom.
        """

    def memory(self) -> Counter | None:
        """What is remembered of earlier ticks, where letters speak of them."""

    def course(self, budget: Budget) -> NumericTrace | None:
        """A run that has not begun; None: no letter depends on earlier numbers."""

    @property
    def labels(self) -> Mapping[int, str]:
        """The atom of each variable that stands for one."""

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """Values of the user's variables that make up a letter.

        Args:
            letter: a value of each of inputs and outputs, legal and reachable, and of the bits of
                `memory` before the tick.
        """
