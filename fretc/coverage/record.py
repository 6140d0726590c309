"""JSON output of `fretc coverage`: requirements, situations, and the runs that show them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated, Any, Final, Literal

from compiler.files.build_id import __version__
from compiler.files.records import Count, Name, Record, Seconds, Whole, about, json_schema, plain
from compiler.files.templating import to_json
from fretc.audit.evidence.schema import Moment
from fretc.coverage import coverage as c
from fretc.coverage.directions import Directions

SCHEMA: Final = "fretc-coverage-1"


class Sighting(Record, frozen=True):
    """The first tick of a run that shows, or may show, a situation."""

    run: Annotated[Count, about("index of the run, from 0")]
    tick: Count
    ns: Whole
    seconds: Seconds


class CoveredSituation(Record, frozen=True):
    """A way in which a run can meet a requirement."""

    key: Name
    words: Annotated[str, about("for people")]
    standing: Annotated[
        Literal["seen", "perhaps", "never", "not measured"],
        about("status over all runs; perhaps: depends on unknown values"),
    ]
    seen: Annotated[
        tuple[Sighting, ...], about("one entry for each run that certainly shows the situation")
    ]
    perhaps: Annotated[
        tuple[Sighting, ...], about("one entry for each other run that may show the situation")
    ]
    direction: Annotated[
        str | None,
        about(
            "inputs of a run that shows the situation, or why there is none; null: seen, or not "
            "searched"
        ),
    ]


class CoveredRequirement(Record, frozen=True):
    """A requirement of the audit."""

    id: Name
    situations: Annotated[
        tuple[CoveredSituation, ...], about("empty: the situations were not measured")
    ]
    measured: Annotated[tuple[Count, ...], about("indices of the runs that were measured")]
    unmeasured: Annotated[
        tuple[Count, ...], about("indices of the runs that were not, or could not be, measured")
    ]


class CoverageDocument(Record, frozen=True):
    """The JSON document."""

    schema: Literal["fretc-coverage-1"]
    fretc: Annotated[str, about("version of the tool")]
    runs: Annotated[tuple[str, ...], about("the logs, as the user named them")]
    requirements: tuple[CoveredRequirement, ...]
    least_runs: Annotated[
        tuple[Count, ...],
        about("indices of runs that together show every situation that all runs show"),
    ]
    least_is_exact: Annotated[
        bool, about("whether it is proved that no smaller set of runs shows them")
    ]


def text(covered: c.Coverage, known: Directions = MappingProxyType({})) -> str:
    """The JSON document as text; equal values give equal bytes."""
    return f"{to_json(plain(document(covered, known)))}\n"


def document(covered: c.Coverage, known: Directions) -> CoverageDocument:
    """The JSON document of a coverage, with directions to unseen situations."""
    return CoverageDocument(
        schema=SCHEMA,
        fretc=__version__,
        runs=covered.runs,
        requirements=tuple(
            CoveredRequirement(
                requirement.id,
                tuple(
                    _situation(requirement.id, situation, known)
                    for situation in requirement.situations
                ),
                requirement.measured,
                requirement.unmeasured,
            )
            for requirement in covered.requirements
        ),
        least_runs=covered.least.runs,
        least_is_exact=covered.least.is_exact,
    )


def _situation(id: str, one: c.RecordedSituation, known: Directions) -> CoveredSituation:
    seen, perhaps = _sightings(one.seen), _sightings(one.perhaps)
    known_direction = None if one.status is c.CoverageStatus.SEEN else known.get((id, one.key))
    direction = None if known_direction is None else known_direction.text
    return CoveredSituation(one.key, one.words, one.status.value, seen, perhaps, direction)


def _sightings(moments: Mapping[int, Moment]) -> tuple[Sighting, ...]:
    return tuple(Sighting(run, m.tick, m.ns, m.seconds) for run, m in sorted(moments.items()))


def schema() -> dict[str, Any]:
    """The JSON Schema of coverage."""
    return json_schema(
        CoverageDocument,
        SCHEMA,
        "What recorded runs have exercised, as `fretc coverage --format json` prints it",
        "Seconds count from the first tick of a run, ticks from 0; `ns` is the time of the log.",
    )
