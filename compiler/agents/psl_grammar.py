"""The grammar of AJPF's properties, with its own precedences and no recovery from errors.

    formula  = rel { "U" rel } .              left associative, and U binds loosest
    rel      = imp { "R" imp } .              left associative
    imp      = conj { "->" conj } .           left associative
    conj     = disj { "&" disj } .            `&` is looser than `||`
    disj     = alw { "||" alw } .
    alw      = [ "[]" | "A" ] ev .
    ev       = [ "<>" | "E" ] neg .
    neg      = [ "~" ] atom .
    atom     = "(" formula ")" | modality "(" agent "," literal ")" .

Source: the property grammar of MCAPL. `T`, `F` and `P`, which it has too, are refused: AJPF
crashes on a negated constant, and takes a percept for absent once the agent has read it.
"""

from __future__ import annotations

import re
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import field
from decimal import Decimal

from compiler.logic import formula as f
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import DiagnosticError
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span

KEY_WORDS = frozenset("A E U R B G F I D P T ItD".split())
"""Words of the grammar: no name can be one of them."""
MODALITIES = ("B", "G", "I", "D", "ItD")
FUNCTOR = re.compile(r"[a-z][A-Za-z0-9_]*")
AGENT = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

_TOKEN = re.compile(
    r"""(?P<skip>[ \t]+ | /\*.*?\*/ )
    | (?P<rest>//.*)
    | (?P<string>"[^"\\']*")
    | (?P<foreign><-> | <=> | => | && | != | == | /\*)
    | (?P<sign>-> | \|\| | <> | \[\] | [~&()\[\],.])
    | (?P<number>[0-9]+\.[0-9]+ (?![A-Za-z0-9_<]))
    | (?P<word>[A-Za-z0-9_<]+)
    | (?P<other>.)""",
    re.VERBOSE | re.DOTALL,
)
_MOST_LEVELS = 1000

_DROPPED = {
    "X": "AJPF has no next: state it without `X`",
    "!": "a negation is `~`",
    "not": "a negation is `~`",
    "W": "AJPF has no weak until: `a W b` is `(b) R ((a) || (b))`",
    "V": "release is `R`",
    "M": "AJPF has no strong release: `a M b` is `(b) U ((a) & (b))`",
    "<->": "write two implications: `((a) -> (b)) & ((b) -> (a))`",
    "<=>": "write two implications: `((a) -> (b)) & ((b) -> (a))`",
    "=>": "an implication is `->`",
    "&&": "a conjunction is `&`",
    "and": "a conjunction is `&`",
    "|": "a disjunction is `||`",
    "or": "a disjunction is `||`",
    "%": "`%` does not begin a comment: a comment is a line that begins with `#`",
    "#": "a comment is a whole line, with `#` in its first column",
    "/*": "the comment has no end: close it with `*/`",
    "T": "AJPF crashes on a negated `T`: simplify the constant away",
    "F": "AJPF crashes on a negated `F`: simplify the constant away",
    "P": "AJPF takes a percept for absent once the agent has read it: say what it believes, `B`",
    "[]": "put parentheses around it: AJPF drops an operator that stands here",
    "<>": "put parentheses around it: AJPF drops an operator that stands here",
    "~": "put parentheses around it: AJPF drops an operator that stands here",
    ")": "there is no `(` for it",
}


class AjpfDivergenceError(DiagnosticError):
    """AJPF would misread the text."""


class JoinedText:
    """The text of one formula: its lines, joined without spaces."""

    def __init__(self, source: Source, pieces: Sequence[Span]) -> None:
        self.source = source
        self.text = "".join(piece.text for piece in pieces)
        self._places = [i for piece in pieces for i in range(piece.start, piece.end)]
        self._after = pieces[0].end if not self._places else self._places[-1] + 1

    def span(self, start: int, end: int) -> Span:
        """The span in the file of the characters `start..end`."""
        if start >= end or start >= len(self._places):
            return self.source.span(self._after, self._after)
        return self.source.span(self._places[start], self._places[end - 1] + 1)

    def is_broken(self, start: int, end: int) -> bool:
        """Whether the characters stand on more than one line."""
        return self._places[end - 1] - self._places[start] != end - 1 - start


@dataclass(frozen=True, slots=True)
class _PropertyToken:
    kind: str
    text: str
    span: Span = field(repr=False)


def formula(text: JoinedText) -> tuple[f.Formula, tuple[Span, ...]]:
    """The formula of one property, and the strings in it.

    Raises:
        AjpfDivergenceError: AJPF would repair the text, drop a part of it, or crash.
    """
    reader = _PropertyParser(deque(_tokens(text)), text.span(0, 0))
    tree = reader.formula()
    if reader.tokens:
        tail = reader.tokens[0]
        fix = _DROPPED.get(tail.text, "a property ends with its formula")
        word = tail.text
        raise AjpfDivergenceError(diagnostic("dropped_by_ajpf", tail.span, word=word, help=fix))
    return tree, tuple(reader.strings)


def _tokens(text: JoinedText) -> Iterator[_PropertyToken]:
    for match in _TOKEN.finditer(text.text):
        kind, span = str(match.lastgroup), text.span(*match.span())
        if kind == "skip":
            continue
        broken = text.is_broken(*match.span())
        if kind == "rest" and not broken:
            continue
        if kind == "rest":
            raise AjpfDivergenceError(diagnostic("slashes_in_property", span.part(0, 2)))
        if broken:
            raise AjpfDivergenceError(diagnostic("lines_become_one_word", span, word=match[0]))
        yield _PropertyToken(kind, match[0], span)


