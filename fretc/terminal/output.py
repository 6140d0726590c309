"""Terminal output of the commands, their output files and exit status."""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from shlex import quote
from typing import Any, NoReturn, TextIO, TypeVar

import click

from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.rendering import RenderedPart, plain, render_all, visible
from fretish.reading.natural_order import by_place

Piece = tuple[str, str | None]
"""Text of a line, and its colour or None."""
REQUIREMENTS_FOLDER = "requirements"
"""Default path of requirements."""
EVIDENCE, STORE = "build/evidence.json", "build/evidence"
"""Default paths of evidence: of one log, and of several."""
EXIT_OK, EXIT_VIOLATION, EXIT_USAGE, EXIT_INCONCLUSIVE, EXIT_INTERRUPTED = 0, 1, 2, 3, 130
"""Exit status: all satisfied, a violation, bad usage or input, inconclusive, Ctrl-C."""


def fail(*diagnostics: Diagnostic) -> NoReturn:
    """Print the diagnostics and exit with 2."""
    print_diagnostics(diagnostics)
    raise SystemExit(EXIT_USAGE)


T = TypeVar("T")


def or_fail(value: T | Diagnostic) -> T:
    """The value; a diagnostic is printed instead, and the command exits with 2."""
    if isinstance(value, Diagnostic):
        fail(value)
    return value


_FAILED = "fretc.failed"


def fail_at_end() -> None:
    """Make the present command exit with 2 at its end, whatever the results of its other input."""
    click.get_current_context().meta[_FAILED] = True


def final_status(context: click.Context, status: int) -> int:
    """Exit status at the end of a command: bad input wins over all but Ctrl-C."""
    failed = _FAILED in context.meta and status != EXIT_INTERRUPTED
    return EXIT_USAGE if failed else status


_ACCEPTED = "fretc.accepted"


def print_diagnostics(diagnostics: Sequence[Diagnostic]) -> None:
    """Print diagnostics on standard error, ordered by position; accepted ones are only counted.

    The output is coloured if standard error is a terminal.
    """
    print_diagnostic_groups([diagnostic for diagnostic in diagnostics if not diagnostic.accepted])
    accepted = {diagnostic for diagnostic in diagnostics if diagnostic.accepted}
    if accepted:
        click.get_current_context().meta.setdefault(_ACCEPTED, set()).update(accepted)


def print_accepted_count(context: click.Context) -> None:
    """Print the number of accepted warnings of a command, if any."""
    count = len(context.meta.get(_ACCEPTED, ()))
    if count:
        what = "1 warning is" if count == 1 else f"{count} warnings are"
        print_status(f"{what} accepted: `fretc check` lists the reasons")


def print_diagnostic_groups(*groups: Sequence[Diagnostic]) -> None:
    """Print groups of diagnostics on standard error, each ordered by position."""
    paint = _painted if _has_colours(sys.stderr) else plain
    blocks = [render_all(by_place(group), paint) for group in groups if group]
    if blocks:
        print_status("\n\n".join(blocks))


_STYLES: Mapping[RenderedPart, Mapping[str, Any]] = {
    RenderedPart.ERROR: {"fg": "red", "bold": True},
    RenderedPart.WARNING: {"fg": "yellow", "bold": True},
    RenderedPart.NOTE: {"fg": "blue", "bold": True},
    RenderedPart.MESSAGE: {"bold": True},
    RenderedPart.FRAME: {"fg": "blue"},
    RenderedPart.HELP: {"fg": "cyan", "bold": True},
}


def _painted(text: str, part: RenderedPart) -> str:
    return click.style(text, **_STYLES[part])


def _has_colours(stream: TextIO) -> bool:
    """Whether the stream is a terminal with colours, and the user wants them (no-color.org)."""
    return stream.isatty() and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"


