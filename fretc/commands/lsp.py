"""`fretc lsp`: the language server for editors."""

from __future__ import annotations

import click

from fretc.terminal.options import extras
from fretc.terminal.output import fail


@click.command(epilog=extras({"lsp": "always"}))
@click.option(
    "--stdio",
    is_flag=True,
    expose_value=False,
    help="Changes nothing: some editors add this option.",
)
def lsp() -> None:
    """Serve an editor: diagnostics, fixes, hover, completion, rename and formatting.

    An editor starts it, and speaks the Language Server Protocol on standard input and output.
    docs/editors.md has the lines to configure VS Code, Neovim, Helix, Emacs and Zed.

    Exit status: 0 when the editor closes it.

    Example, in Helix: [language-server.fretc] command = "fretc", args = ["lsp"]
    """
    from fretish.diagnostics.extras import unless_installed

    missing = unless_installed("a language server needs", ["pygls", "lsprotocol"], "lsp")
    if missing is not None:
        fail(missing)
    from fretc.lsp.server import serve

    serve()
