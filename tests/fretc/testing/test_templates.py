"""Each of FRET's templates: what its tests show, compared with two definitions of their own."""

from __future__ import annotations

from itertools import product

import pytest

from compiler.formalization import reference
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of, letters_by_valuation
from compiler.formalization.reference import ReferenceState
from compiler.situations.mutants import mutants
from fretc.testing.generation import batch
from fretc.testing.suite import GoalStatus, MutantStatus, Polarity
from tests.each import each
from tests.effort import some
from tests.requirement_sets import requirement
from tests.strategies import Template, few_templates

TRIED = some(few_templates((0, 1, 2, 3)), 5)
"""Every one of the 504, or one of each scope, each with a timing of its own."""


def accept_the_same(one: FormalizedRequirement, other: FormalizedRequirement) -> bool:
    """Whether two sentences accept the same finite words: both reference automata side by side."""
    atoms = tuple(dict.fromkeys([*atoms_of(one.sentence), *atoms_of(other.sentence)]))
    sides = []
    for each_rule in (one, other):
        template = reference.template(each_rule.sentence, each_rule.ticks or 0)
        sides.append((template, letters_by_valuation(each_rule.sentence, atoms)))
    start: tuple[ReferenceState | None, ...] = tuple(
        reference.initial(template) for template, _ in sides
    )
    seen, waiting = {start}, [start]
    while waiting:
        states = waiting.pop()
        for valuation in product((False, True), repeat=len(atoms)):
            after = tuple(
                None if state is None else reference.step(template, state, *letters[valuation])
                for state, (template, letters) in zip(states, sides, strict=True)
            )
            accepted = {
                state is not None and reference.accepts(template, state)
                for state, (template, _) in zip(after, sides, strict=True)
            }
            if len(accepted) > 1:
                return False
            if after not in seen:
                seen.add(after)
                waiting.append(after)
    return True


@pytest.mark.slow
@each("template", TRIED)
def test_all_is_met_or_impossible_and_killed_or_equivalent(template: Template) -> None:
    subject = requirement("R1", template.sentence)
    found = batch(subject, [], 60)
    assert {each.outcome for each in found.obligations} <= {GoalStatus.MET, GoalStatus.IMPOSSIBLE}
    wrong = {each.key: each.requirement for each in mutants(subject)}
    for mutant in found.mutants:
        same = accept_the_same(subject, wrong[mutant.key])
        assert mutant.outcome is (MutantStatus.EQUIVALENT if same else MutantStatus.KILLED), mutant
    for test in found.tests:
        columns = {
            name: [row.values[name] for row in test.rows for _ in range(row.count)]
            for name in template.columns
        }
        if test.polarity is Polarity.UNKNOWN:
            assert test.finite is None
            continue
        known = {name: [bool(value) for value in column] for name, column in columns.items()}
        assert template.satisfied(known) is test.finite
