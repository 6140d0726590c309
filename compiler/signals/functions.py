"""The functions beside a monitor, from samples to its inputs, for any language.

Names, their order, which values the caller computes, and the comments are decided here. A target
puts them into its template, and a `NumberSyntax` writes the expressions.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence

from compiler.files.build_id import __version__
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.identifiers import legal_names
from compiler.signals.policies import InstantFunctions, PropositionFunctions, SamplePolicy, instant
from compiler.signals.printing import NumberSyntax, Printer
from fretish.bindings.declarations import Aggregate, ComputedSignal, MeasuredSignal, Reading, Reduce
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class SignalFunction:
    """A function from one message to the number of a signal's sample."""

    name: str
    place: str
    """The field of the message, with its unit."""
    text: str
    """The description of the result."""
    form: str
    """The kind of input: a `number` of a field, an `array` of elements, a `word`, or `given` by the
    caller."""
    reduce: Reduce | None
    max_age: int | None
    """Nanoseconds after which the sample is too old."""
    valid: str | None
    """The validity of `x` as an expression over numbers `n_<field>`; None: always valid."""
    fields: tuple[str, ...]
    invalid: tuple[Reading, Reading, Reading, Reading]
    """The meaning of NaN, +inf, -inf and of an invalid number."""
    words: tuple[str, ...]
    numbers: tuple[int, ...]
    """The numbers by which messages encode the enumeration values; empty: by their text."""


@dataclass(frozen=True, slots=True)
class HeldCondition:
    """A condition that has to hold for a duration; an input at an instant."""

    name: str
    text: str
    truth: str


@dataclass(frozen=True, slots=True)
class PropositionFunction:
    """A function for the truth of a proposition at an instant, over numbers `s_<signal>`."""

    proposition: str
    name: str
    """The name of the monitor's input."""
    truth: str
    aggregate: Aggregate
    on_unknown: bool | None


@dataclass(frozen=True, slots=True)
class Functions:
    """All functions for one monitor."""

    notes: tuple[str, ...]
    """Comments at the top of the file: its purpose, and what it leaves out."""
    signals: tuple[SignalFunction, ...]
    held: tuple[HeldCondition, ...]
    propositions: tuple[PropositionFunction, ...]


def file_name(monitor: str) -> str:
    """The name of the file beside `r1_monitor`."""
    return f"{monitor.removesuffix('_monitor')}_signals"


def functions(
    requirements: Sequence[FormalizedRequirement],
    names: Mapping[str, str],
    language: NumberSyntax,
    reserved: Container[str] = (),
) -> Functions | None:
    """The functions for a monitor; None if there are no bindings.

    Args:
        requirements: the requirements of the monitor.
        names: the monitor's input of each proposition.
        language: the syntax of the target language.
        reserved: reserved names.
    """
    at_instant = instant(requirements, gives_rounded=True)
    if at_instant is None:
        return None
    inputs: tuple[MeasuredSignal, ...] = (
        *(policy.signal for policy in at_instant.policies),
        *at_instant.given,
    )
    signals = legal_names((signal.name for signal in inputs), reserved)
    given = {name: f"s_{legal}" for name, legal in signals.items()}
    durations = _durations(at_instant, names, reserved)
    printers = {
        name: Printer(language, given, tuple(map(language.held.format, mine)))
        for name, mine in durations.items()
    }
    return Functions(
        _notes(requirements, at_instant),
        (
            *(
                _signal(policy, signals[policy.signal.name], language)
                for policy in at_instant.policies
            ),
            *(_computed(signal, signals[signal.name]) for signal in at_instant.given),
        ),
        tuple(
            HeldCondition(
                name,
                f"{meaning.name}: its part number {part}, for {duration} ns",
                printers[meaning.name].truth(truth),
            )
            for meaning in at_instant.meanings
            for part, (name, (truth, duration)) in enumerate(
                zip(durations[meaning.name], meaning.held, strict=True), 1
            )
        ),
        tuple(
            _proposition(meaning, names[meaning.name], printers[meaning.name])
            for meaning in at_instant.meanings
        ),
    )


