"""A monitor in C as a shared library, with the layout of its structs.

The build traps: undefined behaviour that the compiler sees ends the process, and is no answer.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from fretc.verification.engines.programs import MEMORY, STARTED, run

COMPILERS = ("gcc", "clang", "cc")
FLAGS = (
    "-std=c99",
    "-O2",
    "-fPIC",
    "-shared",
    "-s",
    "-fsanitize=undefined",
    "-fsanitize-undefined-trap-on-error",
)
_SECONDS = 60.0


@dataclass(frozen=True, slots=True)
class Binary:
    """What a compiler has made."""

    data: bytes
    engine: str
    """The compiler with its version and its flags."""


class BuildError(Exception):
    """There is no binary; the message says why."""


def compiler() -> str | None:
    """The path of the first C compiler that is installed."""
    return next(filter(None, map(shutil.which, COMPILERS)), None)


@cache
def built(program: str, text: str, header: tuple[str, str], layout: str) -> Binary:
    """The library of a monitor.

    Args:
        program: the compiler.
        text: of the C file.
        header: the name and the text of its header.
        layout: further C in the library, which tells the layout of structs.

    Raises:
        BuildError: the compiler does not take the text, or cannot be run.
    """
    with TemporaryDirectory(prefix="fretc-") as name:
        folder = Path(name)
        (folder / header[0]).write_text(header[1], encoding="utf-8")
        (folder / "fretc_text.c").write_text(text, encoding="utf-8")
        (folder / "fretc_layout.c").write_text(layout, encoding="utf-8")
        command = [program, *FLAGS, "fretc_text.c", "fretc_layout.c", "-o", "fretc_text.so"]
        try:
            version = _version(program, folder)
            end = run(command, folder, seconds=_SECONDS, memory=MEMORY)
        except OSError as error:
            raise BuildError(f"the compiler cannot be run: {error}") from None
        if end.status != 0:
            lines = (line for line in end.text.splitlines() if "error" in line)
            raise BuildError(f"{version} does not compile it: {next(lines, 'it gives no reason')}")
        return Binary((folder / "fretc_text.so").read_bytes(), f"{version} {' '.join(FLAGS)}")


def _version(program: str, folder: Path) -> str:
    end = run([program, "--version"], folder, seconds=STARTED, memory=MEMORY)
    first, *_ = end.text.splitlines() or [""]
    return first or "a compiler that tells no version"


def layout(header: str, base: str, cells: Sequence[str]) -> str:
    """C that tells where the cells of a rail are.

    Args:
        header: its name.
        base: what the names of its types begin with.
        cells: all members of the struct of a rail.
    """
    rail = f"{base}_rail"
    places = "".join(
        f"    offsetof({rail}, {cell}), sizeof((({rail} *)0)->{cell}),\n" for cell in cells
    )
    return f"""#include <stddef.h>
#include "{header}"

const size_t fretc_layout[] = {{
    sizeof({base}_state), offsetof({base}_state, possible), sizeof({base}_inputs),
    sizeof({base}_outcomes), sizeof(fretc_outcome),
{places}}};
"""
