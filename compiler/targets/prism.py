"""`--emit prism`: a requirement with a probability, for PRISM and Storm.

Two files: `<id>.props`, the property in PRISM's syntax over labels, and `<id>.prism`, a frame of a
model that can be run at once and that the user replaces. What PRISM's language lacks is said by
what it has, and means the same: `P=p` as two bounds, `G<=n a` by its complement, and a bound of
ticks within an LTL formula, which PRISM allows around states only, as a chain of `X`.
Sources: the PRISM manual, Property Specification and The PRISM Language; FRET's shape of
probabilistic requirements is that of `compiler.formalization.future.probabilistic`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal, localcontext
from functools import reduce
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.identifiers import legal_names, numbered
from compiler.logic.printing import identifier as identifier_of
from compiler.logic.spelling.reserved_words import PRISM
from compiler.targets.comparison_names import comparison_names, impossible_texts, in_words
from compiler.targets.target import (
    DEFAULT,
    Target,
    TargetOptions,
    identifier,
    not_expressible,
    stem,
    too_long,
)
from fretish import expressions as e
from fretish.checking import LOOK_BACK, calls, conditions
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.printer import timing as printing_of
from fretish.reading.recursion import with_recursion_limit

_MOST_STEPS = 64
"""Maximum length of a chain of `X`: no model checker handles the automaton of a longer one."""


@with_recursion_limit
def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 without a probability, and for parts that PRISM's formulas cannot express."""
    if requirement.pctl is None:
        return not_expressible(
            "PRISM",
            requirement,
            "a requirement without a probability, such as that",
            "add `with probability >= 0.99` before the timing, or use `--emit smv` or `hoa`",
        )
    predicate = _looks_back(requirement)
    if predicate is not None:
        return not_expressible(
            "PRISM",
            requirement,
            f"the predicate `{predicate}`, which looks back,",
            "state it by a condition or a timing",
        )
    if _steps(requirement.pctl) > _MOST_STEPS:
        return not_expressible(
            "PRISM",
            requirement,
            f"more than {_MOST_STEPS} ticks of `{printing_of(requirement.sentence.timing)}` "
            "in one path formula",
            "state the requirement without a scope, or use a clock with longer ticks",
        )
    return too_long("PRISM", requirement, requirement.pctl)


def _looks_back(requirement: FormalizedRequirement) -> str | None:
    for expression in conditions(requirement.sentence):
        predicate = next((name for name in calls(expression) if name in LOOK_BACK), None)
        if predicate is None and any(name.id == "FTP" for name in e.names(expression)):
            predicate = "FTP"
        if predicate is not None:
            return predicate
    return None


@with_recursion_limit
def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """`<id>.props` and `<id>.prism` for each requirement."""
    return tuple(file for requirement in requirements for file in _files(requirement))


def _names(requirement: FormalizedRequirement) -> Mapping[str, str]:
    # Storm's parser of models ends a module at this word, also within a name.
    parted = {
        name: identifier_of(name).replace("endmodule", "end_module")
        for name in requirement.propositions
        if "endmodule" in name
    }
    return legal_names(
        requirement.propositions, PRISM, names={**comparison_names(requirement), **parted}
    )


def _files(requirement: FormalizedRequirement) -> Iterator[Artifact]:
    assert requirement.pctl is not None, "refused"
    names = _names(requirement)
    meanings = in_words(requirement)
    chances = legal_names(names.values(), PRISM | {*names.values()}, "p_")
    modules = legal_names(names.values(), PRISM | {*names.values(), *chances.values()}, "draw_")
    inputs = [
        (name, meanings.get(proposition, proposition), chances[name], modules[name])
        for proposition, name in names.items()
    ]
    values = {
        "id": requirement.id,
        "identifier": next(
            candidate
            for candidate in numbered(identifier(requirement))
            if candidate not in names.values()
        ),  # PRISM reads a name in quotes as a property before it takes it for a label
        "sentence": wording(requirement.entry),
        "inputs": inputs,
    }
    values["impossible"] = impossible_texts(requirement, names)
    for ending, more in (
        ("props", {"property": property_(requirement.pctl, names)}),
        ("prism", {}),
    ):
        text = render(f"prism/requirement.{ending}.j2", stem=stem(requirement), **values, **more)
        yield Artifact(PurePosixPath(f"{stem(requirement)}.{ending}"), text)


# The property ---------------------------------------------------------------------------------


def property_(formula: f.Formula, names: Mapping[str, str]) -> str:
    """The PCTL* formula in PRISM's syntax; each proposition is a label.

    Args:
        formula: a state formula, as the outermost `P>=1 [ ... ]` is one.
        names: the label of each proposition.
    """
    dialect = replace(
        printing.PCTL,
        atom=lambda name: f'"{names[name]}"',
        bounds=lambda ahead: "" if ahead == f.EVER else f"<={ahead.hi}",
    )
    return _Property(dialect).state(formula)


