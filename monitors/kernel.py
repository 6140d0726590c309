"""The run time of every generated monitor: the text below is copied into each of them.

Standard library only. A truth value is True, False or None: unknown. Inside a monitor each value
runs on two rails: `must` (true whatever the unknowns are) and `may` (true for some of them).
Every operator of the past is monotone, so each rail is stepped by itself.
Source: Kleene, Introduction to Metamathematics, 1952, section 64 (strong three-valued logic).
"""

from __future__ import annotations

# kernel begins here
import argparse
import csv
import io
import itertools
import json
import os
import re
import sys
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, Protocol, TextIO

Truth = bool | None
"""True, False, or None: unknown."""

SATISFIED, VIOLATED = "satisfied", "violated"
INCONCLUSIVE, VACUOUS, NO_DATA = "inconclusive", "vacuous", "no data"
EXIT_STATUS = {SATISFIED: 0, VIOLATED: 1, INCONCLUSIVE: 3, VACUOUS: 3, NO_DATA: 3}


class Verdict(NamedTuple):
    """What is known after a tick, as if the trace ended there."""

    tick: int
    verdict: str
    """satisfied, violated, inconclusive, vacuous or no data."""
    finite: Truth
    """FRET's verdict on the finite trace up to here."""
    trigger: Truth
    """Whether a demand began at this tick."""
    breach: Truth
    """Whether a demand was broken at this tick."""
    owed: Truth
    """Whether a demand is open after this tick."""
    answer: Truth
    """Whether the response came at this tick."""


def rails(value: Truth) -> tuple[bool, bool]:
    """A truth value as (must, may); anything else is a mistake of the caller."""
    if value is None:
        return False, True
    if value is True or value is False:
        return value, value
    raise TypeError(f"a truth value is True, False or None (unknown), not {value!r}")


def truth(must: bool, may: bool) -> Truth:
    """The two rails as one truth value."""
    return must if must == may else None


class Window:
    """`left S[lo,hi] right` in ticks; memory: the runs of `right` inside of the window."""

    __slots__ = ("hi", "lo", "now", "runs")

    def __init__(self, lo: int, hi: int) -> None:
        self.lo, self.hi = lo, hi
        self.now = -1
        self.runs: deque[list[int]] = deque()

    def step(self, left: bool, right: bool) -> bool:
        """Whether right held `lo..hi` ticks ago, and left ever since."""
        self.now += 1
        if not left:
            self.runs.clear()
        if right:
            if self.runs and self.runs[-1][1] == self.now - 1:
                self.runs[-1][1] = self.now
            else:
                self.runs.append([self.now, self.now])
        while self.runs and self.runs[0][1] < self.now - self.hi:
            self.runs.popleft()
        return bool(self.runs) and self.runs[0][0] <= self.now - self.lo


class History:
    """What the ticks so far add up to."""

    __slots__ = ("breached_may", "breached_must", "tick", "triggered_may", "triggered_must")

    def __init__(self) -> None:
        self.tick = -1
        self.breached_must = self.breached_may = False
        self.triggered_must = self.triggered_may = False

    def note(
        self,
        trigger: tuple[bool, bool],
        breach: tuple[bool, bool],
        owed: tuple[bool, bool],
        fails: tuple[bool, bool],
        answer: tuple[bool, bool],
    ) -> Verdict:
        """Add one tick, each signal as (must, may)."""
        self.tick += 1
        self.triggered_must |= trigger[0]
        self.triggered_may |= trigger[1]
        self.breached_must |= breach[0]
        self.breached_may |= breach[1]
        lost = self.breached_must or fails[0]
        kept = not (self.breached_may or fails[1])
        return Verdict(
            self.tick,
            self._verdict(*owed),
            truth(not lost and kept, not lost),
            truth(*trigger),
            truth(*breach),
            truth(*owed),
            truth(*answer),
        )

    def _verdict(self, owed_must: bool, owed_may: bool) -> str:
        if self.breached_must:
            return VIOLATED
        if self.breached_may:
            return NO_DATA
        if owed_must:
            return INCONCLUSIVE
        if owed_may:
            return NO_DATA
        if self.triggered_must:
            return SATISFIED
        return NO_DATA if self.triggered_may else VACUOUS


class Monitor(Protocol):
    """What every generated monitor is."""

    REQUIREMENT: ClassVar[str]
    SENTENCE: ClassVar[str]
    HORIZON: ClassVar[int | None]
    """Ticks from a trigger to its deadline; None where there is no deadline."""
    PROPOSITIONS: ClassVar[Mapping[str, str]]
    """The propositions of the sentence, each with its parameter of `step`."""

    def reset(self) -> None:
        """Forget everything: the next step is tick 0."""

    @property
    def step(self) -> Callable[..., Verdict]:
        """One tick: a keyword argument for each proposition."""


