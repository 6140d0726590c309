"""Strict reader of Gwendolen agents (`.gwen`): what MCAPL would silently repair is an error.

MCAPL's parser prints a syntax error and goes on, so the agent that runs and is verified differs
from the one in the file. This reader reads an agent exactly as MCAPL does, or F610 reports what
MCAPL would make of it. F611 names what is valid Gwendolen but not part of the model in `model.py`.

Source: the grammar of MCAPL; Dennis, Gwendolen semantics: 2017, University of Liverpool.
"""

from __future__ import annotations

from dataclasses import field
from decimal import Decimal
from functools import cache
from pathlib import Path
from typing import Literal, cast

from lark import Lark, Token, Tree
from lark.exceptions import UnexpectedInput

from compiler.agents.gwendolen_errors import (
    HEADINGS,
    TrapError,
    beyond,
    unexpected,
)
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.limits import with_budget

Sign = Literal["+", "-"]


@dataclass(frozen=True, slots=True)
class BeliefChange:
    """`+b` or `-b`: as a deed, what the agent does to its beliefs; as an event, what happened."""

    sign: Sign
    belief: str

    def __str__(self) -> str:
        """The text in Gwendolen."""
        return f"{self.sign}{self.belief}"


@dataclass(frozen=True, slots=True)
class Action:
    """`stop_moving`, `move(1,2)`: what the environment does for the agent."""

    name: str

    def __str__(self) -> str:
        """The text in Gwendolen."""
        return self.name


Deed = BeliefChange | Action


@dataclass(frozen=True, slots=True)
class BeliefGuard:
    """`B b` or `~B b`."""

    positive: bool
    belief: str


