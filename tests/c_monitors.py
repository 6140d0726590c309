"""Monitors in C, compiled into one program that steps them over traces."""

from __future__ import annotations

import re
import struct
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.c.monitor import TARGET
from compiler.targets.target import TargetOptions
from monitors.kernel import Monitor
from monitors.kernel.stepping import Marks
from monitors.kernel.verdicts import Requirement, Signals, Truth
from tests.effort import FULL
from tests.programs import installed

STRICT = "-std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror".split()
CHECKED = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
CHECKED_IN_CPP = CHECKED if FULL else ["-D_GLIBCXX_ASSERTIONS"]
"""By default what the library of C++ checks itself: to compile the other takes twice the time."""
Rows = Sequence[Sequence[Truth]]


class Reading(NamedTuple):
    """One approximation after a tick."""

    left: int
    violated: bool
    failed: bool
    trigger: bool
    violation: bool
    open: bool
    satisfied_forever: bool
    answer: bool


class Outcome(NamedTuple):
    """One requirement after a tick."""

    certain: Reading
    possible: Reading
    verdict: str
    finite: Truth
    obligation_pending: Truth


VERDICTS = ("pending", "satisfied", "violated")
_TRUTHS: tuple[Truth, ...] = (False, True, None)


@dataclass(frozen=True)
class Source:
    """The texts of one monitor, and the names that they give."""

    texts: Mapping[str, str]
    base: str
    inputs: tuple[str, ...]
    outcomes: tuple[str, ...]

    @classmethod
    def of(cls, *requirements: FormalizedRequirement) -> Source:
        """One file of all requirements."""
        assert [TARGET.refuse(requirement) for requirement in requirements] == [None] * len(
            requirements
        )
        files = TARGET.emit(requirements, TargetOptions(one_file=len(requirements) > 1))
        texts = {str(file.path): file.text for file in files}
        header = next(text for name, text in texts.items() if name.endswith(".h"))
        (base,) = re.findall(r"^} (\w+)_inputs;$", header, re.M)
        inputs = _members(header, f"{base}_inputs", "fretc_truth")
        return cls(texts, base, inputs, _members(header, f"{base}_outcomes", "fretc_outcome"))

    @property
    def source(self) -> str:
        """The name of the file in C."""
        return next(name for name in self.texts if name.endswith(".c"))


def _members(header: str, name: str, kind: str) -> tuple[str, ...]:
    """Of a struct, those of this kind."""
    body = header[: header.index(f"\n}} {name};\n")].rpartition("typedef struct {")[2]
    return tuple(re.findall(rf"^    {kind} (\w+);", body, re.M))


def write(folder: Path, *sources: Source) -> list[Path]:
    """The files in the folder; gives those in C."""
    for source in sources:
        for name, text in source.texts.items():
            folder.joinpath(name).write_text(text, encoding="utf-8")
    return [folder / source.source for source in sources]


@dataclass(frozen=True)
class Program:
    """What steps the monitors."""

    path: Path
    sources: tuple[Source, ...]
    launcher: tuple[str, ...] = ()
    """What runs a program for another processor."""

    def run(self, *traces: tuple[int, Rows]) -> tuple[list[int], list[list[list[Outcome]]]]:
        """The bytes of state of each monitor, and of each trace all outcomes at each tick.

        Args:
            traces: the place of a monitor, and rows in the order of its inputs.
        """
        data = b"".join(
            struct.pack("=II", place, len(rows))
            + bytes(_TRUTHS.index(value) for row in rows for value in row)
            for place, rows in traces
        )
        done = subprocess.run(
            [*self.launcher, self.path], input=data, capture_output=True, check=False
        )
        assert (done.returncode, done.stderr) == (0, b""), done.stderr.decode()
        head = struct.Struct(f"={len(self.sources)}I")
        readings = struct.iter_unpack("=i7?i7?BBB", done.stdout[head.size :])
        outcomes = (
            Outcome(
                Reading(*r[:8]), Reading(*r[8:16]), VERDICTS[r[16]], _TRUTHS[r[17]], _TRUTHS[r[18]]
            )
            for r in readings
        )
        found = [
            [[next(outcomes) for _ in self.sources[place].outcomes] for _ in rows]
            for place, rows in traces
        ]
        assert next(outcomes, None) is None
        return [*head.unpack(done.stdout[: head.size])], found


