"""CPython 3.14, which Pyodide brings for WebAssembly: same files and same results of monitors."""

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor
from tests.compiler.targets.python.test_old_python import (
    COMPARISONS,
    NUMBERS,
    TEMPLATES,
    run,
    table,
)
from tests.effort import some
from tests.programs import leave_out, needs
from tests.strategies import few_templates

SCRIPT = """
import { loadPyodide } from "pyodide";
import { readFileSync } from "node:fs";
const python = await loadPyodide();
for (const name of ["all.py", "trace.csv"]) {
  python.FS.writeFile(name, readFileSync(name, "utf8"));
}
python.runPython(`
import sys
assert sys.version_info[:2] == (3, 14), sys.version
sys.path.insert(0, ".")
from all import MONITOR, MAIN
for engine in ("columns", "online"):
    MAIN(MONITOR, ["trace.csv", "--format", "json", "--engine", engine])
sys.stdout.flush()
`);
"""


@pytest.fixture(scope="module")
def pyodide(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which Node finds it; the tests are skipped where npm cannot install it."""
    folder = tmp_path_factory.mktemp("pyodide")
    command = ["npm", "install", "--no-audit", "--no-fund", "--prefix", str(folder), "pyodide@314"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        leave_out(f"needs pyodide: {done.stderr[-200:]}")
    return folder


@needs("node", "npm")
@pytest.mark.slow
@pytest.mark.parametrize(
    ("emitted", "names", "entry"),
    [
        (TEMPLATES, "mpqs", "main"),
        (NUMBERS, ("docking", "battery", "speed"), "main_by_variables"),
    ],
    ids=["templates", "numbers"],
)
def test_monitors_give_the_same_outcomes_on_python_3_14(
    pyodide: Path, emitted: list[FormalizedRequirement], names: tuple[str, ...], entry: str
) -> None:
    (pyodide / "all.py").write_text(monitor.text(*emitted))
    (pyodide / "trace.csv").write_text(table(names, 200))
    script = SCRIPT.replace("MAIN", entry)
    (pyodide / "run.mjs").write_text(script)
    expected = ""
    for engine in ("columns", "online"):
        command = ("all.py", "trace.csv", "--format", "json", "--engine", engine)
        expected += run(sys.executable, *command, folder=pyodide)
    assert run("node", "run.mjs", folder=pyodide) == expected


TARGETS = "ltl monitor c rust js ajpf json fret-json smv prism hoa".split()
"""All that need no compiled library. There is none for WebAssembly outside of Pyodide's server."""
LIBRARIES = ("jinja2", "lark", "markupsafe", "tomli_w", "yaml")
HASHES = """
import sys
from hashlib import sha256
from pathlib import Path

from compiler.emit import TARGETS
from compiler.formalization.formalize import formalize
from compiler.targets.target import TargetOptions
from fretish.diagnostics.source import Source
from fretish.documents import RequirementEntry

sentences, *names = sys.argv[1:]
for number, sentence in enumerate(Path(sentences).read_text(encoding="utf-8").splitlines()):
    entry = RequirementEntry(f"R{number}", Source("r.fret", sentence).span())
    requirement, diagnostics = formalize(entry, None)
    print(sentence, [(each.code, each.message) for each in diagnostics])
    for target in (TARGETS[name] for name in names if requirement):
        if target.refuse(requirement) is None:
            for file in target.emit([requirement], TargetOptions()):
                print(file.path, sha256(file.text.encode()).hexdigest())
"""
PROJECT = """
import { loadPyodide } from "pyodide";
const python = await loadPyodide();
for (const [place, folder] of [["/project", process.argv[2]], ["/here", process.cwd()]]) {
  python.FS.mkdirTree(place);
  python.mountNodeFS(place, folder);
}
python.globals.set("words", process.argv.slice(3));
python.runPython(`
import runpy, sys
assert sys.version_info[:2] == (3, 14), sys.version
sys.path[:0] = ["/project", "/here/libraries"]
sys.dont_write_bytecode = True
sys.argv = list(words)
runpy.run_path("/here/hashes.py", run_name="__main__")
sys.stdout.flush()
`);
"""


@needs("node", "npm")
@pytest.mark.slow
def test_sentences_give_the_same_files_on_python_3_14(pyodide: Path) -> None:
    for name in LIBRARIES:
        spec = importlib.util.find_spec(name)
        assert spec is not None
        assert spec.origin is not None
        compiled = shutil.ignore_patterns("*.so", "__pycache__")
        folder = Path(spec.origin).parent
        shutil.copytree(folder, pyodide / "libraries" / name, ignore=compiled)
    (pyodide / "hashes.py").write_text(HASHES)
    (pyodide / "project.mjs").write_text(PROJECT)
    sentences = [t.sentence for t in few_templates((0, 3))]
    sentences += [*COMPARISONS, "whenever the sw shall satisfy p", "the sw shall p &"]
    (pyodide / "sentences.txt").write_text("\n".join(some(sentences, 3)))
    project = str(Path(__file__).parents[4])
    words = ("sentences.txt", *TARGETS)
    script = f"import sys; sys.path[0] = {project!r}; sys.argv[0] = ''; exec({HASHES!r})"
    expected = run(sys.executable, "-c", script, *words, folder=pyodide)
    assert len(expected.splitlines()) > 10 * len(TARGETS)
    there = ("node", "project.mjs", project, "", "/here/sentences.txt", *TARGETS)
    assert run(*there, folder=pyodide) == expected
