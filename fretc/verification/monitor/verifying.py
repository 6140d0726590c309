"""Prove that the text of a generated monitor has the meaning of its sentence.

The text is executed, stepped over every valuation and compared with the counter automaton of the
sentence (`fretc.verification.monitor.equivalence`). Its steps must depend only on its cells,
propositions and constants: `fretc.verification.monitor.text_check` checks that on its tree first,
so a step cannot depend on the number of the tick. The automaton defines verdicts for known values
only. The other signals of a monitor (triggers, responses, open obligations, marks; all of them also
with unknown values) are compared with the generated monitor, state by state
(`fretc.verification.monitor.approximations`), and its column program with the generated one, term
by term (`fretc.verification.monitor.columns`); the generated text itself needs neither. The column
program is also compared with the steps on random traces, some with unknown values.
"""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of, impossible_combinations
from compiler.formalization.numbers.reals import MOST_SEARCHED, with_numeric_counterexample
from compiler.logic.claims import ClaimOutcome, ClaimTrace, not_checked, proved, refuted
from compiler.logic.orders import Exclusion
from compiler.targets.python import monitor as target
from compiler.targets.python.names import prefixes_of
from fretc.verification.monitor import approximations, front_terms
from fretc.verification.monitor.columns import Disagreement, TermTable, Word, agreed
from fretc.verification.monitor.equivalence import (
    DifferingTrace,
    Equivalence,
    Judgement,
    Machine,
    compare,
)
from fretc.verification.monitor.machine import Stepped
from fretc.verification.monitor.slices import SlicedMonitor, slice_of
from fretc.verification.monitor.statements import UnexpectedStatementError
from fretc.verification.monitor.text_check import own, strange
from monitors.kernel import Monitor
from monitors.kernel.variables import Variable
from monitors.loading import load
from monitors.source_text import kernel

MOST_STATES = 10**6


class NotAMonitorError(Exception):
    """The text cannot be executed as a generated monitor; the message gives the reason."""


def verified_beside(
    requirement: FormalizedRequirement, text: str, whole: str | None, limit: int = MOST_STATES
) -> ClaimOutcome:
    """Compare the text of a monitor with its requirement.

    Args:
        requirement: a requirement that the target accepts, on its own clock.
        text: text of its monitor, perhaps with monitors of other requirements.
        whole: the generated text for all of them, from `written`, computed once for each text.
        limit: maximum number of states of the exploration.

    Raises:
        NotAMonitorError: the text is not a generated monitor.
    """
    monitor = _opened(text)
    if isinstance(monitor, str):
        return not_checked(monitor)
    return _compared(requirement, text, monitor, limit, whole)


def written(text: str, requirements: Sequence[FormalizedRequirement]) -> str | None:
    """The generated text for the requirements of a text; None if not all of them are known.

    Raises:
        NotAMonitorError: the text is not a generated monitor.
    """
    monitor = _opened(text)
    by_id = {requirement.id: requirement for requirement in requirements}
    if isinstance(monitor, str) or not all(each.id in by_id for each in monitor.REQUIREMENTS):
        return None
    return target.text(*(by_id[each.id] for each in monitor.REQUIREMENTS))


@lru_cache(maxsize=1)
def _opened(text: str) -> Monitor | str:
    """The monitor; or why it is not executed. The result is cached for files of many requirements.

    Raises:
        NotAMonitorError: the text is not a generated monitor.
    """
    _demand_monitor(text)
    reason = strange(text)  # No other statement is executed.
    if reason is not None:
        return reason
    try:
        return load("monitor", text)
    except Exception as error:
        return f"it cannot be executed: {type(error).__name__}: {error}"


def _compared(
    requirement: FormalizedRequirement, text: str, monitor: Monitor, limit: int, whole: str | None
) -> ClaimOutcome:
    """The outcome for a text that is safe to execute."""
    places = [i for i, each in enumerate(monitor.REQUIREMENTS) if each.id == requirement.id]
    if not places:
        return not_checked("the monitor is for other requirements")
    index = places[0]
    atoms = tuple(dict.fromkeys((*atoms_of(requirement.sentence), *monitor.PROPOSITIONS)))
    needed, cells = _needed(requirement, text, monitor, atoms)
    machine = SlicedMonitor(Stepped(monitor, index, atoms, cells), len(atoms) - len(needed))
    result = lock_step(requirement, machine, needed, limit)
    if isinstance(result, str):
        return not_checked(result)
    if isinstance(result, DifferingTrace):
        return judged_wrongly(result, atoms)
    generated = target.text(requirement)
    if text != generated:
        (expected,) = load("generated", generated).REQUIREMENTS
        if tuple(monitor.REQUIREMENTS[index]) != tuple(expected):
            return not_checked(
                "its verdicts are the same, but it states another sentence or deadline"
            )
        fault = _front_compared(requirement, (generated, whole), text, monitor, atoms)
        if fault is not None:
            return fault
    ticks, note = with_numeric_counterexample(
        requirement,
        needed,
        Disagreement,
        lambda more: agreed(requirement, monitor, index, needed, more),
    )
    if isinstance(ticks, Disagreement):
        apart = f"its column program and its steps differ{noted(note)}"
        return _disagreement(atoms, ticks.word, apart)
    if text == generated or (whole is not None and _is_like(whole, text)):
        return _proved(result, ticks)
    states = _compared_with_generated(
        requirement, generated, text, monitor, index, (atoms, len(needed)), limit
    )
    return _proved(result, ticks, states) if isinstance(states, int) else states


