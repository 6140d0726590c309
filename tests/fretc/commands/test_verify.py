"""`fretc verify`: what it prints, and what it exits with."""

import csv
import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from compiler.files.templating import template_root
from compiler.logic.claims import Proof
from fretc.verification import reader
from fretc.verification.engines import crosshair
from fretc.verification.engines import programs as external
from fretc.verification.engines.programs import Completion
from fretc.verification.layers import crosshair as layer_crosshair
from fretc.verification.layers import dafny as layer_dafny
from tests.command import Fretc, Run, write
from tests.each import each
from tests.effort import FULL
from tests.json_schemas import validate
from tests.programs import needs, needs_package

R1 = "whenever p the sw shall within 2 ticks satisfy q"
LOOKS_BACK = "whenever occurred(2, p) the sw shall always satisfy q"
CLAIM = "the monitor means what the sentence says"
PROVED = (
    f"proved: {CLAIM}; the same at every tick of every trace (4 states, 16 steps); its "
    "column program agrees on 1160 random ticks\n"
)
WROTE = "wrote build/verification.json\n"


@pytest.fixture
def r1(fretc: Fretc) -> str:
    """The file of a requirement, in the folder of the run."""
    return write("r1.fret", R1)


def edited(path: str, old: str, new: str) -> str:
    text = Path(path).read_text(encoding="utf-8")
    assert old in text
    return write(path, text.replace(old, new))


@pytest.fixture
def made(fretc: Fretc, r1: str) -> str:
    """The monitor that was made of it."""
    assert fretc(r1, "--emit", "monitor", "-o", ".").status == 0
    return "r1_monitor.py"


# Proved ---------------------------------------------------------------------------------------


def test_a_monitor_that_is_made_is_proved(fretc: Fretc, r1: str) -> None:
    assert fretc("verify", "--monitor", r1) == Run(0, f"✔ r1  monitor  {PROVED}", WROTE)


def test_a_monitor_that_was_made_before_is_proved(fretc: Fretc, r1: str, made: str) -> None:
    assert fretc("verify", "--file", made, r1) == Run(0, f"✔ r1  monitor  {PROVED}", WROTE)


def test_a_file_with_several_monitors_is_proved_for_each_requirement(fretc: Fretc) -> None:
    path = write("two.fret", f'+++\nid = "A"\n+++\n{R1}\n+++\nid = "BB"\n+++\n{R1}\n')
    assert fretc(path, "--emit", "monitor", "--one-file", "-o", ".").status == 0
    run = fretc("verify", "--file", "monitors.py", path, "--all")
    head, a, bb, count, *claims = run.out.splitlines(keepends=True)
    assert (run.status, "".join(claims)) == (0, f"✔ A   monitor  {PROVED}✔ BB  monitor  {PROVED}")
    assert (head, a, bb) == ("    monitor\n", "A   ✔\n", "BB  ✔\n")
    assert count == "✔ 2 claims are proved\n"


def test_the_names_of_a_folder_stand_in_one_column(fretc: Fretc) -> None:
    write("all/a.fret", R1)
    write("all/longer.fret", R1)
    assert fretc("verify", "--monitor", "all") == Run(
        0,
        "        monitor\na       ✔\nlonger  ✔\n✔ 2 claims are proved: `--all` lists them\n",
        WROTE,
    )


def test_the_bound_is_counted_by_the_clock(fretc: Fretc) -> None:
    path = write("s.fret", R1.replace("2 ticks", "2 seconds"))
    write("bindings.toml", '[clock]\ntick = "20 ms"\n')
    run = fretc("verify", "--monitor", path)
    assert run.status == 0
    assert "(102 states, 408 steps)" in run.out


# Refuted --------------------------------------------------------------------------------------


def test_a_refutation_shows_a_shortest_trace(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "oldest_1 >= 2", "oldest_1 >= 3")
    assert fretc("verify", "--file", made, r1) == Run(
        1,
        f"✘ r1  monitor  counterexample: not true that {CLAIM}; the shortest trace that shows it "
        "has 3 ticks; after it, pending (true if it ended there), and should be violated (false if "
        "it ended there)\n"
        "    tick  p  q\n"
        "       0  1  0\n"
        "    1..2  0  0\n",
        WROTE,
    )


