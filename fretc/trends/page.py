"""Trends as one HTML file that works offline, in the style of the report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from compiler.files.build_id import __version__
from compiler.files.templating import render
from fretc.audit.evidence.verdicts import severity
from fretc.audit.selection.choice import in_words
from fretc.report.model import phrases
from fretc.report.page.html import hash_source, visible_texts
from fretc.trends.changes import RED, VerdictChange
from fretc.trends.charts import chart, heat_map, strip
from fretc.trends.comparisons import ComparisonFinding, VersionComparison
from fretc.trends.known_requirements import NOTHING_KNOWN, KnownRequirements
from fretc.trends.trends import Group, Item, Trends, arrived, gone, not_selected
from fretish.classes.frozen import dataclass
from fretish.diagnostics import status_symbols as signs
from fretish.diagnostics.status_symbols import StatusSymbol

_MOST_RED, _MOST = 500, 150
"""The most rows of a list; the omitted ones are counted, with their requirements."""
_MOST_CHARTS = 24
_PAIRS = "pairs of requirement and scenario"
_FOLDED = 12
"""Above this number of rows a list is folded, unless it is red."""


@dataclass(frozen=True, slots=True)
class _List:
    """Items with one change."""

    anchor: str
    title: str
    about: str
    kinds: tuple[VerdictChange, ...]
    sign: StatusSymbol


_LISTS = (
    _List("new", "Newly violated",
          "Violated now, but not in the last round with a known outcome.", (VerdictChange.NEW,),
          signs.BAD),
    _List("first-violated", "Violated, and never judged before",
          "The newest round is the first that judges them.", (VerdictChange.FIRST_VIOLATED,),
          signs.BAD),
    _List("still", "Still violated",
          "Violated now, and in the last round with a known outcome.", (VerdictChange.STILL,),
          signs.BAD),
    _List("lost", "Decided before, undecided now",
          "Violated or shown before; the newest round leaves it open, so nothing is fixed.",
          (VerdictChange.LOST,), signs.UNKNOWN),
    _List("fixed", "Fixed",
          "Violated in the last round with a known outcome, shown now.", (VerdictChange.FIXED,),
          signs.GOOD),
    _List("never", "Never shown",
          "No round has shown them, and none has violated them.", (VerdictChange.NEVER_SHOWN,),
          signs.UNKNOWN),
)  # fmt: skip


def html(trends: Trends, reports: str = "", known: KnownRequirements = NOTHING_KNOWN) -> str:
    """The text of the whole file.

    Args:
        trends: the trends.
        reports: the address of the report of a round, with `{name}` for the name of its
            evidence; "" if the page has no links to reports.
        known: titles and time limits of the requirements.
    """
    style = render("report/style.css.j2") + render("trends/style.css.j2")
    lists = [_listed(change_list, trends.of(*change_list.kinds), known) for change_list in _LISTS]
    flaky = [item for item in trends.items if item.flaky]
    regressed = trends.with_finding(ComparisonFinding.REGRESSED)
    others = [
        comparison
        for comparison in trends.comparisons
        if comparison.finding is not ComparisonFinding.REGRESSED
    ]
    moving = [
        comparison
        for comparison in others
        if len({value.number for value in comparison.values}) > 1
    ]
    pictured = moving[:_MOST_CHARTS]
    return render(
        "trends/page.html.j2",
        style=style,
        style_hash=hash_source(style),
        fretc=__version__,
        times=phrases.times,
        **visible_texts(
            {
                "mark": _mark(trends),
                "headline": _headline(trends),
                "facts": _facts(trends),
                "rounds": [_round(i, each) for i, each in enumerate(trends.rounds, 1)],
                "by": trends.by,
                "heat": heat_map(trends, reports, known.titles),
                "has_days": any(each.days != each.name for each in trends.rounds),
                "lists": [change_list for change_list in lists if change_list["rows"]],
                "flaky": {
                    "rows": _rows(flaky[:_MOST_RED], known),
                    "left": _left(flaky[_MOST_RED:]),
                    "count": phrases.whole(len(flaky)),
                },
                "gone_count": phrases.whole(len(trends.of(VerdictChange.GONE))),
                "arrived_count": phrases.whole(sum(len(group.items) for group in arrived(trends))),
                "regressions": phrases.whole(len(regressed)) if regressed else "",
                "gone": _groups(gone(trends)),
                "not_selected_count": phrases.whole(len(trends.of(VerdictChange.NOT_SELECTED))),
                "not_selected": _groups(not_selected(trends)),
                "arrived": _groups(arrived(trends)),
                "compared": {"before": trends.compared.before, "after": trends.compared.after},
                "level": f"{trends.level:g}",
                "regressed": _charts(trends, regressed[:_MOST_CHARTS], "regressed", known),
                "regressed_lines": [
                    f"{one.measure.ids}, {one.measure}: {one.worse}"
                    for one in regressed[_MOST_CHARTS:]
                ],
                "others": _charts(trends, pictured, "other", known),
                "few": len(trends.with_finding(ComparisonFinding.TOO_FEW)),
                "chance": len(trends.with_finding(ComparisonFinding.CHANCE)),
                "pictured": len(pictured),
                "moving": len(moving),
            }
        ),
    )


def _mark(trends: Trends) -> dict[str, Any]:
    """The overall symbol and its word."""
    if trends.is_worse:
        return {**asdict(signs.BAD), "word": "worse"}
    if not trends.is_comparable:
        word = "some are undecided now" if trends.lost else "not all can be compared"
        return {**asdict(signs.UNKNOWN), "word": word}
    if trends.of(VerdictChange.STILL):
        return {**asdict(signs.OPEN), "word": "nothing is worse, and some are still violated"}
    return {**asdict(signs.GOOD), "word": "nothing is worse"}


def _headline(trends: Trends) -> str:
    still = trends.of(VerdictChange.STILL)
    violated = len({item.requirement for item in still})
    scenarios = phrases.times(len({item.scenario for item in still}), "scenario")
    counts = (
        (len(trends.of(*RED)), "new violation", ""),
        (len(trends.with_finding(ComparisonFinding.REGRESSED)), "regression", ""),
        (violated, f"requirement still violated in {scenarios}",
         f"requirements still violated in {scenarios}"),
        (len(trends.lost), "verdict undecided now", "verdicts undecided now"),
        (len(trends.of(VerdictChange.FIXED)), "fixed", "fixed"),
    )  # fmt: skip
    parts = [phrases.times(count, one, many) for count, one, many in counts if count]
    return f"{phrases.joined(parts) or 'Nothing has changed'}."


def _facts(trends: Trends) -> list[str]:
    newest = trends.rounds[-1]
    versions = phrases.some([f"version {version}" for version in newest.versions], 3)
    day = "" if newest.days == newest.name else newest.days
    about = ", ".join(filter(None, [day, versions, phrases.times(newest.runs, "run")]))
    steady, never = len(trends.of(VerdictChange.STEADY)), len(trends.of(VerdictChange.NEVER_SHOWN))
    return [
        f"Newest round: {phrases.place(newest.name)} ({about}).",
        f"{phrases.times(len(trends.rounds), 'round')}, {phrases.times(trends.runs, 'run')}, "
        f"{phrases.times(len(trends.sentences), 'requirement')}.",
        f"Of {phrases.times(len(trends.items), 'pair of requirement and scenario', _PAIRS)}, "
        f"{phrases.whole(steady)} {'is' if steady == 1 else 'are'} shown as before, "
        f"{phrases.whole(never)} {'was' if never == 1 else 'were'} never shown.",
        *(f"Newest round: {in_words(selection)}." for selection in newest.selections),
        *([f"{trends.order[:1].upper()}{trends.order[1:]}."] if len(trends.rounds) > 1 else []),
    ]


def _round(number: int, each: Any) -> dict[str, Any]:
    return {
        "number": number,
        "name": phrases.place(each.name),
        "days": each.days,
        "versions": phrases.some(list(each.versions), 4),
        "runs": phrases.whole(each.runs),
    }


def _listed(each: _List, items: Sequence[Item], known: KnownRequirements) -> dict[str, Any]:
    most = _MOST_RED if each.sign is signs.BAD else _MOST
    return {
        "anchor": each.anchor,
        "title": each.title,
        "about": each.about,
        "sign": asdict(each.sign),
        "count": phrases.whole(len(items)),
        "rows": _rows(items[:most], known),
        "is_folded": each.sign is not signs.BAD and len(items) > _FOLDED,
        "left": _left(items[most:]),
    }


def _left(items: Sequence[Item]) -> str:
    """The omitted items in words; empty: there are none."""
    if not items:
        return ""
    ids = phrases.some([*dict.fromkeys(item.requirement for item in items)], 20)
    return f"{phrases.whole(len(items))} more are left out here, of {ids}: `--format json` has all."


def _groups(groups: Sequence[Group]) -> list[str]:
    """Each group in words; of very many the first ones, and the number of others."""
    more = len(groups) - _MOST_RED
    lines = [group.text for group in groups[:_MOST_RED]]
    return [*lines, f"{phrases.whole(more)} more: `--format json` has all"] if more > 0 else lines


def _rows(items: Sequence[Item], known: KnownRequirements) -> list[dict[str, Any]]:
    return [
        {
            "requirement": item.requirement,
            "title": known.titles.get(item.requirement, ""),
            "scenario": str(item.scenario),
            "strip": strip(item.round_outcomes),
            "now": _now(item),
        }
        for item in items
    ]


def _now(item: Item) -> str:
    now = item.rounds[-1]
    verdicts = ", ".join(f"{now.count(word)} {word}" for word in sorted({*now}, key=severity))
    notes = ["flaky"] * item.flaky + ["the requirement changed"] * item.changed
    return "; ".join([verdicts or "not judged", *notes])


def _charts(
    trends: Trends, some: Sequence[VersionComparison], kind: str, known: KnownRequirements
) -> list[dict[str, Any]]:
    after = trends.is_after
    names = [each.days[5:10] or str(number) for number, each in enumerate(trends.rounds, 1)]
    return [
        chart(one, names, after, f"{kind}-{number}", known) for number, one in enumerate(some, 1)
    ]
