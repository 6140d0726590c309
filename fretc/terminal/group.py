"""The command group: `fretc FILE...` and `fretc COMMAND ...`."""

from __future__ import annotations

from collections import UserDict
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from shlex import quote
from typing import Any

import click
from click.shell_completion import CompletionItem

from fretc.terminal.options import PATH
from fretc.terminal.output import fail
from fretish.diagnostics.diagnostic import Diagnostic, suggestion
from fretish.diagnostics.messages import diagnostic

_OWN = ("-h", "--help", "--version", "--parents")
"""Options of `fretc` itself."""
DEFAULT = "compile"
"""The command that `fretc FILE...` stands for."""


class Registry(UserDict[str, Any]):
    """Commands by name, given as `module:attribute`; a module is imported for the first look-up."""

    def __getitem__(self, name: str) -> click.Command:
        if isinstance(self.data[name], str):
            module, _, attribute = self.data[name].partition(":")
            self.data[name] = getattr(import_module(module), attribute)
        command: click.Command = self.data[name]
        return command


class Commands(click.Group):
    """Group of commands with a default command; an unknown command gets a suggestion.

    Args:
        summaries: heading → command → its line in the help.
    """

    def __init__(self, *, summaries: Mapping[str, Mapping[str, str]], **attributes: Any) -> None:
        super().__init__(**attributes)
        self._summaries = summaries

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write all commands under their headings, without importing them."""
        width = max(len(name) for lines in self._summaries.values() for name in lines)
        for heading, lines in self._summaries.items():
            with formatter.section(heading):
                formatter.write_dl([(name.ljust(width), text) for name, text in lines.items()])

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Insert the default command before a file."""
        if args and args[0] not in self.commands and args[0].partition("=")[0] not in _OWN:
            named = args[0].startswith("-") or _is_path(args[0])
            if not named and not ctx.resilient_parsing:  # A shell asks for completions.
                fail(_unknown_command(args[0], [*self.commands]))
            args = [DEFAULT, *args]
        return super().parse_args(ctx, args)

    def shell_complete(self, ctx: click.Context, incomplete: str) -> list[CompletionItem[Any]]:
        """Complete files, commands and options; files first, because bash drops earlier ones."""
        return [*PATH.files(incomplete), *super().shell_complete(ctx, incomplete)]

    def list_commands(self, ctx: click.Context) -> list[str]:
        """All named commands."""
        return [name for name in self.commands if name != DEFAULT]

    def format_usage(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write both forms of the usage."""
        formatter.write_usage("fretc", "FILE... [--emit KIND]\n       fretc COMMAND ...", "Usage: ")


class Compile(click.Command):
    """The default command, which has no name."""

    def format_usage(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the usage as it is typed."""
        formatter.write_usage("fretc", "FILE... [OPTIONS]")


class CommandWithHeadings(click.Command):
    """Command with many options: its help shows them under headings."""

    def __init__(self, *, headings: Mapping[str, Sequence[str]], **attributes: Any) -> None:
        super().__init__(**attributes)
        self._headings = headings

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options under their headings; others come last."""
        options = {o.name: o for o in self.get_params(ctx) if isinstance(o, click.Option)}
        named = {heading: [options.pop(n) for n in ns] for heading, ns in self._headings.items()}
        for heading, some in (*named.items(), ("Other", [*options.values()])):
            with formatter.section(heading):
                formatter.write_dl([r for o in some if (r := o.get_help_record(ctx)) is not None])


def is_sentence(words: str) -> bool:
    """Whether the argument is a requirement sentence, perhaps misspelt, and not a file."""
    shall = any(suggestion(word, ("shall", "should", "must"), 0.8) for word in words.split()[1:])
    return shall and not Path(words).exists()


def _is_path(word: str) -> bool:
    if is_sentence(word):
        return False
    return word == "-" or "/" in word or "." in word or Path(word).exists()


def _unknown_command(word: str, commands: Sequence[str]) -> Diagnostic:
    if is_sentence(word):
        return diagnostic("sentence_as_command", word=quote(word))
    near = suggestion(word, [c for c in commands if c != DEFAULT])
    names = ", ".join(c for c in commands if c != DEFAULT)
    return diagnostic(
        "unknown_command",
        word=word,
        help=f"did you mean `fretc {near}`?" if near else f"commands: {names}; or name a file",
    )
