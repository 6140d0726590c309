"""The Python code that turns messages into propositions in a live node, from the bindings.

The text of `monitors/status_publisher.py` and of its dependencies is copied in. Below stands one
table, `SETTING`: a policy for each signal and a meaning for each proposition, whose expressions
call the functions of `monitors.kernel.readings`, as `compiler.signals` defines them.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import assert_never

from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.binding_agreement import binding_fix
from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals import numbers as n
from compiler.signals.policies import PropositionFunctions, SamplePolicy, instant
from fretish.bindings.declarations import Declarations, Reduce, Signal
from fretish.classes.frozen import dataclass
from fretish.clock import TimeSource
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from monitors.source_text import perception as runtime


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 for what a live node cannot compute, or not with an audit's result."""
    reason = next(_reasons(requirement), None)
    if reason is None:
        return None
    what, fix = reason
    return diagnostic(
        "not_judged_live",
        requirement.entry.wording,
        requirement=requirement.id,
        what=what,
        help=fix,
    )


def _reasons(requirement: FormalizedRequirement) -> Iterator[tuple[str, str]]:
    declared = requirement.declarations
    if declared is None:
        yield "there are no bindings", "define its propositions in bindings.toml"
        return
    unbound = [name for name in requirement.watched if name not in declared.propositions]
    if unbound:
        name = unbound[0]
        yield f"the bindings do not define `{name}`", binding_fix(requirement, name, declared)
    yield from _of_clock(declared)
    if unbound:
        return
    at_instant = instant([requirement])
    if at_instant is None or at_instant.left_out:
        yield (
            "it looks back by ticks within a proposition",
            "state it in the sentence, or with `for 200 ms`",
        )
        return
    for policy in at_instant.policies:
        if policy.signal.reduce is Reduce.MEAN:
            yield (
                f"`{policy.signal.name}` is a mean, whose last digits differ from those of an "
                "audit",
                "reduce it by `min` or `max`, or publish the mean as a field",
            )


def _of_clock(declared: Declarations) -> Iterator[tuple[str, str]]:
    clock = declared.clock
    if clock.period is None:
        yield (
            f"its clock is {clock}" if clock.declared else "no clock says what a tick is",
            'declare `[clock]` with `tick = "100 ms"`',
        )
    if clock.time is TimeSource.PUBLISH_TIME:
        yield (
            "its clock is the time of publication, which subscribers do not receive",
            'write `time = "log_time"` or `time = "header.stamp"`',
        )
    if clock.effective_lateness is None:
        yield (
            "`[clock]` does not state how long a tick waits for its messages",
            'add `lateness = "50 ms"` to `[clock]`',
        )


def text(requirements: Sequence[FormalizedRequirement]) -> str:
    """The text of the file: `SETTING`, below the code that it needs.

    Args:
        requirements: requirements of one project that were not refused.
    """
    table = setting(requirements)
    joined = runtime(
        rounds=any("rounded(" in meaning for meaning in table.meanings),
        remembers=any("MemorySeries(" in policy for policy in table.policies),
        frames=bool(table.frames),
        goals=any("goal_status(" in policy for policy in table.policies),
    )
    return render(
        "ros/perception.py.j2",
        version=__version__,
        imports=joined.imports,
        core=joined.text,
        setting=table,
    )


def setting(requirements: Sequence[FormalizedRequirement]) -> SettingTable:
    """The table of requirements that were not refused."""
    at_instant = instant(requirements)
    declared = requirements[0].declarations
    assert at_instant is not None, "it is refused"
    assert declared is not None, "it is refused"
    assert declared.clock.period is not None, "it is refused"
    return SettingTable(
        tuple(map(_policy, at_instant.policies)),
        tuple(map(_meaning, at_instant.meanings)),
        declared.clock.period,
        declared.clock.phase,
        declared.clock.effective_lateness or 0,
        declared.clock.time is TimeSource.HEADER_STAMP,
        tuple(f"({requirement.id!r}, {topics_of(requirement)!r})" for requirement in requirements),
        tuple(_query(each.signal) for each in at_instant.policies if each.signal.pose is not None),
    )


