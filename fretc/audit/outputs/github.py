"""Results of an audit as annotations of GitHub Actions.

Source: GitHub, Workflow commands for GitHub Actions.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from fretc.audit.evidence import verdicts
from fretc.audit.evidence.probabilities import AVERAGE, Estimated
from fretc.audit.evidence.schema import Result
from fretc.audit.evidence.verdicts import MessageLevel
from fretc.audit.outputs.violated_values import reason
from fretish.diagnostics.rendering import visible
from fretish.diagnostics.source import Span
from fretish.documents import RequirementEntry

_GITHUB = {
    MessageLevel.ERROR: "error",
    MessageLevel.WARNING: "warning",
    MessageLevel.NONE: "notice",
}


def github(
    results: Iterable[Result],
    requirements: Sequence[RequirementEntry],
    estimates: Sequence[Estimated] = (),
) -> str:
    """A line for each result, at the sentence of its requirement.

    A run that only contributes to an estimate (`trials`) gives a notice: the answer of all runs
    follows.

    Args:
        results: one for each run and requirement, in declared units.
        requirements: the requirements of the results.
        estimates: the answers of all runs.
    """
    places = {requirement.id: requirement.wording for requirement in requirements}
    names = {requirement.id: requirement.name for requirement in requirements}
    lines = []
    for result in results:
        level = "notice" if result.trials is not None else _GITHUB[verdicts.level(result.verdict)]
        title = f"{names[result.requirement]} {result.verdict}"
        message = f"{result.run}: {reason(result)}"
        lines.append(_annotation(level, places[result.requirement], title, message))
    for estimate in estimates:
        level, title = (
            _GITHUB[verdicts.level(estimate.answer)],
            f"{names[estimate.requirement]} {estimate.answer}",
        )
        message = f"all runs: {estimate.reason}; {estimate.lines[1]}; {AVERAGE}"
        lines.append(_annotation(level, places[estimate.requirement], title, message))
    return "".join(lines)


def _annotation(level: str, span: Span, title: str, message: str) -> str:
    where = f"file={_property(span.source.name)},line={span.line},title={_property(title)}"
    return f"::{level} {where}::{_data(message)}\n"


def _data(text: str) -> str:
    return visible(text).replace("%", "%25")


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