def test_a_monitor_of_the_sentence_as_it_was_is_refuted(fretc: Fretc, r1: str, made: str) -> None:
    write(r1, R1.replace("whenever", "upon"))
    run = fretc("verify", "--file", made, r1)
    assert run.status == 1
    assert "; the shortest trace that shows it has 4 ticks;" in run.out


def test_programs_that_differ_are_refuted(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "trigger=p,", "trigger=not_q,")
    run = fretc("verify", "--file", made, r1)
    first, *trace = run.out.splitlines()
    assert (run.status, first) == (
        1,
        f"✘ r1  monitor  counterexample: not true that {CLAIM}; its column program and its steps "
        "differ on a trace",
    )
    assert trace[-1].endswith(("  0  0", "  1  1"))


def test_a_trace_may_have_unknown_values(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "elif p and not_q:", "elif p and not q:")
    run = fretc("verify", "--file", made, r1)
    assert run.status == 1
    assert run.out.splitlines()[-1].endswith("  1  ?")
    (record,) = told(fretc("verify", "--file", made, r1, "--format", "json"))
    assert record["trace"]["rows"][-1] == [True, None]


# Not checked ----------------------------------------------------------------------------------


def test_what_cannot_be_checked_is_told(fretc: Fretc) -> None:
    run = fretc("verify", "--monitor", write("r1.fret", LOOKS_BACK))
    assert (run.status, run.out) == (
        3,
        f"? r1  monitor  not checked: {CLAIM}; `occurred` refers to other ticks, and the "
        "automaton reads one tick at a time\n",
    )


def test_a_step_that_looks_at_the_tick_is_not_checked(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "since_1 = oldest_1 >= 2", "since_1 = oldest_1 >= 2 or tick == 5000")
    assert fretc("verify", "--file", made, r1) == Run(
        3, f"? r1  monitor  not checked: {CLAIM}; what it does at a tick depends on `tick`\n", WROTE
    )


def test_a_monitor_of_another_requirement_is_not_checked(fretc: Fretc, r1: str, made: str) -> None:
    write("r2.fret", R1)
    run = fretc("verify", "--file", made, r1, "r2.fret")
    reason = "the monitor is for other requirements"
    told = (
        "    monitor\nr1  ✔\nr2  ?\n✔ 1 claim is proved: `--all` lists them\n"
        f"? r2  monitor  not checked: {CLAIM}; {reason}\n"
    )
    assert run == Run(3, told, WROTE)


@needs("node")
def test_why_a_file_is_not_checked_is_told_once(fretc: Fretc, r1: str) -> None:
    write("r2.fret", R1)
    file = "build/monitors.mjs"
    assert fretc(r1, "r2.fret", "--emit", "js", "--one-file").status == 0
    edited(file, "approximation.signals = [", "globalThis.x = 1; approximation.signals = [")
    *_, first, second = fretc("verify", "--file", file, r1, "r2.fret").out.splitlines()
    assert first.startswith(f"? r1  monitor  not checked: {CLAIM}; ")
    assert second == "? r2  monitor  not checked: as r1"
    one, other = told(fretc("verify", "--file", file, r1, "r2.fret", "--format", "json"))
    assert (one["result"], one["detail"]) == (other["result"], other["detail"])


def test_the_worst_of_several_is_the_exit_status(fretc: Fretc, r1: str, made: str) -> None:
    write("r2.fret", R1)
    edited(made, "oldest_1 >= 2", "oldest_1 >= 3")
    run = fretc("verify", "--file", made, r1, "r2.fret")
    assert run.status == 1
    assert [line[0] for line in run.out.splitlines()[3:] if line[0] != " "] == ["✘", "?"]


# JSON -----------------------------------------------------------------------------------------


def told(run: Run) -> list[dict[str, Any]]:
    """The evidence on standard output, which fits the schema."""
    content = json.loads(run.out)
    validate("verification.schema.json", content)
    assert list(content) == ["schema", "fretc", "evidence"]
    evidence: list[dict[str, Any]] = content["evidence"]
    return evidence


def test_a_proof_as_json(fretc: Fretc, r1: str) -> None:
    run = fretc("verify", "--monitor", r1, "--format", "json")
    (record,) = told(run)
    assert len(record["artefacts"].pop("r1_monitor.py")) == 64
    assert (run.status, record) == (
        0,
        {
            "requirement": "r1",
            "layer": "monitor",
            "claim": CLAIM,
            "result": "proved",
            "detail": PROVED.partition("; ")[2].strip(),
            "assumptions": [],
            "engine": "fretc, lock step with the counter automaton of the sentence",
            "artefacts": {},
        },
    )


