"""Valuations of one tick of a game, and the player who chooses each variable.

The arena asks for the atoms of its requirements one by one; an alphabet returns functions of its
variables. The environment sets the `inputs` first, so that `legal` holds; then the system sets the
`outputs`, so that `reachable` holds. With numbers, the environment's bits name a cell of the input
space, and `reachable` contains the truth patterns that the system can choose in the cell.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol

from compiler.logic.diagrams.decision_diagrams import Function
from fretish.bindings.declarations import Role

if TYPE_CHECKING:
    from fretc.analysis.arena.budget import Budget
    from fretc.analysis.arena.memory import RequirementCounter

Value = bool | int | float | str
"""Value of a variable at one tick: a truth value, a number, or an enumeration value."""
Tick = dict[str, Value]
"""The value of each variable at one tick."""


class NumericTrace(Protocol):
    """Numbers of a run, tick by tick, if valuations depend on numbers of the previous tick."""

    @property
    def ticks(self) -> Sequence[Tick]:
        """Numbers of the ticks so far."""

    @property
    def last(self) -> tuple[object, ...]:
        """Numbers of the last tick; the possible next valuations depend only on these."""

    def possible(self, inputs: Mapping[int, bool]) -> Function:
        """Function over outputs: the valuations that are possible at the next tick."""

    def follow(self, letter: Mapping[int, bool]) -> None:
        """Choose numbers for a possible valuation of the next tick."""


class Alphabet(Protocol):
    """Valuations of one tick; all variables exist once every atom has been asked for."""

    @property
    def inputs(self) -> Sequence[int]:
        """The variables that the environment sets."""

    @property
    def outputs(self) -> Sequence[int]:
        """The variables that the system sets."""

    @property
    def legal(self) -> Function:
        """Function over inputs: the inputs that can occur together. Never false."""

    @property
    def reachable(self) -> Function:
        """Function over inputs and outputs: choices of the system; not empty for legal inputs."""

    @property
    def possible(self) -> Function:
        """Superset of the valuations that can occur. Results for all of these are certain."""

    @property
    def certain(self) -> Function:
        """Subset of the valuations that can occur, over inputs, outputs and `memory`."""

    @property
    def uncertainties(self) -> Mapping[Role, str]:
        """Role → why its valuations are a superset of those that can occur; empty: they are exact.

        With a superset for inputs, strategies of the environment are uncertain; with a superset for
        outputs, strategies of the system are.
        """

    def uncertain_atoms(self, role: Role) -> frozenset[str]:
        """Atoms for which a player has valuations that may be impossible."""

    @property
    def is_refinable(self) -> bool:
        """Whether more about earlier numbers could be stored."""

    @property
    def not_computed(self) -> frozenset[str]:
        """Atoms that read a term with any value: numbers of a trace do not satisfy them."""

    @property
    def open(self) -> str | None:
        """What the favoured player chooses although no player does; None: nothing."""

    def atom(self, name: str) -> Function:
        """Function of an atom, over inputs, outputs and `memory`.

        Raises:
            UnsupportedError: the alphabet has no such atom.
        """

    def memory(self) -> RequirementCounter | None:
        """Stored facts about earlier ticks on which valuations depend."""

    def course(self, budget: Budget) -> NumericTrace | None:
        """A run before its first tick; None: no valuation depends on earlier numbers."""

    @property
    def labels(self) -> Mapping[int, str]:
        """The atom of each variable that represents one."""

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """Values of the user's variables for a valuation.

        Args:
            letter: a value of each input and output, legal and reachable, and of the bits of
                `memory` before the tick.
        """
