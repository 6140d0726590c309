"""Whether evidence still stands: the hashes of its logs and its verdicts, made again.

Everything is made anew from the logs and the requirements as they are now, each log with the
integrity that its results claim, and compared with what the evidence says, to the letter. Free are
only places (of the bindings, and of lines in them), and whether a default is written out.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from dataclasses import replace as changed
from functools import partial
from pathlib import Path

from compiler.files.edition import __version__
from compiler.files.records import plain, replace
from compiler.files.text_files import file_sha256, sha256
from fretc.audit.evidence.basis import BINDINGS, KINDS, SENTENCE, of_all, outdated, why
from fretc.audit.evidence.claim import Claim
from fretc.audit.evidence.estimates import estimates
from fretc.audit.evidence.probabilities import Estimated
from fretc.audit.evidence.schema import Document, Result
from fretc.audit.evidence.schema import Finding as OfLog
from fretc.audit.many_logs import Engine, audit_logs
from fretc.audit.plan import Plan
from fretc.logs.reader import read
from fretc.logs.signals.integrity import Integrity
from fretc.logs.storage.inputs import shown as called
from fretc.reproduction.completeness import Scope, incomplete
from fretc.reproduction.manifest import Manifest, matches
from fretc.reproduction.outcome import ALL_RUNS, FILE, Finding, Rechecked, differs, unknown
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.parser import parse
from fretish.printer import canonical

Results = Mapping[tuple[str, str], Result]
"""Run and requirement → result."""


def located(runs: Sequence[str], folder: str | None) -> dict[str, str]:
    """Run → where its log is now: its path, or the file of that name below a folder.

    A run whose log is not found is left out; of several files of one name the one whose path ends
    most alike counts.
    """
    found: dict[str, str] = {}
    for run in runs:
        place = run if folder is None else _below(Path(folder), run)
        if place is not None and ("://" in place or Path(place).exists()):
            found[run] = place
    return found


def _below(folder: Path, run: str) -> str | None:
    name = Path(run).name
    here = [path for path in sorted(folder.rglob("*")) if path.name == name]
    return str(max(here, key=lambda path: _alike(path, Path(run)))) if here else None


def _alike(path: Path, run: Path) -> int:
    """How many parts are the same, from the end."""
    pairs = zip(reversed(path.parts), reversed(run.parts), strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), len(run.parts))


def rechecked(
    whole: Document,
    plan: Plan,
    places: Mapping[str, str],
    engine: Engine,
    scope: Scope,
    manifest: Manifest | None = None,
) -> tuple[Rechecked, ...] | Diagnostic:
    """Make every result of evidence again.

    Args:
        whole: the evidence.
        plan: what logs are judged by now.
        places: run → where its log is now.
        engine: where logs are audited.
        scope: which requirements and runs it must have.
        manifest: which logs it must have; None: that is not asked.

    Returns:
        What became of each result, in the order of the file, between what is wrong with the file
        itself and what all runs together say; or why the engine gave up.
    """
    whole = _part(whole, scope) if scope.part else whole
    made = _again(whole.results, plan, places, engine)
    if isinstance(made, Diagnostic):
        return made
    listed = matches(whole, manifest, places) if manifest is not None else ()
    hashed = frozenset(match.run for match in listed if not match.wrong)
    now = _Now(plan, places, made, whole.bindings.file, hashed)
    return (
        *_beginning(whole, plan, part=scope.part),
        *(_result(result, now) for result in whole.results),
        *incomplete(whole, scope, places, partial(_prints, plan)),
        *(one for match in listed for one in match.wrong),
        *_found(whole, now),
        *_together(whole, now, scope.claimed),
    )


def _part(whole: Document, scope: Scope) -> Document:
    """What evidence says of the requirements that are asked for."""
    asked = {*scope.claimed}
    return replace(
        whole,
        requirements=tuple(each for each in whole.requirements if each.id in asked),
        results=tuple(each for each in whole.results if each.requirement in asked),
        probabilities=tuple(each for each in _probabilities(whole) if each.requirement in asked),
    )


def _probabilities(whole: Document) -> tuple[Estimated, ...]:
    return whole.probabilities or ()


def _again(
    told: Sequence[Result], plan: Plan, places: Mapping[str, str], engine: Engine
) -> Results | Diagnostic:
    """The results of each run whose log is found, looked at as closely as the evidence claims."""
    claimed = {result.run: _integrity(result) for result in reversed(told)}
    found: dict[tuple[str, str], Result] = {}
    for integrity in Integrity:
        runs = [run for run, one in claimed.items() if one is integrity and run in places]
        if not runs:
            continue
        logs = list(dict.fromkeys(places[run] for run in runs))
        audit = audit_logs(changed(plan, integrity=integrity), logs, engine)
        if isinstance(audit, Diagnostic):
            return audit
        made = {(one.run, one.requirement): one for one in audit.results}
        found |= {
            (run, claim.id): made[called(places[run]), claim.id]
            for run in runs
            for claim in plan.claims
        }
    return found


def _integrity(result: Result) -> Integrity:
    """How closely its log was looked at, as a result claims."""
    checked, hashes = result.health.checked, result.hashes
    if "log" not in hashes and "log_summary" in hashes:
        return Integrity.INDEX
    return Integrity.FULL if checked is not None and not checked.by_index else Integrity.HASH


def _prints(plan: Plan, place: str) -> frozenset[str]:
    """What tells the log from another one, however closely it is looked at."""
    signals = tuple(plan.declarations.signals)
    levels = (Integrity.INDEX, Integrity.HASH)
    found = [read(place, plan.declarations, signals, level) for level in levels]
    known = [one.sha256 for one in found if not isinstance(one, Diagnostic)]
    return frozenset(filter(None, (*known, file_sha256(place))))


# The file as a whole ----------------------------------------------------------------------------

_DOUBT = (0.5, 0.999)
"""Confidences that an audit takes."""


def _beginning(whole: Document, plan: Plan, *, part: bool) -> Iterator[Rechecked]:
    """What is said before the results, where it is not as it is now; and whether there are any."""
    claims = {claim.id: claim for claim in plan.claims}
    named = [told.id for told in whole.requirements]
    bound = of_all({id: claims[id].basis[BINDINGS] for id in named if id in claims})
    if not whole.results:
        yield unknown(FILE, "", "it tells of no run")
    if whole.fretc != __version__:
        yield differs(FILE, "", f"this is fretc {__version__}")
    if whole.bindings.sha256 != bound and not part:
        yield differs(FILE, "", "what the bindings say has changed")
    for told in whole.requirements:
        claim = claims.get(told.id)
        if claim is None:
            yield differs(FILE, told.id, "it is not claimed any more")
        elif {told.sha256, _meant(told.sentence)} != {claim.basis[SENTENCE]}:
            yield differs(FILE, told.id, "the sentence has changed")


def _meant(sentence: str) -> str:
    """SHA-256 of the canonical wording; empty where it is no sentence."""
    tree = parse(Source("evidence", sentence).span())
    return "" if isinstance(tree, Diagnostic) else sha256(canonical(tree))


def _together(whole: Document, now: _Now, asked: Collection[str]) -> Iterator[Rechecked]:
    """What all runs say of each requirement with a probability, made again of the same runs."""
    told = {one.requirement: one for one in _probabilities(whole)}
    count = Counter(one.requirement for one in _probabilities(whole))
    named = {*asked, *(one.id for one in whole.requirements)}
    runs = dict.fromkeys(result.run for result in whole.results)
    for claim in now.plan.claims:
        if claim.chance is None or claim.id not in {*told, *named}:
            continue
        one = told.pop(claim.id, None)
        if one is None:
            yield differs(ALL_RUNS, claim.id, "what all runs say of it is left out")
        elif count[claim.id] > 1:
            yield differs(ALL_RUNS, claim.id, "it is told twice")
        elif any(run not in now.places for run in runs):
            yield unknown(ALL_RUNS, claim.id, "a log is not found")
        else:
            made = [now.results[run, claim.id] for run in runs]
            why = _estimated_otherwise(one, claim, made)
            finding = Finding.DIFFERS if why else Finding.STANDS
            yield Rechecked(ALL_RUNS, claim.id, finding, (why,) if why else ())
    for id in told:
        yield differs(ALL_RUNS, id, "no probability is claimed of it any more")


def _estimated_otherwise(told: Estimated, claim: Claim, results: Sequence[Result]) -> str:
    """How it differs from what is made now; empty where it does not."""
    least, most = _DOUBT
    if not least < told.confidence <= most:
        return f"its confidence is none above {least} and up to {most}"
    (now,) = estimates([claim], results, told.confidence)
    if told.answer != now.answer:
        return f"the answer is {now.answer}, and was {told.answer}"
    others = _unlike(plain(told), plain(now))
    return f"it differs in {', '.join(others)}" if others else ""


# One result -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class _Now:
    """What is made of the logs now."""

    plan: Plan
    places: Mapping[str, str]
    """Run → where its log is."""
    results: Results
    bindings: str
    """What the evidence calls the file of the bindings."""
    hashed: Collection[str]
    """Runs that all of a manifest is held against."""


def _result(told: Result, now: _Now) -> Rechecked:
    run, requirement = told.run, told.requirement
    if run not in now.places:
        return unknown(run, requirement, "its log is not found")
    found = now.results.get((run, requirement))
    if found is None:
        return differs(run, requirement, "it is not claimed any more")
    reasons = tuple(_differences(told, found, now.plan))
    if reasons:
        return differs(run, requirement, *reasons)
    if "log" in told.hashes or run in now.hashed:
        return Rechecked(run, requirement, Finding.STANDS, ())
    if "log_summary" in told.hashes:
        return unknown(run, requirement, "its log was read by its index, and never hashed")
    return unknown(run, requirement, "nothing tells its log from another one: it has no hash")


def _differences(told: Result, now: Result, plan: Plan) -> Iterator[str]:
    if any(told.hashes.get(name) != now.hashes.get(name) for name in _OF_LOG):
        yield "the log has changed"
    yield from map(why, outdated(told.hashes, {kind: now.hashes[kind] for kind in KINDS}))
    if told.verdict != now.verdict:
        yield f"the verdict is {now.verdict}, and was {told.verdict}"
    others = _unlike(plain(told), plain(now), _APART)
    healths = plain(told.health), plain(now.health)
    others.extend(f"health.{name}" for name in _unlike(*healths, _FOUND))
    others.extend(f"hashes.{name}" for name in _unlike(told.hashes, now.hashes, _REASONS))
    if _assumed(told, plan) != _assumed(now, plan):
        others.append("assumptions")
    if others:
        yield f"it differs in {', '.join(others)}"


_OF_LOG = ("log", "log_summary")
_REASONS = (*_OF_LOG, *KINDS)
"""Hashes whose difference has a reason of its own."""
_FOUND = ("findings",)
"""What is found of a log is about its run."""
_APART = {"run", "requirement", "verdict", "hashes", "health", "assumptions"}
"""What is compared in a way of its own."""


def _unlike(
    told: Mapping[str, object], now: Mapping[str, object], apart: Collection[str] = ()
) -> list[str]:
    """The keys whose values differ, to the letter: `1` is neither `1.0` nor `true`."""
    keys = sorted({*told, *now} - {*apart})
    return [key for key in keys if _letters(told, key) != _letters(now, key)]


def _letters(value: Mapping[str, object], key: str) -> str:
    """Empty where it is not there, which is not the same as null."""
    return json.dumps(value[key], sort_keys=True) if key in value else ""


def _assumed(result: Result, plan: Plan) -> list[str]:
    """Without the defaults: whether one is taken or written out is no difference."""
    defaults = {default.text for default in plan.declarations.defaults}
    told = Counter(result.assumptions)
    return sorted(text for text in told.elements() if text not in defaults or told[text] > 1)


# What is found of a log -------------------------------------------------------------------------


def _found(whole: Document, now: _Now) -> Iterator[Rechecked]:
    """What was found of each run, whichever requirement it is about."""
    told: dict[str, list[Result]] = {}
    for result in whole.results:
        told.setdefault(result.run, []).append(result)
    of_now = {run: result for (run, _), result in now.results.items()}
    for run, results in told.items():
        if run not in of_now:
            continue
        bindings = now.plan.declarations.source.name
        known = _findings(of_now[run], now.places[run], bindings)
        if any(_findings(result, run, now.bindings) != known for result in results):
            yield differs(run, "", "what is found of its log differs")


def _findings(result: Result, log: str, bindings: str) -> list[OfLog | tuple[str, OfLog]]:
    """But for where log and bindings are, and for lines: a comment above moves those."""

    def same_place(finding: OfLog) -> OfLog | tuple[str, OfLog]:
        place = finding.file
        if place == bindings:
            return "the bindings", replace(finding, file=None, line=None, column=None)
        if place is not None and place.startswith(log):
            return "the log", replace(finding, file=place.removeprefix(log))
        return finding

    return [same_place(finding) for finding in result.health.findings]
