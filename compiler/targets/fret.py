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
from compiler.project.fret_import import OWN, STATUSES, assignment_field, unquoted
from compiler.project.lustre import fretish, lustre
from compiler.targets.target import DEFAULT, Options, Target, not_expressible
from fretish import expressions as e
from fretish import syntax as s
from fretish.bindings.comparisons import is_mixed
from fretish.bindings.declarations import Declarations, Role, Variable
from fretish.bindings.definitions import expanded
from fretish.checking import conditions, has_units
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.documents import Requirement
from fretish.keywords import RESERVED
from fretish.meaning import meaning
from fretish.parser import parse
from fretish.printer import expression, identifier, sentence, timing

_STATUSES = {"approved": "completed", "retired": "deprecated"}
_SPACE = uuid.UUID("6ba7b811-9dad-11d1-80b4-00c04fd430c8")
"""RFC 4122's name space of URLs: the same requirement always has the same `_id`."""


def emit(
    rules: Sequence[FormalizedRequirement], options: Options = DEFAULT
) -> tuple[Artifact, ...]:
    """`fret.json` with all rules: `{"requirements": [...], "variables": [...]}`."""
    read = {id(rule.requirement): _in_fretish(rule) for rule in rules}
    ordered = [(entry, read.get(id(entry))) for entry in _ordered(rules, options)]
    content = {
        "requirements": [
            requirement(rule.requirement if rule else entry, rule) for entry, rule in ordered
        ],
        "variables": variables([*read.values()], options.declarations),
    }
    text = render("fret-json/fret.json.j2", content=content)
    return (Artifact(PurePosixPath("fret.json"), text),)


def refuse(rule: FormalizedRequirement) -> Diagnostic | None:
    """F601: FRET has no units, and converts nothing."""
    if _mixes_units(rule):
        return not_expressible(
            "FRET",
            rule,
            "a comparison of signals in several units",
            "bind it under a name of its own, `[proposition.NAME]`, and write that name",
        )
    if not has_units(rule.sentence):
        return None
    return not_expressible(
        "FRET",
        rule,
        "a number with a unit",
        "declare the signals beside it in bindings.toml, in one unit, or leave the unit out",
    )


def _in_fretish(rule: FormalizedRequirement) -> FormalizedRequirement:
    """The rule of the sentence that FRET reads.

    Its names stand there as they are written, and FRET has what they stand for. Where a unit is
    among that, or in the sentence, it is the sentence of bare numbers.
    """
    whole = expanded(rule.written, rule.definitions)
    assert isinstance(whole, s.Sentence), "it has been formalized"
    if has_units(whole):
        return _in_quotes(_without_units(rule))
    return _in_quotes(_with_names(rule) if rule.definitions else rule)


def _in_quotes(rule: FormalizedRequirement) -> FormalizedRequirement:
    """The rule of the same sentence, with quotes around names that FRET does not read without."""
    wording = rule.requirement.wording
    component = rule.written.component_span
    places = () if component is None else (component.start - wording.start,)
    text = quoted(wording.text, places)
    if text == wording.text:
        return rule
    span = Source(wording.source.name, text).span()
    written = parse(span)
    assert written == rule.written, "quotes change nothing"
    requirement = replace(rule.requirement, wording=span)
    sentence = written if rule.sentence == written else rule.sentence
    return replace(rule, requirement=requirement, written=written, sentence=sentence)


_NAMES = re.compile(r'"[^"\n]*"|[A-Za-z][A-Za-z0-9_.%]*')


def quoted(text: str, others: Collection[int] = ()) -> str:
    """A text of FRETish in which `T` is `"T"`: a name that FRET's editor refuses without quotes.

    Args:
        text: a sentence, or a part of it.
        others: where a name begins that is left alone.
    """
    return _NAMES.sub(lambda m: _name(m[0]) if m.start() not in others else m[0], text)


def _name(id: str) -> str:
    """`"T"` for `T`; a key word of FRETish is none of them, whatever its case."""
    return f'"{id}"' if id in FRET and id.lower() not in RESERVED else id


def _variable_name(id: str) -> str:
    """As FRET names the variable of a sentence: with the quotes that it has there."""
    return f'"{id}"' if id in FRET else identifier(id)


def _with_names(rule: FormalizedRequirement) -> FormalizedRequirement:
    """The rule as if the names of its sentence stood for nothing."""
    assert rule.declarations is not None, "they define the names"
    variables = {
        name: replace(variable, value=None, of={})
        for name, variable in rule.declarations.variables.items()
    }
    plain, _ = formalize(rule.requirement, replace(rule.declarations, variables=variables))
    return replace(plain, glossary=rule.glossary) if plain else _without_units(rule)


def _mixes_units(rule: FormalizedRequirement) -> bool:
    """Whether FRET would compare metres with centimetres: its variables are bare numbers."""
    signals = rule.declarations.signals if rule.declarations else {}
    return any(
        isinstance(part, e.Comparison) and is_mixed(part, signals, rule.requirement.wording)
        for tree in conditions(rule.written)
        for part in e.parts(tree)
    )


def _without_units(rule: FormalizedRequirement) -> FormalizedRequirement:
    """The rule as if its sentence had been written with bare numbers, in the signals' own units."""
    text = Source(rule.requirement.wording.source.name, sentence(rule.sentence)).span()
    written = parse(text)
    assert isinstance(written, s.Sentence), "what is printed is a sentence"
    requirement = replace(rule.requirement, wording=text)
    return replace(rule, requirement=requirement, written=written, sentence=written, definitions={})


