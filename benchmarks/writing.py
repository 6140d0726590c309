"""How often `fretc write` offers the right reading of published requirements in plain English.

    python -m benchmarks.writing FRET    # FRET: a clone of NASA-SW-VnV/fret

The case studies of FRET hold requirements in English, as their rationale, beside FRETish. A reading
is right if its sentence has the same verdict on all finite runs as the published one, up to a
renaming of its atoms: one name for each comparison or proposition, where `x > 5` is `!(x <= 5)`. A
name may stand for a comparison as it is written.
The rules were made with one half, chosen by a fixed seed; the other half measures them.
"""

from __future__ import annotations

import argparse
import json
import random
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from itertools import permutations
from pathlib import Path

from compiler.formalization.formalize import formalize
from compiler.formalization.formalized import FormalizedRequirement
from fretc.testing.runs import Absence, difference
from fretish import expressions as e
from fretish import syntax as s
from fretish.classes.frozen import dataclass
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.english.readings import demands, readings
from fretish.english.vocabulary import Vocabulary
from fretish.parser import parse
from fretish.printer import expression, sentence

SEED = 20261125
FILES = (
    "FiniteStateMachine/fsm_reqts_and_vars",
    "LMCPS/LM_requirements",
    "LiquidMixer/LM_reqts_and_vars",
)
"""The case studies whose rationales state requirements."""
MOST_ATOMS = 6
SECONDS = 10
"""CPU seconds for each comparison."""


@dataclass(frozen=True, slots=True)
class Pair:
    """A published requirement."""

    study: str
    id: str
    english: str
    fretish: str
    names: Vocabulary
    """The variables of its project."""


def pairs(fret: Path) -> tuple[Pair, ...]:
    """All requirements with an English text, in a fixed order."""
    pairs: list[Pair] = []
    for study in FILES:
        data = json.loads((fret / f"caseStudies/{study}.json").read_text("utf-8"))
        for row in data["requirements"]:
            english = (row.get("rationale") or "").strip()
            if english:
                names = _names(data["variables"], row["project"])
                study_name = study.rpartition("/")[2]
                pairs.append(Pair(study_name, row["reqid"], english, row["fulltext"], names))
    return tuple(sorted(pairs, key=lambda p: (p.study, p.id, p.english, p.fretish)))


def halves(every: Sequence[Pair]) -> tuple[tuple[Pair, ...], tuple[Pair, ...]]:
    """The half for which rules were made, and the other one."""
    mixed = [*every]
    random.Random(SEED).shuffle(mixed)
    middle = (len(mixed) + 1) // 2
    return tuple(mixed[:middle]), tuple(mixed[middle:])


def _names(variables: Sequence[Mapping[str, str]], project: str) -> Vocabulary:
    own = [v for v in variables if v.get("project") == project and v.get("variable_name")]
    truths = tuple(v["variable_name"] for v in own if v.get("dataType") == "boolean")
    others = tuple(v["variable_name"] for v in own if v.get("dataType") != "boolean")
    return Vocabulary(tuple(dict.fromkeys(truths)), tuple(dict.fromkeys(others)))


class Criterion(Enum):
    """When a reading counts as the published sentence."""

    NEW_NAMES = "names new"
    """No name is known; the same up to a renaming of atoms."""
    KNOWN_NAMES = "names known"
    """The variables of the project are known; the same up to a renaming of atoms."""
    SAME_NAMES = "same names"
    """The variables of the project are known, and the atoms are the same."""


def is_offered(pair: Pair, criterion: Criterion) -> bool:
    """Whether a reading of the text is the published sentence."""
    published = parse(Source("published", pair.fretish.strip()).span())
    if not isinstance(published, s.Sentence):
        return False
    names = Vocabulary() if criterion is Criterion.NEW_NAMES else pair.names
    offered = (r for text in demands(pair.english) for r in readings(text, names))
    exact = criterion is Criterion.SAME_NAMES
    return any(is_same(published, reading.sentence, exact=exact) for reading in offered)


