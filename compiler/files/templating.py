"""Templates: where they live, and how text from outside is quoted in them.

The only module that imports jinja2.
"""

from __future__ import annotations

import hashlib
import json
import re
import sys
from contextlib import suppress
from functools import cache
from importlib.util import cache_from_source
from json.encoder import encode_basestring_ascii
from pathlib import Path
from pickle import UnpicklingError
from typing import Any

import jinja2
import tomli_w
from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from jinja2.bccache import Bucket, FileSystemBytecodeCache
from markupsafe import Markup

from fretish.diagnostics import status_symbols as signs


def template_root() -> Path:
    """`compiler/templates` in an installed wheel, `templates` beside us in a checkout."""
    package = Path(__file__).parents[1]
    installed = package / "templates"
    return installed if installed.is_dir() else package.parent / "templates"


def render(name: str, **values: Any) -> str:
    """Render one template; a name that it uses and does not get is a mistake, never an empty text.

    Args:
        name: its path below the templates; `.html.j2` and `.svg.j2` are autoescaped.
        values: what it places.
    """
    return _environment().get_template(name).render(**values)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(template_root()),
        undefined=StrictUndefined,
        autoescape=select_autoescape(enabled_extensions=("html.j2", "svg.j2"), default=False),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        bytecode_cache=_Compiled(),
    )
    environment.filters["python"] = python
    environment.filters["comment"] = comment
    environment.filters["c_comment"] = c_comment
    environment.filters["c_remark"] = c_remark
    environment.filters["js"] = script
    environment.filters["json"] = to_json
    environment.filters["data"] = data
    environment.filters["toml"] = toml
    environment.filters["key"] = key
    environment.filters["hoa"] = quoted
    environment.filters["dot"] = quoted
    environment.globals["signs"] = signs
    return environment


class _Compiled(FileSystemBytecodeCache):
    """Compiled templates, where Python keeps the compiled modules of a folder, and when it does.

    To compile those of the report takes 0.2 s. Anyone who can write there can write our own text.
    """

    def __init__(self) -> None:
        folder = Path(cache_from_source(str(template_root() / "templates.py"))).parent
        super().__init__(str(folder), "%s.template")
        self._maker = f"{jinja2.__version__} {Path(__file__).read_text(encoding='utf-8')}"

    def get_source_checksum(self, source: str) -> str:
        """Of all that the compiled template depends on: another Jinja compiles it anew."""
        return hashlib.sha256(f"{self._maker}\n{source}".encode()).hexdigest()

    def load_bytecode(self, bucket: Bucket) -> None:
        """Where the file is whole."""
        with suppress(OSError, EOFError, UnpicklingError):
            super().load_bytecode(bucket)

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Where the folder can be written."""
        if not sys.dont_write_bytecode:
            with suppress(OSError):
                Path(self.directory).mkdir(parents=True, exist_ok=True)
                super().dump_bytecode(bucket)


def python(value: object) -> str:
    """The value as a Python literal, in ASCII."""
    if isinstance(value, str):
        return f'"{"".join(map(_character, value))}"'
    return ascii(value)


def _character(one: str) -> str:
    """It in a Python string; beyond 16 bits JSON would write two, which Python does not join."""
    return json.dumps(one)[1:-1] if ord(one) < 0x10000 else f"\\U{ord(one):08x}"


def script(text: str) -> str:
    """The text as a JavaScript string, in ASCII; it ends no `<script>` that it stands in."""
    return json.dumps(text).replace("<", "\\u003c")


def comment(text: str, mark: str = "#") -> str:
    """One line that cannot end the comment it stands in, in printable ASCII."""
    flat = " ".join(text.split())
    if not (flat.isascii() and flat.isprintable()):
        flat = "".join(map(_safe, flat))
    return f"{mark} {flat}"


def _safe(sign: str) -> str:
    is_plain = sign.isascii() and sign.isprintable()
    return sign if is_plain else sign.encode("unicode_escape").decode()


def c_comment(text: str, indent: str = "") -> str:
    """One line of a comment of C that is open, which no text in it can end."""
    return f" * {indent}{_harmless(text)}"


def c_remark(text: str) -> str:
    """A comment of C on one line."""
    return f"/* {_harmless(text)} */"


def _harmless(text: str) -> str:
    """In printable ASCII, without the signs that begin or end a comment of C, and no trigraphs."""
    flat = comment(text, "").strip()
    return re.sub(r"\?(?=\?)", "? ", flat.replace("*/", "* /").replace("/*", "/ *"))


def quoted(text: str) -> str:
    """The text in double quotes, on one line: a string of HOA, and of DOT where it is no label."""
    escaped = " ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def data(value: object) -> Markup:
    """JSON in a `<script>` of data, which no text in it can end."""
    text = json.dumps(value, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))


def toml(text: str) -> str:
    """The text as a TOML string, on one line."""
    return _line("x", text).partition(" = ")[2]


def key(name: str) -> str:
    """The name as a TOML key, in quotes where it needs them."""
    return _line(name, True).rpartition(" = ")[0]


def _line(name: str, value: object) -> str:
    return tomli_w.dumps({name: value}).removesuffix("\n")


_WIDTH = 100
"""Columns of a line of JSON, for what fits on one."""
_encode = json.JSONEncoder(allow_nan=False).encode


def to_json(value: object, indent: str = "") -> str:
    """JSON with a fixed order of keys, in ASCII; indented, and what fits on a line stands on one.

    Args:
        value: of JSON.
        indent: what the lines after the first begin with.

    Raises:
        ValueError: a number is infinite or not a number.
    """
    if not isinstance(value, dict | list | tuple):
        return _scalar(value)
    inner = f"{indent}  "
    if isinstance(value, dict):
        parts = [f"{_scalar(str(k))}: {to_json(v, inner)}" for k, v in value.items()]
    else:
        parts = [to_json(part, inner) for part in value]
    opening, closing = "{}" if isinstance(value, dict) else "[]"
    length = len(indent) + len(opening) + len(closing)
    length += sum(map(len, parts)) + 2 * max(0, len(parts) - 1)
    if length <= _WIDTH and not any("\n" in part for part in parts):  # texts have none in JSON
        return f"{opening}{', '.join(parts)}{closing}"
    separator = f",\n{inner}"
    return f"{opening}\n{inner}{separator.join(parts)}\n{indent}{closing}"


def _scalar(value: object) -> str:
    """JSON of what has no parts; most of it is of three kinds."""
    if type(value) is str:
        return encode_basestring_ascii(value)
    return repr(value) if type(value) is int else _encode(value)
