"""Warnings for sentences that many readers misunderstand."""

from __future__ import annotations

from collections.abc import Iterator

from fretish import syntax as s
from fretish.diagnostics.diagnostic import Code, Diagnostic, Severity
from fretish.diagnostics.source import Span
from fretish.printer import expression

_ENDS = (
    s.ScopeKind.IN,
    s.ScopeKind.NOT_IN,
    s.ScopeKind.BEFORE,
)
"""Scopes whose intervals end before the run does, and that do not negate the timing."""


def ambiguity_warnings(sentence: s.Sentence) -> Iterator[Diagnostic]:
    """F204-F208: each states the actual meaning, and how to write the other one."""
    yield from _edge(sentence.condition)
    if s.timing_key(sentence) == "null":
        yield _warning(
            Code.NO_TIMING,
            "without a timing the response may come at any later tick",
            sentence.component_span,
            "write `eventually` if you mean this, or `immediately`, `always`, `within N seconds`",
        )
    scope = sentence.scope
    if scope is None:
        return
    m = expression(scope.mode)
    if s.deadline(sentence.timing) and scope.kind in _ENDS:
        yield _warning(
            Code.SHORT_SCOPE,
            f"if `{m}` ends the scope before the deadline, nothing is required",
            sentence.timing_span,
            "the response is required only if the whole duration fits into the scope",
        )
    if scope.kind in (s.ScopeKind.AFTER, s.ScopeKind.ONLY_AFTER):
        yield _warning(
            Code.FIRST_RUN_ONLY,
            f"only the first stretch of `{m}` counts; later ones change nothing",
            scope.span,
            f"to begin again each time, use a condition: `upon !({m})`",
        )
    if scope.kind is s.ScopeKind.BEFORE:
        yield _warning(
            Code.BEFORE_NOTHING,
            f"if `{m}` is true at the first tick, nothing is required",
            scope.span,
            f"if `{m}` can be true there, state what must hold at the start in another requirement",
        )


def _edge(condition: s.Condition | None) -> Iterator[Diagnostic]:
    if condition is None or condition.word not in ("when", "if", "where", "unless"):
        return
    if condition.kind is not s.ConditionKind.TRIGGER:
        return
    p = expression(condition.expression)
    yield _warning(
        Code.EDGE_TRIGGER,
        f"`{condition.word}` triggers only at the ticks at which `{p}` becomes true",
        condition.span,
        f"write `whenever {p}` to trigger at every tick at which it is true, else `upon {p}`",
    )


def _warning(code: Code, message: str, span: Span | None, fix: str) -> Diagnostic:
    return Diagnostic(code, message, span, help=fix, severity=Severity.WARNING)
