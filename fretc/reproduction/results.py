"""Recheck of evidence: the hashes of the logs and the verdicts are computed again.

All results are computed from the present logs and requirements, with the integrity level that the
results claim, and compared exactly with the evidence. Only paths and line numbers of the bindings
may differ, and whether a default is written out.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace as changed
from functools import lru_cache, partial
from pathlib import Path

from compiler.files.build_id import __version__
from compiler.files.records import plain, replace
from compiler.files.text_files import file_sha256
from fretc.audit.evidence.claim import AuditedRequirement
from fretc.audit.evidence.estimates import estimates
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.result_summaries import summary_of
from fretc.audit.evidence.schema import EvidenceDocument, RequirementRecord, Result
from fretc.audit.evidence.schema import LogFinding as OfLog
from fretc.audit.evidence.verdict_inputs import BINDINGS, KINDS, SENTENCE, of_all, outdated, why
from fretc.audit.many_logs import Engine, audit_logs, named_situations
from fretc.audit.plan import Plan, monitored_requirements
from fretc.logs.labels import path_label
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.storage.log_names import name_of, path_of
from fretc.reproduction.completeness import ComparisonScope, incomplete
from fretc.reproduction.manifest import Manifest, matches
from fretc.reproduction.outcome import ALL_RUNS, FILE, ItemOutcome, Recheck, differs, unknown
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.formulas.sentences import parse
from fretish.printer import canonical

Results = Mapping[tuple[str, str], Result]
"""(run, requirement) → result."""


def located(runs: Sequence[str], folder: str | None) -> dict[str, str]:
    """Run → present path of its log: its recorded path, or the file of that name in a folder.

    A run whose log is not found is left out. Of several files with the name, the one with the
    longest common end of the path is used.
    """
    places: dict[str, str] = {}
    for run in runs:
        log = path_of(run)
        path = log if folder is None else _below(Path(folder), log)
        if path is not None and ("://" in path or Path(path).exists()):
            places[run] = path
    return places


def _below(folder: Path, log: str) -> str | None:
    name = Path(log).name
    here = [path for path in sorted(folder.rglob("*")) if path.name == name]
    return str(max(here, key=lambda path: _common_parts(path, Path(log)))) if here else None


def _common_parts(path: Path, log: Path) -> int:
    """The number of equal path components from the end."""
    pairs = zip(reversed(path.parts), reversed(log.parts), strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), len(log.parts))


def recheck(
    document: EvidenceDocument,
    plan: Plan,
    places: Mapping[str, str],
    engine: Engine,
    scope: ComparisonScope,
    manifest: Manifest | None = None,
) -> tuple[Recheck, ...] | Diagnostic:
    """Compute every result of evidence again and compare.

    Args:
        document: the evidence.
        plan: the present audit plan.
        places: run → present path of its log.
        engine: runs the audits.
        scope: the required requirements and runs.
        manifest: the required logs; None if there is no manifest.

    Returns:
        The recheck of the file itself, of each result in the order of the file, and of the
        probabilities over all runs; or why the engine gave up.
    """
    document = _part(document, scope) if scope.part else document
    results = _results_now(document.results, plan, places, engine)
    if isinstance(results, Diagnostic):
        return results
    listed = matches(document, manifest, places) if manifest is not None else ()
    hashed = frozenset(match.run for match in listed if not match.differences)
    now = _Now(plan, places, results, document.bindings.file, hashed)
    return (
        *_beginning(document, plan, part=scope.part),
        *(_result(result, now) for result in document.results),
        *incomplete(document, scope, places, partial(_prints, plan)),
        *(difference for match in listed for difference in match.differences),
        *_log_findings(document, now),
        *_estimates_again(document, now, scope.claimed),
    )


def _part(document: EvidenceDocument, scope: ComparisonScope) -> EvidenceDocument:
    """The part of the evidence about the selected requirements."""
    ids = {*scope.claimed}
    return replace(
        document,
        requirements=tuple(
            requirement for requirement in document.requirements if requirement.id in ids
        ),
        results=tuple(result for result in document.results if result.requirement in ids),
        probabilities=tuple(
            probability
            for probability in _probabilities(document)
            if probability.requirement in ids
        ),
    )


def _probabilities(document: EvidenceDocument) -> tuple[Estimated, ...]:
    return document.probabilities or ()


def _results_now(
    results_before: Sequence[Result], plan: Plan, places: Mapping[str, str], engine: Engine
) -> Results | Diagnostic:
    """The present results of each run with a log, at the integrity level of the evidence."""
    claimed = {result.run: _integrity(result) for result in reversed(results_before)}
    results: dict[tuple[str, str], Result] = {}
    for integrity in Integrity:
        runs = [run for run, one in claimed.items() if one is integrity and run in places]
        if not runs:
            continue
        logs = list(dict.fromkeys(places[run] for run in runs))
        audit = audit_logs(changed(plan, integrity=integrity), logs, engine)
        if isinstance(audit, Diagnostic):
            return audit
        results_of_audit = {(result.run, result.requirement): result for result in audit.results}
        results |= {
            (run, claim.id): results_of_audit[name_of(places[run]), claim.id]
            for run in runs
            for claim in plan.claims
        }
    return results


def _integrity(result: Result) -> Integrity:
    """The integrity level that a result claims."""
    checked, hashes = result.health.checked, result.hashes
    if "log" not in hashes and "log_summary" in hashes:
        return Integrity.INDEX
    return Integrity.FULL if checked is not None and not checked.by_index else Integrity.HASH


def _prints(plan: Plan, location: str) -> frozenset[str]:
    """The SHA-256 values of a log: of the whole file, and of its summary."""
    signals = tuple(plan.declarations.signals)
    levels = (Integrity.INDEX, Integrity.HASH)
    recordings = [read(location, plan.declarations, signals, level) for level in levels]
    hashes = [recording.sha256 for recording in recordings if not isinstance(recording, Diagnostic)]
    return frozenset(filter(None, (*hashes, file_sha256(location))))


# The file as a whole ----------------------------------------------------------------------------

_DOUBT = (0.5, 0.999)
"""Confidence levels that an audit accepts: above the first, up to the second."""


def _beginning(document: EvidenceDocument, plan: Plan, *, part: bool) -> Iterator[Recheck]:
    """Compare the head of the file; also check that there are results."""
    claims = {claim.id: claim for claim in plan.claims}
    named = [requirement.id for requirement in document.requirements]
    bound = of_all({id: claims[id].verdict_inputs[BINDINGS] for id in named if id in claims})
    if not document.results:
        yield unknown(FILE, "", "it contains no run")
    if document.fretc != __version__:
        yield differs(FILE, "", f"the installed fretc is {__version__}")
    if document.bindings.sha256 != bound and not part:
        yield differs(FILE, "", "the bindings have changed")
    for requirement in document.requirements:
        claim = claims.get(requirement.id)
        if claim is None:
            yield differs(FILE, requirement.id, "it is no longer claimed")
        elif not _same_sentence(requirement, claim):
            yield differs(FILE, requirement.id, "the sentence has changed")
        elif requirement.situations != named_situations(claim):
            yield differs(FILE, requirement.id, "its situations have changed")


def _same_sentence(before: RequirementRecord, now: AuditedRequirement) -> bool:
    """Whether wording and hash of the sentence are equivalent to the present ones."""
    return before.sha256 == now.verdict_inputs[SENTENCE] and _wording(before.sentence) == _wording(
        now.sentence
    )


def _wording(sentence: str) -> str:
    """The canonical wording; the text itself if it is not a sentence."""
    tree = parse(Source("evidence", sentence).span())
    return sentence if isinstance(tree, Diagnostic) else canonical(tree)


def _estimates_again(
    document: EvidenceDocument, now: _Now, ids: Collection[str]
) -> Iterator[Recheck]:
    """Compute the estimate of each requirement with a probability again, from the same runs."""
    estimates_before = {
        probability.requirement: probability for probability in _probabilities(document)
    }
    count = Counter(probability.requirement for probability in _probabilities(document))
    named = {*ids, *(requirement.id for requirement in document.requirements)}
    runs = dict.fromkeys(result.run for result in document.results)
    for claim in now.plan.claims:
        if claim.chance is None or claim.id not in {*estimates_before, *named}:
            continue
        one = estimates_before.pop(claim.id, None)
        if one is None:
            yield differs(ALL_RUNS, claim.id, "its estimate over all runs is missing from the file")
        elif count[claim.id] > 1:
            yield differs(ALL_RUNS, claim.id, "it appears twice")
        elif any(run not in now.places for run in runs):
            yield unknown(ALL_RUNS, claim.id, "a log was not found")
        else:
            results = [now.results[run, claim.id] for run in runs]
            why = _estimate_difference(one, claim, results)
            finding = ItemOutcome.DIFFERS if why else ItemOutcome.STANDS
            yield Recheck(ALL_RUNS, claim.id, finding, (why,) if why else ())
    for id in estimates_before:
        yield differs(ALL_RUNS, id, "a probability is no longer claimed for it")


def _estimate_difference(
    before: Estimated, claim: AuditedRequirement, results: Sequence[Result]
) -> str:
    """The difference between an estimate and the present one, or ""."""
    least, most = _DOUBT
    if not least < before.confidence <= most:
        return f"its confidence is not above {least} and at most {most}"
    (now,) = estimates([claim], [*map(summary_of, results)], before.confidence)
    if before.answer != now.answer:
        return f"the answer is {now.answer} now, and was {before.answer}"
    others = _different_keys(plain(before), plain(now))
    return f"it differs in {', '.join(others)}" if others else ""


# One result -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Now:
    """The present results of the logs."""

    plan: Plan
    places: Mapping[str, str]
    """Run → path of its log."""
    results: Results
    bindings: str
    """The name of the bindings file in the evidence."""
    hashed: Collection[str]
    """Runs whose bytes agree with a manifest."""


def _result(before: Result, now: _Now) -> Recheck:
    run, requirement = before.run, before.requirement
    if run not in now.places:
        return unknown(run, requirement, "its log was not found")
    result = now.results.get((run, requirement))
    if result is None:
        return differs(run, requirement, "it is no longer claimed")
    reasons = tuple(_differences(before, result, now.plan))
    if reasons:
        return differs(run, requirement, *reasons)
    if "log" in before.hashes or run in now.hashed:
        return Recheck(run, requirement, ItemOutcome.STANDS, ())
    if "log_summary" in before.hashes:
        return unknown(run, requirement, "its log was read by its index and was not hashed")
    return unknown(run, requirement, "its log cannot be identified: the evidence has no hash of it")


def _differences(before: Result, now: Result, plan: Plan) -> Iterator[str]:
    if any(before.hashes.get(name) != now.hashes.get(name) for name in _OF_LOG):
        yield "the log has changed"
    yield from map(why, outdated(before.hashes, {kind: now.hashes[kind] for kind in KINDS}))
    if before.verdict != now.verdict:
        yield f"the verdict is {now.verdict} now, and was {before.verdict}"
    others = _different_keys(plain(before), plain(now), _COMPARED_APART)
    healths = plain(before.health), plain(now.health)
    others.extend(f"health.{name}" for name in _different_keys(*healths, _FINDINGS))
    others.extend(f"hashes.{name}" for name in _different_keys(before.hashes, now.hashes, _REASONS))
    if not _same_assumptions(before, now, plan):
        others.append("assumptions")
    if not _same_labels(before, now, plan):
        others.append("labels")
    if others:
        yield f"it differs in {', '.join(others)}"


_OF_LOG = ("log", "log_summary")
_REASONS = (*_OF_LOG, *KINDS)
"""Hashes whose difference is reported with a specific reason."""
_FINDINGS = ("findings",)
"""The findings of a log are about its run, not about one result of it."""
_COMPARED_APART = {"run", "requirement", "verdict", "hashes", "health", "assumptions", "labels"}
"""Fields that are compared separately."""


def _different_keys(
    before: Mapping[str, object], now: Mapping[str, object], except_for: Collection[str] = ()
) -> list[str]:
    """The keys whose values differ, exactly: `1` is neither `1.0` nor `true`."""
    keys = sorted({*before, *now} - {*except_for})
    return [key for key in keys if _letters(before, key) != _letters(now, key)]


def _letters(value: Mapping[str, object], key: str) -> str:
    """The JSON text of a field; "" if the field is missing, in contrast to null."""
    return json.dumps(value[key], sort_keys=True) if key in value else ""


def _same_labels(before: Result, now: Result, plan: Plan) -> bool:
    """Whether the labels are equal; a label from the path may be from the path at the audit."""
    own, other = before.labels or {}, now.labels or {}
    if own.keys() != other.keys():
        return False
    different = [name for name in own if own[name] != other[name]]
    declared = plan.declarations.labels
    return all(
        name not in plan.labels
        and own[name] in path_label(name, declared.get(name, ()), before.run)
        for name in different
    )


def _same_assumptions(before: Result, now: Result, plan: Plan) -> bool:
    """Whether the assumptions are equal; a default may be implicit or written in the bindings."""
    own, other = {*before.assumptions}, {*now.assumptions}
    defaults = _written_defaults(plan)[now.requirement] if now.clock else frozenset()
    return len(own) == len(before.assumptions) and own ^ other <= defaults


@lru_cache(maxsize=4)
def _written_defaults(plan: Plan) -> Mapping[str, frozenset[str]]:
    """Requirement → the defaults of its inputs that the bindings may write out."""
    return {
        claim.id: frozenset(
            default.text
            for default in plan.declarations.restricted_to(each.propositions).defaults
            if default.is_explicit is not None
        )
        for claim, each in zip(plan.claims, monitored_requirements(plan), strict=True)
    }


# Findings of a log ------------------------------------------------------------------------------


def _log_findings(document: EvidenceDocument, now: _Now) -> Iterator[Recheck]:
    """Compare the findings about each run, over all requirements."""
    results_of: dict[str, list[Result]] = {}
    for result in document.results:
        results_of.setdefault(result.run, []).append(result)
    of_now = {run: result for (run, _), result in now.results.items()}
    for run, results in results_of.items():
        if run not in of_now:
            continue
        bindings = now.plan.declarations.source.name
        findings = _findings(of_now[run], now.places[run], bindings)
        if any(_findings(result, run, now.bindings) != findings for result in results):
            yield differs(run, "", "the findings about its log differ")


def _findings(result: Result, log: str, bindings: str) -> list[OfLog | tuple[str, OfLog]]:
    """Findings without paths and line numbers, which may change."""

    def same_place(finding: OfLog) -> OfLog | tuple[str, OfLog]:
        place = finding.file
        if place == bindings:
            return "the bindings", replace(finding, file=None, line=None, column=None)
        if place is not None and place.startswith(log):
            return "the log", replace(finding, file=place.removeprefix(log))
        return finding

    return [same_place(finding) for finding in result.health.findings]
