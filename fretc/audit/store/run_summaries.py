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
    PartialRecord,
    ResultSummary,
    RunFacts,
    SharedFacts,
    facts_of_parts,
    summary_of_part,
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


def run_summary(results: Sequence[Result]) -> RunSummary:
    """The summary of a run.

    Args:
        results: all results of the run, at least one.
    """
    return summary_of_parts(results, results[0])


def summary_of_parts(
    results: Sequence[Result | CountedResult], shared: Result | SharedFacts
) -> RunSummary:
    """The summary of a run.

    Args:
        results: all results of the run, at least one.
        shared: what they have in common; any whole result has it.
    """
    return RunSummary(
        facts_of_parts(results, shared),
        tuple(summary_of_part(each, shared) for each in results),
        {name: tally for each in results for name, tally in each.propositions.items()},
    )


class _Facts(PartialRecord, frozen=True):
    facts: RunFacts


def facts_from(text: bytes) -> RunFacts:
    """The facts of a run, from the JSON of its summary.

    Raises:
        SchemaError: it has none.
    """
    return decoded_json(text, _Facts).facts


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
