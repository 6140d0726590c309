"""The verdict on one trace, from its monitor and from the condition of the log."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from fretish.classes.frozen import dataclass
from monitors import kernel
from monitors.kernel import Column, Monitor, Outcome
from monitors.kernel.verdicts import Verdict

Engine = Callable[[Monitor, Mapping[str, Column], int, Verdict], tuple[Outcome, ...]]
"""Monitor, columns, ticks and the verdict on open demands at the end → the outcome."""

WITHOUT_VIOLATION = (kernel.SATISFIED, kernel.VACUOUS)


@dataclass(frozen=True, slots=True)
class Judgement:
    """The outcome of a monitor over one trace, and the effect of the end of the log."""

    outcome: Outcome
    longer: str | None
    """The verdict if the time after the last whole tick were one more tick; None: there is no such
    time, or it changes nothing."""
    intact: bool
    """Whether the log is undamaged."""

    @property
    def verdict(self) -> str:
        """The verdict: a damaged log shows violations only, and a cut tick leaves demands open."""
        if self.outcome.verdict not in WITHOUT_VIOLATION:
            return self.outcome.verdict
        if not self.intact:
            return kernel.NO_DATA
        undone = self.longer is not None and self.longer != self.outcome.verdict
        return kernel.INCONCLUSIVE if undone else self.outcome.verdict

    @property
    def certain(self) -> bool:
        """Whether the verdict does not depend on the unknown values of the columns."""
        return kernel.NO_DATA not in (self.outcome.verdict, self.longer)


def judge(
    monitor: Monitor,
    columns: Mapping[str, Column],
    cut: Mapping[str, bool | None] | None,
    ticks: int,
    *,
    intact: bool,
    end: Verdict,
    engine: Engine = kernel.evaluate,
) -> tuple[Judgement, ...]:
    """Judge one trace, by each requirement of the monitor in its order.

    Args:
        monitor: of one requirement or more.
        columns: one for each proposition of the monitor.
        cut: the values of the tick that the end of the log cuts short; None: there is none.
        ticks: the length of the trace.
        intact: whether the log is undamaged.
        end: the verdict on demands that are open at the end.
        engine: the evaluator of the monitor.
    """
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

    Such a verdict is not reported: the tick is cut short, and no duration counts it. A cut tick
    that equals the last one adds nothing, unless something is unknown: then its values may differ.
    """
    cut = {name: cut[name] for name in columns}
    if not ticks:
        return None
    last = {name: column.at(ticks - 1) for name, column in columns.items()}
    if cut == last and None not in cut.values():
        return None
    longer = {name: column.followed(cut[name], ticks) for name, column in columns.items()}
    return [then.verdict for then in engine(monitor, longer, ticks + 1, kernel.INCONCLUSIVE)]
