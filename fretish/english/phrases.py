"""Phrases that are true or false: the clause after "when", or what a component shall do."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from fretish import expressions as e
from fretish.english.amounts import time_at
from fretish.english.comparisons import comparison, left_side, states_comparison
from fretish.english.parts import Part, joined
from fretish.english.vocabulary import Vocabulary, content, matched, new_name, valued
from fretish.english.words import ARTICLES, COPULAS, Phrase, Word, lower, places, text

_NEGATIONS = frozenset({"not", "never", "no"})
_JOINS: dict[str, Callable[[e.Expression, e.Expression], e.Expression]] = {
    "and": e.both,
    "but": e.both,
    "or": e.either,
    "nor": e.both,
}
_WITHOUT = "without"


def propositions(phrase: Phrase, names: Vocabulary) -> tuple[Part, ...]:
    """The ways to read a phrase as an expression: several if `and` and `or` are mixed."""
    phrase = _stripped(phrase)
    lasting = _lasting(phrase, names)
    if lasting:
        return lasting
    phrase, some = _without_some(phrase)
    items, joins, words = _items(phrase)
    words = (*words, *some)
    parts = [_signed(item, names) for item in items]
    if lower(some) == ("neither",):
        parts[0] = parts[0].negated()
    parts = [
        parts[0],
        *(p.negated() if j == "nor" else p for p, j in zip(parts[1:], joins, strict=True)),
    ]
    if lower(some)[-2:] == ("one", "of") or lower(some)[:1] == ("any",):
        joins = ["or"] * len(joins)
    first = _combined(parts, joins, tight="and").using(places(words))
    if len({*joins} & {"and", "or"}) < 2:
        return (first,)
    return first, _combined(parts, joins, tight="or").using(places(words))


def _combined(parts: list[Part], joins: list[str], tight: str) -> Part:
    """The parts, joined; `tight` binds closer."""
    kind = {"but": "and", "nor": "and"}
    groups, between = [[parts[0]]], []
    for part, word in zip(parts[1:], joins, strict=True):
        if kind.get(word, word) == tight:
            groups[-1].append(part)
        else:
            groups.append([part])
            between.append(word)
    inner = [joined(group, _JOINS[tight]) for group in groups]
    return joined(inner, _JOINS["or" if tight == "and" else "and"])


def _without_some(phrase: Phrase) -> tuple[Phrase, Phrase]:
    """The phrase without words that say how its parts are joined, and these words."""
    said = lower(phrase)
    for wording in _SOME:
        if said[: len(wording)] == wording:
            return phrase[len(wording) :], phrase[: len(wording)]
    return phrase, ()


_SOME = (
    ("at", "least", "one", "of"), ("one", "of"), ("any", "one", "of"), ("any", "of"),
    ("all", "of"), ("each", "of"), ("both", "of"), ("neither",),
)  # fmt: skip


def _stripped(phrase: Phrase) -> Phrase:
    """Without punctuation at its ends, and without a leading "that"."""
    while phrase and phrase[-1].text in (",", ";", ":", ".") and not _names_before(phrase):
        phrase = phrase[:-1]
    while phrase and (phrase[0].text in (",", ";", ":") or phrase[0].lower == "that"):
        phrase = phrase[1:]
    return phrase


def _names_before(phrase: Phrase) -> bool:
    return len(phrase) > 3 and phrase[-3].text == "," and phrase[-1].text == ","


def _lasting(phrase: Phrase, names: Vocabulary) -> tuple[Part, ...]:
    """`persisted(5 s, p)` of "p for 5 seconds", "for more than 5 seconds"."""
    said = lower(phrase)
    if "for" not in said:
        return ()
    start = len(said) - 1 - said[::-1].index("for")
    index = start + 1
    while index < len(said) and said[index] in _LASTING:
        index += 1
    time = time_at(phrase, index)
    if time is None or not start or phrase[time.end :]:
        return ()
    used = time.used | places(phrase[start:index])
    return tuple(
        part.with_expression(e.Call("persisted", (time.amount, part.expression))).using(used)
        for part in propositions(phrase[:start], names)
    )


_LASTING = frozenset("at least more than longer the last past durations exceeding a".split())


# Coordination ----------------------------------------------------------------------------------


def _items(phrase: Phrase) -> tuple[list[Phrase], list[str], Phrase]:
    """The phrases that "and", "or" and commas join, how, and the joining words."""
    cuts = [*_cuts(phrase)]
    items, joins, words, start = list[Phrase](), list[str](), list[Word](), 0
    for index, length, word in cuts:
        if phrase[start:index]:
            items.append(phrase[start:index])
            joins.append(word)
        words += phrase[index : index + length]
        start = index + length
    items.append(phrase[start:])
    if not items[-1] and len(items) > 1:
        items.pop()
        joins.pop()
    joins = joins[: len(items) - 1]
    last = next((j for j in reversed(joins) if j != ","), "and")
    return _completed(items), [last if join == "," else join for join in joins], tuple(words)


def _cuts(phrase: Phrase) -> Iterator[tuple[int, int, str]]:
    """(index, number of words, join) of each joining word outside of parentheses and ranges."""
    depth, between = 0, False
    said = lower(phrase)
    index = 0
    while index < len(said):
        word = said[index]
        depth += (word == "(") - (word == ")")
        between = between or word in ("between", "range")
        if depth == 0 and word in _JOINS:
            if between or said[index - 2 : index + 3] == ("than", "or", "equal"):
                between = False
            elif not (word == "or" and said[index + 1 : index + 2] == ("equal",)):
                yield index, 1, word
        elif depth == 0 and word == "," and index and _is_listed(said[index + 1 :]):
            follows = said[index + 1 : index + 2]
            if follows and follows[0] in _JOINS:
                yield index, 2, follows[0]
                index += 1
            else:
                yield index, 1, ","
        elif depth == 0 and word == _WITHOUT and index and follows_clause(phrase[:index]):
            yield index, 0, "and"
        index += 1


def _is_listed(said: tuple[str, ...]) -> bool:
    """Whether "and" or "or" follows, other than in "or equal to"."""
    return any(
        word in ("and", "or") and said[index + 1 : index + 2] != ("equal",)
        for index, word in enumerate(said)
    )


def follows_clause(phrase: Phrase) -> bool:
    """Whether a phrase says something by itself, so that "without x" adds to it."""
    return bool({*lower(phrase)} & COPULAS)


def _completed(items: list[Phrase]) -> list[Phrase]:
    """The phrases, each with the subject or the predicate that it shares with its neighbour."""
    whole = list[Phrase]()
    for index, item in enumerate(items):
        at = _copula(item)
        before = _copula(whole[-1]) if whole else None
        after = next((i for i in items[index + 1 :] if _copula(i) is not None), None)
        shared = left_side(whole[-1]) if whole else ()
        if at is None and shared and states_comparison(item) and not left_side(item):
            item = (*shared, *item)
        elif at is None and before and _is_predicate(item):
            item = (*whole[-1][: before + 1], *item)
        elif at is None and after is not None and not states_comparison(item):
            item = (*item, *after[_copula(after) or 0 :])
        elif at == 0 and before:
            item = (*whole[-1][:before], *item)
        whole.append(item)
    return whole


def _is_predicate(item: Phrase) -> bool:
    """Whether a phrase without a verb tells more about the subject before it: "or empty"."""
    first = item[0].lower
    short = len(item) <= _SHORT or states_comparison(item)
    return short and first not in ARTICLES and first not in (_WITHOUT, "no")


_SHORT = 3


def _copula(phrase: Phrase) -> int | None:
    return next((i for i, word in enumerate(lower(phrase)) if word in COPULAS), None)


# One proposition -------------------------------------------------------------------------------


def _signed(phrase: Phrase, names: Vocabulary) -> Part:
    """One proposition with its sign."""
    named = _in_parentheses(phrase, names)
    if named is not None:
        return named
    if phrase and phrase[0].lower == _WITHOUT:
        return _signed(phrase[1:], names).negated().using(places(phrase[:1]))
    compared = comparison(phrase, names)
    signs = tuple(word for word in phrase if word.lower in _NEGATIONS)
    if not signs:
        return compared or _named(phrase, names)
    rest = tuple(word for word in phrase if word not in signs)
    if compared is not None and places(signs) <= compared.used:
        return compared
    part = comparison(rest, names) or _named(rest, names)
    return (part.negated() if len(signs) % 2 else part).using(places(signs))


def _named(phrase: Phrase, names: Vocabulary) -> Part:
    """A name of the project, or a new one."""
    value = valued(phrase, names)
    if value is not None:
        name, word = value
        said = {f"{name} = {word}": text(phrase)}
        return Part(e.Comparison("=", e.Name(name), e.Name(word)), places(phrase), said)
    claim = phrase[-1].lower if len(content(phrase)) > 1 else ""
    shorter = phrase[:-1] if claim in ("true", "false") else phrase
    match = matched(shorter, names, names.propositions)
    name = match.name if match else new_name(shorter)
    part = Part(e.Name(name), places(phrase), {name: text(shorter)})
    return part.negated() if (match is not None and match.negated) != (claim == "false") else part


def _in_parentheses(phrase: Phrase, names: Vocabulary) -> Part | None:
    """The name in "the pilot is not in control (not standby)": it stands for the whole."""
    said = lower(phrase)
    if not said or said[-1] != ")" or "(" not in said:
        return None
    start = len(said) - 1 - said[::-1].index("(")
    inside = phrase[start + 1 : -1]
    signs = [word for word in inside if word.lower in _NEGATIONS]
    own = [word for word in inside if word not in signs]
    if not start or len(own) != 1 or not own[0].text.isidentifier():
        return None
    match = matched(own, names, names.propositions)
    name = match.name if match else own[0].text
    part = Part(e.Name(name), places(phrase), {name: text(phrase)})
    return part.negated() if len(signs) % 2 else part
