"""The HTML page of `fretc play`: monitors in JavaScript, their data, and the script."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import groupby, pairwise
from math import floor, isfinite, log10
from typing import Any

from compiler.files.build_id import __version__
from compiler.files.records import plain
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import TRAITS, Trait, Uninterpreted, boolean, obligation
from compiler.logic import formula as f
from compiler.targets.javascript.monitor import Body, body
from compiler.targets.python.comparisons import NUMBER, CompiledComparison, numbers, threshold
from compiler.targets.python.input_adapter import InputAdapter
from compiler.targets.target import stem
from fretc.play.starts import MOST, Start
from fretc.report.model.phrases import joined, times, visible
from fretc.report.page.html import Inset, hash_source
from fretc.testing.suite import SCHEMA, Tested
from fretish.checking import is_formula
from fretish.diagnostics import status_symbols as signs
from fretish.printer import expression
from fretish.printer import sentence as printed
from monitors.kernel.verdicts import Verdict

_GLYPHS: Mapping[str, str] = {
    Verdict.VIOLATED: signs.BAD.glyph,
    Verdict.SATISFIED: signs.GOOD.glyph,
    Verdict.PENDING: "",
    "unknown": signs.UNKNOWN.glyph,
    Verdict.INCONCLUSIVE: signs.OPEN.glyph,
    Verdict.VACUOUS: signs.EMPTY.glyph,
    Verdict.NO_DATA: signs.UNKNOWN.glyph,
}
_WORDS: Mapping[str, str] = {
    Verdict.VIOLATED: "violated, whatever follows",
    Verdict.SATISFIED: "satisfied; at this tick: whatever follows",
    Verdict.PENDING: "pending: the following ticks decide",
    "unknown": "unknown: the verdict depends on unknown values",
    Verdict.INCONCLUSIVE: "inconclusive: the run would end with an open obligation",
    Verdict.VACUOUS: "vacuous: never triggered",
}


def html(
    requirements: Sequence[FormalizedRequirement],
    left_out: Sequence[tuple[str, str]],
    starts: Sequence[Start],
    before: Mapping[str, str] | None = None,
    notes: Sequence[str] = (),
) -> str:
    """The HTML page; arguments as for `inset`."""
    return inset(requirements, left_out, starts, before, notes).text


def inset(
    requirements: Sequence[FormalizedRequirement],
    left_out: Sequence[tuple[str, str]],
    starts: Sequence[Start],
    before: Mapping[str, str] | None = None,
    notes: Sequence[str] = (),
) -> Inset:
    """The HTML page, to be embedded in another page.

    Args:
        requirements: at least one; all can be translated to JavaScript, and have the same clock.
        left_out: (id, reason) of each requirement that is not on the page.
        starts: traces to start from; traces of more than `MOST` ticks are left out.
        before: id of a requirement → id of its earlier version.
        notes: sentences about versions and runs.
    """
    made, before = body(*requirements), before or {}
    now = [requirement for requirement in requirements if requirement.id not in before.values()]
    known = [start for start in starts if 0 < start.ticks <= MOST]
    names = ", ".join(("REQUIREMENTS", "PROPOSITIONS", "VARIABLES", "init", "truths", "judge"))
    code = "\n".join(line for line in made.text.splitlines() if not line.lstrip().startswith("//"))
    monitor = f'"use strict";\nconst monitor = (() => {{\n{code}\nreturn {{ {names} }};\n}})();\n'
    script = render(
        "play/page.js.j2",
        **{part: render(f"play/{part}.js.j2", glyphs=json.dumps(_GLYPHS)) for part in _PARTS},
    )
    style = render("play/style.css.j2")
    hashes = [hash_source(each) for each in (monitor, script, style)]
    text = render(
        "play/page.html.j2",
        title=visible(_title(now)),
        notes=[visible(note) for note in notes],
        is_compared=bool(before),
        tick=str(requirements[0].clock) if requirements[0].clock else "",
        left_out=[(visible(id), visible(why)) for id, why in left_out],
        labels=[
            visible(f"{requirement.id} {requirement.entry.title}".rstrip())
            for requirement in requirements
        ],
        starts=[*_grouped(known)],
        has_violations=any(start.place for start in known),
        glyphs=[(_WORDS[word], glyph) for word, glyph in _GLYPHS.items() if word in _WORDS],
        version=__version__,
        data=_data(requirements, made, known, before),
        monitor=monitor,
        script=script,
        style=style,
        monitor_hash=hashes[0],
        script_hash=hashes[1],
        style_hash=hashes[2],
    )
    return Inset(
        text,
        frozenset(requirement.id for requirement in requirements),
        (hashes[0], hashes[1]),
        hashes[2],
    )


_PARTS = ("trace", "words", "grid", "gestures")


def _title(requirements: Sequence[FormalizedRequirement]) -> str:
    """The name of one requirement; the components of several, and their number."""
    if len(requirements) == 1:
        return requirements[0].entry.name
    components = sorted({requirement.sentence.component for requirement in requirements})
    return f"{joined(components)}: {times(len(requirements), 'requirement')}"


def _grouped(starts: Sequence[Start]) -> Iterator[tuple[str, list[tuple[int, str]]]]:
    numbered = enumerate(starts)
    for group, some in groupby(numbered, key=lambda each: each[1].group):
        yield group, [(place, visible(start.name)) for place, start in some]


def _data(
    requirements: Sequence[FormalizedRequirement],
    made: Body,
    starts: Sequence[Start],
    before: Mapping[str, str],
) -> dict[str, Any]:
    front = made.front or InputAdapter({}, {})
    variables = [*front.inputs] or [*made.propositions]
    places = {name: index for index, name in enumerate(variables)}
    reads = {name: [places[name]] for name in made.propositions if name in places}
    for name, compared in front.comparisons.items():
        reads[name] = [places[each] for each in compared.inputs]
    ids = {requirement.id: index for index, requirement in enumerate(requirements)}
    return {
        "most": MOST,
        "period": _period(requirements[0]),
        "suite": {
            "schema": SCHEMA,
            "fretc": __version__,
            "clock": str(requirements[0].clock) if requirements[0].clock else "",
        },
        "requirements": [
            _requirement(requirement, made.propositions, reads)
            | {"before": ids[before[requirement.id]] if requirement.id in before else None}
            for requirement in requirements
        ],
        "variables": [_variable(name, front) for name in variables],
        "comparisons": [
            {
                "proposition": index,
                "label": visible(_written(name, requirements).strip("()")),
                "limit": _limit(front.comparisons[name], places),
            }
            for index, name in enumerate(made.propositions)
            if name in front.comparisons
        ],
        "groups": [*_groups(made.propositions, front, places)],
        "starts": [
            {
                "about": visible(start.about),
                "requirements": [ids[id] for id in start.requirements if id in ids],
                "rows": start.rows,
                "run": visible(start.place.run) if start.place else "",
                "number": start.place.number if start.place else 0,
                "seconds": start.place.seconds if start.place else 0,
            }
            for start in starts
        ],
    }


def _period(requirement: FormalizedRequirement) -> float | None:
    """The seconds of a tick; None if ticks are messages, or no clock is known."""
    clock = requirement.clock
    return clock.period / 1e9 if clock is not None and clock.period else None


def _requirement(
    requirement: FormalizedRequirement,
    propositions: Sequence[str],
    reads: Mapping[str, Sequence[int]],
) -> dict[str, Any]:
    demand = obligation(requirement.sentence, requirement.ticks or 0).demand
    formula = boolean(requirement.sentence.response, Uninterpreted().alone())
    known = not is_formula(requirement.sentence) and all(
        name in propositions for name in f.atoms(formula)
    )
    return {
        "label": visible(requirement.id),
        "title": visible(requirement.entry.title),
        "file": stem(requirement),
        "tested": plain(
            Tested(requirement.id, printed(requirement.written), requirement.fingerprint, ())
        ),
        "sentence": visible(printed(requirement.written)),
        "response": visible(expression(requirement.written.response)),
        "formula": _tree(formula, propositions) if known else None,
        "waits": Trait.WAITS in TRAITS[demand.kind],
        "watches": [propositions.index(name) for name in requirement.watched],
        "reads": sorted({place for name in requirement.watched for place in reads[name]}),
    }


def _tree(formula: f.Formula, propositions: Sequence[str]) -> list[Any]:
    """A Boolean formula as nested lists of operators and operands."""
    match formula:
        case f.Const(value):
            return [str(value).lower()]
        case f.Atom(name):
            return ["atom", propositions.index(name)]
        case f.Not(arg):
            return ["not", _tree(arg, propositions)]
        case f.And(args):
            return ["and", *(_tree(arg, propositions) for arg in args)]
        case f.Or(args):
            return ["or", *(_tree(arg, propositions) for arg in args)]
        case f.Implies(left, right):
            return ["or", ["not", _tree(left, propositions)], _tree(right, propositions)]
        case f.Iff(left, right):
            return ["same", _tree(left, propositions), _tree(right, propositions)]
        case f.Xor(left, right):
            return ["not", ["same", _tree(left, propositions), _tree(right, propositions)]]
        case _:
            raise AssertionError(f"not a Boolean formula: {formula}")


# Numbers --------------------------------------------------------------------------------------


def _variable(name: str, front: InputAdapter) -> dict[str, Any]:
    own = [comparison for comparison in front.comparisons.values() if name in comparison.inputs]
    given = front.inputs.get(name)
    unit = next((comparison.units[name][0] for comparison in own if name in comparison.units), "")
    candidates: list[Any] = []
    if given is not None and given.words:
        candidates = [*given.words]
    elif given is not None and given.kind == NUMBER:
        limits = [
            each[1] for comparison in own if (each := threshold(comparison)) and each[0] == name
        ]
        candidates = _candidates(
            limits or [number for comparison in own for number in numbers(comparison)]
        )
    return {
        "label": visible(name),
        "note": f"in {unit}" if unit else "",
        "candidates": candidates,
    }


def _written(name: str, requirements: Sequence[FormalizedRequirement]) -> str:
    """A comparison, as written in the first sentence that contains it."""
    return next(
        (text for requirement in requirements if (text := requirement.wordings.get(name))), name
    )


def _limit(compared: CompiledComparison, places: Mapping[str, int]) -> tuple[int, float] | None:
    """A threshold: the index of its variable, and the number."""
    limit = threshold(compared)
    value = _finite(limit[1]) if limit else None
    return (places[limit[0]], value) if limit and value is not None else None


def _finite(value: Fraction) -> float | None:
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if isfinite(number) else None


def _candidates(limits: Sequence[Fraction]) -> list[float]:
    """Numbers at, between and beside the limits, which give all combinations of comparisons."""
    known = sorted({each for limit in limits if (each := _finite(limit)) is not None} or {0.0})
    between = [(a + b) / 2 for a, b in pairwise(known)]
    least, most = known[0] - _step(known[0]), known[-1] + _step(known[-1])
    return [number for number in (most, *known, *between, least) if isfinite(number)]


def _step(value: float) -> float:
    """A step of one unit of the first digit."""
    return float(10 ** floor(log10(abs(value)))) if value else 1.0


def _groups(
    propositions: Sequence[str], front: InputAdapter, places: Mapping[str, int]
) -> Iterator[dict[str, list[int]]]:
    """Groups of comparisons that share variables."""
    groups: list[tuple[set[str], set[str]]] = []
    for name, compared in front.comparisons.items():
        variables, members = {*compared.inputs}, {name}
        for group in [each for each in groups if not each[0].isdisjoint(variables)]:
            groups.remove(group)
            variables |= group[0]
            members |= group[1]
        groups.append((variables, members))
    for variables, members in groups:
        yield {
            "variables": sorted(places[name] for name in variables),
            "propositions": sorted(propositions.index(name) for name in members),
        }
