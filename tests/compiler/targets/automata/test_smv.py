"""NuSMV files: of its grammar, and a reader of our own runs them as the definition runs."""

import random
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import pytest
from lark import Lark, Token, Tree

from compiler.formalization import reference as counters
from compiler.formalization.letters import atoms_of, letters_by_valuation
from compiler.formalization.reference import ReferenceState, accepts
from compiler.logic import printing
from compiler.logic.definition import holds
from compiler.logic.spot import same_language
from compiler.targets.comparison_names import comparison_names
from tests.each import each
from tests.effort import FULL
from tests.emitting import LOOKING_BACK, MANY, PROBABLE, SHARING, emitted, refused, requirement
from tests.strategies import Template, few_templates

# The part of NuSMV's language that is used, from the grammar of its user manual (2.6, chapter 2
# and 3.2); precedences of expressions as in its table, from the tightest.
KEYWORDS = (
    "MODULE VAR DEFINE ASSIGN LTLSPEC TRUE FALSE case esac xor xnor boolean init next mod union in "
    "word1 bool array of self abs max min A E F G H O S T U V X Y Z"
).split()
GRAMMAR = r"""
start: module+
module: "MODULE" NAME parameters? section+
parameters: "(" NAME ("," NAME)* ")"
?section: "VAR" declaration+ -> variables
    | "DEFINE" definition+ -> definitions
    | "ASSIGN" assignment+ -> assignments
    | "LTLSPEC" "NAME" NAME ":=" expression ";" -> property
declaration: NAME ":" type ";"
?type: "boolean" -> boolean
    | NUMBER ".." NUMBER -> range
    | "{" NAME ("," NAME)* "}" -> enumeration
    | NAME "(" expression ("," expression)* ")" -> instance
definition: NAME ":=" expression ";"
assignment: "init" "(" NAME ")" ":=" expression ";" -> init
    | "next" "(" NAME ")" ":=" expression ";" -> next
?expression: iff
?iff: implies | iff "<->" implies -> iff
?implies: either | either "->" implies -> implies
?either: both | either "|" both -> or | either "xor" both -> xor
?both: since | both "&" since -> and
?since: comparison | since BINARY comparison -> binary
?comparison: sum | comparison COMPARES sum -> compare
?sum: unary | sum SIGN unary -> sum
?unary: atom | "!" unary -> not | UNARY bound? unary -> temporal
bound: "[" NUMBER "," NUMBER "]"
?atom: "(" expression ")" | NUMBER -> number | "TRUE" -> true | "FALSE" -> false
    | NAME ("." NAME)* -> name
    | "case" branch+ "esac" -> case
branch: expression ":" expression ";"
COMPARES: "<=" | ">=" | "!=" | "=" | "<" | ">"
SIGN: "+" | "-"
UNARY.2: /[XFGYZHO](?![A-Za-z0-9_$#-])/
BINARY.2: /[USVT](?![A-Za-z0-9_$#-])/
NAME: /(?!(?:@KEYWORDS)(?![A-Za-z0-9_$#-]))[A-Za-z_][A-Za-z0-9_$#-]*/
NUMBER: /[0-9]+/
COMMENT: /--[^\n]*/
%ignore COMMENT
%ignore /\s+/
"""


@cache
def parser() -> Lark:
    return Lark(GRAMMAR.replace("@KEYWORDS", "|".join(KEYWORDS)), parser="lalr")


def text_of(sentence: str) -> str:
    return emitted("smv", sentence)["r1.smv"]


def trees(tree: Tree[Any], kind: str) -> list[Tree[Any]]:
    return list(tree.find_data(kind))


# The reader -----------------------------------------------------------------------------------


