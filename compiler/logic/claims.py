"""The results of `fretc verify`: one line of evidence for each claim, from any engine.

A result comes with the claim in words, the assumptions that it holds under, the engine that found
it, and the SHA-256 of each text that was examined.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING, Any, assert_never

if TYPE_CHECKING:
    from monitors.kernel.verdicts import Truth

SCHEMA = "fretc-verification-1"


class Layer(StrEnum):
    """The object of a claim, from the monitor outwards; the values are those of `--layer`."""

    MONITOR = "monitor"
    """The text of the monitor means what its sentence means."""
    INTERCEPTOR = "interceptor"
    """The text of the interceptor keeps its contracts."""
    LOOP = "loop"
    """Monitor, interceptor and any environment under named assumptions keep the requirement."""
    BOUNDS = "bounds"
    """The same at every bound and latency, not only at the declared ones."""
    AGENT = "agent"
    """The text of the agent has the properties of its property file, in a model of our own."""
    AJPF = "ajpf"
    """The same by AJPF's own verdict, which the `run.py` of a bundle has recorded."""


ALL, PROVERS = ("verify", "proof"), ("dafny", "crosshair")
METHODS = (*ALL, *PROVERS, *map(str, Layer))
"""Methods of `verify = [...]` that `fretc verify` can give a result for."""


@dataclass(frozen=True, slots=True)
class Trace:
    """A run as a table: a row for each tick."""

    names: tuple[str, ...]
    """Propositions and whatever else helps to read it, as heads of the columns."""
    rows: tuple[tuple[Truth, ...], ...]
    actions: tuple[str, ...] = ()
    """The event at each row, in words; empty, or as many as rows."""
    cycle: int | None = None
    """The row to which the last one leads back for ever; None: the run ends."""

    def __post_init__(self) -> None:
        assert all(len(row) == len(self.names) for row in self.rows)
        assert len(self.actions) in (0, len(self.rows))
        assert self.cycle is None or 0 <= self.cycle < len(self.rows)


@dataclass(frozen=True, slots=True)
class Proved:
    """The claim holds, under the assumptions of its line."""

    detail: str
    """How much was examined."""


@dataclass(frozen=True, slots=True)
class Counterexample:
    """The claim is wrong, and this run shows it."""

    detail: str
    trace: Trace | None
    """None where the engine gives no run."""


@dataclass(frozen=True, slots=True)
class Vacuous:
    """The claim holds trivially: its condition cannot occur."""

    detail: str


@dataclass(frozen=True, slots=True)
class NotChecked:
    """There is no result."""

    reason: str


Result = Proved | Counterexample | Vacuous | NotChecked


@dataclass(frozen=True, slots=True)
class Evidence:
    """One claim and its result."""

    requirement: str
    layer: Layer
    claim: str
    """One sentence without a full stop."""
    result: Result
    engine: str
    """The engine of the result, with its version where it is not fretc itself."""
    assumptions: tuple[str, ...] = ()
    """Each in words that name its number and where it is declared."""
    artefacts: Mapping[str, str] = field(default_factory=dict)
    """Name of a file → SHA-256 of the text that was examined."""


PROVED, COUNTEREXAMPLE, VACUOUS, NOT_CHECKED = "proved", "counterexample", "vacuous", "not checked"
RESULTS = (PROVED, COUNTEREXAMPLE, VACUOUS, NOT_CHECKED)
"""The name of each kind of result in every output."""


def status(result: Result) -> str:
    """One of `RESULTS`."""
    match result:
        case Proved():
            return PROVED
        case Counterexample():
            return COUNTEREXAMPLE
        case Vacuous():
            return VACUOUS
        case NotChecked():
            return NOT_CHECKED
        case _:
            assert_never(result)


def document(fretc: str, evidence: Sequence[Evidence]) -> dict[str, Any]:
    """The content of `build/verification.json`; equal for equal texts, at any time.

    Args:
        fretc: the version of the tool.
        evidence: in its order.
    """
    return {"schema": SCHEMA, "fretc": fretc, "evidence": [as_record(each) for each in evidence]}


def as_record(evidence: Evidence) -> dict[str, Any]:
    """Plain values, in a fixed order of keys."""
    result = evidence.result
    detail = result.reason if isinstance(result, NotChecked) else result.detail
    trace = result.trace if isinstance(result, Counterexample) else None
    return {
        "requirement": evidence.requirement,
        "layer": str(evidence.layer),
        "claim": evidence.claim,
        "result": status(result),
        "detail": detail,
        "assumptions": list(evidence.assumptions),
        "engine": evidence.engine,
        "artefacts": dict(evidence.artefacts),
        **({"trace": _trace(trace)} if trace is not None else {}),
    }


def _trace(trace: Trace) -> dict[str, Any]:
    return {
        "names": list(trace.names),
        "rows": [list(row) for row in trace.rows],
        "actions": list(trace.actions),
        "cycle": trace.cycle,
    }
