"""Names of a project, recognized in words: `battery_low` in "the battery is low"."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from functools import cached_property

from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.english.words import ARTICLES, COPULAS, Word, carries_meaning, stem, stems
from fretish.keywords import RESERVED

_OFF = frozenset(
    map(
        stem, "close shut stop disable disengage deactivate halt off clear release deselect".split()
    )
)
"""Stems of words that say the opposite of a name that lacks them."""
_MOST_OTHERS = 2
"""The largest number of words of a phrase that a name for it may lack."""
_TWINS = {
    stem(a): stem(b)
    for pair in (
        "open closed", "on off", "start stop", "enabled disabled", "engaged disengaged",
        "active inactive", "activate deactivate", "available unavailable", "safe unsafe",
        "empty full", "valid invalid", "moving stopped",
    )
    for a, b in (pair.split(), pair.split()[::-1])
}  # fmt: skip


@dataclass(frozen=True)
class Vocabulary:
    """The names of a project."""

    propositions: tuple[str, ...] = ()
    numbers: tuple[str, ...] = ()
    """Names of signals that are numbers."""
    values: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    """Enumerated signal → its words."""
    components: tuple[str, ...] = ()

    @cached_property
    def stems(self) -> Mapping[str, frozenset[str]]:
        """Name of a proposition or number → the stems of its words."""
        return {name: frozenset(stems(name)) for name in (*self.propositions, *self.numbers)}


def vocabulary(declarations: Declarations | None, components: Iterable[str] = ()) -> Vocabulary:
    """The names that bindings declare.

    Args:
        declarations: None: there are no bindings.
        components: the components of the project's requirements.
    """
    own = tuple(dict.fromkeys(components))
    if declarations is None:
        return Vocabulary(components=own)
    signals = declarations.signals
    variables = [name for name in declarations.variables if name not in declarations.propositions]
    return Vocabulary(
        (*declarations.propositions, *variables),
        tuple(name for name, signal in signals.items() if not signal.values),
        {name: signal.values for name, signal in signals.items() if signal.values},
        own,
    )


@dataclass(frozen=True, slots=True)
class Match:
    """A name for some words; `negated` if they say its opposite."""

    name: str
    negated: bool = False


def matched(words: Sequence[Word], names: Vocabulary, kind: Sequence[str]) -> Match | None:
    """The name that the words mean; None if there is none, or several fit equally.

    Args:
        words: a phrase.
        names: the project's names.
        kind: those that may be meant.
    """
    said = frozenset(part for word in content(words) for part in stems(word.text))
    if not said:
        return None
    written = [Match(name) for name in kind for word in words if word.text == name]
    if written:
        return written[0]
    own = {name: names.stems[name] for name in kind}
    for twin in (said, *({*said - {one}, _TWINS[one]} for one in said if one in _TWINS)):
        same = [name for name, parts in own.items() if parts == twin]
        if len(same) == 1:
            return Match(same[0], negated=twin != said)
    return _within(said, own) or _longer(said, own)


def _within(said: frozenset[str], own: Mapping[str, frozenset[str]]) -> Match | None:
    """The name with the most words of the phrase, if all its words are there and few others."""
    some = {
        name: parts
        for name, parts in own.items()
        if parts and parts <= said and len(said - parts) <= _MOST_OTHERS
    }
    longest = max(map(len, some.values()), default=0)
    best = [name for name, parts in some.items() if len(parts) == longest]
    if len(best) != 1:
        return None
    return Match(best[0], negated=bool((said - some[best[0]]) & _OFF))


def _longer(said: frozenset[str], own: Mapping[str, frozenset[str]]) -> Match | None:
    """The only name that has all words of the phrase, and not as many more."""
    some = [name for name, parts in own.items() if said < parts and 2 * len(said) >= len(parts)]
    return Match(some[0]) if len(some) == 1 else None


def valued(words: Sequence[Word], names: Vocabulary) -> tuple[str, str] | None:
    """The enumerated signal and its word that a phrase names; None if not exactly one."""
    said = {part for word in content(words) for part in stems(word.text)}
    fits = [
        (name, value)
        for name, values in names.values.items()
        for value in values
        if {*stems(value)} <= said
    ]
    exact = [(name, value) for name, value in fits if {*stems(name)} <= said] or fits
    return exact[0] if len(exact) == 1 else None


def content(words: Sequence[Word]) -> tuple[Word, ...]:
    """The words that make a name: no articles, copulas and punctuation."""
    skipped = ARTICLES | COPULAS | {"of"}
    some = tuple(w for w in words if carries_meaning(w) and w.lower not in skipped)
    return some or tuple(w for w in words if w.text.isalnum())


def new_name(words: Sequence[Word]) -> str:
    """A name made of all content words: `battery_low`; never a reserved word."""
    parts = (
        "".join(c if c.isalnum() or c == "_" else "_" for c in _small(word.text))
        for word in content(words)
    )
    name = "_".join(filter(None, (part.strip("_") for part in parts))) or "it"
    if not name.isascii():
        name = "".join(c if c.isascii() else "_" for c in name).strip("_") or "it"
    if not name[0].isalpha():
        name = f"n_{name}"
    return f"is_{name}" if name.lower() in RESERVED else name


def _small(word: str) -> str:
    """The word without a capital at its start; `LED` stays."""
    return word.lower() if word[1:].islower() or len(word) == 1 else word


def lacking(name: str, words: Sequence[Word]) -> tuple[str, ...]:
    """The content words of a phrase that a name for it does not contain."""
    own = {*stems(name)}
    return tuple(word.text for word in content(words) if not own.issuperset(stems(word.text)))
