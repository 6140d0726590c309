"""AJPF property files: only what AJPF reads as it is meant, and the same language as FT."""

import re
from dataclasses import dataclass

import pytest

from compiler import formula as f
from compiler import printing
from compiler.automata import equivalent, same_language
from compiler.pipeline import formalize
from compiler.rule import Rule
from compiler.targets import TARGETS
from compiler.targets.ajpf import property_
from fretish.diagnostic import Code
from fretish.documents import Requirement
from fretish.rendering import render
from fretish.source import Source
from tests.strategies import Template, templates

R1 = "whenever too_close agilex_agent shall eventually satisfy stopped"


def rule(sentence: str, id: str = "R1") -> Rule:
    made, said = formalize(Requirement(id, Source("r.fret", sentence).span()), None)
    assert made is not None, said
    return made


def emitted(sentence: str, id: str = "R1") -> str:
    made = rule(sentence, id)
    assert TARGETS["ajpf"].refuse(made) is None
    (file,) = TARGETS["ajpf"].emit([made])
    return file.text


def refused(sentence: str) -> str:
    told = TARGETS["ajpf"].refuse(rule(sentence))
    assert told is not None
    assert told.code is Code.NOT_EXPRESSIBLE
    return render(told)


# The reader of property files -----------------------------------------------------------------


def properties(text: str) -> dict[str, str]:
    """As AJPF's file reader takes a file apart, with nothing that it would repair or drop."""
    assert text.isascii()
    assert "//" not in text
    assert "%" not in text
    found: dict[str, str] = {}
    for line in text.splitlines():
        if line.startswith("#"):
            continue
        assert line.count(":") == 1, "a second `:` cuts the formula; a line without one is glued"
        key, formula = line.split(":")
        assert re.fullmatch(r"[A-Za-z0-9_.-]+", key)
        assert key not in found
        assert formula.strip()
        found[key] = formula.strip()
    return found


_TOKENS = re.compile(r"\s*(->|\|\||<>|\[\]|[~&()\[\],.]|[A-Za-z_0-9]+)")
_KEY_WORDS = {"A", "E", "U", "R", "B", "G", "I", "F", "D", "P", "T", "ItD"}


class NotAjpfError(Exception):
    """The text is not of the grammar, so AJPF would repair it in silence."""


@dataclass
class Reader:
    """AJPF's grammar as it is, with its own precedences, and no recovery from errors.

    `said` is the formula in Spot's syntax; every belief B(agent,atom) is the proposition atom.
    """

    tokens: list[str]
    agents: set[str]

    def take(self, *wanted: str) -> str | None:
        if self.tokens and self.tokens[0] in wanted:
            return self.tokens.pop(0)
        return None

    def need(self, token: str) -> None:
        if self.take(token) is None:
            raise NotAjpfError(f"`{token}` is missing before {self.tokens[:4]}")

    def formula(self) -> str:
        left = self.rel()
        while self.take("U"):
            left = f"({left} U {self.rel()})"
        return left

    def rel(self) -> str:
        left = self.imp()
        while self.take("R"):
            left = f"({left} R {self.imp()})"
        return left

    def imp(self) -> str:
        left = self.conj()
        while self.take("->"):
            left = f"({left} -> {self.conj()})"
        return left

    def conj(self) -> str:
        left = self.disj()
        while self.take("&"):
            left = f"({left} & {self.disj()})"
        return left

    def disj(self) -> str:
        left = self.alw()
        while self.take("||"):
            left = f"({left} | {self.alw()})"
        return left

    def alw(self) -> str:
        return f"(G {self.ev()})" if self.take("[]", "A") else self.ev()

    def ev(self) -> str:
        return f"(F {self.neg()})" if self.take("<>", "E") else self.neg()

    def neg(self) -> str:
        return f"(! {self.atom()})" if self.take("~") else self.atom()

    def atom(self) -> str:
        if self.take("("):
            inside = self.formula()
            self.need(")")
            return inside
        self.need("B")
        self.need("(")
        self.agents.add(self.word(r"[A-Za-z][A-Za-z0-9_]*"))
        self.need(",")
        functor = self.word(r"[a-z][A-Za-z0-9_]*")
        self.need(")")
        return f'"{functor}"'

    def word(self, pattern: str) -> str:
        word = self.tokens.pop(0) if self.tokens else ""
        if not re.fullmatch(pattern, word) or word in _KEY_WORDS:
            raise NotAjpfError(f"`{word}` is no name here")
        return word


def read(formula: str) -> tuple[str, set[str]]:
    """The formula in Spot's syntax, and the agents that it names."""
    tokens, at = [], 0
    while at < len(formula):
        match = _TOKENS.match(formula, at)
        if match is None:
            raise NotAjpfError(f"no token at {formula[at : at + 10]!r}")
        tokens.append(match[1])
        at = match.end()
    reader = Reader(tokens, set())
    said = reader.formula()
    if reader.tokens:
        raise NotAjpfError(f"dropped in silence: {reader.tokens}")
    return said, reader.agents


