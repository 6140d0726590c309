"""A tick of a generated monitor: its approximation's `advance`, statement by statement.

The logic of a tick is free over names that have a value at this tick; reading propositions, storing
values for the next tick and setting marks have a fixed form.
"""

from __future__ import annotations

import ast
import copy
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

from compiler.program.program import MARKS, SIGNALS
from compiler.targets.python.program import negation
from fretc.verification.monitor.statements import (
    UnexpectedStatementError,
    body_of,
    is_one_of,
    normal,
    require,
)
from fretish.classes.frozen import dataclass

FIXED = frozenset(
    "self approximation rows known is_possible tick boolean VIOLATED SATISFIED PENDING".split(),
)
"""Names that a tick uses itself, and names that it calls."""


@dataclass(frozen=True, slots=True)
class ApproximationNames:
    """Names of an approximation."""

    cells: tuple[str, ...]
    windows: frozenset[str]
    prefixes: tuple[str, ...]

    @property
    def marks(self) -> tuple[str, ...]:
        """Names of all marks."""
        return tuple(f"{prefix}_{mark}" for prefix in self.prefixes for mark in MARKS)

    @property
    def signals(self) -> tuple[str, ...]:
        """Names of all signals."""
        return tuple(f"{prefix}_signals" for prefix in self.prefixes)


@dataclass(frozen=True, slots=True)
class RowBehaviour:
    """Behaviour of an approximation at one row."""

    inlined: str
    """The same as statements of a step with known values, on the only `approximation`."""
    violation_inevitable: frozenset[str]
    """Prefixes of requirements whose violation can be inevitable."""
    satisfied_forever: frozenset[str]
    """Prefixes of requirements that can be satisfied for ever."""


def check_advance(
    node: ast.stmt, approximation: ApproximationNames, inputs: Mapping[str, str]
) -> RowBehaviour:
    """Check that the function does the visible work at each row, and nothing else.

    Args:
        node: the function.
        approximation: its approximation.
        inputs: propositions in the order of a row, each with its parameter.

    Raises:
        UnexpectedCodeError: it does something else.
    """
    body = body_of(node, "advance", "self, rows: 'Iterable[Sequence[Any]]'")
    index = next((i for i, part in enumerate(body) if isinstance(part, ast.For)), None)
    require(index is not None, node)
    assert index is not None
    loop = body[index]
    assert isinstance(loop, ast.For)
    require(index > 2, node)
    carried = tuple(_carried(body[:index], approximation))
    require(is_one_of(loop.iter, "rows") and not loop.orelse, loop)
    row = ", ".join(inputs.values()) + "," * (len(inputs) == 1)
    require(is_one_of(loop.target, f"({row})" if inputs else "_"), loop)
    require(bool(loop.body) and is_one_of(loop.body[0], "tick += 1"), loop)
    bound = _RowStatements(approximation, frozenset(carried)).check(loop.body[1:], inputs)
    signals = _check_end(body[index + 1 :], approximation, carried, bound)
    return RowBehaviour(
        inlined(body),
        frozenset(
            prefix
            for prefix in approximation.prefixes
            if f"{prefix}_violation_inevitable" in carried
        ),
        frozenset(
            prefix
            for prefix in approximation.prefixes
            if signals[prefix]["satisfied_forever"] != "False"
        ),
    )


def _is_odd(name: str) -> str:
    """Test of whether a value is neither true nor false."""
    return f"{name} is not True and {name} is not False"


def _stored(carried: Iterable[str]) -> Iterator[str]:
    return (f"self.{name} = {name}" for name in ("tick", *carried))


def inlined(body: Sequence[ast.stmt]) -> str:
    """Statements of a step that equal `advance` at one row with known values.

    Marks stay on the approximation, because few ticks change one.

    Args:
        body: body of `advance`, in the layout that `check_advance` requires.
    """
    index = next(i for i, part in enumerate(body) if isinstance(part, ast.For))
    loop = body[index]
    assert isinstance(loop, ast.For)
    carried = [ast.unparse(each).partition(" = ")[0] for each in body[3:index]]
    marks = [name for name in carried if name.endswith(tuple(f"_{mark}" for mark in MARKS))]
    others = {f"self.{name} = {name}" for name in ("tick", *marks)}
    statements = [each for each in body[3:index] if ast.unparse(each).split(" = ")[0] not in marks]
    statements += [each for each in loop.body[1:] if not _is_of_odd_values(each)]
    statements += [each for each in body[index + 2 : -1] if ast.unparse(each) not in others]
    on_approximation = _OnApproximation(marks)
    lines = (
        ast.unparse(on_approximation.visit(copy.deepcopy(statement))) for statement in statements
    )
    return "\n".join(["approximation.tick = tick = approximation.tick + 1", *lines])


