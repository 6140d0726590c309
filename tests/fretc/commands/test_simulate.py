import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from mcap.reader import make_reader

from tests.command import PROCESS, Fretc, write
from tests.effort import FULL, some

ROOT = Path(__file__).parents[3]


@pytest.mark.slow
def test_a_mission_is_recorded_and_drawn(fretc: Fretc) -> None:
    words = "walker --seed 3 --duration 2 -o a.mcap --png a.png --gif a.gif"
    ran = fretc("simulate", *words.split())
    assert (ran.status, ran.err) == (0, "wrote a.mcap\nwrote a.png\nwrote a.gif\n")
    assert ran.out.startswith("walker, seed 3: 2.0 s, 0 of 4 goals, 0 stops, 0 contacts, least ")
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")
    assert Path("a.gif").read_bytes().startswith(b"GIF89a")
    with Path("a.mcap").open("rb") as stream:
        reader = make_reader(stream)
        assert reader.get_header().profile == "ros2"
        (about,) = (entry.metadata for entry in reader.iter_metadata())
    assert (about["scenario"], about["seed"], about["max_seconds"]) == ("walker", "3", "2.0")
    assert about["fretc"]


@pytest.mark.slow
def test_folders_are_made_and_a_mission_can_be_a_log_of_ros_1(fretc: Fretc) -> None:
    words = "--duration 1 --encoding ros1 -o a/b/c.mcap --png d/e.png"
    ran = fretc("simulate", *words.split())
    assert ran.status == 0, ran.err
    assert Path("d/e.png").is_file()
    with Path("a/b/c.mcap").open("rb") as stream:
        assert make_reader(stream).get_header().profile == "ros1"


def test_the_scenarios_are_named(fretc: Fretc) -> None:
    ran = fretc("simulate", "--list")
    assert ran.status == 0
    assert re.search(r"^nominal +Nominal mission$", ran.out, re.MULTILINE)
    assert len(ran.out.splitlines()) == 31


@pytest.mark.slow
def test_a_campaign_ends_in_a_table_and_tells_what_is_not_as_stated(fretc: Fretc) -> None:
    stated = f'title = "Mine"\nduration = {3 if FULL else 2}\n[expect]\n'
    write("mine.toml", f'{stated}inconclusive = ["R12"]\n')
    ran = fretc("simulate", "mine.toml", "--campaign", "2", "--jobs", "2")
    assert ran.status == 0, ran.err
    assert ran.out.splitlines()[1].startswith("mine      2/2        0/2 ")
    write("mine.toml", f'{stated}satisfied = ["R12"]\n')
    ran = fretc("simulate", "mine.toml", "--campaign", "1", "--format", "json")
    assert ran.status == 1
    (run,) = json.loads(ran.out)
    assert run["wrong"] == {"R12": "satisfied"}
    assert run["verdicts"]["R12"] == "inconclusive"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "F907 missing option '--output'"),
        (("nominal",), "F907 missing option '--output'"),
        (("nominul", "-o", "a.mcap"), "F914 the scenario `nominul` cannot be run: there is no"),
        (("no.toml", "-o", "a.mcap"), "F914 the scenario `no.toml` cannot be run: No such file"),
        (("bad.toml", "-o", "a.mcap"), "F914 the scenario `bad.toml` cannot be run: `title` is"),
        (("ghost.toml", "-o", "a.mcap"), "cannot be run: the store has no obstacle `ghost`"),
        (("walker", "nominal", "-o", "a.mcap"), "F907 several scenarios need --campaign"),
        (("-o", "bad.toml/a.mcap"), "F905 `bad.toml/a.mcap` cannot be written: File exists"),
        (("-o", "-"), "F905 `-` cannot be written"),
        (("-o", "."), "F905 `.` cannot be written: it is not a regular file"),
        (("-o", "a.x", "--png", "a.x"), "F905 `a.x` cannot be written: two outputs"),
        (("-o", "a.mcap", "--png", "bad.toml/a.png"), "F905 `bad.toml/a.png` cannot be written"),
        (("-o", "a.mcap", "--duration", "inf"), "F905 `a.mcap` cannot be written: the duration"),
        (("--campaign", "1", "--png", "a.png"), "F907 --campaign cannot be combined with --png"),
        (("walker", "walker", "--campaign", "1"), "F907 two scenarios have the same name"),
        (
            ("--campaign", "1", "-o", "bad.toml"),
            "F905 `bad.toml` cannot be written: File exists",
        ),
    ],
)
def test_what_cannot_be_done_is_refused_and_leaves_nothing(
    tmp_path: Path, fretc: Fretc, words: tuple[str, ...], said: str
) -> None:
    (tmp_path / "bad.toml").write_text("", encoding="utf-8")
    (tmp_path / "ghost.toml").write_text(
        'title = "a"\n[store.moved]\nghost = [1, 1]\n', encoding="utf-8"
    )
    ran = fretc("simulate", *words)
    assert ran.status == 2
    assert said in ran.err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.toml", "ghost.toml"]


