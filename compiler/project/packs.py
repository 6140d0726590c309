"""Packs: the requirements, bindings and hazards of a kind of robot, to begin a project with.

A pack is a folder of project files. Those that ship with fretc are in the templates.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from compiler.files.templating import template_root
from compiler.files.text_files import read
from compiler.project.folder import load
from compiler.project.paths import BINDINGS, HAZARDS, requirement_files, sibling_path
from fretish.diagnostics.diagnostic import Diagnostic, has_errors
from fretish.diagnostics.messages import diagnostic


def pack_names() -> list[str]:
    """The packs that ship with fretc, in alphabetical order."""
    return sorted(each.name for each in _root().iterdir() if each.is_dir())


def read_pack(name: str) -> Mapping[str, str] | list[Diagnostic]:
    """The text of each file of a pack, by its name.

    Args:
        name: one of `pack_names()`, or the path of a folder with `.fret` files.

    Returns:
        The texts, in which `check` finds no error; or why the pack cannot be used.
    """
    folder = _root() / name if name in pack_names() else Path(name)
    if not folder.is_dir():
        return [diagnostic("no_pack", name=name, names=", ".join(pack_names()))]
    listed = requirement_files(str(folder))
    if isinstance(listed, Diagnostic):
        return [listed]
    beside = {each: sibling_path(str(folder), each) for each in (BINDINGS, HAZARDS)}
    paths = [*listed, *filter(None, beside.values())]
    project = load(listed, beside[BINDINGS], beside[HAZARDS])
    own = [each for each in project.diagnostics if _is_about(each, paths)]
    if has_errors(own):
        return own
    texts: dict[str, str] = {}
    for path in paths:
        source = read(path)
        if isinstance(source, Diagnostic):
            return [source]
        texts[Path(path).name] = source.text
    return texts


def _is_about(mistake: Diagnostic, paths: Sequence[str]) -> bool:
    """Whether a diagnostic is about the files of a pack, not about settings above its folder."""
    return mistake.span is None or mistake.span.source.name in paths


def _root() -> Path:
    return template_root() / "packs"
