"""Samples in C say what the audit says: of random bindings, special floats and large numbers."""

from __future__ import annotations

import math
import random
import struct
import subprocess
from dataclasses import replace
from itertools import chain
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from compiler.project.folder import load
from compiler.signals.policies import policy
from compiler.targets.c.monitor import TARGET
from compiler.targets.target import Options
from fretc.logs.signals.propositions import Steps, truth_values
from fretc.logs.signals.samples import EXACT, Values
from fretc.logs.signals.traces import combined
from fretc.logs.signals.words import word
from fretish import expressions as e
from fretish.bindings.declarations import Aggregate, Declarations, Proposition, Signal, path
from fretish.clock import Clock
from fretish.diagnostics.source import Source
from fretish.units import ONE
from monitors.kernel.verdicts import Truth
from tests.c_monitors import CHECKED, STRICT, compiler
from tests.each import each
from tests.emitting import rule
from tests.signal_policies import NOW, Case, Message, audited_truth, collected, numbered

ROOT = Path(__file__).parents[4]
TYPES = "float double bool int8 uint8 int16 uint16 int32 uint32 int64 uint64".split()
TRUTHS: tuple[Truth, ...] = (False, True, None)
DRIVER = """
#include <stdio.h>
#include "monitors_signals.h"

static monitors_samples samples;
static uint64_t elements[64];

static int given(fretc_array *array, double *least, double *most, int64_t *at)
{
    unsigned char head[2];
    if (fread(head, 1, 2, stdin) != 2 || fread(least, 8, 1, stdin) != 1) {
        return 0;
    }
    if (fread(most, 8, 1, stdin) != 1 || fread(at, 8, 1, stdin) != 1) {
        return 0;
    }
    array->type = (fretc_element_type)head[0];
    array->count = head[1];
    array->elements = elements;
    return fread(elements, 1, 64, stdin) == 64;
}

static void put(fretc_number number)
{
    const unsigned char kind = (unsigned char)number.kind;
    fwrite(&number.value, 8, 1, stdout);
    fwrite(&number.magnitude, 8, 1, stdout);
    fwrite(&kind, 1, 1, stdout);
}
"""


def driver(cases: list[Case]) -> str:
    """A program that reads rows of each case in turn, and writes truths and samples."""
    functions, calls = [], []
    for i, case in enumerate(cases):
        lines = []
        for signal in case.signals:
            name, found = f"{signal.name}{i}", policy(signal)
            field = "&array" if found.is_array else "fretc_element(&array, 0u)"
            arguments = ", ".join((field, *found.fields))
            lines += [
                "    if (!given(&array, &least, &most, &at)) { return; }",
                f"    samples.{name}.number = monitors_sample_{name}({arguments});",
                f"    samples.{name}.at = at;",
                f"    put(samples.{name}.number);",
                f"    if (at < 0) {{ samples.{name}.number = fretc_no_number(); }}",
                "    (void)least; (void)most;",
            ]
        body = "\n".join(lines)
        functions.append(
            f"static void case_{i}(monitors_inputs *inputs)\n{{\n"
            "    fretc_array array; double least, most; int64_t at;\n"
            f"{body}\n    monitors_instant(&samples, {NOW}, inputs);\n"
            f"    putchar((int)inputs->p{i});\n}}\n"
        )
        loop = f"for (row = 0; row < {len(case.rows)}; row++)"
        calls.append(f"    {loop} {{ case_{i}(&inputs); }}")
    main = "int main(void)\n{\n    monitors_inputs inputs; int row;\n"
    return DRIVER + "\n".join(functions) + main + "\n".join(calls) + "\n    return 0;\n}\n"


def packed(message: Message) -> bytes:
    field = np.atleast_1d(message.field)
    names = {"float32": "float", "float64": "double"}
    kind = TYPES.index(names.get(field.dtype.name, field.dtype.name))
    head = struct.pack("=BBddq", kind, len(field), message.least, message.most, message.at)
    return head + field.tobytes().ljust(64, b"\0")


def same(audited: Values, value: float, magnitude: int, kind: int) -> bool:
    """Whether a number in C is the audit's sample."""
    (expected,) = audited
    if np.isnan(expected) or kind == 0:
        return bool(np.isnan(expected)) and kind == 0
    if audited.dtype == EXACT:
        return kind == 3 and int(expected) == (magnitude if value > 0 else -magnitude)
    return kind == (1 if audited.dtype == np.float32 else 2) and float(expected) == value