def compiled(
    folder: Path,
    cc: str,
    *sources: Source,
    flags: Sequence[str] = (*STRICT, *CHECKED),
    launcher: tuple[str, ...] = (),
) -> Program:
    """Of all monitors, each with a base of its own."""
    files = write(folder, *sources)
    main = folder / "main.c"
    main.write_text(_main(sources), encoding="utf-8")
    path = folder / "main"
    subprocess.run([installed(cc), *flags, "-o", path, main, *files], check=True)
    return Program(path, sources, launcher)


def _main(sources: Sequence[Source]) -> str:
    """C that reads traces and writes outcomes."""
    includes = "".join(
        f'#include "{name}"\n' for each in sources for name in each.texts if name.endswith(".h")
    )
    sizes = "".join(f"    put_word(sizeof({each.base}_state));\n" for each in sources)
    cases = "".join(f"        case {i}: run_{i}(ticks); break;\n" for i in range(len(sources)))
    return f"""#include <stdio.h>
{includes}
static void put_word(size_t word)
{{
    const uint32_t value = (uint32_t)word;
    (void)fwrite(&value, sizeof value, 1, stdout);
}}

static void put_reading(const fretc_reading *r)
{{
    const uint8_t bits[7] = {{
        r->violated, r->failed, r->trigger, r->violation, r->open, r->satisfied_forever, r->answer
    }};
    (void)fwrite(&r->left, sizeof r->left, 1, stdout);
    (void)fwrite(bits, 1, 7, stdout);
}}

static void put(const fretc_outcome *o)
{{
    put_reading(&o->certain);
    put_reading(&o->possible);
    (void)putchar((int)o->verdict);
    (void)putchar(o->finite);
    (void)putchar(o->obligation_pending);
}}

{"".join(_runner(i, each) for i, each in enumerate(sources))}
int main(void)
{{
    uint32_t head[2];
{sizes}    while (fread(head, sizeof head[0], 2, stdin) == 2) {{
        const uint32_t ticks = head[1];
        switch (head[0]) {{
{cases}        default: return 1;
        }}
    }}
    return 0;
}}
"""


def _runner(place: int, source: Source) -> str:
    inputs = "".join(f"        in.{name} = (uint8_t)getchar();\n" for name in source.inputs)
    if source.inputs == ("none",):
        inputs = "        in.none = 0;\n"
    outcomes = "".join(f"        put(&out.{name});\n" for name in source.outcomes)
    return f"""static void run_{place}(uint32_t ticks)
{{
    static {source.base}_state state;
    static {source.base}_outcomes out;
    {source.base}_inputs in;
    {source.base}_init(&state);
    while (ticks-- > 0) {{
{inputs}        {source.base}_step(&state, &in, &out);
{outcomes}    }}
}}

"""


def of_python(machine: Monitor, rows: Rows) -> Iterator[list[Outcome]]:
    """What the monitor in Python tells at each tick, of rows in the order of `PROPOSITIONS`."""
    machine.reset()
    for row in rows:
        machine.advance([row])
        verdicts, statuses = machine.verdicts(), machine.statuses()
        approximations = [
            [
                *map(
                    _reading,
                    machine.REQUIREMENTS,
                    approximation.signals(),
                    approximation.marks(),
                    [machine.tick] * len(verdicts),
                )
            ]
            for approximation in (machine.certain, machine.possible)
        ]
        yield [
            Outcome(certain, possible, str(verdict), status.finite, status.obligation_pending)
            for certain, possible, verdict, status in zip(
                *approximations, verdicts, statuses, strict=True
            )
        ]


def _reading(requirement: Requirement, signals: Signals[bool], marks: Marks, tick: int) -> Reading:
    left = -1
    if marks.open >= 0 and requirement.deadline_ticks is not None:
        left = max(-1, marks.open + requirement.deadline_ticks - tick)
    return Reading(
        left,
        marks.violated >= 0,
        marks.broken >= 0 or signals.violated_if_ended,
        signals.trigger,
        signals.violation,
        signals.obligation_pending,
        signals.satisfied_forever,
        signals.answer,
    )
