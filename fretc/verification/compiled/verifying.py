"""Prove that a monitor in another language than Python means what its sentence means.

Its text has the form that fretc writes, so that a step depends on nothing but its cells and inputs.
It is compiled or run, and explored in two comparisons, each until no new pair of states appears:
with the counter automaton of the sentence by both verdicts, for known values; and, rail by rail,
with the monitor in Python by all that a reading has, with unknown values too.
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
from compiler.formalization.letters import excluded
from compiler.formalization.numbers.reals import MOST_SEARCHED, by_numbers
from compiler.logic.claims import Outcome, Trace, not_checked, proved, refuted
from compiler.logic.orders import Exclusion, only_possible
from compiler.targets.python import monitor as python
from fretc.verification.compiled.delays import FreeLetter, PythonDelayed
from fretc.verification.compiled.plan import (
    Executable,
    Language,
    Machines,
    ParsedSource,
    Plan,
    SourceText,
    atoms,
)
from fretc.verification.compiled.readings import NAMES, PythonJudging, PythonRail
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.compiled.tools import ToolError
from fretc.verification.engines.sandbox import Limits, Session, Stopped
from fretc.verification.monitor import rails
from fretc.verification.monitor.equivalence import Difference
from fretc.verification.monitor.verifying import MOST_STATES, judged_wrongly, lock_step, noted
from monitors.loading import load


class RequirementOutcome(NamedTuple):
    """An outcome, with what it rests on."""

    requirement: FormalizedRequirement
    outcome: Outcome
    engine: str
    """What compiled or ran the text, with version and flags; empty where nothing did."""
    artefacts: dict[str, str]
    """SHA-256 of the texts and of what was made of them."""


def verified(
    requirements: Sequence[FormalizedRequirement],
    given: SourceText,
    language: Language,
    program: str,
    limits: Limits,
    others: Sequence[FormalizedRequirement] = (),
) -> Iterator[RequirementOutcome]:
    """Compare a text with each of its requirements, in processes of their own.

    Args:
        requirements: those that are asked about; the target accepts them, and they have a clock.
        given: a monitor of them, maybe with others.
        language: of the text.
        program: its tool.
        limits: of each exploration.
        others: further requirements that the text may implement.
    """
    artefacts = {name: sha256(text) for name, text in given.texts.items()}
    with TemporaryDirectory(prefix="fretc-") as folder, Session(limits) as session:
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
    session: Session,
) -> Outcome:
    try:
        plan = checked.plan(requirement)
    except UnexpectedLayoutError as error:
        return not_checked(str(error))
    outcome = session.call(explored, requirement, executable, plan, MOST_STATES)
    if isinstance(outcome, Stopped):
        return not_checked(f"{outcome.reason}; the text may contain code that does not terminate")
    return outcome


# In the process that runs it --------------------------------------------------------------------


def explored(
    requirement: FormalizedRequirement, executable: Executable, plan: Plan, limit: int
) -> Outcome:
    """Run the text, and compare it; a crash of a library is one of this process.

    Args:
        requirement: the requirement.
        executable: the text.
        plan: where the requirement is in it.
        limit: the most states of either comparison.
    """
    try:
        with executable.running(plan) as machines:
            return _explored(requirement, machines, limit)
    except ToolError as error:
        return not_checked(str(error))


def _explored(requirement: FormalizedRequirement, machines: Machines, limit: int) -> Outcome:
    free = _without_delays(requirement, machines, limit)
    if free is not None:
        return free
    judged = lock_step(requirement, machines.judging(), atoms(requirement), limit)
    if isinstance(judged, str):
        return not_checked(judged)
    if isinstance(judged, Difference):
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
) -> Outcome | None:
    """Proved, if both monitors are the same whatever bits their delay lines give.

    Then each verdict of the text is that of the monitor in Python, for it follows from both rails
    as there; so that monitor is compared with the automaton of the sentence. Not checked, where
    that is too large. None: nothing is known, and all states are to be compared.
    """
    names, monitor, states = atoms(requirement), load("reference", python.text(requirement)), 0
    if len(names) > rails.MOST_PROPOSITIONS:
        return None
    for doubt in (False, True):
        left, right = (
            machines.delayed(doubt=doubt),
            PythonRail(monitor, requirement, names, doubt=doubt),
        )
        windows = right.windows()
        if left is None or [line.length for line in left.lines] != [each.lo for each in windows]:
            return None
        letters = [
            FreeLetter(values, oldest)
            for values in _letters(requirement, names)
            for oldest in product((False, True), repeat=len(windows))
        ]
        further = tuple(f"delay line {place}" for place in range(len(windows)))
        free = PythonDelayed(right, left.lines)
        result = rails.in_lock_step(left, free, letters, limit, (*NAMES, *further))
        if not isinstance(result, rails.Equivalent):
            return None
        states += result.states
        ticks = _PERIODS * max(line.length for line in left.lines)
        if not _agree(requirement, machines, _letters(requirement, names), ticks, doubt=doubt):
            return None
    judged = lock_step(requirement, PythonJudging(monitor, names), names, limit)
    if isinstance(judged, str):
        return not_checked(judged)
    if isinstance(judged, Difference):
        return None
    return proved(
        "at every tick of every trace, also with unknown values, its results are those of the "
        f"monitor in Python ({states} states, for all contents of its delay lines), whose "
        f"verdicts are those of the sentence ({judged.states} states, {judged.steps} steps)"
    )


_PERIODS = 4
"""How often a delay line goes round in a drawn run: its places are explored at 0 only."""


def _agree(
    requirement: FormalizedRequirement,
    machines: Machines,
    letters: Sequence[rails.Letter],
    ticks: int,
    *,
    doubt: bool,
) -> bool:
    """Whether both monitors, with all their bits, give the same on a drawn run."""
    monitor, draw = load("reference", python.text(requirement)), Random(0)
    left = machines.rail(letters, doubt=doubt)
    right = PythonRail(monitor, requirement, atoms(requirement), doubt=doubt)
    first, second = left.save(), right.save()
    for _ in range(ticks):
        letter = draw.choice(letters)
        if left.step(first, letter) != right.step(second, letter):
            return False
        first, second = left.save(), right.save()
    return True


def _letters(requirement: FormalizedRequirement, names: Sequence[str]) -> Sequence[rails.Letter]:
    """The values that may come at a tick, unknown ones among them."""
    every = tuple(product((False, True, None), repeat=len(names)))
    return only_possible(every, names, excluded(requirement))


def _read(requirement: FormalizedRequirement, machines: Machines, limit: int) -> int | Outcome:
    """The states in which each rail tells what that of the monitor in Python tells."""
    names = atoms(requirement)
    if len(names) > rails.MOST_PROPOSITIONS:
        most = rails.MOST_PROPOSITIONS
        return not_checked(
            f"{len(names)} propositions, more than {most}, are too many to check unknown values"
        )
    every = _letters(requirement, names)
    monitor, states = load("reference", python.text(requirement)), 0

    def compare(
        more: Sequence[Exclusion], *, doubt: bool
    ) -> rails.Equivalent | rails.Distinguished | None:
        letters = only_possible(every, names, more)
        left = machines.rail(letters, doubt=doubt)
        right = PythonRail(monitor, requirement, names, doubt=doubt)
        most = min(limit, MOST_SEARCHED) if more else limit
        return rails.in_lock_step(left, right, letters, most, NAMES)

    for doubt in (False, True):
        result, note = by_numbers(
            requirement, names, rails.Distinguished, partial(compare, doubt=doubt)
        )
        match result:
            case None:
                return not_checked(f"with unknown values there are more than {limit} states")
            case rails.Distinguished(word, signal):
                which = "possible" if doubt else "certain"
                fault = f"the monitor in Python has another {signal} in `{which}` on a trace"
                return refuted(f"{fault}{noted(note)}", Trace(names, word))
            case rails.Equivalent(count):
                states += count
    return states
