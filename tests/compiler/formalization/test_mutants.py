"""A monitor with a small mistake in it is never taken for the right one.

Mistakes are put into the text that is generated, below its run time, and into the formulas that it
is generated from. The proof refutes each, or its columns differ from its steps, or it is refused
as something that is not generated; what is proved all the same must tell the same as the monitor
without the mistake, and that the definition is reported by that one is held in `test_telling`.
"""

import ast
import random
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import fields, replace
from functools import partial
from itertools import islice
from typing import Any, TypeVar, get_args

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.past import MonitorSpec
from compiler.logic import formula as f
from compiler.logic.claims import ClaimResult
from compiler.targets.python import monitor as target
from fretc.verification.monitor.verifying import NotAMonitorError
from fretish import syntax as s
from monitors.kernel import Monitor
from monitors.kernel.stepping import RequirementStatus
from monitors.kernel.verdicts import Truth
from monitors.loading import load
from tests.effort import FULL
from tests.monitoring import over, requirement, with_step
from tests.proofs import verified

SENTENCES = (
    "the sw shall immediately satisfy q",
    "upon p the sw shall at the next timepoint satisfy q",
    "in m mode the sw shall finally satisfy q",
    "except in m mode whenever p the sw shall eventually satisfy q",
    "after m mode the sw shall always satisfy q",
    "only before m mode the sw shall never satisfy q",
    "whenever p the sw shall within 2 ticks satisfy q",
    "before m mode the sw shall within 3 ticks satisfy q",
    "in m mode whenever p the sw shall for 3 ticks satisfy q",
    "when p the sw shall for 2 ticks satisfy q",
    "upon p the sw shall after 2 ticks satisfy q",
    "only in m mode whenever p the sw shall after 2 ticks satisfy q",
    "only after m mode upon p the sw shall until s satisfy q",
    "upon p xor s the sw shall before s satisfy q",
    "whenever !p the sw shall after 2 ticks satisfy p",
)
"""Every timing and every scope, and with them every kind of line that is generated."""

MOST_STATES = 1000
"""More than twice what the right ones have: one that counts for ever is not looked at for ever."""

MARK = "# The requirements ---"


# Mistakes in a text ---------------------------------------------------------------------------

_NEXT = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt}


def mistakes(node: ast.AST, names: frozenset[str]) -> Iterator[tuple[str, ast.AST]]:
    """Each kind of mistake that fits here, with what stands here then."""
    match node:
        case ast.Constant(bool() as value):
            yield "constant", ast.Constant(not value)
        case ast.Constant(int() as value):
            yield "bound", ast.Constant(value + 1)
            if value:
                yield "bound", ast.Constant(value - 1)
        case ast.Compare(left, [operator], right) if type(operator) in _NEXT:
            yield "comparison", ast.Compare(left, [_NEXT[type(operator)]()], right)
        case ast.BoolOp(operator, values):
            other = ast.Or() if isinstance(operator, ast.And) else ast.And()
            yield "and, or", ast.BoolOp(other, values)
            for place in range(len(values)):
                rest = [value for i, value in enumerate(values) if i != place]
                yield "operand left out", rest[0] if len(rest) == 1 else ast.BoolOp(operator, rest)
        case ast.BinOp(left, ast.BitAnd() | ast.BitOr() as operator, right):
            swapped = ast.BitOr() if isinstance(operator, ast.BitAnd) else ast.BitAnd()
            yield "and, or", ast.BinOp(left, swapped, right)
            yield "operand left out", left
            yield "operand left out", right
        case ast.UnaryOp(ast.Not(), arg):
            yield "negation", arg
        case ast.Name(name, ast.Load()):
            other_name = name.removeprefix("not_") if name.startswith("not_") else f"not_{name}"
            if other_name in names:
                yield "negation", ast.Name(other_name)
        case ast.IfExp(test, body, orelse):
            yield "operands swapped", ast.IfExp(test, orelse, body)
        case ast.Call(function, [left, right, *rest], []):
            yield "operands swapped", ast.Call(function, [right, left, *rest], [])
        case ast.Assign([ast.Tuple(targets)], ast.Tuple(values)):
            yield "kept value", ast.Assign(targets[:1], values[0])
        case ast.Assign([ast.Name()], ast.Constant() | ast.UnaryOp(ast.USub())):
            yield "reset", ast.Pass()
        case ast.Assign([ast.Attribute()], ast.Name()):
            yield "not written back", ast.Pass()
        case _:
            pass


