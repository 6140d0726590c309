"""What has changed: single changes of a project, with and without a new audit.

`python -m tests.fretc.audit.evidence.test_verdict_inputs` prints them as a table: what a change
touches, whose evidence is then of something else, and whose review no longer stands. What each
command has to say is computed from the links below, which are written down here, and nowhere taken
from the program.
"""

import json
import re
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from compiler.files.records import decoded
from compiler.project.folder import load_folder
from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.audit.evidence.schema import EvidenceDocument
from fretc.audit.evidence.writer import text
from fretc.audit.store.anywhere import read, source
from fretc.report.make import make
from fretc.traceability.chain_builder import chains
from fretc.traceability.lock import Lock, review_statuses
from fretc.traceability.lock import read as read_lock
from fretc.traceability.lock import text as lock_text
from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import Fretc, write
from tests.effort import FULL, some
from tests.fretc.logs.logs import MS, S, said
from tests.fretc.logs.logs import write as write_log
from tests.stores import write_document

IDS = ("R1", "R2", "R3")
FILES = {
    "requirements/r1.fret": """\
+++
id = "R1"
title = "Answer"
parents = ["HAZ-1"]
text = "It must answer."
rationale = "It would fall."
status = "draft"
verify = ["audit", "desk"]
params = { p = "1 m" }
+++
whenever p the sw shall within 300 milliseconds satisfy q
""",
    "requirements/r2.fret": """\
+++
id = "R2"
title = "Stay"
parents = ["R1"]
status = "approved"
+++
the sw shall always satisfy ok
""",
    "requirements/r3.fret": """\
+++
id = "R3"
title = "Keep"
parents = ["HAZ-2"]
status = "approved"
+++
the sw shall always satisfy fine
""",
    "requirements/hazards.toml": """\
[HAZ-1]
title = "It falls"
text = "From the table."
severity = "minor"
source = "workshop"

[HAZ-2]
title = "It burns"
""",
    "requirements/bindings.toml": """\
[clock]
tick = "100 ms"

[signal.x]
path = "/a.x"
unit = "m"
max_age = "300 ms"

[signal.y]
path = "/b.y"
unit = "m"

[signal.z]
path = "/a.z"
unit = "m"

[proposition.p]
text = "it is far"
expr = "x > 1 m for 100 ms"
role = "input"

[proposition.q]
expr = "y > 50 cm"

[proposition.ok]
expr = "z < 9 m"

[proposition.fine]
expr = "y < 9 m"
""",
}
R1, R2, R3, HAZARDS, BINDINGS = FILES
LOCK = "requirements/fretc.lock"
LOGS = ("logs/a.mcap", "logs/b.mcap")
BY = ("--reviewer", "A", "--role", "b", "--comment", "c", "--date", "2026-01-02")
ONE_PROCESS = ("--jobs", "1")
"""Two short logs are sooner read than a process is started for each."""


# What a requirement is made of ------------------------------------------------------------------


def links() -> Iterator[tuple[str, str]]:
    """What follows from what, from hazards to reviews."""
    yield from (("HAZ-1", "text R1"), ("text R1", "text R2"), ("HAZ-2", "text R3"))
    for id in IDS:
        for above in ("sentence", "params", "bindings", "monitor", "record"):
            yield f"{above} {id}", f"verdict {id}"
        for above in ("clock", "topics", "fretc", "log"):
            yield above, f"verdict {id}"
        for above in ("text", "words", "plan", "artefact", "verdict"):
            yield f"{above} {id}", f"review {id}"


def reached(things: set[str]) -> set[str]:
    """Everything downstream, the things themselves included."""
    reach, more = set(things), True
    while more:
        next_ones = {below for above, below in links() if above in reach} - reach
        reach |= next_ones
        more = bool(next_ones)
    return reach


def ids(things: set[str], kind: str) -> set[str]:
    return {id for id in IDS if f"{kind} {id}" in things}


