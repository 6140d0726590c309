"""A class of Java beside a monitor: from typed samples to the inputs of the monitor.

The class of the monitor stays unchanged.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import chain
from math import isinf, isnan
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.spelling.reserved_words import JAVA
from compiler.signals.functions import Functions, functions
from compiler.signals.printing import NumberSyntax, encode_constant, parts
from compiler.targets.java.printer import methods

_SIGNS = {"<": "LT", "<=": "LE", ">": "GT", ">=": "GE", "=": "EQ", "!=": "NE"}


def files(
    monitor: str, requirements: Sequence[FormalizedRequirement], names: Mapping[str, str]
) -> tuple[Artifact, ...]:
    """The class beside the class `monitor`; empty without bindings.

    Args:
        monitor: the name of the class.
        requirements: the requirements of the monitor.
        names: the monitor's input of each proposition.
    """
    truth = f"{monitor}.Truth"
    found = functions(requirements, names, _language(truth), JAVA)
    if found is None:
        return ()
    name = f"{monitor.removesuffix('Monitor')}Signals"
    text = render(
        "java/signals.java.j2",
        functions=found,
        class_name=name,
        monitor=monitor,
        truth=truth,
        numbers=render("java/numbers.java.j2", truth=truth),
        string=_string,
        **{part: methods([line] for line in lines) for part, lines in _bodies(found).items()},
    )
    return (Artifact(PurePosixPath(f"{name}.java"), text),)


def statements(
    requirements: Sequence[FormalizedRequirement], names: Mapping[str, str]
) -> Iterator[str]:
    """The statements of the class that differ in length."""
    found = functions(requirements, names, _language("Truth"), JAVA)
    yield from chain.from_iterable(_bodies(found).values() if found else ())


def _bodies(found: Functions) -> dict[str, list[str]]:
    """The statements of the class that are divided into methods."""
    reading = [
        f"s_{signal.name} = inForce(samples.{signal.name}, now, {_age(signal.max_age)});"
        for signal in found.signals
    ]
    aggregates = {"any": "either(tick.{0}, next.{0})", "all": "both(tick.{0}, next.{0})"}
    gathering = (
        f"tick.{each.name} = {aggregates.get(each.aggregate, 'next.{0}').format(each.name)};"
        for each in found.propositions
    )
    assuming = (
        f"tick.{each.name} = assumed(tick.{each.name}, {str(each.on_unknown).lower()});"
        for each in found.propositions
        if each.on_unknown is not None
    )
    return {
        "reading": reading,
        "judging": [f"inputs.{each.name} = {each.truth};" for each in found.propositions],
        "holding": [f"holding.{each.name} = {each.truth};" for each in found.held],
        "gathering": [*gathering],
        "assuming": [*assuming],
    }


def _age(nanoseconds: int | None) -> str:
    """The maximum age; -1: its age does not count."""
    return f"{-1 if nanoseconds is None else nanoseconds}L"


def _string(text: str) -> str:
    """The text as a string of Java, in ASCII: its letters and digits, and the codes of others."""
    units = text.encode("utf-16-be")
    codes = (int.from_bytes(units[i : i + 2], "big") for i in range(0, len(units), 2))
    return f'"{"".join(map(_character, codes))}"'


def _character(code: int) -> str:
    is_plain = code < 128 and chr(code).isalnum()
    return chr(code) if is_plain else f"\\{code:03o}" if code < 128 else f"\\u{code:04x}"


def _double(value: float) -> str:
    if isnan(value):
        return "Double.NaN"
    if isinf(value):
        return f"Double.{'POSITIVE' if value > 0 else 'NEGATIVE'}_INFINITY"
    return repr(float(value))


def _fixed(value: Fraction) -> str:
    return f"Number.of({_double(encode_constant(value).double)})"


def _chosen(function: str, number: str, value: Fraction) -> str:
    encodings = encode_constant(value)
    single = f"{_double(encodings.single)}, {str(encodings.is_single).lower()}"
    return f"{function}With({number}, {single}, {_double(encodings.double)})"


def _compared(number: str, sign: str, value: Fraction) -> str:
    encodings = encode_constant(value, sign)
    beside = ", ".join(map(_double, (encodings.single, encodings.double, encodings.exact)))
    return f"comparedWith({number}, Sign.{_SIGNS[sign]}, {beside}, {encodings.magnitude:#x}L)"


def _language(truth: str) -> NumberSyntax:
    """The syntax of Java, with the type of truth values."""
    return NumberSyntax(
        prefix="",
        truths={True: f"{truth}.TRUE", False: f"{truth}.FALSE", None: f"{truth}.UNKNOWN"},
        signs={sign: f"Sign.{name}" for sign, name in _SIGNS.items()},
        held="held.{}",
        scale=lambda value: ", ".join(map(_double, parts(value))),
        fixed=_fixed,
        chosen=_chosen,
        compared=_compared,
    )
