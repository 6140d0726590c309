"""Results of an audit as SARIF 2.1.0, for code scanning services and editors.

A requirement is a rule of SARIF, and each run that does not show it gives one result, at its
sentence. A run that shows it gives none.

Sources: OASIS, SARIF Version 2.1.0; GitHub, SARIF support for code scanning.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any
from urllib.parse import quote

from compiler.files.build_id import PACKAGE, __version__
from compiler.files.settings import repository
from compiler.files.templating import to_json
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import wording
from fretc.audit.evidence import verdicts
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import Result
from fretc.audit.evidence.verdicts import CURRENT, SUSPECT, MessageLevel
from fretc.audit.outputs.violated_values import reason
from fretc.logs.storage.log_names import path_of
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Span
from fretish.documents import RequirementEntry
from fretish.meaning import meaning
from monitors import kernel

_SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
_ROOT = "%SRCROOT%"
"""The base of relative paths, as GitHub names it."""
_ROOT_MEANING = "the root of the repository, or the folder in which fretc ran outside of one"
_RESERVED = "%/:?#[]@!$&'()*+,;="
"""The reserved characters of an address, and the percent sign."""


@dataclass(frozen=True, slots=True)
class OneRun:
    """A result with its verdict, and the reasons why the verdict is suspect."""

    result: Result
    verdict: str
    suspicions: tuple[str, ...] = ()

    @staticmethod
    def of(result: Result) -> OneRun:
        """The result of the present audit, which is not suspect."""
        return OneRun(result, result.verdict)

    @property
    def level(self) -> MessageLevel:
        """The level; a run that alone decides nothing counts with all others, in `AllRuns`."""
        if self.result.trials is not None and self.result.verdict != kernel.NO_DATA:
            return MessageLevel.NONE
        return verdicts.level(self.verdict, suspect=bool(self.suspicions))


@dataclass(frozen=True, slots=True)
class AllRuns:
    """The answer of all runs for a requirement, and the reasons why it is suspect."""

    requirement: str
    answer: str
    text: str
    suspicions: tuple[str, ...] = ()

    @staticmethod
    def of(one: Estimated) -> AllRuns:
        """The answer of the present audit, which is not suspect."""
        return AllRuns(one.requirement, one.answer, "; ".join((one.reason, *one.lines[1:])))

    @property
    def level(self) -> MessageLevel:
        """The level of the answer."""
        return verdicts.level(self.answer, suspect=bool(self.suspicions))


def sarif(
    results: Sequence[OneRun],
    rules: Sequence[FormalizedRequirement],
    diagnostics: Sequence[Diagnostic] = (),
    estimates: Sequence[AllRuns] = (),
    failed: Sequence[RequirementEntry] = (),
) -> str:
    """One SARIF run; equal inputs give equal bytes.

    Args:
        results: one for each run and requirement, in declared units, in the order of the evidence.
        rules: all requirements of the results; others are left out.
        diagnostics: the diagnostics of the logs.
        estimates: the answers of all runs: each gives one more result.
        failed: requirements that could not be formalized.
    """
    shown_results = [result for result in results if result.level is not MessageLevel.NONE]
    of_all = [estimate for estimate in estimates if estimate.level is not MessageLevel.NONE]
    ids = {one.result.requirement for one in shown_results} | {one.requirement for one in of_all}
    named = {r.id: r for r in (*(rule.entry for rule in rules), *failed)}
    occurring = [requirement for id, requirement in named.items() if id in ids]
    by_id = {rule.id: rule for rule in rules}
    files = _files(shown_results, occurring)
    places = _Places(
        {requirement.id: number for number, requirement in enumerate(occurring)},
        {name: number for number, name in enumerate(files)},
        occurring,
    )
    content = {
        "tool": {"driver": _driver(occurring, by_id, diagnostics)},
        "invocations": [_invocation(diagnostics)],
        "originalUriBaseIds": {_ROOT: {"description": {"text": _ROOT_MEANING}}},
        "artifacts": list(files.values()),
        "columnKind": "unicodeCodePoints",
        "results": [
            *(_result(one, places) for one in shown_results),
            *(_result_of_all(one, places) for one in of_all),
        ],
    }
    return f"{to_json({'$schema': _SCHEMA, 'version': '2.1.0', 'runs': [content]})}\n"


@dataclass(frozen=True, slots=True)
class _Places:
    """The indices of rules and files in their lists."""

    rules: Mapping[str, int]
    files: Mapping[str, int]
    requirements: Sequence[RequirementEntry]


def _driver(
    used: Sequence[RequirementEntry],
    rules: Mapping[str, FormalizedRequirement],
    diagnostics: Sequence[Diagnostic],
) -> dict[str, Any]:
    codes = {diagnostic.code.number: diagnostic.code for diagnostic in diagnostics}
    return {
        "name": "fretc",
        "semanticVersion": __version__,
        "informationUri": PACKAGE,
        "rules": [_rule(each, rules.get(each.id)) for each in used],
        "notifications": [
            {"id": number, "shortDescription": {"text": codes[number].summary}}
            for number in sorted(codes)
        ],
    }


def _rule(requirement: RequirementEntry, rule: FormalizedRequirement | None) -> dict[str, Any]:
    """The SARIF rule of a requirement."""
    sentence = wording(requirement)
    words = meaning(rule.written, rule.ticks, rule.clock) if rule else ""
    paragraphs = [words, requirement.text, requirement.rationale]
    return {
        "id": requirement.id,
        "shortDescription": {"text": requirement.title or sentence},
        "fullDescription": {"text": sentence},
        "help": {"text": "\n\n".join(text for text in paragraphs if text) or sentence},
        "defaultConfiguration": {"level": "error"},
        "properties": {
            **({"sha256": rule.fingerprint} if rule else {}),
            "parents": list(requirement.parents),
        },
    }


def _files(
    results: Sequence[OneRun], used: Sequence[RequirementEntry]
) -> dict[str, dict[str, Any]]:
    """Each file by its name: the logs, and the files with the sentences."""
    files: dict[str, dict[str, Any]] = {}
    for result in results:
        run = result.result.run
        artifact = files.setdefault(
            run, {"location": _place(path_of(run)), "roles": ["analysisTarget"]}
        )
        size, sha256 = result.result.health.size, result.result.hashes.get("log")
        artifact |= {"length": size} if size is not None else {}
        artifact |= {"hashes": {"sha-256": sha256}} if sha256 else {}
    for requirement in used:
        name = requirement.wording.source.name
        files.setdefault(name, {"location": _place(name), "sourceLanguage": "fretish"})
    return files


def _result(one: OneRun, places: _Places) -> dict[str, Any]:
    result, suspicions = one.result, one.suspicions
    message = f"{result.run}: {one.verdict}: {reason(result)}{_because(suspicions)}"
    return _at_sentence(result.requirement, result.run, places) | {
        "kind": "fail",
        "level": one.level.value,
        "message": {"text": message},
        "analysisTarget": _place(path_of(result.run)) | {"index": places.files[result.run]},
        "properties": {
            "verdict": one.verdict,
            "currency": _currency(suspicions),
            "sha256": dict(result.hashes),
        },
    }


def _result_of_all(one: AllRuns, places: _Places) -> dict[str, Any]:
    return _at_sentence(one.requirement, "", places) | {
        "kind": "fail",
        "level": one.level.value,
        "message": {"text": f"all runs: {one.answer}: {one.text}{_because(one.suspicions)}"},
        "properties": {"answer": one.answer, "currency": _currency(one.suspicions)},
    }


def _because(suspicions: Sequence[str]) -> str:
    return f"; {SUSPECT}, because {'; '.join(suspicions)}" if suspicions else ""


def _currency(suspicions: Sequence[str]) -> str:
    return SUSPECT if suspicions else CURRENT


def _at_sentence(id: str, run: str, places: _Places) -> dict[str, Any]:
    """The fields that all results of a requirement share; `run` is empty for all runs together."""
    number = places.rules[id]
    span = places.requirements[number].wording
    where = _place(span.source.name) | {"index": places.files[span.source.name]}
    same = hashlib.sha256(f"{id}\n{run}".encode()).hexdigest()
    return {
        "ruleId": id,
        "ruleIndex": number,
        "locations": [{"physicalLocation": {"artifactLocation": where, "region": _region(span)}}],
        # GitHub takes two results with the same first one for the same alert.
        "partialFingerprints": {
            "primaryLocationLineHash": f"{same[:16]}:1",
            "requirementAndRun/v1": same,
        },
    }


def _invocation(diagnostics: Sequence[Diagnostic]) -> dict[str, Any]:
    return {
        "executionSuccessful": not any(diagnostic.is_error for diagnostic in diagnostics),
        "toolExecutionNotifications": [
            {
                "descriptor": {"id": diagnostic.code.number},
                "level": diagnostic.severity.value,
                "message": {"text": diagnostic.message},
                **_locations(diagnostic.span),
                **(
                    {"properties": {"accepted": diagnostic.accepted}} if diagnostic.accepted else {}
                ),
            }
            for diagnostic in diagnostics
        ],
    }


def _locations(span: Span | None) -> dict[str, Any]:
    if span is None:
        return {}
    where: dict[str, Any] = {"artifactLocation": _place(path_of(span.source.name))}
    if span.source.text:
        where["region"] = _region(span)
    return {"locations": [{"physicalLocation": where}]}


def _region(span: Span) -> dict[str, int]:
    end = span.source.span(span.end, span.end)
    return {
        "startLine": span.line,
        "startColumn": span.column,
        "endLine": end.line,
        "endColumn": end.column,
    }


@lru_cache(maxsize=1)
def _root(here: Path) -> Path:
    return repository(here) or here


def _place(path: str) -> dict[str, Any]:
    """The address of a file: relative below the root, absolute elsewhere."""
    if "://" in path:
        return {"uri": quote(path, safe=_RESERVED)}
    inside = os.path.relpath(path, _root(Path.cwd()))
    if inside == os.pardir or inside.startswith(os.pardir + os.sep):
        return {"uri": Path(os.path.abspath(path)).as_uri()}
    return {"uri": quote(os.fsencode(inside)), "uriBaseId": _ROOT}