def test_the_evidence_is_what_is_printed_as_json(fretc: Fretc, r1: str) -> None:
    printed = fretc("verify", "--monitor", r1, "--format", "json").out
    assert Path("build/verification.json").read_text() == printed
    assert fretc("verify", "--monitor", r1, "-o", "-") == Run(0, printed, "")


def test_a_refutation_as_json(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "oldest_1 >= 2", "oldest_1 >= 1")
    run = fretc("verify", "--file", made, r1, "--format", "json")
    (record,) = told(run)
    assert (run.status, record["result"], record["trace"]) == (
        1,
        "counterexample",
        {
            "names": ["p", "q"],
            "rows": [[True, False], [False, False]],
            "actions": [],
            "cycle": None,
        },
    )
    assert record["detail"].endswith(
        "violated (false if it ended there), and should be pending (true if it ended there)"
    )


def test_what_is_not_checked_as_json(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "import argparse\n", "import argparse  # as it was\nimport array\n")
    run = fretc("verify", "--file", made, r1, "--format", "json")
    (record,) = told(run)
    assert (run.status, record["result"], record["detail"]) == (
        3,
        "not checked",
        "its runtime part is not the one of this version of fretc",
    )


# The closed loop ------------------------------------------------------------------------------

BINDINGS = """\
[clock]
tick = "100 ms"

[signal.d]
path = "/d.data"
unit = "m"

[signal.v]
path = "/v.data"
unit = "m/s"

[proposition.near]
expr = "d < 5 cm"

[proposition.stopped]
expr = "abs(v) < 0.01 m/s"

[interceptor]
stop = "/stop"
command = "/cmd_vel"
output = "/wheels"
period = "50 ms"
hold = "200 ms"
stop_timeout = "1200 ms"

[assume]
stands = "stopped"
latency = "100 ms"
lost = 1
braking = "170 ms"
"""
NEAR = "whenever near the sw shall within {} milliseconds satisfy stopped"
ASSUMPTIONS = """\
assumptions
   1  the safety function steps at every tick of 100 ms and sends its request every time \
(`requests`, [assume])
   2  stop messages arrive in the order of sending, each within 100 ms (`latency`, [assume])
   3  at most 1 stop messages in a row are lost (`lost`, [assume])
   4  `stopped` is false while the wheels are commanded to move, and true once they \
have had zero for 170 ms (`braking`, [assume]), or earlier
   5  the wheels follow a published command at once, and keep it until the next one
   6  at the first tick the robot stands, and nothing has been received yet
   7  the node around the interceptor's step passes on every message, and publishes the result
   8  the interceptor's timer expires once in each 50 ms (`period`, [interceptor])
   9  `braking` of 170 ms counts as 200 ms, whole cells of the model
"""


@pytest.fixture
def loop(fretc: Fretc) -> Callable[..., str]:
    """Write a requirement and its bindings, some of them changed; the path of the requirement."""

    def make(bound: int, *edits: tuple[str, str]) -> str:
        text = BINDINGS
        for old, new in edits:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        write("bindings.toml", text)
        return write("r1.fret", NEAR.format(bound))

    return make


@pytest.mark.slow
@pytest.mark.confined
def test_a_loop_that_keeps_its_requirement(fretc: Fretc, loop: Callable[..., str]) -> None:
    run = fretc("verify", "--layer", "loop", loop(400))
    kept, released, rest = run.out.split("\n", 2)
    assert kept.startswith(
        "✔ r1  loop  proved under (1-9): monitor, interceptor and any environment together "
        "satisfy the requirement; "
    )
    assert released == (
        "✔ r1  loop  proved under (1-9): the stop is released once no demand begins any more; "
        "Spot finds no endless run that violates it"
    )
    assert (run.status, rest, run.err) == (0, ASSUMPTIONS, WROTE)


