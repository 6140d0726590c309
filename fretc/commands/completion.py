"""`fretc completion`: print a completion script for a shell."""

from __future__ import annotations

import click

from fretc.terminal.completion import SHELLS, script


@click.command()
@click.argument("shell", type=click.Choice(SHELLS))
def completion(shell: str) -> None:
    """Print a script that completes commands, options and files in your shell.

    bash: put `eval "$(fretc completion bash)"` into ~/.bashrc. zsh: put `eval "$(fretc
    completion zsh)"` into ~/.zshrc. fish: put `fretc completion fish | source` into
    ~/.config/fish/config.fish.
    """
    click.echo(script(click.get_current_context().find_root().command, shell), nl=False)
