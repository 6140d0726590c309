"""Warnings about a whole project before any run: vacuity, plans without result, missing links.

`compiler.project.folder` reports mistakes of single files while it reads them. These warnings are
about no single file: with them, the project cannot show all that it should.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from shlex import quote

from compiler.emit import TARGETS
from compiler.explanation.constant_parts import constant_parts
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import METHODS
from compiler.project.folder import Project
from compiler.project.parent_graph import without_hazard
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
"""Methods with results that fretc knows, or with files that it makes."""


def checks(project: Project, standings: Sequence[ReviewedRequirement]) -> tuple[Diagnostic, ...]:
    """All warnings, in the order of the project.

    Args:
        project: with or without errors; no requirement that a mistake reaches is looked at.
        standings: requirements beside their reviews.
    """
    requirements = [
        requirement
        for requirement in project.sound.formalized
        if requirement.entry.status != "retired"
    ]
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
            "itself commands: "
            "it holds where nothing is ever commanded",
            _place(requirement, name),
            help="trigger it by what the sensors see, or say `role` and `kind` of the proposition",
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
            "whatever is "
            "measured",
            next((name.span for name in names(part)), None) or requirement.entry.wording,
            help="look at the numbers, and at the direction of each comparison",
            severity=Severity.WARNING,
        )


# Planned methods -------------------------------------------------------------------------------


def _planned(requirement: FormalizedRequirement) -> Iterator[Diagnostic]:
    """F525: a planned method that can give no result; and what a target has to remark."""
    for method in requirement.entry.verify:
        target = TARGETS.get("monitor" if method == "audit" else method)
        if target is None:
            yield from _misspelt(requirement, method)
            continue
        refused = target.refuse(requirement)
        if refused is not None:
            yield Diagnostic(
                Code.UNREACHABLE_PLAN,
                f"{requirement.id} plans `{method}`, and there can be no result: {refused.message}",
                requirement.entry.place("verify"),
                help=refused.help,
                severity=Severity.WARNING,
            )
            continue
        remark = target.remark(requirement)
        if remark is not None:
            yield remark


def _misspelt(requirement: FormalizedRequirement, method: str) -> Iterator[Diagnostic]:
    """F528: nearly the name of a method whose results fretc knows; any other name is one's own."""
    near = suggestion(method, _METHODS, cutoff=0.75)
    if method not in _METHODS and near is not None:
        yield Diagnostic(
            Code.MISSPELT_METHOD,
            f"{requirement.id} plans `{method}`, which is no method that fretc knows: it stays "
            "open",
            requirement.entry.place("verify"),
            help=f"did you mean `{near}`?",
            severity=Severity.WARNING,
        )


# Links -----------------------------------------------------------------------------------------


def _links(project: Project) -> Iterator[Diagnostic]:
    """F522, F523 and F527: hazards that nothing prevents, requirements that reach none."""
    active = [r for r in project.requirements if r.status != "retired"]
    above = {parent for requirement in active for parent in requirement.parents}
    for hazard in project.hazards.values():
        if hazard.id not in above:
            yield Diagnostic(
                Code.UNCOVERED_HAZARD,
                f"no requirement in force names {hazard.id} ({hazard.title}) as its parent",
                help="write one, or name it in the `parents` of one",
                severity=Severity.WARNING,
                subject=hazard.id,
            )
    for requirement in active if project.hazards or project.parents else ():
        if not requirement.parents:
            yield Diagnostic(
                Code.NO_PARENT,
                f"{requirement.id} names no parent",
                requirement.place("id"),
                help="name the hazard or the requirement that it is there for in `parents`",
                severity=Severity.WARNING,
            )
    declared = {*project.hazards, *project.parents}
    for requirement in without_hazard(active, declared) if declared else ():
        yield Diagnostic(
            Code.REACHES_NO_HAZARD,
            f"the parents of {requirement.id} lead to no hazard",
            requirement.place("parents"),
            help="name the hazard in `parents`, or in those of a requirement above it",
            severity=Severity.WARNING,
        )


# Reviews ---------------------------------------------------------------------------------------


def _changes(project: Project, standings: Sequence[ReviewedRequirement]) -> Iterator[Diagnostic]:
    """F512 for each requirement whose review no longer stands."""
    places = {r.id: r.wording for r in project.requirements}
    for standing in standings:
        if not standing.is_suspect or standing.review is None:
            continue
        id = standing.chain.requirement
        yield Diagnostic(
            Code.CHANGED_SINCE_REVIEW,
            f"{id} was reviewed on {standing.review.date}, and since then "
            f"this has changed: {in_words(standing.changes)}",
            places.get(id, Source("", "").span()),
            help=f"look at `fretc diff`, then accept it: `fretc lock {quote(id)} ...`",
            severity=Severity.WARNING,
        )
        if standing.has_other_texts:
            yield Diagnostic(
                Code.OTHER_TEXTS,
                f"the texts that the review of {id} keeps are not those of its fingerprints: what "
                "was accepted is not known",
                places.get(id, Source("", "").span()),
                help="take the lock from version control again, or review anew: "
                f"`fretc lock {quote(id)} ...`",
                severity=Severity.WARNING,
            )


def unreviewed(project: Project, standings: Sequence[ReviewedRequirement]) -> Iterator[Diagnostic]:
    """F544 for each requirement in force without a review; for a project that has a lock."""
    by_id = {requirement.id: requirement for requirement in project.requirements}
    for standing in standings:
        requirement = by_id[standing.chain.requirement]
        if standing.review is None and requirement.status != "retired":
            yield Diagnostic(
                Code.NOT_REVIEWED,
                f"{requirement.id} was never reviewed",
                requirement.place("id"),
                help=f"review it, then accept it: `fretc lock {requirement.id} ...`",
                severity=Severity.WARNING,
            )