@dataclass(frozen=True)
class Change:
    """One change, and what it changes of what requirements are made of."""

    name: str
    make: Callable[[], None]
    touches: frozenset[str] = frozenset()
    of_audit: bool = False
    """It is undone by a new audit."""
    respelt: str = ""
    """The requirement of which a threshold is written otherwise: it means the same, and its digits
    say where beside it runs are looked through."""

    def told(self) -> tuple[int, ...]:
        """Of how many requirements what is said, before a new audit and after it."""
        said = (self.stale, self.suspect, self.differs)
        return tuple(len(of(audited)) for audited in (False, True) for of in said)

    @property
    def things(self) -> frozenset[str]:
        """What it touches, whichever requirement that belongs to."""
        return frozenset(thing.partition(" ")[0] for thing in self.touches)

    def stale(self, audited: bool) -> set[str]:
        """Requirements whose evidence is about something else than what is here."""
        direct = {thing for thing in self.touches if not thing.startswith(("verdict", "log"))}
        return set() if audited else ids(reached(direct), "verdict")

    def suspect(self, audited: bool) -> set[str]:
        """Requirements whose review no longer stands on what was reviewed."""
        if self.of_audit and audited:
            return set()
        visible = {thing for thing in self.touches if audited or thing != "log"}
        return ids(reached(visible), "review")

    def differs(self, audited: bool) -> set[str]:
        """Requirements whose evidence comes out otherwise when it is made again.

        Another log than the reviewed one stays another one, whatever it is audited with.
        """
        own = ids(reached({t for t in self.touches if not audited or t == "log"}), "verdict")
        return own | ({self.respelt} if self.respelt and not audited else set())


# The changes ------------------------------------------------------------------------------------


def put(file: str, old: str, new: str) -> Callable[[], None]:
    def make() -> None:
        text = Path(file).read_text()
        assert old in text, (file, old)
        Path(file).write_text(text.replace(old, new, 1))

    return make


def after(file: str, table: str, line: str) -> Callable[[], None]:
    return put(file, f"{table}\n", f"{table}\n{line}\n")


def append(file: str, text: str) -> Callable[[], None]:
    def make() -> None:
        Path(file).write_text(Path(file).read_text() + text)

    return make


def changed(
    name: str,
    make: Callable[[], None],
    *touches: str,
    of_audit: bool = False,
    respelt: str = "",
) -> Change:
    return Change(name, make, frozenset(touches), of_audit, respelt)


def evidence(edit: Callable[[dict[str, object]], None], id: str = "R1") -> Callable[[], None]:
    """Edit each result of a requirement."""

    def make() -> None:
        content = _document()
        for result in content["results"]:
            if result["requirement"] == id:
                edit(result)
        _keep(content)

    return make


def _document() -> dict[str, Any]:
    found = read("build/evidence")
    assert not isinstance(found, Diagnostic)
    content: dict[str, Any] = json.loads(text(found.document))
    return content


def _keep(content: dict[str, Any]) -> None:
    """As a store that somebody wrote with the tool's own means."""
    written = write_document(Path("build/evidence"), decoded(content, EvidenceDocument))
    assert not isinstance(written, Diagnostic)


def hashed(kind: str, value: str | None) -> Callable[[], None]:
    def edit(result: dict[str, object]) -> None:
        hashes = result["hashes"]
        assert isinstance(hashes, dict)
        hashes.pop(kind)
        if value is not None:
            hashes[kind] = value

    return evidence(edit)


