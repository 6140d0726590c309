"""`fretc explain`: requirements by id or file, codes, pictures, and what it says of wrong input."""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.command import Fretc, runner, write

R1 = """+++
id = "R1"
title = "Stop in time"
+++
whenever too_close the robot shall within 200 milliseconds satisfy stopped
"""
OTHERS = """+++
id = "E1"
+++
whenever too_close the robot shall eventually satisfy stopped
+++
id = "X1"
+++
whenever too_close the robot shall within 2 ticks
+++
id = "T1"
+++
"some day it stops"
"""
BINDINGS = '[clock]\ntick = "100 ms"\n'


@pytest.fixture
def fretc(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Fretc:
    monkeypatch.chdir(tmp_path)
    write("requirements/r1.fret", R1)
    write("requirements/others.fret", OTHERS)
    write("requirements/bindings.toml", BINDINGS)
    return runner(monkeypatch, capsys)


def test_a_sentence_is_explained_as_it_is_typed(fretc: Fretc) -> None:
    sentence = "whenever too_close the robot shall within 200 milliseconds satisfy stopped"
    by_id, typed = fretc("explain", "R1"), fretc("explain", sentence)
    assert (typed.status, typed.err) == (0, "")
    assert typed.out.splitlines()[0] == "sentence"
    assert typed.out.splitlines()[1:] == by_id.out.splitlines()[1:]
    (record,) = json.loads(fretc("explain", sentence, "--format", "json").out)
    assert record["id"] == "sentence"


def test_a_sentence_with_a_mistake_has_a_place_and_a_fix(fretc: Fretc) -> None:
    run = fretc("explain", "the robot should satisfy speed <= 1.5")
    assert (run.status, run.out) == (2, "")
    assert run.err.splitlines()[1] == "  --> <sentence>:1:11"


def test_a_file_that_reads_as_a_sentence_is_a_file(fretc: Fretc) -> None:
    write("the robot shall satisfy p", "the robot shall always satisfy stopped")
    assert "always satisfy stopped" in fretc("explain", "the robot shall satisfy p").out


def test_a_requirement_is_explained_by_its_id(fretc: Fretc) -> None:
    run = fretc("explain", "R1")
    assert (run.status, run.err) == (0, "")
    assert run.out == (
        "R1  Stop in time\n"
        "  whenever too_close the robot shall within 200 milliseconds satisfy stopped\n"
        "\n"
        "  meaning      Over the whole run: at every tick at which `too_close` is true, `stopped` "
        "must be true at that tick or within the next 2 ticks (200 ms) (nothing is required if the "
        "run ends before that).\n"
        "  FT           G(too_close -> F[0,2] stopped)\n"
        "  FT, finite   LAST R (too_close -> F[0,2] stopped | F[0,1] LAST)\n"
        "  PT           H(O[2,2](too_close & !stopped) -> O[0,1]((Z FALSE) | stopped))\n"
        "\n"
        "  one run, drawn\n"
        "    tick                                                    0 1 2 3 4 5 …\n"
        "    enforced                                                ━━━━━━━━━━━━→\n"
        "    too_close: true                                         · ─── · · ·\n"
        "    triggers                                                · ▲ ▲ · · ·\n"
        "    2 ticks (200 ms) from tick 1                            · ├╌╌╌┤ · ·\n"
        "    stopped: must be true at least once, trigger at tick 1  · ▒▒▒▒▒ · ·\n"
        "    2 ticks (200 ms) from tick 2                            · · ├╌╌╌┤ ·\n"
        "    stopped: must be true at least once, trigger at tick 2  · · ▒▒▒▒▒ ·\n"
        "\n"
        "  ✔ satisfied: triggered at tick 0, `stopped` is true at tick 0, at once; the bound is 2 "
        "ticks (200 ms)\n"
        "    tick  too_close  stopped\n"
        "    0     1          1\n"
        "    1     0          0          …repeats\n"
        "    decided at the end only\n"
        "\n"
        "  ✔ satisfied: triggered at tick 0, `stopped` is true at tick 2, 2 ticks later; the bound "
        "is 2 ticks (200 ms)\n"
        "    tick  too_close  stopped\n"
        "    0     1          0\n"
        "    1     0          0\n"
        "    2     0          1\n"
        "    3     0          0          …repeats\n"
        "    decided at the end only\n"
        "\n"
        "  ✘ violated: triggered at tick 0, `stopped` is false at ticks 0 to 2; the bound is 2 "
        "ticks (200 ms)\n"
        "    tick  too_close  stopped\n"
        "    0     1          0\n"
        "    1     0          0\n"
        "    2     0          0          ← decided\n"
        "    decided at tick 2\n"
        "\n"
        "  ✘ violated: triggered at tick 0, `stopped` is true at tick 3 only, one tick too late; "
        "the bound is 2 ticks (200 ms)\n"
        "    tick  too_close  stopped\n"
        "    0     1          0\n"
        "    1     0          0\n"
        "    2     0          0          ← decided\n"
        "    3     0          1\n"
        "    decided at tick 2\n"
    )


def test_capitals_do_not_matter_and_a_file_is_explained_whole(fretc: Fretc) -> None:
    assert fretc("explain", "r1").out == fretc("explain", "requirements/r1.fret").out


def test_a_mistake_elsewhere_in_the_folder_is_not_told(fretc: Fretc) -> None:
    run = fretc("explain", "E1")
    assert (run.status, run.err) == (0, "")
    assert "…repeats" in run.out


def test_a_mistake_in_the_requirement_is(fretc: Fretc) -> None:
    run = fretc("explain", "X1")
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith("F101 ")
    assert run.err.count("-->") == 1


def test_free_text_has_nothing_to_explain(fretc: Fretc) -> None:
    run = fretc("explain", "T1")
    assert (run.status, run.out) == (3, "")
    assert run.err.startswith("F114 note: ")


def test_json_holds_the_same(fretc: Fretc) -> None:
    (told,) = json.loads(fretc("explain", "R1", "--format", "json").out)
    assert told["schema"] == "fretc-explanation-1"
    assert [trace["verdict"] for trace in told["traces"]] == ["satisfied"] * 2 + ["violated"] * 2
    assert told["traces"][2] == {
        "verdict": "violated",
        "rows": [
            {
                "first": tick,
                "last": tick,
                "values": {"too_close": tick == 0, "stopped": False},
                "repeats": False,
            }
            for tick in range(3)
        ],
        "decided": 2,
        "reason": "triggered at tick 0, `stopped` is false at ticks 0 to 2; the bound is 2 ticks "
        "(200 ms)",
    }
    assert told["diagram"]["lanes"][3] == {
        "kind": "bound",
        "name": "",
        "note": "2 ticks (200 ms) from tick 1",
        "ticks": [{"first": 1, "last": 3, "goes_on": False}],
    }


def test_a_picture_is_written_or_printed(fretc: Fretc) -> None:
    run = fretc("explain", "R1", "--svg", "r1.svg")
    assert (run.status, run.err) == (0, "wrote r1.svg\n")
    printed = fretc("explain", "R1", "--svg", "-").out
    assert printed == Path("r1.svg").read_text(encoding="utf-8")
    assert ElementTree.fromstring(printed).tag.endswith("svg")
    assert not re.search(r"https?://(?!www\.w3\.org/2000/svg)", printed)


def test_a_picture_is_of_one_requirement_and_of_no_code(fretc: Fretc) -> None:
    write("two.fret", R1 + R1.replace("R1", "R2"))
    run = fretc("explain", "two.fret", "--bindings", "requirements/bindings.toml", "--svg", "x.svg")
    assert (run.status, run.out) == (2, "")
    assert run.err == (
        "F907 `two.fret` contains several requirements\nhelp: name one of them: `fretc explain "
        "R1`\n"
    )
    assert fretc("explain", "F203", "--svg", "x.svg").err == (
        "F907 `--svg` draws a requirement, not a diagnostic code\nhelp: remove `--svg`\n"
    )
    assert not Path("x.svg").exists()


def test_a_picture_does_not_replace_its_requirement(fretc: Fretc) -> None:
    run = fretc("explain", "R1", "--svg", "requirements/r1.fret")
    assert run.status == 2
    assert "F905" in run.err
    assert Path("requirements/r1.fret").read_text() == R1


@pytest.mark.slow
def test_a_long_bound_is_folded(fretc: Fretc) -> None:
    write("long.fret", "when p the robot shall within 1000 ticks satisfy q")
    run = fretc("explain", "long.fret")
    assert "    1..999  0  0\n" in run.out
    assert len(run.out.splitlines()) < 60


def test_what_has_no_trace_says_so(fretc: Fretc) -> None:
    write("a.fret", "the robot shall always satisfy q | !q")
    assert "note: no run violates the sentence\n" in fretc("explain", "a.fret").out
    write("b.fret", "whenever persisted(2, p) robot shall always satisfy q")
    run = fretc("explain", "b.fret")
    assert run.status == 0
    assert "note: no traces are shown: `persisted` refers to other ticks" in run.out
    write("c.fret", "the robot shall always satisfy q & !q")
    assert "note: no run that goes on satisfies the sentence\n" in fretc("explain", "c.fret").out


def test_a_name_that_is_none_gets_a_suggestion(fretc: Fretc) -> None:
    assert fretc("explain", "RR1").err == (
        "F515 no requirement in `requirements` has the id `RR1`\nhelp: did you mean `R1`?\n"
    )
    assert fretc("explain", "elephant").err == (
        "F515 no requirement in `requirements` has the id `elephant`\n"
        "help: there are E1, X1, T1, R1\n"
    )
    assert fretc("explain", "R11").err == (  # a number is nothing that one misspells
        "F515 no requirement in `requirements` has the id `R11`\nhelp: there are E1, X1, T1, R1\n"
    )
    run = fretc("explain", "F699")
    assert (run.status, run.out) == (2, "")
    assert run.err.startswith(
        "F515 `F699` is neither a diagnostic code nor the id of a requirement\nhelp: there are "
        "F601, "
    )


def test_a_folder_that_is_not_there(fretc: Fretc) -> None:
    run = fretc("explain", "R1", "--requirements", "nowhere")
    assert run.status == 2
    assert run.err.startswith("F901 ")


def test_a_code_that_is_none_needs_no_project(fretc: Fretc) -> None:
    run = fretc("explain", "F699")
    assert run.status == 2
    assert run.err.startswith("F515 `F699` is neither a diagnostic code nor ")


def test_a_code_is_explained(fretc: Fretc) -> None:
    run = fretc("explain", "f104")
    assert (run.status, run.err) == (0, "")
    assert run.out == (
        "F104  `satisfy` is missing before the response\n"
        "\n"
        "  The response must begin with `satisfy`, which separates it from the timing.\n"
        "\n"
        "  To fix it: Write `satisfy` before the response.\n"
        "\n"
        "  wrong:\n"
        "    the robot shall always upright\n"
        "\n"
        "  fixed:\n"
        "    the robot shall always satisfy upright\n"
    )
    told = json.loads(fretc("explain", "F104", "--format", "json").out)
    assert told["example"]["fixed"] == "the robot shall always satisfy upright"


def test_no_text_can_hide_another_one(fretc: Fretc) -> None:
    write(
        "t.fret",
        '+++\nid = "R"\ntitle = "a\\u202eb\\u001b[2J"\n+++\nthe robot shall always satisfy q',
    )
    run = fretc("explain", "t.fret")
    assert "a\\u202eb\\x1b[2J" in run.out
