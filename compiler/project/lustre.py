"""Conversion of FRET's assignments between Lustre and the expressions of FRETish.

Only expressions with a certainly equal meaning are converted; other Lustre (`if`, `div`, `pre`
without a first value) stays text. `0.0 -> pre x`, with a literal that shows the type, is
`preReal(0.0, x)`; `0.0 -> (x - pre x) * 2.0` is `(x - preReal(x, x)) * 2.0`, which is 0 at the
first tick. Source: Lustre V6 reference manual, expressions and their precedences.
"""

from __future__ import annotations

import re
from typing import assert_never

from compiler.logic.spelling.reserved_words import LUSTRE
from fretish import expressions as e
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.source import Source
from fretish.parser import parse_value
from fretish.reading.recursion import with_recursion_limit

_LEXEME = re.compile(
    r"\s*(?:(?P<word>[A-Za-z_]\w*)|(?P<number>\d+(?:\.\d+)?(?:[eE][+-]?\d+)?)"
    r"|(?P<sign><>|<=|>=|=>|->|[-+*/<>=(),]))"
)
_WORDS = {"and": "&", "or": "|", "not": "!", "xor": "xor", "mod": "mod", "true": "true",
          "false": "false"}  # fmt: skip
_FOREIGN = frozenset(
    "current when merge fby if then else with div nor int real bool let tel node const "
    "returns var at of the is".split()
)
"""Words that are reserved in Lustre or in FRETish."""
_SIGNS = {"<>": "!=", "=>": "->"}
_ENDS_NEGATION = frozenset({")", ",", "and", "or", "=>", "xor", ""})
"""Tokens that may follow a negated name: whether `not` binds closer than `=` is disputed."""
_MOST = 20_000
"""Maximum number of characters of an assignment."""
_MOST_DELAYS = 50


def fretish(text: str) -> e.Expression | None:
    """The assignment in FRETish; None if that is not certain."""
    if len(text) > _MOST:
        return None
    lexemes = _delayed(_differences(_lexemes(text) or []))
    if not lexemes or {"->", "pre"} & {*lexemes} or not _is_clear(lexemes):
        return None
    words = " ".join(_WORDS.get(word, _SIGNS.get(word, word)) for word in lexemes)
    tree = parse_value(Source("assignment", words).span())
    if isinstance(tree, Diagnostic) or any(isinstance(p, e.Quantity) for p in e.parts(tree)):
        return None
    return tree


def _lexemes(text: str) -> list[str] | None:
    lexemes, index = [], 0
    while text[index:].strip():
        match = _LEXEME.match(text, index)
        if match is None or match["word"] in _FOREIGN:
            return None
        lexemes.append(match[0].strip())
        index = match.end()
    return lexemes


def _differences(lexemes: list[str]) -> list[str]:
    """The tokens with `(x - preReal(x, x))` for `0.0 -> (x - pre x)`, also times a number.

    Only where nothing else is in the assignment: its first value is 0, and so is the difference of
    a number and itself.
    """
    match lexemes:
        case [zero, "->", "(", name, "-", "pre", other, ")", *rest]:
            pass
        case [zero, "->", name, "-", "pre", other, *rest]:
            pass
        case _:
            return lexemes
    scaled = not rest or (rest[0] in ("*", "/") and len(rest) == 2 and rest[1][0].isdigit())
    is_scaled = bool(rest) and lexemes[2] != "("
    is_name = name == other and re.fullmatch(r"[A-Za-z_]\w*", name) and name not in _WORDS
    if not re.fullmatch(r"0+(\.0*)?", zero) or not scaled or is_scaled or not is_name:
        return lexemes
    if rest and rest[0] == "/" and not re.search(r"[1-9]", rest[1]):
        return lexemes
    return ["(", name, "-", _function([zero]), "(", name, ",", name, ")", ")", *rest]


def _delayed(lexemes: list[str]) -> list[str]:
    """The tokens with `preReal(0.0, x)` for `0.0 -> pre x` that stands alone or in parentheses."""
    rewritten = lexemes if lexemes.count("->") <= _MOST_DELAYS else []
    for arrow in reversed([i for i, word in enumerate(rewritten) if word == "->"]):
        first, after = _literal(rewritten[:arrow]), _after_pre(rewritten, arrow)
        begin = arrow - len(first)
        alone = rewritten[begin - 1 : begin] in ([], ["("]) and rewritten[after : after + 1] in (
            [],
            [")"],
        )
        if not first or not after or not alone or _is_called(rewritten, begin - 1):
            return []
        inner = rewritten[arrow + 2 : after]
        rewritten = [
            *rewritten[:begin],
            _function(first),
            "(",
            *first,
            ",",
            *inner,
            ")",
            *rewritten[after:],
        ]
    return rewritten


