"""`--emit rust`: a crate with a monitor for controllers, without a standard library or a heap.

It computes the program of `--emit monitor` twice at every tick: the certain and the possible
values. A step takes the same time for any unknown values and any bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.spelling.reserved_words import RUST
from compiler.targets.c.fixed_memory import input_names, inputs, monitor_program, too_large
from compiler.targets.python.monitor import description, refusal, remark
from compiler.targets.python.names import module
from compiler.targets.rust import signals
from compiler.targets.rust.printer import RustPrinter
from compiler.targets.target import DEFAULT, Target, TargetOptions, stem
from compiler.targets.witness_traces import witness_traces
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """The refusals of a monitor in Python; and F601 for bounds that need too much memory."""
    return refusal(requirement, "Rust") or too_large(requirement, "Rust")


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """A crate for each requirement, or one for all; and a crate for samples beside it."""
    if options.one_file:
        return _crate("monitors", requirements)
    return tuple(
        file
        for requirement in requirements
        for file in _crate(f"{module(stem(requirement))}_monitor", [requirement])
    )


@with_recursion_limit
def _crate(name: str, requirements: Sequence[FormalizedRequirement]) -> tuple[Artifact, ...]:
    """The files of a crate with one monitor for all of the requirements."""
    name = name if name[0].isalpha() else f"r{name}"
    names = input_names(requirements, RUST)
    printer = RustPrinter.of(monitor_program(requirements, RUST), names)
    library = render(
        "rust/lib.rs.j2",
        **description(requirements),
        inputs=inputs(requirements, names),
        literals=[*printer.literals()],
        fields=[*printer.fields()],
        stages=printer.stages(),
        readings=printer.readings(),
    )
    witnesses = {
        reading.prefix: witness_traces(requirement)
        for reading, requirement in zip(printer.program.readings, requirements, strict=True)
    }
    tests = render("rust/words.rs.j2", crate=name, names=names, words=witnesses)
    manifest = render("rust/Cargo.toml.j2", crate=name, monitor=None)
    files = {f"{name}/Cargo.toml": manifest, f"{name}/src/lib.rs": library}
    files |= {f"{name}/tests/words.rs": tests} if any(witnesses.values()) else {}
    files |= signals.files(name, requirements, names, RUST)
    return tuple(Artifact(PurePosixPath(path), text) for path, text in files.items())


TARGET = Target(
    "rust",
    "a runtime monitor in Rust for controllers: a crate without the standard library",
    emit,
    refuse,
    remark,
    joins=True,
    next_step="`cargo test --manifest-path {}` builds it and runs its tests",
    names=lambda requirement: input_names([requirement], RUST),
)
