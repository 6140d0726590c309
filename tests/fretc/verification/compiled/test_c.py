# ruff: noqa: E501
"""Compiled monitors in C are proved; what is wrong, or may hide something, is never proved."""

import os
import random
import re
import shutil
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from compiler.formalization.formalized import Formalized
from compiler.logic.claims import Result
from compiler.targets.python.monitor import text
from fretc.verification.c import language as c
from fretc.verification.c.build import compiler
from fretc.verification.compiled.plan import Given
from fretc.verification.compiled.readings import PythonRail
from fretc.verification.compiled.text import StrangeTextError
from fretc.verification.compiled.tools import ToolError
from fretc.verification.compiled.verifying import explored, verified
from fretc.verification.engines.sandbox import Limits
from monitors.kernel.verdicts import Truth
from monitors.loading import load
from tests import meaning
from tests.c_monitors import Source, compiled, of_python
from tests.compiled_monitors import (
    FOR,
    KINDS,
    REFUSED,
    REFUTED,
    RING,
    SAME,
    SENTENCES,
    WITHIN,
    Checker,
    edited,
)
from tests.each import each
from tests.monitoring import rule
from tests.strategies import templates

CC = compiler() or ""
LIMITS = Limits(seconds=20)
pytestmark = pytest.mark.skipif(not CC, reason="no C compiler is installed")
needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
FULL = os.environ.get("HYPOTHESIS_PROFILE") == "full"


def given(*rules: Formalized) -> Given:
    """What `--emit c` writes for them."""
    source = Source.of(*rules)
    header = source.source.removesuffix(".c") + ".h"
    return Given(source.source, source.texts[source.source], header, source.texts[header])


@pytest.fixture
def checker(tmp_path: Path) -> Checker:
    return Checker(c, tmp_path)


# What is right --------------------------------------------------------------------------------


def test_each_requirement_of_one_text_is_proved(checker: Checker) -> None:
    rules = [rule(sentence, f"R{i}") for i, sentence in enumerate(SENTENCES)]
    for one, outcome in zip(rules, checker.outcomes(given(*rules), rules), strict=True):
        assert outcome.result is Result.PROVED, one.sentence


@pytest.mark.slow
@each("scope", meaning.SCOPES)
def test_every_template_is_proved(scope: str, checker: Checker) -> None:
    bounds = (0, 1, 2, 3) if FULL else (0, 3)
    sentences = [each.sentence for each in templates(bounds) if each.scope == scope]
    rules = [rule(sentence, f"R{i}") for i, sentence in enumerate(sentences)]
    for one, outcome in zip(rules, checker.outcomes(given(*rules), rules), strict=True):
        assert outcome.result is Result.PROVED, one.sentence


@pytest.mark.slow
def test_a_long_bound_is_proved_as_it_is(checker: Checker) -> None:
    one = rule("whenever p the sw shall within 1000 ticks satisfy q")
    outcome = checker.outcome(given(one), one)
    assert outcome.result is Result.PROVED
    assert "1002 states" in outcome.detail


@pytest.mark.slow
def test_what_takes_too_long_is_not_proved() -> None:
    one = rule("whenever p the sw shall within 100000 ticks satisfy q")
    (found,) = verified([one], given(one), c, CC, Limits(seconds=2))
    assert found.outcome.result is Result.NOT_CHECKED
    assert found.outcome.detail.startswith("out of time")


def test_too_many_states_are_not_proved(checker: Checker) -> None:
    one = rule("whenever p the sw shall within 100 ticks satisfy q")
    found = checker.prepared(given(one), one)
    outcome = explored(one, found.executable, found.checked.plan(one), 150)
    assert outcome.result is Result.NOT_CHECKED


def test_comments_and_layout_are_free(checker: Checker) -> None:
    one = rule(WITHIN)
    monitor = given(one)
    loose = re.sub(r"/\*.*?\*/", "/* mine\n */", monitor.text).replace("    ", "\t")
    assert checker.outcome(replace(monitor, text=loose), one).result is Result.PROVED


@each("sentence", SENTENCES)
def test_the_reference_tells_what_the_monitor_in_python_tells(sentence: str) -> None:
    """Saved and loaded at each tick, on both rails."""
    one = rule(sentence)
    choose = random.Random(sentence)
    machine, reference = load("r1", text(one)), load("r1", text(one))
    atoms = (*machine.PROPOSITIONS,)
    rows: list[tuple[Truth, ...]] = [
        tuple(choose.choice([False, True, True, None]) for _ in atoms) for _ in range(60)
    ]
    rails = [PythonRail(reference, one, atoms, doubt=doubt) for doubt in (False, True)]
    states = [rail.save() for rail in rails]
    for row, (outcome,) in zip(rows, of_python(machine, rows), strict=True):
        for i, expected in enumerate((outcome.certain, outcome.possible)):
            assert rails[i].step(states[i], row)[:-1] == tuple(expected)
            states[i] = rails[i].save()


