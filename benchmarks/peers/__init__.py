"""Other people's monitors, to be timed in the same run as ours.

PEERS     the adaptors; `peer.missing()` says why one cannot run here
WORKLOADS the formulas, with `columns(ticks, seed)`
rate      millions of ticks per second of CPU of one evaluation
speed     those of a peer on a workload
"""

from benchmarks.peers.copilot_code import COPILOT, COUNTERS
from benchmarks.peers.peer import Evaluation, Peer, Step
from benchmarks.peers.reelay_monitors import Reelay
from benchmarks.peers.rtamt_monitors import RtamtOffline, RtamtOnline
from benchmarks.peers.speed import Speed, rate, speed, stepping
from benchmarks.peers.spot_automata import Spot
from benchmarks.peers.workloads import WORKLOADS, Columns, Workload, letters, rows

__all__ = [
    "PEERS",
    "WORKLOADS",
    "Columns",
    "Evaluation",
    "Peer",
    "Speed",
    "Step",
    "Workload",
    "letters",
    "rate",
    "rows",
    "speed",
    "stepping",
]

PEERS: tuple[Peer, ...] = (COPILOT, COUNTERS, Reelay(), Spot(), RtamtOffline(), RtamtOnline())
