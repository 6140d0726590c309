"""The table `[run.label]` of `bindings.toml`: labels of runs."""

from __future__ import annotations

import re

from fretish.bindings.declarations import LabelSource
from fretish.bindings.tables.fields import Fields
from fretish.diagnostics.messages import diagnostic
from fretish.reading import name_patterns

_RUN = ("label",)
_LABEL = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,49}", re.ASCII)
MOST_LABELS = 32
_MOST_SOURCES, _LONGEST_SOURCE = 8, 200
_LABEL_FORM = '`version = "metadata:build.version"` or `scenario = "path:{scenario}-*.mcap"`'


class LabelTable(Fields):
    """Reader of the table `[run.label]`."""

    def labels(self) -> dict[str, tuple[LabelSource, ...]]:
        """Label → its sources."""
        table = self.tables.data.get("run", {})
        labels = table.get("label", {}) if isinstance(table, dict) else None
        if not isinstance(labels, dict) or len(labels) > MOST_LABELS:
            span = self.tables.value("run")
            self._say(diagnostic("bad_labels", span, most=MOST_LABELS, form=_LABEL_FORM))
            return {}
        self._check_keys(table, _RUN, "[run]", "run")
        return {name: self._label_sources(name, written) for name, written in labels.items()}

    def _label_sources(self, name: str, written: object) -> tuple[LabelSource, ...]:
        at = ("run", "label", name)
        if not is_label(name):
            self._say(diagnostic("bad_label_name", self.tables.value(*at), name=name))
            return ()
        texts = written if isinstance(written, list) else [written]
        sources = [_label_source(name, text) for text in texts]
        wrong = next((source for source in sources if isinstance(source, str)), None)
        if wrong is None and not 0 < len(sources) <= _MOST_SOURCES:
            wrong = f"a label has 1 to {_MOST_SOURCES} sources"
        if wrong is not None:
            span = self.tables.value(*at)
            self._say(
                diagnostic("bad_label_source", span, name=name, wrong=wrong, form=_LABEL_FORM)
            )
            return ()
        return tuple(source for source in sources if isinstance(source, LabelSource))


def is_label(name: str) -> bool:
    """Whether the text can be the name of a label."""
    return _LABEL.fullmatch(name) is not None


def _label_source(name: str, written: object) -> LabelSource | str:
    """The source of a label, or the reason why it is wrong."""
    kind, _, text = written.partition(":") if isinstance(written, str) else ("", "", "")
    if kind not in ("metadata", "path") or not 0 < len(text) <= _LONGEST_SOURCE:
        return "it is neither `metadata:RECORD.KEY` nor `path:PATTERN`"
    if kind == "metadata":
        return LabelSource(False, text) if "." in text else "a record has keys: `RECORD.KEY`"
    names = name_patterns.names(text)
    if isinstance(names, str):
        return names
    return LabelSource(True, text) if name in names else f"`{{{name}}}` is not in the pattern"
