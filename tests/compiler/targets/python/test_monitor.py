"""Generated monitors, executed from their text: the meaning of FRETish, tick by tick."""

import ast
import io
import json
import random
import re
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any
from unittest.mock import patch

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.emit import TARGETS
from compiler.files.text_files import write
from compiler.formalization.formalize import formalize
from compiler.targets.python import monitor as target
from fretish.clock import Clock
from fretish.diagnostics.diagnostic import Code
from fretish.diagnostics.source import Source
from fretish.documents import requirements
from monitors.kernel import Monitor
from monitors.kernel.verdicts import Truth, Verdict
from monitors.loading import executed, load
from tests import fret_notation as fret
from tests import meaning
from tests.effort import FULL, pairwise, some
from tests.monitoring import emitted, monitor, over, requirement, steps
from tests.strategies import COUNTS, Template, some_templates, three_valued

SCOPES = meaning.SCOPES
R1 = "whenever too_close agilex_agent shall eventually satisfy stopped"
FIELDS = (
    *("finite", "trigger", "violation", "violation_inevitable", "obligation_pending"),
    *("satisfied_forever", "answer"),
)
WITHIN = "when p the sw shall within 3 ticks satisfy q"
Columns = dict[str, list[bool]]


def of_scope(scope: str, counts: tuple[int, ...] = COUNTS) -> list[Template]:
    """Each condition and each timing; with the full profile each two of them."""
    return [template for template in some_templates(counts) if template.scope == scope]


@cache
def of_template(template: Template) -> Monitor:
    return monitor(template.sentence)


def drawn(names: Sequence[str], length: int, count: int, seed: str) -> list[Columns]:
    choose = random.Random(seed)
    return [
        {n: [choose.random() < 0.5 for _ in range(length)] for n in names} for _ in range(count)
    ]


