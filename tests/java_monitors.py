"""Monitors in Java, compiled by one call of javac and stepped over traces by one Java program."""

from __future__ import annotations

import re
import struct
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.java.monitor import TARGET
from compiler.targets.target import TargetOptions
from tests.c_monitors import VERDICTS, Outcome, Reading, Rows
from tests.programs import installed

STRICT = ("--release", "11", "-Xlint:all", "-Werror", "-encoding", "US-ASCII")
"""Options of javac."""
QUICK = ("-XX:TieredStopAtLevel=1", "-XX:+UseSerialGC")
"""Options of a virtual machine that runs for a moment."""
_TRUTHS = (False, True, None)


def emitted(*requirements: FormalizedRequirement) -> Mapping[str, str]:
    """The files of one monitor."""
    assert [TARGET.refuse(requirement) for requirement in requirements] == [None] * len(
        requirements
    )
    files = TARGET.emit(requirements, TargetOptions(one_file=len(requirements) > 1))
    return {str(file.path): file.text for file in files}


def monitor(*requirements: FormalizedRequirement) -> str:
    """The text of the class of one monitor."""
    return next(t for name, t in emitted(*requirements).items() if "Signals" not in name)


def write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def class_of(text: str) -> str:
    (name,) = re.findall(r"^public final class (\w+) \{$", text, re.M)
    return str(name)


def fields(text: str, record: str) -> list[str]:
    """The public fields of a nested class."""
    body = text.partition(f"    public static final class {record} {{")[2].partition("\n    }\n")[0]
    return re.findall(r"^        public (?:final )?\w+ (\w+) =", body, re.M)


def compiled(folder: Path, options: Sequence[str] = STRICT) -> str:
    """What javac says of all files in the folder; empty: it compiles them, without a warning."""
    files = sorted(str(path.relative_to(folder)) for path in folder.rglob("*.java"))
    quick = [f"-J{option}" for option in QUICK]
    command = [installed("javac"), *quick, *options, "-d", "classes", *files]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert (done.returncode == 0) is (not done.stderr), done.stderr
    return done.stderr


def run(folder: Path, main: str, data: bytes = b"", options: Sequence[str] = QUICK) -> bytes:
    """What a compiled class prints."""
    command = [installed("java"), *options, "-cp", "classes", main]
    done = subprocess.run(command, cwd=folder, input=data, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr.decode()[:2000]
    return done.stdout


def outcomes(
    folder: Path,
    monitors: Sequence[str],
    traces: Sequence[tuple[int, Rows]],
    options: Sequence[str] = STRICT,
) -> list[list[list[Outcome]]]:
    """Of each trace all outcomes at each tick.

    Args:
        folder: for what is compiled.
        monitors: texts of classes, which get a package each.
        traces: the place of a monitor, and rows in the order of its inputs.
        options: options of javac.
    """
    files = {
        f"m{place}/{class_of(text)}.java": f"package m{place};\n{text}"
        for place, text in enumerate(monitors)
    }
    write(folder, files | {"Main.java": _main(monitors)})
    assert compiled(folder, options) == ""
    data = b"".join(
        struct.pack(">II", place, len(rows))
        + bytes(_TRUTHS.index(value) for row in rows for value in row)
        for place, rows in traces
    )
    readings = struct.iter_unpack(">i7?i7?BBB", run(folder, "Main", data))
    found = (
        Outcome(Reading(*r[:8]), Reading(*r[8:16]), VERDICTS[r[16]], _TRUTHS[r[17]], _TRUTHS[r[18]])
        for r in readings
    )
    sizes = [len(fields(text, "Outcomes")) for text in monitors]
    told = [[[next(found) for _ in range(sizes[p])] for _ in rows] for p, rows in traces]
    assert next(found, None) is None
    return told


def _main(monitors: Sequence[str]) -> str:
    calls = "".join(
        f"                case {i}: run{i}(ticks); break;\n" for i in range(len(monitors))
    )
    return f"""import java.io.BufferedInputStream;
import java.io.BufferedOutputStream;
import java.io.DataInputStream;
import java.io.DataOutputStream;
import java.io.IOException;

public final class Main {{
    private static final DataInputStream in =
        new DataInputStream(new BufferedInputStream(System.in));
    private static final DataOutputStream out =
        new DataOutputStream(new BufferedOutputStream(System.out));

    private static void put(int left, boolean... truths) throws IOException {{
        out.writeInt(left);
        for (boolean truth : truths) {{
            out.writeBoolean(truth);
        }}
    }}
{"".join(_runner(i, text) for i, text in enumerate(monitors))}
    public static void main(String[] arguments) throws IOException {{
        while (in.available() > 0) {{
            int place = in.readInt();
            int ticks = in.readInt();
            switch (place) {{
{calls}                default: throw new IOException();
            }}
        }}
        out.flush();
    }}
}}
"""


def _runner(place: int, text: str) -> str:
    name = f"m{place}.{class_of(text)}"
    inputs = "".join(
        f"            inputs.{field} = {name}.Truth.values()[in.readByte()];\n"
        for field in fields(text, "Inputs")
    )
    puts = "".join(
        f"            put(outcomes.{field});\n" for field in fields(text, "Outcomes")
    ).replace("put(", f"put{place}(")
    return f"""
    private static void put{place}({name}.Outcome o) throws IOException {{
        for ({name}.Reading r : new {name}.Reading[] {{o.certain, o.possible}}) {{
            put(r.left, r.violated, r.failed, r.trigger, r.violation, r.open, r.satisfied_forever,
                r.answer);
        }}
        out.writeByte(o.verdict.ordinal());
        out.writeByte(o.finite.ordinal());
        out.writeByte(o.obligation_pending.ordinal());
    }}

    private static void run{place}(int ticks) throws IOException {{
        {name} monitor = new {name}();
        {name}.Inputs inputs = new {name}.Inputs();
        {name}.Outcomes outcomes = new {name}.Outcomes();
        for (int tick = 0; tick < ticks; tick++) {{
{inputs}            monitor.step(inputs, outcomes);
{puts}        }}
    }}
"""
