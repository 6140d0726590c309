"""Requirement sets: CPU time of the analysis, and of Spot's synthesis where it gets there.

Each row has a process of its own, and a limit. `verdict` is the time to the verdict of the whole
set, `all` that to everything: all minimal conflicts, what is redundant, vacuous, inconsistent.
"""

from __future__ import annotations

import argparse
import multiprocessing as mp
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

Answer = tuple[str, float]
Set = tuple[Sequence[str], Sequence[str]]
"""Sentences, and the outputs among their variables."""


# Sets -----------------------------------------------------------------------------------------


def pump() -> Set:
    """26 requirements like those of an infusion pump: alarms by priority, and commands.

    Two of the alarms do not look at those above them, and fight with those that want other modes.
    """
    modes = [f"mode_{i}" for i in range(8)]
    exclusive = [
        f"the pump shall always satisfy {mode} -> !({' | '.join(m for m in modes if m != mode)})"
        for mode in modes
    ]
    above = {i: " & ".join(f"!alarm_{j}" for j in range(i)) for i in range(1, 12)}
    alarms = [
        f"the pump shall always satisfy alarm_{i}{f' & {above[i]}' if i not in (0, 2, 7) else ''} "
        f"-> {modes[i % 8]}"
        for i in range(12)
    ]
    calm = " & ".join(f"!alarm_{j}" for j in range(12))
    commands = [
        f"whenever command_{i} & {calm} the pump shall immediately satisfy "
        f"{calm.replace('!', '')} | {modes[i]} | command_{i + 1}"
        for i in range(6)
    ]
    return [*exclusive, *alarms, *commands], modes


def chain(length: int) -> Set:
    """Each answer is the trigger of the next one."""
    return (
        [f"whenever e{i} the sw shall within 50 ticks satisfy e{i + 1}" for i in range(length)],
        [f"e{i + 1}" for i in range(length)],
    )


def resource(deadlines: int, bound: int = 50) -> Set:
    """Requests, each with a deadline, for what only one can have."""
    grants = [f"grant_{i}" for i in range(deadlines)]
    pairs = " | ".join(f"{a} & {b}" for a, b in combinations(grants, 2))
    wanted = [
        f"whenever request_{i} the sw shall within {bound + i} ticks satisfy {grants[i]}"
        for i in range(deadlines)
    ]
    return [*wanted, f"the sw shall never satisfy {pairs}"], grants


def stop_and_start(bound: int) -> Set:
    """Two requirements that fight after as many ticks, and not before."""
    return (
        [
            f"whenever start the line shall within {bound} ticks satisfy run",
            f"upon stop the line shall for {bound + 1} ticks satisfy !run",
        ],
        ["run"],
    )


SETS: Mapping[str, Callable[[], Set]] = {
    "pump, 26": pump,
    "chain of 8": lambda: chain(8),
    "chain of 30": lambda: chain(30),
    **{f"1 resource, {n} deadlines of 50": lambda n=n: resource(n) for n in (2, 4, 6, 8)},  # type: ignore[misc]
    **{f"fight after {n}": lambda n=n: stop_and_start(n) for n in (100, 1_000, 100_000)},  # type: ignore[misc]
}
BOUNDS = (2, 4, 8, 16, 32, 64)


# Measuring ------------------------------------------------------------------------------------


def _rules(sentences: Sequence[str]) -> list[Any]:
    from compiler.formalization.formalize import formalize
    from fretish.diagnostics.source import Source
    from fretish.documents import Requirement

    found = []
    for i, sentence in enumerate(sentences, 1):
        rule, remarks = formalize(Requirement(f"R{i}", Source("r", sentence).span()), None)
        assert rule is not None, (sentence, remarks)
        found.append(rule)
    return found


def verdict(sentences: Sequence[str], outputs: Sequence[str]) -> Answer:
    """Of the whole set."""
    from fretc.analysis.analysis import DEFAULT, jobs

    rules, roles = _rules(sentences), _roles(sentences, outputs)
    start = time.process_time()
    found = [
        finding
        for job in jobs(rules, roles, (), DEFAULT)
        if job.title.startswith("can ") and job.title.endswith("together?")
        for finding in job.ask([])
    ]
    words = {str(each.verdict) for each in found}  # type: ignore[union-attr]
    order = ("unrealizable", "not checked", "realizable")
    return next(word for word in order if word in words), time.process_time() - start


def everything(sentences: Sequence[str], outputs: Sequence[str]) -> Answer:
    """All questions."""
    from fretc.analysis.analysis import analyze

    rules, roles = _rules(sentences), _roles(sentences, outputs)
    start = time.process_time()
    found = analyze(rules, roles)
    more = "" if found.complete else "+"
    return f"{len(found.conflicts)}{more} conflicts", time.process_time() - start


def spot(sentences: Sequence[str], outputs: Sequence[str]) -> Answer:
    """Spot's game of the conjunction of the formulas."""
    import spot as engine

    from compiler.logic import printing

    rules = _rules(sentences)
    start = time.process_time()
    formula = " & ".join(f"({printing.future(rule.ft_infinite)})" for rule in rules)
    game = engine.ltl_to_game(formula, list(outputs))
    answer = "realizable" if engine.solve_game(game) else "unrealizable"
    return answer, time.process_time() - start


def _roles(sentences: Sequence[str], outputs: Sequence[str]) -> Any:
    from fretish.bindings.declarations import Role

    names = {name for rule in _rules(sentences) for name in rule.variables}
    return {name: Role.OUTPUT if name in outputs else Role.INPUT for name in names}


Measure = Callable[[Sequence[str], Sequence[str]], Answer]


def measured(what: Measure, sentences: Sequence[str], outputs: Sequence[str], limit: float) -> str:
    """In a process of its own; or that the limit is over."""
    reading, writing = mp.Pipe(duplex=False)
    process = mp.get_context("fork").Process(target=lambda: writing.send(what(sentences, outputs)))
    process.start()
    writing.close()
    try:
        answer, seconds = reading.recv() if reading.poll(limit) else ("-", limit)
    except EOFError:
        answer, seconds = "broken off", 0.0
    process.kill()
    process.join()
    return f"> {limit:.0f} s" if answer == "-" else f"{answer}, {seconds:.3f} s"


def rows(limit: float) -> Iterator[tuple[str, ...]]:
    """Everything."""
    yield "set", "verdict", "all"
    for name, made in SETS.items():
        sentences, outputs = made()
        yield name, *(measured(each, sentences, outputs, limit) for each in (verdict, everything))
    yield "two requirements, bound", "fretc", "Spot"
    for bound in BOUNDS:
        sentences, outputs = stop_and_start(bound)
        yield str(bound), *(measured(each, sentences, outputs, limit) for each in (verdict, spot))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for each row")
    for name, *cells in rows(parser.parse_args().limit):
        print(f"{name:<34}", *(f"{cell:<32}" for cell in cells), flush=True)


if __name__ == "__main__":
    main()
