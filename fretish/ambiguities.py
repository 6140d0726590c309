"""Warnings for sentences that many readers misunderstand."""

from __future__ import annotations

from collections.abc import Iterator

from fretish import syntax as s
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
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
        yield diagnostic("no_timing", sentence.component_span)
    scope = sentence.scope
    if scope is None:
        return
    m = expression(scope.mode)
    if s.deadline(sentence.timing) and scope.kind in _ENDS:
        yield diagnostic("short_scope", sentence.timing_span, mode=m)
    if scope.kind in (s.ScopeKind.AFTER, s.ScopeKind.ONLY_AFTER):
        yield diagnostic("first_stretch_only", scope.span, mode=m)
    if scope.kind is s.ScopeKind.BEFORE:
        yield diagnostic("before_nothing", scope.span, mode=m)


def _edge(condition: s.Condition | None) -> Iterator[Diagnostic]:
    if condition is None or condition.word not in ("when", "if", "where", "unless"):
        return
    if condition.kind is not s.ConditionKind.TRIGGER:
        return
    p = expression(condition.expression)
    yield diagnostic("edge_trigger", condition.span, word=condition.word, expression=p)
