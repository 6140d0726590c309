"""Functions of a Dafny text, evaluated: enough of the language for what is emitted."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any

_TOKENS = re.compile(
    r"\s*(<==>|==>|=>|:\||::|:=|==|!=|<=|>=|&&|\|\||[-+!<>(){}\[\],.;|:]|\d+(?:\.\d+)?|[A-Za-z_]\w*)"
)
_INTERCEPTOR, _LOOP = "// Interceptor ---", "// Closed loop ---"
Scope = dict[str, Any]
Code = Callable[[Scope], Any]


class Reader:
    """The functions, predicates, constants and datatypes of a part of a text."""

    def __init__(self, text: str, *, interceptor: bool = False) -> None:
        """Of the monitor, or of the interceptor."""
        monitor, _, rest = text.partition(_INTERCEPTOR)
        text = rest.partition(_LOOP)[0] if interceptor else monitor
        text = re.sub(r"//[^\n]*", "", text)
        self.known: Scope = {"true": True, "false": False}
        for datatype in re.findall(r"^datatype \w+ = (.*)$", text, re.MULTILINE):
            for name, fields in re.findall(r"(\w+)(?:\(([^)]*)\))?(?: \||$)", datatype):
                self.known[name] = _constructor(name, re.findall(r"(\w+):", fields))
        for name, value in re.findall(r"^const (\w+): \w+ := (.*)$", text, re.MULTILINE):
            self.known[name] = _Parser(_TOKENS.findall(value)).all()(self.known)
        declared = r"^(?:function|predicate) (\w+)\(([^)]*)\)[^{]*?\n\{\n(.*?)\n\}$"
        for name, datatype, body in re.findall(declared, text, re.MULTILINE | re.DOTALL):
            if name == "Invariant":  # of the proof
                continue
            self.known[name] = self._function(re.findall(r"(\w+):", datatype), body)

    def __getattr__(self, name: str) -> Any:
        return self.known[name]

    def _function(self, parameters: list[str], body: str) -> Callable[..., Any]:
        code = _Parser(_TOKENS.findall(body)).all()

        def call(*args: Any) -> Any:
            return code({**self.known, **dict(zip(parameters, args, strict=True))})

        return call


def _constructor(name: str, fields: list[str]) -> Any:
    """What makes a value; the value itself where it has no fields."""

    def made(*args: Any) -> SimpleNamespace:
        return SimpleNamespace(made_=name, **dict(zip(fields, args, strict=True)))

    return made if fields else made()


_COMPARED: Mapping[str, Callable[[Any, Any], bool]] = {
    "==": lambda a, b: a == b,
    "!=": lambda a, b: a != b,
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
}


class _Parser:
    """Text → closures; Dafny's precedences, as far as the texts use them."""

    def __init__(self, tokens: list[str]) -> None:
        self.tokens = tokens

    def all(self) -> Code:
        code = self.expression()
        assert not self.tokens, self.tokens
        return code

    def at(self, *wanted: str) -> str | None:
        return self.tokens.pop(0) if self.tokens and self.tokens[0] in wanted else None

    def need(self, token: str) -> None:
        assert self.at(token), (token, self.tokens[:6])

    def expression(self) -> Code:
        if self.at("var"):
            name = self.tokens.pop(0)
            self.need(":=")
            value = self.expression()
            self.need(";")
            rest = self.expression()
            return lambda s: rest({**s, name: value(s)})
        if self.at("match"):
            return self.matched()
        if self.at("if"):
            asked = self.expression()
            self.need("then")
            yes = self.expression()
            self.need("else")
            no = self.expression()
            return lambda s: yes(s) if asked(s) else no(s)
        if kind := self.at("forall", "exists"):
            name = self.tokens.pop(0)
            self.need("::")
            body = self.expression()
            every = kind == "forall"
            return lambda s: (all if every else any)(
                body({**s, name: i}) for i in range(len(s["w"]) + 1)
            )
        return self.implied()

    def matched(self) -> Code:
        """The cases of a match; each names a constructor and its fields."""
        subject = self.primary()
        cases: dict[str, tuple[list[str], Code]] = {}
        while self.at("case"):
            name, fields = self.tokens.pop(0), []
            if self.at("("):
                while not self.at(")"):
                    fields.append(self.tokens.pop(0))
                    self.at(",")
            self.need("=>")
            cases[name] = fields, self.expression()

        def code(s: Scope) -> Any:
            made, *values = vars(subject(s)).values()
            fields, body = cases[made]
            return body({**s, **dict(zip(fields, values, strict=True))})

        return code

    def implied(self) -> Code:
        left = self.joined()
        if self.at("==>"):
            right = self.expression()
            return lambda s: not left(s) or right(s)
        if self.at("<==>"):
            other = self.joined()
            return lambda s: bool(left(s)) == bool(other(s))
        return left

    def joined(self) -> Code:
        parts = [self.compared()]
        operator = None
        while found := self.at("&&", "||"):
            assert operator in (None, found), "Dafny does not mix them without parentheses"
            operator = found
            parts.append(self.compared())
        if operator == "||":
            return lambda s: any(part(s) for part in parts)
        return parts[0] if operator is None else lambda s: all(part(s) for part in parts)

    def compared(self) -> Code:
        if self.tokens[0] in ("forall", "exists", "if"):
            return self.expression()
        parts, operators = [self.added()], []
        while found := self.at(*_COMPARED):
            operators.append(_COMPARED[found])
            parts.append(self.added())

        def code(s: Scope) -> Any:
            values = [part(s) for part in parts]
            if not operators:
                return values[0]
            pairs = zip(operators, values, values[1:], strict=False)
            return all(operator(a, b) for operator, a, b in pairs)

        return code

    def added(self) -> Code:
        left = self.unary()
        while sign := self.at("+", "-"):
            left = _sum(left, self.unary(), 1 if sign == "+" else -1)
        return left

    def unary(self) -> Code:
        if self.at("!"):
            arg = self.unary()
            return lambda s: not arg(s)
        if self.at("-"):
            arg = self.unary()
            return lambda s: -arg(s)
        return self.primary()

    def primary(self) -> Code:
        code: Code
        if self.at("("):
            code = self.expression()
            self.need(")")
        elif self.at("|"):
            name = self.tokens.pop(0)
            self.need("|")
            return lambda s: len(s[name])
        else:
            token = self.tokens.pop(0)
            code = (
                (lambda s: number)
                if (number := _number(token)) is not None
                else (lambda s: s[token])
            )
        while mark := self.at("(", "[", "."):
            code = self.after(code, mark)
        return code

    def after(self, code: Code, mark: str) -> Code:
        if mark == "." and self.at("("):
            return self.updated(code)
        if mark == ".":
            name = self.tokens.pop(0)
            return lambda s: getattr(code(s), name)
        args = [] if self.at(")") else [self.expression()]
        while args and self.at(","):
            args.append(self.expression())
        if mark == "[":
            self.need("]")
            return lambda s: code(s)[args[0](s)]
        if args:
            self.need(")")
        return lambda s: code(s)(*[arg(s) for arg in args])

    def updated(self, code: Code) -> Code:
        """`s.(f := e, g := h)`: the same but for some fields."""
        changes: dict[str, Code] = {}
        while not self.at(")"):
            name = self.tokens.pop(0)
            self.need(":=")
            changes[name] = self.expression()
            self.at(",")
        return lambda s: SimpleNamespace(
            **{**vars(code(s)), **{name: change(s) for name, change in changes.items()}}
        )


def _number(token: str) -> int | float | None:
    if not token[0].isdigit():
        return None
    return float(token) if "." in token else int(token)


def _sum(left: Code, right: Code, sign: int) -> Code:
    return lambda s: left(s) + sign * right(s)
