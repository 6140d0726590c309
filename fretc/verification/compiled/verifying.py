"""Prove that a monitor in another language than Python satisfies its sentence.

The layout of the text guarantees that a step depends only on its cells and inputs. The monitor is
compiled or run, and explored in two comparisons, each until no new pair of states appears: with the
counter automaton of the sentence (both verdicts, known values); and, for each approximation, with
the monitor in Python (all values of a reading, also with unknown inputs).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import NamedTuple

from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import impossible_combinations
from compiler.formalization.numbers.reals import MOST_SEARCHED, with_numeric_counterexample
from compiler.logic.claims import ClaimOutcome, ClaimTrace, not_checked, proved, refuted
from compiler.logic.orders import Exclusion, only_possible
from compiler.targets.python import monitor as python
from fretc.verification.compiled.delays import FreeLetter, PythonDelayed
from fretc.verification.compiled.plan import (
    Executable,
    Language,
    Machines,
    ParsedSource,
    RequirementPosition,
    SourceText,
    atoms,
)
from fretc.verification.compiled.readings import NAMES, PythonApproximation, PythonJudging
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.compiled.tools import ToolError
from fretc.verification.engines.sandbox import CallLimits, NoResult, SandboxSession
from fretc.verification.monitor import approximations
from fretc.verification.monitor.equivalence import DifferingTrace
from fretc.verification.monitor.verifying import MOST_STATES, judged_wrongly, lock_step, noted
from monitors.loading import load


class RequirementOutcome(NamedTuple):
    """An outcome, with its inputs."""

    requirement: FormalizedRequirement
    outcome: ClaimOutcome
    engine: str
    """Compiler or interpreter, with version and flags; empty if there was none."""
    artefacts: dict[str, str]
    """SHA-256 of the texts and of the generated files."""


def verified(
    requirements: Sequence[FormalizedRequirement],
    given: SourceText,
    language: Language,
    program: str,
    limits: CallLimits,
    others: Sequence[FormalizedRequirement] = (),
) -> Iterator[RequirementOutcome]:
    """Compare a monitor with each of its requirements, in separate processes.

    Args:
        requirements: the requirements to prove; the target accepts them, and they have a clock.
        given: a monitor of them, and perhaps of others.
        language: language of the text.
        program: path of its tool.
        limits: limits of each exploration.
        others: further requirements that the text may implement.
    """
    artefacts = {name: sha256(text) for name, text in given.texts.items()}
    with TemporaryDirectory(prefix="fretc-") as folder, SandboxSession(limits) as session:
        try:
            checked = language.checked(given, (*requirements, *others))
            found = language.prepared(program, given, checked, Path(folder))
        except (UnexpectedLayoutError, ToolError) as error:
            for requirement in requirements:
                yield RequirementOutcome(requirement, not_checked(str(error)), "", artefacts)
            return
        artefacts.update(found.artefacts)
        for requirement in requirements:
            outcome = _confined(requirement, checked, found.executable, session)
            yield RequirementOutcome(requirement, outcome, found.engine, artefacts)


def _confined(
    requirement: FormalizedRequirement,
    checked: ParsedSource,
    executable: Executable,
    session: SandboxSession,
) -> ClaimOutcome:
    try:
        plan = checked.plan(requirement)
    except UnexpectedLayoutError as error:
        return not_checked(str(error))
    outcome = session.call(explored, requirement, executable, plan, MOST_STATES)
    if isinstance(outcome, NoResult):
        return not_checked(f"{outcome.reason}; the text may contain code that does not terminate")
    return outcome


# In the process that runs it --------------------------------------------------------------------


def explored(
    requirement: FormalizedRequirement,
    executable: Executable,
    plan: RequirementPosition,
    limit: int,
) -> ClaimOutcome:
    """Run and compare the monitor in this process, which a crash of the library ends.

    Args:
        requirement: the requirement.
        executable: the monitor.
        plan: position of the requirement in it.
        limit: maximum number of states of either comparison.
    """
    try:
        with executable.running(plan) as machines:
            return _explored(requirement, machines, limit)
    except ToolError as error:
        return not_checked(str(error))


def _explored(requirement: FormalizedRequirement, machines: Machines, limit: int) -> ClaimOutcome:
    free = _without_delays(requirement, machines, limit)
    if free is not None:
        return free
    judged = lock_step(requirement, machines.judging(), atoms(requirement), limit)
    if isinstance(judged, str):
        return not_checked(judged)
    if isinstance(judged, DifferingTrace):
        return judged_wrongly(judged, atoms(requirement))
    states = _read(requirement, machines, limit)
    if not isinstance(states, int):
        return states
    return proved(
        f"the same at every tick of every trace ({judged.states} states, {judged.steps} steps); "
        "also with unknown values, its triggers, responses, open obligations, deadlines and "
        f"final verdicts are those of the monitor in Python ({states} states)"
    )


def _without_delays(
    requirement: FormalizedRequirement, machines: Machines, limit: int
) -> ClaimOutcome | None:
    """Proved if both monitors are equal for arbitrary bits in their delay lines.

    Then each verdict of the text is that of the monitor in Python, because both derive it from both
    approximations; so the monitor in Python is compared with the automaton of the sentence. Not
    checked if that comparison is too large. None: unknown, so that all states must be compared.
    """
    names, monitor, states = atoms(requirement), load("reference", python.text(requirement)), 0
    if len(names) > approximations.MOST_PROPOSITIONS:
        return None
    for is_possible in (False, True):
        left, right = (
            machines.delayed(is_possible=is_possible),
            PythonApproximation(monitor, requirement, names, is_possible=is_possible),
        )
        windows = right.windows()
        if left is None or [line.length for line in left.lines] != [
            window.lo for window in windows
        ]:
            return None
        letters = [
            FreeLetter(values, oldest)
            for values in _letters(requirement, names)
            for oldest in product((False, True), repeat=len(windows))
        ]
        further = tuple(f"delay line {index}" for index in range(len(windows)))
        free = PythonDelayed(right, left.lines)
        result = approximations.in_lock_step(left, free, letters, limit, (*NAMES, *further))
        if not isinstance(result, approximations.Equivalent):
            return None
        states += result.states
        ticks = _PERIODS * max(line.length for line in left.lines)
        if not _agree(
            requirement, machines, _letters(requirement, names), ticks, is_possible=is_possible
        ):
            return None
    judged = lock_step(requirement, PythonJudging(monitor, names), names, limit)
    if isinstance(judged, str):
        return not_checked(judged)
    if isinstance(judged, DifferingTrace):
        return None
    return proved(
        "at every tick of every trace, also with unknown values, its results are those of the "
        f"monitor in Python ({states} states, for all contents of its delay lines), whose "
        f"verdicts are those of the sentence ({judged.states} states, {judged.steps} steps)"
    )


_PERIODS = 4
"""Number of cycles of a delay line in a random run; the exploration covers index 0 only."""


def _agree(
    requirement: FormalizedRequirement,
    machines: Machines,
    letters: Sequence[approximations.Letter],
    ticks: int,
    *,
    is_possible: bool,
) -> bool:
    """Whether both monitors, with all their bits, agree on a random run."""
    monitor, draw = load("reference", python.text(requirement)), Random(0)
    left = machines.approximation(letters, is_possible=is_possible)
    right = PythonApproximation(monitor, requirement, atoms(requirement), is_possible=is_possible)
    first, second = left.save(), right.save()
    for _ in range(ticks):
        letter = draw.choice(letters)
        if left.step(first, letter) != right.step(second, letter):
            return False
        first, second = left.save(), right.save()
    return True


def _letters(
    requirement: FormalizedRequirement, names: Sequence[str]
) -> Sequence[approximations.Letter]:
    """Possible values of a tick, including unknown ones."""
    every = tuple(product((False, True, None), repeat=len(names)))
    return only_possible(every, names, impossible_combinations(requirement))


def _read(requirement: FormalizedRequirement, machines: Machines, limit: int) -> int | ClaimOutcome:
    """Number of states whose readings equal those of the monitor in Python, or the failure."""
    names = atoms(requirement)
    if len(names) > approximations.MOST_PROPOSITIONS:
        most = approximations.MOST_PROPOSITIONS
        return not_checked(
            f"{len(names)} propositions, more than {most}, are too many to check unknown values"
        )
    every = _letters(requirement, names)
    monitor, states = load("reference", python.text(requirement)), 0

    def compare(
        more: Sequence[Exclusion], *, is_possible: bool
    ) -> approximations.Equivalent | approximations.Distinguished | None:
        letters = only_possible(every, names, more)
        left = machines.approximation(letters, is_possible=is_possible)
        right = PythonApproximation(monitor, requirement, names, is_possible=is_possible)
        most = min(limit, MOST_SEARCHED) if more else limit
        return approximations.in_lock_step(left, right, letters, most, NAMES)

    for is_possible in (False, True):
        result, note = with_numeric_counterexample(
            requirement,
            names,
            approximations.Distinguished,
            partial(compare, is_possible=is_possible),
        )
        match result:
            case None:
                return not_checked(f"with unknown values there are more than {limit} states")
            case approximations.Distinguished(word, signal):
                which = "possible" if is_possible else "certain"
                fault = f"the monitor in Python has another {signal} in `{which}` on a trace"
                return refuted(f"{fault}{noted(note)}", ClaimTrace(names, word))
            case approximations.Equivalent(count):
                states += count
    return states
