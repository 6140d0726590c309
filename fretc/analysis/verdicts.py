"""Verdict of a component, and its conflicts if it is unrealizable."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.arena.budget import Budget, OutOfTimeError
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.undeclared_roles import are_known_before_outputs, undeclared
from fretc.analysis.arena.variables import UnsupportedError
from fretc.analysis.components import tokens, without_inputs
from fretc.analysis.controllers.circuit import Circuit, circuit
from fretc.analysis.controllers.files import ControllerFormat
from fretc.analysis.controllers.machine import NoMachineError, machine
from fretc.analysis.controllers.moves import Mealy, mealy
from fretc.analysis.findings import Component, OpenQuestion, RealizabilityVerdict
from fretc.analysis.games.unrolled_runs import NoShortRun
from fretc.analysis.realizability_problem import RealizabilityProblem, stage
from fretc.analysis.reasons import listed
from fretish.bindings.declarations import Role

if TYPE_CHECKING:
    from fretc.analysis.games.lassos import Lassos


def verdict(
    setting: RealizabilityProblem, budget: Budget
) -> tuple[Component, RealizabilityProblem]:
    """Whether the requirements of a component are realizable, and the problem that decides it.

    If the answer depends on numbers of earlier ticks, more and more of them are stored.
    """
    answer, why = _answer(setting, budget)
    there = setting
    if answer is RealizabilityVerdict.NOT_CHECKED:
        answer, why = (
            _without_inputs(setting, budget) or _for_each_role(setting, budget) or (answer, why)
        )
    while answer is RealizabilityVerdict.NOT_CHECKED and has_room(budget):
        try:
            finer = there.finer(budget)
        except (UnsupportedError, OutOfTimeError):
            break
        if finer is None:
            break
        there = finer
        verdict, because_ = _answer(there, budget)
        if verdict is not RealizabilityVerdict.NOT_CHECKED:
            answer, why, setting = verdict, because_, there
    if answer is RealizabilityVerdict.NOT_CHECKED:
        alone = without_inputs(setting.requirements, setting.roles)
        some = [*setting.parts, *([alone] if 0 < len(alone) < len(setting.requirements) else [])]
        lost = next(lost_parts(setting, some, budget), None)
        if lost is not None:
            which = _few([requirement.id for requirement in lost.requirements])
            answer, why = RealizabilityVerdict.UNREALIZABLE, f"the environment wins against {which}"
    spent = round(budget.spent, 3)
    return component(setting.requirements, setting.roles, answer, why, spent), setting


def lost_parts(
    setting: RealizabilityProblem, some: Iterable[Sequence[FormalizedRequirement]], budget: Budget
) -> Iterator[RealizabilityProblem]:
    """Problems of some of the requirements that the environment certainly wins."""
    try:
        check_assumptions(setting, budget)
        for each in some:
            part = setting.part(each, budget)
            if _answer(part, budget)[0] is RealizabilityVerdict.UNREALIZABLE:
                yield part
    except (UnsupportedError, OutOfTimeError):
        return


_MOST_NAMES = 4


def _few(ids: Sequence[str]) -> str:
    return listed(ids) if len(ids) <= _MOST_NAMES else f"{len(ids)} of them"


def has_room(budget: Budget) -> bool:
    """Whether there is time to store more; each refinement takes several times as long."""
    return budget.spent < budget.seconds / 8


def _answer(setting: RealizabilityProblem, budget: Budget) -> tuple[RealizabilityVerdict, str]:
    try:
        return _verdict(setting, budget)
    except (UnsupportedError, OutOfTimeError) as error:
        return RealizabilityVerdict.NOT_CHECKED, str(error)


def component(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    answer: RealizabilityVerdict,
    why: str,
    seconds: float = 0.0,
) -> Component:
    """A component with its verdict."""
    names = (
        name
        for requirement in requirements
        for name in requirement.variables
        if roles.get(name) is Role.OUTPUT
    )
    ids = tuple(requirement.id for requirement in requirements)
    return Component(ids, tuple(dict.fromkeys(names)), answer, why, seconds)


def _verdict(setting: RealizabilityProblem, budget: Budget) -> tuple[RealizabilityVerdict, str]:
    """The verdict with its reason."""
    check_assumptions(setting, budget)
    if not is_lost(setting, [counter.id for counter in setting.arena.counters], budget):
        uncertainty = setting.left_out or setting.of_outputs
        if uncertainty is None:
            return RealizabilityVerdict.REALIZABLE, "the system has a strategy"
        answer = _unrolled(setting, budget)
        if answer is not None:
            return answer
    else:
        uncertainty = setting.of_inputs
        if uncertainty is None:
            return RealizabilityVerdict.UNREALIZABLE, "the environment wins"
        generous, ids = (
            setting.generous(budget),
            [requirement.id for requirement in setting.requirements],
        )
        if generous.of_inputs is None and is_lost(generous, ids, budget):
            return RealizabilityVerdict.UNREALIZABLE, f"the environment wins, {WHATEVER}"
        answer = _unrolled(setting, budget) if generous is not setting else None
        if answer is not None:
            return answer
    return RealizabilityVerdict.NOT_CHECKED, uncertainty


WHATEVER = "whatever the unknown values are"


def _unrolled(
    setting: RealizabilityProblem, budget: Budget
) -> tuple[RealizabilityVerdict, str] | None:
    """Verdict without inputs: a satisfying run, or proof that there is none."""
    from fretc.analysis.games.lassos import lasso

    chosen = [
        setting.roles.get(name)
        for requirement in setting.requirements
        for name in requirement.variables
    ]
    if setting.left_out or setting.assumptions or Role.INPUT in chosen:
        return None
    found = lasso(setting.requirements, setting.roles, budget, as_fret=setting.as_fret)
    if found is None:
        return None
    if isinstance(found, NoShortRun):
        return (
            RealizabilityVerdict.UNREALIZABLE,
            f"no run of {found.ticks} ticks satisfies all of them",
        )
    run = f"a run of {len(found.numbers)} ticks that repeats itself from tick {found.loop} on"
    return RealizabilityVerdict.REALIZABLE, f"there are no inputs, and {run} satisfies all of them"


def lassos(setting: RealizabilityProblem) -> Lassos | None:
    """Exact answers about the requirements without inputs; None: the game has them.

    A system that could break an assumption would win without satisfying the requirements.
    """
    alphabet = setting.arena.alphabet
    if alphabet.open is None and not setting.left_out and not setting.of_outputs:
        return None
    if any(tokens(each, setting.roles, Role.OUTPUT) for each in setting.assumptions):
        return None
    alone = without_inputs(setting.requirements, setting.roles)
    if not alone:
        return None
    from fretc.analysis.games.lassos import Lassos

    return Lassos(alone, setting.roles, as_fret=setting.as_fret)


def _without_inputs(
    setting: RealizabilityProblem, budget: Budget
) -> tuple[RealizabilityVerdict, str] | None:
    """Verdict if no run satisfies the requirements that the system alone decides."""
    try:
        check_assumptions(setting, budget)
        exact = lassos(setting)
        result = exact and exact.answer(sorted(exact.unrolled.known), Budget(budget.left / 4))
    except (UnsupportedError, OutOfTimeError):
        return None
    if not isinstance(result, NoShortRun):
        return None
    run = f"no run of {result.ticks} ticks satisfies {_few(sorted(result.of))}"
    return RealizabilityVerdict.UNREALIZABLE, run


def _for_each_role(
    setting: RealizabilityProblem, budget: Budget
) -> tuple[RealizabilityVerdict, str] | None:
    """Verdict that holds for each role of the variables without one, and for each definition.

    The system wins if it does while the environment chooses them, and loses if it does while it
    chooses them itself.
    """
    names = undeclared(setting.requirements, setting.roles)
    if not names:
        return None
    free = (
        f"whatever {listed([f'`{name}`' for name in names])} {'is' if len(names) == 1 else 'are'}"
    )
    certain = {
        Role.OUTPUT: (RealizabilityVerdict.UNREALIZABLE, f"the environment wins, {free}"),
        Role.INPUT: (RealizabilityVerdict.REALIZABLE, f"the system has a strategy, {free}"),
    }
    for role, (wanted, why) in certain.items():
        if role is Role.INPUT and not are_known_before_outputs(
            names, setting.requirements, setting.roles
        ):
            continue
        chosen = {**setting.roles, **dict.fromkeys(names, role)}
        limit = Budget(budget.left / 2) if role is Role.OUTPUT else budget
        try:
            there = stage(
                setting.requirements,
                setting.assumptions,
                chosen,
                as_fret=setting.as_fret,
                budget=limit,
            )
        except (UnsupportedError, OutOfTimeError):
            continue
        if _answer(there, limit)[0] is wanted:
            return wanted, why
    return None


def is_lost(setting: RealizabilityProblem, ids: Sequence[str], budget: Budget) -> bool:
    """Whether the environment wins against some requirements."""
    there = setting.close(ids, budget)
    return not there.game(there.counters(ids), budget).solution().is_realizable


def strategy(
    setting: RealizabilityProblem, budget: Budget, *, number: int, form: ControllerFormat
) -> Iterator[Circuit | Mealy | OpenQuestion]:
    """The controller of a realizable component.

    Args:
        setting: problem of the component.
        budget: time limit.
        number: number of the component.
        form: output form of the controller.
    """
    ids = tuple(requirement.id for requirement in setting.requirements)
    try:
        if setting.left_out is not None:
            raise UnsupportedError(setting.left_out)
        game = setting.game(setting.arena.counters, budget)
        controller = machine(game, game.solution(), budget)
        if form is ControllerFormat.PYTHON:
            yield circuit(controller, ids, number)
        else:
            yield mealy(controller, ids, budget)
    except (UnsupportedError, NoMachineError, OutOfTimeError) as error:
        yield OpenQuestion(f"how can {', '.join(ids)} be satisfied?", str(error))


def check_assumptions(setting: RealizabilityProblem, budget: Budget) -> None:
    """Raise UnsupportedError if no run satisfies the assumptions: every result would follow."""
    if not setting.assumptions:
        return
    runs = setting.runs((), budget)
    if not runs.is_possible():
        ids = ", ".join(assumption.id for assumption in setting.assumptions)
        raise UnsupportedError(f"no run satisfies the assumptions {ids}")
