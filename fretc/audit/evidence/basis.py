"""What a verdict rests on beside its log, as fingerprints of canonical meaning.

This is the one notion of change. Evidence records the basis of each of its results, a lock that of
each review, and a later comparison uses the basis of now.

Fingerprints are of canonical meaning (`fretish.bindings.canonical`), and only what a requirement
reads is part of its basis.
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
"""The parts that evidence records of each result; the version of fretc is that of its file."""

_WHY = {
    SENTENCE: "the sentence has changed since the audit",
    PARAMS: "the numbers in `params` have changed since the audit",
    CLOCK: "the clock has changed since the audit",
    TOPICS: "the topics that the audit reads have changed since the audit",
    BINDINGS: "the bindings have changed since the audit",
    MONITOR: "the generated monitor has changed since the audit",
    FRETC: "the audit was made with another version of fretc",
}

Basis = Mapping[str, str]
"""Each of `KINDS`, perhaps `FRETC` → its SHA-256 (of `FRETC` the version itself)."""


def basis(
    entry: RequirementEntry,
    requirement: FormalizedRequirement | None,
    declarations: Declarations | None,
    topics: Iterable[str],
    monitor_sha256: str | None = None,
) -> Basis:
    """What a verdict on a requirement would rest on now.

    Args:
        entry: as written.
        requirement: None where it cannot be formalized: its wording stands for its sentence.
        declarations: None where there are no bindings; what they say is then an empty text.
        topics: which an audit of the project reads; its ticks begin with their messages.
        monitor_sha256: of the monitor of the requirement, where it is known.
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
    """Of an empty text if nothing is formalized, or its monitor would be too deep for Python."""
    return sha256(
        monitor.text(requirement) if requirement and monitor.is_readable(requirement) else ""
    )


def of_bindings(
    requirement: FormalizedRequirement | None, declarations: Declarations | None
) -> str:
    """What a verdict would rest on of the bindings; empty where there is none."""
    return digest(bound(declarations, requirement.watched)) if declarations and requirement else ""


def outdated(recorded: Mapping[str, object], now: Basis) -> tuple[str, ...]:
    """The kinds that are not as they were recorded, without what only follows from another one.

    Args:
        recorded: by an audit; what it does not have was not known to it.
        now: what is compared is what this has.
    """
    kinds = [kind for kind in (FRETC, *KINDS) if kind in now]
    changed = {kind for kind in kinds if recorded.get(kind) != now[kind]}
    follows = set()
    if changed & {FRETC, SENTENCE, CLOCK}:
        follows.add(MONITOR)
    if now.get(CLOCK) == "":  # there are no bindings at all
        follows |= {CLOCK, TOPICS}
    return tuple(kind for kind in kinds if kind in changed - follows)


def why(kind: str) -> str:
    """Why a result is not current, in words."""
    return _WHY[kind]


def of_all(bindings: Mapping[str, str]) -> str:
    """One SHA-256 for what the bindings say of several requirements: id → that of each."""
    return digest(dict(bindings))