def some_traces(template: Template) -> Iterator[Columns]:
    names = template.columns
    every = fret.all_traces(names, 9 // len(names) if len(names) < 4 else 2)
    yield from some(every, 23)  # no power of two: each value at each tick
    yield from drawn(names, 8, 25 if FULL else 8, repr(template))


def cut(columns: Columns, length: int) -> Columns:
    return {name: column[:length] for name, column in columns.items()}


# The meaning ----------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_finite_is_the_meaning_of_every_prefix(scope: str) -> None:
    for template in of_scope(scope):
        known: dict[tuple[tuple[bool, ...], ...], bool] = {}
        for columns in some_traces(template):
            rows = tuple(zip(*columns.values(), strict=True))
            for length, verdict in enumerate(steps(of_template(template), columns), 1):
                prefix = rows[:length]
                if prefix not in known:
                    known[prefix] = template.satisfied(cut(columns, length))
                assert verdict.finite is known[prefix], (template, cut(columns, length))


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_triggers_are_those_of_the_definition(scope: str) -> None:
    for template in of_scope(scope):
        for columns in some_traces(template):
            m, p = (columns.get(name, columns["q"]) for name in "mp")
            expected = [
                t
                for left, right in meaning.intervals(template.scope, m)
                for t in meaning.triggers(template.condition, p, left, right)
            ]
            found = [v.tick for v in steps(of_template(template), columns) if v.trigger]
            assert found == expected, (template, columns)


def rows(names: Sequence[str], length: int) -> Iterator[tuple[tuple[bool, ...], ...]]:
    return product(product((False, True), repeat=len(names)), repeat=length)


def columns_of(names: Sequence[str], table: Sequence[tuple[bool, ...]]) -> Columns:
    return {name: [row[i] for row in table] for i, name in enumerate(names)}


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_violated_is_said_at_the_first_tick_that_nothing_can_repair(scope: str) -> None:
    """Two more ticks decide every template that counts to 1: nothing of before is open then."""
    for template in of_scope(scope, (0, 1)):
        names, machine = template.columns, of_template(template)
        for length in (1, 2):
            for prefix in rows(names, length):
                lost = not any(
                    template.satisfied(columns_of(names, prefix + rest)) for rest in rows(names, 2)
                )
                last = steps(machine, columns_of(names, prefix))[-1]
                assert (last.verdict == last.decided == "violated") is lost, (template, prefix)


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_an_open_demand_is_never_counted_as_satisfied(scope: str) -> None:
    """Satisfied and vacuous are said only of traces that FRET's finite semantics satisfies."""
    for template in of_scope(scope):
        for columns in drawn(template.columns, 6, 20, repr(template)):
            for verdict in steps(of_template(template), columns):
                if verdict.verdict in ("satisfied", "vacuous"):
                    assert verdict.finite is True, (template, columns)
                if verdict.verdict == "vacuous":
                    assert not any(
                        v.trigger for v in steps(of_template(template), columns)[: verdict.tick + 1]
                    )


DUALS = {
    "null": "never",
    "eventually": "never",
    "always": "eventually",
    "never": "eventually",
    "within": "for",
    "for": "within",
    "until": "before",
    "before": "until",
}
"""What an `only` scope demands, as a timing; of the opposite response but for `never`."""


def is_open(timing: str, n: int, begun: int, last: int, q: list[bool]) -> bool:
    """Whether a demand that began at `begun` still waits, after the tick `last`."""
    silent = not any(q[begun : last + 1])
    match timing:
        case "next":
            return begun == last
        case "finally":
            return True
        case "null" | "eventually":
            return silent
        case "within":
            return silent and last < begun + n
        case "for":
            return last < begun + n
        case "after":
            return silent and last < begun + n + 1
        case _:
            return False


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_a_demand_is_open_until_its_answer_or_its_deadline(scope: str) -> None:
    for template in of_scope(scope):
        timing, negated = template.timing, False
        if scope.startswith("only"):
            negated = timing in ("always", "for", "within")
            timing = DUALS.get(timing, timing)
        for columns in drawn(template.columns, 6, 15, repr(template)):
            for verdict in steps(of_template(template), columns):
                last, seen = verdict.tick, cut(columns, verdict.tick + 1)
                m, p = (seen.get(name, seen["q"]) for name in "mp")
                q = [value is not negated for value in seen["q"]]
                expected = any(
                    right == last and is_open(timing, template.n, t, last, q)
                    for left, right in meaning.intervals(scope, m)
                    for t in meaning.triggers(template.condition, p, left, right)
                )
                if verdict.verdict != "violated":
                    assert verdict.obligation_pending is expected, (template, seen)
                    assert (verdict.verdict == "inconclusive") is expected, (template, seen)


@pytest.mark.parametrize(
    ("timing", "deadline_ticks"),
    [
        ("immediately", 0),
        ("at the next timepoint", 1),
        ("within 3 ticks", 3),
        ("for 3 ticks", 3),
        ("after 3 ticks", 4),
        ("eventually", None),
        ("always", None),
        ("until s", None),
    ],
)
def test_the_horizon_is_the_last_tick_that_a_demand_asks_for(
    timing: str, deadline_ticks: int | None
) -> None:
    found = monitor(f"the sw shall {timing} satisfy q").REQUIREMENTS[0].deadline_ticks
    assert found == deadline_ticks


# Unknown values -------------------------------------------------------------------------------


def completions(columns: dict[str, list[Truth]]) -> Iterator[Columns]:
    holes = [(n, i) for n, column in columns.items() for i, v in enumerate(column) if v is None]
    for values in product((False, True), repeat=len(holes)):
        filled = {name: list(column) for name, column in columns.items()}
        for (name, i), value in zip(holes, values, strict=True):
            filled[name][i] = value
        yield {name: [value is True for value in column] for name, column in filled.items()}


def with_holes(names: Sequence[str], length: int, seed: str) -> dict[str, list[Truth]]:
    choose = random.Random(seed)
    (known,) = drawn(names, length, 1, seed)
    columns: dict[str, list[Truth]] = {name: list(column) for name, column in known.items()}
    for _ in range(choose.randint(1, 4)):
        columns[choose.choice(names)][choose.randrange(length)] = None
    return columns


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_what_is_definite_stays_whatever_the_unknown_values_are(scope: str) -> None:
    for template in of_scope(scope):
        for k in range(6):
            columns = with_holes(template.columns, 6, f"{template} {k}")
            partly = steps(of_template(template), columns)
            for filled in completions(columns):
                for known, full in zip(partly, steps(of_template(template), filled), strict=True):
                    for field in FIELDS:
                        value = getattr(known, field)
                        assert value in (None, getattr(full, field)), (template, columns, field)
                    assert known.decided in ("pending", full.decided), (template, columns)
                    assert known.verdict in ("no data", full.verdict), (template, columns)


@pytest.mark.slow
@given(
    st.sampled_from(some_templates()),
    three_valued("m", "p", "q", "s"),
    st.randoms(use_true_random=False),
)
def test_no_unknown_value_contradicts_a_definite_verdict(
    template: Template, table: list[dict[str, Truth]], choose: random.Random
) -> None:
    columns: dict[str, list[Truth]] = {n: [row[n] for row in table] for n in template.columns}
    filled = {
        name: [choose.random() < 0.5 if value is None else value for value in column]
        for name, column in columns.items()
    }
    partly = steps(of_template(template), columns)
    for length, known in enumerate(partly, 1):
        assert known.finite in (None, template.satisfied(cut(filled, length)))


@pytest.mark.slow
@pytest.mark.parametrize("scope", SCOPES)
def test_with_all_values_known_everything_is_definite_and_with_none_nothing(scope: str) -> None:
    for template in of_scope(scope):
        (columns,) = drawn(template.columns, 8, 1, repr(template))
        for verdict in steps(of_template(template), columns):
            assert None not in (verdict.finite, verdict.violation, verdict.obligation_pending)
            assert verdict.verdict != "no data"
        unknown: dict[str, list[Truth]] = {name: [None] * 6 for name in template.columns}
        for verdict in steps(of_template(template), unknown):
            assert verdict.verdict not in ("satisfied", "violated"), template


# Whole runs -----------------------------------------------------------------------------------


def ran(sentence: str, end: str = "inconclusive", **columns: str) -> dict[str, Any]:
    """Run over columns such as `p="10?"`."""
    values: dict[str, Truth] = {"0": False, "1": True, "?": None}
    given = {name: [values[mark] for mark in column] for name, column in columns.items()}
    return over(monitor(sentence), given, Verdict(end)).as_json()


def test_r1_is_inconclusive_until_the_robot_stops() -> None:
    assert ran(R1, too_close="0110", stopped="0000") == {
        "requirement": "R1",
        "ticks": 4,
        "verdict": "inconclusive",
        "finite": False,
        "first_violation": None,
        "violations": [],
        "unknown": [],
        "triggers": [1, 2],
        "answers": [],
        "open": [{"trigger": 1, "deadline": None}, {"trigger": 2, "deadline": None}],
        "uncertain": [],
    }
    answered = ran(R1, too_close="0110", stopped="0001")
    assert (answered["verdict"], answered["finite"]) == ("satisfied", True)
    assert (answered["answers"], answered["open"]) == ([[1, 3], [2, 3]], [])


@pytest.mark.parametrize(
    ("p", "q", "verdict", "finite", "violations", "unanswered"),
    [
        ("0000", "0000", "vacuous", True, [], []),
        ("1000", "0001", "satisfied", True, [], []),
        ("1000", "0000", "violated", False, [[3, 3]], []),
        ("100000", "000000", "violated", False, [[3, 5]], []),
        ("100000", "000001", "violated", False, [[3, 4]], []),
        ("100", "000", "inconclusive", True, [], [{"trigger": 0, "deadline": 3}]),
        ("1010", "0100", "inconclusive", True, [], [{"trigger": 2, "deadline": 5}]),
        ("110", "100", "satisfied", True, [], []),
        ("?", "0", "no data", True, [], []),
        ("?0", "00", "no data", True, [], []),
        ("1000", "000?", "no data", None, [], []),
        ("1000", "0?1?", "satisfied", True, [], []),
    ],
)
def test_within_three_ticks(
    p: str, q: str, verdict: str, finite: Truth, violations: list[Any], unanswered: list[Any]
) -> None:
    found = ran(WITHIN, p=p, q=q)
    keys = ("verdict", "finite", "violations", "open")
    assert tuple(found[key] for key in keys) == (verdict, finite, violations, unanswered)
    assert found["first_violation"] == (violations[0][0] if violations else None)


def test_a_demand_whose_deadline_has_come_is_not_open() -> None:
    found = ran("whenever p the sw shall for 2 ticks satisfy q", p="101", q="111")
    assert (found["verdict"], found["finite"]) == ("inconclusive", True)
    assert found["open"] == [{"trigger": 2, "deadline": 4}]


def test_an_answer_after_the_deadline_is_no_answer() -> None:
    found = ran(WITHIN, p="10000", q="00001")
    assert (found["verdict"], found["answers"]) == ("violated", [])
    assert ran(WITHIN, p="10000", q="00010")["answers"] == [[0, 3]]


def test_an_open_demand_may_count_as_violated_at_the_end() -> None:
    found = ran(WITHIN, end="violated", p="100", q="000")
    assert (found["verdict"], found["first_violation"]) == ("violated", 2)


# The text -------------------------------------------------------------------------------------


def generated(text: str) -> list[ast.ClassDef]:
    """The approximation and the monitor, which are not copied from the kernel."""
    after = text[text.index("# The requirements ---") :]
    return [node for node in ast.parse(after).body if isinstance(node, ast.ClassDef)]


def shape(text: str) -> list[str]:
    return [type(node).__name__ for part in generated(text) for node in ast.walk(part)]


@pytest.mark.slow
def test_a_step_is_the_same_code_for_any_duration() -> None:
    for parts in pairwise(SCOPES, meaning.CONDITIONS, ("within", "for", "after")):
        scope, condition, timing = parts
        short, long = (emitted(Template(scope, condition, timing, n).sentence) for n in (3, 10**6))
        assert shape(short) == shape(long), parts


def test_a_chain_of_differences_makes_no_exponential_code() -> None:
    short, long = (
        len(shape(emitted(f"the sw shall always satisfy {' xor '.join(names)}")))
        for names in ([f"p{i}" for i in range(4)], [f"p{i}" for i in range(8)])
    )
    assert long < 4 * short, (short, long)


def test_a_monitor_with_a_long_duration_steps_to_its_deadline() -> None:
    machine = monitor("when p the sw shall within 1000 ticks satisfy q")
    p = [tick == 0 for tick in range(1002)]
    outputs = steps(machine, {"p": p, "q": [False] * 1002})
    assert [step.verdict for step in outputs[999:]] == ["inconclusive", "violated", "violated"]
    assert [step.decided for step in outputs[999:]] == ["pending", "violated", "violated"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("p", "q"),
    [
        ("class", "lambda"),
        ("None", "True_"),
        ("cls", "super"),
        ("p", "p_must"),
        ("p_may", "p"),
        ("p_must", "p_may"),
        ("p", "p_"),
        ("approximations", "truth"),
        ("Truth", "Verdict"),
        ("History", "Window"),
        ("deque", "sys"),
        ("len", "print"),
        ("isinstance", "tuple"),
        ("note", "step"),
        ("l", "I"),
        ("object", "type"),
        ('"a-b"', '"a+b"'),
        ('"1"', '"2x"'),
        ('"é"', '"ö"'),
        ('"\\"', "\"'''\""),
        ('"{{ x }}"', '"{% raw %}"'),
        ('"#"', '"\\n"'),
        ("x > 3", "x >= 3"),
        ("x > 3", "x_gt_3"),
        ("x - 1 = 2", "x = 2"),
        ("f(x, 1)", "f(x, 2)"),
        ("x < 1.5", "x < 15"),
        ("absReal(x) > 1", '"(x > 3)"'),
    ],
)
def test_names_of_any_kind_are_kept_apart(p: str, q: str) -> None:
    machine = monitor(f"when {p} the sw shall within 1 ticks satisfy {q}")
    first, second = machine.PROPOSITIONS
    seen = {first: [False, True, False, False], second: [True, False, False, True]}
    verdicts = [step.verdict for step in steps(machine, seen)]
    assert verdicts == ["vacuous", "inconclusive", "violated", "violated"]
    assert over(machine, seen).verdict == "violated"


def locals_of(text: str) -> list[str]:
    """Every name that the generated functions store to or read, without their propositions."""
    methods = [n for part in generated(text) for n in part.body if isinstance(n, ast.FunctionDef)]
    found = {n.id for method in methods for n in ast.walk(method) if isinstance(n, ast.Name)}
    return sorted(found - {"p", "q", "m"})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scope", "condition", "timing"),
    [
        ("in", "regular", "within"),
        ("notin", "regular", "after"),
        ("after", "regular", "for"),
        ("onlyAfter", "holding", "within"),
        ("in", "null", "until"),
        ("null", "regular", "before"),
    ],
)
def test_names_that_the_code_uses_itself_change_nothing(
    scope: str, condition: str, timing: str
) -> None:
    template = Template(scope, condition, timing, 2)
    used = locals_of(emitted(template.sentence))
    names = [n for n in used if n not in template.columns]
    for taken in some(names, 5, first=len(scope) % 5):
        sentence = re.sub(r"\bq\b", f'"{taken}"', template.sentence)
        machine = monitor(sentence)
        for columns in drawn(template.columns, 8, 6, taken):
            renamed: dict[str, list[Any]] = {
                taken if name == "q" else name: column for name, column in columns.items()
            }
            verdicts = [v.finite for v in steps(machine, renamed)]
            expected = [template.satisfied(cut(columns, length)) for length in range(1, 9)]
            assert verdicts == expected, taken


