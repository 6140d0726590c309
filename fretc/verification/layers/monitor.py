"""Layer MONITOR: the text of a monitor has the meaning of its sentence."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof, not_checked, proof
from compiler.project.project import Project
from fretc.verification.compiled.plan import SourceText
from fretc.verification.engines.sandbox import NoResult, SandboxSession
from fretc.verification.layers.languages import LanguageRow, language_of
from fretc.verification.layers.request import Request, named_text, setup_of
from fretc.verification.monitor.verifying import verified_beside, written
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

CLAIM = "the monitor means what the sentence says"
ENGINE = "fretc, lock step with the counter automaton of the sentence"


def prove(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterable[Proof] | Diagnostic:
    """One proof for each requirement; the text may contain monitors of other requirements, too.

    A diagnostic if the compiler or interpreter is not installed.

    Raises:
        NotAMonitorError: the given text is not a generated monitor.
    """
    language = language_of(request.monitor.name) if request.monitor else None
    if request.monitor is None or language is None:
        return _of_python(requirements, project, request)
    program = language.module.tool()
    if program is None:
        return diagnostic(
            "language_missing",
            language=language.name,
            missing=language.missing,
            help=language.install,
        )
    texts = (named_text(each) for each in (request.monitor, request.header))
    given = SourceText(*(part for text in texts if text for part in (text.name, text.text)))
    return _of_language(requirements, project, request, language, (program, given))


def _of_python(
    requirements: Sequence[FormalizedRequirement], project: Project, request: Request
) -> Iterator[Proof]:
    given = request.monitor
    with SandboxSession(request.limits) as session:
        whole = session.call(written, given.text, tuple(project.formalized)) if given else None
        for requirement in requirements:
            file = setup_of(requirement, project, request).monitor
            request.progress(f"{requirement.id}: monitor")
            beside = file.text if given is None else whole if isinstance(whole, str) else None
            outcome = session.call(verified_beside, requirement, file.text, beside)
            if isinstance(outcome, NoResult):
                outcome = not_checked(outcome.reason)
            artefacts = {file.name: sha256(file.text)}
            yield proof(requirement.id, Layer.MONITOR, CLAIM, outcome, ENGINE, (), artefacts)


def _of_language(
    requirements: Sequence[FormalizedRequirement],
    project: Project,
    request: Request,
    language: LanguageRow,
    made: tuple[str, SourceText],
) -> Iterator[Proof]:
    """Proofs of a monitor in a language.

    Args:
        requirements: the requirements to prove.
        project: all requirements.
        request: the limits.
        language: the language.
        made: its tool, and the text.
    """
    from fretc.verification.compiled.verifying import verified as examined

    program, given = made
    words = (f"{requirement.id}: monitor in {language.name}" for requirement in requirements)
    found = examined(
        requirements, given, language.module, program, request.limits, project.formalized
    )
    for progress in words:
        request.progress(progress)
        requirement, outcome, by, artefacts = next(found)
        under = (f"{language.under}: {by}",) if by else ()
        engine = f"{ENGINE} and the monitor in Python"
        yield proof(requirement.id, Layer.MONITOR, CLAIM, outcome, engine, under, artefacts)
