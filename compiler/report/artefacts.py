"""What every target makes of a requirement, by name and hash."""

from __future__ import annotations

from compiler.files import sha256
from compiler.report.views import ArtefactView
from compiler.rule import Rule
from compiler.targets import TARGETS
from compiler.targets.target import Target

_ORDER = ("monitor", "ltl", "ajpf", "json")


def artefacts(rule: Rule | None) -> tuple[ArtefactView, ...]:
    """A view for each file that the targets make; for a target that refuses, why."""
    if rule is None:
        return ()
    known = [name for name in _ORDER if name in TARGETS]
    others = [name for name, target in TARGETS.items() if target.per_rule and name not in known]
    names = [*known, *others]
    return tuple(view for name in names for view in _of_target(TARGETS[name], rule))


def _of_target(target: Target, rule: Rule) -> tuple[ArtefactView, ...]:
    refused = target.refuse(rule)
    if refused is not None:
        mend = f"; {refused.help}" if refused.help else ""
        refusal = f"{refused.code.number} {refused.message}{mend}"
        return (ArtefactView(target.name, "", "", refusal),)
    return tuple(
        ArtefactView(target.name, str(artifact.path), sha256(artifact.text), "")
        for artifact in target.emit([rule])
    )
