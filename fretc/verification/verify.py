"""The six layers of `fretc verify`, asked of a project: which text goes to which engine."""

from __future__ import annotations

import ast
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass
from pathlib import PurePath

from compiler.agents.checking import checked
from compiler.files import records
from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Layer, Proof, not_checked, proof
from compiler.project.folder import Project
from compiler.project.interceptor_options import ASSUMED, assumed, options
from compiler.targets import dafny
from compiler.targets.ajpf import bundle
from compiler.targets.ajpf import properties as ajpf
from compiler.targets.python import interceptor, monitor
from compiler.targets.target import stem
from fretc.verification.engines import sandbox as processes
from fretc.verification.engines.crosshair import stated, with_crosshair
from fretc.verification.engines.dafny import with_dafny
from fretc.verification.engines.sandbox import Limits, Stopped
from fretc.verification.interceptor.contracts import contracts
from fretc.verification.interceptor.file import head, otherwise
from fretc.verification.loop import bounds
from fretc.verification.loop import layer as closedloop
from fretc.verification.loop.layer import Named, Setup
from fretc.verification.monitor import layer as proofs
from fretish.bindings.declarations import Interception
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from monitors.source_text import interceptor as core

DAFNY, CROSSHAIR = "dafny", "crosshair"


@dataclass(frozen=True, slots=True)
class Request:
    """What is to be looked at; None: what fretc makes itself."""

    layers: Collection[Layer]
    limits: Limits
    monitor: Source | None = None
    interceptor: Source | None = None
    agent: Source | None = None
    properties: Source | None = None
    percepts: tuple[str, ...] = ()
    provers: Collection[str] = ()
    ajpf: Sequence[Proof] = ()
    """What AJPF itself has said."""


Tell = Callable[[str], None]
"""Is told what is worked on from now on, in words."""


def evidence(
    project: Project, asked: Request, tell: Tell = lambda words: None
) -> tuple[Proof, ...] | Diagnostic:
    """All lines: requirement by requirement from the monitor outwards, then what all share.

    Args:
        project: the requirements and what their bindings declare.
        asked: which layers, with which texts.
        tell: is called before each claim that takes its time.

    Raises:
        NotAMonitorError: the given text is no generated monitor.
    """
    found: list[Proof] = []
    for rule in project.rules:
        found.extend(_of_rule(rule, project, asked, tell))
        if DAFNY in asked.provers:
            tell(f"{rule.id}: Dafny")
            found.extend(_dafny(rule, project, asked.limits))
    found.extend(_interceptor(project, asked, tell))
    if Layer.AGENT in asked.layers:
        tell("agent: its properties")
        agent = _agent(project, asked)
        if isinstance(agent, Diagnostic):
            return agent
        found.extend(agent)
    if Layer.AJPF in asked.layers:
        found.extend(_ajpf(project, asked))
    return tuple(found)


def refusals(project: Project, asked: Request) -> tuple[Diagnostic, ...]:
    """Why a monitor cannot be made of some requirements, where a layer steps one."""
    if not {Layer.MONITOR, Layer.LOOP, Layer.BOUNDS}.intersection(asked.layers):
        return ()
    found = (monitor.refuse(rule) for rule in project.rules)
    return tuple(diagnostic for diagnostic in found if diagnostic is not None)


def _ajpf(project: Project, asked: Request) -> Iterator[Proof]:
    """What AJPF itself has said; where nothing else is asked for, that it has said nothing."""
    yield from asked.ajpf
    if set(asked.layers) == {Layer.AJPF}:
        known = {line.requirement for line in asked.ajpf}
        for rule in project.rules:
            if rule.id not in known:
                claim = f"AJPF: the agent of {rule.id} keeps it"
                yield _unknown(rule.id, Layer.AJPF, claim, "there is no result of AJPF (--ajpf)")


def _of_rule(rule: Formalized, project: Project, asked: Request, tell: Tell) -> Iterator[Proof]:
    setup = _setup(rule, project, asked)
    if Layer.MONITOR in asked.layers:
        tell(f"{rule.id}: monitor")
        made = setup.monitor
        yield proofs.monitor_proof(rule, made.name, made.text, asked.limits, project.rules)
    found: list[Proof] = []
    if Layer.LOOP in asked.layers:
        tell(f"{rule.id}: loop")
        found.extend(closedloop.loop(rule, setup, asked.limits))
    if Layer.BOUNDS in asked.layers:
        tell(f"{rule.id}: bounds")
        found.extend(bounds.bounds(rule, setup, asked.limits))
    known = assumed(rule.declarations) if rule.declarations else ""
    extra = {ASSUMED: known} if known else {}
    for one in found:
        yield records.replace(one, artefacts={**one.artefacts, **extra})


def _setup(rule: Formalized, project: Project, asked: Request) -> Setup:
    declared = project.declarations
    return Setup(
        _named(asked.monitor) or Named(f"{stem(rule)}_monitor.py", monitor.text(rule)),
        _gate(project, asked),
        declared.interceptor if declared else None,
        declared.assumed if declared else None,
    )


