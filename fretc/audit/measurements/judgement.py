"""The verdict on one trace: what its monitor shows, and what the log takes back of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from monitors import kernel
from monitors.kernel import Column, Monitor, Outcome
from monitors.kernel.verdicts import Verdict

Engine = Callable[[Monitor, Mapping[str, Column], int, Verdict], tuple[Outcome, ...]]
"""Monitor, columns, ticks and the verdict on what is open at the end → the outcome."""

WITHOUT_VIOLATION = (kernel.SATISFIED, kernel.VACUOUS)


@dataclass(frozen=True, slots=True)
class Judgement:
    """The outcome of a monitor over one trace, and what the end of the log changes."""

    outcome: Outcome
    longer: str | None
    """The verdict where what came after the last whole tick is one more tick; None where that is
    nothing, or changes nothing."""
    intact: bool
    """Whether the log is whole."""

    @property
    def verdict(self) -> str:
        """A damaged log can show a violation, and nothing else; a cut tick leaves things open."""
        if self.outcome.verdict not in WITHOUT_VIOLATION:
            return self.outcome.verdict
        if not self.intact:
            return kernel.NO_DATA
        undone = self.longer is not None and self.longer != self.outcome.verdict
        return kernel.INCONCLUSIVE if undone else self.outcome.verdict

    @property
    def certain(self) -> bool:
        """Whether the verdict is the same whatever the unknown values of the columns were."""
        return kernel.NO_DATA not in (self.outcome.verdict, self.longer)


def judged(
    monitor: Monitor,
    columns: Mapping[str, Column],
    cut: Mapping[str, bool | None] | None,
    ticks: int,
    *,
    intact: bool,
    end: Verdict,
    engine: Engine = kernel.evaluate,
) -> Judgement:
    """Judge one trace.

    Args:
        monitor: of one requirement.
        columns: one for each of its propositions.
        cut: what a tick would see that the end of the log cuts short; None where there is none.
        ticks: the length of the trace.
        intact: whether the log is whole.
        end: what a demand is that is open at the end.
        engine: how the monitor is run.
    """
    (judgement,) = each_judged(monitor, columns, cut, ticks, intact=intact, end=end, engine=engine)
    return judgement


def each_judged(
    monitor: Monitor,
    columns: Mapping[str, Column],
    cut: Mapping[str, bool | None] | None,
    ticks: int,
    *,
    intact: bool,
    end: Verdict,
    engine: Engine = kernel.evaluate,
) -> tuple[Judgement, ...]:
    """The same by each requirement of a monitor of several, in their order."""
    outcomes = engine(monitor, columns, ticks, end)
    matters = [each.verdict in WITHOUT_VIOLATION and intact for each in outcomes]
    longer: Sequence[str | None] = [None] * len(outcomes)
    if any(matters) and cut is not None:
        longer = _longer(monitor, columns, cut, ticks, engine) or longer
    return tuple(
        Judgement(outcome, then if it_matters else None, intact)
        for outcome, then, it_matters in zip(outcomes, longer, matters, strict=True)
    )


def _longer(
    monitor: Monitor,
    columns: Mapping[str, Column],
    cut: Mapping[str, bool | None],
    ticks: int,
    engine: Engine,
) -> list[str] | None:
    """The verdicts with the cut tick as one more.

    What that shows is no verdict: the tick is cut short, and no duration counts it. Nor does a
    tick that is as the last one, unless something is unknown: then it may be another one.
    """
    cut = {name: cut[name] for name in columns}
    if not ticks:
        return None
    last = {name: column.at(ticks - 1) for name, column in columns.items()}
    if cut == last and None not in cut.values():
        return None
    longer = {name: column.followed(cut[name], ticks) for name, column in columns.items()}
    return [then.verdict for then in engine(monitor, longer, ticks + 1, kernel.INCONCLUSIVE)]
