"""What is emitted gives the same results on CPython 3.14, which Pyodide brings for WebAssembly."""

import subprocess
import sys
from pathlib import Path

import pytest

from compiler.formalization.formalized import FormalizedRequirement
from compiler.targets.python import monitor
from tests.compiler.targets.python.test_old_python import NUMBERS, TEMPLATES, run, table
from tests.programs import leave_out, needs

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
