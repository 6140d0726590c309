"""Monitors in Java, compiled and stepped: at each tick they tell what those in Python tell."""

from __future__ import annotations

import random
import re
from itertools import islice
from pathlib import Path

import pytest

from compiler.targets.java.monitor import TARGET, refuse_joint
from tests.c_monitors import of_python
from tests.compiler.targets.c.test_c_monitor import (
    CLASHES,
    drawn,
    in_files,
    monitors,
    of_requirements,
    rows,
)
from tests.effort import FULL, full_only
from tests.emitting import refused
from tests.java_monitors import compiled, emitted, fields, monitor, outcomes, run, write
from tests.monitoring import requirement

WITHIN = "whenever p the sw shall within 100 ticks satisfy q"
WORDS = (*CLASHES, "Truth", "Inputs", "null", "enum", "var", "yield", "this", "int", "step")


@pytest.mark.slow
def test_every_monitor_tells_the_same_at_each_tick(tmp_path: Path) -> None:
    """Templates, drawn sentences and requirements of each form: javac compiles them at once."""
    choose = random.Random("sentences")
    sentences = [*in_files(), [*islice(drawn(choose), 40 if FULL else 20)]]
    groups = [
        *([requirement(text, f"R{i}") for i, text in enumerate(texts)] for texts in sentences),
        of_requirements(),
        *([each] for each in of_requirements()[: 8 if FULL else 2]),
    ]
    machines = [monitors(group) for group in groups]
    traces = [
        (place, rows(choose, len(machine.PROPOSITIONS), length))
        for place, machine in enumerate(machines)
        for length in (6, 12, 60, 200)
    ]
    told = outcomes(tmp_path, [monitor(*group) for group in groups], traces)
    for (place, trace), found in zip(traces, told, strict=True):
        assert found == [*of_python(machines[place], trace)], place


ESCAPES = ("\\u000a", "\\uuu000A", "\\\\u000a", "*/", "\\u002a/", "\\u", "\\ud83d", "\u2028", "\\")
"""Java reads the first ones before anything else, also within a comment; others do not compile."""


@pytest.mark.slow
def test_no_name_and_no_text_changes_the_code(tmp_path: Path) -> None:
    injected = [f'p {escape} public int injected; {escape} "' for escape in ESCAPES]
    names = [*WORDS, *(text.replace('"', "").replace("\u2028", "") for text in injected)]
    quoted = " | ".join(name if name == "x > 3" else f'"{name}"' for name in names)
    sentence = f"whenever p & !q the sw shall within 3 ticks satisfy {quoted}"
    ids = ("class", "fretc", "1.main-x", "Truth", "R1")
    for id in ids:
        write(tmp_path, emitted(requirement(sentence, id)))
    files = {path.name for path in tmp_path.iterdir()}
    assert files == {
        f"{name}Monitor.java" for name in ("Class", "Fretc", "_1_main_x", "Truth", "R1")
    }
    text = (tmp_path / "R1Monitor.java").read_text("utf-8")
    assert "\\u" not in text
    assert text.isascii()
    assert not re.search(r"^\s*public int injected", text, re.M)
    assert compiled(tmp_path) == ""


_ALLOCATION = """
import java.lang.management.ManagementFactory;

public final class Main {
    private static long allocated() {
        long id = Thread.currentThread().getId();
        return ((com.sun.management.ThreadMXBean) ManagementFactory.getThreadMXBean())
            .getThreadAllocatedBytes(id);
    }

    private static long steps(Monitors monitor, Monitors.Inputs in, Monitors.Outcomes out, int n) {
        long before = allocated();
        for (int i = 0; i < n; i++) {
            in.p = Monitors.Truth.of((i & 1) == 0);
            in.q = i % 3 == 0 ? Monitors.Truth.UNKNOWN : Monitors.Truth.FALSE;
            monitor.step(in, out);
        }
        return allocated() - before;
    }

    public static void main(String[] arguments) {
        Monitors monitor = new Monitors();
        Monitors.Inputs in = new Monitors.Inputs();
        Monitors.Outcomes out = new Monitors.Outcomes();
        steps(monitor, in, out, 10);
        System.out.print(steps(monitor, in, out, 10) - steps(monitor, in, out, 1_000));
    }
}
"""


@pytest.mark.slow
def test_a_step_allocates_nothing(tmp_path: Path) -> None:
    """The virtual machine interprets: it cannot remove an allocation."""
    write(tmp_path, {**emitted(*of_requirements()), "Main.java": _ALLOCATION})
    assert compiled(tmp_path, ["-nowarn"]) == ""
    assert run(tmp_path, "Main", options=["-Xint"]) == b"0"


def test_a_bound_changes_nothing_but_numbers() -> None:
    small, large = (monitor(requirement(WITHIN.replace("100", str(n)))) for n in (10, 10**6))
    assert len(small.splitlines()) == len(large.splitlines())
    assert fields(small, "Inputs") == ["p", "q"]
    code = re.sub(r"//.*|/\*.*?\*/", "", small)
    assert not re.search(r"\b(for|while|do|import|synchronized)\b", code)


def test_what_a_class_cannot_hold_is_refused() -> None:
    found = refused("java", f"the sw shall within {2**31} ticks satisfy q")
    assert found.startswith("F601 a monitor in Java cannot express a bound of 2^31 ticks or more")
    sentence = "the sw shall immediately satisfy occurred(9000000, 9000001, q)"
    assert "more than 8388608 ticks ago" in refused("java", sentence)
    wide = " & ".join(f"a_rather_long_name_{i}" for i in range(1_200))
    assert "a condition of more than 32000 characters" in refused(
        "java", f"the sw shall always satisfy {wide}"
    )


def test_a_set_that_a_class_cannot_hold_is_refused() -> None:
    few = [requirement(WITHIN, f"R{i}") for i in range(3)]
    assert refuse_joint(few) is None
    names = " & ".join(f"n{i}" for i in range(1_001))
    many = [
        requirement(f"the sw shall always satisfy {names.replace('n', f'n{i}_')}", f"R{i}")
        for i in range(5)
    ]
    assert [TARGET.refuse(each) for each in many] == [None] * 5
    found = refuse_joint(many)
    assert found is not None
    assert found.message == "a class of Java cannot express all values of R4"
    assert found.help == "emit smaller groups of requirements"


@pytest.mark.slow
@full_only("javac takes a minute")
def test_the_largest_classes_compile(tmp_path: Path) -> None:
    """Many counters and rings, a long row of operands, deep operands, and the largest ring."""
    shapes = ("within 3 ticks", "for 2 ticks", "after 40 ticks", "eventually")
    many = [
        requirement(f"upon p{i} the sw shall {shapes[i % 4]} satisfy q{i}", f"R{i}")
        for i in range(1_200)
    ]
    while refuse_joint(many) is not None:
        many = many[: -len(many) // 20]
    assert len(many) > 700
    wide = " & ".join(f"w{i}" for i in range(1_900))
    deep = "p"
    for i in range(58):
        deep = f"({deep} {'|' if i % 2 else '&'} d{i})"
    others = {
        "Wide": f"the sw shall always satisfy {wide}",
        "Deep": f"the sw shall always satisfy {deep}",
        "Ring": "the sw shall immediately satisfy occurred(8388000, 8388001, q)",
    }
    for id, sentence in others.items():
        assert TARGET.refuse(requirement(sentence, id)) is None, id
        write(tmp_path, emitted(requirement(sentence, id)))
    write(tmp_path, emitted(*many))
    assert compiled(tmp_path) == ""
