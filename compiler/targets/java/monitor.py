"""`--emit java`: a monitor as a class for Java 11, whose step allocates nothing.

It computes the program of `--emit monitor` twice at every tick: the certain and the possible
values. A step is divided into methods, because the size of a method is limited.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.templating import java_comment, render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.spelling.reserved_words import JAVA
from compiler.targets.c.fixed_memory import input_names, inputs, monitor_program, too_large
from compiler.targets.java import signals
from compiler.targets.java.printer import JavaPrinter, methods
from compiler.targets.python.monitor import description, refusal, remark
from compiler.targets.python.names import module
from compiler.targets.target import DEFAULT, Target, TargetOptions, not_expressible, stem
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit

_MOST_STATEMENT = 32_000
"""Characters of a statement, which has at most as many bytes; a method has at most 65 535."""
_MOST_FIELDS, _MOST_NAMES = 5_000, 20_000
"""The fields of a class, and all names that it mentions. A file of a class has at most 65 535
constants, three for each name, and the code of its constructor at most 11 bytes for each field."""


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """The refusals of a monitor in Python; and F601 for what a class of Java cannot hold."""
    return (
        refusal(requirement, "Java")
        or too_large(requirement, "Java")
        or _too_long(requirement)
        or refuse_joint([requirement])
    )


@with_recursion_limit
def _too_long(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 if a statement is larger than a method may be."""
    printer = java_printer([requirement])
    bound = signals.statements([requirement], printer.names)
    lines = chain(bound, *_stages(printer), *_readings(printer))
    if max(map(len, lines), default=0) <= _MOST_STATEMENT:
        return None
    fix = "bind parts of the expression as propositions"
    what = f"a condition of more than {_MOST_STATEMENT} characters"
    return not_expressible("a monitor in Java", requirement, what, fix)


@with_recursion_limit
def refuse_joint(requirements: Sequence[FormalizedRequirement]) -> Diagnostic | None:
    """F601 if one class cannot hold the names of all requirements."""
    printer = java_printer(requirements)
    fields, literals = len([*printer.fields()]), len(printer.program.literals)
    numbers = (len(requirements), len(printer.names), fields, literals)
    if max(numbers) <= _MOST_FIELDS and sum(numbers) <= _MOST_NAMES:
        return None
    what, fix = "all values", "emit smaller groups of requirements"
    return not_expressible("a class of Java", requirements[-1], what, fix)


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """`<Id>Monitor.java` for each requirement, or `Monitors.java`; and a class for samples."""
    if options.one_file:
        return _files("Monitors", requirements)
    return tuple(
        file
        for requirement in requirements
        for file in _files(class_name(requirement), [requirement])
    )


def class_name(requirement: FormalizedRequirement) -> str:
    """The name of the class of a requirement's monitor, by which no file system confuses two."""
    name = module(stem(requirement))
    return f"{'' if name[0].isalpha() else '_'}{name[0].upper()}{name[1:]}Monitor"


@with_recursion_limit
def _files(name: str, requirements: Sequence[FormalizedRequirement]) -> tuple[Artifact, ...]:
    """The class with one monitor for all of the requirements."""
    printer = java_printer(requirements)
    text = render(
        "java/monitor.java.j2",
        **description(requirements),
        class_name=name,
        inputs=inputs(requirements, printer.names),
        literals=[*printer.literals()],
        readings=printer.readings(),
        fields=[*printer.fields()],
        **_methods(printer),
    )
    monitor = Artifact(PurePosixPath(f"{name}.java"), text)
    return (monitor, *signals.files(name, requirements, printer.names))


def java_printer(requirements: Sequence[FormalizedRequirement]) -> JavaPrinter:
    """The printer of Java for a monitor of all requirements, which are not refused."""
    return JavaPrinter.of(monitor_program(requirements, JAVA), input_names(requirements, JAVA))


def _methods(printer: JavaPrinter) -> dict[str, Any]:
    """The lines of all methods, as values for the template."""
    literals = [*printer.literals()]
    certain = (
        f"{name} = inputs.{given} == Truth.{'TRUE' if positive else 'FALSE'};"
        for name, given, positive in literals
    )
    possible = (
        f"{name} = inputs.{given} != Truth.{'FALSE' if positive else 'TRUE'};"
        for name, given, positive in literals
    )
    judging = (f"{reading.prefix}.judge();" for reading in printer.program.readings)
    bodies = {
        "certain": methods([line] for line in certain),
        "possible": methods([line] for line in possible),
        "advancing": methods(_stages(printer)),
        "telling": methods(_readings(printer)),
        "judging": methods([line] for line in judging),
    }
    return {**bodies, "step": [*_step(*map(len, bodies.values()))]}


def _step(certain: int, possible: int, advancing: int, telling: int, judging: int) -> Iterator[str]:
    """The calls of a step, by the numbers of methods."""
    for name, literals in (("certain", certain), ("possible", possible)):
        told = f"(now, outcomes, {str(name == 'possible').lower()})"
        yield from (f"now.{name}{i}(inputs)" for i in range(1, literals + 1))
        yield from (f"{name}.advance{i}(now)" for i in range(1, advancing + 1))
        yield from (f"{name}.tell{i}{told}" for i in range(1, telling + 1))
    yield from (f"outcomes.judge{i}()" for i in range(1, judging + 1))


def _stages(printer: JavaPrinter) -> Iterator[list[str]]:
    for stage in printer.stages():
        yield [java_comment(stage["comment"]), *stage["lines"]]


def _readings(printer: JavaPrinter) -> Iterator[list[str]]:
    for reading in printer.readings():
        outcome = f"outcomes.{reading['prefix']}"
        yield [
            java_comment(reading["id"]),
            f"reading = isPossible ? {outcome}.possible : {outcome}.certain;",
            f"reading.left = {reading['left']};",
            *(f"reading.{name} = {value};" for name, value in reading["truths"].items()),
        ]


TARGET = Target(
    "java",
    "a runtime monitor in Java 11: a class that needs no library",
    emit,
    refuse,
    remark,
    joins=True,
    refuse_joint=refuse_joint,
    next_step="`javac {}` compiles it",
    names=lambda requirement: input_names([requirement], JAVA),
)
