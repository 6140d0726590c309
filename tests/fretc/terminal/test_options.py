"""One vocabulary of options: the same thing has the same name, whatever the command."""

import re
from pathlib import Path

import click

from compiler.emit import TARGETS
from fretc.cli import cli
from tests.command import Fretc, write
from tests.each import each

COMMANDS = sorted(cli.commands)
PRINTING = ("audit", "bind", "check", "diff", "explain", "info", "lock", "verify", "simulate")
MEANINGS = {
    "--requirements": "Requirement file, or folder of requirement files.",
    "--hazards": "Hazards file.  [default: hazards.toml beside the requirements]",
}


def options(name: str) -> dict[str, click.Option]:
    return {
        spelling: option
        for option in cli.commands[name].params
        if isinstance(option, click.Option)
        for spelling in option.opts
    }


@each("name", COMMANDS)
def test_a_command_has_both_spellings_of_help(fretc: Fretc, name: str) -> None:
    short, long = fretc(name, "-h"), fretc(name, "--help")
    if name == "compile":
        short, long = fretc("r.fret", "-h"), fretc("r.fret", "--help")
    assert short == long
    assert short.status == 0
    assert short.out.startswith("Usage: fretc ")


@each("name", COMMANDS)
def test_an_option_means_the_same_in_each_command(name: str) -> None:
    here = options(name)
    assert ("-o" in here) == ("--output" in here)
    assert not {"--out", "--evidence-file", "--folder"} & here.keys()
    for spelling, text in MEANINGS.items():
        assert spelling not in here or here[spelling].help == text


@each("name", COMMANDS)
def test_each_option_says_what_it_is_for(name: str) -> None:
    for spelling, option in options(name).items():
        text = option.help or ("" if option.hidden else "missing")
        assert text == "" or re.fullmatch(r"[A-Z`][^\n]*[.\])]", text), (spelling, text)


def test_each_command_has_a_line_under_a_heading(fretc: Fretc) -> None:
    lines = fretc("--help").out.partition("\nWrite requirements:\n")[2].splitlines()
    names = [line.split()[0] for line in lines if line.startswith("  ")]
    assert sorted(names) == [name for name in COMMANDS if name != "compile"]
    assert all(len(line) < 80 and line.endswith((".", ":")) for line in lines if line)


@each("name", PRINTING)
def test_what_prints_results_prints_them_as_json_too(name: str) -> None:
    kinds = options(name)["--format"].type
    assert isinstance(kinds, click.Choice)
    assert {"text", "json"} <= {*kinds.choices}


def test_requirements_are_named_once(fretc: Fretc) -> None:
    write("a/r.fret", "the sw shall always satisfy p")
    run = fretc("analyze", "a", "--requirements", "b")
    assert run.err.startswith("F907 requirements are named twice: `a` and `--requirements`")


def test_options_that_commands_share_are_explained_in_one_place() -> None:
    text = (Path(__file__).parents[3] / "docs/commands.md").read_text("utf-8")
    table = text[text.index("| option |") : text.index("\nExit status")]
    spellings = [spelling for name in COMMANDS for spelling in options(name)]
    shared = {spelling for spelling in spellings if spellings.count(spelling) >= 4}
    assert shared
    assert all(f"`{spelling}`" in table for spelling in shared), shared


@each("kind", [*TARGETS])
def test_each_help_lists_each_kind_of_emit(fretc: Fretc, kind: str) -> None:
    for help_ in (fretc("--help").out, fretc("r.fret", "--help").out):
        assert kind in re.split(r"[\s,|.\[\]]+", re.sub(r"-\n\s*", "-", help_))
