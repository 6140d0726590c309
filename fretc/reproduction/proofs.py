"""Recheck of proofs: each claim of `fretc verify` is proved again and compared.

Only claims about files that fretc generates are proved again, with the layers, provers and
languages that the file of proofs names. Claims about other files, claims of a prover that is not
installed, and results of AJPF are not checked.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

from compiler.files.build_id import __version__
from compiler.files.records import plain
from compiler.logic.claims import ALL, METHODS, PROVERS, ClaimResult, Layer, Proof
from compiler.project.project import Project
from compiler.targets.python import monitor
from fretc.reproduction.outcome import PROOFS, ItemOutcome, Recheck, differs, unknown
from fretc.reproduction.texts import other_build, remade
from fretc.verification.ajpf_results import ajpf_proofs
from fretc.verification.engines.sandbox import CallLimits
from fretc.verification.layers.request import Progress, Request
from fretc.verification.reader import Proofs, ajpf_results
from fretc.verification.verify import prove
from fretish.diagnostics.diagnostic import Diagnostic

AGENT = "agent"
"""The name used as requirement of claims about a user's agent."""


def prove_again(
    project: Project,
    proofs: Proofs,
    limits: CallLimits,
    claimed: Collection[str],
    progress: Progress,
) -> tuple[Recheck, ...] | Diagnostic:
    """Prove every claim of a file again.

    Args:
        project: the requirements as they are now.
        proofs: the file.
        limits: limits for each claim.
        claimed: the selected requirements.
        progress: called before each slow claim.
    """
    records = [proof for proof in proofs.proofs if _is_asked_for(proof, project, claimed)]
    proofs_now = _prove(project, records, limits, progress)
    if isinstance(proofs_now, Diagnostic):
        return proofs_now
    return (
        *_beginning(proofs),
        *(_compared(record, proofs_now) for record in records),
        *_twice(records),
        *_left_out(records, proofs_now),
    )


def unproved_plans(
    project: Project, proofs: Sequence[Proof], claimed: Collection[str]
) -> Iterator[Recheck]:
    """Planned repeatable methods without a claim in the file."""
    for requirement in project.requirements:
        for method in dict.fromkeys(requirement.verify):
            repeatable = method in METHODS and method != Layer.AJPF
            own = [proof for proof in proofs if proof.requirement in (requirement.id, *_SHARED)]
            if (
                requirement.id in claimed
                and repeatable
                and not any(_is_of(proof, method) for proof in own)
            ):
                why = f"{requirement.id} plans `{method}` but the file has no proof of it"
                yield unknown(PROOFS, requirement.id, why)


_SHARED = ("interceptor", AGENT)
"""Names used as requirement of claims about several requirements."""


def _is_of(proof: Proof, method: str) -> bool:
    """Whether the proof is a result of the planned method."""
    return method in (*ALL, proof.layer) or method == _prover(proof.engine)


def _prover(engine: str) -> str:
    """The prover of `--with` in the name of an engine, or ""."""
    name = engine.casefold().partition(" ")[0]
    return name if name in PROVERS else ""


def _is_asked_for(record: Proof, project: Project, claimed: Collection[str]) -> bool:
    """Whether a claim is about a selected or an unknown requirement."""
    ids = {requirement.id for requirement in project.requirements}
    return record.requirement in claimed or record.requirement not in ids


# Again ------------------------------------------------------------------------------------------


def _prove(
    project: Project, records: Sequence[Proof], limits: CallLimits, progress: Progress
) -> Sequence[Proof] | Diagnostic:
    """Prove the requirements again, with the layers and provers that the file names."""
    named = {record.requirement for record in records}
    own = [record for record in records if not _prover(record.engine)]
    layers = [layer for layer in Layer if any(record.layer == layer for record in own)]
    if AGENT in named:
        layers = [layer for layer in layers if layer != Layer.AGENT]
    requirements = [
        requirement
        for requirement in project.formalized
        if requirement.id in named and monitor.refuse(requirement) is None
    ]
    monitor_text, header = remade(own, project.formalized)
    plans_agent = {
        requirement.id
        for requirement in project.requirements
        if {Layer.AGENT, Layer.AJPF} & {*requirement.verify}
    }
    of_agent = {record.requirement for record in own if record.layer is Layer.AGENT}
    request = Request(
        layers,
        limits,
        monitor=monitor_text,
        header=header,
        demanded=(Layer.AGENT,) if of_agent - plans_agent else (),
        provers=sorted({_prover(record.engine) for record in records} - {""}),
        ajpf=ajpf_proofs(requirements, ajpf_results())[0] if Layer.AJPF in layers else (),
        progress=progress,
    )
    return prove(replace(project, formalized=tuple(requirements)), request)