@pytest.mark.parametrize(
    "text",
    [
        "X B(a,p)",
        "! B(a,p)",
        "not B(a,p)",
        "B(a,~p)",
        "<> [] B(a,p)",
        "[] [] B(a,p)",
        "~~B(a,p)",
        "[] ~ <> B(a,p)",
        "(B(a,p)",
        "B(a,p) )",
        "B(a,p) W B(a,q)",
        "B(a,p) <-> B(a,q)",
        "B(a,P)",
        "B(a-b,p)",
        "B(a,_p)",
        "B(T,p)",
        "B(a,p()))",
        "T",
        "",
    ],
)
def test_the_strict_reader_refuses_what_ajpf_repairs(text: str) -> None:
    with pytest.raises(NotAjpfError):
        read(text)


def test_the_strict_reader_groups_as_ajpf_does() -> None:
    assert read("[] B(a,p) -> B(a,q)")[0] == '((G "p") -> "q")'
    assert read("B(a,p) & B(a,q) || B(a,r)")[0] == '("p" & ("q" | "r"))'
    assert read("B(a,p) -> B(a,q) U B(a,r)")[0] == '(("p" -> "q") U "r")'
    assert read("B(a,p) -> B(a,q) -> B(a,r)")[0] == '(("p" -> "q") -> "r")'
    assert read("[] <> ~ B(a,p)")[0] == '(G (F (! "p")))'


# What is emitted ------------------------------------------------------------------------------


def test_r1_is_the_property_of_the_paper() -> None:
    text = emitted(R1)
    assert text.splitlines()[-1] == (
        "R1: [] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))"
    )
    assert properties(text) == {
        "R1": "[] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))"
    }


def expressible() -> list[Template]:
    return [t for t in templates((0, 2)) if TARGETS["ajpf"].refuse(rule(t.sentence)) is None]


def test_many_templates_can_be_expressed() -> None:
    found = {(t.scope, t.condition, t.timing) for t in expressible()}
    assert ("null", "holding", "eventually") in found
    assert ("null", "holding", "until") in found
    assert ("onlyBefore", "holding", "always") in found
    assert not any(timing == "next" for _, _, timing in found)
    assert len(found) > 20


def test_a_mode_guards_what_is_demanded_in_it() -> None:
    (formula,) = properties(emitted("in m, the sw shall always satisfy q")).values()
    assert same_language(read(formula)[0], "G(m -> q)")


def test_every_property_has_the_language_of_the_formula() -> None:
    for template in expressible():
        (formula,) = properties(emitted(template.sentence)).values()
        said, agents = read(formula)
        assert agents == {"sw"}
        assert same_language(said, printing.future(rule(template.sentence).ft_infinite)), template


@pytest.mark.parametrize(
    "response",
    [
        "p & q & r & s",
        "p | q | r | s",
        "p & q | r & s",
        "p -> q -> r",
        "(p -> q) -> r",
        "p <-> q",
        "p xor q",
        "p xor q xor r",
        "p <-> q <-> r",
        "!(p & !q)",
        "!!p",
        "!(p xor q)",
        "!(p <-> (q xor r))",
        "if p then q & if r then s",
    ],
)
def test_every_grouping_survives(response: str) -> None:
    for sentence in (
        f"the sw shall always satisfy {response}",
        f"whenever {response} the sw shall eventually satisfy !({response})",
        f"whenever p the sw shall until {response} satisfy q",
    ):
        (formula,) = properties(emitted(sentence)).values()
        said, _ = read(formula)
        assert same_language(said, printing.future(rule(sentence).ft_infinite)), sentence


def fully_parenthesized(formula: str) -> bool:
    """No two binary operators stand side by side, and a unary one has its own parentheses."""
    depth, binary, unary = 0, {0: 0}, {0: 0}
    for token in _TOKENS.findall(formula):
        if token == "(":
            depth += 1
            binary[depth] = unary[depth] = 0
        elif token == ")":
            depth -= 1
        elif token in ("->", "&", "||", "U", "R"):
            binary[depth] += 1
        elif token in ("[]", "<>", "~"):
            unary[depth] += 1
        if binary[depth] + unary[depth] > 1:
            return False
    return True


def test_ajpf_is_never_asked_for_its_own_grouping() -> None:
    assert fully_parenthesized("((B(a,p)) & (B(a,q))) & (~B(a,r))")
    assert not fully_parenthesized("(B(a,p)) & (B(a,q)) & (B(a,r))")
    assert not fully_parenthesized("[] (B(a,p)) -> (B(a,q))")
    for sentence in (
        *(template.sentence for template in expressible()),
        "the sw shall always satisfy p & q & r & s",
        "the sw shall always satisfy !(p | q | r) xor (p <-> !q)",
    ):
        for formula in properties(emitted(sentence)).values():
            assert fully_parenthesized(formula), formula