@pytest.mark.slow
def test_the_stop_of_r1_is_released(fretc: Fretc) -> None:
    """Its safety function speaks on change; a watchdog that hears nothing halts it for good."""
    shutil.copytree(template_root().parent / "requirements", "requirements")
    bindings = Path("requirements/bindings.toml")
    run = fretc("verify", "requirements/r1.fret", "--layer", "loop")
    assert (run.status, [line[0] for line in run.out.splitlines()[:2]]) == (0, ["✔", "✔"])
    if not FULL:  # `test_a_heartbeat_is_an_assumption` asks a small loop
        return
    lines = bindings.read_text().splitlines(keepends=True)
    bindings.write_text("".join(line for line in lines if not line.startswith("heartbeat")))
    run = fretc("verify", "requirements/r1.fret", "--layer", "loop")
    assert (run.status, [line[0] for line in run.out.splitlines() if line[0] in "✔✘"]) == (
        3,
        ["✘", "✔"],
    )


@pytest.mark.slow
def test_a_heartbeat_is_an_assumption(fretc: Fretc, loop: Callable[..., str]) -> None:
    beating = ("lost = 1\n", 'requests = "edge"\nheartbeat = "250 ms"\n')
    run = fretc("verify", "--layer", "loop", loop(300, beating))
    assert (run.status, [line[0] for line in run.out.splitlines()[:2]]) == (0, ["✔", "✔"])
    lines = [line[4:].strip() for line in run.out.splitlines()[3:]]
    assert lines[0] == (
        "the safety function steps at every tick of 100 ms and sends its request when it "
        "changes, and again when it has been silent for 250 ms, or earlier (`requests` and "
        "`heartbeat`, "
        "[assume])"
    )
    assert lines[-1] == "`heartbeat` of 250 ms counts as 300 ms, whole ticks of the clock"


@pytest.mark.slow
def test_a_loop_that_does_not_shows_a_run(fretc: Fretc, loop: Callable[..., str]) -> None:
    run = fretc("verify", "--layer", "loop", loop(200, ("lost = 1\n", "")))
    first, *table = run.out.splitlines()[:5]
    assert run.status == 1
    assert first == (
        "✘ r1  loop  counterexample under (1-9): not true that monitor, interceptor and any "
        "environment together satisfy the requirement; violated at tick 3; no shorter run shows it"
    )
    assert table == [
        "    tick  near  stopped  request  delivered  halt  wheels",
        "       0     0        1        0          0     0       1  no stop is requested, and the "
        "message is sent; a command to move is received; `false` is received",
        "       1     1        0        1          1     1       0  a stop is requested, and the "
        "message is sent; `true` is received",
        "    2..3     0        0        1          1     1       0  a stop is requested, and the "
        "message is sent; `true` is received",
    ]


@pytest.mark.slow
def test_a_run_is_replayed_by_the_monitor_itself(fretc: Fretc, loop: Callable[..., str]) -> None:
    path = loop(200)
    assert fretc(path, "--emit", "monitor", "-o", ".").status == 0
    run = fretc("verify", "--layer", "loop", path, "--traces", "runs")
    assert run.err == "wrote build/verification.json\nwrote runs/r1_loop_1.csv\n"
    with Path("runs/r1_loop_1.csv").open() as file:
        rows = [*csv.reader(file)]
    assert rows[0] == ["near", "stopped"]
    replay = [sys.executable, "r1_monitor.py", "runs/r1_loop_1.csv"]
    assert subprocess.run(replay, capture_output=True, check=False).returncode == 1


@pytest.mark.slow
@pytest.mark.confined
def test_the_least_bound_is_told(fretc: Fretc, loop: Callable[..., str]) -> None:
    run = fretc("verify", "--layer", "bounds", loop(400))
    answered, enough = run.out.splitlines()[:2]
    assert answered.startswith(
        "✔ r1  bounds  proved under (1-8): every demand is answered within `lost` ticks and the "
        "ticks of `latency` and `braking` together, at least one; by an inductive "
    )
    assert enough == (
        "✔ r1  bounds  proved under (1, 5-12): the bound of 4 ticks is enough; the smallest "
        "satisfied bound is 4 ticks (400 ms); with one tick less a run of 5 ticks violates it"
    )
    assert run.status == 0


