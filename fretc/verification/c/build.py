"""A monitor in C as a shared library, with the layout of its structs.

The build traps: undefined behaviour that the compiler sees ends the process, and is no answer.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence

from fretc.verification.compiled.tools import Binary, compiled

COMPILERS = ("gcc", "clang", "cc")
FLAGS = (
    "-std=c99",
    "-O2",
    "-fPIC",
    "-shared",
    "-s",
    "-ftrapv",  # else gcc takes `x + 1 > x` for true, and the sum for none that can overflow
    "-fsanitize=undefined",
    "-fsanitize-undefined-trap-on-error",
)


def compiler() -> str | None:
    """The path of the first C compiler that is installed."""
    return next(filter(None, map(shutil.which, COMPILERS)), None)


def built(program: str, text: str, header: tuple[str, str], layout: str) -> Binary:
    """The library of a monitor.

    Args:
        program: the compiler.
        text: of the C file.
        header: the name and the text of its header.
        layout: further C in the library, which tells the layout of structs.

    Raises:
        ToolError: the compiler does not take the text, or cannot be run.
    """
    texts = {header[0]: header[1], "fretc_text.c": text, "fretc_layout.c": layout}
    step = ("fretc_text.c", "fretc_layout.c", "-o", "fretc_text.so")
    return compiled(program, FLAGS, texts, [step], "fretc_text.so")


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
    sizeof({base}_state), offsetof({base}_state, certain), offsetof({base}_state, possible),
    sizeof({base}_inputs), sizeof({base}_outcomes), sizeof(fretc_outcome),
{places}}};
"""
