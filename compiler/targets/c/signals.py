"""Beside a monitor in C: from typed samples to the truth of its propositions, as an audit has it.

Functions without memory; the header has the numbers that they compute with, in exact C99.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from fractions import Fraction
from math import isinf, isnan
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.edition import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import Formalized
from compiler.logic.identifiers import legal_names
from compiler.signals.policies import Instant, Meaning, Policy, instant
from compiler.signals.printing import Fixing, Printer, parts, suited
from fretish.bindings.declarations import Reading

_SIGNS = {"<": "LT", "<=": "LE", ">": "GT", ">=": "GE", "=": "EQ", "!=": "NE"}
_TRUTHS = {True: "FRETC_TRUE", False: "FRETC_FALSE", None: "FRETC_UNKNOWN"}
_MEANINGS = {
    Reading.DROP: "FRETC_DROP",
    Reading.FAR: "FRETC_FAR",
    Reading.NEAR: "FRETC_NEAR",
    Reading.UNKNOWN: "FRETC_UNKNOWABLE",
}


def files(
    name: str,
    base: str,
    rules: Sequence[Formalized],
    names: Mapping[str, str],
    reserved: Collection[str],
) -> tuple[Artifact, ...]:
    """The header and the source beside the monitor `name`; none where no bindings are at hand.

    Args:
        name: of the monitor's files, without their ending.
        base: what the monitor's functions begin with.
        rules: those of the monitor.
        names: the monitor's input of each proposition.
        reserved: what no name may be.
    """
    found = instant(rules)
    if found is None:
        return ()
    file = f"{name.removesuffix('_monitor')}_signals"
    values = _values(found, names, reserved)
    common = {"base": base, "header": f"{file}.h", "title": ", ".join(rule.id for rule in rules)}
    source = render("c/signals.c.j2", **values, **common)
    header = render(
        "c/signals.h.j2",
        **values,
        **common,
        guard=guard(file),
        monitor=f"{name}.h",
        version=__version__,
        kernel=render("c/numbers.h.j2"),
        left_out=found.left_out,
    )
    return tuple(
        Artifact(PurePosixPath(f"{file}.{ending}"), text)
        for ending, text in (("c", source), ("h", header))
    )


def guard(file: str) -> str:
    """The macro that a header of this name defines; a file may begin with a digit, as an id."""
    return f"{'FRETC_' if file[:1].isdigit() else ''}{file.upper()}_H"


def _values(found: Instant, names: Mapping[str, str], reserved: Collection[str]) -> dict[str, Any]:
    """What both templates place."""
    signals = legal_names((each.signal.name for each in found.policies), reserved)
    given = {name: f"s_{legal}" for name, legal in signals.items()}
    durations = {
        (each.name, place): f"{names[each.name]}_for_{place + 1}"
        for each in found.meanings
        for place in range(len(each.held))
    }
    members = legal_names(durations.values(), reserved)
    held, propositions = [], []
    for each in found.meanings:
        mine = [members[durations[each.name, place]] for place in range(len(each.held))]
        printer = _printer(given, tuple(f"held->{member}" for member in mine))
        propositions.append(_proposition(each, names[each.name], printer))
        for member, (truth, duration) in zip(mine, each.held, strict=True):
            text = f"{each.name}: its part number {mine.index(member) + 1}, for {duration} ns"
            held.append({"name": member, "text": text, "truth": printer.truth(truth)})
    return {
        "signals": [_signal(each, signals[each.signal.name]) for each in found.policies],
        "held": held,
        "propositions": propositions,
    }


def _proposition(meaning: Meaning, name: str, printer: Printer) -> dict[str, Any]:
    return {
        "name": name,
        "truth": printer.truth(meaning.truth),
        "aggregate": meaning.aggregate.value,
        "on_unknown": meaning.on_unknown,
    }


def _signal(policy: Policy, name: str) -> dict[str, Any]:
    signal, invalid = policy.signal, policy.signal.invalid
    form = "word" if signal.values else "array" if policy.is_array else "number"
    fields = legal_names(policy.fields, ())
    given = {field: f"n_{legal}" for field, legal in fields.items()} | {"x": "x"}
    valid = None if policy.valid is None else _printer(given, ()).truth(policy.valid)
    unit = f", {signal.unit_name}" if signal.unit_name else ""
    return {
        "name": name,
        "text": f"{signal.path}{unit}",
        "form": "given" if policy.is_given else form,
        "reduce": signal.reduce.value if signal.reduce else "",
        "max_age": signal.max_age,
        "valid": valid,
        "fields": [*fields.values()],
        "parameters": "".join(f", double f_{each}" for each in fields.values()),
        "arguments": "".join(f", f_{each}" for each in fields.values()),
        "invalid": ", ".join(
            _MEANINGS[each]
            for each in (
                invalid.nan,
                invalid.positive_infinity,
                invalid.negative_infinity,
                invalid.other,
            )
        ),
        "numbers": [(_double(float(each)), place) for place, each in enumerate(signal.numbers)],
        "words": [(_letters(word), len(word.encode())) for word in signal.values],
    }


def _letters(word: str) -> str:
    """The bytes of a word for a string of C: letters and digits as they are."""
    return "".join(
        chr(byte) if chr(byte).isascii() and chr(byte).isalnum() else f"\\{byte:03o}"
        for byte in word.encode()
    )


def _double(value: float) -> str:
    if isnan(value):
        return "fretc_nan()"
    if isinf(value):
        return "fretc_infinity()" if value > 0 else "-fretc_infinity()"
    return value.hex()


def _printer(given: Mapping[str, str], held: tuple[str, ...]) -> Printer:
    signs = {sign: f"FRETC_{name}" for sign, name in _SIGNS.items()}
    fixing = Fixing(_arithmetic, _chosen, _compared)
    return Printer("fretc_", given, held, fixing, _TRUTHS, signs, _scale)


def _arithmetic(value: Fraction) -> str:
    return f"fretc_of_double({_double(suited(value).double)})"


def _chosen(function: str, number: str, value: Fraction) -> str:
    found = suited(value)
    single = f"{_double(found.single)}, {str(found.is_single).lower()}"
    return f"fretc_{function}_with({number}, {single}, {_double(found.double)})"


def _compared(number: str, sign: str, value: Fraction) -> str:
    found = suited(value, sign)
    beside = ", ".join(map(_double, (found.single, found.double, found.exact)))
    whole = f"UINT64_C({found.magnitude})"
    return f"fretc_compared_with({number}, FRETC_{_SIGNS[sign]}, {beside}, {whole})"


def _scale(value: Fraction) -> str:
    return ", ".join(map(_double, parts(value)))
