"""The command line of a generated monitor."""

import argparse
import io
import json
import os
import sys
import typing
from collections.abc import Sequence
from typing import TextIO

from monitors.kernel.columns import Piece, columns_of
from monitors.kernel.outcomes import Outcome, evaluate, stepped
from monitors.kernel.stepping import Monitor
from monitors.kernel.tables import InputError, read_pieces, visible
from monitors.kernel.verdicts import (
    EXIT_STATUS,
    INCONCLUSIVE,
    VIOLATED,
    Verdict,
)

Read = typing.Callable[[TextIO, str, argparse.Namespace], typing.Iterable[Piece]]
"""Gives the truth of the propositions, from a table, its source and the options."""


def main(monitor: "type[Monitor]", arguments: "Sequence[str] | None" = None) -> int:
    """Run the monitor over tables of propositions and print the verdicts.

    Returns:
        As `judge`.
    """
    names = tuple(monitor.PROPOSITIONS)
    return judge(
        monitor,
        _parser(monitor),
        lambda text, source, options: read_pieces(text, names, source),
        arguments,
    )


def judge(
    monitor: "type[Monitor]",
    parser: argparse.ArgumentParser,
    read: Read,
    arguments: "Sequence[str] | None",
) -> int:
    """Run the monitor over the tables that the arguments name, and print the verdicts.

    Returns:
        0 all satisfied, 1 a violation, 2 bad use or input, 3 something is not shown, 130 stopped by
        Ctrl-C, 141 nobody reads the output any more.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        options = parser.parse_args(arguments)
        statuses = [_report(monitor(), path, options, read) for path in options.trace]
        if sys.stdout is None:
            raise InputError("standard output is closed")
        sys.stdout.flush()
        return max(statuses, key=(0, 3, 1, 2).index)
    except InputError as error:
        _complain(str(error))
    except OSError as error:  # standard output is full, or its reader has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            return _CLOSED_PIPE
        _complain(f"standard output cannot be written: {error.strerror}")
    except KeyboardInterrupt:
        return 130
    except _FAULTS as error:  # status 1 would say that a requirement is violated
        _complain(f"the monitor stopped: {type(error).__name__}: {error}")
    return 2


_CLOSED_PIPE = 141
"""The exit status after SIGPIPE, as a shell reports it."""
_FAULTS = (
    ArithmeticError,
    AttributeError,
    LookupError,
    MemoryError,
    RuntimeError,
    TypeError,
    ValueError,
)


def _complain(text: str) -> None:
    if sys.stderr is not None:
        print(visible(text), file=sys.stderr)


def _parser(monitor: "type[Monitor]") -> argparse.ArgumentParser:
    sentences = "\n".join(f"  {r.id}: {r.sentence}" for r in monitor.REQUIREMENTS)
    parser = argparse.ArgumentParser(
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_literal(f"Monitor of\n{sentences}"),
        epilog=_literal(
            f"columns: {', '.join(monitor.PROPOSITIONS)}\n"
            "exit status: 0 satisfied, 1 violated, 2 bad use or input, 3 not shown"
        ),
    )
    parser.add_argument(
        "trace",
        nargs="+",
        help="CSV with a header, or JSON lines; one row a tick; `-` is standard input",
    )
    parser.add_argument("--format", choices=("text", "json"), default="text")
    parser.add_argument(
        "--end",
        choices=(INCONCLUSIVE.value, VIOLATED.value),
        default=INCONCLUSIVE.value,
        help="what a demand is that is open at the end of the trace",
    )
    parser.add_argument(
        "--engine",
        choices=("columns", "online"),
        default="columns",
        help="whole traces at once, or step by step: the outcome is the same",
    )
    return parser


def _literal(text: str) -> str:
    """The text as argparse shows it unchanged: it formats only where `%(prog)` comes."""
    return text.replace("%", "%%") if "%(prog)" in text else text


def _report(monitor: Monitor, path: str, options: argparse.Namespace, read: Read) -> int:
    source = "<stdin>" if path == "-" else path
    names = tuple(monitor.PROPOSITIONS)
    with _opened(path) as text:
        try:
            ticks, columns = columns_of(read(text, source, options), len(names))
        except UnicodeDecodeError:
            raise InputError(f"{source}: the trace is not UTF-8 text") from None
        except OSError as error:
            raise InputError(f"{source}: {error.strerror or error}") from None
    run = stepped if options.engine == "online" else evaluate
    end = Verdict(options.end)
    outcomes = run(monitor, dict(zip(names, columns)), ticks, end)
    for outcome in outcomes:
        if options.format == "json":
            print(json.dumps(outcome.as_json()))
        else:
            print(visible(f"{source}: {outcome.requirement}: {_sentence(outcome)}"))
    return max((EXIT_STATUS[outcome.verdict] for outcome in outcomes), key=(0, 3, 1).index)


def _opened(path: str) -> TextIO:
    try:
        if path == "-":
            if sys.stdin is None:
                raise InputError("standard input is closed")
            return open(sys.stdin.fileno(), encoding="utf-8", newline="", closefd=False)
        return open(path, encoding="utf-8", newline="")
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None


def _sentence(outcome: Outcome) -> str:
    return f"{outcome.verdict} ({_details(outcome)})"


def _details(outcome: Outcome) -> str:
    count = f"{len(outcome.triggers)} trigger{'' if len(outcome.triggers) == 1 else 's'}"
    if outcome.verdict is Verdict.SATISFIED:
        return count
    if outcome.verdict is Verdict.VIOLATED:
        return f"ticks {_in_words(outcome.violations)}"
    if outcome.verdict is Verdict.INCONCLUSIVE:
        return f"{count}, {len(outcome.open)} open at the end"
    if outcome.verdict is Verdict.VACUOUS:
        return "never triggered"
    unknown = outcome.unknown
    return f"unknown at ticks {_in_words(unknown)}" if unknown else _why_no_data(outcome)


def _in_words(runs: "Sequence[tuple[int, int]]") -> str:
    return ", ".join(f"{first}..{last}" for first, last in runs)


def _why_no_data(outcome: Outcome) -> str:
    """The reason why nothing is shown, although no obligation can have been violated."""
    if not outcome.ticks:
        return "the trace has no tick"
    return "unknown whether there was a trigger, or whether a demand is open at the end"
