"""Monitors in Rust, compiled into one program that steps them over traces."""

from __future__ import annotations

import re
import struct
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.rust.monitor import TARGET
from compiler.targets.target import TargetOptions
from tests.c_monitors import VERDICTS, Outcome, Reading, Rows
from tests.programs import installed, leave_out

STRICT = ["--edition", "2021", "-D", "warnings", "-C", "debug-assertions=on"]
_TRUTHS = (False, True, None)


@dataclass(frozen=True)
class ArmProcessor:
    """A processor for which `rustc` compiles, with the linker and the emulator for it."""

    target: str
    linker: str
    emulator: str

    @property
    def options(self) -> tuple[str, ...]:
        """Options of `rustc`; the test is skipped where the library for this target is missing."""
        command = [installed("rustc"), "--print", "sysroot"]
        root = subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
        if not Path(root, "lib/rustlib", self.target).exists():
            leave_out(
                f"needs Rust's library for {self.target}: python -m benchmarks.aarch64 --rust"
            )
        linker = f"linker={installed(self.linker)}"
        return ("--target", self.target, "-C", linker, "-C", "target-feature=+crt-static")


ARM = (
    ArmProcessor("aarch64-unknown-linux-gnu", "aarch64-linux-gnu-gcc", "qemu-aarch64-static"),
    ArmProcessor("armv7-unknown-linux-gnueabihf", "arm-linux-gnueabihf-gcc", "qemu-arm-static"),
)


def crate(*requirements: FormalizedRequirement) -> Mapping[str, str]:
    """The files of one crate."""
    assert [TARGET.refuse(requirement) for requirement in requirements] == [None] * len(
        requirements
    )
    files = TARGET.emit(requirements, TargetOptions(one_file=len(requirements) > 1))
    return {str(file.path): file.text for file in files}


def write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def library(files: Mapping[str, str]) -> str:
    return next(text for name, text in files.items() if name.endswith("src/lib.rs"))


def fields(text: str, struct_: str) -> list[str]:
    body = text.partition(f"pub struct {struct_} {{\n")[2].partition("\n}\n")[0]
    return re.findall(r"^    pub (\w+):", body, re.M)


def outcomes(
    folder: Path,
    libraries: Sequence[str],
    traces: Sequence[tuple[int, Rows]],
    lints: Sequence[str] = (),
    arm: ArmProcessor | None = None,
) -> list[list[list[Outcome]]]:
    """Of each trace all outcomes at each tick.

    Args:
        folder: for what is compiled.
        libraries: texts of `lib.rs`.
        traces: the place of a library, and rows in the order of its inputs.
        lints: further options for the libraries.
        arm: compile for this processor, and run the program under emulation.
    """
    rustc = [installed("rustc"), *(arm.options if arm else ())]
    for place, text in enumerate(libraries):
        (folder / f"m{place}.rs").write_text(text, encoding="utf-8")
        kind = ["--crate-type", "rlib", "--crate-name", f"m{place}"]
        subprocess.run([*rustc, *STRICT, *lints, *kind, f"m{place}.rs"], cwd=folder, check=True)
    (folder / "main.rs").write_text(_main(libraries), encoding="utf-8")
    externs = [f"--extern=m{place}=libm{place}.rlib" for place in range(len(libraries))]
    subprocess.run([*rustc, "--edition", "2021", *externs, "main.rs"], cwd=folder, check=True)
    data = b"".join(
        struct.pack("=II", place, len(rows))
        + bytes(_TRUTHS.index(value) for row in rows for value in row)
        for place, rows in traces
    )
    launcher = [installed(arm.emulator)] if arm else []
    program = [*launcher, str(folder / "main")]
    done = subprocess.run(program, input=data, capture_output=True, check=True)
    readings = struct.iter_unpack("=i7?i7?BBB", done.stdout)
    found = (
        Outcome(Reading(*r[:8]), Reading(*r[8:16]), VERDICTS[r[16]], _TRUTHS[r[17]], _TRUTHS[r[18]])
        for r in readings
    )
    sizes = [len(fields(text, "Outcomes")) for text in libraries]
    told = [[[next(found) for _ in range(sizes[p])] for _ in rows] for p, rows in traces]
    assert next(found, None) is None
    return told


def _main(libraries: Sequence[str]) -> str:
    cases = "".join(_case(place, text) for place, text in enumerate(libraries))
    return f"""use std::io::{{Read, Write}};

macro_rules! put {{
    ($out:expr, $o:expr) => {{{{
        let o = $o;
        for r in [o.certain, o.possible] {{
            $out.extend(r.left.map_or(-1, |left| left as i32).to_ne_bytes());
            let signals = [r.trigger, r.violation, r.open, r.satisfied_forever, r.answer];
            $out.extend([r.violated, r.failed].map(u8::from));
            $out.extend(signals.map(u8::from));
        }}
        $out.push(o.verdict as u8);
        $out.push(o.finite.map_or(2, u8::from));
        $out.push(o.obligation_pending.map_or(2, u8::from));
    }}}};
}}

fn main() {{
    let mut data = Vec::new();
    std::io::stdin().read_to_end(&mut data).unwrap();
    let (mut at, mut out) = (0, Vec::new());
    while at < data.len() {{
        let word = |at: usize| u32::from_ne_bytes(data[at..at + 4].try_into().unwrap());
        let (place, ticks) = (word(at), word(at + 4));
        at += 8;
        let mut next = || {{
            at += 1;
            [Some(false), Some(true), None][usize::from(data[at - 1])]
        }};
        let _ = &mut next;
        match place {{
{cases}            _ => unreachable!(),
        }}
    }}
    std::io::stdout().write_all(&out).unwrap();
}}
"""


def _case(place: int, text: str) -> str:
    inputs = "".join(f"{name}: next(), " for name in fields(text, "Inputs"))
    puts = "".join(f"put!(out, o.{name}); " for name in fields(text, "Outcomes"))
    return f"""            {place} => {{
                let mut monitor = m{place}::Monitor::new();
                for _ in 0..ticks {{
                    let o = monitor.step(&m{place}::Inputs {{ {inputs}}});
                    {puts}
                }}
            }}
"""