SENTENCES = [
    changed("a scope", put(R1, "whenever p the", "while q, whenever p the"), "sentence R1"),
    changed("another scope", put(R2, "the sw", "after ok, the sw"), "sentence R2"),
    changed("another condition", put(R1, "whenever p", "whenever q"), "sentence R1"),
    changed("when for whenever", put(R1, "whenever p", "when p"), "sentence R1"),
    changed("no condition", put(R1, "whenever p the", "the"), "sentence R1"),
    changed("another component", put(R1, "the sw", "the hw"), "sentence R1"),
    changed("another deadline", put(R1, "within 300", "within 400"), "sentence R1"),
    changed("ticks for time", put(R1, "300 milliseconds", "3 ticks"), "sentence R1"),
    changed("another timing", put(R1, "within 300", "for 300"), "sentence R1"),
    changed("never for always", put(R2, "always", "never"), "sentence R2"),
    changed("eventually for always", put(R3, "always", "eventually"), "sentence R3"),
    changed("another response", put(R1, "satisfy q", "satisfy !q"), "sentence R1"),
    changed("more in the response", put(R2, "satisfy ok", "satisfy ok & ok"), "sentence R2"),
    changed("a name for another", put(R3, "satisfy fine", "satisfy q"), "sentence R3"),
    changed("a line break", put(R1, "shall within", "shall\n    within")),
    changed("more white space", put(R1, "satisfy q", "satisfy   q")),
    # Monitors quote their sentence as it is written.
    changed("no article", put(R1, "p the sw", "p sw"), "monitor R1"),
    changed("an empty line at the end", append(R1, "\n\n")),
]
HEADERS = [
    changed("title", put(R1, '"Answer"', '"Reply"'), "text R1"),
    changed("title of the last", put(R3, '"Keep"', '"Hold"'), "text R3"),
    changed("text", put(R1, '"It must answer."', '"It may answer."'), "text R1"),
    changed("no text", put(R1, 'text = "It must answer."\n', ""), "text R1"),
    changed("rationale", put(R1, "would fall", "would burn"), "text R1"),
    changed("a parent more", put(R3, '["HAZ-2"]', '["HAZ-2", "HAZ-1"]'), "text R3"),
    changed("another parent", put(R3, '["HAZ-2"]', '["HAZ-1"]'), "text R3"),
    changed("no parent", put(R2, 'parents = ["R1"]\n', ""), "text R2"),
    changed("another number", put(R1, '"1 m"', '"2 m"'), "params R1"),
    changed("a number more", put(R1, '"1 m" }', '"1 m", q = "50 cm" }'), "params R1"),
    changed("no number", put(R1, 'params = { p = "1 m" }\n', ""), "params R1"),
    changed("a number for another name", put(R1, "{ p =", "{ q ="), "params R1"),
    changed("a planned method is taken out", put(R1, '["audit", "desk"]', '["audit"]'), "plan R1"),
    changed("no plan", put(R1, 'verify = ["audit", "desk"]\n', ""), "plan R1"),
    changed(
        "an assumption",
        put(R1, 'title = "Answer"', 'kind = "assumption"\ntitle = "Answer"'),
        "text R1",
    ),
    changed(
        "the kind by its name",
        put(R1, 'title = "Answer"', 'kind = "requirement"\ntitle = "Answer"'),
    ),
    changed("the number in another unit", put(R1, '"1 m"', '"100 cm"')),
    changed("the number with more digits", put(R1, '"1 m"', '"1.00 m"')),
    changed("approved", put(R1, '"draft"', '"approved"')),
    changed("a planned method", put(R1, '"desk"]', '"desk", "verify"]')),
    changed("a planned target", put(R1, '"desk"]', '"desk", "smv"]')),
    changed("what FRET keeps", put(R1, "+++\nwhenever", 'fret = { project = "x" }\n+++\nwhenever')),
    changed("white space in the title", put(R1, '"Answer"', '" Answer "')),
    changed("a comment", put(R1, '"Answer"', '"Answer"  # or not')),
    changed("another order", put(R1, 'id = "R1"\ntitle = "Answer"', 'title = "Answer"\nid = "R1"')),
    changed("plans in another order", put(R1, '["audit", "desk"]', '["desk", "audit"]')),
]
HAZARD = [
    changed("its title", put(HAZARDS, "It falls", "It flies"), "HAZ-1"),
    changed("its text", put(HAZARDS, "the table", "the roof"), "HAZ-1"),
    changed("its severity", put(HAZARDS, "minor", "major"), "HAZ-1"),
    changed("its source", put(HAZARDS, "workshop", "meeting"), "HAZ-1"),
    changed("the other title", put(HAZARDS, "It burns", "It melts"), "HAZ-2"),
    changed("a text", append(HAZARDS, 'text = "Away."\n'), "HAZ-2"),
    changed("a comment", append(HAZARDS, "# nothing\n")),
    changed("another hazard", append(HAZARDS, '\n[HAZ-3]\ntitle = "It sinks"\n')),
]
CLOCK = [
    changed("tick", put(BINDINGS, '"100 ms"', '"50 ms"'), "clock"),
    changed("time", after(BINDINGS, "[clock]", 'time = "publish_time"'), "clock"),
    changed("end", after(BINDINGS, "[clock]", 'end = "violated"'), "clock"),
    changed("phase", after(BINDINGS, "[clock]", 'phase = "10 ms"'), "clock"),
    changed("the tick in seconds", put(BINDINGS, '"100 ms"', '"0.1 s"')),
    changed("the default of time", after(BINDINGS, "[clock]", 'time = "log_time"')),
    changed("the default of end", after(BINDINGS, "[clock]", 'end = "inconclusive"')),
    changed("the default of phase", after(BINDINGS, "[clock]", 'phase = "0 ns"')),
    changed("the default of rounding", after(BINDINGS, "[clock]", 'rounding = "exact"')),
    changed("rounding of none", after(BINDINGS, "[clock]", 'rounding = "conservative"')),
]
X, Y, P, Q = "[signal.x]", "[signal.y]", "[proposition.p]", "[proposition.q]"
SIGNALS = [
    changed("another field", put(BINDINGS, "/a.x", "/a.z"), "bindings R1"),
    changed("another topic", put(BINDINGS, "/a.x", "/c.x"), "bindings R1", "topics"),
    changed("the other topic", put(BINDINGS, "/a.z", "/b.y"), "bindings R2"),
    changed("another unit", put(BINDINGS, 'x"\nunit = "m"', 'x"\nunit = "cm"'), "bindings R1"),
    changed("max_age", put(BINDINGS, '"300 ms"', '"400 ms"'), "bindings R1"),
    changed("no max_age", put(BINDINGS, 'max_age = "300 ms"\n', ""), "bindings R1"),
    changed("a type", after(BINDINGS, X, 'type = "S"'), "bindings R1"),
    changed("valid", after(BINDINGS, X, 'valid = "x < 99"'), "bindings R1"),
    changed("invalid", after(BINDINGS, X, 'invalid = { nan = "drop" }'), "bindings R1"),
    changed("of two", after(BINDINGS, Y, 'max_age = "9 s"'), "bindings R1", "bindings R3"),
    changed("valid of two", after(BINDINGS, Y, 'valid = "x < 99"'), "bindings R1", "bindings R3"),
    changed("max_age in seconds", put(BINDINGS, '"300 ms"', '"0.3 s"')),
    changed("the default of invalid", after(BINDINGS, X, 'invalid = { nan = "unknown" }')),
    changed("a unit spelt otherwise", put(BINDINGS, 'x"\nunit = "m"', 'x"\nunit = "m*1"')),
    changed("unused, of a topic that is read", append(BINDINGS, '\n[signal.u]\npath = "/a.u"\n')),
    changed("unused, of another topic", append(BINDINGS, '\n[signal.u]\npath = "/c.x"\n')),
    changed("a comment above all", put(BINDINGS, "[clock]", "# what is meant\n\n[clock]")),
]
PROPOSITIONS = [
    changed("another bound", put(BINDINGS, "x > 1 m", "x > 2 m"), "bindings R1"),
    changed("another operator", put(BINDINGS, "x > 1 m", "x >= 1 m"), "bindings R1"),
    changed("another bound of R2", put(BINDINGS, "z < 9 m", "z < 8 m"), "bindings R2"),
    changed("another bound of R3", put(BINDINGS, "y < 9 m", "y < 8 m"), "bindings R3"),
    changed("longer", put(BINDINGS, "for 100 ms", "for 200 ms"), "bindings R1"),
    changed("at once", put(BINDINGS, " for 100 ms", ""), "bindings R1"),
    changed("negated", put(BINDINGS, '"y > 50 cm"', '"not (y > 50 cm)"'), "bindings R1"),
    changed("agg", after(BINDINGS, P, 'agg = "any"'), "bindings R1"),
    changed("on_unknown", after(BINDINGS, P, "on_unknown = true"), "bindings R1"),
    changed("its text", put(BINDINGS, "it is far", "it is near"), "words R1"),
    changed("a text", after(BINDINGS, Q, 'text = "y"'), "words R1"),
    changed("its role", put(BINDINGS, '"input"', '"internal"'), "words R1"),
    changed("its kind", after(BINDINGS, Q, 'kind = "belief"'), "words R1"),
    changed("its modality", after(BINDINGS, "[proposition.fine]", 'modality = "G"'), "artefact R3"),
    changed("the bound in metres", put(BINDINGS, "50 cm", "0.5 m"), respelt="R1"),
    changed("the bound in km", put(BINDINGS, "50 cm", "0.0005 km"), respelt="R1"),
    changed("the bound as a sum", put(BINDINGS, "50 cm", "500 mm"), respelt="R1"),
    changed("more digits", put(BINDINGS, "1 m for", "1.00 m for"), respelt="R1"),
    changed("seconds", put(BINDINGS, "for 100 ms", "for 0.1 s")),
    changed("the default of agg", after(BINDINGS, P, 'agg = "last"')),
    changed("the default of on_unknown", after(BINDINGS, P, 'on_unknown = "unknown"')),
    changed("the default of role", after(BINDINGS, Q, 'role = "internal"')),
    changed("white space", put(BINDINGS, "y > 50 cm", "y  >  50 cm")),
    changed("parentheses", put(BINDINGS, '"y > 50 cm"', '"(y > 50 cm)"')),
    changed("unused", append(BINDINGS, '\n[proposition.u]\nexpr = "x > 3 m"\n')),
    changed("a variable", append(BINDINGS, '\n[variable.v]\nrole = "input"\n')),
]


