"""AJPF property files: only what AJPF reads as it is meant, and the same language as FT."""

import re
from functools import cache, lru_cache
from itertools import count

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.agents import psl
from compiler.agents.psl_printing import property_text
from compiler.emit import TARGETS
from compiler.logic import formula as f
from compiler.logic import printing
from compiler.logic.spot import same_language
from compiler.targets.ajpf import properties as ajpf
from compiler.targets.target import DEFAULT, Target, TargetOptions
from fretish import expressions as e
from fretish import syntax as s
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.printer import canonical
from tests.bound_requirements import bound_requirement as requirement
from tests.effort import FULL, examples, needs_deep_calls, some
from tests.spot_oracle import equivalent
from tests.strategies import Template, templates

R1 = "whenever too_close agilex_agent shall eventually satisfy stopped"
LATE = "whenever too_close agilex_agent shall within 2 seconds satisfy stopped"
WEAKEN = TargetOptions(weaken=True)


def target(options: TargetOptions) -> Target:
    plain = TARGETS["ajpf"]
    assert plain.weak is not None
    return plain.weak if options.weaken else plain


@lru_cache(maxsize=1024)
def emitted(
    sentence: str, options: TargetOptions = DEFAULT, id: str = "R1", bindings: str = ""
) -> str:
    made = requirement(sentence, bindings, id)
    diagnostic = target(options).refuse(made)
    assert diagnostic is None, diagnostic
    (file,) = target(options).emit([made], options)
    return file.text


def refused(sentence: str, options: TargetOptions = DEFAULT) -> str:
    diagnostic = target(options).refuse(requirement(sentence))
    assert diagnostic is not None
    assert diagnostic.code is Code.NOT_EXPRESSIBLE
    return render(diagnostic)


def properties(text: str) -> dict[str, f.Formula]:
    """As AJPF reads them; each belief B(agent,p) is the proposition p again."""
    read = psl.read(Source("r.psl", text))
    assert not isinstance(read, Diagnostic), render(read)
    assert not any(p.remarks for p in read)
    return {p.key: unbelieved(p.formula) for p in read}


def unbelieved(formula: f.Formula) -> f.Formula:
    if isinstance(formula, f.Atom):
        match = re.fullmatch(r"B\((sw|agilex_agent|R),(\w+)\)", formula.name)
        assert match, formula
        return f.Atom(match[2])
    return f.rebuild(formula, unbelieved)


@cache
def expressible(options: TargetOptions = DEFAULT) -> list[Template]:
    """Every fifth; all with the full profile."""
    chosen = some(templates((2,)), 5)
    return [t for t in chosen if target(options).refuse(requirement(t.sentence)) is None]


# What is emitted ------------------------------------------------------------------------------


def test_r1_is_the_property_of_the_paper_with_its_controls() -> None:
    assert emitted(R1) == (
        "# R1 whenever too_close agilex_agent shall eventually satisfy stopped\n"
        "# expected of R1: HOLDS (the requirement)\n"
        "R1: [] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))\n"
        "# expected of R1_reach: VIOLATED (a trigger comes; if it never does, R1 demands nothing)\n"
        "R1_reach: [] (~B(agilex_agent,too_close))\n"
        "# expected of R1_resp: VIOLATED (the response comes; if it never does, R1 holds without "
        "it)\n"
        "R1_resp: [] (~B(agilex_agent,stopped))\n"
    )


@pytest.mark.slow
def test_every_template_is_emitted_or_refused_for_the_right_reason() -> None:
    """192 of 288 count no ticks; nine of them are constant on infinite runs, and the rest is said.

    `finally` demands nothing of a scope that never ends: null, after and only before, each with
    three kinds of condition.
    """
    counts = {"emitted": 0, "constant": 0, "counts ticks": 0}
    for template in templates((2,)):
        made = requirement(template.sentence)
        diagnostic = TARGETS["ajpf"].refuse(made)
        if diagnostic is None:
            counts["emitted"] += 1
        elif template.timing == "finally":
            counts["constant"] += 1
            assert template.scope in ("null", "after", "onlyBefore")
            assert diagnostic.message == "AJPF cannot express a formula that is constant of R1"
        else:
            counts["counts ticks"] += 1
            assert template.timing in ("next", "within", "for", "after")
            assert diagnostic.message.startswith("AJPF cannot express the timing `")
    assert counts == {"emitted": 183, "constant": 9, "counts ticks": 96}