def _named(source: Source | None) -> Named | None:
    return Named(PurePath(source.name).name, source.text) if source else None


def _gate(project: Project, asked: Request) -> Named | None:
    declared = project.declarations
    if asked.interceptor is not None or declared is None or declared.interceptor is None:
        return _named(asked.interceptor)
    name = PurePath(declared.source.name).name
    return Named(interceptor.NAME, interceptor.text(declared.interceptor, name))


# Layers of other rooms ------------------------------------------------------------------------


def _interceptor(project: Project, asked: Request, tell: Tell) -> Iterator[Proof]:
    """Its contracts, and what CrossHair finds of them."""
    gate = _gate(project, asked)
    declared = project.declarations.interceptor if project.declarations else None
    if Layer.INTERCEPTOR in asked.layers:
        if gate is None or declared is None:
            yield _unknown(
                "interceptor",
                Layer.INTERCEPTOR,
                "the interceptor keeps its contracts",
                "the bindings declare no interceptor (`[interceptor]`)",
            )
        else:
            tell("interceptor: its contracts")
            yield from _contracts(gate, declared, asked.limits)
    if CROSSHAIR in asked.provers and gate is not None:
        yield from _crosshair(gate, asked.limits, tell)


def _contracts(gate: Named, declared: Interception, limits: Limits) -> Iterator[Proof]:
    """Of the module that flies: its core may be any, the rest is what fretc writes."""
    wrong = otherwise(gate.text, declared)
    found: Stopped | tuple[Proof, ...]
    if wrong is not None:
        found = Stopped(wrong)
    else:
        found = processes.confined(limits, contracts, gate.text, options(declared))
    if isinstance(found, Stopped):
        claim = "the interceptor keeps its contracts"
        yield _unknown("interceptor", Layer.INTERCEPTOR, claim, found.reason, gate)
    else:
        yield from (records.replace(one, artefacts={gate.name: sha256(gate.text)}) for one in found)


def _crosshair(gate: Named, limits: Limits, tell: Tell) -> Iterator[Proof]:
    """Of the core alone: the node takes commands apart, and CrossHair would execute it."""
    known = head(gate.text)
    if isinstance(known, str):
        claim = "CrossHair confirms the contracts in the text"
        yield _unknown("interceptor", Layer.INTERCEPTOR, claim, known, gate)
        return
    if stated(known.text) != stated(core().text):
        claim = "CrossHair confirms the contracts in the text"
        reason = "its `pre:` and `post:` lines are not those of fretc, and CrossHair executes them"
        yield _unknown("interceptor", Layer.INTERCEPTOR, claim, reason, gate)
        return
    found = with_crosshair(
        ast.unparse(ast.parse(known.text)),  # CrossHair takes orders from comments
        seconds=float(limits.seconds),
        tell=lambda name: tell(f"interceptor: CrossHair, `{name}`"),
    )
    yield from (records.replace(one, artefacts={gate.name: sha256(gate.text)}) for one in found)


def _dafny(rule: Formalized, project: Project, limits: Limits) -> Iterator[Proof]:
    refused = dafny.TARGET.refuse(rule)
    if refused is not None:
        claim = "Dafny verifies the file of the requirement"
        yield _unknown(rule.id, Layer.LOOP, claim, refused.message)
        return
    text = dafny.text(rule, project.declarations)
    yield from with_dafny(rule, text, project.declarations, seconds=float(limits.seconds))


def _agent(project: Project, asked: Request) -> tuple[Proof, ...] | Diagnostic:
    """The agent that is named; else of each requirement the one that its bundle has."""
    claim = "the agent has its properties"
    if asked.agent is None or asked.properties is None:
        return tuple(line for rule in project.rules for line in _bundle(rule, claim, asked.limits))
    found = processes.confined(asked.limits, checked, asked.agent, asked.properties, asked.percepts)
    if isinstance(found, Stopped):
        named = _named(asked.agent)
        return (_unknown("agent", Layer.AGENT, claim, found.reason, named),)
    return found


def _bundle(rule: Formalized, claim: str, limits: Limits) -> tuple[Proof, ...]:
    refused = ajpf.refusal(rule)
    found = processes.confined(limits, bundle.checked_agent, rule) if refused is None else refused
    if isinstance(found, Diagnostic):
        return (_unknown(rule.id, Layer.AGENT, claim, f"there is none: {found.message}"),)
    if isinstance(found, Stopped):
        return (_unknown(rule.id, Layer.AGENT, claim, found.reason),)
    return found.evidence


def _unknown(
    requirement: str, layer: Layer, claim: str, reason: str, text: Named | None = None
) -> Proof:
    artefacts = {text.name: sha256(text.text)} if text else {}
    return proof(requirement, layer, claim, not_checked(reason), "fretc", (), artefacts)