@pytest.mark.parametrize(
    ("text", "why", "shown"),
    [
        (
            "[safety]\nlate = -1\n",
            "`safety.late` must not be below 0\n",
            "  --> bad.toml:3:1\n   | late = -1\n   | ^^^^\n",
        ),
        (
            '[expect]\nviolated = ["R99"]\n',
            "`expect.violated` names `R99`, which is no requirement; there are R1, ",
            '  --> bad.toml:3:1\n   | violated = ["R99"]\n   | ^^^^^^^^\n',
        ),
    ],
)
def test_what_is_wrong_in_a_scenario_is_shown(
    tmp_path: Path, fretc: Fretc, text: str, why: str, shown: str
) -> None:
    (tmp_path / "bad.toml").write_text(f'title = "a"\n{text}', encoding="utf-8")
    ran = fretc("simulate", "bad.toml", "-o", "a.mcap")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err.startswith(f"F914 the scenario `bad.toml` cannot be run: {why}")
    assert shown in ran.err


@pytest.mark.slow
def test_a_campaign_that_is_stopped_leaves_nothing_half_written(tmp_path: Path) -> None:
    (tmp_path / "logs").mkdir()
    (tmp_path / "temporary").mkdir()
    for where in some((["-o", "logs"], []), 2):
        words = ["simulate", "nominal", "walker", "--campaign", "4", "--jobs", "2", *where]
        process = subprocess.Popen(
            [*PROCESS, *words],
            cwd=tmp_path,
            env={"PYTHONPATH": str(ROOT), "TMPDIR": str(tmp_path / "temporary")},
            stderr=subprocess.PIPE,
            text=True,
        )
        folders = (tmp_path / "logs", tmp_path / "temporary")
        while not any([*path.rglob(".*.partial")] for path in folders):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=30)
        assert (process.returncode, said) == (130, "stopped\n")
        assert [*tmp_path.rglob(".*.partial")] == []
        assert [*(tmp_path / "temporary").iterdir()] == []


@pytest.mark.slow
def test_without_the_extra_the_scenarios_are_named_and_a_mission_tells_what_to_install(
    tmp_path: Path,
) -> None:
    program = (
        "import simulation; simulation.missing = lambda: ('mujoco', 'rosbags'); "
        "import sys; sys.modules['mujoco'] = sys.modules['rosbags'] = None; "
        "from fretc.cli import main; main()"
    )
    for words, status in ((("--list",), 0), (("-o", "a.mcap"), 2), (("--campaign", "1"), 2)):
        ran = subprocess.run(
            [sys.executable, "-c", program, "simulate", *words],
            cwd=tmp_path,
            env={"PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            check=False,
        )
        assert ran.returncode == status
        if status:
            assert ran.stderr == (
                "F908 the simulated robot needs `mujoco` and `rosbags`\n"
                "help: install the extra: pip install 'fretc[sim]' "
                "(in a checkout: pip install '.[sim]')\n"
            )