_BINARY: tuple[tuple[str, Callable[[f.Formula, f.Formula], f.Formula]], ...] = (
    ("U", f.Until),
    ("R", f.Release),
    ("->", f.Implies),
    ("&", lambda left, right: f.And((left, right))),
    ("||", lambda left, right: f.Or((left, right))),
)
"""The binary operators, the loosest first."""


class _PropertyParser:
    """A parser with one method for each level of the grammar; it collects `strings`."""

    def __init__(self, tokens: deque[_PropertyToken], end: Span) -> None:
        self.tokens = tokens
        self.end = _PropertyToken("end", "the end", end)
        self.strings: list[Span] = []
        self.level = 0

    # Tokens

    @property
    def next(self) -> _PropertyToken:
        return self.tokens[0] if self.tokens else self.end

    def take(self, *wanted: str) -> bool:
        if self.next.text in wanted and self.next.kind in ("sign", "word"):
            self.tokens.popleft()
            return True
        return False

    def need(self, sign: str) -> None:
        if not self.take(sign):
            place = f"before `{self.next.text}`" if self.tokens else "at the end"
            fix = _DROPPED.get(self.next.text, "")
            effect = "AJPF supplies it, or drops what stands there, in silence"
            raise AjpfDivergenceError(
                diagnostic(
                    "sign_missing",
                    self.next.span,
                    sign=sign,
                    place=place,
                    help=f"{effect}{'; ' * bool(fix)}{fix}",
                )
            )

    # Operators

    def formula(self) -> f.Formula:
        return self._chain(0)

    def _chain(self, level: int) -> f.Formula:
        """A chain of the operator of this level, over chains of the next one."""
        if level == len(_BINARY):
            return self._alw()
        operator, build = _BINARY[level]
        left = self._chain(level + 1)
        while self.take(operator):
            left = build(left, self._chain(level + 1))
        return left

    def _alw(self) -> f.Formula:
        return f.Globally(self._ev(), f.EVER) if self.take("[]", "A") else self._ev()

    def _ev(self) -> f.Formula:
        return f.Eventually(self._neg(), f.EVER) if self.take("<>", "E") else self._neg()

    def _neg(self) -> f.Formula:
        return f.Not(self._atom()) if self.take("~") else self._atom()

    def _atom(self) -> f.Formula:
        if self.next.text == "(":
            return self._inside()
        modality = self.next
        if modality.text not in MODALITIES or modality.kind != "word":
            raise self._no_formula(modality)
        self.tokens.popleft()
        self.need("(")
        agent = self._agent()
        self.need(",")
        literal = self._literal()
        self.need(")")
        return f.Atom(f"{modality.text}({agent},{literal})")

    def _inside(self) -> f.Formula:
        self._deeper()
        self.take("(")
        inside = self.formula()
        self.level -= 1
        self.need(")")
        return inside

    def _deeper(self) -> None:
        self.level += 1
        if self.level > _MOST_LEVELS:
            raise AjpfDivergenceError(
                diagnostic("too_many_parentheses", self.next.span, most=_MOST_LEVELS)
            )

    def _no_formula(self, token: _PropertyToken) -> AjpfDivergenceError:
        if token.kind == "end":
            return AjpfDivergenceError(diagnostic("formula_missing", token.span))
        fix = _DROPPED.get(token.text, "an atom is `B(agent,belief)`")
        if token.text[0] in "URAE" and token.text[1:] in MODALITIES:
            fix = f"put a space between: `{token.text[0]} {token.text[1:]}`"
        return AjpfDivergenceError(
            diagnostic("bad_formula_start", token.span, token=token.text, help=fix)
        )

    # Atoms

    def _agent(self) -> str:
        words = [self._word(AGENT, "an agent", "letters, digits and `_`")]
        while self.take("."):
            words.append(self._word(AGENT, "an agent", "letters, digits and `_`"))
        return ".".join(words)

    def _word(self, pattern: re.Pattern[str], kind: str, allowed: str) -> str:
        token = self.next
        if token.kind == "word" and pattern.fullmatch(token.text) and token.text not in KEY_WORDS:
            self.tokens.popleft()
            return token.text
        subject = f"`{token.text}` is" if self.tokens else "there is"
        raise AjpfDivergenceError(
            diagnostic("bad_property_name", token.span, what=subject, kind=kind, allowed=allowed)
        )

    def _literal(self) -> str:
        allowed = "a small letter, then letters, digits and `_`"
        functor = self._word(FUNCTOR, "a belief or an action", allowed)
        return f"{functor}({self._arguments(')')})" if self.take("(") else functor

    def _arguments(self, closing: str) -> str:
        self._deeper()
        arguments = [self._argument()]
        while self.take(","):
            arguments.append(self._argument())
        self.level -= 1
        self.need(closing)
        return ",".join(arguments)

    def _argument(self) -> str:
        token = self.next
        if token.kind == "number" or (token.kind == "word" and token.text.isdigit()):
            self.tokens.popleft()
            return format(Decimal(repr(float(token.text))).normalize(), "f")
        if token.kind == "string":
            self.tokens.popleft()
            self.strings.append(token.span)
            return f"'{token.text[1:-1]}'"
        if self.take("_"):
            return "_"
        if self.take("["):
            return f"[{self._arguments(']')}]"
        return self._literal()