def hold(folder: Path, cases: list[Case], *flags: str, cc: str = "gcc") -> None:
    """The compiled functions say of each row what the audit says."""
    rules = [numbered(case, i) for i, case in enumerate(cases)]
    for file in TARGET.emit(rules, Options(one_file=True)):
        folder.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    folder.joinpath("main.c").write_text(driver(cases), encoding="utf-8")
    strict = [compiler(cc), *STRICT, *flags]
    done = subprocess.run(
        [*strict, "main.c", "monitors_signals.c", "-o", "main"],
        cwd=folder, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[:2000]
    rows = chain.from_iterable(row for case in cases for row in case.rows)
    answer = subprocess.run(
        [folder / "main"], input=b"".join(map(packed, rows)), capture_output=True, check=False
    )
    assert answer.returncode == 0, answer.stderr.decode()[:2000]
    records = struct.iter_unpack("=dQBdQBB", answer.stdout)
    for case in cases:
        for row, (truth, samples) in zip(case.rows, case.expected(), strict=True):
            told = next(records)
            assert same(samples[0], *told[:3]), (case.signals[0], row[0], samples[0], told)
            assert same(samples[1], *told[3:6]), (case.signals[1], row[1], samples[1], told)
            assert TRUTHS[told[6]] is truth, (case.tree, case.signals, row, samples, told)
    assert next(records, None) is None


@pytest.mark.parametrize(
    ("cc", "flags"),
    [
        ("gcc", ["-O1", *CHECKED]),
        pytest.param("clang", ["-O3"], marks=pytest.mark.slow),
        pytest.param("gcc", ["-O3", "-march=native"], marks=pytest.mark.slow),
    ],
)
def test_samples_say_in_c_what_they_say_in_an_audit(
    cc: str, flags: list[str], tmp_path: Path
) -> None:
    hold(tmp_path, collected(40), *flags, cc=cc)


@each("folder", ["requirements", "requirements/mission", "requirements/agv"])
@pytest.mark.parametrize(
    "command",
    [
        ["gcc", *STRICT],
        ["clang", *STRICT],
        ["gcc", *STRICT, "-m32", "-msse2", "-mfpmath=sse", "-ffreestanding"],
        ["g++", "-x", "c++", "-std=c++17", *STRICT[1:]],
    ],
)
def test_the_projects_of_this_repository_compile_without_a_warning(
    folder: str, command: list[str], tmp_path: Path
) -> None:
    project = load([str(path) for path in sorted(ROOT.joinpath(folder).glob("*.fret"))])
    for file in TARGET.emit(project.rules, Options(one_file=True)):
        tmp_path.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    compile_ = [compiler(command[0]), *command[1:], "-c", "monitors_signals.c", "-o", "x.o"]
    done = subprocess.run(compile_, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]


@each("flag", ["-ffast-math", "-ffinite-math-only", "-m32 -mno-sse -ffreestanding"])
def test_inexact_arithmetic_is_no_text_that_compiles(flag: str, tmp_path: Path) -> None:
    project = load([str(ROOT / "requirements/r1.fret")])
    for file in TARGET.emit(project.rules):
        tmp_path.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    compile_ = [compiler("gcc"), *flag.split(), "-c", "r1_signals.c", "-o", "x.o"]
    done = subprocess.run(compile_, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "#error" in done.stderr


WORDS = ("idle", 'say "?"', "dr\u00e9ive", "9")
NUMBERS = (0, 4, -1)
TICK = """
#include <stdio.h>
#include "monitors_signals.h"

int main(void)
{
    static monitors_samples samples;
    unsigned char length;
    char text[16];
    double number;
    monitors_held held = {FRETC_UNKNOWN}, holding;
    monitors_inputs tick, next;
    bool is_first = true;
    while (fread(&length, 1, 1, stdin) == 1 && fread(text, 1, 16, stdin) == 16
           && fread(&number, 8, 1, stdin) == 1) {
        samples.mode.number = monitors_sample_mode(text, length);
        samples.gear.number = monitors_sample_gear(number);
        monitors_instant(&samples, 0, &held, &next);
        monitors_holding(&samples, 0, &held, &holding);
        putchar(next.p0); putchar(next.p1); putchar(next.p2); putchar(holding.p3_for_1);
        held = holding; /* as if it had held since then */
        monitors_instant(&samples, 0, &held, &next);
        putchar(next.p3);
        if (is_first) { tick = next; } else { monitors_gather(&tick, &next); }
        is_first = false;
    }
    monitors_assume(&tick);
    putchar(tick.p0); putchar(tick.p1); putchar(tick.p2); putchar(tick.p3);
    return 0;
}
"""


def is_word(signal: str, sign: Any, text: str) -> e.Expression:
    return e.Comparison(sign, e.Name(signal), e.Word(text))


PROPOSITIONS = (
    Proposition("p0", e.Or((is_word("mode", "=", WORDS[1]), is_word("mode", "=", WORDS[2])))),
    Proposition("p1", is_word("mode", "!=", "idle"), aggregate=Aggregate.ANY, on_unknown=False),
    Proposition("p2", is_word("gear", "!=", "back"), aggregate=Aggregate.ALL),
    Proposition(
        "p3",
        e.Not(e.Persistence(is_word("gear", "=", "forward"), 10**9)),
        aggregate=Aggregate.ALL,
        on_unknown=True,
    ),
)


def of_words() -> Declarations:
    places = [path(f"/t.{name}") for name in ("mode", "gear")]
    mode, gear = (place for place in places if place is not None)
    signals = {
        "mode": Signal("mode", mode, ONE, "", values=WORDS),
        "gear": Signal("gear", gear, ONE, "", values=("park", "forward", "back"), numbers=NUMBERS),
    }
    named = {each.name: each for each in PROPOSITIONS}
    return Declarations(Source("bindings.toml", ""), Clock(10**8), signals, named)


def test_words_durations_and_the_instants_of_a_tick(tmp_path: Path) -> None:
    declarations = of_words()
    subjects = [rule(f"the sw shall always satisfy {p.name}", p.name) for p in PROPOSITIONS]
    rules = [replace(each, declarations=declarations) for each in subjects]
    for file in TARGET.emit(rules, Options(one_file=True)):
        tmp_path.joinpath(str(file.path)).write_text(file.text, encoding="utf-8")
    tmp_path.joinpath("main.c").write_text(TICK, encoding="utf-8")
    sources = ["main.c", "monitors_signals.c", "-o", "main"]
    subprocess.run([compiler("gcc"), *STRICT, *CHECKED, *sources], cwd=tmp_path, check=True)
    choose = random.Random(7)
    for _ in range(200):
        rows = [
            (choose.choice([*WORDS, "", "idle ", "Idle"]), choose.choice([*NUMBERS, 1.5, math.nan]))
            for _ in range(choose.randint(1, 5))
        ]
        data = b"".join(
            struct.pack("=B16sd", len(text.encode()), text.encode(), number)
            for text, number in rows
        )
        done = subprocess.run([tmp_path / "main"], input=data, capture_output=True, check=True)
        told = [TRUTHS[byte] for byte in done.stdout]
        columns = [states(each, declarations, rows) for each in PROPOSITIONS]
        expected = [[column[k] for column in columns] for k in range(len(rows))]
        for k, now in enumerate(expected):
            p0, p1, p2, holding, p3 = told[5 * k : 5 * k + 5]
            assert [p0, p1, p2, p3] == now, rows
            assert holding is (None if p3 is None else not p3)
        assert told[5 * len(rows) :] == [
            decided(p, [now[i] for now in expected]) for i, p in enumerate(PROPOSITIONS)
        ], rows


def states(
    proposition: Proposition, declarations: Declarations, rows: list[tuple[str, float]]
) -> list[Truth]:
    """The audit's truths; a duration is as what it is about."""
    found = []
    for text, number in rows:
        message = SimpleNamespace(mode=text, gear=number)
        places = {name: word(each, message) for name, each in declarations.signals.items()}
        row = {n: np.array([np.nan if isinstance(p, str) else p]) for n, p in places.items()}
        tree = proposition.expression
        if isinstance(tree, e.Not) and isinstance(tree.arg, e.Persistence):
            tree = e.Not(tree.arg.arg)
        found.append(audited_truth(tree, declarations.signals, row))
    return found


def decided(proposition: Proposition, truths: list[Truth]) -> Truth:
    """What a tick says that sees these instants, in an audit."""
    codes = np.array([(False, None, True).index(each) for each in truths], np.int8)
    steps = Steps(np.arange(len(truths)), codes)
    ends = np.array([0]), np.array([len(truths)])
    (value,) = truth_values(combined(steps, *ends, proposition))
    return value
