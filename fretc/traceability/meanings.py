"""The meaning of each text of a review, and the fingerprints computed from the texts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Any

import tomli_w

from compiler.files.records import Record
from compiler.files.text_files import sha256
from compiler.formalization.formalize import formalize
from compiler.project.hazards import Hazard
from fretc.audit.evidence import verdict_inputs
from fretc.traceability.chain import (
    ACCEPTANCE,
    ANALYSIS,
    ARTEFACT,
    FORMULAS,
    HAZARD,
    PARENT,
    PLAN,
    PROOF,
    SHARED,
    STATUS,
    TEXT,
    WORDS,
    ChainItem,
    status_node,
)
from fretc.traceability.fingerprints import (
    print_of_hazard,
    print_of_header,
    print_of_proof,
    print_of_status,
    print_of_words,
)
from fretc.traceability.texts import (
    BindingsTexts,
    ReviewedTexts,
    Table,
    canonical_text,
    header_of,
)
from fretish.bindings import canonical
from fretish.bindings.declarations import ComputedSignal, Declarations
from fretish.bindings.tables.reader import read_bindings
from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.printer import expression
from fretish.reading.recursion import with_recursion_limit


@dataclass(frozen=True, slots=True)
class ReviewText:
    """One text of a review."""

    node: ChainItem
    """The node whose fingerprint covers the text."""
    what: str
    """Name of the text for a reader, such as `title` or `max_age of vx`."""
    text: str
    meaning: Any
    """A value that is equal for two texts with the same meaning."""
    owner: str = ""
    """The table of the text, such as `signal vx`; "" if the table cannot be added or removed."""


Key = tuple[str, str, str]
"""Kind, name of the table, and field."""


# Each text -------------------------------------------------------------------------------------


def leaves(id: str, texts: ReviewedTexts) -> Mapping[Key, ReviewText]:
    """Each text of a requirement, in the order in which changes are listed."""
    texts_of = dict(_of_sentence(id, texts))
    declarations = _declarations(texts.bindings) if texts.bindings else None
    if texts.bindings is not None:
        texts_of |= _of_bindings(id, texts.bindings, declarations)
    parts = (_of_header(id, texts), _of_parents(texts), _of_audit(id, texts))
    return texts_of | dict(chain.from_iterable(parts))


def _of_sentence(id: str, texts: ReviewedTexts) -> Iterator[tuple[Key, ReviewText]]:
    written = _line(texts.sentence)
    sentence = texts.canonical or written
    yield (
        ("", "", "sentence"),
        ReviewText(ChainItem(verdict_inputs.SENTENCE, id), "sentence", written, sentence),
    )
    # A monitor quotes its sentence: another wording changes its text and not its meaning.
    wording = ReviewText(ChainItem(ARTEFACT, id), "wording", written, (sentence, written))
    yield ("", "", "wording"), wording
    for name, text in texts.params.items():
        meaning = canonical.parameter(text)
        node, what = ChainItem(verdict_inputs.PARAMS, id), f"number stated for {name}"
        yield ("params", name, ""), ReviewText(node, what, text, meaning, f"params {name}")


def _of_header(id: str, texts: ReviewedTexts) -> Iterator[tuple[Key, ReviewText]]:
    node = ChainItem(TEXT, id)
    for name in ("title", "text", "rationale", "kind"):
        text = _line(getattr(texts, name))
        yield ("", "", name), ReviewText(node, name, text, text)
    yield (
        ("", "", "parents"),
        ReviewText(node, "parents", ", ".join(texts.parents), {*texts.parents}),
    )
    retired = texts.status == "retired"
    yield ("", "", "status"), ReviewText(status_node(id), "status", texts.status, retired)
    plan = ChainItem(PLAN, id)
    yield ("", "", "verify"), ReviewText(plan, "verify", ", ".join(texts.verify), {*texts.verify})
    for name, reason in texts.accept.items():
        what, why = f"reason to accept {name}", _line(reason)
        leaf = ReviewText(ChainItem(ACCEPTANCE, name), what, why, why, f"accept {name}")
        yield (ACCEPTANCE, name, ""), leaf


def _of_parents(texts: ReviewedTexts) -> Iterator[tuple[Key, ReviewText]]:
    """The texts of hazards and of the requirements between them and this one."""
    tables: list[tuple[str, str, Mapping[str, str]]] = []
    for id, header in texts.above.items():
        texts_of = {name: text for name, text in _fields(header).items() if name != "parents"}
        tables.append((TEXT, id, texts_of))
        node, parents = ChainItem(TEXT, id), header.parents
        leaf = ReviewText(node, f"parents of {id}", ", ".join(parents), {*parents}, f"text {id}")
        yield (TEXT, id, "parents"), leaf
    tables += [(HAZARD, id, _fields(each)) for id, each in texts.hazards.items()]
    tables += [(PARENT, id, _fields(each)) for id, each in texts.elsewhere.items()]
    for kind, id, words in tables:
        for name, text in words.items():
            line = _line(text)
            leaf = ReviewText(ChainItem(kind, id), f"{name} of {id}", line, line, f"{kind} {id}")
            yield (kind, id, name), leaf


def _of_audit(id: str, texts: ReviewedTexts) -> Iterator[tuple[Key, ReviewText]]:
    if texts.topics is not None:
        node, names = ChainItem(verdict_inputs.TOPICS, "audited"), ", ".join(texts.topics)
        yield ("", "", "topics"), ReviewText(node, "topics that are read", names, texts.topics)
    for claim, (result, *assumptions) in texts.proofs.items():
        node, owner = ChainItem(PROOF, f"{id} {claim}"), f"proof {claim}"
        under = {*assumptions}
        yield (PROOF, claim, "result"), ReviewText(node, f"proof of {claim}", result, result, owner)
        text = "; ".join(assumptions)
        leaf = ReviewText(node, f"assumptions of the proof of {claim}", text, under, owner)
        yield (PROOF, claim, "assumptions"), leaf
    if texts.analysis:
        (verdict, *findings), node = texts.analysis, ChainItem(ANALYSIS, id)
        yield (ANALYSIS, "", "verdict"), ReviewText(node, "analysis", verdict, verdict, ANALYSIS)
        leaf = ReviewText(
            node, "findings of the analysis", "; ".join(findings), {*findings}, ANALYSIS
        )
        yield (ANALYSIS, "", "findings"), leaf
    for table, fields in texts.loop.items():
        for name, value in fields.items():
            text = _in_toml(value)
            leaf = ReviewText(
                ChainItem(SHARED, table), f"{name} of [{table}]", text, canonical.parameter(text)
            )
            yield (SHARED, table, name), leaf
    if texts.fretc:
        node = ChainItem(verdict_inputs.FRETC, "version")
        yield ("", "", "fretc"), ReviewText(node, "version of fretc", texts.fretc, texts.fretc)


def _fields(record: Record) -> dict[str, Any]:
    return {name: getattr(record, name) for name in record.__struct_fields__}


# Bindings --------------------------------------------------------------------------------------

_WORDS = ("text", "role", "kind")
_OUTLINE = ("footprint", "sensor")
_POSE = ("frame", "in", "path")
_GOALS = ("goal", "status")
_FIRST = {"expr", "value"}
"""Fields that are listed first."""
_CLOCK = ("tick", "time", "end", "phase", "rounding")


def _of_bindings(
    id: str, bindings: BindingsTexts, declarations: Declarations | None
) -> Mapping[Key, ReviewText]:
    """The texts of clock and tables; if they cannot be read, a text is its own meaning."""
    texts: dict[Key, ReviewText] = {}
    for name, table in bindings.proposition.items():
        texts |= _of_table(id, "proposition", name, table, _proposition(name, declarations))
    for name, table in bindings.signal.items():
        texts |= _of_table(id, "signal", name, table, _signal(name, declarations))
    for name, table in bindings.variable.items():
        texts |= _of_table(id, "variable", name, table, _variable(name, declarations))
    clock = declarations.clock if declarations else None
    for name in _CLOCK:
        node = (
            ChainItem(FORMULAS, id)
            if name == "rounding"
            else ChainItem(verdict_inputs.CLOCK, "clock")
        )
        meaning = (clock.period or clock.topic) if clock and name == "tick" else None
        meaning = getattr(clock, name) if clock and name != "tick" else meaning
        text = str(bindings.clock.get(name, ""))
        leaf = ReviewText(node, f"{name} of the clock", text, text if clock is None else meaning)
        texts["clock", "", name] = leaf
    return texts


def _of_table(
    id: str, kind: str, name: str, table: Table, meanings: Mapping[str, Any]
) -> Mapping[Key, ReviewText]:
    """The fields of a table that are written or have a meaning of their own."""
    return {
        (kind, name, field): ReviewText(
            ChainItem(_covered_by(kind, field), id),
            name if field in ("expr", "value") else f"{field} of {name}",
            _in_toml(table[field]) if field in table else "",
            meanings.get(field, _in_toml(table.get(field, ""))),
            f"{kind} {name}",
        )
        for field in dict.fromkeys((*(_FIRST & table.keys()), *table, *meanings))
    }


def _covered_by(kind: str, field: str) -> str:
    """The kind of node whose fingerprint covers the field."""
    if kind == "proposition" and field in _WORDS:
        return WORDS
    if kind == "variable":
        return verdict_inputs.SENTENCE if field == "value" else ARTEFACT
    if kind == "signal":
        return ARTEFACT if field == "role" else verdict_inputs.BINDINGS
    return verdict_inputs.BINDINGS if field in ("expr", "agg", "on_unknown") else ARTEFACT


def _proposition(name: str, declarations: Declarations | None) -> Mapping[str, Any]:
    known = declarations.propositions.get(name) if declarations else None
    if known is None:
        return {}
    words = {"text": _line(known.text), "role": str(known.role), "kind": known.kind}
    other = {"modality": str(known.modality), "action": known.action}
    return {**canonical.proposition_fields(known), **words, **other}


def _signal(name: str, declarations: Declarations | None) -> Mapping[str, Any]:
    known = declarations.measured.get(name) if declarations else None
    if known is None:
        return {}
    if isinstance(known, ComputedSignal):
        unit = canonical.unit_fields(known.unit)
        own = {"agg": str(known.aggregate), "role": str(known.role)}
        return {"value": canonical.expression(known.value), "unit": unit, **own}
    meanings = canonical.signal_fields(known)
    outline = meanings.pop("outline") or (None, None)
    own = {"agg": str(known.aggregate), "role": str(known.role)}
    for fields, kind in ((_POSE, "pose"), (_GOALS, "goals")):
        own |= dict(zip(fields, meanings.pop(kind, ()), strict=False))
    return {**meanings, **dict(zip(_OUTLINE, outline, strict=True)), **own}


def _variable(name: str, declarations: Declarations | None) -> Mapping[str, Any]:
    known = declarations.variables.get(name) if declarations else None
    if known is None:
        return {}
    value = expression(known.value) if known.value is not None else None
    words = {"text": _line(known.text), "role": known.role, "type": known.type}
    return {"value": value, "modality": str(known.modality), "action": known.action, **words}


@with_recursion_limit
def _in_toml(value: Any) -> str:
    """A string unchanged; any other value as TOML on one line."""
    if isinstance(value, str):
        return _line(value)
    if isinstance(value, dict):
        parts = ", ".join(f"{name} = {_quoted(each)}" for name, each in value.items())
        return f"{{ {parts} }}" if parts else "{}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_quoted, value))}]"
    return str(value).lower() if isinstance(value, bool) else str(value)


def _quoted(value: Any) -> str:
    return f'"{value}"' if isinstance(value, str) else _in_toml(value)


def _line(text: str) -> str:
    return " ".join(text.split())


@with_recursion_limit
def _declarations(bindings: BindingsTexts) -> Declarations | None:
    """The declarations of the tables, or None if the tables are not valid bindings."""
    tables = {"clock": bindings.clock, "signal": bindings.signal}
    tables |= {"proposition": bindings.proposition, "variable": bindings.variable}
    text = tomli_w.dumps({kind: table for kind, table in tables.items() if table})
    return read_bindings(Source("fretc.lock", text))[0]


# All of them -----------------------------------------------------------------------------------


def agree(id: str, texts: ReviewedTexts, prints: Mapping[ChainItem, str]) -> bool:
    """Whether the texts of a review match its fingerprints.

    A lock may be untrusted, so texts that do not match the fingerprints are never shown as
    accepted. The seal of a review, and so its signature, covers fingerprints and texts.
    """
    own = dict(_fingerprints(id, texts))
    ours = {node for node in prints if node.kind in _COVERED}
    return own.keys() == ours and all(own[node] == prints[node] for node in ours)


_VERSION = ChainItem(verdict_inputs.FRETC, "version")
_COVERED = (
    verdict_inputs.SENTENCE, verdict_inputs.PARAMS, verdict_inputs.CLOCK,
    verdict_inputs.TOPICS, verdict_inputs.BINDINGS, verdict_inputs.FRETC,
    TEXT, HAZARD, PARENT, STATUS, PLAN, ACCEPTANCE, WORDS,
    PROOF, ANALYSIS,
)  # fmt: skip
"""Kinds of nodes that have texts; formulas and artefacts are derived from them."""


def _of(value: Any) -> str:
    return canonical.digest(value)


def _fingerprints(id: str, texts: ReviewedTexts) -> Iterator[tuple[ChainItem, str]]:
    """The fingerprints that fretc computes from these texts."""
    yield status_node(id), print_of_status(texts.status)
    for method in texts.verify:
        yield ChainItem(PLAN, f"{id} {method}"), _of(method)
    for name, reason in texts.accept.items():
        yield ChainItem(ACCEPTANCE, name), print_of_words(reason)
    yield ChainItem(TEXT, id), print_of_header(header_of(texts))
    for above, header in texts.above.items():
        yield ChainItem(TEXT, above), print_of_header(header)
    for hazard, words in texts.hazards.items():
        yield ChainItem(HAZARD, hazard), print_of_hazard(Hazard(hazard, **_fields(words)))
    for parent, other in texts.elsewhere.items():
        yield ChainItem(PARENT, parent), print_of_words([other.title, other.text])
    for claim, (result, *assumptions) in texts.proofs.items():
        yield ChainItem(PROOF, f"{id} {claim}"), print_of_proof(result, assumptions)
    if texts.analysis:
        yield ChainItem(ANALYSIS, id), print_of_proof(texts.analysis[0], texts.analysis[1:])
    if texts.topics is not None:
        yield ChainItem(verdict_inputs.TOPICS, "audited"), _of(sorted(set(texts.topics)))
    if texts.fretc:
        yield _VERSION, _of(texts.fretc)
    yield from _of_meaning(id, texts)


def _of_meaning(id: str, texts: ReviewedTexts) -> Iterator[tuple[ChainItem, str]]:
    """Fingerprints of the sentence, its numbers, the clock and the bindings, parsed again."""
    declarations = _declarations(texts.bindings) if texts.bindings is not None else None
    wording = Source("fretc.lock", texts.sentence).span()
    requirement = (
        formalize(RequirementEntry(id, wording), declarations)[0] if texts.canonical else None
    )
    sentence = requirement.fingerprint if requirement else sha256(_line(texts.sentence))
    is_canonical = canonical_text(requirement) == texts.canonical
    yield ChainItem(verdict_inputs.SENTENCE, id), sentence if is_canonical else ""
    params = {name: canonical.parameter(text) for name, text in texts.params.items()}
    yield ChainItem(verdict_inputs.PARAMS, id), _of(params)
    clock = _of(canonical.clock(declarations.clock)) if declarations else ""
    yield ChainItem(verdict_inputs.CLOCK, "clock"), clock
    known = requirement.declarations or declarations if requirement else None
    bound = _of(canonical.bound(known, requirement.watched)) if requirement and known else ""
    yield ChainItem(verdict_inputs.BINDINGS, id), bound
    words = canonical.described(known, requirement.watched) if requirement else {}
    if words:
        yield ChainItem(WORDS, id), _of(words)
