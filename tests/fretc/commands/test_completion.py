"""A shell completes commands, options, choices and files after `fretc`."""

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from fretc.cli import cli
from fretc.commands.completion import SHELLS
from fretc.terminal.group import DEFAULT
from tests.command import Fretc, write

Answers = Callable[[str], list[str]]


@pytest.fixture
def answers(fretc: Fretc, monkeypatch: pytest.MonkeyPatch) -> Answers:
    """What completes the last word of a line, as bash asks for it."""

    def ask(line: str) -> list[str]:
        monkeypatch.setenv("COMP_WORDS", f"fretc {line}")
        monkeypatch.setenv("COMP_CWORD", str(line.count(" ") + 1))
        monkeypatch.setenv("_FRETC_COMPLETE", "bash_complete")
        run = fretc()
        assert (run.status, run.err) == (0, "")
        return run.out.splitlines()

    return ask


def test_the_first_word_is_a_command_or_a_file(answers: Answers) -> None:
    assert answers("veri") == ["file,veri", "plain,verify", "plain,verify-evidence"]
    names = {name for name in cli.commands if name != DEFAULT}
    assert {line.partition(",")[2] for line in answers("")} == {"", *names}


def test_options_of_each_command_are_completed(answers: Answers) -> None:
    for name in cli.commands:
        start = "r.fret" if name == DEFAULT else name
        assert "plain,--help" in answers(f"{start} --h"), name
    assert "plain,--emit" in answers("no-such-thing --em")


def test_a_path_is_left_to_the_shell_and_a_choice_is_not(answers: Answers) -> None:
    assert answers("audit tra") == answers("check --requirements tra") == ["file,tra"]
    assert answers("r.fret --emit aj") == ["plain,ajpf", "plain,ajpf-bundle"]


def test_an_earlier_spelling_is_not_offered(answers: Answers) -> None:
    assert answers("simulate --ou") == ["plain,--output"]


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_calls_back(fretc: Fretc, shell: str) -> None:
    run = fretc("completion", shell)
    assert (run.status, run.err) == (0, "")
    assert f"_FRETC_COMPLETE={shell}_complete" in run.out


def test_bash_takes_the_script(fretc: Fretc) -> None:
    script = write("fretc.bash", fretc("completion", "bash").out)
    line = f"source {script}; complete -p fretc"
    done = subprocess.run(
        ["bash", "--norc", "-c", line], capture_output=True, text=True, check=True
    )
    assert done.stdout.endswith("-F _fretc_completion fretc\n")
    assert Path(script).exists()
