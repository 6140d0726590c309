"""The basis of the verdict on each requirement of a project."""

from __future__ import annotations

from collections.abc import Mapping

from compiler.project.folder import Project
from fretc.audit.evidence.basis import Basis, basis
from fretc.audit.refusals import in_force, refusals


def bases(project: Project) -> Mapping[int, Basis]:
    """What a verdict on each requirement rests on, by its `id()`: those in force and all others."""
    declarations = project.declarations
    refused = {id(requirement) for requirement, _ in refusals(project)}
    auditable = [rule for rule in in_force(project) if id(rule.requirement) not in refused]
    topics: set[str] = set()
    if declarations is not None:
        used = declarations.reading(name for rule in auditable for name in rule.watched)
        topics = {signal.path.topic for signal in used.signals.values()}
    rules = {id(rule.requirement): rule for rule in project.rules}
    return {
        id(each): basis(each, rules.get(id(each)), declarations, topics)
        for each in project.requirements
    }
