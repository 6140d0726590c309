"""Answers as tests of the chosen sentence, as a suite that `fretc test --suite` runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from compiler.files.build_id import __version__
from compiler.files.records import replace
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor as emitted
from fretc.testing.suite import SCHEMA, Polarity, Suite, Test, Tested, unused
from fretc.testing.words import RunColumns, expected
from fretish.classes.frozen import dataclass
from fretish.printer import sentence as printed
from monitors.loading import load


@dataclass(frozen=True, slots=True)
class Answer:
    """A run that a person was shown, and whether it may happen."""

    run: RunColumns
    may_happen: bool


def answers_file(requirements: str) -> str:
    """The path of the answers beside a `.fret` file: `requirements/dock.answers.json`."""
    path = PurePath(requirements)
    return str(path.with_name(f"{path.stem}.answers.json"))


def suite_with(
    earlier: Suite | None, requirement: FormalizedRequirement, answers: Sequence[Answer]
) -> Suite:
    """The tests of a file with those of a new requirement.

    Args:
        earlier: the suite in the file; None: there is no file.
        requirement: the chosen sentence, which agrees with all answers.
        answers: what was asked, and answered.
    """
    clock = requirement.clock
    before = earlier or Suite(
        schema=SCHEMA,
        fretc=__version__,
        clock=str(clock) if clock is not None and clock.declared else "",
        requirements=(),
        roles={},
        tests=(),
        obligations=(),
        mutants=(),
    )
    names = {test.name for test in before.tests}
    monitor = load(f"{requirement.id}.py", emitted.text(requirement))
    tests: list[Test] = []
    for number, answer in enumerate(answers, 1):
        result = expected(requirement, monitor, answer.run)
        assert result.finite is answer.may_happen, "the sentence agrees with all answers"
        name = unused(f"{_plain(requirement.id)}-answer-{number}", names)
        tests.append(
            Test(
                name=name,
                requirement=requirement.id,
                words=f"answered: this run {'may' if answer.may_happen else 'must not'} happen",
                rows=answer.run.rows,
                polarity=Polarity.KEPT if answer.may_happen else Polarity.BROKEN,
                verdict=result.verdict,
                finite=result.finite,
                decided=result.decided,
                first_violation=result.first_violation,
                because=result.because,
                situations=(),
                kills=(),
            )
        )
    tested = Tested(requirement.id, printed(requirement.written), requirement.fingerprint, ())
    others = tuple(each for each in before.requirements if each.id != requirement.id)
    older = tuple(test for test in before.tests if test.requirement != requirement.id)
    return replace(before, requirements=(*others, tested), tests=(*older, *tests))


def _plain(id: str) -> str:
    """The id in the letters that a name of a test may have."""
    letters = "".join(c if c.isalnum() and c.isascii() else "-" for c in id.lower())
    return "-".join(filter(None, letters.split("-"))) or "requirement"
