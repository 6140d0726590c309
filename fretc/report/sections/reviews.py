"""Reviews, changes since a review, and waivers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from compiler.project.project import Project
from fretc.attestation.signatures import SignatureBook
from fretc.audit.evidence.verdict_inputs import KINDS
from fretc.audit.evidence.verdicts import SUSPECT
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.changes import (
    ChangeGroup,
    ChangeText,
    RequirementChanges,
    follows,
    new_violations,
    only_change,
)
from fretc.report.model.marks import sign_mark
from fretc.report.model.views import ReviewView, WaiverView
from fretc.report.sections.signatures import of_review, of_waiver
from fretc.traceability.changes import ReviewChange as TextChange
from fretc.traceability.comparison import OTHER_TEXTS, ReviewDifference, difference
from fretc.traceability.lock import Review, WithdrawnRequirement
from fretish.diagnostics import status_symbols as signs

_ACCEPTED = sign_mark("reviewed", signs.GOOD)
_UNSIGNED = sign_mark("reviewed", signs.OPEN)
_OPEN = sign_mark("not reviewed", signs.UNUSED)
_SUSPECT = sign_mark(SUSPECT, signs.SUSPECT)


def review(assessment: Assessment, book: SignatureBook) -> ReviewView:
    """The review of a requirement."""
    accepted = assessment.review_status.review
    if accepted is None:
        return ReviewView(_OPEN, "", "", (), None)
    signature = of_review(book, accepted)
    by = _by(accepted)
    if not assessment.review_status.is_suspect:
        mark = _ACCEPTED if signature.is_good else _UNSIGNED
        return ReviewView(mark, by, accepted.comment, (), signature)
    lines = tuple(change.text for change in assessment.review_status.changes)
    return ReviewView(_SUSPECT, by, accepted.comment, lines, signature)


def waiver(assessment: Assessment, book: SignatureBook) -> WaiverView | None:
    """The view of the waiver that is valid today."""
    granted = assessment.waiver
    if granted is None:
        return None
    by = f"{granted.by}, {granted.role}, {granted.granted}"
    mark = assessment.unwaived_mark
    signature = of_waiver(book, granted)
    return WaiverView(
        assessment.id, assessment.anchor, granted.reason, by, granted.expires, mark, signature
    )


def summary(assessments: Sequence[Assessment], book: SignatureBook) -> str:
    """Sentences with the number of reviews, of current ones, and of unsigned ones."""
    statuses = [
        assessment.review_status
        for assessment in assessments
        if assessment.review_status.review is not None
    ]
    if not statuses:
        return "No requirement has been reviewed."
    suspect = sum(status.is_suspect for status in statuses)
    verb = "is" if suspect == 1 else "are"
    stands = (
        f"; {suspect} of these reviews {verb} suspect: the requirement or a result changed since"
        if suspect
        else ", all reviews are current"
    )
    reviews = [status.review for status in statuses if status.review is not None]
    unsigned = sum(not of_review(book, review).is_good for review in reviews)
    verb = "is" if unsigned == 1 else "are"
    who = f" {unsigned} of {len(statuses)} {verb} unauthenticated." if unsigned else ""
    count = phrases.times(len(assessments), "requirement")
    return f"{len(statuses)} of {count} reviewed{stands}.{who}"


def changes(assessments: Sequence[Assessment], project: Project) -> tuple[RequirementChanges, ...]:
    """The changes of each requirement since its review, those with causes of their own first.

    A requirement without changes is left out.
    """
    reviewed = [assessment for assessment in assessments if assessment.review_status.review]
    pairs = [(assessment, difference(assessment.review_status, project)) for assessment in reviewed]
    views = [_change(each, change) for each, change in pairs if change.state != "same"]
    return tuple(sorted(views, key=lambda change: not change.is_root))


def change_groups(
    assessments: Sequence[Assessment], changes: Sequence[RequirementChanges]
) -> tuple[ChangeGroup, ...]:
    """The distinct changes, each with all requirements that it affects.

    Causes come before their consequences, those with the most new violations first.
    """
    violations = {change.anchor: new_violations(change) for change in changes}
    touched: dict[ChangeText, list[tuple[str, str]]] = {}
    links: Counter[ChangeText] = Counter()
    judged: set[ChangeText] = set()
    roots: set[ChangeText] = set()
    for assessment in assessments:
        for change in assessment.review_status.changes:
            text = _text(change)
            touched.setdefault(text, []).append((assessment.id, assessment.anchor))
            if not change.is_of_analysis:
                roots.add(text)
            if change.node.kind in KINDS:
                judged.add(text)
            links[text] += sum(map(change.makes_suspect, assessment.review_status.suspects))
    groups = [
        ChangeGroup(text, tuple(of), links[text], text in roots) for text, of in touched.items()
    ]

    def worst_first(group: ChangeGroup) -> tuple[bool, float, int]:
        anchors = [anchor for _, anchor in group.requirements] if group.change in judged else []
        new = sum(violations.get(anchor, 0) for anchor in anchors)
        return not group.is_root, -new / len(group.requirements), -group.links

    return tuple(sorted(groups, key=worst_first))


def change_sentences(
    changes: Sequence[RequirementChanges], groups: Sequence[ChangeGroup]
) -> Iterator[str]:
    """Sentences about changes since the review, changed verdicts, and contradictions."""
    roots = [group for group in groups if group.is_root]
    for group in roots[:_SENTENCES]:
        named = phrases.some([id for id, _ in group.requirements])
        only = only_change(group, changes)
        more = follows(only) if only else ()
        yield f"Changed since the review: {'; '.join([f'{named}: {group.change.text}', *more])}."
    left = len(roots) - _SENTENCES
    if left > 0:
        yield f"{phrases.times(left, 'more change')} since the review."
    grouped = sum(new_violations(change) for change in changes)
    if grouped:
        runs = "is" if grouped == 1 else "are"
        yield f"{phrases.times(grouped, 'violation')} {runs} new since the review."


_SENTENCES = 3


def withdrawals(withdrawn: Sequence[WithdrawnRequirement]) -> tuple[RequirementChanges, ...]:
    """A change for each removed requirement; retired ones are already among `changes`."""
    return tuple(
        RequirementChanges(
            requirement=withdrawal.review.requirement,
            title=withdrawal.review.texts.title if withdrawal.review.texts else "",
            anchor="",
            state="gone",
            by=_by(withdrawal.review),
            texts=(),
            lines=(withdrawal.text,),
            contradictions=(),
            consequences=(),
            suspicion="",
            verdicts=tuple(
                (run, then, "none") for run, then in sorted(withdrawal.review.verdicts.items())
            ),
            is_root=True,
        )
        for withdrawal in withdrawn
        if not withdrawal.retired
    )


def _change(assessment: Assessment, difference: ReviewDifference) -> RequirementChanges:
    texts = tuple(map(_text, difference.changes))
    other = (OTHER_TEXTS,) if difference.has_other_texts else ()
    return RequirementChanges(
        requirement=assessment.id,
        title=assessment.entry.title,
        anchor=assessment.anchor,
        state=difference.state,
        by=_by(difference.review) if difference.review else "",
        texts=texts,
        lines=(*(text.text for text in texts), *other),
        contradictions=difference.contradictions,
        consequences=difference.consequences,
        suspicion=difference.suspicion,
        verdicts=tuple((run, b or "none", now or "none") for run, b, now in difference.verdicts),
        is_root=not assessment.review_status.needs_only_analysis,
    )


def _text(change: TextChange) -> ChangeText:
    return ChangeText(change.what, change.before, change.after, change.text, change.segments)


def _by(review: Review) -> str:
    return f"{review.reviewer}, {review.role}, {review.date}"


def reservations(assessment: Assessment) -> Iterator[str]:
    """Sentences that qualify a review."""
    if assessment.review_status.review is None:
        return
    new = (
        assessment.review_status.chain.verdicts.keys()
        - assessment.review_status.review.verdicts.keys()
    )
    if new and not assessment.review_status.is_suspect:
        count = phrases.times(len(new), "run")
        yield f"{assessment.id} was audited against {count} after its review."
