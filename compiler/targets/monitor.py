"""`--emit monitor`: a standalone Python file, straight-line code over the watch of a rule.

Every temporal sub-formula has one variable on each rail (`must`, `may`), stepped at every tick;
the text of `monitors/kernel.py` is copied in, so the file needs the standard library and nothing
else.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from importlib.resources import files
from keyword import iskeyword
from pathlib import PurePosixPath

from compiler import __version__, printing
from compiler.artifact import Artifact
from compiler.program import locals_of, program
from compiler.rule import Rule
from compiler.targets.target import DEFAULT, Options, Target, not_expressible, stem
from compiler.templating import render
from fretish import syntax as s
from fretish.checking import LOOK_AHEAD, calls, conditions
from fretish.clock import assumed_ticks
from fretish.depth import depth
from fretish.diagnostic import Code, Diagnostic, Severity

_KERNEL_BEGINS = "# kernel begins here\n"
_IMPORTS_END = re.compile(r"\n\n(?=[A-Z])")


def refuse(rule: Rule) -> Diagnostic | None:
    """F312: a monitor steps by ticks, so it must be known how long a tick is.

    F601: Python reads no more than 200 parentheses within each other; and one run cannot show
    a probability.
    """
    if max(map(depth, conditions(rule.sentence))) > _MOST_LEVELS:
        return not_expressible(
            "Python",
            rule,
            f"more than {_MOST_LEVELS} operators within each other",
            "give parts of the expression names of their own",
        )
    ahead = next((n for e in conditions(rule.sentence) for n in calls(e) if n in LOOK_AHEAD), None)
    if ahead is not None:
        return not_expressible(
            "a monitor", rule, f"`{ahead}`", "it looks ahead: state it by a timing, or look back"
        )
    if rule.pctl is not None:
        return not_expressible(
            "a monitor",
            rule,
            "the probability",
            "one run does not tell a probability: estimate it over many, or leave it out",
        )
    if assumed_ticks(rule.sentence, rule.clock) is None:
        return None
    return Diagnostic(
        Code.NO_CLOCK,
        f"no clock says how many ticks the duration of {rule.id} is",
        rule.sentence.timing_span,
        help='declare `[clock]` with `tick = "100 ms"` in bindings.toml, or write ticks',
    )


def remark(rule: Rule) -> Diagnostic | None:
    """F203: whatever has happened, what follows can still make the verdict either way.

    So it is with 12 of FRET's 288 templates: a demand for ever later at each trigger, on a stretch
    that ends with the run. Source: Pnueli, Zaks, PSL model checking and run-time verification via
    testers, FM 2006 (monitorability).
    """
    sentence = rule.sentence
    scope = sentence.scope.kind if sentence.scope else None
    if sentence.condition is None:
        return None
    later = scope in (None, s.ScopeKind.AFTER) and isinstance(sentence.timing, s.Eventually)
    negated = scope is s.ScopeKind.ONLY_BEFORE and isinstance(sentence.timing, s.Always | s.Never)
    if not later and not negated:
        return None
    return Diagnostic(
        Code.NEVER_DECIDED,
        f"no run, however long, can violate {rule.id} or confirm it: it sets no bound",
        sentence.timing_span or rule.requirement.wording,
        help="state a bound: `within 200 milliseconds` in place of `eventually`",
        severity=Severity.WARNING,
    )


def emit(rules: Sequence[Rule], options: Options = DEFAULT) -> tuple[Artifact, ...]:
    """`<id>_monitor.py` for each rule; it needs Python 3.11 and nothing else."""
    return tuple(
        Artifact(PurePosixPath(f"{_module(stem(rule))}_monitor.py"), text(rule)) for rule in rules
    )


def text(rule: Rule) -> str:
    """The monitor's Python source."""
    parameters = _parameters(rule.watched)
    imports, kernel = _kernel()
    return render(
        "monitor/monitor.py.j2",
        id=rule.id,
        version=__version__,
        sentence=" ".join(rule.requirement.wording.text.split()),
        fingerprint=rule.fingerprint,
        tick=str(rule.clock) if rule.clock else "not declared",
        ft=printing.readable(rule.ft_infinite),
        finite=printing.readable(rule.ft_finite),
        pt=printing.readable(rule.pt),
        class_name=_class_name(rule.id),
        horizon=rule.watch.horizon,
        parameters=parameters,
        program=program(rule.watch, parameters),
        imports=imports,
        kernel=kernel,
    )


def _kernel() -> tuple[str, str]:
    """The imports and the rest of the kernel's text."""
    source = files("monitors").joinpath("kernel.py").read_text(encoding="utf-8")
    _, found, body = source.partition(_KERNEL_BEGINS)
    assert found, "the kernel lost its mark"
    imports, rest = _IMPORTS_END.split(body, maxsplit=1)
    return imports.strip(), rest.strip()


def _class_name(id: str) -> str:
    name = re.sub(r"\W", "_", id, flags=re.ASCII)
    name = name if name[0].isalpha() else f"R{name}"
    return f"{name[0].upper()}{name[1:]}Monitor"


def _module(name: str) -> str:
    return re.sub(r"[^a-z0-9_]", "_", name)


_MOST_LEVELS = 60
_SPOKEN = {"<=": "_le_", ">=": "_ge_", "!=": "_ne_", "<": "_lt_", ">": "_gt_", "=": "_eq_"}
_TAKEN = frozenset({"self", "Window", "History", "Verdict", "Truth", "rails", "first"})


def _parameters(names: Iterable[str]) -> dict[str, str]:
    """A parameter of `step` for each proposition: its name as an identifier, all different."""
    parameters: dict[str, str] = {}
    for name in names:
        parameter = printing.identifier(name) if not printing.is_compound(name) else _spoken(name)
        if not parameter[0].isalpha():
            parameter = f"p_{parameter}"
        while _clashes(parameter, parameters.values()):
            parameter += "_"
        parameters[name] = parameter
    return parameters


def _clashes(parameter: str, others: Iterable[str]) -> bool:
    """Whether the name, or one of its rails, is another name of the generated step."""
    return (
        iskeyword(parameter)
        or not locals_of([parameter]).isdisjoint(_TAKEN)
        or not locals_of([parameter]).isdisjoint(locals_of(others))
    )


def _spoken(text: str) -> str:
    """`(kias <= 90.0)` as `kias_le_90_0`."""
    for operator, word in _SPOKEN.items():
        text = text.replace(operator, word)
    name = re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_")
    return re.sub(r"_+", "_", name) or "p"


TARGET = Target("monitor", "a standalone runtime monitor in Python", emit, refuse, remark)
