"""Pictures: read back, they judge every trace as the definition does; Graphviz draws them."""

import random
import re
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import pytest

from compiler.formalization import reference as counters
from compiler.formalization.letters import atoms_of, letters_by_valuation
from compiler.targets.automata.chart import chart
from tests.each import each
from tests.effort import FULL
from tests.emitting import LOOKING_BACK, MANY, PROBABLE, SHARING, emitted, refused, requirement
from tests.programs import installed, needs
from tests.strategies import Template, few_templates


def text_of(sentence: str) -> str:
    return emitted("dot", sentence)["r1.dot"]


# The picture, read as a person reads it -------------------------------------------------------


@dataclass(frozen=True)
class Arrow:
    target: str
    expression: str
    condition: str
    change: str


@dataclass(frozen=True)
class Picture:
    start: str
    labels: Mapping[str, str]
    arrows: Mapping[str, list[Arrow]]


def read(text: str) -> Picture:
    start = re.search(r"begin -> (\w+);", text)
    assert start
    labels = dict(re.findall(r"^  (\w+) \[.*label=\"(.*)\"\];$", text, re.MULTILINE))
    arrows: dict[str, list[Arrow]] = {name: [] for name in labels}
    for source, target, label in re.findall(r"^  (\w+) -> (\w+) \[label=\"(.*)\"\];$", text, re.M):
        expression, *more = label.split(r"\n")
        condition = next((line[1:-1] for line in more if line.startswith("[")), "")
        change = next((line[2:] for line in more if line.startswith("/ ")), "")
        arrows[source].append(Arrow(target, expression, condition, change))
    return Picture(start[1], labels, arrows)


def true(expression: str, values: Mapping[str, bool]) -> bool:
    python = re.sub(r"!(?!=)", " not ", expression.replace("&", " and ").replace("|", " or "))
    names = {"TRUE": True, "FALSE": False}
    return bool(eval(python, {"__builtins__": {}}, names | dict(values)))


class Walk:
    """Through the picture, with k and with the triggers of the past."""

    def __init__(self, picture: Picture) -> None:
        self.picture, self.place, self.k = picture, picture.start, 0
        self.register = 0

    def on(self, condition: str) -> bool:
        if not condition:
            return True
        ago = re.fullmatch(r"(an|no) unanswered trigger (\d+) ticks? ago", condition)
        if ago:
            return bool(self.register >> int(ago[2]) - 1 & 1) is (ago[1] == "an")
        name, operator, number = condition.split()
        assert name == "k"
        return {"=": self.k == int(number), "<=": self.k <= int(number)}.get(
            operator, self.k >= int(number)
        )

    def go(self, values: Mapping[str, bool], register: int) -> None:
        here = self.picture.arrows[self.place]
        ways = [a for a in here if true(a.expression, values) and self.on(a.condition)]
        if self.place in ("violated", "satisfied"):
            assert not here
            return
        (way,) = ways
        assert (
            (way.change != "")
            or "k =" not in self.picture.labels[way.target]
            or (way.target == self.place)
        )
        if way.change:
            self.k = int(eval(way.change.removeprefix("k := "), {"k": self.k}))
        self.place = way.target
        self.register = register


def assert_walked_as_defined(sentence: str, traces: int) -> None:
    made = requirement(sentence)
    picture, defined = read(text_of(sentence)), chart(made)
    kind, atoms = counters.template(made.sentence, made.ticks or 0), atoms_of(made.sentence)
    letters = letters_by_valuation(made.sentence, atoms)
    choose = random.Random(sentence)
    for _ in range(traces):
        walk, index, register = Walk(picture), defined.start, 0
        odds = {name: choose.choice((0.15, 0.5, 0.85)) for name in atoms}
        for _ in range(14):
            row = tuple(choose.random() < odds[name] for name in atoms)
            letter = letters[row]
            if index < len(defined.states):
                reached = counters.step(kind, defined.states[index], *letter)
                register = reached.counted if reached else 0  # bit k: a trigger k ticks ago
                index = defined.moves[index][defined.letters.index(letter)]
            walk.go(dict(zip(atoms, row, strict=True)), register)
            assert (walk.place == "violated") is (index == defined.violated), (sentence, walk.place)
            assert (walk.place == "satisfied") is (index == defined.satisfied), sentence


@pytest.mark.slow
@each("template", few_templates((0, 1, 3)))
def test_every_template_is_walked_as_it_is_defined(template: Template) -> None:
    assert_walked_as_defined(template.sentence, 12)


