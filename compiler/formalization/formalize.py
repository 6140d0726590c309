"""The order of everything: from a requirement as written to a rule, by way of its tree."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

from compiler.formalization import predicates
from compiler.formalization.anticipation import anticipated
from compiler.formalization.binding_agreement import disagreements
from compiler.formalization.future import future, probabilistic
from compiler.formalization.obligation import obligation
from compiler.formalization.past import past, watch
from compiler.formalization.rule import Rule
from compiler.logic.formula import endless
from compiler.logic.printing import identifier
from fretish import expressions as e
from fretish import units
from fretish.bindings.constants import constants
from fretish.bindings.declarations import Declarations, Modality, Variable
from fretish.checking import conditions, temporal_predicates, too_deep
from fretish.clock import Clock, assumed_ticks, in_ticks
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Span
from fretish.documents import Requirement
from fretish.parser import parse
from fretish.pitfalls import surprises
from fretish.reading.limits import within
from fretish.reading.recursion import deep
from fretish.reading.toml_text import as_key
from fretish.syntax import Sentence


@deep
def formalize(
    requirement: Requirement, declarations: Declarations | None
) -> tuple[Rule | None, tuple[Diagnostic, ...]]:
    """Parse, check and formalize one requirement.

    Returns:
        The rule, or None where there is an error; and all that there is to say.
    """
    wording = requirement.wording
    reading = partial(_formalized, requirement, declarations)
    found = within(wording.end - wording.start, wording, reading)
    return (None, (found,)) if isinstance(found, Diagnostic) else found


def _formalized(
    requirement: Requirement, declarations: Declarations | None
) -> tuple[Rule | None, tuple[Diagnostic, ...]]:
    if requirement.is_free_text:
        return None, (_free_text(requirement),)
    sentence = parse(requirement.wording)
    if isinstance(sentence, Diagnostic):
        return None, (sentence,)
    ticks = in_ticks(sentence, _clock(declarations))
    if isinstance(ticks, Diagnostic):
        return None, (ticks,)
    try:
        rule = _rule(requirement, sentence, ticks, declarations)
    except RecursionError:  # some versions of Python bound it below what `deep` asks for
        return None, (too_deep(sentence),)
    wrong = (*clashes([rule]), *(disagreements(rule, declarations) if declarations else ()))
    if wrong:
        return None, wrong
    return rule, tuple(_remarks(requirement, sentence, declarations))


def clashes(rules: Sequence[Rule]) -> Iterator[Diagnostic]:
    """F116: formulas spell `a.b` as `a_DOT_b`, and another name is spelt so already."""
    spelt: dict[str, str] = {}
    for rule in rules:
        for name in rule.variables:
            first = spelt.setdefault(identifier(name), name)
            if first != name:
                yield Diagnostic(
                    Code.NAME_CLASH,
                    f"`{first}` and `{name}` would be one name in formulas: `{identifier(name)}`",
                    _place(rule, name),
                    help="rename one of them",
                )


def _rule(
    requirement: Requirement,
    sentence: Sentence,
    ticks: int | None,
    declarations: Declarations | None,
) -> Rule:
    """The three formulas and the watch, each from the same obligation."""
    ahead = obligation(sentence, ticks or 0, predicates.Future())
    back = obligation(sentence, ticks or 0, predicates.Past())
    finite = future(ahead)
    odds = sentence.probability
    return Rule(
        requirement=requirement,
        sentence=sentence,
        ticks=ticks,
        clock=_clock(declarations),
        ft_infinite=endless(finite),
        ft_finite=finite,
        pt=past(back),
        watch=anticipated(sentence, back, watch(back)),
        pctl=probabilistic(ahead, odds.op, odds.digits) if odds else None,
        glossary=_glossary(declarations),
        declarations=declarations,
    )


def _glossary(declarations: Declarations | None) -> Mapping[str, Variable]:
    """What is declared of each variable; a bound proposition tells its role and its text.

    A modality other than belief counts wherever it is declared.
    """
    if declarations is None:
        return {}
    bound = {
        name: Variable(
            name,
            type="boolean",
            role=str(p.role),
            text=p.text,
            modality=p.modality,
            action=p.action,
        )
        for name, p in declarations.propositions.items()
    }
    named = {
        name: _with_bound(variable, bound[name]) if name in bound else variable
        for name, variable in declarations.variables.items()
    }
    return {**bound, **named}


def _with_bound(variable: Variable, bound: Variable) -> Variable:
    """What FRET's glossary says of a name, and what only its binding says."""
    modality = bound.modality if variable.modality is Modality.BELIEF else variable.modality
    return replace(variable, modality=modality, action=variable.action or bound.action)