class _Property:
    def __init__(self, dialect: printing.Dialect) -> None:
        self._dialect = dialect

    def state(self, formula: f.Formula) -> str:
        """The text of a state formula."""
        return self._read(formula, self._odds)

    def _odds(self, odds: f.ProbabilityBound) -> str:
        if isinstance(odds.arg, f.Globally) and odds.arg.ahead != f.EVER and _is_simple(odds.arg):
            return self._odds(complement(odds))
        path = f"[ {self._path(odds.arg)} ]"
        if odds.op == "=":
            return f"(P>={odds.bound} {path} & P<={odds.bound} {path})"
        if odds.op == "!=":
            return f"(P<{odds.bound} {path} | P>{odds.bound} {path})"
        return f"P{odds.op}{odds.bound} {path}"

    def _path(self, formula: f.Formula) -> str:
        """The text of a path formula; one operator around state formulas keeps its bound."""
        if _is_simple(formula):
            return self._read(formula, self._odds)
        return self._read(unrolled(formula), self._odds)

    def _read(self, formula: f.Formula, odds: Callable[[f.ProbabilityBound], str]) -> str:
        """The text of the formula, with its probabilities inserted."""
        hidden: dict[str, str] = {}

        def hide(part: f.Formula) -> f.Formula:
            if isinstance(part, f.ProbabilityBound):
                name = f"_{len(hidden)}_"
                hidden[name] = odds(part)
                return f.Atom(name)
            return f.rebuild(part, hide)

        atom = self._dialect.atom
        dialect = replace(
            self._dialect, atom=lambda name: hidden[name] if name in hidden else atom(name)
        )
        return printing.text(printing.for_prism(hide(formula)), dialect)


def complement(odds: f.ProbabilityBound) -> f.ProbabilityBound:
    """`P<=0.1 [ F<=n !a ]` for `P>=0.9 [ G<=n a ]`, which Storm does not read."""
    assert isinstance(odds.arg, f.Globally)
    with localcontext(prec=len(odds.bound) + 2):
        bound = format(1 - Decimal(odds.bound), "f")
    flipped = odds.op.translate(str.maketrans("<>", "><"))
    return f.ProbabilityBound(flipped, bound, f.eventually(f.not_(odds.arg.arg), odds.arg.ahead))


def _is_simple(formula: f.Formula) -> bool:
    """Whether PRISM reads the formula with its bound, as `F<=n a`, or it has no operator."""
    if isinstance(formula, f.Eventually | f.Globally) and formula.ahead.lo == 0:
        return not _is_temporal(formula.arg)
    return False


def _is_temporal(formula: f.Formula) -> bool:
    match formula:
        case f.ProbabilityBound():
            return False  # it is true or false of a state
        case f.Next() | f.Eventually() | f.Globally() | f.Until() | f.Release():
            return True
        case _:
            return any(map(_is_temporal, f.children(formula)))


def unrolled(formula: f.Formula) -> f.Formula:
    """The formula with chains of `X` for bounds; nested probabilities are unchanged."""
    if isinstance(formula, f.ProbabilityBound):
        return formula
    rebuilt = f.rebuild(formula, unrolled)
    match rebuilt:
        case f.Eventually(arg, f.Interval(lo, int(hi))):
            return _later(
                reduce(lambda rest, _: f.or_(arg, f.next_(rest)), range(hi - lo), arg), lo
            )
        case f.Globally(arg, f.Interval(lo, int(hi))):
            return _later(
                reduce(lambda rest, _: f.and_(arg, f.next_(rest)), range(hi - lo), arg), lo
            )
        case _:
            return rebuilt


def _later(formula: f.Formula, ticks: int) -> f.Formula:
    return reduce(lambda rest, _: f.next_(rest), range(ticks), formula)


def _steps(formula: f.Formula) -> int:
    """The number of `X` in the chains of the longest LTL formula in it."""
    match formula:
        case f.ProbabilityBound(_, _, arg):
            return _steps(arg) if _is_simple(arg) else max(_chain(arg), _steps(arg))
        case _:
            return max(map(_steps, f.children(formula)), default=0)


def _chain(formula: f.Formula) -> int:
    match formula:
        case f.ProbabilityBound():
            return 0
        case f.Eventually(arg, f.Interval(_, int(hi))) | f.Globally(arg, f.Interval(_, int(hi))):
            return hi + _chain(arg)
        case _:
            return max(map(_chain, f.children(formula)), default=0)


TARGET = Target(
    "prism", "a property and a frame of a model, for PRISM and Storm", emit, refuse, names=_names
)
