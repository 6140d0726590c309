"""Reader of the suite in a file of `fretc test`.

The file is not trusted: values outside the types of `fretc.testing.suite` are F503.
"""

from __future__ import annotations

from compiler.files import records
from fretc.testing.suite import Suite
from fretish.diagnostics.diagnostic import Diagnostic

DEFAULT = "build/tests/suite.json"
"""Default path of the output of `fretc test`."""


def read(path: str) -> Suite | Diagnostic:
    """Read and check a file of `fretc test`."""
    again = f"generate it again: `fretc test -o {path}`"
    file = records.read(path, Suite, "fretc test", again)
    return file if isinstance(file, Diagnostic) else file[1]
