"""Monitors in C, compiled and stepped: at each tick they tell what those in Python tell."""

import random
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from itertools import islice
from pathlib import Path

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.c.monitor import TARGET
from compiler.targets.python.monitor import text
from monitors.kernel import Monitor
from monitors.kernel.columns import columns_of, pieces_of
from monitors.kernel.stepping import literals_of
from monitors.kernel.verdicts import Signals
from monitors.loading import load
from tests import meaning
from tests.c_monitors import (
    CHECKED,
    STRICT,
    Program,
    Rows,
    Source,
    compiled,
    of_python,
    write,
)
from tests.each import each
from tests.effort import FULL
from tests.emitting import refused
from tests.monitoring import requirement
from tests.programs import installed
from tests.strategies import COUNTS, few_templates, templates

SIGNALS = {name: name for name in ("trigger", "violation", "satisfied_forever", "answer")} | {
    "open": "obligation_pending"
}
ROOT = Path(__file__).parents[4]
WITHIN = "whenever p the sw shall within 100 ticks satisfy q"


def rows(choose: random.Random, width: int, length: int) -> Rows:
    """A value stays for some ticks; some traces have unknown values, first or later."""
    stays = choose.choice([0.0, 0.5, 0.9])
    unknown = choose.choice([0.0, 0.0, 0.02, 0.3])
    shares = [choose.choice([0.1, 0.5, 0.9]) for _ in range(width)]
    values: list[bool | None] = [choose.random() < share for share in shares]
    found = []
    for _ in range(length):
        for i, share in enumerate(shares):
            if choose.random() >= stays:
                values[i] = None if choose.random() < unknown else choose.random() < share
        found.append(tuple(values))
    return found


def columns(machine: Monitor, trace: Rows, is_possible: bool) -> tuple[Signals[int], ...]:
    """The signals of the monitor's columns on one approximation."""
    every = (1 << len(trace)) - 1
    _, made = columns_of(pieces_of(trace), len(machine.PROPOSITIONS))
    named = dict(zip(machine.PROPOSITIONS, made, strict=True))
    return machine.columns(every, **literals_of(machine, named, every, is_possible))


def hold(machine: Monitor, program: Program, *traces: Rows, place: int = 0) -> None:
    """C, the steps of Python and its columns tell the same at each tick of all traces."""
    _, found = program.run(*((place, trace) for trace in traces))
    for trace, outcomes in zip(traces, found, strict=True):
        certain, possible = (columns(machine, trace, is_possible) for is_possible in (False, True))
        for tick, (expected, told) in enumerate(
            zip(of_python(machine, trace), outcomes, strict=True)
        ):
            assert told == expected, (tick, trace)
            for one, low, high in zip(told, certain, possible, strict=True):
                for reading, signals in ((one.certain, low), (one.possible, high)):
                    for name, signal in SIGNALS.items():
                        column = getattr(signals, signal)
                        assert getattr(reading, name) is bool(column >> tick & 1), (name, tick)


@cache
def of_requirements() -> list[FormalizedRequirement]:
    """Requirements of each form: a latch, counters, the tick before, a deadline, a ring."""
    return [
        requirement(WITHIN, "R1"),
        requirement("in m mode whenever p the sw shall eventually satisfy q", "R2"),
        requirement("only before m whenever p the sw shall for 3 ticks satisfy q", "R3"),
        requirement("upon p the sw shall after 2 ticks satisfy (p xor preBool(true, s))", "R4"),
        requirement("whenever p the sw shall immediately satisfy occurred(33, 35, q)", "R5"),
        requirement("whenever p the sw shall immediately satisfy persisted(2, 4, !q)", "R6"),
        requirement("the sw shall until s satisfy q", "R7"),
        requirement("the sw shall always satisfy true", "R8"),
    ]


def monitors(requirements: list[FormalizedRequirement]) -> Monitor:
    return load("monitors.py", text(*requirements))


def in_files(counts: tuple[int, ...] = COUNTS) -> list[list[str]]:
    """Sentences of templates: with the full profile all, of each scope together."""
    if not FULL:
        return [[template.sentence for template in few_templates(counts)]]
    every = [*templates(counts)]
    return [[each.sentence for each in every if each.scope == scope] for scope in meaning.SCOPES]


@pytest.mark.slow
@each("sentences", in_files())
def test_every_template_tells_the_same_at_each_tick(sentences: list[str], tmp_path: Path) -> None:
    """Several in one file, which computes what they share once."""
    requirements = [requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences)]
    machine, source = monitors(requirements), Source.of(*requirements)
    assert source.inputs == (*machine.PROPOSITIONS,)
    program, choose = compiled(tmp_path, "gcc", source), random.Random(sentences[0])
    width = len(source.inputs)
    hold(machine, program, *(rows(choose, width, choose.choice([6, 12, 60])) for _ in range(24)))


