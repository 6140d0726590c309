"""Options that several commands share: one spelling, meaning and help for each."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import click
from click.shell_completion import CompletionItem

from fretc.terminal.output import EVIDENCE, REQUIREMENTS_FOLDER, STORE, fail
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic

T = TypeVar("T")
Command = Callable[..., Any]
LOG_EXTRAS = {
    "bags": "bags (.bag, .db3) and messages defined in IDL",
    "parquet": "Parquet and Arrow",
    "protobuf": "messages in Protobuf",
    "remote": "URLs",
    "ulog": "ULog",
}
"""Extras for commands that read logs, and what needs them."""


def extras(needed: Mapping[str, str]) -> str:
    """Last paragraph of a help: the optional packages.

    Args:
        needed: extra → what needs it.
    """
    parts = "; ".join(f"`{name}` for {what}" for name, what in needed.items())
    return f"Optional packages (`pip install 'fretc[NAME]'`): {parts}."


class _Path(click.ParamType[str]):
    """Parameter type: path of a file or folder, with shell completion."""

    name = "path"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem[Any]]:
        """Let the shell complete file names."""
        return self.files(incomplete)

    @staticmethod
    def files(incomplete: str) -> list[CompletionItem[Any]]:
        """The item that makes a shell complete file names."""
        return [CompletionItem(incomplete, type="file")]


PATH = _Path()


class _Seconds(click.FloatRange):
    """Parameter type: a duration above 0 in seconds; NaN is rejected."""

    def __init__(self) -> None:
        super().__init__(min=0, min_open=True)

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Convert as for a range; NaN is rejected because no comparison excludes it."""
        seconds = super().convert(value, param, ctx)
        if math.isnan(seconds):
            self.fail(f"{value} is not a number of seconds", param, ctx)
        return seconds


SECONDS = _Seconds()


def path_option(*spellings: str, **attributes: Any) -> Callable[[Command], Command]:
    """An option that names a file or folder."""
    return click.option(*spellings, type=PATH, **attributes)


def output_option(**attributes: Any) -> Callable[[Command], Command]:
    """`-o`, `--output`: path of the command's main output."""
    return path_option("-o", "--output", **attributes)


def format_option(*others: str, text: str = "Output format.") -> Callable[[Command], Command]:
    """`--format`: text, JSON, and perhaps other formats."""
    return click.option(
        "--format",
        "output_format",
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
first_bindings_option = path_option(
    "--bindings", help="Bindings file.  [default: bindings.toml beside the first FILE]"
)
files_argument = click.argument("files", nargs=-1, type=PATH, metavar="[FILE]...")
component_option = click.option(
    "--component", metavar="NAME", help="Only requirements of this component."
)
hazards_option = path_option(
    "--hazards", help="Hazards file.  [default: hazards.toml beside the requirements]"
)


def evidence_path(named: str | None) -> str:
    """Path of the evidence: the user's, or else the existing default file or store."""
    if named is not None:
        return named
    path = default_evidence()
    if isinstance(path, Diagnostic):
        fail(path)
    return path


def default_evidence() -> str | Diagnostic:
    """The existing default file or store; a diagnostic if there are both."""
    if os.path.lexists(EVIDENCE) and os.path.lexists(STORE):
        return diagnostic("two_evidences", evidence=EVIDENCE, store=STORE)
    return STORE if os.path.lexists(STORE) else EVIDENCE


evidence_option = path_option(
    "--evidence",
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


def grouped(kind: type[T], options: Mapping[str, Any]) -> T:
    """A dataclass of options; each field has the value of the parameter with its name."""
    return kind(**{name: options[name] for name in kind.__annotations__})


def is_given(name: str) -> bool:
    """Whether the user gave this parameter on the command line."""
    source = click.get_current_context().get_parameter_source(name)
    return source is click.core.ParameterSource.COMMANDLINE


def places(arguments: Sequence[str], requirements: str) -> list[str]:
    """Paths of requirements: the arguments, or else `--requirements`; F907 for both."""
    if arguments and is_given("requirements"):
        fail(diagnostic("requirements_named_twice", argument=arguments[0]))
    return [*arguments] or [requirements]
