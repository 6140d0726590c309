"""What a component shall do: its proposition, its sign, and adverbs of time."""

from __future__ import annotations

from enum import Enum, auto

from fretish import expressions as e
from fretish.classes.frozen import dataclass
from fretish.english.clauses import Outline
from fretish.english.parts import Part
from fretish.english.phrases import propositions
from fretish.english.vocabulary import Vocabulary, content, matched, new_name, valued
from fretish.english.words import COPULAS, Phrase, Places, Word, lower, places, stem, stems, text


class Adverb(Enum):
    """A timing in one word or a few."""

    ALWAYS = auto()
    EVENTUALLY = auto()
    IMMEDIATELY = auto()
    NEXT = auto()
    FINALLY = auto()


_ADVERBS = {
    Adverb.ALWAYS: "always; at all times; at any time; continuously; permanently; constantly; "
    "at every tick; at every step; in all cases; forever; for ever",
    Adverb.EVENTUALLY: "eventually; at least once; sometime; at some point; at some time; "
    "sooner or later",
    Adverb.IMMEDIATELY: "immediately; at once; instantly; directly; simultaneously; right away; "
    "without delay; initially; at the same time; straight away; at startup; at start up; "
    "at the start; at the beginning",
    Adverb.NEXT: "at the next tick; at the next step; at the next timepoint; in the next step; "
    "in the next tick; next",
    Adverb.FINALLY: "finally; at the end; at the last timepoint",
}
_ADVERB_WORDS = sorted(
    (
        (tuple(wording.split()), adverb)
        for adverb, some in _ADVERBS.items()
        for wording in some.split(";")
    ),
    key=lambda each: -len(each[0]),
)
_NEVER = frozenset({"not", "never"})
_ENSURING = ("ensure", "guarantee", "satisfy", "assure", "verify")
_STATES = COPULAS | {"exceed", "equal", "hold", "<", "<=", ">", ">=", "="}
_EVENT_CAUSES = frozenset(
    {("be", "followed", "by"), ("result", "in"), ("lead", "to"), ("imply",), ("implies",)}
)
"""What only events do."""
_CAUSES = (*_EVENT_CAUSES, ("latch",), ("cause",), ("trigger",), ("initiate",))
_HOLDS = (("be", "true"), ("hold",), ("be", "the", "case"))
_CHANGES = frozenset(map(stem, "change switch transition go move transit".split()))
DEFAULT_COMPONENT = "system"


@dataclass(frozen=True, slots=True)
class Response:
    """What a sentence demands."""

    component: str
    part: Part
    negated: bool
    adverbs: tuple[tuple[Adverb, Places], ...]
    """The adverbs of time, with the places of their words."""
    used: Places
    """The places of signs and of the component."""
    condition: Part | None = None
    """A condition that the main clause holds: the event of "exceeding the limit shall stop it"."""


def responses(parts: Outline, names: Vocabulary) -> tuple[Response, ...]:
    """The ways to read the main clause."""
    subject, none = _without_no(parts.subject)
    predicate, adverbs = _without_adverbs(parts.predicate)
    subject, more = _without_adverbs(subject)
    predicate, negated, signs = _without_not(predicate)
    used = signs | places(none) | places(parts.modal)
    adverbs = (*more, *adverbs)
    if not predicate:
        return ()
    component, of_component = _component(subject, names)
    negated = negated != bool(none)
    if any(word.lower == "never" and word.start in signs for word in parts.predicate):
        adverbs = adverbs or ((Adverb.ALWAYS, frozenset()),)
    change = _change(subject, predicate, names)
    if change is not None:
        before, after, words = change
        return (Response(component, after, negated, adverbs, used | words | of_component, before),)
    cause = _cause(subject, predicate, names)
    if cause is not None:
        before, rest, words = cause
        return tuple(
            Response(_default(names), part, negated, adverbs, used | words, before)
            for part in propositions(rest, names)
        )
    is_state, phrase, claimed = _claim(subject, predicate, names)
    used |= places(predicate) - places(phrase)
    if claimed or is_state:
        of_component = of_component if claimed == "ensured" else frozenset()
        component = component if of_component or component in names.components else _default(names)
    return tuple(
        Response(component, part, negated, adverbs, used | of_component)
        for whole in propositions(phrase, names)
        for part in (_distributed(whole) if negated else (whole,))
    )


def _distributed(part: Part) -> tuple[Part, ...]:
    """What "not a and b" may negate: both together, or each."""
    if isinstance(part.expression, e.And):
        return part, part.with_expression(e.Or(part.expression.args))
    return (part,)


def _default(names: Vocabulary) -> str:
    return names.components[0] if len(names.components) == 1 else DEFAULT_COMPONENT


def _component(subject: Phrase, names: Vocabulary) -> tuple[str, Places]:
    """The component that the subject names, and the places of its words."""
    said = "_".join(word.lower for word in content(subject))
    known = [c for c in names.components if c.lower() == said or c == text(content(subject))]
    if known:
        return known[0], places(subject)
    if not content(subject) or lower(subject) in (("it",), ("there",)):
        return _default(names), places(subject)
    return new_name(subject), places(subject)


