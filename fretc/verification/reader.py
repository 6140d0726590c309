"""What `fretc verify` has found, as its file says it, in checked shapes.

Nothing in the file is trusted: a wrong shape anywhere is F503. Its form is that of
`compiler.logic.claims.document`, and what is unknown is refused; runs that show something stay in
the file.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from compiler.files.checked_json import MisshapenError, Shape, parsed
from compiler.files.json_schema import misfit
from compiler.files.text_files import read as read_text
from compiler.files.text_files import sha256
from compiler.logic.claims import RESULTS, SCHEMA, Layer
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source


@dataclass(frozen=True, slots=True)
class Proof:
    """One claim, and what is known of it."""

    requirement: str
    """Its id; or `interceptor` or `agent`, where the claim is about those."""
    layer: str
    claim: str
    result: str
    detail: str
    assumptions: tuple[str, ...]
    engine: str
    artefacts: Mapping[str, str]
    """Name of a file → SHA-256 of the text that was looked at."""


@dataclass(frozen=True, slots=True)
class Proofs:
    """A whole file."""

    file: str
    sha256: str
    fretc: str
    proofs: tuple[Proof, ...]
    records: Sequence[Mapping[str, Any]]
    """The same proofs as plain values, with their runs."""


DEFAULT = "build/verification.json"
"""Where `fretc verify` writes."""


def read(path: str) -> Proofs | Diagnostic:
    """Read and check a file of `fretc verify`."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return source
    try:
        return _proofs(parsed(source.text), source)
    except json.JSONDecodeError as error:
        return _wrong(source, f"is not JSON: {error.msg[:1].lower()}{error.msg[1:]}")
    except MisshapenError as error:
        return _wrong(source, f"is not what `fretc verify` writes: {error}")
    except RecursionError:
        return _wrong(source, "is not JSON that fretc can read: it is nested too deeply")
    except ValueError as error:
        return _wrong(source, f"is not JSON that fretc can read: {error}")


def known(path: str | None) -> tuple[Proof, ...] | Diagnostic:
    """The proofs of a file; None: of the one at its usual place, where there is one."""
    place = path or written()
    found = read(place) if place is not None else None
    if found is None or isinstance(found, Diagnostic):
        return found or ()
    return found.proofs


def written() -> str | None:
    """The file of `fretc verify` at its usual place, if there is one."""
    return DEFAULT if Path(DEFAULT).exists() else None


def _wrong(source: Source, what: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_EVIDENCE,
        f"`{source.name}` {what}",
        Source(source.name, "").span(),
        help="verify again: `fretc verify FILE...`",
    )


def _proofs(file: Shape, source: Source) -> Proofs:
    if file.field("schema").text() != SCHEMA:
        raise file.field("schema").wrong(f"`{SCHEMA}`")
    found = Proofs(
        source.name,
        sha256(source.text),
        file.field("fretc").text(),
        tuple(map(_proof, file.field("evidence").items())),
        tuple(_record(each) for each in file.field("evidence").items()),
    )
    wrong = misfit(file.value, "verification")
    if wrong:
        raise MisshapenError(wrong)
    return found


def _record(at: Shape) -> Mapping[str, Any]:
    assert isinstance(at.value, dict)
    return at.value


def _proof(at: Shape) -> Proof:
    artefacts = at.field("artefacts").fields()
    return Proof(
        requirement=at.field("requirement").text(),
        layer=at.field("layer").one_of([str(layer) for layer in Layer]),
        claim=at.field("claim").text(),
        result=at.field("result").one_of(RESULTS),
        detail=at.field("detail").text(),
        assumptions=tuple(text.text() for text in at.field("assumptions").items()),
        engine=at.field("engine").text(),
        artefacts={name: value.text() for name, value in artefacts.items()},
    )
