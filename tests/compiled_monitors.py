"""Monitors in other languages than Python, verified in this process."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import wraps
from pathlib import Path
from tempfile import mkdtemp
from typing import Any, ParamSpec, TypeVar

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimOutcome, ClaimResult
from compiler.targets.javascript.monitor import text as in_javascript
from fretc.verification.c import language as c
from fretc.verification.compiled.plan import Executable, Language, ParsedSource, SourceText
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.compiled.tools import ToolError
from fretc.verification.compiled.verifying import explored
from fretc.verification.java import language as java
from fretc.verification.javascript import language as javascript
from fretc.verification.rust import language as rust
from tests import c_monitors, java_monitors, node, rust_monitors
from tests.c_monitors import Reading, Rows, Source

P = ParamSpec("P")
R = TypeVar("R")


def once(function: Callable[P, R]) -> Callable[P, R]:
    """Call it once for the same objects: requirements have no hash."""
    known: dict[tuple[int, ...], tuple[object, R]] = {}

    @wraps(function)
    def called(*args: P.args, **kwargs: P.kwargs) -> R:
        key = tuple(map(id, args))
        if key not in known:
            known[key] = args, function(*args, **kwargs)  # kept, so that no other has their ids
        return known[key][1]

    return called


WITHIN = "in m mode whenever p the sw shall within 3 ticks satisfy q"
FOR = "upon p the sw shall for 2 ticks satisfy q & !m"
RING = "only after m whenever p the sw shall within 2 ticks satisfy q"
SENTENCES = (
    WITHIN,
    FOR,
    RING,
    "before m mode the sw shall always satisfy q",
    "the sw shall until p satisfy q",
    "when p the sw shall after 2 ticks satisfy q",
    "whenever p the sw shall immediately satisfy x < 3",
)
REFUTED, REFUSED, SAME = "refuted", "refused", "same"
KINDS = {
    ClaimResult.COUNTEREXAMPLE: REFUTED,
    ClaimResult.PROVED: SAME,
    ClaimResult.NOT_CHECKED: REFUSED,
}


def edited(monitor: SourceText, old: str, new: str) -> SourceText:
    assert monitor.text.count(old) == 1, (old, monitor.text.count(old))
    return replace(monitor, text=monitor.text.replace(old, new))


@dataclass(frozen=True)
class Checker:
    """One language, and where its libraries lie.

    No two libraries have one file, for a process never lets go of one.
    """

    language: Language
    folder: Path

    @once
    def prepared(
        self, monitor: SourceText, *requirements: FormalizedRequirement
    ) -> tuple[ParsedSource, Executable]:
        """The text, checked and compiled; `UnexpectedLayoutError` and `ToolError` say why not."""
        checked = self.language.checked(monitor, requirements)
        program = self.language.tool()
        assert program is not None
        folder = Path(mkdtemp(dir=self.folder))
        return checked, self.language.prepared(program, monitor, checked, folder).executable

    def outcomes(
        self, monitor: SourceText, requirements: Sequence[FormalizedRequirement]
    ) -> list[ClaimOutcome]:
        """Of each requirement of one text."""
        checked, executable = self.prepared(monitor, *requirements)
        return [
            explored(requirement, executable, checked.plan(requirement), 10**5)
            for requirement in requirements
        ]

    def outcome(self, monitor: SourceText, requirement: FormalizedRequirement) -> ClaimOutcome:
        """Of a text of one requirement."""
        (outcome,) = self.outcomes(monitor, [requirement])
        return outcome

    def kind(self, monitor: SourceText, requirement: FormalizedRequirement) -> str:
        """Whether it is refuted, refused, or the same as what fretc writes."""
        try:
            return KINDS[self.outcome(monitor, requirement).result]
        except (UnexpectedLayoutError, ToolError):
            return REFUSED


@dataclass(frozen=True)
class Tongue:
    """A language, with what tests of it need."""

    name: str
    language: Language
    given: Callable[..., SourceText]
    """The monitor that fretc writes for some requirements."""
    comments: tuple[str, str]
    """Those that are free, and one of them."""
    start: str
    """Here begins the part that is changed."""
    end: str
    """Here it ends."""
    edits: Sequence[tuple[str, str]]
    """Mistakes, as what is found and what takes its place."""
    program: str
    """What compiles or runs it."""
    told: Callable[[Path, SourceText, FormalizedRequirement, Rows], list[list[c_monitors.Outcome]]]
    """What the text tells at each tick, by another program than that of the verification."""

    def faults(self, text: str) -> Iterator[str]:
        """The text with each mistake at each place, one at a time."""
        start, end = text.index(self.start), text.index(self.end)
        for old, new in self.edits:
            for match in re.finditer(old, text[start:end]):
                place = start + match.start()
                yield text[:place] + match.expand(new) + text[place + len(match[0]) :]


_SHARED = (
    (r"&&", "||"), (r"\|\|", "&&"), (r">=", ">"), (r"<=", "<"), (r"(?<= )< ", "<= "),
    (r"\bis_", "not_"), (r"\bnot_", "is_"), (r"true", "false"), (r"false", "true"),
    (r"(?<= )[1-9]\d*(?=\)|;|\)| })", "9"), (r"\+ 1", "+ 2"), (r"(?<= )0;", "1;"),
    (r"-1;", "0;"), (r"since_1", "since_2"), (r"since_2", "since_1"),
)  # fmt: skip
_BITWISE = ((r"(?<!word) & (?!bit|~|\(1 <<)", " | "), (r" \| (?!bit)", " & "))
"""Not of rings, which are as fretc writes them."""


@once
def given_c(*requirements: FormalizedRequirement) -> SourceText:
    """What `--emit c` writes for them."""
    source = Source.of(*requirements)
    header = source.source.removesuffix(".c") + ".h"
    return SourceText(source.source, source.texts[source.source], header, source.texts[header])


def _told_by_c(
    folder: Path, monitor: SourceText, requirement: FormalizedRequirement, rows: Rows
) -> list[list[c_monitors.Outcome]]:
    source = replace(Source.of(requirement), texts=monitor.texts)
    program = c_monitors.compiled(folder, "gcc", source, flags=["-std=c99"])
    return program.run((0, rows))[1][0]


@once
def given_rust(*requirements: FormalizedRequirement) -> SourceText:
    """What `--emit rust` writes for them."""
    return SourceText("lib.rs", rust_monitors.library(rust_monitors.crate(*requirements)))


def _told_by_rust(
    folder: Path, monitor: SourceText, requirement: FormalizedRequirement, rows: Rows
) -> list[list[c_monitors.Outcome]]:
    return rust_monitors.outcomes(
        folder, [monitor.text], [(0, rows)], lints=["--cap-lints", "warn"]
    )[0]


@once
def given_java(*requirements: FormalizedRequirement) -> SourceText:
    """What `--emit java` writes for them."""
    text = java_monitors.monitor(*requirements)
    return SourceText(f"{java_monitors.class_of(text)}.java", text)


def _told_by_java(
    folder: Path, monitor: SourceText, requirement: FormalizedRequirement, rows: Rows
) -> list[list[c_monitors.Outcome]]:
    return java_monitors.outcomes(folder, [monitor.text], [(0, rows)])[0]


@once
def given_javascript(*requirements: FormalizedRequirement) -> SourceText:
    """What `--emit js` writes for them."""
    return SourceText("monitor.mjs", in_javascript(*requirements))


def _told_by_javascript(
    folder: Path, monitor: SourceText, requirement: FormalizedRequirement, rows: Rows
) -> list[list[c_monitors.Outcome]]:
    (told,) = node.outcomes(folder, [monitor.text], [(0, rows)], "judge")
    return [[_outcome(tick, each) for each in row] for tick, row in enumerate(told)]


def _outcome(tick: int, told: dict[str, Any]) -> c_monitors.Outcome:
    certain, possible = (
        _reading(tick, told[approximation]) for approximation in ("certain", "possible")
    )
    # Only both together tell whether it was broken, or fails now.
    failed = {False: (True, True), True: (False, False), None: (False, True)}[told["finite"]]
    return c_monitors.Outcome(
        certain._replace(failed=failed[0]),
        possible._replace(failed=failed[1]),
        told["verdict"],
        told["finite"],
        told["obligationPending"],
    )


def _reading(tick: int, told: dict[str, Any]) -> Reading:
    left = -1 if told["deadline"] is None else max(-1, told["deadline"] - tick)
    trigger, violation, is_open, satisfied_forever, answer = (
        told[name]
        for name in ("trigger", "violation", "obligationPending", "satisfiedForever", "answer")
    )
    violated = told["firstViolation"] is not None
    return Reading(left, violated, False, trigger, violation, is_open, satisfied_forever, answer)


C = Tongue(
    "c", c, given_c, (r"/\*.*?\*/", "/* mine\n */"), "_clear(", "_judge(&",
    (*_SHARED, *_BITWISE, (r"!= FRETC", "== FRETC"), (r"\.certain;", ".possible;"),
     (r"(?m)^    +(approximation|reading)->\w+ = .*;$", ";")),
    "gcc", _told_by_c,
)  # fmt: skip
RUST = Tongue(
    "rust", rust, given_rust, (r"(?<!/)// .*", "// mine\n//"),
    "impl Approximation {", "impl Default",
    (*_SHARED, *_BITWISE, (r"!= Some", "== Some"), (r"\(certain\[", "(possible["),
     (r": (\d+|-1),", ": 7,"), (r"(?m)^ +self\.\w+ = .*;$", "")),
    "rustc", _told_by_rust,
)  # fmt: skip
JAVASCRIPT = Tongue(
    "javascript", javascript, given_javascript, (r"// .*", "// mine\n/* too */"),
    "function approximation(", "/** The truth of",
    (*_SHARED, (r"null \?", "true ?"), (r": (\d+|-1),", ": 7,"),
     (r"(?m)^  approximation\.\w+ = .*;$", "")),
    "node", _told_by_javascript,
)  # fmt: skip
JAVA = Tongue(
    "java", java, given_java,
    (r"(?m)// .*$(?!\n +public final Outcome)", "// mine\n/* too */"),
    "private static final class Literals {", "\n}\n",
    (*_SHARED, *_BITWISE, (r"!= Truth", "== Truth"), (r"(?<=\? )outcomes", "null"),
     (r"= (\d+|-1);", "= 7;"), (r"advance1", "tell1"),
     (r"(?m)^ +(this|reading)\.\w+ = .*;$", "")),
    "javac", _told_by_java,
)  # fmt: skip
TONGUES = {each.name: each for each in (C, RUST, JAVA, JAVASCRIPT)}
