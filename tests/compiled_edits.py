# ruff: noqa: E501
"""Changes of a monitor's text in each language, and what comes of them.

No two languages have the same text, so each has changes of its own; what must come of them is one law.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from tests.compiled_monitors import FOR, REFUSED, REFUTED, SAME, WITHIN

Edit = tuple[str, str]


@dataclass(frozen=True)
class Edits:
    """Of one language."""

    faults: Sequence[tuple[str, str, str, str]]
    """A sentence, an edit of its monitor, and what comes of it."""
    further: Sequence[Edit]
    """Of the monitor of `WITHIN`: what may do more than a step does, and is not run."""
    keeping: str
    """A sentence whose monitor keeps a number of ticks."""
    kept: Sequence[Edit]
    """Of its statements that fretc alone writes, and of readings of what they keep."""
    uncompiled: str
    """In the place of a local truth value: the form is right, and the language has no such text."""
    foreign: str
    """The same: a truth value of another requirement."""
    since: str
    """That local truth value."""


_C_BEGIN = "    fretc_reading *reading;\n"
_C_SINCE = "const bool since_1 = approximation->oldest_1 >= 3;"
C = Edits(
    (
        (WITHIN, "approximation->oldest_1 >= 3", "approximation->oldest_1 >= 2", REFUTED),
        (WITHIN, "approximation->oldest_1 >= 3", "approximation->oldest_1 > 2", SAME),
        (
            WITHIN,
            "reading->trigger = now->is_m & now->is_p;",
            "reading->trigger = now->is_p;",
            REFUTED,
        ),
        (WITHIN, "reading->open = since_2;", "reading->open = since_1;", REFUTED),
        (WITHIN, "reading->answer = now->is_m & now->is_q;", "", REFUTED),
        (
            WITHIN,
            "    approximation->oldest_1 = -1;\n    approximation->r1_broken",
            "    approximation->oldest_1 = 0;\n    approximation->r1_broken",
            REFUTED,
        ),
        (
            WITHIN,
            "reading->answer = now->is_m & now->is_q;",
            "reading->answer = now->is_q;",
            REFUTED,
        ),
        (WITHIN, "(3 - approximation->oldest_1)", "(4 - approximation->oldest_1)", REFUTED),
        (
            WITHIN,
            "reading->left = (since_2 & (approximation",
            "reading->left = (since_1 & (approximation",
            REFUTED,
        ),
        (
            FOR,
            "reading->satisfied_forever = false;",
            "reading->satisfied_forever = since_1;",
            REFUTED,
        ),
        (WITHIN, "reading->open = since_2;", "reading->open = &since_2 > &since_1;", REFUSED),
        (
            WITHIN,
            "reading->open = since_2;",
            "reading->open = since_1 | & approximation->oldest_1;",
            REFUSED,
        ),
        (
            WITHIN,
            "now.is_q = inputs->q != FRETC_FALSE;",
            "now.is_q = inputs->q == FRETC_TRUE;",
            REFUSED,
        ),
        (
            WITHIN,
            "outcome->verdict = FRETC_PENDING;",
            "outcome->verdict = FRETC_SATISFIED;",
            REFUSED,
        ),
    ),
    [
        (_C_BEGIN, f'{_C_BEGIN}    system("true");\n'),
        (_C_BEGIN, f"{_C_BEGIN}    static int n;\n"),
        (_C_BEGIN, f"{_C_BEGIN}    r1_init(0);\n"),
        (_C_BEGIN, f"{_C_BEGIN}    for (;;) {{ }}\n"),
        (_C_BEGIN, f"{_C_BEGIN}    while (true) {{ }}\n"),
        (_C_BEGIN, f"{_C_BEGIN}    approximation = approximation + 1;\n"),
        (_C_BEGIN, f"{_C_BEGIN}    approximation[1].oldest_1 = 0;\n"),
        (_C_BEGIN, f"{_C_BEGIN}    *approximation = *approximation;\n"),
        (_C_BEGIN, f"{_C_BEGIN}    goto end; end:\n"),
        (_C_BEGIN, f"{_C_BEGIN}    return;\n"),
        (_C_BEGIN, f"{_C_BEGIN}    /* \\\n"),
        (_C_BEGIN, f"{_C_BEGIN}    // \n"),
        (_C_BEGIN, f"{_C_BEGIN}#include <stdlib.h>\n"),
        (_C_BEGIN, f"{_C_BEGIN}    const bool n = approximation->oldest_1 <: 1 :> ;\n"),
        (_C_BEGIN, f"{_C_BEGIN}    const bool \u00e9 = true;\n"),
        (_C_SINCE, "const bool since_1 = possible;"),
        (_C_SINCE, "const bool since_1 = since_2;"),
        (_C_SINCE, "const bool since_1 = (approximation->oldest_1 = 3);"),
        (_C_SINCE, "const bool since_1 = (approximation->oldest_1++ >= 3);"),
        (_C_SINCE, "const bool since_1 = --approximation->oldest_1 >= 2;"),
        (_C_SINCE, "const bool since_1 = approximation->oldest_1-- >= 3;"),
        (_C_SINCE, "const bool since_1 = (approximation->oldest_1 >>= 1) >= 3;"),
        (_C_SINCE, "const bool since_1 = (approximation->oldest_1 -= 1) >= 2;"),
        (_C_SINCE, "const bool since_1 = approximation->oldest_1 >= 3 ??! false;"),
        (
            _C_SINCE,
            f"{_C_SINCE} if (since_1) {{ const bool since_1 = since_1; approximation->r1_broken = since_1; }}",
        ),
        (_C_SINCE, "const bool since_1 = (abort(), true);"),
        (_C_SINCE, "const bool since_1 = sizeof(approximation) > 4;"),
        (_C_SINCE, "const bool since_1 = approximation > now;"),
        (_C_SINCE, "bool since_1 = approximation->oldest_1 >= 3;"),
        (_C_SINCE, "const bool since_1 = approximation->oldest_1 >= 3"),
        (
            "    approximation->oldest_1 = -1;\n    approximation->r1_broken",
            "    approximation->r1_broken",
        ),
        ("    approximation->r1_broken = false;\n", ""),
        ("r1_clear(&state->possible);", ""),
        ("r1_judge(&outcomes->r1);", ""),
        ("bool is_m;", "int is_m;"),
        (
            "approximation->oldest_1 = -1;\n    approximation->r1_broken",
            "approximation->oldest_1 = approximation->r1_broken;\n    approximation->r1_broken",
        ),
    ],
    "whenever p the sw shall immediately satisfy occurred(33, 35, q)",
    (
        ("/ 32u]", "/ 31u]"),
        ("[word] = 0u", "[word] = 1u"),
        ("word < 2u", "word < 3u"),
        (
            "reading->satisfied_forever = false;",
            "reading->satisfied_forever = approximation->ring_since_1 > 0;",
        ),
        (
            "reading->satisfied_forever = false;",
            "reading->satisfied_forever = approximation->ring_since_1_at > 0;",
        ),
        (
            "    if (past_since_1) {",
            "    approximation->ring_since_1_at = 99u;\n    if (past_since_1) {",
        ),
    ),
    "const bool since_1 = 3 3;",
    "const bool since_1 = now->is_r;",
    _C_SINCE,
)
_RUST_BEGIN = "-> [Reading; 1] {\n"
_RUST_SINCE = "let since_1 = self.oldest_1 >= 3;"
RUST = Edits(
    (
        (WITHIN, "self.oldest_1 >= 3;", "self.oldest_1 >= 2;", REFUTED),
        (WITHIN, "self.oldest_1 >= 3;", "self.oldest_1 > 2;", SAME),
        (WITHIN, "open: since_2,", "open: since_1,", REFUTED),
        (WITHIN, "trigger: now.is_m & now.is_p,", "trigger: now.is_p,", REFUTED),
        (WITHIN, "oldest_1: -1,", "oldest_1: 0,", REFUTED),
        (WITHIN, "u32::try_from(3 -", "u32::try_from(4 -", REFUTED),
        (WITHIN, "left: if since_2", "left: if since_1", REFUTED),
        (FOR, "satisfied_forever: false,", "satisfied_forever: since_1,", REFUTED),
        (WITHIN, "is_q: inputs.q != Some(false),", "is_q: inputs.q == Some(true),", REFUSED),
        (WITHIN, "Verdict::Pending\n", "Verdict::Satisfied\n", REFUSED),
    ),
    [
        (_RUST_BEGIN, f"{_RUST_BEGIN} std::process::abort();"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} loop {{}}"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} while true {{}}"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} unsafe {{}}"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} return [];"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} let mut n = true;"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} let n: bool = true;"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} static N: u8 = 0;"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} *self = Approximation::new();"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} self.oldest_1 += 1;"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} #[allow(warnings)]"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} /* a /* comment */ in */ another */"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} // a line \r that ends\n"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} let n = include!();"),
        (_RUST_BEGIN, f'{_RUST_BEGIN} let n = include_str!("/etc/passwd") == "";'),
        (_RUST_BEGIN, f"{_RUST_BEGIN} let \u00e9 = true;"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} let n = 'a' == 'b';"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} }}"),
        (_RUST_BEGIN, f"{_RUST_BEGIN} if true {{"),
        (_RUST_SINCE, "let cfg = true; let since_1 = cfg!(true);"),
        (_RUST_SINCE, "let since_1 = since_2;"),
        (_RUST_SINCE, "let since_1 = { self.oldest_1 = 3; true };"),
        (_RUST_SINCE, "let since_1 = self.advance(now);"),
        (_RUST_SINCE, "let since_1 = now.is_m as u8 > 0;"),
        (_RUST_SINCE, "let since_1 = self.oldest_1 / 0 > 1;"),
        (_RUST_SINCE, "let since_1 = u32::try_from(3).ok();"),
        ("#![forbid(unsafe_code)]", ""),
        ("#![forbid(unsafe_code)]", "#![allow(unsafe_code)]"),
        ("            oldest_1: -1,", "            oldest_1: { abort() },"),
        ("            oldest_1: -1,", "            oldest_1: i32::MAX,"),
        ("            oldest_1: -1,", ""),
        ("answer: now.is_m & now.is_q,", "answer: now.is_m & now.is_q, ..panic()"),
        ("Reading {\n                left", "Reading {\n                violation: false, left"),
        ("is_m: bool,", "is_m: u8,"),
    ],
    "whenever p the sw shall immediately satisfy occurred(33, 35, q)",
    (
        ("|= 1 <<", "|= 2 <<"),
        ("ring_since_1_at == 32 {", "ring_since_1_at == 99 {"),
        ("ring_since_1: [0; 2],", "ring_since_1: [1; 2],"),
        ("satisfied_forever: false,", "satisfied_forever: self.ring_since_1_at > 0,"),
        (
            "        if past_since_1 {",
            "        self.ring_since_1_at = 99;\n        if past_since_1 {",
        ),
    ),
    "let since_1 = 3 3;",
    "let since_1 = now.is_r;",
    _RUST_SINCE,
)
_JAVASCRIPT_BEGIN = "function advance(approximation, tick, truths) {\n"
_JAVASCRIPT_SINCE = "const since_1 = approximation.oldest_1 >= 3;"
JAVASCRIPT = Edits(
    (
        (WITHIN, "approximation.oldest_1 >= 3;", "approximation.oldest_1 >= 2;", REFUTED),
        (WITHIN, "approximation.oldest_1 >= 3;", "approximation.oldest_1 > 2;", SAME),
        (WITHIN, "obligationPending: since_2,", "obligationPending: since_1,", REFUTED),
        (WITHIN, "trigger: is_m && is_p,", "trigger: is_p,", REFUTED),
        (WITHIN, "answer: is_m && is_q,", "answer: 1,", REFUTED),
        (WITHIN, "oldest_1: -1,", "oldest_1: 0,", REFUTED),
        (
            WITHIN,
            "approximation.oldest_1 + 1 : 3;",
            "approximation.oldest_1 + 1 + true : 3;",
            REFUTED,
        ),
        (WITHIN, "approximation.oldest_1 = 0;", "approximation.oldest_1 = -0;", SAME),
        (FOR, "satisfiedForever: false,", "satisfiedForever: since_1,", REFUTED),
        (WITHIN, "const since_1 = ", "const since_1 = (true)(false) && ", REFUSED),
        (WITHIN, 'verdict: violated ? "violated"', 'verdict: violated ? "satisfied"', REFUSED),
        (WITHIN, "if (now.trigger) marks.last = tick;", "", REFUSED),
    ),
    [
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} process.exit();"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} while (true) approximation.oldest_1 = 1;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} for (;;) approximation.oldest_1 = 1;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} return;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} let n = true;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} var n = true;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} if (true) const n = true;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} else approximation.oldest_1 = 1;"),
        (
            _JAVASCRIPT_BEGIN,
            f"{_JAVASCRIPT_BEGIN} if (true) if (false) approximation.oldest_1 = 1;",
        ),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} approximation.isPossible = true;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} approximation.marks = true;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} approximation.more = true;"),
        (_JAVASCRIPT_BEGIN, f'{_JAVASCRIPT_BEGIN} approximation["oldest_1"] = 1;'),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} approximation.oldest_1 += 1;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} approximation.oldest_1 ++;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} const mark = true;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} // a comment \u2028 process.exit();\n"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} // a comment \r process.exit();\n"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} <!-- a comment\n"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} /r/;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} `${{process.exit()}}`;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} const n = approximation.constructor;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} const \\u006e = true;"),
        (_JAVASCRIPT_BEGIN, f"{_JAVASCRIPT_BEGIN} const n = true\n const m = true;"),
        (_JAVASCRIPT_SINCE, "const since_1 = since_2;"),
        (_JAVASCRIPT_SINCE, "const since_1 = tick > 3;"),
        (_JAVASCRIPT_SINCE, "const since_1 = approximation.isPossible;"),
        (_JAVASCRIPT_SINCE, "const since_1 = approximation.tick > 3;"),
        (_JAVASCRIPT_SINCE, "const since_1 = truths[0];"),
        (_JAVASCRIPT_SINCE, "const since_1 = is_m(3);"),
        (_JAVASCRIPT_SINCE, "const since_1 = approximation.oldest_1 >= 3n;".replace("3n", '"3"')),
        (_JAVASCRIPT_SINCE, "const since_1 = (approximation.oldest_1 = 3);"),
        (_JAVASCRIPT_SINCE, "const since_1 = approximation?.oldest_1;"),
        (_JAVASCRIPT_SINCE, "const since_1 = approximation.oldest_1 >= 03;"),
        (_JAVASCRIPT_SINCE, "const since_1 = typeof approximation;"),
        (_JAVASCRIPT_SINCE, "const since_1 = [true];"),
        (
            "truths[0] === null ? approximation.isPossible",
            "truths[1] === null ? approximation.isPossible",
        ),
        ("oldest_1: -1,", "oldest_1: process.exit(),"),
        ("oldest_1: -1,", "get oldest_1() { return 0; },"),
        ("oldest_1: -1,", "oldest_1: -1, more: 0,"),
        ("mark(approximation.marks[0], tick,", "mark(approximation.marks[0], tick + 1,"),
        (
            "mark(approximation.marks[0]",
            "approximation.oldest_1 = 0;\n  mark(approximation.marks[0]",
        ),
        ("return certain === possible", "return\n certain === possible"),
        ("return certain === possible", "return // a comment\n certain === possible"),
        ("return certain === possible", "return /* a\ncomment */ certain === possible"),
        ("return { broken: -1", "return\n{ broken: -1"),
        ("export {", "export default process.exit(); export {"),
    ],
    "only in p mode the sw shall after 2 ticks satisfy q",
    (
        ("tick, 2, 2, not_q && not_p", "tick, 2, 3, not_q && not_p"),
        ("tick, 2, 2, not_q && not_p", "tick, 2, 2, not_q"),
        ("{ intervals: [], first: 0 }", "{ intervals: [], first: 1 }"),
        ("satisfiedForever: false,", "satisfiedForever: approximation.kept_since_1,"),
        ("  const since_1 = slide(", "  approximation.kept_since_1 = 0;\n  const since_1 = slide("),
    ),
    "const since_1 = 3 3;",
    "const since_1 = is_r;",
    _JAVASCRIPT_SINCE,
)
_JAVA_BEGIN = "private void advance1(Literals now) {\n"
_JAVA_SINCE = "this.since_1 = this.oldest_1 >= 3;"
_JAVA_BROKEN = "this.r1_broken = this.r1_broken | this.since_1;"
JAVA = Edits(
    (
        (WITHIN, "this.oldest_1 >= 3;", "this.oldest_1 >= 2;", REFUTED),
        (WITHIN, "this.oldest_1 >= 3;", "this.oldest_1 > 2;", SAME),
        (WITHIN, "reading.open = this.since_2;", "reading.open = this.since_1;", REFUTED),
        (WITHIN, "reading.trigger = now.is_m & now.is_p;", "reading.trigger = now.is_p;", REFUTED),
        (WITHIN, "int oldest_1 = -1;", "int oldest_1 = 0;", REFUTED),
        (WITHIN, "? (3 - this.oldest_1)", "? (4 - this.oldest_1)", REFUTED),
        (WITHIN, "reading.left = (this.since_2", "reading.left = (this.since_1", REFUTED),
        (WITHIN, _JAVA_BROKEN, f"if (now.is_p) {{ {_JAVA_BROKEN} }}", REFUTED),
        (WITHIN, "// Runtime monitor", "package org.example;\n// Runtime monitor", SAME),
        (
            FOR,
            "reading.satisfied_forever = false;",
            "reading.satisfied_forever = this.since_1;",
            REFUTED,
        ),
        (WITHIN, "is_q = inputs.q != Truth.FALSE;", "is_q = inputs.q == Truth.TRUE;", REFUSED),
        (WITHIN, "verdict = Verdict.PENDING;\n            }", "}", REFUSED),
    ),
    [
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} System.exit(0);"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} for (;;) {{}}"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} while (true) {{}}"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} do {{}} while (true);"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} return;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} ;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} {{}}"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} boolean n = true;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} var n = true;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} final boolean n = true;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} class More {{}}"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} throw null;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} synchronized (this) {{}}"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} assert true;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} more: {{}}"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} this.advance1(now);"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} this.oldest_1 += 1;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} this.oldest_1++;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} oldest_1 = 1;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} now = null;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} now.is_m = true;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} @SuppressWarnings"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} // a line \r that ends\n"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} // a line \\u000a that ends\n"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} /* a comment \\uu002a/ that ends */"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} this.\\u006fldest_1 = 1;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} this.\u00e9 = true;"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} }}"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} if (true) {{"),
        (_JAVA_BEGIN, f"{_JAVA_BEGIN} if (true) this.oldest_1 = 0;"),
        (_JAVA_SINCE, ""),
        (_JAVA_SINCE, f"if (now.is_p) {{ {_JAVA_SINCE} }}"),
        (_JAVA_SINCE, "this.since_1 = this.since_2;"),
        (_JAVA_SINCE, "this.since_1 = this.since_1 & now.is_p;"),
        (_JAVA_SINCE, "this.since_1 = (this.oldest_1 = 3) > 1;"),
        (_JAVA_SINCE, "this.since_1 = this.oldest_1-- >= 3;"),
        (_JAVA_SINCE, "this.since_1 = this == now;"),
        (_JAVA_SINCE, "this.since_1 = this.hashCode() > 3;"),
        (_JAVA_SINCE, "this.since_1 = now.hashCode > 3;"),
        (_JAVA_SINCE, "this.since_1 = (int) this.oldest_1 >= 3;"),
        (_JAVA_SINCE, "this.since_1 = this instanceof Object;"),
        (_JAVA_SINCE, "this.since_1 = new int[4] == null;"),
        (_JAVA_SINCE, "this.since_1 = this.oldest_1 / 0 > 1;"),
        (_JAVA_SINCE, "this.since_1 = this.oldest_1 >= 03;"),
        (_JAVA_SINCE, "this.since_1 = this.oldest_1 >= 3L;"),
        (_JAVA_SINCE, "this.since_1 = this.oldest_1 >= '3';"),
        (_JAVA_SINCE, 'this.since_1 = "a" == "b";'),
        (_JAVA_SINCE, "this.since_1 = Truth.TRUE == Truth.TRUE;"),
        ("private boolean since_1;", "private boolean since_1 = true;"),
        ("private boolean since_1;", "private static boolean since_1;"),
        ("private boolean since_1;", "private volatile boolean since_1;"),
        ("private boolean since_1;", ""),
        ("private boolean since_1;", "private boolean since_1; { System.exit(0); }"),
        ("private boolean since_1;", "private boolean since_1; private boolean more;"),
        ("private int oldest_1 = -1;", "private static int oldest_1 = -1;"),
        ("private int oldest_1 = -1;", "private int oldest_1 = new Object().hashCode();"),
        ("private int oldest_1 = -1;", "private long oldest_1 = -1;"),
        ("private int oldest_1 = -1;", "private int oldest_1;"),
        ("reading.answer = now.is_m & now.is_q;", ""),
        (
            "reading.answer = now.is_m & now.is_q;",
            "if (now.is_p) { reading.answer = now.is_m & now.is_q; }",
        ),
        ("reading.answer = now.is_m & now.is_q;", "reading.answer = isPossible;"),
        ("reading.answer = now.is_m & now.is_q;", "reading.answer = reading.open;"),
        ("reading.answer = now.is_m & now.is_q;", "reading.open = now.is_m & now.is_q;"),
        ("isPossible ? outcomes.r1.possible", "isPossible ? outcomes.r1.certain"),
        ("        possible.advance1(now);\n", ""),
        ("private boolean is_m;", "private byte is_m;"),
        ("public final class", "import java.util.Date;\npublic final class"),
        ("// Runtime monitor", "package a b;\n// Runtime monitor"),
        ("// Runtime monitor", "package a.;\n// Runtime monitor"),
    ],
    "whenever p the sw shall immediately satisfy occurred(33, 35, q)",
    (
        ("|= 1 <<", "|= 2 <<"),
        ("ring_since_1_at == 32)", "ring_since_1_at == 99)"),
        ("new int[2]", "new int[3]"),
        (
            "reading.satisfied_forever = false;",
            "reading.satisfied_forever = this.ring_since_1_at > 0;",
        ),
        (
            "            if (this.past_since_1) {",
            "            this.ring_since_1_at = 99;\n            if (this.past_since_1) {",
        ),
        (
            "            this.past_since_1 = (this.ring_since_1[this.ring_since_1_at / 32] & "
            "(1 << (this.ring_since_1_at % 32))) != 0;",
            "            if (now.is_p) { this.past_since_1 = (this.ring_since_1["
            "this.ring_since_1_at / 32] & (1 << (this.ring_since_1_at % 32))) != 0; }",
        ),
    ),
    "this.since_1 = 3 3;",
    "this.since_1 = now.is_r;",
    _JAVA_SINCE,
)
EDITS = {"c": C, "rust": RUST, "java": JAVA, "javascript": JAVASCRIPT}
