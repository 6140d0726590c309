"""Computed signals beside monitors of each language: printed, given by the caller, or refused."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from compiler.emit import TARGETS
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.ajpf import runtime
from compiler.targets.python import perception
from compiler.targets.ros import ros2cpp
from fretish.diagnostics.rendering import render
from monitors.loading import executed
from tests.bound_requirements import TABLES_OF_AGENT, bound_requirement
from tests.c_monitors import STRICT
from tests.programs import installed
from tests.test_layers import ROOT

BINDINGS = """
[clock]
tick = "100 ms"
lateness = "50 ms"
[signal.x]
path = "/p.x"
type = "geometry_msgs/Point"
unit = "cm"
[signal.y]
path = "/p.y"
type = "geometry_msgs/Point"
unit = "m"
max_age = "300 ms"
[signal.distance]
value = "hypot(x, y)"
unit = "mm"
[signal.height]
value = "clamp(2 * y, 0 m, 9 m)"
[signal.fast]
value = "rate(y, over = 500 ms)"
"""
FAR = "the sw shall always satisfy distance > 5000"
HIGH = "the sw shall always satisfy height > 5"
FAST = "the sw shall always satisfy fast > 5"
BOTH = "the sw shall always satisfy distance > 5000 | height > 5 | y > 7"
FILES = {
    "c": "r1_signals.h",
    "rust": "r1_signals/src/lib.rs",
    "js": "r1_signals.mjs",
    "java": "R1Signals.java",
}


def subject(sentence: str) -> FormalizedRequirement:
    return bound_requirement(sentence, BINDINGS)


def files(target: str, sentence: str) -> dict[str, str]:
    made = subject(sentence)
    assert TARGETS[target].refuse(made) is None
    return {str(file.path): file.text for file in TARGETS[target].emit([made])}


@pytest.mark.parametrize("target", FILES)
def test_the_file_says_what_the_caller_computes(target: str) -> None:
    text = files(target, FAR)[FILES[target]]
    assert (
        "The number of distance is computed by the caller, unknown where one of its signals is: "
        "hypot(x, y), in m. Its last digits depend on the library of functions."
    ) in " ".join(text.split())
    assert "sample_x" not in text
    assert "s_x" not in text


@pytest.mark.parametrize("target", FILES)
def test_what_is_exact_is_computed_from_the_samples(target: str) -> None:
    high = files(target, HIGH)[FILES[target]]
    assert "computed by the caller" not in high
    assert "sample_y" in high or "y(field)" in high
    both = files(target, BOTH)[FILES[target]]
    assert "The number of distance is computed by the caller" in " ".join(both.split())


MAIN = """
#include <stdio.h>
#include "r1_monitor.h"
#include "r1_signals.h"
int main(void)
{
    const double distances[] = {4.9999, 5.0, 5.0001};
    unsigned i;
    for (i = 0u; i < 4u; i++) {
        r1_samples samples = {0};
        r1_inputs inputs;
        samples.distance.number = i < 3u ? fretc_of_double(distances[i]) : fretc_no_number();
        r1_instant(&samples, 0, &inputs);
        printf("%d", inputs.NAME == FRETC_TRUE ? 1 : inputs.NAME == FRETC_FALSE ? 0 : 2);
    }
    return 0;
}
"""


@pytest.mark.slow
def test_the_number_that_the_caller_gives_is_compared_in_base_units(tmp_path: Path) -> None:
    found = files("c", FAR)
    name = found["r1_signals.c"].partition("inputs->")[2].partition(" ")[0]
    found["main.c"] = MAIN.replace("NAME", name)
    for path, text in found.items():
        (tmp_path / path).write_text(text)
    sources = [path for path in found if path.endswith(".c")]
    command = [installed("gcc"), *STRICT, "-Wno-missing-field-initializers", *sources, "-o", "main"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]
    said = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout
    assert said == "0012"  # 5 m are not more than 5000 mm


def test_a_node_in_cpp_refuses_a_function_whose_last_digits_differ() -> None:
    refusal = ros2cpp.refuse(subject(FAR))
    assert refusal is not None
    assert render(refusal) == (
        "F601 a live node cannot judge R1: `distance` calls a function whose last digits differ in "
        "C++\n"
        "  --> bindings.toml:15:9\n"
        '   | value = "hypot(x, y)"\n'
        "   |         ^^^^^^^^^^^^^\n"
        "help: emit `ros2-package`, whose node is in Python, or publish the value as a field"
    )
    assert ros2cpp.refuse(subject(HIGH)) is None


@pytest.mark.parametrize("target", FILES)
def test_the_caller_gives_the_number_of_a_signal_with_memory(target: str) -> None:
    text = " ".join(files(target, FAST)[FILES[target]].split())
    assert "The number of fast is computed by the caller: rate(y, over = 500 ms)." in text
    assert "sample_fast" not in text


def test_a_node_in_cpp_refuses_a_signal_with_memory() -> None:
    refusal = ros2cpp.refuse(subject(FAST))
    assert refusal is not None
    assert "`fast` has memory, which the node in C++ lacks" in refusal.message


def test_a_node_in_python_has_the_memory_that_a_watch_has() -> None:
    source = ROOT.joinpath("monitors/memory.py").read_text()
    body = source[source.index("class Memory(NamedTuple)") :].strip()
    text = perception.text([subject(FAST)])
    assert body in text
    assert "class Memory" not in perception.text([subject(FAR)])
    module = executed(text, "perception")
    (policy,) = module.SETTING.policies
    series = policy.series()
    for time, value in ((0, 1.0), (5 * 10**8, 3.0)):
        series.put(time, value)
    assert [series.at(i, time) for i, time in enumerate(series.times[:2])] == [None, None]
    series.put(10**9, 2.0)
    assert series.memory.max_age == 3 * 10**8  # too old between its samples


def test_a_node_in_python_has_the_functions_that_an_audit_calls() -> None:
    source = ROOT.joinpath("monitors/rounded_functions.py").read_text()
    body = source[source.index("_EARTH = ") :].strip()
    assert perception.refuse(subject(FAR)) is None
    text = perception.text([subject(FAR)])
    assert body in text
    assert "compared(rounded('hypot', in_base(row['x'], exact('1/100')), row['y']), " in text
    assert body not in perception.text([subject(HIGH)])
    module = executed(text, "perception")
    (spec,) = module.SETTING.meanings
    told = [spec.truth({"x": x, "y": y}, ()) for x, y in ((300.0, 4.0), (301.0, 4.0), (None, 9.0))]
    assert told == [False, True, None]


AGENT = (
    TABLES_OF_AGENT
    + """
[proposition.stopped]
expr = "x > 1 m"
[proposition.near]
expr = "distance < 5 m"
[proposition.high]
expr = "height > 5 m"
[proposition.quick]
expr = "fast > 5 m/s"
"""
)


def test_an_agent_refuses_a_function_whose_last_digits_differ() -> None:
    bindings = BINDINGS + AGENT
    sentence = "whenever near the sw shall eventually satisfy stopped"
    refusal = runtime.refusal(bound_requirement(sentence, bindings))
    assert refusal is not None
    assert refusal.code.number == "F601"
    assert "a function of a computed signal in the percept `near`" in refusal.message


def test_an_agent_refuses_a_signal_with_memory() -> None:
    sentence = "whenever quick the sw shall eventually satisfy stopped"
    refusal = runtime.refusal(bound_requirement(sentence, BINDINGS + AGENT))
    assert refusal is not None
    assert refusal.code.number == "F601"
    assert "`fast`, which has memory" in refusal.message
