"""Groups of runs: by scenario, else by folder, else by name without its number."""

from __future__ import annotations

import re
from collections.abc import Sequence

from fretc.report.model.front import ColumnRun, RunGroup
from fretc.report.sections.runs import AuditedFile, alike, file_names, inner_paths

SCENARIO = "scenario"
"""The label by which runs are grouped."""
_NUMBERED = re.compile(r"([^\W\d](?:\D*[^\W\d_])?)[-_ .]?\d+")
"""`safety-off-2`: a name with a number at its end; dates do not match."""


def run_groups(runs: Sequence[AuditedFile]) -> tuple[RunGroup, ...]:
    """The runs in groups, in the order of first appearance.

    Args:
        runs: runs in the order of the evidence.
    """
    paths = inner_paths([run.facts.run for run in runs])
    names = file_names(paths)
    groups = _groups(runs, paths, names)
    members: dict[str, list[ColumnRun]] = {}
    shared = _shared(names)
    for run, group in zip(runs, groups, strict=True):
        column = ColumnRun(run.anchor, run.name, _short(run.name, group or shared))
        members.setdefault(group, []).append(column)
    return tuple(RunGroup(group, tuple(columns)) for group, columns in members.items())


def _groups(
    runs: Sequence[AuditedFile], paths: Sequence[Sequence[str]], names: Sequence[str]
) -> Sequence[str]:
    """The group of each run; all "" if there are no groups."""
    scenarios = [_scenario(run) for run in runs]
    if all(scenarios):
        return scenarios
    folders = ["/".join(path[:-1]) or "." for path in paths]
    if len({*folders}) > 1:
        return folders
    matches = [_NUMBERED.fullmatch(name) for name in names]
    series = [match[1] for match in matches if match]
    return series if len({*series}) < len(runs) == len(series) else [""] * len(runs)


def _scenario(run: AuditedFile) -> str:
    labels = run.facts.labels
    return labels.get(SCENARIO, "")


def _shared(names: Sequence[str]) -> str:
    """The common prefix of names, up to a separator."""
    prefix = names[0][: alike(names)] if len(names) > 1 else ""
    return re.sub(r"[^-_ ./]*\Z", "", prefix)


def _short(name: str, prefix: str) -> str:
    """`2` of `safety-off-2` in the group `safety-off`."""
    rest = name.removeprefix(prefix) if prefix else name
    return rest.lstrip("-_ ./") or name