HOSTILE = [
    "\"'''\"",
    '"\\"',
    '"\\x22; raise SystemExit(9) #"',
    '"# \r raise SystemExit(9)"',
    '"\u2028raise SystemExit(9)"',
    '"\x0craise SystemExit(9)"',
    '"\x85raise SystemExit(9)"',
    '"{{ 7 * 7 }}{% endraw %}"',
    '"${x}`id`"',
    '"\u202eesrever"',
    '"coding: latin-1"',
]


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE, ids=ascii)
def test_no_name_breaks_out_of_its_place(name: str) -> None:
    text = emitted(f"whenever {name} the sw shall immediately satisfy q")
    assert text.isascii()
    assert shape(text) == shape(emitted("whenever p the sw shall immediately satisfy q"))
    machine = load("hostile.py", text)
    assert list(machine.PROPOSITIONS) == [name[1:-1], "q"]


def test_no_header_breaks_out_of_its_place() -> None:
    text = (
        '+++\nid = "R1"\ntitle = "x\\n\\"\\"\\"\\nraise SystemExit(9)"\n'
        'rationale = "\\u2028raise SystemExit(9)"\nparents = ["\\nraise SystemExit(9)"]\n+++\n'
        "the sw shall\n\n\tsatisfy q\n"
    )
    (requirement,), wrong = requirements(Source('x"""\nraise SystemExit(9)/r.fret', text))
    assert wrong == ()
    made, _ = formalize(requirement, None)
    assert made is not None
    (file,) = TARGETS["monitor"].emit([made])
    assert shape(file.text) == shape(emitted("the sw shall satisfy q"))
    assert load("r.py", file.text).REQUIREMENTS[0].sentence == "the sw shall satisfy q"


