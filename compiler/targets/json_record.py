"""`--emit json`: a requirement with its formulas, for other programs."""

from __future__ import annotations

from compiler.files.templating import render
from compiler.formalization.record import record
from compiler.targets.target import Target, file_of_each

TARGET = Target(
    "json",
    "everything known of the requirement, for programs",
    file_of_each(
        "json",
        lambda requirement, _: render("json/requirement.json.j2", requirement=record(requirement)),
    ),
)
