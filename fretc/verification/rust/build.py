"""A monitor in Rust as a shared library, with the layout of its state.

The text is a crate of its own, with its `forbid(unsafe_code)`; a module at its end exports the
offsets of cells. A second crate exports functions for C. Panics abort the process.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence

from fretc.verification.compiled.readings import ApproximationReading
from fretc.verification.compiled.tools import Binary, compiled

FLAGS = tuple(
    "--edition 2021 -C opt-level=2 -C overflow-checks=on -C debug-assertions=on -C panic=abort"
    " -C strip=symbols".split()
)
BASE = "fretc_monitor"
"""Prefix of the function names."""
_CRATE = "fretc_text"


def compiler() -> str | None:
    """Path of rustc, or None."""
    return shutil.which("rustc")


def built(
    program: str, text: str, cells: Sequence[str], inputs: Sequence[str], outcomes: Sequence[str]
) -> Binary:
    """The library of a monitor.

    Args:
        program: path of rustc.
        text: text of `lib.rs`.
        cells: fields of an approximation.
        inputs: fields of the inputs.
        outcomes: fields of the outcomes.

    Raises:
        ToolError: the compiler rejects the text, or cannot be run.
    """
    texts = {
        "text.rs": f"{text}\n{_layout(cells)}",
        "library.rs": _library(len(cells), inputs, outcomes),
    }
    linked = ("--extern", f"{_CRATE}=lib{_CRATE}.rlib")
    steps = (
        ("--crate-type", "rlib", "--crate-name", _CRATE, "text.rs"),
        ("--crate-type", "cdylib", *linked, "library.rs", "-o", "library.so"),
    )
    return compiled(program, FLAGS, texts, steps, "library.so")


def _layout(cells: Sequence[str]) -> str:
    """Rust module that exports the offsets of an approximation's private fields."""
    places = "".join(
        f"        core::mem::offset_of!(Approximation, {cell}), size(|cells| &cells.{cell}),\n"
        for cell in cells
    )
    return f"""
pub mod fretc_layout {{
    use super::{{Monitor, Approximation}};

    const fn size<T>(_: fn(&Approximation) -> &T) -> usize {{
        core::mem::size_of::<T>()
    }}

    pub const PLACES: [usize; {2 * len(cells) + 2}] = [
        core::mem::offset_of!(Monitor, certain), core::mem::offset_of!(Monitor, possible),
{places}    ];
}}
"""


def _library(cells: int, inputs: Sequence[str], outcomes: Sequence[str]) -> str:
    """Rust crate with a C interface: inputs are a byte each, and outcomes as in C."""
    given = ", ".join(f"{name}: TRUTHS[*values.add({i}) as usize]" for i, name in enumerate(inputs))
    told = "".join(f"    told.add({i}).write(of(found.{n}));\n" for i, n in enumerate(outcomes))
    _, *truths = ApproximationReading._fields
    bits = ", ".join(f"reading.{name}.into()" for name in truths)
    return f"""use std::mem::size_of;
use {_CRATE}::{{fretc_layout::PLACES, Inputs, Monitor, Outcome, Reading}};

const TRUTHS: [Option<bool>; 3] = [Some(false), Some(true), None];

#[repr(C)]
pub struct Approximation {{
    left: i32,
    truths: [u8; {len(truths)}],
}}

#[repr(C)]
pub struct Told {{
    certain: Approximation,
    possible: Approximation,
    verdict: u32,
    finite: u8,
    obligation_pending: u8,
}}

fn approximation(reading: Reading) -> Approximation {{
    let left = reading.left.map_or(-1, |left| i32::try_from(left).unwrap_or(i32::MIN));
    Approximation {{ left, truths: [{bits}] }}
}}

fn of(outcome: Outcome) -> Told {{
    Told {{
        certain: approximation(outcome.certain),
        possible: approximation(outcome.possible),
        verdict: outcome.verdict as u32,
        finite: outcome.finite.map_or(2, u8::from),
        obligation_pending: outcome.obligation_pending.map_or(2, u8::from),
    }}
}}

#[no_mangle]
#[allow(non_upper_case_globals)]
pub static fretc_layout: [usize; {2 * cells + 6}] = {{
    let mut layout = [0; {2 * cells + 6}];
    layout[0] = size_of::<Monitor>();
    layout[1] = PLACES[0];
    layout[2] = PLACES[1];
    layout[3] = {max(len(inputs), 1)};
    layout[4] = {len(outcomes)} * size_of::<Told>();
    layout[5] = size_of::<Told>();
    let mut place = 2;
    while place < PLACES.len() {{
        layout[place + 4] = PLACES[place];
        place += 1;
    }}
    layout
}};

#[no_mangle]
pub unsafe extern "C" fn {BASE}_init(state: *mut Monitor) {{
    state.write(Monitor::new());
}}

#[no_mangle]
#[allow(unused_variables)]
pub unsafe extern "C" fn {BASE}_step(state: *mut Monitor, values: *const u8, told: *mut Told) {{
    let found = (*state).step(&Inputs {{ {given} }});
{told}}}
"""
