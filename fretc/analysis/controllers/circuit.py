"""A machine as a circuit of choices: what a program computes tick by tick.

A circuit is plain data: it goes from process to process, and into templates.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from compiler.logic.diagrams import decision_diagrams as bdd
from fretc.analysis.controllers.machine import MealyMachine, NoMachineError
from fretish.classes.frozen import dataclass

MOST_NODES = 20_000
"""Maximum number of nodes of a circuit; each is a line of a program."""


@dataclass(frozen=True, slots=True)
class Ite:
    """A name for `high if variable else low`."""

    name: str
    variable: str
    high: str
    low: str

    @property
    def text(self) -> str:
        """The choice as a Python expression."""
        match self.high, self.low:
            case "False", "True":
                return f"not {self.variable}"
            case high, "False":
                return f"{self.variable} and {high}"
            case "False", low:
                return f"not {self.variable} and {low}"
            case "True", low:
                return f"{self.variable} or {low}"
            case high, "True":
                return f"not {self.variable} or {high}"
            case high, low:
                return f"{high} if {self.variable} else {low}"


@dataclass(frozen=True, slots=True)
class Circuit:
    """The machine of some requirements; every name is a Python name."""

    requirements: tuple[str, ...]
    inputs: Mapping[str, str]
    """Name → proposition that the environment sets."""
    outputs: Mapping[str, str]
    """Name → proposition that the machine sets."""
    bits: tuple[str, ...]
    replies: tuple[Ite, ...]
    """Choices that are computed before the outputs."""
    values: tuple[str, ...]
    """Value of each output, in the order of `outputs`."""
    steps: tuple[Ite, ...]
    """Choices that are computed after the outputs."""
    following: tuple[str, ...]
    """Value of each bit after the tick, in order."""


def circuit(machine: MealyMachine, requirements: Sequence[str], number: int) -> Circuit:
    """The circuit of a machine.

    Args:
        machine: a machine of any size.
        requirements: ids of its requirements.
        number: number that makes its names unique.

    Raises:
        NoMachineError: the circuit would be too long.
    """
    names = {each: f"i{number}_{i}" for i, each in enumerate(machine.inputs)}
    names |= {each: f"o{number}_{i}" for i, each in enumerate(machine.outputs)}
    names |= {each: f"m{number}_{i}" for i, each in enumerate(machine.steps)}
    roots = [*machine.replies.values(), *machine.steps.values()]
    size = sum(bdd.size(root) for root in roots)
    if size > MOST_NODES:
        raise NoMachineError(f"its controller has {size} choices; at most {MOST_NODES} are written")
    known: dict[bdd.Function, str] = {bdd.true(): "True", bdd.false(): "False"}
    replies = tuple(_choices(machine.replies.values(), names, known, number))
    steps = tuple(_choices(machine.steps.values(), names, known, number))
    return Circuit(
        tuple(requirements),
        {names[each]: atom for each, atom in machine.inputs.items()},
        {names[each]: atom for each, atom in machine.outputs.items()},
        tuple(names[step] for step in machine.steps),
        replies,
        tuple(known[root] for root in machine.replies.values()),
        steps,
        tuple(known[root] for root in machine.steps.values()),
    )


def _choices(
    roots: Iterable[bdd.Function],
    names: Mapping[int, str],
    known: dict[bdd.Function, str],
    number: int,
) -> Iterator[Ite]:
    """Choices that the roots need and that are not yet in `known`, which is extended."""
    for part in bdd.nodes(roots):
        if part not in known:
            variable, high, low = bdd.branches(part)
            if (high, low) == (bdd.true(), bdd.false()):
                known[part] = names[variable]
            else:
                known[part] = f"c{number}_{len(known) - 2}"
                yield Ite(known[part], names[variable], known[high], known[low])
