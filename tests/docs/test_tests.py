"""The tables of docs/test.md are those of the code."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from pathlib import Path

import pytest

from compiler.files.records import replace
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.obligation import Demand, ObligationKind, dual
from compiler.logic import formula as f
from compiler.project.folder import load
from compiler.project.paths import requirement_files
from compiler.situations.mutants import OPERATORS
from compiler.situations.situations import MEANINGS, situations
from compiler.situations.tick_predicates import tick_predicates
from fretc.analysis.text_output import Line
from fretc.testing.assembly import jobs, suite
from fretc.testing.conformance.text_output import lines as lines_of
from fretc.testing.exports.files import SuiteFormat, files
from fretc.testing.suite import Suite
from fretc.testing.text_output import lines, shown
from fretish.bindings.declarations import Role
from fretish.diagnostics.diagnostic import Diagnostic
from tests.docs.pages import is_current
from tests.emitting import requirement
from tests.fretc.testing.controllers import INPUTS, OUTPUTS, program, seen_of
from tests.requirement_sets import roles
from tests.strategies import templates

WORDS = {
    "mode": "the mode",
    "trigger": "the condition",
    "answer": "the answer",
    "none": "no answer",
    "stop": "the stop condition",
    "last": "the last tick",
    "operand": "an operand",
    "part": "part that it is in",
    "measured": "a number",
    "number": "in its unit",
}
SCOPES = ("null", "in", "notin", "before", "after", "onlyIn", "onlyBefore", "onlyAfter")
NAMED = {
    "a scope that ends": {"in", "notin", "before", "onlyIn", "onlyAfter"},
    "a scope that comes again": {"in", "notin", "onlyIn"},
    "a scope that comes once": {"before", "after", "onlyBefore", "onlyAfter"},
    "a scope that may begin late": {"in", "notin", "after", "onlyIn", "onlyBefore"},
    "a scope that may never begin": {*SCOPES} - {"null", "onlyAfter"},
}
OTHERS = {
    "triggered-at-start": "with a condition, or with a scope that may begin late",
    "alone-true": "a part with several operands",
    "alone-false": "a part with several operands",
    "threshold-below": "a comparison with a number",
    "threshold-at": "a comparison with a number",
    "threshold-above": "a comparison with a number",
    "unknown": "each operand that is a value of one tick",
}
"""Those that a timing, a scope and a condition do not tell."""
Place = tuple[ObligationKind, str, str]
"""What is demanded, and the keys of scope and condition."""


def named(kind: ObligationKind) -> str:
    return "dual of `after`" if kind is ObligationKind.NOT_AFTER else f"`{kind.name.lower()}`"


def sentences_with(places: set[Place], every: set[Place]) -> str:
    """The timings, scopes and conditions that the places have: one way for all, or for each."""
    kinds = [kind for kind in ObligationKind if any(place[0] is kind for place in places)]
    fitting = {kind: [*ways(of(kind, places), of(kind, every))] for kind in kinds}
    common = [way for way in fitting[kinds[0]] if all(way in known for known in fitting.values())]
    chosen = {kind: (common or fitting[kind])[0] for kind in kinds}
    texts = []
    for way in dict.fromkeys(chosen.values()):
        names = all_named([kind for kind in kinds if chosen[kind] == way])
        texts.append(" ".join(part for part in (names, way) if part))
    return "; ".join(texts) or "each"


def of(kind: ObligationKind, places: set[Place]) -> set[tuple[str, str]]:
    return {place[1:] for place in places if place[0] is kind}


def ways(own: set[tuple[str, str]], every: set[tuple[str, str]]) -> Iterator[str]:
    """`with a condition`, `with a scope that ends`, or nothing where no more is needed."""
    for (scope, scopes), (condition, conditions) in product(
        {"": {*SCOPES}, "a scope": {*SCOPES} - {"null"}, **NAMED}.items(),
        {"": {"null", "regular", "holding"}, "a condition": {"regular", "holding"}}.items(),
    ):
        if own == {each for each in every if each[0] in scopes and each[1] in conditions}:
            words = " and ".join(part for part in (scope, condition) if part)
            yield f"with {words}" if words else ""


def all_named(kinds: Sequence[ObligationKind]) -> str:
    others = [kind for kind in ObligationKind if kind not in kinds]
    if len(others) > 3:
        return ", ".join(map(named, kinds))
    return f"all but {', '.join(map(named, others))}" if others else ""


def table_of_situations(subject: str) -> str:
    found: defaultdict[str, set[Place]] = defaultdict(set)
    every: set[Place] = set()
    for drawn in templates((2,)):
        made = requirement(drawn.sentence)
        place = tick_predicates(made).demand.kind, drawn.scope, drawn.condition
        if not {*drawn.columns} <= {*made.propositions}:
            continue  # the scope is the whole run
        every.add(place)
        for each in situations(made):
            found[each.key].add(place)
    rows = (
        (f"`{key}`", text.replace("`", "").format_map(WORDS), OTHERS.get(key))
        for key, text in MEANINGS.items()
    )
    return table(
        ("situation", "what a run shows there", "of which sentences"),
        (
            (key, text, other or sentences_with(found[key.strip("`")], every))
            for key, text, other in rows
        ),
    )


def table_of_duals(subject: str) -> str:
    def text(demand: Demand) -> str:
        return (
            named(demand.kind)
            if demand.response == f.Atom("q")
            else f"{named(demand.kind)}, negated"
        )

    written = (
        Demand(kind, f.Atom("q")) for kind in ObligationKind if kind is not ObligationKind.NOT_AFTER
    )
    pairs = ((named(demand.kind), text(dual(demand))) for demand in written)
    return table(("written", "asked for outside"), pairs)


def table_of_mutants(subject: str) -> str:
    rows = ((f"`{key}`", text) for key, text in OPERATORS.items())
    return table(("operator", "what is changed"), rows)


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    cells = (tuple(cell.replace("|", r"\|") for cell in row) for row in rows)
    lines = [f"| {' | '.join(row)} |" for row in (head, *cells)]
    return "\n".join([lines[0], "|--" * len(head) + "|", *lines[1:]])


def summary(folder: str) -> str:
    """What `fretc test` prints of a folder."""
    paths = requirement_files(str(Path(__file__).parents[2] / folder))
    assert not isinstance(paths, Diagnostic)
    requirements = tuple(load(paths, None).formalized)
    return _printed(f"fretc test {folder}", lines(_suite(requirements)))


def drawn(sentence: str) -> str:
    """What `--show` prints of one sentence."""
    subject = requirement(sentence)
    roles = {"start": Role.INPUT, "run": Role.OUTPUT}
    lanes, words = subject.watched, subject.wordings
    return _printed("fretc test --show R1", shown(_suite([subject]), "R1", lanes, roles, words))


def _suite(requirements: Sequence[FormalizedRequirement]) -> Suite:
    return suite(
        requirements, (), [batch for job in jobs(requirements, (), 60) for batch in job.ask(())]
    )


def _printed(command: str, found: Iterable[Line]) -> str:
    text = [f"$ {command}", *(line for line, _ in found)]
    return "\n".join(f"    {line}".rstrip() for line in text)


def emitted(sentence: str) -> str:
    """The test of a sentence, in pytest, that takes the most ticks."""
    requirements = (requirement(sentence),)
    found = _suite(requirements)
    longest = max(found.tests, key=lambda test: test.ticks)
    artifacts, _ = files(found, requirements, SuiteFormat.PYTEST)
    name = longest.name.replace("-", "_")
    _, start, rest = artifacts[-1].text.partition(f"def test_{name}()")
    return f"```python\n{start}{rest.partition('def ')[0].strip()}\n```"


def conformance(fault: str) -> str:
    """What is printed of a program with a fault."""
    found = seen_of(program(fault))
    drawn_of = replace(found, command=("python3", "line.py"))
    return _printed(
        'fretc test --against "python3 line.py"', lines_of(drawn_of, roles(INPUTS, OUTPUTS))
    )


MAKERS = {
    "suite": summary,
    "emitted": emitted,
    "conformance": conformance,
    "tests": drawn,
    "situations": table_of_situations,
    "duals": table_of_duals,
    "mutants": table_of_mutants,
}
COSTLY = ("requirements/agv", "upon a the sw shall within 600 ticks satisfy x")


@pytest.mark.slow
def test_the_tables_are_those_of_the_code(request: pytest.FixtureRequest) -> None:
    is_current("test.md", MAKERS, request, COSTLY)
