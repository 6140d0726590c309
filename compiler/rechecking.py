"""Whether evidence still stands: the hashes of its logs and its verdicts, made again.

Everything is made anew from the logs and the requirements as they are now, and compared with what
the evidence says, field by field. Only how much of a log was looked at may differ.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

from compiler.auditing import Engine, audit_logs
from compiler.files import file_sha256
from compiler.plan import Plan
from fretish.diagnostic import Diagnostic
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
        What became of each result, in the order of the file; or why the engine gave up.
    """
    told = json.loads(text)["results"]
    runs = list(dict.fromkeys(result["run"] for result in told))
    logs = list(dict.fromkeys(places[run] for run in runs if run in places))
    audit = audit_logs(plan, logs, engine)
    if isinstance(audit, Diagnostic):
        return audit
    now = {(result["run"], result["requirement"]): result for result in audit.results}
    return tuple(_compared(result, now, places) for result in told)


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
