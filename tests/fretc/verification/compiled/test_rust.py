"""Monitors in Rust: what faults come to, and which texts are not compiled."""

from dataclasses import replace
from pathlib import Path

import pytest

from fretc.verification.compiled.text import StrangeTextError
from fretc.verification.compiled.tools import ToolError
from fretc.verification.rust import language as rust
from tests.compiled_monitors import (
    FOR,
    REFUSED,
    REFUTED,
    SAME,
    WITHIN,
    Checker,
    edited,
    given_rust,
)
from tests.each import each
from tests.monitoring import rule

needs_rustc = pytest.mark.skipif(rust.tool() is None, reason="rustc is not installed")

FAULTS = (
    (WITHIN, "self.oldest_1 >= 3;", "self.oldest_1 >= 2;", REFUTED),
    (WITHIN, "self.oldest_1 >= 3;", "self.oldest_1 > 2;", SAME),
    (WITHIN, "open: since_2,", "open: since_1,", REFUTED),
    (WITHIN, "trigger: now.is_m & now.is_p,", "trigger: now.is_p,", REFUTED),
    (WITHIN, "oldest_1: -1,", "oldest_1: 0,", REFUTED),
    (WITHIN, "u32::try_from(3 -", "u32::try_from(4 -", REFUTED),
    (WITHIN, "left: if since_2", "left: if since_1", REFUTED),
    (FOR, "settled: false,", "settled: since_1,", REFUTED),
    (WITHIN, "is_q: inputs.q != Some(false),", "is_q: inputs.q == Some(true),", REFUSED),
    (WITHIN, "Verdict::Pending\n", "Verdict::Satisfied\n", REFUSED),
)


@needs_rustc
@pytest.mark.slow
@each("fault", FAULTS)
def test_a_fault_comes_to_what_is_written_beside_it(
    fault: tuple[str, str, str, str], tmp_path: Path
) -> None:
    sentence, old, new, expected = fault
    one = rule(sentence)
    assert Checker(rust, tmp_path).kind(edited(given_rust(one), old, new), one) == expected


BEGIN = "-> [Reading; 1] {\n"
SINCE = "let since_1 = self.oldest_1 >= 3;"


@each(
    "edit",
    [
        (BEGIN, f"{BEGIN} std::process::abort();"),
        (BEGIN, f"{BEGIN} loop {{}}"),
        (BEGIN, f"{BEGIN} while true {{}}"),
        (BEGIN, f"{BEGIN} unsafe {{}}"),
        (BEGIN, f"{BEGIN} return [];"),
        (BEGIN, f"{BEGIN} let mut n = true;"),
        (BEGIN, f"{BEGIN} let n: bool = true;"),
        (BEGIN, f"{BEGIN} static N: u8 = 0;"),
        (BEGIN, f"{BEGIN} *self = Rail::new();"),
        (BEGIN, f"{BEGIN} self.oldest_1 += 1;"),
        (BEGIN, f"{BEGIN} #[allow(warnings)]"),
        (BEGIN, f"{BEGIN} /* a /* comment */ in */ another */"),
        (BEGIN, f"{BEGIN} // a line \r that ends\n"),
        (BEGIN, f"{BEGIN} let n = include!();"),
        (BEGIN, f'{BEGIN} let n = include_str!("/etc/passwd") == "";'),
        (BEGIN, f"{BEGIN} let \u00e9 = true;"),
        (BEGIN, f"{BEGIN} let n = 'a' == 'b';"),
        (BEGIN, f"{BEGIN} }}"),
        (BEGIN, f"{BEGIN} if true {{"),
        (SINCE, "let cfg = true; let since_1 = cfg!(true);"),
        (SINCE, "let since_1 = since_2;"),
        (SINCE, "let since_1 = { self.oldest_1 = 3; true };"),
        (SINCE, "let since_1 = self.advance(now);"),
        (SINCE, "let since_1 = now.is_m as u8 > 0;"),
        (SINCE, "let since_1 = self.oldest_1 / 0 > 1;"),
        (SINCE, "let since_1 = u32::try_from(3).ok();"),
        ("#![forbid(unsafe_code)]", ""),
        ("#![forbid(unsafe_code)]", "#![allow(unsafe_code)]"),
        ("            oldest_1: -1,", "            oldest_1: { abort() },"),
        ("            oldest_1: -1,", "            oldest_1: i32::MAX,"),
        ("            oldest_1: -1,", ""),
        ("answer: now.is_m & now.is_q,", "answer: now.is_m & now.is_q, ..panic()"),
        ("Reading {\n                left", "Reading {\n                breach: false, left"),
        ("is_m: bool,", "is_m: u8,"),
    ],
)
def test_what_may_do_more_is_not_compiled(edit: tuple[str, str]) -> None:
    one = rule(WITHIN)
    with pytest.raises(StrangeTextError):
        rust.checked(edited(given_rust(one), *edit), [one])


def test_a_ring_is_as_fretc_writes_it() -> None:
    one = rule("whenever p the sw shall immediately satisfy occurred(33, 35, q)")
    monitor = given_rust(one)
    rust.checked(monitor, [one])
    for old, new in (
        ("|= 1 <<", "|= 2 <<"),
        ("ring_since_1_at == 32 {", "ring_since_1_at == 99 {"),
        ("ring_since_1: [0; 2],", "ring_since_1: [1; 2],"),
        ("settled: false,", "settled: self.ring_since_1_at > 0,"),
        (
            "        if past_since_1 {",
            "        self.ring_since_1_at = 99;\n        if past_since_1 {",
        ),
    ):
        with pytest.raises(StrangeTextError):
            rust.checked(edited(monitor, old, new), [one])


@needs_rustc
def test_what_rustc_does_not_take_is_refused(tmp_path: Path) -> None:
    one = rule(WITHIN)
    with pytest.raises(ToolError, match=r"^rustc .* does not compile it: error"):
        Checker(rust, tmp_path).prepared(edited(given_rust(one), SINCE, "let since_1 = 3 3;"), one)


def test_what_a_requirement_does_not_speak_of_has_no_part_in_it() -> None:
    one, other = rule(WITHIN), rule("whenever r the sw shall immediately satisfy s", "R2")
    monitor = given_rust(one, other)
    for each_ in (one, other):
        rust.checked(monitor, [one, other]).plan(each_)
    wrong = replace(monitor, text=monitor.text.replace(SINCE, "let since_1 = now.is_r;"))
    checked = rust.checked(wrong, [one, other])
    checked.plan(other)
    with pytest.raises(StrangeTextError, match="R1 depends on what its sentence does not speak of"):
        checked.plan(one)
