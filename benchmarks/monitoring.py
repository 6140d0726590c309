"""Generated monitors: whole traces and single ticks, against each other's bounds and against peers.

    python -m benchmarks.monitoring [--ticks N] [--no-peers]

Prints tables of CPU time; no test asserts them. Peers are an extra: pip install -e '.[peers]'.
"""

from __future__ import annotations

import argparse
import gc
import operator
import time
import tracemalloc
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from benchmarks.figures import Figure
from benchmarks.peers import PEERS, WORKLOADS, Columns, Evaluation, Peer, rate, speed
from benchmarks.timing import seconds
from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.past import MonitorSpec
from compiler.logic import formula as f
from compiler.targets.python.monitor import text
from fretc.logs.signals.traces import bits
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from monitors.kernel import Column, Monitor, evaluate
from monitors.kernel.columns import once, reuse_memory
from monitors.kernel.verdicts import PENDING, VIOLATED, Verdict
from monitors.loading import load

STEPS = 200_000
"""Ticks of which single steps are timed."""

# What is monitored ----------------------------------------------------------------------------


def requirement(sentence: str, id: str = "R1") -> FormalizedRequirement:
    made, said = formalize(RequirementEntry(id, Source("b.fret", sentence).span()), None)
    assert made is not None, said
    return made


def always(trigger: f.Formula, demanded: f.Formula, id: str = "R1") -> FormalizedRequirement:
    """`H(trigger -> demanded)` as a monitor: FRETish has no `since` of its own."""
    violation = f.and_(trigger, f.not_(demanded))
    watch = MonitorSpec(
        trigger, violation, f.FALSE, f.FALSE, f.FALSE, f.FALSE, None, 0, renewed=False
    )
    return replace(requirement("whenever a sw shall immediately satisfy b", id), watch=watch)


A, B, C = f.Atom("a"), f.Atom("b"), f.Atom("c")


def workload_rules() -> Mapping[str, FormalizedRequirement]:
    return {
        "W1": requirement("whenever a sw shall eventually satisfy b"),
        "W2": requirement("whenever a sw shall within 10 ticks satisfy b"),
        "W3": always(A, f.once(B, f.Interval(0, 100))),
        "W4": always(f.and_(A, f.previous(f.not_(A))), f.since(f.not_(C), B)),
    }


def mixed(count: int, names: int = 12) -> list[FormalizedRequirement]:
    """W5: requirements of many forms, bounds to 1 000, on a few propositions."""
    forms = (
        "whenever p{0} sw shall within {n} ticks satisfy p{1}",
        "in p{2} mode, upon p{0} sw shall for {n} ticks satisfy p{1}",
        "upon p{0} sw shall until p{2} satisfy p{1}",
        "after p{2} mode, whenever p{0} sw shall immediately satisfy p{1}",
        "when not in p{2} mode, upon p{0} sw shall after {n} ticks satisfy p{1}",
        "only in p{2} mode sw shall eventually satisfy p{1}",
        "upon p{0} sw shall before p{2} satisfy p{1}",
        "before p{2} mode, whenever p{0} sw shall at the next timepoint satisfy p{1}",
        "whenever p{0} sw shall always satisfy p{1}",
        "upon p{0} sw shall eventually satisfy p{1}",
    )
    found = []
    for i in range(count):
        places = [(7 * i + 3 * k) % names for k in range(3)]
        bound = (10, 100, 1000)[i % 3] - i // len(forms) % 9
        found.append(requirement(forms[i % len(forms)].format(*places, n=bound), f"R{i + 1}"))
    return found


def monitor(*requirements: FormalizedRequirement) -> Monitor:
    return load("monitor.py", text(*requirements))


# Measuring ------------------------------------------------------------------------------------


def repeated(run: Callable[[], object], least: float = 0.02) -> float:
    """CPU time of one run, from as many as take some hundredths of a second."""
    start = time.process_time()
    run()
    count = max(1, int(least / max(time.process_time() - start, 1e-7)))

    def several() -> None:
        for _ in range(count):
            run()

    return seconds(several) / count


def from_numpy(columns: Columns) -> dict[str, Column]:
    """Boolean arrays, shape (ticks,), as one bit a tick."""
    return {name: Column(bits(values), 0) for name, values in columns.items()}


def truths(machine: Monitor, literals: Mapping[str, int], every: int) -> int:
    """The truth at each tick, as if the trace ended there: all that the peers tell.

    Nobody calls this of ours: `evaluate` is what a user calls.
    """
    (signals,) = machine.columns(every, **literals)
    broken = once(signals.violation, 0, None, every) if signals.violation else 0
    open_ended: int = signals.violated_if_ended
    return every ^ (broken | open_ended)


