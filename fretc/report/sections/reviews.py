"""Who has accepted what, what has changed since, and what is waived, as it is shown."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fretc.attestation.signatures import Book
from fretc.audit.evidence.verdicts import SUSPECT
from fretc.report.model import phrases
from fretc.report.model.claims import Claim, thing
from fretc.report.model.views import Change, Listing, ReviewView, WaiverView, sign_mark
from fretc.report.sections.signatures import of_review, of_waiver
from fretc.report.traceability.chain import Suspect
from fretc.report.traceability.comparison import Difference, difference
from fretc.report.traceability.lock import Withdrawn
from fretish.diagnostics import signs

_LISTED = 40
_ACCEPTED = sign_mark("reviewed", signs.GOOD)
_UNSIGNED = sign_mark("reviewed", signs.OPEN)
_OPEN = sign_mark("not reviewed", signs.UNUSED)
_SUSPECT = sign_mark(SUSPECT, signs.SUSPECT)


def review(claim: Claim, book: Book) -> ReviewView:
    """The review of a requirement."""
    found = claim.standing.review
    if found is None:
        return ReviewView(_OPEN, "", "", (), None)
    signature = of_review(book, found)
    by = f"{found.reviewer}, {found.role}, {found.date}"
    if not claim.standing.is_suspect:
        mark = _ACCEPTED if signature.is_good else _UNSIGNED
        return ReviewView(mark, by, found.comment, (), signature)
    causes = dict.fromkeys(cause for s in claim.standing.suspects for cause in s.causes)
    return ReviewView(_SUSPECT, by, found.comment, tuple(map(thing, causes)), signature)


def waiver(claim: Claim, book: Book) -> WaiverView | None:
    """The waiver that counts now."""
    found = claim.waiver
    if found is None:
        return None
    by = f"{found.by}, {found.role}, {found.granted}"
    mark = claim.unwaived_mark
    signature = of_waiver(book, found)
    return WaiverView(claim.id, claim.anchor, found.reason, by, found.expires, mark, signature)


def reviewed(claims: Sequence[Claim], book: Book) -> str:
    """How many have been reviewed, and how many of the reviews are signed, in sentences."""
    known = [claim.standing for claim in claims if claim.standing.review is not None]
    if not known:
        return "No requirement has been reviewed."
    suspect = sum(standing.is_suspect for standing in known)
    verb = "stands" if suspect == 1 else "stand"
    stands = f"; {suspect} of these reviews no longer {verb}" if suspect else ", and all stand"
    signed = [of_review(book, each.review).is_good for each in known if each.review is not None]
    unsigned = signed.count(False)
    verb = "is" if unsigned == 1 else "are"
    who = f" {unsigned} of {len(known)} {verb} unauthenticated." if unsigned else ""
    return f"{len(known)} of {phrases.times(len(claims), 'requirement')} reviewed{stands}.{who}"


def changes(claims: Sequence[Claim]) -> tuple[Change, ...]:
    """What is not as it was reviewed; requirements that are as they were are left out."""
    pairs = [(claim, difference(claim.standing)) for claim in claims if claim.standing.review]
    return tuple(_change(claim, found) for claim, found in pairs if found.state != "same")


def gone(found: Sequence[Withdrawn]) -> tuple[Change, ...]:
    """What was reviewed and is not there any more; one that was retired since is a change."""
    return tuple(
        Change(
            one.review.requirement,
            "",
            "gone",
            (one.text,),
            Listing((), 0),
            tuple((run, then, "none") for run, then in sorted(one.review.verdicts.items())),
        )
        for one in found
        if not one.retired
    )


def _change(claim: Claim, found: Difference) -> Change:
    lines = tuple(f"{how}: {thing(node)}" for node, how in found.changes)
    links = tuple(_link(suspect) for suspect in found.suspects[:_LISTED])
    verdicts = tuple((run, then or "none", now or "none") for run, then, now in found.verdicts)
    listing = Listing(links, len(found.suspects))
    return Change(claim.id, claim.anchor, found.state, lines, listing, verdicts)


def _link(suspect: Suspect) -> str:
    causes = phrases.joined([thing(cause) for cause in suspect.causes])
    source, target = thing(suspect.link.source), thing(suspect.link.target)
    return f"{source} → {target}, because of {causes}"


def reservations(claim: Claim) -> Iterator[str]:
    """What a reader has to know of a review."""
    if claim.standing.review is None:
        return
    new = [how for node, how in difference(claim.standing).changes if node.kind == "log"]
    if "new" in new and not claim.standing.is_suspect:
        count = phrases.times(new.count("new"), "run")
        yield f"{claim.id} was audited against {count} after its review."
