"""`fretc.lock`: reviewed requirements, their reviewers, and the fingerprints at that time.

Sorted TOML with a table for each requirement, so that two reviews merge like code. Only `fretc
lock` writes a lock; waivers are in `waivers.toml` (`fretc.traceability.waivers`).
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any

import tomli_w

from compiler.files.dates import is_date, is_in_future
from compiler.files.text_files import read as read_text
from fretc.analysis.findings import RealizabilityVerdict
from fretc.audit.evidence.reader import VERDICTS
from fretc.audit.evidence.verdict_inputs import SENTENCE
from fretc.traceability.analyses import Realizability
from fretc.traceability.chain import ACCEPTANCE, FORMULAS, REVIEW, Chain, ChainItem, status_node
from fretc.traceability.changes import ReviewChange, changes
from fretc.traceability.fingerprints import IN_FORCE
from fretc.traceability.meanings import agree
from fretc.traceability.suspects import Suspect, changed, suspects
from fretc.traceability.texts import ReviewedTexts, as_table
from fretc.traceability.texts import read as read_texts
from fretish.bindings.canonical import digest
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.reading.natural_order import natural
from fretish.reading.toml_text import Tables
from fretish.reading.toml_text import read as read_tables
from monitors import kernel

NAME = "fretc.lock"
SCHEMA = "fretc-lock-3"
_TABLE = "review"
_TEXTS = ("reviewer", "role", "date", "comment")
_SHA256 = re.compile(r"[0-9a-f]{64}|")
_HEAD = "# Written by `fretc lock`: what was reviewed, and what it was like then.\n\n"


@dataclass(frozen=True, slots=True)
class Review:
    """The review of one requirement."""

    requirement: str
    reviewer: str
    role: str
    date: str
    """ISO 8601, as `2026-11-22`."""
    comment: str
    prints: Mapping[ChainItem, str]
    """Node upstream of the review → SHA-256."""
    verdicts: Mapping[str, str]
    """Run → its verdict."""
    texts: ReviewedTexts | None = None
    """The accepted texts; None if they could not be kept."""

    @property
    def was_in_force(self) -> bool:
        """Whether the requirement was not retired at the review."""
        return self.prints.get(status_node(self.requirement)) == IN_FORCE

    @property
    def was_claimed(self) -> bool:
        """Whether the requirement was in force and formalized, so that runs were judged."""
        return self.was_in_force and ChainItem(FORMULAS, self.requirement) in self.prints

    @property
    def verdict_summary(self) -> str:
        """The accepted verdicts in words, with the result of the analysis of all requirements."""
        together = self.texts.analysis if self.texts else ()
        return "; ".join(filter(None, (_in_words(self.verdicts), _together(together))))

    @property
    def seal(self) -> str:
        """SHA-256 of the whole review, to detect a review that was edited by hand."""
        texts = {name: getattr(self, name) for name in ("requirement", *_TEXTS)}
        prints = {str(node): sha for node, sha in self.prints.items()}
        written = [] if self.texts is None else [as_table(self.texts)]
        return digest([texts, prints, dict(self.verdicts), *written])


@dataclass(frozen=True, slots=True)
class Lock:
    """A lock: requirement → its review, sorted."""

    reviews: Mapping[str, Review]


def accepted(chain: Chain, reviewer: str, role: str, date: str, comment: str) -> Review:
    """A review of the present state of a requirement."""
    id, prints, texts = chain.requirement, chain.prints, chain.texts
    readable = texts is not None and isinstance(read_texts(as_table(texts)), ReviewedTexts)
    kept = texts if texts is not None and readable and agree(id, texts, prints) else None
    return Review(id, reviewer, role, date, comment, prints, chain.verdicts, kept)


def verdicts_of(chain: Chain) -> str:
    """The verdicts that a review would accept, in words, worst first."""
    together = chain.answer.texts if chain.answer else ()
    return "; ".join(filter(None, (_in_words(chain.verdicts), _together(together))))


def _together(texts: Sequence[str]) -> str:
    """The verdict of an analysis with its findings; "" if there is no analysis."""
    if not texts:
        return ""
    verdict, *findings = texts
    more = f" ({'; '.join(findings)})" if findings else ""
    return f"{verdict} with the others{more}"


def warnings_of(chain: Chain) -> str:
    """The warnings that a review would accept, in words; "" if there are none."""
    names = sorted(node.name for node in chain.prints if node.kind == ACCEPTANCE)
    return f"; accepted warnings: {', '.join(names)}" if names else ""


def _in_words(verdicts: Mapping[str, str]) -> str:
    parts = []
    for word in VERDICTS:
        runs = sorted(run for run, verdict in verdicts.items() if verdict == word)
        if not runs:
            continue
        named = ", ".join(runs[:_NAMED]) if word == kernel.VIOLATED else ""
        rest = len(runs) - (_NAMED if named else 0)
        more = f"{rest} {'more ' if named else ''}run{'' if rest == 1 else 's'}" if rest > 0 else ""
        parts.append(f"{word} in {' and '.join(part for part in (named, more) if part)}")
    return "; ".join(parts) or "not audited in any run"


_NAMED = 3
"""Maximum number of violating runs that a summary names."""


def unnamed_violations(chosen: Sequence[Chain], refuted: Collection[str]) -> tuple[Diagnostic, ...]:
    """F529 for each requirement to accept that runs violate, or that conflicts with others.

    Args:
        chosen: the chains to accept.
        refuted: ids of requirements with a probability that the estimate over all runs refutes.
    """
    violations = {
        c.requirement: verdicts_of(c) for c in chosen if kernel.VIOLATED in c.verdicts.values()
    }
    violations |= {c.requirement: "refuted by all runs" for c in chosen if c.requirement in refuted}
    violations = {
        c.requirement: _together(c.answer.texts)
        for c in chosen
        if c.answer is not None and c.answer.verdict is RealizabilityVerdict.UNREALIZABLE
    } | violations
    return tuple(
        diagnostic("violation_not_named", id=id, verdicts=verdicts)
        for id, verdicts in violations.items()
    )


@dataclass(frozen=True, slots=True)
class AcceptedVerdicts:
    """Summary of the verdicts on the requirements that one `fretc lock` accepts."""

    verdicts: Mapping[str, Mapping[str, str]]
    """Requirement → run → verdict."""
    violated: tuple[str, ...]
    """Requirements that a run violates, or that the estimate over all runs refutes."""
    not_shown: tuple[str, ...]
    """Other requirements that were not audited, or are not satisfied in each run."""
    answers: Mapping[str, Realizability]
    """Requirement → result of the analysis; without requirements that were not analyzed."""

    @classmethod
    def of(cls, subjects: Sequence[Chain], refuted: Collection[str]) -> AcceptedVerdicts:
        """The summary for some requirements; `refuted` as in `unnamed_violations`."""
        verdicts = {chain.requirement: chain.verdicts for chain in subjects}
        violated = [
            id for id, runs in verdicts.items() if kernel.VIOLATED in runs.values() or id in refuted
        ]
        good = [id for id, runs in verdicts.items() if {*runs.values()} == {kernel.SATISFIED}]
        unshown = [id for id in verdicts if id not in violated and id not in good]
        answers = {
            subject.requirement: subject.answer
            for subject in subjects
            if subject.answer is not None
        }
        return cls(verdicts, tuple(violated), tuple(unshown), answers)

    @property
    def text(self) -> str:
        """One line, with the number of each kind."""
        count = len(self.verdicts)
        together = Counter(answer.verdict for answer in self.answers.values())
        with_others = (
            f", {together[word]} {word} with the others"
            for word in (RealizabilityVerdict.UNREALIZABLE, RealizabilityVerdict.NOT_CHECKED)
            if together[word]
        )
        return (
            f"accepted {count} requirement{'' if count == 1 else 's'}: "
            f"{len(self.violated)} violated, {len(self.not_shown)} not shown{''.join(with_others)}"
        )

    @property
    def as_record(self) -> dict[str, Any]:
        """The summary as plain values."""
        return {
            "accepted": {id: dict(runs) for id, runs in self.verdicts.items()},
            "violated": list(self.violated),
            "not_shown": list(self.not_shown),
            "together": {id: list(each.texts) for id, each in self.answers.items()},
        }


def outdated_results(chosen: Sequence[Chain]) -> tuple[Diagnostic, ...]:
    """F541 for each requirement with outdated evidence; F542 for logs without a SHA-256."""
    diagnostics = []
    for chain in chosen:
        causes = dict.fromkeys(cause for nodes in chain.outdated.values() for cause in nodes)
        if causes:
            what = ", ".join(f"{cause.kind} {cause.name}" for cause in causes)
            diagnostics.append(
                diagnostic("outdated_result", requirement=chain.requirement, what=what)
            )
        if chain.unhashed:
            diagnostics.append(
                diagnostic("log_without_hash", log=chain.unhashed[0], requirement=chain.requirement)
            )
    return tuple(diagnostics)


def text(lock: Lock) -> str:
    """The text of the lock file."""
    reviews: dict[str, Any] = {}
    tables: dict[str, Any] = {"schema": SCHEMA, _TABLE: reviews}
    for id in sorted(lock.reviews, key=natural):
        review = lock.reviews[id]
        reviews[id] = {
            **{name: getattr(review, name) for name in _TEXTS},
            "seal": review.seal,
            "fingerprints": {str(n): sha for n, sha in sorted(review.prints.items())},
            "verdicts": dict(sorted(review.verdicts.items())),
            **({} if review.texts is None else {"texts": as_table(review.texts)}),
        }
    return f"{_HEAD}{tomli_w.dumps(tables)}"


# Reading ---------------------------------------------------------------------------------------


def read(path: str) -> Lock | Diagnostic:
    """The lock of a file, or diagnostics; F901 as a note if there is no lock yet."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return _none_yet(path) if source.code is Code.NO_SUCH_FILE else source
    tables = read_tables(source.span(), Code.BAD_LOCK, "the lock")
    if isinstance(tables, Diagnostic):
        return tables
    wrong = next(_mistakes(tables), None)
    if wrong is not None:
        return wrong
    lock = Lock({id: _review(id, fields) for id, fields in _reviews(tables)})
    return next(_broken(tables, lock), lock)


