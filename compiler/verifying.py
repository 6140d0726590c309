"""Prove that the text of a generated monitor means what its sentence means.

The text is executed, stepped over every letter and compared with the counter automaton of the
sentence (`compiler.proving`). Its steps must depend on nothing but its cells, propositions and
constants: that is read off its tree first, so a step that looks at the number of the tick cannot
hide. Its column program is then compared with its steps on drawn traces.
"""

from __future__ import annotations

import ast
import random
from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from compiler.letters import Valuation, atoms_of
from compiler.proving import Judgement, NotChecked, Proved, Refuted, prove
from compiler.rule import Rule
from compiler.runtime import kernel
from monitors.kernel import Column, Monitor, evaluate, stepped
from monitors.kernel.columns import column
from monitors.loading import load

DRAWN = 20
"""Traces on which the column program is compared."""
_LONGEST = 2_000


class NotAMonitorError(Exception):
    """The text cannot be executed as a generated monitor; it says why."""


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A trace on which the column program and the steps differ."""

    word: tuple[Valuation, ...]


@dataclass(frozen=True, slots=True)
class Verified:
    """What could be shown of one requirement's monitor."""

    requirement: str
    atoms: tuple[str, ...]
    """The propositions, in the order of the values of a word."""
    result: Proved | Refuted | NotChecked | Disagreement
    compared: int = 0
    """Ticks of drawn traces on which the column program agreed with the steps."""


def verified(rule: Rule, text: str, limit: int = 10**6) -> Verified:
    """Compare the text of a monitor with its rule.

    Args:
        rule: one that a monitor can be made of, on its own clock.
        text: what says to be its monitor, maybe beside others.
        limit: the most states that are looked at.

    Raises:
        NotAMonitorError: the text is no generated monitor.
    """
    monitor = _loaded(f"{rule.id}_monitor", text)
    strange = _strange(text, monitor)
    if strange is not None:
        return Verified(rule.id, (), NotChecked(strange))
    places = [i for i, known in enumerate(monitor.REQUIREMENTS) if known.id == rule.id]
    if not places:
        return Verified(rule.id, (), NotChecked("the monitor is of other requirements"))
    atoms = tuple(dict.fromkeys((*atoms_of(rule.sentence), *monitor.PROPOSITIONS)))
    machine = _Machine(monitor, places[0], atoms)
    result = prove(machine, rule.sentence, rule.ticks or 0, atoms, limit)
    if not isinstance(result, Proved):
        return Verified(rule.id, atoms, result)
    compared, word = _columns_compared(monitor, rule.ticks or 0)
    found = result if word is None else Disagreement(word)
    return Verified(rule.id, atoms, found, compared)


def _loaded(name: str, text: str) -> Monitor:
    """Whatever the text does when it is executed is told as its mistake."""
    try:
        return load(name, text)
    except (Exception, SystemExit) as error:
        raise NotAMonitorError(f"{type(error).__name__}: {error}") from None


# Steps ----------------------------------------------------------------------------------------


class _Machine:
    """A monitor whose propositions are all known, as `prove` steps it."""

    def __init__(self, monitor: Monitor, place: int, atoms: Sequence[str]) -> None:
        monitor.reset()
        rail: Any = monitor.must
        self._rail, self._place = rail, place
        self._alone = len(monitor.REQUIREMENTS) == 1
        self._step: Any = monitor.step  # type: ignore[attr-defined]
        self._parameters = [(p, atoms.index(name)) for name, p in monitor.PROPOSITIONS.items()]
        # The text has a class of its own for windows.
        self._windows = [n for n in rail.CELLS if hasattr(getattr(rail, n), "restore")]
        self._cells = [name for name in rail.CELLS if name not in self._windows]
        self._fates = [n for n in rail.__slots__ if n.endswith(("_broken", "_doomed"))]

    def save(self) -> Hashable:
        """All cells: a step reads nothing else."""
        rail = self._rail
        cells = tuple([getattr(rail, name) for name in self._cells])
        return cells, tuple([getattr(rail, name).state() for name in self._windows])

    def load(self, state: Any) -> None:
        """Go back to a state; nothing was violated there."""
        rail, (cells, windows) = self._rail, state
        for name, value in zip(self._cells, cells, strict=True):
            setattr(rail, name, value)
        for name, value in zip(self._windows, windows, strict=True):
            getattr(rail, name).restore(value)
        for name in self._fates:
            setattr(rail, name, -1)

    def step(self, letter: Valuation) -> Judgement:
        """The verdict as the text's own step tells it, and FRET's finite verdict."""
        told = self._step(**{p: letter[i] for p, i in self._parameters})
        rail = self._rail
        signals, marks = rail.signals()[self._place], rail.marks()[self._place]
        verdict = told if self._alone else told[self._place]
        return str(verdict), marks.broken < 0 and not signals.fails


