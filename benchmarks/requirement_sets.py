"""Can a set be kept: our game against Spot's synthesis from formulas, and sets that are hard.

Each line is printed with OxiDD and with BuDDy; `--one` measures the engine of `FRETC_DIAGRAMS`.
`--exports FILE...` analyzes FRET's exports as their users do, without an edit.
`--generated` answers sets that are generated as industry writes them.
`--tlsf FILE...` compares specifications in TLSF with the status that they state.
`--syntcomp FOLDER` does so for the hundred files of `syntcomp.txt`, in a clone of
github.com/SYNTCOMP/benchmarks.
"""

from __future__ import annotations

import json
import os
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import spot

from benchmarks.figures import RUNS, Figure
from benchmarks.generated_sets import controllers, one_plant
from compiler.logic import printing
from compiler.project.folder import load_folder
from compiler.project.project import Project
from compiler.project.tlsf.importing import read_specification
from fretc.analysis.analysis import AnalysisOptions, analyze, assembled, jobs
from fretc.analysis.arena.budget import Budget
from fretc.analysis.arena.roles import Roles
from fretc.analysis.arena.roles import roles as signal_roles
from fretc.analysis.assumptions import assumptions, guarantees
from fretc.analysis.findings import RealizabilityVerdict
from fretc.analysis.worker import finished
from fretish.diagnostics.source import Source
from tests.requirement_sets import ROLES, drawn, requirements, roles, staged

ENGINES = ("OxiDD", "BuDDy")
LIMIT = 60
"""Seconds after which a set counts as not answered."""


def ours(sentences: Sequence[str], named: Roles = ROLES) -> tuple[bool, float]:
    """The verdict and the seconds, from requirements on."""
    requirements(*sentences)
    start = time.process_time()
    setting = staged(*sentences, roles=named)
    budget = Budget(LIMIT)
    there = setting.close((requirement.id for requirement in setting.requirements), budget)
    game = there.game(there.arena.counters, budget)
    return game.solution().is_realizable, time.process_time() - start


def theirs(sentences: Sequence[str]) -> tuple[bool, float]:
    """The same by Spot: formula, parity automaton, game."""
    made = requirements(*sentences)
    start = time.process_time()
    formula = " & ".join(f"({printing.future(requirement.ft_infinite)})" for requirement in made)
    return bool(spot.solve_game(spot.ltl_to_game(formula, ["x", "y"]))), time.process_time() - start


def against_spot() -> None:
    """Random sets, then two requirements at growing bounds."""
    sets = [drawn(("benchmark", seed)) for seed in range(300)]
    one, other = (sum(each(sentences)[1] for sentences in sets) for each in (ours, theirs))
    print(f"300 random sets: {one:.2f} s, Spot {other:.2f} s")
    for bound in (2, 4, 6, 8, 10, 12):
        sentences = [
            f"whenever a the sw shall within {bound} ticks satisfy x",
            f"upon b the sw shall for {bound // 2} ticks satisfy !x",
        ]
        (verdict, mine), (same, spots) = ours(sentences), theirs(sentences)
        assert verdict is same
        print(f"within {bound}, for {bound // 2}: {mine:.4f} s, Spot {spots:.4f} s")


