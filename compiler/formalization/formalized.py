"""One requirement with everything that is known of its meaning."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
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
    """A requirement, formalized: one meaning in three formulas, and as signals to watch."""

    entry: RequirementEntry
    written: Sentence
    """As it was written, with units, and with names that stand for something else."""
    sentence: Sentence
    """With what names stand for, and with bare numbers, in the units of the signals; a unit stays
    where no signal is declared."""
    ticks: int | None
    """What the duration counts; None where the sentence has none."""
    clock: Clock | None
    """None where no bindings are at hand."""
    ft_infinite: Formula
    """Future-time, on infinite traces."""
    ft_finite: Formula
    """Future-time, on finite traces, with `LAST`; at the first tick."""
    pt: Formula
    """Past-time; at the last tick."""
    watch: MonitorSpec
    pctl: Formula | None
    """PCTL*; None where the sentence gives no probability."""
    glossary: Mapping[str, Variable]
    """Every variable that the bindings declare, bound or not."""
    declarations: Declarations | None = None
    """The bindings as a whole; None where none are at hand."""
    definitions: Definitions = field(default_factory=dict)
    """What names of the sentence as written stand for, each after those that it needs."""

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
        """The propositions that a monitor needs: predicates that look back are none of them.

        Where triggers are counted, each on its own, those of all parts of the sentence are needed.
        """
        needed = {name for signal in self.watch.signals for name in atoms(signal)}
        counted: tuple[str, ...] = ()
        if self.sentence.probability is not None:
            counted = self.demanded.atoms
        known = dict.fromkeys((*self.propositions, *counted))
        return tuple(name for name in known if name in needed or name in counted)

    @cached_property
    def demanded(self) -> Obligation:
        """What the sentence demands, in formulas of the past."""
        return obligation(self.sentence, self.ticks or 0, Past())

    @cached_property
    def variables(self) -> tuple[str, ...]:
        """Every variable of the sentence, also those within comparisons, as they come in it."""
        found = [
            name
            for expression in conditions(self.sentence)
            for name in names(expression)
            if name.id != "FTP"
        ]
        return tuple(dict.fromkeys(name.id for name in sorted(found, key=_place)))

    @cached_property
    @with_recursion_limit
    def stated(self) -> Mapping[str, e.Expression]:
        """The comparisons and calls of the sentence, by the names that formulas give them.

        So is a name in quotes that reads as a comparison. A predicate that looks back is none of
        them within another call: it is never an atom there.
        """
        found: dict[str, e.Expression] = {}
        waiting = [(expression, False) for expression in conditions(self.sentence)]
        while waiting:
            part, inside = waiting.pop()
            expanded = inside and isinstance(part, e.Call) and part.name in LOOK_BACK
            if isinstance(part, e.Comparison | e.Call) and not expanded:
                found[atom(part)] = part
            elif isinstance(part, e.Name):
                quoted = _quoted(part)
                found |= {variable(part.id): quoted} if quoted is not None else {}
            inside |= isinstance(part, e.Call)
            waiting.extend((each, inside) for each in e.children(part))
        return found

    @cached_property
    @with_recursion_limit
    def wordings(self) -> Mapping[str, str]:
        """How atoms are shown to people: with the numbers and units that the sentence has.

        By the names that formulas give them; those that are written so already are left out.
        """
        whole = expanded(self.written, self.definitions)
        assert isinstance(whole, Sentence), "the requirement has been made of it"
        found: dict[str, str] = {}
        waiting = [*zip(conditions(self.sentence), conditions(whole), strict=True)]
        while waiting:
            own, part = waiting.pop()
            if isinstance(own, e.Comparison | e.Call) and expression(own) != expression(part):
                found.setdefault(atom(own), f"({expression(part)})")
            if not isinstance(own, e.Comparison):
                waiting.extend(zip(e.children(own), e.children(part), strict=True))
        return found

    @cached_property
    def mentions(self) -> Mapping[str, Span]:
        """Where the sentence first has each variable."""
        found: dict[str, Span] = {}
        for name in chain.from_iterable(map(names, conditions(self.sentence))):
            if name.span is not None:
                found.setdefault(name.id, name.span)
        return found

    @cached_property
    def fingerprint(self) -> str:
        """SHA-256 of the canonical sentence: white space and wording of key words do not count.

        What its names stand for counts.
        """
        lines = [canonical(self.written)]
        lines += [f"{name} = {expression(value)}" for name, value in self.definitions.items()]
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _quoted(name: Name) -> e.Comparison | None:
    """What the letters of a name in quotes say, where that is a comparison."""
    if not any(sign in name.id for sign in "<>="):
        return None
    read = parse(Source("name", f"the component shall satisfy ({name.id})").span())
    response = read.response if isinstance(read, Sentence) else None
    return response if isinstance(response, e.Comparison) else None


def _place(name: Name) -> int:
    return name.span.start if name.span else 0


def plain(requirement: FormalizedRequirement) -> FormalizedRequirement:
    """The requirement of the same sentence without its probability, under the same id."""
    if requirement.sentence.probability is None:
        return requirement
    sentence = replace(requirement.sentence, probability=None)
    written = replace(requirement.written, probability=None)
    source = Source(requirement.entry.wording.source.name, printed(written))
    entry = replace(requirement.entry, wording=source.span())
    return replace(requirement, entry=entry, written=written, sentence=sentence, pctl=None)
