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
    found: dict[str, dict[str, Tally]] = {}
    for result in results:
        for name, counts in result.propositions.items():
            found.setdefault(name, {})[result.run] = counts
    return {name: list(runs.values()) for name, runs in found.items()}


def never_changed(
    tallies: Mapping[str, Sequence[Tally]],
    declarations: Declarations,
    said: Iterable[Diagnostic] = (),
) -> Iterator[Diagnostic]:
    """F314 for each proposition that changed in none of the runs.

    Args:
        tallies: of each declared proposition one for each run.
        declarations: where it points to.
        said: what is told of the runs; where an error is in the bindings (no such topic, no such
            field), propositions that were unknown throughout are not told again.
    """
    source = declarations.source.name
    explained = any(d.is_error and d.span and d.span.source.name == source for d in said)
    for name, counted in tallies.items():
        whole = sum(counted, NOTHING)
        if whole.changes or not whole.true + whole.false + whole.unknown:
            continue
        if explained and not whole.true + whole.false:
            continue
        runs = "the log" if len(counted) == 1 else f"any of {len(counted)} logs"
        yield Diagnostic(
            Code.NEVER_CHANGED,
            f"`{name}` never changed in {runs}: {_always(whole)}",
            declarations.propositions[name].span,
            help="check its path, its unit and its bound, or audit a run in which it should change",
            severity=Severity.NOTE,
        )


def _always(whole: Tally) -> str:
    parts = [
        f"{word} at {count} tick{'' if count == 1 else 's'}"
        for word, count in (
            ("true", whole.true),
            ("false", whole.false),
            ("unknown", whole.unknown),
        )
        if count
    ]
    return "it was " + ", ".join(parts)
