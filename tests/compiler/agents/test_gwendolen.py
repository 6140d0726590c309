"""Agents in Gwendolen: read exactly, and every trap a mistake with its place."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.agents.gwendolen import Action, Agent, BeliefChange, BeliefGuard, read
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source

AGENT = """GWENDOLEN
:name: watch_agent

:Initial Beliefs:
ready speed(1.0, -2.50)

:Initial Goals:

:Plans:
+zone_near : {True} <- halt_base, +halted;
-zone_near : {B halted, ~B speed(3)} <- release_base(1, fast), -halted;
-ready : {True};
"""


def agent(text: str) -> Agent:
    found = read(Source("a.gwen", text))
    assert not isinstance(found, Diagnostic), render(found)
    return found


def refused(old: str, new: str) -> Diagnostic:
    assert AGENT.count(old) == 1
    diagnostic = read(Source("a.gwen", AGENT.replace(old, new)))
    assert isinstance(diagnostic, Diagnostic), diagnostic
    assert diagnostic.span is not None
    assert diagnostic.help
    return diagnostic


def test_an_agent_is_its_beliefs_and_its_plans_in_their_order() -> None:
    found = agent(AGENT)
    assert found.name == "watch_agent"
    assert found.beliefs == ("ready", "speed(1,-2.5)")
    assert [(p.event, p.guards, p.deeds) for p in found.plans] == [
        (BeliefChange("+", "zone_near"), (), (Action("halt_base"), BeliefChange("+", "halted"))),
        (
            BeliefChange("-", "zone_near"),
            (BeliefGuard(True, "halted"), BeliefGuard(False, "speed(3)")),
            (Action("release_base(1,fast)"), BeliefChange("-", "halted")),
        ),
        (BeliefChange("-", "ready"), (), ()),
    ]
    assert found.plans[1].span.line == 11


def test_comments_white_space_and_an_empty_section_of_rules_say_nothing() -> None:
    text = AGENT.replace(":Initial Goals:", "/* two\nlines */ :Reasoning Rules:\n:Initial Goals:")
    assert agent(f"// first\n{text} // last") == agent(AGENT)
    assert agent(" ".join(AGENT.split())) == agent(AGENT)


def test_the_listing_of_the_paper_lacks_two_sections() -> None:
    diagnostic = read(
        Source(
            "sif.gwen",
            "GWENDOLEN\n:name: agilex_agent\n\n:Plans:\n"
            "+too_close: {True} <-\n    stop_moving,\n    +stopped;\n",
        )
    )
    assert isinstance(diagnostic, Diagnostic)
    assert render(diagnostic) == (
        "F610 `:Plans:` stands in the wrong place\n"
        "  --> sif.gwen:4:1\n"
        "   | :Plans:\n"
        "   | ^^^^^^^\n"
        "help: the sections are `:Initial Beliefs:`, `:Initial Goals:`, `:Plans:`, in this order"
    )


def test_a_trap_is_shown_with_its_place_and_what_mcapl_makes_of_it() -> None:
    assert render(refused("ready speed", "ready, speed")) == (
        "F610 a comma stands between initial beliefs\n"
        "  --> a.gwen:5:6\n"
        "   | ready, speed(1.0, -2.50)\n"
        "   |      ^\n"
        "help: MCAPL drops the beliefs behind it: separate them by white space"
    )


TRAPS = [
    ("ready speed", "~ready speed", "a belief has no `~`", "~"),
    ("+zone_near", "+Zone_near", "`Zone_near` begins with a capital letter", "Zone_near"),
    ("halt_base", "Halt", "`Halt` begins with a capital letter", "Halt"),
    ("{True} <-", "{} <-", "the guard is empty", "{}"),
    ("{True};", "{True} <- ;", "no deed follows the `<-`", "<-"),
    ("{True};", "{True}; # why", "`#` does not begin a comment", "#"),
    ("{True};", "{True}; % why", "`%` does not begin a comment", "%"),
    ("{True};", "{True}; /* why", "the comment has no end", "/"),
    (
        "\n:Initial Goals:\n",
        "",
        "`:Plans:` stands in the wrong place",
        ":Plans:",
    ),
    (":Initial Goals:", ":Initial goals:", "`:Initial goals:` is not a heading", ":Initial goals:"),
    ("GWENDOLEN\n", "", "the file does not begin with `GWENDOLEN`", ""),
    ("watch_agent", "watch-agent", "a `-` stands in the agent's name", "-"),
    ("-ready", "-achieve", "`achieve` is a reserved word", "achieve"),
    ("{True};", "{True}", "the file ends too early", ""),
    ("B halted", "B ~halted", "the `~` stands behind `B`", "~"),
    ("B halted", "halted", "`halted` does not fit here", "halted"),
    ("halt_base", "halt_base()", "the parentheses are empty", "halt_base()"),
    ("-ready", "ready", "`ready` does not fit here", "ready"),
    ("+halted;", "+~halted;", "a belief has no `~`", "~"),
    (
        "-ready : {True};",
        "-ready : {True}; GWENDOLEN :name: b :Initial Beliefs: :Initial Goals: :Plans: +a:{True};",
        "a second `GWENDOLEN` stands in the file",
        "GWENDOLEN",
    ),
]


@pytest.mark.parametrize(("old", "new", "message", "place"), TRAPS)
def test_what_mcapl_misreads_is_a_mistake(old: str, new: str, message: str, place: str) -> None:
    diagnostic = refused(old, new)
    assert (diagnostic.code, diagnostic.message) == (Code.BAD_AGENT, message)
    assert diagnostic.span is not None
    assert diagnostic.span.text == place


def test_an_agent_without_plans_is_none() -> None:
    diagnostic = read(Source("a", "GWENDOLEN :name: a :Initial Beliefs: :Initial Goals: :Plans:"))
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.message == "there is no plan"


def test_a_section_that_is_missing_at_the_end_is_named() -> None:
    diagnostic = read(Source("a", "GWENDOLEN :name: a :Initial Beliefs: b"))
    assert isinstance(diagnostic, Diagnostic)
    assert diagnostic.message == "the section `:Initial Goals:` is missing"


BEYOND = [
    (":Initial Goals:", ":Initial Goals: g [achieve]", "an initial goal"),
    (":Initial Goals:", ":Reasoning Rules: a :- b; :Initial Goals:", "a reasoning rule"),
    ("+halted;", "+!halt [perform];", "a goal"),
    ("B halted", "G halted [achieve]", "a goal"),
    ("B halted", "X < 5", "a comparison"),
    ("halt_base", "halt(X)", "the variable `X`"),
    ("halt_base", "halt(_)", "`_`, which matches everything,"),
    ("halt_base", "*halted", "waiting for a belief"),
    ("halt_base", ".send(b, :tell, c)", "a word for messages or locks"),
    ("halt_base", "+.lock", "a word for messages or locks"),
    ("release_base(1, fast)", "release([a])", "a list"),
    (
        "-ready : {True};",
        "-ready : {True}; :name: b :Initial Beliefs: :Initial Goals: :Plans: +a : {True};",
        "a second agent",
    ),
    ("release_base(1, fast)", f"go{'(a' * 60}{')' * 60}", "a term of more than 50 levels"),
]


@pytest.mark.parametrize(("old", "new", "what"), BEYOND)
def test_gwendolen_that_the_model_does_not_have_is_told_apart(
    old: str, new: str, what: str
) -> None:
    diagnostic = refused(old, new)
    assert diagnostic.code is Code.BEYOND_MODEL
    assert diagnostic.message == f"{what} is Gwendolen, but not in the model of fretc"


@pytest.mark.slow
def test_a_very_deep_term_is_no_crash() -> None:
    deep = f"a{'(a' * 20_000}{')' * 20_000}"
    assert refused("release_base(1, fast)", deep).code is Code.BEYOND_MODEL


PIECES = st.sampled_from(
    [
        *'+-~!*:;,{}()[]<_#%."BGX1a/',
        "<-",
        "/*",
        "//",
        "achieve",
        "True",
        "\n",
        ":Plans:",
        "GWENDOLEN",
    ]
)


@given(st.integers(0, len(AGENT)), st.integers(0, 12), st.lists(PIECES, max_size=3))
def test_any_text_is_read_or_told(at: int, length: int, put: list[str]) -> None:
    source = Source("a.gwen", AGENT[:at] + "".join(put) + AGENT[at + length :])
    found = read(source)
    if isinstance(found, Diagnostic):
        assert found.code in (Code.BAD_AGENT, Code.BEYOND_MODEL)
        assert render(found)
    else:
        assert found.plans
