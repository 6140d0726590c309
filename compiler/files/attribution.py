"""`[project]` of `fretc.toml`: who answers for what is made of a project, and under which license.

The fields go into manifests of packages (`package.xml`, `setup.py`), which have no other source for
them.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

LONGEST = 500
"""Characters of a field."""
_EMAIL = re.compile(
    r"[-\w%+]+(?:\.[-\w%+]+)*@[-a-zA-Z0-9%]+(?:\.[-a-zA-Z0-9%]+)*\.[a-zA-Z]{2,}", re.ASCII
)
"""Source: catkin_pkg, `Person.validate`, which colcon and catkin refuse a manifest by."""
EXAMPLE = """\
[project]
maintainer  = "NAME"
email       = "NAME@DOMAIN"
license     = "LICENSE, as of https://spdx.org/licenses or in words"
description = "WHAT THE PACKAGE IS FOR, IN ONE LINE"
"""


@dataclass(frozen=True, slots=True)
class Attribution:
    """Who answers for a project; a field that is not given is empty."""

    maintainer: str = ""
    email: str = ""
    license: str = ""
    """An identifier of SPDX, or free text."""
    description: str = ""

    @property
    def missing(self) -> tuple[str, ...]:
        """The fields that are not given."""
        return tuple(name for name in FIELDS if not getattr(self, name))


NOBODY = Attribution()
FIELDS = tuple(each.name for each in fields(Attribution))


@dataclass(frozen=True, slots=True)
class Unfit:
    """A field that no manifest can have, and what to write."""

    field: str
    what: str
    fix: str


def attribution(table: Mapping[str, Any]) -> Attribution | Unfit:
    """Read a table that has no other fields."""
    for name, value in table.items():
        if not isinstance(value, str) or not value.strip():
            return Unfit(name, "must be a text", f'write `{name} = "..."`, or leave it out')
        if not value.isprintable() or len(value) > LONGEST:
            fix = f"manifests take up to {LONGEST} printable characters"
            return Unfit(name, "must be one line of text", fix)
        if f'"{value.strip()}"' in EXAMPLE:
            return Unfit(name, "is still the example", "replace it with your own")
    email = table.get("email")
    if email is not None and _EMAIL.fullmatch(email.strip()) is None:
        fix = "write one such as `ada@robots.org`: manifests take no other form"
        return Unfit("email", "must be one e-mail address", fix)
    return Attribution(**{name: value.strip() for name, value in table.items()})
