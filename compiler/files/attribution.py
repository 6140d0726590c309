"""`[project]` of `fretc.toml`: maintainer and license of what is generated from a project.

The fields go into manifests of packages (`package.xml`, `setup.py`).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from fretish.classes.frozen import dataclass

LONGEST = 500
"""Maximum number of characters of a field."""
_EMAIL = re.compile(
    r"[-\w%+]+(?:\.[-\w%+]+)*@[-a-zA-Z0-9%]+(?:\.[-a-zA-Z0-9%]+)*\.[a-zA-Z]{2,}", re.ASCII
)
"""An e-mail address that manifests accept. Source: catkin_pkg, `Person.validate`; colcon and catkin
refuse a manifest with any other."""
EXAMPLE = """\
[project]
maintainer  = "NAME"
email       = "NAME@DOMAIN"
license     = "LICENSE, as of https://spdx.org/licenses or in words"
description = "WHAT THE PACKAGE IS FOR, IN ONE LINE"
"""


@dataclass(frozen=True, slots=True)
class Attribution:
    """Maintainer, license and description of a project; a missing field is empty."""

    maintainer: str = ""
    email: str = ""
    license: str = ""
    """An identifier of SPDX, or free text."""
    description: str = ""

    @property
    def missing(self) -> tuple[str, ...]:
        """The names of the missing fields."""
        return tuple(name for name in FIELDS if not getattr(self, name))


NOBODY = Attribution()
FIELDS = tuple(each.name for each in fields(Attribution))


@dataclass(frozen=True, slots=True)
class InvalidField:
    """A field with a value that no manifest accepts, and the fix."""

    field: str
    what: str
    fix: str


def attribution(table: Mapping[str, Any]) -> Attribution | InvalidField:
    """The attribution in a table without other fields."""
    for name, value in table.items():
        if not isinstance(value, str) or not value.strip():
            return InvalidField(name, "must be a text", f'write `{name} = "..."`, or leave it out')
        if not value.isprintable() or len(value) > LONGEST:
            fix = f"manifests take up to {LONGEST} printable characters"
            return InvalidField(name, "must be one line of text", fix)
        if f'"{value.strip()}"' in EXAMPLE:
            return InvalidField(name, "is still the example", "replace it with your own")
    email = table.get("email")
    if email is not None and _EMAIL.fullmatch(email.strip()) is None:
        fix = "write one such as `ada@robots.org`: manifests take no other form"
        return InvalidField("email", "must be one e-mail address", fix)
    return Attribution(**{name: value.strip() for name, value in table.items()})