def verdict(machine: Monitor, columns: Mapping[str, Column], ticks: int) -> object:
    """A user's call that asks whether the trace is violated, and from where on."""
    (outcome,) = evaluate(machine, columns, ticks)
    return outcome.verdict, outcome.first_violation


def lists(machine: Monitor, columns: Mapping[str, Column], ticks: int) -> object:
    """A user's call that reads every list of the outcome."""
    (outcome,) = evaluate(machine, columns, ticks)
    return [
        tuple(each)
        for each in (
            outcome.violations,
            outcome.unknown,
            outcome.triggers,
            outcome.answers,
            outcome.open,
            outcome.uncertain,
        )
    ]


def literals_of(machine: Monitor, columns: Mapping[str, Column], every: int) -> dict[str, int]:
    return {
        name: columns[proposition].true if positive else every ^ columns[proposition].true
        for name, proposition, positive in machine.LITERALS
    }


def table(title: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    print(f"\n{title}")
    cells = [list(map(str, head)), *([str(cell) for cell in row] for row in rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    for row in cells:
        print("  " + "  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)))


# Whole traces ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class Rates:
    """Millions of ticks per second of a workload."""

    verdict: float
    """`evaluate`, verdict and first violation."""
    verdict_from_numpy: float
    """The same, with the conversion of Boolean arrays."""
    lists: float
    """`evaluate` and all lists."""
    truths: float
    """The truth at each tick alone."""


def offline(ticks: int) -> dict[str, Rates]:
    """What calls over whole traces cost, beside the truth alone and beside single operations."""
    found, calls, alone = {}, [], []
    reuse_memory()
    for name, made in workload_rules().items():
        machine = monitor(made)
        arrays = WORKLOADS[name].columns(ticks)
        columns, every = from_numpy(arrays), (1 << ticks) - 1
        literals = literals_of(machine, columns, every)
        a, b = columns["a"].true, columns["b"].true
        one, add = repeated(partial(operator.and_, a, b)), repeated(partial(operator.add, a, b))
        truth = repeated(partial(truths, machine, literals, every))
        short = repeated(partial(verdict, machine, columns, ticks))
        whole = repeated(partial(lists, machine, columns, ticks))
        converted = short + repeated(partial(from_numpy, arrays))
        rates = Rates(*(ticks / spent / 1e6 for spent in (short, converted, whole, truth)))
        found[name] = rates
        (outcome,) = evaluate(machine, columns, ticks)
        calls.append(
            (
                name,
                f"{short * 1e3:.2f}",
                f"{rates.verdict:,.0f}",
                f"{rates.verdict_from_numpy:,.0f}",
                f"{whole * 1e3:.1f}",
                f"{rates.lists:,.0f}",
                f"{len(outcome.triggers) + len(outcome.answers):,}",
            )
        )
        shares = f"{truth / one:.0f}", f"{truth / add:.1f}", f"{short / truth:.1f}"
        alone.append((name, f"{truth * 1e3:.3f}", f"{rates.truths:,.0f}", *shares))
    table(
        f"`evaluate` over {ticks:,} ticks, one core: verdict and first violation, or all lists",
        ("", "verdict ms", "M ticks/s", "from NumPy", "lists ms", "M ticks/s", "items in them"),
        calls,
    )
    table(
        "The truth at each tick alone, which only the peers tell",
        ("", "ms", "M ticks/s", "x a & b", "x a + b", "verdict: times that"),
        alone,
    )
    return found


def bounds(ticks: int) -> None:
    """What a long bound costs, against one of 10."""
    arrays = {**WORKLOADS["W2"].columns(ticks)}
    columns, every = from_numpy(arrays), (1 << ticks) - 1
    rows = list[tuple[str, float, float]]()
    for bound in (10, 100, 1_000, 100_000):
        machine = monitor(requirement(f"whenever a sw shall within {bound} ticks satisfy b"))
        past = monitor(always(A, f.once(B, f.Interval(0, bound))))
        within, since = (
            repeated(partial(truths, made, literals_of(made, columns, every), every))
            for made in (machine, past)
        )
        rows.append((f"{bound:,}", within, since))
    first = rows[0]
    table(
        f"Bounds, {ticks:,} ticks: ms and multiples of a bound of 10",
        ("bound", "G(a -> F[0,n] b)", "", "H(a -> O[0,n] b)", ""),
        [
            (n, f"{w * 1e3:.3f}", f"{w / first[1]:.1f}", f"{o * 1e3:.3f}", f"{o / first[2]:.1f}")
            for n, w, o in rows
        ],
    )


def against_peers(ticks: int, ours: Mapping[str, Rates]) -> None:
    """Our rates divided by theirs, which are of the truth at each tick."""
    rows = []
    for peer in PEERS:
        missing = peer.missing()
        if missing:
            print(f"\n{peer.name}: {missing}")
            continue
        for name in peer.formulas:
            theirs = speed(peer, name, ticks, runs=3)
            rates = ours[name]
            rows.append(
                (
                    peer.name,
                    name,
                    f"{theirs.ticks:,}",
                    f"{theirs.alone:.2f}",
                    f"{rates.verdict / theirs.alone:,.1f}",
                    f"{rates.lists / theirs.alone:,.2f}",
                    f"{rates.verdict_from_numpy / theirs.from_numpy:,.1f}",
                    f"{rates.truths / theirs.alone:,.0f}",
                )
            )
    ours_in = ("ours: verdict", "all lists", "verdict from NumPy", "truth alone")
    head = ("peer", "", "its ticks", "M ticks/s", *ours_in)
    table(f"Peers, and how many times their rate ours is at {ticks:,} ticks", head, rows)


# Single ticks ---------------------------------------------------------------------------------


def empty(**propositions: bool | None) -> None:
    """What a call costs that does nothing."""


def stepping(step: Callable[..., object], rows: Sequence[Mapping[str, Any]]) -> float:
    """Microseconds a call, without the loop around it."""

    def calls() -> None:
        for row in rows:
            step(**row)

    def loop() -> None:
        for _ in rows:
            pass

    return (seconds(calls) - seconds(loop)) / len(rows) * 1e6


def online() -> None:
    """Microseconds a tick, in a batch and step by step; two-valued and with unknowns."""
    rows = []
    for name, made in workload_rules().items():
        arrays = {
            n: values[:STEPS].tolist() for n, values in WORKLOADS[name].columns(STEPS).items()
        }
        names = tuple(load("m", text(made)).PROPOSITIONS)
        known = [tuple(arrays[n][i] for n in names) for i in range(STEPS)]
        unknown = [
            tuple(None if (i + k) % 5 == 0 else v for k, v in enumerate(r))
            for i, r in enumerate(known)
        ]
        by_name = [[dict(zip(names, row, strict=True)) for row in x] for x in (known, unknown)]
        call = stepping(empty, by_name[0])
        batch = [seconds(partial(_run, made, x)) / STEPS * 1e6 for x in (known, unknown)]
        single: Any = monitor(made)
        steps = []
        for x in by_name:
            single.reset()
            steps.append(stepping(single.step, x))
        rows.append(
            (
                name,
                f"{batch[0]:.3f}",
                f"{steps[0]:.3f}",
                f"{steps[0] / call:.1f}",
                f"{batch[1]:.3f}",
                f"{batch[1] / batch[0]:.2f}",
                f"{steps[1]:.3f}",
                f"{steps[1] / steps[0]:.2f}",
            )
        )
    head = ("", "run us", "step us", "x empty call", "unknown: run", "x", "step", "x")
    table(f"Single ticks, {STEPS:,} of them", head, rows)


class WrittenByHand:
    """W2 as one may write it: it refuses what is no truth value, and knows its demands."""

    def __init__(self) -> None:
        self.tick = self.last = self.open = self.broken = -1

    def step(self, *, a: bool, b: bool) -> Verdict:
        if not isinstance(a, bool) or not isinstance(b, bool):
            raise TypeError("a truth value is True or False")
        self.tick += 1
        if a:
            self.last = self.tick
        if b:
            self.open = -1
        elif a and self.open < 0:
            self.open = self.tick
        if self.broken < 0 <= self.open <= self.tick - 10:
            self.broken = self.tick
        return VIOLATED if self.broken >= 0 else PENDING


def by_hand() -> tuple[float, float]:
    """Microseconds of a step of W2, and of a hand-written one, called in turn."""
    machine: Any = monitor(workload_rules()["W2"])
    arrays = WORKLOADS["W2"].columns(STEPS // 10).values()
    table_rows = list(zip(*(values.tolist() for values in arrays), strict=True))
    peer = WrittenByHand()

    def calls(step: Callable[..., object]) -> float:
        start = time.process_time()
        for a, b in table_rows:
            step(a=a, b=b)
        return time.process_time() - start

    pairs = [(calls(machine.step), calls(peer.step)) for _ in range(60)]
    ours, theirs = (min(each) / len(table_rows) * 1e6 for each in zip(*pairs, strict=True))
    return ours, theirs


def windows() -> None:
    """What a long window with both bounds costs, against one of 10: a call is two ticks."""
    forms = {
        "only ... after": "only in m mode whenever a sw shall after {n} ticks satisfy b",
        "occurred": "sw shall always satisfy (a | occurred({half}, {n}, b))",
    }
    rows = []
    for name, form in forms.items():
        few, many = (_of_window(form.format(n=n, half=n // 2), n) for n in (10, 100_000))
        rows += [
            (name, what, f"{first:.2f}", f"{second:.2f}", f"{second / first:.1f}")
            for what, first, second in zip(_CALLS, few, many, strict=True)
        ]
    table("Windows with both bounds, us", ("", "", "bound 10", "100 000", "x"), rows)


_CALLS = ("run of two rows", "two steps", "first unknown")


def _of_window(sentence: str, bound: int) -> tuple[float, ...]:
    """Microseconds of `_CALLS`, after each proposition was true at every other tick for long."""
    machine: Any = monitor(requirement(sentence))
    pair = [(value,) * len(machine.PROPOSITIONS) for value in (False, True)]
    named = [dict.fromkeys(machine.PROPOSITIONS.values(), value) for value in (False, True, None)]
    machine.run(pair * bound)
    calls = [lambda: machine.run(pair), lambda: [machine.step(**row) for row in named[:2]]]
    spent = [repeated(call) * 1e6 for call in calls]
    state, first = machine.state(), []
    for _ in range(5):
        machine.restore(state)
        gc.collect()  # restoring has made many objects
        start = time.process_time()
        machine.step(**named[2])
        first.append((time.process_time() - start) * 1e6)
    return (*spent, min(first))


def after_unknown() -> None:
    """What steps cost once a value was unknown, against those of a monitor that knows all."""
    rows = []
    for name, made in workload_rules().items():
        machine, other = monitor(made), monitor(made)
        names = tuple(machine.PROPOSITIONS.values())
        named = [{n: (i + k) % 3 > 0 for k, n in enumerate(names)} for i in range(STEPS // 10)]
        other.step(**dict.fromkeys(names))  # type: ignore[attr-defined]
        stepping(other.step, named)  # type: ignore[attr-defined]
        spent = [stepping(each.step, named) for each in (machine, other)]  # type: ignore[attr-defined]
        met = "yes" if other.possible is other.certain else "no"
        rows.append((name, *(f"{each:.3f}" for each in spent), f"{spent[1] / spent[0]:.2f}", met))
    head = ("", "step us", "after an unknown", "x", "one approximation")
    table("After an unknown value", head, rows)


def wide() -> None:
    """What each of many propositions costs, by name and by position, against one of ten."""
    rows = []
    for count in (10, 100, 2_000):
        names = [f"p{i}" for i in range(count)]
        machine: Any = monitor(requirement(f"sw shall always satisfy {' | '.join(names)}"))
        in_order = machine.rows_of(names[::-1])
        named, row = dict.fromkeys(machine.PROPOSITIONS.values(), True), (True,) * count
        calls = (
            lambda m=machine, x=named: m.step(**x),
            lambda m=machine, f=in_order, x=row: m.run(f([x])),
            lambda m=machine, f=in_order, x=row: m.run(f([x] * 100)),
        )
        spent = [repeated(call) * 1e9 / count for call in calls]
        spent[-1] /= 100
        rows.append((f"{count:,}", *(f"{each:.0f}" for each in spent)))
    head = ("propositions", "step", "run of a row in another order", "of a hundred")
    table("Many propositions, ns each", head, rows)


def peers_online() -> None:
    """The peers that can be stepped from Python, in microseconds a tick."""
    rows = []
    for peer in PEERS:
        if not peer.missing():
            for name in peer.formulas:
                told = _peer_step(peer, name)
                if told is not None:
                    rows.append((peer.name, name, f"{told:.2f}"))
    table("Peers by steps from Python", ("peer", "", "us a tick"), rows)


def _peer_step(peer: Peer, name: str) -> float | None:
    if peer.prepare_steps(name) is None:
        return None
    from benchmarks.peers import rows as letters
    from benchmarks.peers import stepping as steps_of

    inputs = letters({n: v[:20_000] for n, v in WORKLOADS[name].columns(20_000).items()})
    evaluation: Evaluation = steps_of(peer, name, inputs)
    return 1 / rate(evaluation, len(inputs), 3)


def many() -> None:
    """W5, and one file of up to 1 000 requirements: microseconds a tick and requirement."""
    rows = []
    for count, names in ((1, 12), (20, 12), (100, 12), (1_000, 12), (1_000, 1_000)):
        requirements = mixed(count, names)
        start = time.process_time()
        made = text(*requirements)
        written = time.process_time() - start
        machine: Any = load("m", made)
        ticks = max(50, 50_000 // count)
        generator = np.random.default_rng(1)
        values = generator.random((ticks, len(machine.PROPOSITIONS))) < 0.3
        table_rows = [tuple(row) for row in values.tolist()]
        spent = seconds(partial(machine.run, table_rows), 3) / ticks / count * 1e6
        named = [dict(zip(machine.PROPOSITIONS, row, strict=True)) for row in table_rows]
        parts = [load("m", text(*requirements[i : i + 20])) for i in range(0, count, 20)]
        rows.append(
            (
                f"{count:,}",
                f"{len(machine.PROPOSITIONS):,}",
                f"{written / count * 1e3:.2f}",
                f"{len(made) // 1024:,}",
                f"{spent:.3f}",
                *(f"{_steps(each, named) / count:.3f}" for each in ([machine], parts)),
            )
        )
    head = ("requirements", "propositions", "ms each to write", "kB", "run us each")
    head_of_steps = ("step us each", "in files of 20")
    table("Many requirements in one file (mixed, bounds to 1 000)", (*head, *head_of_steps), rows)


def _steps(machines: Sequence[Any], rows: Sequence[Mapping[str, bool]]) -> float:
    """Microseconds a tick, of monitors that are stepped one after the other."""
    named = [
        [{p: row[name] for name, p in machine.PROPOSITIONS.items()} for machine in machines]
        for row in rows
    ]

    def calls() -> None:
        for tick in named:
            for machine, values in zip(machines, tick, strict=True):
                machine.step(**values)

    return seconds(calls) / len(rows) * 1e6


# Memory and compiling -------------------------------------------------------------------------


def _run(monitored: FormalizedRequirement, rows: Sequence[Sequence[bool | None]]) -> object:
    machine: Any = monitor(monitored)
    return machine.run(rows)


def memory() -> None:
    """What a monitor holds after 10^3 and after 10^7 ticks."""
    machine = monitor(requirement("in c mode, upon a sw shall within 1000 ticks satisfy b"))
    generator = np.random.default_rng(2)
    piece = [tuple(row) for row in (generator.random((10_000, 3)) < 0.5).tolist()]
    machine.advance(piece[:1_000])
    tracemalloc.start()
    machine.advance(piece[:1_000])
    before = tracemalloc.get_traced_memory()[0]
    for _ in range(1_000):
        machine.advance(piece)
    after = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    print(f"\nMemory: {after - before:+,} bytes from 10^3 to {machine.tick + 1:,} ticks")


def _compile(sentence: str, times: int) -> None:
    for _ in range(times):
        text(requirement(sentence))


def compiling() -> None:
    """From a sentence to the text of its monitor, after import."""
    rows = []
    for bound in (10, 10**6):
        sentence = f"in m mode, upon p sw shall within {bound} ticks satisfy q"
        spent = seconds(partial(_compile, sentence, 20)) / 20
        rows.append((f"{bound:,}", f"{spent * 1e3:.2f}"))
    table("Compiling one requirement", ("bound", "ms"), rows)


def figures() -> Iterator[Figure]:
    ours, theirs = by_hand()
    yield Figure("step of W2", ours / theirs, "x a step by hand", 1.2)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ticks", type=int, nargs="*", default=[10**6, 10**7])
    parser.add_argument("--no-peers", action="store_true")
    options = parser.parse_args()
    for ticks in options.ticks:
        ours = offline(ticks)
        if not options.no_peers:
            against_peers(ticks, ours)
    bounds(max(options.ticks))
    online()
    ours_us, by_hand_us = by_hand()
    row = (f"{ours_us:.3f}", f"{by_hand_us:.3f}", f"{ours_us / by_hand_us:.2f}")
    table("A step of W2", ("us", "by hand", "x"), [row])
    windows()
    wide()
    after_unknown()
    if not options.no_peers:
        peers_online()
    many()
    compiling()
    memory()


if __name__ == "__main__":
    main()
