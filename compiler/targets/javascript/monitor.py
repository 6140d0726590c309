"""`--emit js`: a monitor as an ES module without dependencies.

Certain and possible values are computed at every tick. An outcome has the verdict, its reasons, and
both values of each signal.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.identifiers import legal_names
from compiler.program.lowering import program
from compiler.targets.javascript import signals
from compiler.targets.javascript.constants import Constants, scale, truth
from compiler.targets.javascript.printer import JavaScriptPrinter
from compiler.targets.python.comparisons import TRUTH, ComparisonWriter, Spelling
from compiler.targets.python.input_adapter import InputAdapter, input_adapter
from compiler.targets.python.monitor import description, description_of, refusal, remark, watched
from compiler.targets.python.names import module
from compiler.targets.target import DEFAULT, Target, TargetOptions, stem
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit

_NAMES = ("REQUIREMENTS", "PROPOSITIONS", "VARIABLES", "init", "step", "truths", "judge")
"""The exports of a module."""


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F312 and F601, as the monitor in Python."""
    return refusal(requirement, "JavaScript")


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """`<id>_monitor.mjs` for each requirement, or one file; and the truths of samples beside it."""
    if options.one_file:
        return _files("monitors", requirements)
    return tuple(
        file
        for requirement in requirements
        for file in _files(f"{module(stem(requirement))}_monitor", [requirement])
    )


def _files(name: str, requirements: Sequence[FormalizedRequirement]) -> tuple[Artifact, ...]:
    monitor = Artifact(PurePosixPath(f"{name}.mjs"), text(*requirements))
    return (monitor, *signals.files(name, requirements))


def text(*requirements: FormalizedRequirement) -> str:
    """The text of the module with one monitor for all requirements.

    Args:
        requirements: at least one, each with an id of its own, and all on one clock.
    """
    code = body(*requirements)
    return render(
        "js/monitor.mjs.j2",
        **description(requirements),
        body=code.text,
        exports=code.exports,
    )


@dataclass(frozen=True, slots=True)
class Body:
    """The code of a monitor, without the parts that make it a module."""

    text: str
    exports: tuple[str, ...]
    front: InputAdapter | None
    """The adapter from variables to propositions; None: the variables are the propositions."""
    propositions: tuple[str, ...]


@with_recursion_limit
def body(*requirements: FormalizedRequirement) -> Body:
    """The code of one monitor for all requirements, with the conditions of `text`."""
    propositions = watched(requirements)
    compared = input_adapter(requirements, propositions)
    inputs = compared.inputs if compared else {}
    names = legal_names((*propositions, *inputs), ())
    monitor_program = program({requirement.id: requirement.watch for requirement in requirements})
    printer = JavaScriptPrinter.of(monitor_program, names)
    lines = _JavaScriptAdapter.of(compared, propositions, names) if compared else None
    written = render(
        "js/body.js.j2",
        formalized=[description_of(requirement) for requirement in requirements],
        propositions=propositions,
        variables=[
            {
                "name": name,
                "variable": f"v_{names[name]}",
                "kind": variable.kind,
                "words": variable.words,
            }
            | {"infinite": variable.infinite}
            for name, variable in inputs.items()
        ]
        or [{"name": name, "kind": TRUTH, "words": ()} for name in propositions],
        cells=[
            {"name": c.name, "comment": c.comment, "initial": printer.initial(c)}
            for c in monitor_program.cells
        ],
        literals=[(n, propositions.index(p), positive) for n, p, positive in printer.literals()],
        blocks=[
            {"comment": block.comment, "lines": [*printer.lines(block)]}
            for block in monitor_program.blocks
            if block.instructions
        ],
        requirements=[
            {
                "id": requirement.id,
                "signals": printer.signals(requirement),
                "renewed": requirement.renewed,
            }
            for requirement in monitor_program.requirements
        ],
        front=lines,
        kernel=render("js/kernel.js.j2"),
        readings=render("js/readings.js.j2"),
    )
    return Body(written, (*_NAMES, *(["float32"] if lines else [])), compared, propositions)


@dataclass(frozen=True, slots=True)
class _JavaScriptAdapter:
    """The code that computes truth values from variables."""

    constants: tuple[str, ...]
    row: tuple[tuple[str, str], ...]
    """Each proposition with the code of its truth value."""
    earlier: tuple[tuple[str, str, str], ...]
    """Values kept for `preReal` and the like: (variable name, initial value, expression for the
    current tick)."""

    @classmethod
    def of(
        cls, compared: InputAdapter, propositions: Sequence[str], names: Mapping[str, str]
    ) -> _JavaScriptAdapter:
        """The code for given names of variables and propositions."""
        constants = Constants()
        variables = {name: f"v_{names[name]}" for name in compared.inputs}
        writer = ComparisonWriter(variables, Spelling(constants.name, scale, truth))
        texts = {
            name: writer.comparison(comparison) for name, comparison in compared.comparisons.items()
        }
        row = tuple((name, texts.get(name) or variables[name]) for name in propositions)
        earlier = tuple((name, *both) for both, name in writer.earlier.items())
        return cls(constants.lines(), row, earlier)


TARGET = Target(
    "js",
    "a standalone runtime monitor in JavaScript",
    emit,
    refuse,
    remark,
    joins=True,
)