def test_no_topic_breaks_out_of_its_comment() -> None:
    clock = Clock(None, "/scan\nraise SystemExit(9)\n#\u2028")
    text = emitted("the sw shall within 3 ticks satisfy q", clock=clock)
    assert shape(text) == shape(emitted("the sw shall within 3 ticks satisfy q"))
    load("r.py", text)


@pytest.mark.parametrize(
    ("id", "path"),
    [("R1", "r1_monitor.py"), ("HAZ-003.a", "haz_003_a_monitor.py"), ("7", "7_monitor.py")],
)
def test_a_monitor_is_named_after_its_requirement(id: str, path: str) -> None:
    (file,) = TARGETS["monitor"].emit([requirement("the sw shall satisfy q", id)])
    assert str(file.path) == path
    found = load(path, file.text).REQUIREMENTS[0].id
    assert found == id


@pytest.mark.parametrize("id", ["Monitor", "monitor", "History", "7", "a.b", "_x-1", "class"])
def test_any_id_gives_a_class_that_works(id: str) -> None:
    made = target.text(requirement("the sw shall always satisfy q", id.lstrip("_")))
    assert over(load("r.py", made), {"q": [True]}).verdict == "satisfied"


def test_a_duration_with_a_unit_needs_a_clock() -> None:
    refused = TARGETS["monitor"].refuse(requirement("the sw shall within 3 seconds satisfy q"))
    assert refused is not None
    assert refused.code is Code.NO_CLOCK
    timed = requirement("the sw shall within 3 seconds satisfy q", clock=Clock(10**9))
    assert TARGETS["monitor"].refuse(timed) is None