@dataclass(frozen=True, slots=True)
class SettingTable:
    """The entries of the table, as code."""

    policies: tuple[str, ...]
    meanings: tuple[str, ...]
    period: int
    phase: int
    lateness: int
    stamped: bool
    reads: tuple[str, ...]
    frames: tuple[str, ...] = ()
    """The queries of signals of frames."""


def topics_of(requirement: FormalizedRequirement) -> tuple[str, ...]:
    """The topics that the requirement's propositions read."""
    at_instant = instant([requirement])
    assert at_instant is not None, "it is refused"
    return tuple(dict.fromkeys(policy.signal.path.topic for policy in at_instant.policies))


def _query(signal: Signal) -> str:
    pose = signal.pose
    assert pose is not None
    parts = (signal.name, signal.path.topic, pose.frame, pose.reference, str(pose.number))
    return f"FrameQuery({', '.join(map(repr, parts))})"


def _policy(policy: SamplePolicy) -> str:
    signal = policy.signal
    invalid = signal.invalid
    kinds = (invalid.nan, invalid.positive_infinity, invalid.negative_infinity, invalid.other)
    parts: dict[str, object] = {
        "place": signal.path.index,
        "each": signal.path.each,
        "reduce": "" if signal.reduce is None else str(signal.reduce),
        "invalid": tuple(map(str, kinds)),
        "beside": policy.fields,
        "max_age": signal.max_age,
        "words": signal.values,
        "numbers": signal.numbers,
        "is_pose": signal.pose is not None,
    }
    if signal.reduce is Reduce.OUTLINE:
        parts |= {"scale": str(signal.unit.factor), "sensor": signal.sensor}
        parts["footprint"] = signal.footprint
    texts = {name: repr(part) for name, part in parts.items() if part not in (None, False, (), "")}
    if policy.valid is not None:
        texts["valid"] = f"lambda row: {_truth(policy.valid)}"
    if signal.memory is not None:
        memory = (signal.memory.function, signal.memory.over, signal.memory.max_age)
        texts["series"] = f"lambda: MemorySeries(Memory{memory!r})"
    if signal.goals is not None:
        goals = f"{str(signal.goals.choice)!r}, {signal.goals.statuses!r}"
        texts["read"] = f"lambda message: goal_status(message, {goals})"
    measured = _measured(policy)
    if measured is not None:
        names = "".join(f", {name}" for name in _besides(policy).values())
        # The literals are infinities, and cost less than names: this runs for each beam.
        element = f"x if -1e999 < x < 1e999 and {measured} else meant(x)"
        texts["quick"] = f"lambda xs, meant{names}: [{element} for x in xs]"
    head = [repr(signal.name), repr(signal.path.topic), repr(signal.path.fields)]
    return f"Policy({', '.join([*head, *_named(texts)])})"


def _besides(policy: SamplePolicy) -> dict[str, str]:
    """The fields that `valid` reads, with their parameters."""
    return {name: f"beside{i}" for i, name in enumerate(policy.fields)}


def _measured(policy: SamplePolicy) -> str | None:
    """`valid` in plain Python if nothing in it can be unknown or needs rounding; else None."""
    if not policy.signal.path.each:
        return None
    if policy.valid is None:
        return "True"
    names = {**_besides(policy), "x": "x"}
    signs = {"=": "=="}

    def text(tree: n.Truth) -> str | None:
        match tree:
            case n.Comparison(sign, n.SignalValue(left), n.SignalValue(right)):
                return f"({names[left]} {signs.get(sign, sign)} {names[right]})"
            case n.Not(arg):
                inner = text(arg)
                return inner and f"(not {inner})"
            case n.All(args) | n.Some(args) if args:
                parts = [text(arg) for arg in args]
                word = " and " if isinstance(tree, n.All) else " or "
                conjuncts = [part for part in parts if part is not None]
                return f"({word.join(conjuncts)})" if len(conjuncts) == len(parts) else None
            case _:
                return None

    return text(policy.valid)


