"""The command as its users meet it: what it prints, writes and exits with."""

import json
import os
import re
import subprocess
from pathlib import Path

import pytest

from fretc.cli import cli
from fretc.terminal.group import DEFAULT
from monitors.loading import load
from tests.command import PROCESS, Fretc, Run, runner, write

ROOT = Path(__file__).parents[2]
R1 = "whenever too_close agilex_agent shall eventually satisfy stopped"
UNDECIDED = (
    "F203 warning: no run, however long, can violate r1 or confirm it: it sets no bound\n"
    "  --> r1.fret:1:39\n"
    f"   | {R1}\n"
    "   |                                       ^^^^^^^^^^\n"
    "help: state a bound: `within ...` instead of `eventually`\n"
)


# Formulas ------------------------------------------------------------------------------------


def test_a_requirement_alone_shows_its_meaning_and_its_formulas(fretc: Fretc) -> None:
    assert fretc(write("r1.fret", R1)) == Run(
        0,
        "r1\n"
        "  whenever too_close agilex_agent shall eventually satisfy stopped\n"
        "\n"
        "  meaning      Over the whole run: at every tick at which `too_close` is true, `stopped` "
        "must be true at that tick or at a later one before the run ends.\n"
        "  FT           G(too_close -> F stopped)\n"
        "  FT, finite   LAST R (too_close -> !LAST U stopped)\n"
        "  PT           !(!stopped S (too_close & !stopped))\n",
        UNDECIDED,
    )


def test_when_in_place_of_whenever_is_another_formula(fretc: Fretc) -> None:
    shown = fretc(write("r1.fret", R1.replace("whenever", "when"))).out
    assert (
        "FT           G(!too_close & X too_close -> X F stopped) & (too_close -> F stopped)"
        in shown
    )


def test_the_formulas_as_json_are_an_array_on_standard_output(fretc: Fretc) -> None:
    run = fretc(write("r1.fret", R1), "--emit", "ltl", "--format", "json", "-o", "-")
    assert json.loads(run.out) == [
        {
            "id": "r1",
            "sentence": R1,
            "component": "agilex_agent",
            "scope": "null",
            "condition": "holding",
            "timing": "eventually",
            "variables": ["too_close", "stopped"],
            "durations": [],
            "ft_infinite": "(G (too_close -> (F stopped)))",
            "ft_finite": "(LAST R (too_close -> ((! LAST) U stopped)))",
            "pt": "(! ((! stopped) S (too_close & (! stopped))))",
            "pctl": None,
        }
    ]


def test_one_bad_sentence_among_several_is_an_error_object_in_the_array(fretc: Fretc) -> None:
    text = f'+++\nid = "A"\n+++\n{R1}\n+++\nid = "B"\n+++\nthe sw shall stopped\n'
    run = fretc(write("two.fret", text), "--emit", "ltl", "--format", "json", "-o", "-")
    good, bad = json.loads(run.out)
    assert (run.status, good["id"], good["ft_infinite"]) == (
        2,
        "A",
        "(G (too_close -> (F stopped)))",
    )
    assert bad == {
        "id": "B",
        "sentence": "the sw shall stopped",
        "error": {
            "code": "F104",
            "severity": "error",
            "message": "missing `satisfy` before `stopped`",
            "file": "two.fret",
            "line": 8,
            "column": 14,
            "help": "write `satisfy stopped`",
        },
    }


def test_a_sentence_in_place_of_a_file_is_told_where_it_belongs(fretc: Fretc) -> None:
    assert fretc("the rover shall satisfy speed <= 1.5") == Run(
        2,
        "",
        "F906 the argument is a sentence, not a command or a file\n"
        "help: use `fretc explain 'the rover shall satisfy speed <= 1.5'`, or pipe the sentence "
        "into `fretc -`\n",
    )


