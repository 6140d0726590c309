"""`fretc completion`: print a completion script for a shell, and answer the shell's queries.

The script runs `fretc` with `_FRETC_COMPLETE` in its environment. Source: click's documentation,
Shell Completion.
"""

from __future__ import annotations

import os

import click
from click.shell_completion import ShellComplete, get_completion_class, shell_complete

SHELLS = ("bash", "zsh", "fish")
_NAME, _VARIABLE = "fretc", "_FRETC_COMPLETE"


@click.command()
@click.argument("shell", type=click.Choice(SHELLS))
def completion(shell: str) -> None:
    """Print a script that completes commands, options and files in your shell.

    bash: put `eval "$(fretc completion bash)"` into ~/.bashrc. zsh: put `eval "$(fretc
    completion zsh)"` into ~/.zshrc. fish: put `fretc completion fish | source` into
    ~/.config/fish/config.fish.
    """
    command, kind = click.get_current_context().find_root().command, get_completion_class(shell)
    assert kind is not None
    # `source` of bash alone would run `bash` to warn about old versions.
    click.echo(ShellComplete.source(kind(command, {}, _NAME, _VARIABLE)), nl=False)


def answer_query(command: click.Command) -> bool:
    """Whether this run is a completion query; if so, the completions are printed."""
    question = os.environ.get(_VARIABLE)
    if question is None:
        return False
    shell_complete(command, {}, _NAME, _VARIABLE, question)
    return True
