"""A question that is asked by itself, with what stands in place of an answer that is lost."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

F = TypeVar("F")


@dataclass(frozen=True)  # slots cannot be generic in Python 3.11
class Job(Generic[F]):
    """One question about some requirements; its answer is any number of findings."""

    title: str
    """The question, for people who wait."""
    ask: Callable[[Sequence[F]], Iterator[F]]
    """It is given what is known so far."""
    lost: Callable[[str], F]
    """What stands in its place where it ends without an answer, for a reason."""
