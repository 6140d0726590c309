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
from compiler.estimates import estimates
from compiler.files import file_sha256
from compiler.plan import Claim, Plan
from fretish.diagnostic import Diagnostic
from fretish.ordering import natural
from monitors.inputs import shown as called


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
    now = {(result["run"], result["requirement"]): result for result in audit.results}
    return (
        *_beginning(whole, plan),
        *(_compared(result, now, places) for result in told),
        *_left_out(whole),
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
    if not whole["results"]:
        yield Rechecked(FILE, "", Finding.UNKNOWN, ("it tells of no run",))
    if whole["fretc"] != __version__:
        yield Rechecked(FILE, "", Finding.DIFFERS, (f"this is fretc {__version__}",))
    if _within(whole.get("bindings"), "sha256") != plan.bindings:
        yield Rechecked(FILE, "", Finding.DIFFERS, ("what the bindings say has changed",))
    for told in _objects(whole.get("requirements")):
        claim = claims.get(str(told.get("id")))
        said = (told.get("sentence"), told.get("sha256"))
        if claim is None:
            why = "it is not claimed any more"
        elif said != (claim.sentence, claim.sha256):
            why = "the sentence has changed"
        else:
            continue
        yield Rechecked(FILE, str(told.get("id")), Finding.DIFFERS, (why,))


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


def _compared(
    told: Mapping[str, Any],
    now: Mapping[tuple[str, str], Mapping[str, Any]],
    places: Mapping[str, str],
) -> Rechecked:
    run, requirement = told["run"], told["requirement"]
    place = places.get(run)
    if place is None:
        return Rechecked(run, requirement, Finding.UNKNOWN, ("its log is not found",))
    found = now.get((called(place), requirement))
    if found is None:
        return Rechecked(run, requirement, Finding.DIFFERS, ("it is not claimed any more",))
    reasons = tuple(_differences(told, found, place))
    return Rechecked(run, requirement, Finding.DIFFERS if reasons else Finding.STANDS, reasons)


def _differences(told: Mapping[str, Any], now: Mapping[str, Any], place: str) -> Iterator[str]:
    names = {"log": "the log", "sentence": "the sentence", "bindings": "what the bindings say"}
    for name in (*names, "monitor"):
        before, after = told["hashes"].get(name), now["hashes"].get(name)
        if name == "log" and after is None:
            after = file_sha256(place)
        if name == "log" and before is None:
            continue  # by its index a log is read without being hashed
        if before != after:
            yield f"{names.get(name, 'the monitor')} has changed"
    if told["verdict"] != now["verdict"]:
        yield f"the verdict is {now['verdict']}, and was {told['verdict']}"
    fields = sorted({*told, *now} - {"run", "requirement", "verdict", "hashes", "health"})
    others = [name for name in fields if told.get(name) != now.get(name)]
    if _health(told) != _health(now):
        others.append("health")
    if others:
        yield f"it differs in {', '.join(others)}"


def _health(result: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in result["health"].items() if name != "checked"}
