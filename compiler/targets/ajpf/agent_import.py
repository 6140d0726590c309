"""Import of agents (`.gwen`) and of AJPF's properties (`.psl`) as requirements and bindings.

A property is taken if some sentence means it: the sentence is formalized, printed as a property
again, and has to be the same formula. Of an agent, each plan that responds to beliefs with beliefs
becomes a draft, and the actions before the beliefs go into the bindings. What is not taken is
reported with its line (F917).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from pathlib import PurePosixPath
from typing import Any

import tomli_w

from compiler.agents import gwendolen, psl
from compiler.agents.psl import Property
from compiler.files.artifact import Artifact
from compiler.formalization.formalize import formalize
from compiler.logic import formula as f
from compiler.project.fret_import import ImportResult
from compiler.targets.ajpf import properties
from fretish.bindings.tables.reader import read_bindings
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.documents import requirements

SUFFIXES = (".gwen", ".psl")
_ATOM = re.compile(r"(?P<modality>\w+)\((?P<agent>[\w.]+),(?P<name>\w+)\)", re.ASCII)
_PRINT = re.compile(r"print\b")
Tables = Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True, slots=True)
class _Sentence:
    id: str
    text: str
    origin: str
    """Where it comes from, in words."""
    file: str


@dataclass(slots=True)
class _Import:
    """What has been taken so far."""

    sentences: list[_Sentence] = field(default_factory=list)
    variables: dict[str, dict[str, Any]] = field(default_factory=dict)
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def add(self, sentence: _Sentence) -> None:
        """Take a sentence, unless it has been taken before."""
        if sentence.text not in {each.text for each in self.sentences}:
            self.sentences.append(sentence)


def read_agents(sources: Sequence[Source]) -> ImportResult:
    """The requirements and bindings of agents and property files.

    Args:
        sources: files whose names end with one of `SUFFIXES`.
    """
    taken = _Import()
    for source in sorted(sources, key=lambda each: each.name.endswith(".gwen")):
        if source.name.endswith(".psl"):
            _take_properties(source, taken)
        else:
            _take_agent(source, taken)
    if has_errors(taken.diagnostics):
        return ImportResult(diagnostics=tuple(taken.diagnostics))
    return ImportResult(
        (*_documents(taken.sentences), *_bindings(taken.variables)),
        tuple(taken.diagnostics),
        len(taken.sentences),
        len(taken.variables),
    )


# Properties -------------------------------------------------------------------------------------


def _take_properties(source: Source, taken: _Import) -> None:
    read = psl.read(source)
    if isinstance(read, Diagnostic):
        taken.diagnostics.append(read)
        return
    for each in read:
        reading = _sentence(each)
        if isinstance(reading, str):
            what = f"the property `{each.key}`"
            taken.diagnostics.append(diagnostic("not_imported", each.span, what=what, why=reading))
            continue
        text, variables = reading
        taken.diagnostics += each.remarks
        origin = f"the property on line {each.span.line} of {_base(source)}"
        taken.add(_Sentence(each.key.strip("_.-") or "P", text, origin, _base(source)))
        for name, table in variables.items():
            taken.variables.setdefault(name, {}).update(table)


def _sentence(wanted: Property) -> tuple[str, Tables] | str:
    """A sentence with the meaning of a property, and its variables; or why there is none."""
    atoms = {name: _ATOM.fullmatch(name) for name in sorted(_atoms(wanted.formula))}
    strange = next((name for name, match in atoms.items() if match is None), None)
    if strange is not None:
        return f"`{strange}` has arguments"
    parts = [match for match in atoms.values() if match is not None]
    agents = {match["agent"] for match in parts}
    if len(agents) != 1:
        return "it is about several agents" if agents else "it is about no agent"
    modalities: dict[str, str] = {}
    for match in parts:
        if modalities.setdefault(match["name"], match["modality"]) != match["modality"]:
            return f"`{match['name']}` has two modalities"
    tables = {name: {"modality": kind} for name, kind in modalities.items() if kind != "B"}
    (agent,) = agents
    spoken = {name: match["name"] for name, match in atoms.items() if match is not None}
    for text in _candidates(wanted.formula, agent, spoken):
        if _means(text, tables, wanted.formula):
            return text, tables
    return "no sentence of FRETish has this form"


def _atoms(formula: f.Formula) -> set[str]:
    if isinstance(formula, f.Atom):
        return {formula.name}
    return {name for child in f.children(formula) for name in _atoms(child)}


def _candidates(formula: f.Formula, agent: str, names: Mapping[str, str]) -> Iterator[str]:
    """Sentences that may mean the formula, by its outermost operators."""

    def spoken(part: f.Formula) -> str | None:
        return _boolean(part, names)

    match formula:
        case f.Globally(f.Implies(left, f.Eventually(right, f.EVER)), f.EVER):
            condition, response = spoken(left), spoken(right)
            if condition and response:
                yield f"whenever {condition} {agent} shall eventually satisfy {response}"
        case f.Globally(f.Implies(left, right), f.EVER):
            condition, response = spoken(left), spoken(right)
            if condition and response:
                yield f"whenever {condition} {agent} shall immediately satisfy {response}"
    match formula:
        case f.Globally(f.Not(arg), f.EVER) if spoken(arg):
            yield f"{agent} shall never satisfy {spoken(arg)}"
        case f.Globally(arg, f.EVER) if spoken(arg):
            yield f"{agent} shall always satisfy {spoken(arg)}"
        case f.Eventually(arg, f.EVER) if spoken(arg):
            yield f"{agent} shall eventually satisfy {spoken(arg)}"


def _boolean(part: f.Formula, names: Mapping[str, str]) -> str | None:
    """A Boolean combination as FRETish writes it; None: it is none."""
    match part:
        case f.Atom(name):
            return names[name]
        case f.Not(arg):
            inner = _boolean(arg, names)
            return inner and (f"!{inner}" if isinstance(arg, f.Atom) else f"!({inner})")
        case f.And(args) | f.Or(args):
            each = [_boolean(arg, names) for arg in args]
            if not all(each):
                return None
            sign = " & " if isinstance(part, f.And) else " | "
            return f"({sign.join(filter(None, each))})"
        case _:
            return None


def _means(text: str, tables: Tables, wanted: f.Formula) -> bool:
    """Whether the property of a sentence is the wanted formula."""
    declared, _ = read_bindings(Source("bindings.toml", tomli_w.dumps({"variable": tables})))
    ((entry,), _) = requirements(Source("r.fret", text))
    requirement, _ = formalize(entry, declared)
    if requirement is None or properties.refusal(requirement) is not None:
        return False
    own, *_ = properties.properties(requirement)
    again = psl.read(Source("r.psl", f"{own.key}: {own.text}\n"))
    return not isinstance(again, Diagnostic) and again[0].formula == wanted


# Agents -----------------------------------------------------------------------------------------


def _take_agent(source: Source, taken: _Import) -> None:
    agent = gwendolen.read(source)
    if isinstance(agent, Diagnostic):
        taken.diagnostics.append(agent)
        return
    for plan in agent.plans:
        for what, why in _take_plan(plan, agent.name, source, taken):
            place = _place(plan.span, what)
            taken.diagnostics.append(diagnostic("not_imported", place, what=what, why=why))
    actions = {str(d) for p in agent.plans for d in p.deeds if isinstance(d, gwendolen.Action)}
    for each in taken.sentences:
        for action in sorted(actions & {*re.findall(r"\w+", each.text)}):
            taken.diagnostics.append(
                diagnostic(
                    "belief_is_an_action", agent.name_span, action=action, origin=each.origin
                )
            )


def _place(plan: Span, what: str) -> Span:
    """The place of a deed in its plan, by its first word; else the whole plan."""
    word = re.match(r"`([+-]?\w+)", what)
    match = re.search(rf"{re.escape(word[1])}\b", plan.text) if word else None
    return plan.part(*match.span()) if match else plan


def _take_plan(
    plan: gwendolen.AgentPlan, agent: str, source: Source, taken: _Import
) -> Iterator[tuple[str, str]]:
    """Take a plan; yield what of it is not taken, and why."""
    earned: dict[str, str | None] = {}
    action: str | None = None
    for deed in plan.deeds:
        match deed:
            case gwendolen.Action(name) if _PRINT.match(name):
                yield f"`{name}`", "it is only for people: `--trace` publishes each action"
            case gwendolen.Action(name):
                if action is not None:
                    yield f"`{action}`", "no belief follows it before the next action"
                action = name
            case gwendolen.BeliefChange("+", belief):
                earned[belief], action = action, None
            case _:
                yield f"`{deed}`", "a response is a belief that is added"
    if action is not None:
        yield f"`{action}`", "no belief follows it"
    conditions = [plan.event.belief, *(g.belief for g in plan.guards if g.positive)]
    denied = [g.belief for g in plan.guards if not g.positive and g.belief not in earned]
    names = [*conditions, *denied, *earned]
    if plan.event.sign == "-" or not earned or not all(map(str.isidentifier, names)):
        yield f"the plan for `{plan.event}`", "only a plan `+b : ... <- ..., +r;` is a requirement"
        return
    for belief, done in earned.items():
        if done is not None and done.isidentifier():
            taken.variables.setdefault(belief, {})["action"] = done
        elif done is not None:
            yield f"`{done}`", "the name of an action has no arguments in the bindings"
    condition = " & ".join([*dict.fromkeys(conditions), *(f"!{name}" for name in denied)])
    origin = f"the plan on line {plan.span.line} of {_base(source)}"
    text = f"whenever {condition} {agent} shall eventually satisfy {' & '.join(earned)}"
    taken.add(_Sentence(f"plan-{plan.span.line}", text, origin, _base(source)))


# Files ------------------------------------------------------------------------------------------


def _base(source: Source) -> str:
    return PurePosixPath(source.name.replace("\\", "/")).name


def _documents(sentences: Sequence[_Sentence]) -> Iterator[Artifact]:
    by_file: dict[str, list[_Sentence]] = {}
    for each in sentences:
        by_file.setdefault(PurePosixPath(each.file).stem, []).append(each)
    for file, some in by_file.items():
        text = "\n".join(
            f"+++\n{tomli_w.dumps({'id': each.id, 'status': 'draft', 'rationale': each.origin})}"
            f"+++\n{each.text}\n"
            for each in some
        )
        yield Artifact(PurePosixPath(f"{file}.fret"), text)


def _bindings(variables: Tables) -> Iterator[Artifact]:
    if variables:
        text = (
            "# What the agent does, by its beliefs. To audit logs, declare a [clock], and bind\n"
            "# each variable by a [proposition.NAME] over signals.\n\n"
        )
        tables = {name: dict(table) for name, table in variables.items()}
        yield Artifact(PurePosixPath("bindings.toml"), text + tomli_w.dumps({"variable": tables}))
