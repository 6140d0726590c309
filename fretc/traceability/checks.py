"""Warnings about a whole project before any run: vacuity, plans without result, missing links.

`compiler.project.folder` reports errors in single files while it reads them. These warnings are
about the project as a whole: it cannot show all that it should.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from shlex import quote

from compiler.emit import TARGETS
from compiler.explanation.constant_parts import constant_parts
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import METHODS
from compiler.project.hazards import without_hazard
from compiler.project.project import Project
from compiler.targets.target import TargetOptions
from fretc.analysis.arena.roles import role
from fretc.traceability.changes import in_words
from fretc.traceability.lock import ReviewStatus
from fretish.bindings.declarations import Role
from fretish.diagnostics.diagnostic import Diagnostic, has_errors, suggestion
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.expressions import names
from fretish.printer import expression as printed
from fretish.reading.memory import remembered

_COMMAND = "command"
_METHODS = ("audit", *METHODS, *TARGETS)
"""Methods whose results fretc reads, or for which it generates files."""


def checks(project: Project, statuses: Sequence[ReviewStatus]) -> tuple[Diagnostic, ...]:
    """All warnings, in the order of the project.

    Args:
        project: with or without errors; requirements that an error affects are skipped.
        statuses: requirements with their reviews.
    """
    requirements = project.sound.in_force
    diagnostics = [
        d
        for requirement in requirements
        for d in (
            *_own_triggers(requirement, project),
            *_never_so(requirement),
            *_planned(requirement),
            *_of_outputs(requirement),
        )
    ]
    options = TargetOptions(declarations=project.declarations)
    interceptor = TARGETS["interceptor"].remarks(options)
    is_whole = not has_errors(project.general) and not any(r.mistakes for r in project.requirements)
    links = _links(project) if is_whole else ()  # they are asked of all headers and hazards
    unfinished = _unfinished(project) if is_whole else ()
    return (*diagnostics, *interceptor, *links, *unfinished, *_changes(project, statuses))


# Vacuity ---------------------------------------------------------------------------------------


def _own_triggers(requirement: FormalizedRequirement, project: Project) -> Iterator[Diagnostic]:
    """F209: the condition waits for what the component itself commands.

    Where the component is what the sentence is about, its commands are answers: a property that
    is triggered by them holds of a component that never acts.
    """
    condition = requirement.sentence.condition
    declared = project.declarations
    if condition is None or declared is None:
        return
    for name in dict.fromkeys(name.id for name in names(condition.expression)):
        bound = declared.propositions.get(name)
        if bound is None or bound.role is not Role.OUTPUT or bound.kind != _COMMAND:
            continue
        yield diagnostic(
            "own_trigger",
            _place(requirement, name),
            requirement=requirement.id,
            name=name,
            component=requirement.sentence.component,
        )


def _place(requirement: FormalizedRequirement, name: str) -> Span:
    assert requirement.sentence.condition is not None
    places = (n.span for n in names(requirement.sentence.condition.expression) if n.id == name)
    return next(places, None) or requirement.entry.wording


@remembered
def _never_so(requirement: FormalizedRequirement) -> tuple[Diagnostic, ...]:
    """F210 for each part of the sentence that no numbers make true, or none false."""
    return tuple(
        diagnostic(
            "never_so",
            next((name.span for name in names(part)), None) or requirement.entry.wording,
            part=printed(part),
            requirement=requirement.id,
            when="always" if value else "never",
        )
        for part, value in constant_parts(requirement)
    )


# Assumptions -----------------------------------------------------------------------------------


def _of_outputs(requirement: FormalizedRequirement) -> Iterator[Diagnostic]:
    """F563 for an assumption whose variables the system chooses."""
    players = {role(requirement, name) for name in requirement.variables}
    if requirement.entry.is_assumption and players == {Role.OUTPUT}:
        yield diagnostic(
            "assumption_about_outputs",
            requirement.entry.place("kind"),
            requirement=requirement.id,
            names=", ".join(f"`{name}`" for name in requirement.variables),
        )


# Planned methods -------------------------------------------------------------------------------


def _planned(requirement: FormalizedRequirement) -> Iterator[Diagnostic]:
    """F525 for a planned method that cannot give a result; also the remarks of targets."""
    for method in requirement.entry.verify:
        target = TARGETS.get("monitor" if method == "audit" else method)
        if target is None:
            yield from _misspelt(requirement, method)
            continue
        refused = target.refuse(requirement)
        if refused is not None:
            yield diagnostic(
                "unreachable_plan",
                requirement.entry.place("verify"),
                requirement=requirement.id,
                method=method,
                message=refused.message,
                help=refused.help,
            )
            continue
        remark = target.remark(requirement)
        if remark is not None:
            yield remark


def _misspelt(requirement: FormalizedRequirement, method: str) -> Iterator[Diagnostic]:
    """F528 for a misspelt method name; other unknown names are the user's own methods."""
    near = suggestion(method, _METHODS, cutoff=0.75)
    if method not in _METHODS and near is not None:
        yield diagnostic(
            "misspelt_method",
            requirement.entry.place("verify"),
            requirement=requirement.id,
            method=method,
            near=near,
        )


