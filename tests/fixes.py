"""What messages propose to write."""

import re

_TOML = re.compile(r"`(\[[A-Za-z][^`]*\]|(?!X =)[A-Za-z_.\"-]+ = [^`]*)`")


def toml_in(text: str) -> list[str]:
    """The tables and the fields of TOML that a message shows between backticks."""
    return _TOML.findall(text)