def test_a_probability_is_refused_and_not_dropped() -> None:
    """One run satisfies or violates; it has no probability."""
    refused = TARGETS["monitor"].refuse(
        requirement("the sw shall with probability >= 0.9 always satisfy q")
    )
    assert refused is not None
    assert refused.code is Code.NOT_EXPRESSIBLE


def test_a_caller_who_mistakes_a_number_for_a_truth_value_is_told() -> None:
    with pytest.raises(TypeError, match="`q` is True, False or None"):
        monitor("the sw shall satisfy q").step(q=1)  # type: ignore[attr-defined]


# As a program ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of monitors: `within.py`, `r1.py` and some with unusual names."""
    folder = tmp_path_factory.mktemp("programs")
    sentences = {
        "within": WITHIN,
        "r1": R1,
        "scoped": "in m, when p the sw shall after 2 ticks satisfy q",
        "names": "after l mode, whenever class | I the sw shall for 2 ticks "
        'satisfy x.y & "a b" > 3',
        "comparing": "whenever absReal(preReal(0.1, speed) - 2) < maxReal(speed, 1 / 3) "
        "& x mod 3 = y the sw shall within 2 ticks satisfy q",
        "always": "the sw shall always satisfy q",
        "long": "only after some_rather_long_mode_name, upon another_rather_long_name > 3 the sw "
        "shall until yet_another_rather_long_stop_name satisfy the_response_is_long_too",
    }
    texts = {
        folder / f"{name}.py": target.text(requirement(s, name)) for name, s in sentences.items()
    }
    assert write(texts) is None
    return folder


