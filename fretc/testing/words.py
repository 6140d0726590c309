"""A word as columns of atoms, and what the definition, a monitor and reasons say of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import groupby

from compiler.explanation.reasons import why
from compiler.formalization import reference
from compiler.formalization.formalized import Formalized
from compiler.formalization.obligation import boolean
from compiler.formalization.predicates import Past
from compiler.formalization.reference import Letter as Parts
from compiler.logic import decision_diagrams as bdd
from compiler.logic import formula as f
from compiler.logic.evaluation import evaluate
from fretc.analysis.arena.alphabet import Alphabet, Value
from fretc.testing.search import Letter
from fretc.testing.suite import Repeat
from fretish import syntax as s
from monitors.kernel import Column, Monitor
from monitors.kernel.columns import truths
from monitors.kernel.verdicts import PENDING, Verdict


@dataclass(frozen=True)
class Word:
    """A run, stored by stretches of equal ticks."""

    rows: tuple[Repeat, ...]
    columns: Mapping[str, int]
    """Each atom over time, bit i for tick i."""
    ticks: int


def word(letters: Sequence[Letter], alphabet: Alphabet, atoms: Iterable[str]) -> Word:
    """The word of some letters: the truth of atoms, and numbers that make comparisons so."""
    functions = {name: alphabet.atom(name) for name in atoms}
    columns = dict.fromkeys(functions, 0)
    rows: list[Repeat] = []
    ticks = 0
    for letter, equal in groupby(letters):
        count = sum(1 for _ in equal)
        known = bdd.point(letter)
        values: dict[str, Value | None] = dict(alphabet.values(letter))
        for name, function in functions.items():
            values[name] = bdd.at(function, known) == bdd.true()
            if values[name]:
                columns[name] |= ((1 << count) - 1) << ticks
        rows.append(Repeat(count, {name: values[name] for name in sorted(values)}))
        ticks += count
    return Word(tuple(rows), columns, ticks)


# By the signals of monitors ---------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Judged:
    """What the signals of a sentence say of a word, tick by tick."""

    breach: int
    """A demand is broken, at this tick or before."""
    accepted: int
    """FRET's verdict, were the word to end here."""


def judged(rule: Formalized, word: Word) -> Judged:
    """By the formulas of the monitor, as columns."""
    every = (1 << word.ticks) - 1
    first = evaluate(rule.watch.breach, word.columns, word.ticks)
    breach = every & -(first & -first) if first else 0
    fails = evaluate(rule.watch.fails, word.columns, word.ticks)
    return Judged(breach, every & ~(breach | fails))


def is_killed(own: Judged, mutant: Judged, ticks: int) -> bool:
    """Whether a test of the word tells a mutant from the requirement.

    Either they disagree on the whole word, or one is broken at a tick where the other accepts.
    """
    apart = (own.accepted ^ mutant.accepted) & (own.breach ^ mutant.breach)
    first = (own.breach | mutant.breach) & -(own.breach | mutant.breach)
    return bool((own.accepted ^ mutant.accepted) >> (ticks - 1) or apart & first)


# By the definition ------------------------------------------------------------------------------


def letters(rule: Formalized, word: Word) -> tuple[Parts, ...]:
    """Mode, condition, response and stop condition of a sentence at each tick of a word."""
    sentence = rule.sentence
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
    """What a word is to get."""

    finite: bool
    verdict: Verdict
    decided: int | None
    first_violation: int | None
    because: str


def expected(rule: Formalized, monitor: Monitor, word: Word) -> Expected:
    """The verdict of a word, on which definition, monitor and reasons agree.

    Args:
        rule: the sentence.
        monitor: what is emitted of it, and of nothing else.
        word: a run of all its atoms.
    """
    parts = letters(rule, word)
    broken, finite = defined(rule, parts)
    decided = None
    monitor.reset()
    for tick in range(word.ticks):
        monitor.advance([_row(monitor, word, tick)])
        if decided is None and monitor.verdicts()[0] != PENDING:
            decided = tick
    (standing,) = monitor.standings()
    assert standing.finite is finite, (rule.id, word)
    assert broken is None or (decided is not None and decided <= broken), (rule.id, word)
    because = why(rule, parts, ends=True, satisfied=finite)
    return Expected(
        finite, Verdict(str(standing.verdict)), decided, standing.first_violation, because
    )


def _row(monitor: Monitor, word: Word, tick: int) -> tuple[bool, ...]:
    return tuple(bool(word.columns[name] >> tick & 1) for name in monitor.PROPOSITIONS)


def defined(rule: Formalized, parts: Sequence[Parts]) -> tuple[int | None, bool]:
    """By the reference automaton: the tick at which a demand is broken, and FRET's verdict."""
    template = reference.template(rule.sentence, rule.ticks or 0)
    state = reference.initial(template)
    for tick, letter in enumerate(parts):
        after = reference.step(template, state, *letter)
        if after is None:
            return tick, False
        state = after
    return None, reference.accepts(template, state)
