"""The command that lets a shell complete what is typed after `fretc`."""

from __future__ import annotations

import click

from fretc.terminal.completion import SHELLS, script


@click.command(short_help="Print what lets a shell complete commands, options and files.")
@click.argument("shell", type=click.Choice(SHELLS))
def completion(shell: str) -> None:
    """Print what lets a shell complete commands, options and files.

    For bash, put `eval "$(fretc completion bash)"` into ~/.bashrc; for zsh the same with zsh into
    ~/.zshrc; for fish, `fretc completion fish | source` into ~/.config/fish/config.fish.
    """
    click.echo(script(click.get_current_context().find_root().command, shell), nl=False)
