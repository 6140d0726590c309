"""What an agent believes, pursues and did last, as signals of words: for pictures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from fretc.logs.signals.samples import AgentTrace, Samples

NOTHING = "nothing"
_LONGEST = 100


def word_signals(agents: Mapping[str, AgentTrace]) -> dict[str, Samples]:
    """`belief of sw`, `goal of sw`, `last action of sw` → its changes; no goal without goals."""
    return {
        f"{what} of {agent}": _samples(changes)
        for agent, trace in agents.items()
        for what, changes in _changes(trace)
        if changes
    }


def _changes(trace: AgentTrace) -> Iterator[tuple[str, Sequence[tuple[int, str]]]]:
    yield "belief", [(each.ns, _word(each.beliefs, "beliefs")) for each in trace.states]
    has_goals = any(each.goals for each in trace.states)
    goals = [(each.ns, _word(each.goals, "goals")) for each in trace.states]
    yield "goal", goals if has_goals else ()
    yield "last action", [(trace.states[0].ns, NOTHING), *trace.actions] if trace.actions else ()


def _word(names: Sequence[str], what: str) -> str:
    text = ", ".join(names) or NOTHING
    return text if len(text) <= _LONGEST else f"{len(names)} {what}"


def _samples(changes: Sequence[tuple[int, str]]) -> Samples:
    """The changes; of several at one time, the last."""
    last = dict(changes)
    words = tuple(dict.fromkeys(last.values()))
    places = {word: float(place) for place, word in enumerate(words)}
    return Samples(
        np.array([*last], np.int64), np.array([places[w] for w in last.values()]), words=words
    )
