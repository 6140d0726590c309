"""`--emit ajpf-bundle`: an agent, its environment and its properties, ready for AJPF.

Each requirement gets a folder. Before files are emitted, they are checked in the model of
`compiler/agents/model.py`: the agent must satisfy the requirement, and the controls and a mutant
without the response must not. An agent that fails the check is refused. Source: Dennis, Fisher,
Verifiable autonomous systems, Cambridge University Press (2023), chapter 5 (verification
environments); MCAPL's environment for verification.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from importlib.resources import files
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render, to_json
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimResult, Proof
from compiler.logic.spot import unless_installed
from compiler.targets.ajpf import names
from compiler.targets.ajpf import properties as ajpf
from compiler.targets.ajpf.safety_function import AgentReaction, Sif, sif
from compiler.targets.target import DEFAULT, Target, TargetOptions, stem
from fretish import expressions as e
from fretish.bindings.declarations import Declarations, Modality
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.expressions import MIRRORED
from fretish.reading.recursion import with_recursion_limit

SCHEMA = "fretc-ajpf-bundle-1"
_WEAKEN = TargetOptions(weaken=True)


@with_recursion_limit
def refusal(
    requirement: FormalizedRequirement, options: TargetOptions = DEFAULT
) -> Diagnostic | None:
    """F601 for what AJPF or the agent cannot express; F614 if the agent is not proved correct.

    F908 if the agent cannot be checked, because Spot is not installed.
    """
    refused = ajpf.refusal(requirement, options) or unless_installed(
        "the agent of a bundle is checked before it is emitted, which needs"
    )
    if refused is not None:
        return refused
    agent = checked_agent(requirement, options)
    return agent if isinstance(agent, Diagnostic) else _not_kept(requirement, agent.evidence)


@dataclass(frozen=True, slots=True)
class CheckedAgent:
    """An agent, and the proofs about its texts in the model."""

    sif: Sif
    evidence: tuple[Proof, ...]

    @property
    def is_proved(self) -> bool:
        """Whether all claims are proved."""
        return all(line.result is ClaimResult.PROVED for line in self.evidence)


def forms(requirement: FormalizedRequirement) -> tuple[Sif, ...] | Diagnostic:
    """The possible agents: one that checks the whole condition, and one that does not.

    The result has one agent if both are equal; F601 if there is none.
    """
    asking, bare = sif(requirement), sif(requirement, guarded=False)
    if isinstance(asking, Diagnostic):
        return asking
    if isinstance(bare, Diagnostic) or not bare.over_responds:
        return (asking,)
    return (asking, bare)


@with_recursion_limit
def checked_agent(
    requirement: FormalizedRequirement, options: TargetOptions = DEFAULT, limit: int | None = None
) -> CheckedAgent | Diagnostic:
    """The first form of the agent that is proved to satisfy its requirement, guarded form first.

    Args:
        requirement: one that `ajpf.refusal` does not refuse, with the same options.
        options: `weaken` counts.
        limit: the number of states to explore for each form.

    Returns:
        The guarded form if none is proved; F601 if there is no form.
    """
    from compiler.agents.checking import STATES, agent_evidence

    candidates = forms(requirement)
    if isinstance(candidates, Diagnostic):
        return candidates
    agents: list[CheckedAgent] = []
    for form in candidates:
        files = texts(requirement, form, options)
        agents.append(
            CheckedAgent(form, agent_evidence(requirement, files, form.drawn, limit or STATES))
        )
        if agents[-1].is_proved:
            return agents[-1]
        if any(line.result is ClaimResult.NOT_CHECKED for line in agents[-1].evidence):
            break  # an agent that responds to more has more states
    return agents[0]


def _not_kept(requirement: FormalizedRequirement, evidence: Sequence[Proof]) -> Diagnostic | None:
    for line in evidence:
        if line.result is ClaimResult.PROVED:
            continue
        return diagnostic(
            "agent_not_shown",
            requirement.entry.wording,
            requirement=requirement.id,
            detail=line.detail,
        )
    return None


@with_recursion_limit
def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """A folder `<id>_ajpf/` for each requirement."""
    return tuple(
        artifact for requirement in requirements for artifact in _bundle(requirement, options)
    )


def _bundle(requirement: FormalizedRequirement, options: TargetOptions) -> Iterator[Artifact]:
    agent = checked_agent(requirement, options)
    assert isinstance(agent, CheckedAgent), f"{requirement.id} was to be refused"
    assert agent.is_proved, f"{requirement.id} was to be refused"
    form = agent.sif
    contents = {
        **texts(requirement, form, options),
        **_configuration(requirement, form, options),
        "run.py": files("compiler.targets.ajpf").joinpath("runner.py").read_text(encoding="utf-8"),
        "README.md": render("ajpf-bundle/README.md.j2", id=requirement.id),
    }
    manifest = f"{to_json(_manifest(requirement, form, options, contents))}\n"
    for name, text in {**contents, "manifest.json": manifest}.items():
        yield Artifact(PurePosixPath(package(requirement)) / name, text)


def package(requirement: FormalizedRequirement) -> str:
    """The name of the folder, and of the Java package in it."""
    name = re.sub(r"[^a-z0-9]+", "_", stem(requirement)).strip("_")
    return f"{name if name[:1].isalpha() else f'r{name}'}_ajpf"


def texts(
    requirement: FormalizedRequirement, form: Sif, options: TargetOptions = DEFAULT
) -> dict[str, str]:
    """The texts that are checked in the model and written to the bundle, by file name."""
    return {
        "SIF.gwen": _agent(requirement, form, form.plans, "the agent of"),
        "SIF_mutant.gwen": _agent(
            requirement, form, form.mutant, "an agent without the response, which must violate"
        ),
        "SIF.psl": ajpf.text(requirement, options),
    }


def _sentence(requirement: FormalizedRequirement) -> str:
    return " ".join(requirement.entry.wording.text.split())


def _agent(
    requirement: FormalizedRequirement, form: Sif, plans: Sequence[AgentReaction], title: str
) -> str:
    return render(
        "ajpf-bundle/agent.gwen.j2",
        title=f"{title} {requirement.id}",
        sentence=_sentence(requirement),
        over_responds=form.over_responds,
        agent=form.agent,
        plans=[_plan(plan) for plan in plans],
    )


def _plan(plan: AgentReaction) -> str:
    guards = [f"{'' if g.positive else '~'}B {g.belief}" for g in plan.guards] or ["True"]
    deeds = f" <- {', '.join(map(str, plan.deeds))}" if plan.deeds else ""
    return f"{plan.event} : {{{', '.join(guards)}}}{deeds};"


def _configuration(
    requirement: FormalizedRequirement, form: Sif, options: TargetOptions
) -> dict[str, str]:
    """The other files for MCAPL and Java PathFinder."""
    name = package(requirement)
    texts = {
        "Env.java": render(
            "ajpf-bundle/Env.java.j2",
            package=name,
            percepts=form.drawn,
        )
    }
    for agent in ("SIF", "SIF_mutant"):
        texts[f"{agent}.ail"] = render(
            "ajpf-bundle/agent.ail.j2", title=requirement.id, file=f"{agent}.gwen", package=name
        )
    for check in _checks(requirement, options):
        texts[check["jpf"]] = render(
            "ajpf-bundle/check.jpf.j2", title=requirement.id, ail=check["agent"], key=check["key"]
        )
    return texts


def _checks(requirement: FormalizedRequirement, options: TargetOptions) -> list[dict[str, str]]:
    """The checks for AJPF, each with its expected answer."""
    main, *controls = ajpf.properties(requirement, options)
    return [
        _check("requirement", main, "SIF", main.key, main.expected, main.why),
        *(_check("control", c, "SIF", c.key, c.expected, c.why) for c in controls),
        _check(
            "mutant",
            main,
            "SIF_mutant",
            f"{main.key}_mutant",
            ajpf.VIOLATED,
            "an agent without the response violates the requirement",
        ),
    ]


def _check(
    role: str, prop: ajpf.ExpectedProperty, agent: str, name: str, expected: str, why: str
) -> dict[str, str]:
    return {
        "role": role,
        "key": prop.key,
        "agent": f"{agent}.ail",
        "jpf": f"{name}.jpf",
        "property": prop.text,
        "expected": expected,
        "why": why,
    }


def _manifest(
    requirement: FormalizedRequirement, form: Sif, options: TargetOptions, texts: Mapping[str, str]
) -> dict[str, Any]:
    from compiler.logic import printing

    return {
        "schema": SCHEMA,
        "fretc": __version__,
        "requirement": requirement.id,
        "sentence": _sentence(requirement),
        "fingerprint": requirement.fingerprint,
        "formulas": {
            "ft_infinite": printing.readable(requirement.ft_infinite),
            "ft_finite": printing.readable(requirement.ft_finite),
            "pt": printing.readable(requirement.pt),
        },
        "weakened": ajpf.weakened(requirement, options),
        "agent": form.agent,
        "percepts": list(form.percepts),
        "responses": list(form.responses),
        "released": form.released,
        "over_responds": form.over_responds,
        "atoms": [_atom(requirement, form, name) for name in (*form.percepts, *form.responses)],
        "checks": _checks(requirement, options),
        "files": {name: sha256(text) for name, text in sorted(texts.items())},
    }


def _atom(requirement: FormalizedRequirement, form: Sif, name: str) -> dict[str, Any]:
    declared = requirement.glossary.get(name)
    return {
        "proposition": name,
        **({"name": form.names[name]} if form.names[name] != name else {}),
        "modality": str(declared.modality if declared else Modality.BELIEF),
        "part": "percept" if name in form.percepts else "response",
        "role": declared.role if declared else "",
        "text": declared.text if declared else "",
        **_binding(requirement.declarations, name),
    }


def _binding(declarations: Declarations | None, name: str) -> dict[str, Any]:
    """The binding of the proposition to messages; empty if it is not bound."""
    bound = declarations.propositions.get(name) if declarations else None
    if declarations is None or bound is None:
        return {}
    text = bound.span.text.strip("\"'") if bound.span else ""
    compared = list(_comparisons(declarations, bound.expression))
    return {"expression": text, "comparisons": compared}


def _comparisons(declarations: Declarations, expression: e.Expression) -> Iterator[dict[str, Any]]:
    """Each comparison of a number from messages with a constant."""
    if isinstance(expression, e.Comparison):
        left, op, right = expression.left, expression.op, expression.right
        if isinstance(left, e.Quantity | e.Number):
            left, op, right = right, MIRRORED.get(op, op), left
        name = next((n.id for n in e.names(left)), "")
        signal = declarations.signals.get(name)
        if isinstance(right, e.Quantity | e.Number) and signal is not None:
            yield {
                "signal": signal.name,
                "topic": signal.path.topic,
                "field": ".".join(signal.path.fields),
                "type": signal.type,
                "comparison": op,
                "threshold": right.digits,
                "unit": right.unit if isinstance(right, e.Quantity) else "",
            }
    for part in e.children(expression):
        yield from _comparisons(declarations, part)


@with_recursion_limit
def remark(
    requirement: FormalizedRequirement, options: TargetOptions = DEFAULT
) -> Diagnostic | None:
    """A warning about the properties (F605, F606, F607); else about the agent (F615)."""
    warning = ajpf.remark(requirement, options)
    agent = checked_agent(requirement, options) if warning is None else warning
    if not isinstance(agent, CheckedAgent) or not agent.sif.over_responds:
        return warning
    return diagnostic(
        "agent_over_responds",
        requirement.sentence.condition.span
        if requirement.sentence.condition
        else requirement.entry.wording,
        requirement=requirement.id,
    )


_SUMMARY = "an agent, its environment and its properties, ready for AJPF"
TARGET = Target(
    "ajpf-bundle",
    _SUMMARY,
    emit,
    refusal,
    remark,
    names=names.everything,
    weak=Target(
        "ajpf-bundle",
        _SUMMARY,
        emit,
        partial(refusal, options=_WEAKEN),
        partial(remark, options=_WEAKEN),
    ),
)
