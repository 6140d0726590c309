"""Each change since a review by itself, with what the files said before and what they say now."""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import pytest

from compiler.project.folder import load_folder
from fretc.audit.evidence.reader import EvidenceFile
from fretc.audit.evidence.result_summaries import ResultSummaries
from fretc.audit.store.anywhere import read as read_evidence
from fretc.traceability.chain import ChainItem
from fretc.traceability.chain_builder import chains
from fretc.traceability.comparison import ReviewDifference, differences
from fretc.traceability.lock import Lock, accepted, read, review_statuses, text
from fretc.traceability.meanings import agree
from fretc.traceability.texts import as_table
from fretish.diagnostics.diagnostic import Diagnostic
from tests.command import Fretc, write
from tests.effort import FULL, pairwise, some
from tests.fretc.audit.evidence.test_verdict_inputs import (
    BINDINGS,
    BY,
    CHANGES,
    LOGS,
    ONE_PROCESS,
    R1,
    R3,
    log,
    put,
    with_review,
)

LOCK, EVIDENCE = "requirements/fretc.lock", "build/evidence"
ALL = ("R1", "R2", "R3")
SENTENCE = "whenever p the sw shall within 300 milliseconds satisfy q"
Expected = tuple[str, str, str]
"""What, before, after."""


def of(*expected: Expected, ids: tuple[str, ...] = ("R1",)) -> dict[str, list[Expected]]:
    return {id: list(expected) for id in ids}


def sentence(old: str, new: str) -> dict[str, list[Expected]]:
    return of(("sentence", SENTENCE, SENTENCE.replace(old, new, 1)))


def always(id: str, before: str, after: str) -> dict[str, list[Expected]]:
    start = "the sw shall "
    return of(("sentence", f"{start}{before}", f"{start}{after}"), ids=(id,))


def below(field: str, before: str, after: str) -> dict[str, list[Expected]]:
    """A text of R1, which R2 has as its parent."""
    own = of((field, before, after))
    return own | of((f"{field} of R1", before, after), ids=("R2",))


def hazard(field: str, before: str, after: str) -> dict[str, list[Expected]]:
    return of((f"{field} of HAZ-1", before, after), ids=("R1", "R2"))


def clock(field: str, before: str, after: str) -> dict[str, list[Expected]]:
    return of((f"{field} of the clock", before, after), ids=ALL)


