"""Requirements without inputs, unrolled tick by tick in z3: any of them can be switched on.

If the system chooses every variable, a run that returns to an earlier state proves that the
requirements are realizable, and the absence of a run of some length proves that they are not,
including numbers of earlier ticks.

Source: Biere et al., Bounded model checking, Advances in Computers 58 (2003), for the lasso; Een,
Sorensson, Temporal induction by incremental SAT solving, BMC 2003, for the switches.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import lru_cache

import z3

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.numbers.terms import Term, read_by
from compiler.formalization.resolution import candidates
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import RequirementCounter
from fretc.analysis.arena.product import arena
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import numbers
from fretc.analysis.arithmetic.atoms import Atoms
from fretc.analysis.arithmetic.separate import SeparateComparisons
from fretc.analysis.games.unrolled_runs import NoShortRun, SatisfyingRun
from fretish.bindings.declarations import Role

_PATIENCE = 5_000
"""Milliseconds of z3 for each query."""
_NICE = 500
"""Milliseconds to search for whole numbers, which are easier to read."""


class UnrolledRequirements:
    """Some requirements over the ticks of a run whose length grows with the questions."""

    def __init__(
        self, requirements: Sequence[FormalizedRequirement], roles: Roles, *, as_fret: bool
    ) -> None:
        """No tick yet.

        Args:
            requirements: the requirements.
            roles: roles of their variables, none of them an input.
            as_fret: whether no obligation may be open at the end of any tick.
        """
        fresh = numbers()
        self.alphabet = SeparateComparisons(requirements, roles, fresh)
        self._atoms = self.alphabet.numbers
        counters = arena(requirements, (), self.alphabet, fresh, as_fret=as_fret).counters
        self._counters = {counter.id: counter for counter in counters}
        self._of = {each.id: each for each in requirements}
        self._length = 0
        self._steps = {
            bit.now: step
            for each in counters
            for bit, step in zip(each.bits, each.steps, strict=True)
        }
        self._solver = z3.Solver()
        self._solver.add([z3.Not(_bit(number, 0)) for number in self._steps])
        self.known = self._exact() if self._atoms.is_of_moments else frozenset()
        """Ids of the requirements about which questions have exact answers."""

    def _exact(self) -> frozenset[str]:
        doubtful = self.alphabet.uncertain_atoms(Role.OUTPUT)
        return frozenset(
            id
            for id in self._counters
            if doubtful.isdisjoint(name for name, _ in candidates(self._of[id].sentence))
        )

    @property
    def length(self) -> int:
        """Number of ticks so far."""
        return self._length

    def counters(self, ids: Sequence[str]) -> tuple[RequirementCounter, ...]:
        """Counters of some requirements."""
        return tuple(self._counters[id] for id in ids)

    @property
    def waiting(self) -> frozenset[str]:
        """Ids of requirements whose obligations may stay open for any time, but not for ever."""
        return frozenset(id for id, each in self._counters.items() if each.fair is not None)

    def grow(self) -> None:
        """Add a tick."""
        self._solver.add(list(self._tick(self._length)))
        self._length += 1

    def shortest(self, ids: Sequence[str], budget: Budget) -> NoShortRun | None:
        """Proof that no run of the present length, or of fewer ticks, satisfies some requirements.

        None: there is such a run, or z3 does not answer in time.
        """
        core = self._core(ids, self._length, budget)
        if core is None:
            return None
        low, high = 1, self._length
        while low < high:
            middle = (low + high) // 2
            smaller = self._core(ids, middle, budget)
            low, high, core = (
                (low, middle, smaller) if smaller is not None else (middle + 1, high, core)
            )
        return NoShortRun(high, core)

    def lasso(self, ids: Sequence[str], budget: Budget) -> SatisfyingRun | None:
        """A run of the present length that satisfies some requirements, and returns to a state."""
        begins = [z3.Bool(f"loop {tick} {self._length}") for tick in range(self._length)]
        self._solver.push()
        self._solver.add(z3.Or(begins))
        for tick, begin in enumerate(begins):
            self._solver.add([z3.Implies(begin, each) for each in self._comes_back(tick, ids)])
        is_there = self._check(ids, self._length, budget) == z3.sat
        run = self._run(self._solver.model(), self._length, begins) if is_there else None
        self._solver.pop()
        return run

    def longest(self, ids: Sequence[str], ticks: int, budget: Budget) -> SatisfyingRun | None:
        """A run whose last tick is the first that violates some requirements, as few as possible.

        Args:
            ids: requirements that no run of so many ticks satisfies, but a run of one tick less.
            ticks: number of ticks.
            budget: time limit.
        """
        last = ticks - 1
        for violated in (*([id] for id in ids), ids):
            self._solver.push()
            self._solver.add(
                [_term(self._counters[id].safe, last, {}) for id in ids if id not in violated]
            )
            model = self._model(ids, last, budget)
            run = None if model is None else self._run(model, ticks, ())
            self._solver.pop()
            if run is not None:
                return run
        return None

    def letter(self, run: SatisfyingRun, tick: int, last: int | None) -> Mapping[int, bool]:
        """The valuation of a tick of a run, computed from its numbers alone.

        Args:
            run: the run.
            tick: the tick.
            last: the tick before; None: there is none.
        """
        now = run.numbers[tick]
        values = {**now, **self._before(now, None if last is None else run.numbers[last])}
        domains = (self._atoms.domain(name) for name in now)
        assert all(_holds(self._atoms, each, values) for each in domains), "a type is wrong"
        formulas = self.alphabet.formulas.items()
        of_numbers = {bit: _holds(self._atoms, each, values) for bit, each in formulas}
        return {**run.others[tick], **of_numbers}

    def values(self, numbers: Mapping[str, Term], letter: Mapping[int, bool]) -> Tick:
        """Numbers of a tick and its truth values, by the user's names."""
        own = {name: Fraction(str(_plain(value))) for name, value in numbers.items()}
        return {**self._atoms.tick(own), **self.alphabet.shown(letter)}

    # Constraints

    def _tick(self, tick: int) -> Iterator[Term]:
        """Constraints of a tick: numbers and valuation agree; what is on and counts is safe."""
        known: dict[Function, Term] = {}
        for name in self._atoms.variables:
            if name not in self._atoms.before:
                yield _at(self._atoms, self._atoms.domain(name), tick)
        for bit, formula in self.alphabet.formulas.items():
            yield _bit(bit, tick) == _at(self._atoms, formula, tick)
        for id, counter in self._counters.items():
            counts = z3.And(_switch(id), _counts(tick))
            yield z3.Implies(counts, _term(counter.safe, tick, known))
        for number, step in self._steps.items():
            yield _bit(number, tick + 1) == _term(step, tick, known)

    def _comes_back(self, tick: int, ids: Sequence[str]) -> Iterator[Term]:
        """Constraint: the end equals an earlier tick in state and in stored numbers."""
        counters = [self._counters[id] for id in ids]
        for number in dict.fromkeys(bit.now for each in counters for bit in each.bits):
            yield _bit(number, self._length) == _bit(number, tick)
        for name in self._atoms.before:
            yield _value(self._atoms, name, self._length) == _value(self._atoms, name, tick)
        for counter in counters:
            if counter.fair is not None:
                yield z3.Or([_term(counter.fair, t, {}) for t in range(tick, self._length)])

    # Answers

    def _check(
        self, ids: Sequence[str], ticks: int, budget: Budget, patience: int = _PATIENCE
    ) -> z3.CheckSatResult:
        self._solver.set("timeout", max(1, int(min(patience, 1000 * budget.left))))
        return self._solver.check(*map(_switch, ids), *map(_counts, range(ticks)))

    def _core(self, ids: Sequence[str], ticks: int, budget: Budget) -> frozenset[str] | None:
        """Some of the ids that no run of so many ticks satisfies; None: there may be a run."""
        if self._check(ids, ticks, budget) != z3.unsat:
            return None
        on = {str(_switch(id)): id for id in ids}
        return frozenset(on[str(each)] for each in self._solver.unsat_core() if str(each) in on)

    def _model(self, ids: Sequence[str], ticks: int, budget: Budget) -> z3.ModelRef | None:
        """A model, with whole numbers if they are soon at hand."""
        self._solver.push()
        of_runs = (_value(self._atoms, name, t) for name in self._own for t in range(ticks + 1))
        self._solver.add([z3.IsInt(value) for value in of_runs if z3.is_real(value)])
        is_nice = self._check(ids, ticks, budget, _NICE) == z3.sat
        model = self._solver.model() if is_nice else None
        self._solver.pop()
        if model is None and self._check(ids, ticks, budget) == z3.sat:
            model = self._solver.model()
        return model

    @property
    def _own(self) -> Sequence[str]:
        """Names of variables that are numbers of the same tick."""
        return [name for name in self._atoms.variables if name not in self._atoms.before]

    def _run(self, model: z3.ModelRef, length: int, begins: Sequence[Term]) -> SatisfyingRun:
        def read(term: Term) -> Term:
            return model.eval(term, model_completion=True)

        ticks, free = range(length), self.alphabet.free
        values = (
            {name: read(_value(self._atoms, name, tick)) for name in self._own} for tick in ticks
        )
        others = ({bit: z3.is_true(read(_bit(bit, tick))) for bit in free} for tick in ticks)
        loop = (tick for tick, begin in enumerate(begins) if z3.is_true(read(begin)))
        return SatisfyingRun(tuple(values), tuple(others), next(loop, None))

    def _before(
        self, now: Mapping[str, Term], last: Mapping[str, Term] | None
    ) -> Mapping[str, Term]:
        """Numbers of the previous tick."""
        before = self._atoms.before
        if last is not None:
            return {name: last[each.of] for name, each in before.items()}
        return {name: _first(self._atoms, name, now) for name in before}


