"""Text output of `fretc test`: a row for each requirement, missing goals, or tests as tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from fretc.analysis.reasons import listed
from fretc.analysis.text_output import Line, drawn
from fretc.testing.suite import GoalResult, GoalStatus, MutantResult, MutantStatus, Suite, Test
from fretish.bindings.declarations import Role
from fretish.diagnostics import status_symbols as signs
from monitors.kernel.verdicts import Verdict

_SIGNS: Mapping[Verdict, signs.StatusSymbol] = {
    Verdict.SATISFIED: signs.GOOD,
    Verdict.VIOLATED: signs.BAD,
    Verdict.PENDING: signs.OPEN,
    Verdict.INCONCLUSIVE: signs.OPEN,
    Verdict.VACUOUS: signs.EMPTY,
    Verdict.NO_DATA: signs.UNKNOWN,
}


def lines(suite: Suite) -> Iterator[Line]:
    """The summary."""
    sign = signs.GOOD if suite.is_complete else signs.UNKNOWN
    yield f"{sign.glyph} {_headline(suite)}", sign.colour
    yield "", None
    yield from ((row, None) for row in _table(suite))
    remarks = [*_remarks(suite)]
    if remarks:
        yield "", None
        yield from remarks


def lines_of_file(suite: Suite) -> Iterator[Line]:
    """Summary of tests from a file; the goals that they cover are not examined."""
    yield (
        f"{signs.GOOD.glyph} {_size(suite)}; the monitors give the expected results",
        signs.GOOD.colour,
    )
    yield "", None
    yield from ((row, None) for row in _table(suite, columns=3))


def _headline(suite: Suite) -> str:
    if not suite.is_complete:
        return f"{_size(suite)}; the search is not complete"
    return f"{_size(suite)}; each situation is covered or impossible, and no mutant survives"


def _size(suite: Suite) -> str:
    ticks = sum(test.ticks for test in suite.tests)
    size = f"{_some(len(suite.tests), 'test')} of {_some(ticks, 'tick')} together"
    return f"{_some(len(suite.requirements), 'requirement')}: {size}"


def _some(count: int, what: str) -> str:
    return f"{count:,} {what}{'' if count == 1 else 's'}".replace(",", " ")


_HEAD = ("", "tests", "ticks", "situations", "mutants")


def _table(suite: Suite, columns: int = len(_HEAD)) -> Iterator[str]:
    rows = [_HEAD]
    for requirement in suite.requirements:
        own = [test for test in suite.tests if test.requirement == requirement.id]
        obligations = [
            obligation
            for obligation in suite.obligations
            if obligation.requirement == requirement.id
        ]
        mutants = [mutant for mutant in suite.mutants if mutant.requirement == requirement.id]
        rows.append(
            (
                requirement.id,
                str(len(own)),
                str(sum(test.ticks for test in own)),
                _counts([obligation.outcome for obligation in obligations], GoalStatus),
                _counts([mutant.outcome for mutant in mutants], MutantStatus),
            )
        )
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for id, tests, ticks, met, killed in rows:
        cells = (
            id.ljust(widths[0]),
            tests.rjust(widths[1]),
            ticks.rjust(widths[2]),
            met.ljust(widths[3]),
            killed,
        )
        yield f"  {'  '.join(cells[:columns])}".rstrip()


def _counts(outcomes: Sequence[str], kinds: type[GoalStatus] | type[MutantStatus]) -> str:
    """`14 met, 2 impossible`."""
    found = ((sum(outcome == kind for outcome in outcomes), kind) for kind in kinds)
    return ", ".join(f"{count} {kind}" for count, kind in found if count)


# What no test shows -----------------------------------------------------------------------------


def _remarks(suite: Suite) -> Iterator[Line]:
    lost = dict(_lost(suite))
    for id, why in lost.items():
        yield f"{signs.UNKNOWN.glyph} {id}: not searched: {why}", signs.UNKNOWN.colour
    for situation in _by_situation(suite):
        if situation[0].requirement not in lost:
            yield from _unmet(situation)
    for mutant in suite.mutants:
        if mutant.requirement not in lost:
            yield from _surviving(mutant)
    yield from _uncertainties(suite)


def _lost(suite: Suite) -> Iterator[tuple[str, str]]:
    """Requirements without a search for the same reason, and the reason."""
    for requirement in suite.requirements:
        reasons = {
            obligation.why
            for obligation in suite.obligations
            if obligation.requirement == requirement.id
        }
        reasons |= {mutant.why for mutant in suite.mutants if mutant.requirement == requirement.id}
        if len(reasons) == 1 and "" not in reasons:
            yield requirement.id, reasons.pop()


def _uncertainties(suite: Suite) -> Iterator[Line]:
    """Tests with possibly impossible values, with one of the reasons."""
    uncertain = [requirement for requirement in suite.requirements if requirement.doubt]
    if uncertain:
        ids = listed([each.id for each in uncertain])
        text = f"some tests of {ids} may have impossible values: {uncertain[0].doubt}"
        yield f"{signs.SUSPECT.glyph} {text}", signs.SUSPECT.colour


def _by_situation(suite: Suite) -> list[list[GoalResult]]:
    groups: dict[tuple[str, str], list[GoalResult]] = {}
    for obligation in suite.obligations:
        groups.setdefault((obligation.requirement, obligation.situation), []).append(obligation)
    return [*groups.values()]


def _unmet(obligations: Sequence[GoalResult]) -> Iterator[Line]:
    """Results of one situation, on satisfying runs and on violating runs."""
    first = obligations[0]
    for outcome, sign, how in (
        (GoalStatus.IMPOSSIBLE, signs.UNUSED, "no run shows this"),
        (GoalStatus.EXCLUDED, signs.UNUSED, f"not with {listed(first.by)}"),
        (GoalStatus.NOT_SEARCHED, signs.UNKNOWN, f"not searched: {first.why}"),
    ):
        if all(
            (obligation.outcome, obligation.by, obligation.why) == (outcome, first.by, first.why)
            for obligation in obligations
        ):
            yield f"{sign.glyph} {first.requirement}: {how}: {first.words}", sign.colour
            return
    for each in obligations:
        head = f"{each.requirement} {each.polarity}"
        if each.outcome is GoalStatus.EXCLUDED:
            text = f"{head}: not with {listed(each.by)}: {each.words}"
            yield f"{signs.UNUSED.glyph} {text}", signs.UNUSED.colour
        elif each.outcome is GoalStatus.NOT_SEARCHED:
            text = f"{head}: not searched: {each.why}: {each.words}"
            yield f"{signs.UNKNOWN.glyph} {text}", signs.UNKNOWN.colour


def _surviving(mutant: MutantResult) -> Iterator[Line]:
    head = f"{mutant.requirement}: {mutant.words}"
    match mutant.outcome:
        case MutantStatus.KILLED:
            return
        case MutantStatus.EQUIVALENT:
            yield f"{signs.EMPTY.glyph} {head} is equivalent", signs.EMPTY.colour
        case MutantStatus.EXCLUDED:
            text = f"{head} is equivalent as long as {listed(mutant.by)}"
            verb = "is" if len(mutant.by) == 1 else "are"
            yield f"{signs.EMPTY.glyph} {text} {verb} satisfied", signs.EMPTY.colour
        case MutantStatus.NOT_SEARCHED:
            yield f"{signs.UNKNOWN.glyph} {head}: not searched: {mutant.why}", signs.UNKNOWN.colour


# Tests of one requirement -----------------------------------------------------------------------


def shown(
    suite: Suite,
    id: str,
    names: Sequence[str],
    roles: Mapping[str, Role],
    wordings: Mapping[str, str],
) -> Iterator[Line]:
    """The tests of a requirement, tick by tick.

    Args:
        suite: all tests.
        id: id of the requirement.
        names: its atoms and variables, which are the rows.
        roles: roles of those that have one.
        wordings: atoms with another label than their name.
    """
    tested = next(requirement for requirement in suite.requirements if requirement.id == id)
    yield f"{id}  {tested.sentence}", None
    if tested.kept:
        yield f"  its tests also satisfy {listed(tested.kept)}", None
    for test in suite.tests:
        if test.requirement == id:
            yield "", None
            yield from _test(test, names, roles, wordings)


def _test(
    test: Test, names: Sequence[str], roles: Mapping[str, Role], wordings: Mapping[str, str]
) -> Iterator[Line]:
    sign = _SIGNS[test.verdict]
    yield f"{sign.glyph} {test.name}: {test.verdict}", sign.colour
    yield f"  {test.words}", None
    lanes = [name for name in names if any(name in row.values for row in test.rows)]
    play = [
        {wordings.get(name, name): row.values.get(name, "") for name in lanes}
        for row in test.rows
        for _ in range(row.count)
    ]
    for row in drawn(play, roles):
        yield f"    {row}", None
    yield f"  {test.because}", None