def log(path: str, *values: float) -> None:
    """x, y and z as they are, 100 ms apart, on three topics."""
    Path(path).parent.mkdir(exist_ok=True)
    messages = [
        replace(said(topic, S + i * 100 * MS, **fields), type="S")
        for i, value in enumerate(values)
        for topic, fields in (
            ("/a", {"x": value, "z": 1, "u": 0}),
            ("/b", {"y": value}),
            ("/c", {"x": value}),
        )
    ]
    write_log(Path(path), messages)


def logged(path: str, *values: float) -> Callable[[], None]:
    return lambda: log(path, *values)


def fretc_of_then() -> None:
    _keep(_document() | {"fretc": "0.0.1"})


def verdict(result: dict[str, object]) -> None:
    result["verdict"] = "inconclusive"


EVIDENCE = [
    changed("another fretc", fretc_of_then, "fretc", of_audit=True),
    changed("a sentence", hashed("sentence", "0" * 64), "sentence R1", of_audit=True),
    changed("numbers", hashed("params", "0" * 64), "params R1", of_audit=True),
    changed("a clock", hashed("clock", "0" * 64), "record R1", of_audit=True),
    changed("topics", hashed("topics", "0" * 64), "record R1", of_audit=True),
    changed("bindings", hashed("bindings", "0" * 64), "bindings R1", of_audit=True),
    changed("a monitor", hashed("monitor", "0" * 64), "record R1", of_audit=True),
    changed("of before the clock", hashed("clock", None), "record R1", of_audit=True),
    changed("a verdict by hand", evidence(verdict), "verdict R1", of_audit=True),
    changed("another log", logged(LOGS[0], 0, 2, 3, 3, 2, 1, 0), "log"),
    changed("a log of the same length", logged(LOGS[0], 0, 3, 3, 3, 1, 1, 0), "log"),
    changed("the same log again", logged(LOGS[0], 0, 2, 3, 3, 1, 1, 0)),
    changed("a log more", logged("logs/c.mcap", 0, 2, 2, 2, 1, 1, 0)),
]
CHANGES = {
    f"{kind}: {change.name}": change
    for kind, changes in (
        ("sentence", SENTENCES),
        ("header", HEADERS),
        ("hazard", HAZARD),
        ("clock", CLOCK),
        ("signal", SIGNALS),
        ("proposition", PROPOSITIONS),
        ("evidence", EVIDENCE),
    )
    for change in changes
}

