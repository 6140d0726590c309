"""Text output of `fretc trends`, on one screen: worst changes first, further ones counted."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from textwrap import wrap

from fretc.audit.evidence.verdicts import VERDICTS, severity
from fretc.audit.selection.choice import in_words
from fretc.report.model import phrases
from fretc.terminal.output import Piece
from fretc.terminal.screen import Screen, fitted, padded
from fretc.trends.changes import RoundOutcome, VerdictChange
from fretc.trends.comparisons import ComparisonFinding
from fretc.trends.trends import Group, Item, Trends, arrived, gone, not_selected
from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.rendering import visible
from fretish.diagnostics.status_symbols import StatusSymbol

Line = tuple[Piece, ...]
_BLANK: Line = (("", None),)
_MARKS = 12
"""Number of newest rounds whose symbols are shown."""
_NAME, _ID = 22, 12
"""Maximum columns of scenario names and of ids."""


@dataclass(frozen=True, slots=True)
class _Section:
    """One kind of change."""

    title: str
    kinds: tuple[VerdictChange, ...]
    sign: StatusSymbol
    most: int
    """Maximum number of lines."""


_SECTIONS = (
    _Section("newly violated", (VerdictChange.NEW,), signs.BAD, 8),
    _Section("violated, and never judged before", (VerdictChange.FIRST_VIOLATED,), signs.BAD, 8),
    _Section("still violated", (VerdictChange.STILL,), signs.BAD, 6),
    _Section("decided before, undecided now", (VerdictChange.LOST,), signs.UNKNOWN, 5),
    _Section("fixed", (VerdictChange.FIXED,), signs.GOOD, 4),
)


def lines(trends: Trends, screen: Screen) -> Iterator[Line]:
    """All lines; none is wider than the screen."""
    for line in _all(trends, screen):
        (text, colour), *others = line
        plain = screen.text(text)
        if others or len(plain) <= screen.width:
            yield _narrow(line, screen.width)
            continue
        margin = " " * (len(plain) - len(plain.lstrip()))
        for part in wrap(plain, screen.width, subsequent_indent=f"{margin}  "):
            yield ((part, colour),)


def _narrow(line: Line, most: int) -> Line:
    pieces, left = [], most
    for text, colour in line:
        if left < 3:
            break
        piece = fitted(visible(text), left)
        pieces.append((piece, colour))
        left -= len(piece)
    return tuple(pieces)


def _all(trends: Trends, screen: Screen) -> Iterator[Line]:
    yield from _head(trends)
    for section in _SECTIONS[:2]:
        yield from _section(trends, section, screen)
    yield from _regressions(trends, screen)
    yield from _section(trends, _SECTIONS[2], screen)
    yield from _flaky(trends, screen)
    yield from _section(trends, _SECTIONS[3], screen)
    yield from _groups(gone(trends), signs.UNKNOWN, "gone: judged before, not in the newest round")
    yield from _groups(
        not_selected(trends),
        signs.UNKNOWN,
        "not selected: judged before, in logs that `--since` or `--sample` may have left out",
    )
    yield from _section(trends, _SECTIONS[4], screen)
    yield from _groups(arrived(trends), signs.UNUSED, "never judged before")
    yield from _rest(trends)


def _head(trends: Trends) -> Iterator[Line]:
    newest = trends.rounds[-1]
    what = {"evidence": "each evidence", "day": "each day"}.get(trends.by, f"each {trends.by}")
    scenarios = len({item.scenario for item in trends.items})
    counts = (
        phrases.times(len(trends.rounds), "round"),
        phrases.times(trends.runs, "run"),
        phrases.times(len(trends.sentences), "requirement"),
        phrases.times(scenarios, "scenario"),
    )
    yield ((f"{', '.join(counts)}; a round is {what}", None),)
    facts = [newest.days, *(f"version {version}" for version in newest.versions[:3])]
    about = ", ".join(filter(None, [*facts, phrases.times(newest.runs, "run")]))
    yield ((f"newest: {phrases.place(newest.name)} ({about})", None),)
    for selection in newest.selections:
        yield ((f"newest: {in_words(selection)}", None),)
    if len(trends.rounds) > 1:
        yield ((trends.order, None),)


def _section(trends: Trends, section: _Section, screen: Screen) -> Iterator[Line]:
    items = trends.of(*section.kinds)
    if not items:
        return
    yield _BLANK
    yield _title(section.sign, len(items), section.title)
    for item in items[: section.most]:
        yield _line(item, screen)
    yield from _more(items[section.most :])


def _title(sign: StatusSymbol, count: int, title: str) -> Line:
    return ((f"{sign.glyph} {count} {title}", sign.colour),)


def _more(items: Sequence[Item]) -> Iterator[Line]:
    if items:
        ids = phrases.some([*dict.fromkeys(item.requirement for item in items)])
        yield ((f"    and {len(items)} more, of {ids}: see --html or --format json", None),)


def _line(item: Item, screen: Screen) -> Line:
    rounds = zip(item.round_outcomes[-_MARKS:], item.rounds[-_MARKS:], strict=True)
    marks = [_mark(round_outcome, verdicts) for round_outcome, verdicts in rounds]
    return (
        (f"    {_column(item.requirement, _ID, screen)}  ", None),
        (f"{_column(str(item.scenario), _NAME, screen)}  ", None),
        *marks,
        (f"  {_words(item)}", None),
    )


def _mark(round_outcome: RoundOutcome | None, verdicts: Sequence[str]) -> Piece:
    """The symbol of a round; for an open round that of its worst verdict."""
    if round_outcome is None:
        return " ", None
    word = min(verdicts, key=severity)
    sign = signs.GOOD if round_outcome is RoundOutcome.SHOWN else VERDICTS[word].sign
    return sign.glyph, sign.colour


def _column(text: str, columns: int, screen: Screen) -> str:
    return padded(fitted(screen.text(text), columns), columns)


def _words(item: Item) -> str:
    """Number of runs in the newest round, and further information."""
    now = item.rounds[-1] or next((r for r in reversed(item.rounds) if r), ())
    verdicts = [f"{now.count(word)} {word}" for word in dict.fromkeys(sorted(now))]
    if len(verdicts) == 1:
        verdicts = [now[0]]
    notes = ["flaky" if item.flaky else "", "requirement changed" if item.changed else ""]
    return "; ".join([", ".join(verdicts), *filter(None, notes)])


def _flaky(trends: Trends, screen: Screen) -> Iterator[Line]:
    """Flaky requirements that no other section lists."""
    listed = {
        VerdictChange.NEW,
        VerdictChange.FIRST_VIOLATED,
        VerdictChange.STILL,
        VerdictChange.LOST,
        VerdictChange.FIXED,
    }
    items = [item for item in trends.items if item.flaky and item.change not in listed]
    if not items:
        return
    yield _BLANK
    yield _title(
        signs.OPEN, len(items), "flaky: violated in some earlier rounds, not in the newest"
    )
    for item in items[:4]:
        yield _line(item, screen)
    yield from _more(items[4:])


def _groups(groups: Sequence[Group], sign: StatusSymbol, title: str) -> Iterator[Line]:
    if not groups:
        return
    yield _BLANK
    yield _title(sign, sum(len(group.items) for group in groups), title)
    for group in groups[:5]:
        yield ((f"    {group.text}", None),)
    yield from _more([item for group in groups[5:] for item in group.items])


def _regressions(trends: Trends, screen: Screen) -> Iterator[Line]:
    regressions = trends.with_finding(ComparisonFinding.REGRESSED)
    if not regressions:
        return
    yield _BLANK
    yield _title(
        signs.BAD,
        len(regressions),
        f"regressed in {trends.compared.after} (medians), statistically significant",
    )
    for one in regressions[:6]:
        ids = _column(one.measure.ids, _ID, screen)
        yield ((f"    {ids}  {one.measure} {one.worse}", None),)
    if len(regressions) > 6:
        yield ((f"    and {len(regressions) - 6} more: see --html or --format json", None),)


def _rest(trends: Trends) -> Iterator[Line]:
    yield _BLANK
    steady, never = len(trends.of(VerdictChange.STEADY)), len(trends.of(VerdictChange.NEVER_SHOWN))
    flaky = sum(item.flaky for item in trends.items)
    yield ((f"{steady} shown as before, {never} never shown; {flaky} flaky in all", None),)
    chance = len(trends.with_finding(ComparisonFinding.CHANCE))
    few = len(trends.with_finding(ComparisonFinding.TOO_FEW))
    compared = f"{trends.compared.after} against {trends.compared.before}"
    yield (
        (
            f"latencies and margins, {compared}: "
            f"{len(trends.with_finding(ComparisonFinding.REGRESSED))} regressed, "
            f"{chance} no worse than chance, {few} with too few runs to tell",
            None,
        ),
    )