def test_a_counter_that_requirements_share_tells_each_its_own_deadline(tmp_path: Path) -> None:
    """It goes on behind the earlier deadline: there `left` is -1, as where nothing is open."""
    within, after = (f"upon p the sw shall {t} 2 ticks satisfy q" for t in ("within", "after"))
    requirements = [requirement(within, "R1"), requirement(after, "R2")]
    flags = [*STRICT, *(CHECKED if FULL else ())]
    program = compiled(tmp_path, "gcc", Source.of(*requirements), flags=flags)
    trace = [(False, False), (True, False), *[(True, False)] * 4]
    told = program.run((0, trace))[1][0]
    assert [one.certain.left for one, _ in told] == [-1, 2, 1, 0, -1, -1]
    hold(monitors(requirements), program, trace)


_EXPRESSIONS = (
    "p", "!q", "(p & s)", "(m xor q)", "(p <-> s)", "preBool(true, q)", "persisted({hi}, q)",
    "occurred({hi}, (p | m))", "persisted({lo}, {hi}, p)", "occurred({lo}, {hi}, s)",
)  # fmt: skip


def drawn(choose: random.Random) -> Iterator[str]:
    """Sentences of any shape, with bounds as large as their traces are long, and larger."""
    shapes = [*templates((0,))]
    while True:
        n = choose.choice([1, 7, 40, 1000, 10**6])
        sentence = choose.choice(shapes).sentence.replace(" 0 ticks", f" {n} ticks")
        names = {name: choose.choice(_EXPRESSIONS) for name in "mpqs"}
        free = re.sub("(before|after) m mode", r"\1 m", sentence)
        words = free.replace("m mode", "m\tmode").split(" ")
        words = [names[w] if w in names and choose.random() < 0.6 else w for w in words]
        lo = choose.choice([0, 1, 2, 9, 33, 64])
        yield " ".join(words).format(lo=lo, hi=lo + choose.choice([0, 1, 5, 70]))


@pytest.mark.slow
@each("seed", range(2 if FULL else 1))
def test_any_sentence_tells_the_same_at_each_tick(seed: int, tmp_path: Path) -> None:
    choose = random.Random(seed)
    requirements = [
        requirement(sentence, f"R{i}")
        for i, sentence in enumerate(islice(drawn(choose), 40 if FULL else 20))
    ]
    machine, source = monitors(requirements), Source.of(*requirements)
    program = compiled(tmp_path, "gcc", source)
    width = len(source.inputs)
    hold(machine, program, *(rows(choose, width, choose.choice([20, 150, 300])) for _ in range(3)))


@pytest.mark.slow
def test_monitors_in_one_file_tell_the_same(tmp_path: Path) -> None:
    machine, source = monitors(of_requirements()), Source.of(*of_requirements())
    program = compiled(tmp_path, "gcc", source, flags=[*STRICT, "-O0"])
    choose, width = random.Random(1), len(source.inputs)
    hold(machine, program, rows(choose, width, 60), rows(choose, width, 9))


@pytest.mark.slow
@each("cc", ["gcc", "clang"])
def test_monitors_in_files_of_their_own_tell_the_same(cc: str, tmp_path: Path) -> None:
    """Made faster by the compiler; their state is as large as their headers say."""
    sources = [Source.of(each) for each in of_requirements()]
    program, choose = compiled(tmp_path, cc, *sources, flags=[*STRICT, "-O2"]), random.Random(cc)
    sizes, _ = program.run()
    for place, (one, source) in enumerate(zip(of_requirements(), sources, strict=True)):
        machine = monitors([one])
        width = len(machine.PROPOSITIONS)
        traces = rows(choose, width, 90), rows(choose, width, 9)
        hold(machine, program, *traces, place=place)
        header = next(text for name, text in source.texts.items() if name.endswith(".h"))
        assert f" * State: {sizes[place]} bytes," in header


CLASHES = (
    "class", "now", "approximation", "state", "since_1", "is_p", "not_p", "INT32_MAX", "true_",
    "linux", "near", "C1_MONITOR_H", "UINT32_C", "c1_step", "c1_inputs", "x > 3", "x_gt_3", "a*/b",
    "reading", "_A", "__cplusplus", "p??/", "certain", "uint8_t", "fretc_truth", "FRETC_TRUE",
    "errno", "_Bool",
)  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cc", "processor"),
    [
        ("aarch64-linux-gnu-gcc", "qemu-aarch64-static"),
        ("arm-linux-gnueabihf-gcc", "qemu-arm-static"),
    ],
)
def test_monitors_for_processors_of_arm_tell_the_same(
    cc: str, processor: str, tmp_path: Path
) -> None:
    """The second has words of 32 bits, and on both a `char` has no sign."""
    requirements, choose = of_requirements(), random.Random(cc)
    machine, source = monitors(requirements), Source.of(*requirements)
    launcher = (installed(processor),)
    program = compiled(tmp_path, cc, source, flags=[*STRICT, "-static"], launcher=launcher)
    width = len(source.inputs)
    hold(machine, program, *(rows(choose, width, choose.choice([12, 60, 140])) for _ in range(20)))
    for sentences in in_files():
        every = [requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences)]
        machine, source = monitors(every), Source.of(*every)
        program = compiled(tmp_path, cc, source, flags=[*STRICT, "-static"], launcher=launcher)
        hold(machine, program, *(rows(choose, len(source.inputs), 60) for _ in range(24)))


