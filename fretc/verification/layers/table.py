"""The layers and provers of `fretc verify`, in one table.

The table is there at once; the module of a row is imported when it is asked for, so that help is
quick.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, cast

from compiler.logic.claims import Layer

if TYPE_CHECKING:
    from compiler.formalization.formalized import FormalizedRequirement
    from compiler.logic.claims import Proof
    from compiler.project.project import Project
    from fretc.verification.layers.request import Request
    from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Method:
    """A layer, or a prover that is asked beside the layers."""

    name: str
    """That of `--layer` or `--with`; a module of this package has it, with `_` for `-`, and `prove`
    in it."""
    claim: str
    """What it proves, as the help of `fretc verify` says it."""
    of_requirement: bool = False
    """Whether each proof is about one requirement; else about what all have."""
    needs_monitor: bool = False
    """Whether it steps the monitor of a requirement, and its runs are runs of that monitor."""

    def prove(
        self, requirements: Sequence[FormalizedRequirement], project: Project, request: Request
    ) -> Iterable[Proof] | Diagnostic:
        """The proofs about the requirements; a diagnostic where a given text has a mistake.

        Args:
            requirements: those that are asked about.
            project: all requirements, and what the bindings declare.
            request: the texts that are given, the limits, and the other wishes.

        Raises:
            NotAMonitorError: the given text is no generated monitor.
        """
        name = self.name.replace("-", "_")
        module = import_module(f"fretc.verification.layers.{name}")
        return cast("Iterable[Proof] | Diagnostic", module.prove(requirements, project, request))


TABLE = (
    Method(
        Layer.MONITOR,
        "the monitor's text means what the sentence says",
        of_requirement=True,
        needs_monitor=True,
    ),
    Method(
        "frama-c",
        "no input causes undefined behaviour in a monitor in C",
        of_requirement=True,
    ),
    Method(
        Layer.LOOP,
        "monitor, interceptor and any environment together satisfy the requirement, under the "
        "assumptions of the bindings",
        of_requirement=True,
        needs_monitor=True,
    ),
    Method(
        Layer.BOUNDS,
        "the loop does so for all delays",
        of_requirement=True,
        needs_monitor=True,
    ),
    Method("dafny", "every lemma and method of the file of `--emit dafny`", of_requirement=True),
    Method(Layer.INTERCEPTOR, "the interceptor's text satisfies its contracts"),
    Method("crosshair", "the contracts in the text of the interceptor"),
    Method(Layer.AGENT, "the agent's text has its properties"),
    Method(Layer.AJPF, "results of AJPF itself"),
)
"""In the order of the proofs."""
OF_MONITOR = frozenset(method.name for method in TABLE if method.needs_monitor)
"""Layers whose claims are about the text of a requirement's monitor."""


def in_words() -> str:
    """Each layer with its claim, from the monitor outwards."""
    claims = {method.name: method.claim for method in TABLE}
    return "Layers: " + "; ".join(f"`{layer}`: {claims[layer]}" for layer in Layer) + "."