P = "x > 1 m for 100 ms"
EXPECTED: Mapping[str, dict[str, list[Expected]]] = {
    "sentence: a scope": sentence("whenever p the", "while q, whenever p the"),
    "sentence: another scope": of(
        ("sentence", "the sw shall always satisfy ok", "after ok, the sw shall always satisfy ok"),
        ids=("R2",),
    ),
    "sentence: another condition": sentence("whenever p", "whenever q"),
    "sentence: when for whenever": sentence("whenever", "when"),
    "sentence: no condition": sentence("whenever p the", "the"),
    "sentence: another component": sentence("the sw", "the hw"),
    "sentence: another deadline": sentence("within 300", "within 400"),
    "sentence: ticks for time": sentence("300 milliseconds", "3 ticks"),
    "sentence: another timing": sentence("within 300", "for 300"),
    "sentence: never for always": always("R2", "always satisfy ok", "never satisfy ok"),
    "sentence: eventually for always": always(
        "R3", "always satisfy fine", "eventually satisfy fine"
    ),
    "sentence: another response": sentence("satisfy q", "satisfy !q"),
    "sentence: more in the response": always("R2", "always satisfy ok", "always satisfy ok & ok"),
    "sentence: a name for another": always("R3", "always satisfy fine", "always satisfy q"),
    "sentence: no article": of(("wording", SENTENCE, SENTENCE.replace("the sw", "sw"))),
    "header: title": below("title", "Answer", "Reply"),
    "header: title of the last": of(("title", "Keep", "Hold"), ids=("R3",)),
    "header: text": below("text", "It must answer.", "It may answer."),
    "header: no text": below("text", "It must answer.", ""),
    "header: rationale": below("rationale", "It would fall.", "It would burn."),
    "header: a parent more": of(("parents", "HAZ-2", "HAZ-2, HAZ-1"), ids=("R3",)),
    "header: another parent": of(("parents", "HAZ-2", "HAZ-1"), ids=("R3",)),
    "header: no parent": of(("parents", "R1", ""), ids=("R2",)),
    "header: another number": of(("number stated for p", "1 m", "2 m")),
    "header: a number more": of(("number stated for q", "", "50 cm")),
    "header: no number": of(("number stated for p", "1 m", "")),
    "header: a number for another name": of(
        ("number stated for p", "1 m", ""), ("number stated for q", "", "1 m")
    ),
    "header: an assumption": below("kind", "", "assumption"),
    "header: a planned method is taken out": of(("verify", "audit, desk", "audit")),
    "header: no plan": of(("verify", "audit, desk", "")),
    # Whatever is planned in addition is reported, and makes nothing suspect.
    "header: a planned method": of(("verify", "audit, desk", "audit, desk, verify")),
    "header: a planned target": of(("verify", "audit, desk", "audit, desk, smv")),
    "hazard: its title": hazard("title", "It falls", "It flies"),
    "hazard: its text": hazard("text", "From the table.", "From the roof."),
    "hazard: its severity": hazard("severity", "minor", "major"),
    "hazard: its source": hazard("source", "workshop", "meeting"),
    "hazard: the other title": of(("title of HAZ-2", "It burns", "It melts"), ids=("R3",)),
    "hazard: a text": of(("text of HAZ-2", "", "Away."), ids=("R3",)),
    "clock: tick": clock("tick", "100 ms", "50 ms"),
    "clock: time": clock("time", "", "publish_time"),
    "clock: end": clock("end", "", "violated"),
    "clock: phase": clock("phase", "", "10 ms"),
    "signal: another field": of(("path of x", "/a.x", "/a.z")),
    "signal: another topic": of(("path of x", "/a.x", "/c.x"))
    | of(("topics that are read", "/a, /b", "/a, /b, /c"), ids=("R2", "R3")),
    "signal: the other topic": of(("path of z", "/a.z", "/b.y"), ids=("R2",)),
    "signal: another unit": of(("unit of x", "m", "cm")),
    "signal: max_age": of(("max_age of x", "300 ms", "400 ms")),
    "signal: no max_age": of(("max_age of x", "300 ms", "")),
    "signal: a type": of(("type of x", "", "S")),
    "signal: valid": of(("valid of x", "", "x < 99")),
    "signal: invalid": of(("invalid of x", "", '{ nan = "drop" }')),
    "signal: of two": of(("max_age of y", "", "9 s"), ids=("R1", "R3")),
    "signal: valid of two": of(("valid of y", "", "x < 99"), ids=("R1", "R3")),
    "proposition: another bound": of(("p", P, "x > 2 m for 100 ms")),
    "proposition: another operator": of(("p", P, "x >= 1 m for 100 ms")),
    "proposition: another bound of R2": of(("ok", "z < 9 m", "z < 8 m"), ids=("R2",)),
    "proposition: another bound of R3": of(("fine", "y < 9 m", "y < 8 m"), ids=("R3",)),
    "proposition: longer": of(("p", P, "x > 1 m for 200 ms")),
    "proposition: at once": of(("p", P, "x > 1 m")),
    "proposition: negated": of(("q", "y > 50 cm", "not (y > 50 cm)")),
    "proposition: agg": of(("agg of p", "", "any")),
    "proposition: on_unknown": of(("on_unknown of p", "", "true")),
    "proposition: its text": of(("text of p", "it is far", "it is near")),
    "proposition: a text": of(("text of q", "", "y")),
    "proposition: its role": of(("role of p", "input", "internal")),
    "proposition: its kind": of(("kind of q", "", "belief")),
    "proposition: its modality": of(("modality of fine", "", "G"), ids=("R3",)),
    "evidence: a verdict by hand": of(
        ("verdict of logs/a.mcap", "satisfied", "inconclusive"),
        ("verdict of logs/b.mcap", "satisfied", "inconclusive"),
    ),
}
"""What each single change is reported as; a change that is not here changes nothing."""
OF_EVIDENCE = {
    "another fretc": "the audit was made with another version of fretc",
    "a sentence": "the sentence has changed since the audit",
    "numbers": "the numbers in `params` have changed since the audit",
    "a clock": "the clock has changed since the audit",
    "topics": "the topics that the audit reads have changed since the audit",
    "bindings": "the bindings have changed since the audit",
    "a monitor": "the evidence is about another version of: artefact r1_monitor.py",
    "of before the clock": "the clock has changed since the audit",
}
"""Changes of what the evidence says that it is about."""


