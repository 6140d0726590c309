"""The extension for VS Code: its own tests with the real server, and its package."""

import json
import os
import re
import sys
import zipfile
from pathlib import Path

import pytest

from tests.editors import npm_packages
from tests.effort import full_only

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def extension(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return npm_packages.copy("vscode", tmp_path_factory.mktemp("vscode"))


def test_the_tests_of_the_extension_pass_with_the_real_server(
    extension: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    server = [sys.executable, "-P", "-c", "from fretc.cli import main; main()"]
    monkeypatch.setenv("FRETC", json.dumps(server))
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    output = npm_packages.run(extension, "npm", "test")
    counts = {name: int(count) for name, count in re.findall(r"^# (\w+) (\d+)$", output, re.M)}
    assert counts["pass"] >= 16
    assert counts["fail"] == counts["skipped"] == 0


@full_only("vsce takes seconds")
def test_the_package_is_made_without_network(
    extension: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("npm_config_offline", "true")
    npm_packages.run(extension, "npm", "run", "package")
    with zipfile.ZipFile(extension / "fretish.vsix") as archive:
        names = set(archive.namelist())
    manifest = json.loads((extension / "package.json").read_text())
    contributed = manifest["contributes"]
    files = [
        manifest["main"],
        *(each["configuration"] for each in contributed["languages"]),
        *(each["path"] for kind in ("grammars", "snippets") for each in contributed[kind]),
        *(step["media"]["markdown"] for step in contributed["walkthroughs"][0]["steps"]),
    ]
    assert {os.path.normpath(f"extension/{name}") for name in files} <= names
    assert not [name for name in names if re.search(r"node_modules|tests|\.ts$|\.map$", name)]


def test_no_registry_is_named_in_the_lock_files() -> None:
    for lock in npm_packages.EDITORS.glob("*/package-lock.json"):
        packages = json.loads(lock.read_text(encoding="utf-8"))["packages"]
        assert [name for name, entry in packages.items() if "resolved" in entry] == []
