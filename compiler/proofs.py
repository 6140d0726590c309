"""What verifying monitors has shown: one line for a person, one object for a program."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any, assert_never

from compiler.proving import NotChecked, Proved, Refuted
from compiler.verifying import Disagreement, Verified
from monitors.kernel.verdicts import Truth

_Word = Sequence[tuple[Truth, ...]]

PROVED, REFUTED, NOT_CHECKED = "proved", "refuted", "not checked"


def status(verified: Verified) -> str:
    """One of proved, refuted, not checked."""
    match verified.result:
        case Proved():
            return PROVED
        case Refuted() | Disagreement():
            return REFUTED
        case NotChecked():
            return NOT_CHECKED
        case _:
            assert_never(verified.result)


def as_record(verified: Verified) -> dict[str, Any]:
    """Plain values, in a fixed order of keys."""
    record: dict[str, Any] = {"requirement": verified.requirement, "monitor": status(verified)}
    match verified.result:
        case Proved(states, steps):
            return {**record, "states": states, "steps": steps, "columns": verified.compared}
        case Refuted(word, expected, found):
            judged = {
                "expected": {"verdict": expected[0], "finite": expected[1]},
                "found": {"verdict": found[0], "finite": found[1]},
            }
            return {**record, **judged, "trace": _trace(verified.atoms, word)}
        case Disagreement(word):
            return {**record, "trace": _trace(verified.atoms, word)}
        case NotChecked(reason):
            return {**record, "reason": reason}
        case _:
            assert_never(verified.result)


def _trace(atoms: Sequence[str], word: _Word) -> list[dict[str, Truth]]:
    return [dict(zip(atoms, letter, strict=True)) for letter in word]


def text(verified: Verified) -> str:
    """What is known, and for a refutation the trace that shows it."""
    match verified.result:
        case Proved(states, steps):
            return (
                f"proved: the same at every tick of every trace ({states} states, {steps} steps); "
                f"columns agree on {verified.compared} drawn ticks"
            )
        case Refuted(word, expected, found, shortest):
            length = f"{len(word)} tick{'' if len(word) == 1 else 's'}"
            kind = "the shortest trace" if shortest else "a trace"
            told = f"refuted: {kind} that shows it has {length}; after it, {_judged(*found)}"
            lines = [f"{told}, and should be {_judged(*expected)}"]
            return "\n".join([*lines, *_shown(verified.atoms, word)])
        case Disagreement(word):
            lines = ["refuted: its column program and its steps differ on a trace"]
            return "\n".join([*lines, *_shown(verified.atoms, word)])
        case NotChecked(reason):
            return f"not checked: {reason}"
        case _:
            assert_never(verified.result)


def _judged(verdict: str, finite: bool) -> str:
    return f"{verdict} ({'true' if finite else 'false'} if it ended there)"


def _shown(atoms: Sequence[str], word: _Word) -> Iterator[str]:
    """The trace, equal ticks together."""
    tick = 0
    for letter, run in groupby(word):
        last = tick + len(list(run)) - 1
        ticks = f"tick {tick}" if last == tick else f"ticks {tick}..{last}"
        values = ", ".join(
            f"{name} = {'?' if value is None else int(value)}"
            for name, value in zip(atoms, letter, strict=True)
        )
        yield f"    {ticks}: {values}"
        tick = last + 1