def _notes(
    requirements: Sequence[FormalizedRequirement], at_instant: InstantFunctions
) -> tuple[str, ...]:
    title = ", ".join(requirement.id for requirement in requirements)
    return (
        f"What samples say of the propositions of {title}, as `fretc audit` reads them.",
        "Samples in, truth values out: functions without memory.",
        *(
            f"given by the caller, as it looks back by ticks: {name}"
            for name in at_instant.left_out
        ),
        f"Generated by fretc {__version__}; the file is yours, under any terms.",
    )


def _durations(
    at_instant: InstantFunctions, names: Mapping[str, str], reserved: Container[str]
) -> Mapping[str, tuple[str, ...]]:
    """The inputs of each proposition for conditions that have held for a duration."""
    wanted = {
        meaning.name: [f"{names[meaning.name]}_for_{part + 1}" for part in range(len(meaning.held))]
        for meaning in at_instant.meanings
    }
    legal = legal_names((name for input_names in wanted.values() for name in input_names), reserved)
    return {
        meaning: tuple(legal[name] for name in input_names)
        for meaning, input_names in wanted.items()
    }


def _signal(policy: SamplePolicy, name: str, language: NumberSyntax) -> SignalFunction:
    signal, invalid = policy.signal, policy.signal.invalid
    form = "word" if signal.values else "array" if policy.is_array else "number"
    fields = legal_names(policy.fields, ())
    given = {field: f"n_{legal}" for field, legal in fields.items()} | {"x": "x"}
    unit = f", {signal.unit_name}" if signal.unit_name else ""
    return SignalFunction(
        name,
        signal.origin if signal.origin != str(signal.path) else f"{signal.path}{unit}",
        _text(policy),
        "given" if policy.is_given else form,
        signal.reduce,
        signal.max_age,
        None if policy.valid is None else Printer(language, given).truth(policy.valid),
        tuple(fields.values()),
        (invalid.nan, invalid.positive_infinity, invalid.negative_infinity, invalid.other),
        signal.values,
        signal.numbers,
    )


def _computed(signal: ComputedSignal, name: str) -> SignalFunction:
    unit = str(signal.unit)
    place = signal.text + (f", in {unit}" if unit else "")
    return SignalFunction(
        name,
        place,
        f"The number of {signal.name} is computed by the caller, unknown where one of its signals "
        f"is: {place}. Its last digits depend on the library of functions.",
        "given",
        None,
        None,
        None,
        (),
        (Reading.UNKNOWN,) * 4,
        (),
        (),
    )


def _text(policy: SamplePolicy) -> str:
    signal = policy.signal
    if signal.memory is not None:
        return f"The number of {signal.name} is computed by the caller: {signal.memory.text}."
    if signal.pose is not None:
        unit = "radians" if signal.pose.number.is_angle else "metres"
        return f"The number of {signal.name} is computed by the caller: {signal.pose}, in {unit}."
    if signal.goals is not None:
        places = f": 0 to {len(signal.values) - 1} for {', '.join(signal.values)}"
        what = f"{signal.goals}{places if signal.values else ': 1 or 0'}"
        return f"The number of {signal.name} is given by the caller: {what}."
    if policy.is_given:
        return f"The number of {signal.name} is computed by the caller: {signal.reduce}."
    if signal.values:
        by = "The number that stands for a word" if signal.numbers else "The word in a text"
        return f"{by}; any other is unknown."
    if policy.is_array:
        return f"The {signal.reduce} of a message's elements."
    return "The number of a message's field."


def _proposition(meaning: PropositionFunctions, name: str, printer: Printer) -> PropositionFunction:
    return PropositionFunction(
        meaning.name, name, printer.truth(meaning.truth), meaning.aggregate, meaning.on_unknown
    )