@dataclass(frozen=True)
class Outcome:
    """One requirement over one whole trace; ticks count from 0, intervals include both ends."""

    requirement: str
    ticks: int
    verdict: str
    finite: Truth
    first_violation: int | None
    violations: tuple[tuple[int, int], ...]
    """Runs of ticks at which a demand was broken, or was overdue and still unanswered."""
    unknown: tuple[tuple[int, int], ...]
    """Runs of ticks at which it cannot be known whether a demand was broken."""
    triggers: tuple[int, ...]
    answers: tuple[tuple[int, int], ...]
    """Trigger and first answer to it, where a demand waits for one and it came."""
    open: tuple[tuple[int, int | None], ...]
    """Trigger and deadline (None: there is none) of each demand that is open at the end."""

    def as_json(self) -> dict[str, Any]:
        """Plain values, in a fixed order of keys."""
        return {
            "requirement": self.requirement,
            "ticks": self.ticks,
            "verdict": self.verdict,
            "finite": self.finite,
            "first_violation": self.first_violation,
            "violations": [list(run) for run in self.violations],
            "unknown": [list(run) for run in self.unknown],
            "triggers": list(self.triggers),
            "answers": [list(pair) for pair in self.answers],
            "open": [{"trigger": t, "deadline": d} for t, d in self.open],
        }


def run(monitor: Monitor, rows: Iterable[Mapping[str, Truth]], end: str = INCONCLUSIVE) -> Outcome:
    """Step a monitor over a whole trace.

    Args:
        monitor: any monitor; it is reset first.
        rows: one mapping a tick, from the name of each proposition to its truth value.
        end: what a demand is that is open at the end: `inconclusive` or `violated`.

    Raises:
        KeyError: a row lacks a proposition.
        TypeError: a value is not True, False or None.
    """
    monitor.reset()
    names = tuple(monitor.PROPOSITIONS.items())
    steps: list[Verdict] = []
    answers: list[tuple[int, int]] = []
    waiting: list[int] = []
    for row in rows:
        step = monitor.step(**{parameter: row[name] for name, parameter in names})
        steps.append(step)
        if step.trigger:
            waiting.append(step.tick)
        if step.answer:
            answers.extend((trigger, step.tick) for trigger in waiting)
        if step.answer or step.owed is False:
            waiting.clear()
    return _outcome(monitor, steps, answers, waiting, end)


def _outcome(
    monitor: Monitor,
    steps: Sequence[Verdict],
    answers: Sequence[tuple[int, int]],
    waiting: Sequence[int],
    end: str,
) -> Outcome:
    last = len(steps) - 1
    deadlines = [(t, None if monitor.HORIZON is None else t + monitor.HORIZON) for t in waiting]
    violations = _runs(step.tick for step in steps if step.breach)
    verdict = steps[-1].verdict if steps else NO_DATA
    if end == VIOLATED and verdict == INCONCLUSIVE:
        verdict, violations = VIOLATED, ((last, last),)
    return Outcome(
        requirement=monitor.REQUIREMENT,
        ticks=len(steps),
        verdict=verdict,
        finite=steps[-1].finite if steps else None,
        first_violation=violations[0][0] if violations else None,
        violations=violations,
        unknown=_runs(step.tick for step in steps if step.breach is None),
        triggers=tuple(step.tick for step in steps if step.trigger),
        answers=tuple(answers),
        open=tuple((t, d) for t, d in deadlines if d is None or d > last),
    )


def _runs(ticks: Iterable[int]) -> tuple[tuple[int, int], ...]:
    """Maximal runs of consecutive ticks, each as (first, last)."""
    runs: list[list[int]] = []
    for tick in ticks:
        if runs and runs[-1][1] == tick - 1:
            runs[-1][1] = tick
        else:
            runs.append([tick, tick])
    return tuple((first, last) for first, last in runs)


# Tables of propositions ----------------------------------------------------------------------


class InputError(Exception):
    """A trace that cannot be read, with its place in words."""


_WORDS: dict[str, Truth] = {"": None, "0": False, "1": True, "false": False, "true": True}


def read_rows(text: Iterable[str], names: Sequence[str], source: str) -> Iterator[dict[str, Truth]]:
    """The rows of a table: CSV with a header, or JSON lines where the first line is an object.

    Values are 0, 1, true, false, or nothing (null in JSON): unknown. A column `tick` may count
    the rows; it must grow by one from row to row. Other columns are passed over.

    Raises:
        InputError: a column is missing, a value is no truth value, ticks jump.
    """
    lines = iter(text)
    first = next((line for line in lines if line.strip()), None)
    if first is None:
        raise InputError(f"{source}: the trace is empty")
    lines = itertools.chain([first.removeprefix("\ufeff")], lines)
    is_json = re.match(r'\s*\{\s*["}]', first.removeprefix("\ufeff")) is not None
    read = _json_rows if is_json else _csv_rows
    tick: int | None = None
    for place, row in read(lines, names, source):
        if "tick" in row and "tick" not in names:
            tick = _next_tick(row["tick"], tick, place)
        yield {name: _truth(row[name], name, place) for name in names}


