"""Evidence about agents: the paper's, the published artefact's, and users' own."""

from collections.abc import Sequence

import pytest

from compiler.agents.checking import check_agent
from compiler.logic.claims import ClaimResult, Layer, Proof, not_checked, proved, vacuous
from compiler.targets.ajpf import properties as ajpf
from fretish.diagnostics.diagnostic import Code, Diagnostic
from fretish.diagnostics.source import Source
from tests.compiler.targets.ajpf.test_bundle import requirement
from tests.proofs import outcome

PAPER = """GWENDOLEN
:name: agilex_agent

:Initial Beliefs:

:Initial Goals:

:Plans:
+too_close: {True} <-
    stop_moving,
    +stopped;
"""
R1 = "[] (B(agilex_agent,too_close) -> <> B(agilex_agent,stopped))"
PUBLISHED = "[] (B(agilex_agent,stop_moving) -> <> B(agilex_agent,stopped))"
CONTROLS = "1a_reach: [] (~(B(agilex_agent,too_close)))\n1a_resp: [] (~(B(agilex_agent,stopped)))\n"


def lines(
    properties: str, percepts: Sequence[str], agent: str = PAPER, limit: int = 10_000
) -> tuple[Proof, ...]:
    found = check_agent(Source("sif.gwen", agent), Source("sif.psl", properties), percepts, limit)
    assert not isinstance(found, Diagnostic), found.message
    return found


def refused(properties: str, percepts: Sequence[str], agent: str = PAPER) -> Diagnostic:
    found = check_agent(Source("sif.gwen", agent), Source("sif.psl", properties), percepts)
    assert isinstance(found, Diagnostic)
    return found


def statuses(found: tuple[Proof, ...]) -> list[tuple[str, str]]:
    return [(line.requirement, line.result) for line in found]


def test_the_papers_agent_is_proved_where_its_trigger_comes_and_the_check_can_fail() -> None:
    main, mutant = lines(f"1a: {R1}", ["too_close"])
    assert main.layer is Layer.AGENT
    assert main.claim == (
        "every run of the agent keeps 1a: "
        "[] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))"
    )
    assert outcome(main) == proved("all runs through 121 states keep it")
    assert main.assumptions == (
        "the environment shows exactly too_close, each freely, anew at the start, at every action "
        "and whenever the agent is idle, for ever (--percept)",
        "percepts that are drawn together are believed one after the other, in any order",
        "intentions take turns, first come, first served, one deed a turn",
        "the agent is always scheduled again",
    )
    assert set(main.artefacts) == {"sif.gwen", "sif.psl"}
    assert mutant.claim == "the check can fail: an agent without the response violates 1a"
    assert mutant.result is ClaimResult.PROVED


def test_the_papers_environment_makes_the_papers_property_vacuous() -> None:
    (main,) = lines(f"1a: {R1}", ["stopped"])
    assert outcome(main) == vacuous(
        "never true where it counts: `B(agilex_agent,too_close)`: "
        "no environment shows `too_close`, and no plan adds it"
    )


@pytest.mark.parametrize("percept", ["stopped", "too_close"])
def test_the_published_property_is_vacuous_in_any_environment(percept: str) -> None:
    (main,) = lines(f"1: {PUBLISHED}", [percept])
    assert outcome(main) == vacuous(
        "never true where it counts: `B(agilex_agent,stop_moving)`: "
        "`stop_moving` is an action, and an action is never a belief"
    )


def test_controls_are_to_be_violated() -> None:
    found = lines(f"1a: {R1}\n{CONTROLS}", ["too_close"])
    assert statuses(found) == [
        ("1a", "proved"),
        ("1a", "proved"),
        ("1a_reach", "proved"),
        ("1a_resp", "proved"),
    ]
    assert found[2].claim == (
        "some run of the agent violates the control 1a_reach: [] (~B(agilex_agent,too_close))"
    )
    assert statuses(lines(f"1a: {R1}\n{CONTROLS}", ["stopped"])) == [
        ("1a", "vacuous"),
        ("1a_reach", "vacuous"),
        ("1a_resp", "proved"),
    ]


def test_a_property_whose_own_control_holds_is_vacuous_whatever_its_shape() -> None:
    main, control = lines("x: [] (~B(agilex_agent,a))\nx_reach: [] (~B(agilex_agent,b))", [])
    assert outcome(main) == vacuous(
        "its control x_reach holds: no environment shows `b`, and no plan adds it"
    )
    assert control.result is ClaimResult.VACUOUS


def test_a_key_that_only_looks_like_a_control_is_a_property() -> None:
    (main,) = lines("a_reach: [] (~B(agilex_agent,too_close))", ["too_close"])
    assert main.result is ClaimResult.COUNTEREXAMPLE


