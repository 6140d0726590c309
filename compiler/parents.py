"""Requirements that live in other tools, as parents of ours: their ids and titles.

Sources: StrictDoc, the SDoc text grammar; Doorstop, item files; sphinx-needs, needs.json; OMG,
Requirements Interchange Format (ReqIF) 1.2.
"""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml

from compiler.settings import Settings
from fretish.diagnostic import Code, Diagnostic
from fretish.source import Source, Span


@dataclass(frozen=True, slots=True)
class Parent:
    """One requirement of another tool."""

    id: str
    title: str
    text: str
    source: str
    """The document that it is in."""


class UnreadableError(Exception):
    """The document is not what its name says; the text says why."""


def parents(settings: Settings) -> tuple[Mapping[str, Parent], tuple[Diagnostic, ...]]:
    """Every parent in the documents of the settings, and what is wrong with these."""
    found: dict[str, Parent] = {}
    wrong = []
    for name in settings.parents:
        try:
            for parent in _read(settings.folder / name, name):
                found.setdefault(parent.id, parent)
        except (UnreadableError, OSError) as error:
            why = error.strerror if isinstance(error, OSError) else str(error)
            wrong.append(_unreadable(settings, name, why or str(error)))
    return found, tuple(wrong)


def _unreadable(settings: Settings, name: str, why: str) -> Diagnostic:
    tables = settings.tables
    place = tables.value("tool", "fretc", "parents") if tables else Source(name, "").span()
    return Diagnostic(
        Code.BAD_PARENTS,
        f"the parents in `{name}` cannot be read: {why}",
        _within(place, name),
        help="name a .sdoc file, a folder of Doorstop, needs.json, or a .reqif file",
    )


def _within(place: Span, name: str) -> Span:
    at = place.text.find(name)
    return place.part(at, at + len(name)) if at >= 0 else place


def _read(path: Path, name: str) -> Iterator[Parent]:
    if path.is_dir():
        return _doorstop(path, name)
    match path.suffix.lower():
        case ".sdoc":
            return _strictdoc(_text(path), name)
        case ".json":
            return _needs(_text(path), name)
        case ".reqif":
            return _reqif(_text(path), name)
        case ".reqifz":
            return _reqifz(path, name)
        case _:
            raise UnreadableError("no format is known by that ending")


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise UnreadableError("it is not UTF-8 text") from None


# StrictDoc -------------------------------------------------------------------------------------

_NODE = re.compile(r"^\[(?:\[|/)?(?P<kind>[A-Z][A-Z0-9_]*)\]?\]\s*$", re.MULTILINE)
_FIELD = re.compile(r"^(?P<name>[A-Z][A-Z0-9_]*): (?P<value>.*)$", re.MULTILINE)
_BLOCK = re.compile(
    r"^(?P<name>[A-Z][A-Z0-9_]*): >>>\n(?P<value>.*?)^<<<$", re.MULTILINE | re.DOTALL
)


def _strictdoc(text: str, name: str) -> Iterator[Parent]:
    """Every node with a UID, of whatever type the grammar of the document has."""
    if not text.lstrip().startswith("[DOCUMENT]"):
        raise UnreadableError("it does not begin with `[DOCUMENT]`")
    nodes = list(_NODE.finditer(text))
    for node, following in zip(nodes, [*nodes[1:], None], strict=True):
        if node["kind"] in ("DOCUMENT", "GRAMMAR", "TEXT"):
            continue
        body = text[node.end() : following.start() if following else len(text)]
        blocks = {m["name"]: m["value"] for m in _BLOCK.finditer(body)}
        fields = {m["name"]: m["value"] for m in _FIELD.finditer(_BLOCK.sub("", body))} | blocks
        if "UID" in fields:
            yield _parent(fields["UID"], fields.get("TITLE"), fields.get("STATEMENT"), name)


def _parent(id: str, title: str | None, text: str | None, source: str) -> Parent:
    return Parent(id.strip(), (title or "").strip(), (text or "").strip(), source)


# Doorstop --------------------------------------------------------------------------------------


