"""`--emit fret-json`: requirements and variables as FRET imports them."""

from __future__ import annotations

import re
import uuid
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic import printing
from compiler.logic.spelling.reserved_words import FRET
from compiler.project.fret_import import STATUSES, is_assumption
from compiler.project.fret_variables import OWN, assignment_field, unquoted
from compiler.project.lustre import fretish, lustre
from compiler.targets.target import DEFAULT, Target, TargetOptions, not_expressible
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.comparisons import is_mixed
from fretish.bindings.declarations import Declarations, Role, Variable
from fretish.bindings.definitions import expanded
from fretish.checking import conditions, has_units, is_formula
from fretish.clock import SYMBOLS, duration_text
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.documents import ASSUMPTION, RequirementEntry
from fretish.keywords import RESERVED
from fretish.meaning import meaning
from fretish.parser import parse
from fretish.printer import expression, identifier, sentence, timing

_STATUSES = {"approved": "completed", "retired": "deprecated"}
_SPACE = uuid.UUID("6ba7b811-9dad-11d1-80b4-00c04fd430c8")
"""RFC 4122's name space of URLs, so that equal requirements have equal `_id`s."""


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """`fret.json` with all requirements: `{"requirements": [...], "variables": [...]}`."""
    read = {formalized.entry: _in_fretish(formalized) for formalized in requirements}
    ordered = [(entry, read.get(entry)) for entry in _ordered(requirements, options)]
    content = {
        "requirements": [
            requirement(formalized.entry if formalized else entry, formalized)
            for entry, formalized in ordered
        ],
        "variables": variables([*read.values()], options.declarations),
    }
    text = render("fret-json/fret.json.j2", content=content)
    return (Artifact(PurePosixPath("fret.json"), text),)


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601: FRET has no units and converts nothing, and reads the kind in the id."""
    entry = requirement.entry
    if is_formula(requirement.sentence):
        return not_expressible(
            "FRET", requirement, "a formula", "write it as sentences, or export `ltl`"
        )
    if entry.is_assumption is not is_assumption(entry.fret.get("reqid", entry.id)):
        kind = "an assumption without" if entry.is_assumption else "a requirement with"
        return not_expressible(
            "FRET", requirement, f"{kind} `{ASSUMPTION}` in its id", "change its `id` or its `kind`"
        )
    if _mixes_units(requirement):
        return not_expressible(
            "FRET",
            requirement,
            "a comparison of signals in several units",
            "bind it as `[proposition.NAME]`, and write that name",
        )
    if not has_units(requirement.sentence):
        return None
    return not_expressible(
        "FRET",
        requirement,
        "a number with a unit",
        "declare the signals beside it in bindings.toml, in one unit, or leave the unit out",
    )


def _in_fretish(requirement: FormalizedRequirement) -> FormalizedRequirement:
    """The requirement with the sentence as FRET reads it.

    Names stay as written, and FRET gets their definitions. If a definition or the sentence has a
    unit, numbers without units are used instead.
    """
    whole = expanded(requirement.written, requirement.definitions)
    assert isinstance(whole, s.Sentence), "it has been formalized"
    if has_units(whole):
        return _in_quotes(_without_units(requirement))
    return _in_quotes(_with_names(requirement) if requirement.definitions else requirement)


_FRETS_DURATION = re.compile(rf"[0-9]+\s*(?!(?:{'|'.join(SYMBOLS)})$)[A-Za-z]+")


def _with_frets_duration(requirement: FormalizedRequirement) -> str:
    """The sentence with its duration as a whole number and a word: `500 milliseconds`."""
    wording, bound = requirement.entry.wording, s.duration(requirement.written.timing)
    place = bound.span if bound else None
    if bound is None or place is None or _FRETS_DURATION.fullmatch(place.text):
        return wording.text
    start, end = place.start - wording.start, place.end - wording.start
    return wording.text[:start] + duration_text(bound) + wording.text[end:]


def _in_quotes(requirement: FormalizedRequirement) -> FormalizedRequirement:
    """The requirement with the duration in words, and quotes around names that FRET needs so."""
    wording = requirement.entry.wording
    component = requirement.written.component_span
    places = () if component is None else (component.start - wording.start,)
    text = quoted(_with_frets_duration(requirement), places)
    if text == wording.text:
        return requirement
    span = Source(wording.source.name, text).span()
    written = parse(span)
    assert written == requirement.written, "quotes and words change nothing"
    entry = replace(requirement.entry, wording=span)
    sentence = written if requirement.sentence == written else requirement.sentence
    return replace(requirement, entry=entry, written=written, sentence=sentence)


_NAMES = re.compile(r'"[^"\n]*"|[A-Za-z][A-Za-z0-9_.%]*')


def quoted(text: str, others: Collection[int] = ()) -> str:
    """The FRETish text with quotes around names that FRET's editor refuses otherwise.

    Args:
        text: a sentence, or a part of it.
        others: positions of names that are left unquoted.
    """
    return _NAMES.sub(lambda m: _name(m[0]) if m.start() not in others else m[0], text)


def _name(id: str) -> str:
    """The name in quotes, `"T"` for `T`, unless it is a key word of FRETish in any case."""
    return f'"{id}"' if id in FRET and id.lower() not in RESERVED else id


def _variable_name(id: str) -> str:
    """FRET's name of a variable, with its quotes in the sentence."""
    return f'"{id}"' if id in FRET else identifier(id)