def hard() -> None:
    """Sets of the field, and durations that no automaton would hold."""
    for count, bound in ((8, 50), (8, 100_000), (10, 50)):
        deadlines = [
            f"whenever a{i} the sw shall within {bound + i} ticks satisfy x{i}"
            for i in range(count)
        ]
        apart = [f"the sw shall never satisfy x{i} & x{j}" for i in range(count) for j in range(i)]
        named = roles([f"a{i}" for i in range(count)], [f"x{i}" for i in range(count)])
        show(f"{count} deadlines of {bound} on one resource", [*deadlines, *apart], named)
    for count, bound in ((30, 50), (30, 100_000)):
        chain = [
            f"whenever {cause} the sw shall within {bound + i} ticks satisfy x{i}"
            for i, cause in enumerate(["a", *(f"x{i}" for i in range(count - 1))])
        ]
        show(f"a chain of {count}, {bound}", chain, roles(["a"], [f"x{i}" for i in range(count)]))
    fair = [f"whenever a{i} the sw shall eventually satisfy x{i}" for i in range(12)]
    apart = [f"the sw shall never satisfy x{i} & x{j}" for i in range(12) for j in range(i)]
    named = roles([f"a{i}" for i in range(12)], [f"x{i}" for i in range(12)])
    show("12 responses, one at a time", [*fair, *apart], named)
    for bound in (1_000, 10_000, 100_000, 1_000_000):
        sentences = [
            f"whenever a the sw shall within {bound} ticks satisfy x",
            f"whenever b the sw shall for {bound + 1} ticks satisfy !x",
        ]
        show(f"a conflict after {bound} ticks", sentences, ROLES)
        start = time.process_time()
        found = analyze(requirements(*sentences), ROLES)
        seconds = time.process_time() - start
        print(
            f"  all of it, {len(found.repairs)} repairs: {seconds:.2f} s, open: {len(found.open)}"
        )


