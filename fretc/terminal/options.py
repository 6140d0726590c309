"""Options that several commands have: one spelling, one meaning, one help."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import click
from click.shell_completion import CompletionItem

from fretc.terminal.output import EVIDENCE, REQUIREMENTS_FOLDER, STORE, fail
from fretish.diagnostics.diagnostic import Code, Diagnostic

Command = Callable[..., Any]
OF_LOGS = {
    "bags": "bags (.bag, .db3) and messages defined in IDL",
    "protobuf": "messages in Protobuf",
    "remote": "URLs",
}
"""What a command that reads logs needs extras for."""


def extras(needed: Mapping[str, str]) -> str:
    """The end of a help.

    Args:
        needed: of each extra, what needs it.
    """
    parts = "; ".join(f"`{name}` for {what}" for name, what in needed.items())
    return f"Optional packages (`pip install 'fretc[NAME]'`): {parts}."


class _Path(click.ParamType[str]):
    """The name of a file or folder, which a shell can complete; its reader checks it."""

    name = "path"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem[Any]]:
        """Let the shell look for files."""
        return self.files(incomplete)

    @staticmethod
    def files(incomplete: str) -> list[CompletionItem[Any]]:
        """What tells a shell to complete the name of a file."""
        return [CompletionItem(incomplete, type="file")]


PATH = _Path()


class _Seconds(click.FloatRange):
    """A time that passes: more than 0, and a number (a search ends at no time that is none)."""

    def __init__(self) -> None:
        super().__init__(min=0, min_open=True)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """As of a range; no comparison excludes what is not a number."""
        seconds = super().convert(value, param, ctx)
        if math.isnan(seconds):
            self.fail(f"{value} is not a number of seconds", param, ctx)
        return seconds


SECONDS = _Seconds()


def path_option(*spellings: str, **attributes: Any) -> Callable[[Command], Command]:
    """An option that names a file or folder."""
    return click.option(*spellings, type=PATH, **attributes)


def output_option(**attributes: Any) -> Callable[[Command], Command]:
    """`-o`, `--output`: where the main thing goes that the command makes."""
    return path_option("-o", "--output", **attributes)


def format_option(*others: str, text: str = "Output format.") -> Callable[[Command], Command]:
    """`--format`: text for a person, JSON for a program, and perhaps others."""
    return click.option(
        "--format",
        "form",
        type=click.Choice(("text", "json", *others)),
        default="text",
        show_default=True,
        help=text,
    )


requirements_option = path_option(
    "--requirements",
    default=REQUIREMENTS_FOLDER,
    show_default=True,
    help="Requirement file, or folder of requirement files.",
)
bindings_option = path_option(
    "--bindings", help="Bindings file.  [default: bindings.toml beside the requirements]"
)
hazards_option = path_option(
    "--hazards", help="Hazards file.  [default: hazards.toml beside the requirements]"
)


def evidence_place(named: str | None) -> str:
    """Where evidence is: where the user says, else the file or the store that is there."""
    if named is not None:
        return named
    if os.path.lexists(EVIDENCE) and os.path.lexists(STORE):
        fail(
            Diagnostic(
                Code.TWO_EVIDENCES,
                f"evidence is in `{EVIDENCE}` and in `{STORE}`: one of them is from an earlier "
                "audit",
                help="remove the old one, or name the one to use",
            )
        )
    return STORE if os.path.lexists(STORE) else EVIDENCE


evidence_option = path_option(
    "--evidence",
    callback=lambda _context, _option, named: evidence_place(named),
    help=f"Evidence, as `fretc audit` writes it.  [default: {EVIDENCE} or {STORE}]",
)
verification_option = path_option(
    "--verification",
    help="Proofs, as `fretc verify` writes them.  [default: build/verification.json, if it exists]",
)
analysis_option = path_option(
    "--analysis",
    help="Analysis of the requirement set, as `fretc analyze` writes it.  [default: "
    "build/analysis.json, if it exists]",
)
tests_option = path_option(
    "--tests",
    help="Tests, as `fretc test` writes them.  [default: build/tests/suite.json, if it exists]",
)
label_option = click.option(
    "--label",
    "labels",
    multiple=True,
    metavar="KEY=VALUE",
    help="Label for all runs, for example version=2.1. It overrides the same label in "
    "[run.label] of the bindings. Repeatable.",
)
jobs_option = click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=os.cpu_count() or 1,
    help="Number of parallel processes.  [default: one for each CPU core]",
)
limit_option = click.option(
    "--limit",
    type=click.IntRange(min=1),
    default=60,
    show_default=True,
    help="CPU time limit for each proof, in seconds.",
)


def is_given(name: str) -> bool:
    """Whether the user has typed this parameter of the present command."""
    source = click.get_current_context().get_parameter_source(name)
    return source is click.core.ParameterSource.COMMANDLINE


def places(arguments: Sequence[str], requirements: str) -> list[str]:
    """Where requirements are: what the arguments name, else `--requirements`; never both."""
    if arguments and is_given("requirements"):
        fail(
            Diagnostic(
                Code.BAD_USAGE,
                f"requirements are named twice: `{arguments[0]}` and `--requirements`",
                help="keep one of them",
            )
        )
    return [*arguments] or [requirements]
