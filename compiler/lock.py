"""`fretc.lock`: what was reviewed, by whom, and the fingerprint of each thing at that time.

Sorted TOML, a table for each requirement, so that two reviews merge like code. A lock is written
by `fretc lock` only; a person's reason not to have something shown yet is a waiver, in
`waivers.toml` (`compiler.waivers`).
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from typing import Any

import tomli_w

from compiler.evidence import VERDICTS
from compiler.files import read as read_text
from compiler.links import REVIEW, Chain, Node, Suspect, changed, suspects
from fretish.diagnostic import Code, Diagnostic, Severity, suggestion
from fretish.ordering import natural
from fretish.source import Source
from fretish.tables import Tables
from fretish.tables import read as read_tables
from monitors import kernel

NAME = "fretc.lock"
SCHEMA = "fretc-lock-1"
_TEXTS = ("reviewer", "role", "date", "comment")
_SHA256 = re.compile(r"[0-9a-f]{64}|")
_HEAD = "# Written by `fretc lock`: what was reviewed, and what it was like then.\n\n"


@dataclass(frozen=True, slots=True)
class Review:
    """One requirement as somebody accepted it."""

    requirement: str
    reviewer: str
    role: str
    date: str
    """ISO 8601, as `2026-11-22`."""
    comment: str
    prints: Mapping[Node, str]
    """SHA-256 of everything upstream of the review."""
    verdicts: Mapping[str, str]
    """Run → the word of its verdict."""


@dataclass(frozen=True, slots=True)
class Lock:
    """A whole lock: requirement → its review, sorted."""

    reviews: Mapping[str, Review]


def accepted(chain: Chain, reviewer: str, role: str, date: str, comment: str) -> Review:
    """The present state of a requirement, accepted."""
    return Review(chain.requirement, reviewer, role, date, comment, chain.prints, chain.verdicts)


def verdicts_of(chain: Chain) -> str:
    """The verdicts that a review of it would accept, in words, the worst first."""
    told = []
    for word in VERDICTS:
        runs = sorted(run for run, verdict in chain.verdicts.items() if verdict == word)
        if not runs:
            continue
        named = ", ".join(runs[:_NAMED]) if word == kernel.VIOLATED else ""
        rest = len(runs) - (_NAMED if named else 0)
        more = f"{rest} {'more ' if named else ''}run{'' if rest == 1 else 's'}" if rest > 0 else ""
        told.append(f"{word} in {' and '.join(part for part in (named, more) if part)}")
    return "; ".join(told) or "no run of it was audited"


_NAMED = 3
"""Of so many violated runs the names are told."""


def unnamed_violations(chosen: Sequence[Chain], refuted: Collection[str]) -> tuple[Diagnostic, ...]:
    """F529 for each requirement that would be accepted though runs show that it does not hold.

    Args:
        chosen: what is to be accepted.
        refuted: ids of the requirements with a probability that all runs together refute.
    """
    wrong = {
        c.requirement: verdicts_of(c) for c in chosen if kernel.VIOLATED in c.verdicts.values()
    }
    wrong |= {c.requirement: "refuted by all runs" for c in chosen if c.requirement in refuted}
    return tuple(
        Diagnostic(
            Code.UNREVIEWED_VIOLATION,
            f"{id} is {told}",
            help="mend it, or accept it as it is: add `--accept-violations`",
        )
        for id, told in wrong.items()
    )


def text(lock: Lock) -> str:
    """The file."""
    tables: dict[str, Any] = {"schema": SCHEMA}
    for id in sorted(lock.reviews, key=natural):
        review = lock.reviews[id]
        tables[id] = {
            **{name: getattr(review, name) for name in _TEXTS},
            "fingerprints": {str(n): sha for n, sha in sorted(review.prints.items())},
            "verdicts": dict(sorted(review.verdicts.items())),
        }
    return f"{_HEAD}{tomli_w.dumps(tables)}"


# Reading ---------------------------------------------------------------------------------------


def read(path: str) -> Lock | Diagnostic:
    """A lock from its file, or what is wrong with it; F901 as a note where there is none yet."""
    source = read_text(path)
    if isinstance(source, Diagnostic):
        return _none_yet(path) if source.code is Code.NO_SUCH_FILE else source
    tables = read_tables(source.span(), Code.BAD_LOCK, "the lock")
    if isinstance(tables, Diagnostic):
        return tables
    wrong = next(_mistakes(tables), None)
    if wrong is not None:
        return wrong
    return Lock({id: _review(id, told) for id, told in _reviews(tables)})


def _none_yet(path: str) -> Diagnostic:
    return Diagnostic(
        Code.NO_SUCH_FILE,
        f"nothing has been reviewed: there is no `{path}`",
        help="accept the present state: `fretc lock --reviewer NAME --role ROLE --comment TEXT`",
        severity=Severity.NOTE,
    )


def _reviews(tables: Tables) -> Iterator[tuple[str, Mapping[str, Any]]]:
    return ((id, told) for id, told in tables.data.items() if id != "schema")


def _mistakes(tables: Tables) -> Iterator[Diagnostic]:
    if tables.data.get("schema") != SCHEMA:
        yield _wrong(tables, f"the lock is not of the form `{SCHEMA}`", "schema")
    for id, told in _reviews(tables):
        if not isinstance(told, dict):
            yield _wrong(tables, f"`{id}` is no review", id)
            continue
        for name in _TEXTS:
            if not isinstance(told.get(name), str):
                yield _wrong(tables, f"the review of {id} has no `{name}`", id, name)
        if isinstance(told.get("date"), str) and not is_date(told["date"]):
            yield _wrong(tables, f"`{told['date']}` is no date", id, "date")
        for name in ("fingerprints", "verdicts"):
            table = told.get(name)
            if not isinstance(table, dict) or not all(isinstance(v, str) for v in table.values()):
                yield _wrong(tables, f"`{name}` of {id} must be a table of texts", id, name)
            elif name == "fingerprints":
                yield from _no_prints(tables, id, table)


def _no_prints(tables: Tables, id: str, table: Mapping[str, str]) -> Iterator[Diagnostic]:
    for name, sha in table.items():
        if ":" not in name or not _SHA256.fullmatch(sha):
            yield _wrong(tables, f"`{name}` of {id} is no fingerprint", id, "fingerprints", name)


def _wrong(tables: Tables, what: str, *path: str) -> Diagnostic:
    return Diagnostic(
        Code.BAD_LOCK,
        what,
        tables.place(*path),
        help="take the file from your repository again, or review anew: `fretc lock`",
    )


def is_date(text: str) -> bool:
    """Whether it is a date as `2026-11-22`."""
    try:
        return date.fromisoformat(text).isoformat() == text
    except ValueError:
        return False


def _review(id: str, told: Mapping[str, Any]) -> Review:
    return Review(
        requirement=id,
        **{name: told[name] for name in _TEXTS},
        prints={_node(name): sha for name, sha in told["fingerprints"].items()},
        verdicts=told["verdicts"],
    )


def _node(text: str) -> Node:
    kind, _, name = text.partition(":")
    return Node(kind, name)


# Comparing -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Standing:
    """A requirement as it is now, beside its review."""

    chain: Chain
    review: Review | None
    """None: it has never been reviewed, or the review has been taken back."""

    suspects: tuple[Suspect, ...]
    """The links that no longer stand on what was reviewed; none where nothing was."""
    changes: tuple[Node, ...]
    """Everything that is not as it was reviewed."""

    @property
    def is_suspect(self) -> bool:
        """Whether anything that its review rests on has changed."""
        return any(suspect.link.target.kind == REVIEW for suspect in self.suspects)


def standings(chains: Sequence[Chain], lock: Lock | None) -> tuple[Standing, ...]:
    """Each requirement beside its review."""
    reviews = lock.reviews if lock else {}
    return tuple(_standing(chain, reviews.get(chain.requirement)) for chain in chains)


def _standing(chain: Chain, review: Review | None) -> Standing:
    if review is None:
        return Standing(chain, None, (), ())
    known = review.prints
    return Standing(chain, review, suspects(chain, known), changed(chain.prints, known))


def orphaned(chains: Sequence[Chain], lock: Lock, path: str) -> tuple[Diagnostic, ...]:
    """F511 for each review of a requirement that is not there any more."""
    known = [chain.requirement for chain in chains]
    found = []
    for id in lock.reviews:
        if id not in known:
            near = suggestion(id, known)
            found.append(
                Diagnostic(
                    Code.ORPHANED_REVIEW,
                    f"{id} was reviewed, and is not among the requirements",
                    Source(path, "").span(),
                    help=f"was it renamed to `{near}`?" if near else "lock again without it",
                    severity=Severity.WARNING,
                )
            )
    return tuple(found)
