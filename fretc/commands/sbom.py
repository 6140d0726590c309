"""`fretc sbom`: list the installed components."""

from __future__ import annotations

from pathlib import Path

import click

from fretc.terminal.options import extras, output_option
from fretc.terminal.output import fail, write_outputs


@click.command(
    epilog=extras({"sbom": "all of this"}),
)
@output_option(default="-", show_default=True, help="File. `-` prints.")
def sbom(output: str) -> None:
    """List the installed components as a CycloneDX software bill of materials.

    The JSON file (CycloneDX 1.6) lists fretc, its dependencies and those of the installed
    extras, with versions and licences. With SOURCE_DATE_EPOCH set, the same installation gives
    the same bytes.

    Example: fretc sbom -o build/sbom.json
    """
    from fretc.attestation.sbom import missing
    from fretc.attestation.sbom import sbom as bill

    absent = missing()
    if absent is not None:
        fail(absent)
    write_outputs({Path(output): bill()})
