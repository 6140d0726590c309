"""The percepts of an agent as Java code: samples and truth values, as the bindings declare them.

`templates/agent-runtime/Reading.java.j2` has the functions that the code calls, and
`Signal.java.j2` reads samples as `monitors/samples.py` does.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import inf, isnan

from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals import numbers as n
from compiler.signals.policies import PropositionFunctions, SamplePolicy, meaning, policy
from compiler.signals.printing import NumberSyntax, Printer, encode_constant, parts
from compiler.targets.ajpf.safety_function import Sif
from compiler.targets.target import not_expressible
from fretish.bindings.declarations import Declarations, Reduce, Signal, short_type
from fretish.bindings.expressions import ticks_back
from fretish.bindings.tables.actions import ROS_TYPE
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.expressions import COMPARE

_TARGET = "an agent at run time"
_LONGEST = 20_000
"""Characters of a percept's code; javac reads nested calls recursively."""


def refusal(requirement: FormalizedRequirement, form: Sif) -> Diagnostic | None:
    """F601 for percepts that are not bound, or whose truth the environment cannot compute."""
    reason = next(_reasons(requirement, form), None)
    return None if reason is None else not_expressible(_TARGET, requirement, *reason)


def _reasons(requirement: FormalizedRequirement, form: Sif) -> Iterator[tuple[str, str]]:
    declared = requirement.declarations
    for name in form.percepts:
        if declared is None or name not in declared.propositions:
            yield f"the percept `{name}`, which is not bound", f"add `[proposition.{name}]`"
            return
        if ticks_back(declared.propositions[name].expression):
            yield f"`pre` in the percept `{name}`", "an agent has no ticks: use the value itself"
            return
        if meaning(declared.propositions[name], declared.signals.values()).held:
            fix = "an agent sees the newest messages: publish it as a field, or leave out `for`"
            yield f"`for` in the percept `{name}`", fix
            return
    assert declared is not None, "an agent has percepts"
    for signal in signals(declared, form):
        yield from _of_signal(signal, declared)
    for percept in _meanings(declared, form):
        if any(isinstance(part, n.RoundedCall) for part in _numbers(percept.truth)):
            fix = "publish the value as a field, and bind the field"
            yield f"a function of a computed signal in the percept `{percept.name}`", fix
        elif any(isinstance(part, n.MinMax) for part in _numbers(percept.truth)):
            fix = "compare each number, and combine the comparisons"
            yield f"`min` or `max` of a number in the percept `{percept.name}`", fix
        elif len(_printer(signals(declared, form)).truth(percept.truth)) > _LONGEST:
            yield f"the length of the percept `{percept.name}`", "divide it into several signals"


def _of_signal(signal: Signal, declared: Declarations) -> Iterator[tuple[str, str]]:
    kind, topic = short_type(signal.type or ""), signal.path.topic
    if signal.memory is not None:
        yield f"`{signal.name}`, which has memory", "publish the value as a field, and bind it"
    if signal.reduce is Reduce.MEAN:
        yield f"`{signal.name}`, a mean", "reduce it by `min` or `max`"
    if signal.pose is not None or signal.goals is not None:
        yield f"`{signal.name}`, the {signal.origin}", "publish the value as a field"
    if ROS_TYPE.fullmatch(kind) is None:
        fix = f'add `type = "sensor_msgs/LaserScan"`, say, to `[signal.{signal.name}]`'
        yield f"`{signal.name}`, which has no ROS type", fix
    others = [
        *(s.type for s in declared.signals.values() if s.path.topic == topic),
        *(action.type for action in declared.actions.values() if action.topic == topic),
    ]
    if any(other is not None and short_type(other) != kind for other in others):
        fix = "give all signals and actions the type of their topic"
        yield f"the topic `{topic}` with two types", fix


def _numbers(tree: n.Truth | n.Number) -> Iterator[n.Number | n.Truth]:
    yield tree
    match tree:
        case n.Not(arg) | n.UnaryCall(_, arg) | n.ToBaseUnit(arg, _) | n.Power(arg, _):
            yield from _numbers(arg)
        case n.All(args) | n.Some(args):
            for each in args:
                yield from _numbers(each)
        case (
            n.Iff(left, right)
            | n.Comparison(_, left, right)
            | n.Computed(_, left, right)
            | n.MinMax(_, left, right)
        ):
            yield from _numbers(left)
            yield from _numbers(right)
        case _:
            return