@dataclass(frozen=True, slots=True)
class AgentPlan:
    """`event : {guards} <- deeds;`; it may be chosen where all of the guards hold."""

    event: BeliefChange
    guards: tuple[BeliefGuard, ...]
    """The guard, or None for `True`."""
    deeds: tuple[Deed, ...]
    span: Span = field(compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Agent:
    """One agent. Beliefs and actions are spelt without white space, numbers by their value."""

    name: str
    beliefs: tuple[str, ...]
    """The initial beliefs."""
    plans: tuple[AgentPlan, ...]
    """In the order of the file, in which they are tried."""
    name_span: Span = field(compare=False, repr=False)


_MOST_LEVELS = 50


def read(source: Source) -> Agent | Diagnostic:
    """The agent of a file; F610 if MCAPL misreads it, F611 for a feature beyond the model."""
    return with_budget(len(source.text), source.span(0, 0), lambda: _read(source))


def _read(source: Source) -> Agent | Diagnostic:
    try:
        return _AgentReader(source).agent(_lark().parse(source.text))
    except UnexpectedInput as error:
        return unexpected(error, source)
    except TrapError as trap:
        return trap.diagnostic


@cache
def _lark() -> Lark:
    grammar = Path(__file__).with_name("gwendolen.lark").read_text(encoding="utf-8")
    return Lark(grammar, parser="lalr", lexer="contextual", propagate_positions=True)


class _AgentReader:
    """Converts Lark's tree into an `Agent`; raises TrapError at the first invalid part."""

    def __init__(self, source: Source) -> None:
        self.source = source

    def span(self, part: Tree[Token] | Token) -> Span:
        if isinstance(part, Token):
            return self.source.span(part.start_pos or 0, part.end_pos)
        return self.source.span(part.meta.start_pos, part.meta.end_pos)

    def end(self) -> Span:
        length = len(self.source.text.rstrip())
        return self.source.span(length, length)

    def agent(self, start: Tree[Token]) -> Agent:
        first = start.children[0]
        if not (isinstance(first, Token) and first.type == "GWENDOLEN"):
            raise TrapError(diagnostic("gwendolen_missing", self.source.span(0, 0)))
        agents = _trees(start, "agent")
        self.refuse_more(agents)
        (word, *sections) = _trees(agents[0])
        self.check_headings(sections)
        name = cast(Token, word.children[0])
        by_kind = {section.data: section for section in sections}
        for goal in _trees(by_kind["goals"]):
            raise beyond("an initial goal", self.span(goal))
        return Agent(
            str(name),
            tuple(self.beliefs(by_kind["beliefs"])),
            tuple(map(self.plan, self.some_plans(by_kind["plans"]))),
            self.span(name),
        )

    def refuse_more(self, agents: list[Tree[Token]]) -> None:
        for token in agents[0].children:
            if isinstance(token, Token) and token.type == "GWENDOLEN":
                raise TrapError(diagnostic("second_gwendolen", self.span(token)))
        if len(agents) > 1:
            raise beyond("a second agent", self.span(cast(Token, agents[1].children[0])))

    def check_headings(self, sections: list[Tree[Token]]) -> None:
        """Check that every required section is present, once, and in order."""
        expected = list(HEADINGS)
        for section in sections:
            token = cast(Token, section.children[0])
            if token == ":Reasoning Rules:" and expected[:1] == [":Initial Goals:"]:
                continue
            if not expected or token != expected.pop(0):
                raise TrapError(
                    diagnostic(
                        "misplaced_heading",
                        self.span(token),
                        token=token,
                        headings=", ".join(f"`{h}`" for h in HEADINGS),
                    )
                )
        if expected:
            end = self.end()
            raise TrapError(diagnostic("section_missing", end, section=expected[0]))

    def beliefs(self, section: Tree[Token]) -> list[str]:
        literals: list[str] = []
        for part in section.children[1:]:
            if isinstance(part, Token):
                raise TrapError(diagnostic("comma_between_beliefs", self.span(part)))
            literals.append(self.unnegated(part))
        return literals

    def unnegated(self, parent: Tree[Token]) -> str:
        """The literal below `parent`, where no `~` may stand before it."""
        for part in parent.children:
            if isinstance(part, Token) and part.type == "NOT":
                raise TrapError(diagnostic("negated_belief", self.span(part)))
        return self.literal(_trees(parent, "literal")[0])

    def some_plans(self, section: Tree[Token]) -> list[Tree[Token]]:
        plans = _trees(section, "plan")
        if not plans:
            heading = cast(Token, section.children[0])
            raise TrapError(diagnostic("plan_missing", self.span(heading)))
        return plans

    def plan(self, plan: Tree[Token]) -> AgentPlan:
        event, guards, *rest = _trees(plan)
        span = self.span(plan)
        if not guards.children:
            raise TrapError(diagnostic("empty_guard", self.span(guards)))
        if rest and not rest[1].children:
            raise TrapError(diagnostic("deed_missing", self.span(rest[0])))
        return AgentPlan(
            self.change(event),
            tuple(g for guard in _trees(guards) if (g := self.guard(guard)) is not None),
            tuple(self.deed(deed) for deed in _trees(rest[1])) if rest else (),
            span,
        )

    def change(self, part: Tree[Token]) -> BeliefChange:
        """An event or a deed about a belief."""
        if _trees(part, "goal"):
            raise beyond("a goal", self.span(part))
        return BeliefChange(cast(Sign, str(part.children[0])), self.unnegated(part))

    def guard(self, guard: Tree[Token]) -> BeliefGuard | None:
        """The guard, or None for `True`."""
        first = cast(Token, guard.children[0])
        negated = first.type == "NOT"
        if guard.data == "has_goal":
            raise beyond("a goal", self.span(guard))
        if guard.data == "true":
            if negated:
                raise beyond("a plan that is never chosen", self.span(guard))
            return None
        inner = [t for t in guard.children[negated:] if isinstance(t, Token) and t.type == "NOT"]
        if inner:
            raise TrapError(diagnostic("tilde_behind_b", self.span(inner[0])))
        return BeliefGuard(not negated, self.literal(_trees(guard, "literal")[0]))

    def deed(self, deed: Tree[Token]) -> Deed:
        match deed.data:
            case "action":
                return Action(self.literal(_trees(deed)[0]))
            case "wait":
                raise beyond("waiting for a belief", self.span(deed))
            case _:
                return self.change(deed)

    def literal(self, literal: Tree[Token], level: int = 0) -> str:
        if level > _MOST_LEVELS:
            raise beyond(f"a term of more than {_MOST_LEVELS} levels", self.span(literal))
        functor = cast(Token, literal.children[0])
        if functor.type in ("ACHIEVE", "PERFORM"):
            raise TrapError(diagnostic("reserved_functor", self.span(functor), functor=functor))
        if functor.type == "VAR":
            raise TrapError(diagnostic("capital_functor", self.span(functor), functor=functor))
        terms = [self.term(term, level + 1) for term in _trees(literal)]
        if not terms and self.span(literal).text.endswith(")"):
            raise TrapError(diagnostic("empty_parentheses", self.span(literal)))
        return f"{functor}({','.join(terms)})" if terms else str(functor)

    def term(self, term: Tree[Token], level: int) -> str:
        match term.data:
            case "number":
                return number("".join(map(str, term.children)))
            case "string":
                return f"'{str(term.children[0])[1:-1]}'"
            case "unnamed":
                raise beyond("`_`, which matches everything,", self.span(term))
            case _:
                if cast(Token, term.children[0]).type == "VAR":
                    raise beyond(f"the variable `{term.children[0]}`", self.span(term))
                return self.literal(term, level)


def number(digits: str) -> str:
    """A number by its value: AJPF compares numbers, not their digits."""
    value = Decimal(digits).normalize()
    return f"{value:f}" if value else "0"


def _trees(parent: Tree[Token], kind: str | None = None) -> list[Tree[Token]]:
    return [
        part for part in parent.children if isinstance(part, Tree) and kind in (None, part.data)
    ]
