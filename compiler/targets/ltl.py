"""`--emit ltl`: the formulas for people to read."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from compiler.logic import printing
from compiler.logic.identifiers import legal_names
from compiler.logic.spelling.reserved_words import SMV
from compiler.targets.comparison_names import comparison_names, definitions
from compiler.targets.target import DEFAULT, Target, TargetOptions, file_of_each
from fretish.diagnostics.rendering import visible
from fretish.meaning import meaning


def text(requirement: FormalizedRequirement, options: TargetOptions = DEFAULT) -> str:
    """The text of a file: the sentence, its meaning, and its formulas."""
    dialect = printing.DIALECTS[options.notation]
    names = _names(requirement, dialect)
    if names:
        spelt = dialect.atom
        dialect = replace(dialect, atom=lambda atom: names[atom] if atom in names else spelt(atom))
    lines = {
        "meaning": meaning(requirement.written, requirement.ticks, requirement.clock),
        "FT": printing.text(requirement.ft_infinite, dialect),
    }
    if options.simplify:
        lines["FT, simplified"] = _simplified(requirement)
    lines["FT, finite"] = printing.text(requirement.ft_finite, dialect)
    lines["PT"] = (
        printing.text(requirement.pt, dialect)
        if dialect.has_past
        else f"({dialect.name} has no past operators)"
    )
    if requirement.pctl is not None:
        lines["PCTL*"] = printing.pctl(requirement.pctl)
    lines |= definitions(requirement, names)
    return render(
        "ltl/requirement.ltl.j2",
        id=requirement.id,
        title=visible(" ".join(requirement.entry.title.split())),
        sentence=wording(requirement.entry),
        lines=lines,
        width=max(map(len, lines)),
    )


def _names(requirement: FormalizedRequirement, dialect: printing.Dialect) -> Mapping[str, str]:
    """The propositions with a different name in the notation."""
    if dialect == printing.SPOT:
        return comparison_names(requirement)  # any other is in quotes where it has to be
    if dialect != printing.NUSMV:
        return {}
    names = legal_names(
        requirement.propositions, SMV | {"LAST"}, names=comparison_names(requirement)
    )
    return {atom: name for atom, name in names.items() if name != printing.identifier(atom)}


def _simplified(requirement: FormalizedRequirement) -> str:
    """Spot's shorter form, proved equivalent; or the reason why there is none."""
    from compiler.logic.spot import simplified

    shorter = simplified(requirement.ft_infinite)
    return shorter if shorter is not None else "(Spot finds nothing shorter)"


TARGET = Target("ltl", "future-time and past-time formulas, for reading", file_of_each("ltl", text))
