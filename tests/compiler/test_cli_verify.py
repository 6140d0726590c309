"""`fretc verify`: what it prints, and what it exits with."""

import json
from pathlib import Path

import pytest

from tests.command import Fretc, Run, write

R1 = "whenever p the sw shall within 2 ticks satisfy q"
LOOKS_BACK = "whenever occurred(2, p) the sw shall always satisfy q"
PROVED = (
    "proved: the same at every tick of every trace (4 states, 16 steps); "
    "columns agree on 1160 drawn ticks\n"
)


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
    assert fretc("verify", "--monitor", r1) == Run(0, f"r1  {PROVED}", "")
    assert [path.name for path in Path().iterdir()] == [r1], "nothing is written"


def test_a_monitor_that_was_made_before_is_proved(fretc: Fretc, r1: str, made: str) -> None:
    assert fretc("verify", "--file", made, r1) == Run(0, f"r1  {PROVED}", "")


def test_a_file_with_several_monitors_is_proved_for_each_requirement(fretc: Fretc) -> None:
    path = write("two.fret", f'+++\nid = "A"\n+++\n{R1}\n+++\nid = "BB"\n+++\n{R1}\n')
    assert fretc(path, "--emit", "monitor", "--one-file", "-o", ".").status == 0
    run = fretc("verify", "--file", "monitors.py", path)
    assert (run.status, run.out) == (0, f"A   {PROVED}BB  {PROVED}")


def test_the_names_of_a_folder_stand_in_one_column(fretc: Fretc) -> None:
    write("all/a.fret", R1)
    write("all/longer.fret", R1)
    assert fretc("verify", "--monitor", "all") == Run(0, f"a       {PROVED}longer  {PROVED}", "")


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
        "r1  refuted: the shortest trace that shows it has 3 ticks; after it, pending (true if it "
        "ended there), and should be violated (false if it ended there)\n"
        "    tick 0: p = 1, q = 0\n"
        "    ticks 1..2: p = 0, q = 0\n",
        "",
    )


def test_a_monitor_of_the_sentence_as_it_was_is_refuted(fretc: Fretc, r1: str, made: str) -> None:
    write(r1, R1.replace("whenever", "upon"))
    run = fretc("verify", "--file", made, r1)
    assert run.status == 1
    assert run.out.startswith("r1  refuted: the shortest trace that shows it has 4 ticks;")


def test_programs_that_differ_are_refuted(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "trigger=p,", "trigger=not_q,")
    run = fretc("verify", "--file", made, r1)
    first, *trace = run.out.splitlines()
    assert (run.status, first) == (
        1,
        "r1  refuted: its column program and its steps differ on a trace",
    )
    assert trace[-1].endswith(("p = 0, q = 0", "p = 1, q = 1"))


def test_a_trace_may_have_unknown_values(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "elif p and not_q:", "elif p and not q:")
    run = fretc("verify", "--file", made, r1)
    assert run.status == 1
    assert run.out.splitlines()[-1].endswith("p = 1, q = ?")
    (record,) = json.loads(fretc("verify", "--file", made, r1, "--format", "json").out)
    assert record["trace"][-1] == {"p": True, "q": None}


# Not checked ----------------------------------------------------------------------------------


def test_what_cannot_be_checked_is_told(fretc: Fretc) -> None:
    run = fretc("verify", "--monitor", write("r1.fret", LOOKS_BACK))
    assert (run.status, run.out) == (
        3,
        "r1  not checked: `occurred` speaks of other ticks, and the automaton knows one\n",
    )


def test_a_step_that_looks_at_the_tick_is_not_checked(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "since_1 = oldest_1 >= 2", "since_1 = oldest_1 >= 2 or tick == 5000")
    assert fretc("verify", "--file", made, r1) == Run(
        3, "r1  not checked: what it does at a tick depends on `tick`\n", ""
    )


def test_a_monitor_of_another_requirement_is_not_checked(fretc: Fretc, r1: str, made: str) -> None:
    write("r2.fret", R1)
    run = fretc("verify", "--file", made, r1, "r2.fret")
    assert run == Run(3, f"r1  {PROVED}r2  not checked: the monitor is of other requirements\n", "")


def test_the_worst_of_several_is_the_exit_status(fretc: Fretc, r1: str, made: str) -> None:
    write("r2.fret", R1)
    edited(made, "oldest_1 >= 2", "oldest_1 >= 3")
    run = fretc("verify", "--file", made, r1, "r2.fret")
    assert run.status == 1
    assert [line[4:].partition(":")[0] for line in run.out.splitlines() if line[0] == "r"] == [
        "refuted",
        "not checked",
    ]


# JSON -----------------------------------------------------------------------------------------


def told(run: Run) -> object:
    return json.loads(run.out)


def test_a_proof_as_json(fretc: Fretc, r1: str) -> None:
    run = fretc("verify", "--monitor", r1, "--format", "json")
    assert (run.status, told(run)) == (
        0,
        [{"requirement": "r1", "monitor": "proved", "states": 4, "steps": 16, "columns": 1160}],
    )


def test_a_refutation_as_json(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "oldest_1 >= 2", "oldest_1 >= 1")
    run = fretc("verify", "--file", made, r1, "--format", "json")
    assert (run.status, told(run)) == (
        1,
        [
            {
                "requirement": "r1",
                "monitor": "refuted",
                "expected": {"verdict": "pending", "finite": True},
                "found": {"verdict": "violated", "finite": False},
                "trace": [{"p": True, "q": False}, {"p": False, "q": False}],
            }
        ],
    )


def test_what_is_not_checked_as_json(fretc: Fretc, r1: str, made: str) -> None:
    edited(made, "import argparse\n", "import argparse  # as it was\nimport array\n")
    run = fretc("verify", "--file", made, r1, "--format", "json")
    reason = "the run time in it is not the one of this version of fretc"
    assert (run.status, told(run)) == (
        3,
        [{"requirement": "r1", "monitor": "not checked", "reason": reason}],
    )


# Bad use --------------------------------------------------------------------------------------


def first(run: Run) -> tuple[int, str, str]:
    return run.status, run.out, run.err.splitlines()[0]


def test_something_to_verify_must_be_named(fretc: Fretc, r1: str) -> None:
    assert fretc("verify", r1) == Run(
        2, "", "F907 nothing to verify is named\nhelp: add `--monitor`\n"
    )


def test_files_must_be_named_and_be_there(fretc: Fretc, r1: str) -> None:
    assert first(fretc("verify", "--monitor")) == (2, "", "F907 missing argument 'FILE...'")
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
        ("x = 1\n", "it names no `MONITOR`"),
        ("x = (\n", "it is no Python"),
        ("raise SystemExit(0)\n", "it names no `MONITOR`"),
    ],
)
def test_a_file_that_is_no_monitor_is_told(fretc: Fretc, r1: str, text: str, why: str) -> None:
    run = fretc("verify", "--file", write("x.py", text), r1)
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith(f"F602 `x.py` is no generated monitor: {why}")
    assert run.err.endswith("help: name a file that `--emit monitor` wrote\n")


def test_a_sentence_that_is_wrong_is_told(fretc: Fretc) -> None:
    run = fretc("verify", "--monitor", write("bad.fret", "the sw shall satisfy"))
    assert first(run) == (2, "", "F101 the sentence ends too early")


def test_what_has_no_monitor_has_no_proof(fretc: Fretc) -> None:
    run = fretc("verify", "--monitor", write("s.fret", R1.replace("ticks", "seconds")))
    assert (run.status, run.out) == (2, "")
    assert "F312 no clock says how many ticks the duration of s is" in run.err