# What is wrong --------------------------------------------------------------------------------

FAULTS = (
    (WITHIN, "rail->oldest_1 >= 3", "rail->oldest_1 >= 2", REFUTED),
    (WITHIN, "rail->oldest_1 >= 3", "rail->oldest_1 > 2", SAME),
    (WITHIN, "reading->trigger = now->is_m & now->is_p;", "reading->trigger = now->is_p;", REFUTED),
    (WITHIN, "reading->open = since_2;", "reading->open = since_1;", REFUTED),
    (WITHIN, "reading->open = since_2;", "", REFUTED),
    (WITHIN, "    rail->oldest_1 = -1;\n    rail->r1_broken", "    rail->oldest_1 = 0;\n    rail->r1_broken", REFUTED),
    (WITHIN, "reading->answer = now->is_m & now->is_q;", "reading->answer = now->is_q;", REFUTED),
    (WITHIN, "(3 - rail->oldest_1)", "(4 - rail->oldest_1)", REFUTED),
    (WITHIN, "reading->left = (since_2 & (rail", "reading->left = (since_1 & (rail", REFUTED),
    (FOR, "reading->settled = false;", "reading->settled = since_1;", REFUTED),
    (WITHIN, "reading->open = since_2;", "reading->open = &since_2 > &since_1;", REFUSED),
    (WITHIN, "reading->open = since_2;", "reading->open = since_1 | & rail->oldest_1;", REFUSED),
    (WITHIN, "now.is_q = inputs->q != FRETC_FALSE;", "now.is_q = inputs->q == FRETC_TRUE;", REFUSED),
    (WITHIN, "outcome->verdict = FRETC_PENDING;", "outcome->verdict = FRETC_SATISFIED;", REFUSED),
)  # fmt: skip


@each("fault", FAULTS)
def test_a_fault_comes_to_what_is_written_beside_it(
    fault: tuple[str, str, str, str], checker: Checker
) -> None:
    sentence, old, new, expected = fault
    one = rule(sentence)
    assert checker.kind(edited(given(one), old, new), one) == expected


_EDITS = (
    (r" & ", " | "), (r" \| ", " & "), (r">=", ">"), (r"<=", "<"), (r"(?<= )< ", "<= "),
    (r"\bis_", "not_"), (r"\bnot_", "is_"), (r"true", "false"), (r"false", "true"),
    (r"(?<= )0;", "1;"), (r"-1;", "0;"), (r"(?<= )[1-9]\d*(?=\)|;|\))", "9"), (r"\+ 1", "+ 2"),
    (r"!= FRETC", "== FRETC"), (r"since_1", "since_2"), (r"since_2", "since_1"),
    (r"(?m)^    +(rail|reading)->\w+ = .*;$", ";"), (r"\.certain;", ".possible;"),
)  # fmt: skip


def faults(text: str) -> Iterator[str]:
    """The text with each edit at each place, one at a time."""
    for old, new in _EDITS:
        for match in re.finditer(old, text[text.index("_clear(") :]):
            start = text.index("_clear(") + match.start()
            yield text[:start] + new + text[start + len(match[0]) :]


@needs_gcc
@pytest.mark.slow
@pytest.mark.skipif(not FULL, reason="minutes: HYPOTHESIS_PROFILE=full")
@each("sentence", [WITHIN, FOR, RING])
def test_faults_are_refuted_or_refused_or_of_no_effect(sentence: str, tmp_path: Path) -> None:
    """What is proved tells the same as the monitor in Python on traces, run by another program."""
    one, choose = rule(sentence), random.Random(sentence)
    monitor, source, found = given(one), Source.of(one), Counter[str]()
    drawn = choose.sample([*dict.fromkeys(faults(monitor.text))], 40)
    for wrong in drawn:
        (examined,) = verified([one], replace(monitor, text=wrong), c, CC, LIMITS)
        kind = KINDS[examined.outcome.result]
        found[kind] += 1
        if kind == SAME:
            folder = tmp_path / str(found[SAME])
            folder.mkdir(exist_ok=True)
            texts = {**source.texts, source.source: wrong}
            program = compiled(folder, "gcc", replace(source, texts=texts), flags=["-std=c99"])
            machine = load("r1", text(one))
            rows = [[choose.choice([False, True, None]) for _ in "mpq"] for _ in range(2000)]
            _, (outcomes,) = program.run((0, rows))
            assert outcomes == [*of_python(machine, rows)], wrong
    print(sentence, found)
    assert found[REFUTED] >= 8, found
    assert found[SAME] <= 8, found


# What is refused before it runs ---------------------------------------------------------------

BEGIN = "    fretc_reading *reading;\n"
SINCE = "const bool since_1 = rail->oldest_1 >= 3;"