def signals(declared: Declarations, form: Sif) -> tuple[Signal, ...]:
    """The signals that the percepts read, each once."""
    bound = (declared.propositions[name] for name in form.percepts)
    read = dict.fromkeys(name for proposition in bound for name in proposition.signals)
    return tuple(declared.signals[name] for name in read)


def _meanings(declared: Declarations, form: Sif) -> tuple[PropositionFunctions, ...]:
    return tuple(
        meaning(declared.propositions[name], declared.signals.values()) for name in form.percepts
    )


# Code -----------------------------------------------------------------------------------------


def literal(text: str) -> str:
    """A string of Java in ASCII.

    Java replaces Unicode escapes before it reads strings: a backslash is always written twice, and
    control characters have octal escapes.
    """
    return f'"{"".join(map(_character, text))}"'


def _character(sign: str) -> str:
    if sign in '"\\':
        return f"\\{sign}"
    if " " <= sign <= "~":
        return sign
    if ord(sign) < 0x100:
        return f"\\{ord(sign):03o}"
    units = sign.encode("utf-16-be", "surrogatepass")
    return "".join(f"\\u{units[i]:02x}{units[i + 1]:02x}" for i in range(0, len(units), 2))


def _double(value: float) -> str:
    if value in (inf, -inf):
        return f"Double.{'POSITIVE' if value > 0 else 'NEGATIVE'}_INFINITY"
    return "Double.NaN" if isnan(value) else repr(float(value))


def _constant(value: Fraction) -> str:
    return f"constant({_double(encode_constant(value).double)})"


def _compared(number: str, sign: str, value: Fraction) -> str:
    encoded = encode_constant(value, sign)
    return f'compared({number}, "{sign}", {_double(encoded.single)}, {_double(encoded.double)})'


_JAVA = NumberSyntax(
    prefix="",
    truths={True: "(Boolean) true", False: "(Boolean) false", None: "(Boolean) null"},
    signs={sign: literal(sign) for sign in COMPARE},
    held="",
    scale=lambda value: ", ".join(map(_double, parts(value))),
    fixed=_constant,
    chosen=lambda function, number, value: f"{function}({number}, {_constant(value)})",
    compared=_compared,
)


def _printer(read: Sequence[Signal]) -> Printer:
    return Printer(_JAVA, {signal.name: f"s[{i}]" for i, signal in enumerate(read)})


def signal_code(declared: Declarations, form: Sif) -> list[Mapping[str, str]]:
    """The arguments of each `Signal`, as Java code."""
    return [_signal(policy(signal)) for signal in signals(declared, form)]


def _signal(sample: SamplePolicy) -> Mapping[str, str]:
    signal, invalid = sample.signal, sample.signal.invalid
    index = signal.path.index
    row = {name: f"row.get({literal(name)})" for name in (*sample.fields, "x")}
    words = map(_double, signal.numbers) if signal.numbers else map(literal, signal.values)
    kinds = (invalid.nan, invalid.positive_infinity, invalid.negative_infinity, invalid.other)
    outline = signal.reduce is Reduce.OUTLINE
    return {
        "topic": literal(signal.path.topic),
        "type": literal(short_type(signal.type or "")),
        "path": _array(map(literal, signal.path.fields)),
        "index": str(-1 if index is None else index),
        "reduce": literal(str(signal.reduce or "") if signal.path.each else ""),
        "invalid": _array(literal(str(kind)) for kind in kinds),
        "max_age": str(-1 if signal.max_age is None else signal.max_age),
        "beside": _array(map(literal, sample.fields)),
        "valid": "true" if sample.valid is None else Printer(_JAVA, row).truth(sample.valid),
        "words": ", ".join(words),
        "scale": _array(map(_double, parts(signal.unit.factor))),
        "sensor": _array(map(_double, signal.sensor)),
        "footprint": _array(_array(map(_double, corner)) for corner in signal.footprint)
        if outline
        else "{}",
    }


def _array(items: Iterator[str] | map[str]) -> str:
    return f"{{{', '.join(items)}}}"


def percept_code(declared: Declarations, form: Sif) -> list[Mapping[str, str]]:
    """The arguments of each `Percept`, as Java code."""
    printer = _printer(signals(declared, form))
    events = {str(plan.event) for plan in form.plans}
    return [
        {
            "name": literal(form.names[each.name]),
            "on_unknown": "null" if each.on_unknown is None else str(each.on_unknown).lower(),
            "shown": str(f"+{form.names[each.name]}" in events).lower(),
            "truth": printer.truth(each.truth),
        }
        for each in _meanings(declared, form)
    ]
