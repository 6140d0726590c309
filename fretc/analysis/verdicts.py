"""Whether a component can be kept, and if not, which of its requirements fight."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, repeat

from compiler.formalization.formalized import Formalized
from fretc.analysis.arena.alphabet import BeyondError
from fretc.analysis.arena.counters import Counter
from fretc.analysis.arena.roles import Roles
from fretc.analysis.controllers.circuit import Circuit, circuit
from fretc.analysis.controllers.files import Form
from fretc.analysis.controllers.machine import NoMachineError, machine
from fretc.analysis.controllers.moves import Mealy, mealy
from fretc.analysis.findings import Component, Conflict, OpenQuestion, Verdict
from fretc.analysis.games.budget import Budget, OutOfTimeError
from fretc.analysis.games.cores import Members, cores, minimal
from fretc.analysis.games.plays import Counterstrategy
from fretc.analysis.games.replay import broken
from fretc.analysis.games.switches import switched
from fretc.analysis.reasons import because, listed
from fretc.analysis.stage import Stage, stage
from fretish.bindings.declarations import Role


@dataclass(frozen=True, slots=True)
class Completeness:
    """All minimal conflicts among these are found."""

    requirements: tuple[str, ...]


def verdict(setting: Stage, seconds: float) -> Iterator[Component]:
    """Whether the requirements of a component can be kept together."""
    start = time.process_time()
    try:
        answer, why = _verdict(setting, Budget(seconds))
    except (BeyondError, OutOfTimeError) as error:
        answer, why = Verdict.NOT_CHECKED, str(error)
    spent = round(time.process_time() - start, 3)
    yield component(setting.rules, setting.roles, answer, why, spent)


def component(
    rules: Sequence[Formalized], roles: Roles, answer: Verdict, why: str, seconds: float = 0.0
) -> Component:
    """A component with its verdict."""
    names = (name for rule in rules for name in rule.variables if roles[name] is Role.OUTPUT)
    ids = tuple(rule.id for rule in rules)
    return Component(ids, tuple(dict.fromkeys(names)), answer, why, seconds)


def _verdict(setting: Stage, budget: Budget) -> tuple[Verdict, str]:
    """The verdict, and how it is known, or why it is not."""
    _check_assumptions(setting, budget)
    if _is_kept(setting, [each.id for each in setting.arena.counters], budget):
        doubt = setting.left_out or setting.of_outputs
        if doubt is None:
            return Verdict.REALIZABLE, "the system has a strategy"
    else:
        doubt = setting.of_inputs
        if doubt is None:
            return Verdict.UNREALIZABLE, "the environment wins"
        generous = setting.generous()
        if generous is not None and _is_lost(generous, generous.arena.counters, budget):
            return Verdict.UNREALIZABLE, f"the environment wins, {_WHATEVER}"
        answer = _unrolled(setting, budget) if generous is not None else None
        if answer is not None:
            return answer
    return Verdict.NOT_CHECKED, doubt


def _is_kept(setting: Stage, ids: Sequence[str], budget: Budget) -> bool:
    there = setting.close(ids)
    return there.game(there.counters(ids), budget).solution().is_realizable


def _unrolled(setting: Stage, budget: Budget) -> tuple[Verdict, str] | None:
    """What a run shows where there are no inputs: it keeps all, or there is none."""
    from fretc.analysis.games.lassos import Impossible, lasso

    chosen = [setting.roles[name] for rule in setting.rules for name in rule.variables]
    is_certain = setting.left_out is None and setting.of_outputs is None
    if not is_certain or setting.assumptions or Role.INPUT in chosen:
        return None
    found = lasso(setting.rules, setting.roles, budget, as_fret=setting.as_fret)
    if found is None:
        return None
    if isinstance(found, Impossible):
        return Verdict.UNREALIZABLE, f"no run of {found.ticks} ticks keeps all of them"
    run = f"a run of {len(found.numbers)} ticks that repeats itself from tick {found.loop} on"
    return Verdict.REALIZABLE, f"there are no inputs, and {run} keeps all of them"


_WHATEVER = "whatever the numbers of the tick before are taken for"


def _is_lost(generous: Stage, counters: Sequence[Counter], budget: Budget) -> bool:
    """Whether the environment wins, though the system chooses what is not remembered."""
    if generous.of_inputs is not None:
        return False
    return not generous.game(counters, budget).solution().is_realizable


def strategy(
    setting: Stage, seconds: float, *, number: int, form: Form
) -> Iterator[Circuit | Mealy | OpenQuestion]:
    """How a component that can be kept is kept.

    Args:
        setting: of the component.
        seconds: of a processor.
        number: of the component.
        form: in which the strategy is to be written.
    """
    ids = tuple(rule.id for rule in setting.rules)
    budget = Budget(seconds)
    try:
        game = setting.game(setting.arena.counters, budget)
        found = machine(game, game.solution(), budget)
        if form is Form.PYTHON:
            yield circuit(found, ids, number)
        else:
            yield mealy(found, ids, budget)
    except (BeyondError, NoMachineError, OutOfTimeError) as error:
        yield OpenQuestion(f"how can {', '.join(ids)} be kept?", str(error))


def _check_assumptions(setting: Stage, budget: Budget) -> None:
    """Raise BeyondError where no run keeps the assumptions: everything would follow from them."""
    if not setting.assumptions:
        return
    runs = setting.runs((), budget)
    if not runs.is_possible():
        ids = ", ".join(each.id for each in setting.assumptions)
        raise BeyondError(f"no run keeps the assumptions {ids}")


def conflicts(setting: Stage, seconds: float) -> Iterator[Conflict | Completeness | OpenQuestion]:
    """Every minimal conflict; at the end a question, where there may be more."""
    budget = Budget(seconds)
    counters = setting.arena.counters if setting.of_inputs is None else setting.certain
    read = {rule.id: frozenset(rule.variables) for rule in setting.rules}

    def chosen(members: Members) -> list[Counter]:
        return [counters[i] for i in sorted(members)]

    def is_conflict(members: Members) -> bool:
        return not _is_kept(setting, [each.id for each in chosen(members)], budget)

    def near(i: int, j: int) -> bool:
        return bool(read[counters[i].id] & read[counters[j].id])

    question = f"which others of {', '.join(rule.id for rule in setting.rules)} fight"
    try:
        _check_assumptions(setting, budget)
        at_once = switched(setting.game(counters, budget), setting.fresh)
        sets = at_once.cores(budget) if at_once else cores(len(counters), is_conflict, near)
        for members in sets:
            yield _conflict(setting, [each.id for each in chosen(members)], budget)
        if setting.of_inputs is not None:
            yield from _with_the_past(setting, budget)
    except OutOfTimeError as error:
        yield OpenQuestion(question, f"{error}{_hint(setting, seconds)}")
        return
    except BeyondError as error:
        yield OpenQuestion(question, str(error))
        return
    doubt = setting.left_out or setting.of_inputs
    if doubt is None:
        yield Completeness(tuple(rule.id for rule in setting.rules))
    else:
        yield OpenQuestion(question, doubt)


def _with_the_past(setting: Stage, budget: Budget) -> Iterator[Conflict]:
    """Conflicts about numbers of the tick before that are certain, and certain to be minimal."""
    generous = setting.generous()
    if generous is None:
        return
    counters = generous.arena.counters
    known = {each.id for each in setting.certain}

    def is_conflict(members: Members) -> bool:
        return _is_lost(generous, [counters[i] for i in sorted(members)], budget)

    for members in cores(len(counters), is_conflict, lambda i, j: True):
        ids = sorted(counters[i].id for i in members)
        fewer = [[id for id in ids if id != other] for other in ids]
        games = (setting.game(setting.counters(each), budget) for each in fewer)
        if not known.issuperset(ids) and all(game.solution().is_realizable for game in games):
            yield Conflict(tuple(ids), (), f"the environment wins, {_WHATEVER}; no play is shown")


_SHORT = 200
"""Ticks of the longest duration where durations are scaled."""


def _hint(setting: Stage, seconds: float) -> str:
    """What fights where all durations are a fraction of what they are: a clue, and no finding."""
    longest = max((rule.ticks or 0 for rule in setting.rules), default=0)
    factor = -(-longest // _SHORT)
    if factor < 2:
        return ""
    rules, assumptions = (
        [
            replace(rule, ticks=-(-rule.ticks // factor) if rule.ticks else rule.ticks)
            for rule in some
        ]
        for some in (setting.rules, setting.assumptions)
    )
    scaled = stage(rules, assumptions, setting.roles, as_fret=setting.as_fret)
    every = [each.id for each in scaled.arena.counters]
    budget = Budget(seconds)

    def fights(ids: Sequence[str]) -> bool:
        game = scaled.game(scaled.counters(ids), budget)
        return not game.solution().is_realizable

    try:
        if not fights(every):
            return ""
        return f"; with all durations divided by {factor}, {listed(minimal(every, fights))} fight"
    except OutOfTimeError:
        return ""


_LONGEST = 200_000
"""Ticks of a play that is written down."""


def _conflict(whole: Stage, members: Sequence[str], budget: Budget) -> Conflict:
    """A minimal conflict, with a play that the formulas of its monitors confirm."""
    ids, setting = sorted(members), whole.close(members)
    counters = setting.counters(ids)
    game = setting.game(counters, budget)
    try:
        play = Counterstrategy(game, game.solution(traps=True), budget).play()
    except OutOfTimeError as error:
        return Conflict(tuple(ids), (), f"the environment wins by a play that is {error}")
    rules = [rule for rule in setting.rules if rule.id in ids]
    alphabet = setting.arena.alphabet
    lost = broken(rules, alphabet, play, as_fret=setting.as_fret)
    assert lost, f"the play of {', '.join(ids)} breaks none of them"
    assert not broken(setting.assumptions, alphabet, play), "the environment keeps its word"
    why = because(rules, counters, game, play)
    if play.ticks > _LONGEST:
        return Conflict(tuple(ids), (), why)
    each = setting.ticks(ids, (letter for letter, _ in play.runs))
    shown = chain.from_iterable(
        repeat(t, count) for t, (_, count) in zip(each, play.runs, strict=True)
    )
    return Conflict(tuple(ids), tuple(shown), why, play.loop)