def _needed(
    requirement: FormalizedRequirement, text: str, monitor: Monitor, atoms: tuple[str, ...]
) -> tuple[tuple[str, ...], frozenset[str] | None]:
    """Atoms and cells on which a requirement depends; all, if that is not known."""
    own = atoms_of(requirement.sentence)
    prefix = prefixes_of(each.id for each in monitor.REQUIREMENTS)[requirement.id]
    part = slice_of(text, prefix, monitor.PROPOSITIONS)
    return (own, part.cells) if part.propositions <= {*own} else (atoms, None)


def lock_step(
    requirement: FormalizedRequirement, machine: Machine, atoms: Sequence[str], limit: int
) -> Equivalence | DifferingTrace | str:
    """The comparison with the automaton of the sentence, over all valuations of the atoms.

    In case of a difference, over possible valuations only, because an impossible trace shows
    nothing. A trace that is possible for floats but not for real numbers is shown with a note if
    there is no other.
    """
    sentence, ticks = requirement.sentence, requirement.ticks or 0
    start = machine.save()
    result = compare(machine, sentence, ticks, atoms, limit)
    impossible = impossible_combinations(requirement) if isinstance(result, DifferingTrace) else ()

    def compare_without(more: Sequence[Exclusion]) -> Equivalence | DifferingTrace | str:
        if not impossible and not more:
            return result
        machine.load(start)
        most = min(limit, MOST_SEARCHED) if more else limit
        return compare(machine, sentence, ticks, atoms, most, (*impossible, *more))

    found: Equivalence | DifferingTrace | str
    found, note = with_numeric_counterexample(requirement, atoms, DifferingTrace, compare_without)
    return replace(found, note=note) if isinstance(found, DifferingTrace) else found


def _proved(same: Equivalence, ticks: int, states: int = 0) -> ClaimOutcome:
    """The outcome for a monitor that has the meaning of the sentence.

    Args:
        same: comparison with the automaton.
        ticks: ticks of random traces on which the column program agrees with the steps.
        states: states of the comparison with the generated text; 0: it is that text.
    """
    further = ""
    if states:
        further = (
            "; triggers, responses, open obligations and unknown values as in the generated "
            f"monitor ({states} states)"
        )
    return proved(
        f"the same at every tick of every trace ({same.states} states, {same.steps} steps); its "
        f"column program agrees on {ticks} random ticks{further}"
    )


def judged_wrongly(difference: DifferingTrace, atoms: tuple[str, ...]) -> ClaimOutcome:
    """The outcome for a monitor with a wrong verdict on a trace."""
    count = len(difference.word)
    length = f"{count} tick{'' if count == 1 else 's'}"
    kind = "the shortest trace" if difference.shortest else "a trace"
    return refuted(
        f"{kind} that shows it has {length}; after it, {_in_words(difference.actual)}, and should "
        f"be {_in_words(difference.expected)}{noted(difference.note)}",
        _whole(atoms, difference.word),
    )


def noted(note: str) -> str:
    """The note as a suffix of a message, or nothing."""
    return f"; {note}" if note else ""


def _in_words(judgement: Judgement) -> str:
    verdict, finite = judgement
    return f"{verdict} ({'true' if finite else 'false'} if it ended there)"


def _disagreement(
    atoms: Sequence[str],
    word: Word,
    fault: str,
    values: str = "",
) -> ClaimOutcome:
    """The outcome for a monitor with wrong signals at the last tick of a trace.

    Args:
        atoms: the propositions.
        word: their values at each tick.
        fault: description of the fault.
        values: values of the variables at the last tick, if they matter.
    """
    last = f"; at its last tick {values}" if values else ""
    return refuted(f"{fault} on a trace{last}", _whole(atoms, word))


def _whole(atoms: Sequence[str], word: Word) -> ClaimTrace:
    """The trace with the propositions of other requirements, which are false."""
    return ClaimTrace(
        tuple(atoms), tuple((*row, *(False,) * (len(atoms) - len(row))) for row in word)
    )


