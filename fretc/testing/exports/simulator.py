"""Traces for LTLSIM, the simulator of FRET: all as JSON, and each as CSV.

Sources: FRET, `LTLSimDialog.js` (`handleImportTraces`: a list of traces, each linked to a
requirement) and `LTLSimController.js` (`setTrace`: values tick by tick in one list, kinds and
ranges beside them; `addTrace`: CSV without quotes). Comparisons are not columns, because LTLSIM
computes them from the numbers.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.printing import is_compound
from fretc.testing.exports.tables import Row, columns, csv_text
from fretc.testing.suite import Polarity, Test

LEAST = 4
"""Minimum number of ticks of a trace, according to LTLSIM."""
Numbers = tuple[float, ...]


def refusal(requirement: FormalizedRequirement, test: Test) -> str | None:
    """Why LTLSIM cannot show a test; None: it can."""
    if test.polarity is Polarity.UNKNOWN:
        return "a value is unknown"
    names = _names(test)
    if any(not re.fullmatch(r"\w+", name, re.ASCII) for name in names):
        return "a name is no word"
    missing = {*requirement.variables} - {*names}
    return f"no number is known for `{min(missing)}`" if missing else None


def traces(
    requirements: Mapping[str, FormalizedRequirement], tests: Sequence[Test]
) -> list[dict[str, Any]]:
    """JSON for LTLSIM.

    Args:
        requirements: requirements by id.
        tests: tests that are not refused.
    """
    return [_trace(requirements[test.requirement], test) for test in tests]


def _trace(requirement: FormalizedRequirement, test: Test) -> dict[str, Any]:
    names, rows = _numbers(requirement, test)
    kinds = [isinstance(test.rows[0].values.get(name), bool) for name in names]
    every = [*zip(*rows, strict=True)]
    return {
        "traceID": test.name,
        "traceDescription": _description(test),
        "traceLinkedRequirementIDs": [re.sub(r"[ .+-]", "_", test.requirement)],
        "theTrace": {
            "traceLength": len(rows),
            "keys": names,
            "type": ["category" if is_truth else "number" for is_truth in kinds],
            "canChange": [True] * len(names),
            "minval": [min(0, *column) for column in every],
            "maxval": [max(1, *column) for column in every],
            "values": [value for row in rows for value in row],
        },
        "saveToReqID": "*",
        "saveToComponent": "*",
        "saveToProject": requirement.entry.fret.get("project", "") or "*",
    }


def _description(test: Test) -> str:
    held = "true" if test.finite else "false"
    shown = f"{test.words}. The formulas are {held} up to tick {test.ticks - 1}: {test.because}"
    if test.ticks < LEAST:
        last = test.ticks - 1
        return f"{shown}. It ends at tick {last}, which is repeated here: look at the past formula"
    return shown


def table(requirement: FormalizedRequirement, test: Test) -> str:
    """CSV for LTLSIM, which must have a trace of the same length before the import."""
    names, rows = _numbers(requirement, test)
    ends = [0] * (len(rows) - 1) + [1]
    return csv_text(("LAST", *names), ((end, *row) for end, row in zip(ends, rows, strict=True)))


def _names(test: Test) -> tuple[str, ...]:
    """Names with a known value at each tick that are not comparisons."""
    first, *others = (row.values for row in test.rows)
    known = (name for name in first if all(name in values for values in others))
    return tuple(name for name in known if not is_compound(name))


def _numbers(requirement: FormalizedRequirement, test: Test) -> tuple[list[str], list[Numbers]]:
    """Names and the numbers of each tick: LTLSIM has no enumerations and no truth values.

    Enumeration values are represented by their position in the signal's list.
    """
    names = _names(test)
    signals = requirement.declarations.signals if requirement.declarations else {}
    used = [signals[name].values for name in names if name in signals and signals[name].values]
    words = {word: float(index) for values in used for index, word in enumerate(values)}
    constants = [word for word in words if word not in names]
    tail = tuple(words[word] for word in constants)
    rows = _long_enough(columns(test, names))
    return [*names, *constants], [(*_as_numbers(row, words), *tail) for row in rows]


def _long_enough(rows: Sequence[Row]) -> list[Row]:
    """Rows with the last one repeated up to the minimum length."""
    each = [(1, values) for count, values in rows for _ in range(count)]
    return each + each[-1:] * (LEAST - len(each))


def _as_numbers(row: Row, words: Mapping[str, float]) -> Numbers:
    def number(value: object) -> float:
        if isinstance(value, str):
            return words[value]
        assert isinstance(value, bool | int | float)
        return value + 0

    return tuple(map(number, row[1]))