def print_project_diagnostics(diagnostics: Sequence[Diagnostic], requirements: str) -> None:
    """Print diagnostics of a project, with one line for all warnings about sentences.

    Args:
        diagnostics: diagnostics of the project.
        requirements: its path, as named by the user.
    """
    warnings = [diagnostic for diagnostic in diagnostics if _is_about_a_sentence(diagnostic)]
    others = [diagnostic for diagnostic in diagnostics if diagnostic not in warnings]
    print_diagnostics(others)
    if not warnings:
        return
    counts = Counter(warning.code.number for warning in warnings)
    codes = ", ".join(f"{count} {code}" for code, count in sorted(counts.items()))
    noun = "warning about a sentence" if len(warnings) == 1 else "warnings about sentences"
    option = "" if requirements == REQUIREMENTS_FOLDER else f" --requirements {quote(requirements)}"
    if others:
        print_status("")
    print_status(visible(f"{len(warnings)} {noun} ({codes}): see `fretc check{option}`"))


def _is_about_a_sentence(diagnostic: Diagnostic) -> bool:
    """Whether the diagnostic warns about the meaning of a sentence."""
    about_meaning = diagnostic.code.number.startswith("F2")
    return about_meaning and diagnostic.is_open


def print_diagnostics_below(
    diagnostics: Sequence[Diagnostic], earlier: Sequence[Diagnostic]
) -> None:
    """Print `diagnostics`, preceded by a blank line if `earlier` is not empty."""
    if diagnostics and earlier:
        print_status("")
    print_diagnostics(diagnostics)


def print_status(text: str) -> None:
    """Print a line on standard error; a closed stream is ignored."""
    with suppress(OSError):
        click.echo(text, err=True)


def write_outputs(
    files: Mapping[Path, str | bytes | Iterable[str]], protected: Iterable[str] = ()
) -> None:
    """Write output files, all or none, and print their paths.

    Args:
        files: path → content, whole or in pieces; `-` prints the content.
        protected: input files, which no output may replace.
    """
    from compiler.files.text_files import write

    protect(files, protected)
    targets = [os.path.realpath(path) for path in files]
    for path, target in zip(files, targets, strict=True):
        if targets.count(target) > 1:
            fail(not_written(str(path), "two outputs would go there"))
    printed = files.get(Path("-"))
    for piece in (printed,) if isinstance(printed, str | bytes) else printed or ():
        click.echo(piece, nl=False)
    written = {path: text for path, text in files.items() if path != Path("-")}
    wrong = write(written)
    if wrong is not None:
        fail(wrong)
    _name(written)


def _name(written: Collection[Path]) -> None:
    """Print the paths of written files; of a folder with many files, only their number."""
    folders = Counter(path.parent for path in written)
    for folder, count in folders.items():
        if count > _MOST_NAMED:
            print_status(visible(f"wrote {count} files in {folder}"))
    for path in written:
        if folders[path.parent] <= _MOST_NAMED:
            print_status(visible(f"wrote {path}"))


_MOST_NAMED = 40
"""Maximum number of files of a folder that are named."""


def protect(outputs: Iterable[Path], protected: Iterable[str]) -> None:
    """Exit if an output would replace an input."""
    inputs = {os.path.realpath(path): path for path in protected if path != "-"}
    for path in outputs:
        target = os.path.realpath(path)
        if path != Path("-") and target in inputs:
            fail(not_written(str(path), f"it is `{inputs[target]}`, which is an input"))


def coloured(lines: Iterable[Piece]) -> str:
    """Lines, each in its colour if standard output is a terminal with colours."""
    return painted((line,) for line in lines)


def painted(lines: Iterable[Sequence[Piece]]) -> str:
    """Lines with several colours each; symbols that standard output cannot write become letters."""
    from fretc.terminal.screen import screen

    colours, signs = _has_colours(sys.stdout), screen().signs
    return "".join(
        f"{''.join(_styled(signs(text), colour if colours else None) for text, colour in line)}\n"
        for line in lines
    )


def _styled(text: str, colour: str | None) -> str:
    return text if colour is None else click.style(text, fg=colour)


def not_written(path: str, why: str) -> Diagnostic:
    """F905: a file cannot be written."""
    return diagnostic("output_not_written", path=path, why=why)
