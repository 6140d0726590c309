"""Evidence of runs that came by some situations."""

from collections.abc import Mapping

from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.schema import (
    SCHEMA,
    BindingsRecord,
    EvidenceDocument,
    RequirementRecord,
    Result,
    SituationRecord,
    Situations,
)
from tests.fretc.audit.results import SHA, moment, result

KEYS = ("at-once", "late", "never-triggered")
Shown = Mapping[str, int] | None
"""Situation → its first tick, before 0 where it is uncertain; None: not measured."""


def of_run(run: str, shown: Shown, requirement: str = "R1") -> Result:
    known = result(run=run, requirement=requirement)
    if shown is None:
        return known
    seen = {key: moment(tick, tick / 10) for key, tick in shown.items() if tick >= 0}
    perhaps = {key: moment(~tick, ~tick / 10) for key, tick in shown.items() if tick < 0}
    return result(run=run, requirement=requirement, situations=Situations(seen, perhaps))


def evidence(*results: Result, named: bool = True) -> EvidenceFile:
    """Of all of them; without `named` the requirements say of no situation."""
    ids = dict.fromkeys(each.requirement for each in results)
    situations = tuple(SituationRecord(key, f"it is {key}") for key in KEYS)
    requirements = tuple(
        RequirementRecord(
            id, "the sw shall satisfy p", SHA, **({"situations": situations} if named else {})
        )
        for id in ids
    )
    document = EvidenceDocument(
        SCHEMA, "1", BindingsRecord("bindings.toml", SHA), requirements, results
    )
    return EvidenceFile("evidence.json", SHA, document)
