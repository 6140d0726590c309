"""What is planned for the project in the current folder."""

from functools import cache
from pathlib import Path

from compiler.project.folder import load
from compiler.project.paths import requirement_files, sibling_path
from fretc.audit.plan import Plan, planned
from fretc.logs.signals.integrity import Integrity
from fretish.diagnostics.diagnostic import Diagnostic


def plan(integrity: Integrity = Integrity.HASH) -> Plan:
    """The plan of the requirements there; for the same texts it is made once."""
    files = sorted(Path("requirements").rglob("*.*"))
    texts = tuple((str(file), file.read_bytes()) for file in files if file.is_file())
    return _plan(texts, integrity)


@cache
def _plan(texts: tuple[tuple[str, bytes], ...], integrity: Integrity) -> Plan:
    files = requirement_files("requirements")
    assert not isinstance(files, Diagnostic)
    result = planned(load(files, sibling_path("requirements", "bindings.toml")), integrity)
    assert isinstance(result, Plan)
    return result
