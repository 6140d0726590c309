"""`--emit monitor`: a standalone Python file with straight-line code for the monitor.

Every temporal sub-formula has one variable, updated at every tick, and one column over whole
traces; requirements in one file share sub-formulas. The text of `monitors/kernel/` is copied into
the file, so it needs only the standard library.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

from compiler.files.artifact import Artifact
from compiler.files.build_id import __version__
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement, without_probability
from compiler.formalization.obligation import TRAITS, Trait, obligation
from compiler.logic import printing
from compiler.program.program import MARKS, SIGNALS
from compiler.targets.python.comparisons import ANNOTATIONS, ComparisonWriter
from compiler.targets.python.input_adapter import InputAdapter, input_adapter
from compiler.targets.python.names import (
    MOST_PARAMETERS,
    class_prefix,
    module,
    parameters_of,
    prefixes_of,
)
from compiler.targets.python.program import (
    ProgramCode,
    marks_of,
    program,
)
from compiler.targets.target import DEFAULT, Target, TargetOptions, not_expressible, stem
from fretish import syntax as s
from fretish.checking import LOOK_AHEAD, calls, conditions, is_formula
from fretish.classes.frozen import dataclass
from fretish.clock import assumed_ticks
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.expressions import depth
from fretish.reading.recursion import with_recursion_limit
from monitors.source_text import kernel, kernel_of_variables


def refuse(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F312 and F601 for requirements without a monitor in Python."""
    return refusal(requirement, "Python")


def refusal(requirement: FormalizedRequirement, language: str) -> Diagnostic | None:
    """F312 if a duration has no number of ticks; F601 if no monitor can evaluate the sentence.

    Python reads at most 200 nested parentheses, and all languages refuse the same sentences; and
    one run cannot show a probability.
    """
    if not is_readable(requirement):
        return not_expressible(
            language,
            requirement,
            f"more than {_MOST_LEVELS} nested operators",
            "bind parts of the expression as propositions",
        )
    if is_formula(requirement.sentence):
        return _without_past(requirement)
    ahead = next(
        (n for e in conditions(requirement.sentence) for n in calls(e) if n in LOOK_AHEAD), None
    )
    if ahead is not None:
        return not_expressible(
            "a monitor",
            requirement,
            f"`{ahead}`",
            "it looks ahead: state it by a timing, or look back",
        )
    first = next((name for name in requirement.watched if _ASKS_FOR_FIRST.search(name)), None)
    if first is not None:
        return not_expressible(
            "a monitor",
            requirement,
            f"`FTP` within `{first}`",
            "a monitor cannot evaluate it there: state it outside",
        )
    if requirement.pctl is not None:
        return not_expressible(
            "a monitor",
            requirement,
            "the probability",
            "one run does not show a probability: `fretc audit` estimates it over many runs",
        )
    if assumed_ticks(requirement.sentence, requirement.clock) is None:
        return None
    return diagnostic(
        "no_clock_for_duration", requirement.sentence.timing_span, requirement=requirement.id
    )