def _key(record: Proof) -> tuple[str, ...]:
    return record.requirement, record.layer, record.claim, _prover(record.engine)


# Compared ---------------------------------------------------------------------------------------


def _beginning(proofs: Proofs) -> Iterator[Recheck]:
    if proofs.fretc != __version__:
        yield differs(PROOFS, "", f"the installed fretc is {__version__}")
    if not proofs.proofs:
        yield unknown(PROOFS, "", f"`{proofs.file}` contains no claim")


def _compared(record: Proof, proofs_now: Sequence[Proof]) -> Recheck:
    requirement, claim = record.requirement, f"{record.layer}: {record.claim}"
    now = next((candidate for candidate in proofs_now if _key(candidate) == _key(record)), None)
    if now is None:
        return _absence(record, claim)
    others = record.artefacts.keys() - now.artefacts.keys()
    if others:
        why = f"it is about `{min(others)}`, which this check does not generate"
        return unknown(PROOFS, requirement, why, claim=claim)
    if now.result is ClaimResult.NOT_CHECKED:
        return unknown(PROOFS, requirement, now.detail, claim=claim)
    other = other_build(record, now) if record.result is now.result else ""
    if other:
        return unknown(PROOFS, requirement, other, claim=claim)
    reasons = tuple(_differences(record, now))
    if record.result is ClaimResult.NOT_CHECKED and now.result is not ClaimResult.COUNTEREXAMPLE:
        why = f"the file says that it was not checked; now it is {now.result}"
        return unknown(PROOFS, requirement, why, claim=claim)
    if reasons:
        return differs(PROOFS, requirement, *reasons, claim=claim)
    if record.layer == Layer.AJPF:
        return unknown(PROOFS, requirement, "AJPF itself was not run again", claim=claim)
    return Recheck(PROOFS, requirement, ItemOutcome.STANDS, (), claim)


def _absence(record: Proof, claim: str) -> Recheck:
    """The outcome for a claim that was not made again."""
    if record.layer == Layer.AJPF:
        why = "the file with AJPF's result is missing"
    elif record.layer == Layer.AGENT and record.requirement == AGENT:
        why = "it is about an agent that this check does not generate"
    else:
        return differs(
            PROOFS, record.requirement, "fretc does not make this claim now", claim=claim
        )
    return unknown(PROOFS, record.requirement, why, claim=claim)


def _differences(before: Proof, now: Proof) -> Iterator[str]:
    if before.result != now.result:
        yield f"it is {now.result} now, and was {before.result}"
    if before.artefacts != now.artefacts:
        yield "it is about other files than those generated now"
    names = [name for name in sorted(plain(before) | plain(now)) if name not in _COMPARED]
    others = [name for name in names if getattr(before, name) != getattr(now, name)]
    if others:
        yield f"it differs in {', '.join(others)}"


_COMPARED = ("result", "artefacts")


def _twice(records: Sequence[Proof]) -> Iterator[Recheck]:
    for (requirement, layer, claim, _), count in Counter(map(_key, records)).items():
        if count > 1:
            yield differs(PROOFS, requirement, "it appears twice", claim=f"{layer}: {claim}")


def _left_out(records: Sequence[Proof], proofs_now: Sequence[Proof]) -> Iterator[Recheck]:
    keys = {_key(record) for record in records}
    for record in proofs_now:
        if _key(record) not in keys and record.result is not ClaimResult.NOT_APPLICABLE:
            claim = f"{record.layer}: {record.claim}"
            yield differs(PROOFS, record.requirement, "it is missing from the file", claim=claim)
