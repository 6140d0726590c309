"""Reviews, changes since a review, and waivers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.attestation.signatures import SignatureBook
from fretc.audit.evidence.verdicts import SUSPECT
from fretc.report.model import phrases
from fretc.report.model.assessments import Assessment
from fretc.report.model.views import Change, Listing, ReviewView, WaiverView, sign_mark
from fretc.report.sections.signatures import of_review, of_waiver
from fretc.report.traceability.chain import Suspect
from fretc.report.traceability.comparison import Difference, difference
from fretc.report.traceability.lock import WithdrawnRequirement
from fretish.diagnostics import signs

_LISTED = 40
_ACCEPTED = sign_mark("reviewed", signs.GOOD)
_UNSIGNED = sign_mark("reviewed", signs.OPEN)
_OPEN = sign_mark("not reviewed", signs.UNUSED)
_SUSPECT = sign_mark(SUSPECT, signs.SUSPECT)


def review(assessment: Assessment, book: SignatureBook) -> ReviewView:
    """The review of a requirement."""
    accepted = assessment.standing.review
    if accepted is None:
        return ReviewView(_OPEN, "", "", (), None)
    signature = of_review(book, accepted)
    by = f"{accepted.reviewer}, {accepted.role}, {accepted.date}"
    if not assessment.standing.is_suspect:
        mark = _ACCEPTED if signature.is_good else _UNSIGNED
        return ReviewView(mark, by, accepted.comment, (), signature)
    causes = tuple(map(phrases.thing, assessment.standing.causes))
    return ReviewView(_SUSPECT, by, accepted.comment, causes, signature)


def waiver(assessment: Assessment, book: SignatureBook) -> WaiverView | None:
    """The waiver that counts today."""
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
    """The number of reviews, of those that stand, and of those without a signature."""
    standings = [each.standing for each in assessments if each.standing.review is not None]
    if not standings:
        return "No requirement has been reviewed."
    suspect = sum(standing.is_suspect for standing in standings)
    verb = "stands" if suspect == 1 else "stand"
    stands = f"; {suspect} of these reviews no longer {verb}" if suspect else ", and all stand"
    reviews = [standing.review for standing in standings if standing.review is not None]
    unsigned = sum(not of_review(book, each).is_good for each in reviews)
    verb = "is" if unsigned == 1 else "are"
    who = f" {unsigned} of {len(standings)} {verb} unauthenticated." if unsigned else ""
    count = phrases.times(len(assessments), "requirement")
    return f"{len(standings)} of {count} reviewed{stands}.{who}"


def changes(assessments: Sequence[Assessment]) -> tuple[Change, ...]:
    """The changes of each requirement since its review; one without changes is left out."""
    pairs = [(each, difference(each.standing)) for each in assessments if each.standing.review]
    return tuple(_change(each, change) for each, change in pairs if change.state != "same")


def withdrawals(withdrawn: Sequence[WithdrawnRequirement]) -> tuple[Change, ...]:
    """A change for each requirement that is gone; a retired one is among `changes` already."""
    return tuple(
        Change(
            one.review.requirement,
            "",
            "gone",
            (one.text,),
            Listing((), 0),
            tuple((run, then, "none") for run, then in sorted(one.review.verdicts.items())),
        )
        for one in withdrawn
        if not one.retired
    )


def _change(assessment: Assessment, difference: Difference) -> Change:
    lines = tuple(f"{how}: {phrases.thing(node)}" for node, how in difference.changes)
    links = tuple(_link(suspect) for suspect in difference.suspects[:_LISTED])
    verdicts = tuple((run, then or "none", now or "none") for run, then, now in difference.verdicts)
    listing = Listing(links, len(difference.suspects))
    return Change(assessment.id, assessment.anchor, difference.state, lines, listing, verdicts)


def _link(suspect: Suspect) -> str:
    causes = phrases.joined([phrases.thing(cause) for cause in suspect.causes])
    source, target = phrases.thing(suspect.link.source), phrases.thing(suspect.link.target)
    return f"{source} → {target}, because of {causes}"


def reservations(assessment: Assessment) -> Iterator[str]:
    """Sentences that qualify a review."""
    if assessment.standing.review is None:
        return
    new = [how for node, how in difference(assessment.standing).changes if node.kind == "log"]
    if "new" in new and not assessment.standing.is_suspect:
        count = phrases.times(new.count("new"), "run")
        yield f"{assessment.id} was audited against {count} after its review."
