"""`--emit hoa`: the infinite traces of a requirement, as an automaton in the HOA format.

The automaton is the reference automaton (`compiler.formalization.reference`), never a translated
formula: a bound of n ticks takes about n states. It is deterministic and complete; a violated run
ends in a rejecting sink. Büchi acceptance is enough for every sentence: a demand without a deadline
requires one event again and again. Source: Babiak et al., The Hanoi Omega-Automata Format, CAV
2015, and its specification, version 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from compiler.formalization.reference import Letter
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.implicants import Term
from compiler.targets.automata.chart import PLACES, Chart, chart, kind, words
from compiler.targets.automata.expressibility import refusal
from compiler.targets.comparison_names import comparison_names, notes
from compiler.targets.target import Target, file_of_each
from fretish.diagnostics.diagnostic import Diagnostic


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 for a probability or a temporal predicate, F670 for too many states."""
    return refusal(requirement, "HOA")


def _text(requirement: FormalizedRequirement) -> str:
    automaton = chart(requirement)
    atoms = tuple(
        dict.fromkeys(name for part in automaton.inputs.values() for name in f.atoms(part))
    )
    names = comparison_names(requirement)
    numbers = _numbers(automaton)
    rejecting = [old for old in numbers if not automaton.accepts(old)]
    return render(
        "hoa/automaton.hoa.j2",
        id=requirement.id,
        version=__version__,
        sentence=_comment(wording(requirement.entry)),
        propositions=[names.get(name, printing.readable(f.Atom(name))) for name in atoms],
        notes=[_comment(note) for note in notes(requirement)],
        buchi=bool(rejecting),
        # Then no cycle has both accepting and rejecting states.
        weak=set(rejecting) <= {automaton.violated},
        aliases=_Aliases(atoms).of(automaton.inputs),
        start=numbers[automaton.start],
        states=list(_states(requirement, automaton, numbers)),
    )


def _comment(text: str) -> str:
    """The text without the delimiters of HOA comments, which nest."""
    return " ".join(text.split()).replace("*/", "* /").replace("/*", "/ *")


def _numbers(automaton: Chart) -> dict[int, int]:
    """The reachable states, numbered without gaps."""
    deciding = [i for i in (automaton.violated, automaton.satisfied) if automaton.has(i)]
    return {old: new for new, old in enumerate([*range(len(automaton.states)), *deciding])}


def _states(
    requirement: FormalizedRequirement, automaton: Chart, numbers: Mapping[int, int]
) -> Iterator[tuple[int, str, bool, list[tuple[str, int]]]]:
    """The number, name, acceptance and edges of each state."""
    demanded = kind(requirement)
    labels: dict[tuple[Letter, ...], str] = {}
    for index, row in enumerate(automaton.moves):
        targets: dict[int, list[Letter]] = {}
        for letter, after in zip(automaton.letters, row, strict=True):
            targets.setdefault(after, []).append(letter)
        edges = []
        for after, letters in targets.items():
            key = tuple(letters)
            if key not in labels:
                labels[key] = _label(automaton.guard(letters))
            edges.append((labels[key], numbers[after]))
        name = ", ".join(words(demanded, automaton.template, automaton.states[index]))
        yield numbers[index], name, automaton.accepts(index), edges
    for index, name in ((automaton.violated, "violated"), (automaton.satisfied, "satisfied")):
        if index in numbers:
            accepts = automaton.accepts(index)
            yield numbers[index], name, accepts, [("t", numbers[index])]


def _label(terms: Iterable[Term]) -> str:
    """A label over the aliases: `@condition & !@response | @stop`."""
    return " | ".join(
        " & ".join(f"{'' if value else '!'}@{PLACES[i]}" for i, value in sorted(term.items()))
        or "t"
        for term in terms
    )


class _Aliases:
    """Definitions of the expressions, over the numbers of propositions.

    HOA has neither implication nor equivalence. A sub-formula that would be needed twice gets an
    alias, so that a text is as long as its formula.
    """

    def __init__(self, atoms: Sequence[str]) -> None:
        self._numbers = {name: str(i) for i, name in enumerate(atoms)}
        self._found: dict[str, str] = {}

    def of(self, inputs: Mapping[int, f.Formula]) -> Mapping[str, str]:
        """The text of each alias by its name, after the aliases that it uses."""
        for index, part in inputs.items():
            text = self._text(part)
            self._found[PLACES[index]] = text
        return self._found

    def _text(self, formula: f.Formula) -> str:
        match formula:
            case f.Const(value):
                return "t" if value else "f"
            case f.Atom(name):
                return self._numbers[name]
            case f.Not(arg):
                return f"!{self._operand(arg)}"
            case f.And(args):
                return " & ".join(map(self._operand, args))
            case f.Or(args):
                return " | ".join(map(self._operand, args))
            case f.Implies(left, right):
                return f"!{self._operand(left)} | {self._operand(right)}"
            case f.Iff(left, right):
                a, b = self._short(left), self._short(right)
                return f"{a} & {b} | !{a} & !{b}"
            case f.Xor(left, right):
                a, b = self._short(left), self._short(right)
                return f"{a} & !{b} | !{a} & {b}"
            case _:
                raise AssertionError(f"not of one tick: {formula}")

    def _operand(self, formula: f.Formula) -> str:
        text = self._text(formula)
        return text if isinstance(formula, f.Const | f.Atom | f.Not) else f"({text})"

    def _short(self, formula: f.Formula) -> str:
        """The text of an atom or a constant, or an alias for another formula."""
        text = self._text(formula)
        if isinstance(formula, f.Const | f.Atom):
            return text
        name = f"part{len(self._found)}"
        self._found[name] = text
        return f"@{name}"


TARGET = Target(
    "hoa",
    "a deterministic Büchi automaton in the HOA format",
    file_of_each("hoa", lambda requirement, _: _text(requirement)),
    refuse,
)