Written = Callable[[], str | None]
"""Writes the text with a mistake; None where that is the text without it."""


def of_text(text: str) -> Iterator[tuple[str, Written]]:
    """All mistakes in the logic of a text: in its cells, its tick, its signals and its columns.

    A mistake in the tick of `advance` is in the step, too, else the text is refused for that.
    """
    begun = text.index("\n", text.index(MARK))
    head, module = text[: begun + 1], ast.parse(text[begun:])
    right = [ast.unparse(statement) for statement in module.body]

    def written(
        number: int, parent: ast.AST, field: str, at: int | None, node: ast.AST, other: ast.AST
    ) -> str | None:
        _put(parent, field, at, ast.fix_missing_locations(other))
        changed = ast.unparse(module.body[number])
        _put(parent, field, at, node)
        if changed == right[number]:
            return None
        own = "\n".join([*right[:number], changed, *right[number + 1 :]])
        return with_step(f"{head}\n{own}\n")

    for number, statement in enumerate(module.body):
        for function in ast.walk(statement):
            if isinstance(function, ast.FunctionDef) and function.name in LOGIC:
                for kind, place in _of_function(function):
                    yield f"{function.name}: {kind}", partial(written, number, *place)


LOGIC = ("__init__", "advance", "columns")
Place = tuple[ast.AST, str, int | None, ast.AST, ast.AST]
"""Parent, field, place in the field, what stands there, and what stands there by mistake."""


def _of_function(function: ast.FunctionDef) -> Iterator[tuple[str, Place]]:
    names = {node.id for node in ast.walk(function) if isinstance(node, ast.Name)}
    names |= {argument.arg for argument in function.args.kwonlyargs}
    for parent in ast.walk(function):
        if parent is function.args:
            continue
        for field, value in ast.iter_fields(parent):
            several = isinstance(value, list)
            for i, node in enumerate(value if several else [value]):
                if isinstance(node, ast.AST):
                    for kind, other in mistakes(node, frozenset(names)):
                        yield kind, (parent, field, i if several else None, node, other)


def _put(parent: ast.AST, field: str, place: int | None, node: ast.AST) -> None:
    if place is None:
        setattr(parent, field, node)
    else:
        getattr(parent, field)[place] = node


# Mistakes in formulas -------------------------------------------------------------------------


def of_formula(formula: f.Formula) -> Iterator[tuple[str, f.Formula]]:
    """The formula with one mistake, at each place of it."""
    if not isinstance(formula, f.Const):
        yield "negated", f.not_(formula)
    match formula:
        case f.And(args):
            yield "and, or", f.or_(*args)
        case f.Or(args):
            yield "and, or", f.and_(*args)
        case f.Previous(arg):
            yield "weak, strong", f.weak_previous(arg)
        case f.WeakPrevious(arg):
            yield "weak, strong", f.previous(arg)
        case f.Since(left, right, ago):
            yield "sides swapped", f.since(right, left, ago)
            yield from (("bound", f.since(left, right, other)) for other in bounds(ago))
        case f.Once(arg, ago):
            yield from (("bound", f.once(arg, other)) for other in bounds(ago))
        case f.Historically(arg, ago):
            yield from (("bound", f.historically(arg, other)) for other in bounds(ago))
        case _:
            pass
    for place, child in enumerate(f.children(formula)):
        for kind, other in of_formula(child):
            yield kind, _with(formula, place, other)


def bounds(ago: f.Interval) -> Iterator[f.Interval]:
    if ago == f.EVER:
        return
    for lo, hi in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        first = ago.lo + lo
        last = None if ago.hi is None else ago.hi + hi
        if (lo or ago.hi is not None) and first >= 0 and (last is None or last >= first):
            yield f.Interval(first, last)


