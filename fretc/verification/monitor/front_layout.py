"""Layout of the methods that compute truth values from variables.

The code may only call functions of the runtime part, on the variables of the tick and stored values
of the previous tick.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence

from compiler.targets.python.comparisons import ANNOTATIONS, FUNCTIONS, NUMBER, TRUTH, WORD
from fretc.verification.monitor.statements import (
    UnexpectedStatementError,
    body_of,
    constants,
    is_one_of,
    reads,
    require,
)
from fretish.expressions import MOST_EXPONENT
from monitors.kernel.variables import Variable

_CONSTANT = re.compile(r"-?[0-9]{1,4300}(?:\.[0-9]{1,60}|/[1-9][0-9]{0,4300})?", re.ASCII)
_SIGNS = frozenset({"<", "<=", ">", ">=", "=", "!="})
_COMPUTED = FUNCTIONS - {*"measurement truth_value word exact power compared is_word".split()}
"""Functions with only numbers as arguments."""


def declared_variables(node: ast.stmt) -> Mapping[str, Variable]:
    """The variables of a monitor.

    Raises:
        UnexpectedCodeError: they do not have the layout that fretc writes.
    """
    variables: dict[str, Variable] = {}
    match node:
        case ast.AnnAssign(ast.Name("VARIABLES"), _, ast.Dict(keys, values)):
            for key, value in zip(keys, values, strict=True):
                match key, value:
                    case ast.Constant(str(name)), ast.Call(ast.Name("Variable"), args, more):
                        require(name not in variables, node)
                        variables[name] = _variable(args, more, node)
                    case _:
                        require(False, node)
        case _:
            require(False, node)
    require(bool(variables), node)
    return variables


def _variable(args: Sequence[ast.expr], more: Sequence[ast.keyword], node: ast.stmt) -> Variable:
    match args, more:
        case [ast.Constant(str(parameter)), ast.Constant("number" | "truth" as kind)], []:
            return Variable(parameter, kind)
        case [ast.Constant(str(parameter)), ast.Constant("number")], [
            ast.keyword("infinite", value)
        ]:
            infinite = tuple(each for each in ("+inf", "-inf") if each in constants(value))
            require(bool(infinite) and infinite == constants(value), node)
            return Variable(parameter, NUMBER, infinite=infinite)
        case [ast.Constant(str(parameter)), ast.Constant("word"), words], []:
            texts = tuple(word for word in constants(words) if isinstance(word, str))
            require(bool(texts) and texts == constants(words), node)
            return Variable(parameter, WORD, texts)
        case _:
            raise UnexpectedStatementError(
                f"it is not laid out as fretc writes it: `{ast.unparse(node)}`"
            )


def check_front(
    methods: tuple[ast.stmt, ast.stmt, ast.stmt],
    variables: Mapping[str, Variable],
    propositions: Sequence[str],
    requirements: int,
) -> None:
    """Check that the methods compute truth values and step by them, and do nothing else.

    Args:
        methods: `truths`, `step` and `run`.
        variables: `VARIABLES`.
        propositions: names of the truth values.
        requirements: number of requirements of the monitor.

    Raises:
        UnexpectedCodeError: they do something else.
    """
    truths, step, run = methods
    names = [variable.parameter for variable in variables.values()]
    parameters = ", ".join(f"{v.parameter}: {ANNOTATIONS[v.kind]}" for v in variables.values())
    verdicts = "self.verdicts()" + "[0]" * (requirements == 1)
    row = _tuple(names)
    stepped = body_of(step, "step", f"self, *, {parameters}")
    require(reads(stepped, f"self.take(({row},))\nreturn {verdicts}"), step)
    rows = "self, rows: 'Iterable[Sequence[Value] | Mapping[str, Value]]'"
    require(reads(body_of(run, "run", rows), f"self.take(rows)\nreturn {verdicts}"), run)
    body = body_of(truths, "truths", f"self, {parameters}")
    given, rest, last = body[: len(names)], body[len(names) : -1], body[-1]
    require(reads(given, "\n".join(_given(variables))), truths)
    require(is_one_of(last, f"return {_tuple(propositions)}"), last)
    bound = _check_statements(rest, frozenset(names))
    require(bound >= {*propositions}, last)


def _tuple(names: Iterable[str]) -> str:
    return "(" + "".join(f"{name}, " for name in names) + ")"


def _given(variables: Mapping[str, Variable]) -> Iterator[str]:
    """The statements that assign the variables."""
    for name, (parameter, kind, words, infinite) in variables.items():
        function = {NUMBER: "measurement", TRUTH: "truth_value", WORD: "word"}[kind]
        more = f", {words!r}" if kind == WORD else "".join(f", {each!r}" for each in infinite)
        yield f"{parameter} = {function}({parameter}, {name!r}{more})"


def _check_statements(statements: Sequence[ast.stmt], bound: frozenset[str]) -> frozenset[str]:
    """The names that have a value after the statements."""
    fixed = FUNCTIONS | {"self", "kept"}
    for index, statement in enumerate(statements):
        if index == 0 and is_one_of(statement, "kept = self.kept"):
            bound |= {"kept"}
            continue
        match statement:
            case ast.Assign([ast.Name(name)], ast.IfExp(_, before, ast.Subscript(_, at)) as value):
                form = f"{ast.unparse(before)} if kept is None else kept[{ast.unparse(at)}]"
                require("kept" in bound and is_one_of(value, form), statement)
                require(isinstance(at, ast.Constant) and type(at.value) is int, statement)
                _check_number(before, bound)
            case ast.Assign([ast.Name(name)], value):
                _check_truth(value, bound)
            case ast.Assign([ast.Attribute(ast.Name("self"), "kept")], ast.Tuple(values)):
                require(index == len(statements) - 1 and "kept" in bound, statement)
                for each in values:
                    _check_number(each, bound)
                continue
            case _:
                raise UnexpectedStatementError(
                    f"it is not laid out as fretc writes it: `{ast.unparse(statement)}`"
                )
        require(name not in fixed and name not in bound, statement)
        bound |= {name}
    return bound


def _check_truth(node: ast.expr, bound: frozenset[str]) -> None:
    match node:
        case ast.Constant(None | True | False):
            pass
        case ast.Call(ast.Name("compared" | "is_word"), [left, ast.Constant(str(sign)), right], []):
            require(sign in _SIGNS, node)
            _check_number(left, bound)
            _check_number(right, bound)
        case _:
            require(False, node)


def _check_number(node: ast.expr, bound: frozenset[str]) -> None:
    match node:
        case ast.Name(name):
            require(name in bound and name != "kept", node)
        case ast.Constant(str()):
            pass  # An enumeration value.
        case ast.Call(ast.Name("exact"), [ast.Constant(str(text))], []):
            require(_CONSTANT.fullmatch(text) is not None, node)
        case ast.Call(ast.Name("power"), [base, ast.Constant(int(exponent))], []):
            require(type(exponent) is int and 1 <= exponent <= MOST_EXPONENT, node)
            _check_number(base, bound)
        case ast.Call(ast.Name(name), args, []):
            require(name in _COMPUTED, node)
            for arg in args:
                _check_number(arg, bound)
        case _:
            require(False, node)