@pytest.mark.slow
def test_every_property_has_the_language_of_the_formula() -> None:
    for template in expressible():
        found = properties(emitted(template.sentence))
        assert equivalent(found["R1"], requirement(template.sentence).ft_infinite), template


def test_a_formula_of_the_requirement_without_x_is_emitted_as_it_is() -> None:
    text = emitted("in m, the sw shall always satisfy q")
    assert "\nR1: [] ((B(sw,m)) -> (B(sw,q)))\n" in text


_names = st.sampled_from(["a", "b", "c", "d_1"]).map(e.Name)
_expressions: st.SearchStrategy[e.Expression] = st.recursive(
    st.one_of(_names, _names, _names, st.booleans().map(e.Truth)),
    lambda inner: st.one_of(
        st.builds(e.Not, inner),
        st.builds(e.both, inner, inner),
        st.builds(e.either, inner, inner),
        st.builds(e.Xor, inner, inner),
        st.builds(e.Implies, inner, inner),
        st.builds(e.Iff, inner, inner),
    ),
    max_leaves=4,
)
_timings: st.SearchStrategy[s.Timing] = st.one_of(
    st.sampled_from([s.Immediately(), s.Finally(), s.Eventually(), s.Always(), s.Never()]),
    st.builds(s.Until, _expressions),
    st.builds(s.Before, _expressions),
)
_sentences = st.builds(
    s.Sentence,
    scope=st.one_of(st.none(), st.builds(s.Scope, st.sampled_from(s.ScopeKind), _expressions)),
    condition=st.one_of(
        st.none(), st.builds(s.Condition, st.sampled_from(s.ConditionKind), _expressions)
    ),
    component=st.just("sw"),
    probability=st.none(),
    timing=_timings,
    response=_expressions,
)


@pytest.mark.slow
@examples(30)
@given(_sentences)
def test_compound_sentences_keep_their_language(sentence: s.Sentence) -> None:
    made = requirement(canonical(sentence))
    diagnostic = TARGETS["ajpf"].refuse(made)
    if diagnostic is not None:
        assert diagnostic.message == "AJPF cannot express a formula that is constant of R1"
        return
    (file,) = TARGETS["ajpf"].emit([made])
    found = properties(file.text)
    assert equivalent(found["R1"], made.ft_infinite)
    assert not any(isinstance(formula, f.Const) for formula in found.values())


@pytest.mark.slow
@pytest.mark.parametrize(
    "response",
    [
        "p & q & r & s",
        "p | q | r | s",
        "p & q | r & s",
        "p -> q -> r",
        "(p -> q) -> r",
        "p <-> q",
        "p xor q xor r",
        "p <-> q <-> r",
        "!(p & !q)",
        "!!p",
        "!(p <-> (q xor r))",
        "if p then q & if r then s",
    ],
)
def test_every_grouping_survives(response: str) -> None:
    for sentence in (
        f"the sw shall always satisfy {response}",
        f"whenever {response} the sw shall eventually satisfy !({response})",
        f"when p the sw shall until {response} satisfy q",
    ):
        found = properties(emitted(sentence))
        assert equivalent(found["R1"], requirement(sentence).ft_infinite), sentence


_TOKENS = re.compile(r"\s*(->|\|\||<>|\[\]|[~&()\[\],.]|[A-Za-z_0-9]+)")


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


