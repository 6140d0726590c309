"""A run as columns of atoms, and its results by definition, monitor and explanation."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import field, replace
from functools import partial
from itertools import groupby
from typing import TypeVar

from compiler.explanation.reasons import why
from compiler.formalization import reference
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import boolean
from compiler.formalization.predicates import Past
from compiler.formalization.reference import Letter as Parts
from compiler.logic import formula as f
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.evaluation import evaluate
from fretc.analysis.arena.alphabet import Alphabet, Tick, Value
from fretc.testing.search import Letter
from fretc.testing.suite import Repeat
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from monitors.kernel import Column, Monitor
from monitors.kernel.columns import truths
from monitors.kernel.verdicts import PENDING, Truth, Verdict

Row = TypeVar("Row")


@dataclass(frozen=True)
class RunColumns:
    """A run, stored as columns."""

    rows: tuple[Repeat, ...]
    columns: Mapping[str, int]
    """Each atom over time, bit i for tick i."""
    ticks: int
    unknown: Mapping[str, int] = field(default_factory=dict)
    """Ticks at which atoms are unknown, whatever their columns contain."""


@dataclass(frozen=True, slots=True)
class Naming:
    """Names in the rows of a run."""

    atoms: Sequence[str]
    """Atoms with a column."""
    shown: Collection[str]
    """Atoms shown in rows. Comparisons are not shown; the numbers that decide them are."""
    signals: Mapping[str, Collection[str]]
    """Propositions of the bindings that each atom reads."""
    pinned: Mapping[str, Collection[f.Formula]]
    """Signal → formulas that fix its number, and that propositions agree with it."""

    def numbers(self, values: Tick, true: Collection[str]) -> dict[str, Value | None]:
        """Numbers of a valuation, without those that decide no proposition.

        Args:
            values: values of the valuation, including atoms that are independent of numbers.
            true: atoms that are true in it.
        """
        known = {name: int(name in true) for name in self.atoms}
        loose = {signal for name in values for signal in self.signals.get(name, ())}
        return {
            name: value
            for name, value in values.items()
            if name not in self.atoms
            and (
                name not in loose
                or any(evaluate(each, known, 1) for each in self.pinned.get(name, ()))
            )
        }


def word(letters: Sequence[Letter], alphabet: Alphabet, naming: Naming) -> RunColumns:
    """The run of some valuations."""
    functions = {name: alphabet.atom(name) for name in naming.atoms}
    columns = dict.fromkeys(functions, 0)
    rows: list[Repeat] = []
    ticks = 0
    for letter, equal in groupby(letters):
        count = sum(1 for _ in equal)
        known = bdd.point(letter)
        true = {name for name, function in functions.items() if _holds(function, known)}
        for name in true:
            columns[name] |= ((1 << count) - 1) << ticks
        values = naming.numbers(alphabet.values(letter), true)
        values |= {name: name in true for name in naming.shown}
        rows.append(Repeat(count, {name: values[name] for name in sorted(values)}))
        ticks += count
    return RunColumns(tuple(rows), columns, ticks)


def _holds(function: Function, letter: Function) -> bool:
    return bool(bdd.at(function, letter) == bdd.true())


def blotted(word: RunColumns, tick: int, names: Collection[str]) -> RunColumns:
    """The run with some values unknown at one tick, which has a row of its own."""
    rows: list[Repeat] = []
    start = 0
    for row in word.rows:
        if start == tick:
            values = {name: None if name in names else v for name, v in row.values.items()}
            row = Repeat(row.count, values)
        rows.append(row)
        start += row.count
    unknown = {name: 1 << tick for name in word.columns if name in names}
    return replace(word, rows=tuple(rows), unknown=unknown)


# By the signals of monitors ---------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class RunSignals:
    """Signals of a sentence for a run, tick by tick."""

    violation: int
    """The sentence is violated at this tick or before."""
    accepted: int
    """FRET's verdict if the run ended here."""


def judged(requirement: FormalizedRequirement, word: RunColumns) -> RunSignals:
    """Signals by the formulas of the monitor, as columns."""
    every = (1 << word.ticks) - 1
    first = evaluate(requirement.watch.violation, word.columns, word.ticks)
    violation = every & -(first & -first) if first else 0
    ended = evaluate(requirement.watch.violated_if_ended, word.columns, word.ticks)
    return RunSignals(violation, every & ~(violation | ended))


def is_killed(own: RunSignals, mutant: RunSignals, ticks: int) -> bool:
    """Whether a test with the run distinguishes a mutant from the requirement.

    Either they disagree on the whole run, or one is violated at a tick where the other accepts.
    """
    apart = (own.accepted ^ mutant.accepted) & (own.violation ^ mutant.violation)
    first = (own.violation | mutant.violation) & -(own.violation | mutant.violation)
    return bool((own.accepted ^ mutant.accepted) >> (ticks - 1) or apart & first)