@pytest.fixture(scope="module")
def _base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("base")


@pytest.fixture
def reviewed(fretc: Fretc, _base: Path) -> Fretc:
    """The project in the current folder: audited, and reviewed."""
    return with_review(fretc, _base)


def locked() -> Lock:
    lock = read(LOCK)
    assert isinstance(lock, Lock)
    return lock


@lru_cache(maxsize=4)
def _evidence(files: tuple[tuple[str, bytes], ...]) -> EvidenceFile | Diagnostic:
    """What a store says; it is read once as long as its files stay the same."""
    return read_evidence(EVIDENCE)


def _bytes_of(folder: str) -> tuple[tuple[str, bytes], ...]:
    return tuple((str(p), p.read_bytes()) for p in sorted(Path(folder).rglob("*")) if p.is_file())


def compared(lock: Lock | None = None) -> dict[str, ReviewDifference]:
    """Each requirement that is not as it was."""
    project, evidence = load_folder("requirements"), _evidence(_bytes_of(EVIDENCE))
    assert not isinstance(project, Diagnostic)
    assert not isinstance(evidence, Diagnostic)
    base = lock or locked()
    found = differences(
        review_statuses(chains(project, ResultSummaries.of(evidence)), base), base, project
    )
    return {each.requirement: each for each in found if each.state != "same"}


def listed(found: dict[str, ReviewDifference]) -> dict[str, list[Expected]]:
    return {
        id: [(one.what, one.before or "", one.after or "") for one in each.changes]
        for id, each in found.items()
    }


def kind(name: str) -> str:
    """What a change is reported as, whichever thing and value it is about."""
    told = {tuple(w) for each in EXPECTED.get(name, {}).values() for w in each}
    words = {
        (re.sub(r"\b(?:of [a-z]|of R1|p|q|ok|fine|HAZ-.)\b", "one", what), bool(old), bool(new))
        for what, old, new in told
    }
    return str(sorted(words)) if words else name


QUIET = [
    n for n in CHANGES if n not in EXPECTED and n.removeprefix("evidence: ") not in OF_EVIDENCE
]
GROUPS = len(QUIET) if FULL else 5
LOUD = {name if FULL else kind(name): (name,) for name in CHANGES if name not in QUIET}
TOLD = [*LOUD.values(), *(tuple(QUIET[i::GROUPS]) for i in range(GROUPS))]
"""In quick tests one of each kind, and what changes nothing beside others."""


@pytest.mark.slow
@pytest.mark.parametrize("names", TOLD, ids="; ".join)
def test_a_change_is_told_with_what_the_files_said_and_nothing_else_is(
    reviewed: Fretc, names: tuple[str, ...]
) -> None:
    for name in names:
        CHANGES[name].make()
    found = compared()
    what = names[0].removeprefix("evidence: ")
    if what != names[0] and what in OF_EVIDENCE:
        assert {one.text for each in found.values() for one in each.changes} == {OF_EVIDENCE[what]}
        return
    assert listed(found) == EXPECTED.get(names[0], {})
    for one in (one for each in found.values() for one in each.changes):
        shown = {"before": one.before, "after": one.after}
        for side, other in (("before", "after"), ("after", "before")):
            if shown[side]:
                assert "".join(part for at, part in one.segments if at != other) == shown[side]


def test_nothing_is_expected_of_a_change_that_is_none() -> None:
    assert EXPECTED.keys() <= CHANGES.keys()
    assert {f"evidence: {what}" for what in OF_EVIDENCE} <= CHANGES.keys()
    touching = {n for n, c in CHANGES.items() if c.touches and c.touches != {"log"}}
    assert touching <= EXPECTED.keys() | {f"evidence: {what}" for what in OF_EVIDENCE}


def test_what_is_changed_back_is_no_change(reviewed: Fretc) -> None:
    before = Path(BINDINGS).read_text()
    put(BINDINGS, "x > 1 m", "x > 2 m")()
    put(BINDINGS, '"100 ms"', '"50 ms"')()
    assert compared().keys() == {*ALL}
    Path(BINDINGS).write_text(before)
    assert compared() == {}


