"""Monitors in each language are proved; a fault in one is refuted, refused, or of no effect."""

import random
import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from tempfile import mkdtemp

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import ClaimResult
from compiler.targets.python.monitor import text
from fretc.verification.compiled.readings import PythonApproximation
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.compiled.verifying import explored, verified
from fretc.verification.engines.sandbox import CallLimits
from monitors.kernel.verdicts import Truth
from monitors.loading import load
from tests import meaning
from tests.c_monitors import of_python
from tests.compiled_edits import EDITS, Edit, Edits
from tests.compiled_monitors import (
    FOR,
    KINDS,
    REFUSED,
    REFUTED,
    RING,
    SAME,
    SENTENCES,
    TONGUES,
    WITHIN,
    Checker,
    Tongue,
    edited,
)
from tests.each import each
from tests.effort import FULL, full_only, some
from tests.monitoring import requirement
from tests.programs import installed
from tests.strategies import templates

LIMITS = CallLimits(seconds=20)


@pytest.fixture(params=TONGUES)
def tongue(request: pytest.FixtureRequest) -> Tongue:
    found = TONGUES[request.param]
    installed(found.program)
    return found


@pytest.fixture
def checker(tongue: Tongue, tmp_path: Path) -> Checker:
    return Checker(tongue.language, tmp_path)


# What is right --------------------------------------------------------------------------------


@pytest.mark.slow
def test_each_requirement_of_one_text_is_proved(tongue: Tongue, checker: Checker) -> None:
    """By default all of them in C; with the full profile also those of drawn templates."""
    drawn = random.Random(tongue.name).sample([*templates((0, 3))], 12 if FULL else 0)
    own = SENTENCES if tongue.name == "c" else some(SENTENCES, 3)
    sentences = (*own, *(each.sentence for each in drawn))
    requirements = [requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences)]
    outcomes = checker.outcomes(tongue.given(*requirements), requirements)
    for one, outcome in zip(requirements, outcomes, strict=True):
        assert outcome.result is ClaimResult.PROVED, one.sentence


@pytest.mark.slow
@pytest.mark.parametrize("tongue", some(TONGUES, 3), indirect=True)
def test_a_long_bound_is_proved_as_it_is(tongue: Tongue, checker: Checker) -> None:
    bound = 1000 if FULL else 300
    one = requirement(f"whenever p the sw shall within {bound} ticks satisfy q")
    outcome = checker.outcome(tongue.given(one), one)
    assert outcome.result is ClaimResult.PROVED
    assert f"{bound + 2} states" in outcome.detail


@full_only("minutes")
@each("scope", meaning.SCOPES)
def test_every_template_is_proved(scope: str, tongue: Tongue, checker: Checker) -> None:
    sentences = [each.sentence for each in templates((0, 1, 2, 3)) if each.scope == scope]
    requirements = [requirement(sentence, f"R{i}") for i, sentence in enumerate(sentences)]
    for one, outcome in zip(
        requirements, checker.outcomes(tongue.given(*requirements), requirements), strict=True
    ):
        assert outcome.result is ClaimResult.PROVED, one.sentence


@pytest.mark.slow
@pytest.mark.confined
@pytest.mark.parametrize("tongue", some(TONGUES, 3), indirect=True)
def test_what_takes_too_long_is_not_proved(tongue: Tongue, monkeypatch: pytest.MonkeyPatch) -> None:
    """A CPU second; by default less on the wall clock, which ends it as well."""
    if not FULL:
        monkeypatch.setattr(CallLimits, "wall", 0.5)
    one = requirement("whenever p the sw shall within 100000 ticks satisfy q")
    program = tongue.language.tool()
    assert program is not None
    monitor = tongue.given(one)
    (found,) = verified([one], monitor, tongue.language, program, CallLimits(seconds=1))
    assert found.outcome.result is ClaimResult.NOT_CHECKED
    assert found.outcome.detail.startswith("out of time")


@pytest.mark.slow
@pytest.mark.parametrize("tongue", some(TONGUES, 3), indirect=True)
def test_too_many_states_are_not_proved(tongue: Tongue, checker: Checker) -> None:
    one = requirement("whenever p the sw shall within 100 ticks satisfy q")
    checked, executable = checker.prepared(tongue.given(one), one)
    outcome = explored(one, executable, checked.plan(one), 150)
    assert outcome.result is ClaimResult.NOT_CHECKED


@pytest.mark.slow
def test_comments_and_layout_are_free(tongue: Tongue, checker: Checker) -> None:
    one = requirement(WITHIN)
    monitor = tongue.given(one)
    text = re.sub(*tongue.comments, monitor.text).replace("    ", "\t")
    assert text != monitor.text
    loose = replace(monitor, text=text)
    if FULL or tongue.name not in ("rust", "java"):  # they take longest to compile
        assert checker.outcome(loose, one).result is ClaimResult.PROVED
    else:
        assert tongue.language.checked(loose, [one]).is_original


@pytest.mark.slow
@pytest.mark.parametrize("tongue", some(TONGUES, 3, 1), indirect=True)
def test_what_is_made_of_a_text_is_the_same_each_time(tongue: Tongue, tmp_path: Path) -> None:
    one = requirement(WITHIN)
    monitor, program = tongue.given(one), tongue.language.tool()
    assert program is not None
    checked = tongue.language.checked(monitor, [one])
    first, second = (
        tongue.language.prepared(program, monitor, checked, tmp_path) for _ in range(2)
    )
    assert (first.artefacts, first.engine) == (second.artefacts, second.engine)


