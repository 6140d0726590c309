"""The difference between a project and its lock: changes, verdicts, contradictions, links."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from compiler.project.folder import Project
from compiler.project.stated_numbers import drifted
from fretc.audit.evidence.verdicts import VERDICTS, severity
from fretc.report.traceability.chain import VERDICT, Suspect
from fretc.report.traceability.changes import Change
from fretc.report.traceability.lock import Lock, Review, Standing
from fretish.diagnostics.diagnostic import Code
from monitors import kernel

_MOST = 6
"""The most runs of one requirement with other verdicts that `text` names."""


@dataclass(frozen=True, slots=True)
class Difference:
    """One requirement in both states."""

    requirement: str
    state: str
    """`same`, `changed`, `new` (only now) or `gone` (only in the baseline)."""
    review: Review | None
    changes: tuple[Change, ...]
    contradictions: tuple[str, ...]
    """What beside the changes has stayed as it was, and says something else."""
    verdicts: tuple[tuple[str, str, str], ...]
    """Run, verdict in the baseline, verdict now; an empty word: none. The worst now comes first."""
    outdated: int
    """Verdicts on what it was before a change."""
    suspects: tuple[Suspect, ...]
    has_other_texts: bool = False
    """The texts of the review are not those of its fingerprints."""

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
            lines.append(f"{_verdicts(self.outdated)} {verb} of before the change: audit again")
        return tuple(lines)

    @property
    def suspicion(self) -> str:
        """`5 links are suspect`; empty where there is none."""
        count = len(self.suspects)
        return f"{count} {'link is' if count == 1 else 'links are'} suspect" if count else ""


def _counts(words: Sequence[str]) -> list[tuple[str, int]]:
    return sorted(Counter(words).items(), key=lambda pair: _severity(pair[0]))


def _severity(word: str) -> tuple[int, bool]:
    """By which words are sorted, the worst first; a lock may have one that is no verdict."""
    return severity(word) if word in VERDICTS else (len(VERDICTS), False)


def _in_words(words: Sequence[str]) -> str:
    return ", ".join(f"{count} {word}" for word, count in _counts(words))


def _verdicts(count: int) -> str:
    return f"{count} verdict{'' if count == 1 else 's'}"


def _runs(count: int) -> str:
    return "1 run is" if count == 1 else f"{count} runs are"


def differences(
    standings: tuple[Standing, ...], baseline: Lock, project: Project | None = None
) -> tuple[Difference, ...]:
    """Every requirement of either state, in the order of the project, then those that are gone."""
    now = tuple(difference(standing, project) for standing in standings)
    ids = {standing.chain.requirement for standing in standings}
    return (*now, *(_removed(id, baseline) for id in baseline.reviews if id not in ids))


def difference(standing: Standing, project: Project | None = None) -> Difference:
    """One requirement, against its review; `new` where it has none.

    Args:
        standing: the requirement beside its review.
        project: whose numbers are compared with its words; None: no contradiction is looked for.
    """
    chain, review = standing.chain, standing.review
    if review is None:
        verdicts = _different({}, chain.verdicts)
        return Difference(chain.requirement, "new", None, (), (), verdicts, 0, ())
    verdicts = _different(review.verdicts, chain.verdicts)
    is_changed = bool(standing.changes or verdicts or standing.suspects)
    return Difference(
        chain.requirement,
        "changed" if is_changed else "same",
        review,
        standing.changes,
        contradictions(standing, project) if standing.changes and project else (),
        verdicts,
        sum(node.kind == VERDICT for node in chain.outdated) if standing.changes else 0,
        standing.suspects,
        standing.has_other_texts,
    )


def _removed(id: str, baseline: Lock) -> Difference:
    review = baseline.reviews[id]
    return Difference(id, "gone", review, (), (), _different(review.verdicts, {}), 0, ())


def _different(
    before: Mapping[str, str], now: Mapping[str, str]
) -> tuple[tuple[str, str, str], ...]:
    pairs = [(run, before.get(run, ""), now.get(run, "")) for run in {*before, *now}]
    return tuple(sorted((pair for pair in pairs if pair[1] != pair[2]), key=_worst_first))


def _worst_first(pair: tuple[str, str, str]) -> tuple[bool, tuple[int, bool], str]:
    """Runs that are gone come after what is known now."""
    return not pair[2], _severity(pair[2] or pair[1]), pair[0]


# Contradictions --------------------------------------------------------------------------------


def contradictions(standing: Standing, project: Project) -> tuple[str, ...]:
    """The words of a requirement that state another number than what is judged.

    One that has stood there since the review `still` does.
    """
    id = standing.chain.requirement
    then = standing.review.texts if standing.review else None
    now = standing.chain.texts
    found = []
    for rule in project.rules:
        if rule.id != id or rule.declarations is None:
            continue
        for field, words in drifted(rule, rule.declarations):
            same = then is not None and getattr(then, field) == getattr(now, field, None)
            verb = "state" if field == "params" else "say"
            still = "still " if same else ""
            subject = "`params`" if field == "params" else f"its {field}"
            found.append(f"{subject} {still}{verb}{'' if field == 'params' else 's'} {words}")
    for failed in project.failed:
        if failed.requirement.id == id:
            drifts = (each for each in failed.diagnostics if each.code is Code.NUMBER_DRIFT)
            found.extend(each.message for each in drifts)
    return tuple(dict.fromkeys(found))


# Plain values and text -------------------------------------------------------------------------


def as_record(difference: Difference) -> dict[str, Any]:
    """Plain values, in a fixed order of keys."""
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


def text(differences: Sequence[Difference]) -> Iterator[str]:
    """Lines for a person: each requirement that is not as it was, then how many are."""
    same = [each.requirement for each in differences if each.state == "same"]
    for each in differences:
        if each.state != "same":
            yield from _text(each)
    if same:
        named = ", ".join(same[:_MOST])
        more = f" and {len(same) - _MOST} more" if len(same) > _MOST else ""
        yield f"{named}{more}  as {'it was' if len(same) == 1 else 'they were'} reviewed"


def _text(difference: Difference) -> Iterator[str]:
    review = difference.review
    by = f"the review of {review.date} by {review.reviewer}" if review else ""
    states = {
        "changed": f"changed since {by}",
        "new": "not reviewed",
        "gone": f"not there any more; there is {by}",
    }
    yield f"{difference.requirement}  {states[difference.state]}"
    for change in difference.changes:
        yield f"  {change.text}"
    if difference.has_other_texts:
        yield f"  {OTHER_TEXTS}"
    for line in difference.contradictions:
        yield f"  {line}"
    yield from _verdict_lines(difference)
    if difference.suspicion:
        yield f"  {difference.suspicion}"


OTHER_TEXTS = "the texts in its review are not those of its fingerprints, and do not count"


def _verdict_lines(difference: Difference) -> Iterator[str]:
    """What became of verdicts; then runs by name, no violated one without being counted."""
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