@pytest.mark.slow
def test_ajpf_is_never_asked_for_its_own_grouping() -> None:
    assert fully_parenthesized("((B(a,p)) & (B(a,q))) & (~B(a,r))")
    assert not fully_parenthesized("(B(a,p)) & (B(a,q)) & (B(a,r))")
    assert not fully_parenthesized("[] (B(a,p)) -> (B(a,q))")
    for sentence in (
        *(template.sentence for template in expressible()),
        "the sw shall always satisfy p & q & r & s",
        "the sw shall always satisfy !(p | q | r) xor (p <-> !q)",
    ):
        for stated in ajpf.properties(requirement(sentence)):
            assert fully_parenthesized(stated.text), stated
            assert "\n" not in stated.text
            assert stated.text.isascii()


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
        text = property_text(formula, lambda name: f"B(sw,{name})")
        assert equivalent(properties(f"R1: {text}")["R1"], formula)
    with pytest.raises(AssertionError):
        property_text(f.Next(p), str)


@pytest.mark.parametrize("id", ["R1", "HAZ-003.a", "7"])
def test_the_key_is_the_requirements_id(id: str) -> None:
    assert list(properties(emitted(R1, id=id))) == [id, f"{id}_reach", f"{id}_resp"]


def test_an_id_that_is_a_files_name_becomes_a_legal_key() -> None:
    found = properties(emitted(R1, id="stop, r\u00e9cent: 1"))
    assert list(found) == ["stop__r_cent__1", "stop__r_cent__1_reach", "stop__r_cent__1_resp"]


def test_a_sentence_of_many_lines_is_one_comment() -> None:
    text = emitted("whenever too_close\n agilex_agent shall\r\n\n eventually satisfy stopped")
    assert len(properties(text)) == 3
    assert [line[0] for line in text.splitlines()] == ["#", "#", "R", "#", "R", "#", "R"]


# Controls -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sentence", "controls"),
    [
        ("whenever p sw shall eventually satisfy q", {"reach": "G !p", "resp": "G !q"}),
        ("upon p & !s sw shall before t satisfy q | r",
         {"reach": "G !(p & !s)", "resp": "G !(q | r)", "stop": "G !t"}),
        ("whenever p sw shall never satisfy q", {"reach": "G !p"}),
        ("sw shall never satisfy q", {}),
        ("sw shall always satisfy !q", {"resp": "G q"}),
        ("sw shall until t satisfy q", {"resp": "G !q"}),
        ("in m, sw shall eventually satisfy q", {"reach": "G !m", "resp": "G !q"}),
        ("in m, whenever p sw shall eventually satisfy q",
         {"reach": "G !(m & p)", "resp": "G !q"}),
        ("unless in m, sw shall eventually satisfy q", {"reach": "G m", "resp": "G !q"}),
        ("before m, sw shall eventually satisfy q", {"reach": "G !m", "resp": "G !q"}),
        ("before m, whenever p sw shall eventually satisfy q",
         {"reach": "m | m R (m | !p)", "resp": "G !q"}),
        ("after m, sw shall eventually satisfy q", {"reach": "G(m -> G m)", "resp": "G !q"}),
        ("only in m, whenever p sw shall eventually satisfy q",
         {"reach": "G !(!m & p)"}),
        ("only before m, sw shall never satisfy q", {"reach": "G !m", "resp": "G !q"}),
        ("only after m, sw shall before t satisfy q", {"reach": "G !m"}),
        ("only in m, sw shall always satisfy q", {"reach": "G m"}),
        ("whenever true sw shall eventually satisfy q", {"resp": "G !q"}),
        ("whenever p sw shall eventually satisfy false", {"reach": "G !p"}),
    ],
)  # fmt: skip
def test_controls_ask_for_the_trigger_the_response_and_the_stop(
    sentence: str, controls: dict[str, str]
) -> None:
    first, *others = ajpf.properties(requirement(sentence))
    assert (first.key, first.expected, first.why) == ("R1", "HOLDS", "the requirement")
    assert [stated.key for stated in others] == [f"R1_{name}" for name in controls]
    found = properties(emitted(sentence))
    for stated, expected in zip(others, controls.values(), strict=True):
        assert stated.expected == "VIOLATED"
        assert same_language(printing.future(found[stated.key]), expected)


