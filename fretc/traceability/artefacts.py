"""The files that targets generate from a requirement, by name and hash."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import PurePath

from compiler.emit import TARGETS
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Proof
from compiler.targets.interceptor_options import ASSUMED, assumptions_digest
from compiler.targets.python import interceptor, monitor
from compiler.targets.target import Target, TargetOptions
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.documents import RequirementEntry
from fretish.reading.memory import remembered


@dataclass(frozen=True, slots=True)
class Product:
    """A file that a target generates; `sha256` is empty if the target refuses the requirement."""

    target: str
    file: str
    sha256: str
    refusal: str


_ALWAYS = ("monitor", "ltl", "ajpf", "json")


@remembered
def products(requirement: FormalizedRequirement | None) -> tuple[Product, ...]:
    """A product for each file of the requirement, and for each target that refuses it.

    Targets outside of `_ALWAYS` are run only if `verify` of the requirement names them, because all
    targets together may take longer than the rest of the report.
    """
    if requirement is None:
        return ()
    planned = [name for name in requirement.entry.verify if name in TARGETS]
    names = [name for name in dict.fromkeys((*_ALWAYS, *planned)) if TARGETS[name].per_rule]
    return tuple(product for name in names for product in _of_target(TARGETS[name], requirement))


def monitors(
    products_of: Mapping[RequirementEntry, Sequence[Product]],
) -> Mapping[RequirementEntry, str]:
    """Requirement → SHA-256 of the monitor, for each monitor that can be generated."""
    return {
        entry: product.sha256
        for entry, some in products_of.items()
        for product in some
        if product.target == monitor.TARGET.name and product.sha256
    }


_LANGUAGES = {
    "_monitor.c": "c",
    "lib.rs": "rust",
    "_monitor.mjs": "js",
    "Monitor.java": "java",
}
"""End of a file name → target, for monitors in other languages than Python."""


def compiled_monitor(requirement: FormalizedRequirement, file: str) -> str:
    """SHA-256 of the file of this name that a target generates for the requirement alone, or "".

    Args:
        requirement: the requirement.
        file: the name of the file.
    """
    for end, target in _LANGUAGES.items():
        if file.endswith(end):
            made = _of_target(TARGETS[target], requirement)
            return next(
                (product.sha256 for product in made if PurePath(product.file).name == file), ""
            )
    return ""


_JOINT = {
    "monitors.py": "monitor",
    "monitors.c": "c",
    "lib.rs": "rust",
    "monitors.mjs": "js",
    "Monitors.java": "java",
}
"""Name of a file with a monitor for several requirements → target."""


def joint_monitors(
    requirements: Sequence[FormalizedRequirement], proofs: Iterable[Proof]
) -> frozenset[str]:
    """SHA-256 of each joint monitor that would be generated now for several requirements.

    Joint monitors are generated for all requirements, and for each group of requirements whose
    proofs are about the same file.

    Args:
        requirements: all requirements of a project, in its order; refused ones are left out of
        files.
        proofs: the recorded proofs, about these and other files.
    """
    groups: dict[tuple[str, str], list[str]] = {}
    for proof in proofs:
        for file, examined in proof.artefacts.items():
            if file in _JOINT:
                groups.setdefault((file, examined), []).append(proof.requirement)
    by_id = {requirement.id: requirement for requirement in reversed(requirements)}
    found = set[str]()
    for (file, _), ids in groups.items():
        named = [by_id[id] for id in dict.fromkeys(ids) if id in by_id]
        in_order = [requirement for requirement in requirements if requirement in named]
        orders = {
            tuple(requirement.id for requirement in group): group
            for group in (requirements, in_order, named)
        }
        found.update(_of_joint(file, order) for order in orders.values())
    return frozenset(found - {""})


def _of_joint(file: str, requirements: Sequence[FormalizedRequirement]) -> str:
    """SHA-256 of one monitor for all requirements, or "" if the target refuses all of them."""
    target = TARGETS[_JOINT[file]]
    accepted = [requirement for requirement in requirements if target.refuse(requirement) is None]
    made = target.emit(accepted, TargetOptions(one_file=True)) if accepted else ()
    return next((sha256(product.text) for product in made if product.path.name == file), "")


def _of_target(target: Target, requirement: FormalizedRequirement) -> tuple[Product, ...]:
    refusal = target.refuse(requirement)
    if refusal is not None:
        fix = f"; {refusal.help}" if refusal.help else ""
        text = f"{refusal.code.number} {refusal.message}{fix}"
        return (Product(target.name, "", "", text),)
    return tuple(
        Product(target.name, str(artifact.path), sha256(artifact.text), "")
        for artifact in target.emit([requirement])
    )


def shared_products(declarations: Declarations | None) -> tuple[Product, ...]:
    """The products of the bindings: the interceptor, and its declared assumptions."""
    declared = declarations.interceptor if declarations else None
    if declarations is None or declared is None:
        return ()
    text = interceptor.text(declared, PurePath(declarations.source.name).name)
    node = Product(interceptor.TARGET.name, interceptor.NAME, sha256(text), "")
    return (node, Product("bindings", ASSUMED, assumptions_digest(declarations), ""))
