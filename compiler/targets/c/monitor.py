"""`--emit c`: a monitor for controllers, in C99 that needs no library, no heap and no loop.

It computes the program of `--emit monitor` twice at every tick: the certain and the possible
values. Its state is a struct; a step takes the same time for any unknown values and any bound.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.spelling.reserved_words import C_LIBRARY, C, ReservedWords
from compiler.program.stored_program import Ring
from compiler.signals.functions import Functions, functions
from compiler.targets.c import signals
from compiler.targets.c.fixed_memory import input_names, inputs, monitor_program, too_large
from compiler.targets.c.printer import CPrinter
from compiler.targets.python.monitor import description, refusal, remark
from compiler.targets.python.names import module, prefixes_of
from compiler.targets.target import DEFAULT, Target, TargetOptions, stem
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """The refusals of a monitor in Python; and F601 for bounds that need too much memory."""
    return refusal(requirement, "C") or too_large(requirement, "C")


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """`<id>_monitor.h` and `.c` for each requirement, or `monitors.h` and `.c` for all."""
    if options.one_file:
        return _files("monitors", "monitors", requirements)
    return tuple(
        file
        for name, base, requirement in _apart(requirements)
        for file in _files(name, base, [requirement])
    )


def _apart(
    requirements: Sequence[FormalizedRequirement],
) -> Iterator[tuple[str, str, FormalizedRequirement]]:
    """The name of the files of each requirement, and the prefix of its names.

    `r1_sample_init` belongs to the signal `init` of R1. Names of R1_sample begin with `r1_sample_`
    and continue with another `_`, with which no name of a signal begins.
    """
    bases = prefixes_of([requirement.id for requirement in requirements])
    for requirement in requirements:
        base = re.sub(r"_sample(?=_|$)", "_sample_", bases[requirement.id])
        base = f"{base}_" if base in C_LIBRARY else base
        yield f"{module(stem(requirement))}_monitor", base, requirement


@dataclass(frozen=True, slots=True)
class Interface:
    """The names in the interface of one requirement's monitor."""

    file: str
    """The name of the files, without extension."""
    base: str
    """The prefix of types and functions."""
    inputs: Mapping[str, str]
    """Proposition → the member of the inputs, in their order."""
    outcome: str
    """The member of the outcomes for the requirement."""


def interface(requirements: Sequence[FormalizedRequirement]) -> tuple[Interface, ...]:
    """The interface of each requirement's monitor, in separate files as `emit` writes them."""
    every = [
        (name, base, c_printer(name, [requirement]))
        for name, base, requirement in _apart(requirements)
    ]
    return tuple(
        Interface(name, base, printer.names, printer.program.readings[0].prefix)
        for name, base, printer in every
    )


@with_recursion_limit
def _files(
    name: str, base: str, requirements: Sequence[FormalizedRequirement]
) -> tuple[Artifact, ...]:
    """The header and the source of one monitor for all of the requirements."""
    printer = c_printer(name, requirements)
    values = _values(printer) | description(requirements)
    values |= {"base": base, "header": f"{name}.h"}
    source = render("c/monitor.c.j2", **values)
    header = render(
        "c/monitor.h.j2",
        **values,
        guard=signals.guard(name),
        inputs=inputs(requirements, printer.names),
        bytes=2 * printer.bytes,
        operations=_operations(source, len(requirements)),
    )
    monitor = tuple(
        Artifact(PurePosixPath(f"{name}.{ending}"), text)
        for ending, text in (("c", source), ("h", header))
    )
    return (*monitor, *signals.files(name, base, requirements, printer.names, C))


@dataclass(frozen=True, slots=True)
class JoinedInterface:
    """The names in the interface of one monitor for all requirements; all begin with `monitors`."""

    inputs: Mapping[str, str]
    """Proposition → the member of the inputs."""
    outcomes: tuple[str, ...]
    """The member of the outcomes for each requirement."""
    signals: Functions
    """The functions from samples to the inputs."""


@with_recursion_limit
def joined_interface(requirements: Sequence[FormalizedRequirement]) -> JoinedInterface:
    """The interface of `emit` with `one_file`, for requirements with bindings."""
    printer = c_printer("monitors", requirements)
    sample_functions = functions(requirements, printer.names, signals.LANGUAGE, C)
    assert sample_functions is not None, "there are bindings"
    return JoinedInterface(
        printer.names,
        tuple(reading.prefix for reading in printer.program.readings),
        sample_functions,
    )


def c_printer(name: str, requirements: Sequence[FormalizedRequirement]) -> CPrinter:
    """The printer of C for a monitor of all requirements.

    Args:
        name: the name of its header, without extension.
        requirements: requirements that are not refused.
    """
    reserved = _reserved(name)
    return CPrinter.of(monitor_program(requirements, reserved), input_names(requirements, reserved))


def _reserved(name: str) -> ReservedWords:
    return C | {signals.guard(name)}


def _values(printer: CPrinter) -> dict[str, Any]:
    """The variables of both templates."""
    return {
        "members": printer.members(),
        "literals": [*printer.literals()],
        "rings": [
            {"name": cell.name, "words": -(-cell.length // 32)}
            for cell in printer.program.cells
            if isinstance(cell, Ring)
        ],
        "stages": printer.stages(),
        "readings": printer.readings(),
    }


_OPERATOR = re.compile(r"&&|\|\||[<>=!]=|<<|>>|[|&]=|[-+<>=!~%/?&|\[]")
_FUNCTION = re.compile(r"^(?:static )?(?:inline )?void \w+_(?:advance|judge|step)\b", re.M)
_COMMENT = re.compile(r"/\*.*?\*/|->")


def _operations(source: str, requirements: int) -> int:
    """The number of operators in all statements of a step, which bounds the executed ones.

    Args:
        source: the text of the C file.
        requirements: their number.
    """
    text = _COMMENT.sub("", source)
    _, advance, judge, step = _FUNCTION.split(text)
    often = {advance: 2, judge: requirements, step: 1}
    return sum(times * len(_OPERATOR.findall(part)) for part, times in often.items())


TARGET = Target(
    "c",
    "a runtime monitor in C99 for controllers: a header and a source",
    emit,
    refuse,
    remark,
    joins=True,
    next_step="`cc -std=c99 -c {}` compiles it",
    names=lambda requirement: input_names(
        [requirement], _reserved(f"{module(stem(requirement))}_monitor")
    ),
)