def _free_text(requirement: Requirement) -> Diagnostic:
    return Diagnostic(
        Code.FREE_TEXT,
        f"{requirement.id} is free text: it is kept, and not formalized",
        requirement.wording,
        help="write it in FRETish, without quotes around the whole, to formalize it",
        severity=Severity.NOTE,
    )


def _clock(declarations: Declarations | None) -> Clock | None:
    return declarations.clock if declarations and declarations.clock.declared else None


def _remarks(
    requirement: Requirement, sentence: Sentence, declarations: Declarations | None
) -> Iterator[Diagnostic]:
    clock = _clock(declarations)
    assumed = assumed_ticks(sentence, clock)
    if assumed is not None:
        yield assumed
    yield from surprises(sentence)
    yield from temporal_predicates(sentence)
    if declarations is not None:
        yield from drift(requirement, declarations)


def drift(requirement: Requirement, declarations: Declarations) -> Iterator[Diagnostic]:
    """F310: a number that the requirement states is not the one its binding compares with."""
    for name, text in requirement.params.items():
        place = requirement.place("params", name)
        proposition = declarations.propositions.get(name)
        if proposition is None and ("proposition", name) not in declarations.mistakes:
            yield Diagnostic(
                Code.UNKNOWN_NAME,
                f"`params` states a number for `{name}`, which has no binding",
                place,
                help="name the proposition that the number belongs to, and bind it",
            )
            continue
        stated = units.quantity(text)
        if stated is None:
            yield Diagnostic(
                Code.BAD_FIELD,
                f"`{text}` is no quantity",
                place,
                help='write a number and a unit: `"5 cm"`',
            )
        elif proposition is not None and stated not in constants(proposition.expression):
            yield Diagnostic(
                Code.PARAMETER_DRIFT,
                f"the requirement states {text} for `{name}`, and its binding has another number",
                proposition.span,
                help="make the binding or `params` say what is meant",
                severity=Severity.WARNING,
            )


def unbound(rule: Rule, declarations: Declarations) -> Iterator[Diagnostic]:
    """F304 for every proposition of the sentence that the bindings do not have.

    Where they have one that cannot be used, it is the mistakes in its tables. No other proposition
    is proposed in its place: the nearest name may be another safety claim.
    """
    for name in rule.watched:
        mistakes = declarations.mistakes.get(("proposition", name), ())
        yield from mistakes
        if mistakes or name in declarations.propositions:
            continue
        yield Diagnostic(
            Code.UNBOUND,
            f"`{name}` of {rule.id} has no binding in {declarations.source.name}",
            _place(rule, name),
            help=f"add `[proposition.{as_key(name)}]` there",
        )


def _place(rule: Rule, name: str) -> Span:
    """Where the sentence names it first; the whole sentence for a comparison."""
    for expression in conditions(rule.sentence):
        for variable in e.names(expression):
            if variable.id == name and variable.span is not None:
                return variable.span
    return rule.requirement.wording


def duplicates(requirements: Sequence[Requirement]) -> Mapping[int, Diagnostic]:
    """F201 for every id that comes again; capitals, `-`, `_` and `.` do not tell files apart.

    Returns:
        By the `id()` of each requirement whose id is not its own, the first one's too.
    """
    first: dict[str, Requirement] = {}
    found: dict[int, Diagnostic] = {}
    for requirement in requirements:
        earlier = first.setdefault(re.sub(r"[-.]", "_", requirement.id.lower()), requirement)
        if earlier is not requirement:
            place = earlier.place("id")
            found[id(requirement)] = Diagnostic(
                Code.DUPLICATE_ID,
                f"the id `{requirement.id}` is taken: {place.source.name}:{place.line}",
                requirement.place("id"),
                help="give each an id of its own; capitals, `-`, `_` and `.` do not count",
            )
            found.setdefault(id(earlier), found[id(requirement)])
    return found