def clashing(id: str) -> Source:
    """A monitor whose propositions are called as what is generated is, and as key words are."""
    quoted = (name if re.fullmatch(r"x > 3", name) else f'"{name}"' for name in CLASHES)
    sentence = f"whenever p & !q the sw shall within 3 ticks satisfy {' | '.join(quoted)}"
    return Source.of(requirement(sentence, id))


DIALECTS = {
    "gcc": STRICT,
    "clang": [*STRICT, "-Wcomment"],
    "g++": "-x c++ -std=c++17 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror".split(),
    "clang++": "-x c++ -std=c++17 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror".split(),
    "gcc for 32 bits": [*STRICT, "-m32", "-ffreestanding", "-fno-pic", "-O2"],
    "clang for ARM": [*STRICT, "--target=arm-none-eabi", "-ffreestanding", "-nostdlib", "-O2"],
}


@pytest.mark.slow
@each("dialect", DIALECTS)
def test_every_dialect_takes_it_without_a_warning_and_needs_nothing_else(
    dialect: str, tmp_path: Path
) -> None:
    sources = [Source.of(*of_requirements()), *map(clashing, ("C1", "class", "fretc", "1.main-x"))]
    files = write(tmp_path, *sources)
    cc = installed(dialect.split()[0])
    objects = [path.with_suffix(".o") for path in files]
    for path, made in zip(files, objects, strict=True):
        subprocess.run([cc, *DIALECTS[dialect], "-c", path, "-o", made], check=True)
    undefined = subprocess.run([installed("nm"), "-u", *objects], capture_output=True, check=True)
    assert not re.search(rb"\bU\b", undefined.stdout), undefined.stdout.decode()


@each("name", ["1.main-x", "int", "G-2"])
def test_any_id_gives_a_header_that_compiles(name: str, tmp_path: Path) -> None:
    files = write(tmp_path, Source.of(requirement(WITHIN, name)))
    command = [installed("gcc"), *STRICT, "-fsyntax-only", *map(str, files)]
    subprocess.run(command, check=True)


def test_headers_stand_side_by_side(tmp_path: Path) -> None:
    sources = [Source.of(each) for each in of_requirements()]
    write(tmp_path, *sources)
    names = [name for each in sources for name in each.texts if name.endswith(".h")]
    both = "".join(f'#include "{name}"\n' for name in (*names, *names))
    tmp_path.joinpath("both.c").write_text(both, encoding="utf-8")
    subprocess.run([installed("gcc"), *STRICT, "-fsyntax-only", tmp_path / "both.c"], check=True)


def test_bounds_that_a_controller_cannot_keep_are_refused() -> None:
    assert refused("c", f"the sw shall within {2**31} ticks satisfy q").splitlines() == [
        "F601 a monitor in C cannot express a bound of 2^31 ticks or more of R1",
        "  --> r.fret:1:1",
        "   | the sw shall within 2147483648 ticks satisfy q",
        f"   | {'^' * 46}",
        "help: counters have 32 bits: choose a longer tick",
    ]
    sentence = "the sw shall immediately satisfy occurred(9000000, 9000001, q)"
    assert "more than 8388608 ticks ago" in refused("c", sentence)
    assert TARGET.refuse(requirement(f"the sw shall within {2**31 - 3} ticks satisfy q")) is None


def test_the_example_of_the_documentation_compiles(tmp_path: Path) -> None:
    page = ROOT.joinpath("docs/targets.md").read_text("utf-8")
    section = page.partition("## `--emit c`\n")[2].partition("\n## ")[0]
    examples = re.findall(r"^    #include(?:.*\n(?=    |\n))+", section, re.MULTILINE)
    [example] = [each for each in examples if "r1_monitor.h" in each]
    assert "r1_step" in example
    write(
        tmp_path, Source.of(requirement("whenever too_close sw shall eventually satisfy stopped"))
    )
    tmp_path.joinpath("example.c").write_text(example, encoding="utf-8")
    subprocess.run([installed("gcc"), *STRICT, "-fsyntax-only", tmp_path / "example.c"], check=True)


def test_the_work_of_a_step_does_not_depend_on_the_bound() -> None:
    """What a step does is its text: it has no loop, and calls nothing but its own functions."""

    def work(n: int) -> tuple[str, int]:
        texts = Source.of(requirement(f"in m mode the sw shall within {n} ticks satisfy q")).texts
        header, source = texts["r1_monitor.h"], texts["r1_monitor.c"]
        operations = re.search(r"at most (\d+) operations", header)
        assert operations is not None
        return source[source.index("static inline void r1_advance") :], int(operations[1])

    (step, operations), (larger, same) = work(10), work(100_000)
    assert operations == same > 50
    assert re.sub(r"\d\d+", "", step) == re.sub(r"\d\d+", "", larger)
    assert set(re.findall(r"(\w+)\(", step)) == {"r1_advance", "r1_judge", "r1_step"}
    assert not re.search(r"\b(for|while|goto)\b", step)
