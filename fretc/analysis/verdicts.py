"""Whether a component can be kept, and if not, which of its requirements fight."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from compiler.files.records import replace as altered
from compiler.formalization.formalized import Formalized
from fretc.analysis.arena.alphabet import BeyondError
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.roles import Roles
from fretc.analysis.controllers.circuit import Circuit, circuit
from fretc.analysis.controllers.files import Form
from fretc.analysis.controllers.machine import NoMachineError, machine
from fretc.analysis.controllers.moves import Mealy, mealy
from fretc.analysis.findings import Component, Conflict, OpenQuestion, Verdict
from fretc.analysis.games.cores import Members, cores, minimal
from fretc.analysis.games.plays import Counterstrategy, NoPlayError
from fretc.analysis.games.replay import broken
from fretc.analysis.reasons import because, listed
from fretc.analysis.stage import Stage, stage
from fretish.bindings.declarations import Role


@dataclass(frozen=True, slots=True)
class Completeness:
    """All minimal conflicts among these are found."""

    requirements: tuple[str, ...]


def verdict(setting: Stage, budget: Budget) -> Iterator[Component]:
    """Whether the requirements of a component can be kept together."""
    try:
        answer, why = _verdict(setting, budget)
    except (BeyondError, OutOfTimeError) as error:
        answer, why = Verdict.NOT_CHECKED, str(error)
    yield component(setting.rules, setting.roles, answer, why, round(budget.spent, 3))


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
    if setting.game(setting.arena.counters, budget).solution().is_realizable:
        doubt = setting.left_out or setting.of_outputs
        if doubt is None:
            return Verdict.REALIZABLE, "the system has a strategy"
    else:
        doubt = setting.of_inputs
        if doubt is None:
            return Verdict.UNREALIZABLE, "the environment wins"
        generous, ids = setting.generous(budget), [rule.id for rule in setting.rules]
        if generous.of_inputs is None and _is_lost(generous, ids, budget):
            return Verdict.UNREALIZABLE, f"the environment wins, {_WHATEVER}"
    return Verdict.NOT_CHECKED, doubt


_WHATEVER = "whatever is taken for what is not known"


def _is_lost(there: Stage, ids: Iterable[str], budget: Budget) -> bool:
    """Whether the environment wins against some requirements."""
    return not there.game(there.counters(ids), budget).solution().is_realizable


def strategy(
    setting: Stage, budget: Budget, *, number: int, form: Form
) -> Iterator[Circuit | Mealy | OpenQuestion]:
    """How a component that can be kept is kept.

    Args:
        setting: of the component.
        budget: for finding it.
        number: of the component.
        form: in which the strategy is to be written.
    """
    ids = tuple(rule.id for rule in setting.rules)
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


def conflicts(setting: Stage, budget: Budget) -> Iterator[Conflict | Completeness | OpenQuestion]:
    """Every minimal conflict; at the end a question, where there may be more.

    Where something is not known, a conflict is certain if the environment wins whatever it is taken
    for; it is minimal for certain if the environment does not win any less, though it is favoured.
    """
    question = f"which others of {', '.join(rule.id for rule in setting.rules)} fight"
    try:
        _check_assumptions(setting, budget)
        generous = setting.generous(budget)
        ids = [each.id for each in generous.certain]
        for core in _minimal(generous, ids, budget):
            yield _certain(setting, generous, core, budget)
        doubt = setting.left_out or generous.of_inputs or setting.of_outputs
        if doubt is None and setting.of_inputs is not None:
            more = [
                each
                for each in _minimal(setting, ids, budget)
                if not _is_lost(generous, each, budget)
            ]
            which = "; ".join(listed(each) for each in more)
            if more:
                doubt = f"{setting.of_inputs}; that decides whether these can be kept: {which}"
    except OutOfTimeError as error:
        yield OpenQuestion(question, f"{error}{_hint(setting, budget.again())}")
        return
    except BeyondError as error:
        yield OpenQuestion(question, str(error))
        return
    if doubt is None:
        yield Completeness(tuple(rule.id for rule in setting.rules))
    else:
        yield OpenQuestion(question, doubt)


def _minimal(there: Stage, ids: Sequence[str], budget: Budget) -> Iterator[tuple[str, ...]]:
    """The minimal conflicts of some requirements."""
    read = {rule.id: frozenset(rule.variables) for rule in there.rules}

    def chosen(members: Members) -> tuple[str, ...]:
        return tuple(ids[i] for i in sorted(members))

    def near(i: int, j: int) -> bool:
        return bool(read[ids[i]] & read[ids[j]])

    found = cores(len(ids), lambda members: _is_lost(there, chosen(members), budget), near)
    return map(chosen, found)


def _certain(setting: Stage, generous: Stage, ids: Sequence[str], budget: Budget) -> Conflict:
    """A conflict whatever is taken for what is not known."""
    if {each.id for each in setting.certain}.issuperset(ids):
        return _conflict(setting, ids, budget)
    found = _conflict(generous, ids, budget)
    fewer = [[id for id in ids if id != other] for other in ids]
    if any(_is_lost(setting, each, budget) for each in fewer):
        return altered(found, because=f"{found.because}; fewer of them may fight already")
    return found


_SHORT = 200
"""Ticks of the longest duration where durations are scaled."""


def _hint(setting: Stage, budget: Budget) -> str:
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

    def fights(ids: Sequence[str]) -> bool:
        return _is_lost(scaled, ids, budget)

    try:
        if not fights(every):
            return ""
        return f"; with all durations divided by {factor}, {listed(minimal(every, fights))} fight"
    except OutOfTimeError:
        return ""


def _conflict(setting: Stage, ids: Sequence[str], budget: Budget) -> Conflict:
    """A minimal conflict, with a play that the formulas of its monitors confirm."""
    ids, counters = sorted(ids), setting.counters(ids)
    game = setting.game(counters, budget)
    try:
        play = Counterstrategy(game, game.solution(traps=True), budget).play()
    except (NoPlayError, OutOfTimeError) as error:
        return Conflict(tuple(ids), (), f"the environment wins by a play that is {error}")
    rules = [rule for rule in setting.rules if rule.id in ids]
    alphabet = setting.arena.alphabet
    lost = broken(rules, alphabet, play, as_fret=setting.as_fret)
    assert lost, f"the play of {', '.join(ids)} breaks none of them"
    assert not broken(setting.assumptions, alphabet, play), "the environment keeps its word"
    return Conflict(
        tuple(ids),
        setting.ticks(ids, play.letters, play.numbers),
        because(rules, counters, game, play),
        play.loop,
    )