@dataclass
class Model:
    """The main module and the monitor that it has, run tick by tick."""

    main: Tree[Any]
    module: Tree[Any]

    def __post_init__(self) -> None:
        self.inputs = [
            str(d.children[0]) for d in trees(self.main, "declaration") if kind(d) == "boolean"
        ]
        (instance,) = trees(self.main, "instance")
        assert instance.children[0] == self.module.children[0]
        (parameters,) = trees(self.module, "parameters")
        self.actual = dict(zip(map(str, parameters.children), instance.children[1:], strict=True))
        self.types = {str(d.children[0]): d.children[1] for d in trees(self.module, "declaration")}
        self.defined = {str(d.children[0]): d.children[1] for d in trees(self.module, "definition")}
        self.first = {str(a.children[0]): a.children[1] for a in trees(self.module, "init")}
        self.then = {str(a.children[0]): a.children[1] for a in trees(self.module, "next")}
        assert set(self.first) == set(self.then) == set(self.types)
        self.constants = {
            str(name) for t in trees(self.module, "enumeration") for name in t.children
        }
        self.state: dict[str, Any] = {}
        self.state = {name: self.value(value, {}) for name, value in self.first.items()}

    def tick(self, inputs: Mapping[str, bool]) -> dict[str, bool]:
        """What is defined at a tick; then the state is that of the next."""
        values = {name: self.value(value, inputs) for name, value in self.defined.items()}
        after = {name: self.value(value, inputs) for name, value in self.then.items()}
        for name, value in after.items():
            assert self.allowed(name, value), f"{name} := {value}"
        self.state = after
        return values

    def allowed(self, name: str, value: object) -> bool:
        type_ = self.types[name]
        if type_.data == "range":
            low, high = map(int, type_.children)
            assert low < high
            return isinstance(value, int) and low <= value <= high
        if type_.data == "enumeration":
            return value in [str(name) for name in type_.children]
        return isinstance(value, bool)

    def value(self, tree: Any, inputs: Mapping[str, bool]) -> Any:
        def of(part: Any) -> Any:
            return self.value(part, inputs)

        parts = tree.children
        match tree.data:
            case "true" | "false":
                return tree.data == "true"
            case "number":
                return int(parts[0])
            case "name":
                return self.named(str(parts[0]), inputs)
            case "not":
                return not of(parts[0])
            case "and":
                return of(parts[0]) and of(parts[1])
            case "or":
                return of(parts[0]) or of(parts[1])
            case "xor":
                return of(parts[0]) is not of(parts[1])
            case "iff":
                return of(parts[0]) is of(parts[1])
            case "implies":
                return not of(parts[0]) or of(parts[1])
            case "compare":
                return compared(of(parts[0]), str(parts[1]), of(parts[2]))
            case "sum":
                sign = 1 if parts[1] == "+" else -1
                return of(parts[0]) + sign * of(parts[2])
            case "case":
                return next(of(b.children[1]) for b in parts if of(b.children[0]))
            case _:
                raise AssertionError(tree.data)

    def named(self, name: str, inputs: Mapping[str, bool]) -> Any:
        if name in self.state:
            return self.state[name]
        if name in self.actual:
            return outside(self.actual[name], inputs, self)
        if name in self.defined:
            return self.value(self.defined[name], inputs)
        assert name in self.constants, name
        return name


def outside(tree: Any, inputs: Mapping[str, bool], model: Model) -> Any:
    """An argument: in the scope of the main module, where inputs are all that there is."""
    plain = Model.__new__(Model)
    plain.state, plain.actual, plain.defined = dict(inputs), {}, {}
    plain.constants = set()
    return plain.value(tree, inputs)


def compared(left: Any, operator: str, right: Any) -> bool:
    assert type(left) is type(right)
    if operator in ("=", "!="):
        return (left == right) is (operator == "=")
    low, high = (left, right) if operator.startswith("<") else (right, left)
    return bool(low < high or (operator.endswith("=") and low == high))


def kind(declaration: Tree[Any]) -> str:
    type_ = declaration.children[1]
    return str(type_.data) if isinstance(type_, Tree) else str(type_)


def read(text: str) -> Model:
    main, module = parser().parse(text).children
    assert isinstance(main, Tree)
    assert isinstance(module, Tree)
    assert main.children[0] == Token("NAME", "main")
    return Model(main, module)


# It runs as it is defined ---------------------------------------------------------------------


def assert_runs_as_defined(sentence: str, traces: int, length: int) -> None:
    made = requirement(sentence)
    text = text_of(sentence)
    names = re.findall(r"^    (\w+) : boolean;(?:  -- (.*))?$", text.split("LTLSPEC")[0], re.M)
    compared = {name: atom for atom, name in comparison_names(made).items()}
    atoms = {name: compared.get(name) or proposition or name for name, proposition in names}
    assert set(atoms_of(made.sentence)) <= set(atoms.values())
    order = tuple(atoms.values())
    letters, known = (
        letters_by_valuation(made.sentence, order),
        counters.template(made.sentence, made.ticks or 0),
    )
    choose = random.Random(sentence)
    parsed = parser().parse(text).children
    for _ in range(traces):
        model = Model(*parsed)  # type: ignore[arg-type]
        state: ReferenceState | None = counters.initial(known)
        rows: list[dict[str, bool]] = []
        odds = {name: choose.choice((0.15, 0.5, 0.85)) for name in order}
        for _ in range(length):
            row = {name: choose.random() < odds[name] for name in order}
            rows.append(row)
            values = model.tick({name: row[atoms[name]] for name in atoms})
            letter = letters[tuple(row[name] for name in order)]
            state = counters.step(known, state, *letter) if state is not None else None
            assert values["violated"] is (state is None), (sentence, rows)
            kept = state is not None and accepts(known, state)
            ends = not values["violated"] and not values.get("unmet", False)
            assert ends is kept, (sentence, rows)
        assert ends is holds(made.pt, rows, length - 1), (sentence, rows)


