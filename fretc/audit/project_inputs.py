"""The verdict inputs of each requirement of a project, as fingerprints."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from compiler.project.project import Project
from fretc.audit.evidence.verdict_inputs import VerdictInputs, of_requirement
from fretc.audit.refusals import refusals
from fretish.documents import RequirementEntry


def audited_topics(project: Project) -> frozenset[str]:
    """The topics that an audit of the project reads."""
    declarations = project.declarations
    if declarations is None:
        return frozenset()
    refused = {entry for entry, _ in refusals(project)}
    used = declarations.restricted_to(
        name
        for requirement in project.in_force
        if requirement.entry not in refused
        for name in requirement.watched
    )
    return frozenset(signal.path.topic for signal in used.signals.values())


def all_verdict_inputs(
    project: Project,
    topics: frozenset[str] | None = None,
    monitors: Mapping[RequirementEntry, str] = MappingProxyType({}),
) -> Mapping[RequirementEntry, VerdictInputs]:
    """The verdict inputs of each requirement, retired ones included, by its entry.

    Args:
        project: with or without errors.
        topics: its `audited_topics`, if they are known.
        monitors: the SHA-256 of the monitors that are known, by the same entries.
    """
    declarations = project.declarations
    topics = audited_topics(project) if topics is None else topics
    requirements = {requirement.entry: requirement for requirement in project.formalized}
    return {
        requirement: of_requirement(
            requirement,
            requirements.get(requirement),
            declarations,
            topics,
            monitors.get(requirement),
        )
        for requirement in project.requirements
    }