def test_several_changes_are_told_each_by_itself(reviewed: Fretc) -> None:
    put(BINDINGS, "x > 1 m", "x > 2 m")()
    put(BINDINGS, '"300 ms"', '"400 ms"')()
    put(R1, '"Answer"', '"Reply"')()
    put(R1, "within 300", "within 400")()
    (r1,) = (each for id, each in compared().items() if id == "R1")
    assert [one.what for one in r1.changes] == ["sentence", "p", "max_age of x", "title"]


@pytest.mark.slow
def test_a_suspect_link_has_a_change_that_makes_it_suspect(reviewed: Fretc) -> None:
    """Whatever is suspect, something is reported it."""
    for name in ("sentence: a scope", "header: no plan", "clock: tick", "signal: another topic"):
        before = {path: path.read_text() for path in Path("requirements").glob("*.*")}
        CHANGES[name].make()
        for each in compared().values():
            for link in each.suspects:
                only_topics = {cause.kind for cause in link.causes} == {"topics"}
                assert only_topics or any(one.makes_suspect(link) for one in each.changes)
            assert re.match(r"\d+ links? (is|are) suspect: .+ changed", each.suspicion)
        for path, content in before.items():
            path.write_text(content)


# Verdicts ---------------------------------------------------------------------------------------


@pytest.mark.slow
def test_what_became_of_verdicts_is_counted_and_new_violations_are_named_first(
    reviewed: Fretc,
) -> None:
    put(BINDINGS, "y < 9 m", "y < 2.5 m")()
    assert compared()["R3"].consequences == ("2 verdicts are from before the change: audit again",)
    log("logs/c.mcap", 0, 2, 3, 3, 1, 1, 0)
    log("logs/d.mcap", 0, 0, 0, 0)
    reviewed("audit", "logs", *ONE_PROCESS)
    r3 = compared()["R3"]
    assert r3.consequences == (
        "1 verdict became violated",
        "2 runs are new: 1 violated, 1 satisfied",
    )
    assert r3.verdicts == (
        ("logs/a.mcap", "satisfied", "violated"),
        ("logs/c.mcap", "", "violated"),
        ("logs/d.mcap", "", "satisfied"),
    )


@pytest.mark.slow
def test_a_run_that_is_gone_is_told_with_its_verdict(reviewed: Fretc) -> None:
    Path(LOGS[1]).unlink()
    reviewed("audit", "logs", "-o", EVIDENCE, *ONE_PROCESS)
    for each in compared().values():
        assert each.consequences == ("1 run is gone: 1 satisfied",)
        assert [one.text for one in each.changes] == ["verdict of logs/b.mcap: satisfied → none"]


@pytest.mark.slow
def test_another_log_of_the_same_name_is_told_by_its_hash(reviewed: Fretc) -> None:
    log(LOGS[0], 0, 2, 3, 3, 2, 1, 0)
    reviewed("audit", "logs", *ONE_PROCESS)
    found = compared()
    assert found.keys() == {*ALL}
    for each in found.values():
        (change,) = each.changes
        assert change.what == "log logs/a.mcap"
        assert str(change.before).startswith("SHA-256 ")
        assert change.before != change.after


# Contradictions ---------------------------------------------------------------------------------


@pytest.mark.slow
def test_words_that_state_another_number_are_told_beside_the_change(reviewed: Fretc) -> None:
    put(R3, '"Keep"', '"Keep below 9 m"')()
    assert reviewed("lock", "R3", *BY).status == 0
    assert compared() == {}
    put(BINDINGS, "y < 9 m", "y < 8 m")()
    put(BINDINGS, "x > 1 m", "x > 2 m")()
    found = compared()
    assert found["R3"].contradictions == ("its title still says 9 m",)
    assert found["R1"].contradictions == ("its `params` still say 1 m",)
    put(R3, "below 9 m", "below 7 m")()
    assert compared()["R3"].contradictions == ("its title says 7 m",)


# Locks ------------------------------------------------------------------------------------------


def without_texts(lock: Lock) -> Lock:
    return Lock({id: replace(one, texts=None) for id, one in lock.reviews.items()})


