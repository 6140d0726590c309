"""`viewer` of `fretc.toml`: the address at which another program shows a log at a time.

The settings may come from somebody else, and the address becomes a link. So only `https://` with a
fixed host is accepted, and names of logs are percent-encoded (RFC 3986).
"""

from __future__ import annotations

import re
from datetime import UTC, datetime
from urllib.parse import quote

PLACEHOLDERS = ("log", "time", "seconds", "ns")
EXAMPLE = (
    'viewer = "https://app.foxglove.dev/~/view?ds=remote-file'
    '&ds.url=https://logs.example.org/{log}&time={time}"'
)
_ADDRESS = re.compile(
    r"https://(?P<host>[A-Za-z0-9](?:[-.A-Za-z0-9]*[A-Za-z0-9])?(?::[0-9]{1,5})?)"
    r"[/?#][-A-Za-z0-9._~:/?#\[\]@!$&'()*+,;=%{}]*",
    re.ASCII,
)
_PLACEHOLDER = re.compile(r"\{([^{}]*)\}")
LONGEST = 2_000
"""Maximum number of characters of an address."""


def mistake(address: object) -> str:
    """What is wrong with an address, after its name; "" if nothing is."""
    if not isinstance(address, str) or len(address) > LONGEST:
        return f"must be an address of up to {LONGEST} characters"
    if _ADDRESS.fullmatch(address) is None:
        return "must begin with `https://` and a host, and contain no spaces"
    unknown = [name for name in _PLACEHOLDER.findall(address) if name not in PLACEHOLDERS]
    if unknown or re.search(r"[{}]", _PLACEHOLDER.sub("", address)):
        shown = ", ".join(f"`{{{name}}}`" for name in PLACEHOLDERS)
        return f"must have no braces other than {shown}"
    return "" if "{log}" in address else "must contain `{log}`"


def host(address: str) -> str:
    """The host of an address without a mistake: `app.foxglove.dev`."""
    found = _ADDRESS.fullmatch(address)
    assert found is not None
    return found["host"]


def link(address: str, log: str, ns: int) -> str:
    """The address of a log at a time; "" if the time has no date.

    Args:
        address: without a mistake.
        log: the name of the log.
        ns: nanoseconds since 1970.
    """
    seconds, rest = divmod(ns, 10**9)
    try:
        moment = datetime.fromtimestamp(seconds, UTC)
    except (OverflowError, ValueError, OSError):
        return ""
    if ns < 0:
        return ""
    values = {
        "log": quote(log),
        "time": f"{moment:%Y-%m-%dT%H:%M:%S}.{rest:09d}Z",
        "seconds": f"{seconds}.{rest:09d}",
        "ns": f"{ns}",
    }
    return _PLACEHOLDER.sub(lambda found: values[found[1]], address)
