"""A monitor in JavaScript, run by Node, as a machine whose state can be saved and restored.

Node explores the states: a message asks for the steps of one state, and the answer contains those
of many following states, so that there are few messages. A state is the cells and marks on which
the requirement depends, in ticks relative to the present one; the fixed part of the text uses the
tick number only in differences.
"""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import field
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from compiler.formalization.letters import Valuation
from fretc.verification.compiled.plan import RequirementPosition
from fretc.verification.compiled.readings import ApproximationReading, judged
from fretc.verification.compiled.tools import conversation, no_answer
from fretc.verification.monitor.approximations import Letter
from fretc.verification.monitor.equivalence import Judgement
from fretish.classes.frozen import dataclass
from monitors.kernel.verdicts import Truth

FLAGS = ("--disallow-code-generation-from-strings",)
_TRUTHS: tuple[Truth, ...] = (False, True, None)
_EXPLORER = """
import { createInterface } from "node:readline";
import { init, judge, REQUIREMENTS } from "./monitor.mjs";

const AHEAD = 20_000; // steps in one answer, beside those that are asked for
const APPROXIMATIONS = ["certain", "possible"];
const TRUTHS = ["trigger", "violation", "obligationPending", "satisfiedForever", "answer"];
const code = (value) => [false, true, null].indexOf(value);

/** All states that a plan reaches, found as they are asked for. */
function search({ outcome, cells, windows, ages, approximations, letters }) {
  const { deadlineTicks } = REQUIREMENTS[outcome];
  const now = Math.max(deadlineTicks ?? 0, ...windows.map(([, hi]) => hi)) + 2;
  const machine = init();
  const states = [], places = new Map(), told = [], readings = new Map();
  let done = 0;

  const saved = (approximation, tick) => {
    const marks = approximation.marks[outcome];
    return [
      cells.map((name) => approximation[name]),
      windows.map(([name, hi]) => {
        const { intervals, first } = approximation[name];
        return intervals.slice(first).map(([a, b]) => [Math.min(tick - a, hi), tick - b]);
      }),
      [marks.broken >= 0, marks.violationInevitable >= 0],
      ages.map((name) => (marks[name] < 0 ? -1 : Math.min(tick - marks[name], deadlineTicks + 1))),
    ];
  };
  const load = (approximation, [values, intervals, latched, old]) => {
    cells.forEach((name, i) => (approximation[name] = values[i]));
    windows.forEach(([name], i) => {
      const all = intervals[i].map(([a, b]) => [now - a, now - b]);
      approximation[name] = { intervals: all, first: 0 };
    });
    const [broken, violationInevitable] = latched.map((is) => (is ? 0 : -1));
    const marks = { broken, violationInevitable, last: -1, open: -1 };
    ages.forEach((name, i) => (marks[name] = old[i] < 0 ? -1 : now - old[i]));
    approximation.marks[outcome] = marks;
  };
  const exact = (_, value) => {
    if (typeof value !== "number") return value === undefined ? "undefined" : value;
    return Object.is(value, -0) ? "-0" : String(value);
  };
  const placed = (tick) => {
    const parts = approximations.map((i) => saved(machine[APPROXIMATIONS[i]], tick));
    const key = JSON.stringify(parts, exact);
    if (!places.has(key)) {
      places.set(key, states.length);
      states.push(parts);
    }
    return places.get(key);
  };
  const reading = (said, marks, tick) => [
    said.deadline === null ? -1 : Math.max(-1, said.deadline - tick),
    code(said.firstViolation !== null),
    marks.broken >= 0 ? 1 : code(said.violatedIfEnded),
    ...TRUTHS.map((name) => code(said[name])),
  ];
  const outcomeOf = (tick, { certain, possible, verdict, finite, obligationPending }) => {
    const of = { certain, possible };
    const parts = APPROXIMATIONS.map(
      (name) => reading(of[name], machine[name].marks[outcome], tick),
    );
    const facts = APPROXIMATIONS.map((name) => {
      const { broken, violationInevitable } = machine[name].marks[outcome];
      const pending = of[name].trigger || of[name].obligationPending;
      return [broken >= 0, violationInevitable >= 0, of[name].violatedIfEnded, pending];
    });
    const isReal = facts[0].every((fact, i) => !fact || facts[1][i]);
    const said = [String(verdict), code(finite), code(obligationPending)];
    const key = JSON.stringify([...parts, ...said, isReal]);
    if (!readings.has(key)) {
      readings.set(key, readings.size);
      told.push(key);
    }
    return readings.get(key);
  };
  const step = (state, letter) => {
    approximations.forEach((which, i) => load(machine[APPROXIMATIONS[which]], states[state][i]));
    machine.tick = now;
    const said = judge(machine, letter)[outcome];
    return [placed(machine.tick), outcomeOf(machine.tick, said)];
  };

  placed(machine.tick);
  return (until) => {
    const rows = [];
    told.length = 0;
    for (let ahead = AHEAD; done < states.length && (done <= until || ahead > 0); done += 1) {
      rows.push(letters.map((letter) => step(done, letter)));
      ahead -= letters.length;
    }
    return { rows, told: told.map((key) => JSON.parse(key)) };
  };
}

let explore;
for await (const line of createInterface({ input: process.stdin })) {
  const { plan, until } = JSON.parse(line);
  if (plan !== undefined) explore = search(plan);
  process.stdout.write(`${JSON.stringify(explore(until))}\\n`);
}
"""