def _with_names(requirement: FormalizedRequirement) -> FormalizedRequirement:
    """The requirement without definitions of the names of its sentence."""
    assert requirement.declarations is not None, "they define the names"
    variables = {
        name: replace(variable, value=None, of={})
        for name, variable in requirement.declarations.variables.items()
    }
    plain, _ = formalize(requirement.entry, replace(requirement.declarations, variables=variables))
    return replace(plain, glossary=requirement.glossary) if plain else _without_units(requirement)


def _mixes_units(requirement: FormalizedRequirement) -> bool:
    """Whether FRET would compare metres with centimetres, since its variables have no units."""
    signals = requirement.declarations.measured if requirement.declarations else {}
    return any(
        isinstance(part, e.Comparison) and is_mixed(part, signals, requirement.entry.wording)
        for tree in conditions(requirement.written)
        for part in e.parts(tree)
    )


def _without_units(requirement: FormalizedRequirement) -> FormalizedRequirement:
    """The requirement with numbers without units, in the signals' units."""
    text = Source(requirement.entry.wording.source.name, sentence(requirement.sentence)).span()
    written = parse(text)
    assert isinstance(written, s.Sentence), "what is printed is a sentence"
    entry = replace(requirement.entry, wording=text)
    return replace(requirement, entry=entry, written=written, sentence=written, definitions={})


def _ordered(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions
) -> list[RequirementEntry]:
    """The entries of requirements and free texts, in the order of files and within files."""
    entries = [*(requirement.entry for requirement in requirements), *options.free_texts]
    files = list(dict.fromkeys(entry.wording.source.name for entry in entries))
    return sorted(
        entries, key=lambda entry: (files.index(entry.wording.source.name), entry.wording.start)
    )


def requirement(
    entry: RequirementEntry, requirement: FormalizedRequirement | None
) -> dict[str, Any]:
    """FRET's record of one requirement; an unformalized one becomes free text."""
    fret = entry.fret
    return {
        "reqid": fret.get("reqid", entry.id),
        "parent_reqid": fret.get("parent_reqid", ", ".join(entry.parents)),
        "project": fret.get("project", ""),
        "rationale": entry.rationale,
        "comments": fret.get("comments", ""),
        "status": _status(entry),
        "fulltext": entry.wording.text,
        **_own(entry),
        "semantics": semantics(requirement) if requirement else {"type": "freeForm"},
        "input": {},
        "_id": _id(entry),
    }


