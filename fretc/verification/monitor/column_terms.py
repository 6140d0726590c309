"""The column program of a monitor's text as terms: equal terms are equal columns of any trace.

A name stands for its assigned term, a parameter for its literal. So two programs with equal terms
differ in the names of their variables only, and a proof about one, at all lengths of a trace, holds
of the other.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from compiler.program.program import SIGNALS
from fretc.verification.monitor.text_check import own


@dataclass(slots=True)
class Terms:
    """Terms as numbers, equal for equal terms; texts to compare share one table."""

    _numbers: dict[tuple[object, ...], int] = field(default_factory=dict)

    def of(self, text: str, place: int) -> tuple[int, ...]:
        """The terms of a requirement's signals, in their order.

        Args:
            text: a monitor's, laid out as fretc writes it.
            place: of the requirement among those of the monitor.

        Raises:
            KeyError, IndexError: a signal, or the requirement, is left out.
        """
        monitor = next(
            node
            for node in own(text).body
            if isinstance(node, ast.ClassDef) and node.name.endswith("Monitor")
        )
        names = {"every": self._number("every"), **self._literals(monitor)}
        (columns,) = (
            part
            for part in monitor.body
            if isinstance(part, ast.FunctionDef) and part.name == "columns"
        )
        *_, last = columns.body
        for statement in columns.body:
            match statement:
                case ast.Assign([ast.Name(name)], value):
                    names[name] = self._term(value, names)
        assert isinstance(last, ast.Return)
        assert isinstance(last.value, ast.Tuple)
        signals = last.value.elts[place]
        assert isinstance(signals, ast.Call)
        terms = {keyword.arg: self._term(keyword.value, names) for keyword in signals.keywords}
        return tuple(terms[name] for name in SIGNALS)

    def _literals(self, monitor: ast.ClassDef) -> dict[str, int]:
        for part in monitor.body:
            match part:
                case ast.Assign([ast.Name("LITERALS")], value):
                    literals: tuple[tuple[str, str, bool], ...] = ast.literal_eval(value)
                    return {
                        name: self._number("literal", proposition, positive)
                        for name, proposition, positive in literals
                    }
        return {}

    def _number(self, *term: object) -> int:
        return self._numbers.setdefault(term, len(self._numbers))

    def _term(self, node: ast.expr, names: Mapping[str, int]) -> int:
        match node:
            case ast.Name(name):
                return names[name]
            case ast.Constant(value):
                return self._number("constant", type(value), value)
            case ast.BinOp(left, operator, right):
                parts: Any = self._term(left, names), self._term(right, names)
                return self._number(type(operator), *parts)
            case ast.Call(ast.Name(name), args):
                return self._number(name, *(self._term(arg, names) for arg in args))
            case _:
                raise AssertionError(f"not laid out as fretc writes it: {ast.unparse(node)}")
