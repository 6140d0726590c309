"""The difference between a project and its lock: changes, verdicts, contradictions, links."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from compiler.project.project import Project
from compiler.project.stated_numbers import drifted
from fretc.audit.evidence.verdicts import VERDICTS, severity
from fretc.traceability.chain import ANALYSIS, VERDICT
from fretc.traceability.changes import ReviewChange
from fretc.traceability.lock import Lock, Review, ReviewStatus
from fretc.traceability.suspects import Suspect
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code
from monitors import kernel

_MOST = 6
"""Maximum number of runs with changed verdicts that `text` names per requirement."""
_NAMED = 3
"""Maximum number of changes that are named as causes of suspect links."""


@dataclass(frozen=True, slots=True)
class ReviewDifference:
    """The difference between a requirement and its review."""

    requirement: str
    state: str
    """`same`, `changed`, `new` (only now) or `gone` (only in the baseline)."""
    review: Review | None
    changes: tuple[ReviewChange, ...]
    contradictions: tuple[str, ...]
    """Unchanged texts that contradict the changed ones."""
    verdicts: tuple[tuple[str, str, str], ...]
    """(run, verdict in the baseline, verdict now), worst first; "" for no verdict."""
    outdated: int
    """Number of verdicts from before the change."""
    suspects: tuple[Suspect, ...]
    has_other_texts: bool = False
    """Whether the texts of the review do not match its fingerprints."""
    has_old_analysis: bool = False
    """Whether the analysis is from before a change of its requirements or assumptions."""

    @property
    def consequences(self) -> tuple[str, ...]:
        """`14 verdicts became violated`, `2 became satisfied`, and so on."""
        both = [(then, now) for _, then, now in self.verdicts if then and now]
        new = [now for _, then, now in self.verdicts if not then]
        gone = [then for _, then, now in self.verdicts if not now]
        became = _counts([now for _, now in both])
        lines = [f"{_verdicts(count)} became {word}" for word, count in became]
        lines += [f"{_runs(len(new))} new: {_in_words(new)}"] if new and self.state != "new" else []
        lines += [f"{_runs(len(gone))} gone: {_in_words(gone)}"] if gone else []
        if self.outdated:
            verb = "is" if self.outdated == 1 else "are"
            lines.append(f"{_verdicts(self.outdated)} {verb} from before the change: audit again")
        if self.has_old_analysis:
            lines.append("the realizability result is from before the change: analyze again")
        return tuple(lines)

    @property
    def suspicion(self) -> str:
        """`5 links are suspect: max_age of x changed`; "" if no link is suspect."""
        return suspicion_of([self])


def suspicion_of(differences: Sequence[ReviewDifference]) -> str:
    """The number of suspect links of all these requirements, with the causes."""
    suspects = [suspect for each in differences for suspect in each.suspects]
    reasons = (
        change.what
        for each in differences
        for change in each.changes
        if any(map(change.makes_suspect, each.suspects))
    )
    named = [*dict.fromkeys(reasons)]
    names = [*named[:_NAMED], *([f"{len(named) - _NAMED} more"] if len(named) > _NAMED else [])]
    why = f": {', '.join(names)} changed" if names else ""
    count = len(suspects)
    return f"{count} {'link is' if count == 1 else 'links are'} suspect{why}" if count else ""


def _counts(words: Sequence[str]) -> list[tuple[str, int]]:
    return sorted(Counter(words).items(), key=lambda pair: _severity(pair[0]))


def _severity(word: str) -> tuple[int, bool]:
    """Sort key of verdicts, worst first; a lock may contain a word that is not a verdict."""
    return severity(word) if word in VERDICTS else (len(VERDICTS), False)


def _in_words(words: Sequence[str]) -> str:
    return ", ".join(f"{count} {word}" for word, count in _counts(words))


def _verdicts(count: int) -> str:
    return f"{count} verdict{'' if count == 1 else 's'}"


def _runs(count: int) -> str:
    return "1 run is" if count == 1 else f"{count} runs are"


def differences(
    statuses: tuple[ReviewStatus, ...], baseline: Lock, project: Project | None = None
) -> tuple[ReviewDifference, ...]:
    """The difference of each requirement, in the order of the project; removed ones come last."""
    now = tuple(difference(status, project) for status in statuses)
    ids = {status.chain.requirement for status in statuses}
    return (*now, *(_removed(id, baseline) for id in baseline.reviews if id not in ids))


def difference(status: ReviewStatus, project: Project | None = None) -> ReviewDifference:
    """The difference between a requirement and its review; `new` if it has no review.

    Args:
        status: the requirement with its review.
        project: for contradictions between numbers and words; None: they are not searched.
    """
    chain, review = status.chain, status.review
    if review is None:
        verdicts = _different({}, chain.verdicts)
        return ReviewDifference(chain.requirement, "new", None, (), (), verdicts, 0, ())
    verdicts = _different(review.verdicts, chain.verdicts)
    is_changed = bool(status.changes or verdicts or status.suspects)
    return ReviewDifference(
        chain.requirement,
        "changed" if is_changed else "same",
        review,
        status.changes,
        contradictions(status, project) if status.changes and project else (),
        verdicts,
        sum(node.kind == VERDICT for node in chain.outdated) if status.changes else 0,
        status.suspects,
        status.has_other_texts,
        any(node.kind == ANALYSIS for node in chain.outdated),
    )


def _removed(id: str, baseline: Lock) -> ReviewDifference:
    review = baseline.reviews[id]
    return ReviewDifference(id, "gone", review, (), (), _different(review.verdicts, {}), 0, ())


def _different(
    before: Mapping[str, str], now: Mapping[str, str]
) -> tuple[tuple[str, str, str], ...]:
    pairs = [(run, before.get(run, ""), now.get(run, "")) for run in {*before, *now}]
    return tuple(sorted((pair for pair in pairs if pair[1] != pair[2]), key=_worst_first))


def _worst_first(pair: tuple[str, str, str]) -> tuple[bool, tuple[int, bool], str]:
    """Sort key of changed verdicts; removed runs come last."""
    return not pair[2], _severity(pair[2] or pair[1]), pair[0]


# Contradictions --------------------------------------------------------------------------------


def contradictions(status: ReviewStatus, project: Project) -> tuple[str, ...]:
    """Texts of a requirement that state another number than its sentence or parameters.

    A text that has not changed since the review "still" says so.
    """
    id = status.chain.requirement
    then = status.review.texts if status.review else None
    now = status.chain.texts
    fields: dict[tuple[str, bool], list[str]] = {}
    for requirement in project.formalized:
        if requirement.id == id and requirement.declarations is not None:
            for field, words in drifted(requirement, requirement.declarations):
                same = then is not None and getattr(then, field) == getattr(now, field)
                fields.setdefault((words, same), []).append(_FIELDS[field])
    statements = [_statement(names, words, same) for (words, same), names in fields.items()]
    for failed in project.failed:
        if failed.requirement.id == id:
            drifts = (
                diagnostic
                for diagnostic in failed.diagnostics
                if diagnostic.code is Code.NUMBER_DRIFT
            )
            statements.extend(drift.message for drift in drifts)
    return tuple(dict.fromkeys(statements))


_FIELDS = {"title": "its title", "text": "its text", "params": "its `params`"}


def _statement(fields: Sequence[str], words: str, still: bool) -> str:
    *first, last = dict.fromkeys(fields)
    named = f"{', '.join(first)} and {last}" if first else last
    verb = "say" if first or last == _FIELDS["params"] else "says"
    return f"{named} {'still ' if still else ''}{verb} {words}"


# Plain values and text -------------------------------------------------------------------------


def as_record(difference: ReviewDifference) -> dict[str, Any]:
    """The difference as plain values, in a fixed order of keys."""
    return {
        "requirement": difference.requirement,
        "state": difference.state,
        "reviewed": difference.review.date if difference.review else None,
        "changes": [change.as_record for change in difference.changes],
        "contradictions": list(difference.contradictions),
        "consequences": list(difference.consequences),
        "texts_of_the_review": "not its own" if difference.has_other_texts else "its own",
        "suspect_links": [
            {
                "from": str(suspect.link.source),
                "to": str(suspect.link.target),
                "because_of": [str(cause) for cause in suspect.causes],
            }
            for suspect in difference.suspects
        ],
        "verdicts": [
            {"run": run, "before": before or None, "now": now or None}
            for run, before, now in difference.verdicts
        ],
    }


def text(differences: Sequence[ReviewDifference]) -> Iterator[str]:
    """Lines for a person: changed requirements, each change once, then unchanged ones."""
    alike: dict[object, list[ReviewDifference]] = {}
    for each in differences:
        alike.setdefault(_likeness(each), []).append(each)
    for group in sorted(alike.values(), key=lambda group: group[0].state == "same"):
        yield from _text(group)


def _likeness(difference: ReviewDifference) -> object:
    """A key that is equal for requirements with equal changes and no changed verdict."""
    if difference.state == "same":
        return "same"
    if difference.verdicts or difference.state != "changed" or difference.review is None:
        return difference.requirement
    by = (difference.review.date, difference.review.reviewer)
    changes = tuple(change.text for change in difference.changes)
    others = (difference.contradictions, difference.outdated, difference.has_other_texts)
    return (by, changes, difference.has_old_analysis, *others)


def _text(group: Sequence[ReviewDifference]) -> Iterator[str]:
    first, review = group[0], group[0].review
    by = f"the review of {review.date} by {review.reviewer}" if review else ""
    states = {
        "same": f"as {'it was' if len(group) == 1 else 'they were'} reviewed",
        "changed": f"changed since {by}",
        "new": "not reviewed",
        "gone": f"in {by}, but no longer in the project",
    }
    named = ", ".join(each.requirement for each in group[:_MOST])
    more = f" and {len(group) - _MOST} more" if len(group) > _MOST else ""
    yield f"{named}{more}  {states[first.state]}"
    if first.state == "same":
        return
    for change in first.changes:
        yield f"  {change.text}"
    if first.has_other_texts:
        yield f"  {OTHER_TEXTS}"
    for line in first.contradictions:
        yield f"  {line}"
    yield from _verdict_lines(first)
    suspicion = suspicion_of(group)
    if suspicion:
        yield f"  {suspicion}"


OTHER_TEXTS = "the texts in its review do not match its fingerprints, and are ignored"


def _verdict_lines(difference: ReviewDifference) -> Iterator[str]:
    """Lines about changed verdicts, then the runs; violated runs that are not named are counted."""
    for line in difference.consequences:
        yield f"  {line}"
    for run, before, now in difference.verdicts[:_MOST]:
        yield f"    {run}: {before or 'none'} → {now or 'none'}"
    left = difference.verdicts[_MOST:]
    if left:
        violated = sum(now == kernel.VIOLATED for _, _, now in left)
        yield f"    and {_runs(len(left)).removesuffix(' is').removesuffix(' are')} more" + (
            f", {violated} of them violated" if violated else ""
        )