NOTHING = [name for name, one in CHANGES.items() if not (one.touches or one.respelt)]
GROUPS = len(NOTHING) if FULL else 4
TOGETHER = [tuple(NOTHING[i::GROUPS]) for i in range(GROUPS)]
"""Made one after the other in quick tests: what changes nothing changes nothing beside others."""
REACHING = {name: one for name, one in CHANGES.items() if name not in NOTHING}
TOLD = REACHING if FULL else [*{one.told(): name for name, one in REACHING.items()}.values()]
"""What all commands are asked about: in quick tests one of each kind; `chains` about all."""
AUDITED = REACHING if FULL else {n for n in TOLD if REACHING[n].things & {"clock", "log", "words"}}
"""After which there is a new audit."""


# What is said -----------------------------------------------------------------------------------


def with_review(fretc: Fretc, base: Path) -> Fretc:
    """The current folder gets the project, audited and reviewed; `base` keeps it from then on."""
    if not any(base.iterdir()):
        for name, content in FILES.items():
            write(name, content)
        for path, values in zip(LOGS, ((0, 2, 3, 3, 1, 1, 0), (0, 2, 2, 2, 2, 1, 0)), strict=True):
            log(path, *values)
        assert fretc("audit", "logs", *ONE_PROCESS).status == 0
        assert fretc("lock", *BY).status == 0
        shutil.copytree(".", base, dirs_exist_ok=True)
    shutil.copytree(base, ".", dirs_exist_ok=True)
    return fretc


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("base")


