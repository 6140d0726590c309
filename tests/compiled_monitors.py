"""Monitors in other languages than Python, verified in this process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import mkdtemp

from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Outcome, Result
from fretc.verification.compiled.plan import Given, Language, Prepared
from fretc.verification.compiled.text import StrangeTextError
from fretc.verification.compiled.tools import ToolError
from fretc.verification.compiled.verifying import explored

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
KINDS = {Result.COUNTEREXAMPLE: REFUTED, Result.PROVED: SAME, Result.NOT_CHECKED: REFUSED}


def edited(monitor: Given, old: str, new: str) -> Given:
    assert monitor.text.count(old) == 1, (old, monitor.text.count(old))
    return replace(monitor, text=monitor.text.replace(old, new))


@dataclass(frozen=True)
class Checker:
    """One language, and where its libraries lie.

    No two libraries have one file, for a process never lets go of one.
    """

    language: Language
    folder: Path

    def prepared(self, monitor: Given, *rules: Formalized) -> Prepared:
        """The text, checked and compiled; `StrangeTextError` and `ToolError` say why not."""
        program = self.language.tool()
        assert program is not None
        return self.language.prepared(program, monitor, rules, Path(mkdtemp(dir=self.folder)))

    def outcomes(self, monitor: Given, rules: Sequence[Formalized]) -> list[Outcome]:
        """Of each requirement of one text."""
        found = self.prepared(monitor, *rules)
        return [explored(rule, found.executable, found.checked.plan(rule), 10**5) for rule in rules]

    def outcome(self, monitor: Given, rule: Formalized) -> Outcome:
        """Of a text of one requirement."""
        (outcome,) = self.outcomes(monitor, [rule])
        return outcome

    def kind(self, monitor: Given, rule: Formalized) -> str:
        """Whether it is refuted, refused, or the same as what fretc writes."""
        try:
            return KINDS[self.outcome(monitor, rule).result]
        except (StrangeTextError, ToolError):
            return REFUSED
