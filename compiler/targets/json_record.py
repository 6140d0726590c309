"""`--emit json`: a requirement with its formulas, for other programs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePosixPath

from compiler.files.artifact import Artifact
from compiler.files.templating import render
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.record import record
from compiler.targets.target import DEFAULT, Options, Target, stem


def emit(
    requirements: Sequence[FormalizedRequirement], options: Options = DEFAULT
) -> tuple[Artifact, ...]:
    """`<id>.json` for each requirement."""
    return tuple(
        Artifact(
            PurePosixPath(f"{stem(requirement)}.json"),
            render("json/requirement.json.j2", requirement=record(requirement)),
        )
        for requirement in requirements
    )


TARGET = Target("json", "everything known of the requirement, for programs", emit)
