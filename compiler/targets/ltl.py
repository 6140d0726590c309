"""`--emit ltl`: the formulas, readable."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

from compiler import printing
from compiler.rule import Rule
from compiler.targets.target import Artifact, Target, stem
from compiler.templating import render
from fretish.meaning import meaning
from fretish.printer import sentence


def emit(rules: Sequence[Rule]) -> tuple[Artifact, ...]:
    """`<id>.ltl` for each rule."""
    return tuple(Artifact(PurePosixPath(f"{stem(rule)}.ltl"), text(rule)) for rule in rules)


def text(rule: Rule) -> str:
    """What a person reads: the sentence, its meaning, and the three formulas."""
    return render(
        "ltl/requirement.ltl.j2",
        id=rule.id,
        title=rule.requirement.title,
        sentence=" ".join(rule.requirement.wording.text.split()),
        canonical=sentence(rule.sentence),
        meaning=meaning(rule.sentence, rule.ticks, rule.clock),
        ft_infinite=printing.readable(rule.ft_infinite),
        ft_finite=printing.readable(rule.ft_finite),
        pt=printing.readable(rule.pt),
    )


TARGET = Target("ltl", "future-time and past-time formulas, for reading", emit)
