"""Parent requirements in documents of other tools: their ids, titles and texts.

Only each tool's own interpretation is used: for StrictDoc, Doorstop and sphinx-needs the export
that the tool writes, and for ReqIF the library `reqif`. An export is plain data, so no content of
an untrusted document is executed; StrictDoc's library would run `strictdoc_config.py` and needs
some seventy packages; Doorstop's library follows `!include`.

Sources: StrictDoc, `strictdoc export --formats=json`; Doorstop, `doorstop export --yaml`;
sphinx-needs, needs.json; OMG, Requirements Interchange Format (ReqIF) 1.2.
"""

from __future__ import annotations

import lzma
import zlib
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from compiler.files.checked_json import SchemaError, plain
from compiler.files.settings import Settings
from compiler.files.text_files import open_regular
from fretish.classes.frozen import dataclass
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.extras import missing_extra
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source, Span
from fretish.reading.limits import with_budget
from fretish.reading.yaml_text import loaded

if TYPE_CHECKING:
    from zipfile import ZipFile


@dataclass(frozen=True, slots=True)
class Parent:
    """One requirement of another tool."""

    id: str
    title: str
    text: str
    source: str
    """The path of its document."""


class ParentsError(Exception):
    """The document is not in the format of its name; the message says why."""


def parents(settings: Settings) -> tuple[Mapping[str, Parent], tuple[Diagnostic, ...]]:
    """The parents in the documents of the settings, by id; and diagnostics."""
    by_id: dict[str, Parent] = {}
    diagnostics = []
    for name in settings.parents:
        reading = partial(_all, settings.folder / name, name)
        try:
            _demand_within(settings, settings.folder / name)
            read = with_budget(_size(settings.folder / name), _place(settings, name), reading)
            if isinstance(read, Diagnostic):
                diagnostics.append(read)
                continue
            for parent in read:
                by_id.setdefault(parent.id, parent)
        except ModuleNotFoundError:
            diagnostics.append(_missing_extra(settings, name))
        except (ParentsError, OSError) as error:
            why = error.strerror if isinstance(error, OSError) else str(error)
            diagnostics.append(_unreadable(settings, name, why or str(error)))
    return by_id, tuple(diagnostics)


def _demand_within(settings: Settings, path: Path) -> None:
    """Check that a document lies in the project, since settings may come from somebody else.

    Raises:
        ParentsError: the path, or a document in it, lies outside.
    """
    for file in (path, *(sorted(path.glob("*.yml")) if path.is_dir() else ())):
        if not settings.holds(file):
            raise ParentsError(_OUTSIDE)


_OUTSIDE = "it lies outside of the project"


def _all(path: Path, name: str) -> tuple[Parent, ...]:
    return tuple(_read(path, name))


def _size(path: Path) -> int:
    """The size in bytes of a document, or of a folder of documents."""
    return sum(
        document.stat().st_size for document in (path.glob("*.yml") if path.is_dir() else [path])
    )


def _unreadable(settings: Settings, name: str, why: str) -> Diagnostic:
    return diagnostic(
        "unreadable_parents",
        _place(settings, name),
        name=name,
        why=why,
        help="to allow it, name its folder: `fretc --parents FOLDER COMMAND ...`"
        if why == _OUTSIDE
        else _EXPORTS.get(Path(name).suffix.lower(), _EXPORTS[""]),
    )


_EXPORTS = {
    ".sdoc": "name what StrictDoc writes: `strictdoc export --formats=json`, then `index.json`",
    ".yml": "name what Doorstop writes: `doorstop export --yaml all FOLDER`",
    "": "name the JSON export of StrictDoc, the YAML export of Doorstop, needs.json, or a .reqif",
}


def _missing_extra(settings: Settings, name: str) -> Diagnostic:
    need = f"the parents in `{name}` need"
    return missing_extra(need, ["reqif"], "reqif", _place(settings, name))


def _place(settings: Settings, name: str) -> Span:
    tables = settings.tables
    span = tables.value("tool", "fretc", "parents") if tables else Source(name, "").span()
    at = span.text.find(name)
    return span.part(at, at + len(name)) if at >= 0 else span


