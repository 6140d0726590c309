"""The command that says what fretc itself consists of."""

from __future__ import annotations

from pathlib import Path

import click

from fretc.terminal.options import extras, output_option
from fretc.terminal.output import deliver, stop


@click.command(
    short_help="Say what the installed fretc consists of, as CycloneDX.",
    epilog=extras({"sbom": "all of this"}),
)
@output_option(default="-", show_default=True, help="File; `-` prints it.")
def sbom(output: str) -> None:
    """Say what the installed fretc consists of, as CycloneDX.

    The JSON (CycloneDX 1.6) names fretc, each library that it needs, those of the extras that are
    installed, their versions and licences. With SOURCE_DATE_EPOCH the same installation gives the
    same bytes.
    """
    from fretc.attestation.sbom import missing
    from fretc.attestation.sbom import sbom as bill

    absent = missing()
    if absent is not None:
        stop(absent)
    deliver({Path(output): bill()})