@each(
    "edit",
    [
        (BEGIN, f'{BEGIN}    system("true");\n'),
        (BEGIN, f"{BEGIN}    static int n;\n"),
        (BEGIN, f"{BEGIN}    r1_init(0);\n"),
        (BEGIN, f"{BEGIN}    for (;;) {{ }}\n"),
        (BEGIN, f"{BEGIN}    while (true) {{ }}\n"),
        (BEGIN, f"{BEGIN}    rail = rail + 1;\n"),
        (BEGIN, f"{BEGIN}    rail[1].oldest_1 = 0;\n"),
        (BEGIN, f"{BEGIN}    *rail = *rail;\n"),
        (BEGIN, f"{BEGIN}    goto end; end:\n"),
        (BEGIN, f"{BEGIN}    return;\n"),
        (BEGIN, f"{BEGIN}    /* \\\n"),
        (BEGIN, f"{BEGIN}    // \n"),
        (BEGIN, f"{BEGIN}#include <stdlib.h>\n"),
        (BEGIN, f"{BEGIN}    const bool n = rail->oldest_1 <: 1 :> ;\n"),
        (BEGIN, f"{BEGIN}    const bool \u00e9 = true;\n"),
        (SINCE, "const bool since_1 = possible;"),
        (SINCE, "const bool since_1 = since_2;"),
        (SINCE, "const bool since_1 = (rail->oldest_1 = 3);"),
        (SINCE, "const bool since_1 = (rail->oldest_1++ >= 3);"),
        (SINCE, "const bool since_1 = (abort(), true);"),
        (SINCE, "const bool since_1 = sizeof(rail) > 4;"),
        (SINCE, "const bool since_1 = rail > now;"),
        (SINCE, "bool since_1 = rail->oldest_1 >= 3;"),
        (SINCE, "const bool since_1 = rail->oldest_1 >= 3"),
        ("r1_clear(&state->possible);", ""),
        ("r1_judge(&outcomes->r1);", ""),
        ("bool is_m;", "int is_m;"),
        ("rail->oldest_1 = -1;\n    rail->r1_broken", "rail->oldest_1 = rail->r1_broken;\n    rail->r1_broken"),
    ],
)  # fmt: skip
def test_what_may_reach_further_is_refused(edit: tuple[str, str]) -> None:
    one = rule(WITHIN)
    with pytest.raises(StrangeTextError):
        c.checked(edited(given(one), *edit), [one])


def test_a_ring_is_as_fretc_writes_it() -> None:
    one = rule("whenever p the sw shall immediately satisfy occurred(33, 35, q)")
    monitor = given(one)
    c.checked(monitor, [one])
    for old, new in (
        ("/ 32u]", "/ 31u]"),
        ("[word] = 0u", "[word] = 1u"),
        ("word < 2u", "word < 3u"),
        ("reading->settled = false;", "reading->settled = rail->ring_since_1 > 0;"),
    ):
        with pytest.raises(StrangeTextError):
            c.checked(edited(monitor, old, new), [one])


@each(
    "edit", [("int32_t left;", "int64_t left;"), ("#endif\n\n/* The", "/* The"), ("uint8_t", "int")]
)
def test_a_header_of_another_form_is_refused(edit: tuple[str, str]) -> None:
    one = rule(WITHIN)
    monitor = given(one)
    assert edit[0] in monitor.header
    with pytest.raises(StrangeTextError):
        c.checked(replace(monitor, header=monitor.header.replace(*edit)), [one])


def test_a_monitor_of_other_requirements_is_refused() -> None:
    one, other = rule(WITHIN), rule(FOR, "R2")
    for rules, reason in (((), "R2"), ((other,), "other requirements")):
        with pytest.raises(StrangeTextError, match=reason):
            c.checked(given(other), (one, *rules)).plan(one)


def test_what_does_not_compile_is_refused(checker: Checker) -> None:
    one = rule(WITHIN)
    with pytest.raises(ToolError, match="does not compile it"):
        checker.prepared(edited(given(one), SINCE, "const bool since_1 = 3 3;"), one)


@pytest.mark.slow
def test_undefined_behaviour_ends_the_process_and_proves_nothing() -> None:
    """A `bool` that is never set is read."""
    one = rule(WITHIN)
    wrong = edited(given(one), "    rail->r1_broken = false;\n", "")
    ((_, outcome, _, _),) = verified([one], wrong, c, CC, LIMITS)
    assert outcome.result is Result.NOT_CHECKED
    assert "crashed" in outcome.detail


def test_a_binary_is_the_same_each_time(checker: Checker) -> None:
    one = rule(WITHIN)
    first, second = (checker.prepared(given(one), one) for _ in range(2))
    assert (first.artefacts, first.engine) == (second.artefacts, second.engine)