def test_a_counterexample_is_a_table_of_stages() -> None:
    (main,) = lines(f"now: {R1.replace('<> ', '')}", ["too_close"])
    assert main.result is ClaimResult.COUNTEREXAMPLE
    trace = main.run
    assert trace is not None
    assert trace.names == ("B(agilex_agent,too_close)", "B(agilex_agent,stopped)")
    assert trace.actions[:3] == (
        "nothing yet",
        "the environment shows too_close",
        "perceives +too_close",
    )
    assert trace.rows[:3] == ((False, False), (False, False), (True, False))
    assert trace.cycle is not None


def test_an_agent_that_does_nothing_keeps_no_response() -> None:
    idle = PAPER.replace("stop_moving,\n    +stopped", "drive_on")
    (main,) = lines(f"1a: {R1}", ["too_close"], idle)
    assert main.result is ClaimResult.COUNTEREXAMPLE


def test_what_the_environment_does_cannot_be_taken_away_from_the_agent() -> None:
    """Its response comes in any case, so that the agent without it keeps the property too."""
    always = "a: [] (B(agilex_agent,too_close) -> <> B(agilex_agent,too_close))"
    (main,) = lines(always, ["too_close"])
    assert main.result is ClaimResult.PROVED
    two = PAPER.replace("+stopped;", "+stopped;\n+stopped: {True} <- +stopped;")
    doubled = two.replace(":Initial Beliefs:", ":Initial Beliefs: stopped")
    main, mutant = lines(f"1a: {R1}", ["too_close"], doubled)
    assert main.result is ClaimResult.PROVED
    assert outcome(mutant) == vacuous("that agent satisfies 1a, too, so 1a shows no response")


def test_beyond_the_model_or_its_limit_nothing_is_known() -> None:
    waiting = PAPER.replace("+stopped;", "*stopped;")
    (line,) = lines(f"1a: {R1}", ["too_close"], waiting)
    assert outcome(line) == not_checked(
        "waiting for a belief is Gwendolen, but not in the model of fretc (sif.gwen, line 11)"
    )
    (line,) = lines(f"1a: {R1}", ["too_close"], limit=49)
    assert outcome(line) == not_checked("the agent has more than 49 states")
    (line,) = lines("1a: [] (~B(agilex_agent,near(_)))", ["too_close"])
    assert outcome(line) == not_checked("`_`, which matches everything, is not in the model")


@pytest.mark.parametrize(
    ("properties", "percepts", "agent", "code"),
    [
        (f"1a: {R1} )", ["too_close"], PAPER, Code.BAD_PROPERTY),
        (f"1a: {R1}", ["too_close"], PAPER.replace("+too", "+Too"), Code.BAD_AGENT),
        (f"1a: {R1.replace('agilex', 'other')}", ["too_close"], PAPER, Code.OTHER_AGENT),
        (f"1a: {R1}", ["TooClose"], PAPER, Code.BAD_PERCEPT),
        (f"1a: {R1}", ["too close"], PAPER, Code.BAD_PERCEPT),
        (f"1a: {R1}", ["near(X)"], PAPER, Code.BAD_PERCEPT),
        (f"1a: {R1}", ["near(1,)"], PAPER, Code.BAD_PERCEPT),
        (f"1a: {R1}", [""], PAPER, Code.BAD_PERCEPT),
    ],
)
def test_a_users_mistake_is_a_diagnostic(
    properties: str, percepts: list[str], agent: str, code: Code
) -> None:
    diagnostic = refused(properties, percepts, agent)
    assert diagnostic.code is code
    assert diagnostic.help


def test_a_percept_is_spelt_as_the_agent_spells_it() -> None:
    near = PAPER.replace("too_close", "near(1, lidar)")
    (main, _) = lines("x: [] (B(agilex_agent,near(1,lidar)) -> <> B(agilex_agent,stopped))",
                      ["near(1.0, lidar)"], near)  # fmt: skip
    assert main.result is ClaimResult.PROVED


@pytest.mark.parametrize("properties", ["", "# nothing yet\n"])
def test_a_file_without_properties_shows_nothing(properties: str) -> None:
    (line,) = lines(properties, ["too_close"])
    assert outcome(line) == not_checked("`sif.psl` has none")


def test_in_an_only_scope_an_agent_that_never_responds_keeps_the_prohibition() -> None:
    """As AJPF says; that the mode is left at all is the control that counts."""
    made = requirement("only in m mode the ag shall eventually satisfy r")
    idle = PAPER.replace("agilex_agent", "ag").replace("too_close", "m")
    found = check_agent(Source("a.gwen", idle), Source("p.psl", ajpf.text(made)), ["m"])
    assert not isinstance(found, Diagnostic)
    assert statuses(found) == [("R1", "proved"), ("R1_reach", "proved")]
    responding = idle.replace("stop_moving,", "+r,")
    found = check_agent(Source("a.gwen", responding), Source("p.psl", ajpf.text(made)), ["m"])
    assert not isinstance(found, Diagnostic)
    assert statuses(found)[0] == ("R1", "counterexample")