@pytest.mark.slow
def test_a_lock_without_texts_is_read_and_says_that_it_does_not_know(reviewed: Fretc) -> None:
    write(LOCK, text(without_texts(locked())))
    assert compared() == {}
    put(BINDINGS, "x > 1 m", "x > 2 m")()
    put(R1, '"Answer"', '"Reply"')()
    found = compared()
    assert [one.text for one in found["R1"].changes] == [
        "bindings R1 changed; the lock does not record the earlier value",
        "text R1 changed; the lock does not record the earlier value",
    ]
    run = reviewed("diff")
    assert (run.status, "does not record" in run.out) == (3, True)
    reviewed("audit", "logs", *ONE_PROCESS)
    assert reviewed("lock", "R1", *BY).status == 0
    assert compared()["R2"].changes, "the reviews of the others stay as they were"
    assert "R1" not in compared()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new"),
    some(
        [
            ("x > 1 m for", "x > 7 m for"),
            ('title = "Answer"', 'title = "Question"'),
            ('p = "1 m"', 'p = "7 m"'),
            ('tick = "100 ms"', 'tick = "70 ms"'),
            ('severity = "minor"', 'severity = "none"'),
            ('canonical = "whenever', 'canonical = "never whenever'),
            ("milliseconds satisfy q", "milliseconds satisfy p"),
            ('role = "input"', 'role = "output"'),
            ('max_age = "300 ms"', ""),
            ('fretc = "', 'fretc = "0'),
        ],
        3,
    ),
)
def test_texts_that_are_edited_are_refused_and_forged_ones_are_not_shown(
    reviewed: Fretc, old: str, new: str
) -> None:
    """Anybody can make a seal: what the fingerprints do not vouch for is never a before."""
    written = Path(LOCK).read_text()
    assert old in written
    write(LOCK, written.replace(old, new, 1))
    refused = read(LOCK)
    assert isinstance(refused, Diagnostic)
    assert refused.message == ("the review of R1 was edited after `fretc lock` wrote it")
    write(LOCK, _sealed(written.replace(old, new, 1)))
    assert compared() == {}, "nothing has changed since"
    put(BINDINGS, "x > 1 m", "x > 2 m")()
    put(R1, '"Answer"', '"Reply"')()
    found = compared()["R1"]
    assert found.has_other_texts
    assert all(change.before is None for change in found.changes)
    assert "F546 warning: the texts that the review of R1 keeps" in reviewed("check").err
    assert "do not match its fingerprints" in reviewed("diff").out


def _sealed(lock: str) -> str:
    """The same with seals that fit, as somebody else makes them."""
    for _ in ALL:
        write(LOCK, lock)
        found = read(LOCK)
        if isinstance(found, Lock):
            break
        import tomllib

        from fretc.traceability.lock import _review

        reviews = tomllib.loads(lock)["review"]
        for id, fields in reviews.items():
            lock = lock.replace(fields["seal"], _review(id, fields).seal)
    return lock


def test_a_signature_covers_the_texts(reviewed: Fretc) -> None:
    """The seal is what is signed."""
    review = locked().reviews["R1"]
    assert review.texts is not None
    other = replace(review, texts=None)
    assert other.seal != review.seal
    table = as_table(review.texts)
    for name in table:
        cut = {key: value for key, value in table.items() if key != name}
        from fretc.traceability.texts import read as read_texts

        texts = read_texts({**cut, "sentence": cut.get("sentence", "")})
        assert not isinstance(texts, str)
        assert replace(review, texts=texts).seal != review.seal


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("title = 1", "`$.title`: expected `str`, got `int`"),
        ("nothing = 1", "object contains unknown field `nothing`"),
        (
            "topics = [1979-05-27]",
            "it has a value of a type that no requirement and no binding has",
        ),
        (
            "bindings = { clock = { tick = 0xffffffffffffffffffff } }",
            ("it has a value of a type that no"),
        ),
        (
            f"bindings = {{ clock = {{ tick = {'[' * 200}{']' * 200} }} }}",
            ("it has a value of a type that no"),
        ),
        ("hazards = { H = { weight = 'x' } }", "unknown field `weight`"),
    ],
)
def test_texts_of_another_form_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: str, why: str
) -> None:
    monkeypatch.chdir(tmp_path)
    head = 'schema = "fretc-lock-3"\n[review.R1]\nreviewer = "r"\nrole = "s"\n'
    more = 'date = "2026-01-02"\ncomment = "c"\nseal = "x"\nfingerprints = {}\nverdicts = {}\n'
    found = read(write("fretc.lock", f'{head}{more}[review.R1.texts]\nsentence = "s"\n{line}\n'))
    assert isinstance(found, Diagnostic)
    assert found.message.startswith("`texts` of R1 cannot be read: ")
    assert why in found.message


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["requirements", "requirements/mission", "requirements/agv"])
def test_the_texts_of_real_projects_give_their_fingerprints(folder: str) -> None:
    project = load_folder(str(Path(__file__).parents[3] / folder))
    assert not isinstance(project, Diagnostic)
    for chain in chains(project, None):
        assert chain.texts is not None
        assert agree(chain.requirement, chain.texts, chain.prints)
        review = accepted(chain, "A", "b", "2026-01-02", "c")
        assert review.texts == chain.texts