def _literal(before: list[str]) -> list[str]:
    """The literal at the end; empty if there is none."""
    last = before[-1:]
    if last and (last[0] in ("true", "false") or last[0][0].isdigit()):
        negative = before[-2:-1] == ["-"] and last[0][0].isdigit()
        return before[-2:] if negative else last
    return []


def _after_pre(lexemes: list[str], arrow: int) -> int:
    """The index after the following `pre x` or `pre (...)`; 0 if there is none."""
    if lexemes[arrow + 1 : arrow + 2] != ["pre"] or len(lexemes) < arrow + 3:
        return 0
    start, level = arrow + 2, 0
    if lexemes[start] != "(":
        is_name = re.fullmatch(r"[A-Za-z_]\w*", lexemes[start]) and lexemes[start] not in _WORDS
        return start + 1 if is_name and lexemes[start + 1 : start + 2] != ["("] else 0
    for index in range(start, len(lexemes)):
        level += {"(": 1, ")": -1}.get(lexemes[index], 0)
        if level == 0:
            return index + 1
    return 0


def _is_called(lexemes: list[str], opening: int) -> bool:
    """Whether the parenthesis contains the arguments of a function."""
    before = lexemes[opening - 1 : opening] if opening > 0 else []
    return bool(before) and before[0] not in (*_WORDS, "pre") and before[0][0].isalpha()


def _function(first: list[str]) -> str:
    """The function for the type of the literal."""
    if first[-1] in ("true", "false"):
        return "preBool"
    return "preReal" if "." in first[-1] or "e" in first[-1].lower() else "preInt"


def _is_clear(lexemes: list[str]) -> bool:
    """Whether `or` and `xor` are not mixed, nor `not` and a comparison: their ranks differ."""
    if any({"or", "xor"} <= signs for signs in _levels(lexemes)):
        return False
    for i, word in enumerate(lexemes):
        after = [*lexemes[i + 1 : i + 3], "", ""]
        if word == "not" and after[0] not in ("(", "not") and after[1] not in _ENDS_NEGATION:
            return False
        if word == "not" and after[0] == "(" and not _is_followed(lexemes, i + 1):
            return False
    return True


def _levels(lexemes: list[str]) -> list[set[str]]:
    """The tokens of each pair of parentheses, and of the top level, without nested ones."""
    levels: list[set[str]] = [set()]
    open_ = [0]
    for word in lexemes:
        if word == "(":
            open_.append(len(levels))
            levels.append(set())
        elif word == ")" and len(open_) > 1:
            open_.pop()
        else:
            levels[open_[-1]].add(word)
    return levels


def _is_followed(lexemes: list[str], opening: int) -> bool:
    """Whether the token after the closing parenthesis ends a negation."""
    level = 0
    for i in range(opening, len(lexemes)):
        level += {"(": 1, ")": -1}.get(lexemes[i], 0)
        if level == 0:
            return [*lexemes, ""][i + 1] in _ENDS_NEGATION
    return False


@with_recursion_limit
def lustre(tree: e.Expression) -> str | None:
    """The expression as FRET's assignment; None if Lustre cannot express it."""
    if any(not _has(part) for part in e.parts(tree)):
        return None
    return _text(tree)


def _has(part: e.Expression) -> bool:
    match part:
        case e.Quantity() | e.Word() | e.Persistence() | e.Calculation() | e.Arithmetic("^"):
            return False
        case e.Name(id) | e.Call(id):
            return re.fullmatch(r"[A-Za-z_]\w*", id) is not None and id not in LUSTRE
        case _:
            return True


def _text(tree: e.Expression) -> str:
    """The text, with parentheses around every nested operator."""
    match tree:
        case e.Truth(value):
            return str(value).lower()
        case e.Name(id):
            return id
        case e.Number(digits):
            return digits
        case e.Call(name, args):
            return f"{name}({', '.join(map(_text, args))})"
        case e.Negation(arg):
            return f"-{_inner(arg)}"
        case e.Not(arg):
            return f"not ({_text(arg)})"
        case e.And(args):
            return " and ".join(map(_inner, args))
        case e.Or(args):
            return " or ".join(map(_inner, args))
        case e.Xor(left, right):
            return f"{_inner(left)} xor {_inner(right)}"
        case e.Implies(left, right):
            return f"{_inner(left)} => {_inner(right)}"
        case e.Iff(left, right):
            return f"{_inner(left)} = {_inner(right)}"
        case e.Comparison(op, left, right):
            return f"{_inner(left)} {'<>' if op == '!=' else op} {_inner(right)}"
        case e.Arithmetic(op, left, right):
            return f"{_inner(left)} {op} {_inner(right)}"
        case e.Quantity() | e.Word() | e.Persistence() | e.Calculation() | e.Temporal():
            raise AssertionError("Lustre has none")
        case _:
            assert_never(tree)


def _inner(tree: e.Expression) -> str:
    simple = isinstance(tree, e.Truth | e.Name | e.Number | e.Call)
    return _text(tree) if simple else f"({_text(tree)})"
