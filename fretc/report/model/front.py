"""The views of the front page: facts, the decisive sentence, five figures, runs in their groups."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Link:
    """A name that leads to its section; `title` says more."""

    name: str
    title: str
    anchor: str


@dataclass(frozen=True, slots=True)
class FigureLine:
    """A line below a figure: `never triggered: R1 R3`; `more` counts the names left out."""

    text: str
    names: tuple[Link, ...]
    more: int


@dataclass(frozen=True, slots=True)
class Figure:
    """A number with its word; `kind` is the class of its colour, empty where it has none."""

    name: str
    count: int | None
    """None: nothing can be counted; the lines say why."""
    words: str
    kind: str
    anchor: str
    """Where it is explained."""
    lines: tuple[FigureLine, ...]


@dataclass(frozen=True, slots=True)
class ColumnRun:
    """A run as it is named in the matrix: `short` is the name without that of its group."""

    anchor: str
    name: str
    short: str


@dataclass(frozen=True, slots=True)
class RunGroup:
    """The runs of one scenario or folder; the name is empty where runs have no groups."""

    name: str
    runs: tuple[ColumnRun, ...]


@dataclass(frozen=True, slots=True)
class Front:
    """The first screen."""

    title: str
    facts: tuple[str, ...]
    headline: str
    sentences: tuple[str, ...]
    figures: tuple[Figure, ...]
    trust: tuple[str, ...]
    notes: tuple[str, ...]
    """What else has to be known before the figures are believed."""
    groups: tuple[RunGroup, ...]