def _own(entry: RequirementEntry) -> dict[str, dict[str, str]]:
    """Fields that FRET lacks, for `fretc import` of the file."""
    texts = {"title": entry.title, "text": entry.text}
    own = {name: text for name, text in texts.items() if text}
    return {OWN: own} if own else {}


def _status(entry: RequirementEntry) -> str:
    """FRET's status if it still means the same, else the nearest one."""
    status = entry.fret.get("status", "")
    if STATUSES.get(status, "draft") == entry.status:
        return status
    return _STATUSES.get(entry.status, "")


def _id(entry: RequirementEntry) -> str:
    name = f"fretc:{entry.fret.get('project', '')}/{entry.id}"
    return entry.fret.get("_id") or str(uuid.uuid5(_SPACE, name))


def semantics(requirement: FormalizedRequirement) -> dict[str, Any]:
    """FRET's description of a sentence, with the formulas in FRET's notation."""
    tree = requirement.sentence
    base = requirement.entry.wording.start
    fields: dict[str, Any] = {
        "type": "nasa",
        "scope": {"type": s.scope_key(tree)},
        "condition": s.condition_key(tree),
        "probability": "bound" if tree.probability else "null",
        "timing": s.timing_key(tree),
        "response": "satisfaction",
        "variables": list(map(_variable_name, requirement.variables)),
        "component_name": tree.component,
        "component": tree.component,
        "post_condition": f"({quoted(expression(tree.response))})",
        "description": meaning(tree, requirement.ticks, requirement.clock),
        "ft": printing.text(requirement.ft_finite, printing.FRET),
        "pt": printing.text(requirement.pt, printing.FRET),
        "ftExpanded": printing.text(requirement.ft_finite, printing.FRET),
        "ftInfAUExpanded": printing.text(requirement.ft_infinite, printing.FRET),
        "ptExpanded": printing.text(requirement.pt, printing.FRET),
    }
    fields |= _parts(tree)
    if requirement.pctl is not None:
        fields["pctlExpanded"] = printing.pctl(requirement.pctl)
    for name, span in _spans(tree).items():
        if span is not None:
            fields[f"{name}TextRange"] = [span.start - base, span.end - base - 1]
    return fields


def _parts(tree: s.Sentence) -> dict[str, Any]:
    """The fields that depend on the form of the sentence."""
    fields: dict[str, Any] = {}
    if tree.scope is not None:
        fields["scope_mode"] = quoted(expression(tree.scope.mode))
    if tree.condition is not None:
        condition = f"({quoted(expression(tree.condition.expression))})"
        fields |= {
            "qualifier_word": tree.condition.word,
            "pre_condition": condition,
            "regular_condition": condition,
        }
    stop = s.stop(tree.timing)
    if stop is not None:
        fields["stop_condition"] = f"({quoted(expression(stop))})"
    duration = s.duration(tree.timing)
    if duration is not None:
        fields["duration"] = str(duration.amount)
    if tree.probability is not None:
        fields["probability_bound"] = [tree.probability.op, tree.probability.digits]
    if timing(tree.timing):
        fields["timingText"] = quoted(timing(tree.timing))
    return fields


def _spans(tree: s.Sentence) -> dict[str, Span | None]:
    return {
        "scope": tree.scope.span if tree.scope else None,
        "condition": tree.condition.span if tree.condition else None,
        "component": tree.component_span,
        "timing": tree.timing_span,
    }


