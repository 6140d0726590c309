"""Reader of the suite in a file of `fretc test`.

The file is not trusted: values outside the types of `fretc.testing.suite` are F503.
"""

from __future__ import annotations

import json

from compiler.files.checked_json import SchemaError, parsed
from compiler.files.records import decoded
from compiler.files.text_files import read as read_text
from fretc.testing.suite import Suite
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source

DEFAULT = "build/tests/suite.json"
"""Default path of the output of `fretc test`."""


def read(path: str) -> Suite | Diagnostic:
    """Read and check a file of `fretc test`."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return source
    try:
        return decoded(parsed(source.text).value, Suite)
    except json.JSONDecodeError as error:
        return _wrong(source, f"is not JSON: {error.msg[:1].lower()}{error.msg[1:]}")
    except (SchemaError, ValueError) as error:
        return _wrong(source, f"is not what `fretc test` writes: {error}")
    except RecursionError:
        return _wrong(source, "is not JSON that fretc can read: it is nested too deeply")


def _wrong(source: Source, what: str) -> Diagnostic:
    return diagnostic(
        "bad_test_result", Source(source.name, "").span(), source=source.name, what=what
    )