@pytest.mark.parametrize("kinds", [("ltl",), ("ajpf",), ("monitor",), ("json", "monitor")])
def test_a_file_has_one_opinion_whatever_is_made_of_it(
    fretc: Fretc, kinds: tuple[str, ...]
) -> None:
    path = write("r1.fret", R1)
    bare = fretc(path)
    made = fretc(path, *(word for kind in kinds for word in ("--emit", kind)))
    assert made.err.startswith(bare.err)
    assert made.err.count("F203") == bare.err.count("F203") == 1


# Files -----------------------------------------------------------------------------------------


def test_emitted_files_go_to_build_and_are_named(fretc: Fretc) -> None:
    run = fretc(write("r1.fret", R1), "--emit", "monitor", "--emit", "ajpf")
    assert run == Run(
        0,
        "",
        UNDECIDED + "wrote build/r1_monitor.py\nwrote build/r1.psl\n"
        "next: `python build/r1_monitor.py TRACE.csv` judges a table with a column for each "
        "of its names\n"
        "next: `fretc explain r1.fret` explains the requirement with a timing diagram\n",
    )
    assert sorted(path.name for path in Path("build").iterdir()) == ["r1.psl", "r1_monitor.py"]
    again = fretc("r1.fret", "--emit", "monitor", "--emit", "ajpf")
    assert again.err == f"{UNDECIDED}wrote build/r1_monitor.py\nwrote build/r1.psl\n"


def test_minus_prints_in_place_of_writing(fretc: Fretc) -> None:
    run = fretc(write("r1.fret", R1), "--emit", "ajpf", "-o", "-")
    assert run.out.startswith(
        f"# r1 {R1}\n# expected of r1: HOLDS (the requirement)\n"
        "r1: [] ((B(agilex_agent,too_close)) -> (<> (B(agilex_agent,stopped))))\n"
    )
    assert not Path("build").exists()


def test_what_a_target_refuses_keeps_nothing_else_from_being_written(fretc: Fretc) -> None:
    write("req/a.fret", "whenever p the rover shall within 3 ticks satisfy q")
    write("req/b.fret", "whenever p the rover shall eventually satisfy q")
    run = fretc("req", "--emit", "ajpf", "--emit", "interceptor", "--emit", "monitor")
    assert run.status == 2
    assert "F601 AJPF cannot express the timing `within 3 ticks` of a\n" in run.err
    assert "F323 there are no bindings, and so no interceptor\n" in run.err
    assert "wrote build/b.psl\nwrote build/a_monitor.py\nwrote build/b_monitor.py\n" in run.err
    assert sorted(path.name for path in Path("build").iterdir()) == [
        "a_monitor.py", "b.psl", "b_monitor.py",
    ]  # fmt: skip
    alone = fretc("req/b.fret", "--emit", "ajpf", "-o", "alone")
    assert alone.status == 0
    assert Path("alone/b.psl").read_text() == Path("build/b.psl").read_text()


def test_a_file_of_all_requirements_is_made_of_all_of_them_or_not_at_all(fretc: Fretc) -> None:
    write("req/a.fret", "whenever p the rover shall within 3 seconds satisfy q")
    write("req/b.fret", "whenever p the rover shall eventually satisfy q")
    run = fretc("req", "--emit", "monitor", "--one-file", "--emit", "json")
    assert run.status == 2
    assert sorted(path.name for path in Path("build").iterdir()) == ["a.json", "b.json"]


@pytest.mark.slow
@pytest.mark.parametrize("mask", [0o022, 0o077])
def test_a_file_with_a_command_line_can_be_run_by_whoever_can_read_it(
    fretc: Fretc, mask: int
) -> None:
    before = os.umask(mask)
    try:
        write("build/r_monitor.py", "")
        write("build/target.ltl", "")
        Path("build/r.ltl").symlink_to("target.ltl")
        path = write("r.fret", "the rover shall always satisfy q")
        assert fretc(path, "--emit", "monitor", "--emit", "ltl").status == 0
    finally:
        os.umask(before)
    modes = [oct(Path(f"build/r{end}").stat().st_mode & 0o777) for end in ("_monitor.py", ".ltl")]
    assert modes == (["0o755", "0o644"] if mask == 0o022 else ["0o700", "0o600"])
    ran = subprocess.run(["build/r_monitor.py", "-h"], capture_output=True, text=True, check=False)
    assert ran.returncode == 0
    assert ran.stdout.startswith("usage")


