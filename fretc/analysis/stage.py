"""What each question of some requirements starts from: their arena, and what limits its answers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from compiler.formalization.formalized import Formalized
from compiler.formalization.letters import comparisons
from compiler.formalization.resolution import candidates
from compiler.logic import decision_diagrams as bdd
from compiler.logic.decision_diagrams import Function
from fretc.analysis.arena.alphabet import Alphabet, BeyondError, Numbers, Tick, numbers
from fretc.analysis.arena.counters import Counter, counter
from fretc.analysis.arena.memory import side_by_side
from fretc.analysis.arena.product import Arena, arena
from fretc.analysis.arena.propositions import Propositions
from fretc.analysis.arena.roles import Roles
from fretc.analysis.components import about
from fretc.analysis.games.budget import Budget
from fretc.analysis.games.game import Game, Letter, upheld
from fretc.analysis.games.runs import Runs
from fretish.bindings.declarations import Role

_FEW = 5
"""So many requirements and assumptions are looked at by themselves."""
_LONG = 10
"""Bits of a count that is worth an order of its own beside another one."""


@dataclass(frozen=True, slots=True)
class Stage:
    """Some requirements, the assumptions that bear upon them, and the arena of both."""

    rules: tuple[Formalized, ...]
    assumptions: tuple[Formalized, ...]
    arena: Arena
    roles: Roles
    as_fret: bool
    past: Role = Role.INPUT
    """Who chooses numbers of the tick before, as far as nothing is remembered of them."""
    fresh: Numbers = field(default_factory=numbers, compare=False, repr=False)
    """Variables that nothing of the stage has."""
    _close: dict[frozenset[str], Stage] = field(default_factory=dict, compare=False, repr=False)
    _upheld: list[Function] = field(default_factory=list, compare=False, repr=False)
    """What each game of the stage needs of the assumptions, once it has been computed."""

    def counters(self, ids: Iterable[str]) -> tuple[Counter, ...]:
        """Those of some requirements, in the order of the files."""
        wanted = set(ids)
        return tuple(each for each in self.arena.counters if each.id in wanted)

    def close(self, ids: Iterable[str]) -> Stage:
        """Where some of the requirements are best looked at: by themselves, if they count far."""
        wanted = frozenset(ids)
        members = (*self.counters(wanted), *self.arena.assumptions)
        long = [each for each in members if each.longest >= _LONG]
        if len(members) > _FEW or len(long) < 2 or self.arena.memory is not None:
            return self
        if wanted not in self._close:
            self._close[wanted] = interleaved(self, wanted)
        return self._close[wanted]

    def game(self, counters: Sequence[Counter], budget: Budget) -> Game:
        """The game of some counters, under all assumptions."""
        kept, assumptions = [*counters], [*self.arena.assumptions]
        (kept if self.past is Role.OUTPUT else assumptions).extend(self._memory)
        if not self._upheld:
            self._upheld.append(upheld(self.arena.alphabet, assumptions, budget))
        return Game(self.arena.alphabet, kept, assumptions, budget, self._upheld[0])

    @property
    def _memory(self) -> tuple[Counter, ...]:
        return () if self.arena.memory is None else (self.arena.memory,)

    def assuming(self, more: Sequence[Formalized]) -> Stage:
        """The same under further assumptions, whose bits come last in the order.

        Raises:
            BeyondError: they say something that the stage has no letters for.
        """
        alphabet, found = self.arena.alphabet, list(self.arena.assumptions)
        for rule in more:
            made = counter(rule, alphabet, self.fresh, {})
            known = {*alphabet.inputs, *alphabet.outputs, *(bit.now for bit in made.bits)}
            if not known.issuperset(bdd.support(made.safe)):
                raise BeyondError(f"{rule.id} is about other atoms")
            found.append(made)
        arena = replace(self.arena, assumptions=tuple(found))
        return replace(
            self, assumptions=(*self.assumptions, *more), arena=arena, _close={}, _upheld=[]
        )

    def generous(self) -> Stage | None:
        """The same where the system chooses numbers of the tick before; None: nobody does.

        What cannot be kept even so cannot be kept.
        """
        if self.arena.memory is None:
            return None
        rules, near = self.rules, self.assumptions
        return _built(rules, near, self.roles, numbers(), as_fret=self.as_fret, past=Role.OUTPUT)

    def runs(
        self, kept: Sequence[Counter], budget: Budget, watched: Sequence[Counter] = ()
    ) -> Runs:
        """The runs that keep some counters, and all assumptions."""
        counters = [*kept, *self.arena.assumptions, *self._memory]
        return Runs(self.arena.alphabet, counters, budget, watched)

    def ticks(self, ids: Iterable[str], letters: Iterable[Letter]) -> tuple[Tick, ...]:
        """Letters as values of the variables of some requirements and of the assumptions."""
        wanted = set(ids)
        rules = [*(rule for rule in self.rules if rule.id in wanted), *self.assumptions]
        names = {name for rule in rules for name in (*rule.variables, *rule.propositions)}
        each = map(self.arena.alphabet.values, letters)
        return tuple({name: tick[name] for name in sorted(tick) if name in names} for tick in each)

    @property
    def certain(self) -> tuple[Counter, ...]:
        """The counters of requirements whose letters are just those that there can be."""
        doubtful = self.arena.alphabet.doubtful
        if any(not doubtful.isdisjoint(_atoms(rule)) for rule in self.assumptions):
            return ()
        return self.counters(rule.id for rule in self.rules if doubtful.isdisjoint(_atoms(rule)))

    @property
    def of_inputs(self) -> str | None:
        """Why the environment has more letters here than there can be; None: it has not."""
        return self.arena.alphabet.doubts.get(Role.INPUT)

    @property
    def of_outputs(self) -> str | None:
        """The same of the system."""
        return self.arena.alphabet.doubts.get(Role.OUTPUT)

    @property
    def left_out(self) -> str | None:
        """Which requirements have no counter, and why; None: each has one."""
        return "; ".join(f"{id}: {why}" for id, why in self.arena.beyond.items()) or None


def _atoms(rule: Formalized) -> frozenset[str]:
    return frozenset(name for name, _ in candidates(rule.sentence))


def stage(
    rules: Sequence[Formalized],
    assumptions: Sequence[Formalized],
    roles: Roles,
    *,
    as_fret: bool = False,
) -> Stage:
    """The stage of some requirements.

    Raises:
        BeyondError: an assumption has no counter.
    """
    near = about(rules, assumptions, roles)
    return _built(rules, near, roles, numbers(), as_fret=as_fret)


def interleaved(setting: Stage, ids: Iterable[str]) -> Stage:
    """The stage of a few of the requirements, with bits of the same weight side by side.

    So one count stays easy to compare with another one; counters one after the other need as many
    nodes for it as the counts have values. For many requirements that is worse.
    """
    wanted = set(ids)
    rules = [rule for rule in setting.rules if rule.id in wanted]
    near = about(rules, setting.assumptions, setting.roles)
    used = numbers()
    first = _built(rules, near, setting.roles, used, as_fret=setting.as_fret)
    counters = (*first.arena.counters, *first.arena.assumptions)
    fresh = side_by_side([word for each in counters for word in each.words], next(used))
    return _built(rules, near, setting.roles, fresh, as_fret=setting.as_fret)


def _built(
    rules: Sequence[Formalized],
    near: Sequence[Formalized],
    roles: Roles,
    fresh: Numbers,
    *,
    as_fret: bool,
    past: Role = Role.INPUT,
) -> Stage:
    alphabet = alphabet_of([*rules, *near], roles, fresh, past)
    built = arena(rules, near, alphabet, fresh, as_fret=as_fret)
    return Stage(tuple(rules), tuple(near), built, roles, as_fret, past, fresh)


def _has_numbers(rule: Formalized) -> bool:
    """Whether it compares any, as far as its letters tell."""
    declared = rule.declarations
    if declared is None:
        return bool(comparisons(rule))
    return bool(rule.stated) or not declared.propositions.keys().isdisjoint(rule.variables)


def alphabet_of(rules: Sequence[Formalized], roles: Roles, fresh: Numbers, past: Role) -> Alphabet:
    """The letters of some rules.

    With the numbers that comparisons are about; z3 is imported where there are some.
    """
    if not any(map(_has_numbers, rules)):
        return Propositions(rules, roles, fresh)
    from fretc.analysis.arithmetic.alphabet import Cells

    return Cells(rules, roles, fresh, past)
