"""From a near scan to the stop request of the agent in MCAPL, at several rates of scans.

    AJPF_HOME=/path/to/mcapl python -m benchmarks.agent_latency [--obstacles 100]

The endpoint sends scans of 900 beams; now and then an obstacle is near for a quarter of a second.
Wall time from before the first near scan is sent to the arrival of the stop request; CPU time of
the Java process. No test asserts them.
"""

from __future__ import annotations

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from array import array
from pathlib import Path
from queue import Empty, Queue

from compiler.project.folder import load
from compiler.targets.ajpf import runtime
from compiler.targets.target import TargetOptions
from fretc.rosbridge.endpoint import Endpoint

STOP = "/gwendolen_control"
FAR, NEAR = 9.0, 0.31
LASTS = 0.25
"""Seconds for which an obstacle is near, and then for which it is far."""


class Lidar:
    """Sends scans at a rate, and takes the stop requests."""

    def __init__(self, endpoint: Endpoint, stops: Queue[tuple[float, bool]], rate: int) -> None:
        self._endpoint, self._stops, self._period = endpoint, stops, 1 / rate
        self._next = time.perf_counter()
        self.sent = 0

    def show(self, distance: float, seconds: float) -> float | None:
        """Seconds until the stop request was as the distance demands; None: it never was."""
        while not self._stops.empty():
            self._stops.get()
        began, answer = time.perf_counter(), None
        while time.perf_counter() < began + seconds:
            self._endpoint.publish("/scan", _scan(distance))
            self.sent += 1
            self._next = max(self._next + self._period, time.perf_counter() - 1)
            time.sleep(max(0.0, self._next - time.perf_counter()))
            while answer is None:
                try:
                    at, requested = self._stops.get_nowait()
                except Empty:
                    break
                answer = at - began if requested is (distance == NEAR) else None
        return answer


def _scan(distance: float) -> dict[str, object]:
    ranges = array("f", [FAR]) * 900
    ranges[450] = distance
    now = time.time_ns()
    return {
        "header": {"stamp": {"sec": now // 10**9, "nanosec": now % 10**9}},
        "angle_min": -3.1415,
        "angle_increment": 0.00698,
        "range_min": 0.05,
        "range_max": 30.0,
        "ranges": ranges,
    }


def cpu(process: subprocess.Popen[bytes]) -> float:
    """CPU seconds of the children of run.py."""
    own = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    children = own.read_text(encoding="utf-8").split()
    texts = (Path(f"/proc/{child}/stat").read_text(encoding="utf-8") for child in children)
    fields = [text.rpartition(")")[2].split() for text in texts]
    return sum(int(f[11]) + int(f[12]) for f in fields) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--obstacles", type=int, default=100)
    options = parser.parse_args()
    stops: Queue[tuple[float, bool]] = Queue()

    def receive(topic: str, kind: str, message: dict[str, bool]) -> None:
        if topic == STOP:
            stops.put((time.perf_counter(), message["data"]))

    print("| encoding, scans a second | sent | stop, ms: p50 | p99 | max | no answer | CPU |")
    print("|---" * 7 + "|")
    project = load(["requirements/r1.fret"])
    with tempfile.TemporaryDirectory() as folder:
        for artifact in runtime.emit(project.formalized, TargetOptions()):
            (Path(folder) / artifact.path.name).write_text(artifact.text, encoding="utf-8")
        for compression in ("cbor", "none"):
            with Endpoint({"/scan": "sensor_msgs/LaserScan"}, receive) as endpoint:
                command = [sys.executable, f"{folder}/run.py", "--url", endpoint.url]
                process = subprocess.Popen(
                    [*command, "--compression", compression],
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                )
                try:
                    while not endpoint.subscribers("/scan"):
                        assert process.poll() is None, "set AJPF_HOME"
                        time.sleep(0.1)
                    Lidar(endpoint, stops, 20).show(FAR, 5)
                    for rate in (10, 100, 1000):
                        measure(endpoint, stops, process, f"{compression}, {rate}", options)
                finally:
                    process.terminate()
                    process.wait()


def measure(
    endpoint: Endpoint,
    stops: Queue[tuple[float, bool]],
    process: subprocess.Popen[bytes],
    title: str,
    options: argparse.Namespace,
) -> None:
    """A line of the table."""
    lidar = Lidar(endpoint, stops, int(title.rpartition(" ")[2]))
    began, before = time.perf_counter(), cpu(process)
    answers = []
    for _ in range(options.obstacles):
        answers.append(lidar.show(NEAR, LASTS))
        lidar.show(FAR, LASTS)
    took = time.perf_counter() - began
    times = [1000 * answer for answer in answers if answer is not None]
    centiles = statistics.quantiles(times, n=100, method="inclusive")
    spread = f"{centiles[49]:.1f} | {centiles[98]:.1f} | {max(times):.1f}"
    share = 100 * (cpu(process) - before) / took
    lost = len(answers) - len(times)
    print(f"| {title} | {lidar.sent / took:.0f} | {spread} | {lost} | {share:.0f} % |", flush=True)


if __name__ == "__main__":
    main()
