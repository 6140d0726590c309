"""Groups of comparisons that share variables, and their bits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property

import z3

from compiler.formalization.numbers.terms import Term
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.variables import Numbers, UnsupportedError
from fretc.analysis.arithmetic.atoms import Atoms
from fretc.analysis.arithmetic.cells import (
    InputClass,
    Pattern,
    Point,
    another,
    cells,
    fixed,
    literals,
    patterns,
    point,
    reads,
)
from fretc.analysis.arithmetic.group_content import GroupContent
from fretc.analysis.arithmetic.projection import Limit
from fretish.bindings.declarations import Role
from fretish.classes.frozen import dataclass


class ComparisonGroup:
    """Comparisons that share variables; bits are created when the first of them is asked for."""

    def __init__(
        self, choice: GroupContent, atoms: Atoms, fresh: Numbers, favoured: Role, limit: Limit
    ) -> None:
        """A group of comparisons.

        Args:
            choice: content of the group.
            atoms: atoms of the content.
            fresh: variables for its bits.
            favoured: player who decides which signals are unknown.
            limit: time limit for solving the group.

        Raises:
            UnsupportedError: it has too many patterns, or takes too long.
        """
        self._choice, self._atoms, self._fresh = choice, atoms, fresh
        found = _sorted_out(choice, limit)
        self._patterns, self._cells, self._open = found.patterns, found.cells, found.open
        self._is_favoured = choice.role is favoured
        self._bit_of: dict[int, int] = {}
        self._is_used = False
        self._cell_bits: list[int] = []
        self._points: dict[tuple[int, Pattern], Point] = {}
        self._in_cell: dict[int, Point] = {}

    @property
    def open(self) -> str | None:
        """What is unknown about the group; None: nothing that matters."""
        if not self._open:
            return None
        signals = dict.fromkeys(self._atoms.of(str(flag)) for flag in self._choice.flags)
        shown = " and ".join(f"`{each}`" for each in signals)
        return f"it is not declared when {shown} may be unknown"

    @property
    def is_used(self) -> bool:
        """Whether it has bits."""
        return self._is_used

    def atom(self, name: str) -> Function:
        """Function of one of its atoms."""
        if not self._is_used:
            self._is_used = True
            size = max(0, len(self._cells) - 1).bit_length()
            self._cell_bits = [next(self._fresh) for _ in range(size)]
        number, is_so = self._choice.of[name]
        function = self._formula(number)
        return function if is_so else -function

    @property
    def _bits(self) -> Mapping[int, int]:
        """Each formula that a cell does not decide, in the order of patterns, and its bit."""
        return {number: self._bit(number) for number in self._free}

    @cached_property
    def _free(self) -> Sequence[int]:
        """The formulas that a cell does not decide."""
        return [n for n in range(len(self._choice.formulas)) if not self._is_of_cell(n)]

    def _bit(self, number: int) -> int:
        """The bit of a formula, next to those of the requirement that is the first to read it."""
        if number not in self._bit_of:
            self._bit_of[number] = next(self._fresh)
        return self._bit_of[number]

    def _is_of_cell(self, number: int) -> bool:
        """Whether a formula reads only inputs, in a group of both players."""
        outputs = self._choice.variables[Role.OUTPUT]
        return self._choice.is_mixed and not reads(self._choice.formulas[number], outputs)

    def _formula(self, number: int) -> Function:
        if not self._is_of_cell(number):
            return bdd.variable(self._bit(number))
        function = bdd.false()
        for index, cell in enumerate(self._cells):
            if next(iter(cell.patterns))[number]:  # they agree on what is of inputs
                function = function | self._cell(index)
        return function

    def _cell(self, index: int) -> Function:
        return bdd.point({bit: bool(index >> i & 1) for i, bit in enumerate(self._cell_bits)})

    @property
    def inputs(self) -> Sequence[int]:
        """The bits of the environment."""
        return self._cell_bits if self._choice.role is Role.OUTPUT else [*self._bits.values()]

    @property
    def outputs(self) -> Sequence[int]:
        """The bits of the system."""
        return [*self._bits.values()] if self._choice.role is Role.OUTPUT else []

    @property
    def legal(self) -> Function:
        """Possible cells, or input patterns."""
        if self._choice.role is Role.INPUT:
            return self._of_player()
        function = bdd.false() if self._cells else bdd.true()
        for index in range(len(self._cells)):
            function = function | self._cell(index)
        return function

    @property
    def reachable(self) -> Function:
        """Output patterns, in each cell those that the inputs leave."""
        if self._choice.role is Role.INPUT:
            return bdd.true()
        if not self._cells:
            return self._of_player()
        function = bdd.false()
        for index, cell in enumerate(self._cells):
            function = function | (self._cell(index) & self._some_of(cell.patterns))
        return function

    def _of_player(self) -> Function:
        """Patterns of the player who chooses the numbers."""
        return self.possible if self._is_favoured else self.known

    @property
    def known(self) -> Function:
        """Patterns without unknown values."""
        return self.legal & self.reachable if self._cells else self._some_of(self._patterns)

    @property
    def possible(self) -> Function:
        """All possible patterns."""
        return self.known | self._some_of(self._open)

    def _some_of(self, known: Iterable[Pattern]) -> Function:
        function, bits = bdd.false(), self._bits
        for pattern in known:
            function = function | bdd.point({bit: pattern[n] for n, bit in bits.items()})
        return function

    def formulas(self) -> Iterator[tuple[int, Term]]:
        """Bit → its formula."""
        return ((bit, self._choice.formulas[number]) for number, bit in self._bits.items())

    def labels(self) -> Iterator[tuple[int, str]]:
        """Bit of a formula → an atom of a sentence with this formula."""
        bits = self._bits
        for name, (number, is_so) in self._choice.of.items():
            if is_so and number in bits and self._atoms.found[name].names:
                yield bits[number], name

    @property
    def names(self) -> frozenset[str]:
        """Names of its variables."""
        return frozenset(str(each) for some in self._choice.variables.values() for each in some)

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """Numbers for a valuation; numbers of inputs do not depend on the system."""
        index = self._place(letter)
        if index is None:
            return {}
        if not all(bit in letter for bit in self._bits.values()):
            return self._atoms.tick(self._of_cell(index)) if self._cells else {}
        key = index, self._signs(letter)
        if key not in self._points:
            self._points[key] = self._point(*key)
        return self._atoms.tick(self._points[key])

    def numbers(self, letter: Mapping[int, bool], given: Sequence[Term]) -> Point:
        """Numbers for a complete valuation; `given` are constraints that some numbers satisfy."""
        index = self._place(letter)
        assert index is not None, "the letter is whole"
        return self._point(index, self._signs(letter), given)

    def left(self, inputs: Mapping[int, bool], given: Sequence[Term], limit: Limit) -> Function:
        """Function over outputs: the patterns of numbers that satisfy the constraints."""
        choice, index = self._choice, self._place(inputs)
        assert index is not None, "the inputs are whole"
        if choice.role is Role.INPUT:
            return bdd.true()
        free = [choice.formulas[number] for number in self._bits]
        domain = z3.And(*choice.domains.values(), *given, *self._chosen(index))
        function = bdd.false()
        for pattern in patterns(free, domain, limit):
            function = function | bdd.point(dict(zip(self._bits.values(), pattern, strict=True)))
        return function

    def _place(self, letter: Mapping[int, bool]) -> int | None:
        """Index of the cell; 0 without cells; None: the valuation does not determine it."""
        if not all(bit in letter for bit in self._cell_bits):
            return None
        return sum(letter[bit] << i for i, bit in enumerate(self._cell_bits))

    def _signs(self, letter: Mapping[int, bool]) -> Pattern:
        return tuple(letter[bit] for bit in self._bits.values())

    def _of_cell(self, index: int) -> Point:
        if index not in self._in_cell:
            inputs = self._choice.variables[Role.INPUT]
            self._in_cell[index] = point([self._cells[index].region], inputs)
        return self._in_cell[index]

    def _chosen(self, index: int) -> list[Term]:
        """Numbers that the environment chooses in a cell."""
        if not self._cells:
            return []
        return fixed(self._of_cell(index), self._choice.variables[Role.INPUT])

    def _point(self, index: int, signs: Pattern, given: Sequence[Term] = ()) -> Point:
        formulas = [self._choice.formulas[number] for number in self._bits]
        kept = [*literals(formulas, signs), *self._choice.domains.values(), *given]
        if signs not in self._open:
            kept += [z3.Not(flag) for flag in self._choice.flags]
        inputs, outputs = (self._choice.variables[role] for role in (Role.INPUT, Role.OUTPUT))
        if not self._cells:
            return point(kept, [*inputs, *outputs])
        return self._of_cell(index) | point([*kept, *self._chosen(index)], outputs)


# Groups -----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Sorted:
    """Possible patterns of a group."""

    patterns: Sequence[Pattern]
    cells: Sequence[InputClass] = ()
    """Cells, if both players choose its numbers."""
    open: Sequence[Pattern] = ()
    """Patterns that exist only if something is unknown."""


_SORTED: dict[str, _Sorted | str] = {}
"""Cache of solved groups by content, because every question about the requirements needs them.
Timeouts of a question are not cached."""
_MOST_SORTED = 64


def _sorted_out(choice: GroupContent, limit: Limit) -> _Sorted:
    """The patterns of a group, and its cells if both players choose.

    Raises:
        UnsupportedError: there are too many, or it takes too long.
        OutOfTimeError: the time of the question is over.
    """
    if choice.text not in _SORTED:
        if len(_SORTED) >= _MOST_SORTED:
            _SORTED.clear()
        try:
            _SORTED[choice.text] = _found(choice, limit)
        except UnsupportedError as error:
            _SORTED[choice.text] = str(error)
    found = _SORTED[choice.text]
    if isinstance(found, str):
        raise UnsupportedError(found)
    return found


def _found(choice: GroupContent, limit: Limit) -> _Sorted:
    domain = z3.And(list(choice.domains.values()))
    certain = z3.And(domain, *(z3.Not(flag) for flag in choice.flags))
    known = patterns(choice.formulas, certain, limit)
    if choice.is_mixed:
        outputs = choice.variables[Role.OUTPUT]
        domains = choice.domains[Role.INPUT], choice.domains[Role.OUTPUT]
        return _Sorted(known, cells(choice.formulas, known, outputs, domains, limit))
    if choice.carried:
        *formulas, links = choice.carried
        if another(formulas, known, z3.And(domain, links), limit):
            raise UnsupportedError("share only some samples")
    if not choice.flags:
        return _Sorted(known)
    every = patterns(choice.formulas, domain, limit)
    return _Sorted(known, open=[each for each in every if each not in set(known)])