@dataclass(frozen=True, slots=True)
class Module:
    """A checked module."""

    program: str
    folder: Path
    """Folder that the caller removes, also if Node or fretc is killed."""
    cells: tuple[str, ...]
    """All cells of an approximation."""
    windows: Mapping[str, int]
    """Windows with the maximum age of their values."""
    ages: Mapping[int, tuple[str, ...]]
    """For each requirement, the marks whose age it reads."""

    @contextmanager
    def running(self, plan: RequirementPosition) -> Iterator[ModuleRequirement]:
        """The module, run by Node until the end of the context.

        Raises:
            ToolError: Node cannot be started, or ends.
        """
        complaints = self.folder / "errors.txt"
        with complaints.open("wb") as errors, _started(self, errors) as node:
            yield ModuleRequirement(self, plan, node, complaints)


def placed(text: str, folder: Path) -> None:
    """The module and the exploring program in the folder."""
    (folder / "monitor.mjs").write_text(text, encoding="utf-8")
    (folder / "explorer.mjs").write_text(_EXPLORER, encoding="utf-8")


def _started(module: Module, errors: Any) -> AbstractContextManager[subprocess.Popen[bytes]]:
    """Start Node without `NODE_OPTIONS` of the user, which could load modules."""
    plain = {name: value for name, value in os.environ.items() if not name.startswith("NODE_")}
    command = [module.program, *FLAGS, "explorer.mjs"]
    return conversation("Node", command, module.folder, plain, errors)


