"""Sentences that are nearly FRETish: grown from the grammar's words, and mutated from real ones.

.venv/bin/python -m tests.fuzzing 100000             # as many, from a seed that is printed
.venv/bin/python -m tests.fuzzing --readers 1000     # as many files for each reader of files
.venv/bin/python -m tests.fuzzing --readers 1000 7 psl bag      # from seed 7, for these alone
"""

from __future__ import annotations

import json
import random
import resource
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from compiler.formalization.formalize import formalize
from compiler.formalization.record import formulas
from fretish.diagnostics.diagnostic import Diagnostic
from fretish.diagnostics.rendering import render
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry
from fretish.parser import parse

_DATA = Path(__file__).parent / "data"
_WORDS = (
    "after always and at before during eventually except finally first for if immediately in "
    "initially is last mod mode never next not occurrence of only or previous probability same "
    "satisfy shall the then timepoint unless until upon when whenever where while with within xor "
    "ticks microseconds milliseconds seconds minutes hours TRUE FALSE true false FTP persisted "
    "preBool prevOcc occurs ( ) ( ) , . ! ~ & | -> => <-> < <= > >= = != + - * / ^ 0 1 3 2.5 1e3 "
    '007 -2 p q r m s x y sw rover "my name" "free text" a.b a%b _x [ ] : ; \u2264 \u00e9 \t \n'
).split(" ")
_SCOPES = ("", "in m mode,", "except while m & r", "before m", "after (m | r)", "only in m")
_CONDITIONS = ("", "whenever p", "when p and if r", "upon p is FALSE,", "unless x > 3")
_TIMINGS = (
    "", "immediately", "at the next timepoint", "finally", "eventually", "always", "never",
    "within 3 ticks", "for 0 ticks", "after 2 seconds", "until s", "before s",
)  # fmt: skip
_ATOMS = ("p", "q", "x > 3", "true", "persisted(2,p)", "at the previous occurrence of p, q")


def sentences(count: int, seed: int) -> Iterator[str]:
    """That many texts; the same seed gives the same ones."""
    chance = random.Random(seed)
    real = [
        row["fretish"]
        for name in ("templates", "surface_forms", "case_studies")
        for row in json.loads((_DATA / f"fret_{name}.json").read_text("utf-8"))
    ]
    for _ in range(count):
        kind = chance.random()
        if kind < 0.4:
            yield _mutated(chance.choice(real), chance)
        elif kind < 0.8:
            yield _mutated(_grown(chance), chance) if chance.random() < 0.5 else _grown(chance)
        else:
            yield " ".join(chance.choices(_WORDS, k=chance.randint(0, 30)))


def _grown(chance: random.Random) -> str:
    parts = (
        chance.choice(_SCOPES),
        chance.choice(_CONDITIONS),
        "the sw shall",
        chance.choice(("", "", "", "with probability > 0.9")),
        chance.choice(_TIMINGS),
        "satisfy",
        _expression(chance, chance.randint(0, 5)),
    )
    return " ".join(part for part in parts if part)


def _expression(chance: random.Random, depth: int) -> str:
    if depth == 0:
        return chance.choice(_ATOMS)
    operator = chance.choice((" & ", " | ", " -> ", " <-> ", " xor ", "!", "if"))
    left, right = _expression(chance, depth - 1), _expression(chance, depth - 1)
    if operator == "!":
        return f"!({left})"
    return f"if {left} then {right}" if operator == "if" else f"({left}{operator}{right})"


def _mutated(text: str, chance: random.Random) -> str:
    """A few words dropped, doubled, swapped or replaced, or a character changed."""
    words = text.split(" ")
    for _ in range(chance.randint(1, 3)):
        at = chance.randrange(len(words))
        match chance.randrange(6):
            case 0:
                del words[at]
            case 1:
                words.insert(at, words[at])
            case 2:
                words.insert(at, chance.choice(_WORDS))
            case 3:
                words[at] = chance.choice(_WORDS)
            case 4:
                other = chance.randrange(len(words))
                words[at], words[other] = words[other], words[at]
            case _:
                cut = chance.randint(0, len(words[at]))
                words[at] = words[at][:cut] + chance.choice("aZ0_.!(\u00df") + words[at][cut:]
        words = words or [""]
    return " ".join(words)


def check(text: str) -> bool:
    """Read it, and formalize and print what is FRETish; True where it is.

    Raises:
        Exception: whatever the product lets out: it should never.
        AssertionError: a diagnostic without a place in the text.
    """
    source = Source("fuzz.fret", text)
    tree = parse(source.span())
    if isinstance(tree, Diagnostic):
        assert tree.span is not None
        assert 0 <= tree.span.start <= tree.span.end <= len(text), text
        assert render(tree)
        return False
    requirement, diagnostics = formalize(RequirementEntry("fuzz", source.span()), None)
    assert requirement is not None, diagnostics
    assert formulas(requirement)["ft_infinite"]
    return True


def main() -> None:
    """Check as many as asked for, and print how many were FRETish and the slowest."""
    if "--readers" in sys.argv:
        _files(sys.argv[sys.argv.index("--readers") + 1 :])
        return
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100_000
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else random.SystemRandom().randrange(10**6)
    check("the sw shall satisfy q")  # the grammar is compiled once
    accepted, slowest = 0, (0.0, "")
    for text in sentences(count, seed):
        start = time.process_time()
        accepted += check(text)
        slowest = max(slowest, (time.process_time() - start, text))
    print(f"seed {seed}: {count} texts, {accepted} of them FRETish")
    print(f"slowest: {slowest[0] * 1000:.1f} ms of CPU, {len(slowest[1].split())} words")


def _files(asked: list[str]) -> None:
    """Feed mutations to every reader of files; what breaks one stays in a folder that is named."""
    from tests import tables
    from tests.readers import fuzzed, readers

    count = int(asked[0]) if asked else 1000
    seed = int(asked[1]) if len(asked) > 1 else random.SystemRandom().randrange(10**6)
    folder, broken = Path(tempfile.mkdtemp(prefix="fuzzed")), 0
    print(f"seed {seed}, {count} files for each reader, in {folder}")
    for number, (name, reader) in enumerate(readers(folder / "sound").items()):
        if asked[2:] and name not in asked[2:]:
            continue
        try:
            slowest = fuzzed(name, reader, folder / str(number), count, seed)
            print(f"{name}: the slowest took {slowest:.2f} s", flush=True)
        except AssertionError as error:
            broken += 1
            print(f"{name}: BROKEN\n{error}", flush=True)
    if not asked[2:] or "tables" in asked[2:]:
        try:
            print(f"tables: {tables.fuzzed(folder / 'tables', count, seed)}", flush=True)
        except AssertionError as error:
            broken += 1
            print(f"tables: BROKEN\n{error}", flush=True)
    used = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
    print(f"at most {used} MiB of memory; {broken} readers broken")
    sys.exit(bool(broken))


if __name__ == "__main__":
    main()
