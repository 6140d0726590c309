"""The test suite of a project: one job for each requirement, and all tests in one value."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial

from compiler.files.build_id import __version__
from compiler.files.records import replace
from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.arena.roles import role
from fretc.analysis.components import about, by_variables
from fretc.analysis.games.job import Job
from fretc.testing.generation import Batch, batch, lost
from fretc.testing.suite import SCHEMA, Suite, unused
from fretish.bindings.declarations import Role


def jobs(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    seconds: float,
) -> tuple[Job[Batch], ...]:
    """Jobs that generate the tests of each requirement, in the order of the files.

    Args:
        requirements: the requirements.
        assumptions: the assumptions about the environment.
        seconds: CPU seconds for each requirement.
    """
    roles = {
        name: Role.OUTPUT
        for requirement in (*requirements, *assumptions)
        for name in requirement.variables
    }
    others: dict[str, list[FormalizedRequirement]] = {}
    for group in by_variables(requirements, assumptions, roles):
        near = about(group, assumptions, roles)
        for requirement in group:
            others[requirement.id] = [*(each for each in group if each is not requirement), *near]
    return tuple(_job(requirement, others[requirement.id], seconds) for requirement in requirements)


def _job(
    requirement: FormalizedRequirement, others: Sequence[FormalizedRequirement], seconds: float
) -> Job[Batch]:
    def ask(known: Sequence[Batch]) -> Iterator[Batch]:
        yield batch(requirement, others, seconds)

    return Job(f"which runs show that {requirement.id} is right?", ask, partial(lost, requirement))


def suite(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    batches: Iterable[Batch],
) -> Suite:
    """All tests as one suite with unique names."""
    made = tuple(_renamed(batches))
    names = dict.fromkeys(
        name for requirement in (*requirements, *assumptions) for name in requirement.variables
    )
    roles = {
        name: str(own)
        for name in sorted(names)
        for own in [
            next(filter(None, (role(requirement, name) for requirement in requirements)), None)
        ]
        if own is not None
    }
    clock = next(
        (requirement.clock for requirement in requirements if requirement.clock is not None), None
    )
    return Suite(
        schema=SCHEMA,
        fretc=__version__,
        clock=str(clock) if clock is not None and clock.declared else "",
        requirements=tuple(each.tested for each in made),
        roles=roles,
        tests=tuple(test for each in made for test in each.tests),
        obligations=tuple(one for each in made for one in each.obligations),
        mutants=tuple(one for each in made for one in each.mutants),
    )


def _renamed(batches: Iterable[Batch]) -> Iterator[Batch]:
    """The batch with a number appended to each name that is already used."""
    seen: set[str] = set()
    for each in batches:
        names: dict[str, str] = {}
        for test in each.tests:
            names[test.name] = unused(test.name, seen)
        yield Batch(
            each.tested,
            tuple(replace(test, name=names[test.name]) for test in each.tests),
            tuple(replace(o, tests=tuple(names[n] for n in o.tests)) for o in each.obligations),
            tuple(replace(m, tests=tuple(names[n] for n in m.tests)) for m in each.mutants),
        )
