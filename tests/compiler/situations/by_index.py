"""The situations of a template once more, from intervals and triggers that are lists of ticks.

Written from the words of the situations and from `tests.meaning`; no formula, no automaton.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from tests import meaning
from tests.strategies import Template

Columns = Mapping[str, Sequence[bool]]

DUALS = {
    "eventually": "always",
    "null": "always",
    "always": "eventually",
    "never": "eventually",
    "within": "for",
    "for": "within",
    "after": "not after",
    "until": "before",
    "before": "until",
}
"""What `only` scopes demand outside of themselves; the others are their own duals."""
ONE_INTERVAL = ("before", "after", "onlyBefore", "onlyAfter")


def kind(drawn: Template) -> str:
    """The timing as it is demanded."""
    if drawn.scope.startswith("only"):
        return DUALS.get(drawn.timing, drawn.timing)
    return {"null": "eventually", "never": "always"}.get(drawn.timing, drawn.timing)


def answers(drawn: Template, q: Sequence[bool]) -> list[bool]:
    """Whether the response is as it is demanded."""
    only = drawn.scope.startswith("only") and drawn.timing != "after"
    return [value is not (only != (drawn.timing == "never")) for value in q]


@dataclass(frozen=True)
class At:
    """One tick of a trace."""

    drawn: Template
    columns: Columns
    at: int

    @property
    def q(self) -> list[bool]:
        return answers(self.drawn, self.columns["q"])

    @property
    def intervals(self) -> list[tuple[int, int]]:
        """Those that have begun."""
        found = meaning.intervals(self.drawn.scope, self.columns["m"])
        return [each for each in found if each[0] <= self.at]

    @property
    def left(self) -> int | None:
        """The first tick of the interval that this tick lies in."""
        return next((left for left, right in self.intervals if left <= self.at <= right), None)

    @property
    def triggers(self) -> list[int]:
        """Those of this interval, up to this tick."""
        if self.left is None:
            return []
        p = self.columns["p"]
        return [*meaning.triggers(self.drawn.condition, p, self.left, self.at)]

    @property
    def before(self) -> list[int]:
        """All triggers before this tick."""
        found: list[int] = []
        for left, right in self.intervals:
            last = min(right, self.at - 1)
            found += meaning.triggers(self.drawn.condition, self.columns["p"], left, last)
        return found

    @property
    def previous(self) -> At:
        return At(self.drawn, self.columns, self.at - 1)

    @property
    def ended(self) -> bool:
        """The tick before was the last of an interval."""
        return any(right == self.at - 1 for _, right in self.intervals)

    @property
    def open_triggers(self) -> list[int]:
        """Those before this tick whose demands this tick may still decide."""
        return [t for t in self.triggers if t < self.at and self._is_open(t, self.at - 1)]

    @property
    def is_left_open(self) -> bool:
        """After this tick a demand is open."""
        return any(self._is_open(t, self.at) for t in self.triggers)

    def _is_open(self, trigger: int, last: int) -> bool:
        """Whether the demand of a trigger is open after the tick `last`."""
        n, passed = self.drawn.n, last - trigger
        answers, stops = self.q[trigger : last + 1], self.columns["s"][trigger : last + 1]
        silent = not any(answers)
        match kind(self.drawn):
            case "immediately":
                return False
            case "next":
                return passed == 0
            case "finally":
                return True
            case "always":
                return all(answers)
            case "eventually":
                return silent
            case "within":
                return silent and passed < n
            case "for":
                return all(answers) and passed < n
            case "after" | "not after":
                return silent and passed <= n
            case "until":
                return all(answers) and not any(stops)
            case "before":
                return silent and not any(stops)
            case other:
                raise AssertionError(other)

    # Keys ---------------------------------------------------------------------------------------

    def keys(self) -> Iterator[str]:
        """The situations of this tick, those of the end of a run left out."""
        yield from self._of_scope()
        yield from self._of_triggers()
        yield from self._of_answers()
        yield from self._after_a_miss()
        if self.ended and kind(self.drawn) != "finally" and self.previous.is_left_open:
            yield "scope-ends-open"

    def at_end(self) -> Iterator[str]:
        """The situations of a run that ends with this tick."""
        if not self.intervals:
            yield "never-enforced"
        if self.drawn.condition != "null" and not self.before and not self.triggers:
            yield "never-triggered"
        if kind(self.drawn) == "finally" and self.triggers:
            yield "run-ends-answered" if self.q[self.at] else "run-ends-missed"
        elif kind(self.drawn) != "always" and self.is_left_open:
            yield "run-ends-open"

    def _of_scope(self) -> Iterator[str]:
        at, p, m = self.at, self.columns["p"], self.columns["m"]
        if self.drawn.scope == "null":
            return
        if at in self.triggers and self.drawn.scope not in ONE_INTERVAL:
            yield "first-interval" if len(self.intervals) == 1 else "second-interval"
        if self.drawn.condition != "null":
            if self.left is None and p[at]:
                yield "condition-outside"
            if self.left == at and at > 0 and p[at] and p[at - 1]:
                yield "condition-across-entry"
        if self.drawn.scope in ONE_INTERVAL and at > 0:
            lasts = self.drawn.scope in ("after", "onlyBefore")
            begins_by = self.drawn.scope in ("after", "onlyAfter")
            lasting = self.left is not None and at > self.left
            over = self.left is None and True in m[:at]
            if m[at] is begins_by and (lasting if lasts else over):
                yield "mode-again"

    def _of_triggers(self) -> Iterator[str]:
        at, drawn = self.at, self.drawn
        conditional = drawn.condition != "null"
        if at in self.triggers:
            if at == 0 and (conditional or drawn.scope not in ("null", "before", "onlyAfter")):
                yield "triggered-at-start"
            if at != self.left:
                yield "triggered-later"
            if self.open_triggers:
                yield "triggered-while-open"
            elif conditional and self.before and kind(drawn) not in ("always", "finally"):
                yield "triggered-again"
        if conditional and self.columns["p"][at] and at - 1 in self.before:
            yield "condition-stays"

    def _of_answers(self) -> Iterator[str]:
        at, n, q = self.at, self.drawn.n, self.q
        here = at in self.triggers
        stop = "s" in self.drawn.columns and self.columns["s"][at]
        oldest = at - min(self.open_triggers) if self.open_triggers else None
        if here and kind(self.drawn) not in ("next", "finally"):
            yield from self._at_the_trigger(stop=stop)
        match kind(self.drawn):
            case "immediately":
                if here and not q[at]:
                    yield "missed-by-one"
            case "next":
                if at - 1 in self.triggers:
                    yield "answered-at-last-tick" if q[at] else "missed-by-one"
                    if q[at - 1] and not q[at]:
                        yield "answered-too-early"
            case "finally":
                yield from self._at_the_end()
            case "eventually":
                if oldest is not None and q[at]:
                    yield "answered-later"
                yield from self._at_the_end()
            case "always":
                if any(t < at for t in self.triggers) and not q[at]:
                    yield "missed-later"
            case "within":
                if oldest is not None and q[at]:
                    yield "answered-later" if oldest < n else "answered-at-last-tick"
                if (oldest == n or (here and n == 0)) and not q[at]:
                    yield "missed-by-one"
            case "for":
                yield from self._for()
            case "after":
                if oldest == n + 1:
                    yield "answered-at-last-tick" if q[at] else "missed-by-one"
                if n and self._came_too_early():
                    yield "answered-too-early"
            case "not after":
                if oldest is not None and oldest < n and q[at]:
                    yield "answered-later"
                if n and oldest == n and q[at]:
                    yield "answered-at-last-tick"
                if oldest == n + 1:
                    yield "one-tick-late" if q[at] else "never-answered"
            case "until" | "before" as name:
                yield from self._up_to(name, stop=stop, waits=oldest is not None)

    def _at_the_trigger(self, *, stop: bool) -> Iterator[str]:
        """Of each trigger, whatever demands are open; at a stop no answer is asked for."""
        name, answered = kind(self.drawn), self.q[self.at]
        if name in ("until", "before") and stop:
            yield "stopped-at-once"
        elif answered:
            yield "answered-at-once"
        elif name in ("always", "until") or (name == "for" and self.drawn.n):
            yield "missed-at-once"

    def _came_too_early(self) -> bool:
        """Of `after`: at the tick before the last tick of the first open trigger, and not here."""
        before = self.previous
        if self.at == 0 or self.left is None or before.left != self.left:
            return False
        opened = before.open_triggers
        due = bool(opened) and before.at - min(opened) == self.drawn.n
        return due and before.q[before.at] and not self.q[self.at]

    def _after_a_miss(self) -> Iterator[str]:
        """What the tick before, at which something was missed, has made of this one."""
        if self.at == 0:
            return
        before, name = self.previous, kind(self.drawn)
        missed = {*before._of_answers()}
        same = self.left is not None and before.left == self.left
        one_tick = name in ("immediately", "next", "within", "after")
        if one_tick and same and self.q[self.at] and "missed-by-one" in missed:
            yield "one-tick-late"
        if name == "until" and same and "missed-later" in missed and self.columns["s"][self.at]:
            yield "missed-by-one"
        if name == "always" and self.ended and "missed-later" in missed:
            yield "missed-by-one"

    def _at_the_end(self) -> Iterator[str]:
        if not self.ended or not self.previous.triggers:
            return
        q, last, late = self.q, self.at - 1, self.q[self.at]
        if kind(self.drawn) == "finally":
            if q[last]:
                yield "answered-at-last-tick"
                return
            yield "missed-by-one"
            if late:
                yield "one-tick-late"
            if last > 0 and q[last - 1] and self.previous.open_triggers:
                yield "answered-too-early"
            return
        if self.previous.is_left_open:
            yield "missed-by-one"
            if late:
                yield "one-tick-late"
        elif q[last] and self.previous.open_triggers:
            yield "answered-at-last-tick"

    def _for(self) -> Iterator[str]:
        at, n, q = self.at, self.drawn.n, self.q
        if not self.triggers:
            return
        newest = max(self.triggers)
        if 0 < at - newest < n and not q[at]:
            yield "missed-later"
        if all(q[newest:at]):
            if at - newest == n:
                if not q[at]:
                    yield "missed-by-one"
                elif n:
                    yield "answered-at-last-tick"
            if at - newest == n + 1 and not q[at]:
                yield "given-up-after"

    def _up_to(self, name: str, *, stop: bool, waits: bool) -> Iterator[str]:
        q, at = self.q, self.at
        if not waits:
            if name == "before" and stop and self._answered_before_stop():
                yield "answered-at-last-tick"
            return
        if name == "until":
            if stop:
                yield "stopped-later" if q[at] else "stopped-unanswered"
            elif not q[at]:
                yield "missed-later"
        elif stop:
            yield "one-tick-late" if q[at] else "stopped-unanswered"
        elif q[at]:
            yield "answered-later"

    def _answered_before_stop(self) -> bool:
        """The first answer came at the tick before, in this interval, and after its trigger."""
        before = self.previous
        same = self.at > 0 and self.left is not None and before.left == self.left
        answered = before.q[before.at] and not self.columns["s"][before.at]
        return same and bool(before.open_triggers) and answered