def _read(path: Path, name: str) -> Iterator[Parent]:
    if path.is_dir():
        return _exports(path, name)
    match path.suffix.lower():
        case ".json":
            return _json(_text(path), name)
        case ".yml" | ".yaml":
            return _doorstop(path, name)
        case ".reqif":
            return _reqif(_text(path), name)
        case ".reqifz":
            return _reqifz(path, name)
        case ".sdoc":
            raise ParentsError("only StrictDoc itself can read its documents reliably")
        case _:
            raise ParentsError("its extension belongs to no supported format")


_MOST = 64 * 2**20
"""Maximum number of bytes of a document."""


def _text(path: Path) -> str:
    with open_regular(path) as file:
        return _decoded(file.read(_MOST + 1))


def _decoded(data: bytes) -> str:
    if len(data) > _MOST:
        raise ParentsError(f"it is larger than {_MOST // 2**20} MiB")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise ParentsError("it is not UTF-8 text") from None


def _parent(id: str, title: str | None, text: str | None, source: str) -> Parent:
    return Parent(id.strip(), (title or "").strip(), (text or "").strip(), source)


def _json(text: str, name: str) -> Iterator[Parent]:
    """An export of StrictDoc, or of sphinx-needs."""
    try:
        data: Any = plain(text)
    except SchemaError as error:
        raise ParentsError(f"it is not JSON: {error}") from None
    if isinstance(data, dict) and isinstance(data.get("DOCUMENTS"), list):
        return _strictdoc(data["DOCUMENTS"], name)
    if isinstance(data, dict) and "versions" in data:
        return _needs(data, name)
    raise ParentsError("it has neither `DOCUMENTS` (StrictDoc) nor `versions` (sphinx-needs)")


# StrictDoc -------------------------------------------------------------------------------------

_NO_TEXT = ("UID", "MID", "TITLE", "NODES", "RELATIONS", "GRAMMAR", "OPTIONS", "STATUS", "TAGS")


def _strictdoc(documents: Sequence[Any], name: str) -> Iterator[Parent]:
    """Every node with a UID in the documents, of any type."""
    waiting = [node for document in reversed(documents) for node in _nodes(document)]
    while waiting:
        node = waiting.pop()
        uid = node.get("UID")
        if isinstance(uid, str):
            yield _parent(uid, str(node.get("TITLE") or ""), _statement(node), name)
        waiting.extend(_nodes(node))


def _nodes(node: Any) -> list[dict[str, Any]]:
    """The child nodes, in reverse order."""
    below = node.get("NODES", []) if isinstance(node, dict) else None
    if not isinstance(below, list) or not all(isinstance(child, dict) for child in below):
        raise ParentsError("its nodes are not as StrictDoc writes them")
    return below[::-1]


def _statement(node: Mapping[str, Any]) -> str:
    """The statement of a node; if its grammar has none, all of its other texts."""
    if "STATEMENT" in node:
        return str(node["STATEMENT"])
    texts = {k: v for k, v in node.items() if k not in _NO_TEXT and not k.startswith("_")}
    return "\n".join(value for value in texts.values() if isinstance(value, str))


# Doorstop --------------------------------------------------------------------------------------


def _exports(folder: Path, name: str) -> Iterator[Parent]:
    """Every document in a folder of exports."""
    if any(folder.rglob(".doorstop.yml")):
        raise ParentsError("it holds the items; `doorstop export --yaml all FOLDER` writes them")
    paths = sorted(folder.glob("*.yml"))
    if not paths:
        raise ParentsError("it has no export of Doorstop (`*.yml`)")
    for path in paths:
        yield from _doorstop(path, name)


def _doorstop(path: Path, name: str) -> Iterator[Parent]:
    """The items of one exported document; Doorstop exports the active ones."""
    try:
        document = loaded(_text(path))
    except ValueError as error:
        raise ParentsError(f"{path.name} cannot be read as YAML: {error}") from None
    if not isinstance(document, dict) or not all(_is_item(item) for item in document.values()):
        raise ParentsError(f"{path.name} is not an export of Doorstop")
    for uid, item in document.items():
        if item.get("active", True):
            yield _parent(str(uid), item.get("header"), item["text"], name)


def _is_item(item: Any) -> bool:
    if not isinstance(item, dict) or "level" not in item:
        return False
    return isinstance(item.get("text"), str) and isinstance(item.get("header", ""), str)


