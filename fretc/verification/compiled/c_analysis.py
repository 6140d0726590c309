"""A monitor in C and its driver, for an analyzer of C: nothing of it is compiled or run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.logic.claims import not_checked
from compiler.targets.c.driver import ENTRY, driver
from fretc.verification.compiled.c_form import StrangeTextError, formed, without_comments
from fretc.verification.compiled.c_verifying import Examined, Given, original
from fretc.verification.engines import frama_c
from fretc.verification.engines.sandbox import Limits


def analysed(
    rule: Formalized,
    given: Given,
    program: str,
    limits: Limits,
    others: Sequence[Formalized] = (),
) -> Examined:
    """What Frama-C says of a monitor.

    Args:
        rule: one that the target accepts.
        given: a monitor of it, maybe with others.
        program: the path of Frama-C.
        limits: of the analysis.
        others: further rules that the texts may implement.
    """
    artefacts = {given.name: sha256(given.text), given.header_name: sha256(given.header)}
    try:
        run = prepared(rule, given, others)
    except StrangeTextError as error:
        return Examined(not_checked(str(error)), "Frama-C", artefacts)
    outcome, engine = frama_c.answer(program, run, limits)
    artefacts[f"{PurePath(given.name).stem}_driver.c"] = sha256(run.driver)
    return Examined(outcome, engine, artefacts)


def prepared(rule: Formalized, given: Given, others: Sequence[Formalized] = ()) -> frama_c.Run:
    """The texts that are analysed. What stands in comments, as annotations do, is left out.

    Raises:
        StrangeTextError: the texts are not in the form that fretc writes.
    """
    own = original(rule, given, others)
    formed(given.text, own.text, own.base)
    made = driver(PurePath(given.header_name).stem, own.base, own.rules)
    return frama_c.Run(
        without_comments(given.text),
        (given.header_name, without_comments(given.header)),
        made.text,
        ENTRY,
        made.assertions,
        made.words + 1,
    )
