"""A JavaScript module from typed samples to the truth values that `judge` takes."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.identifiers import legal_names
from compiler.signals.functions import file_name, functions
from compiler.signals.printing import NumberSyntax
from compiler.targets.javascript.constants import Constants, scale, truth
from fretish.expressions import COMPARE


def files(monitor: str, requirements: Sequence[FormalizedRequirement]) -> tuple[Artifact, ...]:
    """The module beside the module `monitor`; empty without bindings."""
    constants = Constants()
    names = legal_names((name for requirement in requirements for name in requirement.watched), ())
    sample_functions = functions(requirements, names, _language(constants))
    if sample_functions is None:
        return ()
    text = render(
        "js/signals.mjs.j2",
        functions=sample_functions,
        constants=constants.lines(),
        readings=render("js/readings.js.j2"),
        samples=render("js/samples.js.j2"),
    )
    return (Artifact(PurePosixPath(f"{file_name(monitor)}.mjs"), text),)


def _language(constants: Constants) -> NumberSyntax:
    """The syntax of JavaScript; constants get their names while expressions are written."""
    return NumberSyntax(
        prefix="",
        truths={value: truth(value) for value in (True, False, None)},
        signs={sign: f'"{sign}"' for sign in COMPARE},
        held="h_{}",
        scale=scale,
        fixed=constants.name,
        chosen=lambda function, number, value: f"{function}({number}, {constants.name(value)})",
        compared=lambda number, sign, value: (
            f'compared({number}, "{sign}", {constants.name(value)})'
        ),
    )
