"""Bad input is one exception with diagnostics; nothing is printed, and the process goes on."""

from collections.abc import Callable
from pathlib import Path

import pytest

import fretc
from fretish.diagnostics.diagnostic import Code

ROOT = Path(__file__).parent.parent.parent.parent


@pytest.fixture(scope="module")
def project() -> fretc.Project:
    return fretc.read_project(ROOT / "requirements")


CALLS: dict[str, tuple[Code, Callable[[fretc.Project], object]]] = {
    "no folder": (Code.NO_SUCH_FILE, lambda _: fretc.read_project("nowhere")),
    "no bindings": (
        Code.NO_SUCH_FILE,
        lambda _: fretc.read_project(ROOT / "requirements", "nowhere.toml"),
    ),
    "no FRETish": (Code.NOT_FRETISH, lambda _: fretc.formalize("stop")),
    "free text": (Code.FREE_TEXT, lambda _: fretc.formalize('"it shall stop"')),
    "too deep": (
        Code.TOO_DEEP,
        lambda _: fretc.formalize(f"r shall always satisfy {'!' * 3000}p"),
    ),
    "no notation": (Code.BAD_USAGE, lambda p: fretc.formulas(p.formalized[0], "prose")),
    "no rule": (Code.NOTHING_TO_DO, lambda _: fretc.load_monitor()),
    "one id": (
        Code.DUPLICATE_ID,
        lambda p: fretc.monitor_text(
            p.formalized[0], fretc.formalize("r shall satisfy p", id="r1")
        ),
    ),
    "two clocks": (
        Code.BAD_USAGE,
        lambda p: fretc.monitor_text(
            p.formalized[0], fretc.formalize("r shall satisfy p", id="R2")
        ),
    ),
    "seconds without a clock": (
        Code.NO_CLOCK,
        lambda _: fretc.monitor_text(fretc.formalize("r shall within 1 second satisfy p")),
    ),
    "no log": (Code.NOTHING_TO_DO, lambda p: fretc.audit_logs(p)),
    "no such log": (Code.NO_SUCH_FILE, lambda p: fretc.audit_logs(p, "runs/*.mcap")),
    "no integrity": (Code.BAD_USAGE, lambda p: fretc.audit_logs(p, "x", integrity="none")),
    "certainty": (Code.BAD_USAGE, lambda p: fretc.audit_logs(p, "x", confidence=1.0)),
    "no process": (Code.BAD_USAGE, lambda p: fretc.audit_logs(p, "x", jobs=0)),
    "no layer": (Code.BAD_USAGE, lambda p: fretc.verify(p, layers=["moniter"])),
    "no layers": (Code.NOTHING_TO_DO, lambda p: fretc.verify(p, layers=[])),
    "no result of AJPF": (Code.NO_SUCH_FILE, lambda p: fretc.verify(p, ajpf=["nowhere.json"])),
    "no lock": (Code.NO_SUCH_FILE, lambda p: fretc.make_report(p, lock="nowhere.lock")),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS)
def test_it_is_refused_with_its_code(
    name: str,
    project: fretc.Project,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capfd: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    code, call = CALLS[name]
    with pytest.raises(fretc.Refusal) as refusal:
        call(project)
    assert code in [diagnostic.code for diagnostic in refusal.value.diagnostics]
    assert str(refusal.value).startswith("F")
    assert capfd.readouterr() == ("", "")
    assert not [*tmp_path.iterdir()]


def test_a_log_that_cannot_be_read_has_a_result_and_shows_nothing(
    project: fretc.Project, tmp_path: Path
) -> None:
    log = tmp_path / "run.mcap"
    log.write_bytes(b"no log")
    audit = fretc.audit_logs(project, log)
    assert [result.verdict for result in audit.results] == ["no data"]
    assert (audit.shown, audit.violated) == (False, False)
    assert [diagnostic.code for diagnostic in audit.diagnostics] == [Code.NOT_A_LOG]


def test_a_requirement_with_a_mistake_is_not_lost(tmp_path: Path) -> None:
    (tmp_path / "r1.fret").write_text("r shall always satisfy low")
    (tmp_path / "r2.fret").write_text("r shall allways satisfy low")
    (tmp_path / "bindings.toml").write_text(
        '[clock]\ntick = "100 ms"\n[signal.vx]\npath = "/odom.twist.twist.linear.x"\nunit = "m/s"\n'
        '[proposition.low]\nexpr = "vx < 9 m/s"\n'
    )
    project = fretc.read_project(tmp_path)
    assert [failed.requirement.id for failed in project.failed] == ["r2"]
    (log,) = ROOT.joinpath("traces").glob("*.mcap")
    audit = fretc.audit_logs(project, log)
    verdicts = {result.requirement: result.verdict for result in audit.results}
    assert verdicts == {"r1": "satisfied", "r2": "no data"}
    assert not audit.shown
    assert audit.diagnostics
    with pytest.raises(fretc.Refusal):
        fretc.verify(project, layers=["monitor"])
