"""Programs around the functions of samples, one for each language: bytes of messages in, bytes out.

A row of a case is a message of each of its two signals: type, count, the fields `least` and `most`,
the time, and 64 bytes of elements. For it a program writes both numbers (value, size of a whole
one, kind) and the truth of the case's proposition. The programs of ticks read words with numbers; a
word of 255 letters ends a tick.
"""

from __future__ import annotations

import struct
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from compiler.emit import TARGETS
from compiler.formalization.formalized import FormalizedRequirement
from compiler.signals.policies import policy
from compiler.targets.target import TargetOptions
from tests import java_monitors
from tests.c_monitors import CHECKED, STRICT
from tests.effort import FULL
from tests.programs import installed
from tests.rust_monitors import STRICT as STRICT_RUST
from tests.rust_monitors import write
from tests.signal_policies import NOW, Case, Message

TYPES = "float double bool int8 uint8 int16 uint16 int32 uint32 int64 uint64".split()


def packed(message: Message) -> bytes:
    """A message as the programs read it."""
    field = np.atleast_1d(message.field)
    names = {"float32": "float", "float64": "double"}
    kind = TYPES.index(names.get(field.dtype.name, field.dtype.name))
    head = struct.pack("=BBddq", kind, len(field), message.least, message.most, message.at)
    return head + field.tobytes().ljust(64, b"\0")


@dataclass(frozen=True)
class Language:
    """How functions of samples are emitted, called and run."""

    target: str
    cases: Callable[[Sequence[Case]], str]
    """The program that judges rows of cases, one after the other."""
    tick: str
    """The program that judges a tick of words."""
    build: Callable[[Path, str], Sequence[str | Path]]
    """A folder with the emitted files, and the program → what runs it."""

    def __str__(self) -> str:
        """For the name of a test."""
        return self.target

    def runner(
        self, folder: Path, requirements: Sequence[FormalizedRequirement], text: str
    ) -> Callable[[bytes], bytes]:
        """What runs the program over the monitor of all requirements."""
        files = TARGETS[self.target].emit(requirements, TargetOptions(one_file=True))
        write(folder, {str(file.path): file.text for file in files})
        command = self.build(folder, text)

        def run(data: bytes) -> bytes:
            done = subprocess.run(command, input=data, capture_output=True, check=False)
            assert done.returncode == 0, done.stderr.decode()[:2000]
            return done.stdout

        return run


def _calls(case: Case, place: int, call: str) -> list[str]:
    """A call for each signal: its name, the signs of an array, and further arguments are placed."""
    found = []
    for signal in case.signals:
        mine = policy(signal)
        rest = "".join(f", {field}" for field in mine.fields)
        kind = "array" if mine.is_array else "field"
        found.append(call.format(name=f"{signal.name}{place}", kind=kind, rest=rest))
    return found


# C ----------------------------------------------------------------------------------------------

_C = """
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

#define array (&message)
#define field fretc_element(&message, 0u)
"""
_C_SIGNAL = """    if (!given(&message, &least, &most, &at)) {{ return; }}
    samples.{name}.number = monitors_sample_{name}({kind}{rest});
    samples.{name}.at = at;
    put(samples.{name}.number);
    if (at < 0) {{ samples.{name}.number = fretc_no_number(); }}
    (void)least; (void)most;
"""


def _in_c(cases: Sequence[Case]) -> str:
    functions = "".join(
        f"static void case_{i}(monitors_inputs *inputs)\n{{\n"
        "    fretc_array message; double least, most; int64_t at;\n"
        f"{''.join(_calls(case, i, _C_SIGNAL))}"
        f"    monitors_instant(&samples, {NOW}, inputs);\n    putchar((int)inputs->p{i});\n}}\n"
        for i, case in enumerate(cases)
    )
    calls = "".join(
        f"    for (row = 0; row < {len(case.rows)}; row++) {{ case_{i}(&inputs); }}\n"
        for i, case in enumerate(cases)
    )
    return (
        f"{_C}{functions}int main(void)\n{{\n"
        f"    monitors_inputs inputs; int row;\n{calls}    return 0;\n}}\n"
    )