@pytest.mark.slow
@each("template", few_templates((0, 1, 3)))
def test_every_template_runs_as_it_is_defined(template: Template) -> None:
    assert_runs_as_defined(template.sentence, 8, 9)


@pytest.mark.slow
@each("sentence", SHARING)
def test_expressions_may_share_propositions(sentence: str) -> None:
    assert_runs_as_defined(sentence.format(n=2), 20 if FULL else 8, 8)


def test_what_decides_at_the_end_is_told_by_acceptance() -> None:
    """`G F !unmet` is the Büchi condition of the definition, for each state."""
    text = text_of("whenever p the sw shall eventually satisfy q")
    assert "(((G (!the_monitor_r1.violated)) & (G (F (!the_monitor_r1.unmet)))) <->" in text
    text = text_of("in m mode the sw shall finally satisfy q")
    assert "((G (!the_monitor_r1.violated)) <->" in text


# Its formulas ---------------------------------------------------------------------------------


def test_the_properties_of_a_safety_requirement() -> None:
    text = text_of("whenever p the sw shall within 3 ticks satisfy q")
    ft = "(G (p -> (F [0,3] q)))"
    pt = "(H ((O [3,3] (p & (!q))) -> (O [0,2] ((Z FALSE) | q))))"
    assert re.findall(r"LTLSPEC NAME (\w+) :=\n  (.*);", text) == [
        ("r1_ft", ft),
        ("r1_ft_is_monitor", f"((G (!the_monitor_r1.violated)) <-> {ft})"),
        ("r1_pt_is_monitor", f"(G ({pt} <-> (!the_monitor_r1.violated)))"),
        ("r1_pt_is_ft", f"((G {pt}) <-> {ft})"),
    ]


@pytest.mark.slow
@each("template", few_templates((0, 2)))
def test_the_requirement_is_its_future_time_formula(template: Template) -> None:
    found = re.search(r"LTLSPEC NAME r1_ft :=\n  (.*);", text_of(template.sentence))
    assert found
    spelt = re.sub(r" \[(\d+),(\d+)\]", r"[\1:\2]", found[1]).replace(" V ", " R ")
    expected = printing.future(requirement(template.sentence).ft_infinite)
    assert same_language(spelt.replace("TRUE", "1").replace("FALSE", "0"), expected)


@pytest.mark.parametrize("timing", ["eventually", "finally"])
def test_the_past_form_is_not_said_everywhere_where_the_end_decides(timing: str) -> None:
    assert "_pt_is_ft" not in text_of(f"in m mode upon p the sw shall {timing} satisfy q")


def test_a_bound_is_a_number() -> None:
    text = text_of("in m mode whenever p the sw shall within 100000 ticks satisfy q")
    assert "    count : 0..100000;" in text
    assert len(text) < 4000


def test_names_are_legal_and_told() -> None:
    text = text_of('whenever x > 3 & outside the sw shall within 2 ticks satisfy x_gt_3 | "a b"')
    assert "    x_gt_3_2 : boolean;  -- x > 3\n" in text
    assert "    outside_2 : boolean;  -- outside\n" in text
    assert "    x_gt_3 : boolean;\n" in text
    assert "    a_SPC_b : boolean;  -- a b\n" in text
    read(text)


def test_many_propositions_are_an_expression() -> None:
    read(text_of(f"whenever {MANY} the sw shall within 3 ticks satisfy p0 xor p1"))


@pytest.mark.parametrize("id", ["R-1.2", "G", "x.y-z", "1.main-x"])
def test_an_id_becomes_a_legal_name(id: str) -> None:
    (text,) = emitted("smv", "whenever p the sw shall always satisfy q", id).values()
    read(text)


def test_the_grammar_refuses_what_nusmv_would() -> None:
    text = text_of("whenever p the sw shall within 3 ticks satisfy q")
    for broken in (
        text.replace("[0,3]", "[0:3]"),
        text.replace("p : boolean;", "next : boolean;", 1),
        text.replace("esac;", ";"),
        text.replace("(p, q)", "(p q)"),
    ):
        assert broken != text
        with pytest.raises(Exception, match="Unexpected"):
            parser().parse(broken)


# Refusals -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("sentence", "message"),
    [
        (PROBABLE, "F601 NuSMV cannot express the probability of R1"),
        (LOOKING_BACK, "F601 NuSMV cannot express the predicate `persisted` of R1"),
    ],
)
def test_it_is_refused(sentence: str, message: str) -> None:
    assert refused("smv", sentence).startswith(message)