@pytest.fixture
def reviewed(fretc: Fretc, base: Path) -> Fretc:
    """The project in the current folder: audited, and reviewed."""
    return with_review(fretc, base)


@dataclass(frozen=True)
class Said:
    """What the four commands say, each as sets of requirements."""

    stale: dict[str, set[str]]
    suspect: dict[str, set[str]]
    differs: set[str]


def older(result: dict[str, Any]) -> bool:
    """Whether a result is of something else; that its review no longer stands is another reason."""
    return any("since the review of" not in reason for reason in result["suspicions"])


_OUTDATED = re.compile(r"F504 warning: the evidence of (.+?) is suspect")
"""Requirements whose evidence is suspect for one reason share a message."""


def asked(fretc: Fretc) -> Said:
    diff = json.loads(fretc("diff", "--format", "json").out)
    check = fretc("check").err
    own_project = load_folder("requirements")
    assert not isinstance(own_project, Diagnostic)
    outcome = make(own_project, "build/evidence", lock=LOCK)
    report = json.loads(outcome.json or "")["requirements"]
    verify = fretc("verify-evidence", *ONE_PROCESS, "--format", "json").out
    again = [one for one in json.loads(verify)["results"] if one["finding"] == "differs"]
    everywhere = any(
        "the installed fretc is" in reason for one in again for reason in one["reasons"]
    )
    return Said(
        {
            "check": {id for ids in _OUTDATED.findall(check) for id in re.findall(r"R\w+", ids)},
            "report": {v["id"] for v in report if any(map(older, v["results"]))},
        },
        {
            "diff": {one["requirement"] for one in diff if one["suspect_links"]},
            "check": set(re.findall(r"F512 warning: (\S+) was reviewed", check)),
            "report": {v["id"] for v in report if v["review"]["mark"]["word"] != "reviewed"},
        },
        set(IDS) if everywhere else {one["requirement"] for one in again} - {""},
    )


@pytest.mark.slow
def test_a_change_is_in_the_chains_of_what_is_made_of_it_and_of_nothing_else(
    reviewed: Fretc, base: Path
) -> None:
    lock, evidence = read_lock(LOCK), summaries()
    assert isinstance(lock, Lock)
    for names in (*TOGETHER, *((name,) for name in REACHING)):
        for name in names:
            CHANGES[name].make()
        project = load_folder("requirements")
        assert not isinstance(project, Diagnostic)
        of_evidence = any(name.startswith("evidence") for name in names)
        found = chains(project, summaries() if of_evidence else evidence)
        suspect = {one.chain.requirement for one in review_statuses(found, lock) if one.suspects}
        change = CHANGES[names[0]]
        assert {one.requirement for one in found if one.outdated} == change.stale(False), names
        assert suspect == change.suspect(audited=False), names
        for file, content in FILES.items():
            write(file, content)
        if of_evidence:
            shutil.rmtree("build")
            shutil.copytree(base, ".", dirs_exist_ok=True)


def summaries() -> ResultSummaries:
    evidence = source("build/evidence")
    assert not isinstance(evidence, Diagnostic)
    return ResultSummaries.of(evidence)


@pytest.mark.slow
@pytest.mark.parametrize("name", TOLD)
def test_a_change_reaches_what_is_made_of_it_and_nothing_else(reviewed: Fretc, name: str) -> None:
    change = REACHING[name]
    change.make()
    held(reviewed, change, audited=False)
    if name in AUDITED:
        reviewed("audit", "logs", *ONE_PROCESS)
        held(reviewed, change, audited=True)


@pytest.mark.slow
@pytest.mark.parametrize("names", some(TOGETHER, 4), ids="; ".join)
def test_what_changes_nothing_reaches_nothing(reviewed: Fretc, names: tuple[str, ...]) -> None:
    for name in names:
        CHANGES[name].make()
    for audited in (False, True):
        if audited:
            reviewed("audit", "logs", *ONE_PROCESS)
        held(reviewed, changed("; ".join(names), lambda: None), audited)