def _is_of_odd_values(statement: ast.stmt) -> bool:
    """Whether it only has an effect if a value is neither true nor false."""
    match statement:
        case ast.If(ast.BoolOp(ast.And(), [ast.Compare(ast.Name(name)), _]) as test):
            return ast.unparse(test) == _is_odd(name)
        case _:
            return False


class _OnApproximation(ast.NodeTransformer):
    """Transformer that puts `approximation.` before names."""

    def __init__(self, names: Collection[str]) -> None:
        self._names = names

    def visit_Name(self, node: ast.Name) -> ast.expr:
        """`name` as `approximation.name`, `self` as `approximation`."""
        if node.id in self._names:
            return ast.Attribute(ast.Name("approximation", ast.Load()), node.id, node.ctx)
        return ast.Name("approximation", node.ctx) if node.id == "self" else node


def _carried(statements: Sequence[ast.stmt], approximation: ApproximationNames) -> Iterator[str]:
    """Names that are read from the approximation before the first row."""
    fixed = [ast.unparse(statement) for statement in statements]
    require(
        fixed[:3] == ["known = True", "is_possible = self.is_possible", "tick = self.tick"],
        statements[0],
    )
    allowed = (*approximation.cells, *approximation.marks)
    for statement in statements[3:]:
        name = ast.unparse(statement).partition(" = ")[0]
        require(name in allowed and is_one_of(statement, f"{name} = self.{name}"), statement)
        yield name
    require(all(f"{cell} = self.{cell}" in fixed for cell in approximation.cells), statements[0])


def _check_end(
    statements: Sequence[ast.stmt],
    approximation: ApproximationNames,
    carried: Sequence[str],
    bound: frozenset[str],
) -> Mapping[str, Mapping[str, str]]:
    """Check the end of `advance`, which stores cells, marks and signals; returns these texts."""
    pending = {*_stored(carried)}
    if len(statements) < 2:
        raise UnexpectedStatementError(
            "it is not laid out as fretc writes it: `advance` does not end"
        )
    first, *rest, last = statements
    require(is_one_of(first, "if tick == self.tick:\n    return True"), first)
    require(is_one_of(last, "return known"), last)
    signals: dict[str, Mapping[str, str]] = {}
    opened: dict[str, str] = {}
    for statement in rest:
        text = ast.unparse(statement)
        if text in pending:
            pending.remove(text)
        elif text in opened:  # Value of the last tick, not yet stored.
            require(f"self.{opened[text]}_open = {opened[text]}_open" in pending, statement)
        else:
            prefix, values = _signals(statement, approximation)
            require(prefix not in signals, statement)
            for value in values.values():
                _check_value(value, bound - approximation.windows, frozenset())
            signals[prefix] = {name: ast.unparse(value) for name, value in values.items()}
            still_open = signals[prefix]["obligation_pending"]
            opened[normal(f"{prefix}_open = {prefix}_last if {still_open} else -1")] = prefix
    require(not pending and signals.keys() == {*approximation.prefixes}, first)
    return signals


def _signals(
    statement: ast.stmt, approximation: ApproximationNames
) -> tuple[str, Mapping[str, ast.expr]]:
    """Prefix of a requirement, and its signals at the last tick."""
    match statement:
        case ast.Assign([ast.Attribute(ast.Name("self"), name)], ast.Tuple(values)):
            require(name in approximation.signals and len(values) == len(SIGNALS), statement)
            return name.removesuffix("_signals"), dict(zip(SIGNALS, values, strict=True))
    raise UnexpectedStatementError(
        f"it is not laid out as fretc writes it: `{ast.unparse(statement)}`"
    )


