"""Entry point of the `fretc` command: handles Ctrl-C also during imports."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command; the exit status is 130 if Ctrl-C stopped it during imports."""
    try:
        from fretc.cli import main as run

        run()
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        raise SystemExit(130) from None