def test_within_is_emitted_for_ajpf_where_weakening_is_allowed(fretc: Fretc) -> None:
    path = write("r.fret", "whenever p rover shall within 3 ticks satisfy q")
    run = fretc(path, "--emit", "ajpf", "--emit", "ltl", "--weaken")
    assert run.status == 0
    assert run.err == (
        "F605 warning: the property of r is weaker than the requirement: `within 3 ticks` has lost "
        "its bound: a response that comes later, however late, satisfies it\n"
        "  --> r.fret:1:24\n"
        "   | whenever p rover shall within 3 ticks satisfy q\n"
        "   |                        ^^^^^^^^^^^^^^\n"
        "help: check the bound with `--emit monitor`\n"
        "wrote build/r.psl\nwrote build/r.ltl\n"
        "next: `fretc explain r.fret` explains the requirement with a timing diagram\n"
    )
    text = Path("build/r.psl").read_text()
    assert "\n# WEAKER than the requirement: `within 3 ticks` has lost its bound" in text
    assert "\nr: [] ((B(rover,p)) -> (<> (B(rover,q))))\n" in text
    assert "F[0,3] q" in Path("build/r.ltl").read_text()


@pytest.mark.parametrize("kinds", [(), ("--emit", "monitor"), ("--emit", "ltl", "--emit", "json")])
def test_only_the_files_of_ajpf_can_be_weaker(fretc: Fretc, kinds: tuple[str, ...]) -> None:
    run = fretc(write("r1.fret", R1), *kinds, "--weaken")
    assert run.status == 2
    assert run.err.startswith("F907 `--weaken` applies only to `--emit ajpf`")
    assert not Path("build").exists()


def test_an_output_that_cannot_be_written_leaves_nothing_behind(fretc: Fretc) -> None:
    write("build/r1.psl/in_the_way", "")
    run = fretc(write("r1.fret", R1), "--emit", "json", "--emit", "ajpf")
    assert run.status == 2
    assert run.err.startswith(
        f"{UNDECIDED}F905 `build/r1.psl` cannot be written: there is a directory"
    )
    assert [path.name for path in Path("build").iterdir()] == ["r1.psl"]