@pytest.mark.parametrize(
    ("scope", "why"),
    [
        ("in m", "the mode comes; if it never does, R1 demands nothing"),
        ("unless in m", "the mode is not on all the time; if it is, R1 demands nothing"),
        ("only in m", "the mode is not on all the time; if it is, R1 demands nothing"),
        ("after m", "the mode comes and goes; if it never does, R1 demands nothing"),
        ("only before m", "the mode comes; if it never does, R1 demands nothing"),
        ("before m", "the mode comes; if it never does, the scope of R1 never ends"),
        ("only after m", "the mode comes; if it never does, the scope of R1 never ends"),
    ],
)
def test_a_control_says_what_it_is_for(scope: str, why: str) -> None:
    _, reach, *_ = ajpf.properties(requirement(f"{scope}, sw shall eventually satisfy q"))
    assert reach.why == why


@pytest.mark.slow
def test_where_a_control_holds_so_does_the_requirement_without_its_trigger() -> None:
    """Of every template: what `reach` says alone implies the requirement."""
    for template in expressible():
        found = properties(emitted(template.sentence))
        exempt = template.condition == "null" and template.scope in ("before", "onlyAfter")
        if "R1_reach" in found and not exempt:
            assert equivalent(f.Or((f.Not(found["R1_reach"]), found["R1"])), f.TRUE), template


# Modalities -----------------------------------------------------------------------------------

BINDINGS = """
[clock]
tick = "100 ms"
[signal.x]
path = "/x.data"
[proposition.too_close]
expr = "x > 1"
[proposition.halting]
expr = "x > 2"
modality = "G"
[variable.stop_moving]
modality = "D"
[variable.turn]
modality = "ItD"
[variable.both]
modality = "I"
[variable.halting]
text = "declared twice"
"""


@pytest.mark.parametrize(
    ("name", "atom"),
    [
        ("too_close", "B(sw,too_close)"),
        ("undeclared", "B(sw,undeclared)"),
        ("halting", "G(sw,halting)"),
        ("both", "I(sw,both)"),
        ("stop_moving", "D(sw,stop_moving)"),
        ("turn", "ItD(sw,turn)"),
    ],
)
def test_a_proposition_has_the_modality_of_the_bindings(name: str, atom: str) -> None:
    sentence = f"whenever {name} sw shall eventually satisfy done"
    text = emitted(sentence, bindings=BINDINGS)
    assert f"\nR1: [] (({atom}) -> (<> (B(sw,done))))\n" in text
    read = psl.read(Source("r.psl", text))
    assert not isinstance(read, Diagnostic)
    assert atom in f.atoms(read[0].formula)


# What is refused ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "sentence",
    [
        "the sw shall at the next timepoint satisfy q",
        "whenever p the sw shall at the next timepoint satisfy q",
        "whenever p the sw shall within 3 ticks satisfy q",
        "whenever p the sw shall within 0 ticks satisfy q",
        "whenever p the sw shall for 3 ticks satisfy q",
        "the sw shall for 0 seconds satisfy q",
        "whenever p the sw shall after 3 ticks satisfy q",
        "only in m, the sw shall within 3 ticks satisfy q",
        "the sw shall always satisfy f(p)",
        "the sw shall always satisfy persisted(2, p)",
        "the sw shall always satisfy occurs(2, p)",
        "whenever preBool(false, p) the sw shall eventually satisfy q",
        "whenever FTP the sw shall eventually satisfy q",
        "the sw shall always satisfy nextOcc(p, q)",
        "the sw shall always satisfy preInt(0, x) = 1",
        "the sw shall finally satisfy q",
        "the sw shall always satisfy true",
        "the sw shall always satisfy q | !false",
        "the sw shall never satisfy true",
        "the sw shall with probability >= 0.9 always satisfy q",
    ],
)
def test_what_ajpf_cannot_say_is_refused(sentence: str) -> None:
    assert refused(sentence).startswith("F601 AJPF cannot express ")