# By the definition ------------------------------------------------------------------------------


def letters(requirement: FormalizedRequirement, word: RunColumns) -> tuple[Parts, ...]:
    """Mode, condition, response and stop condition of a sentence at each tick of a run."""
    sentence = requirement.sentence
    scope, condition, stop = sentence.scope, sentence.condition, s.stop(sentence.timing)
    mode = boolean(scope.mode, Past().alone()) if scope else f.TRUE
    read = partial(boolean, expand=Past().inside(scope.kind if scope else None, mode))
    parts = (
        mode if scope else f.FALSE,
        read(condition.expression) if condition else f.FALSE,
        read(sentence.response),
        read(stop) if stop else f.FALSE,
    )
    columns = (evaluate(part, word.columns, word.ticks) for part in parts)
    m, p, q, stopped = (map(bool, truths(Column(column, 0), word.ticks)) for column in columns)
    return tuple(zip(m, p, q, stopped, strict=True))


@dataclass(frozen=True, slots=True)
class Expected:
    """Expected result of a run."""

    finite: bool | None
    verdict: Verdict
    decided: int | None
    first_violation: int | None
    because: str


def expected(requirement: FormalizedRequirement, monitor: Monitor, word: RunColumns) -> Expected:
    """The verdict of a run with known values; definition, monitor and explanation must agree.

    Args:
        requirement: the sentence.
        monitor: emitted monitor of only this requirement.
        word: a run of all its atoms.
    """
    parts = letters(requirement, word)
    broken, finite = defined(requirement, parts)
    because = why(requirement, parts, ends=True, satisfied=finite)
    found = _monitored(monitor, word, because)
    assert found.finite is finite, (requirement.id, word)
    sooner = found.decided is not None and broken is not None and found.decided <= broken
    assert broken is None or sooner, (requirement.id, word)
    return found


def undecided(
    requirement: FormalizedRequirement, monitor: Monitor, word: RunColumns, atom: str
) -> Expected:
    """The verdict of a run with an atom unknown at one tick; None unless both values differ."""
    at, own = word.unknown[atom], word.columns[atom]
    finite: dict[bool, bool] = {}
    for value, column in {True: own | at, False: own & ~at}.items():
        known = replace(word, columns={**word.columns, atom: column})
        finite[value] = defined(requirement, letters(requirement, known))[1]
    assert finite[True] is not finite[False], (requirement.id, word)
    says = {True: "kept", False: "broken"}
    shown = requirement.wordings.get(atom, atom)
    because = (
        f"`{shown}` is unknown at tick {at.bit_length() - 1}: {requirement.id} is "
        f"{says[finite[True]]} if "
        f"it is true there, and {says[finite[False]]} if it is false"
    )
    found = _monitored(monitor, word, because)
    assert found.finite is None, (requirement.id, word)
    return found


def _monitored(monitor: Monitor, word: RunColumns, because: str) -> Expected:
    rows = (_row(monitor, word, tick) for tick in range(word.ticks))
    return outcome(monitor, monitor.advance, rows, because)


def outcome(
    monitor: Monitor, step: Callable[[Sequence[Row]], None], rows: Iterable[Row], because: str = ""
) -> Expected:
    """Result of a monitor of one requirement for rows, stepped from the first tick."""
    decided = None
    monitor.reset()
    for tick, row in enumerate(rows):
        step([row])
        if decided is None and monitor.verdicts()[0] != PENDING:
            decided = tick
    (status,) = monitor.statuses()
    verdict = Verdict(str(status.verdict))
    return Expected(status.finite, verdict, decided, status.first_violation, because)


def _row(monitor: Monitor, word: RunColumns, tick: int) -> tuple[Truth, ...]:
    columns = (
        Column(word.columns[name] & ~unknown, unknown)
        for name in monitor.PROPOSITIONS
        for unknown in [word.unknown.get(name, 0)]
    )
    return tuple(column.at(tick) for column in columns)


def defined(requirement: FormalizedRequirement, parts: Sequence[Parts]) -> tuple[int | None, bool]:
    """Result of the reference automaton: the tick of the violation, and FRET's verdict."""
    template = reference.template(requirement.sentence, requirement.ticks or 0)
    state = reference.initial(template)
    for tick, letter in enumerate(parts):
        after = reference.step(template, state, *letter)
        if after is None:
            return tick, False
        state = after
    return None, reference.accepts(template, state)
