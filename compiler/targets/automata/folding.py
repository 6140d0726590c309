"""Folded charts: states that differ only in their counter are one node.

A bound of 1 000 ticks becomes one node `open: k = 1..1000`, with conditions on k and changes of k
on its edges. The folded chart is readable and exact.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import TRAITS, Trait
from compiler.formalization.reference import Letter, ReferenceState
from compiler.targets.automata.chart import START, Chart, chart, kind, words
from fretish.classes.frozen import dataclass

VIOLATED, SATISFIED = "violated", "satisfied"
OPEN = ("open", "open twice", "pending")
"""The names of nodes that count."""


@dataclass(frozen=True, slots=True)
class FoldedState:
    """States that differ only in their counter."""

    name: str
    words: tuple[str, ...]
    counts: tuple[int, int] | None
    """The least and the greatest k; None if nothing is counted."""
    accepts: bool
    """Whether a run that stays in the node for ever is accepted."""


@dataclass(frozen=True, slots=True)
class Edge:
    """An edge from all states of a node for which the condition holds."""

    source: str
    target: str
    letters: frozenset[Letter]
    """The letters, each of mode, condition, response and stop condition."""
    condition: str = ""
    """The condition on k, or on past triggers; empty: none."""
    change: str = ""
    """The change of k; empty if the target counts nothing, or k stays."""


@dataclass(frozen=True, slots=True)
class FoldedChart:
    """A deterministic folded chart; deciding nodes have no edges."""

    nodes: tuple[FoldedState, ...]
    edges: tuple[Edge, ...]
    start: str


def folded_chart(requirement: FormalizedRequirement) -> FoldedChart:
    """The folded chart of a requirement; an initial node that equals another one is merged with it.

    Raises:
        TooManyStatesError: the automaton has more than `chart.MOST_STATES` states.
    """
    return _without_twin(_Folding(requirement, chart(requirement)).result())


class _Folding:
    def __init__(self, requirement: FormalizedRequirement, unfolded: Chart) -> None:
        self.chart = unfolded
        self.demanded = kind(requirement)
        self.scoped = requirement.sentence.scope is not None
        self.ticks = unfolded.template.ticks
        self.traits = TRAITS[self.demanded]
        triggered = requirement.sentence.condition is not None
        self.registers = Trait.REGISTERS in self.traits and triggered
        self.groups: dict[object, list[int]] = {}
        for index, state in enumerate(unfolded.states):
            self.groups.setdefault(self._key(index, state), []).append(index)
        self.names = {
            index: f"s{number}"
            for number, members in enumerate(self.groups.values())
            for index in members
        }
        self.names |= {unfolded.violated: VIOLATED, unfolded.satisfied: SATISFIED}

    def _key(self, index: int, state: ReferenceState) -> object:
        if index == self.chart.start:
            return "start"
        count = state.counted
        if self.registers:
            count = 0  # conditions on edges show its triggers
        elif Trait.COUNTS in self.traits:
            count = (count > 0) - (count < 0)
        return state.phase, state.held, count

    def result(self) -> FoldedChart:
        edges = [
            edge
            for members in self.groups.values()
            for edge in self._edges(self.names[members[0]], members)
        ]
        nodes = [self._node(members) for members in self.groups.values()]
        for index, name in ((self.chart.violated, VIOLATED), (self.chart.satisfied, SATISFIED)):
            if self.chart.has(index):
                nodes.append(FoldedState(name, (name,), None, name == SATISFIED))
        return FoldedChart(tuple(nodes), tuple(edges), self.names[self.chart.start])

    def _count(self, index: int) -> int | None:
        """The counter of a state: k ticks, or the register of triggers."""
        if index >= len(self.chart.states):
            return None
        count = self.chart.states[index].counted
        if self.registers:
            return count
        if Trait.COUNTS not in self.traits or count == 0:
            return None
        if Trait.REGISTERS in self.traits:
            return count.bit_length()
        return abs(count)

    def _node(self, members: Sequence[int]) -> FoldedState:
        state = self.chart.states[members[0]]
        phrases = list(words(self.demanded, self.chart.template, state))
        counts = sorted(k for index in members if (k := self._count(index)) is not None)
        if counts and not self.registers:  # one k stands for the ticks of all members
            word = 1 if self.scoped else 0
            phrases[word] = "pending" if Trait.DOWN in self.traits else OPEN[state.counted < 0]
        return FoldedState(
            self.names[members[0]],
            tuple(phrases),
            (counts[0], counts[-1]) if counts and not self.registers else None,
            all(self.chart.accepts(index) for index in members),
        )

    def _edges(self, source: str, members: Sequence[int]) -> Iterator[Edge]:
        """The edges of a node; letters with the same target and condition share an edge."""
        edges: dict[tuple[str, str, str], list[Letter]] = {}
        for place, letter in enumerate(self.chart.letters):
            targets: dict[str, list[tuple[int, int]]] = {}
            for index in members:
                after = self.chart.moves[index][place]
                targets.setdefault(self.names[after], []).append((index, after))
            for target, moves in targets.items():
                condition = self._condition([index for index, _ in moves], members)
                key = (target, condition, self._change(moves))
                edges.setdefault(key, []).append(letter)
        for (target, condition, change), letters in edges.items():
            yield Edge(source, target, frozenset(letters), condition, change)

    def _condition(self, chosen: Sequence[int], members: Sequence[int]) -> str:
        if len(chosen) == len(members):
            return ""
        counts = sorted(k for index in chosen if (k := self._count(index)) is not None)
        every = sorted(k for index in members if (k := self._count(index)) is not None)
        if self.registers:
            due = {k >> self.ticks & 1 for k in counts}
            assert len(due) == 1, "the trigger of n + 1 ticks ago decides"
            word = "an" if due == {1} else "no"
            return f"{word} unanswered trigger {_ago(self.ticks + 1)}"
        assert counts in (every[: len(counts)], every[-len(counts) :]), (
            "one end of the count decides"
        )
        if len(counts) == 1:
            return f"k = {counts[0]}"
        return f"k <= {counts[-1]}" if counts[0] == every[0] else f"k >= {counts[0]}"

    def _change(self, moves: Iterable[tuple[int, int]]) -> str:
        if self.registers:
            return ""
        changes = {(self._count(index), self._count(after)) for index, after in moves}
        after = {k for _, k in changes}
        if after == {None}:
            return ""
        if len(after) == 1:
            return f"k := {after.pop()}"
        steps = {k - before for before, k in changes if before is not None and k is not None}
        assert len(steps) == 1, "all counters go the same way"
        step = steps.pop()
        return "" if step == 0 else f"k := k {'+' if step > 0 else '-'} {abs(step)}"


def _ago(ticks: int) -> str:
    return "1 tick ago" if ticks == 1 else f"{ticks} ticks ago"


def _without_twin(picture: FoldedChart) -> FoldedChart:
    """The chart without its initial node if another node has equal acceptance and edges."""
    by_name = {node.name: node for node in picture.nodes}
    start = by_name[picture.start]
    if start.words != (START,):
        return picture
    for node in picture.nodes:
        same = node is not start and node.counts is None and node.accepts is start.accepts
        if same and _leaving(picture, start.name) == _leaving(picture, node.name):
            nodes = tuple(other for other in picture.nodes if other is not start)
            edges = tuple(edge for edge in picture.edges if edge.source != start.name)
            return FoldedChart(nodes, edges, node.name)
    return picture


def _leaving(picture: FoldedChart, name: str) -> set[Edge]:
    return {replace(edge, source="") for edge in picture.edges if edge.source == name}
