"""A C program that steps a monitor for ever with arbitrary inputs, with assertions in ACSL.

ACSL is the annotation language of Frama-C. The asserted ranges of cells are those of the program,
so an analyzer has to confirm invariants, not to find them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.program.program import Counter
from compiler.program.stored_program import RequirementValues, Ring
from compiler.targets.c.monitor import c_printer
from compiler.targets.c.printer import CPrinter
from fretish.classes.frozen import dataclass

ENTRY = "fretc_driver"
"""The function that never returns."""


@dataclass(frozen=True, slots=True)
class DriverText:
    """The text of the driver, and what an analyzer has to know about the monitor."""

    text: str
    words: int
    """The number of words of the longest ring, which is the number of iterations of its
    initialization."""

    @property
    def assertions(self) -> tuple[int, ...]:
        """The lines with an assertion."""
        lines = enumerate(self.text.splitlines(), 1)
        return tuple(number for number, line in lines if "/*@ assert " in line)


@dataclass(frozen=True, slots=True)
class _Range:
    """The range of a numeric cell."""

    name: str
    least: int
    most: int


def driver(name: str, base: str, requirements: Sequence[FormalizedRequirement]) -> DriverText:
    """The driver of a monitor.

    Args:
        name: the name of the monitor's header, without its extension.
        base: the prefix of its functions.
        requirements: the requirements, in the order of outcomes.
    """
    printer = c_printer(name, requirements)
    program, ranges = printer.program, [*_ranges(printer)]
    ends = {-1, 0, 1, *(end for cell in ranges for end in (cell.least, cell.most))}
    text = render(
        "c/driver.c.j2",
        header=f"{name}.h",
        base=base,
        inputs=[*printer.names.values()],
        ranges=ranges,
        ends=sorted(ends),
        readings=[_told(reading) for reading in program.readings],
    )
    words = (-(-cell.length // 32) for cell in program.cells if isinstance(cell, Ring))
    return DriverText(text, max(words, default=0))


def _ranges(printer: CPrinter) -> Iterator[_Range]:
    for cell in printer.program.cells:
        if isinstance(cell, Counter):
            yield _Range(cell.name, cell.least, cell.most)
        elif isinstance(cell, Ring):
            yield _Range(f"{cell.name}_at", 0, cell.length - 1)


def _told(reading: RequirementValues) -> dict[str, object]:
    deadline_ticks = -1 if reading.deadline is None else reading.deadline.deadline_ticks
    return {"prefix": reading.prefix, "deadline_ticks": deadline_ticks, "truths": [*reading.truths]}
