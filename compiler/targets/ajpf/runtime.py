"""`--emit agent-runtime`: the agent of a bundle with what connects it to a robot by rosbridge.

The agent is the text of `--emit ajpf-bundle`, with the same checks. Its environment is Java 11 and
needs nothing but MCAPL. `percepts.py` writes the part that differs by project.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import partial
from importlib.resources import files
from json import loads
from pathlib import PurePosixPath
from typing import Any

from compiler.agents.gwendolen import Action
from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render, to_json
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.ajpf import bundle, names, percepts
from compiler.targets.ajpf.safety_function import Sif
from compiler.targets.target import DEFAULT, Target, TargetOptions, stem
from fretish.bindings.declarations import ActionBinding, Declarations, ServiceCall
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.reading.recursion import with_recursion_limit

SCHEMA = "fretc-agent-runtime-1"
HEARTBEAT = 100_000_000
"""Nanoseconds between two stop requests, or releases."""
_WEAKEN = TargetOptions(weaken=True)
_CLASSES = (
    *("Bridge", "Cbor", "Environment", "Json", "Percepts", "Reading", "Signal"),
    *("Turns", "View"),
)
_BOOLEANS = ('{"data":true}', '{"data":false}')
"""The messages of a stop request and of a release."""


@with_recursion_limit
def refusal(
    requirement: FormalizedRequirement, options: TargetOptions = DEFAULT
) -> Diagnostic | None:
    """What a bundle refuses; F601 for percepts, F619 for actions that the bindings leave open."""
    refused = bundle.refusal(requirement, options)
    if refused is not None:
        return refused
    form = _form(requirement, options)
    return percepts.refusal(requirement, form) or _unbound(requirement, form)


def _form(requirement: FormalizedRequirement, options: TargetOptions) -> Sif:
    agent = bundle.checked_agent(requirement, options)
    assert isinstance(agent, bundle.CheckedAgent), f"{requirement.id} was to be refused"
    return agent.sif


def _actions(form: Sif) -> tuple[str, ...]:
    """The actions in the agent's plans, in their order."""
    deeds = (deed for plan in form.plans for deed in plan.deeds)
    return tuple(dict.fromkeys(deed.name for deed in deeds if isinstance(deed, Action)))


def _unbound(requirement: FormalizedRequirement, form: Sif) -> Diagnostic | None:
    """F619 if an action or the topic of stop requests is not bound, or has another type."""
    declared = _declared(requirement)
    span, id, actions = requirement.entry.wording, requirement.id, _actions(form)
    name = declared.source.name
    if declared.interceptor is None:
        return diagnostic("stop_topic_not_bound", span, requirement=id, bindings=name)
    for action in actions:
        if action not in declared.actions and action not in declared.calls:
            return diagnostic(
                "action_not_bound", span, requirement=id, action=action, bindings=name
            )
    stop = _topic(declared.interceptor.stop)
    stops = [each for each in declared.actions.values() if _topic(each.topic) == stop]
    for each in stops:
        if each.type != "std_msgs/Bool" or each.message not in _BOOLEANS:
            return diagnostic(
                "stop_of_other_type",
                each.span or span,
                action=each.action,
                message=each.message,
                type=each.type,
                stop=stop,
            )
    if not any(e.message == _BOOLEANS[0] and e.action in actions for e in stops):
        named = ", ".join(f"`{action}`" for action in actions)
        return diagnostic("no_action_stops", span, requirement=id, stop=stop, actions=named)
    return None


def _declared(requirement: FormalizedRequirement) -> Declarations:
    assert requirement.declarations is not None, "it is refused: its percepts are not bound"
    return requirement.declarations


def _topic(name: str) -> str:
    return name if name.startswith("/") else f"/{name}"


@with_recursion_limit
def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """A folder `<id>_agent/` for each requirement."""
    return tuple(
        Artifact(PurePosixPath(package(requirement)) / name, text)
        for requirement in requirements
        for name, text in _files(requirement, options).items()
    )


