"""Views of the front page: facts, headline, five figures, groups of runs."""

from __future__ import annotations

from fretish.classes.frozen import dataclass


@dataclass(frozen=True, slots=True)
class SectionLink:
    """A name with a link to its section; `title` is a tooltip."""

    name: str
    title: str
    anchor: str


@dataclass(frozen=True, slots=True)
class FigureLine:
    """A line below a figure: `never triggered: R1 R3`; `more` counts the names left out."""

    text: str
    names: tuple[SectionLink, ...]
    more: int


@dataclass(frozen=True, slots=True)
class Figure:
    """A number with its label; `kind` is the class of its colour, or ""."""

    name: str
    count: int | None
    """None if nothing can be counted; the lines give the reason."""
    words: str
    kind: str
    anchor: str
    """Anchor of the section with the explanation."""
    lines: tuple[FigureLine, ...]


@dataclass(frozen=True, slots=True)
class ColumnRun:
    """A column of the matrix: `short` is the name of the run without the name of its group."""

    anchor: str
    name: str
    short: str


@dataclass(frozen=True, slots=True)
class RunGroup:
    """The runs of one scenario or folder; the name is "" if runs have no groups."""

    name: str
    runs: tuple[ColumnRun, ...]


@dataclass(frozen=True, slots=True)
class IdentityRow:
    """A row of the head that an assessor signs."""

    name: str
    lines: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Front:
    """The first screen."""

    title: str
    facts: tuple[str, ...]
    identity: tuple[IdentityRow, ...]
    """Date, labels, hash of the evidence, exposure and confidence."""
    headline: str
    sentences: tuple[str, ...]
    figures: tuple[Figure, ...]
    trust: tuple[str, ...]
    notes: tuple[str, ...]
    """Sentences that qualify the figures."""
    groups: tuple[RunGroup, ...]