@each("sentence", [s for s in SHARING if not re.search("x >|<->|->|xor", s)])
def test_expressions_may_share_propositions(sentence: str) -> None:
    assert_walked_as_defined(sentence.format(n=2), 30 if FULL else 12)


# What is seen ---------------------------------------------------------------------------------


def test_a_thousand_ticks_are_one_node() -> None:
    text = text_of("whenever p the sw shall within 1000 ticks satisfy q")
    assert text == (
        'digraph "R1" {\n'
        '  graph [rankdir=LR, labelloc=b, fontname="Helvetica", fontsize=12, pad=0.2,'
        " nodesep=0.4, ranksep=0.6];\n"
        '  node [fontname="Helvetica", fontsize=11];\n'
        '  edge [fontname="Helvetica", fontsize=10];\n'
        '  label="R1: whenever p the sw shall within 1000 ticks satisfy q\\n'
        "Over the whole run: at every tick at which `p` is true, `q` must be true at\\n"
        "that tick or within the next 1000 ticks (nothing is required if the run ends\\n"
        "before that).\\n"
        'On edges: [a condition on k], / what k becomes.";\n'
        "\n"
        '  begin [shape=point, label=""];\n'
        "  begin -> s1;\n"
        "\n"
        '  s1 [shape=ellipse, label="waiting"];\n'
        '  s2 [shape=box, label="open: k = 1..1000 ticks"];\n'
        '  violated [shape=doubleoctagon, label="violated"];\n'
        "\n"
        '  s1 -> s1 [label="!p | q"];\n'
        '  s1 -> s2 [label="p & !q\\n/ k := 1"];\n'
        '  s2 -> s2 [label="!q\\n[k <= 999]\\n/ k := k + 1"];\n'
        '  s2 -> violated [label="!q\\n[k = 1000]"];\n'
        '  s2 -> s1 [label="q"];\n'
        "}\n"
    )


@pytest.mark.slow
@each("template", few_templates((40,)))
def test_no_template_has_more_nodes_than_fit_on_a_page(template: Template) -> None:
    sentence = template.sentence
    if re.search("only .* (upon|whenever) .* after", sentence):
        return  # its states are as many as its registers; see the refusal below
    assert len(read(text_of(sentence)).labels) <= 13, sentence


def test_a_long_expression_is_named_on_edges_and_told_below() -> None:
    text = text_of(f"whenever {MANY} the sw shall within 3 ticks satisfy q")
    assert f"condition: {MANY}"[:60] in text
    assert '"condition & !q\\n/ k := 1"' in text


def test_a_demand_without_a_deadline_is_dashed_and_explained() -> None:
    text = text_of("whenever p the sw shall eventually satisfy q")
    assert 's2 [shape=ellipse, style=dashed, label="open"];' in text
    assert "A run that stays among dashed states for ever violates the requirement." in text


def test_what_is_decided_has_shapes_of_its_own() -> None:
    text = text_of("before m mode the sw shall immediately satisfy q")
    assert 'violated [shape=doubleoctagon, label="violated"];' in text
    assert 'satisfied [shape=doublecircle, label="satisfied"];' in text


def test_names_are_no_commands_of_graphviz() -> None:
    text = text_of('whenever "a<b>{N}" the "sw" shall within 3 ticks satisfy "c|d"')
    assert r"\N" not in text
    assert '"sw\\" shall' in text or 'the \\"sw\\"' in text


@needs("dot")
@pytest.mark.parametrize(
    "sentence",
    [
        "whenever too_close agilex_agent shall eventually satisfy stopped",
        "in m mode upon x > 3 the sw shall within 1000 ticks satisfy q & !r",
        'whenever "a<b>{N}" the "sw" shall after 3 ticks satisfy "c|d"',
    ],
)
def test_graphviz_draws_it(sentence: str, tmp_path: Path) -> None:
    path = tmp_path / "r1.dot"
    path.write_text(text_of(sentence), encoding="utf-8")
    done = subprocess.run(
        [installed("dot"), "-Tsvg", str(path)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "</svg>" in done.stdout


@pytest.mark.parametrize(
    ("sentence", "message"),
    [
        (PROBABLE, "F601 DOT cannot express the probability of R1"),
        (LOOKING_BACK, "F601 DOT cannot express the predicate `persisted` of R1"),
        (
            "only in m mode whenever p the sw shall after 40 ticks satisfy q",
            "F670 the automaton of R1 has more than {} states",
        ),
    ],
)
def test_it_is_refused(most_states: int, sentence: str, message: str) -> None:
    assert refused("dot", sentence).startswith(message.format(most_states))
