"""Software bill of materials of the installed fretc, in CycloneDX 1.6.

The only module that imports cyclonedx, which an extra installs.

Sources: CycloneDX 1.6, https://cyclonedx.org/docs/1.6/json/; Python core metadata 2.4.
"""

from __future__ import annotations

import uuid
from collections.abc import Iterable, Iterator, Mapping
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from typing import TYPE_CHECKING

from compiler.files.dates import now
from fretish.bindings.canonical import digest
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import unless_installed

if TYPE_CHECKING:
    from cyclonedx.model.bom import Bom
    from cyclonedx.model.component import Component
    from packaging.requirements import Requirement

TOOL = "fretc"
_OF_DEVELOPERS = ("dev", "peers")
"""Extras that no command needs."""
_SHORT = 64
"""Maximum characters of the name of a licence; a longer text is the licence itself."""

Name = tuple[str, frozenset[str]]
"""A distribution and its requested extras."""


def missing() -> Diagnostic | None:
    """F908 if the library for bills of materials is not installed."""
    packages = ["cyclonedx", "packageurl", "packaging"]
    return unless_installed("a bill of materials needs", packages, "sbom")


def sbom(root: str = TOOL) -> str:
    """The bill of materials of a distribution and its installed dependencies, as JSON."""
    from cyclonedx.output.json import JsonV1Dot6

    return f"{JsonV1Dot6(_bom(root)).output_as_string(indent=2)}\n"


def _bom(root: str) -> Bom:
    from cyclonedx.model.bom import Bom, BomMetaData
    from cyclonedx.model.component import ComponentType

    needs = closure(root)
    parts = {name: _component(distribution(name)) for name in needs}
    parts[_canonical(root)].type = ComponentType.APPLICATION
    main = parts[_canonical(root)]
    versions = sorted((part.name, part.version) for part in parts.values())
    bom = Bom(
        components=[part for part in parts.values() if part is not main],
        metadata=BomMetaData(component=main, timestamp=now()),
        serial_number=uuid.uuid5(uuid.NAMESPACE_OID, digest(versions)),
    )
    for name, needed in needs.items():
        bom.register_dependency(parts[name], [parts[other] for other in needed])
    return bom


def closure(root: str = TOOL) -> Mapping[str, tuple[str, ...]]:
    """Installed dependency → its own installed dependencies, sorted.

    An extra of the root counts if all its dependencies are installed.
    """
    needs: dict[str, set[str]] = {}
    waiting: list[Name] = [(_canonical(root), frozenset(_installed_extras(root)))]
    visited: set[Name] = set()
    while waiting:
        name, extras = one = waiting.pop()
        if one in visited:
            continue
        visited.add(one)
        needed = [dependency for dependency in _needed(name, extras) if _is_installed(dependency)]
        needs.setdefault(name, set()).update(map(_name, needed))
        waiting.extend((_name(each), frozenset(each.extras)) for each in needed)
    return {name: tuple(sorted(needs[name] - {name})) for name in sorted(needs)}


def _installed_extras(root: str) -> Iterator[str]:
    always = {*_needed(root, [])}
    for extra in distribution(root).metadata.get_all("Provides-Extra", []):
        mine = [dependency for dependency in _needed(root, [extra]) if dependency not in always]
        if extra not in _OF_DEVELOPERS and all(map(_is_installed, mine)):
            yield extra


def _needed(name: str, extras: Iterable[str]) -> Iterator[Requirement]:
    """The dependencies of a distribution in this environment, with these extras."""
    from packaging.requirements import Requirement

    contexts = ("", *extras)
    for text in distribution(name).requires or ():
        one = Requirement(text)
        if one.marker is None or any(one.marker.evaluate({"extra": extra}) for extra in contexts):
            yield one


def _is_installed(needed: Requirement) -> bool:
    try:
        distribution(needed.name)
    except PackageNotFoundError:
        return False
    return True


def _name(needed: Requirement) -> str:
    return _canonical(needed.name)


def _canonical(name: str) -> str:
    from packaging.utils import canonicalize_name

    return canonicalize_name(name)


def _component(one: Distribution) -> Component:
    from cyclonedx.contrib.license.factories import LicenseFactory
    from cyclonedx.model.component import Component
    from packageurl import PackageURL

    name = _canonical(one.metadata["Name"])
    purl = PackageURL("pypi", name=name, version=one.version)
    licences = [LicenseFactory().make_from_string(text) for text in _licences(one)]
    return Component(
        name=name, version=one.version, purl=purl, bom_ref=str(purl), licenses=licences
    )


def _licences(one: Distribution) -> list[str]:
    """The licences of a distribution, from its expression, its name, or its classifiers."""
    for field in ("License-Expression", "License"):
        text = (one.metadata[field] or "").strip() if field in one.metadata else ""
        if text and text != "UNKNOWN" and len(text) <= _SHORT and "\n" not in text:
            return [text]
    classifiers = one.metadata.get_all("Classifier", [])
    return [
        classifier.rpartition(" :: ")[2]
        for classifier in classifiers
        if classifier.startswith("License :: ")
    ]
