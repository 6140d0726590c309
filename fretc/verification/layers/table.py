"""The layers and provers of `fretc verify`, in one table.

The module of a row is imported on demand, so that help is quick.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, cast

from compiler.logic.claims import Layer
from fretish.classes.frozen import dataclass

if TYPE_CHECKING:
    from compiler.formalization.formalized import FormalizedRequirement
    from compiler.logic.claims import Proof
    from compiler.project.project import Project
    from fretc.verification.layers.request import Request
    from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Method:
    """A layer, or an additional prover."""

    name: str
    """Value of `--layer` or `--with`, and with `_` for `-` the name of the module."""
    claim: str
    """The claim, as in the help of `fretc verify`."""
    of_requirement: bool = False
    """Whether each proof is about one requirement, not about a shared part."""
    needs_monitor: bool = False
    """Whether it steps the monitor of a requirement, so that its runs are runs of that monitor."""

    def prove(
        self, requirements: Sequence[FormalizedRequirement], project: Project, request: Request
    ) -> Iterable[Proof] | Diagnostic:
        """The proofs about the requirements; a diagnostic if a given text has an error.

        Args:
            requirements: the requirements to prove.
            project: all requirements, and the bindings.
            request: the given texts, the limits, and other options.

        Raises:
            NotAMonitorError: the given text is not a generated monitor.
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
"""All methods in the order of the proofs."""
OF_MONITOR = frozenset(method.name for method in TABLE if method.needs_monitor)
"""Layers with claims about the text of a requirement's monitor."""


def in_words() -> str:
    """Each layer with its claim, from the monitor outwards."""
    claims = {method.name: method.claim for method in TABLE}
    return "Layers: " + "; ".join(f"`{layer}`: {claims[layer]}" for layer in Layer) + "."