@pytest.mark.parametrize(
    ("sentence", "functor"),
    [
        ("the sw shall always satisfy Speed > 3", "B(sw,v_Speed_gt_3)"),
        ("the sw shall always satisfy Stopped", "B(sw,v_Stopped)"),
        ("the sw shall always satisfy T", "B(sw,v_T)"),
        ("the sw shall always satisfy achieve", "B(sw,achieve_2)"),
        ("arm.sw shall always satisfy query", "B(arm_DOT_sw,query)"),
        ("the sw shall always satisfy arm.joint", "B(sw,arm_DOT_joint)"),
        ("the sw shall always satisfy load%", "B(sw,load_PRC_)"),
        ('the sw shall always satisfy "two words"', "B(sw,two_SPC_words)"),
        ('the sw shall always satisfy "p(x)"', "B(sw,v__DQT_p_x28_x_x29__DQT_)"),
        ('the sw shall always satisfy "1st"', "B(sw,v_1st)"),
        ('the sw shall always satisfy "_p"', "B(sw,v__p)"),
        ('the sw shall always satisfy "p\u00e9"', "B(sw,p_xE9_)"),
        ('the "agilex-agent" shall always satisfy q', "B(agilex_x2D_agent,q)"),
        ("arm.joint shall always satisfy q", "B(arm_DOT_joint,q)"),
        ("ItD shall always satisfy q", "B(ItD_2,q)"),
        ("P shall always satisfy q", "B(P_2,q)"),
    ],
)
def test_a_name_that_ajpf_cannot_read_is_another_one_there(sentence: str, functor: str) -> None:
    text = emitted(sentence)
    assert functor in text
    agent, name = functor.removeprefix("B(").removesuffix(")").split(",")
    other = agent if name in ("q", "query") else name
    assert f"\n# {other}: " in text
    assert not isinstance(psl.read(Source("r1.psl", text)), Diagnostic)


@pytest.mark.parametrize(
    ("sentence", "what", "fix"),
    [
        (
            LATE.replace("2 seconds", "3 ticks"),
            "the timing `within 3 ticks`",
            "AJPF has no next, no past and no time; state the requirement with `eventually`, "
            "let the file say less with `--weaken`, or check it with `--emit monitor`",
        ),
        (
            "whenever p sw shall for 3 ticks satisfy q",
            "the timing `for 3 ticks`",
            "AJPF has no next, no past and no time; check it with `--emit monitor`",
        ),
        (
            "sw shall always satisfy f(p)",
            "the proposition `f(p)`",
            "bind it as a proposition whose name begins with a small letter, and use that",
        ),
        (
            "whenever FTP sw shall eventually satisfy q",
            "`FTP`",
            "it has no past, and counts no steps ahead: make it a proposition, and bind it",
        ),
    ],
)
def test_a_refusal_names_the_part_and_the_way_out(sentence: str, what: str, fix: str) -> None:
    text = refused(sentence)
    assert text.startswith(f"F601 AJPF cannot express {what} of R1\n  --> r.fret:1:1\n")
    assert text.endswith(f"\nhelp: {fix}")


@pytest.mark.slow
@needs_deep_calls
def test_nesting_has_an_end() -> None:
    names = (f"p{i}" for i in count())
    deep = "q"
    for _ in range(600):
        deep = f"({next(names)} -> {deep})"
    assert "parentheses within each other of R1" in refused(f"sw shall always satisfy {deep}")


def test_what_is_not_proved_is_not_emitted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compiler.targets.ajpf.without_next.is_proved", lambda *shape: False)
    monkeypatch.setattr("compiler.targets.ajpf.without_next.is_weaker", lambda *shape: False)
    for sentence, options in (
        ("when p sw shall eventually satisfy q", DEFAULT),
        (LATE.replace("2 seconds", "2 ticks"), WEAKEN),
    ):
        diagnostic = target(options).refuse(requirement(sentence))
        assert diagnostic is not None
        assert diagnostic.code is Code.NOT_PROVED
    assert target(DEFAULT).refuse(requirement(R1)) is None, "its own formula has no X"


