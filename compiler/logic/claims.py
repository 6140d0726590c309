"""The results of `fretc verify`: one line of evidence for each claim, from any engine.

A result comes with the claim in words, the assumptions that it holds under, the engine that found
it, and the SHA-256 of each text that was examined.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Annotated, Any, Final, Literal, assert_never

from compiler.files.records import (
    UNSET,
    Count,
    Name,
    Record,
    Sha256,
    UnsetType,
    about,
    json_schema,
)
from monitors.kernel.verdicts import Truth

SCHEMA: Final = "fretc-verification-1"


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


class Trace(Record, frozen=True):
    """A run as a table: a row for each tick."""

    names: Annotated[
        tuple[str, ...], about("propositions and whatever else helps to read it: heads of columns")
    ]
    rows: Annotated[
        tuple[tuple[Truth, ...], ...],
        about("a row for each tick, with a value for each name; null: unknown, or nothing to tell"),
    ]
    actions: Annotated[
        tuple[str, ...], about("what happened at each row, in words; or nothing")
    ] = ()
    cycle: Annotated[
        Count | None,
        about("the row to which the last one leads back for ever; null: the run ends"),
    ] = None

    def __post_init__(self) -> None:
        """Raise ValueError where it is no table."""
        if any(len(row) != len(self.names) for row in self.rows):
            raise ValueError("Expected a value for each name in each row")
        if len(self.actions) not in (0, len(self.rows)):
            raise ValueError("Expected as many actions as rows, or none")
        if self.cycle is not None and self.cycle >= len(self.rows):
            raise ValueError("Expected the number of a row as the cycle")


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


PROVED: Final = "proved"
COUNTEREXAMPLE: Final = "counterexample"
VACUOUS: Final = "vacuous"
NOT_CHECKED: Final = "not checked"
Status = Literal["proved", "counterexample", "vacuous", "not checked"]
"""What a result is called wherever it is written."""


def status(result: Result) -> Status:
    """The name of a result."""
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


class Proof(Record, frozen=True):
    """One claim, and what is known of it, as it is written."""

    requirement: Annotated[
        Name, about("its id; or interceptor or agent, where the claim is about those")
    ]
    layer: Layer
    claim: Name
    result: Status
    detail: Annotated[str, about("how much was looked at, or why nothing is known")]
    assumptions: Annotated[
        tuple[str, ...], about("what the result holds under, with where it is declared")
    ]
    engine: str
    artefacts: Annotated[
        dict[str, Sha256],
        about("SHA-256 of each text that was looked at, by the name of its file"),
    ]
    trace: Trace | UnsetType = UNSET


class Document(Record, frozen=True):
    """What `build/verification.json` holds; the same for the same texts, whenever it is made."""

    schema: Literal["fretc-verification-1"]
    fretc: Annotated[str, about("version of the tool")]
    evidence: tuple[Proof, ...]


def document(fretc: str, evidence: Sequence[Evidence]) -> Document:
    """What is written of the claims.

    Args:
        fretc: the version of the tool.
        evidence: in its order.
    """
    return Document(SCHEMA, fretc, tuple(map(proof, evidence)))


def proof(evidence: Evidence) -> Proof:
    """What is written of a claim."""
    result = evidence.result
    trace = result.trace if isinstance(result, Counterexample) else None
    return Proof(
        requirement=evidence.requirement,
        layer=evidence.layer,
        claim=evidence.claim,
        result=status(result),
        detail=result.reason if isinstance(result, NotChecked) else result.detail,
        assumptions=tuple(evidence.assumptions),
        engine=evidence.engine,
        artefacts=dict(evidence.artefacts),
        trace=UNSET if trace is None else trace,
    )


def schema() -> dict[str, Any]:
    """The JSON Schema of the file."""
    return json_schema(
        Document,
        SCHEMA,
        "What has been proved, refuted or left open, as `fretc verify` writes it",
        "One object for each claim; nothing in it depends on when or where it was made.",
    )