def variables(
    requirements: Sequence[FormalizedRequirement], declarations: Declarations | None = None
) -> list[dict[str, Any]]:
    """FRET's records of all variables, with types and roles where the bindings declare them.

    Variables that no sentence names come next, and then the records that `fretc import` kept
    without reading them. A kept record replaces one that is derived from another project.
    """
    records: dict[tuple[str, str, str], dict[str, Any]] = {}
    for requirement in requirements:
        project = requirement.entry.fret.get("project", "")
        component = requirement.sentence.component
        for name in requirement.variables:
            key = (project, component, name)
            record = records.setdefault(
                key, _variable(requirement.glossary.get(name), project, component, name)
            )
            record["reqs"].append(_id(requirement.entry))
    named = [*records]
    own: set[tuple[str, str, str]] = set()
    for name, variable in _glossary(requirements, declarations):
        project, component = variable.fret.get("project", ""), variable.component
        key = (project, component, name)
        own.add(key)
        if not any(_is_of(key, identity) for identity in named):
            records[key] = _variable(variable, project, component, name)
    return _with_kept(records, own, declarations.fret if declarations else ())


def _is_of(variable: tuple[str, str, str], named: tuple[str, str, str]) -> bool:
    """Whether a sentence names the variable; hand-written bindings need not name a component."""
    return variable[2] == named[2] and all(
        a == b or not a or (index == 0 and not b)
        for index, (a, b) in enumerate(zip(variable[:2], named[:2], strict=True))
    )


def _glossary(
    requirements: Sequence[FormalizedRequirement], declarations: Declarations | None
) -> Iterator[tuple[str, Variable]]:
    """Each name with its declaration, for each component."""
    if declarations is None:
        yield from requirements[0].glossary.items() if requirements else ()
        return
    for name, variable in declarations.variables.items():
        yield from ((name, declared) for declared in (variable, *variable.of.values()))


def _with_kept(
    records: Mapping[tuple[str, str, str], dict[str, Any]],
    own: Collection[tuple[str, str, str]],
    kept: Sequence[Mapping[str, Any]],
) -> list[dict[str, Any]]:
    """All records; FRET's kept record of a variable has priority."""
    merged = dict(records)
    more: list[dict[str, Any]] = []
    for record in kept:
        fields = ("project", "component_name", "variable_name")
        project, component, name = (str(record.get(field, "")) for field in fields)
        key = (project, component, unquoted(name))
        if key in records and key not in own and merged[key] is records[key]:
            merged[key] = {**record, "reqs": records[key]["reqs"]}
        else:
            more.append(dict(record))
    return [*merged.values(), *more]


def _variable(glossary: Variable | None, project: str, component: str, name: str) -> dict[str, Any]:
    fret = dict(glossary.fret) if glossary else {}
    is_own = (fret.pop("project", ""), glossary.component if glossary else "") == (
        project,
        component,
    )
    if not is_own:
        fret.pop("_id", None)
    role = glossary.role if glossary else ""
    if glossary is not None and glossary.value is not None:
        fret |= _assignment(glossary, fret)
        role = role or Role.INTERNAL  # of others FRET reads no assignment
    return {
        "project": project,
        "component_name": component,
        "variable_name": _variable_name(name),
        "reqs": [],
        "dataType": glossary.type if glossary else "",
        "idType": role.capitalize(),
        "moduleName": "",
        "description": glossary.text if glossary else "",
        "assignment": "",
        "modeRequirement": "",
        "modeldoc": False,
        "completed": False,
        "_id": f"{project}{component}{_variable_name(name)}",
        **fret,
    }


def _assignment(glossary: Variable, fret: Mapping[str, Any]) -> dict[str, Any]:
    """The assignment of a variable as FRET wrote it, or for FRET; the import reads ours."""
    assert glossary.value is not None
    field = assignment_field(glossary.role)
    kept = fret.get(field, "")
    if isinstance(kept, str) and fretish(kept) == glossary.value:
        return {}
    text = lustre(glossary.value) or ""
    own = {} if fretish(text) == glossary.value else {OWN: {"value": expression(glossary.value)}}
    return {field: text, **own}


TARGET = Target(
    "fret-json",
    "requirements and variables, as FRET imports them",
    emit,
    refuse,
    per_rule=False,
    names=lambda requirement: {name: _variable_name(name) for name in requirement.variables},
)