def _ordered(rules: Sequence[FormalizedRequirement], options: Options) -> list[Requirement]:
    """Those of rules and free texts, in the order of their files, and of each file."""
    entries = [*(rule.requirement for rule in rules), *options.free_texts]
    files = list(dict.fromkeys(entry.wording.source.name for entry in entries))
    return sorted(
        entries, key=lambda each: (files.index(each.wording.source.name), each.wording.start)
    )


def requirement(entry: Requirement, rule: FormalizedRequirement | None) -> dict[str, Any]:
    """FRET's record of one requirement; one without a rule is free text."""
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
        "semantics": semantics(rule) if rule else {"type": "freeForm"},
        "input": {},
        "_id": _id(entry),
    }


def _own(entry: Requirement) -> dict[str, dict[str, str]]:
    """Fields that FRET lacks, for `fretc import` of the same file."""
    texts = {"title": entry.title, "text": entry.text}
    own = {name: text for name, text in texts.items() if text}
    return {OWN: own} if own else {}


def _status(entry: Requirement) -> str:
    """FRET's own status where it still means the same, else the nearest."""
    status = entry.fret.get("status", "")
    if STATUSES.get(status, "draft") == entry.status:
        return status
    return _STATUSES.get(entry.status, "")


def _id(entry: Requirement) -> str:
    name = f"fretc:{entry.fret.get('project', '')}/{entry.id}"
    return entry.fret.get("_id") or str(uuid.uuid5(_SPACE, name))


def semantics(rule: FormalizedRequirement) -> dict[str, Any]:
    """FRET's description of a sentence, with our formulas in FRET's spelling."""
    tree = rule.sentence
    base = rule.requirement.wording.start
    fields: dict[str, Any] = {
        "type": "nasa",
        "scope": {"type": s.scope_key(tree)},
        "condition": s.condition_key(tree),
        "probability": "bound" if tree.probability else "null",
        "timing": s.timing_key(tree),
        "response": "satisfaction",
        "variables": list(map(_variable_name, rule.variables)),
        "component_name": tree.component,
        "component": tree.component,
        "post_condition": f"({quoted(expression(tree.response))})",
        "description": meaning(tree, rule.ticks, rule.clock),
        "ft": printing.text(rule.ft_finite, printing.FRET),
        "pt": printing.text(rule.pt, printing.FRET),
        "ftExpanded": printing.text(rule.ft_finite, printing.FRET),
        "ftInfAUExpanded": printing.text(rule.ft_infinite, printing.FRET),
        "ptExpanded": printing.text(rule.pt, printing.FRET),
    }
    fields |= _parts(tree)
    if rule.pctl is not None:
        fields["pctlExpanded"] = printing.pctl(rule.pctl)
    for name, span in _spans(tree).items():
        if span is not None:
            fields[f"{name}TextRange"] = [span.start - base, span.end - base - 1]
    return fields


def _parts(tree: s.Sentence) -> dict[str, Any]:
    """The fields that only some sentences have."""
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
    rules: Sequence[FormalizedRequirement], declarations: Declarations | None = None
) -> list[dict[str, Any]]:
    """FRET's records of all variables; types and roles as far as the bindings know them.

    Those that no sentence names follow, and those that `fretc import` has kept without reading
    them. A kept one stands in the place of what would be said of its project's variable by that
    of another project.
    """
    records: dict[tuple[str, str, str], dict[str, Any]] = {}
    for rule in rules:
        project = rule.requirement.fret.get("project", "")
        component = rule.sentence.component
        for name in rule.variables:
            key = (project, component, name)
            record = records.setdefault(
                key, _variable(rule.glossary.get(name), project, component, name)
            )
            record["reqs"].append(_id(rule.requirement))
    named = [*records]
    own: set[tuple[str, str, str]] = set()
    for name, variable in _glossary(rules, declarations):
        project, component = variable.fret.get("project", ""), variable.component
        key = (project, component, name)
        own.add(key)
        if not any(_is_of(key, each) for each in named):
            records[key] = _variable(variable, project, component, name)
    return _with_kept(records, own, declarations.fret if declarations else ())


def _is_of(variable: tuple[str, str, str], named: tuple[str, str, str]) -> bool:
    """Whether a sentence names it: who writes bindings by hand need not say whose a variable is."""
    return variable[2] == named[2] and all(
        a == b or not a or (place == 0 and not b)
        for place, (a, b) in enumerate(zip(variable[:2], named[:2], strict=True))
    )


def _glossary(
    rules: Sequence[FormalizedRequirement], declarations: Declarations | None
) -> Iterator[tuple[str, Variable]]:
    """Each name with what it is, of each component."""
    if declarations is None:
        yield from rules[0].glossary.items() if rules else ()
        return
    for name, variable in declarations.variables.items():
        yield from ((name, each) for each in (variable, *variable.of.values()))


def _with_kept(
    records: Mapping[tuple[str, str, str], dict[str, Any]],
    own: Collection[tuple[str, str, str]],
    kept: Sequence[Mapping[str, Any]],
) -> list[dict[str, Any]]:
    """All records: what FRET has said of a variable stands there as it is."""
    found = dict(records)
    more: list[dict[str, Any]] = []
    for each in kept:
        fields = ("project", "component_name", "variable_name")
        project, component, name = (str(each.get(field, "")) for field in fields)
        key = (project, component, unquoted(name))
        if key in records and key not in own and found[key] is records[key]:
            found[key] = {**each, "reqs": records[key]["reqs"]}
        else:
            more.append(dict(each))
    return [*found.values(), *more]


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
    """What a variable stands for, as FRET has it, where it has it; `fretc import` reads our own."""
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
    names=lambda rule: {name: _variable_name(name) for name in rule.variables},
)
