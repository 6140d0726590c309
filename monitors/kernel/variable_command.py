"""The command line of a generated monitor that is stepped by variables."""

import argparse
import io
import json
import os
import sys
from collections.abc import Sequence

from monitors.kernel.columns import columns_of
from monitors.kernel.command import _FAULTS, _complain, _literal, _opened, _parser, _sentence
from monitors.kernel.outcomes import evaluate, stepped
from monitors.kernel.tables import InputError, read_rows, visible
from monitors.kernel.variable_tables import read_variables
from monitors.kernel.variables import VariableMonitor, rows_of_truth
from monitors.kernel.verdicts import EXIT_STATUS


def main_by_variables(
    monitor: type[VariableMonitor], arguments: Sequence[str] | None = None
) -> int:
    """Run the monitor over tables of variables and print the verdicts.

    Returns:
        0 all satisfied, 1 a violation, 2 bad use or input, 3 something is not shown, 130 stopped by
        Ctrl-C, 141 nobody reads the output any more.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        options = _parser_by_variables(monitor).parse_args(arguments)
        statuses = [_report_by_variables(monitor, path, options) for path in options.trace]
        if sys.stdout is None:
            raise InputError("standard output is closed")
        sys.stdout.flush()
        return max(statuses, key=(0, 3, 1, 2).index)
    except InputError as error:
        _complain(str(error))
    except OSError as error:  # standard output is full, or its reader has gone
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if isinstance(error, BrokenPipeError):
            return 141  # what a shell makes of SIGPIPE
        _complain(f"standard output cannot be written: {error.strerror}")
    except KeyboardInterrupt:
        return 130
    except _FAULTS as error:  # status 1 would say that a requirement is violated
        _complain(f"the monitor stopped: {type(error).__name__}: {error}")
    return 2


def _parser_by_variables(monitor: type[VariableMonitor]) -> argparse.ArgumentParser:
    parser = _parser(monitor)
    parser.epilog = _literal(
        f"columns: {', '.join(monitor.VARIABLES)}\n"
        f"with --propositions: {', '.join(monitor.PROPOSITIONS)}\n"
        "exit status: 0 satisfied, 1 violated, 2 bad use or input, 3 not shown"
    )
    parser.add_argument(
        "--propositions",
        action="store_true",
        help="the columns are the truth of comparisons, as in the traces of `fretc verify`",
    )
    return parser


def _report_by_variables(
    monitor: type[VariableMonitor], path: str, options: argparse.Namespace
) -> int:
    source = "<stdin>" if path == "-" else path
    names = tuple(monitor.PROPOSITIONS)
    with _opened(path) as text:
        try:
            rows = (
                read_rows(text, names, source)
                if options.propositions
                else rows_of_truth(monitor, read_variables(text, monitor.VARIABLES, source))
            )
            ticks, columns = columns_of(rows, len(names))
        except UnicodeDecodeError:
            raise InputError(f"{source}: the trace is not UTF-8 text") from None
        except OSError as error:
            raise InputError(f"{source}: {error.strerror or error}") from None
    run = stepped if options.engine == "online" else evaluate
    outcomes = run(monitor(), dict(zip(names, columns, strict=True)), ticks, options.end)
    for outcome in outcomes:
        if options.format == "json":
            print(json.dumps(outcome.as_json()))
        else:
            print(visible(f"{source}: {outcome.requirement}: {_sentence(outcome)}"))
    return max((EXIT_STATUS[outcome.verdict] for outcome in outcomes), key=(0, 3, 1).index)
