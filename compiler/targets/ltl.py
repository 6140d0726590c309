"""`--emit ltl`: the formulas, readable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from compiler.logic import printing
from compiler.logic.identifiers import legal_names
from compiler.logic.spelling.reserved_words import SMV
from compiler.targets.comparison_names import comparison_names, definitions
from compiler.targets.target import DEFAULT, Options, Target, stem
from fretish.diagnostics.rendering import visible
from fretish.meaning import meaning


def emit(
    rules: Sequence[FormalizedRequirement], options: Options = DEFAULT
) -> tuple[Artifact, ...]:
    """`<id>.ltl` for each rule."""
    return tuple(
        Artifact(PurePosixPath(f"{stem(rule)}.ltl"), text(rule, options)) for rule in rules
    )


def text(rule: FormalizedRequirement, options: Options = DEFAULT) -> str:
    """What a person reads: the sentence, its meaning, and its formulas."""
    dialect = printing.DIALECTS[options.notation]
    names = _names(rule, dialect)
    if names:
        spelt = dialect.atom
        dialect = replace(dialect, atom=lambda atom: names[atom] if atom in names else spelt(atom))
    lines = {
        "meaning": meaning(rule.written, rule.ticks, rule.clock),
        "FT": printing.text(rule.ft_infinite, dialect),
    }
    if options.simplify:
        lines["FT, simplified"] = _simplified(rule)
    lines["FT, finite"] = printing.text(rule.ft_finite, dialect)
    lines["PT"] = (
        printing.text(rule.pt, dialect)
        if dialect.has_past
        else f"({dialect.name} has no past operators)"
    )
    if rule.pctl is not None:
        lines["PCTL*"] = printing.pctl(rule.pctl)
    lines |= definitions(rule, names)
    return render(
        "ltl/requirement.ltl.j2",
        id=rule.id,
        title=visible(" ".join(rule.requirement.title.split())),
        sentence=wording(rule.requirement),
        lines=lines,
        width=max(map(len, lines)),
    )


def _names(rule: FormalizedRequirement, dialect: printing.Dialect) -> Mapping[str, str]:
    """What propositions are called in a notation, where it is not what they are."""
    if dialect == printing.SPOT:
        return comparison_names(rule)  # any other is in quotes where it has to be
    if dialect != printing.NUSMV:
        return {}
    names = legal_names(rule.propositions, SMV | {"LAST"}, names=comparison_names(rule))
    return {atom: name for atom, name in names.items() if name != printing.identifier(atom)}


def _simplified(rule: FormalizedRequirement) -> str:
    """Spot's shorter form, proved equivalent; or why there is none."""
    from compiler.logic.spot import simplified

    shorter = simplified(rule.ft_infinite)
    return shorter if shorter is not None else "(Spot finds nothing shorter)"


TARGET = Target("ltl", "future-time and past-time formulas, for reading", emit)