def _without_past(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F601 for a formula that no formulas of the past can watch."""
    if not requirement.watch.missing:
        return None
    return not_expressible(
        "a monitor",
        requirement,
        f"the formula: {requirement.watch.missing}",
        "state its parts as requirements of their own",
    )


def is_readable(requirement: FormalizedRequirement) -> bool:
    """Whether Python can read the monitor, which allows at most 200 nested parentheses."""
    return max(map(depth, conditions(requirement.sentence))) <= _MOST_LEVELS


_ASKS_FOR_FIRST = re.compile(r'^[^"].*\bFTP\b')
"""An atom whose text contains `FTP`, the first tick; a quoted name does not count."""


@with_recursion_limit
def remark(requirement: FormalizedRequirement) -> Diagnostic | None:
    """F203: after any prefix of a run, both verdicts are still possible.

    This holds for 12 of FRET's 288 templates: each trigger demands a response at some later time,
    on a stretch that ends with the run. Source: Pnueli, Zaks, PSL model checking and run-time
    verification via testers, FM 2006 (monitorability).
    """
    sentence = requirement.sentence
    if is_formula(sentence):
        return None
    scope = sentence.scope.kind if sentence.scope else None
    traits = TRAITS[obligation(sentence, requirement.ticks or 0).demand.kind]
    later = Trait.UNMET in traits and Trait.LAST not in traits
    if sentence.condition is None or not later or not s.ends_with_run(scope):
        return None
    return diagnostic(
        "never_decided",
        sentence.timing_span or requirement.entry.wording,
        requirement=requirement.id,
    )


def emit(
    requirements: Sequence[FormalizedRequirement], options: TargetOptions = DEFAULT
) -> tuple[Artifact, ...]:
    """`<id>_monitor.py` for each requirement, or one file; they need only Python 3.11."""
    if options.one_file:
        return (Artifact(PurePosixPath("monitors.py"), text(*requirements)),)
    return tuple(
        Artifact(PurePosixPath(f"{module(stem(requirement))}_monitor.py"), text(requirement))
        for requirement in requirements
    )


def text(*requirements: FormalizedRequirement) -> str:
    """The Python source of one monitor for all of the requirements.

    For a sentence with a probability it is the monitor of the sentence without it, with a remark.

    Args:
        requirements: at least one, each with an id of its own, and all on one clock.
    """
    probabilistic = [
        requirement for requirement in requirements if requirement.sentence.probability
    ]
    requirements = tuple(map(without_probability, requirements))
    names = watched(requirements)
    prefixes = prefixes_of([requirement.id for requirement in requirements])
    compared = input_adapter(requirements, names)
    variables = compared.inputs if compared else {}
    parameters = parameters_of(names, prefixes.values(), variables)
    code = program(
        {requirement.id: requirement.watch for requirement in requirements}, parameters, prefixes
    )
    runtime = kernel_of_variables() if compared else kernel()
    lines = _AdapterCode.of(compared, parameters) if compared else None
    inputs = [_Input(name, parameters[name], _is_negated(name, code)) for name in names]
    return render(
        "monitor/monitor.py.j2",
        **description(requirements),
        class_name=class_prefix(requirements[0].id) if len(requirements) == 1 else "All",
        probabilistic=[_probability_note(requirement) for requirement in probabilistic],
        inputs=inputs,
        row=_tuple([p.name for p in inputs]),
        by_mapping=len(inputs) > MOST_PARAMETERS,
        inlined=is_inlined(len(requirements), len(inputs)),
        satisfied_forever=SIGNALS.index("satisfied_forever"),
        program=code,
        front=lines,
        digest=_digest(code, requirements, lines),
        slots=_slots(code),
        requirements=code.requirements,
        marks=MARKS,
        verdicts="Verdict" if len(requirements) == 1 else '"tuple[Verdict, ...]"',
        imports=runtime.imports,
        kernel=runtime.text,
    )


def is_inlined(requirements: int, inputs: int) -> bool:
    """Whether `step` contains the code of a tick, because a call costs as much as the tick."""
    return requirements == 1 and inputs <= MOST_PARAMETERS


def _digest(
    code: ProgramCode, requirements: Sequence[FormalizedRequirement], front: _AdapterCode | None
) -> str:
    """SHA-256 of everything that defines the meaning of the saved state."""
    identities = [
        (requirement.id, requirement.fingerprint, requirement.ticks) for requirement in requirements
    ]
    meaning = (__version__, identities, code, *([front] if front else []))
    return hashlib.sha256(repr(meaning).encode()).hexdigest()


def _tuple(names: Sequence[str]) -> str:
    return f"({', '.join(names)}{',' * (len(names) == 1)})"


def _slots(code: ProgramCode) -> list[str]:
    """The `__slots__` of the state, in natural order."""
    marks = {name for signals in code.requirements for name in marks_of(signals.prefix)}
    names = {"is_possible", "tick", *(cell.name for cell in code.cells), *marks}
    return sorted(names, key=_natural)


def _natural(name: str) -> list[str]:
    """A sort key that compares numbers within names by value."""
    return [part.zfill(9) if part.isdigit() else part for part in re.split(r"(\d+)", name)]


@dataclass(frozen=True, slots=True)
class _Variable:
    """One variable of a step."""

    variable: str
    name: str
    kind: str
    words: tuple[str, ...]
    infinite: tuple[str, ...]
    annotation: str


@dataclass(frozen=True, slots=True)
class _AdapterCode:
    """The code that computes truth values from variables."""

    variables: tuple[_Variable, ...]
    comparisons: tuple[tuple[str, str, str], ...]
    """Each proposition that is a comparison, with its name and code."""
    earlier: tuple[tuple[str, str, str], ...]
    """Values kept for `preReal` and the like: (variable name, initial value, expression for the
    current tick)."""

    @property
    def row(self) -> str:
        """The code for the variables of a tick."""
        return _tuple([variable.name for variable in self.variables])

    @property
    def now(self) -> str:
        """The code for the values that the next tick looks back at."""
        return _tuple([text for _, _, text in self.earlier])

    @classmethod
    def of(cls, compared: InputAdapter, parameters: Mapping[str, str]) -> _AdapterCode:
        """The code for given names of variables and propositions."""
        writer = ComparisonWriter({name: parameters[name] for name in compared.inputs})
        comparisons = tuple(
            (name, parameters[name], writer.comparison(comparison))
            for name, comparison in compared.comparisons.items()
        )
        variables = tuple(
            _Variable(
                name,
                parameters[name],
                variable.kind,
                variable.words,
                variable.infinite,
                ANNOTATIONS[variable.kind],
            )
            for name, variable in compared.inputs.items()
        )
        earlier = tuple((name, *texts) for texts, name in writer.earlier.items())
        return cls(variables, comparisons, earlier)


@dataclass(frozen=True, slots=True)
class _Input:
    """One proposition of a step."""

    proposition: str
    name: str
    negated: bool
    """Whether the negation is needed, too."""


def _is_negated(proposition: str, code: ProgramCode) -> bool:
    return any(
        literal.proposition == proposition and not literal.positive for literal in code.literals
    )


def _probability_note(requirement: FormalizedRequirement) -> dict[str, str]:
    odds = requirement.sentence.probability
    assert odds is not None
    return {
        "id": requirement.id,
        "odds": f"{odds.op} {odds.digits}",
        "fingerprint": requirement.fingerprint,
    }


def watched(requirements: Sequence[FormalizedRequirement]) -> tuple[str, ...]:
    """The propositions that a monitor of all requirements reads, each once."""
    return tuple(
        dict.fromkeys(name for requirement in requirements for name in requirement.watched)
    )


def description(requirements: Sequence[FormalizedRequirement]) -> dict[str, Any]:
    """The description at the top of a monitor, as values for a template."""
    return {
        "title": ", ".join(requirement.id for requirement in requirements),
        "version": __version__,
        "formalized": [description_of(requirement) for requirement in requirements],
        "tick": str(requirements[0].clock) if requirements[0].clock else "not declared",
    }


def description_of(requirement: FormalizedRequirement) -> dict[str, object]:
    """The description of a requirement at the top of a monitor."""
    return {
        "id": requirement.id,
        "sentence": " ".join(requirement.entry.wording.text.split()),
        "fingerprint": requirement.fingerprint,
        "deadline_ticks": requirement.watch.deadline_ticks,
        "ft": printing.readable(requirement.ft_infinite),
        "finite": printing.readable(requirement.ft_finite),
        "pt": printing.readable(requirement.pt),
    }


_MOST_LEVELS = 60


def _names(requirement: FormalizedRequirement) -> Mapping[str, str]:
    """Variable or proposition → the parameter of a step."""
    names = requirement.watched
    compared = input_adapter([without_probability(requirement)], names)
    variables = compared.inputs if compared else ()
    return parameters_of(names, prefixes_of([requirement.id]).values(), variables)


TARGET = Target(
    "monitor",
    "a standalone runtime monitor in Python",
    emit,
    refuse,
    remark,
    joins=True,
    next_step="`python {} TRACE.csv` judges a table with a column for each of its names",
    names=_names,
)