def pump() -> None:
    """26 requirements like those of an infusion pump: alarms by priority, and commands.

    Two of the alarms do not look at those above them, and conflict with those of other modes.
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
    sentences = [*exclusive, *alarms, *commands]
    inputs = [*(f"alarm_{i}" for i in range(12)), *(f"command_{i}" for i in range(7))]
    made, named = requirements(*sentences), roles(inputs, modes)
    start = time.process_time()
    found = analyze(made, named)
    seconds = time.process_time() - start
    print(f"a pump, {len(made)}: all {len(found.conflicts)} conflicts, {seconds:.2f} s", flush=True)


def of_thresholds(count: int) -> float:
    """Seconds of `analyze` for an alarm for each threshold of one signal, each threshold."""
    names = [f"x{n}" for n in range(count)]
    made = requirements(
        *(f"whenever t > {n} the sw shall immediately satisfy x{n}" for n in range(count)),
        *(f"the sw shall always satisfy x{n + 1} -> x{n}" for n in range(count - 1)),
    )
    start = time.process_time()
    found = analyze(made, roles(["t"], names))
    assert found.verdict is RealizabilityVerdict.REALIZABLE
    return (time.process_time() - start) / count


def figures() -> Iterator[Figure]:
    of_thresholds(6)
    for few, many in ((12, 24), (24, 48), (48, 96)):
        value = statistics.median(of_thresholds(many) / of_thresholds(few) for _ in range(RUNS))
        yield Figure(f"analyze: each of {many} thresholds", value, f"x each of {few}", 1.2)


def show(what: str, sentences: Sequence[str], named: Roles) -> None:
    verdict, seconds = ours(sentences, named)
    print(f"{what}: {'realizable' if verdict else 'unrealizable'}, {seconds:.2f} s", flush=True)


def exports(files: Sequence[str]) -> None:
    """Each file of FRET, imported and analyzed by the commands: verdicts, conflicts, CPU time."""
    command = [sys.executable, "-c", "from fretc.cli import main; main()"]
    for file in files:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(
                [*command, "import", file, "-o", f"{folder}/set"], check=True, capture_output=True
            )
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            run = subprocess.run(
                [*command, "analyze", f"{folder}/set", "--format", "json"],
                cwd=folder,
                capture_output=True,
                check=False,
                text=True,
            )
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        found = json.loads(run.stdout)
        verdicts = Counter(each["verdict"] for each in found["components"])
        count = sum(len(each["requirements"]) for each in found["components"])
        shown = ", ".join(f"{number} {verdict}" for verdict, number in sorted(verdicts.items()))
        print(
            f"{Path(file).stem}, {count}: {shown}; {len(found['conflicts'])} conflicts, "
            f"{seconds:.1f} s",
            flush=True,
        )


def generated() -> None:
    """Sets with numbers: CPU seconds and memory of all questions, or of the first ones."""
    sets = {
        "200 requirements in 20 components": (controllers(20), None),
        "50 requirements in one component, verdict": (one_plant(), 1),
        "50 requirements in one component, with all conflicts": (one_plant(), 2),
    }
    for what, ((sentences, named), questions) in sets.items():
        made, asked = requirements(*sentences), AnalysisOptions(LIMIT)
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        answers, _ = finished(jobs(made, named, (), asked)[:questions], lambda title: None)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        analysis = assembled(made, named, (), asked, answers)
        seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        verdicts = Counter(str(each.verdict) for each in analysis.components)
        shown = ", ".join(f"{number} {verdict}" for verdict, number in sorted(verdicts.items()))
        conflicts = f"{len(analysis.conflicts)} conflicts, {len(analysis.open)} open questions"
        memory = after.ru_maxrss // 1024
        print(f"{what}: {shown}; {conflicts}, {seconds:.1f} s, {memory} MiB", flush=True)


def specifications(files: Sequence[str]) -> None:
    """Each file of TLSF that is imported: the verdict, the stated status, CPU seconds."""
    counts: Counter[str] = Counter()
    for file in files:
        text = Path(file).read_text("utf-8", errors="replace")
        result = read_specification(Source(file, text))
        stated = re.search(r"STATUS *: *(\w+)", text)
        if not result.artifacts or stated is None:
            counts["refused"] += 1
            continue
        with tempfile.TemporaryDirectory() as folder:
            for artifact in result.artifacts:
                (Path(folder) / artifact.path).write_text(artifact.text)
            project = load_folder(folder)
        assert isinstance(project, Project)
        named, _ = signal_roles(project.formalized)
        given, _ = assumptions(project.formalized, None)
        asked = AnalysisOptions(LIMIT, repairs=False)
        work = jobs(guarantees(project.formalized), named, given, asked)
        verdicts = [job for job in work if job.title.startswith("can ") and "together" in job.title]
        answers, _ = finished(verdicts, lambda title: None)
        analysis = assembled(guarantees(project.formalized), named, given, asked, answers)
        seconds = sum(float(each.seconds or 0) for each in analysis.components)
        counts[f"{stated[1]}, answered {analysis.verdict}"] += 1
        print(f"{file}: {stated[1]}, {analysis.verdict}, {seconds:.2f} s", flush=True)
    print("; ".join(f"{number} {what}" for what, number in sorted(counts.items())))


def beside() -> None:
    """All of it with each engine of decision diagrams, line by line beside each other."""
    outputs = [
        subprocess.run(
            [sys.executable, "-m", "benchmarks.requirement_sets", "--one"],
            env={**os.environ, "FRETC_DIAGRAMS": engine.lower()},
            stdout=subprocess.PIPE,
            check=True,
            text=True,
        ).stdout.splitlines()
        for engine in ENGINES
    ]
    for lines in zip(*outputs, strict=True):
        for engine, line in zip(ENGINES, lines, strict=True):
            print(f"{engine}  {line}")


if __name__ == "__main__":
    if "--exports" in sys.argv:
        exports(sys.argv[sys.argv.index("--exports") + 1 :])
    elif "--generated" in sys.argv:
        generated()
    elif "--tlsf" in sys.argv:
        specifications(sys.argv[sys.argv.index("--tlsf") + 1 :])
    elif "--syntcomp" in sys.argv:
        clone = Path(sys.argv[sys.argv.index("--syntcomp") + 1])
        names = Path(__file__).with_name("syntcomp.txt").read_text("utf-8").split()
        specifications([str(clone / name) for name in names])
    elif "--one" in sys.argv:
        against_spot()
        hard()
        pump()
    else:
        beside()
