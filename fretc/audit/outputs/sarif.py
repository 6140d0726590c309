"""Results of an audit as SARIF 2.1.0, which code scanning services and editors show.

A requirement is a rule, and each run gives one result of it, at its sentence.

Sources: OASIS, SARIF Version 2.1.0; GitHub, SARIF support for code scanning.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

from compiler.files.edition import __version__
from compiler.files.templating import to_json
from compiler.formalization.formalized import Formalized
from compiler.formalization.record import wording
from fretc.audit.evidence import verdicts
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import Result
from fretc.audit.evidence.verdicts import CURRENT, SUSPECT, Level
from fretc.audit.outputs.violated_values import reason
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Span
from fretish.documents import Requirement
from fretish.meaning import meaning

_SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
_ROOT = "%SRCROOT%"
"""What relative paths start from, as GitHub calls it: the folder in which fretc ran."""
_RESERVED = "%/:?#[]@!$&'()*+,;="
"""What has a meaning in an address, and what is quoted in it already."""
_LEVELS: Mapping[Level, Mapping[str, str]] = {
    Level.NONE: {"kind": "pass", "level": "none"},
    Level.WARNING: {"kind": "fail", "level": "warning"},
    Level.ERROR: {"kind": "fail", "level": "error"},
}
"""What is not shown is not `open`, which has no level and which services do not show."""
_COUNTED = {"kind": "informational", "level": "none"}
"""A run that alone decides nothing: its triggers are counted with those of all others."""


@dataclass(frozen=True, slots=True)
class OneRun:
    """A result with its verdict, and the reasons why that is suspect."""

    result: Result
    verdict: str
    suspicions: tuple[str, ...] = ()

    @staticmethod
    def of(result: Result) -> OneRun:
        """What an audit has just found."""
        return OneRun(result, result.verdict)


@dataclass(frozen=True, slots=True)
class AllRuns:
    """What all runs together say of a requirement, and why that does not count, if it does not."""

    requirement: str
    answer: str
    text: str
    suspicions: tuple[str, ...] = ()

    @staticmethod
    def of(one: Estimated) -> AllRuns:
        """What an audit has just found."""
        return AllRuns(one.requirement, one.answer, "; ".join((one.reason, *one.lines[1:])))


def sarif(
    results: Sequence[OneRun],
    rules: Sequence[Formalized],
    diagnostics: Sequence[Diagnostic] = (),
    estimates: Sequence[AllRuns] = (),
    failed: Sequence[Requirement] = (),
) -> str:
    """One SARIF run; the same inputs give the same bytes.

    Args:
        results: each of a run and a requirement, in declared units, in the order of the evidence.
        rules: all requirements of the results; others are left out.
        diagnostics: what there is to say of the logs.
        estimates: requirements that are judged over all runs: each gives one more result.
        failed: requirements without a rule.
    """
    ids = dict.fromkeys(one.result.requirement for one in results)
    named = {r.id: r for r in (*(rule.requirement for rule in rules), *failed)}
    rules_of_results = [requirement for id, requirement in named.items() if id in ids]
    by_id = {rule.id: rule for rule in rules}
    files = _files(results, rules_of_results)
    content = {
        "tool": {"driver": _driver(rules_of_results, by_id, diagnostics)},
        "invocations": [_invocation(diagnostics)],
        "artifacts": list(files.values()),
        "columnKind": "unicodeCodePoints",
        "results": [
            *(_result(one, rules_of_results, list(files)) for one in results),
            *(_result_of_all(one, rules_of_results, list(files)) for one in estimates),
        ],
    }
    return f"{to_json({'$schema': _SCHEMA, 'version': '2.1.0', 'runs': [content]})}\n"


def _driver(
    used: Sequence[Requirement], rules: Mapping[str, Formalized], diagnostics: Sequence[Diagnostic]
) -> dict[str, Any]:
    codes = {diagnostic.code.number: diagnostic.code for diagnostic in diagnostics}
    return {
        "name": "fretc",
        "semanticVersion": __version__,
        "rules": [_rule(each, rules.get(each.id)) for each in used],
        "notifications": [
            {"id": number, "shortDescription": {"text": codes[number].summary}}
            for number in sorted(codes)
        ],
    }


def _rule(requirement: Requirement, rule: Formalized | None) -> dict[str, Any]:
    """A requirement; without a rule nothing says what it means."""
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


def _files(results: Sequence[OneRun], used: Sequence[Requirement]) -> dict[str, dict[str, Any]]:
    """Each file by its name: the logs, and where the sentences are."""
    files: dict[str, dict[str, Any]] = {}
    for one in results:
        run = one.result.run
        artifact = files.setdefault(run, {"location": _place(run), "roles": ["analysisTarget"]})
        size, sha256 = one.result.health.size, one.result.hashes.get("log")
        artifact |= {"length": size} if size is not None else {}
        artifact |= {"hashes": {"sha-256": sha256}} if sha256 else {}
    for requirement in used:
        name = requirement.wording.source.name
        files.setdefault(name, {"location": _place(name), "sourceLanguage": "fretish"})
    return files


def _result(one: OneRun, used: Sequence[Requirement], files: Sequence[str]) -> dict[str, Any]:
    result, suspicions = one.result, one.suspicions
    level = _LEVELS[verdicts.level(one.verdict, suspect=bool(suspicions))]
    message = f"{result.run}: {one.verdict}: {reason(result)}{_because(suspicions)}"
    return _at_sentence(result.requirement, result.run, used, files) | {
        **(level if result.trials is None else _COUNTED),
        "message": {"text": message},
        "analysisTarget": _place(result.run) | {"index": files.index(result.run)},
        "properties": {
            "verdict": one.verdict,
            "currency": _currency(suspicions),
            "sha256": dict(result.hashes),
        },
    }


def _result_of_all(
    one: AllRuns, used: Sequence[Requirement], files: Sequence[str]
) -> dict[str, Any]:
    return _at_sentence(one.requirement, "", used, files) | {
        **_LEVELS[verdicts.level(one.answer, suspect=bool(one.suspicions))],
        "message": {"text": f"all runs: {one.answer}: {one.text}{_because(one.suspicions)}"},
        "properties": {"answer": one.answer, "currency": _currency(one.suspicions)},
    }


def _because(suspicions: Sequence[str]) -> str:
    return f"; {SUSPECT}, because {'; '.join(suspicions)}" if suspicions else ""


def _currency(suspicions: Sequence[str]) -> str:
    return SUSPECT if suspicions else CURRENT


def _at_sentence(
    id: str, run: str, used: Sequence[Requirement], files: Sequence[str]
) -> dict[str, Any]:
    """What every result of a requirement has; `run` is empty for all of them together."""
    (number,) = (i for i, requirement in enumerate(used) if requirement.id == id)
    span = used[number].wording
    where = _place(span.source.name) | {"index": files.index(span.source.name)}
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
    where: dict[str, Any] = {"artifactLocation": _place(span.source.name)}
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


def _place(path: str) -> dict[str, Any]:
    """A relative address below the folder in which fretc runs, an absolute one elsewhere."""
    if "://" in path:
        return {"uri": quote(path, safe=_RESERVED)}
    inside = os.path.relpath(path)
    if inside == os.pardir or inside.startswith(os.pardir + os.sep):
        return {"uri": Path(os.path.abspath(path)).as_uri()}
    return {"uri": quote(os.fsencode(inside)), "uriBaseId": _ROOT}
