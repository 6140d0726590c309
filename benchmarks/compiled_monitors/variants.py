"""A monitor as a program: its files, and the loop that calls it. C is not inlined across files."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from benchmarks.compiled_monitors import copilot_files, java_program
from benchmarks.compiled_monitors.program import Program
from benchmarks.compiled_monitors.requirement_files import Demand, Task
from compiler.targets.c.monitor import TARGET as C
from compiler.targets.rust.monitor import TARGET as RUST
from compiler.targets.target import TargetOptions

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Variant:
    """A way to a monitor."""

    name: str
    compiler: str
    build: Callable[[Task, Path], Program | None]
    """In an empty folder; None: it is not written so."""


def variants() -> list[Variant]:
    """Those whose compilers are installed."""
    styles: Mapping[str, Callable[[Task], Mapping[str, str] | None]] = {
        "fretc C": _emitted,
        "by hand": _by_hand,
        "Copilot, library": partial(_copilot, style="library"),
        "Copilot, counters": partial(_copilot, style="counter"),
    }
    found = [
        Variant(f"{name}, {cc}", cc, partial(_c, files=files, cc=cc))
        for name, files in styles.items()
        for cc in ("gcc", "clang")
    ]
    found.append(Variant("fretc Rust", "rustc", _rust))
    found.append(Variant("fretc Java", "javac", java_program.build))
    return [each for each in found if shutil.which(each.compiler) and shutil.which("gcc")]


def _c(
    task: Task, folder: Path, files: Callable[[Task], Mapping[str, str] | None], cc: str
) -> Program | None:
    """Of `monitor.c`, what it includes, and `loop.c`."""
    texts = files(task)
    if texts is None:
        return None
    for name, text in texts.items():
        folder.joinpath(name).write_text(text, encoding="utf-8")
    flags = ["-std=c99", "-O2", f"-I{HERE}", "-w", "-c"]
    for name in ("monitor.c", "loop.c"):
        subprocess.run([cc, *flags, name], cwd=folder, check=True)
    return _linked(folder, "monitor.o", ["monitor.o", "loop.o"])


def _linked(folder: Path, monitor: str, objects: Sequence[str]) -> Program:
    flags = ["-std=c99", "-O2", "-o", "program", str(HERE / "main.c"), *objects]
    subprocess.run(["gcc", *flags], cwd=folder, check=True)
    lines = subprocess.run(
        ["size", monitor], cwd=folder, check=True, capture_output=True, text=True
    ).stdout.splitlines()[1:]
    text, data, bss = (sum(int(line.split()[i]) for line in lines) for i in range(3))
    return Program(folder / "program", text, data + bss)


def _loop(start: str, reset: str, tick: str, finite: Sequence[str], size: str, width: int) -> str:
    """C that calls a monitor, and reads the first demand at each tick, all at the end."""
    return f"""#include <stddef.h>
#include <stdint.h>
{start}
void monitor_reset(void) {{ {reset} }}
size_t monitor_bytes(void) {{ return {size}; }}
uint64_t monitor_run(const uint8_t *rows, size_t ticks)
{{
    uint64_t sum = 0;
    for (const uint8_t *row = rows; ticks-- > 0; row += {width}) {{
        {tick}
        sum += {finite[0]};
    }}
    {"".join(f"sum += {each}; " for each in finite)}
    return sum;
}}
"""


# fretc ------------------------------------------------------------------------------------------


def _emitted(task: Task) -> Mapping[str, str]:
    files = C.emit([each.requirement() for each in task.demands], TargetOptions(one_file=True))
    header, source = (
        next(file.text for file in files if str(file.path).endswith(e)) for e in (".h", ".c")
    )
    places = {name: i for i, name in enumerate(task.propositions)}
    names = _members(header, "monitors_inputs", "fretc_truth")
    assert [places[name] for name in names] == [*range(len(places))], "a row is a struct of inputs"
    outcomes = _members(header, "monitors_outcomes", "fretc_outcome")
    loop = _loop(
        '#include "monitors.h"\nstatic monitors_state state;\nstatic monitors_outcomes outcomes;',
        "monitors_init(&state);",
        "monitors_step(&state, (const monitors_inputs *)row, &outcomes);",
        [f"outcomes.{name}.finite == FRETC_TRUE" for name in outcomes],
        "sizeof state",
        len(names),
    )
    return {"monitors.h": header, "monitor.c": source, "loop.c": loop}


def _members(header: str, name: str, kind: str) -> list[str]:
    body = header[: header.index(f"\n}} {name};\n")].rpartition("typedef struct {")[2]
    return re.findall(rf"^    {kind} (\w+);", body, re.M)


def _rust(task: Task, folder: Path) -> Program:
    files = RUST.emit([each.requirement() for each in task.demands], TargetOptions(one_file=True))
    library = next(file.text for file in files if str(file.path).endswith("src/lib.rs"))
    names = re.findall(r"^    pub (\w+):", _struct(library, "Inputs"), re.M)
    outcomes = re.findall(r"^    pub (\w+):", _struct(library, "Outcomes"), re.M)
    values = "".join(f"{name}: Some(row[{i}] != 0), " for i, name in enumerate(names))
    holds = "".join(f"sum += u64::from(last.{name}.finite == Some(true)); " for name in outcomes)
    loop = f"""use monitor::{{Inputs, Monitor}};
