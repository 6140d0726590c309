"""A monitor in Java as a program that prints what those in C print.

It steps until the virtual machine has compiled the step, before it measures. The time is that of
the thread of the steps, without those that compile.
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

from benchmarks.compiled_monitors.program import Program
from benchmarks.compiled_monitors.requirement_files import Task
from compiler.targets.java.monitor import TARGET
from compiler.targets.target import TargetOptions

_MAIN = """
import java.io.IOException;
import java.lang.management.ManagementFactory;
import java.nio.file.Files;
import java.nio.file.Paths;

public final class Main {
    private static final int WARM = 60_000;

    private static Monitors.Inputs inputs(byte[] rows, int at) {
        Monitors.Inputs inputs = new Monitors.Inputs();
FIELDS        return inputs;
    }

    private static long run(Monitors.Inputs[] rows) {
        Monitors monitor = new Monitors();
        Monitors.Outcomes outcomes = new Monitors.Outcomes();
        long sum = 0;
        for (Monitors.Inputs row : rows) {
            monitor.step(row, outcomes);
            sum += holds(outcomes.FIRST);
        }
        return sum + last(outcomes);
    }

    private static int holds(Monitors.Outcome outcome) {
        return outcome.finite == Monitors.Truth.TRUE ? 1 : 0;
    }

    private static long last(Monitors.Outcomes outcomes) {
        long sum = 0;
HOLDS        return sum;
    }

    public static void main(String[] arguments) throws IOException {
        byte[] data = Files.readAllBytes(Paths.get(arguments[0]));
        int width = Integer.parseInt(arguments[1]);
        Monitors.Inputs[] rows = new Monitors.Inputs[Integer.parseInt(arguments[2])];
        for (int i = 0; i < rows.length; i++) {
            rows[i] = inputs(data, i * width);
        }
        for (int done = 0; done < WARM; done += rows.length) {
            run(rows);
        }
        long sum = 0;
        for (int i = 0; i < Integer.parseInt(arguments[3]); i++) {
            long start = ManagementFactory.getThreadMXBean().getCurrentThreadCpuTime();
            sum = run(rows);
            long end = ManagementFactory.getThreadMXBean().getCurrentThreadCpuTime();
            System.out.println((double) (end - start) / rows.length);
        }
        System.out.println(sum + " -");
    }
}
"""


def build(task: Task, folder: Path) -> Program:
    """The program in an empty folder."""
    requirements = [each.requirement() for each in task.demands]
    text = TARGET.emit(requirements, TargetOptions(one_file=True))[0].text
    names, outcomes = (
        re.findall(rf"^        public (?:final )?{kind} (\w+) =", text.partition(start)[2], re.M)
        for kind, start in (("Truth", "class Inputs {"), ("Outcome", "class Outcomes {"))
    )
    places = {name: i for i, name in enumerate(task.propositions)}
    fields = "".join(
        f"        inputs.{name} = Monitors.Truth.of(rows[at + {places[name]}] != 0);\n"
        for name in names
    )
    holds = "".join(f"        sum += holds(outcomes.{name});\n" for name in outcomes)
    main = _MAIN.replace("FIELDS", fields).replace("HOLDS", holds).replace("FIRST", outcomes[0])
    for name, each in (("Monitors.java", text), ("Main.java", main)):
        folder.joinpath(name).write_text(each, encoding="utf-8")
    subprocess.run(["javac", "-d", ".", "Main.java", "Monitors.java"], cwd=folder, check=True)
    path = folder / "program"
    path.write_text(f'#!/bin/sh\nexec java -XX:+UseSerialGC -cp "{folder}" Main "$@"\n')
    path.chmod(0o755)
    return Program(path, sum(file.stat().st_size for file in folder.glob("Monitors*.class")), 0)
