"""Languages of provable monitors, besides Python."""

from __future__ import annotations

from importlib import import_module
from pathlib import PurePath
from typing import TYPE_CHECKING, cast

from fretish.classes.frozen import dataclass

if TYPE_CHECKING:
    from fretc.verification.compiled.plan import Language


@dataclass(frozen=True, slots=True)
class LanguageRow:
    """A language of the table; its module is imported on demand."""

    name: str
    suffixes: tuple[str, ...]
    """Suffixes of its files."""
    emit: str
    """The `--emit` kind that writes it."""
    room: str
    """The package in `fretc.verification`."""
    missing: str
    """Message about the missing tool of its monitors."""
    install: str
    under: str
    """Assumption about the tool, before its name."""

    @property
    def module(self) -> Language:
        """Module that checks, compiles and runs its texts."""
        name = f"fretc.verification.{self.room}.language"
        return cast("Language", import_module(name))


TABLE = (
    LanguageRow(
        "C",
        (".c",),
        "c",
        "c",
        "compiled for its proof, but none of `gcc`, `clang`, `cc` is installed",
        "install a C compiler, as with `apt install gcc`",
        "the deployed binary is the one that was proved",
    ),
    LanguageRow(
        "Rust",
        (".rs",),
        "rust",
        "rust",
        "compiled for its proof, but `rustc` is not installed",
        "install Rust: see rustup.rs, or `apt install rustc`",
        "the deployed binary is the one that was proved",
    ),
    LanguageRow(
        "Java",
        (".java",),
        "java",
        "java",
        "compiled and run for its proof, but `javac` and `java` are not both installed",
        "install a JDK of Java 11 or later, as with `apt install default-jdk-headless`",
        "other compilers and virtual machines run the file as these did",
    ),
    LanguageRow(
        "JavaScript",
        (".mjs", ".js"),
        "js",
        "javascript",
        "run for its proof, but `node` is not installed",
        "install Node.js: see nodejs.org, or `apt install nodejs`",
        "other JavaScript engines run the file as this one did",
    ),
)


def language_of(file: str) -> LanguageRow | None:
    """The language of a file, by its suffix; None: Python."""
    suffix = PurePath(file).suffix
    return next((row for row in TABLE if suffix in row.suffixes), None)
