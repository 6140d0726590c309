"""`--emit smv`: the counter automaton of a requirement as a module for NuSMV and nuXmv.

The module follows the definition of the timing, with one bounded integer for any bound. The file
also has the formulas, and properties that link them with the module and must be true. So a
checker's answers to these properties are evidence about formulas and automaton. Source of the
language: Cavada et al., NuSMV 2.6 User Manual, chapters 2 and 3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of, impossible_combinations
from compiler.formalization.obligation import TRAITS, Obligation, Trait, obligation
from compiler.formalization.record import wording
from compiler.logic import printing
from compiler.logic.identifiers import legal_names
from compiler.logic.orders import Exclusion
from compiler.logic.spelling.reserved_words import SMV
from compiler.targets.automata.expressibility import no_automaton
from compiler.targets.automata.smv_symbols import monitor
from compiler.targets.comparison_names import comparison_names, in_words
from compiler.targets.target import Target, file_of_each, identifier
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 for a probability or a temporal predicate."""
    return no_automaton(requirement, "NuSMV")


@dataclass(frozen=True, slots=True)
class Spec:
    """An LTL property of the file, with its expected result in the comment."""

    name: str
    formula: str
    comment: str


def _text(requirement: FormalizedRequirement) -> str:
    demanded = obligation(requirement.sentence, requirement.ticks or 0)
    plain = identifier(requirement)
    monitor_name, instance = _modules(requirement)
    names = _names(requirement)
    meanings = in_words(requirement)
    module = monitor(demanded)
    dialect = replace(printing.NUSMV, atom=names.__getitem__, full=True)
    actual = {
        "mode": demanded.mode,
        "condition": demanded.trigger,
        "response": demanded.demand.response,
        "stop": demanded.demand.stop,
    }
    return render(
        "smv/monitor.smv.j2",
        id=requirement.id,
        sentence=wording(requirement.entry),
        variables=[(names[name], meanings.get(name, name)) for name in names],
        impossible=[
            _together(exclusion, names) for exclusion in impossible_combinations(requirement)
        ],
        instance=instance,
        module_name=monitor_name,
        module=module,
        arguments=[printing.text(actual[name], dialect) for name in module.parameters],
        negated=demanded.scope is not None and demanded.scope.negates,
        specs=_specs(requirement, demanded, (plain, instance), dialect),
    )


def _modules(requirement: FormalizedRequirement) -> tuple[str, str]:
    """The name of the module, and the name of its instance."""
    name = f"monitor_{identifier(requirement)}"
    return name, f"the_{name}"


def _names(requirement: FormalizedRequirement) -> Mapping[str, str]:
    """The names of all propositions; formulas may lack some, as `only after m` may lack m."""
    propositions = (*requirement.propositions, *atoms_of(requirement.sentence))
    return legal_names(
        propositions, SMV | {*_modules(requirement)}, names=comparison_names(requirement)
    )


def _together(exclusion: Exclusion, names: Mapping[str, str]) -> str:
    return " & ".join(f"{'' if value else '!'}{names[name]}" for name, value in exclusion)


def _specs(
    requirement: FormalizedRequirement,
    demanded: Obligation,
    names: tuple[str, str],
    dialect: printing.Dialect,
) -> list[Spec]:
    """The formulas, and the properties that link them to the module.

    Args:
        requirement: the requirement.
        demanded: the obligation that the module implements.
        names: the prefix of the properties' names, and the name of the module's instance.
        dialect: with the names of the propositions.
    """
    prefix, instance = names
    ft, pt = printing.text(requirement.ft_infinite, dialect), printing.text(requirement.pt, dialect)
    safe = f"(G (!{instance}.violated))"
    traits = TRAITS[demanded.demand.kind]
    unmet = Trait.UNMET in traits
    if unmet and Trait.LAST not in traits:
        safe = f"({safe} & (G (F (!{instance}.unmet))))"
    ends = f"(!{instance}.violated{f' & !{instance}.unmet' if unmet else ''})"
    specs = [
        Spec(f"{prefix}_ft", ft, "the requirement, on infinite traces: what you want to know"),
        Spec(f"{prefix}_ft_is_monitor", f"({safe} <-> {ft})", "expected true: FT is the module"),
        Spec(
            f"{prefix}_pt_is_monitor",
            f"(G ({pt} <-> {ends}))",
            "expected true: PT has the verdict of the module on every finite trace that ends here",
        ),
    ]
    if not unmet:
        comment = "expected true: nothing is left for the end to decide, so PT everywhere is FT"
        specs.append(Spec(f"{prefix}_pt_is_ft", f"((G {pt}) <-> {ft})", comment))
    return specs


TARGET = Target(
    "smv",
    "a model with the monitor as a module, for NuSMV and nuXmv",
    file_of_each("smv", lambda requirement, _: _text(requirement)),
    refuse,
    next_step="`NuSMV {}` checks its properties",
    names=_names,
)
