"""A monitor in C and its driver, prepared for Frama-C; nothing is compiled or run."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePath

from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import not_checked
from compiler.targets.c.driver import ENTRY, driver
from fretc.verification.c.language import base, checked
from fretc.verification.c.layout import without_comments
from fretc.verification.compiled.plan import ParsedSource, SourceText
from fretc.verification.compiled.text import UnexpectedLayoutError
from fretc.verification.compiled.verifying import RequirementOutcome
from fretc.verification.engines import frama_c
from fretc.verification.engines.sandbox import CallLimits


def analysed(
    requirements: Sequence[FormalizedRequirement],
    given: SourceText,
    program: str,
    limits: CallLimits,
    others: Sequence[FormalizedRequirement] = (),
) -> Iterator[RequirementOutcome]:
    """Frama-C's outcome for a monitor; it is the same for each of its requirements.

    Args:
        requirements: the requirements to prove; the target accepts them.
        given: a monitor of them, and perhaps of others.
        program: path of Frama-C.
        limits: limits of the analysis.
        others: further requirements that the monitor may implement.

    Raises:
        NotAMonitorError: the monitor contains no requirement.
    """
    artefacts = {name: sha256(text) for name, text in given.texts.items()}
    try:
        source = checked(given, (*requirements, *others))
        run = prepared(given, source)
    except UnexpectedLayoutError as error:
        for requirement in requirements:
            yield RequirementOutcome(requirement, not_checked(str(error)), frama_c.NAME, artefacts)
        return
    outcome, engine = frama_c.answer(program, run, limits)
    artefacts[f"{PurePath(given.name).stem}_driver.c"] = sha256(run.driver)
    own = {requirement.id for requirement in source.requirements}
    absent = not_checked("the monitor is for other requirements")
    for requirement in requirements:
        yield RequirementOutcome(
            requirement, outcome if requirement.id in own else absent, engine, artefacts
        )


def prepared(given: SourceText, source: ParsedSource) -> frama_c.EvaInput:
    """The texts to analyse, without comments, which could be annotations.

    Args:
        given: the texts.
        source: their parsed layout.
    """
    made = driver(PurePath(given.header_name).stem, base(given), source.requirements)
    return frama_c.EvaInput(
        without_comments(given.text),
        (given.header_name, without_comments(given.header)),
        made.text,
        ENTRY,
        made.assertions,
        made.words + 1,
    )