def _claim(subject: Phrase, predicate: Phrase, names: Vocabulary) -> tuple[bool, Phrase, str]:
    """Whether it is about a state, the words of the proposition, and what is said of them."""
    said = lower(predicate)
    if said[:1] and said[0] in _ENSURING and len(said) > 1:
        return True, predicate[1:], "ensured"
    if said[:2] == ("make", "sure"):
        return True, predicate[2:], "ensured"
    for holds in _HOLDS:
        if said[: len(holds)] == holds and content(subject):
            rest = predicate[len(holds) :]
            return True, rest if rest and len(holds) == 3 else subject, "holds"
    if said[:1] and said[0] in _STATES and content(subject):
        if _says_enough(subject, predicate, names):
            return True, predicate, "ensured"
        return True, (*subject, *predicate), ""
    whole = (*subject, *predicate)
    known = matched(whole, names, names.propositions)
    alone = matched(predicate, names, names.propositions)
    if content(subject) and known and not alone:
        return False, whole, "named"
    return False, predicate, ""


def _says_enough(subject: Phrase, predicate: Phrase, names: Vocabulary) -> bool:
    """Whether a name of the project is about the predicate alone: the subject is a component."""
    match, value = matched(predicate, names, names.propositions), valued(predicate, names)
    known = match.name if match is not None else value[0] if value is not None else ""
    about = {part for word in content(subject) for part in stems(word.text)}
    return bool(known) and about.isdisjoint(stems(known))


def _without_no(subject: Phrase) -> tuple[Phrase, Phrase]:
    """The subject without a leading "no"; "neither a nor b" becomes "a or b"."""
    if subject and subject[0].lower == "neither":
        return tuple(_as_or(word) for word in subject[1:]), subject[:1]
    if subject and subject[0].lower == "no":
        return subject[1:], subject[:1]
    return subject, ()


def _as_or(word: Word) -> Word:
    return Word("or", word.start) if word.lower == "nor" else word


def _without_not(predicate: Phrase) -> tuple[Phrase, bool, Places]:
    """The predicate without the signs before its verb, and whether they negate it."""
    signs: list[Word] = []
    rest = predicate
    while rest and rest[0].lower in _NEVER:
        signs.append(rest[0])
        rest = rest[1:]
    if rest[1:2] and rest[0].lower in ("be", "remain") and rest[1].lower in _NEVER:
        signs.append(rest[1])
        rest = (rest[0], *rest[2:])
    return rest, len(signs) % 2 == 1, places(signs)


def _without_adverbs(phrase: Phrase) -> tuple[Phrase, tuple[tuple[Adverb, Places], ...]]:
    """The words without adverbs of time, and these."""
    rest, adverbs, index = list[Word](), list[tuple[Adverb, Places]](), 0
    said = lower(phrase)
    while index < len(phrase):
        wording, adverb = next(
            (each for each in _ADVERB_WORDS if said[index : index + len(each[0])] == each[0]),
            ((), None),
        )
        if adverb is None or (wording == ("next",) and index + 1 < len(phrase)):
            rest.append(phrase[index])
            index += 1
        else:
            adverbs.append((adverb, places(phrase[index : index + len(wording)])))
            index += len(wording)
    return tuple(rest), tuple(adverbs)


def _change(
    subject: Phrase, predicate: Phrase, names: Vocabulary
) -> tuple[Part, Part, Places] | None:
    """The states before and after of "shall change states from X to Y"."""
    said = lower(predicate)
    if "from" not in said or "to" not in said[said.index("from") :]:
        return None
    start = said.index("from")
    end = said.index("to", start)
    verb = stem(said[0])
    if verb not in _CHANGES or not predicate[start + 1 : end] or not predicate[end + 1 :]:
        return None
    kind = predicate[1:start]
    whole = tuple(word for word in kind if word.lower not in ("its", "the"))
    before = _state(whole, predicate[start + 1 : end], names)
    after = _state(whole, predicate[end + 1 :], names)
    same = before.expression == after.expression
    return None if same else (before, after, places(predicate))


def _state(kind: Phrase, value: Phrase, names: Vocabulary) -> Part:
    """`state = value` of an enumerated signal, else a name such as `state_nominal`."""
    singular = tuple(
        Word(w.lower.rstrip("s"), w.start) for w in kind if w.lower.rstrip("s") in ("state", "mode")
    )
    (part,) = propositions((*singular, *value), names)[:1]
    if isinstance(part.expression, e.Comparison):
        return part.using(places(kind))
    name = new_name((*(Word("in", -1),), *value))
    match = matched(value, names, names.propositions)
    if match is not None and not match.negated and not singular:
        return Part(e.Name(match.name), places((*kind, *value)), {match.name: text(value)})
    return Part(e.Name(name), places((*kind, *value)), {name: text((*kind, *value))})


def _cause(
    subject: Phrase, predicate: Phrase, names: Vocabulary
) -> tuple[Part, Phrase, Places] | None:
    """The event, the effect, and the causing verb of "exceeding the limit shall trigger a stop"."""
    if not predicate or not content(subject):
        return None
    said = lower(predicate)
    length = next((len(verb) for verb in _CAUSES if said[: len(verb)] == verb), 0)
    gerund = subject[0].lower.endswith("ing") and len(subject) > 1
    is_component = _component(subject, names)[0] in names.components
    if is_component or not (gerund or said[:length] in _EVENT_CAUSES) or length == len(said):
        return None
    return propositions(subject, names)[0], predicate[length:], places(predicate[:length])
