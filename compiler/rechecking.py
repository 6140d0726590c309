"""Whether evidence still stands: the hashes of its logs and its verdicts, made again.

Everything is made anew from the logs and the requirements as they are now, and compared with what
the evidence says, field by field. Only how much of a log was looked at may differ.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from compiler import __version__
from compiler.auditing import Audit, Engine, audit_logs
from compiler.basis import BINDINGS, KINDS, SENTENCE, of_all, outdated, why
from compiler.estimates import estimates
from compiler.files import file_sha256, sha256
from compiler.plan import Claim, Plan
from fretish.diagnostic import Diagnostic
from fretish.ordering import natural
from fretish.parser import parse
from fretish.printer import canonical
from fretish.source import Source
from monitors.inputs import shown as called
from monitors.integrity import Integrity
from monitors.recordings import read


class Finding(StrEnum):
    """What became of one result."""

    STANDS = "stands"
    DIFFERS = "differs"
    UNKNOWN = "not checked"


@dataclass(frozen=True, slots=True)
class Rechecked:
    """One run and requirement of the evidence, made again."""

    run: str
    requirement: str
    finding: Finding
    reasons: tuple[str, ...]
    """Empty where it stands."""


def located(runs: Sequence[str], folder: str | None) -> dict[str, str]:
    """Run → where its log is now: its path, or the file of that name below a folder.

    A run whose log is not found is left out; of several files of one name the one whose path ends
    most alike counts.
    """
    found: dict[str, str] = {}
    for run in runs:
        place = run if folder is None else _below(Path(folder), run)
        if place is not None and ("://" in place or Path(place).exists()):
            found[run] = place
    return found


def _below(folder: Path, run: str) -> str | None:
    name = Path(run).name
    here = [path for path in sorted(folder.rglob("*")) if path.name == name]
    return str(max(here, key=lambda path: _alike(path, Path(run)))) if here else None


def _alike(path: Path, run: Path) -> int:
    """How many parts are the same, from the end."""
    pairs = zip(reversed(path.parts), reversed(run.parts), strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), len(run.parts))


def rechecked(
    text: str, plan: Plan, places: Mapping[str, str], engine: Engine
) -> tuple[Rechecked, ...] | Diagnostic:
    """Make every result of an evidence file again.

    Args:
        text: the evidence, in its right shape.
        plan: what logs are judged by now.
        places: run → where its log is now.
        engine: where logs are audited.

    Returns:
        What became of each result, in the order of the file, between what is wrong with the file
        itself and what all runs together say; or why the engine gave up.
    """
    whole = json.loads(text)
    told = whole["results"]
    runs = list(dict.fromkeys(result["run"] for result in told))
    logs = list(dict.fromkeys(places[run] for run in runs if run in places))
    audit = audit_logs(plan, logs, engine)
    if isinstance(audit, Diagnostic):
        return audit
    now = _Now(plan, places, {(r["run"], r["requirement"]): r for r in audit.results})
    return (
        *_beginning(whole, plan),
        *(each for result in told for each in _result(result, now)),
        *_left_out(whole),
        *_found(whole, now),
        *_together(whole, plan, audit, places),
    )


# The file as a whole ----------------------------------------------------------------------------

FILE, ALL_RUNS = "the file", "all runs"
"""In the place of a run."""
_DOUBT = (0.5, 0.999)
"""Confidences that an audit takes."""


def _beginning(whole: Mapping[str, Any], plan: Plan) -> Iterator[Rechecked]:
    """What is said before the results, where it is not as it is now; and whether there are any."""
    claims = {claim.id: claim for claim in plan.claims}
    named = [str(told.get("id")) for told in _objects(whole.get("requirements"))]
    bound = of_all({id: claims[id].basis[BINDINGS] for id in named if id in claims})
    if not whole["results"]:
        yield Rechecked(FILE, "", Finding.UNKNOWN, ("it tells of no run",))
    if whole["fretc"] != __version__:
        yield Rechecked(FILE, "", Finding.DIFFERS, (f"this is fretc {__version__}",))
    if _within(whole.get("bindings"), "sha256") != bound:
        yield Rechecked(FILE, "", Finding.DIFFERS, ("what the bindings say has changed",))
    for told in _objects(whole.get("requirements")):
        claim = claims.get(str(told.get("id")))
        sentence = str(told.get("sentence"))
        if claim is None:
            why = "it is not claimed any more"
        elif {told.get("sha256"), _meant(sentence)} != {claim.basis[SENTENCE]}:
            why = "the sentence has changed"
        else:
            continue
        yield Rechecked(FILE, str(told.get("id")), Finding.DIFFERS, (why,))


def _meant(sentence: str) -> str:
    """SHA-256 of the canonical wording; empty where it is no sentence."""
    tree = parse(Source("evidence", sentence).span())
    return "" if isinstance(tree, Diagnostic) else sha256(canonical(tree))


def _left_out(whole: Mapping[str, Any]) -> Iterator[Rechecked]:
    """Each run tells of each requirement that the file names, once."""
    found = Counter((result["run"], result["requirement"]) for result in whole["results"])
    named = {str(told.get("id")) for told in _objects(whole.get("requirements"))}
    for run in dict.fromkeys(run for run, _ in found):
        for requirement in sorted(named | {id for other, id in found if other == run}, key=natural):
            count = found[run, requirement]
            if count > 1:
                yield Rechecked(run, requirement, Finding.DIFFERS, ("it is told twice",))
            elif not count:
                yield Rechecked(run, requirement, Finding.DIFFERS, ("its result is left out",))
            elif requirement not in named:
                why = "the file does not name it among its requirements"
                yield Rechecked(run, requirement, Finding.DIFFERS, (why,))


def _together(
    whole: Mapping[str, Any], plan: Plan, audit: Audit, places: Mapping[str, str]
) -> Iterator[Rechecked]:
    """What all runs say of each requirement with a probability, made again of the same runs."""
    told = {one["requirement"]: one for one in whole.get("probabilities", ())}
    named = {str(one.get("id")) for one in _objects(whole.get("requirements"))}
    asked = [c for c in plan.claims if c.chance is not None and c.id in {*told, *named}]
    missing = any(result["run"] not in places for result in whole["results"])
    for claim in asked:
        one = told.pop(claim.id, None)
        if one is None:
            finding, why = Finding.DIFFERS, "what all runs say of it is left out"
        elif missing:
            finding, why = Finding.UNKNOWN, "a log is not found"
        else:
            why = _estimated_otherwise(one, claim, audit)
            finding = Finding.DIFFERS if why else Finding.STANDS
        yield Rechecked(ALL_RUNS, claim.id, finding, (why,) if why else ())
    for id in told:
        why = "no probability is claimed of it any more"
        yield Rechecked(ALL_RUNS, id, Finding.DIFFERS, (why,))


def _estimated_otherwise(told: Mapping[str, Any], claim: Claim, audit: Audit) -> str:
    """How it differs from what is made now; empty where it does not."""
    least, most = _DOUBT
    if not least < told["confidence"] <= most:
        return f"its confidence is none above {least} and up to {most}"
    (made,) = estimates([claim], audit.results, told["confidence"])
    now = made.as_record
    if told["answer"] != now["answer"]:
        return f"the answer is {now['answer']}, and was {told['answer']}"
    others = [name for name in sorted({*told, *now}) if told.get(name) != now.get(name)]
    return f"it differs in {', '.join(others)}" if others else ""


def _objects(value: Any) -> list[Mapping[str, Any]]:
    return [one for one in value if isinstance(one, dict)] if isinstance(value, list) else []


def _within(value: Any, name: str) -> Any:
    return value.get(name) if isinstance(value, dict) else None


# One result -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Now:
    """What is made of the logs now."""

    plan: Plan
    places: Mapping[str, str]
    """Run → where its log is."""
    results: Mapping[tuple[str, str], Mapping[str, Any]]


def _result(told: Mapping[str, Any], now: _Now) -> Iterator[Rechecked]:
    run, requirement = told["run"], told["requirement"]
    place = now.places.get(run)
    if place is None:
        yield Rechecked(run, requirement, Finding.UNKNOWN, ("its log is not found",))
        return
    found = now.results.get((called(place), requirement))
    if found is None:
        yield Rechecked(run, requirement, Finding.DIFFERS, ("it is not claimed any more",))
        return
    reasons = tuple(_differences(told, found, place, now.plan))
    yield Rechecked(run, requirement, Finding.DIFFERS if reasons else Finding.STANDS, reasons)


def _differences(
    told: Mapping[str, Any], now: Mapping[str, Any], place: str, plan: Plan
) -> Iterator[str]:
    if _is_another_log(told["hashes"], now["hashes"], place, plan):
        yield "the log has changed"
    yield from map(why, outdated(told["hashes"], {kind: now["hashes"][kind] for kind in KINDS}))
    if told["verdict"] != now["verdict"]:
        yield f"the verdict is {now['verdict']}, and was {told['verdict']}"
    others = [name for name in sorted({*told, *now} - _APART) if told.get(name) != now.get(name)]
    if _health(told) != _health(now):
        others.append("health")
    if ({*told["assumptions"]} ^ {*now["assumptions"]}) - _defaults(plan):
        others.append("assumptions")
    if others:
        yield f"it differs in {', '.join(others)}"


def _is_another_log(
    told: Mapping[str, str], now: Mapping[str, str], place: str, plan: Plan
) -> bool:
    """Where it was read by its index only its summary was hashed: that of now is, too."""
    if "log" in told:
        return told["log"] != (now.get("log") or file_sha256(place))
    if "log_summary" not in told:
        return False
    recording = read(place, plan.declarations, tuple(plan.declarations.signals), Integrity.INDEX)
    if isinstance(recording, Diagnostic) or recording.checked.hashed:
        return True  # it is not as its index says, and it was
    return told["log_summary"] != recording.sha256


def _defaults(plan: Plan) -> set[str]:
    """Whether a default is taken or written out is no difference."""
    return {default.text for default in plan.declarations.defaults}


_APART = {"run", "requirement", "verdict", "hashes", "health", "assumptions"}
"""What is compared in a way of its own."""


def _health(result: Mapping[str, Any]) -> dict[str, Any]:
    """But for how much was looked at, and for what was found, which is about the whole run."""
    apart = ("checked", "findings")
    return {name: value for name, value in result["health"].items() if name not in apart}


def _found(whole: Mapping[str, Any], now: _Now) -> Iterator[Rechecked]:
    """What was found of each run, whichever requirement it is about."""
    results: dict[str, list[Mapping[str, Any]]] = {}
    for told in whole["results"]:
        results.setdefault(told["run"], []).append(told)
    of_now = {run: _findings(result) for (run, _), result in now.results.items()}
    for run, told in results.items():
        known = of_now.get(called(now.places[run])) if run in now.places else None
        if known is not None and any(_findings(result) != known for result in told):
            yield Rechecked(run, "", Finding.DIFFERS, ("what is found of its log differs",))


def _findings(result: Mapping[str, Any]) -> list[dict[str, Any]]:
    """But for where in the bindings they point to: a comment above moves that."""
    places = ("file", "line", "column")
    return [
        {name: value for name, value in finding.items() if name not in places}
        for finding in result["health"]["findings"]
    ]
