"""The agent of the safety requirement, in MCAPL, as the safety function of a simulated mission.

The simulation does not run in real time: it waits until the agent has perceived each scan, has
acted, and sleeps. A simulated clock tells the agent the time. An agent that does not answer is
silent from then on, as one that was killed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time as times
from array import array
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from queue import Empty, Queue
from typing import Any

import numpy as np

from compiler.targets.ajpf import runtime
from compiler.targets.target import TargetOptions
from fretc.campaigns.agent_faults import HEAP, FaultyConnection, flood, kill
from fretc.campaigns.experiment import SAFETY_REQUIREMENT, declarations, project
from fretc.rosbridge.endpoint import Endpoint
from fretish.bindings.declarations import short_type
from fretish.system.processes import kill_all, pause_all, resume_all
from simulation.mission import EPOCH
from simulation.world.scenario import AgentFault, Scenario

CLOCK, TRACE = "/clock", "/agent/trace"
START = 60.0
"""Seconds for the agent to compile, to start and to connect."""
PATIENCE = 10.0
"""Seconds for the agent to perceive and to act."""
_REPEAT = 1.0
"""Seconds after which the time is sent again to an agent that does not answer."""
_SECOND = 10**9


class AgentError(Exception):
    """The agent cannot be started; the text says why."""


class AgentLink:
    """The running agent: it decides when to stop, and tells what it believes and does."""

    def __init__(
        self,
        process: subprocess.Popen[bytes],
        manifest: Mapping[str, Any],
        listen: Callable[[int], Endpoint],
        fault: AgentFault | None = None,
    ) -> None:
        """A link that is not connected yet.

        Args:
            process: the agent.
            manifest: of the emitted folder.
            listen: starts the endpoint again, at a port.
            fault: what goes wrong.
        """
        self.process = process
        self._fault, self._listen = fault, listen
        self._connection = FaultyConnection(fault)
        self._was_on = False
        self.speaks = True
        """Whether the agent has answered in time."""
        self._stop: str = manifest["stop"]
        self._topics = {signal["path"].partition(".")[0] for signal in manifest["signals"]}
        self._endpoint: Endpoint | None = None
        self._requested = True
        self._answers: Queue[tuple[int, bool]] = Queue()
        self._told: list[str] = []
        self._waiting: dict[str, Any] = {}
        self._now = 0

    def receive(self, topic: str, kind: str, message: Any) -> None:
        """A message of the agent, in the thread of the endpoint.

        Raises:
            ValueError: the message does not conform to its type.
        """
        data = message.get("data")
        if topic == self._stop:
            if not isinstance(data, bool):
                raise ValueError("data is no bool")
            self._requested = data
        elif topic == TRACE:
            record = json.loads(str(data))
            self._told.append(str(data))
            if record["action"] is None:
                self._answers.put((int(record["time"]), self._requested))

    def connected(self, endpoint: Endpoint) -> None:
        """Wait until the agent listens and answers.

        Raises:
            AgentError: it has ended, or does not connect in time.
        """
        self._await(endpoint)
        self._ask(1, START)
        if not self.speaks:
            raise AgentError(f"it has not answered within {START:g} seconds")

    def close(self) -> None:
        """End the connection."""
        if self._endpoint is not None:
            self._endpoint.close()

    def _await(self, endpoint: Endpoint) -> None:
        """Wait until the agent has subscribed to all topics."""
        self._endpoint = endpoint
        end = times.monotonic() + START
        while not all(endpoint.subscribers(topic) for topic in (CLOCK, *self._topics)):
            if self.process.poll() is not None:
                raise AgentError(f"it has ended with status {self.process.returncode}")
            if times.monotonic() > end:
                raise AgentError(f"it has not connected within {START:g} seconds")
            times.sleep(0.02)

    # What the simulation asks

    def hear(self, topic: str, message: Any, time: int) -> None:
        """A message of the robot; `time` in nanoseconds."""
        if topic in self._topics:
            self._waiting[topic] = _plain(message)

    def step(self, time: int) -> bool:
        """Whether the robot must stop now."""
        passed = time - EPOCH
        self._go_wrong(is_on=self._connection.is_on(passed))
        wrong = self._connection.step(passed)
        now = time + wrong
        demanded = self._ask(now if wrong else max(now, self._now + 1))
        waiting, self._waiting = self._waiting, {}
        arriving = self._connection.carried(waiting, passed)
        if arriving:
            for topic, message in arriving:
                self._publish(topic, message)
            demanded = self._ask(self._now + 1)
        return demanded

    def _go_wrong(self, *, is_on: bool) -> None:
        """Begin or end the fault."""
        if self._fault is None or is_on == self._was_on:
            return
        self._was_on = is_on
        assert self._endpoint is not None, "it is connected"
        match self._fault.kind:
            case "killed":
                if is_on:
                    kill(self.process)
            case "frozen":
                (pause_all if is_on else resume_all)(self.process)
                self.speaks = True  # It is to be waited for, before it counts as silent.
            case "out of memory":
                if is_on:
                    flood(lambda message: self._publish(min(self._topics), message), self.process)
            case "endpoint killed" if is_on:
                self._endpoint.close()
            case "endpoint killed":
                self._await(self._listen(self._endpoint.port))
                self.speaks = True
            case _:
                pass  # of the connection

    def told(self) -> Sequence[str]:
        """What the agent has told of itself since the last call, as JSON."""
        told, self._told = self._told, []
        return told

    def _publish(self, topic: str, message: Any) -> None:
        assert self._endpoint is not None, "it is connected"
        self._endpoint.publish(topic, message)

    def _ask(self, time: int, patience: float = PATIENCE) -> bool:
        """The stop request after all that was published, at a time."""
        self._now = time
        seconds, nanoseconds = divmod(time, _SECOND)
        now = {"clock": {"sec": seconds, "nanosec": nanoseconds}}
        self._publish(CLOCK, now)
        end = times.monotonic() + (patience if self.speaks else 0)
        again = times.monotonic() + _REPEAT
        while True:
            if times.monotonic() > again:  # It may have been lost with a connection.
                self._publish(CLOCK, now)
                again += _REPEAT
            if self.process.poll() is not None:
                end = 0.0
            try:
                answered, requested = self._answers.get(timeout=0.1 if self.speaks else 0.001)
            except Empty:
                if times.monotonic() > end:
                    self.speaks = False
                    return True
                continue
            if time <= answered < time + _SECOND:  # Its clock may have been ahead before.
                self.speaks = True
                return requested


def _plain(message: Any) -> Any:
    """A message as the endpoint takes it."""
    if isinstance(message, np.ndarray):
        return array(message.dtype.char, message.tobytes())
    fields = getattr(message, "__dataclass_fields__", None)
    if fields is None:
        return message
    return {name: _plain(getattr(message, name)) for name in fields if name != "__msgtype__"}


@contextmanager
def agent(scenario: Scenario, types: Mapping[str, str]) -> Iterator[AgentLink]:
    """The agent of R1, started and connected; it ends with the context.

    Args:
        scenario: says how far is too close, and what goes wrong with the agent.
        types: topic → ROS type of the robot's topics.

    Raises:
        AgentError: MCAPL, Java or the agent cannot be used.
    """
    (requirement,) = (r for r in project().formalized if r.id == SAFETY_REQUIREMENT)
    requirement = replace(requirement, declarations=declarations(scenario.safety.threshold))
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="fretc-agent-")))
        for artifact in runtime.emit([requirement], TargetOptions()):
            path = folder / artifact.path.name
            path.write_text(artifact.text, encoding="utf-8")
        manifest = json.loads((folder / "manifest.json").read_text(encoding="utf-8"))
        errors = stack.enter_context((folder / "errors.txt").open("w+b"))
        late: list[AgentLink] = []
        known = {topic: short_type(kind) for topic, kind in types.items()}

        def listen(port: int = 0) -> Endpoint:
            return Endpoint(
                known, lambda *message: late[0].receive(*message) if late else None, port=port
            )

        endpoint = stack.enter_context(listen())
        process = subprocess.Popen(
            [sys.executable, str(folder / "run.py"), "--url", endpoint.url]
            + ["--clock", CLOCK, "--trace", TRACE],
            env={**os.environ, "AGENT_JAVA_OPTIONS": _java_options(scenario)},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=errors,
            start_new_session=True,
        )
        stack.callback(_end, process)
        link = AgentLink(process, manifest, listen, scenario.agent)
        stack.callback(link.close)
        late.append(link)
        try:
            link.connected(endpoint)
        except AgentError as error:
            errors.seek(0)
            lines = errors.read().decode(errors="replace").strip().splitlines()
            said = next((line for line in lines if line.startswith("error: ")), "")
            raise AgentError(said.removeprefix("error: ") or str(error)) from error
        yield link


def _java_options(scenario: Scenario) -> str:
    fault = scenario.agent
    heap = HEAP if fault is not None and fault.kind == "out of memory" else ""
    return f"{os.environ.get('AGENT_JAVA_OPTIONS', '')} {heap}".strip()


def _end(process: subprocess.Popen[bytes]) -> None:
    """End the agent; its script passes the signal on to Java."""
    if process.poll() is None:
        resume_all(process)
    process.terminate()
    try:
        process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        kill_all(process)
        process.wait()