def is_same(published: s.Sentence, other: s.Sentence, *, exact: bool = False) -> bool:
    """Whether two sentences have the same verdicts on all finite runs.

    Args:
        published: a sentence.
        other: another one.
        exact: whether its atoms must be the same; else they are renamed if there are as many. A
            name may stand for a comparison as it is written.
    """
    atoms, own = _atoms(published), _atoms(other)
    if len(atoms) != len(own) or len(atoms) > MOST_ATOMS or (exact and {*atoms} != {*own}):
        return False
    first = _formalized(published, {atom: e.Name(f"p{i}") for i, atom in enumerate(atoms)})
    if first is None:
        return False
    for order in (tuple(own),) if exact else permutations(atoms):
        names = {
            atom: _signed(f"p{[*atoms].index(theirs)}", own[atom], atoms[theirs])
            for atom, theirs in zip(own, order, strict=True)
        }
        renamed = _formalized(other, names)
        if renamed is None:
            return False
        apart = difference(first, renamed, SECONDS)
        if isinstance(apart, Absence) and not apart.why:
            return True
    return False


def _signed(name: str, own: bool | None, theirs: bool | None) -> e.Expression:
    """The name of an atom; negated if it stands for a comparison that is written as a negation."""
    negated = (own is None) != (theirs is None) and bool(own or theirs)
    return e.Not(e.Name(name)) if negated else e.Name(name)


def _formalized(
    tree: s.Sentence, names: Mapping[str, e.Expression]
) -> FormalizedRequirement | None:
    """The sentence with a name for each atom; None if fretc has no meaning for it."""
    plain = s.with_expressions(tree, lambda part: _renamed(part, names))
    text = sentence(plain)
    return formalize(RequirementEntry("r", Source("r", text).span()), None)[0]


_NEGATED = {">": "<=", ">=": "<", "!=": "="}


def _renamed(part: e.Expression, names: Mapping[str, e.Expression]) -> e.Expression:
    if isinstance(part, e.Comparison) and part.op in _NEGATED:
        return e.Not(names[_key(part)])
    if _key(part) in names:
        return names[_key(part)]
    if isinstance(part, e.Call):
        *bounds, last = part.args
        return e.Call(part.name, (*map(_in_ticks, bounds), _renamed(last, names)))
    return e.with_children(part, [_renamed(child, names) for child in e.children(part)])


def _in_ticks(bound: e.Expression) -> e.Expression:
    """A duration as a number of ticks, as FRET reads it without a clock."""
    return e.Number(bound.digits) if isinstance(bound, e.Quantity) else bound


def _atoms(tree: s.Sentence) -> dict[str, bool | None]:
    """Atom → None for a name; for a comparison, whether its first form is a negation."""
    signs: dict[str, bool | None] = {}

    def collect(part: e.Expression) -> e.Expression:
        for atom in _parts(part):
            sign = atom.op in _NEGATED if isinstance(atom, e.Comparison) else None
            signs.setdefault(_key(atom), sign)
        return part

    s.with_expressions(tree, collect)
    return signs


def _parts(part: e.Expression) -> Iterator[e.Expression]:
    match part:
        case e.Call(name, args) if name in e.COUNTING:
            yield from _parts(args[-1])
        case e.Name() | e.Comparison() | e.Call():
            yield part
        case _:
            for child in e.children(part):
                yield from _parts(child)


def _key(part: e.Expression) -> str:
    """The text of an atom; equal for a comparison and its negation."""
    if isinstance(part, e.Comparison) and part.op in _NEGATED:
        op = _NEGATED[part.op]
        return f"{expression(part.left)} {op} {expression(part.right)}"
    if isinstance(part, e.Comparison):
        return f"{expression(part.left)} {part.op} {expression(part.right)}"
    return expression(part) if isinstance(part, e.Name | e.Call) else ""


def main() -> None:
    """Print the figure of each half."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("fret", type=Path, metavar="FRET", help="a clone of FRET's repository")
    fret = parser.parse_args().fret
    for what, half in zip(("made with", "measured"), halves(pairs(fret)), strict=True):
        for criterion in Criterion:
            right = sum(is_offered(pair, criterion) for pair in half)
            share = f"{right:3} of {len(half)}  {right / len(half):.0%}"
            print(f"{what:10} {criterion.value:12} {share}")


if __name__ == "__main__":
    main()