def _none_yet(path: str) -> Diagnostic:
    return diagnostic("nothing_reviewed", path=path)


def _reviews(tables: Tables) -> Iterable[tuple[str, Any]]:
    reviews = tables.data.get(_TABLE, {})
    return reviews.items() if isinstance(reviews, dict) else ()


def _mistakes(tables: Tables) -> Iterator[Diagnostic]:
    if tables.data.get("schema") != SCHEMA:
        yield _wrong(tables, f"the lock does not have the schema `{SCHEMA}`", "schema")
    for name, value in tables.data.items():
        if name not in ("schema", _TABLE) or (name == _TABLE and not isinstance(value, dict)):
            yield _wrong(tables, f"`{name}` is not a field of the lock", name)
    for id, fields in _reviews(tables):
        if not isinstance(fields, dict):
            yield _wrong(tables, f"`{id}` is not a review", _TABLE, id)
            continue
        for name in (*_TEXTS, "seal"):
            if not isinstance(fields.get(name), str):
                yield _wrong(tables, f"the review of {id} has no `{name}`", _TABLE, id, name)
        if isinstance(fields.get("date"), str) and not is_date(fields["date"]):
            yield _wrong(tables, f"`{fields['date']}` is not a date", _TABLE, id, "date")
        for name in ("fingerprints", "verdicts"):
            table = fields.get(name)
            if not isinstance(table, dict) or not all(isinstance(v, str) for v in table.values()):
                yield _wrong(tables, f"`{name}` of {id} must be a table of texts", _TABLE, id, name)
            elif name == "fingerprints":
                yield from _no_prints(tables, id, table)
        texts = read_texts(fields["texts"]) if "texts" in fields else None
        if isinstance(texts, str):
            what = f"`texts` of {id} cannot be read: {texts}"
            yield _wrong(tables, what, _TABLE, id, "texts")