def _doorstop(folder: Path, name: str) -> Iterator[Parent]:
    """Every active item of the documents in the folder and below it."""
    documents = sorted(path.parent for path in folder.rglob(".doorstop.yml"))
    if not documents:
        raise UnreadableError("no `.doorstop.yml` is in it")
    for document in documents:
        for path in sorted(document.glob("*.yml")):
            if path.name == ".doorstop.yml":
                continue
            item = _yaml(path)
            if item.get("active", True):
                header, text = str(item.get("header") or ""), str(item.get("text") or "")
                yield _parent(path.stem, header, text, name)


def _yaml(path: Path) -> Mapping[str, Any]:
    try:
        found = yaml.safe_load(_text(path))
    except yaml.YAMLError:
        raise UnreadableError(f"{path.name} is not YAML") from None
    if not isinstance(found, dict):
        raise UnreadableError(f"{path.name} is no item")
    return found


# sphinx-needs ----------------------------------------------------------------------------------


def _needs(text: str, name: str) -> Iterator[Parent]:
    """The needs of the current version."""
    try:
        data = json.loads(text)
    except (ValueError, RecursionError):
        raise UnreadableError("it is not JSON") from None
    versions = data.get("versions") if isinstance(data, dict) else None
    if not isinstance(versions, dict) or not versions:
        raise UnreadableError("it has no `versions`, as a needs.json has")
    current = data.get("current_version")
    version = versions.get(current) or versions[sorted(versions)[-1]]
    needs = version.get("needs") if isinstance(version, dict) else None
    if not isinstance(needs, dict):
        raise UnreadableError("its version has no `needs`")
    for id, need in needs.items():
        if isinstance(need, dict):
            content = need.get("content", need.get("description"))
            yield _parent(id, str(need.get("title") or ""), str(content or ""), name)


# ReqIF -----------------------------------------------------------------------------------------

_NAMES = ("ReqIF.ForeignID", "ReqIF.Name", "ReqIF.ChapterName", "ReqIF.Text", "UID", "TITLE")


def _reqifz(path: Path, name: str) -> Iterator[Parent]:
    try:
        with zipfile.ZipFile(path) as archive:
            inside = sorted(n for n in archive.namelist() if n.lower().endswith(".reqif"))
            texts = [archive.read(n).decode("utf-8-sig") for n in inside]
    except (zipfile.BadZipFile, UnicodeDecodeError):
        raise UnreadableError("it is no archive of ReqIF files") from None
    for text in texts:
        yield from _reqif(text, name)


def _reqif(text: str, name: str) -> Iterator[Parent]:
    """Every SPEC-OBJECT, by its foreign id where it has one, else by its identifier."""
    if "<!ENTITY" in text:
        raise UnreadableError("it declares entities")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise UnreadableError(f"it is not XML: {error}") from None
    if _tag(root) != "REQ-IF":
        raise UnreadableError("its root is no `REQ-IF`")
    names = {
        node.get("IDENTIFIER", ""): node.get("LONG-NAME", "")
        for node in root.iter()
        if _tag(node).startswith("ATTRIBUTE-DEFINITION-")
    }
    for node in root.iter():
        if _tag(node) == "SPEC-OBJECT":
            yield _spec_object(node, names, name)


def _tag(node: ElementTree.Element) -> str:
    return str(node.tag).rpartition("}")[2]


def _spec_object(node: ElementTree.Element, names: Mapping[str, str], source: str) -> Parent:
    values: dict[str, str] = {}
    for value in node.iter():
        if not _tag(value).startswith("ATTRIBUTE-VALUE-"):
            continue
        refs = [ref.text or "" for ref in value.iter() if _tag(ref).endswith("-REF")]
        known = next((names[ref] for ref in refs if ref in names), "")
        if known in _NAMES:
            content = next((part for part in value.iter() if _tag(part) == "THE-VALUE"), None)
            said = "".join(content.itertext()) if content is not None else ""
            values[known] = value.get("THE-VALUE", said)
    id = values.get("ReqIF.ForeignID") or values.get("UID") or node.get("IDENTIFIER", "")
    title = values.get("ReqIF.Name") or values.get("ReqIF.ChapterName") or values.get("TITLE")
    return _parent(id or "", title or node.get("LONG-NAME"), values.get("ReqIF.Text"), source)