# sphinx-needs ----------------------------------------------------------------------------------


def _needs(data: Mapping[str, Any], name: str) -> Iterator[Parent]:
    """The needs of the current version of needs.json."""
    versions, current = data["versions"], data.get("current_version")
    if not isinstance(versions, dict) or not isinstance(current, str) or current not in versions:
        raise ParentsError("its `current_version` is not among its `versions`")
    version = versions[current]
    needs = version.get("needs") if isinstance(version, dict) else None
    if not isinstance(needs, dict):
        raise ParentsError("its version has no `needs`")
    for id, need in needs.items():
        if not isinstance(need, dict):
            raise ParentsError(f"`{id}` is not a need")
        content = need.get("content", need.get("description"))
        yield _parent(id, str(need.get("title") or ""), str(content or ""), name)


# ReqIF -----------------------------------------------------------------------------------------

_LEAST_PACKED, _RATIO = 2**22, 50
"""Limit of unpacking an archive: bytes, and bytes for each byte of the archive, because XML
compresses well."""
_NAMES = ("ReqIF.ForeignID", "ReqIF.Name", "ReqIF.ChapterName", "ReqIF.Text", "UID", "TITLE")


def _reqifz(path: Path, name: str) -> Iterator[Parent]:
    import zipfile

    try:
        with open_regular(path) as file, zipfile.ZipFile(file) as archive:
            inside = sorted(n for n in archive.namelist() if n.lower().endswith(".reqif"))
            most = _LEAST_PACKED + _RATIO * path.stat().st_size
            if sum(archive.getinfo(member).file_size for member in inside) > most:
                raise ParentsError("it unpacks to far more data than a ReqIF archive should")
            texts = [_inside(archive, member) for member in inside]
    except (zipfile.BadZipFile, zlib.error, lzma.LZMAError, EOFError, RuntimeError, ValueError):
        texts = []  # RuntimeError: it is encrypted, or packed in a way that Python does not know
    if not texts:
        raise ParentsError("it is not an archive of ReqIF files")
    for text in texts:
        yield from _reqif(text, name)


def _inside(archive: ZipFile, member: str) -> str:
    with archive.open(member) as file:
        return _decoded(file.read(_MOST + 1))


def _reqif(text: str, name: str) -> Iterator[Parent]:
    """Every SPEC-OBJECT, with its foreign id if it has one, else its identifier."""
    from reqif.parser import ReqIFParser

    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise ParentsError("it declares a document type, which a ReqIF file must not have")
    try:
        content = ReqIFParser.parse_from_string(text).core_content.req_if_content
        types, objects = content.spec_types or (), content.spec_objects or ()
        names = {
            definition.identifier: definition.long_name or ""
            for kind in types
            for definition in getattr(kind, "attribute_definitions", None) or ()
        }
        members = [_spec_object(spec_object, names, name) for spec_object in objects]
    except Exception as error:  # the library has no exception of its own for what it cannot read
        raise ParentsError(f"the library `reqif` cannot read it: {_first(error)}") from None
    yield from members


def _first(error: Exception) -> str:
    """The first line of the error message."""
    return next(iter(str(error).splitlines()), "") or type(error).__name__


def _spec_object(spec: Any, names: Mapping[str, str], source: str) -> Parent:
    values = {
        names.get(attribute.definition_ref, ""): _value(attribute)
        for attribute in spec.attributes or ()
    }
    attributes = {name: values[name] for name in _NAMES if name in values}
    id = attributes.get("ReqIF.ForeignID") or attributes.get("UID") or spec.identifier
    title = (
        attributes.get("ReqIF.Name")
        or attributes.get("ReqIF.ChapterName")
        or attributes.get("TITLE")
    )
    text = attributes.get("ReqIF.Text") or "\n".join(
        v for n, v in values.items() if n not in _NAMES
    )
    return _parent(id, title or spec.long_name, text, source)


def _value(attribute: Any) -> str:
    """The value as text, without XHTML elements."""
    from xml.etree import ElementTree

    value = attribute.value
    if isinstance(value, list):
        return ", ".join(map(str, value))
    if attribute.value_stripped_xhtml is None:
        return str(value or "")
    return "".join(ElementTree.fromstring(f"<x>{attribute.value_stripped_xhtml}</x>").itertext())