def test_nested_temporal_operators_keep_their_grouping() -> None:
    p, q, r = f.Atom("p"), f.Atom("q"), f.Atom("r")
    for formula in (
        f.Not(f.Globally(f.Not(f.Eventually(f.Not(p), f.EVER)), f.EVER)),
        f.Eventually(f.Globally(p, f.EVER), f.EVER),
        f.Until(f.Implies(p, q), f.Until(q, r)),
        f.Until(f.Until(p, q), r),
        f.Release(f.And((p, q, r)), f.Or((p, f.Not(q), r))),
        f.Implies(f.Globally(p, f.EVER), f.Eventually(q, f.EVER)),
        f.Xor(f.Iff(p, q), f.Not(r)),
    ):
        said, _ = read(property_(formula, "sw"))
        assert same_language(said, printing.future(formula)), formula
    assert not equivalent(f.Eventually(p, f.EVER), f.Globally(p, f.EVER))


# What is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "sentence",
    [
        "the sw shall at the next timepoint satisfy q",
        "whenever p the sw shall at the next timepoint satisfy q",
        "when p the sw shall eventually satisfy q",
        "whenever p the sw shall within 3 ticks satisfy q",
        "whenever p the sw shall for 3 ticks satisfy q",
        "whenever p the sw shall after 3 ticks satisfy q",
        "after m, the sw shall always satisfy q",
        "the sw shall always satisfy x > 3",
        "the sw shall always satisfy f(p)",
        "the sw shall always satisfy persisted(2, p)",
        "the sw shall always satisfy Stopped",
        "the sw shall always satisfy arm.joint",
        "the sw shall always satisfy load%",
        'the sw shall always satisfy "two words"',
        'the sw shall always satisfy "1st"',
        'the sw shall always satisfy "_p"',
        'the sw shall always satisfy "p\u00e9"',
        "the sw shall finally satisfy q",
        "the sw shall always satisfy true",
        "the sw shall always satisfy q | !false",
        "the sw shall never satisfy true",
        'the "agilex-agent" shall always satisfy q',
        'the "agilex agent" shall always satisfy q',
        "arm.joint shall always satisfy q",
        "T shall always satisfy q",
        "B shall always satisfy q",
        "ItD shall always satisfy q",
        "P shall always satisfy q",
        "the sw shall with probability >= 0.9 always satisfy q",
    ],
)
def test_what_ajpf_cannot_say_is_refused(sentence: str) -> None:
    assert refused(sentence).startswith("F601 AJPF cannot express ")


def test_a_property_that_holds_a_constant_is_refused_or_has_none() -> None:
    """AJPF crashes on a negated T, and `T -> x` holds one."""
    for sentence in (
        "whenever true the sw shall eventually satisfy q",
        "whenever p the sw shall until false satisfy q",
        "whenever p the sw shall before true satisfy q",
        "the sw shall always satisfy p | p & !p",
    ):
        made = rule(sentence)
        if TARGETS["ajpf"].refuse(made) is None:
            (formula,) = properties(emitted(sentence)).values()
            assert same_language(read(formula)[0], printing.future(made.ft_infinite))


@pytest.mark.parametrize(
    "timing", ["immediately", "within 0 ticks", "for 0 ticks", "within 0 seconds"]
)
def test_immediately_is_refused(timing: str) -> None:
    """`Immediately` has no meaning there: an agent needs several states to react."""
    for start in ("the sw", "whenever p the sw", "before m, the sw"):
        assert refused(f"{start} shall {timing} satisfy q").startswith("F601 ")


def test_a_refusal_names_the_part_and_the_way_out() -> None:
    assert refused("whenever p the sw shall within 3 ticks satisfy q") == (
        "F601 AJPF cannot express the timing `within 3 ticks` of R1\n"
        "  --> r.fret:1:1\n"
        "   | whenever p the sw shall within 3 ticks satisfy q\n"
        "   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^\n"
        "help: AJPF has no next, no past and no time; state the requirement with `eventually`, or "
        "check it with `--emit monitor`"
    )


@pytest.mark.parametrize("id", ["R1", "HAZ-003.a", "7"])
def test_the_key_is_the_requirements_id(id: str) -> None:
    assert list(properties(emitted(R1, id))) == [id]


def test_a_sentence_of_many_lines_is_one_comment() -> None:
    text = emitted("whenever too_close\n agilex_agent shall\r\n\n eventually satisfy stopped")
    assert len(properties(text)) == 1
    assert [line[0] for line in text.splitlines()] == ["#", "R"]