@lru_cache(maxsize=1)
def _is_like(whole: str, text: str) -> bool:
    """Whether both texts are equal except for comments."""
    return ast.dump(own(whole)) == ast.dump(own(text))


def _front_compared(
    requirement: FormalizedRequirement,
    texts: tuple[str, str | None],
    text: str,
    monitor: Monitor,
    atoms: Sequence[str],
) -> ClaimOutcome | None:
    """Why its comparisons are not those of the sentence; None: they are.

    Another requirement in the file may use as a truth value what this one uses as a number; then
    the generated text for all of them is the reference.
    """
    generated, whole = texts
    fault = _differing(requirement, text, generated, monitor, atoms)
    if fault is None or whole is None:
        return fault
    return _differing(requirement, text, whole, monitor, atoms)


def _differing(
    requirement: FormalizedRequirement,
    text: str,
    written: str,
    monitor: Monitor,
    atoms: Sequence[str],
) -> ClaimOutcome | None:
    """Why the variables or comparisons of a text differ from the other's."""
    try:
        actual, expected = front_terms.terms(text), front_terms.terms(written)
    except UnexpectedStatementError as error:
        return not_checked(str(error))
    names = [name for name in requirement.watched if name in expected]
    if all(actual.get(name) == expected[name] for name in names):
        return None
    reference = load("written", written)
    inputs, others = (getattr(each, "VARIABLES", None) for each in (monitor, reference))
    if inputs is not None and others is not None and _kinds(inputs) == _kinds(others):
        difference = front_terms.differing(monitor, reference, (text, written), names)
        if difference is not None:
            word = tuple(tuple(row.get(name) for name in atoms) for row in difference.truths)
            return _disagreement(atoms, word, difference.fault, difference.values)
    wrong = next(name for name in names if actual.get(name) != expected[name])
    return not_checked(f"`{wrong}` is not computed from the variables as in generated code")


def _kinds(variables: Mapping[str, Variable]) -> Mapping[str, object]:
    return {name: (each.kind, each.words) for name, each in variables.items()}


def _compared_with_generated(
    requirement: FormalizedRequirement,
    generated: str,
    text: str,
    monitor: Monitor,
    index: int,
    atoms: tuple[Sequence[str], int],
    limit: int,
) -> int | ClaimOutcome:
    """Number of states in which it agrees with the generated text of the requirement.

    Args:
        requirement: the requirement.
        generated: generated text.
        text: text of the monitor.
        monitor: monitor loaded from the text.
        index: index of the requirement in the monitor.
        atoms: all propositions, and how many of them, counted from the first, the requirement
            depends on.
        limit: maximum number of states.
    """
    names, count = atoms
    if count > approximations.MOST_PROPOSITIONS:
        most = approximations.MOST_PROPOSITIONS
        return not_checked(
            f"it is not the generated monitor, and {count} propositions, more than "
            f"{most}, are too many to compare both with unknown values"
        )
    reference = load("generated", generated)
    never = impossible_combinations(requirement)

    def compare_without(
        more: Sequence[Exclusion],
    ) -> approximations.Equivalent | approximations.Distinguished | None:
        most = min(limit, MOST_SEARCHED) if more else limit
        every = (*never, *more)
        return approximations.compared(monitor, index, reference, names[:count], most, every)

    comparison, note = with_numeric_counterexample(
        requirement, names[:count], approximations.Distinguished, compare_without
    )
    match comparison:
        case None:
            return not_checked(f"with unknown values there are more than {limit} states")
        case approximations.Distinguished(word, signal):
            fault = f"the generated monitor has another {signal}{noted(note)}"
            return _disagreement(names, word, fault)
        case approximations.Equivalent(states):
            terms = TermTable()
            if terms.of(text, index) == terms.of(generated, 0):
                return states
            return not_checked(
                "its column program is not the generated one: it agrees with the steps on random "
                "traces, and is not proved for others"
            )


def _demand_monitor(text: str) -> None:
    """Raise NotAMonitorError unless it is Python and defines a monitor."""
    runtime = kernel().text
    try:  # The runtime part is long; it is cut off with line numbers kept.
        tree = ast.parse(text.replace(runtime, "\n" * runtime.count("\n"), 1))
    except (SyntaxError, ValueError, RecursionError) as error:
        raise NotAMonitorError(f"it is not valid Python: {error}") from None
    targets = (node.target for node in tree.body if isinstance(node, ast.AnnAssign))
    if not any(isinstance(target, ast.Name) and target.id == "MONITOR" for target in targets):
        raise NotAMonitorError("it defines no `MONITOR`")
