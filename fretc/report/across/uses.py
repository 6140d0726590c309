"""The share of each bound (deadline and thresholds) that the runs of a requirement used.

A threshold counts as a bound only if no run that satisfies the requirement crosses it, because good
runs cross the thresholds of triggers. The share of a deadline is latency / allowed time. The share
of a threshold is 1 - (least distance / size of the threshold); if the threshold is 0, the greatest
value of all runs replaces its size. Runs beyond a bound come first. Runs with an unknown share are
counted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import inf, isfinite

from fretc.audit.evidence.samples import number
from fretc.audit.evidence.schema import ThresholdRecord
from fretc.report.model import phrases
from fretc.report.model.pictures import Use, UseRow, Uses
from fretc.report.model.results import ResultRow
from fretish.bindings.amounts import exact
from fretish.classes.frozen import dataclass
from monitors import kernel

_LETTERS = "abcdefgh"
"""Letters of the bounds in one picture; further bounds are counted."""
_ROUNDING = 1e-9


RunThresholds = tuple[ResultRow, Sequence[ThresholdRecord]]
"""A result and its thresholds, in declared units."""
_Key = tuple[str, str, str, float, str]


def uses(
    runs: Sequence[RunThresholds], allowed: float | None, most: int, suspect: int = 0
) -> Uses | None:
    """The ranking of runs; None if fewer than two runs have a share.

    Args:
        runs: runs with current results, in their order.
        allowed: seconds to the deadline of the response; None if there is no deadline.
        most: maximum number of rows.
        suspect: number of runs that are left out because their results are suspect.
    """
    grouped = _grouped(runs)
    bounds = {key: bound for key, of in grouped.items() if (bound := _bound(of)) is not None}
    letters = _lettered(allowed, bounds)
    rows = [_row(*run, allowed, bounds, letters) for run in runs]
    places = sorted((n for n, row in enumerate(rows) if row.uses), key=lambda n: _rank(rows[n]))
    if len(places) < 2:
        return None
    shown = [_row(*runs[n], allowed, bounds, letters, worded=True) for n in places[:most]]
    left = [rows[n] for n in places[most:]]
    more = len(bounds) + bool(allowed) - len(letters)
    notes = tuple(
        filter(
            None,
            [
                _left_out(left),
                _unknown([row for row in rows if not row.uses]),
                _not_bounds([key for key in grouped if key not in bounds]),
                f"{phrases.times(more, 'more bound')} not ranked." if more > 0 else "",
                f"{phrases.times(suspect, 'suspect run')} left out." if suspect else "",
            ],
        )
    )
    measures = tuple((letter, _named(key, allowed)) for key, letter in letters.items())
    return Uses(
        "How much of its bounds each run used",
        measures,
        tuple(shown),
        notes,
        _in_words(shown, measures, notes),
    )


def _grouped(runs: Sequence[RunThresholds]) -> dict[_Key, list[tuple[ResultRow, ThresholdRecord]]]:
    """The thresholds of all runs, grouped by comparison."""
    grouped: dict[_Key, list[tuple[ResultRow, ThresholdRecord]]] = {}
    for run, thresholds in runs:
        for threshold in thresholds:
            grouped.setdefault(_key(threshold), []).append((run, threshold))
    return grouped


def _key(each: ThresholdRecord) -> _Key:
    return each.proposition, each.signal, each.operator, each.bound, each.unit


@dataclass(frozen=True, slots=True)
class _Bound:
    """The data of all runs for one threshold."""

    side: str | None
    """The truth value of the comparison in runs that satisfy the requirement; None if unknown."""
    scale: float
    """The value by which distances are divided."""


def _bound(of: Sequence[tuple[ResultRow, ThresholdRecord]]) -> _Bound | None:
    """The bound; None if runs that satisfy the requirement are on both sides of the threshold."""
    good = [each.comparison for run, each in of if run.mark.word == kernel.SATISFIED]
    kept = {comparison for comparison in good if comparison is not None}
    if "crossed" in kept or len(kept) > 1 or not any(each.comparison for _, each in of):
        return None
    scale = abs(of[0][1].bound) or max(_reach(each) for _, each in of)
    return _Bound(next(iter(kept), None), scale)


def _lettered(allowed: float | None, bounds: Mapping[_Key, object]) -> dict[_Key | None, str]:
    """Bound → letter; None is the latency."""
    keys: list[_Key | None] = [*([None] if allowed else []), *bounds]
    return dict(zip(keys, _LETTERS, strict=False))


def _named(key: _Key | None, allowed: float | None) -> str:
    if key is None:
        return f"latency within {phrases.seconds(allowed or 0.0)}"
    proposition, signal, operator, bound, unit = key
    return f"{signal} {operator} {exact(bound, unit)} ({proposition})"


def _row(
    run: ResultRow,
    thresholds: Sequence[ThresholdRecord],
    allowed: float | None,
    bounds: Mapping[_Key, _Bound],
    letters: Mapping[_Key | None, str],
    *,
    worded: bool = False,
) -> UseRow:
    """The row of a run; texts only if `worded`, because most rows are not shown."""
    uses = list(_of_latency(run, allowed, letters))
    for threshold in thresholds:
        key = _key(threshold)
        if key in bounds and key in letters and threshold.comparison is not None:
            uses.append(_of_threshold(threshold, bounds[key], letters[key], worded=worded))
    uses.sort(key=_most_used)
    return UseRow(run.run_label, run.run_file, run.mark, run.anchor, run.section, tuple(uses))


def _most_used(use: Use) -> tuple[bool, float, str]:
    return not use.is_crossed, -(inf if use.share is None else use.share), use.measure


def _rank(row: UseRow) -> tuple[bool, bool, float]:
    first = row.uses[0]
    return (
        row.mark.word != kernel.VIOLATED,
        not first.is_crossed,
        -(inf if first.share is None else first.share),
    )


# Latency ---------------------------------------------------------------------------------------


def _of_latency(
    run: ResultRow, allowed: float | None, letters: Mapping[_Key | None, str]
) -> Iterator[Use]:
    if not allowed or None not in letters:
        return
    limit, latency = phrases.seconds(allowed), run.latency_max_s
    if latency is not None and latency > allowed + _ROUNDING:
        text = f"answered after {phrases.seconds(latency)}, {limit} are allowed"
        yield Use(letters[None], latency / allowed, True, text)
    elif run.violations_total and run.triggers:
        yield Use(letters[None], None, True, f"no answer within {limit}")
    elif latency is not None:
        text = f"answered after {phrases.seconds(latency)} of {limit}"
        yield Use(letters[None], max(0.0, latency / allowed), False, text)


# Thresholds ------------------------------------------------------------------------------------


def _of_threshold(each: ThresholdRecord, of: _Bound, letter: str, *, worded: bool) -> Use:
    side = of.side or (each.comparison if each.comparison != "crossed" else None)
    beyond = each.comparison != side
    worst = _worst(each, side)
    distance = _beyond(each, side) if beyond else each.margin
    if distance is None or not of.scale or not isfinite(distance / of.scale):
        share = None if beyond else 0.0
    else:
        share = 1 + distance / of.scale if beyond else max(0.0, 1 - distance / of.scale)
    return Use(letter, share, beyond, _measured(each, worst) if worded else "")


def _measured(each: ThresholdRecord, worst: float | None) -> str:
    bound = exact(each.bound, each.unit)
    if worst is None:
        return f"crossed {bound}"
    return f"{phrases.value(worst, each.unit, [each.bound])}, bound {bound}"


def _reach(each: ThresholdRecord) -> float:
    ends = (number(each.least), number(each.greatest))
    return max((abs(end) for end in ends if end is not None and isfinite(end)), default=0.0)


def _worst(each: ThresholdRecord, side: str | None) -> float | None:
    """The value nearest to the bound, or farthest beyond it; None if the side is unknown."""
    if side is None:
        return None
    is_upper = (each.operator in ("<", "<=")) == (side == "true")
    return number(each.greatest if is_upper else each.least)


def _beyond(each: ThresholdRecord, side: str | None) -> float | None:
    worst = _worst(each, side)
    return None if worst is None else abs(worst - each.bound)


# Words -----------------------------------------------------------------------------------------


def _left_out(left: Sequence[UseRow]) -> str:
    if not left:
        return ""
    violated = sum(row.mark.word == kernel.VIOLATED for row in left)
    crossed = sum(row.uses[0].is_crossed for row in left)
    shares = [row.uses[0].share for row in left if not row.uses[0].is_crossed]
    most = max((share for share in shares if share is not None), default=None)
    parts = [
        f"{phrases.whole(violated)} of them violated" if violated else "",
        f"{phrases.whole(crossed)} beyond a bound" if crossed else "",
        f"the others used at most {percent(most)}" if most is not None and crossed else "",
        f"they used at most {percent(most)}" if most is not None and not crossed else "",
    ]
    return f"{phrases.times(len(left), 'more run')}: {', '.join(filter(None, parts))}."


def percent(share: float) -> str:
    """`63 %`; a share near 100 % is never rounded to `100 %`."""
    whole = f"{share * 100:.0f}"
    if share < 1 and float(whole) >= 100:
        return "just below 100 %"
    if share > 1 and float(whole) <= 100:
        return "just above 100 %"
    return f"{whole} %" if share < 100 else "more than 10 000 %"


def _unknown(rows: Sequence[UseRow]) -> str:
    """A sentence about runs without a share: unknown, never triggered, or without an answer."""
    if not rows:
        return ""
    named = [f"{row.label} ({row.mark.text})" for row in rows]
    return f"How much of the bound was used is not known in {phrases.some(named)}."


def _not_bounds(keys: Sequence[_Key]) -> str:
    if not keys:
        return ""
    named = [
        f"`{signal} {operator} {exact(bound, unit)}`" for _, signal, operator, bound, unit in keys
    ]
    return (
        "Not ranked, because runs that satisfy the requirement are on both sides of the "
        f"bound, or no value is known: {phrases.some(list(dict.fromkeys(named)))}."
    )


def _in_words(
    rows: Sequence[UseRow], measures: Sequence[tuple[str, str]], notes: Sequence[str]
) -> str:
    named = [f"{row.label}: {row.uses[0].text}{_share(row.uses[0])}" for row in rows[:3]]
    bounds = phrases.joined([f"{letter} is {name}" for letter, name in measures])
    return " ".join([f"The most used first. {'; '.join(named)}. Bounds: {bounds}.", *notes])


def _share(use: Use) -> str:
    return f" ({percent(use.share)})" if use.share is not None else ""