def _with(formula: f.Formula, place: int, child: f.Formula) -> f.Formula:
    places = iter(range(len(f.children(formula))))
    return f.rebuild(formula, lambda known: child if next(places) == place else known)


def of_watch(watch: MonitorSpec) -> Iterator[tuple[str, MonitorSpec]]:
    for field in fields(watch):
        signal = getattr(watch, field.name)
        if field.name in ("deadline_ticks", "renewed", "missing") or signal is None:
            continue
        for kind, other in of_formula(signal):
            if other != signal:
                yield f"{field.name}: {kind}", changed(watch, field.name, other)
        if watch.trigger != f.TRUE and field.name not in ("trigger", "answer"):
            other = replaced(signal, watch.trigger, f.TRUE)
            if other != signal:
                yield f"{field.name}: always triggered", changed(watch, field.name, other)


def changed(watch: MonitorSpec, signal: str, other: f.Formula) -> MonitorSpec:
    changes: dict[str, Any] = {signal: other}
    return replace(watch, **changes)


def replaced(formula: f.Formula, old: f.Formula, new: f.Formula) -> f.Formula:
    if formula == old:
        return new
    return f.rebuild(formula, lambda child: replaced(child, old, new))


# What becomes of them -------------------------------------------------------------------------

REFUTED, DIFFERS, REFUSED, TOLD, SAME = "refuted", "differs", "refused", "told apart", "same"


class Judge:
    """What is found of a monitor with a mistake."""

    def __init__(self, right: FormalizedRequirement) -> None:
        self.requirement = right
        self.machine = load("right.py", target.text(right))
        choose = random.Random(right.id)
        self.traces = [self._trace(choose, number) for number in range(16)]
        self.expected = [telling(self.machine, trace) for trace in self.traces]

    def _trace(self, choose: random.Random, number: int) -> dict[str, list[Truth]]:
        values: tuple[Truth, ...] = (False, True, None)
        unknown = 0.1 if number % 2 else 0
        weights = {
            name: ((1 - unknown) * odds, (1 - unknown) * (1 - odds), unknown)
            for name in "mpqs"
            for odds in [choose.choice((0.15, 0.5, 0.85))]
        }
        return {name: choose.choices(values, weights[name], k=16) for name in weights}

    def kind(self, text: str) -> str:
        try:
            outcome = verified(self.requirement, text, MOST_STATES)
        except NotAMonitorError:
            return REFUSED
        match outcome.result:
            case ClaimResult.COUNTEREXAMPLE:
                return REFUTED if "that shows it has" in outcome.detail else DIFFERS
            case ClaimResult.NOT_CHECKED:
                return REFUSED
            case _:
                return self._compared(text)

    def _compared(self, text: str) -> str:
        machine = load("other.py", text)
        for trace, expected in zip(self.traces, self.expected, strict=True):
            if telling(machine, trace) != expected:
                return TOLD
        return SAME


def telling(machine: Monitor, trace: dict[str, list[Truth]]) -> object:
    """All that a monitor tells of a trace: at each tick, and at its end of single demands."""
    machine.reset()
    names = tuple(machine.PROPOSITIONS)
    told: list[tuple[RequirementStatus, ...]] = []
    for tick in range(16):
        machine.advance([tuple(trace[name][tick] for name in names)])
        told.append(machine.statuses())
    columns = {name: trace[name] for name in names} or {"q": trace["q"]}
    return told, over(machine, columns)


Mistake = TypeVar("Mistake")

# The tests ------------------------------------------------------------------------------------

HARMLESS = {
    "advance: and, or",
    "advance: bound",
    "advance: comparison",
    "advance: kept value",
    "advance: negation",
    "advance: operand left out",
    "__init__: bound",
    "__init__: constant",
    "__init__: operands swapped",
}
"""Mistakes in a text that may change nothing: a counter that saturates later, a value that was
never read, an operand that follows from the other. In columns none is taken: no exploration shows
that it changes nothing at all lengths."""


