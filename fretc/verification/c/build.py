"""A monitor in C as a shared library, with the layout of its structs.

Undefined behaviour that the compiler can detect aborts the process, so that it gives no result.
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
    "-ftrapv",  # Without this flag gcc assumes that `x + 1 > x` and that sums do not overflow.
    "-fsanitize=undefined",
    "-fsanitize-undefined-trap-on-error",
)


def compiler() -> str | None:
    """Path of the first installed C compiler, or None."""
    return next(filter(None, map(shutil.which, COMPILERS)), None)


def built(program: str, text: str, header: tuple[str, str], layout: str) -> Binary:
    """The library of a monitor.

    Args:
        program: path of the compiler.
        text: text of the C file.
        header: name and text of its header.
        layout: further C code that exports the layout of structs.

    Raises:
        ToolError: the compiler rejects the text, or cannot be run.
    """
    texts = {header[0]: header[1], "fretc_text.c": text, "fretc_layout.c": layout}
    step = ("fretc_text.c", "fretc_layout.c", "-o", "fretc_text.so")
    return compiled(program, FLAGS, texts, [step], "fretc_text.so")


def layout(header: str, base: str, cells: Sequence[str]) -> str:
    """C code that exports the offsets of an approximation's cells.

    Args:
        header: name of the header.
        base: prefix of the type names.
        cells: all members of the approximation's struct.
    """
    approximation = f"{base}_approximation"
    places = "".join(
        f"    offsetof({approximation}, {cell}), sizeof((({approximation} *)0)->{cell}),\n"
        for cell in cells
    )
    return f"""#include <stddef.h>
#include "{header}"

const size_t fretc_layout[] = {{
    sizeof({base}_state), offsetof({base}_state, certain), offsetof({base}_state, possible),
    sizeof({base}_inputs), sizeof({base}_outcomes), sizeof(fretc_outcome),
{places}}};
"""
