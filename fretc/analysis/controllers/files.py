"""The files of `fretc analyze --emit`: controllers in Python, Mealy machines in HOA and DOT."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum
from pathlib import PurePosixPath
from typing import assert_never

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from fretc.analysis.controllers.circuit import Circuit
from fretc.analysis.controllers.moves import MachineMove, Mealy, Term


class ControllerFormat(StrEnum):
    """Form of a controller; the values are those of `--emit`."""

    PYTHON = "python"
    HOA = "hoa"
    DOT = "dot"


Sentences = Mapping[str, str]
"""FRETish sentences by id."""


def controller(
    circuits: Sequence[Circuit], requirements: Sentences, assumptions: Sentences
) -> Artifact:
    """`controller.py`, which satisfies all requirements."""
    text = render(
        "controller/controller.py.j2",
        circuits=circuits,
        requirements=[*requirements],
        sentences=[*requirements.items()],
        assumptions=[*assumptions.items()],
        inputs=sorted({name for each in circuits for name in each.inputs.values()}),
        outputs=sorted({name for each in circuits for name in each.outputs.values()}),
        bits=[bit for each in circuits for bit in each.bits],
        following=[value for each in circuits for value in each.following],
        version=__version__,
    )
    return Artifact(PurePosixPath("controller.py"), text)


def automata(machines: Sequence[Mealy], form: ControllerFormat) -> tuple[Artifact, ...]:
    """`controller.hoa` or `controller.dot`; with a number for several components."""
    return tuple(
        Artifact(
            PurePosixPath(f"controller{f'-{number}' if len(machines) > 1 else ''}.{form}"),
            _automaton(machine, form),
        )
        for number, machine in enumerate(machines, 1)
    )


def _automaton(machine: Mealy, form: ControllerFormat) -> str:
    title = f"a controller that satisfies {', '.join(machine.requirements)}"
    match form:
        case ControllerFormat.HOA:
            return _hoa(machine, title)
        case ControllerFormat.DOT:
            return render("controller/mealy.dot.j2", title=title, edges=[*_edges(machine)])
        case ControllerFormat.PYTHON:
            raise AssertionError("a program is made of circuits")
        case _:
            assert_never(form)


def _hoa(machine: Mealy, title: str) -> str:
    names = {name: i for i, name in enumerate((*machine.inputs, *machine.outputs))}

    def label(move: MachineMove) -> str:
        outputs = _conjunction(move.outputs, names)
        return " | ".join(
            " & ".join(part for part in (_conjunction(term, names), outputs) if part) or "t"
            for term in move.when
        )

    return render(
        "controller/mealy.hoa.j2",
        title=title,
        propositions=[*names],
        controllable=[names[name] for name in machine.outputs],
        states=[[(label(move), move.after) for move in moves] for moves in machine.states],
        version=__version__,
    )


def _conjunction(term: Term, names: Mapping[str, int]) -> str:
    return " & ".join(f"{'' if value else '!'}{names[name]}" for name, value in term.items())


def _edges(machine: Mealy) -> Iterator[tuple[int, str, int]]:
    for number, moves in enumerate(machine.states):
        for move in moves:
            inputs = " | ".join(
                " & ".join(f"{'' if value else '!'}{name}" for name, value in term.items()) or "any"
                for term in move.when
            )
            outputs = ", ".join(name for name, value in move.outputs.items() if value)
            yield number, f"{inputs} / {outputs or 'none'}", move.after