def _no_prints(tables: Tables, id: str, table: Mapping[str, str]) -> Iterator[Diagnostic]:
    for name, sha in table.items():
        if ":" not in name or not _SHA256.fullmatch(sha):
            path = (_TABLE, id, "fingerprints", name)
            yield _wrong(tables, f"`{name}` of {id} is not a fingerprint", *path)


def _broken(tables: Tables, lock: Lock) -> Iterator[Diagnostic]:
    """A diagnostic for each review that was edited, or is dated in the future."""
    for id, review in lock.reviews.items():
        fields = tables.data[_TABLE][id]
        if fields["seal"] != review.seal:
            what = f"the review of {id} was edited after `fretc lock` wrote it"
            yield _wrong(tables, what, _TABLE, id, "seal")
        elif is_in_future(review.date):
            what = f"the review of {id} is of {review.date}, a date in the future"
            yield _wrong(tables, what, _TABLE, id, "date")


def _wrong(tables: Tables, what: str, *path: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_LOCK,
        what,
        tables.place(*path),
        help="restore the file from version control, or review again: `fretc lock`",
    )


def _review(id: str, fields: Mapping[str, Any]) -> Review:
    return Review(
        requirement=id,
        **{name: fields[name] for name in _TEXTS},
        prints={_node(name): sha for name, sha in fields["fingerprints"].items()},
        verdicts=fields["verdicts"],
        texts=_texts(fields),
    )


