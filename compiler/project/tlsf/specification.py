"""The basic format of TLSF: its text as signals and formulas."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence

from compiler.logic import formula as f
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.recursion import with_recursion_limit

SECTIONS: Mapping[str, str] = {
    "INITIALLY": "INITIALLY",
    "PRESET": "PRESET",
    "REQUIRE": "REQUIRE",
    "REQUIREMENTS": "REQUIRE",
    "ASSERT": "ASSERT",
    "INVARIANTS": "ASSERT",
    "ASSUME": "ASSUME",
    "ASSUMPTIONS": "ASSUME",
    "GUARANTEE": "GUARANTEE",
    "GUARANTEES": "GUARANTEE",
}
"""Name of a section of formulas, in any version → its name in the result."""
ALWAYS = frozenset({"REQUIRE", "ASSERT"})
"""Sections whose formulas hold at every tick."""
OF_ENVIRONMENT = frozenset({"INITIALLY", "REQUIRE", "ASSUME"})
"""Sections with assumptions about the environment."""
_LEXEME = re.compile(
    r"\s+|//[^\n]*|/\*(?:[^*]|\*(?!/))*\*/|"
    r'(?P<text>"[^"]*")|(?P<word>[A-Za-z_@][A-Za-z0-9_@\']*)|(?P<number>\d+)|'
    r"(?P<sign><->|->|&&|\|\||[{}();:,!\[\]=<>+*/%.?|&~-])"
)
_WORDS = {"NOT": "!", "AND": "&&", "OR": "||", "IMPLIES": "->", "EQUIV": "<->"}
_UNARY: Mapping[str, Callable[[f.Formula], f.Formula]] = {
    "!": f.not_,
    "X": f.next_,
    "F": f.eventually,
    "G": f.globally,
}


def _weak_until(left: f.Formula, right: f.Formula) -> f.Formula:
    return f.release(right, f.or_(left, right))


_LEVELS: Sequence[tuple[str, Callable[[f.Formula, f.Formula], f.Formula], bool]] = (
    ("R", f.release, False),
    ("U", f.until, True),
    ("W", _weak_until, True),
    ("->", f.implies, True),
    ("||", f.or_, False),
    ("&&", f.and_, False),
)
"""Binary operators, loosest first: symbol, constructor, whether it groups to the right.

