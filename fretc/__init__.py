"""The product that users call, from the shell (`fretc.cli`) or from Python.

Input is projects, logs and evidence. Output is verdicts, proofs, tests and reports. The names below
are the API, which docs/api.md documents; each name is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from compiler.files.build_id import __version__ as __version__
    from compiler.formalization.formalized import FormalizedRequirement as FormalizedRequirement
    from compiler.logic.claims import Proof as Proof
    from compiler.project.project import Project as Project
    from fretc.api.audits import Audit as Audit
    from fretc.api.audits import audit_logs as audit_logs
    from fretc.api.monitors import Monitor as Monitor
    from fretc.api.monitors import load_monitor as load_monitor
    from fretc.api.monitors import monitor_text as monitor_text
    from fretc.api.proofs import verify as verify
    from fretc.api.refusal import Refusal as Refusal
    from fretc.api.reports import Report as Report
    from fretc.api.reports import make_report as make_report
    from fretc.api.requirements import Formulas as Formulas
    from fretc.api.requirements import formalize as formalize
    from fretc.api.requirements import formulas as formulas
    from fretc.api.requirements import read_project as read_project
    from fretc.api.streams import End as End
    from fretc.api.streams import Stream as Stream
    from fretc.api.streams import Tick as Tick
    from fretc.audit.evidence.schema import Result as Result
    from fretish.diagnostics.diagnostic import Diagnostic as Diagnostic

_HOMES = {
    "Audit": "fretc.api.audits",
    "Diagnostic": "fretish.diagnostics.diagnostic",
    "End": "fretc.api.streams",
    "FormalizedRequirement": "compiler.formalization.formalized",
    "Formulas": "fretc.api.requirements",
    "Monitor": "fretc.api.monitors",
    "Project": "compiler.project.project",
    "Proof": "fretc.api.proofs",
    "Refusal": "fretc.api.refusal",
    "Report": "fretc.api.reports",
    "Result": "fretc.audit.evidence.schema",
    "Stream": "fretc.api.streams",
    "Tick": "fretc.api.streams",
    "__version__": "compiler.files.build_id",
    "audit_logs": "fretc.api.audits",
    "formalize": "fretc.api.requirements",
    "formulas": "fretc.api.requirements",
    "load_monitor": "fretc.api.monitors",
    "make_report": "fretc.api.reports",
    "monitor_text": "fretc.api.monitors",
    "read_project": "fretc.api.requirements",
    "verify": "fretc.api.proofs",
}
"""The module of each name."""

_RENAMED = {"Formalized": "FormalizedRequirement"}
"""Names of the previous version: each still works, with a `DeprecationWarning`."""

__all__ = [
    "Audit",
    "Diagnostic",
    "End",
    "FormalizedRequirement",
    "Formulas",
    "Monitor",
    "Project",
    "Proof",
    "Refusal",
    "Report",
    "Result",
    "Stream",
    "Tick",
    "__version__",
    "audit_logs",
    "formalize",
    "formulas",
    "load_monitor",
    "make_report",
    "monitor_text",
    "read_project",
    "verify",
]


def __getattr__(name: str) -> object:
    """The value of a name, which stays: it is not asked for again."""
    if name in _RENAMED:
        import warnings

        message = f"`fretc.{name}` is now `fretc.{_RENAMED[name]}`"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        return __getattr__(_RENAMED[name])
    if name not in _HOMES:
        raise AttributeError(f"module `fretc` has no attribute `{name}`", name=name)
    value = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