def _texts(fields: Mapping[str, Any]) -> ReviewedTexts | None:
    texts = read_texts(fields["texts"]) if "texts" in fields else None
    assert not isinstance(texts, str), "it has been read before"
    return texts


def _node(text: str) -> ChainItem:
    kind, _, name = text.partition(":")
    return ChainItem(kind, name)


# Comparing -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ReviewStatus:
    """A present requirement with its review."""

    chain: Chain
    review: Review | None
    """None if the requirement was never reviewed, or its review was withdrawn."""

    suspects: tuple[Suspect, ...]
    """The suspect links; empty if there is no review."""
    changes: tuple[ReviewChange, ...]
    """Changes since the review, without changes that follow from others."""
    has_other_texts: bool = False
    """Whether the texts of the review do not match its fingerprints, and are ignored."""

    @property
    def is_suspect(self) -> bool:
        """Whether a link to the review is suspect."""
        return any(suspect.link.target.kind == REVIEW for suspect in self.suspects)

    @property
    def needs_only_analysis(self) -> bool:
        """Whether nothing of the requirement has changed, but the analysis is out of date.

        No run's verdict depends on the analysis.
        """
        own = not all(change.is_of_analysis for change in self.changes)
        return bool(self.changes) and not own and not self.has_other_texts

    @property
    def causes(self) -> tuple[ChainItem, ...]:
        """The changes that make links suspect, without duplicates."""
        return tuple(dict.fromkeys(cause for suspect in self.suspects for cause in suspect.causes))


def review_statuses(chains: Sequence[Chain], lock: Lock | None) -> tuple[ReviewStatus, ...]:
    """Each requirement with its review."""
    reviews = lock.reviews if lock else {}
    return tuple(_review_status(chain, reviews.get(chain.requirement)) for chain in chains)


def _review_status(chain: Chain, review: Review | None) -> ReviewStatus:
    if review is None:
        return ReviewStatus(chain, None, (), ())
    prints, texts = review.prints, review.texts
    suspect = suspects(chain, prints)
    if not suspect and not changed(chain.prints, prints):
        return ReviewStatus(chain, review, (), ())
    vouched = texts is None or agree(chain.requirement, texts, prints)
    causes = tuple(dict.fromkeys(cause for item in suspect for cause in item.causes))
    found = changes(chain, prints, review.verdicts, texts if vouched else None, causes)
    return ReviewStatus(chain, review, suspect, found, not vouched)


@dataclass(frozen=True, slots=True)
class WithdrawnRequirement:
    """A requirement that was in force when it was reviewed, and is no longer."""

    review: Review
    retired: bool
    """True if the requirement was retired, False if it was removed."""
    successor: str = ""
    """Id of a requirement that is new since the review and has the same sentence, or ""."""

    @property
    def text(self) -> str:
        """A sentence with the verdicts of the review."""
        how = "is retired now" if self.retired else "is no longer among the requirements"
        renamed = f"; {self.successor} has the same sentence" if self.successor else ""
        id, verdicts = self.review.requirement, self.review.verdict_summary
        return f"{id} was reviewed ({verdicts}) and {how}{renamed}"


def withdrawn_requirements(
    requirements: Iterable[RequirementEntry], chains: Iterable[Chain], lock: Lock | None
) -> tuple[WithdrawnRequirement, ...]:
    """The reviewed requirements that were removed, renamed, split or retired."""
    if lock is None:
        return ()
    status = {requirement.id: requirement.status for requirement in requirements}
    new = {
        chain.prints.get(ChainItem(SENTENCE, chain.requirement)): chain.requirement
        for chain in chains
        if chain.requirement not in lock.reviews
    }
    return tuple(
        WithdrawnRequirement(
            review,
            id in status,
            new.get(review.prints.get(ChainItem(SENTENCE, id)), "") if id not in status else "",
        )
        for id, review in lock.reviews.items()
        if review.was_in_force and status.get(id, "retired") == "retired"
    )


def withdrawal_warnings(
    withdrawn: Sequence[WithdrawnRequirement], path: str
) -> tuple[Diagnostic, ...]:
    """F511 or F540 for each requirement that was withdrawn since its review."""
    return tuple(
        Diagnostic(
            Code.RETIRED_SINCE_REVIEW if withdrawal.retired else Code.ORPHANED_REVIEW,
            withdrawal.text,
            Source(path, "").span(),
            help=f"to accept this: `fretc lock {withdrawal.review.requirement} ...`",
            severity=Severity.WARNING,
        )
        for withdrawal in withdrawn
    )
