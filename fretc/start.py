"""What the `fretc` command runs: Ctrl-C stops it in one line, also while the rest is imported."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command; its exit status is 130 where Ctrl-C came before it could answer."""
    try:
        from fretc.cli import main as run

        run()
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        raise SystemExit(130) from None
