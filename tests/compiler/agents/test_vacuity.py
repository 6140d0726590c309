"""What a property says where its conditions never come."""

import pytest

from compiler.agents.vacuity import positive_atoms, without_consequences
from compiler.logic import formula as f

a, b, c, r = map(f.Atom, "abcr")
G, F = f.globally, f.eventually


@pytest.mark.parametrize(
    ("formula", "conditions", "rest"),
    [
        (G(f.implies(a, F(r))), (a,), G(f.not_(a))),
        (G(f.or_(f.not_(a), F(r))), (a,), G(f.not_(a))),
        (
            f.Globally(f.Or((f.Or((f.not_(a), b)), F(r))), f.EVER),
            (a,),
            G(f.not_(a)),
        ),
        (G(f.implies(a, f.implies(b, F(r)))), (b,), G(f.implies(a, f.not_(b)))),
        (f.release(c, f.implies(a, F(r))), (a,), f.release(c, f.not_(a))),
        (G(f.or_(c, f.implies(a, F(r)))), (a,), G(f.or_(c, f.not_(a)))),
    ],
)
def test_what_follows_from_the_conditions_is_left_out(
    formula: f.Formula, conditions: tuple[f.Formula, ...], rest: f.Formula
) -> None:
    assert without_consequences(formula) == ((conditions, rest),)


@pytest.mark.parametrize(
    "formula", [G(f.not_(a)), F(r), f.not_(f.implies(a, r)), a, G(f.or_(a, b))]
)
def test_what_has_no_condition_is_not_asked(formula: f.Formula) -> None:
    assert without_consequences(formula) == ()


def test_each_part_that_speaks_of_all_times_is_asked_by_itself() -> None:
    """The first part is about the first state only, where nothing is believed yet."""
    always = G(f.implies(b, F(r)))
    assert without_consequences(f.and_(f.implies(a, F(r)), always)) == (((b,), G(f.not_(b))),)
    assert len(without_consequences(f.and_(G(f.implies(a, F(r))), always))) == 2


def test_what_is_demanded_stands_under_no_negation() -> None:
    assert positive_atoms(G(f.implies(a, F(f.and_(r, f.not_(b)))))) == {"r"}
    assert positive_atoms(f.not_(f.implies(a, r))) == {"a"}
    assert positive_atoms(f.iff(a, r)) == {"a", "r"}
