"""The inputs of a verdict other than its log, as fingerprints of their canonical meaning.

This is the one notion of change. Evidence records the inputs of each of its results, a lock those
of each review, and a later comparison uses the inputs of now.

Fingerprints are of canonical meaning (`fretish.bindings.canonical`), and only what a requirement
reads is one of its inputs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor
from fretish.bindings.canonical import bound, clock, digest, parameter
from fretish.bindings.declarations import Declarations
from fretish.documents import RequirementEntry

SENTENCE, PARAMS, CLOCK, TOPICS = "sentence", "params", "clock", "topics"
BINDINGS, MONITOR, FRETC = "bindings", "monitor", "fretc"
KINDS = (SENTENCE, PARAMS, CLOCK, TOPICS, BINDINGS, MONITOR)
"""The inputs that evidence records for each result; the version of fretc is recorded once for each
file."""

_WHY = {
    SENTENCE: "the sentence has changed since the audit",
    PARAMS: "the numbers in `params` have changed since the audit",
    CLOCK: "the clock has changed since the audit",
    TOPICS: "the topics that the audit reads have changed since the audit",
    BINDINGS: "the bindings have changed since the audit",
    MONITOR: "the generated monitor has changed since the audit",
    FRETC: "the audit was made with another version of fretc",
}

VerdictInputs = Mapping[str, str]
"""SHA-256 of each of `KINDS`; for `FRETC` the version itself."""


def of_requirement(
    entry: RequirementEntry,
    requirement: FormalizedRequirement | None,
    declarations: Declarations | None,
    topics: Iterable[str],
    monitor_sha256: str | None = None,
) -> VerdictInputs:
    """The verdict inputs of a requirement in its present state.

    Args:
        entry: the requirement as written.
        requirement: None: it cannot be formalized, and its wording is hashed instead of its
            formula.
        declarations: None: there are no bindings, and an empty text is hashed instead.
        topics: the topics that an audit of the project reads; the first tick depends on their
            messages.
        monitor_sha256: SHA-256 of the requirement's monitor, if it is known.
    """
    wording = " ".join(entry.wording.text.split())
    return {
        SENTENCE: requirement.fingerprint if requirement else sha256(wording),
        PARAMS: digest({name: parameter(text) for name, text in entry.params.items()}),
        CLOCK: digest(clock(declarations.clock)) if declarations else "",
        TOPICS: digest(sorted(set(topics))) if declarations else "",
        BINDINGS: of_bindings(requirement, declarations),
        MONITOR: monitor_sha256 or _of_monitor(requirement),
    }


def _of_monitor(requirement: FormalizedRequirement | None) -> str:
    """SHA-256 of the monitor, or of an empty text if there is none or Python cannot parse it."""
    return sha256(
        monitor.text(requirement) if requirement and monitor.is_readable(requirement) else ""
    )


def of_bindings(
    requirement: FormalizedRequirement | None, declarations: Declarations | None
) -> str:
    """SHA-256 of the bindings that a verdict depends on; empty without bindings."""
    return digest(bound(declarations, requirement.watched)) if declarations and requirement else ""


def outdated(recorded: Mapping[str, object], now: VerdictInputs) -> tuple[str, ...]:
    """The kinds of inputs that differ from the recorded ones, without mere consequences of others.

    Args:
        recorded: the inputs at the time of the audit; kinds that it lacks are not compared.
        now: the inputs at present; only its kinds are compared.
    """
    kinds = [kind for kind in (FRETC, *KINDS) if kind in now]
    changed = {kind for kind in kinds if recorded.get(kind) != now[kind]}
    follows = set()
    if changed & {FRETC, SENTENCE, CLOCK}:
        follows.add(MONITOR)
    if now.get(CLOCK) == "":  # there are no bindings
        follows |= {CLOCK, TOPICS}
    return tuple(kind for kind in kinds if kind in changed - follows)


def why(kind: str) -> str:
    """The reasons why a result is not current."""
    return _WHY[kind]


def of_all(bindings: Mapping[str, str]) -> str:
    """One SHA-256 of the bindings of several requirements."""
    return digest(dict(bindings))