static mut STATE: Monitor = Monitor::new();
static mut INPUTS: Vec<Inputs> = Vec::new();
#[no_mangle]
pub extern "C" fn monitor_reset() {{ unsafe {{ STATE = Monitor::new(); }} }}
#[no_mangle]
pub extern "C" fn monitor_bytes() -> usize {{ std::mem::size_of::<Monitor>() }}
#[no_mangle]
pub unsafe extern "C" fn monitor_run(rows: *const u8, ticks: usize) -> u64 {{
    let (state, inputs) = (&mut *(&raw mut STATE), &mut *(&raw mut INPUTS));
    if inputs.is_empty() {{
        let rows = std::slice::from_raw_parts(rows, ticks * {len(names)});
        inputs.extend(rows.chunks_exact({len(names)}).map(|row| Inputs {{ {values} }}));
        return monitor_run(rows.as_ptr(), ticks);
    }}
    let mut sum = 0;
    for now in &inputs[..ticks - 1] {{
        sum += u64::from(state.step(now).{outcomes[0]}.finite == Some(true));
    }}
    let last = state.step(&inputs[ticks - 1]);
    sum += u64::from(last.{outcomes[0]}.finite == Some(true));
    {holds}
    sum
}}
"""
    folder.joinpath("monitor.rs").write_text(library, encoding="utf-8")
    folder.joinpath("loop.rs").write_text(loop, encoding="utf-8")
    flags = ["--edition", "2021", "-C", "opt-level=2", "-C", "panic=abort", "-A", "warnings"]
    for kind, name in (("rlib", "monitor.rs"), ("staticlib", "loop.rs")):
        libraries = ["--extern", "monitor=libmonitor.rlib"] if kind == "staticlib" else []
        command = ["rustc", *flags, "--crate-type", kind, *libraries, name]
        subprocess.run(command, cwd=folder, check=True)
    return _linked(folder, "libmonitor.rlib", ["libloop.a", "-lpthread", "-ldl", "-lm"])


def _struct(library: str, name: str) -> str:
    return library.partition(f"pub struct {name} {{\n")[2].partition("\n}\n")[0]


# Others -----------------------------------------------------------------------------------------


def _by_hand(task: Task) -> Mapping[str, str]:
    demands, names = task.demands, task.propositions
    kinds = [each.kind.lower() for each in demands]
    cells = "".join(f"    {kind}_t r{i};\n" for i, kind in enumerate(kinds))
    starts, steps = "", ""
    for i, each in enumerate(demands):
        bound = f", {each.bound}" if each.bound else ""
        first = bound if each.kind == "W3" else ""
        values = "".join(f", in->{name}" for name in each.names.values())
        starts += f"    {kinds[i]}_init(&state->r{i}{first});\n"
        steps += f"    {kinds[i]}_step(&state->r{i}{values}{bound}, &out->r{i});\n"
    header = f"""#include "by_hand.h"
typedef struct {{
{cells}}} monitor_state;
typedef struct {{
{"".join(f"    bool {name};" for name in names)}
}} monitor_inputs;
typedef struct {{
{"".join(f"    outcome_t r{i};" for i in range(len(demands)))}
}} monitor_outcomes;
void monitor_init(monitor_state *state);
void monitor_step(monitor_state *state, const monitor_inputs *in, monitor_outcomes *out);
"""
    source = f"""#include "monitor.h"
void monitor_init(monitor_state *state)
{{
{starts}}}
void monitor_step(monitor_state *state, const monitor_inputs *in, monitor_outcomes *out)
{{
{steps}}}
"""
    loop = _loop(
        '#include "monitor.h"\nstatic monitor_state state;\nstatic monitor_outcomes outcomes;',
        "monitor_init(&state);",
        "monitor_step(&state, (const monitor_inputs *)row, &outcomes);",
        [f"outcomes.r{i}.finite" for i in range(len(demands))],
        "sizeof state",
        len(names),
    )
    return {"monitor.h": header, "monitor.c": source, "loop.c": loop}


_MOST_LIBRARY = 100
"""Requirements with the library's operators: of a thousand it has 0.9 million lines."""


def _copilot(task: Task, style: str) -> Mapping[str, str] | None:
    if style == "library" and len(task.demands) > _MOST_LIBRARY:
        return None
    text = copilot_files.text(task.demands, style)
    if text is None or (style == "counter" and not any(_counts(each) for each in task.demands)):
        return None
    count, names = len(task.demands), task.propositions
    handlers = "".join(
        f"void r{i}_verdict(bool value) {{ truths[{i}] = value; }}\n" for i in range(count)
    )
    # Copilot has no way back to the first state: its variables have a section of their own.
    kept = """#define static static __attribute__((section("monitor")))\n"""
    return {
        "monitor.c": text.replace("static ", kept + "static ", 1),
        "loop.c": _loop(
            f"""#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
bool {", ".join(names)};
static bool truths[{count}];
void step(void);
{handlers}extern char __start_monitor[], __stop_monitor[];
#define SIZE ((size_t)(__stop_monitor - __start_monitor))
static char *first;""",
            "if (!first) memcpy(first = malloc(SIZE), __start_monitor, SIZE); "
            "memcpy(__start_monitor, first, SIZE);",
            "".join(f"{name} = row[{i}]; " for i, name in enumerate(names)) + "step();",
            [f"truths[{i}]" for i in range(count)],
            "SIZE",
            len(names),
        ),
    }


def _counts(demand: Demand) -> bool:
    return demand.kind in ("W2", "W3")