@cache
def module(path: Path) -> Any:
    return executed(path.read_text("utf-8"), path.stem)


def call(
    programs: Path, name: str, *arguments: str, stdin: bytes = b""
) -> subprocess.CompletedProcess[bytes]:
    """As the program does it that the text is, in this process."""
    path, given = programs / f"{name}.py", programs / "stdin"
    given.write_bytes(stdin)
    program, out, err = module(path), io.StringIO(), io.StringIO()
    main = getattr(program, "main_by_variables", None) or program.main
    with (
        given.open(encoding="utf-8") as file,
        patch.object(sys, "stdin", file),
        patch.object(sys, "argv", [str(path), *arguments]),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        try:
            status = main(program.MONITOR)
        except SystemExit as exit_:
            status = exit_.code
    return subprocess.CompletedProcess(
        [str(path)], status, out.getvalue().encode(), err.getvalue().encode()
    )


def started(
    programs: Path, name: str, *arguments: str, stdin: bytes = b""
) -> subprocess.CompletedProcess[bytes]:
    """The program in a process of its own."""
    return subprocess.run(
        [sys.executable, "-I", "-S", str(programs / f"{name}.py"), *arguments],
        input=stdin,
        capture_output=True,
        timeout=60,
        check=False,
    )


def tool(*command: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_a_monitor_passes_a_strict_type_check(
    programs: Path, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    """In a folder with another name: the checker is not to find the project's configuration."""
    files = sorted(map(str, programs.glob("*.py")))
    cache = getattr(request.config, "cache", None)
    kept = cache.mkdir("mypy-of-monitors") if cache else tmp_path
    arguments = ("--strict", "--config-file=", f"--cache-dir={kept}", *files)
    done = tool(sys.executable, "-m", "mypy", *arguments)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout


def test_a_monitor_passes_the_linter(programs: Path) -> None:
    files = sorted(map(str, programs.glob("*.py")))
    arguments = ("check", "--isolated", "--no-cache", "--target-version=py38", *files)
    done = tool(sys.executable, "-m", "ruff", *arguments)
    assert done.returncode == 0, done.stdout


CASES = [
    ("p,q\n0,0\n", 3, "vacuous"),
    ("p,q\n1,0\n0,1\n", 0, "satisfied"),
    ("p,q\n1,0\n0,0\n0,0\n0,0\n", 1, "violated"),
    ("p,q\n1,0\n", 3, "inconclusive"),
    ("p,q\n1,\n0,\n0,\n0,\n", 3, "no data"),
    ("p,q\n", 3, "no data"),
    ("\ufefftick,p,q\r\n4,true,false\r\n5,FALSE,True\r\n", 0, "satisfied"),
    ('{"p": true, "q": null}\n{"p": 0, "q": 1}\n', 0, "satisfied"),
]


@pytest.mark.slow
@pytest.mark.parametrize(("trace", "status", "verdict"), CASES)
def test_the_exit_status_tells_the_verdict(
    programs: Path, tmp_path: Path, trace: str, status: int, verdict: str
) -> None:
    path = tmp_path / "trace.csv"
    path.write_bytes(trace.encode())
    for done in (
        call(programs, "within", str(path), "--format", "json"),
        call(programs, "within", "-", "--format", "json", stdin=trace.encode()),
        *([started(programs, "within", "-", "--format", "json", stdin=trace.encode())] * FULL),
    ):
        assert (done.returncode, done.stderr) == (status, b"")
        (line,) = done.stdout.decode().splitlines()
        assert json.loads(line)["verdict"] == verdict


def test_the_json_has_the_fields_that_programs_rely_on(programs: Path) -> None:
    """From a process of its own, as programs get it."""
    done = started(
        programs, "within", "-", "--format", "json", stdin=b"p,q\n1,0\n0,0\n0,0\n0,0\n1,1\n"
    )
    assert (done.returncode, done.stderr) == (1, b"")
    found = json.loads(done.stdout)
    promised = {
        "requirement": "within",
        "verdict": "violated",
        "finite": False,
        "first_violation": 3,
        "violations": [[3, 3]],
        "triggers": [0, 4],
        "open": [],
    }
    assert {key: found[key] for key in promised} == promised


@pytest.mark.slow
@pytest.mark.parametrize("form", ["text", "json"])
def test_a_reader_that_goes_away_is_neither_a_verdict_nor_bad_use(
    programs: Path, form: str
) -> None:
    command = f"{sys.executable} -I -S {programs / 'within.py'} - --format {form}"
    line = f"printf 'p,q\\n1,0\\n' | {command} | true; echo ${{PIPESTATUS[1]}}"
    done = tool("bash", "-c", line)
    assert (done.stdout, done.stderr) == ("141\n", "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("trace", "why"),
    [
        ("p,q\n", "the trace has no tick"),
        ("p,q\n1,\n0,\n0,\n0,\n", "unknown at ticks 3..3"),
        (
            "p,q\n,0\n",
            "unknown whether there was a trigger, or whether a demand is open at the end",
        ),
    ],
)
def test_what_is_missing_is_said(programs: Path, trace: str, why: str) -> None:
    done = call(programs, "within", "-", stdin=trace.encode())
    assert done.stdout.decode() == f"<stdin>: within: no data ({why})\n"


def test_people_read_one_line(programs: Path) -> None:
    done = call(programs, "within", "-", stdin=b"p,q\n1,0\n0,1\n")
    assert done.stdout.decode() == "<stdin>: within: satisfied (1 trigger)\n"


def test_what_is_open_at_the_end_may_count_as_violated_on_request(programs: Path) -> None:
    done = call(programs, "within", "-", "--end", "violated", stdin=b"p,q\n1,0\n")
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.slow
def test_the_worst_of_several_traces_decides(programs: Path, tmp_path: Path) -> None:
    good, bad = tmp_path / "good.csv", tmp_path / "bad.csv"
    good.write_text("p,q\n1,1\n")
    bad.write_text("p,q\n1,0\n0,0\n0,0\n0,0\n")
    assert call(programs, "within", str(good), str(good)).returncode == 0
    assert call(programs, "within", str(bad), str(good)).returncode == 1
    assert len(call(programs, "within", str(bad), str(good)).stdout.splitlines()) == 2
    assert call(programs, "within", str(bad), str(tmp_path / "missing.csv")).returncode == 2


@pytest.mark.slow
@pytest.mark.parametrize(
    ("trace", "message"),
    [
        (b"", "<stdin>: the trace is empty"),
        (b"p\n1\n", "<stdin>:1: there is no column `q`; there are p"),
        (
            b"p,q\n1,maybe\n",
            "<stdin>:2: column `q`: `maybe` is no truth value; write 0, 1, true, false, or "
            "nothing for unknown",
        ),
        (
            b"p,q\nNaN,1\n",
            "<stdin>:2: column `p`: `NaN` is no truth value; write 0, 1, true, false, or nothing "
            "for unknown",
        ),
        (
            b'{"p": NaN, "q": 1}\n',
            "<stdin>:1: column `p`: `nan` is no truth value; write 0, 1, true, false, or nothing "
            "for unknown",
        ),
        (b"tick,p,q\n1,0,0\n0,0,0\n", "<stdin>:3: column `tick` goes back: 1, then 0"),
        (b"tick,p,q\n0,0,0\n2,0,0\n", "<stdin>:3: column `tick` leaves ticks out: 0, then 2"),
        (b"p,q\n1,\xe9\n", "<stdin>: the trace is not UTF-8 text"),
        (b"\x89HDF\r\n\x1a\n\x00\x00", "<stdin>: the trace is not UTF-8 text"),
    ],
)
def test_bad_input_is_one_clear_message(programs: Path, trace: bytes, message: str) -> None:
    done = call(programs, "within", "-", "--format", "json", stdin=trace)
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr.decode() == f"{message}\n"


@pytest.mark.slow
@pytest.mark.parametrize("trace", [b'{"p": ' + b"[" * 100_000, b"p,q\n\x00,1\n", b'{"p":1}\n\xff'])
def test_no_input_gives_a_traceback(programs: Path, trace: bytes) -> None:
    done = started(programs, "within", "-", stdin=trace)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1, done.stderr[-300:]


def test_a_file_that_is_not_there_is_one_clear_message(programs: Path, tmp_path: Path) -> None:
    missing = tmp_path / "missing.csv"
    done = call(programs, "within", str(missing))
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr.decode() == f"{missing}: No such file or directory\n"
    assert call(programs, "within", str(tmp_path)).stderr.decode() == (
        f"{tmp_path}: Is a directory\n"
    )


@pytest.mark.parametrize("arguments", [(), ("-", "--format", "xml"), ("-", "--end", "x"), ("--x",)])
def test_bad_use_is_exit_status_2_with_a_hint(programs: Path, arguments: tuple[str, ...]) -> None:
    done = call(programs, "within", *arguments)
    assert (done.returncode, done.stdout) == (2, b"")
    assert b"usage:" in done.stderr
    assert b"Traceback" not in done.stderr


def test_help_names_the_sentence_and_the_columns(programs: Path) -> None:
    done = call(programs, "within", "--help")
    assert done.returncode == 0
    assert WITHIN in done.stdout.decode()
    assert "columns: p, q" in done.stdout.decode()


def test_a_percent_sign_in_a_sentence_does_not_break_the_help(
    programs: Path, tmp_path: Path
) -> None:
    path = tmp_path / "percent.py"
    path.write_text(emitted("the sw shall satisfy load%s"), encoding="utf-8")
    done = call(tmp_path, "percent", "--help")
    assert (done.returncode, done.stderr) == (0, b"")
    assert "load%s" in done.stdout.decode()


def test_unusual_names_are_columns(programs: Path) -> None:
    done = call(programs, "names", "--help").stdout.decode()
    columns = done.split("columns: ")[1].splitlines()[0]
    assert columns == "l, class, I, x.y, a b"
    trace = "l,class,I,x.y,a b\n1,0,0,1,4\n0,0,1,1,3.5\n0,0,0,1,1e2\n0,0,0,0,inf\n"
    done = call(programs, "names", "-", "--format", "json", stdin=trace.encode()).stdout.decode()
    assert json.loads(done)["violations"] == [[3, 3]]


def test_a_table_of_numbers_is_compared_and_judged(programs: Path) -> None:
    """`x mod 3 = y` holds at the first two ticks; no response comes to the first in time."""
    trace = b"x,y,speed,q\n4,1,3,0\n7.5,1.5,2.5,0\n,1,2.5,0\n5,1,1,1\n"
    for engine in ("columns", "online"):
        done = call(programs, "comparing", "-", "--engine", engine, "--format", "json", stdin=trace)
        outcome = json.loads(done.stdout)
        assert (outcome["triggers"], outcome["violations"]) == ([0, 1], [[2, 2]]), engine
        assert (done.returncode, done.stderr) == (1, b"")


def test_a_table_of_numbers_that_cannot_be_read_is_refused_with_its_place(programs: Path) -> None:
    done = call(programs, "comparing", "-", stdin=b"x,y,speed,q\n4,1,3,0\n4,one,3,0\n")
    assert (done.returncode, done.stdout) == (2, b"")
    assert done.stderr.decode() == (
        "<stdin>:3: column `y`: `one` is no number; write it as 17.5 or 1e-3, or nothing for "
        "unknown\n"
    )


def test_a_monitor_of_numbers_reads_the_truth_of_comparisons_too(programs: Path) -> None:
    text = call(programs, "comparing", "--help").stdout.decode()
    assert "columns: speed, x, y, q\n" in text
    header = text.split("with --propositions: ")[1].splitlines()[0]
    names = re.split(r", (?=[(q])", header)
    assert len(names) == 3
    assert names[-1] == "q"
    quoted = ",".join(f'"{name}"' for name in names)
    trace = f"{quoted}\n1,1,0\n0,0,0\n0,0,0\n".encode()
    assert call(programs, "comparing", "-", "--propositions", stdin=trace).returncode == 1
