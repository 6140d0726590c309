"""What becomes of messages on a faulty connection; no agent is needed."""

from pathlib import Path

import pytest

from fretc.campaigns.agent_faults import COPIES, DELAY, FaultyConnection
from simulation.world.scenario import AgentFault, ScenarioError, load

S = 10**9


def arriving(kind: str, seconds: float = 0.4) -> list[list[int]]:
    """The numbers of the messages that arrive at each tenth of a second; message n is sent at n."""
    connection = FaultyConnection(AgentFault(kind, 0.2, seconds))  # type: ignore[arg-type]
    return [
        [message for _, message in connection.carried({"/scan": number}, number * S // 10)]
        for number in range(12)
    ]


def test_without_a_fault_each_message_arrives_at_once() -> None:
    connection = FaultyConnection(None)
    assert connection.carried({"/a": 1, "/b": 2}, 0) == [("/a", 1), ("/b", 2)]
    assert connection.carried({}, 1) == []
    assert connection.step(2) == 0


def test_messages_are_dropped_while_the_fault_lasts() -> None:
    assert arriving("dropped") == [[0], [1], [], [], [], [], *([n] for n in range(6, 12))]


def test_messages_are_delayed_and_none_is_lost() -> None:
    found = arriving("delayed", seconds=0.8)
    assert found[:2] == [[0], [1]]
    late = DELAY * 10 // S
    assert found[2:10] == [[n - late] if n >= 2 + late else [] for n in range(2, 10)]
    assert sorted(n for each in found for n in each) == [*range(12)]


def test_messages_are_duplicated() -> None:
    assert arriving("duplicated")[1:4] == [[1], [2] * COPIES, [3] * COPIES]


def test_messages_are_reordered_and_none_is_lost() -> None:
    assert arriving("reordered")[:7] == [[0], [1], [], [3, 2], [], [5, 4], [6]]


def test_a_clock_is_wrong_from_the_step_on() -> None:
    connection = FaultyConnection(AgentFault("clock stepped", 1.0, by=-5.0))
    assert [connection.step(at) for at in (0, S - 1, S, 9 * S)] == [0, 0, -5 * S, -5 * S]


@pytest.mark.parametrize(
    ("agent", "why"),
    [
        ('kind = "killed"', "`agent.at` is missing"),
        ('kind = "tired"\nat = 1', "`agent.kind` must be `killed` or "),
        ('kind = "killed"\nat = -1', "`agent.at` must not be below 0"),
        ('kind = "killed"\nat = 1\nby = 2', "`agent.by` must be given with `clock stepped`"),
        ('kind = "clock stepped"\nat = 1', "`agent.by` must be given with `clock stepped`"),
    ],
)
def test_a_fault_that_is_none_is_refused(tmp_path: Path, agent: str, why: str) -> None:
    path = tmp_path / "a.toml"
    path.write_text(f'title = "x"\n[agent]\n{agent}\n')
    with pytest.raises(ScenarioError, match=why.replace(".", r"\.")):
        load(str(path))
