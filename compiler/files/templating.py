"""Rendering of templates, and quoting of untrusted text in them."""

from __future__ import annotations

import json
import re
from functools import cache
from json.encoder import encode_basestring_ascii
from pathlib import Path
from typing import TYPE_CHECKING, Any

import tomli_w

from fretish.diagnostics import status_symbols as signs

if TYPE_CHECKING:
    from jinja2 import Environment
    from markupsafe import Markup


def template_root() -> Path:
    """The templates' folder: `compiler/templates` in a wheel, `templates` in a checkout."""
    package = Path(__file__).parents[1]
    installed = package / "templates"
    return installed if installed.is_dir() else package.parent / "templates"


def render(name: str, **values: Any) -> str:
    """Render one template; an undefined name is an error, never an empty text.

    Args:
        name: the path below the templates; `.html.j2` and `.svg.j2` are autoescaped.
        values: the variables of the template.
    """
    return _environment().get_template(name).render(**values)


@cache
def _environment() -> Environment:
    from compiler.files.template_engine import environment  # Many commands fill no template.

    jinja = environment(template_root(), Path(__file__))
    jinja.filters.update(
        python=python,
        comment=comment,
        c_comment=c_comment,
        c_remark=c_remark,
        java_comment=java_comment,
        js=script,
        json=to_json,
        data=data,
        toml=toml,
        key=key,
        hoa=quoted,
        dot=quoted,
    )
    jinja.globals["signs"] = signs
    return jinja


def python(value: object) -> str:
    """The value as a Python literal, in ASCII."""
    if isinstance(value, str):
        return f'"{"".join(map(_character, value))}"'
    return ascii(value)


def _character(character: str) -> str:
    """The character in a Python string; JSON would write a surrogate pair beyond 16 bits."""
    return json.dumps(character)[1:-1] if ord(character) < 0x10000 else f"\\U{ord(character):08x}"


def script(text: str) -> str:
    """The text as a JavaScript string, in ASCII, that cannot end its `<script>`."""
    return json.dumps(text).replace("<", "\\u003c")


def comment(text: str, mark: str = "#") -> str:
    """A comment on one line, in printable ASCII, that its text cannot end."""
    flat = " ".join(text.split())
    if not (flat.isascii() and flat.isprintable()):
        flat = "".join(map(_safe, flat))
    return f"{mark} {flat}"


def _safe(sign: str) -> str:
    is_plain = sign.isascii() and sign.isprintable()
    return sign if is_plain else sign.encode("unicode_escape").decode()


def c_comment(text: str, indent: str = "") -> str:
    """A line within a C comment that its text cannot end."""
    return f" * {indent}{_harmless(text)}"


def c_remark(text: str) -> str:
    """A comment of C on one line."""
    return f"/* {_harmless(text)} */"


def _harmless(text: str) -> str:
    """The text in printable ASCII, without delimiters of C comments and without trigraphs."""
    flat = comment(text, "").strip()
    return re.sub(r"\?(?=\?)", "? ", flat.replace("*/", "* /").replace("/*", "/ *"))


def java_comment(text: str, mark: str = "//") -> str:
    """A comment of Java on one line.

    Java replaces Unicode escapes before it reads comments, so that one could end the line.
    """
    return comment(text, mark).replace("\\u", "\\ u")


def quoted(text: str) -> str:
    """The text in double quotes, on one line: a string of HOA, or of DOT if it is not a label."""
    escaped = " ".join(text.split()).replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'


def data(value: object) -> Markup:
    """JSON for a data `<script>`, which no text in it can end."""
    from markupsafe import Markup  # With Jinja.

    text = json.dumps(value, separators=(",", ":"))
    return Markup(text.replace("<", "\\u003c"))


def toml(text: str) -> str:
    """The text as a TOML string, on one line."""
    return _line("x", text).partition(" = ")[2]


def key(name: str) -> str:
    """The name as a TOML key, in quotes if needed."""
    return _line(name, True).rpartition(" = ")[0]


def _line(name: str, value: object) -> str:
    return tomli_w.dumps({name: value}).removesuffix("\n")


_WIDTH = 100
"""Maximum width of a JSON array or object on one line."""
_encode = json.JSONEncoder(allow_nan=False).encode


def to_json(value: object, indent: str = "") -> str:
    """JSON in ASCII with a fixed order of keys, indented; short values stand on one line.

    Args:
        value: a JSON value.
        indent: prefix of the lines after the first.

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
    """JSON of a scalar; the three most frequent kinds come first."""
    if type(value) is str:
        return encode_basestring_ascii(value)
    return repr(value) if type(value) is int else _encode(value)