# Warnings -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sentence", "code"),
    [
        (R1, None),
        ("sw shall eventually satisfy q", None),
        ("whenever p sw shall never satisfy q", None),
        ("whenever p sw shall before s satisfy q", None),
        ("in m, sw shall finally satisfy q", None),
        ("only in m, sw shall immediately satisfy q", None),
        ("sw shall always satisfy q", Code.STATE_ZERO),
        ("sw shall immediately satisfy q", Code.STATE_ZERO),
        ("sw shall until s satisfy q", Code.STATE_ZERO),
        ("unless in m, sw shall always satisfy q", Code.STATE_ZERO),
        ("before m, sw shall always satisfy q", Code.STATE_ZERO),
        ("in m, sw shall always satisfy q", Code.NO_TIME_TO_REACT),
        ("after m, sw shall immediately satisfy q", Code.NO_TIME_TO_REACT),
        ("whenever p sw shall immediately satisfy q", Code.NO_TIME_TO_REACT),
        ("whenever p sw shall always satisfy q", Code.NO_TIME_TO_REACT),
        ("when p sw shall until s satisfy q", Code.NO_TIME_TO_REACT),
    ],
)
def test_what_no_agent_can_do_is_warned_of(sentence: str, code: Code | None) -> None:
    made = requirement(sentence)
    assert TARGETS["ajpf"].refuse(made) is None
    diagnostic = TARGETS["ajpf"].remark(made)
    assert (diagnostic.code if diagnostic else None) is code
    assert diagnostic is None or diagnostic.severity is Severity.WARNING


# Weaker, on request ---------------------------------------------------------------------------


def test_within_becomes_eventually_on_request_and_the_file_says_so() -> None:
    text = emitted(LATE, WEAKEN, bindings=BINDINGS)
    loss = (
        "`within 2 seconds` has lost its bound: a response that comes later, however late, "
        "satisfies it"
    )
    assert text.splitlines()[:4] == [
        f"# R1 {LATE}",
        f"# WEAKER than the requirement: {loss}",
        "# expected of R1: HOLDS (weaker than the requirement)",
        "R1: [] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))",
    ]
    made = requirement(LATE, bindings=BINDINGS)
    assert ajpf.weakened(made, WEAKEN) == loss
    assert ajpf.weakened(made) is None
    diagnostic = target(WEAKEN).remark(made)
    assert diagnostic is not None
    assert diagnostic.code is Code.WEAKENED
    assert loss in diagnostic.message


@pytest.mark.slow
def test_what_is_weakened_is_implied_by_the_requirement_and_nothing_else_is_touched() -> None:
    weakened = 0
    for template in expressible(WEAKEN):
        made = requirement(template.sentence)
        found = properties(emitted(template.sentence, WEAKEN))
        loss = ajpf.weakened(made, WEAKEN)
        if loss is None:
            assert emitted(template.sentence, WEAKEN) == emitted(template.sentence)
            continue
        weakened += 1
        assert template.timing == "within"
        assert not template.scope.startswith("only")
        assert ("stretch of the scope" in loss) is (template.scope in ("in", "notin", "before"))
        assert equivalent(f.And((made.ft_infinite, found["R1"])), made.ft_infinite), template
    assert weakened == 15 if FULL else weakened >= 2


@pytest.mark.parametrize("timing", ["at the next timepoint", "for 3 ticks", "after 3 ticks"])
def test_other_timings_have_no_weaker_form(timing: str) -> None:
    assert refused(f"whenever p sw shall {timing} satisfy q", WEAKEN).endswith(
        "\nhelp: no weaker form of it says anything of use: check it with `--emit monitor`"
    )


def test_only_scopes_are_not_weakened() -> None:
    """Outside of m, q must be missing for 3 ticks: for ever would be stronger."""
    refused("only in m, whenever p sw shall within 3 ticks satisfy q", WEAKEN)
