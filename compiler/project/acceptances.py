"""Warnings that the project accepts, each with its reason.

A warning about a requirement is accepted in its header; other warnings in the settings, for one
topic or hazard or for the whole project. An accepted warning is still counted and shown.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace

from compiler.files.settings import Settings
from fretish.bindings.declarations import Declarations
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity, did_you_mean
from fretish.diagnostics.explanations import ACCEPTANCES, explanation
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Span
from fretish.documents import RequirementEntry

REQUIREMENT, TOPIC, HAZARD = "requirement", "topic", "hazard"
_CODES = {code.number: code for code in Code}


@dataclass(frozen=True, slots=True)
class Acceptance:
    """Accepted warnings of one code, with the reason."""

    code: Code
    reason: str
    span: Span = field(compare=False, repr=False)
    requirement: RequirementEntry | None = field(default=None, repr=False)
    """The requirement whose header has the acceptance; None if it is in the settings."""
    subject: str = ""
    """The topic or the hazard; empty: any."""

    @property
    def name(self) -> str:
        """`R2 F206`, `F315 /battery`, `F631`."""
        before = self.requirement.id if self.requirement else ""
        return " ".join(part for part in (before, self.code.number, self.subject) if part)

    @property
    def about(self) -> str:
        """The kind of subject of the code's warnings: a key of `ACCEPTANCES`."""
        return explanation(self.code).accept


def acceptances(
    requirements: Iterable[RequirementEntry], settings: Settings | None
) -> tuple[tuple[Acceptance, ...], tuple[Diagnostic, ...]]:
    """The acceptances of headers, then those of settings; and F549 for each that is invalid."""
    written = [(requirement, code) for requirement in requirements for code in requirement.accept]
    entries = [
        _acceptance(code, requirement.accept[code], requirement.place("accept", code), requirement)
        for requirement, code in written
    ]
    if settings is not None:
        entries.extend(_of_settings(settings))
    good = tuple(entry for entry in entries if isinstance(entry, Acceptance))
    return good, tuple(entry for entry in entries if isinstance(entry, Diagnostic))


def _of_settings(settings: Settings) -> Iterator[Acceptance | Diagnostic]:
    """The acceptances of the settings, the most specific (of one topic or hazard) first."""
    for code, reasons in settings.accept.items():
        for subject, reason in reasons.items() if isinstance(reasons, Mapping) else ():
            span = settings.place("accept", code, subject)
            yield _acceptance(code, reason, span, subject=subject)
    for code, reasons in settings.accept.items():
        if isinstance(reasons, str):
            yield _acceptance(code, reasons, settings.place("accept", code))


def _acceptance(
    number: str,
    reason: str,
    span: Span,
    requirement: RequirementEntry | None = None,
    subject: str = "",
) -> Acceptance | Diagnostic:
    code = _CODES.get(number)
    if code is None:
        fix = did_you_mean(number, _CODES, "write the number that the warning begins with")
        return _bad(f"`{number}` is not a code of fretc", span, fix)
    about = explanation(code).accept
    if not about:
        fix = f"fix the cause: `fretc explain {number}` says how"
        return _bad(f"{number} cannot be accepted: {code.summary}", span, fix)
    where, example = ACCEPTANCES[about]
    line = example.format(number).removeprefix("[accept]\n")
    fix = f"write `{line}` in {where}{'' if about == REQUIREMENT else ', under `[accept]`'}"
    if requirement is not None and about != REQUIREMENT:
        return _bad(f"{number} is not about one requirement", span, fix)
    if subject and about not in (TOPIC, HAZARD):
        return _bad(f"{number} is not about a topic or a hazard", span, fix)
    if not reason.strip():
        return _bad(
            f"{number} is accepted without a reason", span, "write why the warning is acceptable"
        )
    return Acceptance(code, reason.strip(), span, requirement, subject)


def _bad(message: str, span: Span, fix: str) -> Diagnostic:
    return Diagnostic(Code.BAD_ACCEPTANCE, message, span, help=fix)


_ByCode = Mapping[tuple[Code, str], Sequence[Acceptance]]
"""Acceptances of headers by code and file, in their order; the others by code and `""`."""


def with_acceptance_reasons(
    diagnostics: Iterable[Diagnostic], accepted: Sequence[Acceptance]
) -> tuple[Diagnostic, ...]:
    """The diagnostics, each accepted warning with the reason of its first acceptance."""
    by_code = _by_code(accepted)
    return tuple(_answered(diagnostic, by_code) for diagnostic in diagnostics)


def _answered(diagnostic: Diagnostic, by_code: _ByCode) -> Diagnostic:
    acceptance = next(_answers(diagnostic, by_code), None)
    return diagnostic if acceptance is None else replace(diagnostic, accepted=acceptance.reason)


def _by_code(accepted: Iterable[Acceptance]) -> _ByCode:
    by_code: dict[tuple[Code, str], list[Acceptance]] = {}
    for acceptance in accepted:
        file = acceptance.span.source.name if acceptance.requirement else ""
        by_code.setdefault((acceptance.code, file), []).append(acceptance)
    return by_code


def _answers(diagnostic: Diagnostic, by_code: _ByCode) -> Iterator[Acceptance]:
    """The acceptances of a warning, the most specific first."""
    if diagnostic.severity is not Severity.WARNING:
        return
    span = diagnostic.span
    if span is not None and span.source.name:
        headers = by_code.get((diagnostic.code, span.source.name), ())
        before = bisect_right(headers, span.end, key=lambda acceptance: acceptance.span.start)
        around = headers[max(0, before - 1) : before + 1]  # a header begins above its acceptance
        yield from (e for e in around if e.requirement and e.requirement.contains(span))
    others = by_code.get((diagnostic.code, ""), ())
    yield from (
        acceptance for acceptance in others if acceptance.subject in ("", diagnostic.subject)
    )


def unused_acceptances(
    accepted: Sequence[Acceptance],
    warnings: Iterable[Diagnostic],
    declarations: Declarations | None,
    recorded: Collection[str] | None,
) -> Iterator[Diagnostic]:
    """F550 for each acceptance without a matching warning.

    Args:
        accepted: the acceptances; those in headers of retired requirements are skipped.
        warnings: all warnings of the project, and of the audited logs.
        declarations: the bindings, if there are any.
        recorded: the topics of the audited logs; None if none was audited.
    """
    by_code = _by_code(accepted)
    used = {id(acceptance) for warning in warnings for acceptance in _answers(warning, by_code)}
    for acceptance in accepted:
        retired = acceptance.requirement is not None and acceptance.requirement.status == "retired"
        open_yet = acceptance.about == TOPIC and _may_come(
            acceptance.subject, declarations, recorded
        )
        if not (retired or open_yet or id(acceptance) in used):
            yield diagnostic("unused_acceptance", acceptance.span, number=acceptance.code.number)


def _may_come(
    topic: str, declarations: Declarations | None, recorded: Collection[str] | None
) -> bool:
    """Whether a log that was not audited may give F315 for a topic; for any topic if empty.

    It cannot if each signal of the topic states how long a sample counts.
    """
    signals = declarations.signals.values() if declarations else ()
    topics = {signal.path.topic for signal in signals if signal.max_age is None}
    here = topics if not topic else topics & {topic}
    return bool(here - {*(recorded or ())})
