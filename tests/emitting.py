"""A sentence through a target, as the tests of targets want it."""

from compiler.emit import TARGETS
from fretish.diagnostics.rendering import render
from tests.monitoring import requirement as requirement


def emitted(target: str, sentence: str, id: str = "R1") -> dict[str, str]:
    """The texts of the files by their names."""
    subject = requirement(sentence, id)
    refusal = TARGETS[target].refuse(subject)
    assert refusal is None, render(refusal)
    return {str(file.path): file.text for file in TARGETS[target].emit([subject])}


def refused(target: str, sentence: str) -> str:
    refusal = TARGETS[target].refuse(requirement(sentence))
    assert refusal is not None
    return render(refusal)


SHARING = [
    "whenever p the sw shall within {n} ticks satisfy !p",
    "whenever p the sw shall after {n} ticks satisfy p",
    "whenever !p the sw shall after {n} ticks satisfy p",
    "upon p | q the sw shall after {n} ticks satisfy q",
    "upon p & q the sw shall within {n} ticks satisfy p xor q",
    "whenever p the sw shall within {n} ticks satisfy p & !p",
    "whenever p & !p the sw shall for {n} ticks satisfy q",
    "in p mode whenever q the sw shall within {n} ticks satisfy !p",
    "in p mode the sw shall finally satisfy p & q",
    "in p mode the sw shall eventually satisfy !p",
    "only in p mode whenever q the sw shall after {n} ticks satisfy !q",
    "only after p mode whenever q the sw shall always satisfy p -> q",
    "upon p the sw shall until !p satisfy q",
    "whenever p the sw shall before !p satisfy p <-> (q xor r <-> p)",
    "the sw shall immediately satisfy x > 3 | !(x > 3)",
    "the sw shall always satisfy true",
    "the sw shall eventually satisfy false",
    "whenever x > 3 the sw shall within {n} ticks satisfy !(x > 3) & y = 0",
]
"""Sentences whose expressions share propositions, so that not all letters occur."""

LOOKING_BACK = "whenever persisted(3, p) the sw shall within 2 ticks satisfy q"
PROBABLE = "whenever p the sw shall with probability >= 0.9 within 2 ticks satisfy q"
MANY = " & ".join(f"p{i}" for i in range(20))
"""More propositions than their valuations can be listed."""
