"""The request to the layers: which of them, about which texts, and with which limits."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from pathlib import PurePath

from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimOutcome, Layer, Proof, not_checked, proof
from compiler.project.project import Project
from compiler.targets.python import interceptor, monitor
from compiler.targets.target import stem
from fretc.verification.engines.sandbox import CallLimits
from fretc.verification.loop.closed_loop import NamedText, Setup
from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry

Progress = Callable[[str], None]
"""Callback that gets the name of the next activity."""


@dataclass(frozen=True, slots=True)
class Request:
    """The layers and provers, and the texts; None: the generated text."""

    layers: Collection[Layer]
    limits: CallLimits
    demanded: Collection[Layer] = ()
    """Layers and provers that the user names, for every requirement; others count if they apply,
    and if the header of a requirement plans them."""
    monitor: Source | None = None
    header: Source | None = None
    """Header of a monitor in C."""
    interceptor: Source | None = None
    agent: Source | None = None
    properties: Source | None = None
    percepts: tuple[str, ...] = ()
    provers: Collection[str] = ()
    ajpf: Sequence[Proof] = ()
    """Results of AJPF."""
    progress: Progress = lambda words: None
    """Called before each claim that takes time."""

    def names(self, name: str) -> bool:
        """Whether a layer or a prover is requested."""
        return name in self.layers or name in self.provers

    def demands(self, layer: Layer, requirement: RequirementEntry) -> bool:
        """Whether a claim of a layer counts as open without a result."""
        return layer in self.demanded or str(layer) in requirement.verify


def setup_of(requirement: FormalizedRequirement, project: Project, request: Request) -> Setup:
    """The parts of the closed loop around a requirement."""
    declared = project.declarations
    return Setup(
        named_text(request.monitor)
        or NamedText(f"{stem(requirement)}_monitor.py", monitor.text(requirement)),
        interceptor_of(project, request),
        declared.interceptor if declared else None,
        declared.assumed if declared else None,
    )


def interceptor_of(project: Project, request: Request) -> NamedText | None:
    """The given interceptor, or the one of the bindings; None: they declare none."""
    declared = project.declarations
    if request.interceptor is not None or declared is None or declared.interceptor is None:
        return named_text(request.interceptor)
    name = PurePath(declared.source.name).name
    return NamedText(interceptor.NAME, interceptor.text(declared.interceptor, name))


def named_text(source: Source | None) -> NamedText | None:
    """A given text, with the name of its file."""
    return NamedText(PurePath(source.name).name, source.text) if source else None


def unknown(
    requirement: str, layer: Layer, claim: str, reason: str, text: NamedText | None = None
) -> Proof:
    """A claim that is not checked, about a text if there is one."""
    return unexamined(requirement, layer, claim, not_checked(reason), text)


def unexamined(
    requirement: str, layer: Layer, claim: str, outcome: ClaimOutcome, text: NamedText | None = None
) -> Proof:
    """A claim that no engine has examined."""
    artefacts = {text.name: sha256(text.text)} if text else {}
    return proof(requirement, layer, claim, outcome, "fretc", (), artefacts)
