"""An alphabet of truth values: each atom is a bit of the environment or of the system.

Comparisons of numbers and enumeration values are bits, too; patterns that no values satisfy are
excluded (`compiler.logic.orders`). If order alone cannot exclude all impossible patterns, the
alphabet reports it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import chain

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import all_comparisons
from compiler.formalization.resolution import candidates
from compiler.logic.diagrams import decision_diagrams as bdd
from compiler.logic.diagrams.decision_diagrams import Function
from compiler.logic.orders import Exclusion, exclusions
from fretc.analysis.arena.alphabet import Tick
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.variables import Numbers, UnsupportedError
from fretish import expressions as e
from fretish.bindings.declarations import Role
from fretish.bindings.types import Kind
from fretish.bindings.types import kind as kind_of


class Propositions:
    """An `Alphabet` in which each atom is a bit.

    Args:
        requirements: requirements with the atoms.
        roles: roles of their variables.
        fresh: variables for the bits.
        elsewhere: atoms that another alphabet has.
        refused: comparison → why the other alphabet does not have it.
    """

    def __init__(
        self,
        requirements: Sequence[FormalizedRequirement],
        roles: Roles,
        fresh: Numbers,
        elsewhere: frozenset[str] = frozenset(),
        refused: Mapping[str, str] | None = None,
    ) -> None:
        self._fresh = fresh
        self._elsewhere, self._refused = elsewhere, refused or {}
        self._roles = roles
        self._parts = dict(
            chain.from_iterable(candidates(requirement.sentence) for requirement in requirements)
        )
        self._read = {name: _read(name, part, requirements) for name, part in self._parts.items()}
        self._numbers: dict[str, int] = {}
        self.uncertainties: dict[Role, str] = {}
        self._uncertain_atoms: dict[Role, set[str]] = {Role.INPUT: set(), Role.OUTPUT: set()}
        self._compared = dict(
            chain.from_iterable(
                all_comparisons(requirement).items() for requirement in requirements
            )
        )
        self._computed = {
            name
            for requirement in requirements
            for name in (requirement.declarations.computed if requirement.declarations else ())
        }
        self._excluded = _exclusions(self._compared, requirements)
        for role, reason in self._uncertainties(requirements):
            self.uncertainties.setdefault(role, reason)

    def uncertain_atoms(self, role: Role) -> frozenset[str]:
        """Atoms for which a player has valuations that may be impossible."""
        return frozenset(self._uncertain_atoms[role])

    @property
    def is_refinable(self) -> bool:
        """False: nothing about numbers is stored."""
        return False

    @property
    def not_computed(self) -> frozenset[str]:
        """No atom."""
        return frozenset()

    @property
    def open(self) -> None:
        """None: nothing is left to a favoured player."""

    def memory(self) -> None:
        """No facts about earlier ticks are stored."""

    def course(self, budget: Budget) -> None:
        """None: no valuation depends on numbers."""

    def atom(self, name: str) -> Function:
        """The bit of an atom."""
        if name not in self._numbers:
            self.role(name)
            self._numbers[name] = next(self._fresh)
        return bdd.variable(self._numbers[name])

    def role(self, name: str) -> Role:
        """The player who decides an atom.

        Raises:
            UnsupportedError: both players do, or the atom is not about one tick.
        """
        part = self._parts.get(name)
        if part is None:
            raise UnsupportedError(f"`{name}` is not a value at a single tick")
        called = next((each for each in e.parts(part) if isinstance(each, e.Call)), None)
        if called is not None and called.name.lower() not in _ABSOLUTE:
            raise UnsupportedError(f"it calls `{called.name}`")
        players = {self._roles[each.id] for each in e.names(part)}
        if len(players) > 1:
            both = f"`{name}` compares what the environment and the system choose"
            raise UnsupportedError(self._refused.get(name, both))
        return players.pop() if players else Role.INPUT

    @property
    def inputs(self) -> Sequence[int]:
        """The bits of the environment."""
        return self._of(Role.INPUT)

    @property
    def outputs(self) -> Sequence[int]:
        """The bits of the system."""
        return self._of(Role.OUTPUT)

    def _of(self, role: Role) -> Sequence[int]:
        return [number for name, number in self._numbers.items() if self.role(name) is role]

    @property
    def legal(self) -> Function:
        """Input patterns that some values satisfy."""
        return self._possible(Role.INPUT)

    @property
    def reachable(self) -> Function:
        """Output patterns that some values satisfy."""
        return self._possible(Role.OUTPUT)

    @property
    def possible(self) -> Function:
        """Patterns that some values satisfy."""
        return self.legal & self.reachable

    @property
    def certain(self) -> Function:
        """The possible patterns; false if some of them may be impossible."""
        return bdd.false() if self.uncertainties else self.possible

    def _possible(self, role: Role) -> Function:
        valid = bdd.true()
        for each in self._excluded:
            if all(name in self._numbers and self.role(name) is role for name, _ in each):
                valid = valid - bdd.point({self._numbers[name]: value for name, value in each})
        return valid

    @property
    def labels(self) -> Mapping[int, str]:
        """The atom of each bit."""
        return {number: name for name, number in self._numbers.items()}

    def values(self, letter: Mapping[int, bool]) -> Tick:
        """Atom → its value, by the names that formulas have."""
        return {name: letter[number] for name, number in self._numbers.items() if number in letter}

    def _uncertainties(
        self, requirements: Sequence[FormalizedRequirement]
    ) -> Iterator[tuple[Role, str]]:
        """Variables whose atoms order alone cannot separate."""
        readers: defaultdict[str, list[str]] = defaultdict(list)
        for name, read in self._read.items():
            for each in sorted(read):  # the order of a set changes from process to process
                readers[each].append(name)
        glossary = {
            name: each
            for requirement in requirements
            for name, each in requirement.glossary.items()
        }
        for name, atoms in readers.items():
            if self._elsewhere.issuperset(atoms):
                continue
            whole = name in glossary and kind_of(glossary[name].type) in (Kind.WHOLE, Kind.NATURAL)
            plain = all(_is_plain(self._compared.get(atom), whole=whole) for atom in atoms)
            plain = plain and self._elsewhere.isdisjoint(atoms) and self._is_of_one(atoms)
            if (len(atoms) > 1 or not isinstance(self._parts[atoms[0]], e.Name)) and not plain:
                yield from self._uncertainty(atoms)

    def _is_of_one(self, atoms: Sequence[str]) -> bool:
        """Whether no computed signal meets another name, on which its value may depend."""
        names = {each.id for atom in atoms for each in e.names(self._compared[atom])}
        return len(names) <= 1 or names.isdisjoint(self._computed)

    def _uncertainty(self, atoms: Sequence[str]) -> Iterator[tuple[Role, str]]:
        """Role → why the valuations of these atoms may be impossible."""
        shown = f"`{atoms[0]}` compares numbers, and is treated as true or false at any tick"
        if len(atoms) > 1:
            both = " and ".join(f"`{each}`" for each in atoms[:2])
            shown = f"{both} read the same numbers, and are treated as independent"
        refused = next((self._refused[atom] for atom in atoms if atom in self._refused), None)
        shown = shown if refused is None else f"{refused}: {shown}"
        for atom in atoms:
            with suppress(UnsupportedError):
                role = self.role(atom)
                self._uncertain_atoms[role].update(atoms)
                yield role, shown


_ABSOLUTE = ("abs", "absreal", "absint")


def _read(
    name: str, part: e.Expression, requirements: Iterable[FormalizedRequirement]
) -> frozenset[str]:
    """Signals or variables that decide an atom."""
    for requirement in requirements:
        declared = requirement.declarations
        bound = declared.propositions.get(name) if declared else None
        if bound is not None:
            return frozenset(bound.signals)
    return frozenset(each.id for each in e.names(part))


def _is_plain(part: e.Comparison | None, *, whole: bool) -> bool:
    """Whether order alone determines what a comparison excludes."""
    if part is None:
        return False
    sides = (part.left, part.right)
    simple = all(isinstance(s, e.Name | e.Number | e.Quantity | e.Word) for s in sides)
    return simple and (not whole or part.op in ("=", "!="))


def _exclusions(
    compared: Mapping[str, e.Comparison], requirements: Sequence[FormalizedRequirement]
) -> tuple[Exclusion, ...]:
    """Patterns of comparisons that no values satisfy."""
    signals = {
        name: each
        for requirement in requirements
        for name, each in (
            requirement.declarations.measured if requirement.declarations else {}
        ).items()
    }
    scales = {name: signal.scale for name, signal in signals.items()}
    words = {name: signal.values for name, signal in signals.items() if signal.values}
    return exclusions(compared, scales, words)