@pytest.mark.slow
def test_requirements_are_read_from_standard_input() -> None:
    run = subprocess.run(
        [*PROCESS, "-", "--emit", "ajpf", "-o", "-"],
        cwd=ROOT,
        input=R1,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (run.returncode, run.stdout.splitlines()[2].partition(":")[0]) == (0, "stdin")


# Mistakes --------------------------------------------------------------------------------------


def test_a_mistyped_command_gets_a_suggestion(fretc: Fretc) -> None:
    assert fretc("audti", "x.mcap") == Run(
        2,
        "",
        "F906 `audti` is neither a command of fretc nor a file\nhelp: did you mean `fretc "
        "audit`?\n",
    )


def test_a_missing_file_is_named_with_its_neighbour(fretc: Fretc) -> None:
    write("r1.fret", R1)
    assert fretc("rr1.fret") == Run(
        2, "", "F901 there is no file `rr1.fret`\n  --> rr1.fret\nhelp: did you mean `r1.fret`?\n"
    )


def test_a_directory_stands_for_the_requirements_in_it(fretc: Fretc) -> None:
    write("folder/r1.fret", R1)
    write("folder/notes.txt", "no requirement")
    assert fretc("folder/") == fretc("folder/r1.fret")


def test_a_directory_without_requirements_is_refused(fretc: Fretc) -> None:
    Path("folder").mkdir()
    assert fretc("folder") == Run(
        2,
        "",
        "F901 no requirement (`*.fret`) is in `folder`\n  --> folder\n"
        "help: name `.fret` files, or a folder with `.fret` files\n",
    )


def test_a_file_that_is_not_text_is_refused(fretc: Fretc) -> None:
    Path("r1.fret").write_bytes(b"the sw \xff shall")
    assert fretc("r1.fret") == Run(
        2,
        "",
        "F904 `r1.fret` is not UTF-8 text: byte 7 does not fit\n  --> r1.fret\n"
        "help: name a text file, in UTF-8\n",
    )


@pytest.mark.parametrize(
    "command",
    [
        ("check", "--bindings"),
        ("check", "--hazards"),
        ("test", "--suite"),
        ("import",),
    ],
)
def test_a_folder_in_place_of_a_file_is_refused(fretc: Fretc, command: tuple[str, ...]) -> None:
    write("requirements/r1.fret", R1)
    Path("folder").mkdir()
    run = fretc(*command, "folder")
    assert run.status == 2
    assert "F902 `folder` is a directory\n  --> folder\nhelp: name a file\n" in run.err


def test_a_bad_header_points_at_its_place(fretc: Fretc) -> None:
    assert fretc(write("r1.fret", f'+++\nid = "R1"\ntitel = "x"\n+++\n{R1}\n')) == Run(
        2,
        "",
        "F103 unknown field `titel` in a requirement's header\n"
        "  --> r1.fret:3:1\n"
        '   | titel = "x"\n'
        "   | ^^^^^\n"
        "help: did you mean `title`?\n",
    )


def test_a_bad_option_is_explained_without_a_traceback(fretc: Fretc) -> None:
    run = fretc(write("r1.fret", R1), "--emit", "monitr")
    assert run.status == 2
    assert run.err.startswith("F907 invalid value for '--emit': 'monitr' is not one of")


def test_an_unexpected_fault_of_our_own_is_told_as_such(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError("by purpose")

    monkeypatch.setattr("compiler.project.folder.load", broken)
    monkeypatch.chdir(tmp_path)
    run = runner(monkeypatch, capsys, fault=True)(write("r1.fret", R1))
    assert run.status == 2
    assert run.err.startswith("F999 internal error in fretc: ZeroDivisionError in test_cli.py:")


def test_two_requirements_with_one_id_are_refused(fretc: Fretc) -> None:
    text = f'+++\nid = "A"\n+++\n{R1}\n+++\nid = "a"\n+++\n{R1}\n'
    run = fretc(write("two.fret", text))
    assert run.status == 2
    assert "F201 the id `a` is taken: two.fret:2\n  --> two.fret:6:6\n" in run.err


# Bindings and clock ------------------------------------------------------------------------------


def test_a_duration_in_seconds_without_a_clock_is_told_in_formulas_and_refused_in_monitors(
    fretc: Fretc,
) -> None:
    sentence = "whenever p the rover shall within 3 seconds satisfy q"
    formulas = fretc(write("r.fret", sentence))
    assert formulas.status == 0
    assert "FT           G(p -> F[0,3] q)\n" in formulas.out
    assert formulas.err.startswith(
        "F312 warning: no clock says what a tick is: `3 seconds` is read"
    )
    monitor = fretc("r.fret", "--emit", "monitor")
    assert monitor.status == 2
    assert "F312 no clock says how many ticks the duration of r is" in monitor.err
    assert not Path("build").exists()


def test_the_clock_beside_the_requirement_counts_its_seconds(fretc: Fretc) -> None:
    write("bindings.toml", '[clock]\ntick = "100 ms"\n')
    run = fretc(write("r.fret", "whenever p the rover shall within 3 seconds satisfy q"))
    assert (run.status, run.err) == (0, "")
    assert "FT           G(p -> F[0,30] q)\n" in run.out
    assert "within the next 30 ticks (3 s)" in run.out


def test_a_number_of_the_requirement_that_its_binding_does_not_have_is_drift(fretc: Fretc) -> None:
    write(
        "bindings.toml",
        '[clock]\ntick = "100 ms"\n[signal.d]\npath = "/scan.d"\nunit = "m"\n'
        '[proposition.too_close]\nexpr = "d < 0.9 m"\n',
    )
    header = '+++\nid = "R1"\nparams = { too_close = "5 cm" }\n+++\n'
    run = fretc(write("r1.fret", header + R1))
    assert run.err == (
        "F310 warning: the requirement states 5 cm for `too_close`, but its binding has another "
        "number\n"
        "  --> bindings.toml:7:8\n"
        '   | expr = "d < 0.9 m"\n'
        "   |        ^^^^^^^^^^^\n"
        "help: correct the binding or `params`\n"
        "\n" + UNDECIDED.replace("r1 or", "R1 or").replace("r1.fret:1", "r1.fret:5")
    )


@pytest.mark.parametrize(
    ("expression", "stated", "drifts"),
    [
        ("d < 5 cm", "0.05 m", False),
        ("d < 10 cm / 2", "5 cm", False),
        ("d < 10 cm / 2", "10 cm", True),
        ("d < 4 cm + 1 cm and d > -3 cm", "50 mm", False),
        ("d < 4 cm + 1 cm", "4 cm", True),
        ("d > -3 cm", "3 cm", False),
        ("d > -3 cm", "-3 cm", False),
        ("d > 3 cm", "-3 cm", True),
        ("d / 2 < min(5 cm, 7 cm)", "5 cm", False),
        ("d / 2 < min(5 cm, 7 cm)", "7 cm", True),
        ("d < 5 cm for 200 ms", "0.2 s", False),
    ],
)
def test_a_number_of_a_binding_is_what_is_computed_of_its_numbers(
    fretc: Fretc, expression: str, stated: str, drifts: bool
) -> None:
    write(
        "bindings.toml",
        '[clock]\ntick = "100 ms"\n[signal.d]\npath = "/scan.d"\nunit = "m"\n'
        f'[proposition.too_close]\nexpr = "{expression}"\n',
    )
    header = f'+++\nid = "R1"\nparams = {{ too_close = "{stated}" }}\n+++\n'
    run = fretc(write("r1.fret", header + R1))
    assert ("F310" in run.err) == drifts


def test_an_empty_name_is_no_folder(fretc: Fretc) -> None:
    """It is what an unset shell variable gives."""
    write("a.fret", R1)
    for command in ((), ("fmt",), ("verify", "--monitor")):
        assert fretc(*command, "").out == ""
        assert "F901 there is no file ``" in fretc(*command, "").err
    assert Path("a.fret").read_text("utf-8") == R1


def test_a_file_that_is_named_twice_is_read_once(fretc: Fretc) -> None:
    write("ok/a.fret", R1)
    assert fretc("ok/a.fret", "./ok/a.fret", "ok") == fretc("ok")


def test_a_name_that_is_too_long_is_no_fault_of_the_output(fretc: Fretc) -> None:
    found = fretc("a" * 300 + ".fret")
    assert found.status == 2
    assert found.err.startswith("F903")


def test_one_file_is_for_monitors(fretc: Fretc) -> None:
    write("a.fret", R1)
    for kinds in ((), ("--emit", "ltl")):
        assert fretc("a.fret", *kinds, "--one-file").err.startswith("F907 `--one-file`")


def test_the_monitors_of_a_folder_can_be_one_file(fretc: Fretc) -> None:
    write("req/a.fret", "whenever p the sw shall within 2 ticks satisfy q")
    write("req/b.fret", "the sw shall always satisfy q")
    assert fretc("req", "--emit", "monitor", "--one-file").status == 0
    machine = load("monitors.py", Path("build/monitors.py").read_text("utf-8"))
    assert [known.id for known in machine.REQUIREMENTS] == ["a", "b"]
    assert fretc("req", "--emit", "js", "--one-file").status == 0
    assert Path("build/monitors.mjs").read_text("utf-8").count("fingerprint:") == 2


def test_names_that_become_one_in_one_file_are_refused(fretc: Fretc) -> None:
    write("req/a.fret", "the sw shall always satisfy a.b > 3")
    write("req/b.fret", "the sw shall always satisfy a_DOT_b > 3")
    assert fretc("req", "--emit", "monitor").status == 0
    found = fretc("req", "--emit", "monitor", "--one-file")
    assert (found.status, found.out) == (2, "")
    assert "F116 `a.b` and `a_DOT_b` would have the same name" in found.err


def test_a_broken_table_does_not_cost_the_clock(fretc: Fretc) -> None:
    """The sentence does not read `x`: three seconds are the ticks of the clock."""
    write("bindings.toml", '[clock]\ntick = "100 ms"\n[signal.x]\npath = "/x.data"\nunit = "mps"\n')
    run = fretc(write("r.fret", "whenever p the rover shall within 3 seconds satisfy q"))
    assert (run.status, "F[0,30] q" in run.out) == (2, True)
    assert run.err == (
        "F306 unknown unit `mps`\n"
        "  --> bindings.toml:5:8\n"
        '   | unit = "mps"\n'
        "   |        ^^^^^\n"
        "help: did you mean `m/s`?\n"
    )


def test_the_options_of_an_audit_stand_under_headings(fretc: Fretc) -> None:
    text = fretc("audit", "--help").out
    headings = [line for line in text.splitlines() if line.endswith(":") and line[0] != " "]
    assert headings == [
        "Input:",
        "Output:",
        "Selection:",
        "Many logs, performance:",
        "Queries on existing evidence:",
        "Other:",
    ]
    assert text.index("--requirements") < text.index("--format") < text.index("--jobs")
    assert "Other:\n  -h, --help  Show this message and exit.\n\n  Optional packages" in text


def test_requirements_come_as_people_count(fretc: Fretc) -> None:
    """In listings, and in what `step` of the monitor of all of them takes and gives."""
    for number in (1, 10, 2):
        header = f'+++\nid = "R{number}"\n+++\n'
        write(f"r{number}.fret", f"{header}the sw shall always satisfy p{number}\n")
    told = fretc(".").out
    assert [line for line in told.splitlines() if line.startswith("R")] == ["R1", "R2", "R10"]
    text = fretc(".", "--emit", "monitor", "--one-file", "-o", "-").out
    assert "\n# Runtime monitor of R1, R2, R10\n" in text
    assert "def step(self, *, p1: Truth, p2: Truth, p10: Truth)" in text
    assert [r.id for r in load("monitors.py", text).REQUIREMENTS] == ["R1", "R2", "R10"]


@pytest.mark.slow
@pytest.mark.parametrize("command", [*cli.commands, ""])
def test_h_is_help_everywhere(fretc: Fretc, command: str) -> None:
    name = [] if not command else ["x.fret"] if command == DEFAULT else [command]
    short, long = fretc(*name, "-h"), fretc(*name, "--help")
    assert (short.status, short.out, short.err) == (0, long.out, long.err)
    assert "-h, --help" in short.out


def test_all_mistakes_of_a_file_are_told_and_each_sentence_has_its_first_in_json(
    fretc: Fretc,
) -> None:
    text = (
        '+++\nid = "A"\nverify = 3\n+++\nthe sw must satisfy p and q\n'
        '+++\nid = "B"\n+++\nthe sw shall satisfy p && q == 3\n'
    )
    run = fretc(write("two.fret", text), "--emit", "ltl", "--format", "json", "-o", "-")
    codes = [line[:4] for line in run.err.splitlines() if re.match(r"F\d{3} ", line)]
    assert (run.status, codes) == (2, ["F105", "F107", "F101", "F101", "F101"])
    first, second = json.loads(run.out)
    assert (first["error"]["code"], second["error"]["column"]) == ("F105", 24)


def test_what_follows_an_unclosed_header_is_not_read_as_a_sentence(fretc: Fretc) -> None:
    run = fretc(write("r1.fret", '+++\nid = "A"\nthe sw must satisfy p\n'))
    assert [line[:4] for line in run.err.splitlines() if line.startswith("F")] == ["F113"]
