"""`--emit ajpf`: a property file for the AJPF model checker of MCAPL.

AJPF's language is LTL without next, without past, without time. Its parser repairs wrong text in
silence, so that a wrong property looks verified: what is emitted is fully parenthesized, ASCII,
one line a property, with names that AJPF reads as they are; the rest is refused.
Source: Dennis et al., Model checking agent programming languages, ASE 19 (2012); the property
parser of MCAPL.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import PurePosixPath

from compiler import formula as f
from compiler.artifact import Artifact
from compiler.rule import Rule
from compiler.targets.target import DEFAULT, Options, Target, not_expressible, stem
from compiler.templating import render
from fretish import syntax as s
from fretish.depth import deep
from fretish.diagnostic import Diagnostic
from fretish.printer import timing as printing_of

_FUNCTOR = re.compile(r"[a-z][A-Za-z0-9_]*")
_AGENT = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_KEY_WORDS = frozenset("A E U R B G F I D P T ItD".split())
_BEYOND = "AJPF has no next, no past and no time; state the requirement with `eventually`, or "
_MONITOR = "check it with `--emit monitor`"
_COUNTING = (s.Immediately, s.Next, s.Within, s.For, s.After)
"""A reasoning cycle of an agent is many states: a number of them means nothing, not even 0."""


@deep
def refuse(rule: Rule) -> Diagnostic | None:
    """F601 for the first part of the rule that AJPF's language cannot say."""
    agent = rule.sentence.component
    if rule.pctl is not None:
        return not_expressible(
            "AJPF",
            rule,
            "the probability",
            "leave it out, or use a probabilistic tool",
        )
    if isinstance(rule.sentence.timing, _COUNTING):
        timing = printing_of(rule.sentence.timing)
        return not_expressible("AJPF", rule, f"the timing `{timing}`", f"{_BEYOND}{_MONITOR}")
    if not _AGENT.fullmatch(agent) or agent in _KEY_WORDS:
        return not_expressible(
            "AJPF", rule, f"the agent name `{agent}`", "use letters, digits and `_` only"
        )
    for name in rule.propositions:
        if not _FUNCTOR.fullmatch(name):
            return not_expressible(
                "AJPF",
                rule,
                f"the proposition `{name}`",
                "give the comparison a name that begins with a small letter, and bind it",
            )
    if isinstance(rule.ft_infinite, f.Const):
        return not_expressible("AJPF", rule, "a formula that is constant", "it says nothing")
    part = _beyond(rule.ft_infinite)
    if part is not None:
        return not_expressible("AJPF", rule, part, f"{_BEYOND}{_MONITOR}")
    return None


def _beyond(formula: f.Formula) -> str | None:
    """The first operator that AJPF does not have, in words."""
    match formula:
        case f.Next():
            return "the next tick (`X`), which triggers on an edge and `next` need,"
        case f.Eventually(_, ahead) | f.Globally(_, ahead) if ahead != f.EVER:
            return "a bound in ticks"
        case _:
            return next((part for child in f.children(formula) if (part := _beyond(child))), None)


@deep
def emit(rules: Sequence[Rule], options: Options = DEFAULT) -> tuple[Artifact, ...]:
    """`<id>.psl` for each rule: one property, with the requirement's id as its key."""
    return tuple(
        Artifact(
            PurePosixPath(f"{stem(rule)}.psl"),
            render(
                "ajpf/properties.psl.j2",
                id=rule.id,
                sentence=" ".join(rule.requirement.wording.text.split()),
                property=property_(rule.ft_infinite, rule.sentence.component),
            ),
        )
        for rule in rules
    )


def property_(formula: f.Formula, agent: str) -> str:
    """The formula in AJPF's language; each proposition is a belief of the agent.

    Raises:
        AssertionError: the formula was to be refused.
    """

    def text(part: f.Formula) -> str:
        return property_(part, agent)

    match formula:
        case f.Atom(name):
            return f"B({agent},{name})"
        case f.Not(f.Atom() as arg):
            return f"~{text(arg)}"
        case f.Not(arg):
            return f"~({text(arg)})"
        case f.And(args):
            return _joined(" & ", [text(arg) for arg in args])
        case f.Or(args):
            return _joined(" || ", [text(arg) for arg in args])
        case f.Implies(left, right):
            return f"({text(left)}) -> ({text(right)})"
        case f.Iff(left, right):
            return f"(({text(left)}) -> ({text(right)})) & (({text(right)}) -> ({text(left)}))"
        case f.Xor(left, right):
            return f"~({text(f.Iff(left, right))})"
        case f.Globally(arg, f.EVER):
            return f"[] ({text(arg)})"
        case f.Eventually(arg, f.EVER):
            return f"<> ({text(arg)})"
        case f.Until(left, right):
            return f"({text(left)}) U ({text(right)})"
        case f.Release(left, right):
            return f"({text(left)}) R ({text(right)})"
        case _:
            raise AssertionError(f"not of AJPF's language: {formula}")


def _joined(operator: str, texts: list[str]) -> str:
    """`((a) & (b)) & (c)`: AJPF's own grouping of a chain is never asked for."""
    result = f"({texts[0]})"
    for i, text in enumerate(texts[1:], 1):
        result = f"{result}{operator}({text})"
        result = f"({result})" if i < len(texts) - 1 else result
    return result


TARGET = Target("ajpf", "a property file for the AJPF model checker", emit, refuse)