`<->` stands at the level of `->`, and the two group to the right: `a -> b <-> c` is
`a -> (b <-> c)`.
"""
_IMPLICATIONS: Mapping[str, Callable[[f.Formula, f.Formula], f.Formula]] = {
    "->": f.implies,
    "<->": f.iff,
}
_MOST_NESTED = 400


@dataclass(frozen=True, slots=True)
class SectionFormula:
    """A formula of a section, with its text."""

    section: str
    formula: f.Formula
    span: Span


@dataclass(frozen=True, slots=True)
class Specification:
    """A specification of the basic format."""

    title: str
    semantics: str
    target: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    formulas: tuple[SectionFormula, ...]


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str
    text: str
    start: int
    end: int


class _RefusedError(Exception):
    def __init__(self, mistake: Diagnostic) -> None:
        super().__init__(mistake.message)
        self.mistake = mistake


@with_recursion_limit
def read(source: Source) -> Specification | Diagnostic:
    """The specification in a text, or F620 (not TLSF) or F621 (more than the basic format)."""
    try:
        return _Reader(source).specification()
    except _RefusedError as error:
        return error.mistake


class _Reader:
    """Recursive descent over the tokens; `_at` is the index of the next one."""

    def __init__(self, source: Source) -> None:
        self._source, self._at, self._depth = source, 0, 0
        self._tokens = self._lexemes()

    def _lexemes(self) -> list[_Token]:
        tokens, index, text = [], 0, self._source.text
        while index < len(text):
            match = _LEXEME.match(text, index)
            if match is None:
                raise self._wrong(f"`{text[index]}` begins no word of TLSF", index, index + 1)
            if match.lastgroup is not None:
                tokens.append(_Token(match.lastgroup, match[0], index, match.end()))
            index = match.end()
        return [*tokens, _Token("end", "", len(text), len(text))]

    # Tokens

    @property
    def _next(self) -> _Token:
        return self._tokens[self._at]

    def _take(self, *texts: str) -> _Token:
        token = self._next
        if texts and token.text not in texts:
            wanted = " or ".join(f"`{each}`" for each in texts)
            raise self._unexpected(token, wanted)
        if token.kind == "end":
            raise self._unexpected(token, "more")
        self._at += 1
        return token

    def _unexpected(self, token: _Token, wanted: str) -> _RefusedError:
        if token.text == "[" or token.kind == "number":
            return self._not_basic("a bus or an index", token)
        place = f"`{token.text}` stands" if token.text else "the file ends"
        return self._wrong(f"{place} where {wanted} is expected", token.start, token.end)

    def _wrong(self, why: str, start: int, end: int) -> _RefusedError:
        end = min(max(end, start + 1), len(self._source.text))
        span = self._source.span(min(start, end), end)
        return _RefusedError(diagnostic("not_tlsf", span, why=why))

    def _not_basic(self, what: str, token: _Token) -> _RefusedError:
        span = self._source.span(token.start, token.end)
        return _RefusedError(diagnostic("tlsf_of_full_format", span, what=what))

    # Parts

    def specification(self) -> Specification:
        """The whole file."""
        info = self._info()
        if self._next.text == "GLOBAL":
            raise self._not_basic("`GLOBAL`", self._next)
        self._take("MAIN")
        self._take("{")
        signals: dict[str, tuple[str, ...]] = {"INPUTS": (), "OUTPUTS": ()}
        formulas: list[SectionFormula] = []
        while self._next.text != "}":
            name = self._take()
            self._take("{")
            if name.text in signals:
                signals[name.text] = (*signals[name.text], *self._signals())
            elif name.text in SECTIONS:
                known = {*signals["INPUTS"], *signals["OUTPUTS"]}
                formulas.extend(self._section(SECTIONS[name.text], known))
            else:
                raise self._wrong(f"TLSF has no section `{name.text}`", name.start, name.end)
            self._take("}")
        self._take("}")
        if self._next.kind != "end":
            raise self._unexpected(self._next, "the end of the file")
        return Specification(
            info.get("TITLE", ""),
            info.get("SEMANTICS", "Mealy"),
            info.get("TARGET", "Mealy"),
            signals["INPUTS"],
            signals["OUTPUTS"],
            tuple(formulas),
        )

    def _info(self) -> dict[str, str]:
        self._take("INFO")
        self._take("{")
        entries: dict[str, str] = {}
        while self._next.text != "}":
            key = self._take().text
            self._take(":")
            words: list[str] = []
            while self._next.kind in ("text", "word") or self._next.text == ",":
                if self._tokens[self._at + 1].text == ":":
                    break
                words.append(self._take().text)
            entries[key] = " ".join("".join(words).strip('"').split())
        self._take("}")
        return entries

    def _signals(self) -> tuple[str, ...]:
        names = []
        while self._next.text != "}":
            name = self._take()
            if name.kind != "word":
                raise self._unexpected(name, "a name")
            names.append(name.text)
            if self._next.text != "}":
                self._take(";")
        return tuple(names)

    def _section(self, name: str, known: set[str]) -> list[SectionFormula]:
        formulas = []
        while self._next.text != "}":
            first = self._next
            formula = self._formula(0, known)
            last = self._tokens[self._at - 1]
            formulas.append(SectionFormula(name, formula, self._source.span(first.start, last.end)))
            if self._next.text != "}":
                self._take(";")
        return formulas

    def _formula(self, level: int, known: set[str]) -> f.Formula:
        if level == len(_LEVELS):
            return self._unary(known)
        symbol, build, is_right = _LEVELS[level]
        if symbol == "->":
            return self._implied(level, known)
        parts = [self._formula(level + 1, known)]
        while _WORDS.get(self._next.text, self._next.text) == symbol:
            self._take()
            parts.append(self._formula(level + 1, known))
        if symbol in ("&&", "||"):
            return build(*parts) if len(parts) > 1 else parts[0]
        if is_right:
            result = parts.pop()
            while parts:
                result = build(parts.pop(), result)
            return result
        result, *rest = parts
        for each in rest:
            result = build(result, each)
        return result

    def _implied(self, level: int, known: set[str]) -> f.Formula:
        """Operands of `->` and `<->`."""
        operands, builders = [self._formula(level + 1, known)], []
        while (symbol := _WORDS.get(self._next.text, self._next.text)) in _IMPLICATIONS:
            self._take()
            builders.append(_IMPLICATIONS[symbol])
            operands.append(self._formula(level + 1, known))
        result = operands.pop()
        while builders:
            result = builders.pop()(operands.pop(), result)
        return result

    def _unary(self, known: set[str]) -> f.Formula:
        token = self._take()
        self._depth += 1
        if self._depth > _MOST_NESTED:
            raise self._wrong("the formula is nested too deep", token.start, token.end)
        text = _WORDS.get(token.text, token.text)
        if text in _UNARY:
            result = _UNARY[text](self._unary(known))
        elif text == "(":
            result = self._formula(0, known)
            self._take(")")
        elif text in ("true", "false"):
            result = f.Const(text == "true")
        elif token.kind != "word":
            raise self._unexpected(token, "a formula")
        elif text not in known:
            raise self._wrong(f"`{text}` is no input or output", token.start, token.end)
        else:
            result = f.Atom(text)
        self._depth -= 1
        return result
