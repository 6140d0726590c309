"""Clauses of a sentence: conditions before and after what a component shall do, and timings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

from fretish.classes.frozen import dataclass
from fretish.english.markers import Clause, Role, marker, time_clause
from fretish.english.words import COPULAS, Phrase, Word, lower, words

MODALS = tuple(
    tuple(modal.split())
    for modal in (
        "is required to", "are required to", "has to", "have to", "needs to", "need to", "ought to",
        "shall", "must", "should", "will", "can", "may",
    )
)  # fmt: skip
_ONLY = {
    Role.WHEN: Role.ONLY_WHEN,
    Role.WHENEVER: Role.ONLY_WHEN,
    Role.WHILE: Role.ONLY_WHEN,
    Role.UPON: Role.ONLY_AFTER,
    Role.AFTER: Role.ONLY_AFTER,
    Role.BEFORE: Role.ONLY_BEFORE,
    Role.UNTIL: Role.ONLY_BEFORE,
}
"""What "shall only ... when" makes of a clause."""
_DETERMINERS = frozenset("the a an its it this no".split())


@dataclass(frozen=True, slots=True)
class Outline:
    """The clauses of a sentence."""

    subject: Phrase
    modal: Phrase
    predicate: Phrase
    before: tuple[Clause, ...] = ()
    after: tuple[Clause, ...] = ()

    @property
    def clauses(self) -> tuple[Clause, ...]:
        """All clauses, in the order of the text."""
        return (*self.before, *self.after)


def outlines(words: Phrase) -> Iterator[Outline]:
    """The ways to cut a sentence: in "stop when pressed for 5 s", the time is of either verb."""
    whole = outline(words)
    yield whole
    for index, (clause, following) in enumerate(pairwise(whole.after)):
        timed = following.role in (Role.FOR, Role.MORE_THAN) and not following.is_since
        if timed and clause.time is None and following.time is not None and not following.words:
            end = max(following.time.used)
            start = clause.words[0].start
            said = tuple(word for word in words if start <= word.start <= end)
            after = (*whole.after[:index], replace(clause, words=said), *whole.after[index + 2 :])
            yield replace(whole, after=after)


def outline(words: Phrase) -> Outline:
    """The clauses of a sentence."""
    start, length = _modal(words)
    before, subject = _prefix(words[:start])
    predicate, after = _suffix(words[start + length :])
    if not length and not predicate:
        predicate, subject = subject, ()
    modal = words[start : start + length]
    if lower(predicate[:1]) == ("only",) and any(clause.role in _ONLY for clause in after):
        modal, predicate = (*modal, predicate[0]), predicate[1:]
        after = tuple(replace(each, role=_ONLY.get(each.role, each.role)) for each in after)
    return Outline(subject, modal, predicate, before, after)


def _modal(words: Phrase) -> tuple[int, int]:
    """Index and length of the modal; without one, where the main clause begins."""
    said = lower(words)
    modals = [*_modals(said)]
    if modals and _opens(words):  # "if it must stop, the lamp shall be on"
        commas = [i for i, word in enumerate(said) if word in (",", "then")]
        later = [each for each in modals if commas and each[0] > commas[0]]
        return later[0] if later else modals[-1]
    if modals:
        return modals[0]
    for index, word in enumerate(said):
        if word in ("always", "never"):
            return index, 0
    commas = [i for i, word in enumerate(said) if word in (",", "then")]
    return (commas[-1] + 1 if commas and marker(words, 0) else 0), 0


def _modals(said: tuple[str, ...]) -> Iterator[tuple[int, int]]:
    """Index and length of each modal outside of parentheses, but for those after "which"."""
    depth = 0
    for index, word in enumerate(said):
        depth += (word == "(") - (word == ")")
        for modal in MODALS if depth == 0 else ():
            if said[index : index + len(modal)] == modal and _may_be_modal(said, index):
                yield index, len(modal)
                break


def _may_be_modal(said: tuple[str, ...], index: int) -> bool:
    """Only a forbidden "may" or "can" demands something; "it can" permits."""
    if index and said[index - 1] in ("which", "that", "who"):
        return False
    return said[index] not in ("can", "may") or said[index + 1 : index + 2] in (
        ("not",),
        ("never",),
        ("only",),
    )


# Before the component --------------------------------------------------------------------------


def _prefix(words: Phrase) -> tuple[tuple[Clause, ...], Phrase]:
    """The clauses before the component, and the words about the component."""
    if not words or not _opens(words):
        return (), words
    pieces = _pieces(words)
    if len(pieces) == 1:
        first, rest = _without_comma(pieces[0])
        pieces = [first, rest]
    *conditions, subject = pieces
    timed = time_clause(subject, 0)
    if timed is not None and not timed[0].is_since:
        conditions, subject = [*conditions, subject[: timed[1]]], subject[timed[1] :]
    clauses: list[Clause] = []
    is_listed = any(lower(piece[:1]) in (("and",), ("or",)) for piece in conditions)
    for piece in conditions:
        clauses += _inner(piece) if _opens(piece) or not clauses else ()
        if clauses and piece and not _opens(piece):
            last = clauses[-1]
            follows = lower(piece[:1]) in (("and",), ("or",))
            comma = () if follows else (Word("," if is_listed else "and", piece[0].start - 1),)
            clauses[-1] = replace(last, words=(*last.words, *comma, *piece))
    return tuple(clauses), subject


def _opens(words: Phrase) -> bool:
    """Whether a clause begins with these words."""
    return marker(words, 0) is not None or time_clause(words, 0) is not None


def _pieces(words: Phrase) -> list[Phrase]:
    """The words between commas and "then", outside of parentheses; the last is the component."""
    pieces, depth, start = list[Phrase](), 0, 0
    for index, word in enumerate(lower(words)):
        depth += (word == "(") - (word == ")")
        if depth == 0 and word in (",", "then", ":"):
            if words[start:index]:
                pieces.append(words[start:index])
            start = index + 1
    return [*pieces, words[start:]]


def _without_comma(words: Phrase) -> tuple[Phrase, Phrase]:
    """The clause and the component, where no comma separates them: at the last determiner."""
    said = lower(words)
    timed = time_clause(words, 0)
    if timed is not None and not timed[0].is_since:
        return words[: timed[1]], words[timed[1] :]
    mark = marker(words, 0)
    first = len(mark[0]) if mark else 1
    cuts = [i for i in range(first + 1, len(said)) if said[i] in _DETERMINERS]
    cut = cuts[-1] if cuts else len(words) - 1
    return words[:cut], words[cut:]


def _inner(words: Phrase) -> list[Clause]:
    """The clauses in a piece that begins with a marker: "when a and while b"."""
    clauses, start, either = list[Clause](), 0, words[:0]
    said = lower(words)
    first = marker(words, 0)
    index = len(first[0]) if first else 1
    cuts = []
    while index < len(words):
        mark = marker(words, index)
        joined = said[index - 1] in ("and", "or")
        if mark and (joined or mark[1] is Role.WHILE or mark[0] in _MOMENTS):
            cuts.append((index - joined, index, _or_before(words, index)))
            index += len(mark[0])
        index += 1
    for end, following, joins in [*cuts, (len(words), len(words), words[:0])]:
        clauses.append(_clause(words[start:end], either))
        start, either = following, joins
    return clauses


def _or_before(words: Phrase, index: int) -> Phrase:
    """The word "or" before a place, if it is there."""
    before = words[max(0, index - 1) : index]
    return before if lower(before) == ("or",) else ()


def _clause(words: Phrase, either: Phrase) -> Clause:
    time = time_clause(words, 0)
    if time is not None:
        clause, end = time
        rest = words[end:]
        return replace(clause, words=rest, either=either)
    mark = marker(words, 0)
    if mark is None:
        return Clause(Role.WHEN, (), words, None, either)
    length = len(mark[0])
    keep = 0 if mark[0] != ("in",) else 1
    return Clause(mark[1], words[:length], words[max(length, keep) :], None, either)


# After the component ---------------------------------------------------------------------------


def _suffix(words: Phrase) -> tuple[Phrase, tuple[Clause, ...]]:
    """What the component shall do, and the clauses after it."""
    while lower(words[:1]) == (",",):
        words = words[1:]
    starts = [*_starts(words)]
    ends = [*(start for start, _ in starts), len(words)][1:]
    clauses: list[Clause] = []
    for (start, clause), end in zip(starts, ends, strict=True):
        length = len(clause.marker) + (len(clause.time.used) if clause.time else 0)
        rest = words[start + length : end]
        either = _or_before(words, start) if clauses else ()
        clauses.append(replace(clause, words=_trimmed(rest), either=either))
    core = words[: starts[0][0]] if starts else words
    if starts and starts[0][0] == 0 and clauses:
        core, clauses[0] = _at_front(clauses[0])
    return _with_rest(core, clauses)


def _with_rest(core: Phrase, clauses: list[Clause]) -> tuple[Phrase, tuple[Clause, ...]]:
    """The predicate with the words after a duration: "return within 5 s to the base"."""
    whole: list[Clause] = []
    for clause in clauses:
        goes_on = clause.time is not None and not clause.is_since
        if goes_on and clause.words and clause.words[0].text != "(":
            core = (*core, *clause.words)
            clause = replace(clause, words=())
        whole.append(clause)
    return _trimmed(core), tuple(whole)


def _trimmed(phrase: Phrase) -> Phrase:
    """Without joining words and commas at the end."""
    while phrase and phrase[-1].lower in (",", "and", "or", ";"):
        phrase = phrase[:-1]
    return phrase


def _at_front(clause: Clause) -> tuple[Phrase, Clause]:
    """The predicate after a clause at its front: "shall, within 5 s, stop"."""
    commas = [i for i, word in enumerate(clause.words) if word.text == ","]
    cut = commas[0] + 1 if commas else 0
    if clause.time is not None:
        return clause.words[cut:], replace(clause, words=())
    return clause.words[cut:], replace(clause, words=clause.words[: max(0, cut - 1)])


def _starts(words: Phrase) -> Iterator[tuple[int, Clause]]:
    """Where clauses begin after the modal."""
    depth, index = 0, 0
    said = lower(words)
    while index < len(words):
        depth += (said[index] == "(") - (said[index] == ")")
        step = 1
        if depth == 0:
            timed = time_clause(words, index)
            mark = marker(words, index)
            if timed is not None:
                clause, step = timed
                yield index, clause
            elif mark is not None and _begins(said, index, mark[0]):
                step = len(mark[0])
                yield index, Clause(mark[1], words[index : index + step])
        index += step


def _begins(said: tuple[str, ...], index: int, wording: tuple[str, ...]) -> bool:
    """Whether a marker begins a clause: not "at once", nor the "in" of "is in X mode"."""
    before = said[index - 1] if index else ""
    if wording == ("once",):
        return before not in ("at", "least", "only")
    return wording != ("in",) or (bool(before) and before not in COPULAS)


# Several demands in one sentence ---------------------------------------------------------------


def divided(text: str) -> tuple[str, ...]:
    """The demands of a sentence: "it shall start when a and stop when b" has two."""
    phrase = words(text)
    if len(phrase) > _MOST_WORDS:
        return (text,)
    parts = outline(phrase)
    for clause, following in pairwise(parts.after):
        said = lower(clause.words)
        cut = max((i for i, word in enumerate(said) if word == "and"), default=0)
        verb = clause.words[cut + 1 :]
        if cut and 0 < len(verb) <= _SHORT and not {*lower(verb)} & COPULAS and following.marker:
            before = text[: clause.words[cut].start].rstrip(" ,")
            return before, *divided(f"{_head(text, parts)} {text[verb[0].start :]}".strip())
    return _with_otherwise(text, parts)


def _head(text: str, parts: Outline) -> str:
    """Subject, modal and copula of a sentence: "the output shall be"."""
    copula = parts.predicate[:1] if lower(parts.predicate[:1]) == ("be",) else ()
    some = (*parts.subject, *parts.modal, *copula)
    return text[some[0].start : some[-1].start + len(some[-1].text)] if some else ""


def _with_otherwise(text: str, parts: Outline) -> tuple[str, ...]:
    """The demands of "if a then b, otherwise c": the second is "unless a, c"."""
    match = _OTHERWISE.search(text)
    conditions = [clause for clause in parts.before if clause.role is Role.WHEN and clause.words]
    if match is None or len(conditions) != 1 or len(parts.before) > 1:
        return (text,)
    first, last = conditions[0].words[0], conditions[0].words[-1]
    condition = text[first.start : last.start + len(last.text)]
    subject = text[: parts.subject[-1].start + len(parts.subject[-1].text)] if parts.subject else ""
    subject = subject[parts.subject[0].start :] if subject else "it"
    other = re.sub(r"^it\b", subject, text[match.end() :].strip())
    has_modal = bool(outline(words(other)).modal)
    demand = other if has_modal else f"{_head(text, parts)} {other}"
    return text[: match.start()], f"unless {condition}, {demand}"


_OTHERWISE = re.compile(r"\s*,?\s+(?:otherwise|else)\b,?", re.IGNORECASE)


_SHORT = 3
_MOST_WORDS = 200
_MOMENTS = (("at", "the", "time", "of"), ("at", "the", "moment", "when"))
