"""Import of a TLSF specification as a `.fret` file and `bindings.toml`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePosixPath
from typing import Any

import tomli_w

from compiler.files.artifact import Artifact
from compiler.logic import formula as f
from compiler.logic.identifiers import legal_names
from compiler.project.fret_import import ImportResult
from compiler.project.tlsf.patterns import as_formula, sentences
from compiler.project.tlsf.specification import (
    ALWAYS,
    OF_ENVIRONMENT,
    SectionFormula,
    Specification,
    read,
)
from fretish.bindings.declarations import Role
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.messages import diagnostic
from fretish.diagnostics.source import Source
from fretish.documents import ASSUMPTION
from fretish.parser import parse
from fretish.reading.recursion import with_recursion_limit

_SEMANTICS = frozenset({"Mealy", "Mealy,Strict"})
_OPERATORS = frozenset("XFGURW")
"""Names that a formula reads as operators."""
_LONGEST = 60
"""Characters of a formula in a message."""


@with_recursion_limit
def read_specification(source: Source) -> ImportResult:
    """The requirements of a specification, or every reason why it is not imported.

    Each formula becomes sentences of the same meaning, or stays a formula if there are none.
    """
    specification = read(source)
    if isinstance(specification, Diagnostic):
        return ImportResult((), (specification,))
    if specification.semantics not in _SEMANTICS or specification.target != "Mealy":
        mistake = diagnostic(
            "other_semantics",
            source.span(0, 0),
            semantics=specification.semantics,
            target=specification.target,
        )
        return ImportResult((), (mistake,))
    names = _names(specification)
    entries: list[tuple[dict[str, Any], str]] = []
    kept: list[SectionFormula] = []
    for number, part in enumerate(specification.formulas, 1):
        formula = f.globally(part.formula) if part.section in ALWAYS else part.formula
        texts = sentences(formula, names)
        if texts is None:
            kept.append(part)
            texts = (as_formula(formula, names),)
        entries.extend(_entries(number, part, texts))
    outputs = set(specification.outputs)
    doubts = [
        diagnostic("assumption_reads_outputs", part.span)
        for part in specification.formulas
        if part.section in OF_ENVIRONMENT and not outputs.isdisjoint(f.atoms(part.formula))
    ]
    assumed = sum("kind" in header for header, _ in entries)
    count = len(specification.inputs) + len(specification.outputs)
    files = (_requirements(entries), _bindings(specification, names))
    return ImportResult(
        files, (*_kept_as_formulas(kept), *doubts[:1]), len(entries), count, assumed
    )


def _kept_as_formulas(parts: Sequence[SectionFormula]) -> Iterator[Diagnostic]:
    """F622 for the first formula without a sentence, with the number of others."""
    if parts:
        first, *more = parts
        others = f", nor {len(more)} other formula{'s' * (len(more) > 1)}" if more else ""
        yield diagnostic("no_pattern", first.span, formula=_short(first), others=others)


def _short(part: SectionFormula) -> str:
    text = " ".join(part.span.text.split())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def _names(specification: Specification) -> Mapping[str, str]:
    """Each signal and its text in a sentence: key words are quoted, other characters replaced."""
    legal = legal_names((*specification.inputs, *specification.outputs), _OPERATORS)
    return {name: _written(text) for name, text in legal.items()}


def _written(name: str) -> str:
    read_so = parse(Source("name", f"the sw shall always satisfy !{name} & {name} = true").span())
    return f'"{name}"' if isinstance(read_so, Diagnostic) else name


def _entries(
    number: int, part: SectionFormula, texts: tuple[str, ...]
) -> Iterator[tuple[dict[str, Any], str]]:
    """Header and sentence of each requirement of a formula."""
    is_assumption = part.section in OF_ENVIRONMENT
    letter = "A" if is_assumption else "G"
    for place, sentence in enumerate(texts, 1):
        more = f".{place}" if len(texts) > 1 else ""
        header = {"id": f"{letter}{number}{more}", "text": f"{part.section}: {_short(part)}"}
        if is_assumption:
            header["kind"] = ASSUMPTION
        yield header, sentence


def _requirements(entries: list[tuple[dict[str, Any], str]]) -> Artifact:
    text = "\n".join(
        f"+++\n{tomli_w.dumps(header)}+++\n{sentence}\n" for header, sentence in entries
    )
    return Artifact(PurePosixPath("specification.fret"), text)


def _bindings(specification: Specification, names: Mapping[str, str]) -> Artifact:
    tables = {
        names[name].strip('"'): {"role": str(role), "type": "boolean"}
        for role, some in (
            (Role.INPUT, specification.inputs),
            (Role.OUTPUT, specification.outputs),
        )
        for name in some
    }
    text = f"# The signals of {specification.title or 'a TLSF specification'}.\n\n"
    return Artifact(PurePosixPath("bindings.toml"), text + tomli_w.dumps({"variable": tables}))