@pytest.mark.slow
def test_bounds_are_of_the_monitor_that_fretc_writes(
    fretc: Fretc, loop: Callable[..., str]
) -> None:
    """At longer times than those that are looked at, another one may ask for no stop."""
    path = loop(400)
    assert fretc(path, "--emit", "monitor", "-o", ".").status == 0
    edited("r1_monitor.py", "oldest_1 >= 4\n", "oldest_1 >= 5\n")
    run = fretc("verify", "--layer", "bounds", path, "--file", "r1_monitor.py")
    assert run.status == 3
    assert run.out.count("the monitor is not the one that fretc generates for it") == 2


@pytest.mark.slow
def test_a_stop_that_stays_is_no_violation(fretc: Fretc, loop: Callable[..., str]) -> None:
    path = loop(400, ("[assume]", "latching = true\n\n[assume]"))
    run = fretc("verify", "--layer", "loop", path)
    assert (run.status, [line[0] for line in run.out.splitlines() if line[0] in "✔✘"]) == (
        3,
        ["✘", "✔"],
    )


@pytest.mark.parametrize(
    ("sentence", "edits", "reason"),
    [
        (
            "whenever stopped the sw shall within 200 milliseconds satisfy near",
            [],
            "its response does not mention `stopped`, which the loop controls",
        ),
        (
            NEAR.format(200),
            [(BINDINGS[BINDINGS.index("[assume]") :], "")],
            "the bindings state no assumptions about the loop (`[assume]`)",
        ),
        (
            NEAR.format(200),
            [('period = "50 ms"', 'period = "70 ms"')],
            "a tick of the clock, 100 ms, is not a whole number of periods of the interceptor's "
            "timer, 70 ms",
        ),
    ],
)
def test_what_is_no_loop_is_not_checked(
    fretc: Fretc,
    loop: Callable[..., str],
    sentence: str,
    edits: list[tuple[str, str]],
    reason: str,
) -> None:
    path = loop(200, *edits)
    write(path, sentence)
    run = fretc("verify", "--layer", "loop", path)
    assert run.status == 3
    assert [line.endswith(f"; {reason}") for line in run.out.splitlines()] == [True, True]


def test_without_bindings_there_is_no_loop(fretc: Fretc, r1: str) -> None:
    run = fretc("verify", "--layer", "loop", "--layer", "bounds", r1)
    assert run.status == 3
    reason = "the bindings declare no interceptor (`[interceptor]`)"
    assert [line.endswith(f"; {reason}") for line in run.out.splitlines()[2:]] == [True] * 4


@pytest.mark.slow
def test_an_interceptor_of_other_bindings_is_not_checked(
    fretc: Fretc, loop: Callable[..., str]
) -> None:
    path = loop(400)
    assert fretc(path, "--emit", "interceptor", "-o", ".").status == 0
    assert fretc("verify", "--layer", "loop", path, "--interceptor", "interceptor.py").status == 0
    edited("interceptor.py", "hold=4,", "hold=3,")
    run = fretc("verify", "--layer", "loop", path, "--interceptor", "interceptor.py")
    assert run.status == 3
    assert "its options differ from those that the bindings declare" in run.out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (
            "PERIOD = ",
            "PERIOD = 10 * ",
            "its node is not the one that fretc generates for these bindings",
        ),
        (
            "velocity[:3]",
            "velocity[:2]",
            "its node is not the one that fretc generates for these bindings",
        ),
        ("hold=4,", "hold=3,", "its options differ from those that the bindings declare"),
        ("    wz: float = 0.0\n", "", "fretc cannot read its core: `class Velocity"),
        (
            "def halted(",
            "def isfinite(age: int) -> bool:\n    return age > 0\n\n\ndef halted(",
            "fretc cannot read its core: `def isfinite(age: int) -> bool:`",
        ),
    ],
)
def test_nothing_is_proved_of_an_interceptor_that_flies_otherwise(
    fretc: Fretc, loop: Callable[..., str], old: str, new: str, reason: str
) -> None:
    path = loop(400)
    assert fretc(path, "--emit", "interceptor", "-o", ".").status == 0
    verify = ("verify", "--layer", "interceptor", path, "--interceptor", "interceptor.py")
    assert fretc(*verify).status == 0
    edited("interceptor.py", old, new)
    run = fretc(*verify)
    assert run.status == 3
    assert "proved" not in run.out.replace("not checked", "")
    assert reason in run.out


