"""MCAPL's reasoning cycle, written down a second time: whole cycles over plain tuples and queues.

It shares nothing with `compiler/agents/model.py` but the reader of agents. A run is cut into
cycles: perceive, then one turn of one intention. What is believed is reported after each single
change, as the model checker sees it. Only what fretc's bundles use is here: actions, `+b`, `-b`,
guards.
"""

from collections.abc import Callable, Iterator
from itertools import combinations, permutations

from compiler.agents.gwendolen import Action, Agent, BeliefChange

Beliefs = frozenset[str]
Item = tuple[str, ...]
"""In the queue: ("percept", "+a"), ("event", "+a"), or ("plan", deeds still to be done...)."""
State = tuple[Beliefs, bool, Beliefs, Beliefs, tuple[Item, ...]]
"""What is shown, whether that was seen, beliefs of percepts, of the agent, and the queue."""
Cycle = tuple[tuple[Beliefs, ...], State]
"""What is believed at each of its states but the first, and how it ends."""


class Machine:
    """One agent with its environment.

    Args:
        agent: which one.
        percepts: what is drawn freely.
        in_turn: whether each percept waits in the queue; else all are believed before a turn.
        orders: in which orders percepts that come or go at once are taken.
    """

    def __init__(
        self,
        agent: Agent,
        percepts: tuple[str, ...],
        in_turn: bool,
        orders: Callable[[list[str]], list[tuple[str, ...]]] = lambda names: [*permutations(names)],
    ) -> None:
        self.plans = [
            (
                str(plan.event),
                [(guard.belief, guard.positive) for guard in plan.guards],
                tuple(map(_deed, plan.deeds)),
            )
            for plan in agent.plans
        ]
        sizes = range(len(percepts) + 1)
        self.draws = [frozenset(c) for n in sizes for c in combinations(percepts, n)]
        self.in_turn, self.orders = in_turn, orders

    def begin(self) -> list[State]:
        return [(drawn, False, frozenset(), frozenset(), ()) for drawn in self.draws]

    def cycles(self, state: State) -> Iterator[Cycle]:
        for told, (shown, seen, sensed, own, queue) in self.perceived(state):
            if queue:
                turn = self.turn(shown, sensed, own, queue[0], queue[1:])
                for beliefs, after in turn:
                    yield (*told, *beliefs), (after[0], seen and after[1], *after[2:])
            else:
                for drawn in self.draws:
                    silent = seen and not shown and not drawn
                    yield told, (drawn, silent, sensed, own, ())

    def perceived(self, state: State) -> Iterator[Cycle]:
        shown, seen, sensed, own, queue = state
        if seen:
            yield (), state
            return
        for gone in self.orders(sorted(sensed - shown)):
            for come in self.orders(sorted(shown - sensed)):
                now, told, waiting = sensed, [], list(queue)
                for change in (*(f"-{name}" for name in gone), *(f"+{name}" for name in come)):
                    if self.in_turn:
                        if ("percept", change) not in waiting:
                            waiting.append(("percept", change))
                        continue
                    now = _with(now, change)
                    told.append(now | own)
                    waiting.append(("event", change))
                yield tuple(told), (shown, True, now, own, tuple(waiting))

    def turn(
        self, shown: Beliefs, sensed: Beliefs, own: Beliefs, item: Item, queue: tuple[Item, ...]
    ) -> Iterator[Cycle]:
        kind, *rest = item
        if kind == "percept":
            after = _with(sensed, rest[0])
            raised = (("event", rest[0]),) if after != sensed else ()
            yield (after | own,), (shown, True, after, own, (*queue, *raised))
            return
        deeds = tuple(rest)
        if kind == "event":
            deeds = self.planned(rest[0], sensed | own)
            if not deeds:
                yield (), (shown, True, sensed, own, queue)
                return
        deed, left = deeds[0], deeds[1:]
        again: tuple[Item, ...] = (("plan", *left),) if left else ()
        if deed[0] not in "+-":
            for drawn in self.draws:
                silent = not shown and not drawn
                yield (), (drawn, silent, sensed, own, (*queue, *again))
            return
        after = _with(own, deed)
        raised = (("event", deed),) if after != own else ()
        # The event is put behind what waits; the rest of this plan comes back at the next choice.
        yield (sensed | after,), (shown, True, sensed, after, (*queue, *raised, *again))

    def planned(self, event: str, beliefs: Beliefs) -> tuple[str, ...]:
        for heard, guards, deeds in self.plans:
            if heard == event and all((name in beliefs) is wanted for name, wanted in guards):
                return deeds
        return ()


def _deed(deed: Action | BeliefChange) -> str:
    return str(deed)


def _with(beliefs: Beliefs, change: str) -> Beliefs:
    return beliefs | {change[1:]} if change[0] == "+" else beliefs - {change[1:]}


def answers(
    machine: Machine, trigger: Callable[[Beliefs], bool], response: str, edges: bool, limit: int
) -> bool:
    """Whether in every run each trigger is followed by the response, or has it already.

    Args:
        machine: whose runs.
        trigger: of what is believed.
        response: a belief.
        edges: whether only a trigger that was not there in the state before counts.
        limit: of states, an assertion.
    """
    runs: dict[tuple[State, bool, bool], set[tuple[State, bool, bool]]] = {}
    todo = [(state, False, False) for state in machine.begin()]
    while todo:
        node = todo.pop()
        if node in runs:
            continue
        state, before, was_pending = node
        runs[node] = set()
        assert len(runs) < limit, "too many states"
        for told, after in machine.cycles(state):
            last, pending = before, was_pending
            for beliefs in told:
                now = trigger(beliefs)
                pending = (pending or (now and not (edges and last))) and response not in beliefs
                last = now
            # A trigger that stays asks again in each state, unless only its coming counts.
            runs[node].add((after, last, pending))
        todo.extend(runs[node])
    return not _lasting({n: {m for m in after if m[2]} for n, after in runs.items() if n[2]})


def _lasting(edges: dict[tuple[State, bool, bool], set[tuple[State, bool, bool]]]) -> bool:
    """Whether some node has an endless way: what has none is peeled off from the ends."""
    before: dict[object, list[tuple[State, bool, bool]]] = {}
    ways = {node: len(after) for node, after in edges.items()}
    for node, after in edges.items():
        for following in after:
            before.setdefault(following, []).append(node)
    ends = [node for node, count in ways.items() if not count]
    for end in ends:
        for node in before.get(end, ()):
            ways[node] -= 1
            if not ways[node]:
                ends.append(node)
    return len(ends) < len(edges)
