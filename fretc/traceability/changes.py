"""Changes since a review, each with its text before and after."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any

from compiler.files.records import replace
from fretc.audit.evidence import verdict_inputs
from fretc.traceability import word_diff
from fretc.traceability.chain import (
    ACCEPTANCE,
    ADDED,
    ANALYSIS,
    ARTEFACT,
    DERIVED,
    FORMULAS,
    HAZARD,
    LOG,
    MEMBER,
    PARENT,
    PLAN,
    PROOF,
    SHARED,
    TEXT,
    VERDICT,
    WORDS,
    Chain,
    ChainItem,
)
from fretc.traceability.meanings import Key, ReviewText, leaves
from fretc.traceability.suspects import Suspect, changed, upstream_of
from fretc.traceability.texts import BindingsTexts, ReviewedTexts
from fretc.traceability.word_diff import Segment
from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class ReviewChange:
    """One change since a review."""

    node: ChainItem
    """The node that the changed text is part of."""
    what: str
    """Name of the changed text, such as `title` or `max_age of vx`."""
    before: str | None
    """Text at the review; "" if there was none; None if the lock does not record it."""
    after: str | None
    """Text now; "" if there is none; None if the item has no text."""
    is_of_evidence: bool = False
    """Whether only the evidence is about another version, without a change since the review."""
    is_table: bool = False
    """Whether a whole table was added or removed, so that an absent text has no default."""

    @property
    def is_of_analysis(self) -> bool:
        """Whether only the analysis is out of date, because another requirement has changed."""
        return self.is_of_evidence and self.node.kind == MEMBER

    @property
    def text(self) -> str:
        """`speed: vx <= 0.40 m/s → 0.35 m/s`: only the differing word, if there is only one."""
        if self.is_of_evidence:
            if self.node.kind == MEMBER:
                return f"the analysis used another version of {self.node.name}"
            known = self.node.kind in (*verdict_inputs.KINDS, verdict_inputs.FRETC)
            about = f"the evidence is about another version of: {self.what}"
            return verdict_inputs.why(self.node.kind) if known else about
        if self.before is None:
            now = f" is {self.after} now" if self.after else " changed"
            return f"{self.what}{now}; the lock does not record the earlier value"
        if self.after is None:
            return f"{self.what} changed"
        return f"{self.what}: {word_diff.short(*self._texts)}"

    @property
    def _absent(self) -> str:
        """The words for an absent text; an omitted field has a default."""
        has_default = self.node.kind in _WITH_DEFAULTS and not self.is_table
        return "not stated" if has_default else "none"

    @property
    def brief(self) -> str:
        """`text` within a sentence, cut if it is long."""
        if not self.is_of_evidence and (self.before is None or self.after is None):
            return f"{self.what} changed"
        return self.text if len(self.text) <= _BRIEF else f"{self.text[: _BRIEF - 2]} …"

    @property
    def segments(self) -> tuple[Segment, ...]:
        """Word difference of both texts; empty if one of them is unknown."""
        if self.before is None or self.after is None:
            return ()
        return word_diff.segments(*self._texts)

    @property
    def _texts(self) -> tuple[str, str]:
        return self.before or self._absent, self.after or self._absent

    def makes_suspect(self, link: Suspect) -> bool:
        """Whether this change makes the link suspect."""
        kind = self.node.kind
        return any(c == self.node or (c.kind == kind and kind in _MANY) for c in link.causes)

    @property
    def as_record(self) -> dict[str, Any]:
        """Plain values, in a fixed order of keys."""
        return {
            "thing": str(self.node),
            "what": self.what,
            "before": self.before,
            "after": self.after,
            "text": self.text,
        }


_BRIEF = 120
"""Maximum number of characters of a change within a sentence."""
_WITH_DEFAULTS = (verdict_inputs.BINDINGS, verdict_inputs.CLOCK, WORDS, FORMULAS, ARTEFACT)


def changes(
    chain: Chain,
    prints: Mapping[ChainItem, str],
    verdicts: Mapping[str, str],
    texts: ReviewedTexts | None,
    causes: Collection[ChainItem],
) -> tuple[ReviewChange, ...]:
    """Each change of a requirement since its review, without changes that follow from others.

    Args:
        chain: the present chain.
        prints: node → SHA-256 at the review.
        verdicts: run → verdict at the review.
        texts: the texts of the review; None if its fingerprints do not confirm them.
        causes: the nodes that make links of the requirement suspect; each of them is reported.
    """
    comparison = _Comparison(chain, prints, verdicts, texts)
    all_changes = [*comparison.of_texts(), *comparison.of_nodes()]
    return (*all_changes, *comparison.of_causes(causes, all_changes))


def in_words(changes: Sequence[ReviewChange]) -> str:
    """One sentence with the first changes, changes of requirements before changes of evidence."""
    own = [change.brief for change in changes if not change.is_of_evidence]
    named = own or [change.brief for change in changes]
    left = len(named) - _IN_A_SENTENCE
    more = [f"and {left} more"] if left > 0 else []
    return "; ".join([*named[:_IN_A_SENTENCE], *more])


_IN_A_SENTENCE = 3


class _Comparison:
    """Comparison of one requirement with its review."""

    def __init__(
        self,
        chain: Chain,
        prints: Mapping[ChainItem, str],
        verdicts: Mapping[str, str],
        texts: ReviewedTexts | None,
    ) -> None:
        self._chain, self._prints, self._verdicts = chain, prints, verdicts
        self._now = chain.prints
        self._verdicts_now = chain.verdicts
        self._nodes = frozenset(changed(self._now, prints))
        self._texts = texts
        self._explained: set[ChainItem] = set()

    # Texts

    def of_texts(self) -> Iterator[ReviewChange]:
        """Changes of texts whose meaning has changed."""
        now = self._chain.texts
        if self._texts is None or now is None or not self._nodes:
            return
        id = self._chain.requirement
        then, now = _without_equal_tables(self._texts, now)
        before, after = leaves(id, then), leaves(id, now)
        keys = dict.fromkeys((*before, *after))
        pairs = {key: (before.get(key), after.get(key)) for key in keys}
        different = {key: pair for key, pair in pairs.items() if self._differs(*pair)}
        texts = [leaf.node for pair in different.values() for leaf in pair if leaf is not None]
        kinds = {node.kind for node in texts if node.kind in _MANY}
        self._explained |= {*texts, *(node for node in self._nodes if node.kind in kinds)}
        yield from _merged(different, before, after)

    def _differs(self, before: ReviewText | None, after: ReviewText | None) -> bool:
        leaf = before or after
        assert leaf is not None
        kinds = {node.kind for node in self._nodes}
        is_touched = (
            leaf.node.kind in kinds if leaf.node.kind in _MANY else leaf.node in self._nodes
        )
        if not is_touched or before is None or after is None:
            return is_touched
        return before.text != after.text and before.meaning != after.meaning

    # Things without a text

    def of_nodes(self) -> Iterator[ReviewChange]:
        """Changes of nodes that no text shows and that do not follow from another change."""
        above = upstream_of(self._now, self._chain.links) if self._nodes - self._explained else {}
        for node in sorted(self._nodes - self._explained):
            is_new = node not in self._prints and node.kind in ADDED
            is_gone = node not in self._now and node.kind in _ONLY_OF_EVIDENCE
            derived = node.kind in DERIVED and above.get(node, frozenset()) & self._nodes
            if not (is_new or is_gone or derived or self._follows(node)):
                yield self._named(node)

    def _follows(self, node: ChainItem) -> bool:
        """Whether the change of the node follows from a changed node to which it has no link."""
        id = self._chain.requirement
        kinds = {each.kind for each in self._nodes if each.kind != TEXT or each.name == id}
        if node.kind == verdict_inputs.FRETC:  # A node has no version if it has no formulas.
            is_other = node in self._prints and node in self._now
            return not is_other and verdict_inputs.SENTENCE in kinds
        sources = _SOURCES if self._texts is None else {**_SOURCES, **_SOURCES_OF_TEXTS}
        return bool(kinds & sources.get(node.kind, frozenset()))

    def _named(self, node: ChainItem) -> ReviewChange:
        """The change of a node of which only the fingerprint is recorded."""
        run = node.name.removeprefix(f"{self._chain.requirement} ")
        before, after = self._prints.get(node, ""), self._now.get(node, "")
        if node.kind == LOG and node not in self._now:
            return ReviewChange(node, f"verdict of {run}", self._verdicts.get(run, ""), "")
        if node.kind == VERDICT:
            then, now = self._verdicts.get(run, ""), self._verdicts_now.get(run, "")
            if then != now:
                return ReviewChange(node, f"verdict of {run}", then, now)
            return ReviewChange(node, f"what was found in {run}", None, None)
        if node.kind in (LOG, ARTEFACT, SHARED):
            return ReviewChange(node, f"{node.kind} {run}", _digest(before), _digest(after))
        return ReviewChange(node, thing(node), None, None)

    def of_causes(
        self, causes: Collection[ChainItem], changes: Collection[ReviewChange]
    ) -> Iterator[ReviewChange]:
        """Causes of suspect links that no change in `changes` reports."""
        own = ChainItem(MEMBER, self._chain.requirement)
        for cause in causes:
            if cause == own and changes:
                continue
            if cause not in self._nodes:
                yield ReviewChange(cause, thing(cause), None, None, is_of_evidence=True)
            elif not changes:
                yield self._named(cause)


def thing(node: ChainItem) -> str:
    """The name of a node for a reader: `artefact r1_monitor.py`, `the clock`."""
    if node.kind in (verdict_inputs.CLOCK, verdict_inputs.TOPICS):
        return f"the {node.kind}"
    return f"{node.kind} {node.name}"


def _digest(sha256: str) -> str:
    return f"SHA-256 {sha256[:12]}" if sha256 else ""


_MANY = (ARTEFACT, FORMULAS, PLAN, SHARED)
"""Kinds with several nodes per requirement, all of which one text is about."""
_ONLY_OF_EVIDENCE = (VERDICT, verdict_inputs.TOPICS)
"""Kinds of nodes that exist only if there are runs; the node of the log reports a removed run."""
_SOURCES: Mapping[str, frozenset[str]] = {
    ARTEFACT: frozenset(
        {TEXT, verdict_inputs.PARAMS, verdict_inputs.BINDINGS, WORDS, FORMULAS, PLAN}
    ),
    FORMULAS: frozenset({verdict_inputs.BINDINGS}),
    SHARED: frozenset({PROOF}),
}
"""Kind of a node → other kinds that it may be derived from without a link."""
_SOURCES_OF_TEXTS: Mapping[str, frozenset[str]] = {
    verdict_inputs.BINDINGS: frozenset({verdict_inputs.SENTENCE}),
    WORDS: frozenset({verdict_inputs.SENTENCE, verdict_inputs.BINDINGS}),
    verdict_inputs.TOPICS: frozenset({verdict_inputs.SENTENCE, verdict_inputs.BINDINGS}),
    PROOF: frozenset({verdict_inputs.SENTENCE, verdict_inputs.BINDINGS}),
}
"""`_SOURCES` for kinds whose texts do not show a change of the node itself."""


# One change of many texts ----------------------------------------------------------------------

_Pairs = Mapping[Key, tuple[ReviewText | None, ReviewText | None]]
_ABOVE = (HAZARD, PARENT, TEXT)


def _without_equal_tables(
    then: ReviewedTexts, now: ReviewedTexts
) -> tuple[ReviewedTexts, ReviewedTexts]:
    """Both texts without equal tables of bindings, which would take time to read."""
    before, after = then.bindings, now.bindings
    if before is None or after is None:
        return then, now
    kept: list[BindingsTexts | None] = [before, after]
    if before == after:
        kept = [None, None]
    elif _tables(before) == _tables(after):
        kept = [BindingsTexts(before.clock), BindingsTexts(after.clock)]
    return replace(then, bindings=kept[0]), replace(now, bindings=kept[1])


def _tables(bindings: BindingsTexts) -> tuple[Any, ...]:
    return bindings.signal, bindings.proposition, bindings.variable


def _merged(
    different: _Pairs, before: Mapping[Key, ReviewText], after: Mapping[Key, ReviewText]
) -> Iterator[ReviewChange]:
    """A change for each text, or for each added or removed table that follows from no other."""
    owners = [{leaf.owner for leaf in side.values()} for side in (before, after)]
    lone = {owner for owner in owners[0] ^ owners[1] if owner}
    for key, (then, now) in different.items():
        leaf = then or now
        assert leaf is not None
        if leaf.owner in lone:
            if key[2] == _FACE.get(key[0]) and not _comes_with(key[0], different, lone):
                yield _change(_name(key, leaf), then, now, is_table=True)
        elif not _is_repetition(key, different):
            yield _change(leaf.what, then, now)


def _is_repetition(key: Key, different: _Pairs) -> bool:
    """Whether another changed text already implies this change."""
    if key == _WORDING:
        return _SENTENCE in different
    own = _SENTENCE in different or any(field == "path" for _, _, field in different)
    return key == ("", "", "topics") and own


def _change(
    what: str, then: ReviewText | None, now: ReviewText | None, *, is_table: bool = False
) -> ReviewChange:
    leaf = now or then
    assert leaf is not None
    before, after = then.text if then else "", now.text if now else ""
    return ReviewChange(leaf.node, what, before, after, is_table=is_table)


_SENTENCE, _WORDING = ("", "", "sentence"), ("", "", "wording")
_FACE = {
    "proposition": "expr", "signal": "path", "variable": "value", HAZARD: "title", PARENT: "title",
    TEXT: "title", PROOF: "result", ANALYSIS: "verdict", "params": "", ACCEPTANCE: "",
}  # fmt: skip
"""Kind of a table → the field that represents an added or removed table."""


def _name(key: Key, leaf: ReviewText) -> str:
    kind, name, _ = key
    return f"{kind} {name}" if kind in ("signal", *_ABOVE) else leaf.what


def _comes_with(kind: str, different: _Pairs, lone: Collection[str]) -> bool:
    """Whether a table is added or removed only because another text began or ceased to use it."""
    if kind in _ABOVE:
        return any(field == "parents" for _, _, field in different)
    sentences = [key for key in different if key == _SENTENCE or key[0] == "variable"]
    if kind == "variable":
        return _SENTENCE in different
    if kind == "proposition":
        return bool(sentences)
    expressions = [key for key in different if key[0] == "proposition" and key[2] == "expr"]
    return kind == "signal" and bool(sentences or expressions)
