"""Lassos: endless runs that satisfy requirements without inputs.

If the system chooses every variable, one satisfying run proves that the requirements are
realizable, including numbers of earlier ticks. z3 searches for it with exact numbers. The result is
checked: comparisons are recomputed from the numbers, and the formulas of the monitors judge the
run.

Source: Biere et al., Bounded model checking, Advances in Computers 58 (2003), for the lasso.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import z3

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.numbers.terms import Term, read_by
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.memory import RequirementCounter
from fretc.analysis.arena.product import arena
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import numbers
from fretc.analysis.arithmetic.alphabet import Cells
from fretc.analysis.arithmetic.atoms import Atoms
from fretc.analysis.games.replay import ROUNDS, kept
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass

LONGEST = 40
"""Maximum number of ticks of a lasso."""
_PATIENCE = 5_000
"""Milliseconds of z3 for each length."""


@dataclass(frozen=True, slots=True)
class SatisfyingRun:
    """A run that satisfies all requirements, and the tick at which its repeated part begins."""

    numbers: tuple[Mapping[str, Term], ...]
    """The value of each variable, for each tick."""
    others: tuple[Mapping[int, bool], ...]
    """The bits of an alphabet that are not about numbers, for each tick."""
    loop: int


@dataclass(frozen=True, slots=True)
class NoShortRun:
    """No run of so many ticks satisfies all requirements."""

    ticks: int


def lasso(
    requirements: Sequence[FormalizedRequirement],
    roles: Roles,
    budget: Budget,
    *,
    as_fret: bool = False,
) -> SatisfyingRun | NoShortRun | None:
    """An endless run that satisfies all requirements, or proof that there is none; None: unknown.

    Args:
        requirements: the requirements; without a counter or certain valuations, the answer is None.
        roles: roles of their variables, none of them an input.
        budget: time limit for the search.
        as_fret: whether no obligation may be open at the end of any tick.
    """
    fresh = numbers()
    cells = Cells(requirements, roles, fresh, Role.OUTPUT, budget)
    if not cells.numbers.is_of_moments:
        return None
    counters = arena(requirements, (), cells, fresh, as_fret=as_fret).counters
    if len(counters) < len(requirements) or cells.is_approximate:
        return None
    waiting = {counter.id for counter in counters if counter.fair is not None}
    search = _LassoSearch(cells, counters)
    for length in range(1, LONGEST + 1):
        if budget.spent > budget.seconds / 2:
            return None
        found = search.next()
        if isinstance(found, SatisfyingRun):
            letters, tail = _letters(cells, found), length - found.loop
            is_kept = kept(requirements, cells, letters, tail, waiting, as_fret=as_fret)
            return found if is_kept else None
        if found is not None:
            return found
    return None


class _LassoSearch:
    """Search for runs of increasing length that return to an earlier state."""

    def __init__(self, cells: Cells, counters: Sequence[RequirementCounter]) -> None:
        self._atoms, self._formulas = cells.numbers, cells.formulas
        assert not cells.inputs, "the system chooses everything"
        self._free = [bit for bit in cells.outputs if bit not in self._formulas]
        self._counters, self._length = counters, 0
        self._steps = {
            bit.now: step
            for each in counters
            for bit, step in zip(each.bits, each.steps, strict=True)
        }
        self._solver = z3.Solver()
        self._solver.set("timeout", _PATIENCE)
        self._solver.add([z3.Not(_bit(number, 0)) for number in self._steps])

    def next(self) -> SatisfyingRun | NoShortRun | None:
        """A lasso with one more tick, or proof that there is none of this length; None: neither."""
        self._solver.add(list(self._tick(self._length)))
        self._length += 1
        if self._solver.check() == z3.unsat:
            return NoShortRun(self._length)
        self._solver.push()
        begins = [z3.Bool(f"loop {tick}") for tick in range(self._length)]
        self._solver.add(z3.Or(begins))
        for tick, begin in enumerate(begins):
            self._solver.add([z3.Implies(begin, each) for each in self._comes_back(tick)])
        run = self._found(begins) if self._solver.check() == z3.sat else None
        self._solver.pop()
        return run

    def _tick(self, tick: int) -> Iterator[Term]:
        """Constraints of a tick: numbers and valuation agree, and no requirement is violated."""
        known: dict[Function, Term] = {}
        for name in self._atoms.variables:
            if name not in self._atoms.before:
                yield _at(self._atoms, self._atoms.domain(name), tick)
        for bit, formula in self._formulas.items():
            yield _bit(bit, tick) == _at(self._atoms, formula, tick)
        for counter in self._counters:
            yield _term(counter.safe, tick, known)
        for number, step in self._steps.items():
            yield _bit(number, tick + 1) == _term(step, tick, known)

    def _comes_back(self, tick: int) -> Iterator[Term]:
        """Constraint: the end equals an earlier tick in state and in stored numbers."""
        for number in self._steps:
            yield _bit(number, self._length) == _bit(number, tick)
        for name in self._atoms.before:
            yield _value(self._atoms, name, self._length) == _value(self._atoms, name, tick)
        for counter in self._counters:
            if counter.fair is not None:
                yield z3.Or([_term(counter.fair, t, {}) for t in range(tick, self._length)])

    def _found(self, begins: Sequence[Term]) -> SatisfyingRun:
        model = self._solver.model()

        def read(term: Term) -> Term:
            return model.eval(term, model_completion=True)

        ticks = range(self._length)
        own = [name for name in self._atoms.variables if name not in self._atoms.before]
        values = ({name: read(_value(self._atoms, name, tick)) for name in own} for tick in ticks)
        others = ({bit: z3.is_true(read(_bit(bit, tick))) for bit in self._free} for tick in ticks)
        loop = next(tick for tick, begin in enumerate(begins) if z3.is_true(read(begin)))
        return SatisfyingRun(tuple(values), tuple(others), loop)


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
    names = read_by(formula)
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


# Once more ------------------------------------------------------------------------------------


def _letters(cells: Cells, run: SatisfyingRun) -> tuple[Mapping[int, bool], ...]:
    """Valuations of a run with its loop repeated, computed from its numbers alone."""
    atoms = cells.numbers
    length = len(run.numbers)
    again = [*range(run.loop, length)] * (ROUNDS - 1)
    letters: list[Mapping[int, bool]] = []
    last: Mapping[str, Term] | None = None
    for tick in (*range(length), *again):
        now = run.numbers[tick]
        values = {**now, **_before(atoms, now, last)}
        domains = (atoms.domain(name) for name in now)
        assert all(_holds(atoms, each, values) for each in domains), "a number has a wrong type"
        of_numbers = {bit: _holds(atoms, each, values) for bit, each in cells.formulas.items()}
        letters.append({**run.others[tick], **of_numbers})
        last = now
    return tuple(letters)


def _before(
    atoms: Atoms, now: Mapping[str, Term], last: Mapping[str, Term] | None
) -> Mapping[str, Term]:
    """Numbers of the previous tick."""
    if last is not None:
        return {name: last[before.of] for name, before in atoms.before.items()}
    found: dict[str, Term] = {}
    for name in atoms.before:
        found[name] = _first(atoms, name, now)
    return found


def _first(atoms: Atoms, name: str, now: Mapping[str, Term]) -> Term:
    first = atoms.before[name].first
    inner = {each: _first(atoms, each, now) for each in read_by(first) if each in atoms.before}
    return _put_in(atoms, first, {**now, **inner})


def _holds(atoms: Atoms, formula: Term, values: Mapping[str, Term]) -> bool:
    found = _put_in(atoms, formula, values)
    assert z3.is_true(found) or z3.is_false(found), "every number is known"
    return bool(z3.is_true(found))


def _put_in(atoms: Atoms, term: Term, values: Mapping[str, Term]) -> Term:
    pairs = [(atoms.variables[name], values[name]) for name in read_by(term)]
    return z3.simplify(z3.substitute(term, *pairs) if pairs else term)
