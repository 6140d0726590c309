"""`--json`: the report for programs, with each result and each run in full.

The results are read and written in groups, because they may not fit into memory.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, fields, is_dataclass, replace
from typing import Any

from compiler.files.templating import to_json
from fretc.report.across.assembly import across
from fretc.report.model.views import ReportView, RequirementView
from fretc.report.sections.details import Details

_AT_ONCE = 2_000
"""Maximum number of results that are read at once, unless one requirement has more."""


def json_pieces(report: ReportView, details: Details) -> Iterator[str]:
    """The JSON text in pieces."""
    anchors = [view.anchor for view in report.requirements]
    report = replace(report, across=across(details, anchors, len(anchors)))
    runs = (to_json(asdict(run), "    ") for run in details.run_views(report.runs))
    requirements = _requirements(report.requirements, details)
    yield from _object(report, {"runs": runs, "requirements": requirements}, "")
    yield "\n"


def _requirements(views: Sequence[RequirementView], details: Details) -> Iterator[str]:
    for group in _groups(views):
        results: dict[str, list[str]] = {view.anchor: [] for view in group}
        for row, result in details.results(row for view in group for row in view.results):
            results[row.section].append(to_json(asdict(result), "        "))
        histograms = dict(details.histograms(view.anchor for view in group))
        for view in group:
            whole = replace(view, histograms=histograms[view.anchor])
            own = {"results": results.pop(view.anchor)}
            yield "".join(_object(whole, own, "    "))


def _groups(views: Sequence[RequirementView]) -> Iterator[list[RequirementView]]:
    """The requirements in their order, in groups whose results are read at once."""
    group: list[RequirementView] = []
    for view in views:
        if group and sum(len(member.results) for member in (*group, view)) > _AT_ONCE:
            yield group
            group = []
        group.append(view)
    yield group


def _object(view: Any, written: Mapping[str, Iterable[str]], indent: str) -> Iterator[str]:
    """A view as a JSON object in the layout of `to_json`.

    Args:
        view: a dataclass.
        written: field → elements, for fields that are arrays of views.
        indent: indentation of the lines of the object.
    """
    inner = f"{indent}  "
    separator = f"{{\n{inner}"
    for name in (field.name for field in fields(view)):
        yield f'{separator}"{name}": '
        if name in written:
            yield from _array(written[name], inner)
        else:
            yield to_json(_plain(getattr(view, name)), inner)
        separator = f",\n{inner}"
    yield f"\n{indent}}}"


def _array(elements: Iterable[str], indent: str) -> Iterator[str]:
    separator, closing = f"[\n{indent}  ", "[]"
    for element in elements:
        yield f"{separator}{element}"
        separator, closing = f",\n{indent}  ", f"\n{indent}]"
    yield closing


def _plain(value: Any) -> Any:
    """The value of a field, with dataclasses converted to plain values."""
    if is_dataclass(value) and not isinstance(value, type):
        return asdict(value)
    if isinstance(value, tuple):
        return [_plain(each) for each in value]
    return dict(value) if isinstance(value, Mapping) else value
