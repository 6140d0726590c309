"""The command line of a generated monitor that is stepped by variables."""

import argparse
from collections.abc import Iterable, Sequence
from typing import TextIO

from monitors.kernel.columns import Piece, pieces_of
from monitors.kernel.command import _literal, _parser, judge
from monitors.kernel.tables import read_pieces
from monitors.kernel.variable_tables import read_variables
from monitors.kernel.variables import VariableMonitor, rows_of_truth


def main_by_variables(
    monitor: "type[VariableMonitor]", arguments: "Sequence[str] | None" = None
) -> int:
    """Run the monitor over tables of variables and print the verdicts.

    Returns:
        As `judge`.
    """

    def read(text: TextIO, source: str, options: argparse.Namespace) -> "Iterable[Piece]":
        if options.propositions:
            return read_pieces(text, tuple(monitor.PROPOSITIONS), source)
        rows = read_variables(text, monitor.VARIABLES, source)
        return pieces_of(rows_of_truth(monitor, rows))

    return judge(monitor, _parser_by_variables(monitor), read, arguments)


def _parser_by_variables(monitor: "type[VariableMonitor]") -> argparse.ArgumentParser:
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