GROUPS = [[number] for number in range(len(SENTENCES))] if FULL else [[*range(len(SENTENCES))]]
"""The numbers of sentences whose mistakes are counted together."""


def chosen(
    mistakes: Iterable[tuple[str, Callable[[], Mistake | None]]], met: Counter[str]
) -> Iterator[tuple[str, Mistake]]:
    """Mistakes in a sentence: each kind in every sixth that has it, each time at another place.

    With the full profile, all.

    Args:
        mistakes: in this sentence.
        met: how many sentences had each kind before this one; it is counted here.
    """
    of_kind: dict[str, list[Callable[[], Mistake | None]]] = {}
    for kind, written in mistakes:
        of_kind.setdefault(kind, []).append(written)
    for kind, several in of_kind.items():
        first, turn = 7 * met[kind] % len(several), met[kind] % 6
        met[kind] += 1
        if FULL or not turn:
            made = (written() for written in (*several[first:], *several[:first]))
            wrong = (mistake for mistake in made if mistake is not None)
            yield from ((kind, mistake) for mistake in islice(wrong, None if FULL else 1))


@pytest.mark.slow
@pytest.mark.parametrize("numbers", GROUPS)
def test_a_mistake_in_a_text_is_found_or_changes_nothing(numbers: list[int]) -> None:
    found, met = Counter[str](), Counter[str]()
    for number in numbers:
        made = requirement(SENTENCES[number])
        judge = Judge(made)
        for kind, text in chosen(of_text(target.text(made)), met):
            result = judge.kind(text)
            found[result] += 1
            if result == SAME:
                assert kind in HARMLESS, text[text.index(MARK) :]
        assert judge.kind(target.text(made)) == SAME
    assert found[TOLD] == 0, "what is proved tells the same as the right one"
    assert found[SAME] <= 0.17 * found.total(), found
    assert found[REFUTED] >= 5, found
    assert found[DIFFERS] >= 10, found


@pytest.mark.slow
@pytest.mark.parametrize("numbers", GROUPS)
def test_a_mistake_in_a_formula_is_found_or_proved_to_change_nothing(numbers: list[int]) -> None:
    """What changes nothing is proved, or not checked: its columns are others, and seem to agree."""
    found, met = Counter[str](), Counter[str]()
    for number in numbers:
        made = requirement(SENTENCES[number])
        judge = Judge(made)
        wrong = ((kind, partial(_same, watch)) for kind, watch in of_watch(made.watch))
        for kind, watch in chosen(wrong, met):
            result = judge.kind(target.text(replace(made, watch=watch)))
            assert result in (REFUTED, DIFFERS, REFUSED, SAME), (kind, watch)
            found[result] += 1
            if result in (REFUSED, SAME):
                assert kind.partition(": ")[2] == "weak, strong" or kind.startswith(
                    "violation_inevitable"
                ), kind
    assert found[REFUSED] + found[SAME] <= 0.2 * found.total(), found
    assert found[REFUTED] >= 5, found


def _same(watch: MonitorSpec) -> MonitorSpec:
    return watch


def test_the_sentences_have_every_kind_of_line_and_of_demand() -> None:
    """`released` and `released_between` come only where parts are no atoms of their own."""
    own = "".join(
        text[text.index(MARK) :] for text in map(target.text, map(requirement, SENTENCES))
    )
    cells = "youngest_1 oldest_1 since_1 before_1 first differ_1 agree_1 Window".split()
    columns = "previous weak_previous once historically since since_from since_between".split()
    for name in (*cells, *(f"{column}(" for column in columns)):
        assert f" {name}" in own, name
    sentences = [requirement(sentence).sentence for sentence in SENTENCES]
    assert {type(sentence.timing) for sentence in sentences} == {*get_args(s.Timing)}
    assert {x.scope.kind for x in sentences if x.scope} == {*s.ScopeKind}
    assert {x.condition.kind for x in sentences if x.condition} == {*s.ConditionKind}
