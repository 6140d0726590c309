"""`--emit rust`: a crate with a monitor for controllers, without a standard library or a heap.

It computes the program of `--emit monitor` twice at every tick: the certain and the possible
values. A step takes the same time for any unknown values and any bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.identifiers import legal_names
from compiler.logic.spelling.reserved_words import RUST
from compiler.program.lowering import program
from compiler.program.rails import Reading, rail
from compiler.targets.c.monitor import too_large
from compiler.targets.comparison_names import comparison_names, in_words
from compiler.targets.python.monitor import description_of, module, prefixes_of, refusal, remark
from compiler.targets.rust import signals
from compiler.targets.rust.printer import Printer
from compiler.targets.target import DEFAULT, Options, Target, stem
from compiler.targets.witness_traces import witness_traces
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.reading.recursion import with_recursion_limit


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """The refusals of a monitor in Python; and F601 for bounds that need too much memory."""
    return refusal(requirement, "Rust") or too_large(requirement, "Rust")


def emit(
    requirements: Sequence[FormalizedRequirement], options: Options = DEFAULT
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
    propositions = tuple(
        dict.fromkeys(atom for requirement in requirements for atom in requirement.watched)
    )
    meanings = {
        atom: text for requirement in requirements for atom, text in in_words(requirement).items()
    }
    names = _names(requirements)
    prefixes = prefixes_of([requirement.id for requirement in requirements])
    members = legal_names(prefixes, RUST, names=prefixes)
    cells = rail(
        program({requirement.id: requirement.watch for requirement in requirements}), members
    )
    printer = Printer.of(cells, names)
    library = render(
        "rust/lib.rs.j2",
        title=", ".join(requirement.id for requirement in requirements),
        formalized=[description_of(requirement) for requirement in requirements],
        tick=str(requirements[0].clock) if requirements[0].clock else "not declared",
        version=__version__,
        inputs=[{"name": names[atom], "text": meanings.get(atom, atom)} for atom in propositions],
        literals=[*printer.literals()],
        fields=[*printer.fields()],
        stages=[
            {"comment": group.comment, "lines": [*printer.lines(group)]} for group in cells.stages
        ],
        readings=[_reading(reading, printer) for reading in cells.readings],
    )
    witnesses = {
        members[requirement.id]: witness_traces(requirement) for requirement in requirements
    }
    tests = render("rust/words.rs.j2", crate=name, names=names, words=witnesses)
    manifest = render("rust/Cargo.toml.j2", crate=name, monitor=None)
    files = {f"{name}/Cargo.toml": manifest, f"{name}/src/lib.rs": library}
    files |= {f"{name}/tests/words.rs": tests} if any(witnesses.values()) else {}
    files |= signals.files(name, requirements, names, RUST)
    return tuple(Artifact(PurePosixPath(path), text) for path, text in files.items())


def _names(requirements: Sequence[FormalizedRequirement]) -> Mapping[str, str]:
    """Proposition → the field of the inputs."""
    spoken = {
        proposition: word
        for requirement in requirements
        for proposition, word in comparison_names(requirement).items()
    }
    propositions = (
        proposition for requirement in requirements for proposition in requirement.watched
    )
    return legal_names(propositions, RUST, names=spoken)


def _reading(reading: Reading, printer: Printer) -> Mapping[str, Any]:
    return {
        "id": reading.id,
        "prefix": reading.prefix,
        "left": printer.left(reading.deadline, reading.truths["open"]),
        "truths": {name: printer.value(value) for name, value in reading.truths.items()},
    }


TARGET = Target(
    "rust",
    "a runtime monitor in Rust for controllers: a crate without the standard library",
    emit,
    refuse,
    remark,
    joins=True,
    next_step="`cargo test --manifest-path {}` builds it and runs its tests",
    names=lambda requirement: _names([requirement]),
)
