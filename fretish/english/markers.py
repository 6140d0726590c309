"""Words that begin a clause, and the role that they say."""

from __future__ import annotations

from enum import Enum, auto

from fretish.classes.frozen import dataclass
from fretish.english.amounts import Time, time_at
from fretish.english.words import Phrase, lower


class Role(Enum):
    """What a clause is for."""

    WHEN = auto()
    """`when`, `if`: at the ticks at which it becomes true, or at all at which it is true."""
    WHENEVER = auto()
    UPON = auto()
    WHILE = auto()
    UNLESS = auto()
    UNTIL = auto()
    BEFORE = auto()
    AFTER = auto()
    EXCEPT = auto()
    ONLY_WHEN = auto()
    ONLY_AFTER = auto()
    ONLY_BEFORE = auto()
    WITHIN = auto()
    FOR = auto()
    MORE_THAN = auto()
    """`for more than 5 seconds`."""
    AT_MOST = auto()
    """`for at most 5 seconds`."""
    AFTER_TIME = auto()
    EVERY = auto()
    """`every 5 seconds`."""
    IFF = auto()
    """`if and only if`."""
    ASIDE = auto()
    """`regardless of the input`: it demands nothing, and is left out."""


_WORDINGS = {
    Role.WHEN: "when; if; in case; in case of; in the event of; in the event that; provided that; "
    "provided; given that; in the case of; where",
    Role.WHENEVER: "whenever; at any time when; any time; always when; always if",
    Role.UPON: "upon; as soon as; once; every time; each time; the moment; at the moment when; "
    "at the time of; every time that; on detection of",
    Role.WHILE: "while; during; as long as; throughout; so long as; whilst; while in; when in; "
    "if in; whenever in; when operating in; while operating in",
    Role.UNLESS: "unless",
    Role.UNTIL: "until; till; up until",
    Role.BEFORE: "before; prior to",
    Role.AFTER: "after; following; from the time",
    Role.EXCEPT: "except when; except while; except if; except in; except during; except",
    Role.ONLY_WHEN: "only when; only if; only while; only in; only during",
    Role.ONLY_AFTER: "only after; only once",
    Role.ONLY_BEFORE: "only before; only until",
    Role.IFF: "if and only if; exactly when; exactly if; exactly while",
    Role.ASIDE: "regardless of; irrespective of; independent of; independently of; so that; "
    "in order to; because; no matter; whatever; even if; although",
}
_MARKERS = sorted(
    (
        (tuple(wording.split()), role)
        for role, some in _WORDINGS.items()
        for wording in some.split(";")
    ),
    key=lambda each: -len(each[0]),
)
_TIMES = (
    (Role.AT_MOST, "for at most; for no more than; for no longer than"),
    (Role.MORE_THAN, "for more than; for longer than; for durations exceeding; "
     "for a time of more than"),
    (Role.FOR, "for at least; for a period of; for a duration of; for the next; for; until"),
    (Role.WITHIN, "within at most; within the next; within a maximum of; within; in less than; "
     "in at most; no later than; not later than; at most; at the latest; in under; in"),
    (Role.EVERY, "at least once every; at least every; once every; every"),
    (Role.AFTER_TIME, "after exactly; after; exactly; at least"),
)  # fmt: skip
_TIME_MARKERS = sorted(
    ((tuple(wording.split()), role) for role, some in _TIMES for wording in some.split(";")),
    key=lambda each: -len(each[0]),
)
_SINCE = ("of", "after", "from", "since", "following")
_MODES = frozenset({"mode", "state", "phase"})


@dataclass(frozen=True, slots=True)
class Clause:
    """A clause with its role; `marker` are the words that say the role."""

    role: Role
    marker: Phrase
    words: Phrase = ()
    time: Time | None = None
    either: Phrase = ()
    """The word "or" that joins it to the clause before; empty: it is joined by "and"."""
    is_since: bool = False
    """Whether `words` are the event from which `time` counts."""


def marker(words: Phrase, index: int) -> tuple[tuple[str, ...], Role] | None:
    """The marker at a place, the longest."""
    said = lower(words[index:])
    if said[:1] == ("in",) and _MODES & {*said} and said[1:2] != ("case",):
        return ("in",), Role.WHILE
    return next((m for m in _MARKERS if said[: len(m[0])] == m[0]), None)


def time_clause(words: Phrase, index: int) -> tuple[Clause, int] | None:
    """The clause of a duration at a place, and its number of words."""
    said = lower(words[index:])
    for wording, role in _TIME_MARKERS:
        if said[: len(wording)] != wording:
            continue
        time = time_at(words, index + len(wording))
        if time is None:
            continue
        end = time.end - index
        follows = said[end] if end < len(said) else ""
        if _needs(wording, role) and follows not in _needs(wording, role):
            continue
        said_by = words[index : index + len(wording)]
        if follows in _SINCE:
            clause = Clause(role, (*said_by, words[index + end]), (), time, is_since=True)
            return clause, end + 1
        return Clause(role, said_by, (), time), end
    return None


def _needs(wording: tuple[str, ...], role: Role) -> tuple[str, ...]:
    """The words of which one must follow the duration; empty: none needs to."""
    if wording == ("until",):
        return _SINCE
    if role is Role.AFTER_TIME and wording[-1] != "after":
        return ("after",)
    return ()
