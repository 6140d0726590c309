"""A Rust crate beside a monitor's crate: from typed samples to the inputs of the monitor.

The crate of the monitor stays unchanged.
"""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from fractions import Fraction
from math import isinf, isnan

from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals.functions import file_name, functions
from compiler.signals.printing import NumberSyntax, encode_constant, letters, parts

_SIGNS = {"<": "lt", "<=": "le", ">": "gt", ">=": "ge", "=": "eq", "!=": "ne"}


def files(
    monitor: str,
    requirements: Sequence[FormalizedRequirement],
    names: Mapping[str, str],
    reserved: Container[str],
) -> dict[str, str]:
    """The files of the crate beside the crate `monitor`; empty without bindings.

    Args:
        monitor: the name of the crate.
        requirements: the requirements of the monitor.
        names: the monitor's input of each proposition.
        reserved: reserved names.
    """
    sample_functions = functions(requirements, names, _LANGUAGE, reserved)
    if sample_functions is None:
        return {}
    bound = {function.name for function in sample_functions.propositions}
    library = render(
        "rust/signals.rs.j2",
        functions=sample_functions,
        monitor=monitor,
        others=[name for name in names.values() if name not in bound],
        letters=letters,
    )
    crate = file_name(monitor)
    return {
        f"{crate}/Cargo.toml": render("rust/Cargo.toml.j2", crate=crate, monitor=monitor),
        f"{crate}/src/lib.rs": library,
        f"{crate}/src/numbers.rs": render("rust/numbers.rs.j2"),
    }


def _double(value: float) -> str:
    if isnan(value):
        return "f64::NAN"
    if isinf(value):
        return "f64::INFINITY" if value > 0 else "f64::NEG_INFINITY"
    return repr(value)


def _fixed(value: Fraction) -> str:
    return f"Some(Number::Double({_double(encode_constant(value).double)}))"


def _chosen(function: str, number: str, value: Fraction) -> str:
    encodings = encode_constant(value)
    kind = "Single" if encodings.is_single else "Double"
    single = f"Number::{kind}({_double(encodings.single)})"
    return f"{function}_with({number}, {single}, {_double(encodings.double)})"


def _compared(number: str, sign: str, value: Fraction) -> str:
    encodings = encode_constant(value, sign)
    whole = encodings.magnitude if encodings.exact > 0 else -encodings.magnitude
    wide = f"Number::Whole({whole})" if whole else f"Number::Wide({_double(encodings.exact)})"
    beside = f"{_double(encodings.single)}, {_double(encodings.double)}, {wide}"
    return f"compared_with({number}, Ordering::is_{_SIGNS[sign]}, {beside})"


def _scale(value: Fraction) -> str:
    return ", ".join(map(_double, parts(value)))


_LANGUAGE = NumberSyntax(
    prefix="",
    truths={True: "Some(true)", False: "Some(false)", None: "None"},
    signs={sign: f"Ordering::is_{name}" for sign, name in _SIGNS.items()},
    held="held.{}",
    scale=_scale,
    fixed=_fixed,
    chosen=_chosen,
    compared=_compared,
)
