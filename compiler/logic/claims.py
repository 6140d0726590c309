"""The proofs of `fretc verify`: one for each claim, whatever the engine.

An engine answers a claim with a `ClaimOutcome`. The `Proof` adds the claim in words, the
assumptions that the outcome holds under, the engine, and the SHA-256 of each text that was
examined.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from enum import StrEnum
from typing import Annotated, Any, Final, Literal

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
from fretish.classes.frozen import dataclass
from monitors.kernel.verdicts import Truth

SCHEMA: Final = "fretc-verification-1"


class Layer(StrEnum):
    """The object of a claim, from the monitor outwards; the values are those of `--layer`."""

    MONITOR = "monitor"
    """The code of the monitor means the same as its sentence."""
    INTERCEPTOR = "interceptor"
    """The code of the interceptor satisfies its contracts."""
    LOOP = "loop"
    """Monitor, interceptor and any environment under named assumptions satisfy the requirement
    together."""
    BOUNDS = "bounds"
    """As `loop`, for every bound and latency, not only the declared ones."""
    AGENT = "agent"
    """The agent has the properties of its property file, in fretc's own model."""
    AJPF = "ajpf"
    """As `agent`, by AJPF's own verdict, which the `run.py` of a bundle recorded."""


ALL, PROVERS = ("verify", "proof"), ("frama-c", "dafny", "crosshair")
METHODS = (*ALL, *PROVERS, *map(str, Layer))
"""Methods of `verify = [...]` that `fretc verify` can give a result for."""


class ClaimTrace(Record, frozen=True):
    """A run as a table: a row for each tick."""

    names: Annotated[
        tuple[str, ...],
        about("headings of the columns: propositions, and other values that help to read the run"),
    ]
    rows: Annotated[
        tuple[tuple[Truth, ...], ...],
        about("a row for each tick, with a value for each name; null: unknown or not applicable"),
    ]
    actions: Annotated[
        tuple[str, ...], about("what happened at each row, in words; may be empty")
    ] = ()
    cycle: Annotated[
        Count | None,
        about("the row to which the last one leads back for ever; null: the run ends"),
    ] = None

    def __post_init__(self) -> None:
        """Raise ValueError if the rows do not form a table."""
        if any(len(row) != len(self.names) for row in self.rows):
            raise ValueError("Expected a value for each name in each row")
        if len(self.actions) not in (0, len(self.rows)):
            raise ValueError("Expected as many actions as rows, or none")
        if self.cycle is not None and self.cycle >= len(self.rows):
            raise ValueError("Expected the number of a row as the cycle")


class ClaimResult(StrEnum):
    """The result of a claim; the values are the words of files and of the terminal."""

    PROVED = "proved"
    """The claim holds, under the assumptions of its proof."""
    COUNTEREXAMPLE = "counterexample"
    """The claim is wrong."""
    VACUOUS = "vacuous"
    """The claim holds trivially: its condition cannot occur."""
    NOT_CHECKED = "not checked"
    """No result is known."""
    NOT_APPLICABLE = "not applicable"
    """The claim cannot be made about this requirement, and was not requested."""


@dataclass(frozen=True, slots=True)
class ClaimOutcome:
    """An engine's answer to a claim."""

    result: ClaimResult
    detail: str
    """How much was examined; for a vacuous or unchecked claim, the reason."""
    trace: ClaimTrace | None = None
    """The run that refutes the claim; None if the engine gives none."""

    def __post_init__(self) -> None:
        assert self.trace is None or self.result is ClaimResult.COUNTEREXAMPLE


def proved(detail: str) -> ClaimOutcome:
    """The outcome of a claim that holds; the detail says how much was examined."""
    return ClaimOutcome(ClaimResult.PROVED, detail)


def refuted(detail: str, trace: ClaimTrace | None = None) -> ClaimOutcome:
    """The outcome of a claim that is wrong, with the run that shows it."""
    return ClaimOutcome(ClaimResult.COUNTEREXAMPLE, detail, trace)


def vacuous(reason: str) -> ClaimOutcome:
    """The outcome of a claim that holds trivially, with the reason."""
    return ClaimOutcome(ClaimResult.VACUOUS, reason)


def not_checked(reason: str) -> ClaimOutcome:
    """The outcome of a claim without a result, with the reason."""
    return ClaimOutcome(ClaimResult.NOT_CHECKED, reason)


def not_applicable(reason: str) -> ClaimOutcome:
    """The outcome of a claim that cannot be made about this requirement, with the reason."""
    return ClaimOutcome(ClaimResult.NOT_APPLICABLE, reason)


class Proof(Record, frozen=True):
    """One claim and its outcome, with the assumptions and texts on which the outcome rests."""

    requirement: Annotated[
        Name, about("its id; or interceptor or agent, where the claim is about those")
    ]
    layer: Layer
    claim: Annotated[Name, about("one sentence without a full stop")]
    result: ClaimResult
    detail: Annotated[str, about("how much was examined, or why nothing is known")]
    assumptions: Annotated[
        tuple[str, ...], about("what the result holds under, with where it is declared")
    ]
    engine: Annotated[str, about("with its version where it is not fretc itself")]
    artefacts: Annotated[
        dict[str, Sha256],
        about("SHA-256 of each text that was examined, by the name of its file"),
    ]
    trace: ClaimTrace | UnsetType = UNSET

    @property
    def run(self) -> ClaimTrace | None:
        """The run that refutes the claim, if there is one."""
        return self.trace if isinstance(self.trace, ClaimTrace) else None


def proof(
    requirement: str,
    layer: Layer,
    claim: str,
    outcome: ClaimOutcome,
    engine: str,
    assumptions: Sequence[str] = (),
    artefacts: Mapping[str, str] | None = None,
) -> Proof:
    """The proof of a claim.

    Args:
        requirement: the id of the requirement; or `interceptor` or `agent` for claims about those.
        layer: the object of the claim.
        claim: one sentence without a full stop.
        outcome: the answer of the engine.
        engine: the name, with its version unless it is fretc.
        assumptions: each in words, with its number and the place of its declaration.
        artefacts: name of a file → SHA-256 of the text that was examined.
    """
    return Proof(
        requirement=requirement,
        layer=layer,
        claim=claim,
        result=outcome.result,
        detail=outcome.detail,
        assumptions=tuple(assumptions),
        engine=engine,
        artefacts=dict(artefacts or {}),
        trace=UNSET if outcome.trace is None else outcome.trace,
    )


class VerificationDocument(Record, frozen=True):
    """The content of `build/verification.json`; equal texts give equal files."""

    schema: Literal["fretc-verification-1"]
    fretc: Annotated[str, about("version of the tool")]
    evidence: tuple[Proof, ...]


def schema() -> dict[str, Any]:
    """The JSON Schema of the file."""
    return json_schema(
        VerificationDocument,
        SCHEMA,
        "What has been proved, refuted or left open, as `fretc verify` writes it",
        "One object for each claim; nothing in it depends on when or where it was made.",
    )