@dataclass(frozen=True, slots=True)
class _RowStatements:
    """Statements that are executed for each row."""

    approximation: ApproximationNames
    carried: frozenset[str]

    def check(self, statements: Sequence[ast.stmt], inputs: Mapping[str, str]) -> frozenset[str]:
        """Check the statements; returns the names that have a value after them."""
        bound = {*self.approximation.cells}
        rest = [*statements]
        for proposition, name in inputs.items():
            both = name
            if rest and is_one_of(rest[0], f"{negation(name)} = not {name}"):
                rest.pop(0)
                both = f"{name} = {negation(name)}"
                bound.add(negation(name))
            bound.add(name)
            block = f"""\
if {_is_odd(name)}:
    if {name} is None:
        known = False
        {both} = is_possible
    else:
        {name} = boolean({name}, {proposition!r})"""
            require(
                bool(rest) and is_one_of(rest[0], block), rest[0] if rest else ast.Module([], [])
            )
            rest.pop(0)
        return self._after(rest, frozenset(bound))

    def _after(self, statements: Iterable[ast.stmt], bound: frozenset[str]) -> frozenset[str]:
        """Bound names, with those that the statements assign on every path."""
        for statement in statements:
            if self._remembers(statement, bound):
                continue
            match statement:
                case ast.Assign([ast.Tuple(targets)], ast.Tuple(values)):
                    require(len(targets) == len(values), statement)
                case ast.Assign([ast.Name() as target], value):
                    targets, values = [target], [value]
                case ast.If(test, body, orelse):
                    self._check(test, bound)
                    bound = self._after(body, bound) & self._after(orelse, bound)
                    continue
                case _:
                    require(False, statement)
            for value in values:
                self._check(value, bound)
            bound |= {self._target(target) for target in targets}
        return bound

    def _target(self, node: ast.expr) -> str:
        fixed = {*FIXED, *self.approximation.marks, *self.approximation.windows}
        require(isinstance(node, ast.Name) and node.id not in fixed, node)
        assert isinstance(node, ast.Name)
        return node.id

    def _check(self, value: ast.expr, bound: frozenset[str]) -> None:
        _check_value(value, bound - self.approximation.windows, self.approximation.windows)

    def _remembers(self, statement: ast.stmt, bound: frozenset[str]) -> bool:
        """Check that it only stores the tick of an event in a mark."""
        stored = {n.id for n in ast.walk(statement) if isinstance(n, ast.Name)}
        for mark in self.carried.intersection(self.approximation.marks, stored):
            noted, (kind,) = f"{mark} = tick", (k for k in MARKS if mark.endswith(f"_{k}"))
            match statement:
                case ast.Assign() if kind == "last" and is_one_of(statement, noted):
                    return True
                case ast.If(test, [body], []) if kind == "last" and is_one_of(body, noted):
                    self._check(test, bound)
                    return True
                case ast.If(ast.BoolOp(ast.And(), [once, *tests]), [body], []) if (
                    kind in ("broken", "violation_inevitable")
                    and is_one_of(once, f"{mark} < 0")
                    and is_one_of(body, noted)
                ):
                    for test in tests:
                        self._check(test, bound)
                    return True
                case ast.If(ast.UnaryOp(ast.Not(), test), [closed], [opened]) if (
                    kind == "open"
                    and is_one_of(closed, f"{mark} = -1")
                    and is_one_of(opened, f"if {mark} < 0:\n    {noted}")
                ):
                    self._check(test, bound)
                    return True
        return False


_OPERATORS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE, ast.Eq, ast.NotEq)
"""Operators that do not distinguish True from 1, because a proof takes these as one state."""


def _check_value(node: ast.expr, bound: frozenset[str], windows: frozenset[str]) -> None:
    """Check that it depends only on names that have a value at this tick."""

    def check(*parts: ast.expr) -> None:
        for part in parts:
            _check_value(part, bound, windows)

    match node:
        case ast.Name(name):
            if name not in bound:
                raise UnexpectedStatementError(f"what it does at a tick depends on `{name}`")
        case ast.Constant(value):
            require(isinstance(value, int), node)
        case ast.UnaryOp(ast.Not() | ast.USub(), arg):
            check(arg)
        case ast.BoolOp(_, args):
            check(*args)
        case ast.Compare(left, [operator], [right]):
            require(isinstance(operator, _OPERATORS), node)
            check(left, right)
        case ast.BinOp(left, ast.Add() | ast.Sub(), right):
            check(left, right)
        case ast.IfExp(test, body, orelse):
            check(test, body, orelse)
        case ast.Call(ast.Attribute(ast.Name(name), "step"), [left, right], []):
            require(name in windows, node)
            check(left, right)
        case _:
            require(False, node)
