"""Propositions that never change in the logs: their bindings may be wrong."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from fretc.audit.evidence.schema import Result
from fretc.audit.measurements.tallies import NOTHING, PropositionTally
from fretc.audit.measurements.unknown_inputs import without_brackets
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic


@dataclass(frozen=True, slots=True)
class PropositionTotal:
    """The ticks of a proposition in some runs."""

    ticks: PropositionTally
    runs: int


def totals(runs: Iterable[Mapping[str, PropositionTally]]) -> dict[str, PropositionTotal]:
    """The total of each proposition.

    Args:
        runs: the tally of each proposition in each run.
    """
    of_name: dict[str, list[PropositionTally]] = {}
    for tallies in runs:
        for name, tally in tallies.items():
            of_name.setdefault(name, []).append(tally)
    return {name: PropositionTotal(sum(some, NOTHING), len(some)) for name, some in of_name.items()}


def tallies_of(results: Iterable[Result]) -> dict[str, PropositionTally]:
    """The tally of each proposition in one run, from all results of the run."""
    return {name: counts for result in results for name, counts in result.propositions.items()}


def never_changed(
    of_all: Mapping[str, PropositionTotal],
    declarations: Declarations,
    diagnostics: Iterable[Diagnostic] = (),
) -> Iterator[Diagnostic]:
    """F314 for each proposition that changed in none of the runs.

    Args:
        of_all: the total of each declared proposition over all runs.
        declarations: the source of the places in the diagnostics.
        diagnostics: the diagnostics of the runs. If one is an error in the bindings (a missing
            topic or field), propositions that were unknown throughout get no second diagnostic.
    """
    source = declarations.source.name
    explained = any(d.is_error and d.span and d.span.source.name == source for d in diagnostics)
    for name, of_runs in of_all.items():
        total = of_runs.ticks
        if total.changes or not total.true + total.false + total.unknown:
            continue
        if explained and not total.true + total.false:
            continue
        runs = "the log" if of_runs.runs == 1 else f"any of {of_runs.runs} logs"
        yield diagnostic(
            "never_changed",
            declarations.propositions[name].span,
            name=without_brackets(name),
            runs=runs,
            values=_always(total),
        )


def _always(total: PropositionTally) -> str:
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
