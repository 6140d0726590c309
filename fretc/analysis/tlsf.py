"""The realizability problem of a component in TLSF, for other synthesis tools.

Source: Jacobs, Klein, Schirmer, A high-level LTL synthesis format: TLSF v1.1, SYNT 2016; this is
its basic format. Comparisons of numbers become propositions, with the patterns that numbers allow.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import PurePosixPath
from typing import assert_never

from compiler.files.artifact import Artifact
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import temporal_predicate
from compiler.logic import formula as f
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.identifiers import legal_names
from fretc.analysis.arena.alphabet import Alphabet
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.components import by_outputs
from fretc.analysis.realizability_problem import RealizabilityProblem, stage
from fretish.checking import is_formula
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.printer import sentence as printed
from fretish.reading.recursion import with_recursion_limit

LONGEST = 500
"""Longest duration in ticks, for which `X` is written so many times."""
_MOST = 1_000_000
"""Maximum number of characters of a file."""
_RESERVED = frozenset(
    "INFO MAIN GLOBAL INPUTS OUTPUTS INITIALLY PRESET REQUIRE REQUIREMENTS ASSERT INVARIANTS "
    "ASSUME ASSUMPTIONS GUARANTEE GUARANTEES TITLE DESCRIPTION SEMANTICS TARGET TAGS PARAMETERS "
    "DEFINITIONS true false X F G U R W NOT AND OR IMPLIES EQUIV".split()
)


@with_recursion_limit
def specifications(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    roles: Roles,
    seconds: float,
) -> tuple[tuple[Artifact, ...], tuple[Diagnostic, ...]]:
    """`component-1.tlsf`, ... for each component, and F624 for each one that has no file.

    Args:
        requirements: the requirements.
        assumptions: the assumptions about the environment.
        roles: role of each variable.
        seconds: CPU time limit for solving the comparisons of each component.
    """
    files: list[Artifact] = []
    mistakes: list[Diagnostic] = []
    for number, members in enumerate(by_outputs(requirements, assumptions, roles), 1):
        try:
            problem = stage(members, assumptions, roles, budget=Budget(seconds))
            path = PurePosixPath(f"component-{number}.tlsf")
            files.append(Artifact(path, _specification(problem)))
        except (UnsupportedError, OutOfTimeError) as error:
            ids = ", ".join(requirement.id for requirement in members)
            mistakes.append(diagnostic("not_for_tlsf", requirements=ids, why=str(error)))
    return tuple(files), tuple(mistakes)


def _specification(problem: RealizabilityProblem) -> str:
    """The text of a file.

    Raises:
        UnsupportedError: TLSF cannot state the problem.
    """
    alphabet = problem.arena.alphabet
    formulas = {each.id for each in problem.requirements if is_formula(each.sentence)}
    beyond = [f"{id}: {why}" for id, why in problem.arena.beyond.items() if id not in formulas]
    why = "; ".join(beyond) or next(iter(alphabet.uncertainties.values()), None) or alphabet.open
    if why is not None:
        raise UnsupportedError(why)
    every = [*problem.requirements, *problem.assumptions]
    for requirement in every:
        called = temporal_predicate(requirement.sentence)
        if called and not is_formula(requirement.sentence):
            raise UnsupportedError(f"{requirement.id} reads earlier or later ticks by `{called}`")
        if (ticks := f.longest_bound(requirement.ft_infinite)) > LONGEST:
            raise UnsupportedError(f"{requirement.id} lasts {ticks} ticks, more than {LONGEST}")
    text = _Text(alphabet)
    lines = [
        *_info(problem),
        "MAIN {",
        *_block("INPUTS", text.signals(alphabet.inputs)),
        *_block("OUTPUTS", text.signals(alphabet.outputs)),
        *_block("REQUIRE", text.constraint(alphabet.legal)),
        *_block("ASSUME", text.of(problem.assumptions)),
        *_block("ASSERT", text.constraint(alphabet.reachable)),
        *_block("GUARANTEE", text.of(problem.requirements)),
        "}",
    ]
    result = "\n".join(lines) + "\n"
    if len(result) > _MOST:
        raise UnsupportedError("the file would be too large")
    return result


def _info(problem: RealizabilityProblem) -> Iterator[str]:
    ids = ", ".join(requirement.id for requirement in problem.requirements)
    yield "INFO {"
    yield f'  TITLE:       "{_quoted(ids)}"'
    yield '  DESCRIPTION: "A component of a requirement set"'
    yield "  SEMANTICS:   Mealy"
    yield "  TARGET:      Mealy"
    yield "}"


def _quoted(text: str) -> str:
    return text.replace('"', "'")


def _block(name: str, lines: Iterable[str]) -> Iterator[str]:
    content = [f"    {line}" for line in lines]
    if content or name in ("INPUTS", "OUTPUTS"):
        yield from (f"  {name} {{", *content, "  }")


class _Text:
    """Formulas over the bits of an alphabet."""

    def __init__(self, alphabet: Alphabet) -> None:
        self._alphabet = alphabet
        bits = [*alphabet.inputs, *alphabet.outputs]
        labels = alphabet.labels
        own = {bit: labels.get(bit, f"cell_{number}") for number, bit in enumerate(bits)}
        legal = legal_names(own.values(), _RESERVED)
        self._names = {bit: legal[name] for bit, name in own.items()}

    def signals(self, bits: Sequence[int]) -> Iterator[str]:
        """The declarations of bits."""
        return (f"{self._names[bit]};" for bit in bits)

    def constraint(self, function: Function) -> Iterator[str]:
        """The formula of a function, unless it is true."""
        if function != bdd.true():
            yield f"{self._function(function)};"

    def of(self, requirements: Sequence[FormalizedRequirement]) -> Iterator[str]:
        """The formula of each requirement, below its sentence."""
        for requirement in requirements:
            sentence = " ".join(printed(requirement.written).split())
            yield f"// {requirement.id}: {sentence}"
            yield f"{self._formula(requirement.ft_infinite)};"

    def _function(self, function: Function) -> str:
        if function in (bdd.true(), bdd.false()):
            return "true" if function == bdd.true() else "false"
        bit, high, low = bdd.branches(function)
        name = self._names[bit]
        parts = []
        if high != bdd.false():
            parts.append(name if high == bdd.true() else f"({name} && {self._function(high)})")
        if low != bdd.false():
            low_text = "" if low == bdd.true() else f" && {self._function(low)}"
            parts.append(f"(!{name}{low_text})")
        return parts[0] if len(parts) == 1 else f"({' || '.join(parts)})"

    def _formula(self, formula: f.Formula) -> str:
        read = self._formula
        match formula:
            case f.Const(value):
                return str(value).lower()
            case f.Atom(name):
                return self._function(self._alphabet.atom(name))
            case f.Not(arg):
                return f"!{read(arg)}"
            case f.And(args):
                return f"({' && '.join(map(read, args))})"
            case f.Or(args):
                return f"({' || '.join(map(read, args))})"
            case f.Xor(left, right):
                return f"(!({read(left)} <-> {read(right)}))"
            case f.Implies(left, right):
                return f"({read(left)} -> {read(right)})"
            case f.Iff(left, right):
                return f"({read(left)} <-> {read(right)})"
            case f.Next(arg):
                return f"(X {read(arg)})"
            case f.Until(left, right):
                return f"({read(left)} U {read(right)})"
            case f.Release(left, right):
                return f"({read(left)} R {read(right)})"
            case f.Eventually(arg, ahead):
                return _bounded("F", "||", read(arg), ahead)
            case f.Globally(arg, ahead):
                return _bounded("G", "&&", read(arg), ahead)
            case f.Last():
                return "false"
            case f.ProbabilityBound():
                raise UnsupportedError("a requirement states a probability")
            case f.Previous() | f.WeakPrevious() | f.Once() | f.Historically() | f.Since():
                raise UnsupportedError("a requirement reads earlier ticks")
            case _:
                assert_never(formula)


def _bounded(operator: str, joint: str, text: str, ahead: f.Interval) -> str:
    """`F` or `G`; with bounds as nested `X`."""
    if ahead.hi is None:
        result = f"({operator} {text})"
    else:
        result = text
        for _ in range(ahead.hi - ahead.lo):
            result = f"({text} {joint} X {result})"
    return "(X " * ahead.lo + result + ")" * ahead.lo