# Links -----------------------------------------------------------------------------------------


def _links(project: Project) -> Iterator[Diagnostic]:
    """F522, F523 and F527: hazards without a requirement, requirements without a hazard."""
    active = [r for r in project.requirements if r.is_in_force]
    above = {parent for requirement in active for parent in requirement.parents}
    for hazard in project.hazards.values():
        if hazard.id not in above:
            yield diagnostic(
                "uncovered_hazard", hazard=hazard.id, title=hazard.title, subject=hazard.id
            )
    for requirement in active if project.hazards or project.parents else ():
        if not requirement.parents:
            yield diagnostic("no_parent", requirement.place("id"), requirement=requirement.id)
    declared = {*project.hazards, *project.parents}
    for requirement in without_hazard(active, declared) if declared else ():
        yield diagnostic(
            "reaches_no_hazard", requirement.place("parents"), requirement=requirement.id
        )


# Texts -----------------------------------------------------------------------------------------


def _unfinished(project: Project) -> Iterator[Diagnostic]:
    """F532 for texts of approved requirements, and of their hazards, that are only drafted."""
    for requirement in project.requirements:
        if requirement.status != "approved":
            continue
        for field in ("title", "text", "rationale"):
            if _is_to_do(getattr(requirement, field)):
                yield diagnostic(
                    "unfinished_text",
                    requirement.place(field),
                    requirement=requirement.id,
                    field=field,
                )
        above = (project.hazards.get(parent) for parent in requirement.parents)
        for hazard in filter(None, above):
            for field in ("title", "text"):
                if _is_to_do(getattr(hazard, field)):
                    yield diagnostic(
                        "unfinished_hazard",
                        requirement.place("parents"),
                        requirement=requirement.id,
                        field=field,
                        hazard=hazard.id,
                    )


def _is_to_do(text: str) -> bool:
    return text.lstrip().lower().startswith("to do:")


# Reviews ---------------------------------------------------------------------------------------


def _changes(project: Project, statuses: Sequence[ReviewStatus]) -> Iterator[Diagnostic]:
    """F512 for each requirement whose review is no longer valid."""
    places = {r.id: r.wording for r in project.requirements}
    for status in statuses:
        if not status.is_suspect or status.review is None:
            continue
        id = status.chain.requirement
        yield diagnostic(
            "changed_since_review",
            places.get(id, Source("", "").span()),
            requirement=id,
            date=status.review.date,
            changes=in_words(status.changes),
            argument=quote(id),
        )
        if status.has_other_texts:
            yield diagnostic(
                "other_texts",
                places.get(id, Source("", "").span()),
                requirement=id,
                argument=quote(id),
            )


def unreviewed(project: Project, statuses: Sequence[ReviewStatus]) -> Iterator[Diagnostic]:
    """F544 for each requirement in force without a review."""
    by_id = {requirement.id: requirement for requirement in project.requirements}
    for status in statuses:
        requirement = by_id[status.chain.requirement]
        if status.review is None and requirement.is_in_force:
            yield diagnostic("never_reviewed", requirement.place("id"), requirement=requirement.id)
