"""The summary of a run, which a store keeps beside the record of the run that it is made from.

Queries and counts read it alone. What reads the records compares them with it, so that a summary
that contradicts its record is an error.
"""

from __future__ import annotations

from collections.abc import Sequence

from compiler.files.checked_json import SchemaError
from compiler.files.records import Record, decoded_json, json_bytes
from fretc.audit.evidence.result_summaries import (
    CountedResult,
    ResultSummary,
    RunFacts,
    run_facts,
    summary_of,
)
from fretc.audit.evidence.schema import Result
from fretc.audit.measurements.tallies import PropositionTally


class RunSummary(Record, frozen=True):
    """What is counted of a run."""

    facts: RunFacts
    results: tuple[ResultSummary, ...]
    tallies: dict[str, PropositionTally]
    """The tally of each proposition."""

    @property
    def text(self) -> bytes:
        """Its JSON: equal results give equal bytes."""
        return json_bytes(self)


def run_summary(results: Sequence[Result | CountedResult]) -> RunSummary:
    """The summary of a run.

    Args:
        results: all results of the run, at least one.
    """
    return RunSummary(
        run_facts(results),
        tuple(map(summary_of, results)),
        {name: tally for each in results for name, tally in each.propositions.items()},
    )


def summary_from(text: bytes, results: int) -> RunSummary:
    """The summary of a run, from its JSON.

    Args:
        text: of an untrusted store.
        results: the number of results of the run.

    Raises:
        SchemaError: it is no summary of so many results.
    """
    found = decoded_json(text, RunSummary)
    if len(found.results) != results:
        raise SchemaError("a summary does not have the results of its run")
    return found
