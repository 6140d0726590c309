"""What every target makes of a requirement, by name and hash."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.files import sha256
from compiler.rule import Rule
from compiler.targets import TARGETS
from compiler.targets.target import Target


@dataclass(frozen=True, slots=True)
class Product:
    """One file that a target makes; `sha256` is empty where it refuses, and `refusal` says why."""

    target: str
    file: str
    sha256: str
    refusal: str


_ORDER = ("monitor", "ltl", "ajpf", "json")


def products(rule: Rule | None) -> tuple[Product, ...]:
    """A product for each file that the targets make; for a target that refuses, why."""
    if rule is None:
        return ()
    known = [name for name in _ORDER if name in TARGETS]
    others = [name for name, target in TARGETS.items() if target.per_rule and name not in known]
    names = [*known, *others]
    return tuple(product for name in names for product in _of_target(TARGETS[name], rule))


def _of_target(target: Target, rule: Rule) -> tuple[Product, ...]:
    refused = target.refuse(rule)
    if refused is not None:
        mend = f"; {refused.help}" if refused.help else ""
        refusal = f"{refused.code.number} {refused.message}{mend}"
        return (Product(target.name, "", "", refusal),)
    return tuple(
        Product(target.name, str(artifact.path), sha256(artifact.text), "")
        for artifact in target.emit([rule])
    )