def _meaning(meaning: PropositionFunctions) -> str:
    asked = [_truth(part) for part, _ in meaning.held]
    held = "".join(
        f"(lambda row, held: {text}, {duration}), "
        for text, (_, duration) in zip(asked, meaning.held, strict=True)
    )
    parts: dict[str, object] = {
        "outer": tuple(places(meaning.truth)),
        "lookback": lookback(meaning.truth, meaning),
        "on_unknown": meaning.on_unknown,
    }
    texts = {name: repr(part) for name, part in parts.items() if part not in (None, (), 0)}
    if meaning.on_unknown is False:
        texts["on_unknown"] = "False"
    if held:
        texts["held"] = f"({held.strip()})"
    texts["aggregate"] = repr(str(meaning.aggregate))
    signals = tuple(dict.fromkeys(signals_of(meaning)))
    head = [repr(meaning.name), repr(signals), f"lambda row, held: {_truth(meaning.truth)}"]
    return f"PropositionSpec({', '.join([*head, *_named(texts)])})"


def _named(texts: dict[str, str]) -> Iterator[str]:
    return (f"{name}={text}" for name, text in texts.items())


def lookback(tree: n.Truth, meaning: PropositionFunctions) -> int:
    """The sum of nested durations."""
    return max(
        (
            meaning.held[place][1] + lookback(meaning.held[place][0], meaning)
            for place in places(tree)
        ),
        default=0,
    )


def signals_of(meaning: PropositionFunctions) -> Iterator[str]:
    """The signals that the meaning reads, possibly repeated."""
    for tree in (meaning.truth, *(part for part, _ in meaning.held)):
        for part in _parts(tree):
            if isinstance(part, n.BooleanSignal | n.SignalValue):
                yield part.name


def places(tree: n.Truth) -> list[int]:
    """The indices of the conditions that have to hold for a duration."""
    return [part.place for part in _parts(tree) if isinstance(part, n.HeldFor)]


def _parts(tree: n.Truth | n.Number) -> Iterator[n.Truth | n.Number]:
    yield tree
    for part in _children(tree):
        yield from _parts(part)


def _children(tree: n.Truth | n.Number) -> Iterable[n.Truth | n.Number]:
    match tree:
        case n.Known() | n.BooleanSignal() | n.HeldFor() | n.SignalValue() | n.Constant():
            return ()
        case n.Not(arg) | n.UnaryCall(_, arg) | n.ToBaseUnit(arg, _) | n.Power(arg, _):
            return (arg,)
        case n.All(args) | n.Some(args) | n.RoundedCall(_, args):
            return args
        case (
            n.Iff(left, right)
            | n.Comparison(_, left, right)
            | n.Computed(_, left, right)
            | n.MinMax(_, left, right)
        ):
            return (left, right)
        case _:
            assert_never(tree)


def _truth(tree: n.Truth) -> str:
    match tree:
        case n.Known(value):
            return repr(value)
        case n.BooleanSignal(name):
            return f"flag(row[{name!r}])"
        case n.Comparison(sign, left, right):
            return f"compared({_number(left)}, {sign!r}, {_number(right)})"
        case n.HeldFor(place):
            return f"held[{place}]"
        case n.Not(arg):
            return f"negation({_truth(arg)})"
        case n.All(args):
            return f"every({', '.join(map(_truth, args))})"
        case n.Some(args):
            return f"some({', '.join(map(_truth, args))})"
        case n.Iff(left, right):
            return f"same({_truth(left)}, {_truth(right)})"
        case _:
            assert_never(tree)


def _number(tree: n.Number) -> str:
    match tree:
        case n.SignalValue(name):
            return f"row[{name!r}]"
        case n.Constant(value):
            return f"exact({str(value)!r})"
        case n.UnaryCall(function, arg):
            return f"{function}({_number(arg)})"
        case n.Computed(function, left, right) | n.MinMax(function, left, right):
            return f"{function}({_number(left)}, {_number(right)})"
        case n.Power(base, times):
            return f"power({_number(base)}, {times})"
        case n.ToBaseUnit(arg, scale):
            return f"in_base({_number(arg)}, exact({str(scale)!r}))"
        case n.RoundedCall(function, args):
            return f"rounded({', '.join([repr(function), *map(_number, args)])})"
        case _:
            assert_never(tree)
