"""`fretc check`: what is wrong or missing in a project, before any run."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from fretish.reading.natural_order import natural
from tests.command import Fretc, write
from tests.each import each
from tests.fretc.report import cases

GOOD = cases.R1.replace("shall eventually", "shall within 300 milliseconds")
ROOT = Path(__file__).parents[3]
BY = ("--reviewer", "A", "--role", "B", "--comment", "c", "--date", "2026-01-01")


@pytest.fixture
def good(fretc: Fretc) -> Fretc:
    """A project with nothing to be said of it."""
    write("requirements/r1.fret", GOOD)
    write("requirements/bindings.toml", cases.BINDINGS)
    write("requirements/hazards.toml", cases.HAZARDS)
    return fretc


def edited(name: str, old: str, new: str) -> None:
    path = Path("requirements") / name
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


def test_a_sound_project_is_said_to_be_sound(good: Fretc) -> None:
    run = good("check")
    assert (run.status, run.out, run.err) == (0, "", "1 requirement: 0 errors, 0 warnings\n")


SHIPPED = sorted(
    str(path.parent.relative_to(ROOT)) for path in ROOT.glob("requirements/**/bindings.toml")
)


@pytest.mark.slow
@pytest.mark.parametrize("folder", SHIPPED)
def test_every_shipped_project_is_free_of_findings(
    folder: str, fretc: Fretc, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    run = fretc("check", "--requirements", folder)
    assert run.status == 0, run.err
    assert "0 errors, 0 warnings" in run.err


def test_the_same_is_said_as_json(good: Fretc) -> None:
    edited("r1.fret", "within 300 milliseconds", "eventually")
    edited("r1.fret", "status", "statuss")
    text, record = good("check"), json.loads(good("check", "--format", "json").out)
    assert record["mistakes"] == 1
    assert text.err.endswith(
        f"{record['requirements']} requirement: {record['mistakes']} error, "
        f"{record['warnings']} warnings\n"
    )
    for diagnostic in record["diagnostics"]:
        assert f"{diagnostic['code']} " in text.err
        assert diagnostic["message"] in text.err
    assert good("check", "--format", "json").status == text.status == 2


def test_a_trigger_that_the_component_itself_commands_is_told(good: Fretc) -> None:
    edited("bindings.toml", 'role = "input"\nkind = "belief"', 'role = "output"\nkind = "command"')
    run = good("check")
    assert run.status == 3
    assert run.err == (
        "F209 warning: R1 is triggered by `near`, which robot itself commands: the requirement "
        "holds if nothing is ever commanded\n"
        "  --> requirements/r1.fret:10:10\n"
        "   | whenever near the robot shall within 300 milliseconds satisfy stopped\n"
        "   |          ^^^^\n"
        "help: use a trigger that depends on sensor values, or declare `role` and `kind` of the "
        "proposition\n"
        "\n"
        "1 requirement: 0 errors, 1 warning\n"
    )


TOLD: dict[str, tuple[dict[str, str], list[str], list[str]]] = {
    "comparisons that contradict each other": (
        {"whenever near": "whenever near & vx < 1 & vx > 2"},
        ["F210 warning: `near & vx < 1 & vx > 2` of R1 is never true, whatever the signa"],
        [],
    ),
    "a plan that can give no result": (
        {'["audit"]': '["audit", "ajpf"]'},
        ["F525 warning: R1 plans `ajpf`, but this method cannot give a result: AJPF cannot"],
        [],
    ),
    "a remark of a planned method": (
        {"within 300 milliseconds": "eventually"},
        ["F203 warning"],
        [],
    ),
    "missing links, in both directions": (
        {'parents = ["HAZ-1"]\n': ""},
        [
            "F522 warning: no requirement in force names HAZ-1 (The robot hits something)",
            "F523 warning: R1 names no parent",
        ],
        [],
    ),
    "an approved requirement with a text to complete": (
        {'"The robot must stop."': '"To do: say it."'},
        ["F532 warning: R1 is approved, and its text still begins with `To do:`"],
        [],
    ),
    "a draft with a text to complete": (
        {
            '"The robot must stop."': '"To do: say it."',
            '"approved"': '"draft"',
            'it"]': 'it", "ajpf"]',
        },
        ["F525"],
        ["F532"],
    ),
    "a retired requirement, which covers no hazard and is not looked at": (
        {'"approved"': '"retired"', '["audit"]': '["ajpf"]'},
        ["F522"],
        ["F525"],
    ),
}
"""Edits of the requirement, what is reported then, and what is not."""


@each("kind", TOLD)
def test_what_is_wrong_with_a_requirement_is_told(good: Fretc, kind: str) -> None:
    edits, told, untold = TOLD[kind]
    write("requirements/r1.fret", GOOD)
    for old, new in edits.items():
        edited("r1.fret", old, new)
    run = good("check")
    assert run.status == 3
    assert all(text in run.err for text in told)
    assert not any(text in run.err for text in untold)


def test_what_changed_since_its_review_is_told(good: Fretc) -> None:
    assert good("lock", *BY).status == 0
    assert good("check").status == 0
    edited("r1.fret", "300 milliseconds", "400 milliseconds")
    run = good("check")
    assert run.status == 3
    assert (
        "F512 warning: R1 was reviewed on 2026-01-01, and has changed since then: sentence: "
        "whenever near the robot shall within 300 milliseconds → 400 milliseconds …\n"
    ) in run.err


def test_a_review_of_what_is_gone_is_told(good: Fretc) -> None:
    assert good("lock", *BY).status == 0
    edited("r1.fret", 'id = "R1"', 'id = "R2"')
    run = good("check")
    assert run.status == 3
    assert "F511 warning: R1 was reviewed (not audited in any run) and is no longer" in run.err


def test_mistakes_win_over_warnings(good: Fretc) -> None:
    write("requirements/waivers.toml", "[R9]\n")
    run = good("check")
    assert run.status == 2
    assert "F513 R9 is waived, but is not among the requirements" in run.err


def test_a_lock_that_cannot_be_read_is_a_mistake(good: Fretc) -> None:
    write("requirements/fretc.lock", "x")
    assert good("check").status == 2


@pytest.mark.parametrize(
    ("parents", "way"),
    [
        ({"R1": ["R1"]}, "R1 → R1"),
        ({"R1": ["R2"], "R2": ["R3", "HAZ-1"], "R3": ["R1"]}, "R1 → R2 → R3 → R1"),
    ],
)
def test_parents_in_a_circle_are_a_mistake(
    good: Fretc, parents: dict[str, list[str]], way: str
) -> None:
    for id, above in parents.items():
        text = GOOD.replace('"R1"', f'"{id}"').replace('["HAZ-1"]', str(above).replace("'", '"'))
        write(f"requirements/{id.lower()}.fret", text)
    run = good("check")
    assert run.status == 2
    assert f"F526 R1 is its own ancestor: {way}\n" in run.err
    assert run.err.count("F526") == 1


@pytest.mark.parametrize(
    ("status", "above", "told"),
    [
        ("approved", "HAZ-1", False),
        ("retired", "HAZ-1", True),
        ("approved", "R1", False),
        ("approved", "GONE", True),
    ],
)
def test_a_requirement_that_reaches_no_hazard_is_told(
    good: Fretc, status: str, above: str, told: bool
) -> None:
    low = GOOD.replace('"R1"', '"R3"').replace("HAZ-1", "R2")
    high = GOOD.replace('"R1"', '"R2"').replace("HAZ-1", above).replace("approved", status)
    write("requirements/r2.fret", high)
    write("requirements/r3.fret", low)
    run = good("check")
    assert run.status == (3 if told else 0)
    assert ("F527 warning: the parents of R3 lead to no hazard" in run.err) == told


def test_hazards_that_cannot_be_read_are_one_message(good: Fretc) -> None:
    write("requirements/r2.fret", GOOD.replace('"R1"', '"R2"'))
    write("requirements/hazards.toml", "[HAZ-1\n")
    run = good("check")
    assert (run.status, run.err.count("F502"), "F501" in run.err) == (2, 1, False)
    run = good("check", "--hazards", "gone.toml")
    assert (run.status, run.err.count("F901"), "F501" in run.err) == (2, 1, False)


def test_hazards_that_are_nowhere_are_one_message(good: Fretc) -> None:
    write("requirements/r2.fret", GOOD.replace('"R1"', '"R2"'))
    Path("requirements/hazards.toml").unlink()
    run = good("check")
    assert run.status == 3
    assert run.err.count("F501") == 1
    assert "the parent `HAZ-1` of R1 is declared nowhere (1 more parent is, too)" in run.err


NEAR = {
    "auditt": "audit",
    "adit": "audit",
    "monitr": "monitor",
    "proofs": "proof",
    "dafni": "dafny",
    "ajfp": "ajpf",
}


@each("method", NEAR)
def test_a_misspelt_method_gets_a_suggestion(good: Fretc, method: str) -> None:
    write("requirements/r1.fret", GOOD.replace('["audit"]', f'["{method}"]'))
    run = good("check")
    assert run.status == 3
    assert f"F528 warning: R1 plans `{method}`" in run.err
    assert f"help: did you mean `{NEAR[method]}`?" in run.err


@each("method", ["review", "inspection", "test", "analysis", "simulation", "field trial", "audit"])
def test_a_method_of_ones_own_is_no_mistake(good: Fretc, method: str) -> None:
    write("requirements/r1.fret", GOOD.replace('["audit"]', f'["{method}"]'))
    assert good("check").status == 0


# Fixes -----------------------------------------------------------------------------------------


def test_fix_writes_what_is_sure_says_so_and_checks_again(good: Fretc) -> None:
    edited("r1.fret", "shall within 300 milliseconds", "should within 300 msec")
    before = Path("requirements/bindings.toml").read_bytes()
    run = good("check", "--fix")
    assert Path("requirements/r1.fret").read_bytes() == GOOD.encode()
    assert Path("requirements/bindings.toml").read_bytes() == before
    assert (run.status, run.out, run.err) == (
        0,
        "",
        "wrote requirements/r1.fret\n"
        "fixed requirements/r1.fret:10:25: replaced `should` by `shall`\n"
        "fixed requirements/r1.fret:10:43: replaced `msec` by `milliseconds`\n"
        "\n"
        "1 requirement: 0 errors, 0 warnings\n",
    )


@pytest.mark.parametrize("fix", ["shall near", "shall alwyas satisfy near", "shall satisfy (near"])
def test_fix_leaves_alone_what_is_not_sure(good: Fretc, fix: str) -> None:
    edited("r1.fret", "shall within 300 milliseconds satisfy stopped", f"{fix} until stopped or p")
    text = Path("requirements/r1.fret").read_text()
    run = good("check", "--fix")
    assert run.status == 2
    left = Path("requirements/r1.fret").read_text()
    assert left in (text, text.replace("shall near", "shall satisfy near"))
    assert good("check", "--fix").err.count("fixed") == 0


def test_fix_touches_no_file_that_has_nothing_to_fix(good: Fretc) -> None:
    text = (GOOD + "+++\nid = 'R2'\n+++\n\"the robot should and must\"\n").replace("\n", "\r\n")
    write("requirements/r1.fret", text)
    before = Path("requirements/r1.fret").stat()
    good("check", "--fix")
    after = Path("requirements/r1.fret").stat()
    assert (after.st_ino, after.st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    assert Path("requirements/r1.fret").read_bytes() == text.encode()


def test_fix_keeps_the_ends_of_lines_and_the_headers(good: Fretc) -> None:
    text = GOOD.replace("\n", "\r\n")
    write("requirements/r1.fret", text.replace("shall", "must"))
    assert good("check", "--fix").status == 0
    assert Path("requirements/r1.fret").read_bytes() == text.encode()


def test_fix_writes_all_files_or_none(good: Fretc) -> None:
    edited("r1.fret", "shall", "must")
    other = write("elsewhere.txt", GOOD.replace('"R1"', '"R2"').replace("shall", "must"))
    Path("requirements/r2.fret").symlink_to(Path(other).resolve())
    run = good("check", "--fix")
    assert (run.status, run.err.splitlines()[0][:4]) == (2, "F905")
    assert "must" in Path("requirements/r1.fret").read_text()
    assert "must" in Path(other).read_text()


# All mistakes, by their places -----------------------------------------------------------------


def test_mistakes_are_in_the_order_of_their_places(good: Fretc) -> None:
    for name in ("r10", "r2"):
        text = GOOD.replace('"R1"', f'"{name}"').replace("HAZ-1", "HAZ-9")
        write(f"requirements/{name}.fret", text.replace("near", "near and p && q"))
    write("requirements/bindings.toml", cases.BINDINGS.replace("path", "pth"))
    run = good("check")
    places = [line.split()[1] for line in run.err.splitlines() if line.startswith("  -->")]
    keys = [(natural(f), int(r), int(c)) for f, r, c in (p.rsplit(":", 2) for p in places)]
    assert keys == sorted(keys)
    assert sum(place.startswith("requirements/r2.fret") for place in places) >= 3


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("[proposition.stopped]", "[proposition.other]", "F304"),
        ("[clock]", "[clocks]", "F302"),
    ],
)
def test_check_refuses_what_an_audit_refuses(good: Fretc, old: str, new: str, code: str) -> None:
    edited("bindings.toml", old, new)
    run = good("check")
    assert run.status == 2
    assert f"{code} " in run.err


def test_a_misspelt_signal_is_answered_with_the_declared_one(good: Fretc) -> None:
    edited("r1.fret", "satisfy stopped", "satisfy stopped & claerance < 3")
    run = good("check")
    assert run.status == 2
    assert "help: did you mean `clearance`? Or add `[signal.claerance]` with its `path`" in run.err


def test_a_comparison_of_what_is_no_signal_is_shown_itself_with_the_signal(good: Fretc) -> None:
    edited("r1.fret", "satisfy stopped", "satisfy stopped & range < 3")
    run = good("check")
    assert run.status == 2
    assert "F304 `(range < 3)` of R1 has no binding in requirements/bindings.toml\n" in run.err
    assert run.err.splitlines()[3].count("^") == len("range < 3")
    assert (
        "help: add `[signal.range]` with its `path` to requirements/bindings.toml; "
        "`fretc bind --from LOG` drafts signals\n"
    ) in run.err
    edited("r1.fret", "range < 3", "range mod 2 < 3")
    assert 'add `[proposition."((range mod 2) < 3)"]` with its `expr` to ' in good("check").err


def test_a_hazard_to_be_named_is_told_of_the_approved_requirement_below_it(good: Fretc) -> None:
    edited("hazards.toml", "The robot hits something", "To do: name the harm")
    run = good("check")
    assert run.status == 3
    assert "F532 warning: R1 is approved, and the title of its parent HAZ-1 still begins" in run.err
    edited("r1.fret", '"approved"', '"draft"')
    assert "F532" not in good("check").err


Steps = Callable[..., None]


@pytest.fixture
def steps(monkeypatch: pytest.MonkeyPatch) -> Steps:
    """Do something in each pause of `--watch`; then press Ctrl-C."""

    def set_steps(*actions: Callable[[], object]) -> None:
        waiting = iter(actions)

        def sleep(_: float) -> None:
            action = next(waiting, None)
            if action is None:
                raise KeyboardInterrupt
            action()

        monkeypatch.setattr("fretc.commands.check.time.sleep", sleep)

    return set_steps


SOUND = "1 requirement: 0 errors, 0 warnings"


def test_a_watch_checks_again_after_each_change(good: Fretc, steps: Steps) -> None:
    def nothing() -> None: ...

    steps(
        nothing,
        lambda: edited("r1.fret", "shall", "shal"),
        nothing,
        lambda: edited("r1.fret", "shal ", "shall "),
        lambda: Path("requirements/bindings.toml").unlink(),
    )
    run = good("check", "--watch")
    assert run.status == 2, "that of the last check"
    counts = [line for line in run.err.splitlines() if line.startswith("1 requirement")]
    assert [counts[0], counts[2]] == [SOUND, SOUND]
    assert counts[1].startswith("1 requirement: 1 error")
    assert len(counts) == 4
    assert run.err.count("waiting for a change of requirements; Ctrl-C ends") == 4
    assert run.out == ""


def test_a_watch_waits_for_a_folder_that_is_missing(good: Fretc, steps: Steps) -> None:
    folder = Path("requirements")
    steps(lambda: folder.rename("away"), lambda: Path("away").rename(folder))
    run = good("check", "--watch")
    assert (run.status, run.err.count(SOUND), run.err.count("there is no folder")) == (0, 2, 1)


@each("path", ("fretc.toml", "build/evidence.json", "requirements/waivers.toml", "other.toml"))
def test_a_watch_sees_the_files_beside_the_requirements(
    path: str, good: Fretc, steps: Steps
) -> None:
    Path(path).unlink(missing_ok=True)
    steps(lambda: write(path, "a mistake\n"))
    write("requirements/same.toml", cases.BINDINGS)
    run = good("check", "--watch", "--verification", "other.toml")
    assert run.status == 2
    assert run.err.count("waiting for a change") == 2
    Path(path).unlink()


def test_a_watch_prints_text_only(good: Fretc) -> None:
    run = good("check", "--watch", "--format", "json")
    assert run.status == 2
    assert run.err.startswith("F907 --watch cannot be combined with --format json")