def _plain(value: Term) -> Term:
    return value.as_fraction() if z3.is_real(value) else value.as_long()


def _switch(id: str) -> Term:
    return z3.Bool(f"on {id}")


def _counts(tick: int) -> Term:
    return z3.Bool(f"counts {tick}")


def _bit(number: int, tick: int) -> Term:
    return z3.Bool(f"{number}@{tick}")


def _value(atoms: Atoms, name: str, tick: int) -> Term:
    """A variable at a tick."""
    before = atoms.before.get(name)
    if before is None:
        variable = atoms.variables[name]
        return z3.Const(f"{name}@{tick}", variable.sort())
    if tick == 0:
        return _at(atoms, before.first, 0)
    return _value(atoms, before.of, tick - 1)


def _at(atoms: Atoms, formula: Term, tick: int) -> Term:
    names = _read(formula)
    pairs = [(atoms.variables[name], _value(atoms, name, tick)) for name in names]
    return z3.substitute(formula, *pairs) if pairs else formula


def _term(function: Function, tick: int, known: dict[Function, Term]) -> Term:
    """A function of bits as a z3 formula; `known` has the bits of the tick."""
    known |= {bdd.true(): z3.BoolVal(True), bdd.false(): z3.BoolVal(False)}
    for part in bdd.nodes([function]):
        if part not in known:
            number, high, low = bdd.branches(part)
            known[part] = z3.If(_bit(number, tick), known[high], known[low])
    return known[function]


def _first(atoms: Atoms, name: str, now: Mapping[str, Term]) -> Term:
    first = atoms.before[name].first
    inner = {each: _first(atoms, each, now) for each in _read(first) if each in atoms.before}
    return _put_in(atoms, first, {**now, **inner})


def _holds(atoms: Atoms, formula: Term, values: Mapping[str, Term]) -> bool:
    value = _put_in(atoms, formula, values)
    assert z3.is_true(value) or z3.is_false(value), "every number is known"
    return bool(z3.is_true(value))


def _put_in(atoms: Atoms, term: Term, values: Mapping[str, Term]) -> Term:
    pairs = [(atoms.variables[name], values[name]) for name in _read(term)]
    return z3.simplify(z3.substitute(term, *pairs) if pairs else term)


@lru_cache(maxsize=10_000)
def _read(term: Term) -> frozenset[str]:
    """The names of the variables in a formula."""
    return read_by(term)
