"""How many wrong sentences the tests of `fretc test` kill, and how fast they are made.

Against random words of the same total length, and against a suite like FLIP's: for each atom a
shortest word that is accepted, and is not once the atom is flipped at one tick. A mutant is killed
where the verdict on a whole word differs, or where one is broken at a tick at which the other
accepts. Source: Katis et al., a definition by flips of atoms, NFM 2025; this version is semantic,
by the reference automaton.
"""

from __future__ import annotations

import random
import time
from collections import Counter, deque
from collections.abc import Iterator, Sequence
from itertools import product
from pathlib import Path

from compiler.formalization import reference
from compiler.formalization.formalized import FormalizedRequirement
from compiler.formalization.letters import letters_by_valuation
from compiler.project.folder import load
from compiler.project.paths import requirement_files
from compiler.situations.mutants import mutants
from fretc.testing.assembly import jobs
from fretc.testing.suite import MutantStatus
from fretc.testing.words import RunColumns, is_killed, judged
from fretish.diagnostics.diagnostic import Diagnostic
from tests.requirement_sets import requirement

MISSION = Path(__file__).parents[1] / "requirements" / "mission"
MORE = (
    "upon a the sw shall for 10 ticks satisfy q",
    "whenever a the sw shall after 5 ticks satisfy q",
    "in m mode upon a the sw shall until s satisfy q",
    "only after m mode the sw shall within 5 ticks satisfy q",
    "when a the sw shall before s satisfy q",
    "after m mode whenever a the sw shall at the next timepoint satisfy q",
)
Valuation = tuple[bool, ...]
FlipState = tuple[reference.ReferenceState, reference.ReferenceState, bool]
"""States of both words, and whether an atom of the second has been flipped."""


def sentences() -> list[FormalizedRequirement]:
    """Fifteen of a mission, with bounds of up to 200 ticks, and six more."""
    paths = requirement_files(str(MISSION))
    assert not isinstance(paths, Diagnostic)
    return [
        *load(paths, None).formalized,
        *(requirement(f"X{i}", text) for i, text in enumerate(MORE, 1)),
    ]


def as_word(requirement: FormalizedRequirement, rows: Sequence[Valuation]) -> RunColumns:
    """Valuations of the atoms of a requirement, tick by tick."""
    columns = {
        name: sum(row[place] << tick for tick, row in enumerate(rows))
        for place, name in enumerate(requirement.watched)
    }
    return RunColumns((), columns, len(rows))


def by_flips(requirement: FormalizedRequirement) -> Iterator[RunColumns]:
    """For each atom a shortest accepted word that one flip of it makes a rejected one."""
    template = reference.template(requirement.sentence, requirement.ticks or 0)
    letters = letters_by_valuation(requirement.sentence, requirement.watched)
    initial = reference.initial(template)
    for place in range(len(requirement.watched)):
        start: FlipState = (initial, initial, False)
        seen = {start}
        waiting = deque[tuple[FlipState, tuple[Valuation, ...]]]([(start, ())])
        found: tuple[Valuation, ...] | None = None
        while waiting and found is None:
            (own, other, is_flipped), word = waiting.popleft()
            for row, flips in product(
                product((False, True), repeat=len(requirement.watched)), (0, 1)
            ):
                if is_flipped and flips:
                    continue
                changed = tuple(v ^ (i == place) for i, v in enumerate(row)) if flips else row
                after = reference.step(template, own, *letters[row])
                twin = reference.step(template, other, *letters[changed])
                if after is None:
                    continue
                if reference.accepts(template, after) and not (
                    twin is not None and reference.accepts(template, twin)
                ):
                    found = (*word, row)
                    break
                if twin is None:
                    continue
                key = (after, twin, is_flipped or bool(flips))
                if key not in seen:
                    seen.add(key)
                    waiting.append((key, (*word, row)))
        if found is not None:
            yield as_word(requirement, found)


def at_random(
    requirement: FormalizedRequirement, lengths: Sequence[int], seed: int
) -> Iterator[RunColumns]:
    """Words of the same lengths."""
    drawn = random.Random(f"{requirement.id} {seed}")
    for ticks in lengths:
        yield as_word(
            requirement,
            [tuple(drawn.choices((False, True), k=len(requirement.watched))) for _ in range(ticks)],
        )


def killed(
    requirement: FormalizedRequirement,
    wrong: Sequence[FormalizedRequirement],
    words: Sequence[RunColumns],
) -> int:
    """How many of the mutants some word kills."""
    own = [judged(requirement, word) for word in words]
    return sum(
        any(
            is_killed(one, judged(mutant, word), word.ticks)
            for one, word in zip(own, words, strict=True)
        )
        for mutant in wrong
    )


def main() -> None:
    """One line for each suite, and the time of ours."""
    requirements = sentences()
    together, alone = requirements[: -len(MORE)], requirements[-len(MORE) :]
    asked = [*jobs(together, (), 60), *(job for each in alone for job in jobs([each], (), 60))]
    start = time.process_time()
    batches = [batch for job in asked for batch in job.ask(())]
    print(f"{len(requirements)} sentences: {time.process_time() - start:.1f} s of CPU time")
    obligations = [one for batch in batches for one in batch.obligations]
    print(
        f"{len(obligations)} obligations:", dict(Counter(str(each.outcome) for each in obligations))
    )
    fates = Counter(str(one.outcome) for batch in batches for one in batch.mutants)
    print(f"{fates.total()} mutants:", dict(fates))
    suites: dict[str, list[tuple[int, int, int]]] = {}
    for subject, batch in zip(requirements, batches, strict=True):
        same = {one.key for one in batch.mutants if one.outcome is MutantStatus.EQUIVALENT}
        wrong = [each.requirement for each in mutants(subject) if each.key not in same]
        lengths = [test.ticks for test in batch.tests]
        ours = sum(one.outcome is MutantStatus.KILLED for one in batch.mutants)
        suites.setdefault("ours", []).append((len(lengths), sum(lengths), ours))
        others = {"flips": by_flips(subject), "random": at_random(subject, lengths, seed=1)}
        for name, words in others.items():
            made = [*words]
            ticks = sum(word.ticks for word in made)
            suites.setdefault(name, []).append((len(made), ticks, killed(subject, wrong, made)))
    for name, rows in suites.items():
        count, ticks, dead = map(sum, zip(*rows, strict=True))
        print(f"{name}: {count} words, {ticks} ticks, {dead} mutants killed")


if __name__ == "__main__":
    main()
