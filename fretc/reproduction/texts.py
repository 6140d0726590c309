"""Monitors in C, Rust, Java or JavaScript, generated again to recheck proofs about them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from compiler.emit import TARGETS
from compiler.files.text_files import sha256
from compiler.formalization.formalized import FormalizedRequirement
from compiler.logic.claims import Layer, Proof
from compiler.targets.target import TargetOptions
from fretc.verification.layers.languages import LanguageRow, language_of
from fretish.diagnostics.source import Source


class Remade(NamedTuple):
    """The file of a monitor, and its header if there is one."""

    monitor: Source | None
    header: Source | None


def remade(records: Sequence[Proof], requirements: Sequence[FormalizedRequirement]) -> Remade:
    """The monitor that fretc generates now and that equals the one that the proofs are about.

    Both are None if no generated text has these hashes, if several have them, or if the compiler is
    not installed.
    """
    hashes = {name: value for record in records for name, value in _texts(record).items()}
    of_monitor = [record for record in records if record.layer is Layer.MONITOR]
    found = {name: row for name in hashes if (row := language_of(name))}
    if len(found) != 1 or len(of_monitor) != len(records):
        return Remade(None, None)
    ((name, language),) = found.items()
    for files in _written(language, records, requirements) if language.module.tool() else ():
        if all(sha256(files.get(each, "")) == value for each, value in hashes.items()):
            headers = [Source(each, files[each]) for each in hashes if each != name]
            return Remade(Source(name, files[name]), next(iter(headers), None))
    return Remade(None, None)


def other_build(before: Proof, now: Proof) -> str:
    """The reason why proofs of one text cannot be compared: other tools built another binary."""
    is_other = before.assumptions != now.assumptions and _texts(before) == _texts(now)
    if not is_other or not any(map(language_of, before.artefacts)):
        return ""
    return f"the file states: {'; '.join(before.assumptions)}"


def _texts(record: Proof) -> Mapping[str, str]:
    """The artefacts of a proof without compiled ones."""
    return {name: value for name, value in record.artefacts.items() if not name.endswith(".so")}


def _written(
    language: LanguageRow, records: Sequence[Proof], requirements: Sequence[FormalizedRequirement]
) -> Iterator[Mapping[str, str]]:
    """Candidate file sets: one monitor for all requirements, for the proved ones, and for each."""
    target, ids = TARGETS[language.emit], {record.requirement for record in records}
    named = [requirement for requirement in requirements if requirement.id in ids]
    for group, one_file in (
        (requirements, True),
        (named, True),
        *(([requirement], False) for requirement in named),
    ):
        files = target.emit(group, TargetOptions(one_file=one_file))
        yield {file.path.name: file.text for file in reversed(files)}  # The first `lib.rs` wins.