_C_TICK = """
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
        if (length == 255) {
            monitors_assume(&tick);
            putchar(tick.p0); putchar(tick.p1); putchar(tick.p2); putchar(tick.p3);
            held.p3_for_1 = FRETC_UNKNOWN;
            is_first = true;
            continue;
        }
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
    return 0;
}
"""


def c(cc: str = "gcc", *flags: str) -> Language:
    """C by a compiler, by default with all checks while it runs."""

    def build(folder: Path, text: str) -> Sequence[str | Path]:
        (folder / "main.c").write_text(text, encoding="utf-8")
        command = [installed(cc), *STRICT, *(flags or ("-O1" if FULL else "-O0", *CHECKED))]
        _make([*command, "main.c", "monitors_signals.c", "-o", "main"], folder)
        return [folder / "main"]

    return Language("c", _in_c, _C_TICK, build)


def _make(command: Sequence[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:2000]


# Rust -------------------------------------------------------------------------------------------

_RUST = """
use monitors_signals::*;
use std::io::{Read, Write};

pub struct Message {
    array: Vec<Number>,
    field: Number,
    least: f64,
    most: f64,
    at: i64,
}

fn all<T: Into<Number>, const N: usize>(bytes: &[u8], of: fn([u8; N]) -> T) -> Vec<Number> {
    bytes.chunks_exact(N).map(|each| of(each.try_into().unwrap()).into()).collect()
}

fn given(data: &mut &[u8]) -> Message {
    let (mine, rest) = data.split_at(90);
    *data = rest;
    let word = |at: usize| mine[at..at + 8].try_into().unwrap();
    let bytes = &mine[26..];
    let mut array = match mine[0] {
        0 => all(bytes, f32::from_ne_bytes),
        1 => all(bytes, f64::from_ne_bytes),
        2 => all(bytes, |[byte]: [u8; 1]| byte != 0),
        3 => all(bytes, i8::from_ne_bytes),
        4 => all(bytes, u8::from_ne_bytes),
        5 => all(bytes, i16::from_ne_bytes),
        6 => all(bytes, u16::from_ne_bytes),
        7 => all(bytes, i32::from_ne_bytes),
        8 => all(bytes, u32::from_ne_bytes),
        9 => all(bytes, i64::from_ne_bytes),
        _ => all(bytes, u64::from_ne_bytes),
    };
    let field = array[0];
    array.truncate(mine[1].into());
    let (least, most) = (f64::from_ne_bytes(word(2)), f64::from_ne_bytes(word(10)));
    Message { array, field, least, most, at: i64::from_ne_bytes(word(18)) }
}

fn put(number: Option<Number>) {
    let (value, size, kind) = match number {
        None => (0.0, 0, 0),
        Some(Number::Single(value)) => (f64::from(value), 0, 1),
        Some(Number::Double(value)) => (value, 0, 2),
        Some(Number::Whole(value)) => (value as f64, value.unsigned_abs() as u64, 3),
        Some(Number::Wide(_)) => unreachable!("a sample is recorded"),
    };
    let mut out = std::io::stdout();
    out.write_all(&value.to_ne_bytes()).unwrap();
    out.write_all(&size.to_ne_bytes()).unwrap();
    out.write_all(&[kind]).unwrap();
}

fn say(truth: Option<bool>) {
    std::io::stdout().write_all(&[truth.map_or(2, u8::from)]).unwrap();
}

fn read() -> Vec<u8> {
    let mut data = Vec::new();
    std::io::stdin().read_to_end(&mut data).unwrap();
    data
}
"""
_RUST_SIGNAL = """    let Message {{ array, field, least, most, at }} = given(data);
    let _ = (&array, &field, least, most);
    let number = sample_{name}({kind}{rest});
    put(number);
    samples.{name} = Sample {{ number: if at < 0 {{ None }} else {{ number }}, at }};
"""


def _in_rust(cases: Sequence[Case]) -> str:
    functions = "".join(
        f"fn case_{i}(data: &mut &[u8], samples: &mut Samples) {{\n"
        f"{''.join(_calls(case, i, _RUST_SIGNAL)).replace('(array', '(&array')}"
        f"    say(instant(samples, {NOW}).p{i});\n}}\n"
        for i, case in enumerate(cases)
    )
    calls = "".join(
        f"    for _ in 0..{len(case.rows)} {{ case_{i}(&mut data, &mut samples); }}\n"
        for i, case in enumerate(cases)
    )
    return (
        f"{_RUST}{functions}fn main() {{\n    let bytes = read();\n"
        f"    let (mut data, mut samples) = (&bytes[..], Samples::default());\n{calls}}}\n"
    )


_RUST_TICK = f"""{_RUST}
fn main() {{
    let (mut held, mut tick) = (Held::default(), None);
    let mut samples = Samples::default();
    for row in read().chunks_exact(25) {{
        if row[0] == 255 {{
            let mut tick = tick.take().unwrap();
            assume(&mut tick);
            [tick.p0, tick.p1, tick.p2, tick.p3].map(say);
            held = Held::default();
            continue;
        }}
        let text = &row[1..1 + usize::from(row[0])];
        samples.mode.number = sample_mode(text);
        samples.gear.number = sample_gear(f64::from_ne_bytes(row[17..].try_into().unwrap()));
        let now = instant(&samples, 0, &held);
        held = holding(&samples, 0, &held);
        [now.p0, now.p1, now.p2, held.p3_for_1].map(say);
        let now = instant(&samples, 0, &held);
        say(now.p3);
        match &mut tick {{
            None => tick = Some(now),
            Some(tick) => gather(tick, &now),
        }}
    }}
}}
"""


def _build_rust(folder: Path, text: str) -> Sequence[str | Path]:
    rustc, beside = installed("rustc"), list[str]()
    for name in ("monitors", "monitors_signals"):
        kind = ["--crate-type", "rlib", "--crate-name", name, f"{name}/src/lib.rs"]
        _make([rustc, *STRICT_RUST, *beside, *kind], folder)
        beside += ["--extern", f"{name}=lib{name}.rlib", "-L", "."]
    (folder / "main.rs").write_text(text, encoding="utf-8")
    _make([rustc, "--edition", "2021", "-A", "dead_code", *beside, "main.rs"], folder)
    return [folder / "main"]


RUST = Language("rust", _in_rust, _RUST_TICK, _build_rust)

# JavaScript -------------------------------------------------------------------------------------

_JS = """
import { readFileSync, writeSync } from "node:fs";
import * as signals from "./monitors_signals.mjs";

const { sample, float32, instant, assume, gather, holding } = signals;
const data = readFileSync(0);
const view = new DataView(data.buffer, data.byteOffset, data.length);
const TYPES = [
  Float32Array, Float64Array, Uint8Array, Int8Array, Uint8Array, Int16Array, Uint16Array,
  Int32Array, Uint32Array, BigInt64Array, BigUint64Array,
];
const samples = {};
const out = [];
let start = 0;

function given() {
  const [kind, count] = [view.getUint8(start), view.getUint8(start + 1)];
  const bytes = Uint8Array.prototype.slice.call(data, start + 26, start + 90).buffer;
  const floats = [2, 10].map((at) => view.getFloat64(start + at, true));
  const at = view.getBigInt64(start + 18, true);
  let array = new TYPES[kind](bytes, 0, count);
  if (kind === 2) array = Array.from(array, (byte) => byte !== 0);
  const [field] = array;
  start += 90;
  return [array, kind === 0 ? float32(field) : field, ...floats, at];
}

function put(number) {
  const record = new DataView(new ArrayBuffer(17));
  const isSingle = number?.float32 !== undefined;
  record.setFloat64(0, isSingle ? number.float32 : Number(number ?? 0), true);
  if (typeof number === "bigint") record.setBigUint64(8, number < 0n ? -number : number, true);
  record.setUint8(16, number === null ? 0 : isSingle ? 1 : typeof number === "bigint" ? 3 : 2);
  out.push(new Uint8Array(record.buffer));
}

function say(truth) {
  out.push(Uint8Array.of([false, true, null].indexOf(truth)));
}

process.on("exit", () => {
  const bytes = Buffer.concat(out);
  for (let at = 0; at < bytes.length; ) at += writeSync(1, bytes, at);
});
"""
_JS_SIGNAL = """  {{
    const [array, field, least, most, at] = given();
    const number = sample.{name}({kind}{rest});
    put(number);
    samples.{name} = at < 0n ? null : {{ number, at }};
  }}
"""


def _in_javascript(cases: Sequence[Case]) -> str:
    return _JS + "".join(
        f"for (let row = 0; row < {len(case.rows)}; row += 1) {{\n"
        f"{''.join(_calls(case, i, _JS_SIGNAL))}"
        f"  say(instant(samples, {NOW}n).p{i});\n}}\n"
        for i, case in enumerate(cases)
    )


_JS_TICK = f"""{_JS}
let held = {{ p3_for_1: null }};
let tick = null;
for (; start < data.length; start += 25) {{
  if (data[start] === 255) {{
    const {{ p0, p1, p2, p3 }} = assume(tick);
    [p0, p1, p2, p3].forEach(say);
    held = {{ p3_for_1: null }};
    tick = null;
    continue;
  }}
  const text = data.toString("utf8", start + 1, start + 1 + data[start]);
  samples.mode = {{ number: sample.mode(text), at: 0n }};
  samples.gear = {{ number: sample.gear(view.getFloat64(start + 17, true)), at: 0n }};
  const now = instant(samples, 0n, held);
  held = holding(samples, 0n, held);
  [now.p0, now.p1, now.p2, held.p3_for_1].forEach(say);
  const next = instant(samples, 0n, held);
  say(next.p3);
  tick = tick === null ? next : gather(tick, next);
}}
"""


def _build_javascript(folder: Path, text: str) -> Sequence[str | Path]:
    (folder / "main.mjs").write_text(text, encoding="utf-8")
    return [installed("node"), folder / "main.mjs"]


JAVASCRIPT = Language("js", _in_javascript, _JS_TICK, _build_javascript)

# Java -------------------------------------------------------------------------------------------

_JAVA = """
import java.io.BufferedOutputStream;
import java.io.DataOutputStream;
import java.io.IOException;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.charset.StandardCharsets;

public final class Main {
    private static final MonitorsSignals.Samples samples = new MonitorsSignals.Samples();
    private static final Monitors.Inputs inputs = new Monitors.Inputs();
    private static final DataOutputStream out =
        new DataOutputStream(new BufferedOutputStream(System.out));
    private static ByteBuffer data;
    private static MonitorsSignals.Elements array;
    private static MonitorsSignals.Number field;
    private static double least;
    private static double most;
    private static long at;

    private static void given() {
        int start = data.position();
        int kind = data.get();
        int count = data.get();
        least = data.getDouble();
        most = data.getDouble();
        at = data.getLong();
        array = elements(kind, count, data.slice().order(ByteOrder.nativeOrder()));
        field = elements(kind, 1, data.slice().order(ByteOrder.nativeOrder())).element(0);
        data.position(start + 90);
    }

    private static MonitorsSignals.Elements elements(int kind, int count, ByteBuffer from) {
        float[] floats = new float[count];
        double[] doubles = new double[count];
        boolean[] truths = new boolean[count];
        byte[] bytes = new byte[count];
        short[] shorts = new short[count];
        int[] ints = new int[count];
        long[] longs = new long[count];
        for (int i = 0; i < count; i++) {
            switch (kind) {
                case 0: floats[i] = from.getFloat(); break;
                case 1: doubles[i] = from.getDouble(); break;
                case 2: truths[i] = from.get() != 0; break;
                case 3: case 4: bytes[i] = from.get(); break;
                case 5: case 6: shorts[i] = from.getShort(); break;
                case 7: case 8: ints[i] = from.getInt(); break;
                default: longs[i] = from.getLong();
            }
        }
        switch (kind) {
            case 0: return MonitorsSignals.elements(floats);
            case 1: return MonitorsSignals.elements(doubles);
            case 2: return MonitorsSignals.elements(truths);
            case 3: return MonitorsSignals.elements(bytes);
            case 4: return MonitorsSignals.unsignedElements(bytes);
            case 5: return MonitorsSignals.elements(shorts);
            case 6: return MonitorsSignals.unsignedElements(shorts);
            case 7: return MonitorsSignals.elements(ints);
            case 8: return MonitorsSignals.unsignedElements(ints);
            case 9: return MonitorsSignals.elements(longs);
            default: return MonitorsSignals.unsignedElements(longs);
        }
    }

    private static void put(MonitorsSignals.Number number) throws IOException {
        ByteBuffer record = ByteBuffer.allocate(17).order(ByteOrder.nativeOrder());
        if (number != null) {
            boolean isWhole = number.magnitude() != 0L;
            record.putDouble(number.value()).putLong(number.magnitude());
            record.put((byte) (number.isSingle() ? 1 : isWhole ? 3 : 2));
        }
        out.write(record.array());
    }

    private static void say(Monitors.Truth truth) throws IOException {
        out.writeByte(truth.ordinal());
    }

    public static void main(String[] arguments) throws IOException {
        data = ByteBuffer.wrap(System.in.readAllBytes()).order(ByteOrder.nativeOrder());
        run();
        out.flush();
    }
"""
_JAVA_SIGNAL = """        given();
        samples.{name}.number = MonitorsSignals.sample_{name}({kind}{rest});
        samples.{name}.at = at;
        put(samples.{name}.number);
        samples.{name}.number = at < 0 ? null : samples.{name}.number;
"""


def _in_java(cases: Sequence[Case]) -> str:
    functions = "".join(
        f"    private static void case{i}() throws IOException {{\n"
        f"{''.join(_calls(case, i, _JAVA_SIGNAL))}"
        f"        MonitorsSignals.instant(samples, {NOW}L, inputs);\n"
        f"        say(inputs.p{i});\n    }}\n"
        for i, case in enumerate(cases)
    )
    calls = "".join(
        f"        for (int i = 0; i < {len(case.rows)}; i++) {{ case{i}(); }}\n"
        for i, case in enumerate(cases)
    )
    head = "    private static void run() throws IOException {\n"
    return f"{_JAVA}{functions}{head}{calls}    }}\n}}\n"


_JAVA_TICK = f"""{_JAVA}
    private static void run() throws IOException {{
        MonitorsSignals.Held held = new MonitorsSignals.Held();
        MonitorsSignals.Held holding = new MonitorsSignals.Held();
        Monitors.Inputs tick = new Monitors.Inputs();
        boolean isFirst = true;
        while (data.hasRemaining()) {{
            int length = data.get() & 0xff;
            byte[] text = new byte[16];
            data.get(text);
            double number = data.getDouble();
            if (length == 255) {{
                MonitorsSignals.assume(tick);
                say(tick.p0);
                say(tick.p1);
                say(tick.p2);
                say(tick.p3);
                held.p3_for_1 = Monitors.Truth.UNKNOWN;
                isFirst = true;
                continue;
            }}
            String word = new String(text, 0, length, StandardCharsets.UTF_8);
            samples.mode.number = MonitorsSignals.sample_mode(word);
            samples.gear.number = MonitorsSignals.sample_gear(number);
            MonitorsSignals.instant(samples, 0L, held, inputs);
            MonitorsSignals.holding(samples, 0L, held, holding);
            say(inputs.p0);
            say(inputs.p1);
            say(inputs.p2);
            say(holding.p3_for_1);
            held.p3_for_1 = holding.p3_for_1;
            MonitorsSignals.instant(samples, 0L, held, inputs);
            say(inputs.p3);
            Monitors.Inputs next = new Monitors.Inputs();
            MonitorsSignals.instant(samples, 0L, held, next);
            if (isFirst) {{
                tick = next;
            }} else {{
                MonitorsSignals.gather(tick, next);
            }}
            isFirst = false;
        }}
    }}
}}
"""


def _build_java(folder: Path, text: str) -> Sequence[str | Path]:
    (folder / "Main.java").write_text(text, encoding="utf-8")
    assert java_monitors.compiled(folder) == ""
    return [installed("java"), *java_monitors.QUICK, "-cp", folder / "classes", "Main"]


JAVA = Language("java", _in_java, _JAVA_TICK, _build_java)
LANGUAGES = (c(), RUST, JAVASCRIPT, JAVA)
