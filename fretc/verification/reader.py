"""Reader of the proofs in a file of `fretc verify`.

The file is not trusted: values outside the types of `compiler.logic.claims` are F503.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from compiler.files.checked_json import SchemaError, parsed
from compiler.files.records import decoded
from compiler.files.text_files import read as read_text
from compiler.files.text_files import sha256
from compiler.logic.claims import Document, Proof, Result
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source


@dataclass(frozen=True, slots=True)
class Proofs:
    """Content of a proof file, with its name and its SHA-256."""

    file: str
    sha256: str
    document: Document

    @property
    def fretc(self) -> str:
        """Version of fretc that proved the claims."""
        return self.document.fretc

    @property
    def proofs(self) -> tuple[Proof, ...]:
        """One proof for each claim that applies to its requirement."""
        evidence = self.document.evidence
        return tuple(each for each in evidence if each.result is not Result.NOT_APPLICABLE)


DEFAULT = "build/verification.json"
"""Default path of the output of `fretc verify`."""


def read(path: str) -> Proofs | Diagnostic:
    """Read and check a file of `fretc verify`."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return source
    try:
        document = decoded(parsed(source.text).value, Document)
        return Proofs(source.name, sha256(source.text), document)
    except json.JSONDecodeError as error:
        return _wrong(source, f"is not JSON: {error.msg[:1].lower()}{error.msg[1:]}")
    except SchemaError as error:
        return _wrong(source, f"is not what `fretc verify` writes: {error}")
    except RecursionError:
        return _wrong(source, "is not JSON that fretc can read: it is nested too deeply")
    except ValueError as error:
        return _wrong(source, f"is not JSON that fretc can read: {error}")


def known(path: str | None) -> tuple[Proof, ...] | Diagnostic:
    """Proofs of a file, or of the default file if it exists; empty: there is none."""
    place = path or default_path()
    file = read(place) if place is not None else None
    if file is None or isinstance(file, Diagnostic):
        return file or ()
    return file.proofs


def default_path() -> str | None:
    """Default path of the proofs, if the file exists."""
    return DEFAULT if Path(DEFAULT).exists() else None


def _wrong(source: Source, what: str) -> Diagnostic:
    return diagnostic("bad_proof", Source(source.name, "").span(), source=source.name, what=what)
