"""The table of all targets of `--emit`.

The names are available at once. A target's module is imported on first use, so that `--help` is
fast.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from compiler.formalization.formalized import FormalizedRequirement
    from compiler.targets.target import Target

_MODULES: Mapping[str, str] = {
    "ltl": "ltl",
    "monitor": "python.monitor",
    "c": "c.monitor",
    "rust": "rust.monitor",
    "js": "javascript.monitor",
    "java": "java.monitor",
    "ajpf": "ajpf.properties",
    "ajpf-bundle": "ajpf.bundle",
    "agent-runtime": "ajpf.runtime",
    "interceptor": "python.interceptor",
    "ros1-package": "ros.ros1",
    "ros2-package": "ros.ros2",
    "ros2-cpp-package": "ros.ros2cpp",
    "dafny": "dafny",
    "smv": "automata.smv",
    "hoa": "automata.hoa",
    "dot": "automata.dot",
    "prism": "prism",
    "json": "json_record",
    "fret-json": "fret",
}
"""Target name → module below `compiler.targets` that has its `TARGET`, in the order of the help."""


class _Targets(Mapping[str, "Target"]):
    def __getitem__(self, name: str) -> Target:
        return cast("Target", import_module(f"compiler.targets.{_MODULES[name]}").TARGET)

    def __contains__(self, name: object) -> bool:
        return name in _MODULES

    def __iter__(self) -> Iterator[str]:
        return iter(_MODULES)

    def __len__(self) -> int:
        return len(_MODULES)


TARGETS: Mapping[str, Target] = _Targets()


def renamed_propositions(requirement: FormalizedRequirement) -> dict[str, dict[str, str]]:
    """For each kind of file: the names that are spelt differently there, with the spelling."""
    from compiler.logic.printing import is_compound

    renamed_names: dict[str, dict[str, str]] = {}
    for kind, target in TARGETS.items():
        names = target.names(requirement).items()
        own = {name: new for name, new in names if name != new and not is_compound(name)}
        renamed_names |= {kind: own} if own else {}
    return renamed_names
