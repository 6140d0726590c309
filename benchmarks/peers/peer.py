"""What a peer offers: evaluations ready to be timed."""

from __future__ import annotations

import importlib.metadata
import importlib.util
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from benchmarks.peers.workloads import Columns

Step = Callable[[Mapping[str, bool]], object]
"""Takes the signals of the next tick and tells the truth there, as `Peer.truths` can read it."""


@dataclass(frozen=True)
class Evaluation:
    """The evaluation of a whole trace, as often as wanted. Only `run` is timed."""

    fresh: Callable[[], Any]
    """A monitor in its initial state."""
    run: Callable[[Any], Any]
    """Takes that monitor over the trace; `Peer.truths` reads what it gives back."""

    def __call__(self) -> Any:
        """Once."""
        return self.run(self.fresh())


class Peer(ABC):
    """Somebody else's monitor."""

    name: str
    formulas: Mapping[str, str]
    """What it is given, by workload; only those that it can express."""
    most: int | None = None
    """Of how many ticks its rate is taken at most, where its cost is linear and high."""

    @property
    @abstractmethod
    def version(self) -> str:
        """Of the installed peer; "" where it is not."""

    @abstractmethod
    def missing(self) -> str | None:
        """Why it cannot run here, or None."""

    @abstractmethod
    def prepare(self, workload: str, columns: Columns) -> Evaluation:
        """The evaluation alone: the columns are converted before it."""

    @abstractmethod
    def prepare_from_numpy(self, workload: str, columns: Columns) -> Evaluation:
        """The evaluation with the conversion of NumPy's columns in it."""

    def prepare_steps(self, workload: str) -> Step | None:
        """A fresh monitor, to be called once a tick; None where there is none."""
        return None

    @abstractmethod
    def truths(self, results: Any) -> Sequence[bool]:
        """The truth at each tick, from what a run, or a list of steps, gave back; not timed."""


class PackagePeer(Peer):
    """A peer that is a Python package."""

    package: str
    module: str

    @property
    def version(self) -> str:
        return "" if self.missing() else importlib.metadata.version(self.package)

    def missing(self) -> str | None:
        found = importlib.util.find_spec(self.module)
        return None if found else f"not installed: pip install {self.package}"