@pytest.mark.slow
def test_all_five_layers_have_a_line(fretc: Fretc, loop: Callable[..., str]) -> None:
    path = loop(400)
    write(path, f'+++\nverify = ["agent"]\n+++\n{NEAR.format(400)}\n')
    run = fretc("verify", path, "--format", "json")
    assert {record["layer"] for record in told(run)} == {
        "monitor",
        "interceptor",
        "loop",
        "bounds",
        "agent",
    }
    assert run.status == 3, "it plans an agent, which cannot keep a bound"


# What applies ---------------------------------------------------------------------------------

SHARED = {"interceptor": "interceptor"}


@pytest.mark.slow
@each("layer", ["interceptor", "loop", "bounds", "agent"])
@each("planned", [False, True])
@each("named", [False, True])
def test_what_does_not_apply_is_open_only_if_somebody_asks_for_it(
    layer: str, planned: bool, named: bool, fretc: Fretc
) -> None:
    header = f'+++\nverify = ["{layer}"]\n+++\n' if planned else ""
    path = write("r1.fret", f"{header}the sw shall always satisfy q\n")
    options = ("--layer", layer, "--layer", "monitor") if named else ()
    run = fretc("verify", path, *options, "--format", "json")
    results = {record["layer"]: record["result"] for record in told(run)}
    is_open = planned or named
    expected = "not checked" if is_open else "not applicable" if layer != "agent" else None
    assert results.get(layer) == expected
    assert results["monitor"] == "proved"
    assert run.status == (3 if is_open else 0)
    text = fretc("verify", path, *options, "-o", "other.json")
    assert text.status == run.status
    subject = SHARED.get(layer, "r1")
    marked = [line for line in text.out.splitlines() if line.startswith(f"? {subject}")]
    assert bool(marked) == is_open
    read = reader.read("other.json")
    assert isinstance(read, reader.Proofs)
    shown = {proof.layer for proof in read.proofs}
    assert (layer in shown) == is_open


@each("timing", ["immediately", "always", "within 2 ticks"])
def test_an_agent_that_cannot_be_in_time_is_no_counterexample(timing: str, fretc: Fretc) -> None:
    path = write("r1.fret", f"whenever p the sw shall {timing} satisfy q")
    run = fretc("verify", path, "--layer", "agent")
    assert run.status == 3
    (line,) = run.out.splitlines()
    assert line.startswith("? r1  agent  not checked: the agent has its properties; there is none:")


# Other provers --------------------------------------------------------------------------------


@pytest.fixture
def node(fretc: Fretc, loop: Callable[..., str]) -> tuple[str, str]:
    """The requirement, and the interceptor that was made for it."""
    path = loop(400)
    assert fretc(path, "--emit", "interceptor", "-o", ".").status == 0
    return path, "interceptor.py"


