"""Requirement sets in tests: sentences over inputs a, b and outputs x, y, drawn or written down."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from functools import cache

import spot

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from fretc.analysis.analysis import AnalysisOptions, analyze
from fretc.analysis.arena.roles import Roles
from fretc.analysis.findings import Analysis
from fretc.analysis.realizability_problem import RealizabilityProblem, stage
from fretish.bindings.declarations import Role
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry

INPUTS, OUTPUTS = ("a", "b"), ("x", "y")
ROLES: Roles = {**dict.fromkeys(INPUTS, Role.INPUT), **dict.fromkeys(OUTPUTS, Role.OUTPUT)}


@cache
def requirement(id: str, sentence: str) -> FormalizedRequirement:
    """A requirement, without any bindings."""
    found, diagnostics = formalize(
        RequirementEntry(id, Source(f"{id}.fret", sentence).span()), None
    )
    assert found is not None, (sentence, diagnostics)
    return found


def requirements(*sentences: str) -> tuple[FormalizedRequirement, ...]:
    """Requirements that are called R1, R2, ..."""
    return tuple(requirement(f"R{i}", f"{sentence}") for i, sentence in enumerate(sentences, 1))


def roles(inputs: Sequence[str], outputs: Sequence[str]) -> Roles:
    """Of such names."""
    return {**dict.fromkeys(inputs, Role.INPUT), **dict.fromkeys(outputs, Role.OUTPUT)}


def staged(
    *sentences: str, roles: Roles = ROLES, assumed: Sequence[str] = (), as_fret: bool = False
) -> RealizabilityProblem:
    """Their stage."""
    assumptions = [requirement(f"A{i}", sentence) for i, sentence in enumerate(assumed, 1)]
    return stage(requirements(*sentences), assumptions, roles, as_fret=as_fret)


def analyzed(
    *sentences: str,
    roles: Roles = ROLES,
    assumed: Sequence[str] = (),
    as_fret: bool = False,
    repairs: bool = False,
) -> Analysis:
    """All that is found of them."""
    assumptions = [requirement(f"A{i}", sentence) for i, sentence in enumerate(assumed, 1)]
    return analyze(
        requirements(*sentences),
        roles,
        assumptions,
        AnalysisOptions(as_fret=as_fret, repairs=repairs),
    )


def conflicts(analysis: Analysis) -> list[tuple[str, ...]]:
    """The ids of each."""
    return [each.requirements for each in analysis.conflicts]


def synthesized(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement] = (),
    outputs: Sequence[str] = OUTPUTS,
) -> bool:
    """What Spot says of the future-time formulas."""
    kept, given = (
        " & ".join(f"({printing.future(requirement.ft_infinite)})" for requirement in some) or "1"
        for some in (requirements, assumptions)
    )
    formula = f"({given}) -> ({kept})"
    return bool(spot.solve_game(spot.ltl_to_game(formula, list(outputs))))


def satisfiable(requirements: Sequence[FormalizedRequirement]) -> bool:
    """Whether any run keeps them, as Spot says."""
    formulas = (f"({printing.future(requirement.ft_infinite)})" for requirement in requirements)
    return not spot.translate(" & ".join(formulas)).is_empty()


SCOPES = ("while {}", "before {}", "after {}", "only while {}", "only before {}", "only after {}",
          "except while {}")  # fmt: skip
TIMINGS = ("immediately", "at the next timepoint", "eventually", "always", "never",
           "within {n} ticks", "for {n} ticks", "after {n} ticks", "until {stop}", "before {stop}",
           "finally")  # fmt: skip


def sentence(
    choose: random.Random,
    most: int = 2,
    every: Sequence[str] = (*INPUTS, *OUTPUTS),
    answers: Sequence[str] = OUTPUTS,
) -> str:
    """Any scope, condition and timing, with a bound of so many ticks at most."""

    def literal(names: Sequence[str]) -> str:
        return choose.choice(["", "!"]) + choose.choice(names)

    scope = choose.choice(["", choose.choice(SCOPES).format(literal(every))])
    condition = choose.choice(
        ["", f"when {literal(every)}", f"whenever {literal(every)}", f"upon {literal(INPUTS)}"]
    )
    timing = choose.choice(TIMINGS).format(n=choose.randint(0, most), stop=literal(every))
    other = choose.choice(["", f" | {literal(every)}"])
    return f"{scope} {condition} the sw shall {timing} satisfy {literal(answers)}{other}".strip()


def drawn(seed: object, most: int = 3) -> tuple[str, ...]:
    """A few sentences."""
    choose = random.Random(repr(seed))
    return tuple(sentence(choose) for _ in range(choose.randint(1, most)))


def terse(seed: object, most: int = 3) -> tuple[str, ...]:
    """A few sentences that get into each other's way."""
    choose = random.Random(repr(seed))

    def one() -> str:
        timing = choose.choice(
            ["immediately", "always", "never", "eventually", "within 2 ticks", "for 1 tick"]
        )
        condition = choose.choice(["", "whenever a", "whenever !x", "upon y", "whenever x"])
        return f"{condition} the sw shall {timing} satisfy {choose.choice(['x', '!x', 'y', '!a'])}"

    return tuple(one() for _ in range(choose.randint(1, most)))


def assumed(seed: object) -> str:
    """A sentence about inputs alone."""
    return sentence(random.Random(repr(seed)), every=INPUTS, answers=INPUTS)


def named(tick: Mapping[str, object]) -> frozenset[str]:
    """What is true at a tick."""
    return frozenset(name for name, value in tick.items() if value is True)
