"""Monitors in Rust, compiled and stepped: at each tick they tell what those in Python tell."""

from __future__ import annotations

import random
import subprocess
from itertools import islice
from pathlib import Path

import pytest

from compiler.targets.witness_traces import witness_traces
from monitors.kernel import Monitor
from tests.c_monitors import of_python
from tests.compiler.targets.c.test_c_monitor import (
    CLASHES,
    drawn,
    in_files,
    monitors,
    of_requirements,
    rows,
)
from tests.each import each
from tests.effort import FULL, some
from tests.emitting import refused
from tests.monitoring import requirement
from tests.programs import installed
from tests.rust_monitors import ARM, ArmProcessor, crate, fields, library, outcomes, write

WITHIN = "whenever p the sw shall within 100 ticks satisfy q"


@pytest.mark.slow
@each("sentences", in_files())
def test_every_template_tells_the_same_at_each_tick(tmp_path: Path, sentences: list[str]) -> None:
    requirements = [requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences)]
    machine, text = monitors(requirements), library(crate(*requirements))
    choose = random.Random(sentences[0])
    traces = [rows(choose, len(machine.PROPOSITIONS), length) for length in (6, 12, 12, 60)]
    told = outcomes(tmp_path, [text], [(0, trace) for trace in traces])
    for trace, found in zip(traces, told, strict=True):
        assert found == [*of_python(machine, trace)]


@pytest.mark.slow
def test_any_sentence_tells_the_same_at_each_tick(tmp_path: Path) -> None:
    choose = random.Random("sentences")
    sentences = [
        requirement(sentence, f"R{i}")
        for i, sentence in enumerate(islice(drawn(choose), 40 if FULL else 20))
    ]
    alone = of_requirements()[: 4 if FULL else 1]
    groups = [sentences, of_requirements(), *([one] for one in alone)]
    machines: list[Monitor] = [monitors(group) for group in groups]
    traces = [
        (place, rows(choose, len(machine.PROPOSITIONS), length))
        for place, machine in enumerate(machines)
        for length in (20, 200)
    ]
    told = outcomes(tmp_path, [library(crate(*group)) for group in groups], traces)
    for (place, trace), found in zip(traces, told, strict=True):
        assert found == [*of_python(machines[place], trace)], place


@pytest.mark.slow
@each("arm", ARM)
def test_monitors_for_processors_of_arm_tell_the_same(tmp_path: Path, arm: ArmProcessor) -> None:
    """The second has words of 32 bits."""
    requirements, choose = of_requirements(), random.Random(arm.target)
    machine, text = monitors(requirements), library(crate(*requirements))
    width = len(machine.PROPOSITIONS)
    traces = [rows(choose, width, choose.choice([12, 60, 140])) for _ in range(20)]
    told = outcomes(tmp_path, [text], [(0, trace) for trace in traces], arm=arm)
    for trace, outcome in zip(traces, told, strict=True):
        assert outcome == [*of_python(machine, trace)]


@pytest.mark.slow
def test_clippy_finds_nothing_and_the_tests_of_crates_pass(tmp_path: Path) -> None:
    quoted = " | ".join(f'"{name}"' for name in (*CLASHES, "fn", "match", "Monitor", "Truth"))
    odd = requirement(f"whenever p & !q the sw shall within 3 ticks satisfy {quoted}", "fn")
    installed("cargo-clippy")
    cargo = installed("cargo")
    write(tmp_path, crate(odd))
    write(tmp_path, crate(*of_requirements()))
    write(tmp_path, crate(requirement(WITHIN)))
    members = ["fn_monitor", "monitors", "r1_monitor"]  # one run of cargo for all of them
    write(tmp_path, {"Cargo.toml": f'[workspace]\nmembers = {members}\nresolver = "2"\n'})
    command = [cargo, "clippy", "--offline", "--quiet", "--all-targets"]
    subprocess.run([*command, "--", "-D", "warnings"], cwd=tmp_path, check=True)
    assert passes(cargo, tmp_path)
    path = tmp_path / "r1_monitor/src/lib.rs"
    sound = path.read_text("utf-8")
    faults = [(">= 100;", ">= 101;"), (">= 100;", ">= 99;"), ("oldest_1 = 0;", "oldest_1 = 1;")]
    for text, fault in some(faults, 3):
        assert sound.count(text) == 1
        path.write_text(sound.replace(text, fault), encoding="utf-8")
        assert not passes(cargo, tmp_path / "r1_monitor"), fault


def passes(cargo: str, folder: Path) -> bool:
    """Whether the tests of a crate pass."""
    done = subprocess.run(
        [cargo, "test", "--offline", "--quiet"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "test result: " in done.stdout, done.stderr
    return done.returncode == 0


def test_words_reach_each_verdict_and_the_deadline() -> None:
    found = {word.name: word for word in witness_traces(requirement(WITHIN))}
    assert [*found] == ["soonest_violation", "soonest_pending", "latest_state"]
    assert sum(ticks.count for ticks in found["latest_state"].ticks) == 100
    assert found["soonest_violation"].ticks[-1].verdict == "violated"
    assert sum(ticks.count for ticks in found["soonest_violation"].ticks) == 101
    assert not witness_traces(
        requirement("whenever persisted(3, p) the sw shall immediately satisfy q")
    )


def test_a_bound_changes_nothing_but_numbers() -> None:
    small, large = (library(crate(requirement(WITHIN.replace("100", str(n))))) for n in (10, 10**6))
    assert len(small.splitlines()) == len(large.splitlines())
    assert fields(small, "Inputs") == ["p", "q"]
    assert "#![no_std]" in small
    assert "#![forbid(unsafe_code)]" in small


def test_bounds_that_a_controller_cannot_keep_are_refused() -> None:
    found = refused("rust", f"the sw shall within {2**31} ticks satisfy q")
    assert found.startswith("F601 a monitor in Rust cannot express a bound of 2^31 ticks or more")
