"""One run of the program: towards a goal, or with given inputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from random import Random

from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.transition import State
from fretc.analysis.arena.variables import UnsupportedError
from fretc.testing.conformance.oracle import Oracle, ProgramTrace, Tick, Truths
from fretc.testing.conformance.program import ProgramRun
from fretc.testing.conformance.requirement_groups import GoalPath, RequirementGroup
from fretc.testing.search import Letter

Start = Callable[[], ProgramRun]
"""Function that starts the program."""


class ProgramDriver:
    """Runs of one program."""

    def __init__(self, fields: Sequence[RequirementGroup], oracle: Oracle, start: Start) -> None:
        self._fields, self._oracle, self._start = fields, oracle, start
        self.runs = self.ticks = 0
        """Numbers of runs and of ticks so far."""

    def towards(
        self, field: RequirementGroup, plan: GoalPath, choose: Random | None, most: int
    ) -> ProgramTrace:
        """A run with inputs that lead to a goal.

        Args:
            field: requirement group of the goal.
            plan: way to the goal.
            choose: random choice of irrelevant inputs; None: they keep their values.
            most: maximum number of ticks if the program does not cooperate.

        Raises:
            UnsupportedError: no value is known for an input.
            ProgramError: the program violates the protocol.
            OutOfTimeError: it takes too long to find the inputs.
        """
        sides = [_Side(each, choose) for each in self._fields]
        own = next(side for side in sides if side.field is field)

        def inputs(tick: int) -> Tick | None:
            options = plan.options(own.state) if tick < most else None
            return None if options is None else _joined(sides, {own: options})

        def goes_on(truths: Truths) -> bool:
            return all(side.moves(truths) for side in sides) and not plan.is_reached(own.last)

        return self._run(inputs, goes_on)

    def anywhere(self, choose: Random, change: float, most: int) -> ProgramTrace:
        """A run with random inputs that satisfy the assumptions.

        Args:
            choose: random choice of the inputs.
            change: probability that an input changes at a tick.
            most: number of ticks.

        Raises:
            UnsupportedError: as for `towards`; also ProgramError.
        """
        sides = [_Side(field, choose, change) for field in self._fields]
        return self._run(
            lambda tick: _joined(sides, {}) if tick < most else None,
            lambda truths: all(side.moves(truths) for side in sides),
        )

    def again(self, rows: Sequence[Tick]) -> ProgramTrace:
        """A run with these inputs, up to the first violation.

        Raises:
            ProgramError: the program violates the protocol.
        """
        return self._run(lambda tick: rows[tick] if tick < len(rows) else None, lambda truths: True)

    def _run(
        self, inputs: Callable[[int], Tick | None], goes_on: Callable[[Truths], bool]
    ) -> ProgramTrace:
        """A run that ends with its inputs, with the program, or with a violation."""
        oracle = self._oracle
        oracle.begin()
        rows: list[Tick] = []
        found: list[Truths] = []
        with self._start() as program:
            while (values := inputs(len(rows))) is not None:
                missing = next((name for name in oracle.inputs if name not in values), None)
                if missing is not None:
                    raise UnsupportedError(f"no value is known for `{missing}`")
                given = {name: values[name] for name in oracle.inputs}
                answer = dict(zip(oracle.outputs, program.step([*given.values()]), strict=True))
                truths = oracle.step({**given, **answer})
                rows.append({**given, **answer})
                found.append(truths)
                if oracle.broken() or oracle.is_over() or not goes_on(truths):
                    break
        self.runs += 1
        self.ticks += len(rows)
        return ProgramTrace(tuple(rows), tuple(found), oracle.broken(), oracle.triggered())


class _Side:
    """State of a run in one requirement group."""

    def __init__(self, field: RequirementGroup, choose: Random | None, change: float = 0.5) -> None:
        self.field, self._choose, self._change = field, choose, change
        self.state: State = field.transition.start
        self.last: Letter = {}
        """The last tick: the state before it, and the choices of both sides."""
        self._inputs: Letter = dict.fromkeys(field.alphabet.inputs, False)

    def options(self) -> Function:
        """All inputs that satisfy the assumptions."""
        return bdd.at(self.field.allowed, bdd.point(self.state))

    def values(self, options: Function) -> Tick | None:
        """Input values for the program; None: there are no such inputs."""
        if options == bdd.false():
            return None
        wanted = self._inputs
        if self._choose is not None:
            drawn = self._choose.random
            wanted = {bit: value ^ (drawn() < self._change) for bit, value in wanted.items()}
        self._inputs = self.field.inputs(options, wanted)
        return self.field.values(self._inputs)

    def moves(self, truths: Truths) -> bool:
        """Whether the state after the tick is known; it is stored."""
        letter = self.field.letter(self._inputs, truths)
        if letter is None:
            return False
        self.last = {**self.state, **letter}
        self.state = self.field.transition.next(bdd.point(self.last))
        return True


def _joined(sides: Sequence[_Side], options: Mapping[_Side, Function]) -> Tick | None:
    """Input values for the program, from the options of each group; None: one has none."""
    found: Tick = {}
    for side in sides:
        values = side.values(options.get(side, side.options()))
        if values is None:
            return None
        found = {**found, **values}
    return found
