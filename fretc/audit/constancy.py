"""Propositions that never change in the logs: what they are bound to may be wrong."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence

from fretc.audit.evidence.schema import Result
from fretc.audit.measurements.tallies import NOTHING, Tally
from fretish.bindings.declarations import Declarations
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity


def tallies_of(results: Sequence[Result]) -> dict[str, list[Tally]]:
    """Of each proposition its tally in each run, from the results of an audit.

    A proposition of several requirements counts once in each run.
    """
    tallies: dict[str, dict[str, Tally]] = {}
    for result in results:
        for name, counts in result.propositions.items():
            tallies.setdefault(name, {})[result.run] = counts
    return {name: list(runs.values()) for name, runs in tallies.items()}


def never_changed(
    tallies: Mapping[str, Sequence[Tally]],
    declarations: Declarations,
    diagnostics: Iterable[Diagnostic] = (),
) -> Iterator[Diagnostic]:
    """F314 for each proposition that changed in none of the runs.

    Args:
        tallies: of each declared proposition one for each run.
        declarations: where it points to.
        diagnostics: of the runs. Where one is an error in the bindings (no such topic, no such
            field), propositions that were unknown throughout get no other diagnostic.
    """
    source = declarations.source.name
    explained = any(d.is_error and d.span and d.span.source.name == source for d in diagnostics)
    for name, tallies_of_runs in tallies.items():
        total = sum(tallies_of_runs, NOTHING)
        if total.changes or not total.true + total.false + total.unknown:
            continue
        if explained and not total.true + total.false:
            continue
        runs = "the log" if len(tallies_of_runs) == 1 else f"any of {len(tallies_of_runs)} logs"
        yield Diagnostic(
            Code.NEVER_CHANGED,
            f"`{name}` never changed in {runs}: {_always(total)}",
            declarations.propositions[name].span,
            help="check its path, its unit and its bound, or audit a run in which it should change",
            severity=Severity.NOTE,
        )


def _always(total: Tally) -> str:
    parts = [
        f"{word} at {count} tick{'' if count == 1 else 's'}"
        for word, count in (
            ("true", total.true),
            ("false", total.false),
            ("unknown", total.unknown),
        )
        if count
    ]
    return "it was " + ", ".join(parts)
