"""Prove that a compiled monitor in C means what its sentence means.

Its text has the form that fretc writes, so that a step depends on nothing but its cells and inputs
(`c_form`). It is compiled, and then explored in two comparisons, each until no new pair of states
appears: with the counter automaton of the sentence by both verdicts, for known values; and, rail by
rail, with the monitor in Python by all that a reading has, with unknown values too.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

from compiler.files.text_files import sha256
from compiler.formalization.formalized import Formalized
from compiler.formalization.letters import atoms_of, excluded
from compiler.logic.claims import Outcome, Trace, not_checked, proved, refuted
from compiler.logic.orders import only_possible
from compiler.targets.c.monitor import TARGET
from compiler.targets.python import monitor as python
from compiler.targets.target import Options
from fretc.verification.compiled.c_build import Binary, BuildError, built, layout
from fretc.verification.compiled.c_form import StrangeTextError, formed, same, tokens
from fretc.verification.compiled.c_machine import (
    CompiledRail,
    Judging,
    LayoutError,
    Library,
    Plan,
)
from fretc.verification.compiled.readings import NAMES, PythonRail
from fretc.verification.engines import sandbox
from fretc.verification.monitor import rails
from fretc.verification.monitor.equivalence import Difference
from fretc.verification.monitor.verifying import MOST_STATES, judged_wrongly, lock_step
from monitors.loading import load

_OF_OUTCOMES = re.compile(r"^    fretc_outcome (\w+); /\* (.*) \*/$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Given:
    """A monitor in C."""

    name: str
    """Of its file."""
    text: str
    header_name: str
    header: str


@dataclass(frozen=True, slots=True)
class Examined:
    """An outcome, with what it rests on."""

    outcome: Outcome
    compiler: str
    """With version and flags; empty where nothing was compiled."""
    artefacts: Mapping[str, str]
    """SHA-256 of the texts and of the binary."""


def verified(
    rule: Formalized,
    given: Given,
    program: str,
    limits: sandbox.Limits,
    others: Sequence[Formalized] = (),
    limit: int = MOST_STATES,
) -> Examined:
    """Compile a monitor, and compare it with its rule in a process of its own.

    Args:
        rule: one that the target accepts, on its own clock.
        given: a monitor of it, maybe with others.
        program: the path of the compiler.
        limits: of the exploration.
        others: further rules that the texts may implement.
        limit: the most states.
    """
    artefacts = {given.name: sha256(given.text), given.header_name: sha256(given.header)}
    try:
        binary, plan = prepared(rule, given, program, others)
    except (StrangeTextError, BuildError) as error:
        return Examined(not_checked(str(error)), "", artefacts)
    artefacts[f"{Path(given.name).stem}.so"] = hashlib.sha256(binary.data).hexdigest()
    return Examined(_confined(rule, binary, plan, limits, limit), binary.engine, artefacts)


def prepared(
    rule: Formalized, given: Given, program: str, others: Sequence[Formalized] = ()
) -> tuple[Binary, Plan]:
    """The library, and where the requirement is in it; nothing of it has run.

    Raises:
        StrangeTextError: the texts are not in the form that fretc writes.
        BuildError: the compiler does not take them.
    """
    plan = _planned(rule, given, others)
    places = layout(given.header_name, plan.base, plan.cells)
    return built(program, given.text, (given.header_name, given.header), places), plan


def _confined(
    rule: Formalized, binary: Binary, plan: Plan, limits: sandbox.Limits, limit: int
) -> Outcome:
    with TemporaryDirectory(prefix="fretc-") as folder:
        path = Path(folder) / "monitor.so"
        path.write_bytes(binary.data)
        outcome = sandbox.confined(limits, explored, rule, path, plan, limit)
    if isinstance(outcome, sandbox.Stopped):
        return not_checked(f"{outcome.reason}; so ends undefined behaviour in C, too")
    return outcome


@dataclass(frozen=True, slots=True)
class Original:
    """What fretc writes where a monitor in C is given, and the names in it."""

    rules: tuple[Formalized, ...]
    """In the order of their outcomes."""
    text: str
    header: str
    base: str
    """What the names of its functions begin with."""


def original(rule: Formalized, given: Given, others: Sequence[Formalized]) -> Original:
    """What fretc writes for the requirements of a monitor, whose header is that of fretc.

    Raises:
        StrangeTextError: the header is another one, or the rule is not among the requirements.
    """
    rules = _rules(given, (rule, *others))
    if rule.id not in [each.id for each in rules]:
        raise StrangeTextError("the monitor is of other requirements")
    text, header = _written(given, rules)
    same(tokens(given.header), tokens(header))
    (base,) = re.findall(r"^} (\w+)_outcomes;$", header, re.MULTILINE)
    return Original(tuple(rules), text, header, base)


def _planned(rule: Formalized, given: Given, others: Sequence[Formalized]) -> Plan:
    """Where the requirement is.

    Raises:
        StrangeTextError: the texts are not in the form that fretc writes.
    """
    own = original(rule, given, others)
    rules, own_header, base = own.rules, own.header, own.base
    form = formed(given.text, own.text, base)
    place = [each.id for each in rules].index(rule.id)
    part = form.part(_OF_OUTCOMES.findall(own_header)[place][0])
    cells = _members(own_header, f"{base}_rail")
    names = _members(own_header, f"{base}_inputs")
    inputs = tuple(dict.fromkeys(name for each in rules for name in each.watched))
    needed = [inputs[i] for i, name in enumerate(names) if name in part.inputs]
    if not {*needed} <= {*_atoms(rule)}:
        raise StrangeTextError(f"{rule.id} depends on what its sentence does not speak of")
    places = [inputs.index(name) if name in inputs else -1 for name in _atoms(rule)]
    return Plan(base, cells, part.cells, place, tuple(places), len(names))


def _rules(given: Given, rules: Sequence[Formalized]) -> list[Formalized]:
    """Those whose ids stand beside the outcomes of the header, in that order."""
    by_id = {each.id: each for each in rules}
    ids = [id for _, id in _OF_OUTCOMES.findall(given.header)]
    missing = [id for id in ids if id not in by_id]
    if missing or not ids:
        which = f"it has {missing[0]}, which" if missing else "it names no requirement that"
        raise StrangeTextError(f"{which} is not among the requirements that are read")
    return [by_id[id] for id in dict.fromkeys(ids)]


def _written(given: Given, rules: Sequence[Formalized]) -> tuple[str, str]:
    """What fretc writes for these rules: in one file if the header has the name of that."""
    for one_file in (False, True):
        files = {str(f.path): f.text for f in TARGET.emit(rules, Options(one_file=one_file))}
        header = files.get(given.header_name)
        if header is not None and (one_file or len(rules) == 1):
            return files[given.header_name.removesuffix(".h") + ".c"], header
    raise StrangeTextError(f"`{given.header_name}` is not the name that fretc gives the header")


def _members(header: str, name: str) -> tuple[str, ...]:
    """Of a struct."""
    body = header[: header.index(f"\n}} {name};\n")].rpartition("typedef struct {")[2]
    return tuple(re.findall(r"^    \w+ (\w+)(?:\[\d+\])?;", body, re.MULTILINE))


def _atoms(rule: Formalized) -> tuple[str, ...]:
    return tuple(dict.fromkeys((*atoms_of(rule.sentence), *rule.watched)))


# In the process that runs it --------------------------------------------------------------------


def explored(rule: Formalized, path: Path, plan: Plan, limit: int) -> Outcome:
    """Run the library, and compare it; a crash of it is one of this process.

    Args:
        rule: the requirement.
        path: of the library.
        plan: where the requirement is in it.
        limit: the most states of either comparison.
    """
    try:
        library = Library(path, plan)
    except (OSError, LayoutError) as error:
        return not_checked(f"the library cannot be used: {error}")
    starts = library.save(0), library.save(1)
    judged = lock_step(rule, Judging(library), _atoms(rule), limit)
    if isinstance(judged, str):
        return not_checked(judged)
    if isinstance(judged, Difference):
        return judged_wrongly(judged, _atoms(rule))
    states = _read(rule, library, starts, limit)
    if not isinstance(states, int):
        return states
    return proved(
        f"the same at every tick of every trace ({judged.states} states, {judged.steps} steps); "
        "with unknown values too, triggers, answers, open demands, deadlines and what is settled "
        f"are those of the monitor in Python ({states} states)"
    )


def _read(
    rule: Formalized, library: Library, starts: tuple[bytes, bytes], limit: int
) -> int | Outcome:
    """The states in which each rail tells what that of the monitor in Python tells."""
    atoms = _atoms(rule)
    if len(atoms) > rails.MOST_PROPOSITIONS:
        most = rails.MOST_PROPOSITIONS
        return not_checked(
            f"{len(atoms)} propositions, more than {most}, are too many for unknown values"
        )
    every = tuple(product((False, True, None), repeat=len(atoms)))
    letters = only_possible(every, atoms, excluded(rule))
    monitor, states = load("reference", python.text(rule)), 0
    for doubt in (False, True):
        for rail, start in enumerate(starts):
            library.load(rail, start)
        left = CompiledRail(library, doubt=doubt)
        right = PythonRail(monitor, rule, atoms, doubt=doubt)
        result = rails.in_lock_step(left, right, letters, limit, NAMES)
        match result:
            case None:
                return not_checked(f"with unknown values there are more than {limit} states")
            case rails.Apart(word, signal):
                which = "possible" if doubt else "certain"
                fault = f"the monitor in Python tells another {signal} in `{which}` on a trace"
                return refuted(fault, Trace(atoms, word))
            case rails.Same(count):
                states += count
    return states
