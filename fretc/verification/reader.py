"""Reader of the proofs in a file of `fretc verify`.

The file is not trusted: values outside the types of `compiler.logic.claims` are F503.
"""

from __future__ import annotations

from pathlib import Path

from compiler.files import records
from compiler.files.text_files import sha256
from compiler.logic.claims import ClaimResult, Proof, VerificationDocument
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic


@dataclass(frozen=True, slots=True)
class Proofs:
    """Content of a proof file, with its name and its SHA-256."""

    file: str
    sha256: str
    document: VerificationDocument

    @property
    def fretc(self) -> str:
        """Version of fretc that proved the claims."""
        return self.document.fretc

    @property
    def proofs(self) -> tuple[Proof, ...]:
        """One proof for each claim that applies to its requirement."""
        evidence = self.document.evidence
        return tuple(each for each in evidence if each.result is not ClaimResult.NOT_APPLICABLE)


DEFAULT = "build/verification.json"
"""Default path of the output of `fretc verify`."""


AJPF_RESULTS = "build/*_ajpf/result.json"
"""Default paths of the results of `--emit ajpf-bundle -o build/` and `run.py`."""


def ajpf_results() -> tuple[str, ...]:
    """The result files of AJPF at the default paths."""
    return tuple(sorted(map(str, Path().glob(AJPF_RESULTS))))


def read(path: str) -> Proofs | Diagnostic:
    """Read and check a file of `fretc verify`."""
    file = records.read(
        path, VerificationDocument, "fretc verify", "verify again: `fretc verify FILE...`"
    )
    if isinstance(file, Diagnostic):
        return file
    source, document = file
    return Proofs(source.name, sha256(source.text), document)


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
