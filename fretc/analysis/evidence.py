"""Analysis results as evidence: `build/analysis.json`, and whether it is up to date.

The file is not trusted: a verdict that does not follow from its findings is F503.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Final, Literal

from compiler.files import records
from compiler.files.build_id import __version__
from compiler.files.records import Name, Record, Sha256, about, json_schema
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from fretc.analysis.arena.roles import role
from fretc.analysis.findings import Analysis, RealizabilityVerdict
from fretc.analysis.reasons import listed
from fretish.bindings import canonical
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.printer import sentence as printed

SCHEMA: Final = "fretc-analyzed-set-1"
DEFAULT = "build/analysis.json"
"""Default path of the output of `fretc analyze`."""


class AnalyzedRequirement(Record, frozen=True):
    """A requirement or an assumption when it was analyzed."""

    sentence: Annotated[str, about("in FRETish")]
    sha256: Annotated[
        Sha256,
        about(
            "SHA-256 of everything that the analysis reads: formulas, ticks, the bindings of its "
            "names, their types and roles"
        ),
    ]


class AnalysisDocument(Record, frozen=True):
    """Content of `build/analysis.json`."""

    schema: Literal["fretc-analyzed-set-1"]
    fretc: Annotated[str, about("version of the tool")]
    as_fret: Annotated[
        bool, about("whether FRET's question was answered: `eventually` means at once")
    ]
    requirements: Annotated[
        dict[Name, AnalyzedRequirement], about("the requirements that were analyzed, by their ids")
    ]
    assumptions: Annotated[
        dict[Name, AnalyzedRequirement], about("what the environment was assumed to satisfy")
    ]
    analysis: Analysis


def schema() -> dict[str, Any]:
    """The JSON Schema of the file."""
    return json_schema(
        AnalysisDocument,
        SCHEMA,
        "Which requirements were analyzed, and what was found, as `fretc analyze` writes it",
        "Nothing in it depends on when or where it was made.",
    )


def document(
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
    analysis: Analysis,
    *,
    as_fret: bool,
) -> AnalysisDocument:
    """The evidence of an analysis of these requirements, without its times."""
    untimed = tuple(records.replace(each, seconds=records.UNSET) for each in analysis.components)
    return AnalysisDocument(
        SCHEMA,
        __version__,
        as_fret,
        members(requirements),
        members(assumptions),
        records.replace(analysis, components=untimed),
    )


def members(requirements: Sequence[FormalizedRequirement]) -> dict[str, AnalyzedRequirement]:
    """Present requirements or assumptions, by id."""
    return {
        requirement.id: AnalyzedRequirement(printed(requirement.written), _digest(requirement))
        for requirement in requirements
    }


def _digest(requirement: FormalizedRequirement) -> str:
    """SHA-256 of everything that the analysis reads of a requirement."""
    declared = requirement.declarations
    return canonical.digest(
        {
            "meaning": requirement.fingerprint,
            "formulas": [
                str(each)
                for each in (requirement.ft_infinite, requirement.ft_finite, requirement.pt)
            ],
            "ticks": requirement.ticks,
            "bound": canonical.bound(declared, requirement.propositions) if declared else None,
            "roles": {name: str(role(requirement, name)) for name in requirement.variables},
            "types": {
                name: requirement.glossary[name].type
                for name in requirement.variables
                if name in requirement.glossary
            },
        }
    )


def suspicions(
    known: AnalysisDocument,
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
) -> Iterator[str]:
    """Reasons why an analysis is out of date: added, removed or changed requirements.

    Args:
        known: the evidence.
        requirements: the present active requirements.
        assumptions: the present assumptions.
    """
    if known.as_fret:
        yield "it answers FRET's question, in which `eventually` means at once"
    yield from changes(known, requirements, assumptions)


def changes(
    known: AnalysisDocument,
    requirements: Sequence[FormalizedRequirement],
    assumptions: Sequence[FormalizedRequirement],
) -> Iterator[str]:
    """Added, removed and changed requirements since an analysis."""
    yield from _changes(known.requirements, members(requirements), "")
    yield from _changes(known.assumptions, members(assumptions), "assumption ")


def _changes(
    then: Mapping[str, AnalyzedRequirement], now: Mapping[str, AnalyzedRequirement], what: str
) -> Iterator[str]:
    for id in (*then, *(each for each in now if each not in then)):
        if id not in now:
            yield f"{what}{id} is no longer part of the set"
        elif id not in then:
            yield f"{what}{id} was not part of the set"
        elif then[id] != now[id]:
            yield f"{what}{id} has changed since"


def remarks(
    analysis: Analysis, requirements: Sequence[FormalizedRequirement]
) -> Iterator[Diagnostic]:
    """F561 for each conflict; F562 if realizability is unknown."""
    places = {requirement.id: requirement.entry.wording for requirement in requirements}
    for each in analysis.conflicts:
        ids = each.requirements
        what = (
            "cannot be satisfied by any system" if len(ids) == 1 else "cannot be satisfied together"
        )
        yield diagnostic(
            "unrealizable_requirements",
            places.get(ids[0]),
            requirements=listed(ids),
            what=what,
            because=each.because,
        )
    if analysis.verdict is RealizabilityVerdict.UNREALIZABLE and not analysis.conflicts:
        yield diagnostic("unrealizable_set", why=analysis.why)
    if analysis.verdict is RealizabilityVerdict.NOT_CHECKED:
        yield diagnostic("not_analyzed", why=analysis.why)


# Files ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class AnalyzedSet:
    """A complete file, with its name and SHA-256."""

    file: str
    sha256: str
    document: AnalysisDocument


def read(path: str) -> AnalyzedSet | Diagnostic:
    """Read and check a file of `fretc analyze`."""
    again = "analyze again: `fretc analyze FILE...`"
    file = records.read(path, AnalysisDocument, "fretc analyze", again)
    if isinstance(file, Diagnostic):
        return file
    source, content = file
    mistake = _contradiction(content)
    if mistake:
        span = Source(source.name, "").span()
        what = f"contradicts itself: {mistake}"
        return diagnostic("bad_result_file", span, path=source.name, what=what, help=again)
    return AnalyzedSet(source.name, sha256(source.text), content)


def known(path: str | None) -> AnalyzedSet | Diagnostic | None:
    """The analysis of a file, or of the default file if it exists; None: there is none."""
    file = path or default_path()
    return read(file) if file is not None else None


def default_path() -> str | None:
    """Default path of the analysis, if the file exists."""
    return DEFAULT if Path(DEFAULT).exists() else None


def _contradiction(document: AnalysisDocument) -> str:
    """Why the verdict does not follow from the findings; empty if it does."""
    analysis = document.analysis
    ids = document.requirements.keys()
    named = {id for each in analysis.components for id in each.requirements}
    named |= {id for each in analysis.conflicts for id in each.requirements}
    if not named <= ids:
        return f"it is not about `{min(named - ids)}`"
    shown = {
        id
        for each in analysis.components
        if each.verdict is RealizabilityVerdict.REALIZABLE
        for id in each.requirements
    }
    if analysis.conflicts or any(
        component.verdict is RealizabilityVerdict.UNREALIZABLE for component in analysis.components
    ):
        follows = RealizabilityVerdict.UNREALIZABLE
    else:
        follows = (
            RealizabilityVerdict.REALIZABLE if ids <= shown else RealizabilityVerdict.NOT_CHECKED
        )
    if analysis.verdict is follows:
        return ""
    return f"the verdict is `{analysis.verdict}`, but its parts imply `{follows}`"
