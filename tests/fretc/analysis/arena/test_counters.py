"""The counters of the arena against the reference automata, state by state."""

from itertools import product

import pytest

from compiler.formalization.reference import accepting, accepts, initial, step, tick_role
from compiler.formalization.reference import template as template_of
from compiler.logic.diagrams import decision_diagrams as bdd
from fretc.analysis.arena.transition import Transition
from fretish.bindings.declarations import Role
from tests import meaning
from tests.requirement_sets import staged
from tests.strategies import Template, some_templates

ROLES = dict.fromkeys("mpqs", Role.OUTPUT)


def assert_same(template: Template) -> None:
    """Whatever the letters are, both break at the same tick, and accept the same states."""
    setting = staged(template.sentence, roles=ROLES)
    strict = staged(template.sentence, roles=ROLES, as_fret=True).arena.counters[0]
    (counter,), (requirement,) = setting.arena.counters, setting.requirements
    names = template.columns
    atoms = {name: setting.arena.alphabet.atom(name) for name in names}
    reference = template_of(requirement.sentence, requirement.ticks or 0)
    transition = Transition([counter, strict])
    waiting = [(initial(reference), tuple(transition.start.items()))]
    seen = set(waiting)
    for state, bits in waiting:
        for values in product((False, True), repeat=len(names)):
            row = dict(zip(names, values, strict=True))
            known = bdd.point(dict(bits))
            for name, value in row.items():
                known = known & (atoms[name] if value else -atoms[name])
            m, p, q, s = (row.get(name, False) for name in "mpqs")
            after = step(reference, state, m, p, q, s)
            where = (template, state, row)
            assert (bdd.at(counter.safe, known) == bdd.true()) is (after is not None), where
            happens = tick_role(reference, state, m, p)
            assert (bdd.at(counter.enforced, known) == bdd.true()) is happens.enforced, where
            assert (bdd.at(counter.triggered, known) == bdd.true()) is happens.triggered, where
            may_end = after is not None and accepts(reference, after)
            assert (bdd.at(strict.safe, known) == bdd.true()) is may_end, where
            if after is None:
                continue
            found = transition.next(known)
            fair = counter.fair is None or bdd.at(counter.fair, bdd.point(found)) == bdd.true()
            assert fair is accepting(reference, after), where
            pair = (after, tuple(found.items()))
            if pair not in seen:
                seen.add(pair)
                waiting.append(pair)


@pytest.mark.slow
@pytest.mark.parametrize("scope", meaning.SCOPES)
def test_a_counter_does_what_its_reference_does(scope: str) -> None:
    for template in some_templates((0, 1, 3)):
        if template.scope == scope:
            assert_same(template)


def test_a_long_bound_has_few_bits() -> None:
    (counter,) = staged("whenever a the sw shall within 1000000 ticks satisfy x").arena.counters
    assert len(counter.bits) == 20


def test_what_is_never_read_has_no_bit() -> None:
    (counter,) = staged("whenever a the sw shall immediately satisfy x").arena.counters
    assert counter.bits == ()
