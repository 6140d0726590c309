"""Groups of runs: by scenario, else by folder, else by their names without a last number."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from itertools import takewhile

from fretc.report.model.front import ColumnRun, RunGroup
from fretc.report.sections.runs import Run

_NUMBERED = re.compile(r"([^\W\d](?:\D*[^\W\d_])?)[-_ .]?\d+")
"""`safety-off-2`: a name in letters, and one number. A date is no such name."""
_SEPARATOR = re.compile(r"[/\\]+")


def run_groups(runs: Sequence[Run]) -> tuple[RunGroup, ...]:
    """The runs in groups, in the order in which groups and runs come first.

    Args:
        runs: in the order of the evidence.
    """
    paths = _inner([_SEPARATOR.split(run.facts.run) for run in runs])
    names = _names(paths)
    groups = _groups(runs, paths, names)
    members: dict[str, list[ColumnRun]] = {}
    shared = _shared(names)
    for run, group, name in zip(runs, groups, _distinct(names, runs), strict=True):
        column = ColumnRun(run.anchor, name, _short(name, group or shared))
        members.setdefault(group, []).append(column)
    return tuple(RunGroup(group, tuple(columns)) for group, columns in members.items())


def _groups(
    runs: Sequence[Run], paths: Sequence[Sequence[str]], names: Sequence[str]
) -> Sequence[str]:
    """The group of each run; all of them empty where there are none."""
    scenarios = [_scenario(run) for run in runs]
    if all(scenarios):
        return scenarios
    folders = ["/".join(path[:-1]) or "." for path in paths]
    if len({*folders}) > 1:
        return folders
    matches = [_NUMBERED.fullmatch(name) for name in names]
    series = [match[1] for match in matches if match]
    return series if len({*series}) < len(runs) == len(series) else [""] * len(runs)


def _scenario(run: Run) -> str:
    labels = run.facts.labels
    return labels.get("scenario", "")


def _inner(paths: Sequence[list[str]]) -> list[list[str]]:
    """The paths without the folders that all of them share: no place of one machine is said."""
    shared = _alike([path[:-1] for path in paths])
    return [path[shared:] for path in paths]


def _alike(sequences: Sequence[Sequence[str]]) -> int:
    """With how many of the same elements all of them begin."""
    return sum(1 for _ in takewhile(lambda same: len({*same}) == 1, zip(*sequences, strict=False)))


def _names(paths: Sequence[Sequence[str]]) -> list[str]:
    """The name of each file, without an ending that all share; with its folder where needed."""
    endings = {path[-1].rpartition(".")[1:] for path in paths}
    cut = sum(map(len, next(iter(endings)))) if len(endings) == 1 else 0
    cut = cut if all(len(path[-1]) > cut for path in paths) else 0
    files = [path[-1][: len(path[-1]) - cut] for path in paths]
    if len({*files}) == len(files):
        return files
    return ["/".join((*path[:-1], file)) for path, file in zip(paths, files, strict=True)]


def _distinct(names: Sequence[str], runs: Sequence[Run]) -> list[str]:
    """A name that several runs have, with the number of the run."""
    counts = Counter(names)
    return [
        name if name and counts[name] == 1 else f"{name} ({run.label.lower()})".lstrip()
        for name, run in zip(names, runs, strict=True)
    ]


def _shared(names: Sequence[str]) -> str:
    """What the names of several runs begin with, up to a separator."""
    prefix = names[0][: _alike(names)] if len(names) > 1 else ""
    return re.sub(r"[^-_ ./]*\Z", "", prefix)


def _short(name: str, prefix: str) -> str:
    """`2` of `safety-off-2` in the group `safety-off`."""
    rest = name.removeprefix(prefix) if prefix else name
    return rest.lstrip("-_ ./") or name