def package(requirement: FormalizedRequirement) -> str:
    """The name of the folder, and of the Java package in it."""
    name = re.sub(r"[^a-z0-9]+", "_", stem(requirement)).strip("_")
    return f"{name if name[:1].isalpha() else f'r{name}'}_agent"


def _files(requirement: FormalizedRequirement, options: TargetOptions) -> dict[str, str]:
    form, declared = _form(requirement, options), _declared(requirement)
    assert declared.interceptor is not None, "it is refused"
    bound, calls = [*declared.actions.values()], [*declared.calls.values()]
    name = package(requirement)
    values = {
        "package": name,
        "id": requirement.id,
        "agent": percepts.literal(form.agent),
        "stop": percepts.literal(_topic(declared.interceptor.stop)),
        "heartbeat": HEARTBEAT,
        "signals": percepts.signal_code(declared, form),
        "percepts": percepts.percept_code(declared, form),
        "actions": [_action_code(each) for each in bound],
        "calls": [_call_code(each) for each in calls],
    }
    texts = {
        "SIF.gwen": bundle.texts(requirement, form, options)["SIF.gwen"],
        "SIF.ail": render("agent-runtime/agent.ail.j2", **values),
        **{f"{each}.java": render(f"agent-runtime/{each}.java.j2", **values) for each in _CLASSES},
        "run.py": files("compiler.targets.ajpf")
        .joinpath("runtime_runner.py")
        .read_text(encoding="utf-8"),
        "README.md": render("agent-runtime/README.md.j2", **values),
    }
    manifest = _manifest(requirement, form, bound, calls)
    digests = {file: sha256(text) for file, text in sorted(texts.items())}
    return {**texts, "manifest.json": f"{to_json({**manifest, 'files': digests})}\n"}


def _action_code(bound: ActionBinding) -> Mapping[str, str]:
    return {
        "name": percepts.literal(bound.action),
        "topic": percepts.literal(_topic(bound.topic)),
        "type": percepts.literal(bound.type),
        "message": percepts.literal(bound.message),
    }


def _call_code(call: ServiceCall) -> Mapping[str, str]:
    return {
        "name": percepts.literal(call.action),
        "service": percepts.literal(_topic(call.service)),
        "type": percepts.literal(call.type),
        "request": percepts.literal(call.request),
        "limit": str(call.limit),
    }


def _manifest(
    requirement: FormalizedRequirement,
    form: Sif,
    bound: Sequence[ActionBinding],
    calls: Sequence[ServiceCall],
) -> dict[str, Any]:
    declared = _declared(requirement)
    assert declared.interceptor is not None, "it is refused"
    return {
        "schema": SCHEMA,
        "fretc": __version__,
        "requirement": requirement.id,
        "sentence": " ".join(requirement.entry.wording.text.split()),
        "fingerprint": requirement.fingerprint,
        "package": package(requirement),
        "agent": form.agent,
        "stop": _topic(declared.interceptor.stop),
        "heartbeat_ns": HEARTBEAT,
        "percepts": {name: form.names[name] for name in form.percepts},
        "signals": [
            {"name": s.name, "path": str(s.path), "type": s.type, "max_age_ns": s.max_age}
            for s in percepts.signals(declared, form)
        ],
        "actions": [
            {
                "action": each.action,
                "topic": _topic(each.topic),
                "type": each.type,
                "message": loads(each.message),
            }
            for each in bound
        ],
        "calls": [
            {
                "action": each.action,
                "service": _topic(each.service),
                "type": each.type,
                "request": loads(each.request),
                "limit_ns": each.limit,
            }
            for each in calls
        ],
    }


_SUMMARY = "the agent with an environment for a robot with rosbridge, to run in MCAPL"
TARGET = Target(
    "agent-runtime",
    _SUMMARY,
    emit,
    refusal,
    bundle.remark,
    names=names.everything,
    weak=Target(
        "agent-runtime",
        _SUMMARY,
        emit,
        partial(refusal, options=_WEAKEN),
        partial(bundle.remark, options=_WEAKEN),
    ),
    reads=("interceptor", "action", "call"),
    next_step="`python3 run.py` in the folder starts it",
)