@pytest.mark.slow
@needs_package("crosshair")
def test_crosshair_is_given_the_core_and_the_limit(
    fretc: Fretc, node: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the node beside it every number of a velocity is a case of its own, and there is no end.

    The contracts of one function are looked at, so that it takes seconds.
    """
    path, made = node
    every = crosshair._contracts
    monkeypatch.setattr(
        crosshair, "_contracts", lambda text: [c for c in every(text) if c.function == "halted"]
    )
    limits: list[float] = []
    asked = external.run

    def run(*args: Any, seconds: float, memory: int) -> Completion:
        limits.append(seconds)
        return asked(*args, seconds=seconds, memory=memory)

    monkeypatch.setattr(crosshair, "run", run)
    options = ("--layer", "interceptor", "--with", "crosshair", "--limit", "20")
    found = told(fretc("verify", *options, "--interceptor", made, path, "--format", "json"))[-2:]
    assert limits == [50], "20 s, and half a minute to begin"
    assert [(one["claim"], one["result"]) for one in found] == [
        ("`halted` keeps `__return__ or not state.stop`", "proved"),
        ("`halted` keeps `__return__ or state.held <= 0`", "proved"),
    ]
    assert list(found[0]["artefacts"]) == ["interceptor.py"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        ("ZERO = Velocity()", "ZERO = print()", "fretc cannot read its core: "),
        ("\n\nclass Gate:", "\n\nstep = print\n\nclass Gate:", "the node below it"),
        (
            "post: __return__ or state.held",
            "post: print() or state.held",
            "differ from those of fretc",
        ),
        ("    post: __return__ or not state.stop\n", "", "differ from those of fretc"),
    ],
)
def test_crosshair_does_not_execute_what_may_not_be_pure(
    fretc: Fretc,
    node: tuple[str, str],
    monkeypatch: pytest.MonkeyPatch,
    old: str,
    new: str,
    reason: str,
) -> None:
    monkeypatch.setattr(layer_crosshair, "with_crosshair", None)
    path, made = node
    edited(made, old, new)
    options = ("--layer", "interceptor", "--with", "crosshair", "--interceptor", made)
    run = fretc("verify", *options, path, "--format", "json")
    last = told(run)[-1]
    assert (run.status, last["result"]) == (3, "not checked")
    assert last["claim"] == "CrossHair confirms the contracts in the text"
    assert reason in last["detail"]


def test_dafny_is_given_the_limit(
    fretc: Fretc, node: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[float] = []

    def dafny(*_: object, seconds: float) -> tuple[Proof, ...]:
        seen.append(seconds)
        return ()

    monkeypatch.setattr(layer_dafny, "with_dafny", dafny)
    fretc("verify", "--layer", "interceptor", "--with", "dafny", "--limit", "7", node[0])
    assert seen == [7]


# Bad use --------------------------------------------------------------------------------------


def first(run: Run) -> tuple[int, str, str]:
    return run.status, run.out, run.err.splitlines()[0]


def test_a_layer_must_be_one_of_five(fretc: Fretc, r1: str) -> None:
    status, out, line = first(fretc("verify", "--layer", "lop", r1))
    assert (status, out, line[:4]) == (2, "", "F907")


def test_an_agent_needs_its_properties(fretc: Fretc, r1: str) -> None:
    assert fretc("verify", r1, "--agent", "SIF.gwen") == Run(
        2,
        "",
        "F907 `--agent` needs `--properties`\n"
        "help: name both: `--agent FILE.gwen --properties FILE.psl`\n",
    )


def test_a_requirement_is_not_written_over(fretc: Fretc, r1: str) -> None:
    run = fretc("verify", "--monitor", r1, "-o", r1)
    assert run.status == 2
    assert run.err.startswith("F905 `r1.fret` cannot be written")


def test_requirements_are_named_by_files_or_by_the_option(fretc: Fretc, r1: str) -> None:
    write("requirements/r1.fret", Path(r1).read_text())
    by_file = fretc("verify", "--monitor", "requirements/r1.fret")
    assert by_file.status == 0
    assert fretc("verify", "--monitor") == by_file
    assert fretc("verify", "--monitor", "--requirements", "requirements") == by_file
    assert first(fretc("verify", r1, "--requirements", "requirements")) == (
        2,
        "",
        f"F907 requirements are named twice: `{r1}` and `--requirements`",
    )


def test_files_must_be_there(fretc: Fretc, r1: str) -> None:
    assert first(fretc("verify", "--monitor")) == (
        2,
        "",
        "F901 there is no folder `requirements`",
    )
    assert first(fretc("verify", "--monitor", "no.fret")) == (
        2,
        "",
        "F901 there is no file `no.fret`",
    )
    assert first(fretc("verify", "--file", "no.py", r1)) == (2, "", "F901 there is no file `no.py`")
    Path("empty").mkdir()
    assert first(fretc("verify", "--monitor", "empty"))[:2] == (2, "")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("x = 1\n", "it defines no `MONITOR`"),
        ("x = (\n", "it is not valid Python"),
        ("raise SystemExit(0)\n", "it defines no `MONITOR`"),
    ],
)
def test_a_file_that_is_no_monitor_is_told(fretc: Fretc, r1: str, text: str, why: str) -> None:
    run = fretc("verify", "--file", write("x.py", text), r1)
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith(f"F602 `x.py` is not a generated monitor: {why}")
    assert run.err.endswith("help: name a file that `--emit monitor` wrote\n")


def test_a_sentence_that_is_wrong_is_told(fretc: Fretc) -> None:
    run = fretc("verify", "--monitor", write("bad.fret", "the sw shall satisfy"))
    assert first(run) == (2, "", "F101 the response is missing after `satisfy`")


def test_what_has_no_monitor_has_no_proof(fretc: Fretc) -> None:
    run = fretc("verify", "--monitor", write("s.fret", R1.replace("ticks", "seconds")))
    assert (run.status, run.out) == (2, "")
    assert "F312 no clock says how many ticks the duration of s is" in run.err
