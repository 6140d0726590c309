"""`--emit smv`: the counter automaton of a requirement as a module for NuSMV and nuXmv.

The module is written from the definition of the timing, with one bounded integer, whatever the
bound; the formulas stand beside it, and the two are linked by properties that have to be true.
What a checker says of the links is then evidence about formulas and automaton alike.
Source of the language: Cavada et al., NuSMV 2.6 User Manual, chapters 2 and 3.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.letters import atoms_of
from compiler.formalization.obligation import TRAITS, Obligation, Trait, obligation
from compiler.formalization.record import wording
from compiler.formalization.rule import Rule
from compiler.logic import printing
from compiler.logic.identifiers import legal_names
from compiler.targets.automata.refusals import no_automaton
from compiler.targets.automata.smv_symbols import monitor
from compiler.targets.target import DEFAULT, Options, Target, stem
from fretish.checking import RESERVED
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import deep

_RESERVED = RESERVED | frozenset(
    "ABU BU EBG COMPID CONSTARRAY COMPWFF READ WRITE W always and assert before bool clock cos "
    "count exp floor in inside last_run first_run ln main mod never next noncontinuous not of or "
    "outside over pi sin tan time toint typeof until urandom within word xor xnor".split()
)
"""Key words of NuSMV, nuXmv and PSL; and the phases, as constants are known in all modules."""


def refuse(rule: Rule) -> Diagnostic | None:
    """F601 for a probability or a temporal predicate."""
    return no_automaton(rule, "NuSMV")


@deep
def emit(rules: Sequence[Rule], options: Options = DEFAULT) -> tuple[Artifact, ...]:
    """`<id>.smv` for each rule."""
    return tuple(Artifact(PurePosixPath(f"{stem(rule)}.smv"), _text(rule)) for rule in rules)


@dataclass(frozen=True, slots=True)
class Spec:
    """An LTL property of the file, and what is to be expected of it."""

    name: str
    formula: str
    comment: str


def _text(rule: Rule) -> str:
    demanded = obligation(rule.sentence, rule.ticks or 0)
    plain = re.sub(r"\W", "_", stem(rule))
    monitor_name = f"monitor_{plain}"
    instance = f"the_{monitor_name}"
    # The formulas may lack some: `only after m` says nothing of m where nothing is demanded.
    propositions = tuple(dict.fromkeys((*rule.propositions, *atoms_of(rule.sentence))))
    names = legal_names(propositions, _RESERVED | {instance, monitor_name})
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
        id=rule.id,
        sentence=wording(rule.requirement),
        variables=[(names[name], name) for name in propositions],
        instance=instance,
        module_name=monitor_name,
        module=module,
        arguments=[printing.text(actual[name], dialect) for name in module.parameters],
        negated=demanded.scope is not None and demanded.scope.negates,
        specs=_specs(rule, demanded, (plain, instance), dialect),
    )


def _specs(
    rule: Rule, demanded: Obligation, names: tuple[str, str], dialect: printing.Dialect
) -> list[Spec]:
    """The formulas, and what links them to the module.

    Args:
        rule: what is formalized.
        demanded: what the module was made from.
        names: what those of the properties begin with, and that of the module's instance.
        dialect: with the names of the propositions.
    """
    prefix, instance = names
    ft, pt = printing.text(rule.ft_infinite, dialect), printing.text(rule.pt, dialect)
    kept = f"(G (!{instance}.violated))"
    traits = TRAITS[demanded.demand.kind]
    unmet = Trait.UNMET in traits
    if unmet and Trait.LAST not in traits:
        kept = f"({kept} & (G (F (!{instance}.unmet))))"
    ends = f"(!{instance}.violated{f' & !{instance}.unmet' if unmet else ''})"
    found = [
        Spec(f"{prefix}_ft", ft, "the requirement, on infinite traces: what you want to know"),
        Spec(f"{prefix}_ft_is_monitor", f"({kept} <-> {ft})", "expected true: FT is the module"),
        Spec(
            f"{prefix}_pt_is_monitor",
            f"(G ({pt} <-> {ends}))",
            "expected true: PT tells of every finite trace that ends here what the module tells",
        ),
    ]
    if not unmet:
        told = "expected true: nothing is left for the end to decide, so PT everywhere is FT"
        found.append(Spec(f"{prefix}_pt_is_ft", f"((G {pt}) <-> {ft})", told))
    return found


TARGET = Target("smv", "a model with the monitor as a module, for NuSMV and nuXmv", emit, refuse)