# The text -------------------------------------------------------------------------------------


def _strange(text: str, monitor: Monitor) -> str | None:
    """Why the steps of the text may depend on more than cells and propositions."""
    if kernel().text not in text:
        return "the run time in it is not the one of this version of fretc"
    own = text.rpartition(kernel().text)[2]
    classes = [node for node in ast.parse(own).body if isinstance(node, ast.ClassDef)]
    found = [f for c in classes for f in c.body if isinstance(f, ast.FunctionDef)]
    steps = [function for function in found if function.name == "advance"]
    if len(classes) != 2 or len(steps) != 1:
        return "it is not laid out as fretc writes it"
    history = {*monitor.must.__slots__} - {*monitor.must.CELLS, "doubt"}
    wrong = next(_History(frozenset(history)).misused(steps[0]), None)
    return f"what it does at a tick depends on `{wrong}`" if wrong else None


@dataclass(frozen=True, slots=True)
class _History:
    """What a rail remembers beside its cells; no cell may depend on it."""

    names: frozenset[str]

    def misused(self, function: ast.FunctionDef) -> Iterator[str]:
        """What reads the history and does more than to remember."""
        for node in ast.walk(function):
            match node:
                case ast.If(test) | ast.While(test):
                    wrong = self._read(test) and not self._remembers(node)
                case ast.Assign() | ast.AugAssign() | ast.AnnAssign():
                    wrong = self._read(node.value) and not self._remembers(node)
                case ast.For():
                    wrong = self._read(node.iter)
                case ast.NamedExpr() | ast.Call(ast.Name("getattr" | "setattr" | "vars")):
                    wrong = True
                case _:
                    wrong = False
            if wrong:
                yield ast.unparse(node).splitlines()[0]

    def _read(self, node: ast.AST | None) -> bool:
        return node is not None and any(self._is_part(part) for part in ast.walk(node))

    def _is_part(self, node: ast.AST) -> bool:
        name = node.id if isinstance(node, ast.Name) else getattr(node, "attr", "")
        return name in self.names

    def _remembers(self, statement: ast.AST) -> bool:
        """It only changes the history, or ends a call without rows."""
        match statement:
            case ast.Assign(targets):
                return all(map(self._is_part, targets))
            case ast.AugAssign(target):
                return self._is_part(target)
            case ast.If(_, body, orelse):
                return all(map(self._remembers, (*body, *orelse)))
            case ast.Return(ast.Constant(True)):
                return True
            case _:
                return False


# Columns --------------------------------------------------------------------------------------


def _columns_compared(monitor: Monitor, bound: int) -> tuple[int, tuple[Valuation, ...] | None]:
    """The ticks on which both programs agree; and a trace on which they do not."""
    choose = random.Random(bound)
    length = min(4 * bound + 50, _LONGEST)
    for _ in range(DRAWN):
        drawn = {name: _drawn(choose, length) for name in monitor.PROPOSITIONS}
        if evaluate(monitor, drawn, length) != stepped(monitor, drawn, length):
            return 0, tuple(_rows(drawn, length))
    return DRAWN * length, None


def _drawn(choose: random.Random, length: int) -> Column:
    """A column with odds of its own: rare and frequent events both matter."""
    odds = choose.choice((0.02, 0.2, 0.5, 0.95))
    return column(bytes(choose.random() < odds for _ in range(length)))


def _rows(columns: Mapping[str, Column], length: int) -> Iterator[Valuation]:
    return (
        tuple(bool(column.true >> tick & 1) for column in columns.values())
        for tick in range(length)
    )