def _csv_rows(
    lines: Iterable[str], names: Sequence[str], source: str
) -> Iterator[tuple[str, dict[str, Any]]]:
    table = csv.reader(lines, strict=True)
    try:
        header = [name.strip() for name in next(table)]
        _check_columns(header, names, f"{source}:1")
        for values in table:
            place = f"{source}:{table.line_num}"
            if not values and len(header) > 1:
                continue  # an empty line; in a table of one column it is an unknown value
            values = values or [""]
            if len(values) != len(header):
                raise InputError(f"{place}: {len(values)} values for {len(header)} columns")
            yield place, dict(zip(header, values, strict=True))
    except csv.Error as error:
        raise InputError(f"{source}:{table.line_num}: {error}") from None


def _json_rows(
    lines: Iterable[str], names: Sequence[str], source: str
) -> Iterator[tuple[str, dict[str, Any]]]:
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            row = json.loads(line, object_pairs_hook=_distinct)
        except (ValueError, RecursionError) as error:
            raise InputError(f"{source}:{number}: not JSON: {error}") from None
        if not isinstance(row, dict):
            raise InputError(f"{source}:{number}: a line must hold one object")
        _check_columns(row, names, f"{source}:{number}")
        yield f"{source}:{number}", row


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key comes twice")
    return found


def _check_columns(found: Iterable[str], names: Sequence[str], place: str) -> None:
    columns = list(found)
    for name in names:
        if name not in columns:
            raise InputError(
                f"{place}: there is no column `{name}`; there are {', '.join(columns) or 'none'}"
            )
        if columns.count(name) > 1:
            raise InputError(f"{place}: there are two columns `{name}`")


def _truth(value: Any, name: str, place: str) -> Truth:
    if value is None or isinstance(value, bool):
        return value
    word = str(value).strip().lower()
    if word not in _WORDS:
        raise InputError(
            f"{place}: column `{name}`: `{value}` is no truth value; "
            "write 0, 1, true, false, or nothing for unknown"
        )
    return _WORDS[word]


def _next_tick(value: Any, before: int | None, place: str) -> int:
    try:
        tick = int(str(value))
    except ValueError:
        raise InputError(f"{place}: column `tick`: `{value}` is no whole number") from None
    if before is not None and tick != before + 1:
        what = "goes back" if tick <= before else "leaves ticks out"
        raise InputError(f"{place}: column `tick` {what}: {before}, then {tick}")
    return tick


# Command line ----------------------------------------------------------------------------------


def main(monitors: Sequence[type[Monitor]], arguments: Sequence[str] | None = None) -> int:
    """Run the monitors over tables of propositions and print the verdicts.

    Returns:
        0 all satisfied, 1 a violation, 2 bad use or input, 3 something is not shown.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    options = _parser(monitors).parse_args(arguments)
    try:
        status = max(
            (_report(monitor(), path, options) for path in options.trace for monitor in monitors),
            key=(0, 3, 1, 2).index,
        )
        if sys.stdout is None:
            raise InputError("standard output is closed")
        sys.stdout.flush()
        return status
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    except OSError as error:  # standard output is full, or its reader has gone
        if not isinstance(error, BrokenPipeError):
            print(f"standard output cannot be written: {error.strerror}", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 2
    except KeyboardInterrupt:
        return 130


def _parser(monitors: Sequence[type[Monitor]]) -> argparse.ArgumentParser:
    sentences = "\n".join(f"  {monitor.REQUIREMENT}: {monitor.SENTENCE}" for monitor in monitors)
    names = dict.fromkeys(name for monitor in monitors for name in monitor.PROPOSITIONS)
    parser = argparse.ArgumentParser(
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_literal(f"Monitor of\n{sentences}"),
        epilog=_literal(
            f"columns: {', '.join(names)}\n"
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
        choices=(INCONCLUSIVE, VIOLATED),
        default=INCONCLUSIVE,
        help="what a demand is that is open at the end of the trace",
    )
    return parser


def _literal(text: str) -> str:
    """The text as argparse shows it unchanged: it formats only where `%(prog)` comes."""
    return text.replace("%", "%%") if "%(prog)" in text else text


def _report(monitor: Monitor, path: str, options: argparse.Namespace) -> int:
    source = "<stdin>" if path == "-" else path
    with _opened(path) as text:
        try:
            rows = read_rows(text, tuple(monitor.PROPOSITIONS), source)
            outcome = run(monitor, rows, options.end)
        except UnicodeDecodeError:
            raise InputError(f"{source}: the trace is not UTF-8 text") from None
    if options.format == "json":
        print(json.dumps(outcome.as_json()))
    else:
        print(f"{source}: {outcome.requirement}: {_sentence(outcome)}")
    return EXIT_STATUS[outcome.verdict]


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
    count = f"{len(outcome.triggers)} trigger{'' if len(outcome.triggers) == 1 else 's'}"
    details = {
        SATISFIED: count,
        VIOLATED: "ticks " + ", ".join(f"{a}..{b}" for a, b in outcome.violations),
        INCONCLUSIVE: f"{count}, {len(outcome.open)} open at the end",
        VACUOUS: "never triggered",
        NO_DATA: f"unknown at ticks {', '.join(f'{a}..{b}' for a, b in outcome.unknown) or '-'}",
    }
    return f"{outcome.verdict} ({details[outcome.verdict]})"
