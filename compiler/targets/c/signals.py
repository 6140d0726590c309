"""C functions from typed samples to the inputs of a monitor, as an audit computes them.

The functions have no state. The header has the constants, in exact C99.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from fractions import Fraction
from math import isinf, isnan
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals.functions import file_name, functions
from compiler.signals.printing import NumberSyntax, encode_constant, letters, parts

_SIGNS = {"<": "LT", "<=": "LE", ">": "GT", ">=": "GE", "=": "EQ", "!=": "NE"}


def files(
    name: str,
    base: str,
    requirements: Sequence[FormalizedRequirement],
    names: Mapping[str, str],
    reserved: Container[str],
) -> tuple[Artifact, ...]:
    """The header and the source beside the monitor `name`; empty without bindings.

    Args:
        name: the name of the monitor's files, without extension.
        base: the prefix of the monitor's functions.
        requirements: the requirements of the monitor.
        names: the monitor's input of each proposition.
        reserved: reserved names.
    """
    sample_functions = functions(requirements, names, LANGUAGE, reserved)
    if sample_functions is None:
        return ()
    file = file_name(name)
    common = {"functions": sample_functions, "base": base, "header": f"{file}.h"}
    source = render("c/signals.c.j2", **common, double=_double, letters=letters)
    header = render(
        "c/signals.h.j2",
        **common,
        guard=guard(file),
        monitor=f"{name}.h",
        kernel=render("c/numbers.h.j2"),
    )
    return tuple(
        Artifact(PurePosixPath(f"{file}.{ending}"), text)
        for ending, text in (("c", source), ("h", header))
    )


def guard(file: str) -> str:
    """The include guard of a header; a file name may begin with a digit, like an id."""
    return f"{'FRETC_' if file[:1].isdigit() else ''}{file.upper()}_H"


def _double(value: float) -> str:
    if isnan(value):
        return "fretc_nan()"
    if isinf(value):
        return "fretc_infinity()" if value > 0 else "-fretc_infinity()"
    return float(value).hex()


def _fixed(value: Fraction) -> str:
    return f"fretc_of_double({_double(encode_constant(value).double)})"


def _chosen(function: str, number: str, value: Fraction) -> str:
    encodings = encode_constant(value)
    single = f"{_double(encodings.single)}, {str(encodings.is_single).lower()}"
    return f"fretc_{function}_with({number}, {single}, {_double(encodings.double)})"


def _compared(number: str, sign: str, value: Fraction) -> str:
    encodings = encode_constant(value, sign)
    beside = ", ".join(map(_double, (encodings.single, encodings.double, encodings.exact)))
    whole = f"UINT64_C({encodings.magnitude})"
    return f"fretc_compared_with({number}, FRETC_{_SIGNS[sign]}, {beside}, {whole})"


def _scale(value: Fraction) -> str:
    return ", ".join(map(_double, parts(value)))


LANGUAGE = NumberSyntax(
    prefix="fretc_",
    truths={True: "FRETC_TRUE", False: "FRETC_FALSE", None: "FRETC_UNKNOWN"},
    signs={sign: f"FRETC_{name}" for sign, name in _SIGNS.items()},
    held="held->{}",
    scale=_scale,
    fixed=_fixed,
    chosen=_chosen,
    compared=_compared,
)
