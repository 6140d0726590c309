"""A question of the analysis, with its finding for the case that it gets no answer."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Generic, TypeVar

from fretish.classes.frozen import dataclass

F = TypeVar("F")


@dataclass(frozen=True)  # slots cannot be generic in Python 3.11
class Job(Generic[F]):
    """A question about some requirements; its answer is any number of findings."""

    title: str
    """The question, for progress messages."""
    ask: Callable[[Sequence[F]], Iterator[F]]
    """Function of the earlier findings that yields the answer."""
    lost: Callable[[str], F]
    """Function of a reason that gives the finding if there is no answer."""
    problem: Callable[[], str] | None = None
    """The fingerprint of all that the answer depends on; None: it is not kept. Questions with the
    same fingerprint share what they compute."""

    def out_of_memory(self, limit: str = "there is") -> F:
        """The finding if the memory, or the table of decision diagrams, is full."""
        return self.lost(
            f"it took more memory than {limit}, or more decision diagrams than their table holds"
        )
