"""Layer BOUNDS: the maximum response time, for every latency, loss and braking time.

The closed loop has an integer abstraction (`fretc.verification.loop.abstraction`). z3 proves an
inductive invariant of it for all times: an obligation is open for less than any D with `D * tick >=
lost * heartbeat + latency + braking` and `D * tick > lost * heartbeat`, where requests at every
tick have a heartbeat of a tick. In addition, the abstraction is compared with the code at small
times, and a run of the code shows that a lower bound fails under the declared times.

Source: Manna, Pnueli, Temporal verification of reactive systems: safety, 1995, chapter 1
(invariance).
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import atoms_of, letters_by_valuation
from compiler.logic.claims import (
    ClaimOutcome,
    Layer,
    Proof,
    not_checked,
    proof,
    proved,
    refuted,
)
from compiler.logic.kripke import ModelTooLargeError
from compiler.targets.python import monitor as target
from fretc.verification.engines.sandbox import CallLimits
from fretc.verification.interceptor.file import is_original
from fretc.verification.interceptor.machine import NotAnInterceptorError
from fretc.verification.loop.abstraction import (
    covered,
    times_of,
)
from fretc.verification.loop.actuation_model import ActuationAssumptions, ActuationModel
from fretc.verification.loop.closed_loop import (
    Setup,
    answered,
    artefacts,
    assumptions,
    case,
    inapplicable,
)
from fretc.verification.loop.invariant import unproved
from fretc.verification.loop.search import Case, NotALoopError, Parts, as_table, reach
from fretc.verification.monitor.statements import is_same
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.clock import in_words
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.printer import canonical
from monitors.interceptor import Options

_MORE = "the ticks of `latency` and `braking` together, at least one"
ANSWERED = f"every demand is answered within `lost` ticks and {_MORE}"
_SMALL = ((1, 0, 0, 0), (1, 1, 1, 1), (2, 1, 1, 2), (1, 2, 2, 0), (3, 4, 1, 2))
"""Cells in a tick, latency, losses in a row, and braking, for comparing the abstraction with the
code."""


@dataclass(frozen=True, slots=True)
class Question:
    """The proof problem, in a form for another process."""

    case: Case
    sentence: s.Sentence
    ticks: int | None
    """Bound of the sentence; None: it has none."""
    tick: int
    """Length of a tick in nanoseconds."""

    @property
    def unknown(self) -> str | None:
        """Why small times do not represent all times; None: they do."""
        if is_original(self.case.interceptor):
            return None
        return (
            "the interceptor's core is not the one that fretc generates: a check of some "
            "times proves nothing about longer times"
        )


@dataclass(frozen=True, slots=True)
class BoundsResult:
    """Results of both claims, and the version of z3."""

    answered: ClaimOutcome
    enough: ClaimOutcome
    z3: str = ""


def bounds_proofs(
    requirement: FormalizedRequirement, setup: Setup, limits: CallLimits
) -> tuple[Proof, ...]:
    """Proofs of both claims: a response comes in time for all times; and the bound is enough."""
    reason = _inapplicable(requirement, setup)
    query = reason or question(requirement, setup)
    found = answered(reason, query, search, limits)
    answer = BoundsResult(found, found) if isinstance(found, ClaimOutcome) else found
    at_declared, at_any = (
        ()
        if isinstance(query, str)
        else tuple(assumptions(requirement, setup, query.case, any_time=any_))
        for any_ in (False, True)
    )
    engine = f"z3 {answer.z3}; fretc, explicit states" if answer.z3 else "fretc, explicit states"
    return tuple(
        proof(
            requirement.id,
            Layer.BOUNDS,
            claim,
            result,
            engine,
            assumed,
            artefacts(requirement, setup),
        )
        for claim, result, assumed in (
            (_answered(query), answer.answered, at_any),
            (_enough(requirement), answer.enough, at_declared),
        )
    )


def _answered(query: Question | str) -> str:
    beat = 1 if isinstance(query, str) else times_of(query.case.channel).heartbeat
    if beat == 1:
        return ANSWERED
    return f"every demand is answered within {beat} ticks for each message of `lost` and {_MORE}"


def _enough(requirement: FormalizedRequirement) -> str:
    if s.deadline(requirement.sentence.timing) is None:
        return "some bound is enough"
    return f"the bound of {_ticks(requirement.ticks or 0)} is enough"


def _ticks(amount: int) -> str:
    return f"{amount} tick{'' if amount == 1 else 's'}"


# The question ---------------------------------------------------------------------------------


def _inapplicable(requirement: FormalizedRequirement, setup: Setup) -> str | None:
    """Why the requirement has no bound to prove; None: it has one."""
    reason, sentence = inapplicable(requirement, setup), requirement.sentence
    if reason is not None:
        return reason
    if sentence.scope is not None:
        return "it has a scope; only requirements about the whole run have bounds"
    if not (s.deadline(sentence.timing) or s.is_eventual(sentence.timing)):
        return "its timing is neither `within` nor `eventually`"
    return None


def question(requirement: FormalizedRequirement, setup: Setup) -> Question | str:
    """The proof problem of a requirement with a bound; or why it cannot be examined."""
    problem = case(requirement, setup)
    if isinstance(problem, str):
        return problem
    sentence = requirement.sentence
    if problem.settings.event_driven:
        return "an interceptor without a timer stops nothing before the next command"
    if problem.channel.edge and not problem.channel.heartbeat:
        return "a request that is sent only once may be lost (`requests`, [assume]: no `heartbeat`)"
    if not _answers(sentence, problem.stands):
        return f"`{problem.stands}` alone does not answer it"
    assert requirement.clock is not None
    bound = requirement.ticks if s.deadline(sentence.timing) else None
    if not is_same(problem.safety, problem.observer):
        return (
            "the monitor is not the one that fretc generates for it, and only generated "
            "monitors are examined"
        )
    return Question(problem, sentence, bound, requirement.clock.period or 0)


def _answers(sentence: s.Sentence, stands: str) -> bool:
    """Whether the response holds whenever the robot stands."""
    atoms = atoms_of(sentence)
    letters = letters_by_valuation(sentence, atoms)
    index = atoms.index(stands)
    return all(letter[2] for values, letter in letters.items() if values[index])


# In another process ---------------------------------------------------------------------------


def search(query: Question) -> BoundsResult:
    """Prove the invariant, compare abstraction and code, and search for the least bound."""
    try:
        endless = _with(query, s.Eventually())  # so that no run ends at a deadline
        parts = Parts.of(endless)
        longest, steps, loops = _covered(query, endless, parts)
        obstacle, version = unproved(times_of(query.case.channel))
        if obstacle is not None:
            return BoundsResult(not_checked(obstacle), not_checked(obstacle), version)
        in_time: ClaimOutcome = proved(
            f"by an inductive invariant; {steps:,} steps of {loops} loops are steps of its model"
        )
        if query.unknown is not None:
            in_time = not_checked(query.unknown)
        return BoundsResult(in_time, _least(query, longest + 1, parts.loop.drive), version)
    except (NotALoopError, NotAnInterceptorError, ModelTooLargeError) as error:
        return BoundsResult(not_checked(str(error)), not_checked(str(error)))


def _covered(query: Question, endless: Case, parts: Parts) -> tuple[int, int, int]:
    """Compare loops with the abstraction.

    Args:
        query: the proof problem.
        endless: its case without a bound, so that no run ends at a deadline.
        parts: the parts of the endless case.

    Returns:
        Maximum number of ticks for which an obligation of the endless case is open, -1 if there is
        none; number of compared steps, and of loops.

    Raises:
        NotALoopError: a step is not a step of the abstraction.
    """
    small = _short(query.case.settings)
    cases = (
        replace(endless, settings=small, channel=_channel(query.case.channel, *numbers))
        for numbers in _SMALL
    )
    loops = [
        parts.loop,
        Parts.of(query.case, parts.loop.drive).loop,
        *(Parts.of(case).loop for case in cases),
    ]
    longest, steps = [], 0
    for loop in loops:
        coverage = covered(loop, endless.limit, longest=_formula(loop.channel) + 1)
        if coverage.uncovered is not None:
            raise NotALoopError("the loop has a step that its integer model does not have")
        longest.append(coverage.longest)
        steps += coverage.steps
    return longest[0], steps, len(loops)


def _channel(
    declared: ActuationAssumptions, cells: int, latency: int, lost: int, braking: int
) -> ActuationAssumptions:
    """Small times; a heartbeat becomes short, too, and stays above 0."""
    return replace(
        declared,
        cells=cells,
        latency=latency,
        lost=lost,
        braking=braking,
        heartbeat=min(declared.heartbeat, 3),
    )


def _short(settings: Options) -> Options:
    """The same settings with short times, on which the abstraction does not depend."""
    return replace(
        settings,
        hold=min(settings.hold, 2),
        stop_timeout=min(settings.stop_timeout, 3),
        scan_timeout=min(settings.scan_timeout, 2),
        command_timeout=min(settings.command_timeout, 2),
    )


def _formula(channel: ActuationAssumptions) -> int:
    """D: ticks within which each obligation is met, as in the claim."""
    filled = -(-(channel.latency + channel.braking) // channel.cells)
    return channel.lost * times_of(channel).heartbeat + max(1, filled)


def _with(query: Question, timing: s.Timing) -> Case:
    text = canonical(replace(query.sentence, timing=timing))
    entry = RequirementEntry(query.case.requirement, Source("sentence", text).span())
    requirement, diagnostics = formalize(entry, None)
    assert requirement is not None, diagnostics
    monitor = target.text(requirement)
    return replace(query.case, safety=monitor, observer=monitor, formula=requirement.ft_infinite)


def _least(query: Question, least: int, drive: ActuationModel) -> ClaimOutcome:
    """Whether the bound is enough.

    Args:
        query: the proof problem.
        least: least sufficient bound in ticks; 0: no obligation is ever open.
        drive: actuation model of the case.
    """
    if least == 0:
        return not_checked("no demand is ever open")
    detail = f"the smallest satisfied bound is {_ticks(least)} ({in_words(least * query.tick)})"
    before = _with(query, _bound(least - 1))
    violation = reach(Parts.of(before, drive).loop, before.limit).violation
    assert violation is not None, "a demand is open for longer than it can be"
    if query.ticks is None:
        return proved(detail)
    if query.ticks >= least:
        return proved(f"{detail}; with one tick less a run of {_ticks(len(violation))} violates it")
    trace = _violating(query, drive)
    return refuted(detail, trace)


def _bound(ticks: int) -> s.Timing:
    return s.Within(s.Duration(ticks, "tick")) if ticks else s.Immediately()


def _violating(query: Question, drive: ActuationModel) -> Any:
    """A shortest run that violates the original sentence."""
    assert query.ticks is not None
    parts = Parts.of(_with(query, _bound(query.ticks)), drive)
    violation = reach(parts.loop, query.case.limit).violation
    assert violation is not None
    trace, violated = as_table(parts, violation)
    assert violated
    return trace
