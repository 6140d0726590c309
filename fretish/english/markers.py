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
    (Role.FOR, "for at least; for a period of; for a duration of; for the next; for"),
    (Role.WITHIN, "within at most; within the next; within a maximum of; within; in less than; "
     "in at most; no later than; not later than; at most; at the latest; in under; in"),
    (Role.EVERY, "at least once every; at least every; once every; every"),
    (Role.AFTER_TIME, "after exactly; after; exactly; at least"),
)  # fmt: skip
_TIME_MARKERS = sorted(
    ((tuple(wording.split()), role) for role, some in _TIMES for wording in some.split(";")),
    key=lambda each: -len(each[0]),
)
_SINCE = ("of", "after", "from", "since", "when", "once", "upon", "following")
_MODES = frozenset({"mode", "state", "phase"})


@dataclass(frozen=True, slots=True)
class Clause:
    """A clause with its role; `marker` are the words that say the role."""

    role: Role
    marker: Phrase
    words: Phrase = ()
    time: Time | None = None
    is_or: bool = False
    """Whether "or" joins it to the clause before."""
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
        if time is not None:
            end = time.end - index
            if (
                role is Role.AFTER_TIME
                and wording[-1] != "after"
                and said[end : end + 1] != ("after",)
            ):
                continue
            said_by = words[index : index + len(wording)]
            since = 1 if said[end : end + 1] and said[end] in _SINCE else 0
            if since:
                clause = Clause(role, (*said_by, words[index + end]), (), time, is_since=True)
                return clause, end + since
            return Clause(role, said_by, (), time), end
    return None
