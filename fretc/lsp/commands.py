"""The commands of code lenses, answered as text for an editor that does not run them itself."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from shlex import quote

from fretc.lsp.view import View
from fretish.documents import RequirementEntry

EXPLAIN, PLAY, AUDIT = "fretc.explain", "fretc.play", "fretc.audit"
VERIFY, TEST = "fretc.verify", "fretc.test"
_MOST_TICKS = 1000
"""The longest duration whose diagram is drawn: it has a column for each tick."""


def answer(view: View, command: str, id: str) -> str | None:
    """The text that answers a command.

    Args:
        view: the file that has the requirement.
        command: a key of `COMMANDS`.
        id: the id of the requirement.

    Returns:
        Lines of text; None if the file has no such requirement.
    """
    entry = next((each for each in view.entries() if each.id == id), None)
    return None if entry is None else "\n".join(COMMANDS[command](view, entry))


def _explanation(view: View, entry: RequirementEntry) -> Iterator[str]:
    from compiler.explanation.explain import explanation, text

    requirement = view.formalized(entry)
    if requirement is None:
        yield f"{entry.id} has no formulas: first fix its errors"
    elif (requirement.ticks or 0) > _MOST_TICKS:
        yield f"its duration has more than {_MOST_TICKS} ticks, too many for a diagram"
    else:
        yield text(explanation(requirement)).rstrip()


def _audit(view: View, entry: RequirementEntry) -> Iterator[str]:
    status = view.open_project.statuses.get(entry)
    if status is not None:
        yield f"{entry.id}: {status.verdict}"
        yield from (f"  {each.comparison}: {each.values}" for each in status.ranges if each.values)
    yield f"to audit again: fretc audit LOG... --requirements {_folder(view)}"


def _verification(view: View, entry: RequirementEntry) -> Iterator[str]:
    status = view.open_project.statuses.get(entry)
    for proof in status.proofs if status is not None else ():
        stale = f", stale ({'; '.join(proof.suspicions)})" if proof.suspicions else ""
        yield f"{proof.layer}: {proof.claim}: {proof.mark.word}{stale}"
    yield f"to verify: fretc verify {_file(view)}"


def _play(view: View, entry: RequirementEntry) -> Iterator[str]:
    yield f"to play with {entry.id}: fretc play {_file(view)}"


def _test(view: View, entry: RequirementEntry) -> Iterator[str]:
    yield f"to generate tests: fretc test {_file(view)}"


COMMANDS: Mapping[str, Callable[[View, RequirementEntry], Iterator[str]]] = {
    EXPLAIN: _explanation,
    PLAY: _play,
    AUDIT: _audit,
    VERIFY: _verification,
    TEST: _test,
}
"""Command → the lines that answer it."""


def _folder(view: View) -> str:
    return quote(view.open_project.name)


def _file(view: View) -> str:
    return quote(view.open_project.relative(view.path))