class ModuleRequirement:
    """A requirement of a module."""

    def __init__(
        self,
        module: Module,
        plan: RequirementPosition,
        process: subprocess.Popen[bytes],
        errors: Path,
    ) -> None:
        """The requirement before any exploration."""
        self._module, self._plan = module, plan
        self._process, self._errors = process, errors

    def delayed(self, *, is_possible: bool) -> None:
        """None: its windows are those of the monitor in Python, and are explored with all bits."""

    def judging(self) -> NodeMonitorMachine:
        """A machine of both approximations, before the first tick."""
        letters = tuple(product((False, True), repeat=len(self._plan.inputs)))
        return NodeMonitorMachine(self._table((0, 1), letters))

    def approximation(self, letters: Sequence[Letter], *, is_possible: bool) -> TableApproximation:
        """One of the approximations, before the first tick."""
        return TableApproximation(
            self._table((int(is_possible),), letters), is_possible=is_possible
        )

    def _table(self, approximations: Sequence[int], letters: Sequence[Letter]) -> StateTable:
        module, plan = self._module, self._plan
        needed = [name for name in module.cells if name in plan.needed]
        rows = []
        for letter in letters:
            row: list[Truth] = [False] * plan.width
            for value, index in zip(letter, plan.inputs, strict=True):
                if index >= 0:
                    row[index] = value
            rows.append(row)
        order = {
            "outcome": plan.outcome,
            "cells": [name for name in needed if name not in module.windows],
            "windows": [(name, module.windows[name]) for name in needed if name in module.windows],
            "ages": module.ages[plan.outcome],
            "approximations": approximations,
            "letters": rows,
        }
        table = StateTable(self, {letter: i for i, letter in enumerate(letters)})
        table.take(self.ask({"plan": order, "until": 0}))
        return table

    def ask(self, order: Mapping[str, Any]) -> Any:
        """The answer to a message.

        Raises:
            ToolError: Node does not answer.
        """
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        with suppress(BrokenPipeError):  # Then Node has ended without an answer.
            self._process.stdin.write(f"{json.dumps(order)}\n".encode())
            self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line.endswith(b"\n"):
            raise no_answer("Node", self._process, self._errors, ("Error", "FATAL"))
        return json.loads(line)


class Observation(NamedTuple):
    """Result of a step."""

    approximations: tuple[ApproximationReading, ApproximationReading]
    """Certain and possible value."""
    verdicts: tuple[object, ...]
    """Verdict, FRET's finite verdict, and open obligation."""
    is_real: bool
    """Whether a certain value is also possible; an approximation combined with any other one may be
    in a state that it cannot have at this tick."""


@dataclass(slots=True)
class StateTable:
    """The explored states, by number, and their steps."""

    node: ModuleRequirement
    letters: Mapping[Letter, int]
    rows: list[list[tuple[int, int]]] = field(default_factory=list)
    """For each state and valuation the next state, and the number of the observation."""
    outcomes: list[Observation] = field(default_factory=list)

    def take(self, answer: Any) -> None:
        """Add the steps of further states."""
        self.rows += answer["rows"]
        for certain, possible, verdict, *truths, is_real in answer["told"]:
            approximations = ApproximationReading(*certain), ApproximationReading(*possible)
            both = (_TRUTHS[each] if each >= 0 else "no truth value" for each in truths)
            self.outcomes.append(Observation(approximations, (verdict, *both), is_real))

    def step(self, state: int, letter: Letter) -> tuple[int, int]:
        """The next state, and the number of the observation."""
        if state >= len(self.rows):
            self.take(self.node.ask({"until": state}))
        return self.rows[state][self.letters[letter]]


class NodeMonitorMachine:
    """Both approximations, for known propositions."""

    def __init__(self, table: StateTable) -> None:
        """The machine before the first tick."""
        self._table, self._state = table, 0

    def save(self) -> int:
        """Number of the state."""
        return self._state

    def load(self, state: Any) -> None:
        """Restore a state."""
        self._state = state

    def step(self, letter: Valuation) -> Judgement:
        """The verdict after a tick, and FRET's finite verdict."""
        self._state, told = self._table.step(self._state, letter)
        verdict, finite, _ = self._table.outcomes[told].verdicts
        return str(verdict), finite is True


class TableApproximation:
    """One approximation; the state of the other approximation is arbitrary."""

    def __init__(self, table: StateTable, *, is_possible: bool) -> None:
        """The approximation before the first tick; with `is_possible` the possible one."""
        self._table, self._approximation, self._state = table, int(is_possible), 0

    def save(self) -> int:
        """Number of the state."""
        return self._state

    def step(self, state: int, letter: Letter) -> tuple[object, ...]:
        """The reading after a tick, and whether the verdict follows from both approximations."""
        self._state, number = self._table.step(state, letter)
        told = self._table.outcomes[number]
        follows = not told.is_real or told.verdicts == judged(*told.approximations)
        return (*told.approximations[self._approximation], follows)
