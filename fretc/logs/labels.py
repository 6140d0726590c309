"""Labels of a run, such as robot and version, from the sources in `[run.label]` of the bindings.

The first source with a value counts; a source with another value is F552, and a label without a
value is F553. `--label` of a command takes precedence over all sources. Values are texts of
untrusted sources: their length is limited here, and they are escaped wherever they are shown.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

from fretish.bindings.declarations import LabelSource
from fretish.bindings.tables.labels import MOST_LABELS, is_label
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.reading import name_patterns

LONGEST = 200
"""The most characters of a value; a longer one is ignored, because a cut one could be that of
another run."""
_SHOWN = 60
"""Characters of a value that a message shows."""
NO_METADATA: Mapping[str, tuple[str, ...]] = MappingProxyType({})

Labels = Mapping[str, str]


def labels(
    declared: Mapping[str, Sequence[LabelSource]],
    run: str,
    described: Mapping[str, tuple[str, ...]] = NO_METADATA,
) -> tuple[Labels, tuple[Diagnostic, ...]]:
    """The labels of a run, and diagnostics about them.

    Args:
        declared: each label with its sources.
        run: the path of its log, as named on the command line.
        described: the metadata of the log: `build.version` → values.
    """
    found: dict[str, str] = {}
    diagnostics: list[Diagnostic] = []
    for name, sources in declared.items():
        values = list(dict.fromkeys(_values(name, sources, run, described)))
        sound = [value for value in values if 0 < len(value) <= LONGEST]
        if sound:
            found[name] = sound[0]
        else:
            diagnostics.append(_none(name, sources, is_given=bool(values)))
        if len(sound) > 1:
            diagnostics.append(_conflict(name))
    return found, tuple(diagnostics)


def path_label(name: str, sources: Sequence[LabelSource], run: str) -> tuple[str, ...]:
    """The value of a label in the path of a log."""
    patterns = [source.text for source in sources if source.is_path]
    matches = [name_patterns.match(pattern, run) for pattern in patterns]
    return tuple(each[name] for each in matches if each is not None)


def _values(
    name: str,
    sources: Sequence[LabelSource],
    run: str,
    described: Mapping[str, tuple[str, ...]],
) -> Iterator[str]:
    for source in sources:
        if source.is_path:
            yield from path_label(name, [source], run)
        else:
            yield from described.get(source.text, ())


def with_overrides(before: Labels, given: Labels) -> tuple[Labels, tuple[Diagnostic, ...]]:
    """The labels of a run with those of the command, and F552 for each that differs."""
    clashes = (_conflict(name) for name, value in given.items() if before.get(name, value) != value)
    return {**before, **given}, tuple(clashes)


def given(texts: Sequence[str]) -> Labels | Diagnostic:
    """The labels that a command gives: `version=2.1`."""
    labels_given: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        if not equals or not is_label(name) or not 0 < len(value) <= LONGEST:
            return diagnostic("not_a_label", text=_short(text), longest=LONGEST)
        if name in labels_given:
            return diagnostic("label_given_twice", name=name)
        labels_given[name] = value
    if len(labels_given) > MOST_LABELS:
        return diagnostic("too_many_labels", count=len(labels_given), most=MOST_LABELS)
    return labels_given


def _conflict(name: str) -> Diagnostic:
    """F552, with equal text for all logs, so that many of them are one warning."""
    return diagnostic("label_conflict", name=name)


def _none(name: str, sources: Sequence[LabelSource], *, is_given: bool) -> Diagnostic:
    """F553."""
    texts = (f"{'path' if source.is_path else 'metadata'}:{source.text}" for source in sources)
    where = " or ".join(f"`{text}`" for text in texts)
    what = f"is empty, or longer than {LONGEST} characters" if is_given else "has no value"
    return diagnostic("no_label", name=name, where=where, what=what)


def _short(text: str) -> str:
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."
