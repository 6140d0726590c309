"""Titles and time limits of the requirements of a project, which evidence does not contain."""

from __future__ import annotations

from collections.abc import Mapping

from compiler.formalization.record import wording
from compiler.project.project import Project
from fretc.report.pictures.histograms import seconds_allowed
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class KnownRequirements:
    """What the page of trends shows of requirements, by their ids."""

    titles: Mapping[str, str]
    limits: Mapping[str, float]
    """The time in seconds that a sentence allows; a sentence without a limit has none."""


NOTHING_KNOWN = KnownRequirements({}, {})


def known_requirements(project: Project, sentences: Mapping[str, str]) -> KnownRequirements:
    """The titles, and the limits of the requirements whose sentence is still that of the evidence.

    Args:
        project: with or without errors.
        sentences: id of a requirement → its sentence in the newest evidence.
    """
    limits = {
        requirement.id: limit
        for requirement in project.formalized
        if sentences.get(requirement.id) == wording(requirement.entry)
        and (limit := seconds_allowed(requirement)) is not None
    }
    titles = {entry.id: entry.title for entry in project.requirements if entry.title}
    return KnownRequirements(titles, limits)