def held(fretc: Fretc, change: Change, audited: bool) -> None:
    answers = asked(fretc)
    assert answers.stale == dict.fromkeys(("check", "report"), change.stale(audited))
    assert answers.suspect == dict.fromkeys(("diff", "check", "report"), change.suspect(audited))
    assert answers.differs == change.differs(audited)


def test_there_are_more_changes_than_were_once_tried_by_hand() -> None:
    assert len(CHANGES) >= 82


@pytest.mark.slow
def test_evidence_of_what_has_come_back_is_still_of_something_else(reviewed: Fretc) -> None:
    before = Path(BINDINGS).read_text()
    put(BINDINGS, "x > 1 m", "x > 2 m")()
    reviewed("audit", "logs", *ONE_PROCESS)
    Path(BINDINGS).write_text(before)
    answers = asked(reviewed)
    assert list(answers.stale.values()) == [{"R1"}] * 2
    assert list(answers.suspect.values()) == [{"R1"}] * 3
    assert answers.differs == {"R1"}


@pytest.mark.slow
def test_evidence_of_something_else_is_not_accepted(reviewed: Fretc) -> None:
    put(BINDINGS, "x > 1 m", "x > 2 m")()
    before = Path(LOCK).read_text()
    run = reviewed("lock", *BY)
    assert run.status == 2
    message = "F541 the evidence for R1 is about another version: bindings R1\n"
    assert message in run.err
    assert Path(LOCK).read_text() == before
    assert reviewed("lock", "R2", *BY).status == 0, "of the others nothing is asked"
    reviewed("audit", "logs", *ONE_PROCESS)
    assert reviewed("lock", *BY, "--accept-violations").status == 0
    assert reviewed("diff").status == 0


def test_a_log_that_nothing_identifies_is_not_accepted(reviewed: Fretc) -> None:
    shutil.rmtree("logs")
    hashed("log", None)()
    run = reviewed("lock", *BY)
    assert run.status == 2
    assert "F542 the evidence does not identify the log `logs/a.mcap` of R1, because" in run.err


@pytest.mark.slow
@pytest.mark.parametrize("audited", [False, True])
def test_a_log_that_is_gone_is_told(reviewed: Fretc, audited: bool) -> None:
    Path(LOGS[1]).unlink()
    if audited:
        reviewed("audit", "logs", *ONE_PROCESS)
        content = json.loads(reviewed("diff", "--format", "json").out)
        assert {one["requirement"] for one in content if one["suspect_links"]} == set(IDS)
    else:
        assert reviewed("verify-evidence").status == 3


# What is claimed no more ------------------------------------------------------------------------


def removed() -> None:
    Path(R3).unlink()


def renamed() -> None:
    put(R3, '"R3"', '"R3b"')()


def split() -> None:
    text = Path(R3).read_text()
    removed()
    for part in "ab":
        write(f"requirements/r3{part}.fret", text.replace('"R3"', f'"R3{part}"'))


def retired() -> None:
    put(R3, '"approved"', '"retired"')()


def all_retired() -> None:
    retired()
    put(R2, '"approved"', '"retired"')()
    put(R1, '"draft"', '"retired"')()


WITHDRAWN = {
    "removed": (removed, {"R3"}),
    "renamed": (renamed, {"R3"}),
    "split": (split, {"R3"}),
    "retired": (retired, {"R3"}),
    "all retired": (all_retired, set(IDS)),
}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "audited"), some(product(WITHDRAWN, (False, True)), 3))
def test_what_was_claimed_and_is_not_any_more_is_never_lost(
    reviewed: Fretc, name: str, audited: bool
) -> None:
    make_it, ids = WITHDRAWN[name]
    make_it()
    if audited:
        reviewed("audit", "logs", *ONE_PROCESS)
    diff = json.loads(reviewed("diff", "--format", "json").out)
    suspects = {
        one["requirement"] for one in diff if one["suspect_links"] or one["state"] == "gone"
    }
    assert suspects == ids
    assert set(re.findall(r"F5(?:11|40) warning: (\S+) was", reviewed("check").err)) == ids
    run = reviewed("report", "--strict", "--json", "r.json", "--junit", "r.xml")
    report = json.loads(Path("r.json").read_text())
    assert run.status == 1
    assert {one["requirement"] for one in report["withdrawn"]} == ids
    assert report["overall"]["headline"] != "All claimed requirements are shown."
    assert all(any(id in sentence for sentence in report["overall"]["sentences"]) for id in ids)
    junit = Path("r.xml").read_text()
    cases = re.findall(r'name="(\w+)[^"]*"[^>]*>\s*<failure message="withdrawn: ', junit)
    assert set(cases) == ids
    if not audited:
        again = json.loads(reviewed("verify-evidence", "--format", "json").out or '{"results": []}')
        differing = {r["requirement"] for r in again["results"] if r["finding"] == "differs"} - {""}
        new = {"renamed": {"R3b"}, "split": {"R3a", "R3b"}}.get(name, set())
        assert differing == (ids | new if name != "all retired" else set())


