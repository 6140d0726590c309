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
from compiler.targets.target import Options
from fretc.traceability.changes import in_words
from fretc.traceability.lock import ReviewedRequirement
from fretish.bindings.declarations import Role
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity, has_errors, suggestion
from fretish.diagnostics.source import Source, Span
from fretish.expressions import names
from fretish.printer import expression as printed

_COMMAND = "command"
_METHODS = ("audit", *METHODS, *TARGETS)
"""Methods whose results fretc reads, or for which it generates files."""


def checks(project: Project, standings: Sequence[ReviewedRequirement]) -> tuple[Diagnostic, ...]:
    """All warnings, in the order of the project.

    Args:
        project: with or without errors; requirements that an error affects are skipped.
        standings: requirements with their reviews.
    """
    requirements = project.sound.in_force
    diagnostics = [
        d
        for requirement in requirements
        for d in (
            *_own_triggers(requirement, project),
            *_never_so(requirement),
            *_planned(requirement),
        )
    ]
    options = Options(declarations=project.declarations)
    interceptor = TARGETS["interceptor"].remarks(options)
    is_whole = not has_errors(project.general) and not any(r.mistakes for r in project.requirements)
    links = _links(project) if is_whole else ()  # they are asked of all headers and hazards
    return (*diagnostics, *interceptor, *links, *_changes(project, standings))


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
        yield Diagnostic(
            Code.OWN_TRIGGER,
            f"{requirement.id} is triggered by `{name}`, which {requirement.sentence.component} "
            "itself commands: the requirement holds if nothing is ever commanded",
            _place(requirement, name),
            help="use a trigger that depends on sensor values, or declare `role` and `kind` "
            "of the proposition",
            severity=Severity.WARNING,
        )


def _place(requirement: FormalizedRequirement, name: str) -> Span:
    assert requirement.sentence.condition is not None
    places = (n.span for n in names(requirement.sentence.condition.expression) if n.id == name)
    return next(places, None) or requirement.entry.wording


def _never_so(requirement: FormalizedRequirement) -> Iterator[Diagnostic]:
    """F210 for each part of the sentence that no numbers make true, or none false."""
    for part, value in constant_parts(requirement):
        yield Diagnostic(
            Code.NEVER_SO,
            f"`{printed(part)}` of {requirement.id} is {'always' if value else 'never'} true, "
            "whatever the signals are",
            next((name.span for name in names(part)), None) or requirement.entry.wording,
            help="check the numbers and the direction of each comparison",
            severity=Severity.WARNING,
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
            yield Diagnostic(
                Code.UNREACHABLE_PLAN,
                f"{requirement.id} plans `{method}`, but this method cannot give a result: "
                f"{refused.message}",
                requirement.entry.place("verify"),
                help=refused.help,
                severity=Severity.WARNING,
            )
            continue
        remark = target.remark(requirement)
        if remark is not None:
            yield remark


def _misspelt(requirement: FormalizedRequirement, method: str) -> Iterator[Diagnostic]:
    """F528 for a misspelt method name; other unknown names are the user's own methods."""
    near = suggestion(method, _METHODS, cutoff=0.75)
    if method not in _METHODS and near is not None:
        yield Diagnostic(
            Code.MISSPELT_METHOD,
            f"{requirement.id} plans `{method}`, which is not a method of fretc: the plan stays "
            "open",
            requirement.entry.place("verify"),
            help=f"did you mean `{near}`?",
            severity=Severity.WARNING,
        )


# Links -----------------------------------------------------------------------------------------


def _links(project: Project) -> Iterator[Diagnostic]:
    """F522, F523 and F527: hazards without a requirement, requirements without a hazard."""
    active = [r for r in project.requirements if r.is_in_force]
    above = {parent for requirement in active for parent in requirement.parents}
    for hazard in project.hazards.values():
        if hazard.id not in above:
            yield Diagnostic(
                Code.UNCOVERED_HAZARD,
                f"no requirement in force names {hazard.id} ({hazard.title}) as its parent",
                help="write a requirement for it, or name it in the `parents` of one",
                severity=Severity.WARNING,
                subject=hazard.id,
            )
    for requirement in active if project.hazards or project.parents else ():
        if not requirement.parents:
            yield Diagnostic(
                Code.NO_PARENT,
                f"{requirement.id} names no parent",
                requirement.place("id"),
                help="name in `parents` the hazard or requirement that it refines",
                severity=Severity.WARNING,
            )
    declared = {*project.hazards, *project.parents}
    for requirement in without_hazard(active, declared) if declared else ():
        yield Diagnostic(
            Code.REACHES_NO_HAZARD,
            f"the parents of {requirement.id} lead to no hazard",
            requirement.place("parents"),
            help="name the hazard in its `parents`, or in the `parents` of a requirement above it",
            severity=Severity.WARNING,
        )


# Reviews ---------------------------------------------------------------------------------------


def _changes(project: Project, standings: Sequence[ReviewedRequirement]) -> Iterator[Diagnostic]:
    """F512 for each requirement whose review is no longer valid."""
    places = {r.id: r.wording for r in project.requirements}
    for standing in standings:
        if not standing.is_suspect or standing.review is None:
            continue
        id = standing.chain.requirement
        yield Diagnostic(
            Code.CHANGED_SINCE_REVIEW,
            f"{id} was reviewed on {standing.review.date}, and has changed since then: "
            f"{in_words(standing.changes)}",
            places.get(id, Source("", "").span()),
            help="inspect the change with `fretc diff`, then accept it: `fretc lock "
            f"{quote(id)} ...`",
            severity=Severity.WARNING,
        )
        if standing.has_other_texts:
            yield Diagnostic(
                Code.OTHER_TEXTS,
                f"the texts that the review of {id} keeps do not match its fingerprints: it is "
                "not known which texts were accepted",
                places.get(id, Source("", "").span()),
                help="restore the lock from version control, or review again: "
                f"`fretc lock {quote(id)} ...`",
                severity=Severity.WARNING,
            )


def unreviewed(project: Project, standings: Sequence[ReviewedRequirement]) -> Iterator[Diagnostic]:
    """F544 for each requirement in force without a review."""
    by_id = {requirement.id: requirement for requirement in project.requirements}
    for standing in standings:
        requirement = by_id[standing.chain.requirement]
        if standing.review is None and requirement.is_in_force:
            yield Diagnostic(
                Code.NOT_REVIEWED,
                f"{requirement.id} was never reviewed",
                requirement.place("id"),
                help=f"review it, then accept it: `fretc lock {requirement.id} ...`",
                severity=Severity.WARNING,
            )
