"""Jinja as the templates need it, with a cache of compiled templates.

The only module that imports jinja2.
"""

from __future__ import annotations

import hashlib
import sys
from contextlib import suppress
from importlib.util import cache_from_source
from pathlib import Path
from pickle import UnpicklingError

import jinja2
from jinja2 import Environment, FileSystemLoader, StrictUndefined, select_autoescape
from jinja2.bccache import Bucket, FileSystemBytecodeCache


def environment(root: Path, filters: Path) -> Environment:
    """The environment of all templates, without filters.

    Args:
        root: the folder of the templates.
        filters: the module of the filters. Templates are compiled again when its text changes.
    """
    return Environment(
        loader=FileSystemLoader(root),
        undefined=StrictUndefined,
        autoescape=select_autoescape(enabled_extensions=("html.j2", "svg.j2"), default=False),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        bytecode_cache=_Compiled(root, filters),
    )


class _Compiled(FileSystemBytecodeCache):
    """Cache of compiled templates in Python's own cache folder, if that is writable.

    Compiling the templates of the report takes 0.2 s. Anyone who can write there can also change
    fretc's own code.
    """

    def __init__(self, root: Path, filters: Path) -> None:
        folder = Path(cache_from_source(str(root / "templates.py"))).parent
        super().__init__(str(folder), "%s.template")
        texts = (path.read_text(encoding="utf-8") for path in (Path(__file__), filters))
        self._maker = " ".join((jinja2.__version__, *texts))

    def get_source_checksum(self, source: str) -> str:
        """A checksum of the template and of everything that compiles it, with Jinja's version."""
        return hashlib.sha256(f"{self._maker}\n{source}".encode()).hexdigest()

    def load_bytecode(self, bucket: Bucket) -> None:
        """Load the compiled template if its file is intact."""
        with suppress(OSError, EOFError, UnpicklingError):
            super().load_bytecode(bucket)

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Save the compiled template if the folder can be written."""
        if not sys.dont_write_bytecode:
            with suppress(OSError):
                Path(self.directory).mkdir(parents=True, exist_ok=True)
                super().dump_bytecode(bucket)