@pytest.mark.slow
@pytest.mark.parametrize("name", some([n for n in WITHDRAWN if n != "all retired"], 2))
def test_who_accepts_that_something_is_claimed_no_more_hears_of_it_no_more(
    reviewed: Fretc, name: str
) -> None:
    make_it, ids = WITHDRAWN[name]
    make_it()
    reviewed("audit", "logs", *ONE_PROCESS)
    assert reviewed("lock", "R1", *BY).status == 0
    assert reviewed("report", "--strict").status == 1, "R3 is still to be accepted"
    assert reviewed("lock", *sorted(ids), *BY).status == 0
    assert json.loads(reviewed("diff", "--format", "json").out)[-1]["state"] != "gone"
    assert "was reviewed" not in reviewed("check").err


def test_what_was_renamed_is_found_by_its_sentence(reviewed: Fretc) -> None:
    renamed()
    assert (
        "F511 warning: R3 was reviewed (satisfied in 2 runs) and is no longer among the "
        "requirements; R3b has the same sentence\n"
    ) in reviewed("check").err


def test_a_requirement_without_a_review_is_told_where_others_have_one(reviewed: Fretc) -> None:
    renamed()
    assert "F544 warning: R3b was never reviewed\n" in reviewed("check").err


def test_a_project_in_which_all_is_retired_shows_nothing(reviewed: Fretc) -> None:
    all_retired()
    Path(LOCK).unlink()
    assert reviewed("report", "--strict").status == 3


# What nobody can have reviewed ------------------------------------------------------------------

LOCKS: dict[str, Callable[[], None]] = {
    "reviewer": put(LOCK, 'reviewer = "A"', 'reviewer = "B"'),
    "verdict": put(LOCK, '"logs/a.mcap" = "satisfied"', '"logs/a.mcap" = "violated"'),
    "date": put(LOCK, 'date = "2026-01-02"', 'date = "2026-01-01"'),
    "form": put(LOCK, '"fretc-lock-3"', '"fretc-lock-1"'),
    "a review under another name": put(LOCK, "[review.R3]", "[review.R4]"),
    "in the year 3000": lambda: _dated("3000-01-01"),
}
READ_LOCK = ("diff", "check", "report", "lock", "verify-evidence")


def _dated(day: str) -> None:
    lock = read_lock(LOCK)
    assert isinstance(lock, Lock)
    text = lock_text(Lock({id: replace(one, date=day) for id, one in lock.reviews.items()}))
    Path(LOCK).write_text(text)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "command"), some(product(LOCKS, READ_LOCK), 4))
def test_a_lock_that_nobody_can_have_written_is_refused_by_all(
    reviewed: Fretc, name: str, command: str
) -> None:
    LOCKS[name]()
    run = reviewed(command, *(BY if command == "lock" else ()))
    assert run.status == 2
    assert "F510 " in run.err


def test_nobody_reviews_on_a_day_to_come(reviewed: Fretc) -> None:
    run = reviewed("lock", *BY[:-1], "3000-01-01")
    assert (run.status, run.err.splitlines()[0]) == (
        2,
        "F907 `3000-01-01` is in the future: a review cannot have happened yet",
    )


# The table --------------------------------------------------------------------------------------

if __name__ == "__main__":
    for name, change in CHANGES.items():
        told = [*sorted(change.touches)] or ["nothing"]
        stale, suspect = sorted(change.stale(False)), sorted(change.suspect(True))
        print(f"{name:<44} {', '.join(told):<24} {' '.join(stale):<10} {' '.join(suspect)}")
