"""Check the peers against the definition, or print how fast they are."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from benchmarks.peers import PEERS, Peer, speed
from benchmarks.peers.checking import faults


def check(peers: Sequence[Peer]) -> int:
    """Print what disagrees; how much it is."""
    found = faults(peers)
    names = ", ".join(peer.name for peer in peers)
    print("\n".join(found) or f"agree with the definition at each tick: {names}")
    return len(found)


def table(peers: Sequence[Peer], ticks: int, runs: int, seed: int) -> None:
    """Print a line for each peer and workload."""
    print("Millions of ticks per second of CPU, medians.")
    print(f"{'peer':46} {'':3} {'ticks':>10} {'alone':>9} {'from NumPy':>11} {'by steps':>9}")
    for peer in peers:
        for name in sorted(peer.formulas):
            found = speed(peer, name, ticks, runs, seed)
            steps = f"{found.steps:9.3f}" if found.steps else f"{'-':>9}"
            print(
                f"{f'{peer.name} ({peer.version})':46} {name:3} {found.ticks:10}"
                f" {found.alone:9.3f} {found.from_numpy:11.3f} {steps}"
            )


def main() -> int:
    """Run what the arguments ask for."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.peers", description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare with the definition")
    parser.add_argument("--ticks", type=int, default=100_000)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--peer", default="", help="only peers whose name has this in it")
    asked = parser.parse_args()
    peers = [peer for peer in PEERS if asked.peer.lower() in peer.name.lower()]
    for peer in peers:
        if peer.missing():
            print(f"{peer.name}: {peer.missing()}")
    present = [peer for peer in peers if not peer.missing()]
    if asked.check:
        return 1 if check(present) else 0
    table(present, asked.ticks, asked.runs, asked.seed)
    return 0


if __name__ == "__main__":
    sys.exit(main())