HEAD = '+++\nid = "R1"\ntitle = "T"\nparents = ["HAZ-1", "R0"]\n+++\n'
CLOCK = '[clock]\ntick = "100 ms"\n'
SIGNALS = """
[signal.v]
path = "/a.v"
unit = "km/h"
agg = "any"
[signal.scan]
path = "/s.ranges[:]"
unit = "m"
type = "sensor_msgs/msg/LaserScan"
reduce = "outline"
footprint = [[1, 0.5], [-1.0, 0.5], [0, -1]]
valid = "0 <= x and x < 35"
max_age = "0.3 s"
[signal.mode]
path = "/m.mode"
values = { "drive fast" = 1, dock = 4 }
[proposition.near]
expr = "scan < 5 cm for 200 ms"
on_unknown = true
[variable.limit]
value = "5 km/h"
[variable.fast]
value = "v > limit"
role = "internal"
"""


SENTENCES = (
    '"free text: it must  stop"',
    "the rover shal satisfy near",
    "the rover shall always satisfy near",
    "whenever near the rover shall within 250 milliseconds satisfy !near",
    "when v > 1.5 m/s the rover shall\n  always  satisfy v < 50 km/h & near",
    "if fast the rover shall with probability > 0.9 eventually satisfy near",
    'in dock mode the rover shall always satisfy mode = dock | "odd  name" > 3',
    "the rover shall immediately satisfy persisted(2, near) & previous(v) <= v",
)
TICKS = (CLOCK + SIGNALS, CLOCK, '[clock]\ntick = "/s"\n', None)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("bindings", "sentence", "status"), pairwise(TICKS, SENTENCES, ("draft", "retired"))
)
def test_the_texts_of_any_requirement_give_its_fingerprints(
    tmp_path: Path, bindings: str | None, sentence: str, status: str
) -> None:
    header = HEAD.replace("parents", f'status = "{status}"\nverify = ["audit"]\nparents')
    write(str(tmp_path / "r1.fret"), f"{header}{sentence}\n")
    write(
        str(tmp_path / "r0.fret"),
        HEAD.replace("R1", "R0").replace('"R0"]', '"R1"]') + "the a shall b",
    )
    write(str(tmp_path / "hazards.toml"), '[HAZ-1]\ntitle = "x"\n')
    if bindings is not None:
        write(str(tmp_path / "bindings.toml"), bindings)
    project = load_folder(str(tmp_path))
    assert not isinstance(project, Diagnostic)
    for chain in chains(project, None):
        review = accepted(chain, "A", "b", "2026-01-02", "c")
        assert review.texts is not None
        path = write(str(tmp_path / "fretc.lock"), text(Lock({chain.requirement: review})))
        assert read(path) == Lock({chain.requirement: review})


BEFORE_AND_AFTER: list[tuple[Callable[[], None], str]] = [
    (put(BINDINGS, "[signal.x]", "[signal.w]"), "R1"),
    (put(R1, "whenever p the", "whenever the"), "R1"),
]


@pytest.mark.parametrize(("make", "id"), BEFORE_AND_AFTER)
def test_what_cannot_be_formalized_now_is_told_by_its_text(
    reviewed: Fretc, make: Callable[[], None], id: str
) -> None:
    make()
    found = compared()[id]
    assert found.changes
    assert found.suspects
    assert not any(change.node == ChainItem("formulas", id) for change in found.changes)
