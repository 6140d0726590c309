"""One requirement with its formulas, bindings and definitions."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import field, replace
from functools import cached_property
from itertools import chain

from compiler.formalization.obligation import Obligation, atom, obligation, variable
from compiler.formalization.past import MonitorSpec
from compiler.formalization.predicates import Past
from compiler.logic.formula import Formula, atoms
from fretish import expressions as e
from fretish.bindings.declarations import Declarations, Variable
from fretish.bindings.definitions import Definitions, expanded
from fretish.checking import LOOK_BACK, conditions
from fretish.classes.frozen import dataclass
from fretish.clock import Clock
from fretish.diagnostics.source import Source, Span
from fretish.documents import RequirementEntry
from fretish.expressions import Name, names
from fretish.parser import parse
from fretish.printer import canonical, expression
from fretish.printer import sentence as printed
from fretish.reading.recursion import with_recursion_limit
from fretish.syntax import Sentence


@dataclass(frozen=True)
class FormalizedRequirement:
    """A formalized requirement: its meaning as three formulas, and as signals to monitor."""

    entry: RequirementEntry
    written: Sentence
    """The sentence as written: with units, and with defined names."""
    sentence: Sentence
    """The sentence with names replaced by their definitions, and numbers in the units of the
    signals. A unit stays if no signal is declared."""
    ticks: int | None
    """The duration in ticks; None if the sentence has none."""
    clock: Clock | None
    """The clock; None if there are no bindings."""
    ft_infinite: Formula
    """Future-time formula on infinite traces."""
    ft_finite: Formula
    """Future-time formula on finite traces, with `LAST`; evaluated at the first tick."""
    pt: Formula
    """Past-time formula; evaluated at the last tick."""
    watch: MonitorSpec
    pctl: Formula | None
    """PCTL* formula; None if the sentence has no probability."""
    glossary: Mapping[str, Variable]
    """Every variable that the bindings declare, bound or not."""
    declarations: Declarations | None = None
    """All bindings; None if there are none."""
    definitions: Definitions = field(default_factory=dict)
    """The definitions of names in `written`, each after those that it uses."""

    @property
    def id(self) -> str:
        """The requirement's id."""
        return self.entry.id

    @cached_property
    def propositions(self) -> tuple[str, ...]:
        """The atoms of the sentence, in the order of the future-time formula.

        A formula may lack some: `finally` says nothing of an infinite run.
        """
        formulas = (self.ft_infinite, self.ft_finite, self.pt, *self.watch.signals)
        return tuple(dict.fromkeys(name for formula in formulas for name in atoms(formula)))

    @cached_property
    def watched(self) -> tuple[str, ...]:
        """The propositions that a monitor needs, without predicates that look back.

        If each trigger is counted separately, the propositions of all parts are needed.
        """
        needed = {name for signal in self.watch.signals for name in atoms(signal)}
        counted: tuple[str, ...] = ()
        if self.sentence.probability is not None:
            counted = self.demanded.atoms
        names = dict.fromkeys((*self.propositions, *counted))
        return tuple(name for name in names if name in needed or name in counted)

    @cached_property
    def demanded(self) -> Obligation:
        """The demand of the sentence, as formulas of the past."""
        return obligation(self.sentence, self.ticks or 0, Past())

    @cached_property
    def variables(self) -> tuple[str, ...]:
        """Every variable of the sentence, in order of appearance, also within comparisons."""
        occurrences = [
            name
            for expression in conditions(self.sentence)
            for name in names(expression)
            if name.id != "FTP"
        ]
        return tuple(dict.fromkeys(name.id for name in sorted(occurrences, key=_place)))

    @cached_property
    @with_recursion_limit
    def stated(self) -> Mapping[str, e.Expression]:
        """The comparisons and calls of the sentence, by the names that formulas give them.

        A quoted name that reads as a comparison counts as one. A predicate that looks back, within
        another call, is left out: it is never an atom there.
        """
        expressions: dict[str, e.Expression] = {}
        waiting = [(expression, False) for expression in conditions(self.sentence)]
        while waiting:
            part, inside = waiting.pop()
            expanded = inside and isinstance(part, e.Call) and part.name in LOOK_BACK
            if isinstance(part, e.Comparison | e.Call) and not expanded:
                expressions[atom(part)] = part
            elif isinstance(part, e.Name):
                quoted = _quoted(part)
                expressions |= {variable(part.id): quoted} if quoted is not None else {}
            inside |= isinstance(part, e.Call)
            waiting.extend((child, inside) for child in e.children(part))
        return expressions

    @cached_property
    @with_recursion_limit
    def wordings(self) -> Mapping[str, str]:
        """The display text of atoms, with the numbers and units of the sentence.

        The keys are the names in formulas; atoms whose text is their name are left out.
        """
        whole = expanded(self.written, self.definitions)
        assert isinstance(whole, Sentence), "the requirement has been made of it"
        texts: dict[str, str] = {}
        waiting = [*zip(conditions(self.sentence), conditions(whole), strict=True)]
        while waiting:
            own, part = waiting.pop()
            if isinstance(own, e.Comparison | e.Call) and expression(own) != expression(part):
                texts.setdefault(atom(own), f"({expression(part)})")
            if not isinstance(own, e.Comparison):
                waiting.extend(zip(e.children(own), e.children(part), strict=True))
        return texts

    @cached_property
    def mentions(self) -> Mapping[str, Span]:
        """The first occurrence of each variable in the sentence."""
        spans: dict[str, Span] = {}
        for name in chain.from_iterable(map(names, conditions(self.sentence))):
            if name.span is not None:
                spans.setdefault(name.id, name.span)
        return spans

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the canonical sentence, without white space and variants of key words.

        The definitions of its names are included.
        """
        lines = [canonical(self.written)]
        lines += [f"{name} = {expression(value)}" for name, value in self.definitions.items()]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _quoted(name: Name) -> e.Comparison | None:
    """The comparison that a quoted name spells; None if it does not."""
    if not any(sign in name.id for sign in "<>="):
        return None
    read = parse(Source("name", f"the component shall satisfy ({name.id})").span())
    response = read.response if isinstance(read, Sentence) else None
    return response if isinstance(response, e.Comparison) else None


def _place(name: Name) -> int:
    return name.span.start if name.span else 0


def without_probability(requirement: FormalizedRequirement) -> FormalizedRequirement:
    """The requirement without its probability, under the same id."""
    if requirement.sentence.probability is None:
        return requirement
    sentence = replace(requirement.sentence, probability=None)
    written = replace(requirement.written, probability=None)
    source = Source(requirement.entry.wording.source.name, printed(written))
    entry = replace(requirement.entry, wording=source.span())
    return replace(requirement, entry=entry, written=written, sentence=sentence, pctl=None)