@pytest.mark.slow
@each("sentence", SENTENCES)
def test_the_reference_tells_what_the_monitor_in_python_tells(sentence: str) -> None:
    """Saved and loaded at each tick, on both approximations."""
    one = requirement(sentence)
    choose = random.Random(sentence)
    machine, reference = load("r1", text(one)), load("r1", text(one))
    atoms = (*machine.PROPOSITIONS,)
    rows: list[tuple[Truth, ...]] = [
        tuple(choose.choice([False, True, True, None]) for _ in atoms) for _ in range(60)
    ]
    approximations = [
        PythonApproximation(reference, one, atoms, is_possible=is_possible)
        for is_possible in (False, True)
    ]
    states = [approximation.save() for approximation in approximations]
    for row, (outcome,) in zip(rows, of_python(machine, rows), strict=True):
        for i, expected in enumerate((outcome.certain, outcome.possible)):
            assert approximations[i].step(states[i], row)[:-1] == tuple(expected)
            states[i] = approximations[i].save()


# What is wrong --------------------------------------------------------------------------------


@pytest.fixture
def edits(tongue: Tongue) -> Edits:
    return EDITS[tongue.name]


@pytest.mark.slow
def test_a_fault_comes_to_what_is_written_beside_it(
    tongue: Tongue, checker: Checker, edits: Edits
) -> None:
    """By default most in C: what is made of the text is explored alike in each language."""
    faults = some(edits.faults, {"c": 2, "java": 6}.get(tongue.name, 4))
    for sentence, old, new, expected in faults:
        one = requirement(sentence)
        assert checker.kind(edited(tongue.given(one), old, new), one) == expected, (old, new)


@pytest.mark.slow
def test_what_may_do_more_is_not_run(tongue: Tongue, edits: Edits) -> None:
    one = requirement(WITHIN)
    assert [each for each in edits.further if is_formed(tongue, one, each)] == []


@pytest.mark.slow
def test_what_keeps_a_number_of_ticks_is_as_fretc_writes_it(tongue: Tongue, edits: Edits) -> None:
    one = requirement(edits.keeping)
    tongue.language.checked(tongue.given(one), [one])
    assert [each for each in edits.kept if is_formed(tongue, one, each)] == []


def is_formed(tongue: Tongue, one: FormalizedRequirement, edit: Edit) -> bool:
    """Whether the changed text has a form that is compiled or run."""
    monitor = edited(tongue.given(one), *edit)
    try:
        tongue.language.checked(monitor, [one])
    except UnexpectedLayoutError:
        return False
    return True


@pytest.mark.slow
def test_what_is_no_text_of_the_language_is_not_proved(
    tongue: Tongue, checker: Checker, edits: Edits
) -> None:
    one, edit = requirement(WITHIN), (edits.since, edits.uncompiled)
    assert is_formed(tongue, one, edit)
    assert checker.kind(edited(tongue.given(one), *edit), one) == REFUSED


def test_a_monitor_of_other_requirements_is_refused(tongue: Tongue) -> None:
    one, other = requirement(WITHIN), requirement(FOR, "R2")
    for requirements, reason in (((), "R2"), ((other,), "other requirements")):
        with pytest.raises(UnexpectedLayoutError, match=reason):
            tongue.language.checked(tongue.given(other), (one, *requirements)).plan(one)


def test_what_a_requirement_does_not_speak_of_has_no_part_in_it(
    tongue: Tongue, edits: Edits
) -> None:
    one, other = (
        requirement(WITHIN),
        requirement("whenever r the sw shall immediately satisfy s", "R2"),
    )
    monitor, requirements = tongue.given(one, other), [one, other]
    for each_ in requirements:
        tongue.language.checked(monitor, requirements).plan(each_)
    checked = tongue.language.checked(edited(monitor, edits.since, edits.foreign), requirements)
    checked.plan(other)
    with pytest.raises(
        UnexpectedLayoutError, match="R1 depends on names that its sentence does not mention"
    ):
        checked.plan(one)


@pytest.mark.slow
@pytest.mark.parametrize("tongue", some(TONGUES, 3), indirect=True)
def test_drawn_faults_are_refuted_or_refused(tongue: Tongue, checker: Checker) -> None:
    """A few of those below, in this process: what crashes a library is not among them."""
    one = requirement(WITHIN)
    monitor = tongue.given(one)
    texts = [*dict.fromkeys(tongue.faults(monitor.text))]
    drawn = random.Random(tongue.name).sample(texts, 6)
    kinds = [checker.kind(replace(monitor, text=wrong), one) for wrong in drawn]
    assert kinds.count(REFUTED) >= 1
    assert kinds.count(SAME) <= 2


@full_only("minutes")
@each("sentence", [WITHIN, FOR, RING])
def test_faults_are_refuted_or_refused_or_of_no_effect(
    sentence: str, tongue: Tongue, tmp_path: Path
) -> None:
    """What is proved tells the same as the monitor in Python on traces, run by another program."""
    one, choose = requirement(sentence), random.Random(sentence)
    monitor, found = tongue.given(one), Counter[str]()
    texts = [*dict.fromkeys(tongue.faults(monitor.text))]
    drawn = choose.sample(texts, min(40, len(texts)))
    program = tongue.language.tool()
    assert program is not None
    for wrong in drawn:
        faulty = replace(monitor, text=wrong)
        (examined,) = verified([one], faulty, tongue.language, program, LIMITS)
        kind = KINDS[examined.outcome.result]
        found[kind] += 1
        if kind == SAME:
            folder = Path(mkdtemp(dir=tmp_path))
            machine = load("r1", text(one))
            rows = [[choose.choice([False, True, None]) for _ in "mpq"] for _ in range(2000)]
            assert tongue.told(folder, faulty, one, rows) == [*of_python(machine, rows)], wrong
    print(tongue.name, sentence, found)
    assert found[REFUTED] >= 8, found
    assert found[SAME] <= 15, found
